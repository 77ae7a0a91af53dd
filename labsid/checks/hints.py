"""Hints in stages: what is wrong, where to look, what to do. The next one comes for another answer, or with time."""

from dataclasses import dataclass, replace

from labsid.checks.question import Assignment, Stages

WAIT = 120.0
"""Seconds after which the next hint comes for the same answer, too (point 2 of the course's design of checks)."""

Code = tuple[str, ...] | None


@dataclass(frozen=True, slots=True)
class _Given:
    """What was shown on one question: the stage, for which code, and when (s)."""

    mend: str
    names: tuple[str, ...]
    code: Code
    at: float
    stage: int = 0


class Hints:
    """The hints of an assignment that have been given; `last` is the question of the last check that failed."""

    def __init__(self, assignment: Assignment) -> None:
        self._stages = assignment.stages
        self._given: dict[str, _Given] = {}
        self.last: str | None = None

    def failed(self, question_id: str, mend: str, names: tuple[str, ...], code: Code, now: float) -> None:
        """Note a failed check: `mend` corrects its mistake, `names` and `code` are those of the answer."""
        self.last = question_id
        given = self._given.get(question_id, _Given(mend, names, code, now))
        self._given[question_id] = replace(given, mend=mend, names=names or given.names)

    def names(self, question_id: str) -> tuple[str, ...]:
        """The variables that the last check of a question read."""
        return self._given[question_id].names if question_id in self._given else ()

    def forget(self, question_id: str) -> None:
        """Begin anew: the question is right."""
        self._given.pop(question_id, None)

    def next(self, question_id: str, code: Code, now: float, has_practice: bool) -> str:
        """The text of the next hint; empty before the first failed check.

        Parameters
        ----------
        question_id : str
        code : tuple of str or None
            The answer's code now; None where it is not known, and counts as changed.
        now : float
            Time on a monotonic clock (s).
        has_practice : bool
            Whether the question can be practised on new numbers.
        """
        given = self._given.get(question_id)
        if given is None:
            return ""
        stages = self._texts(question_id, given.mend)
        seconds_left = WAIT - (now - given.at)
        if given.stage < len(stages):
            if code is not None and code == given.code and seconds_left > 0:
                shown, which = (f"{stages[given.stage - 1]} ", "next") if given.stage else ("", "first")
                return (
                    f"{shown}The {which} hint comes when your answer has changed and its check has been run, or in "
                    f"{seconds_left:.0f} s. What does the message tell you?"
                )
            given = self._given[question_id] = replace(given, stage=given.stage + 1, code=code, at=now)
        text = stages[given.stage - 1]
        return text if given.stage < len(stages) else f"{text} {_ways_on(question_id, has_practice)}"

    def _texts(self, question_id: str, mend: str) -> list[str]:
        stages = self._stages.get(question_id, Stages("Read the text of this step once more, from its heading.", ""))
        return [text for text in (stages.where, " ".join(filter(None, (mend, stages.how)))) if text]


def _ways_on(question_id: str, has_practice: bool) -> str:
    """What is offered with the last hint."""
    practise = f'Practise it with new numbers: check.practice("{question_id}"). ' if has_practice else ""
    return f'{practise}To go on without it: check.skip("{question_id}") in a new cell; it earns no marks.'
