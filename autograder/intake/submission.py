"""Taking in a submission: mend what can be mended, quarantine what cannot, and say which."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat

from autograder.course.layout import Template
from autograder.intake.untrusted_json import read_json

MAX_NOTEBOOK_BYTES = 50 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class NotebookCell:
    """One cell to go through while grading.

    Attributes
    ----------
    id : str or None
        The grade_id; None for a cell that the student added.
    kind : {"given", "demonstration", "answer", "question", "manual", "extra"}
    source : str
        The course's text for given cells and questions, the student's for the rest.
    code : bool
        Whether it is a code cell.
    """

    id: str | None
    kind: str
    source: str
    code: bool


@dataclass(frozen=True, slots=True)
class Submission:
    """A submission as it goes to the judge.

    Attributes
    ----------
    student, assignment : str
    status : {"ready", "missing", "quarantined"}
    cells : tuple of NotebookCell
        Empty unless ready.
    notes : tuple of str
        What was mended, or why it is quarantined.
    """

    student: str
    assignment: str
    status: str
    cells: tuple[NotebookCell, ...]
    notes: tuple[str, ...]


def read_submission(folder: Path, student: str, template: Template) -> Submission:
    """Read a student's hand-in folder for one assignment.

    Parameters
    ----------
    folder : Path
        ``<submitted>/<student>/<assignment>``; need not exist.
    student : str
    template : Template
        The released assignment.

    Returns
    -------
    Submission
        Never raises for anything that a student can hand in.
    """

    name = f"{template.assignment}.ipynb"
    try:
        found = _find_notebook(folder, template.assignment)
        if found is None:
            return Submission(student, template.assignment, "missing", (), ("no notebook was handed in",))
        name, notes = found[0].name, found[1]
        if any(path.is_symlink() for path in (folder.parent, folder, found[0])):
            raise ValueError("it is a link, or lies below one: hand in the file itself")
        cells = _read_cells(found[0])
    except (ValueError, OSError, RecursionError, MemoryError) as error:
        return quarantined_submission(student, template.assignment, f"{name} cannot be read: {error}")
    if not {cell["id"] for cell in cells} & {cell.id for cell in template.cells}:
        return quarantined_submission(
            student, template.assignment, f"{name} has none of the cells of {template.assignment}"
        )
    steps, mended = _align_cells(cells, template)
    return Submission(student, template.assignment, "ready", steps, tuple(notes + mended))


def quarantined_submission(student: str, assignment: str, why: str) -> Submission:
    """A submission that cannot be graded, with the reason."""
    return Submission(student, assignment, "quarantined", (), (why,))


def _find_notebook(folder: Path, assignment: str) -> tuple[Path, list[str]] | None:
    expected = folder / f"{assignment}.ipynb"
    if expected.is_file():
        return expected, []
    others = sorted(path for path in folder.glob("*.ipynb") if path.is_file())
    if not others:
        return None
    closest = min(others, key=lambda path: (assignment not in path.name, path.name))
    return closest, [f"{closest.name} was taken for {expected.name}"]


def _read_cells(path: Path) -> list[dict[str, Any]]:
    if path.stat().st_size > MAX_NOTEBOOK_BYTES:
        raise ValueError(f"it is larger than {MAX_NOTEBOOK_BYTES // 2**20} MiB")
    try:
        raw = read_json(path.read_bytes().decode("utf-8-sig").encode())
    except json.JSONDecodeError as error:
        raise ValueError(f"it is not a notebook (broken JSON at line {error.lineno})") from None
    except UnicodeDecodeError:
        raise ValueError("it is not text in UTF-8") from None
    if not isinstance(raw, dict) or type(raw.get("nbformat")) is not int:
        raise ValueError("it is JSON, but not a notebook")
    if raw["nbformat"] < 4:
        try:
            raw = nbformat.convert(nbformat.from_dict(raw), 4)
        except Exception:  # what the converter raises for a broken notebook is not documented, and is of many kinds
            raise ValueError(f"it is a broken notebook of the old format {raw['nbformat']}") from None
    cells = raw.get("cells")
    if not isinstance(cells, list):
        raise ValueError("it has no cells")
    return [_plain_cell(cell) for cell in cells if isinstance(cell, dict)]


def _plain_cell(cell: dict[str, Any]) -> dict[str, Any]:
    """Keep what grading needs of a cell, each part of the kind that it should be."""
    source = cell.get("source", "")
    if isinstance(source, list):
        source = "".join(part for part in source if isinstance(part, str))
    meta = cell.get("metadata")
    nbgrader = meta.get("nbgrader") if isinstance(meta, dict) else None
    grade_id = nbgrader.get("grade_id") if isinstance(nbgrader, dict) else None
    return {
        "code": cell.get("cell_type") == "code",
        "source": source if isinstance(source, str) else "",
        "id": grade_id if isinstance(grade_id, str) else None,
    }


def _align_cells(cells: list[dict[str, Any]], template: Template) -> tuple[tuple[NotebookCell, ...], list[str]]:
    """The template's cells in its order, filled with the student's answers, and the cells that the student added."""
    released = {cell.id: cell.source.strip() for cell in template.cells}
    answers: dict[str, str] = {}
    extras: dict[str | None, list[NotebookCell]] = {}
    notes: list[str] = []
    own = {cell.id for cell in template.cells if cell.kind in ("answer", "manual")}
    anchor: str | None = None
    for cell in cells:
        grade_id, source = cell["id"], cell["source"]
        if grade_id in released and grade_id not in answers:
            answers[grade_id] = source
            anchor = grade_id
            continue
        if grade_id in released:
            # of two cells with one id, the one that was worked in counts; a second one with work in it is an extra
            if source.strip() in (released[grade_id], answers[grade_id].strip()):
                notes.append(f"the cell {grade_id} is there twice")
                continue
            if grade_id in own and answers[grade_id].strip() == released[grade_id]:
                notes.append(f"the cell {grade_id} is there twice: the one with work in it was graded")
                answers[grade_id] = source
                continue
            notes.append(f"the cell {grade_id} is there twice: both were kept")
        extras.setdefault(anchor, []).append(NotebookCell(None, "extra", source, cell["code"]))
    steps = list(extras.get(None, []))
    for wanted in template.cells:
        if wanted.id not in answers and wanted.id in own:
            notes.append(f"the cell {wanted.id} was missing: it counts as not answered")
        elif wanted.id not in answers or (wanted.id not in own and answers[wanted.id].strip() != released[wanted.id]):
            notes.append(f"the cell {wanted.id} was put back as released")
        source = answers.get(wanted.id, "") if wanted.id in own else wanted.source
        steps.append(NotebookCell(wanted.id, wanted.kind, source, wanted.code))
        steps.extend(extras.get(wanted.id, []))
    return tuple(steps), notes
