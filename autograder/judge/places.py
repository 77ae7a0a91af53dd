"""Where a notebook makes the values and functions that a wrong answer gives, and which code starts from them."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

from autograder.judge.answer import Answer
from autograder.judge.execution import ExecutedCell, source_to_run
from labsid.checks.cell_names import assigned_names, made_by_calls, read_names


@dataclass(frozen=True)
class Places:
    """The cells of a notebook, by what they make and read.

    Attributes
    ----------
    cells : sequence of ExecutedCell
        All cells.
    answers : sequence of Answer
        One for each question that a check judges, in their order.
    replaced : sequence of frozenset of str
        For each answer, the names of its values and functions that may be replaced.
    """

    cells: Sequence[ExecutedCell]
    answers: Sequence[Answer]
    replaced: Sequence[frozenset[str]]

    def starts_from(self, key: int, earlier: int) -> bool:
        """Whether an answer's code starts from what the cells of an earlier answer make, or was made in the same ones.

        Code counts by what it reads: a name in a comment or in a text does not.
        """
        made = self._made[earlier] | self.replaced[earlier]
        between = range(self.checks[earlier] + 1, self.checks[key])
        own = frozenset(self.answers[key].asked.values) | self.replaced[key]
        return any(not made.isdisjoint(self._read[place]) for place in between) or not own.isdisjoint(
            self._made[earlier]
        )

    def goes_on_from(self, key: int) -> bool:
        """Whether the cells that make the values of an answer also make what later code or checks use."""
        later = self._read[self.checks[key] + 1 :]
        asked = (frozenset(other.asked.values) | self.replaced[n] for n, other in enumerate(self.answers) if n > key)
        return not (self._made[key] - self.replaced[key]).isdisjoint(frozenset().union(*later, *asked))

    def read_after(self, key: int) -> frozenset[str]:
        """The names that code reads from the first cell that makes a value or function of an answer on."""
        own = self._own_cells(range(len(self.cells)))
        first = next((place for place in own if not self.replaced[key].isdisjoint(self._assigned[place])), 0)
        return frozenset().union(*self._read[min(first, self.checks[key]) :])

    @cached_property
    def checks(self) -> Sequence[int]:
        """Index of each answer's check."""
        return [place for place, done in enumerate(self.cells) if done.cell.kind == "question"]

    @cached_property
    def given(self) -> frozenset[str]:
        """The names that given cells make."""
        cells = range(len(self.cells))
        return frozenset().union(*(self._assigned[place] for place in set(cells) - set(self._own_cells(cells))))

    @cached_property
    def _made(self) -> Sequence[frozenset[str]]:
        """For each answer, the names that students' cells make from the first that makes one of its values on."""
        found = []
        for key, names in enumerate(self.replaced):
            own = self._own_cells(range(self.checks[key]))
            first = next((place for place in own if not names.isdisjoint(self._assigned[place])), None)
            if first is None:
                first = self.checks[key - 1] if key else 0
            found.append(frozenset().union(*(self._assigned[place] for place in own if place >= first)))
        return found

    @cached_property
    def _assigned(self) -> Sequence[frozenset[str]]:
        sources = [source_to_run(done.cell) for done in self.cells]
        return [assigned_names(source) | made_by_calls(source) for source in sources]

    @cached_property
    def _read(self) -> Sequence[frozenset[str]]:
        return [read_names(source_to_run(done.cell)) for done in self.cells]

    def _own_cells(self, places: Collection[int]) -> Sequence[int]:
        return [place for place in places if self.cells[place].cell.kind in ("answer", "extra")]
