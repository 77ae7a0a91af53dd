"""Notebooks for formgrader: the student's cells with their output, and the judged figures.

formgrader shows Markdown as HTML without cleaning it, in the browser of the instructor, who is logged in. What students
write is therefore rendered when the notebook is written, see `autograder.results.prose`, as HTML that runs no script.
"""

import base64
import json
import time
from collections.abc import Collection, Mapping
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any

from autograder.course.layout import Course
from autograder.judge.execution import ExecutedCell
from autograder.judge.outcome import SubmissionResult
from autograder.results.prose import SECONDS, prose_for_notebook
from labsid._files import write_text

MAX_TEXT_CHARACTERS, MAX_TEXT_SECONDS = 1_000_000, 3.0
"""Text of a student in one notebook, and the processor time in which it is rendered; the rest is left out or plain."""


def write_autograded(course: Course, out: Path, result: SubmissionResult) -> None:
    """Write ``OUT/autograded/<student>/<assignment>/<assignment>.ipynb``; nothing if there are no cells."""
    if not result.cells:
        return
    name = result.assignment
    path = course.release / name / f"{name}.ipynb"
    notebook = _released(path, path.stat().st_mtime_ns)
    released = {cell["id"]: cell for cell in notebook["cells"]}
    pictures = {question.question: question.figures for question in result.results}
    cells: list[dict[str, Any]] = []
    texts = _Texts({"".join(cell["source"]).strip() for cell in notebook["cells"] if cell["cell_type"] == "markdown"})
    for index, executed in enumerate(result.cells):
        # cells without a grade_id come from the submission, text of the course included
        cell = _as_cell(executed, released, f"extra-{index}", texts)
        if executed.cell.code:
            cell["outputs"] = [*_outputs(executed), *map(_picture, pictures.get(executed.cell.id or "", ()))]
        cells.append(cell)
    target = out / "autograded" / result.student / name / f"{name}.ipynb"
    write_text(target, json.dumps({**notebook, "cells": cells}, indent=1, ensure_ascii=False) + "\n")


@lru_cache(maxsize=32)
def _released(path: Path, changed: int) -> dict[str, Any]:
    """The released notebook as plain JSON, cached until it changes."""
    read: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return read


class _Texts:
    """The texts of one student in one notebook, within limits for all of them together."""

    def __init__(self, released: Collection[str]) -> None:
        self._released = released
        self._characters = MAX_TEXT_CHARACTERS
        self._until = time.thread_time() + MAX_TEXT_SECONDS

    def rendered(self, text: str) -> str:
        """A text as HTML; one of the course as it is."""
        if text.strip() in self._released:
            return text
        shown = text[: self._characters]
        self._characters -= len(shown)
        return prose_for_notebook(shown, SECONDS if time.thread_time() < self._until else 0.0)


def _as_cell(
    executed: ExecutedCell, released: Mapping[str, dict[str, Any]], extra_id: str, texts: _Texts
) -> dict[str, Any]:
    own = executed.cell
    if own.id is not None:
        cell = deepcopy(released[own.id])
    else:
        cell = {"cell_type": "code" if own.code else "markdown", "id": extra_id, "metadata": {}}
        if own.code:
            cell["execution_count"] = None
    by_student = own.kind in ("manual", "extra") and not own.code
    cell["source"] = texts.rendered(own.source) if by_student else own.source
    return cell


def _outputs(executed: ExecutedCell) -> list[dict[str, Any]]:
    outputs: list[dict[str, Any]] = []
    if executed.reply.stdout:
        outputs.append({"output_type": "stream", "name": "stdout", "text": executed.reply.stdout})
    if executed.reply.error is not None:
        kind, text = str(executed.reply.error.get("kind")), str(executed.reply.error.get("text"))
        outputs.append({"output_type": "error", "ename": kind, "evalue": text, "traceback": [f"{kind}: {text}"]})
    if executed.failure is not None:
        outputs.append({"output_type": "stream", "name": "stderr", "text": f"{executed.failure}\n"})
    return outputs


def _picture(picture: str) -> dict[str, Any]:
    shown = base64.b64decode(picture).decode()
    return {"output_type": "display_data", "data": {"image/svg+xml": shown}, "metadata": {}}
