"""Whether a check looks at what the notebook will give at grading: every cell once, from top to bottom.

In the notebook cells are run in any order, variables outlive the cells that made them, and the reference can be
imported. Each function returns what is wrong in one or two sentences, and None if nothing is known to be wrong: where
the notebook's program sends no ids of cells, or the file has not been saved, less is known.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from labsid.checks.cell_names import bound_names, used_names
from labsid.checks.cell_runs import CellRun, CellRuns
from labsid.checks.cells import Template, answer_id, is_stub
from labsid.checks.given_lines import put_back
from labsid.checks.mended_functions import Mend
from labsid.checks.notebook_file import NotebookFile
from labsid.checks.permitted import WRITE_YOURSELF, is_taught, refused_lines
from labsid.checks.python_errors import explain, told
from labsid.checks.stops import Stop
from labsid.checks.time_limit import CELL_SECONDS
from labsid.checks.verdict import PYTHON_ERROR

CHECK_FAILED = "CheckFailed"  # kind of the error that ends the cell of a check


@dataclass(frozen=True, slots=True, eq=False)
class QuestionCells:
    """The cells of a question among those of its notebook.

    Attributes
    ----------
    question_id : str
    runs : CellRuns
        The cells that have been run.
    file : NotebookFile or None
        The notebook as last saved.
    template : Template or None
        The cells of the assignment, saved or released.
    variables : mapping
        The notebook's variables.
    """

    question_id: str
    runs: CellRuns
    file: NotebookFile | None
    template: Template | None
    variables: Mapping[str, Any]

    @property
    def answer(self) -> CellRun | None:
        """The last run of the answer cell."""
        return self.runs.last(answer_id(self.question_id))

    @property
    def has_stopped(self) -> bool:
        """Whether an error stopped the last run of the answer cell."""
        return self.answer is not None and self.answer.stop is not None

    @property
    def has_ids(self) -> bool:
        """Whether the notebook's program sends the ids that the notebook's file has; some send ids of their own."""
        known = {cell.id for cell in self.template.cells} if self.template is not None else set()
        return not self.runs.cell_ids.isdisjoint(known | set(self.file.sources if self.file is not None else ()))

    def not_run(self, outcome: Callable[[Mend], str] | None = None) -> str | None:
        """The answer cell failed, took too long, or was not run as it now is.

        ``outcome(mend)`` tries a repair of the line that stopped before it is proposed; see `Stop`.
        """
        run = self.answer
        saved = None if self.file is None else self.file.sources.get(answer_id(self.question_id))
        if run is None:
            if not self.has_ids or saved is None or is_stub(saved):
                return None
            return "its answer cell has not been run since the kernel was started. Run it, then this check."
        if run.error.startswith("KeyboardInterrupt"):
            return (
                f"its answer cell was interrupted after {run.seconds:.0f} s{_line_of(run)}. Grading stops a cell after "
                f"{CELL_SECONDS:g} s. {explain(Stop('KeyboardInterrupt', '') if run.stop is None else run.stop)}"
            )
        if run.stop is not None:
            why = told(replace(run.stop, outcome=outcome), "its answer cell", self.making_cells)
            return f"{why} Correct that and run the cell, then this check."
        is_newer = self.file is not None and self.file.saved > run.ended
        if is_newer and saved is not None and saved.strip() != run.source.strip():
            return "its answer cell was changed after it was last run. Run it, then this check."
        if run.seconds > CELL_SECONDS:
            return f"its answer cell took {run.seconds:.0f} s; grading stops a cell after {CELL_SECONDS:g} s."
        return None

    def stopped_before(
        self, names: Iterable[str], slip: str | None, outcome: Callable[[Mend], str] | None = None
    ) -> str | None:
        """The cell that was run before the check stopped; asked where the answer cell is not known by its id.

        Where all `names` are functions, and the cell made those of them that it makes before it stopped, a mistake that
        the check names in them is what is told. (A value may not be finished where the cell stopped.)
        """
        run = next((run for run in reversed(self.runs.runs) if run.stop is None or run.stop.kind != CHECK_FAILED), None)
        if self.has_ids or run is None or run.stop is None:
            return None
        asked = set(names)
        is_made = bound_names(run.source) & asked <= run.assigned and all(
            callable(self.variables.get(n)) for n in asked
        )
        if slip not in (None, PYTHON_ERROR) and is_made:
            return None
        why = told(replace(run.stop, outcome=outcome), "the cell that was run before this check", self.making_cells)
        return f"{why} Correct that and run the cell, then this check."

    def making_cells(self, name: str) -> str:
        """Which cells above this one define a name, in a sentence; empty if none does."""
        cells = () if self.template is None else self.template.cells
        saved = {} if self.file is None else self.file.sources
        for cell in cells:
            if cell.id == answer_id(self.question_id):
                break
            if cell.code and name in bound_names(saved.get(cell.id, cell.source)):
                made = self.runs.last(cell.id)
                step = f" ({cell.heading})" if cell.heading else ""
                done = (
                    "it has not been run since the kernel was started" if made is None else "it did not run to its end"
                )
                return f"The cell `{cell.id}`{step} above defines `{name}`; {done}. Run it first."
        return ""

    def deleted_lines(self, release: Template | None) -> str | None:
        """Lines that the release gives in the answer cell were deleted, and nothing in the cell replaces them.

        `release` is the assignment as it was released, if it is on this machine.
        """
        run, cell_id = self.answer, answer_id(self.question_id)
        saved = "" if self.file is None else self.file.sources.get(cell_id, "")
        cells = () if release is None else release.cells
        released = next((cell.source for cell in cells if cell.id == cell_id and cell.code), "")
        lines = put_back(released, saved if run is None else run.source)[1]
        if not lines:
            return None
        what = "the line" if len(lines) == 1 else "the lines"
        quoted = ", ".join(f"`{' '.join(line.split())}`" for line in lines)
        return f"Its answer cell lacks {what} {quoted} of the release: undo the deletion, or copy from the release."

    def refused(self) -> str | None:
        """The answer uses what grading refuses."""
        run = self.answer
        sources = [] if run is None else [run.source]
        for name in () if run is None else sorted(used_names(run.source)):
            if is_taught(self.variables.get(name)):
                return f"it uses `{name}`, which is the taught function itself. Grading refuses it: {WRITE_YOURSELF}."
            made = self.runs.assigning(name)
            if made and self._is_own(made[-1]):
                sources.append(made[-1].source)
        return next((text for source in sources for text in refused_lines(source, self.variables)), None)

    def wrong_origin(self, name: str, is_right: bool) -> str | None:
        """A variable that the check reads is not the one that the cells above it make.

        A right value that both the answer and a given cell further down make is no concern.
        """
        made = self.runs.assigning(name)
        if not made or not self.has_ids:
            return None
        last, run = made[-1], self.answer
        if is_taught(self.variables.get(name)):
            return f"`{name}` is the taught function itself. Grading refuses it: {WRITE_YOURSELF}."
        if run is not None and last.cell_id == run.cell_id and last is not run and name not in run.assigned:
            return f"`{name}` is from an earlier run of the answer cell; as the cell is now, it does not make `{name}`."
        if self._is_below(last):
            where = self._name_of(last)
            if run is not None and name in run.assigned:
                if is_right and self._is_given(last):
                    return None
                return f"`{name}` was set anew further down, by {where}. Run the answer cell again, then this check."
            return (
                f"`{name}` is made further down, by {where}. Grading runs the cells from top to bottom and looks at "
                f"`{name}` here: move that code into the answer cell above this check."
            )
        if self._is_gone(last):
            return (
                f"`{name}` was made by a cell that is no longer in the notebook. Make it in the answer cell, and run "
                "that cell, then this check."
            )
        return None

    def made_below(self) -> str | None:
        """The answer uses a variable that only a cell further down makes."""
        run = self.answer
        for name in () if run is None or not self.has_ids else sorted(used_names(run.source)):
            made = self.runs.assigning(name)
            if made and name not in self.runs.first_names and all(map(self._is_below, made)):
                return (
                    f"the answer uses `{name}`, which only {self._name_of(made[-1])} further down makes. Grading runs "
                    "the cells from top to bottom: make it above."
                )
        return None

    def remark(self, names: Iterable[str]) -> str:
        """A remark for a right answer: it comes from a cell of the student's whose place is not known."""
        if self.has_ids:
            for name in names:
                made = self.runs.assigning(name)
                if made and self._is_own(made[-1]) and self._position(made[-1].cell_id) is None:
                    return f"`{name}` is made in a cell of your own: it counts if that cell stands above this check."
        return ""

    def _position(self, cell_id: str | None) -> int | None:
        if self.file is not None:
            return self.file.position(cell_id)
        order = [] if self.template is None else [cell.id for cell in self.template.cells]
        return order.index(cell_id) if cell_id in order else None

    def _is_below(self, run: CellRun) -> bool:
        place, here = self._position(run.cell_id), self._position(self.question_id)
        return place is not None and here is not None and place > here

    def _is_own(self, run: CellRun) -> bool:
        known = () if self.template is None else self.template.cells
        return run.cell_id is not None and all(cell.id != run.cell_id for cell in known)

    def _is_given(self, run: CellRun) -> bool:
        known = () if self.template is None else self.template.cells
        return any(cell.id == run.cell_id and cell.kind in ("given", "demonstration") for cell in known)

    def _is_gone(self, run: CellRun) -> bool:
        file = self.file
        return (
            file is not None and run.cell_id is not None and file.saved > run.ended and run.cell_id not in file.sources
        )

    def _name_of(self, run: CellRun) -> str:
        return "a cell of your own" if self._is_own(run) else f"the cell {run.cell_id}"


def _line_of(run: CellRun) -> str:
    """Where a run was interrupted, as the end of a sentence; empty if that is not known."""
    return "" if run.stop is None or not run.stop.line else f", in `{run.stop.line}`"
