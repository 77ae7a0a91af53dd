"""Build the course: text notebooks to source notebooks to release, with checks at each stage.

The MyST text contains abbreviated nbgrader metadata. The build completes it, uses each grade_id as cell id, so that two
builds are equal byte for byte, and generates the release with nbgrader.
"""

import logging
import math
import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import jupytext
import nbformat
from jupytext.myst import MystMetadataParsingError

from autograder.course.layout import Course, read_template
from autograder.course.nbgrader_access import COURSE_ID, import_nbgrader_api
from autograder.course.own_secret import shared_file
from labsid._files import write_file, write_text
from labsid.checks.cells import CODE_STUB, HIDDEN_DELIMITERS, TEXT_STUB, read_cell
from labsid.checks.notebook import assignment_names, find_assignment, load_assignment, marks_text
from labsid.checks.notebook_file import START_PAGE
from labsid.checks.question import Question
from labsid.hand_in.start_page import DATA_BESIDE, start_notebook

SOLUTION_DELIMITERS = ("### BEGIN SOLUTION", "### END SOLUTION")
STRAY_DELIMITER = re.compile(
    r"#\s*#*\s*(BEGIN|END)[ _-]*(SOLUTION|HIDDEN|MARK)|(BEGIN|END)\s+(SOL|HIDDEN|MARK)\w*", re.IGNORECASE
)
_REGION = re.compile(f"{SOLUTION_DELIMITERS[0]}(.*?){SOLUTION_DELIMITERS[1]}", re.DOTALL)
_HIDDEN_REGION = re.compile(f"{HIDDEN_DELIMITERS[0]}(.*?){HIDDEN_DELIMITERS[1]}", re.DOTALL)
_ASSERTION = re.compile(r"\bassert|\.assert")

_METADATA_OF_NBGRADER = ("cell_type", "checksum", "grade", "locked", "points", "schema_version", "solution", "task")
_METADATA_OF_JUPYTER = ("collapsed", "deletable", "editable", "jupyter", "scrolled", "slideshow", "trusted")

GO_ON_TAG = "raises-exception"
"""Jupyter's tag of a cell after which the others are run even if it fails."""


def build_course(course: Course) -> Iterator[str]:
    """Build every assignment; yields the name of each one built.

    Raises
    ------
    ValueError
        If a text notebook cannot be released; no source notebook is written then.
    """
    names = course.assignments()
    if not names:
        raise ValueError(f"no assignments in {course.notebooks}: expected <name>/<name>.md.")
    built = {name: build_source(course.notebooks / name / f"{name}.md") for name in names}
    for name, notebook in built.items():
        _write_notebook(notebook, course.source / name / f"{name}.ipynb")
    yield from build_releases(course, names)
    templates = [read_template(course, name) for name in names]
    write_file(course.release / START_PAGE, start_notebook(templates, {}, DATA_BESIDE))


def build_source(path: Path) -> Any:
    """Convert a text notebook into a source notebook for nbgrader; `ValueError` lists its problems."""
    try:
        notebook = jupytext.read(path, fmt="md:myst")
    except MystMetadataParsingError as error:
        raise ValueError(f"{path} cannot be released: {error}") from None
    for cell in notebook.cells:
        _abbreviate_metadata(cell)
    problems = [problem for cell in notebook.cells for problem in lint_metadata(cell)]
    if problems:
        raise ValueError(f"{path} cannot be released: " + "; ".join(problems))
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for index, cell in enumerate(notebook.cells):
        short = cell.metadata.pop("nbgrader", None)
        kept = {key: value for key, value in cell.metadata.items() if key == "tags"}
        if short is not None:
            kept["nbgrader"] = nbgrader_metadata(short, cell.cell_type)
        cell.metadata = kept
        cell.id = str(short["grade_id"]) if short else f"{path.stem[:24]}-{index}"
    problems = [*lint_source(notebook), *lint_checks(notebook, path.stem)]
    if problems:
        raise ValueError(f"{path} cannot be released: " + "; ".join(problems))
    _write_marks(notebook)
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    return notebook


def _write_marks(notebook: Any) -> None:
    """Write the marks of each question beside its check, and under the text of one that is marked by hand."""
    for above, cell in zip([None, *notebook.cells], notebook.cells, strict=False):
        known = read_cell(cell)
        if known is not None and known.kind == "question":
            cell.source = f"{cell.source.strip()}  # {marks_text(known.points)}"
        elif known is not None and known.kind == "tests":
            cell.source = f"{cell.source.rstrip()}\n# {marks_text(known.points)}"
        elif known is not None and known.kind == "manual" and above is not None and above.cell_type == "markdown":
            above.source = f"{above.source.rstrip()}\n\n*({marks_text(known.points)}, marked by hand)*"


def _abbreviate_metadata(cell: Any) -> None:
    """Abbreviate metadata that nbgrader wrote, as in a notebook of an existing course, and drop those of Jupyter."""
    for name in _METADATA_OF_JUPYTER:
        cell.metadata.pop(name, None)
    full = cell.metadata.get("nbgrader")
    if not isinstance(full, dict) or "grade" not in full:
        return
    short = {key: value for key, value in full.items() if key not in _METADATA_OF_NBGRADER}
    short |= {key: True for key in ("locked", "task") if full.get(key)}
    if full["grade"]:
        short |= {"points": full.get("points", 0), **({"manual": True} if full.get("solution") else {})}
    elif full.get("solution"):
        short["solution"] = True
    cell.metadata["nbgrader"] = short


