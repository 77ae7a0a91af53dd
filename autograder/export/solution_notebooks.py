"""Model solutions for students: the notebook with its outputs on one record, and the same as a page."""

import asyncio
import base64
import shutil
import tempfile
from copy import deepcopy
from pathlib import Path
from subprocess import DEVNULL
from typing import Any

import nbformat

from autograder.course.layout import Course
from autograder.course.questions import without_delimiters
from autograder.results.feedback import load_template, printable
from autograder.results.prose import course_html
from labsid.checks.notebook import find_assignment

SECONDS = 600
"""Longest run of one cell."""

_FILES = Path(__file__).parent


def solve(course: Course, name: str, record: bytes | None) -> Any:
    """Run the model solution of an assignment on a record.

    Parameters
    ----------
    course : Course
        Built.
    name : str
    record : bytes or None
        Content of the data file beside the notebook; None if the assignment has none.

    Returns
    -------
    NotebookNode
        With its outputs, without hidden tests, the marks of a solution and the metadata by which a notebook is graded.

    Raises
    ------
    ValueError
        If the course has not been built, or a cell stops with an error.
    """
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError

    path = course.source / name / f"{name}.ipynb"
    if not path.is_file():
        raise ValueError(f"{name} has not been built ({path} does not exist). Run: labsid course build")
    notebook = nbformat.reads(path.read_text(encoding="utf-8"), as_version=4)
    for cell in notebook.cells:
        cell.source = without_delimiters(cell.source)
    file = find_assignment(name).record_file
    with tempfile.TemporaryDirectory(prefix="labsid-") as scratch:
        shutil.copyfile(path, Path(scratch) / path.name)  # the checks read the marks from it
        if file is not None and record is not None:
            (Path(scratch) / file).write_bytes(record)
        client = NotebookClient(
            notebook, timeout=SECONDS, kernel_name="python3", resources={"metadata": {"path": scratch}}
        )
        try:
            solved = asyncio.run(client.async_execute(stdout=DEVNULL, stderr=DEVNULL))  # closes its event loop
        except (CellExecutionError, CellTimeoutError, DeadKernelError) as error:
            last = next((line for line in reversed(str(error).splitlines()) if line.strip()), type(error).__name__)
            raise ValueError(f"the model solution of {name} stops: {printable(last)}") from None
    for cell in solved.cells:
        cell.metadata = {key: value for key, value in cell.metadata.items() if key == "tags"}
    return solved


def solution_page(notebook: Any, title: str, course: str = "") -> str:
    """A solved notebook as one self-contained HTML page."""
    cells = [
        {
            "prose": course_html(cell.source) if cell.cell_type == "markdown" else None,
            "code": cell.source,
            "outputs": [shown for output in cell.get("outputs", ()) if (shown := _output(output)) is not None],
        }
        for cell in notebook.cells
        if cell.source.strip()
    ]
    return load_template("solution.html.j2", _FILES).render(page={"title": title, "course": course, "cells": cells})


def _output(output: Any) -> dict[str, str] | None:
    """An output as text or as the address of an image; None if there is nothing to show."""
    if output.output_type == "stream":
        return {"text": printable(output.text), "image": ""}
    data = output.get("data", {})
    if "image/png" in data:
        return {"text": "", "image": f"data:image/png;base64,{''.join(data['image/png'].split())}"}
    if "image/svg+xml" in data:
        packed = base64.b64encode("".join(data["image/svg+xml"]).encode()).decode("ascii")
        return {"text": "", "image": f"data:image/svg+xml;base64,{packed}"}
    text = printable("".join(data.get("text/plain", "")))
    return {"text": text, "image": ""} if text.strip() else None


def notebook_bytes(notebook: Any) -> bytes:
    """A notebook as its file."""
    return f"{nbformat.writes(deepcopy(notebook), version=4).rstrip()}\n".encode()
