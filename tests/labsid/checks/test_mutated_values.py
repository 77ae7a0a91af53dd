"""No check ends with an internal error, whatever stands in the place of a right value; answers in single precision."""

from collections.abc import Iterator

import numpy as np
import pytest
from mutated_values import failures
from one_answer import quietly, solve

from labsid.checks.notebook import NotebookAsk, assignment_names
from labsid.checks.question import Ask, Assignment, Question, given_values
from labsid.checks.values import Value
from labsid.checks.verdict import SINGLE_PRECISION, Verdict

pytestmark = pytest.mark.slow

CASES, SECONDS = 40, 0.7
"""For each question; ``python tests/mutated_values.py`` runs more."""


@pytest.mark.parametrize("name", assignment_names())
def test_no_check_ends_with_an_internal_error(name: str) -> None:
    solved = solve(name)
    found = {
        question.id: errors
        for question in solved.assignment.questions
        if (errors := list(failures(solved, question, CASES, SECONDS)))
    }
    assert found == {}


def test_an_internal_error_is_found() -> None:
    """A check that does not expect what it may be handed."""

    def careless(ask: Ask) -> Verdict:
        return Verdict(float(ask.value("Ts")) > 0, "")  # type: ignore[arg-type]

    solved = solve("lab-identification")
    (number, said), *_ = failures(solved, Question("lab-1a-sampling-time", careless), CASES, SECONDS)
    assert number >= 0
    assert "Error" in said


class SingleAsk(NotebookAsk):
    """Answers in single precision."""

    def value(self, name: str) -> Value:
        return _single(super().value(name))

    def call(self, name: str, *arguments: Value) -> Value:
        return _single(super().call(name, *arguments))


def _single(value: Value) -> Value:
    if isinstance(value, np.ndarray) and value.dtype == np.float64:
        return value.astype(np.float32)
    if isinstance(value, tuple):
        return tuple(map(_single, value))
    return value


def _judged_in_single_precision(assignment: Assignment) -> Iterator[tuple[str, Verdict]]:
    solved = solve(assignment.name)
    for question in assignment.questions:
        ask = SingleAsk(
            solved.kept[question.id].variables(["plt"]), solved.record, solved.known[question.id], question.id
        )
        ask.origin = solved.origin  # type: ignore[assignment]
        with quietly():
            yield question.id, question.verdict(ask)


@pytest.mark.parametrize("name", ["lab-identification", "least-squares", "postlab-model-order"])
def test_a_right_answer_in_single_precision_is_right_or_told_why_not(name: str) -> None:
    found = dict(_judged_in_single_precision(solve(name).assignment))
    refused = {question: verdict for question, verdict in found.items() if not verdict.passed}
    assert {verdict.slip for verdict in refused.values()} <= {SINGLE_PRECISION}
    assert len(refused) < len(found) / 2, list(refused)


def test_what_is_right_in_single_precision_goes_on_in_double_precision() -> None:
    solved = solve("lab-identification")
    question = solved.assignment.question("lab-2b-theta")
    variables = solved.kept[question.id].variables(["plt"])
    ask = SingleAsk(variables, solved.record, solved.known[question.id], question.id)
    assert question.verdict(ask).passed
    given = given_values(question, ask, passed=True)
    assert {value.dtype for value in given.values() if isinstance(value, np.ndarray)} == {np.dtype(np.float64)}


def test_what_is_wrong_in_single_precision_is_refused_with_the_reason() -> None:
    solved = solve("lab-identification")
    question = solved.assignment.question("lab-1c-offsets")
    variables = solved.kept[question.id].variables(["plt"])
    variables["y"] = (variables["y"] + 0.5).astype(np.float32)
    verdict = question.verdict(NotebookAsk(variables, solved.record, solved.known[question.id], question.id))
    assert (verdict.passed, verdict.slip) == (False, SINGLE_PRECISION)
