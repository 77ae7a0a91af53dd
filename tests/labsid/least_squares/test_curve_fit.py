"""The printed curve fits, and polyfit."""

import numpy as np
import pytest

from labsid.least_squares.curve_fit import EXAMPLE_2_1, LINE, PARABOLA, SUSTECH_POINTS, fit_powers, power_regressors


@pytest.mark.parametrize(
    ("points", "powers", "theta"),
    [
        (EXAMPLE_2_1, LINE, [1.1754386, 0.3333333]),
        (EXAMPLE_2_1, PARABOLA, [-0.1038961, 1.995671, -0.8095238]),
        (SUSTECH_POINTS, LINE, [1.97096774, 0.08903226]),
        (SUSTECH_POINTS, (0, 1, 2), [-0.26601423, 1.85886714, 0.11393832]),
    ],
)
def test_worked_values(points, powers, theta):
    np.testing.assert_allclose(fit_powers(points.x, points.y, powers).theta, theta, atol=5e-8)


def test_the_regressors_of_example_2_4_and_its_normal_equations():
    Phi = power_regressors(EXAMPLE_2_1.x, LINE)
    np.testing.assert_array_equal(Phi, [[1, 1], [2, 1], [4, 1], [5, 1], [7, 1]])
    np.testing.assert_array_equal(Phi.T @ Phi, [[95, 19], [19, 5]])
    np.testing.assert_array_equal(Phi.T @ EXAMPLE_2_1.y, [118, 24])


@pytest.mark.parametrize("degree", [0, 1, 3])
def test_polyfit_agrees(degree):
    rng = np.random.default_rng(degree)
    x, y = rng.standard_normal(30), rng.standard_normal(30)
    powers = range(degree, -1, -1)
    np.testing.assert_allclose(fit_powers(x, y, powers).theta, np.polyfit(x, y, degree), rtol=1e-9)


def test_too_few_different_points_do_not_determine_the_curve():
    assert fit_powers([1, 1, 2, 2], [1, 2, 3, 4], PARABOLA).status == "rank-deficient"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: power_regressors([1, 2], []), r"powers must be different exponents, zero or more; got \[\]"),
        (lambda: power_regressors([1, 2], [1, 1]), r"got \[1, 1\]"),
        (lambda: power_regressors([1, 2], [-1, 0]), r"got \[-1, 0\]"),
        (lambda: fit_powers([1, 2], [1], LINE), "x and y must have equal length; got 2 and 1"),
        (lambda: fit_powers([1], [1], LINE), r"at least as many rows as unknowns \(2\); got 1"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
