"""Eq. (8), the sound solution, and the appendix (A1)-(A6)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import approx_fprime
from scipy.stats import linregress

from labsid.least_squares.solve import loss, loss_gradient, normal_equations, solve_least_squares, two_equations

# Three equations, two unknowns, as in (A3). By hand: Phi'Phi = [[2, 1], [1, 2]], Phi'Y = [5, 6],
# theta = [[2, -1], [-1, 2]] / 3 @ [5, 6] = [4/3, 7/3], E = [-1/3, -1/3, 1/3], V = 1/6.
PHI = np.array([[1.0, 0], [0, 1], [1, 1]])
Y = np.array([1.0, 2, 4])
THETA = np.array([4 / 3, 7 / 3])


def test_three_equations_by_hand():
    np.testing.assert_allclose(normal_equations(PHI, Y), THETA, rtol=1e-14)
    fit = solve_least_squares(PHI, Y)
    np.testing.assert_allclose(fit.theta, THETA, rtol=1e-14)
    np.testing.assert_allclose(fit.residual, [-1 / 3, -1 / 3, 1 / 3], rtol=1e-13)
    assert fit.loss == pytest.approx(1 / 6)
    assert fit.sigma2 == pytest.approx(1 / 3)  # E'E / (3 - 2)
    np.testing.assert_allclose(fit.covariance, np.array([[2, -1], [-1, 2]]) / 9, rtol=1e-13)
    np.testing.assert_allclose(fit.stderr, np.sqrt([2 / 9, 2 / 9]), rtol=1e-13)
    assert fit.condition_number == pytest.approx(np.sqrt(3))
    assert (fit.rank, fit.status) == (2, "unique")


def test_line_and_quadratic_of_the_sustech_lecture_give_the_worked_values():
    x, y = np.array([1, 0.5, -2, 3, 2.5]), np.array([1.4, 1.2, -3.6, 6.8, 4.5])
    line = solve_least_squares(np.column_stack([x, np.ones(5)]), y)
    np.testing.assert_allclose(line.theta, [1.97096774, 0.08903226], atol=5e-9)
    quadratic = solve_least_squares(np.column_stack([np.ones(5), x, x**2]), y)
    np.testing.assert_allclose(quadratic.theta, [-0.26601423, 1.85886714, 0.11393832], atol=5e-9)


def test_covariance_and_standard_errors_agree_with_an_independent_regression():
    rng = np.random.default_rng(3)
    x = rng.uniform(-2, 5, 80)
    y = 1.5 * x - 0.7 + 0.3 * rng.standard_normal(80)
    fit = solve_least_squares(np.column_stack([x, np.ones(80)]), y)
    oracle = linregress(x, y)
    np.testing.assert_allclose(fit.theta, [oracle.slope, oracle.intercept], rtol=1e-12)
    np.testing.assert_allclose(fit.stderr, [oracle.stderr, oracle.intercept_stderr], rtol=1e-12)


def test_the_covariance_is_the_scatter_of_the_estimates():
    rng = np.random.default_rng(11)
    Phi = rng.standard_normal((50, 2)) @ [[1.0, 0.5], [0.0, 2.0]]
    fits = [solve_least_squares(Phi, Phi @ [1, -1] + 0.2 * rng.standard_normal(50)) for _ in range(3000)]
    scatter = np.cov(np.array([fit.theta for fit in fits]).T)
    np.testing.assert_allclose(scatter, 0.04 * np.linalg.inv(Phi.T @ Phi), rtol=0.15, atol=1e-5)
    assert np.mean([fit.sigma2 for fit in fits]) == pytest.approx(0.04, rel=0.01)


matrices = st.integers(1, 4).flatmap(
    lambda p: st.integers(p, 12).flatmap(
        lambda n: st.tuples(
            arrays(np.float64, (n, p), elements=st.integers(-10, 10).map(float)),
            arrays(np.float64, (n,), elements=st.integers(-10, 10).map(float)),
        )
    )
)


@given(matrices)
@settings(max_examples=300, deadline=None)
def test_the_residual_is_orthogonal_to_phi_and_the_gradient_zero(case):
    Phi, y = case
    fit = solve_least_squares(Phi, y)
    assert np.max(np.abs(Phi.T @ fit.residual)) < 1e-9
    assert np.max(np.abs(loss_gradient(Phi, y, fit.theta))) < 1e-9
    assert fit.loss == pytest.approx(loss(Phi, y, fit.theta), abs=1e-12)


@given(matrices)
@settings(max_examples=300, deadline=None)
def test_the_solution_is_that_of_numpy_of_minimum_norm_too(case):
    Phi, y = case
    fit = solve_least_squares(Phi, y)
    theta, _, rank, _ = np.linalg.lstsq(Phi, y, rcond=None)
    assert fit.rank == rank
    np.testing.assert_allclose(fit.theta, theta, atol=1e-8)
    assert (fit.status == "unique") == (fit.rank == Phi.shape[1])
    if fit.status == "rank-deficient":
        assert np.all(np.isnan(fit.stderr))


@given(matrices, st.floats(-3, 3), st.integers(0, 3))
@settings(max_examples=200, deadline=None)
def test_no_other_theta_has_a_smaller_loss(case, step, which):
    Phi, y = case
    theta = solve_least_squares(Phi, y).theta.copy()
    best = loss(Phi, y, theta)
    theta[which % theta.size] += step
    assert loss(Phi, y, theta) >= best - 1e-9 * (1 + best)


@pytest.mark.parametrize("seed", range(20))
def test_the_lesson_and_the_sound_solution_agree_on_a_well_conditioned_problem(seed):
    rng = np.random.default_rng(seed)
    Phi, y = rng.standard_normal((30, 4)), rng.standard_normal(30)
    np.testing.assert_allclose(normal_equations(Phi, y), solve_least_squares(Phi, y).theta, rtol=1e-10)


def test_the_sound_solution_keeps_the_digits_that_the_normal_equations_lose():
    x = np.linspace(0, 1, 50)
    Phi = np.vander(x, 9)
    theta = np.arange(1.0, 10)
    sound = np.max(np.abs(solve_least_squares(Phi, Phi @ theta).theta - theta))
    lesson = np.max(np.abs(normal_equations(Phi, Phi @ theta) - theta))
    assert np.linalg.cond(Phi) > 1e5
    assert sound < 1e-7
    assert lesson > 100 * sound


def test_rank_deficiency_is_a_status_with_the_shortest_solution():
    fit = solve_least_squares([[1, 1], [2, 2], [3, 3]], [2, 4, 6])
    assert (fit.rank, fit.status) == (1, "rank-deficient")
    np.testing.assert_allclose(fit.theta, [1, 1], rtol=1e-13)
    assert fit.condition_number > 1e15
    assert np.all(np.isnan(fit.covariance))


def test_all_zero_regressors_have_rank_0_and_an_infinite_condition_number():
    fit = solve_least_squares(np.zeros((3, 2)), [1, 2, 3])
    assert (fit.rank, fit.condition_number, fit.loss) == (0, np.inf, 7.0)
    np.testing.assert_array_equal(fit.theta, [0, 0])


def test_as_many_equations_as_unknowns_leave_no_error_to_estimate():
    fit = solve_least_squares([[2, 0], [0, 4]], [2, 4])
    np.testing.assert_allclose(fit.theta, [1, 1])
    assert np.isnan(fit.sigma2)
    assert np.all(np.isnan(fit.stderr))


def test_normal_equations_need_full_column_rank():
    message = "Phi'Phi must have an inverse; got a Phi of 2 columns with condition number"
    with pytest.raises(ValueError, match=message):
        normal_equations([[1, 1], [2, 2], [3, 3]], [1, 2, 3])


def test_normal_equations_say_when_squaring_lost_the_last_digit():
    # Full rank, yet Phi'Phi rounds to [[3, 3], [3, 3]].
    Phi = np.array([[1, 1], [1, 1 + 2**-30], [1, 1 - 2**-30]])
    assert solve_least_squares(Phi, [1, 2, 3]).status == "unique"
    with pytest.raises(ValueError, match=r"condition number .*, squared in Phi'Phi"):
        normal_equations(Phi, [1, 2, 3])


def test_two_equations_by_hand():
    # 2 a1 + a2 = 5, a1 + 3 a2 = 10: a = [1, 3].
    np.testing.assert_allclose(two_equations([[2, 1], [1, 3]], [5, 10]), [1, 3], rtol=1e-15)


@pytest.mark.parametrize("seed", range(10))
def test_two_equations_agree_with_numpy(seed):
    rng = np.random.default_rng(seed)
    U, y = rng.standard_normal((2, 2)), rng.standard_normal(2)
    np.testing.assert_allclose(two_equations(U, y), np.linalg.solve(U, y), rtol=1e-10)


def test_dependent_equations_have_no_single_solution():
    with pytest.raises(ValueError, match=r"must be independent; got determinant zero\. The solution is not unique"):
        two_equations([[0.1, 0.3], [0.2, 0.6]], [1, 2])


def test_two_equations_are_two():
    with pytest.raises(ValueError, match=r"U must have shape \(2, 2\); got \(3, 2\)\. For more equations use"):
        two_equations(PHI, Y)


def test_loss_by_hand():
    # At theta = 0 the error is Y: V = (1 + 4 + 16) / 2; its gradient is -Phi'Y.
    assert loss(PHI, Y, [0, 0]) == 10.5
    np.testing.assert_array_equal(loss_gradient(PHI, Y, [0, 0]), [-5, -6])


@pytest.mark.parametrize("seed", range(5))
def test_the_gradient_is_the_slope_of_the_loss(seed):
    rng = np.random.default_rng(seed)
    Phi, y, theta = rng.standard_normal((9, 3)), rng.standard_normal(9), rng.standard_normal(3)
    slope = approx_fprime(theta, lambda x: loss(Phi, y, x), 1e-7)
    np.testing.assert_allclose(loss_gradient(Phi, y, theta), slope, atol=1e-4)


@pytest.mark.parametrize("solve", [normal_equations, solve_least_squares])
@pytest.mark.parametrize(
    ("Phi", "y", "message"),
    [
        (PHI, [1, 2], "Phi and Y must have equally many rows; got 3 and 2"),
        ([1, 2, 3], [1, 2, 3], r"Phi must be a matrix with one row per equation; got shape \(3,\)"),
        ([[1, 2, 3]], [1], r"Phi must have at least as many rows as unknowns \(3\); got 1"),
        ([[1.0], [np.nan]], [1, 2], "Phi must be finite; got NaN or infinity"),
        ([[1.0], [2.0]], [1, np.inf], "Y must be finite; got inf at sample 1"),
    ],
)
def test_shapes_that_do_not_fit(solve, Phi, y, message):
    with pytest.raises(ValueError, match=message):
        solve(Phi, y)


@pytest.mark.parametrize("function", [loss, loss_gradient])
def test_theta_must_fit_phi(function):
    with pytest.raises(ValueError, match=r"theta must have one entry per column of Phi \(2\); got 3"):
        function(PHI, Y, [1, 2, 3])
