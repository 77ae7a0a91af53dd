"""Hand-ins with nearly all answers equal, in a class of any size: found by question and by structure.

Two answers to a question are equal if their code has the same normal form, as in `autograder.results.similar`. How many
others wrote the same does not count: in a small class a few students who share their work are most of those who did.
So nearly all answers must be equal, and they must be enough of them, and of enough code.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import connected_components

from autograder.judge.outcome import QuestionResult
from autograder.results.result_files import StoredResult
from autograder.results.similar import MIN_NOTEBOOK_NODES

MIN_ANSWERS = 5
"""Hand-ins with fewer equal answers are not reported."""

MIN_SHARE = 0.85
"""Smallest share of the answers that are equal, and of their code."""


@dataclass(frozen=True, slots=True)
class NearlyEqual:
    """Hand-ins of one assignment, each of which has nearly all answers equal to those of another one.

    Attributes
    ----------
    assignment : str
    students : tuple of str
    fewest, most : int
        Number of equal answers of the pairs that were found.
    compared : int
        Number of answers of the pair with the fewest equal ones.
    different : tuple of str
        The questions that not all of them answered equally.
    to_the_letter : int
        Number of questions in which the answers of all of them are equal as text, comments and own names included.
    same_mistakes : tuple of str
        Questions without full marks in which the answers of all of them are equal.
    """

    assignment: str
    students: tuple[str, ...]
    fewest: int
    most: int
    compared: int
    different: tuple[str, ...]
    to_the_letter: int
    same_mistakes: tuple[str, ...]


def find_nearly_equal(stored: Iterable[StoredResult]) -> list[NearlyEqual]:
    """Find hand-ins with nearly all answers equal, largest groups first.

    Hand-ins with all answers equal are found by `autograder.results.similar.find_equal`; a group of which all are equal
    is left out here.
    """
    by_assignment: dict[str, list[StoredResult]] = {}
    for one in stored:
        if one.work:
            by_assignment.setdefault(one.assignment, []).append(one)
    found = [group for submissions in by_assignment.values() for group in _groups(submissions)]
    return sorted(found, key=lambda group: (-len(group.students), -group.fewest, group.assignment, group.students))


def _groups(submissions: Sequence[StoredResult]) -> list[NearlyEqual]:
    """The groups of one assignment."""
    pairs = _pairs(submissions)
    linked = np.zeros((len(submissions), len(submissions)), bool)
    for pair in pairs:
        linked[pair] = True
    count, group_of = connected_components(linked, directed=False)
    groups = []
    for number in range(count):
        group = np.flatnonzero(group_of == number).tolist()
        inside = {pair: counts for pair, counts in pairs.items() if pair[0] in group}
        if any(equal < compared for equal, compared in inside.values()):
            groups.append(_described([submissions[index] for index in group], list(inside.values())))
    return groups


def _pairs(submissions: Sequence[StoredResult]) -> dict[tuple[int, int], tuple[int, int]]:
    """Number of equal answers, and of answers, of each pair of submissions that is nearly equal."""
    questions = list(dict.fromkeys(question for submission in submissions for question in submission.work))
    column = {question: index for index, question in enumerate(questions)}
    numbers: dict[str, int] = {}
    form = np.zeros((len(submissions), len(questions)), dtype=np.int64)  # 0 where there is no answer
    size = np.zeros((len(submissions), len(questions)), dtype=np.int64)  # syntax tree nodes
    for row, submission in enumerate(submissions):
        for question, (digest, nodes) in submission.work.items():
            form[row, column[question]] = numbers.setdefault(digest, len(numbers) + 1)
            size[row, column[question]] = nodes
    answers, nodes_of = np.count_nonzero(form, axis=1), size.sum(axis=1)
    pairs = {}
    for row in range(len(submissions) - 1):
        same = (form[row + 1 :] == form[row]) & (form[row] > 0)
        equal, code = np.count_nonzero(same, axis=1), (same * size[row]).sum(axis=1)
        compared = np.minimum(answers[row + 1 :], answers[row])
        is_enough = (equal >= MIN_ANSWERS) & (code >= MIN_NOTEBOOK_NODES)
        is_nearly_all = (equal >= MIN_SHARE * compared) & (
            code >= MIN_SHARE * np.minimum(nodes_of[row + 1 :], nodes_of[row])
        )
        for later in np.flatnonzero(is_enough & is_nearly_all):
            pairs[row, row + 1 + int(later)] = int(equal[later]), int(compared[later])
    return pairs


def _described(group: Sequence[StoredResult], counts: Sequence[tuple[int, int]]) -> NearlyEqual:
    fewest, compared = min(counts)
    first, *others = group
    asked = list(dict.fromkeys(question for member in group for question in member.work))
    equal = [name for name in asked if all(member.work.get(name) == first.work.get(name) for member in others)]
    results = [{question.question: question for question in member.questions} for member in group]
    texts = {name: {" ".join(of[name].answer.split()) for of in results if name in of} for name in equal}
    wrong = [name for name in equal if all(name in of and _has_lost_marks(of[name]) for of in results)]
    return NearlyEqual(
        first.assignment,
        tuple(member.student for member in group),
        fewest,
        max(counts)[0],
        compared,
        tuple(name for name in asked if name not in equal),
        sum(len(distinct) == 1 for distinct in texts.values()),
        tuple(wrong),
    )


def _has_lost_marks(question: QuestionResult) -> bool:
    return question.score is not None and question.score < question.max_score
