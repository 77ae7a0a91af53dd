"""What was hard: statistics of the tries that students sent, for groups of at least five."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from autograder.results.sent_tries import StudentTries
from labsid._files import csv_text
from labsid.checks.kept_tries import OTHER, KeptTry

SMALLEST_GROUP = 5
"""No figure is shown that is of fewer students."""

COLUMNS = (
    "assignment", "question", "sent", "handed_in", "tried", "tries_until_right", "minutes_until_right", "gave_up",
    "without_a_name", "first_mistakes",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class HardQuestion:
    """One question in the tries of those who sent them; None where fewer than `SMALLEST_GROUP` students are counted.

    Attributes
    ----------
    question, heading : str
    tried : int
        Students who tried it.
    tries_until_right : float or None
        Median of those who got it right.
    minutes_until_right : float or None
        Median time from the first try to the first right one, of those who got it right.
    gave_up : int or None
        Students who never got it right.
    without_a_name : int or None
        Students with a mistake that no message named.
    first_mistakes : tuple of (str, int)
        How many students made each mistake first, the most frequent one first.
    """

    question: str
    heading: str
    tried: int
    tries_until_right: float | None
    minutes_until_right: float | None
    gave_up: int | None
    without_a_name: int | None
    first_mistakes: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class HardAssignment:
    """What was hard in one assignment.

    Attributes
    ----------
    assignment : str
    sent : int
        Students who sent their tries, at least `SMALLEST_GROUP`.
    handed_in : int
        Students who handed in the assignment.
    questions : tuple of HardQuestion
        Those that at least `SMALLEST_GROUP` students tried: the most tries until right first.
    """

    assignment: str
    sent: int
    handed_in: int
    questions: tuple[HardQuestion, ...]


def what_was_hard(
    assignment: str, sent: Sequence[StudentTries], handed_in: int, headings: Mapping[str, str]
) -> HardAssignment | None:
    """Statistics of the tries at an assignment.

    Parameters
    ----------
    assignment : str
    sent : sequence of tuple of KeptTry
        The tries of each student who sent them.
    handed_in : int
        Students who handed in the assignment.
    headings : mapping
        The heading of each question of the assignment; tries at others are ignored.

    Returns
    -------
    HardAssignment or None
        None if fewer than `SMALLEST_GROUP` students sent tries at its questions.
    """
    by_question: dict[str, list[StudentTries]] = {question: [] for question in headings}
    students = 0
    for tries in sent:
        own = {question: tuple(tried for tried in tries if tried.question == question) for question in headings}
        students += any(own.values())
        for question, of_question in own.items():
            by_question[question] += [of_question] if of_question else []
    if students < SMALLEST_GROUP:
        return None
    rows = [
        _question(question, headings[question], tries)
        for question, tries in by_question.items()
        if len(tries) >= SMALLEST_GROUP
    ]
    rows.sort(key=lambda row: -(row.tries_until_right or 0))
    return HardAssignment(assignment, students, max(handed_in, students), tuple(rows))


def hard_csv(assignments: Iterable[HardAssignment]) -> str:
    """The statistics as a CSV table, a row for each question; a figure of too few students is empty."""
    rows = (
        [
            one.assignment, row.question, str(one.sent), str(one.handed_in), str(row.tried),
            _number(row.tries_until_right), _number(row.minutes_until_right), _number(row.gave_up),
            _number(row.without_a_name), "; ".join(f"{name} ({count})" for name, count in row.first_mistakes),
        ]
        for one in assignments
        for row in one.questions
    )  # fmt: skip
    return csv_text(COLUMNS, rows)


def _question(question: str, heading: str, found: Sequence[StudentTries]) -> HardQuestion:
    solved = [tries for tries in found if any(attempt.right for attempt in tries)]
    until = [_until_right(tries) for tries in solved]
    first = Counter(tries[0].slip for tries in found if not tries[0].right)
    unnamed = sum(any(attempt.slip == OTHER for attempt in tries) for tries in found)
    enough = len(solved) >= SMALLEST_GROUP
    return HardQuestion(
        question,
        heading,
        len(found),
        median(len(tries) for tries in until) if enough else None,
        median(max(tries[-1].minute - tries[0].minute, 0) for tries in until) if enough else None,
        _enough(len(found) - len(solved)),
        _enough(unnamed),
        tuple((name, count) for name, count in first.most_common() if count >= SMALLEST_GROUP),
    )


def _until_right(tries: StudentTries) -> Sequence[KeptTry]:
    """The tries up to the first right one."""
    return tries[: next(i for i, one in enumerate(tries) if one.right) + 1]


def _enough(count: int) -> int | None:
    return count if count >= SMALLEST_GROUP else None


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:g}"
