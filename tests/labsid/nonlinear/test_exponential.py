"""Both exponential fits: on the printed data, and where they differ."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import curve_fit

from labsid.least_squares.curve_fit import SUSTECH_POINTS
from labsid.nonlinear.exponential import evaluate_exponential, fit_exponential, fit_exponential_by_logarithm


def test_worked_value_on_the_printed_data():
    fit = fit_exponential(SUSTECH_POINTS.x, SUSTECH_POINTS.y)
    np.testing.assert_allclose(fit.theta, [0.88402534, 0.48571061], atol=5e-9)
    assert fit.sse == pytest.approx(13.8246, abs=5e-5)
    assert fit.status == "converged"
    np.testing.assert_allclose(
        fit.residual, SUSTECH_POINTS.y - evaluate_exponential(SUSTECH_POINTS.x, *fit.theta), atol=1e-12
    )


def test_the_printed_data_have_no_logarithm():
    with pytest.raises(
        ValueError, match=r"y must be positive to have a logarithm; got -3\.6 at point 2\. Use fit_expo"
    ):
        fit_exponential_by_logarithm(SUSTECH_POINTS.x, SUSTECH_POINTS.y)


def test_without_the_third_point_the_logarithm_works_and_is_not_the_least_squares_curve():
    x, y = np.delete(SUSTECH_POINTS.x, 2), np.delete(SUSTECH_POINTS.y, 2)
    line, curve = fit_exponential_by_logarithm(x, y), fit_exponential(x, y)
    np.testing.assert_allclose([line.a, np.log(line.b)], np.polyfit(x, np.log(y), 1), rtol=1e-10)
    assert line.sse > curve.sse
    assert line.log_residual @ line.log_residual < np.sum(
        (np.log(y) - np.log(evaluate_exponential(x, *curve.theta))) ** 2
    )


@given(
    st.floats(-3, 3).filter(lambda a: abs(a) > 0.01),
    st.sampled_from([-20.0, -1.0, 0.003, 1.0, 500.0]),
    st.sampled_from([0.0, -3.0, 10.0]),
)
@example(2.5625, 500.0, 10.0)  # derivatives by a and by b of which one is 10^15 times the other
@settings(max_examples=60, deadline=None)
def test_exact_data_give_the_truth(a, b, shift):
    x = np.linspace(0, 2, 9) + shift
    y = evaluate_exponential(x, a, b)
    fit = fit_exponential(x, y)
    assert fit.status == "converged"
    np.testing.assert_allclose(fit.theta, [a, b], rtol=1e-6)
    if b > 0:
        line = fit_exponential_by_logarithm(x, y)
        np.testing.assert_allclose([line.a, line.b], [a, b], rtol=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_scipy_finds_the_same_with_the_same_covariance(seed):
    x = np.linspace(4, 7, 30)
    y = evaluate_exponential(x, -0.7, 30.0) + 0.05 * np.random.default_rng(seed).standard_normal(30)
    fit = fit_exponential(x, y)
    theta, covariance = curve_fit(evaluate_exponential, x, y, p0=fit.theta * 1.02, xtol=1e-14, ftol=1e-14)
    np.testing.assert_allclose(fit.theta, theta, rtol=1e-5)
    np.testing.assert_allclose(fit.covariance, covariance, rtol=1e-3)
    np.testing.assert_allclose(fit.path[-1], fit.theta)


def test_the_logarithm_is_biased_by_noise_that_is_the_same_on_all_points():
    x, rng = np.linspace(0, 3, 40), np.random.default_rng(3)
    lines, curves = [], []
    for _ in range(100):
        y = np.maximum(evaluate_exponential(x, -1.0, 2.0) + 0.05 * rng.standard_normal(40), 1e-3)
        lines.append(fit_exponential_by_logarithm(x, y).a)
        curves.append(fit_exponential(x, y).theta[0])
    assert abs(np.mean(curves) + 1) < 0.01
    assert abs(np.mean(lines) + 1) > 0.05


@pytest.mark.parametrize("fit", [fit_exponential, fit_exponential_by_logarithm])
@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ([1, 1, 1], [1, 2, 3], "x must take at least two values; got 1 throughout"),
        ([1, 2], [1, 2, 3], "x and y must have equal length; got 2 and 3"),
    ],
)
def test_points_that_are_no_curve(fit, x, y, message):
    with pytest.raises(ValueError, match=message):
        fit(x, y)


@pytest.mark.parametrize("a", [1.0, -1.0])
def test_a_b_out_of_range_is_said(a):
    x = np.linspace(10_000, 10_002, 9)
    with pytest.raises(ValueError, match=r"x must lie nearer to zero, .* around 10001 with a = .* Subtract a constant"):
        fit_exponential(x, np.exp(a * (x - 10_001)))
