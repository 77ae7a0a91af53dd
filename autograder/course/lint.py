"""Problems in the notebooks of a course that their author has to correct, each with what to write."""

import math
import re
from collections.abc import Iterator
from decimal import Decimal
from typing import Any

from labsid.checks.cells import HIDDEN_DELIMITERS, Cell, read_cell
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.question import Question

SOLUTION_DELIMITERS = ("### BEGIN SOLUTION", "### END SOLUTION")
METADATA = "labsid"
"""Key of the metadata of a cell that are in the notebook with solutions alone."""

STRAY_DELIMITER = re.compile(
    r"#\s*#*\s*(BEGIN|END)[ _-]*(SOLUTION|HIDDEN|MARK)|(BEGIN|END)\s+(SOL|HIDDEN|MARK)\w*", re.IGNORECASE
)
_REGION = re.compile(f"{SOLUTION_DELIMITERS[0]}(.*?){SOLUTION_DELIMITERS[1]}", re.DOTALL)
_HIDDEN_REGION = re.compile(f"{HIDDEN_DELIMITERS[0]}(.*?){HIDDEN_DELIMITERS[1]}", re.DOTALL)
_ASSERTION = re.compile(r"\bassert|\.assert")


def lint_metadata(cell: Any) -> Iterator[str]:
    """Problems in the abbreviated metadata of a cell."""
    name = f"the cell {cell.source[:30]!r}"
    unknown = set(cell.metadata) - {"nbgrader", "tags"}
    if unknown:
        yield f"{name}: unknown metadata {', '.join(sorted(unknown))}"
    if "nbgrader" not in cell.metadata:
        return
    short = cell.metadata["nbgrader"]
    if not isinstance(short, dict) or not re.fullmatch(r"[\w-]{1,64}", str(short.get("grade_id", "")), re.ASCII):
        yield f"{name}: needs a grade_id of letters, digits and hyphens, got nbgrader: {short}"
        return
    unknown = set(short) - {"grade_id", "locked", "manual", "points", "rubric", "solution", "values"}
    if unknown:
        yield f"{short['grade_id']}: unknown metadata {', '.join(sorted(unknown))}"
    points = short.get("points", 1)
    if not isinstance(points, int | float) or not 0 <= points < math.inf:
        yield f"{short['grade_id']}: points must not be negative, got {points}"
    elif not short.get("manual") and {"rubric", "values"} & set(short):
        yield f"{short['grade_id']}: only a question with manual: true has a rubric and values"
    else:
        yield from (f"{short['grade_id']}: {problem}" for problem in _lint_marking(short, points))


def _lint_marking(short: dict[str, Any], points: float) -> Iterator[str]:
    """Problems in the rubric and the values of a question that is marked by hand."""
    values = short.get("values", [])
    if not isinstance(values, list) or not all(isinstance(name, str) and name.isidentifier() for name in values):
        yield f"values must be a list of names of variables, got {values!r}"
    if "rubric" not in short:
        return
    try:
        given = [Decimal(str(one["points"])) for one in short["rubric"] if str(one["text"]).strip()]
        is_valid = bool(given) and len(given) == len(short["rubric"]) and all(one > 0 for one in given)
    except (TypeError, KeyError, ArithmeticError):
        is_valid = False
    if not is_valid:
        yield 'rubric must be a list of {"text": ..., "points": ...} with positive points'
    elif sum(given) != Decimal(str(points)):
        yield f"the points of the rubric add up to {sum(given)}, but the question has {points}"


