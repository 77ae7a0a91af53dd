"""The least-squares lecture's checks in the notebook, and on many draws of the hidden inputs."""

import re
from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from labsid.checks import NoAnswer, Question
from labsid.checks.assignments._ls_forms import trial_forms
from labsid.checks.assignments.least_squares import ASSIGNMENT
from labsid.checks.values import Value, plain
from labsid.quadratic_form import definiteness
from labsid.record import Record

NAME = "least-squares"
RunNotebook = Callable[..., dict[str, str]]
QUESTIONS = [question.id for question in ASSIGNMENT.questions]


class Answers:
    """Asks the functions of a notebook, with inputs from a seed of its own."""

    def __init__(self, variables: dict[str, object], seed: int) -> None:
        self._variables = variables
        self.rng = np.random.default_rng(seed)

    @property
    def record(self) -> Record:
        raise AssertionError("this assignment has no record")

    def value(self, name: str) -> Value:
        return plain(self._variables[name])

    def call(self, name: str, *arguments: Value) -> Value:
        function = self._variables[name]
        assert callable(function)
        try:
            return plain(function(*arguments))
        except Exception as error:
            raise NoAnswer(str(error)) from error

    def known(self, name: str) -> Value:
        return self.value(name)


@pytest.fixture
def solved(notebook_cells: Callable) -> dict[str, object]:
    """The variables of the model solution, without the cells that only show something."""
    variables: dict[str, object] = {}
    for words, source in notebook_cells(NAME):
        if words.get("solution") or words["grade_id"] == "ls-setup":
            exec(source, variables)
    plt.close("all")
    return variables


def test_the_notebook_runs_and_its_solution_passes(shipped_record_path: Path, run_notebook: RunNotebook) -> None:
    assert run_notebook(NAME, shipped_record_path) == dict.fromkeys(QUESTIONS, "")


def test_every_check_of_an_empty_release_fails_kindly(shipped_record_path: Path, run_notebook: RunNotebook) -> None:
    said = run_notebook(NAME, shipped_record_path, release=True)
    assert list(said) == QUESTIONS
    for question, text in said.items():
        assert re.match(rf"{question}(:| starts from)", text), text
        assert "Error" not in text


@pytest.mark.parametrize("question", ASSIGNMENT.questions, ids=QUESTIONS)
def test_the_solution_passes_whatever_is_drawn(question: Question, solved: dict[str, object]) -> None:
    for seed in range(100):
        verdict = question.verdict(Answers(solved, seed))
        assert verdict.passed, (seed, verdict)


def test_the_trial_forms_are_of_the_kind_that_they_are_made_to_be() -> None:
    for seed in range(200):
        for M, kind in trial_forms(np.random.default_rng(seed)):
            eigenvalues = definiteness(M).eigenvalues
            clean = np.where(np.abs(eigenvalues) < 1e-12 * np.abs(eigenvalues).max(), 0, eigenvalues)
            assert definiteness(np.diag(clean)).kind == kind
            nonzero = np.abs(clean[clean != 0])
            assert nonzero.min() > 0.1, "too near to singular for a student's tolerance"


@pytest.mark.parametrize(
    ("theta", "slip"),
    [
        (lambda right: right[::-1], "order of theta"),
        (lambda right: right + 1, None),
    ],
)
def test_fit_powers_with_a_wrong_theta(theta: Callable, slip: str | None, solved: dict[str, object]) -> None:
    right = solved["fit_powers"]
    assert callable(right)

    def fit_powers(x: np.ndarray, y: np.ndarray, powers: np.ndarray) -> tuple[np.ndarray, float]:
        found, sse = right(x, y, powers)
        return theta(found), sse

    verdict = ASSIGNMENT.question("ls-4-fits").verdict(Answers(solved | {"fit_powers": fit_powers}, 1))
    assert not verdict.passed
    assert verdict.slip == slip


@pytest.mark.parametrize("returned", [None, 3.0, "text", (1, 2), np.zeros((2, 2, 2)), ((1.0,), "a"), [], {"a": 1}])
def test_odd_returns_get_a_reason_and_never_an_exception(returned: object, solved: dict[str, object]) -> None:
    odd = {name: (lambda *_: returned) if callable(value) else value for name, value in solved.items()}
    for question in ASSIGNMENT.questions:
        if question.id == "ls-4-figure-5":
            continue
        verdict = question.verdict(Answers(odd, 1))
        assert not verdict.passed, question.id
        assert verdict.reason
