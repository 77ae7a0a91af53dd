"""Gauss-Newton and Levenberg-Marquardt against scipy, and where the first fails."""

import numpy as np
import pytest
from scipy.optimize import least_squares as scipy_least_squares

from labsid.least_squares.gradients import numerical_jacobian
from labsid.least_squares.solve import solve_least_squares
from labsid.nonlinear.solve import gauss_newton, levenberg_marquardt

SOLVERS = [gauss_newton, levenberg_marquardt]


def sustech_g(theta):
    """The example of the lecture's first slides."""
    return np.array([np.sin(theta[0]), np.cos(theta[0]), theta[0] - theta[1]])


def sustech_jacobian(theta):
    return np.array([[np.cos(theta[0]), 0], [-np.sin(theta[0]), 0], [1, -1]])


def linear(seed):
    rng = np.random.default_rng(seed)
    return rng.standard_normal((8, 3)), rng.standard_normal(8)


@pytest.mark.parametrize("solve", SOLVERS)
def test_a_linear_function_is_linear_least_squares_standard_errors_included(solve):
    H, y = linear(0)
    fit, oracle = solve(lambda th: H @ th, lambda th: H, y, np.zeros(3)), solve_least_squares(H, y)
    assert fit.status == "converged"
    np.testing.assert_allclose(fit.theta, oracle.theta, rtol=1e-8)
    np.testing.assert_allclose(fit.stderr, oracle.stderr, rtol=1e-8)
    assert fit.sse == pytest.approx(2 * oracle.loss)
    if solve is gauss_newton:
        assert len(fit.path) == 2  # one step, as the function is its own linearisation


@pytest.mark.parametrize("solve", SOLVERS)
@pytest.mark.parametrize("seed", range(5))
def test_scipy_finds_the_same(solve, seed):
    y = sustech_g([0.7, -1.0]) + 0.1 * np.random.default_rng(seed).standard_normal(3)
    fit = solve(sustech_g, sustech_jacobian, y, [0.3, 0.0])
    oracle = scipy_least_squares(lambda th: y - sustech_g(th), [0.3, 0.0], xtol=1e-15, ftol=1e-15, gtol=1e-12)
    assert fit.status == "converged"
    np.testing.assert_allclose(fit.theta, oracle.x, atol=1e-7)
    assert fit.sse == pytest.approx(2 * oracle.cost, rel=1e-9)
    np.testing.assert_allclose(sustech_jacobian(fit.theta), numerical_jacobian(sustech_g, fit.theta), atol=1e-9)


def exponential(x, y):
    return (
        lambda th: th[1] * np.exp(th[0] * x),
        lambda th: np.column_stack([th[1] * x * np.exp(th[0] * x), np.exp(th[0] * x)]),
        y,
    )


@pytest.mark.parametrize("start", [[0.0, 1.0], [2.0, 1.0], [-1.0, 1.0], [5.0, -3.0]])
def test_levenberg_marquardt_arrives_from_afar_downhill_all_the_way(start):
    x = np.array([1, 0.5, -2, 3, 2.5])
    problem = exponential(x, np.array([1.4, 1.2, -3.6, 6.8, 4.5]))
    fit = levenberg_marquardt(*problem, start)
    assert fit.status == "converged"
    np.testing.assert_allclose(fit.theta, [0.88402534, 0.48571061], atol=1e-7)
    assert np.all(np.diff(fit.path_sse) <= 1e-12 * fit.path_sse[:-1])
    np.testing.assert_array_equal(fit.path[-1], fit.theta)


def test_gauss_newton_overshoots_where_levenberg_marquardt_shortens_the_step():
    def slope(theta):
        return np.array([[1 / (1 + theta[0] ** 2)]])

    whole, shortened = gauss_newton(np.arctan, slope, [0.5], [3.0]), levenberg_marquardt(np.arctan, slope, [0.5], [3.0])
    assert whole.status == "diverged"
    np.testing.assert_array_equal(whole.theta, [3.0])  # the best met is the start
    assert shortened.status == "converged"
    assert shortened.theta[0] == pytest.approx(np.tan(0.5))


