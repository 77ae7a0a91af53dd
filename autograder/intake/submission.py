"""Read a submission: repair what can be repaired, quarantine what cannot, and report both."""

import json
import stat
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat

from autograder.course.plain_text import one_line
from autograder.intake.alignment import AmbiguousError, align_by_text
from autograder.intake.untrusted_json import read_json
from labsid.checks.cells import Template, has_work
from labsid.checks.given_lines import put_back
from labsid.checks.time_limit import NOTEBOOK_BYTES

MAX_NOTEBOOK_BYTES = NOTEBOOK_BYTES

MAX_TEXT_CHARACTERS = 10_000_000
"""Text and code of all cells; outputs and attached pictures do not count."""

VERSIONS_FILE = "versions.txt"
"""Beside a notebook: why it may not be the latest copy that was handed in; written by `collect`."""

MAX_CELLS = 5_000
"""Cells of a notebook; the longest released one has 104."""

MAX_NOTES, MAX_NOTE_CHARACTERS = 50, 500

NOT_SUBMITTED = "no notebook was submitted"
UNTOUCHED = "the notebook was handed in as it was released, without an answer"

UNTOUCHED_FILE = "as-released.txt"
"""In the folder of an assignment: its notebook was handed in as it was released, and not collected."""

NOT_READ_FILE = "not-read.txt"
"""In the folder of an assignment, or of a student: why what was handed in for it, or at all, could not be collected."""