def lint_checks(notebook: Any, assignment: str) -> Iterator[str]:
    """Differences between the questions of a notebook and the checks of its assignment, each with what to write."""
    known = [cell for cell in map(read_cell, notebook.cells) if cell is not None]
    asked = [cell.id for cell in known if cell.kind in ("question", "tests") and not _has_own_tests(cell)]
    package = assignment.replace("-", "_")
    file = f"labsid/checks/assignments/{package}/__init__.py"
    questions: tuple[Question, ...] = ()
    if assignment in assignment_names():
        try:
            loaded = load_assignment(assignment)
        except Exception as error:  # whatever its author has written wrongly
            yield f"{file} cannot be imported: {type(error).__name__}: {error}"
            return
        if loaded.name != assignment:
            yield f"{file}: ASSIGNMENT has the name {loaded.name!r}; expected {assignment!r}"
        questions = loaded.questions
        where = f"add it to the questions of ASSIGNMENT in {file}"
    else:
        where = f"write {file}, with ASSIGNMENT = Assignment({assignment!r}, (...)), and add it there"
    checked = [question.id for question in questions]
    for question in asked:
        if question not in checked:
            yield (
                f"{question}: the notebook has this question, but there is no check for it. Write "
                f'Question("{question}", judge), with a function judge(ask) that returns a Verdict: {where}'
            )
    for question in checked:
        if question not in asked:
            yield (
                f"{question}: {file} has a check for it, but the notebook has no such question. Write a code cell "
                f':nbgrader: {{grade_id: {question}, points: 1}} with check("{question}") in '
                f"notebooks/{assignment}/{assignment}.md, or delete this Question"
            )
    if sorted(asked) == sorted(checked) and asked != checked:
        yield (
            f"the checks are in a different order than the questions. Put the questions of ASSIGNMENT in {file} in the "
            f"order of the notebook: {', '.join(asked)}"
        )


def lint_source(notebook: Any) -> Iterator[str]:
    """Problems that prevent the release of a notebook."""
    seen: set[str] = set()
    for cell in notebook.cells:
        known = read_cell(cell)
        opened, closed = (cell.source.count(mark) for mark in SOLUTION_DELIMITERS)
        rest = cell.source.replace(SOLUTION_DELIMITERS[0], "").replace(SOLUTION_DELIMITERS[1], "")
        if known is not None and known.kind == "tests":
            rest = _HIDDEN_REGION.sub("", rest)
        name = known.id if known else f"the cell {cell.source[:30]!r}"
        strange = STRAY_DELIMITER.search(rest)
        if strange is not None:
            yield f"{name}: a misspelt or unknown delimiter ({strange[0]!r})"
        if len(_REGION.findall(cell.source)) != opened or opened != closed:
            yield f"{name}: {opened} BEGIN SOLUTION and {closed} END SOLUTION that do not match"
        if opened and (known is None or known.kind not in ("answer", "manual")):
            yield f"{name}: contains a solution but is not an answer cell"
        if known is None:
            continue
        if known.id in seen:
            yield f"{known.id}: the grade_id is used twice"
        seen.add(known.id)
        if known.kind == "answer" and not opened:
            yield f"{known.id}: an answer cell without a solution region"
        is_asked = known.kind in ("question", "tests") and not _has_own_tests(known)
        if is_asked and cell.source.strip() != f'check("{known.id}")':
            yield (
                f'{known.id}: a question must contain check("{known.id}") and nothing else, or assertions as the test '
                "cells of nbgrader do"
            )


def _has_own_tests(cell: Cell) -> bool:
    return cell.kind == "tests" and _ASSERTION.search(cell.source) is not None


def lint_release(release: Any, source: Any) -> Iterator[str]:
    """Solutions and hidden tests that remain in the release."""
    texts = {cell.id: cell.source for cell in release.cells}
    yield from (
        f"{cell.id}: the release still contains its rubric" for cell in release.cells if METADATA in cell.metadata
    )
    for cell in source.cells:
        known = read_cell(cell)
        if known is None or known.kind not in ("answer", "manual", "tests"):
            continue
        if known.kind == "manual":
            leaked = [cell.source]
        elif known.kind == "tests":
            leaked = [*HIDDEN_DELIMITERS, *_lines_inside(_HIDDEN_REGION, cell.source)]
        else:
            leaked = _lines_inside(_REGION, cell.source)
        for line in leaked:
            if line in texts.get(known.id, ""):
                what = "hidden test" if known.kind == "tests" else "solution"
                yield f"{known.id}: the release still contains the {what} line {line[:40]!r}"


def _lines_inside(region: re.Pattern[str], source: str) -> list[str]:
    """The longer lines of the regions of a cell that do not stand outside of them, too."""
    outside = region.sub("", source)
    lines = [line.strip() for inside in region.findall(source) for line in inside.splitlines()]
    return [line for line in lines if len(line) > 12 and line not in outside]
