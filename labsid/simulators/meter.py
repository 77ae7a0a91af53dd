"""Count the runs of a simulation and their time, and end a search when its budget of runs is spent."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any

SEARCH_SHARE = 0.75  # of a budget of runs, for the beam search; the rest is for the search on held-out samples


class BudgetSpentError(ValueError):
    """A search has asked for more runs than its budget allows."""

    def __init__(self, budget: int | None) -> None:
        super().__init__(f"{budget} evaluations are too few to fit the simulation to the record. Allow more.")


class RunMeter:
    """Counts the runs of a simulation.

    `budget` is the largest number of runs of the searches, None for no limit; `runs` the number of runs since `begin`,
    and `seconds` their time; `spent` whether a search has been refused a run; `failed` the number of runs without an
    output, and `failure` what the first of them said.
    """

    def __init__(self) -> None:
        self._most = float("inf")
        self.begin(None)

    def begin(self, budget: int | None) -> None:
        """Count from zero, with another budget."""
        self.budget, self.runs, self.seconds, self.spent = budget, 0, 0.0, False
        self.failed, self.failure = 0, ""
        self._begun = perf_counter()

    @contextmanager
    def searching(self, share: float = 1.0) -> Iterator[None]:
        """Within a search, refuse runs beyond this share of the budget. Outside of one, no run is refused."""
        self._most = float("inf") if self.budget is None else share * self.budget
        try:
            yield
        finally:
            self._most = float("inf")

    @property
    def left(self) -> float:
        """Runs that the present search has left; infinity without a budget."""
        return max(self._most - self.runs, 0.0)

    @property
    def exhausted(self) -> bool:
        """Whether the present search may run the simulation no more."""
        return not self.left

    def measured(self, run: Callable[[], Any]) -> Any:
        """Result of one run.

        Raises
        ------
        BudgetSpentError
            If a search has spent its budget.
        """
        if self.exhausted:
            self.spent = True
            raise BudgetSpentError(self.budget)
        self.runs += 1
        start = perf_counter()
        try:
            return run()
        finally:
            self.seconds += perf_counter() - start

    def note_failure(self, said: str) -> None:
        """Count a run without an output, and keep what the first one said."""
        self.failed += 1
        self.failure = self.failure or said

    def counts(self) -> dict[str, Any]:
        """What a report says of the runs, JSON-ready."""
        return {name: getattr(self, name) for name in ("runs", "budget", "spent", "failed", "failure")}

    def __str__(self) -> str:
        """What a progress line says."""
        share = self.seconds / max(perf_counter() - self._begun, 1e-9)
        return f"{self.runs:,} simulations, {100.0 * min(share, 1.0):.0f} % of the time"
