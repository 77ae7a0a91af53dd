"""The answer to a question while its submission is judged, and the result that it ends with."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal

from autograder.judge.attempt import Attempt
from autograder.judge.carrying import differ_in_shape
from autograder.judge.examiner import Examination
from autograder.judge.outcome import QuestionResult
from labsid.checks.cell_names import read_names
from labsid.checks.question import Question
from labsid.checks.values import Value
from labsid.checks.verdict import Verdict


@dataclass(slots=True)
class Answer:
    """The answer to a question.

    Attributes
    ----------
    asked : Examination
        The question in the notebook as it was handed in.
    points : Decimal
    known : mapping
        The student's own values of earlier steps.
    own, right : mapping
        The student's values of the names that later steps use, and the right ones that follow from `known`.
    attempts : list of Attempt
        The judgings so far, by right values of earlier steps.
    follows_own : bool
        Whether it is right by the student's own values of earlier steps, where these are wrong. That earns nothing:
        these values are of the student's own choosing.
    is_sound : bool
        Whether it is right with no wrong value involved, so that its values and functions are carried forward.
    causes : tuple of str
        The wrong steps on whose values it is right.
    pictures : tuple of str
        The judged figures.
    seconds : float
        Time so far.
    """

    asked: Examination
    points: Decimal
    known: Mapping[str, Value]
    own: Mapping[str, Value] = field(default_factory=dict)
    right: Mapping[str, Value] = field(default_factory=dict)
    attempts: list[Attempt] = field(default_factory=list)
    follows_own: bool = False
    is_sound: bool = False
    causes: tuple[str, ...] = ()
    pictures: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def question(self) -> Question:
        """The question."""
        return self.asked.question

    @property
    def is_right(self) -> bool:
        """Whether any attempt found it right."""
        return any(attempt.passed for attempt in self.attempts)

    @property
    def accepted(self) -> Mapping[str, Value]:
        """The values with which later steps start, with vectors in the shape of the right ones."""
        return {
            name: value.reshape(self.right[name].shape)  # type: ignore[union-attr]
            if differ_in_shape({name: value}, self.right)
            else value
            for name, value in self.carried.items()
        }

    @property
    def crashed(self) -> bool:
        """Whether one of its cells ended the process."""
        return any(done.failure is not None for done in self.asked.cells)

    @property
    def carried(self) -> Mapping[str, Value]:
        """The values with which later steps start: the student's own where there are any."""
        return {**self.right, **self.own}

    def follow_right(self, right: Mapping[str, Value]) -> None:
        """Take right values, and the student's of these names as far as they were judged."""
        self.right = right
        self.own = {name: self.asked.values[name] for name in right if name in self.asked.values}

    def reads(self, name: str) -> bool:
        """Whether its code reads a name."""
        return any(name in read_names(done.cell.source) for done in self.asked.cells)

    def result(self) -> QuestionResult:
        """The result of the question."""
        cells = self.asked.cells
        best = max(self.attempts, key=lambda attempt: attempt.rank)
        verdict, status = best.verdict, "graded"
        if verdict is None:
            status = "crashed" if best.failure is None else best.failure.status
            verdict = Verdict(False, f"Your code for this step did not finish: {best.failure}.")
        elif not verdict.passed and any((done.reply.error or {}).get("kind") == "MemoryError" for done in cells):
            status = "limit"
        return QuestionResult(
            self.question.id,
            self.points if verdict.passed else Decimal(0),
            self.points,
            status,
            verdict.reason,
            verdict.slip,
            answer="\n\n".join(done.cell.source for done in cells),
            output="".join(done.reply.stdout for done in cells),
            figures=self.pictures,
            seconds=self.seconds,
            consistent=self.follows_own and not verdict.passed,
        )


def wrong_steps(answers: Iterable[Answer]) -> tuple[str, ...]:
    """Ids of the wrong questions among these answers, and of those on whose wrong values the right ones rest."""
    steps = [step for answer in answers for step in (answer.causes if answer.is_right else (answer.question.id,))]
    return tuple(dict.fromkeys(steps))
