"""The checks of the five lectures: the solution passes whatever is drawn, and nothing that comes back breaks one."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from labsid.checks import Question
from labsid.checks.notebook import load_assignment
from labsid.checks.question import FollowsFrom

LECTURES = (
    "least-squares",
    "model-structures",
    "recursive-identification",
    "armax-and-instruments",
    "nonlinear-least-squares",
    "several-signals",
)
QUESTIONS = [
    pytest.param(name, question, id=question.id) for name in LECTURES for question in load_assignment(name).questions
]
SEEDS = 15
ODD = (None, 3.0, "text", (1, 2), np.zeros((2, 2, 2)), ((1.0,), "a"), [], {"a": 1}, np.full(3, np.nan), 1j, True)

RunNotebook = Callable[..., dict[str, str]]
Solved = Callable[[str], dict[str, object]]


def ids(name: str) -> list[str]:
    return [question.id for question in load_assignment(name).questions]


@pytest.mark.parametrize("name", LECTURES)
def test_every_check_of_an_empty_release_fails_kindly(
    name: str, shipped_record_path: Path, run_notebook: RunNotebook
) -> None:
    said = run_notebook(name, shipped_record_path, release=True)
    assert list(said) == ids(name)
    for question, text in said.items():
        assert re.match(rf"{question}:", text), text
        assert "Error" not in text


@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_the_solution_passes_whatever_is_drawn(
    name: str, question: Question, solved: Solved, answers: Callable
) -> None:
    for seed in range(SEEDS):
        verdict = question.verdict(answers(solved(name), seed))
        assert verdict.passed, (seed, verdict)


@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_odd_returns_get_a_reason_and_never_an_exception(
    name: str, question: Question, solved: Solved, answers: Callable
) -> None:
    for returned in ODD:
        odd = {name: (lambda *_, it=returned: it) if callable(value) else value for name, value in solved(name).items()}
        verdict = question.verdict(answers(odd, 1))
        assert verdict.reason
        assert not verdict.passed or "figure" in question.id or question.follows_from is FollowsFrom.TEXT


@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_odd_variables_get_a_reason_and_never_an_exception(
    name: str, question: Question, solved: Solved, answers: Callable
) -> None:
    for value in ODD:
        odd = {name: known if callable(known) else value for name, known in solved(name).items()}
        asked = answers(odd, 1)
        asked.known = answers(solved(name), 1).value  # the judge makes sure of these
        assert question.verdict(asked).reason
