"""Build the course: text notebooks to source notebooks to release, with checks at each stage.

The MyST text contains abbreviated nbgrader metadata. The build completes it, uses each grade_id as cell id, so that two
builds are equal byte for byte, and generates the release with nbgrader.
"""

import logging
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import jupytext
import nbformat
from jupytext.myst import MystMetadataParsingError

from autograder.course.layout import Course, read_template
from autograder.course.lint import METADATA, lint_checks, lint_metadata, lint_release, lint_source
from autograder.course.nbgrader_access import COURSE_ID, import_nbgrader_api, without_disk_sync
from autograder.course.own_rig import OwnRig
from autograder.course.own_secret import shared_file
from autograder.course.rig_check import check_rig
from autograder.course.rig_texts import RigWords, read_for_rig, rig_words
from autograder.course.settings import read_settings
from labsid._files import write_file, write_text
from labsid.checks.cells import CODE_STUB, TEXT_STUB, read_cell
from labsid.checks.notebook import find_assignment, marks_text
from labsid.checks.notebook_file import START_PAGE
from labsid.checks.question import PEN
from labsid.hand_in.start_page import DATA_BESIDE, start_notebook

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
    settings = read_settings(course)
    rig = settings.rig
    words = None if rig is None else _words_of(rig)
    built = {name: build_source(course.notebooks / name / f"{name}.md", words) for name in names}
    for name, notebook in built.items():
        _write_notebook(notebook, course.source / name / f"{name}.ipynb")
    yield from build_releases(course, names)
    templates = [read_template(course, name) for name in names]
    write_file(course.release / START_PAGE, start_notebook(templates, {}, DATA_BESIDE, title=settings.title))


def _words_of(rig: OwnRig) -> RigWords:
    """What the notebooks say of the course's own rig; `ValueError` if its record does not carry the lab."""
    checked = check_rig(rig.record, rig.reading, rig.simulated)
    if not checked.carries:
        raise ValueError(f"[rig]: {rig.record.name} {checked.verdict}. labsid course rig says what to record instead.")
    return rig_words(rig)


def build_source(path: Path, words: RigWords | None = None) -> Any:
    """Convert a text notebook into a source notebook for nbgrader; `ValueError` lists its problems.

    Parameters
    ----------
    path : Path
    words : RigWords, optional
        Of the course's own rig; default the tanks.
    """
    try:
        notebook = jupytext.read(path, fmt="md:myst") if words is None else read_for_rig(path, words)
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
            kept |= (
                {METADATA: own} if (own := {key: short[key] for key in ("rubric", "values") if key in short}) else {}
            )
        cell.metadata = kept
        cell.id = str(short["grade_id"]) if short else f"{path.stem[:24]}-{index}"
    problems = [*lint_source(notebook), *lint_checks(notebook, path.stem)]
    if problems:
        raise ValueError(f"{path} cannot be released: " + "; ".join(problems))
    _write_marks(notebook, path.stem)
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    return notebook


def _write_marks(notebook: Any, name: str) -> None:
    """Write the marks of each question beside its check, and under the text of one that is marked by hand.

    The pen stands beside those of the questions at which a typed-in value counts.
    """
    typed = {question.id for question in find_assignment(name).questions if question.follows_from.may_be_typed}
    for above, cell in zip([None, *notebook.cells], notebook.cells, strict=False):
        known = read_cell(cell)
        if known is not None and known.kind == "question":
            pen = f" {PEN}" if known.id in typed else ""
            cell.source = f"{cell.source.strip()}  # {marks_text(known.points)}{pen}"
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


def build_releases(course: Course, names: Sequence[str]) -> Iterator[str]:
    """Generate the release notebooks with nbgrader and check them; yields the name of each one."""
    with tempfile.TemporaryDirectory(prefix="labsid-") as scratch:
        for name in names:
            notebook = _generate(course, name, Path(scratch))
            _finish_release(notebook)
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
        with without_disk_sync():  # a build throws its database away
            converter.start()
    except NbGraderException as error:
        raise ValueError(f"{name} cannot be released: {error}") from error
    return nbformat.read(scratch / "release" / "." / name / f"{name}.ipynb", as_version=4)


def _finish_release(notebook: Any) -> None:
    """Remove the rubrics, and let "Run all" go on after a cell with an error, as grading does."""
    for cell in notebook.cells:
        cell.metadata.pop(METADATA, None)
        if cell.cell_type == "code":
            cell.metadata["tags"] = [*cell.metadata.get("tags", ()), GO_ON_TAG]


def _write_notebook(notebook: Any, path: Path) -> None:
    text = nbformat.writes(notebook, version=4)
    write_text(path, text if text.endswith("\n") else text + "\n")
