"""Weighted least squares against statsmodels, repetition, and the forgetting criterion."""

import numpy as np
import pytest
import statsmodels.api as sm
from scipy.optimize import minimize

from labsid.least_squares.solve import solve_least_squares
from labsid.least_squares.weighted import forgetting_weights, weighted_least_squares


def case(seed):
    rng = np.random.default_rng(seed)
    return rng.standard_normal((20, 3)), rng.standard_normal(20), rng.uniform(0.1, 5, 20)


@pytest.mark.parametrize("seed", range(5))
def test_statsmodels_agrees(seed):
    Phi, Y, w = case(seed)
    fit = weighted_least_squares(Phi, Y, w)
    oracle = sm.WLS(Y, Phi, w).fit()
    np.testing.assert_allclose(fit.theta, oracle.params, rtol=1e-9)
    np.testing.assert_allclose(fit.stderr, oracle.bse, rtol=1e-9)
    np.testing.assert_allclose(fit.residual, oracle.resid, rtol=1e-9)
    assert fit.loss == pytest.approx(np.sum(w * fit.residual**2) / 2)
    np.testing.assert_allclose(Phi.T @ (w * fit.residual), 0, atol=1e-10)


def test_equal_weights_change_nothing_and_a_whole_weight_is_a_repeated_row():
    Phi, Y, _ = case(9)
    np.testing.assert_allclose(
        weighted_least_squares(Phi, Y, np.full(20, 7.0)).theta, solve_least_squares(Phi, Y).theta
    )
    times = np.arange(20) % 3 + 1
    repeated = solve_least_squares(np.repeat(Phi, times, axis=0), np.repeat(Y, times))
    np.testing.assert_allclose(weighted_least_squares(Phi, Y, times).theta, repeated.theta, rtol=1e-9)


def test_weights_of_one_over_the_variance_scatter_least():
    rng = np.random.default_rng(4)
    Phi = np.column_stack([np.linspace(0, 1, 40), np.ones(40)])
    sigma = np.where(np.arange(40) < 20, 0.1, 2.0)
    plain, weighted = [], []
    for _ in range(500):
        Y = Phi @ [1, 2] + sigma * rng.standard_normal(40)
        plain.append(solve_least_squares(Phi, Y).theta)
        weighted.append(weighted_least_squares(Phi, Y, 1 / sigma**2).theta)
    assert np.all(np.std(weighted, axis=0) < 0.5 * np.std(plain, axis=0))


def test_forgetting_by_hand_and_as_the_printed_criterion():
    np.testing.assert_allclose(forgetting_weights(3, 0.5), [0.25, 0.5, 1])
    np.testing.assert_array_equal(forgetting_weights(4, 1.0), 1)
    Phi, Y, _ = case(2)

    def criterion(theta):
        return sum(0.9 ** (20 - t) * (Y[t - 1] - Phi[t - 1] @ theta) ** 2 for t in range(1, 21))

    best = minimize(criterion, np.zeros(3), tol=1e-12)
    fit = weighted_least_squares(Phi, Y, forgetting_weights(20, 0.9))
    np.testing.assert_allclose(fit.theta, best.x, atol=1e-6)
    assert 2 * fit.loss == pytest.approx(best.fun)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: weighted_least_squares([[1], [2]], [1, 2], [1]), r"one entry per equation \(2\); got 1"),
        (lambda: weighted_least_squares([[1], [2]], [1, 2], [1, 0]), "must be positive; got 0 at equation 1.*drop its"),
        (lambda: forgetting_weights(0, 0.9), "n must be at least 1; got 0"),
        (lambda: forgetting_weights(5, 0.0), r"forgetting must be above 0 and at most 1; got 0\.0"),
        (lambda: forgetting_weights(5, 1.1), "forgetting must be above 0 and at most 1; got 1.1"),
        (lambda: forgetting_weights(100_000, 0.9), "makes the oldest of 100000 weights vanish"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
