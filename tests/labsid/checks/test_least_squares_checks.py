"""What is special to the checks of the least-squares lecture; `test_lecture_checks.py` has what all lectures share."""

from collections.abc import Callable

import numpy as np
import pytest

from labsid.checks.assignments.least_squares import ASSIGNMENT
from labsid.checks.assignments.least_squares.forms_and_derivatives import trial_forms
from labsid.least_squares.quadratic_form import definiteness


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
def test_fit_powers_with_a_wrong_theta(theta: Callable, slip: str | None, solved: Callable, answers: Callable) -> None:
    right = solved("least-squares")["fit_powers"]
    assert callable(right)

    def fit_powers(x: np.ndarray, y: np.ndarray, powers: np.ndarray) -> tuple[np.ndarray, float]:
        found, sse = right(x, y, powers)
        return theta(found), sse

    verdict = ASSIGNMENT.question("ls-4-fits").verdict(answers(solved("least-squares") | {"fit_powers": fit_powers}, 1))
    assert not verdict.passed
    assert verdict.slip == slip
