"""Notebooks for formgrader: the student's cells with their output, and the judged figures.

formgrader shows Markdown as HTML without cleaning it, in the browser of the instructor, who is logged in. What could
run a script there is made plain text when the notebook is written.
"""

import base64
import json
import re
from collections.abc import Mapping
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any

from autograder.course.layout import Course
from autograder.judge.execution import ExecutedCell
from autograder.judge.outcome import SubmissionResult
from labsid._files import write_text

_TAG = re.compile(r"<(?=[A-Za-z/!?])")
_ENTITY = re.compile(r"&(?=[A-Za-z#])")
_BLANKS = r"[\x00-\x20]*"  # browsers ignore some of them in the name of a scheme
_SCHEME = re.compile(
    "("
    + "|".join(map(_BLANKS.join, ("javascript", "vbscript")))
    + f"|data(?={_BLANKS}:{_BLANKS}(?:text|application)/))"
    f"{_BLANKS}:",
    re.IGNORECASE,
)
_MATHJAX = re.compile(r"\\+(?=(?:href|mmlToken|require|cssId|class|style|htmlData|unicode)(?![A-Za-z]))")


def clean_markdown(text: str) -> str:
    """Markdown without HTML tags, entities, links that run a script, and macros of MathJax that write HTML.

    Blanks are inserted, so that formulas such as ``a<b`` look the same.
    """
    for pattern, replacement in ((_TAG, "< "), (_ENTITY, "& "), (_MATHJAX, ""), (_SCHEME, r"\1 :")):
        text = pattern.sub(replacement, text)
    return text


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
    for index, executed in enumerate(result.cells):
        # cells without a grade_id come from the submission, text of the course included
        cell = _as_cell(executed, released, f"extra-{index}")
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


def _as_cell(executed: ExecutedCell, released: Mapping[str, dict[str, Any]], extra_id: str) -> dict[str, Any]:
    own = executed.cell
    if own.id is not None:
        cell = deepcopy(released[own.id])
    else:
        cell = {"cell_type": "code" if own.code else "markdown", "id": extra_id, "metadata": {}}
        if own.code:
            cell["execution_count"] = None
    by_student = own.kind in ("manual", "extra") and not own.code
    cell["source"] = clean_markdown(own.source) if by_student else own.source
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
