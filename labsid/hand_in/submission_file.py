"""The file to hand in: notebooks examined in a clean run, and packed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from labsid._files import write_file, zip_bytes
from labsid.checks.kept_tries import MAX_BYTES, read_tries, tries_file_name
from labsid.checks.notebook import assignment_names, find_assignment
from labsid.checks.summary import FAILED, NOT_DONE, SIGNS, SKIPPED, summary_text
from labsid.hand_in.clean_run import CleanRun, run_from_clean_start
from labsid.hand_in.long_outputs import packed_notebook
from labsid.hand_in.saved_work import SavedNotebook, notebook_paths, read_saved
from labsid.hand_in.second_record import confirmed_on_another_record

_MAX_RECORD_BYTES = 16 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class WorkFound:
    """The notebooks of a work folder.

    Attributes
    ----------
    to_hand_in, untouched : tuple of SavedNotebook
    remarks : tuple of str
        On files that are not included.
    unreadable : mapping
        Why a notebook cannot be handed in, by its assignment.
    """

    to_hand_in: tuple[SavedNotebook, ...]
    untouched: tuple[SavedNotebook, ...]
    remarks: tuple[str, ...]
    unreadable: Mapping[str, str] = field(default_factory=dict)


def find_work(folder: Path, assignment: str | None = None) -> WorkFound:
    """Find the notebooks to hand in.

    Parameters
    ----------
    folder : Path
        The work folder.
    assignment : str, optional
        Only this assignment.

    Returns
    -------
    WorkFound

    Raises
    ------
    ValueError
        If there is no such notebook, or each one cannot be read or is as it was released.
    """
    paths = [path for path in notebook_paths(folder) if assignment in (None, path.parent.name)]
    notebooks: list[SavedNotebook] = []
    unreadable: dict[str, str] = {}
    for path in (path for path in paths if path.stem == path.parent.name):
        try:
            notebooks.append(read_saved(path))
        except ValueError as error:
            unreadable[path.stem] = str(error)
    if not notebooks and not unreadable:
        expected = f"{assignment}/{assignment}.ipynb" if assignment else "<assignment>/<assignment>.ipynb"
        raise ValueError(f"{folder} contains no notebooks. Expected {expected} below it.")
    remarks = tuple(
        f"{path.parent.name}/{path.name} is not included: the notebook of this folder is {path.parent.name}.ipynb"
        for path in paths
        if path.stem != path.parent.name
    )
    begun = tuple(notebook for notebook in notebooks if not notebook.is_untouched)
    if not begun and unreadable:
        raise ValueError(f"there is nothing to hand in: {' '.join(unreadable.values())}")
    if not begun:
        names = ", ".join(notebook.name for notebook in notebooks)
        raise ValueError(f"there is nothing to hand in: {names} as released, without an answer. Save your notebooks.")
    return WorkFound(begun, tuple(notebook for notebook in notebooks if notebook.is_untouched), remarks, unreadable)


def run_notebook(notebook: SavedNotebook) -> CleanRun | None:
    """Run a notebook from a clean start, on its own record and on another one; None if its assignment has no checks."""
    if notebook.name not in assignment_names() and all(cell.kind != "tests" for cell in notebook.template.cells):
        return None
    first = run_from_clean_start(notebook.cells, notebook.template, notebook.path)
    return confirmed_on_another_record(first, notebook.cells, notebook.template, notebook.path)


def run_text(notebook: SavedNotebook, run: CleanRun | None) -> Iterator[str]:
    """The lines on a clean run: the table of marks, the reason of each question that is not right, and remarks."""
    if run is None:
        yield f"{notebook.name}: it has no checks, so it was not run."
        return
    yield summary_text(f"{notebook.name}, run from a clean start:", run.states)
    for one in run.states:
        if one.state == FAILED:
            yield f"{SIGNS[FAILED]} {run.reasons.get(one.question.id, one.question.id)}"
    yield from run.remarks


def open_questions(runs: Sequence[CleanRun | None]) -> int:
    """The number of questions that are not right, skipped or not done."""
    states = [one.state for run in runs if run is not None for one in run.states]
    return sum(state in (FAILED, SKIPPED, NOT_DONE) for state in states)


def tries_to_send(notebooks: Sequence[SavedNotebook]) -> dict[str, bytes]:
    """The tries that a student has kept beside notebooks.

    Parameters
    ----------
    notebooks : sequence of SavedNotebook

    Returns
    -------
    dict
        The content of each file by its path in the hand-in, without files that have no tries or cannot be read.
    """
    contents: dict[str, bytes] = {}
    for notebook in notebooks:
        path = notebook.path.with_name(tries_file_name(notebook.name))
        try:
            with path.open("rb") as file:
                content = file.read(MAX_BYTES + 1)
            if read_tries(content):
                contents[f"{notebook.name}/{path.name}"] = content
        except (OSError, ValueError):  # there is none, or it was damaged
            continue
    return contents


def pack(notebooks: Sequence[SavedNotebook], out: Path, tries: Mapping[str, bytes] | None = None) -> list[str]:
    """Write the zip file of `zipped` atomically; returns what is not in it as it is saved."""
    content, remarks = zipped(notebooks, tries)
    write_file(out, content)
    return remarks


def zipped(notebooks: Sequence[SavedNotebook], tries: Mapping[str, bytes] | None = None) -> tuple[bytes, list[str]]:
    """Zip notebooks with the data files on which they were made.

    Parameters
    ----------
    notebooks : sequence of SavedNotebook
    tries : mapping, optional
        The tries that the student sends, as `tries_to_send` finds them; default none.

    Returns
    -------
    tuple
        The zip file, the same bytes for the same work, and what is not in it as it is saved.

    Raises
    ------
    ValueError
        If a notebook is too large to be collected.
    """
    remarks: list[str] = []
    files: dict[str, bytes] = dict(tries or {})
    for notebook in notebooks:
        content, remark = packed_notebook(notebook.name, notebook.data)
        remarks += [remark] if remark else []
        files[f"{notebook.name}/{notebook.path.name}"] = content
        record = _record_beside(notebook.path)
        if record is not None:
            files[f"{notebook.name}/{record.name}"] = record.read_bytes()
    return zip_bytes(files), remarks


def _record_beside(notebook: Path) -> Path | None:
    """The data file beside a notebook; it is handed in to show on which record the notebook was made."""
    name = find_assignment(notebook.stem).record_file
    path = notebook.parent / (name or "")
    return path if name is not None and path.is_file() and path.stat().st_size <= _MAX_RECORD_BYTES else None