def nbgrader_metadata(short: dict[str, Any], cell_type: str) -> dict[str, Any]:
    """Complete the abbreviated metadata of a cell.

    ``solution`` marks an answer cell, ``points`` a question graded automatically, ``points`` with ``manual`` a question
    graded by hand, and ``locked`` a given cell.
    """
    manual = bool(short.get("manual"))
    points = short.get("points")
    full = {
        "grade": points is not None,
        "grade_id": str(short["grade_id"]),
        "locked": (points is not None and not manual) or bool(short.get("locked")),
        "schema_version": 3,
        "solution": bool(short.get("solution")) or manual,
        "task": False,
        "cell_type": cell_type,
    }
    if points is not None:
        full["points"] = float(points)
    return full


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
    unknown = set(short) - {"grade_id", "locked", "manual", "points", "solution"}
    if unknown:
        yield f"{short['grade_id']}: unknown metadata {', '.join(sorted(unknown))}"
    points = short.get("points", 1)
    if not isinstance(points, int | float) or not 0 < points < math.inf:
        yield f"{short['grade_id']}: points must be positive, got {points}"


def lint_checks(notebook: Any, assignment: str) -> Iterator[str]:
    """Differences between the questions of a notebook and the checks of its assignment, each with what to write."""
    known = [read_cell(cell) for cell in notebook.cells]
    asked = [cell.id for cell in known if cell is not None and cell.kind == "question"]
    package = assignment.replace("-", "_")
    file = f"labsid/checks/assignments/{package}/__init__.py"
    questions: tuple[Question, ...] = ()
    if assignment in assignment_names():
        try:
            found = load_assignment(assignment)
        except Exception as error:  # whatever its author has written wrongly
            yield f"{file} cannot be imported: {type(error).__name__}: {error}"
            return
        if found.name != assignment:
            yield f"{file}: ASSIGNMENT has the name {found.name!r}; expected {assignment!r}"
        questions = found.questions
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
        is_tests = known is not None and known.kind == "tests"
        if is_tests:
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
        is_check = cell.source.strip() == f'check("{known.id}")'
        if (known.kind == "question" and not is_check) or (is_tests and not _ASSERTION.search(cell.source)):
            yield (
                f'{known.id}: a question must contain check("{known.id}") and nothing else, or assertions as the test '
                "cells of nbgrader do"
            )


def build_releases(course: Course, names: Sequence[str]) -> Iterator[str]:
    """Generate the release notebooks with nbgrader and check them; yields the name of each one."""
    with tempfile.TemporaryDirectory(prefix="labsid-") as scratch:
        for name in names:
            notebook = _generate(course, name, Path(scratch))
            _keep_running(notebook)
            source = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
            problems = list(lint_release(notebook, source))
            if problems:
                raise ValueError(f"{name} cannot be released: " + "; ".join(problems))
            _write_notebook(notebook, course.release / name / f"{name}.ipynb")
            data = find_assignment(name).record_file
            if data is not None:
                shutil.copyfile(shared_file(course, data), course.release / name / data)
            yield name


def _generate(course: Course, name: str, scratch: Path) -> Any:
    import_nbgrader_api()
    from nbgrader.converters import GenerateAssignment
    from nbgrader.converters.base import NbGraderException
    from nbgrader.coursedir import CourseDirectory
    from traitlets.config import Config

    config = Config()
    config.CourseDirectory.root = str(course.root / "autograder")
    config.CourseDirectory.course_id = COURSE_ID
    config.CourseDirectory.assignment_id = name
    config.CourseDirectory.db_url = f"sqlite:///{scratch / 'gradebook.db'}"
    config.CourseDirectory.release_directory = str(scratch / "release")
    config.ClearSolutions.code_stub = {"python": CODE_STUB}
    config.ClearSolutions.text_stub = TEXT_STUB
    converter = GenerateAssignment(coursedir=CourseDirectory(config=config), config=config)
    converter.log = logging.getLogger("labsid.build")
    converter.log.setLevel(logging.ERROR)
    try:
        converter.start()
    except NbGraderException as error:
        raise ValueError(f"{name} cannot be released: {error}") from error
    return nbformat.read(scratch / "release" / "." / name / f"{name}.ipynb", as_version=4)


def _keep_running(notebook: Any) -> None:
    """Let "Run all" go on after a cell with an error, as grading does: of the release alone, which is unfinished."""
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.metadata["tags"] = [*cell.metadata.get("tags", ()), GO_ON_TAG]


def lint_release(release: Any, source: Any) -> Iterator[str]:
    """Solutions and hidden tests that remain in the release."""
    texts = {cell.id: cell.source for cell in release.cells}
    for cell in source.cells:
        known = read_cell(cell)
        if known is None or known.kind not in ("answer", "manual", "tests"):
            continue
        if known.kind == "manual":
            leaked = [cell.source]
        elif known.kind == "tests":
            leaked = _lines_inside(_HIDDEN_REGION, cell.source)
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


def _write_notebook(notebook: Any, path: Path) -> None:
    text = nbformat.writes(notebook, version=4)
    write_text(path, text if text.endswith("\n") else text + "\n")
