"""What a prediction is: a question with options, positions of a slider, and an experiment on the student's own data."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from labsid.plots.predictions import View
from labsid.records.record import Record


@dataclass(frozen=True, slots=True)
class Outcome:
    """What happened.

    Attributes
    ----------
    holds : int
        Index of the option that holds on these data.
    said : str
        Why, with their numbers.
    """

    holds: int
    said: str


class Experiment(Protocol):
    """A prediction tried on data."""

    def view(self, position: int) -> View:
        """What is seen at a position of the slider."""

    def outcome(self) -> Outcome:
        """Which option holds."""


@dataclass(frozen=True, slots=True, eq=False)
class Sources:
    """The data of a notebook.

    Attributes
    ----------
    record : Record or None
        The student's record, if the assignment has one.
    variables : mapping
        The notebook's variables.
    """

    record: Record | None
    variables: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Prediction:
    """One prediction.

    Attributes
    ----------
    id : str
        As in ``check.predict(id)``.
    question : str
    options : tuple of str
        Exactly one holds on any data.
    slider : str
        Label of the slider.
    positions : tuple of str
        Its positions, as text.
    start, asked : int
        The position at which nothing is changed, and the one of which the question speaks.
    prepare : callable
        ``prepare(sources)`` is the `Experiment`; raises `ValueError` if the data are not there.
    """

    id: str
    question: str
    options: tuple[str, ...]
    slider: str
    positions: tuple[str, ...]
    start: int
    asked: int
    prepare: Callable[[Sources], Experiment]


def verdict_text(prediction: Prediction, chosen: int, outcome: Outcome) -> str:
    """Whether a prediction held, and what happens if not."""
    if chosen == outcome.holds:
        return "Your prediction held."
    return f'Your prediction did not hold. What happens: "{prediction.options[outcome.holds]}"'
