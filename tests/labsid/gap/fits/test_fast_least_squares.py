"""Least squares by normal equations: against numpy's, and where columns are equal or zero."""

import numpy as np
import pytest

from labsid.gap.fits.fast_least_squares import scaled_gram, solve_least_squares, solve_positive_definite


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("scales", [(1.0, 1.0, 1.0), (1e-6, 1.0, 1e5)])
def test_the_solution_equals_least_squares_at_any_scaling(order: str, scales: tuple[float, ...]) -> None:
    rng = np.random.default_rng(0)
    Phi = np.array(rng.standard_normal((200, 3)) * scales, order=order)  # type: ignore[call-overload]
    y = rng.standard_normal(200)
    np.testing.assert_allclose(solve_least_squares(Phi, y), np.linalg.lstsq(Phi, y, rcond=None)[0], rtol=1e-8)


def test_equal_and_empty_columns_share_the_answer() -> None:
    x = np.arange(1.0, 6.0)
    Phi = np.column_stack([x, x, np.zeros(5)])
    gains = solve_least_squares(Phi, 4.0 * x)
    np.testing.assert_allclose(gains, [2.0, 2.0, 0.0], atol=1e-4)


def test_gram_has_ones_on_its_diagonal() -> None:
    gram, scale = scaled_gram(np.array([[3.0, 1.0], [4.0, 0.0]]))
    np.testing.assert_allclose(scale, [5.0, 1.0])
    np.testing.assert_allclose(gram, [[1.0, 0.6], [0.6, 1.0]])


def test_singular_normal_equations_are_solved() -> None:
    gram = np.array([[0.0, 1.0], [1.0, 0.0]])
    np.testing.assert_allclose(solve_positive_definite(gram, np.array([2.0, 3.0])), [3.0, 2.0])
