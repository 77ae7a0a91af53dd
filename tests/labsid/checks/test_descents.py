"""Steps along the gradient: found from their end, by the numbers in the code, or from a path."""

import numpy as np
import pytest

from labsid.checks.answer_code import AnswerCode
from labsid.checks.descents import descent_of, gradient_factor

M, V = np.array([[3.0, 1.0], [1.0, 2.0]]), np.array([1.0, -2.0])


def walked(steps: int, factor: float) -> np.ndarray:
    """The end of so many steps from zero."""
    x = np.zeros(2)
    for _ in range(steps):
        x = x - factor * (M @ x - V)
    return x


@pytest.mark.parametrize(("times", "steps", "factor"), [(1.0, 10, 0.05), (2.0, 7, 0.1)])
def test_the_end_of_steps_is_told_by_the_numbers_of_the_code(times: float, steps: int, factor: float) -> None:
    code = AnswerCode(f"for _ in range({steps}):\n    x = x - {factor} * gradient(x)\n")
    assert descent_of(code, walked(steps, times * factor), M, V) == (steps, factor)


def test_other_numbers_and_other_ends_are_not() -> None:
    code = AnswerCode("for _ in range(11):\n    x = x - 0.05 * gradient(x)\n")
    assert descent_of(code, walked(10, 0.05), M, V) is None
    assert descent_of(AnswerCode("x = 0.05 * 10"), walked(10, 0.05), M, V) is None
    assert descent_of(None, walked(10, 0.05), M, V) is None


def test_a_singular_matrix_has_no_descent_that_ends() -> None:
    code = AnswerCode("for _ in range(10):\n    x = x - 0.05 * gradient(x)\n")
    assert descent_of(code, np.ones(2), np.ones((2, 2)), V) is None


def test_one_factor_of_all_steps() -> None:
    gradients = np.array([[1.0, 2.0], [-0.5, 3.0]])
    assert gradient_factor(-0.3 * gradients, gradients) == pytest.approx(0.3)
    assert gradient_factor(-np.array([[0.3], [0.2]]) * gradients, gradients) is None
    assert gradient_factor(0 * gradients, gradients) is None
    assert gradient_factor(-gradients[:, :1], gradients[:, :1]) is None  # in one unknown every step lies along it
