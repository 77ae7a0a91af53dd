"""A notebook run from a clean start, as grading runs it: every cell once, from top to bottom, on public inputs.

An error costs its own cell. After a wrong step the run goes on from the reference's values, so that a wrong step costs
only its own marks.
"""

import re
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from textwrap import shorten
from typing import Any

from labsid.checks.cell_names import bound_names, read_names
from labsid.checks.cells import Cell, Template, grade_id_of
from labsid.checks.notebook import find_assignment
from labsid.checks.permitted import skipped_lines
from labsid.checks.summary import FAILED, PASSED, SKIPPED, QuestionState, states_of
from labsid.checks.time_limit import CALL_SECONDS, CELL_SECONDS, DISK_BYTES, MOST_OWN_CELLS, SUBMISSION_SECONDS
from labsid.hand_in.kernel import CellOutcome, NotebookKernel

_CHECK_SECONDS = 3 * CALL_SECONDS
_MOST_FILES = 5  # that are named
_HISTORY = re.compile(r"_i{1,3}|_i?\d+|_[io]h|In|Out")


@dataclass(frozen=True, slots=True)
class CleanRun:
    """What the checks found in a clean run.

    Attributes
    ----------
    states : tuple of QuestionState
        One for each question.
    reasons : mapping
        Why a question is not right, by its id.
    remarks : tuple of str
        On the student's own cells that failed.
    """

    states: tuple[QuestionState, ...]
    reasons: Mapping[str, str]
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Step:
    """A code cell to run, with its template's cell; None for a cell of the student's own."""

    cell_id: str
    source: str
    known: Cell | None


def run_from_clean_start(
    cells: Sequence[Mapping[str, Any]],
    template: Template,
    notebook: Path,
    cell_seconds: float = CELL_SECONDS,
    content: bytes | None = None,
) -> CleanRun:
    """Run the cells of a notebook in a kernel of their own.

    Parameters
    ----------
    cells : sequence of mapping
        The student's cells, as `plain_cells` reads them.
    template : Template
        The assignment as it was released.
    notebook : Path
        The notebook's file; of the files beside it, the run has the data file alone, as grading does.
    cell_seconds : float
        Longest run of a cell, in seconds.
    content : bytes, optional
        Of a data file that takes the place of the one beside the notebook.

    Returns
    -------
    CleanRun

    Raises
    ------
    ValueError
        If no kernel can be started.
    """
    steps = list(_steps(cells, template))
    with tempfile.TemporaryDirectory(prefix="labsid-") as scratch, _Runner(Path(scratch), cell_seconds) as runner:
        shutil.copyfile(notebook, Path(scratch) / f"{template.assignment}.ipynb")
        record = find_assignment(template.assignment).record_file
        if record is not None and content is not None:
            (Path(scratch) / record).write_bytes(content)
        elif record is not None and (notebook.parent / record).is_file():
            shutil.copyfile(notebook.parent / record, Path(scratch) / record)
        runner.remarks += _remarks_on_history(steps)
        for step in steps:
            runner.run(step)
        runner.remark_on_files()
        texts = {grade_id_of(cell): cell["source"] for cell in reversed(cells)}
        return CleanRun(states_of(template.questions, runner.found, texts), runner.reasons, tuple(runner.remarks))


def _steps(cells: Sequence[Mapping[str, Any]], template: Template) -> Iterator[_Step]:
    """The code cells in the order of the template; given cells and checks as they were released."""
    known = {cell.id for cell in template.cells}
    answers: dict[str, Mapping[str, Any]] = {}
    own: dict[str, list[Mapping[str, Any]]] = {}
    anchor = ""
    for cell in cells:
        grade_id = grade_id_of(cell)
        if grade_id in known and grade_id not in answers:
            answers[grade_id] = cell
            anchor = grade_id
        elif cell["cell_type"] == "code":
            own.setdefault(anchor, []).append(cell)
    yield from (_Step(str(cell["id"]), cell["source"], None) for cell in own.get("", ()))
    for wanted in template.cells:
        if wanted.code:
            mine = answers.get(wanted.id)
            is_answer = wanted.kind in ("answer", "manual")
            source = (mine["source"] if mine is not None else "") if is_answer else wanted.source
            yield _Step(wanted.id if mine is None else str(mine["id"]), source, wanted)
        yield from (_Step(str(cell["id"]), cell["source"], None) for cell in own.get(wanted.id, ()))


def _remark(source: str, outcome: CellOutcome) -> str:
    """What to do about a student's own cell that failed."""
    first = next((line.strip() for line in source.splitlines() if line.strip()), "")
    return (
        f"Your own cell that begins with `{shorten(first, 60)}` stopped with {outcome.error}: "
        f"{shorten(outcome.text, 200)}. The cells after it were run all the same. In JupyterLab, Run All Cells ends "
        "at it: correct it or delete it."
    )


def _remark_on_skipped(line: str) -> str:
    return (
        f"`{shorten(line, 60)}` was skipped, as it is when the notebook is graded: nothing can be installed there and "
        "no program started. The rest of the cell was run."
    )