LATE_FILE = "late.txt"
"""Beside a notebook: the learning platform called it late and gave no time; written by `collect`."""


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
        Invalid submissions are quarantined; they do not raise an error. A notebook as it was released is missing, and
        the note says so.
    """
    name = f"{template.assignment}.ipynb"
    try:
        notebook = _find_notebook(folder, template.assignment)
        if notebook is None and (why := _why_not_read(folder)):
            return quarantined_submission(student, template.assignment, why)
        if notebook is None:
            note = UNTOUCHED if is_plain_file(folder / UNTOUCHED_FILE, MAX_NOTE_CHARACTERS) else NOT_SUBMITTED
            return Submission(student, template.assignment, "missing", (), (note,))
        name, notes = notebook[0].name, notebook[1]
        if any(path.is_symlink() for path in (folder.parent, folder, notebook[0])):
            raise ValueError("it is a symbolic link, or is below one: submit the file itself")
        cells = _read_cells(notebook[0])
        notes += _note_on_versions(folder)
    except Exception as error:  # of what students hand in, no list of errors is complete
        return quarantined_submission(student, template.assignment, f"{name} cannot be read: {error}")
    if not {cell["id"] for cell in cells} & {cell.id for cell in template.cells}:
        if any(cell["id"] is not None for cell in cells):
            why = f"{name} contains no cell of {template.assignment}"
            return quarantined_submission(student, template.assignment, why)
        try:
            found_by_text = align_by_text(cells, template)
        except AmbiguousError as error:
            why = f"{name} contains no cell of {template.assignment}: {error}"
            return quarantined_submission(student, template.assignment, why)
        cells = found_by_text.cells
        notes.append(found_by_text.note)
    if not has_work(((cell["id"], cell["source"]) for cell in cells), template):
        return Submission(student, template.assignment, "missing", (), (UNTOUCHED,))
    aligned, repairs = _align_cells(cells, template)
    return Submission(student, template.assignment, "ready", aligned, _limited(notes + repairs))


def _limited(notes: list[str]) -> tuple[str, ...]:
    """Notes, shortened, and how many were left out."""
    shown = [_shortened(note) for note in notes[:MAX_NOTES]]
    return (*shown, f"and {len(notes) - MAX_NOTES} more") if len(notes) > MAX_NOTES else tuple(shown)


def _shortened(note: str) -> str:
    return note if len(note) <= MAX_NOTE_CHARACTERS else f"{note[:MAX_NOTE_CHARACTERS]} ..."


def is_untouched(content: bytes, template: Template) -> bool:
    """Whether a notebook has no answer and no cell that is not in the release; False if it cannot be read."""
    try:
        return is_as_released(cells_of(read_notebook(content)), template)
    except Exception:  # of what students hand in, no list of errors is complete
        return False


def is_as_released(cells: Sequence[Mapping[str, Any]], template: Template) -> bool:
    """Whether cells, as `cells_of` reads them, are of an assignment but have no answer and no cell of their own."""
    known = {cell.id for cell in template.cells}
    return any(cell["id"] in known for cell in cells) and not has_work(
        ((cell["id"], cell["source"]) for cell in cells), template
    )


def is_handed_in(folder: Path, template: Template) -> bool:
    """Whether a folder ``<submitted>/<student>/<assignment>`` has a notebook with an answer, or an unread one."""
    found = _find_notebook(folder, template.assignment)
    if found is None:
        return (folder / NOT_READ_FILE).is_file()
    if not is_plain_file(found[0], MAX_NOTEBOOK_BYTES):
        return True
    return not is_untouched(found[0].read_bytes(), template)


def is_plain_file(path: Path, max_bytes: int) -> bool:
    """Whether a path is a file of at most that size, not a link, a device or a pipe."""
    try:
        found = path.lstat()
    except OSError:
        return False
    return stat.S_ISREG(found.st_mode) and found.st_size <= max_bytes


def _note_on_versions(folder: Path) -> list[str]:
    """What `collect` noted on several copies of the notebook."""
    noted = _noted(folder / VERSIONS_FILE)
    return [noted] if noted else []


def _why_not_read(folder: Path) -> str:
    """Why `collect` could not read what was handed in; empty if nothing was."""
    why = _noted(folder / NOT_READ_FILE) or _noted(folder.parent / NOT_READ_FILE)
    return f"what was handed in could not be read: {why}" if why else ""


def _noted(path: Path) -> str:
    """What `collect` noted in a file; empty if there is none."""
    if not is_plain_file(path, MAX_NOTES * MAX_NOTE_CHARACTERS):
        return ""
    return one_line(path.read_text(encoding="utf-8", errors="replace"))


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
    return cells_of(read_notebook(path.read_bytes()))


def read_notebook(content: bytes) -> Any:
    """The JSON of a notebook; `ValueError` if it is not JSON or has too many parts."""
    try:
        return read_json(content.decode("utf-8-sig").encode())
    except json.JSONDecodeError as error:
        raise ValueError(f"it is not a notebook (broken JSON at line {error.lineno})") from None
    except UnicodeDecodeError:
        raise ValueError("it is not text in UTF-8") from None


def cells_of(raw: Any) -> list[dict[str, Any]]:
    """The cells of a notebook that was read from JSON: for each whether it is code, its text and its grade_id.

    Raises
    ------
    ValueError
        If it is not a notebook, or too large.
    """
    if not isinstance(raw, dict) or type(raw.get("nbformat")) is not int:
        raise ValueError("it is JSON but not a notebook")
    if raw["nbformat"] < 4:
        _refuse_many(sheet.get("cells") for sheet in _dicts(raw.get("worksheets")))
        try:
            raw = nbformat.convert(nbformat.from_dict(raw), 4)
        except Exception:  # the errors of the converter are not documented
            raise ValueError(f"it is an invalid notebook of the old format {raw['nbformat']}") from None
    cells = raw.get("cells")
    if not isinstance(cells, list):
        raise ValueError("it has no cells")
    _refuse_many([cells])
    plain = [_plain_cell(cell) for cell in _dicts(cells)]
    if sum(len(cell["source"]) for cell in plain) > MAX_TEXT_CHARACTERS:
        raise ValueError(f"its cells have more than {MAX_TEXT_CHARACTERS // 10**6} million characters of text")
    return plain


def _refuse_many(lists: Iterable[Any]) -> None:
    count = sum(len(cells) for cells in lists if isinstance(cells, list))
    if count > MAX_CELLS:
        raise ValueError(f"it has {count} cells; at most {MAX_CELLS} are graded")


def _dicts(values: Any) -> list[dict[str, Any]]:
    return [value for value in values if isinstance(value, dict)] if isinstance(values, list) else []


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
