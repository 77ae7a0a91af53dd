"""The cells that have been run in a notebook, as its shell reports them: what they assigned and how they ended."""

import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from threading import Timer
from typing import Any
from weakref import WeakKeyDictionary

from labsid.checks.cell_names import assigned_names, read_names
from labsid.checks.stops import Stop, stop_of
from labsid.checks.time_limit import CELL_SECONDS


@dataclass(frozen=True, slots=True)
class CellRun:
    """One run of one cell.

    Attributes
    ----------
    cell_id : str or None
        None where the notebook's program does not send it.
    source : str
    error : str
        Kind and text of the error that stopped it; empty if it ran to its end.
    assigned : frozenset of str
        The variables that it assigned.
    seconds : float
    ended : float
        Seconds since the epoch.
    stop : Stop or None
        Where the error stopped it.
    """

    cell_id: str | None
    source: str
    error: str
    assigned: frozenset[str]
    seconds: float
    ended: float
    stop: Stop | None = None


class CellRuns:
    """Records the runs of cells in an IPython shell, from the moment when it is opened.

    `runs` are in the order in which they ended; `first_names` are the variables before the first of them; `cell_ids`
    are the ids that the notebook's program has sent.
    """

    def __init__(self) -> None:
        self.runs: list[CellRun] = []
        self.first_names: frozenset[str] = frozenset()
        self.cell_ids: set[str] = set()
        self._before: dict[str, Any] | None = None
        self._started = 0.0
        self._warning: Timer | None = None

    def last(self, cell_id: str) -> CellRun | None:
        """The last run of a cell; None if it has not been run."""
        return next((run for run in reversed(self.runs) if run.cell_id == cell_id), None)

    def assigning(self, name: str) -> list[CellRun]:
        """The runs that assigned a variable."""
        return [run for run in self.runs if name in run.assigned]

    def sources_of(self, name: str) -> list[str]:
        """The sources that made a variable: of the run that assigned it last, and of later ones that use it."""
        last = next((i for i, run in reversed(list(enumerate(self.runs))) if name in run.assigned), len(self.runs))
        made, later = self.runs[last : last + 1], self.runs[last + 1 :]
        return [run.source for run in made] + [run.source for run in later if name in read_names(run.source)]

    def before_cell(self, info: Any, variables: Mapping[str, Any]) -> None:
        """Note the variables before the run that IPython describes by its `ExecutionInfo`.

        A warning is printed when the cell has run for as long as grading lets it.
        """
        cell_id = getattr(info, "cell_id", None)
        self.cell_ids |= set() if cell_id is None else {cell_id}
        if self._before is None and not self.runs:
            self.first_names = frozenset(variables)
        self._before = dict(variables)
        self._started = time.monotonic()
        self._warning = Timer(CELL_SECONDS, _warn_of_time)
        self._warning.daemon = True
        self._warning.start()

    def after_cell(self, result: Any, variables: Mapping[str, Any]) -> None:
        """Record the run that IPython describes by its `ExecutionResult`, which is None after some interrupts."""
        if self._warning is not None:
            self._warning.cancel()
        variables_before, self._before = self._before, None
        if variables_before is None:  # the cell that opened the record
            self.first_names = frozenset(variables)
            return
        if result is None:
            return
        source = str(result.info.raw_cell or "")
        error = result.error_before_exec or result.error_in_exec
        new = {
            name
            for name, value in variables.items()
            if name not in variables_before or variables_before[name] is not value
        }
        written = assigned_names(source) if error is None else frozenset()
        assigned = frozenset(name for name in new | written if not name.startswith("_") and name in variables)
        said = "" if error is None else f"{type(error).__name__}: {error}".strip(": ")
        taken = time.monotonic() - self._started
        cell_id = getattr(result.info, "cell_id", None)
        stop = None if error is None else stop_of(error, variables, source)
        self.runs.append(CellRun(cell_id, source, said, assigned, taken, time.time(), stop))


_OPENED: WeakKeyDictionary[Any, CellRuns] = WeakKeyDictionary()


def runs_in(shell: Any) -> CellRuns:
    """The record of an IPython shell; it is opened at the first call."""
    if shell not in _OPENED:
        runs = _OPENED[shell] = CellRuns()
        shell.events.register("pre_run_cell", lambda info: runs.before_cell(info, shell.user_ns))
        shell.events.register("post_run_cell", lambda result: runs.after_cell(result, shell.user_ns))
    return _OPENED[shell]


def shell_of(variables: Mapping[str, Any]) -> Any:
    """The IPython shell whose variables these are; None in any other Python."""
    ask = variables.get("get_ipython")
    shell = ask() if callable(ask) and "IPython" in sys.modules else None
    return shell if shell is not None and shell.user_ns is variables else None


def _warn_of_time() -> None:
    print(
        f"This cell has been running for {CELL_SECONDS:g} seconds; grading stops a cell then. If it does not end by "
        "itself, stop it with Kernel > Interrupt, and look for a loop whose condition never becomes false.",
        file=sys.stderr,
    )