def test_rosenbrock():
    g, jacobian = (
        lambda th: np.array([10 * (th[1] - th[0] ** 2), 1 - th[0]]),
        lambda th: np.array([[-20 * th[0], 10], [-1, 0]]),
    )
    fit = levenberg_marquardt(lambda th: g(th) + 1, jacobian, [1, 1], [-1.2, 1.0])
    assert fit.status == "converged"
    np.testing.assert_allclose(fit.theta, [1, 1], rtol=1e-9)
    assert len(fit.path) < 40


def test_units_of_theta_do_not_matter():
    x = np.linspace(0, 3, 20)
    y = 2 * np.exp(-x) + 0.01 * np.random.default_rng(0).standard_normal(20)
    g, jacobian, _ = exponential(x, y)
    scale = np.array([1e-6, 1e6])
    plain = levenberg_marquardt(g, jacobian, y, [0.0, 1.0])
    scaled = levenberg_marquardt(
        lambda th: g(th * scale), lambda th: jacobian(th * scale) * scale, y, [0.0, 1.0] / scale
    )
    assert scaled.status == "converged"
    np.testing.assert_allclose(scaled.theta * scale, plain.theta, rtol=1e-8)
    np.testing.assert_allclose(scaled.stderr * scale, plain.stderr, rtol=1e-6)


def test_standard_errors_are_the_scatter_of_the_estimates():
    x, rng = np.linspace(0, 2, 25), np.random.default_rng(1)
    fits = []
    for _ in range(400):
        y = 1.5 * np.exp(-0.8 * x) + 0.05 * rng.standard_normal(25)
        fits.append(levenberg_marquardt(*exponential(x, y), [0.0, 1.0]))
    assert {fit.status for fit in fits} == {"converged"}
    scatter = np.std([fit.theta for fit in fits], axis=0)
    np.testing.assert_allclose(scatter, np.mean([fit.stderr for fit in fits], axis=0), rtol=0.12)


@pytest.mark.parametrize("solve", SOLVERS)
def test_parameters_that_only_occur_as_a_product_are_not_determined(solve):
    x = np.arange(1.0, 5)
    fit = solve(lambda th: th[0] * th[1] * x, lambda th: np.column_stack([th[1] * x, th[0] * x]), 6 * x, [2.0, 2.0])
    assert fit.status == "not determined"
    assert np.prod(fit.theta) == pytest.approx(6)
    assert np.all(np.isnan(fit.stderr))


def test_steps_that_run_out_are_said():
    x = np.array([1, 0.5, -2, 3, 2.5])
    problem = exponential(x, np.array([1.4, 1.2, -3.6, 6.8, 4.5]))
    for solve in SOLVERS:
        fit = solve(*problem, [0.8, 0.5], steps=1)
        assert fit.status == "not converged"
        assert np.all(np.isnan(fit.covariance))


def test_leaving_the_range_of_numbers_is_divergence_for_one_and_a_shorter_step_for_the_other():
    x = np.array([0.0, 1.0, 2.0])
    problem = exponential(x, np.array([1.0, 50.0, 3000.0]))
    start = [0.1, 0.001]  # the first whole step asks for e^(thousands)
    assert gauss_newton(*problem, start).status == "diverged"
    fit = levenberg_marquardt(*problem, start)
    assert fit.status == "converged"
    assert fit.theta[0] == pytest.approx(4.1, abs=0.1)


@pytest.mark.parametrize("solve", SOLVERS)
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.sin, np.cos, [1], [1, 2]), r"at least as many measurements as unknowns \(2\); got 1"),
        ((np.sin, np.cos, [1, 2], [1]), r"g\(theta\) must have shape \(2,\); got \(1,\)"),
        ((np.sin, np.cos, [1], [1]), r"jacobian\(theta\) must have shape \(1, 1\); got \(1,\)"),
        ((lambda th: th * np.inf, lambda th: np.eye(1), [1], [1]), r"must be finite at theta0 = \[1\.0\]\. Start else"),
        ((np.sin, np.cos, [1], [np.nan]), "theta0 must be finite"),
        ((np.sin, np.cos, [1], [1], 0), "steps must be at least 1; got 0"),
    ],
)
def test_what_cannot_start(solve, arguments, message):
    with pytest.raises(ValueError, match=message):
        solve(*arguments)
