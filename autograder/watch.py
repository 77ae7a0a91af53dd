"""What a check was handed while it judged: kept for the pictures, and to see whose data a wrong answer is made of."""

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from autograder.ask import ProcessAsk
from autograder.isolation import Student
from labsid.checks.question import Origin
from labsid.checks.values import FigureValue, Value
from labsid.record import Record


class WatchingAsk(ProcessAsk):
    """Asks a student's process, and keeps the values that it was handed."""

    def __init__(
        self,
        student: Callable[[], Student],
        record: Record | None,
        known: Mapping[str, Value],
        rng: np.random.Generator,
        origin: Origin | None = None,
    ) -> None:
        super().__init__(student, record, known, rng, origin)
        self._seen: dict[str, Value] = {}

    def value(self, name: str) -> Value:
        """The variable as plain data; asked for once, as an object of the student's may answer otherwise next time."""
        if name not in self._seen:
            self._seen[name] = super().value(name)
        return self._seen[name]

    @property
    def figures(self) -> tuple[FigureValue, ...]:
        """The figures that were asked for."""
        return tuple(value for value in self._seen.values() if isinstance(value, FigureValue))

    def values_of(self, names: Iterable[str]) -> dict[str, Value]:
        """Those of the variables that were asked for."""
        return {name: self._seen[name] for name in names if name in self._seen}
