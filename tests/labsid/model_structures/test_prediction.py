"""Simulation and prediction, told apart."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from statsmodels.tsa.arima.model import ARIMA

from labsid.lab.arx import ArxModel
from labsid.lab.simulation import predict_one_step, simulate
from labsid.model_structures.prediction import free_run, one_step_prediction, prediction_errors
from labsid.model_structures.structures import PolynomialModel, build_equations

ARMAX = PolynomialModel([1, -0.9], [1.0], [1, 0.3])


def noise(seed=0, n=200):
    rng = np.random.default_rng(seed)
    return rng.uniform(-2, 2, n), rng.standard_normal(n)


def test_armax_by_hand():
    # y(k) = 0.9 y(k-1) + u(k-1) + e(k) + 0.3 e(k-1).
    np.testing.assert_allclose(free_run(ARMAX, [1, 0, 0], [1, 0, 2]), [1, 0.9 + 1 + 0.3, 0.9 * 2.2 + 2])


def test_the_matlab_loop_of_system_2():
    u, e = noise(1)
    y = np.zeros(200)
    for i in range(1, 200):
        y[i] = 0.8 * y[i - 1] + u[i - 1] - 0.8 * e[i - 1] + e[i]
    system = PolynomialModel([1, -0.8], [1.0], [1, -0.8])
    # The loop starts at y(1) = 0 where the model has y = e: the difference dies out with the pole.
    np.testing.assert_allclose(free_run(system, u, e)[100:], y[100:], atol=1e-9)


@given(st.integers(0, 1000))
@settings(max_examples=50, deadline=None)
def test_the_true_model_is_surprised_by_the_noise_alone(seed):
    u, e = noise(seed)
    y = free_run(ARMAX, u, e)
    np.testing.assert_allclose(prediction_errors(ARMAX, u, y), e, atol=1e-10)
    np.testing.assert_allclose(one_step_prediction(ARMAX, u, y) + e, y, atol=1e-10)


def test_prediction_leans_on_the_measurements_and_simulation_does_not():
    u, e = noise(2, 2000)
    y = free_run(ARMAX, u, e)
    predicted, simulated = one_step_prediction(ARMAX, u, y), free_run(ARMAX, u)
    assert np.var(y - predicted) == pytest.approx(1, rel=0.1)
    # The variance of C/A e with a pole at 0.9: 1 + 1.2^2 / (1 - 0.81).
    assert np.var(y - simulated) == pytest.approx(1 + 1.2**2 / (1 - 0.81), rel=0.25)
    # A disturbed output sample disturbs all later predictions, and no sample of the simulation.
    disturbed = y + np.eye(1, 2000, 10)[0]
    assert np.max(np.abs(one_step_prediction(ARMAX, u, disturbed) - predicted)) > 0.5


def test_arx_prediction_is_phi_theta_of_the_sustech_predictor():
    u, e = noise(3)
    model = PolynomialModel([1, -0.5, 0.2], [1.0, 0.3], [1], delay=0)
    y = free_run(model, u, e)
    H = build_equations(model.structure, u, y, start=0).Phi
    np.testing.assert_allclose(one_step_prediction(model, u, y), H @ model.theta, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_the_lab_does_the_same(seed):
    u, y = noise(seed)
    ours, labs = PolynomialModel([1, -1.2, 0.4], [0.1, 0.2], [1]), ArxModel([1, -1.2, 0.4], [0.1, 0.2], 1.0)
    np.testing.assert_allclose(free_run(ours, u), simulate(labs, u), atol=1e-10)
    np.testing.assert_allclose(one_step_prediction(ours, u, y), predict_one_step(labs, u, y), atol=1e-10)


def test_arma_prediction_is_that_of_statsmodels_once_the_start_is_forgotten():
    _, e = noise(4, 300)
    model = PolynomialModel([1, -0.7], [], [1, 0.5])
    y = free_run(model, None, e)
    oracle = ARIMA(y, order=(1, 0, 1), trend="n").smooth([0.7, 0.5, 1.0])
    np.testing.assert_allclose(one_step_prediction(model, None, y)[100:], oracle.fittedvalues[100:], atol=1e-9)


U = np.ones(5000)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: free_run(ARMAX, None, U), "u must be given: the model has an input"),
        (
            lambda: free_run(PolynomialModel([1, 0.5], [], [1]), None),
            "e must be given: a model without input is driven",
        ),
        (lambda: free_run(ARMAX, U, U[1:]), "u and e must have equal length; got 5000 and 4999"),
        (lambda: prediction_errors(ARMAX, None, U), "u must be given: the model has an input"),
        (lambda: one_step_prediction(ARMAX, U[1:], U), "u and y must have equal length"),
        (
            lambda: free_run(PolynomialModel([1, -1.2], [1.0], [1]), U),
            r"the simulated output must stay within .* at sample \d+\. .* root of magnitude 1\.2, outside",
        ),
        (
            lambda: prediction_errors(PolynomialModel([1], [1.0], [1, 2.0]), U, 3 * U),
            "the prediction errors must stay within .* root of magnitude 2, outside the unit circle",
        ),
    ],
)
def test_what_does_not_fit_or_runs_away(call, message):
    with pytest.raises(ValueError, match=message):
        call()
