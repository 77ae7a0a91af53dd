"""The right angle of least squares, and the solutions that a missing rank leaves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsid.least_squares.curve_fit import EXAMPLE_2_1, LINE, power_regressors
from labsid.least_squares.projection import completed_square, project, projection_matrix, qr_solution, solution_set
from labsid.least_squares.solve import loss, normal_equations, solve_least_squares

cases = st.integers(1, 4).flatmap(
    lambda p: st.tuples(
        arrays(np.float64, (8, p), elements=st.integers(-9, 9).map(float)),
        arrays(np.float64, (8,), elements=st.integers(-9, 9).map(float)),
    )
)
PHI = power_regressors(EXAMPLE_2_1.x, LINE)


def test_three_ways_to_example_2_4():
    for solve in (normal_equations, qr_solution, lambda Phi, Y: solve_least_squares(Phi, Y).theta):
        np.testing.assert_allclose(solve(PHI, EXAMPLE_2_1.y), [1.1754386, 0.3333333], atol=5e-8)


def test_sustech_singular_normal_equations():
    solutions = solution_set([[1, 2], [2, 4]], [4, 8])
    assert solutions.rank == 1
    (direction,) = solutions.directions.T
    assert abs(direction @ [-2, 1]) == pytest.approx(np.sqrt(5))
    # [4, 0] + alpha [-2, 1], of which the shortest is [0.8, 1.6].
    np.testing.assert_allclose(solutions.theta, [0.8, 1.6])
    alpha = direction @ (np.array([4, 0]) - solutions.theta)
    np.testing.assert_allclose(solutions.theta + alpha * direction, [4, 0], atol=1e-13)


@given(cases)
@settings(max_examples=100, deadline=None)
def test_projection_is_symmetric_idempotent_and_leaves_a_right_angle(case):
    Phi, Y = case
    P = projection_matrix(Phi)
    np.testing.assert_allclose(P, P.T, atol=1e-12)
    np.testing.assert_allclose(P @ P, P, atol=1e-12)
    np.testing.assert_allclose(P @ Phi, Phi, atol=1e-11)
    assert np.trace(P) == pytest.approx(np.linalg.matrix_rank(Phi), abs=1e-10)
    shadow = project(Phi, Y)
    np.testing.assert_allclose(shadow.Y_hat, P @ Y, atol=1e-10)
    np.testing.assert_allclose(shadow.Y_hat + shadow.residual, Y, atol=1e-12)
    np.testing.assert_allclose(Phi.T @ shadow.residual, 0, atol=1e-9)
    assert shadow.Y_hat @ shadow.Y_hat == pytest.approx((np.linalg.norm(Y) * np.cos(shadow.angle)) ** 2, abs=1e-9)


@given(cases, st.floats(-5, 5))
@settings(max_examples=100, deadline=None)
def test_all_solutions_have_the_same_loss_and_the_given_one_is_the_shortest(case, alpha):
    Phi, Y = case
    solutions = solution_set(Phi, Y)
    assert solutions.directions.shape == (Phi.shape[1], Phi.shape[1] - np.linalg.matrix_rank(Phi))
    other = solutions.theta + solutions.directions @ np.full(solutions.directions.shape[1], alpha)
    assert loss(Phi, Y, other) == pytest.approx(loss(Phi, Y, solutions.theta), abs=1e-8)
    assert np.linalg.norm(other) >= np.linalg.norm(solutions.theta) - 1e-12


def test_y_within_the_columns_leaves_nothing():
    shadow = project(PHI, PHI @ [2, -1])
    np.testing.assert_allclose(shadow.residual, 0, atol=1e-13)
    assert shadow.angle == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("seed", range(10))
def test_qr_is_least_squares(seed):
    rng = np.random.default_rng(seed)
    Phi, Y = rng.standard_normal((20, 4)), rng.standard_normal(20)
    np.testing.assert_allclose(qr_solution(Phi, Y), solve_least_squares(Phi, Y).theta, rtol=1e-10)


@given(cases, arrays(np.float64, (4,), elements=st.floats(-3, 3)))
@settings(max_examples=100, deadline=None)
def test_the_completed_square_adds_up(case, tried):
    Phi, Y = case
    theta = tried[: Phi.shape[1]]
    minimum, excess = completed_square(Phi, Y, theta)
    assert excess >= 0
    assert minimum + excess == pytest.approx(2 * loss(Phi, Y, theta), rel=1e-9, abs=1e-8)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: qr_solution([[1, 1], [2, 2], [3, 3]], [1, 2, 3]), "full column rank .*; got rank 1 of 2 columns"),
        (lambda: qr_solution(PHI, [1, 2]), "Phi and Y must have equally many rows; got 5 and 2"),
        (lambda: completed_square(PHI, EXAMPLE_2_1.y, [1]), r"one entry per column of Phi \(2\); got 1"),
        (lambda: projection_matrix([1, 2]), "Phi must be a matrix"),
    ],
)
def test_what_does_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