def _remark_on_file(path: str) -> str:
    return (
        f"`{path}` is opened or imported, and is not there when the notebook is graded: what depends on it is wrong "
        "then. Put its content, or its code, into a cell; the data file is beside the notebook, under its name alone."
    )


def _remarks_on_history(steps: Sequence[_Step]) -> Iterator[str]:
    """On names that Jupyter gives to earlier cells and their values; the student may use them for something else."""
    read = {name for step in steps for name in read_names(step.source)}
    for name in sorted(read.difference(*(bound_names(step.source) for step in steps))):
        if _HISTORY.fullmatch(name):
            yield (
                f"`{name}`, which Jupyter makes of the cells that were run before, is missing or another one when the "
                "notebook is graded: a question that depends on it is wrong. Give the value a name."
            )


class _Runner:
    """Runs steps in a kernel; one that ends is replaced by one that has run the steps before, without the last."""

    def __init__(self, folder: Path, cell_seconds: float) -> None:
        self.found: dict[str, str] = {}
        self.reasons: dict[str, str] = {}
        self.remarks: list[str] = []
        self._folder = folder
        self._cell_seconds = cell_seconds
        self._done: list[tuple[str, str | None]] = []
        self._stack = ExitStack()
        self._kernel: NotebookKernel | None = None
        self._deadline = time.monotonic() + SUBMISSION_SECONDS
        self._lost = ""
        self._own_cells = 0

    def __enter__(self) -> "_Runner":
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def run(self, step: _Step) -> None:
        """Run a step and note what the checks in it found."""
        kind = "" if step.known is None else step.known.kind
        question = step.known.id if step.known is not None and kind in ("question", "tests") else ""
        seconds_left = self._deadline - time.monotonic()
        self._own_cells += (step.known is None or kind == "answer") and bool(step.source)
        over = self._over_a_limit(seconds_left)
        if over:
            if question:
                self._fail(question, f"{question}: {over}")
            return
        allowed = _CHECK_SECONDS if kind == "question" else self._cell_seconds
        outcome = self._run(step.source, step.cell_id, min(seconds_left, allowed))
        for outcome_of_check in outcome.outcomes:  # of the question itself; another cell can only skip one
            name, state = str(outcome_of_check.get("question")), str(outcome_of_check.get("state"))
            if name == question or state == SKIPPED:
                self.found[name] = state
        if kind != "question":
            self.remarks += map(_remark_on_skipped, skipped_lines(step.source))
        if step.known is None and outcome.error:
            self.remarks.append(_remark(step.source, outcome))
        if not question:
            return
        if outcome.error:
            said = outcome.text if outcome.error == "CheckFailed" else f"{question}: {outcome.error} {outcome.text}"
            self._fail(question, f"{question}: {self._lost}" if self._lost else said)
            if kind == "question":
                self._run(f"check.skip({question!r})", None, _CHECK_SECONDS)
        elif kind == "tests":
            self.found[question] = PASSED
        self._lost = ""

    def remark_on_files(self) -> None:
        """Remark on what grading does not have: files elsewhere, and the space for large ones."""
        elsewhere = [] if self._kernel is None else self._kernel.files_elsewhere()
        self.remarks += map(_remark_on_file, elsewhere[:_MOST_FILES])
        written = sum(path.stat().st_size for path in self._folder.rglob("*") if path.is_file())
        if written > DISK_BYTES:
            self.remarks.append(
                f"The notebook's files have {written // 2**20} MB. While it is graded all files together may have "
                f"{DISK_BYTES // 2**20} MB: what is written beyond that fails, and the answer with it."
            )

    def _over_a_limit(self, seconds: float) -> str:
        """Why grading does not run a cell; empty if it does."""
        if seconds <= 0:
            return f"the cells before took longer than {SUBMISSION_SECONDS:g} s, the limit at grading."
        if self._own_cells > MOST_OWN_CELLS:
            return (
                f"the notebook has more than {MOST_OWN_CELLS} cells of your own code. Grading does not run the others, "
                "and what comes after them is not answered. Join cells, or delete some."
            )
        return ""

    def _fail(self, question: str, reason: str) -> None:
        self.found[question] = FAILED
        self.reasons[question] = reason

    def _run(self, source: str, cell_id: str | None, seconds: float) -> CellOutcome:
        outcome = self._open().run(source, cell_id, seconds)
        if not outcome.lost:
            self._done.append((source, cell_id))
            return outcome
        self._lost = f"its cell was stopped after {seconds:g} s, or ended the kernel ({outcome.text})."
        self._stack.close()
        self._kernel = None
        for again, again_id in self._done:
            self._open().run(again, again_id, self._cell_seconds)
        return outcome

    def _open(self) -> NotebookKernel:
        if self._kernel is None:
            self._kernel = self._stack.enter_context(NotebookKernel(self._folder, as_graded=True))
        return self._kernel
