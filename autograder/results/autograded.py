"""The notebooks that formgrader shows: the student's cells with what they printed, and pictures of what was judged."""

import base64
import json
from collections.abc import Mapping
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any

from autograder.course.layout import Course
from autograder.judge.execution import ExecutedCell
from autograder.judge.outcome import SubmissionResult
from labsid._files import write_text


def write_autograded(course: Course, out: Path, result: SubmissionResult) -> None:
    """Write ``OUT/autograded/<student>/<assignment>/<assignment>.ipynb``; nothing where there was nothing to grade."""
    if not result.ran:
        return
    name = result.assignment
    path = course.release / name / f"{name}.ipynb"
    notebook = _released(path, path.stat().st_mtime_ns)
    released = {cell["id"]: cell for cell in notebook["cells"]}
    pictures = {question.question: question.figures for question in result.results}
    cells: list[dict[str, Any]] = []
    for index, ran in enumerate(result.ran):
        # cells without a grade_id are the hand-in's own, the course's text among them
        cell = _as_cell(ran, released, f"extra-{index}")
        if ran.step.code:
            cell["outputs"] = [*_outputs(ran), *map(_picture, pictures.get(ran.step.id or "", ()))]
        cells.append(cell)
    target = out / "autograded" / result.student / name / f"{name}.ipynb"
    write_text(target, json.dumps({**notebook, "cells": cells}, indent=1, ensure_ascii=False) + "\n")


@lru_cache(maxsize=32)
def _released(path: Path, changed: int) -> dict[str, Any]:
    """The released notebook as plain JSON, read once as long as it does not change."""
    read: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return read


def _as_cell(ran: ExecutedCell, released: Mapping[str, dict[str, Any]], extra_id: str) -> dict[str, Any]:
    step = ran.step
    if step.id is not None:
        cell = deepcopy(released[step.id])
    else:
        cell = {"cell_type": "code" if step.code else "markdown", "id": extra_id, "metadata": {}}
        if step.code:
            cell["execution_count"] = None
    cell["source"] = step.source
    return cell


def _outputs(ran: ExecutedCell) -> list[dict[str, Any]]:
    made: list[dict[str, Any]] = []
    if ran.reply.stdout:
        made.append({"output_type": "stream", "name": "stdout", "text": ran.reply.stdout})
    if ran.reply.error is not None:
        kind, text = str(ran.reply.error.get("kind")), str(ran.reply.error.get("text"))
        made.append({"output_type": "error", "ename": kind, "evalue": text, "traceback": [f"{kind}: {text}"]})
    if ran.death is not None:
        made.append({"output_type": "stream", "name": "stderr", "text": f"{ran.death}\n"})
    return made


def _picture(picture: str) -> dict[str, Any]:
    shown = base64.b64decode(picture).decode()
    return {"output_type": "display_data", "data": {"image/svg+xml": shown}, "metadata": {}}
