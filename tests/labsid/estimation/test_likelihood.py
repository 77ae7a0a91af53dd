"""Gaussian maximum likelihood: least squares where the errors are in the equation, prediction errors elsewhere."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import norm

from labsid.estimation.likelihood import fit_likelihood, log_likelihood, maximise_likelihood
from labsid.estimation.monte_carlo import run_monte_carlo
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.lecture_systems import example_7_1, example_7_2, system_1, system_2
from labsid.model_structures.prediction import prediction_errors
from labsid.model_structures.structures import Structure, build_equations, model_from_theta

ARMAX = Structure(1, 1, 1)


def test_the_log_likelihood_is_the_sum_of_log_densities():
    e = np.array([0.5, -1.0, 2.0])
    assert log_likelihood(e, 4.0) == pytest.approx(norm.logpdf(e, scale=2.0).sum(), rel=1e-14)
    # By hand: -3/2 log(8 pi) - 5.25 / 8.
    assert log_likelihood(e, 4.0) == pytest.approx(-1.5 * np.log(8 * np.pi) - 0.65625)


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e4])
def test_the_top_of_the_likelihood_is_least_squares(scale):
    r = system_1(np.random.default_rng(0))
    equations = build_equations(Structure(2, 2), scale * r.u, r.y)
    top, exact = maximise_likelihood(equations.Phi, equations.Y), solve_least_squares(equations.Phi, equations.Y)
    assert top.status == "converged"
    np.testing.assert_allclose(top.theta, exact.theta, rtol=1e-5, atol=1e-6 / scale)
    n, p = equations.Phi.shape
    assert top.sigma2 == pytest.approx(exact.sigma2 * (n - p) / n, rel=1e-6)
    assert top.log_likelihood == pytest.approx(log_likelihood(exact.residual, 2 * exact.loss / n), abs=1e-6)


def test_arx_by_likelihood_is_arx_by_least_squares():
    r = system_1(np.random.default_rng(1))
    found = fit_likelihood(Structure(1, 1), r.u, r.y)
    equations = build_equations(Structure(1, 1), r.u, r.y, start=0)
    assert found.status == "converged"
    np.testing.assert_allclose(found.model.theta, solve_least_squares(equations.Phi, equations.Y).theta, atol=1e-9)


@pytest.mark.parametrize("system", [example_7_1, system_2])
def test_armax_by_likelihood_agrees_with_a_general_optimiser(system):
    r = system(np.random.default_rng(2))
    found = fit_likelihood(ARMAX, r.u, r.y)
    assert found.status == "converged"

    def height(theta):
        e = prediction_errors(model_from_theta(ARMAX, theta), r.u, r.y)
        return -log_likelihood(e, float(np.mean(e**2)))

    oracle = minimize(height, [-0.5, 0.5, 0.0], method="Nelder-Mead", options={"xatol": 1e-8, "fatol": 1e-8})
    np.testing.assert_allclose(found.model.theta, oracle.x, atol=1e-5)
    assert found.log_likelihood == pytest.approx(-oracle.fun, abs=1e-6)
    np.testing.assert_array_equal(found.e, r.y - (r.y - found.e))
    assert found.sigma2 == pytest.approx(np.mean(prediction_errors(found.model, r.u, r.y) ** 2))


def test_arma_by_likelihood_agrees_with_statsmodels():
    """The conditional likelihood (from rest) against the exact one: they differ by the first few of 1000 samples."""
    arima = pytest.importorskip("statsmodels.tsa.arima.model", reason="statsmodels is not installed")
    r = example_7_2(np.random.default_rng(3))
    found = fit_likelihood(Structure(1, 0, 1), None, r.y)
    oracle = arima.ARIMA(r.y, order=(1, 0, 1), trend="n").fit()
    np.testing.assert_allclose(found.model.theta, oracle.params[:2] * [-1, 1], atol=0.1 * found.stderr.max())
    np.testing.assert_allclose(found.stderr, oracle.bse[:2], rtol=0.1)
    assert found.log_likelihood == pytest.approx(oracle.llf, abs=3)


def test_its_standard_errors_are_the_spread_over_many_records():
    errors = []

    def estimate(rng):
        r = example_7_1(rng)
        found = fit_likelihood(ARMAX, r.u, r.y)
        errors.append(found.stderr)
        return found.model.theta

    result = run_monte_carlo(estimate, [-0.9, 1.0, 0.3], 80, seed=4)
    assert np.all(np.abs(result.bias) < 4 * result.bias_stderr)
    np.testing.assert_allclose(np.mean(errors, axis=0), result.spread, rtol=0.3)


def test_an_over_parameterised_model_is_not_determined():
    """Example 7-2: any common factor 1 + d q^-1 gives the same likelihood, within the noise."""
    r = example_7_2(np.random.default_rng(5))
    right, larger = (fit_likelihood(Structure(n, 0, n), None, r.y) for n in (1, 2))
    assert right.status == "converged"
    gained = larger.log_likelihood - right.log_likelihood
    assert -1e-6 < gained < 6
    assert larger.status != "converged" or np.max(larger.stderr) > 5 * np.max(right.stderr)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: log_likelihood([1.0], 0), "sigma2 must be a positive variance; got 0"),
        (lambda: log_likelihood([np.nan], 1), "e must be finite"),
        (lambda: maximise_likelihood(np.ones((5, 2)), np.arange(5.0)), "one maximum"),
        (lambda: maximise_likelihood([[1.0], [2.0], [3.0]], [2, 4, 6]), "one maximum"),
        (lambda: fit_likelihood(ARMAX, np.ones(50), np.ones(49)), "equal length"),
        (lambda: fit_likelihood(ARMAX, None, np.ones(50)), "u must be given"),
    ],
)
def test_bad_input_says_what_is_wrong(call, message):
    with pytest.raises(ValueError, match=message):
        call()
