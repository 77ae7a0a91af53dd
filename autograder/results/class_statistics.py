"""What a class says of the questions: how hard they are, whether they tell, and wrong answers that no message named.

Nothing is shown that is of fewer than `SMALLEST_GROUP` students, and no text that fewer have in common.
"""

import io
import re
import tokenize
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from statistics import StatisticsError, correlation, fmean

from autograder.results.hard_questions import SMALLEST_GROUP
from autograder.results.result_files import StoredResult
from labsid._files import csv_text
from labsid.checks.cells import is_stub
from labsid.checks.given_lines import MAX_CHARACTERS

COLUMNS = (
    "assignment", "question", "answers", "difficulty", "discrimination", "not_right", "without_a_name", "kind", "count",
    "reason", "code",
)  # fmt: skip

MOST_KINDS = 5
"""Kinds of wrong answers of a question that are listed."""

_MOST_CHARACTERS = 600
_NUMBER = re.compile(r"(?<![\w.])[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?j?")


@dataclass(frozen=True, slots=True)
class WrongAnswers:
    """Wrong answers of one kind that no message named.

    Attributes
    ----------
    count : int
        Students who gave one, at least `SMALLEST_GROUP`.
    reason : str
        What all of them were told, with # for each number.
    code : str
        What at least `SMALLEST_GROUP` of them wrote, without comments; empty if no code is common to so many.
    """

    count: int
    reason: str
    code: str


@dataclass(frozen=True, slots=True)
class QuestionFigures:
    """One question; None where fewer than `SMALLEST_GROUP` students are counted.

    Attributes
    ----------
    question, heading : str
    answers : int
        Students whose marks are known.
    difficulty : float
        Mean share of the marks: 1 if all are right.
    discrimination : float or None
        Correlation of the share with the marks of the other questions; None also if either does not vary.
    not_right : int or None
        Students who answered, and not with full marks.
    without_a_name : int or None
        Those of them whose mistake no message named.
    kinds : tuple of WrongAnswers
        The most frequent first.
    """

    question: str
    heading: str
    answers: int
    difficulty: float
    discrimination: float | None
    not_right: int | None
    without_a_name: int | None
    kinds: tuple[WrongAnswers, ...]


def question_figures(
    stored: Iterable[StoredResult],
    manual: Mapping[tuple[str, str, str], Decimal],
    headings: Mapping[str, str] | None = None,
) -> tuple[QuestionFigures, ...]:
    """The figures of the questions of one assignment, in the order of the notebook.

    Parameters
    ----------
    stored : iterable of StoredResult
        Hand-ins that were graded.
    manual : mapping
        Marks given by hand, by student, assignment and question.
    headings : mapping, optional
        By question.

    Returns
    -------
    tuple of QuestionFigures
        Of the questions to which the marks of at least `SMALLEST_GROUP` students are known.
    """
    shares: dict[str, dict[str, float]] = {}
    scores: dict[str, dict[str, float]] = {}
    wrong: dict[str, list[tuple[str | None, str, str]]] = {}
    for result in stored:
        for entry in result.questions:
            score = manual.get((result.student, result.assignment, entry.question), entry.score)
            of_question = shares.setdefault(entry.question, {})
            if score is None or not entry.max_score:
                continue
            of_question[result.student] = min(float(score / entry.max_score), 1.0)
            scores.setdefault(result.student, {})[entry.question] = float(score)
            if score < entry.max_score and entry.status != "manual" and not is_stub(entry.answer):
                wrong.setdefault(entry.question, []).append((entry.slip, entry.reason, entry.answer))
    return tuple(
        QuestionFigures(
            question,
            (headings or {}).get(question, ""),
            len(of_students),
            fmean(of_students.values()),
            _discrimination(question, of_students, scores),
            _enough(len(wrong.get(question, ()))),
            _enough(len(unnamed := [mistake[1:] for mistake in wrong.get(question, ()) if not mistake[0]])),
            _kinds(unnamed),
        )
        for question, of_students in shares.items()
        if len(of_students) >= SMALLEST_GROUP
    )


def statistics_csv(figures: Mapping[str, Sequence[QuestionFigures]]) -> str:
    """The figures by assignment as a table without names: a row for each question, and one for each kind below it."""
    rows = []
    for assignment, questions in figures.items():
        for of_question in questions:
            counts = (of_question.not_right, of_question.without_a_name)
            numbers = [
                f"{of_question.difficulty:.3f}",
                "" if of_question.discrimination is None else f"{of_question.discrimination:.3f}",
            ]
            numbers += ["" if count is None else str(count) for count in counts]
            rows.append([assignment, of_question.question, str(of_question.answers), *numbers, "", "", "", ""])
            for number, kind in enumerate(of_question.kinds, start=1):
                blank = [""] * 5
                rows.append(
                    [assignment, of_question.question, *blank, str(number), str(kind.count), kind.reason, kind.code]
                )
    return csv_text(COLUMNS, rows)


def _discrimination(
    question: str, shares: Mapping[str, float], scores: Mapping[str, Mapping[str, float]]
) -> float | None:
    rest = [sum(score for other, score in scores[student].items() if other != question) for student in shares]
    try:
        return correlation(list(shares.values()), rest)
    except StatisticsError:  # one of them is the same for all
        return None


def _kinds(unnamed: Sequence[tuple[str, str]]) -> tuple[WrongAnswers, ...]:
    """Wrong answers with the same reason, apart from numbers, that are common enough."""
    groups: dict[str, list[str]] = {}
    for reason, answer in unnamed:
        groups.setdefault(" ".join(_NUMBER.sub("#", reason).split()), []).append(answer)
    kinds = [
        WrongAnswers(len(answers), reason[:_MOST_CHARACTERS], _common_code(answers))
        for reason, answers in groups.items()
        if len(answers) >= SMALLEST_GROUP
    ]
    return tuple(sorted(kinds, key=lambda kind: (-kind.count, kind.reason))[:MOST_KINDS])


def _common_code(answers: Sequence[str]) -> str:
    """The code that most of the answers have in common, if enough do."""
    found = Counter(filter(None, map(_without_comments, answers)))
    code, count = found.most_common(1)[0] if found else ("", 0)
    return code[:_MOST_CHARACTERS] if count >= SMALLEST_GROUP else ""


def _without_comments(answer: str) -> str:
    """Code without comments and empty lines; empty if it is too long, or no Python."""
    if len(answer) > MAX_CHARACTERS:
        return ""
    lines = answer.splitlines()
    try:
        for token in tokenize.generate_tokens(io.StringIO("\n".join(lines)).readline):
            if token.type == tokenize.COMMENT:
                row, column = token.start
                lines[row - 1] = lines[row - 1][:column]
    except (tokenize.TokenError, SyntaxError):
        return ""
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _enough(count: int) -> int | None:
    return count if count >= SMALLEST_GROUP else None
