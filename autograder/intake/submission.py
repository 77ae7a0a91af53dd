"""Read a submission: repair what can be repaired, quarantine what cannot, and report both."""

import json
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat

from autograder.intake.untrusted_json import read_json
from labsid.checks.cells import Template, has_work
from labsid.checks.given_lines import put_back

MAX_NOTEBOOK_BYTES = 50 * 1024 * 1024

MAX_TEXT_CHARACTERS = 10_000_000
"""Text and code of all cells; outputs and attached pictures do not count."""


UNTOUCHED = "the notebook is as it was released: no answer was submitted"


@dataclass(frozen=True, slots=True)
class NotebookCell:
    """One cell to execute or judge.

    Attributes
    ----------
    id : str or None
        The grade_id; None for a cell added by the student.
    kind : {"given", "demonstration", "answer", "question", "tests", "manual", "extra"}
    source : str
        The released text of given cells and questions, the student's text of all others.
    code : bool
        Whether it is a code cell.
    """

    id: str | None
    kind: str
    source: str
    code: bool


@dataclass(frozen=True, slots=True)
class Submission:
    """A submission as it is judged.

    Attributes
    ----------
    student, assignment : str
    status : {"ready", "missing", "quarantined"}
    cells : tuple of NotebookCell
        Empty unless the status is ready.
    notes : tuple of str
        What was repaired, or why it is quarantined.
    """

    student: str
    assignment: str
    status: str
    cells: tuple[NotebookCell, ...]
    notes: tuple[str, ...]


def read_submission(folder: Path, student: str, template: Template) -> Submission:
    """Read a student's submission of one assignment.

    Parameters
    ----------
    folder : Path
        ``<submitted>/<student>/<assignment>``; may be missing.
    student : str
    template : Template
        The released assignment.

    Returns
    -------
    Submission
        Invalid submissions are quarantined; they do not raise an error. A notebook as it was released is missing.
    """
    name = f"{template.assignment}.ipynb"
    try:
        found = _find_notebook(folder, template.assignment)
        if found is None:
            return Submission(student, template.assignment, "missing", (), ("no notebook was submitted",))
        name, notes = found[0].name, found[1]
        if any(path.is_symlink() for path in (folder.parent, folder, found[0])):
            raise ValueError("it is a symbolic link, or is below one: submit the file itself")
        cells = _read_cells(found[0])
    except (ValueError, OSError, RecursionError, MemoryError) as error:
        return quarantined_submission(student, template.assignment, f"{name} cannot be read: {error}")
    if not {cell["id"] for cell in cells} & {cell.id for cell in template.cells}:
        return quarantined_submission(student, template.assignment, f"{name} contains no cell of {template.assignment}")
    if not has_work(((cell["id"], cell["source"]) for cell in cells), template):
        return Submission(student, template.assignment, "missing", (), (UNTOUCHED,))
    aligned, repairs = _align_cells(cells, template)
    return Submission(student, template.assignment, "ready", aligned, tuple(notes + repairs))


def is_untouched(content: bytes, template: Template) -> bool:
    """Whether a notebook has no answer and no cell that is not in the release; False if it cannot be read."""
    try:
        cells = _parse_cells(content)
    except (ValueError, RecursionError, MemoryError):
        return False
    known = {cell.id for cell in template.cells}
    return any(cell["id"] in known for cell in cells) and not has_work(
        ((cell["id"], cell["source"]) for cell in cells), template
    )


def is_handed_in(folder: Path, template: Template) -> bool:
    """Whether a folder ``<submitted>/<student>/<assignment>`` contains a notebook that is not as released."""
    found = _find_notebook(folder, template.assignment)
    if found is None or not is_plain_file(found[0], MAX_NOTEBOOK_BYTES):
        return found is not None
    return not is_untouched(found[0].read_bytes(), template)


def is_plain_file(path: Path, max_bytes: int) -> bool:
    """Whether a path is a file of at most that size, not a link, a device or a pipe."""
    try:
        found = path.lstat()
    except OSError:
        return False
    return stat.S_ISREG(found.st_mode) and found.st_size <= max_bytes


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
    return closest, [f"{closest.name} was graded as {expected.name}"]


def _read_cells(path: Path) -> list[dict[str, Any]]:
    if path.stat().st_size > MAX_NOTEBOOK_BYTES:
        raise ValueError(f"it is larger than {MAX_NOTEBOOK_BYTES // 2**20} MiB")
    return _parse_cells(path.read_bytes())


def _parse_cells(content: bytes) -> list[dict[str, Any]]:
    try:
        raw = read_json(content.decode("utf-8-sig").encode())
    except json.JSONDecodeError as error:
        raise ValueError(f"it is not a notebook (broken JSON at line {error.lineno})") from None
    except UnicodeDecodeError:
        raise ValueError("it is not text in UTF-8") from None
    if not isinstance(raw, dict) or type(raw.get("nbformat")) is not int:
        raise ValueError("it is JSON but not a notebook")
    if raw["nbformat"] < 4:
        try:
            raw = nbformat.convert(nbformat.from_dict(raw), 4)
        except Exception:  # the errors of the converter are not documented
            raise ValueError(f"it is an invalid notebook of the old format {raw['nbformat']}") from None
    cells = raw.get("cells")
    if not isinstance(cells, list):
        raise ValueError("it has no cells")
    plain = [_plain_cell(cell) for cell in cells if isinstance(cell, dict)]
    if sum(len(cell["source"]) for cell in plain) > MAX_TEXT_CHARACTERS:
        raise ValueError(f"its cells have more than {MAX_TEXT_CHARACTERS // 10**6} million characters of text")
    return plain


def _plain_cell(cell: dict[str, Any]) -> dict[str, Any]:
    """The parts of a cell that grading needs, with values of the right type."""
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
    """Put the student's answers and added cells into the order of the template; also returns notes on repairs."""
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
            # of two cells with the same id, the edited one counts; a second edited one is kept as an added cell
            if source.strip() in (released[grade_id], answers[grade_id].strip()):
                notes.append(f"the cell {grade_id} is duplicated")
                continue
            if grade_id in own and answers[grade_id].strip() == released[grade_id]:
                notes.append(f"the cell {grade_id} is duplicated: the edited one was graded")
                answers[grade_id] = source
                continue
            notes.append(f"the cell {grade_id} is duplicated: both were kept")
        extras.setdefault(anchor, []).append(NotebookCell(None, "extra", source, cell["code"]))
    aligned = list(extras.get(None, []))
    for wanted in template.cells:
        if wanted.id not in answers and wanted.id in own:
            notes.append(f"the cell {wanted.id} is missing: it counts as not answered")
        elif wanted.id not in answers or (wanted.id not in own and answers[wanted.id].strip() != released[wanted.id]):
            notes.append(f"the cell {wanted.id} was restored to the released version")
        source = answers.get(wanted.id, "") if wanted.id in own else wanted.source
        if wanted.kind == "answer" and wanted.code:
            source, given = put_back(wanted.source, source)
            if given:
                notes.append(f"given lines of the cell {wanted.id} were put back: {'; '.join(given)}")
        aligned.append(NotebookCell(wanted.id, wanted.kind, source, wanted.code))
        aligned.extend(extras.get(wanted.id, []))
    return tuple(aligned), notes
