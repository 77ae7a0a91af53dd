"""Derivatives found by hand against finite differences."""

import numpy as np
import pytest
from scipy.differentiate import jacobian as scipy_jacobian

from labsid.least_squares.gradients import (
    directional_derivative,
    gradient_of_sse,
    gradient_quadratic,
    jacobian_cubic,
    jacobian_linear,
    numerical_jacobian,
)
from labsid.least_squares.solve import loss_gradient, solve_least_squares

SEEDS = range(10)


def test_by_hand():
    np.testing.assert_array_equal(jacobian_linear([[1, 2], [3, 4], [5, 6]]), [[1, 2], [3, 4], [5, 6]])
    np.testing.assert_array_equal(gradient_quadratic([[1, 2], [0, 3]], [1, 1]), [4, 8])
    # f1 = (x1^2 + x2^2) x1: df1/dx1 = 3 x1^2 + x2^2, df1/dx2 = 2 x1 x2.
    np.testing.assert_array_equal(jacobian_cubic([1, 2]), [[7, 4], [4, 13]])


@pytest.mark.parametrize("seed", SEEDS)
def test_derivatives_are_the_finite_differences(seed):
    rng = np.random.default_rng(seed)
    A, S, x = rng.standard_normal((2, 3)), rng.standard_normal((3, 3)), rng.standard_normal(3)
    H, y = rng.standard_normal((5, 3)), rng.standard_normal(5)
    for by_hand, f in (
        (jacobian_linear(A), lambda x: A @ x),
        (gradient_quadratic(S, x), lambda x: x @ S @ x),
        (jacobian_cubic(x), lambda x: (x @ x) * x),
        (gradient_of_sse(H, y, x), lambda x: np.sum((y - H @ x) ** 2)),
    ):
        np.testing.assert_allclose(by_hand, numerical_jacobian(f, x), atol=1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_symmetric_quadratic_gradient_is_2_a_x(seed):
    rng = np.random.default_rng(seed)
    S, x = rng.standard_normal((3, 3)), rng.standard_normal(3)
    S = S + S.T
    np.testing.assert_allclose(gradient_quadratic(S, x), 2 * S @ x, rtol=1e-12)


def test_numerical_jacobian_is_scipys():
    x = np.array([0.3, -1.2])

    def f(x):
        return np.array([np.sin(x[0]), np.cos(x[0]), x[0] * x[1]])

    np.testing.assert_allclose(numerical_jacobian(f, x), scipy_jacobian(f, x).df, atol=1e-9)


def test_numerical_jacobian_copes_with_large_x():
    np.testing.assert_allclose(numerical_jacobian(lambda x: x @ x, [1e6, -2e6]), [2e6, -4e6], rtol=1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_directional_derivative_is_the_gradient_along_the_direction_length_included(seed):
    rng = np.random.default_rng(seed)
    A, x, d = rng.standard_normal((3, 3)), rng.standard_normal(3), 100 * rng.standard_normal(3)
    slope = directional_derivative(lambda x: x @ A @ x, x, d)
    assert slope == pytest.approx(gradient_quadratic(A, x) @ d, rel=1e-7)
    assert directional_derivative(lambda x: x @ A @ x, x, 2 * d) == pytest.approx(2 * slope, rel=1e-7)


def test_gradient_of_sse_is_zero_at_the_solution_and_twice_the_labs():
    rng = np.random.default_rng(3)
    H, y, theta = rng.standard_normal((8, 2)), rng.standard_normal(8), rng.standard_normal(2)
    np.testing.assert_allclose(gradient_of_sse(H, y, solve_least_squares(H, y).theta), 0, atol=1e-13)
    np.testing.assert_allclose(gradient_of_sse(H, y, theta), 2 * loss_gradient(H, y, theta), rtol=1e-13)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: gradient_quadratic(np.eye(2), [1, 2, 3]), r"x must have as many entries as A has rows \(2\); got 3"),
        (lambda: directional_derivative(np.sum, [1, 2], [0, 0]), "d must be a direction with 2 entries, not all zero"),
        (lambda: directional_derivative(np.sum, [1, 2], [1]), "d must be a direction with 2 entries"),
        (
            lambda: gradient_of_sse(np.eye(2), [1, 2], [1]),
            r"a row for each of y \(2\) and a column .* theta \(1\); got",
        ),
        (lambda: jacobian_linear([1, 2]), "A must be a matrix"),
    ],
)
def test_what_does_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
