"""Confidence intervals: their width against statsmodels, their coverage by counting."""

import numpy as np
import pytest
import statsmodels.api as sm

from labsid.least_squares.intervals import confidence_intervals, parameter_covariance
from labsid.least_squares.solve import solve_least_squares


@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
def test_intervals_are_those_of_statsmodels(confidence):
    rng = np.random.default_rng(0)
    Phi, Y = rng.standard_normal((9, 3)), rng.standard_normal(9)
    intervals = confidence_intervals(solve_least_squares(Phi, Y), confidence)
    oracle = sm.OLS(Y, Phi).fit().conf_int(1 - confidence)
    np.testing.assert_allclose(np.column_stack([intervals.lower, intervals.upper]), oracle, rtol=1e-9)
    assert intervals.degrees_of_freedom == 6


def test_nineteen_intervals_in_twenty_hold_the_truth_where_the_normal_quantile_would_miss_more():
    rng = np.random.default_rng(1)
    Phi, truth = rng.standard_normal((5, 2)), np.array([1.0, -2.0])
    held, narrow = [], []
    for _ in range(4000):
        fit = solve_least_squares(Phi, Phi @ truth + rng.standard_normal(5))
        intervals = confidence_intervals(fit)
        held.append((intervals.lower <= truth) & (truth <= intervals.upper))
        narrow.append(np.abs(fit.theta - truth) <= 1.96 * fit.stderr)
    # The standard error of a share of 0.95 in 4000 draws is 0.0034.
    np.testing.assert_allclose(np.mean(held, axis=0), 0.95, atol=0.014)
    assert np.all(np.mean(narrow, axis=0) < 0.9)


def test_known_variance_gives_lemma_1():
    Phi = np.array([[1.0, 0], [0, 2], [0, 0]])
    np.testing.assert_allclose(parameter_covariance(Phi, 0.5), [[0.5, 0], [0, 0.125]])
    rng = np.random.default_rng(2)
    Phi = rng.standard_normal((30, 3))
    np.testing.assert_allclose(parameter_covariance(Phi, 2.0), 2 * np.linalg.inv(Phi.T @ Phi), rtol=1e-10)
    # Twice the record, half the covariance.
    np.testing.assert_allclose(parameter_covariance(np.vstack([Phi, Phi]), 2.0), parameter_covariance(Phi, 1.0))


def test_no_standard_error_no_interval():
    for fit in (
        solve_least_squares([[1, 0], [0, 1]], [1, 2]),
        solve_least_squares([[1, 1], [2, 2], [3, 3]], [1, 2, 3]),
    ):
        assert np.all(np.isnan(confidence_intervals(fit).lower))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: confidence_intervals(solve_least_squares([[1], [1]], [1, 2]), 95),
            "between 0 and 1; got 95. For 95 % give",
        ),
        (lambda: parameter_covariance([[1]], -1), "sigma2 must be a variance, zero or more; got -1"),
        (lambda: parameter_covariance([[1, 1], [1, 1]], 1), "Phi must have full column rank; got rank 1 of 2"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
