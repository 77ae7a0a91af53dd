"""Free run, one-step prediction and the initial state, against python-control and scipy."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import dlsim

from labsid.lab.arx import ArxModel, canonical_form, to_ss, to_tf
from labsid.lab.regressor import build_phi
from labsid.lab.simulation import estimate_initial_state, free_response, predict_one_step, simulate

MODEL = ArxModel([1, -1.5, 0.7], [0.5, 0.2], 0.75)

models = st.tuples(st.lists(st.floats(-0.95, 0.95), min_size=1, max_size=4), st.integers(0, 1000)).map(
    lambda case: ArxModel(np.poly(case[0]), np.random.default_rng(case[1]).uniform(-1, 1, len(case[0])), 0.5)
)


def test_free_run_by_hand():
    # y(1) = 0.5, y(2) = 1.5 * 0.5 + 0.2, y(3) = 1.5 * 0.95 - 0.7 * 0.5
    np.testing.assert_allclose(simulate(MODEL, [1, 0, 0, 0]), [0, 0.5, 0.95, 1.075], rtol=1e-14)


def test_free_run_from_a_state_by_hand():
    # x = [1, 2]: y(0) = 0.2 * 1 + 0.5 * 2; x(1) = [2, -0.7 + 3] gives y(1) = 0.4 + 1.15
    np.testing.assert_allclose(simulate(MODEL, [0, 0], x0=[1, 2]), [1.2, 1.55], rtol=1e-14)


@given(models, st.integers(0, 1000))
@settings(max_examples=60, deadline=None)
def test_free_run_equals_python_control_and_scipy(model, seed):
    rng = np.random.default_rng(seed)
    u, x0 = rng.standard_normal(50), rng.standard_normal(model.order)
    rest = simulate(model, u)
    np.testing.assert_allclose(rest, control.forced_response(to_tf(model), inputs=u).outputs, atol=1e-9)
    started = control.forced_response(to_ss(model), inputs=u, initial_state=x0).outputs
    np.testing.assert_allclose(simulate(model, u, x0), started, atol=1e-9)
    _, y, _ = dlsim((*canonical_form(model), model.Ts), u, x0=x0)
    np.testing.assert_allclose(simulate(model, u, x0), y[:, 0], atol=1e-9)


@given(models, st.integers(0, 1000), st.integers(1, 40))
@settings(max_examples=60, deadline=None)
def test_the_state_carries_a_run_on_where_it_was_cut(model, seed, cut):
    u = np.random.default_rng(seed).standard_normal(60)
    G, H, _, _ = canonical_form(model)
    x = np.zeros((model.order, 1))
    for k in range(cut):
        x = G @ x + H * u[k]
    np.testing.assert_allclose(simulate(model, u[cut:], x), simulate(model, u)[cut:], atol=1e-9)


@given(models, st.integers(0, 1000), st.floats(-5, 5))
@settings(max_examples=40, deadline=None)
def test_the_free_run_is_linear(model, seed, scale):
    u, v = np.random.default_rng(seed).standard_normal((2, 40))
    together = simulate(model, u + scale * v)
    np.testing.assert_allclose(together, simulate(model, u) + scale * simulate(model, v), atol=1e-9)


def test_free_response_is_that_of_the_unit_states():
    np.testing.assert_allclose(free_response(MODEL, 6) @ [1, 2], simulate(MODEL, np.zeros(6), [1, 2]))


@given(models, st.integers(0, 1000))
@settings(max_examples=60, deadline=None)
def test_one_step_prediction_is_phi_theta(model, seed):
    u, y = np.random.default_rng(seed).standard_normal((2, 40))
    regression = build_phi(u, y, model.order, start=0)
    np.testing.assert_allclose(predict_one_step(model, u, y), regression.Phi @ model.theta, atol=1e-12)


def test_one_step_prediction_is_not_simulation():
    """A model with a wrong gain predicts well and simulates badly: the measured past hides its error."""
    u = np.where(np.arange(400) // 100 % 2 == 0, 1.0, -1.0)
    y = simulate(ArxModel([1, -0.99], [0.01], 1.0), u)
    wrong = ArxModel([1, -0.99], [0.005], 1.0)
    assert np.std(y - predict_one_step(wrong, u, y)) < 0.02 * np.std(y)
    assert np.std(y - simulate(wrong, u)) > 0.4 * np.std(y)
    np.testing.assert_allclose(predict_one_step(MODEL, u, simulate(MODEL, u)), simulate(MODEL, u), atol=1e-9)


@given(models, st.integers(0, 1000), st.sampled_from([None, 10, 25]))
@settings(max_examples=60, deadline=None)
def test_the_initial_state_is_recovered_as_far_as_the_output_shows_it(model, seed, samples):
    rng = np.random.default_rng(seed)
    u, x0 = rng.standard_normal(50), rng.standard_normal(model.order)
    y = simulate(model, u, x0)
    found = estimate_initial_state(model, u, y, samples)
    np.testing.assert_allclose(simulate(model, u, found), y, atol=1e-6)


def test_the_initial_state_of_an_observable_model_is_unique():
    u = np.random.default_rng(2).standard_normal(20)
    y = simulate(MODEL, u, [0.3, -1.2])
    np.testing.assert_allclose(estimate_initial_state(MODEL, u, y), [0.3, -1.2], rtol=1e-10)
    np.testing.assert_allclose(estimate_initial_state(MODEL, u, y, samples=2), [0.3, -1.2], rtol=1e-10)


def test_the_initial_state_averages_noise_out():
    rng = np.random.default_rng(7)
    slow = ArxModel([1, -0.99], [0.1], 1.0)
    u = rng.standard_normal(300)
    y = simulate(slow, u, [5.0]) + 0.05 * rng.standard_normal(300)
    # Standard error: 0.05 over the length of the basis, 0.1 / sqrt(1 - 0.99^2), about 0.07.
    assert estimate_initial_state(slow, u, y)[0] == pytest.approx(5, abs=0.25)


def test_an_unstable_model_is_run_as_far_as_numbers_go():
    grows = ArxModel([1, -2], [1], 1.0)
    np.testing.assert_allclose(simulate(grows, [1, 0, 0, 0]), [0, 1, 2, 4])
    with pytest.raises(ValueError, match=r"more than 1e\+150 at sample 500\. .* a root of magnitude 2, .* unstable"):
        simulate(grows, np.eye(1, 600)[0])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: simulate(MODEL, [1, 2], x0=[1]), r"x0 must have one entry for each state \(2\); got 1"),
        (lambda: simulate(MODEL, []), "u must have at least 1 samples; got 0"),
        (lambda: predict_one_step(MODEL, [1, 2], [1]), "u and y must have equal length; got 2 and 1"),
        (lambda: estimate_initial_state(MODEL, [1, 2], [1]), "u and y must have equal length; got 2 and 1"),
        (
            lambda: estimate_initial_state(MODEL, [1, 2, 3], [1, 2, 3], samples=1),
            "samples must lie between the order 2 and the 3 samples given; got 1",
        ),
        (
            lambda: estimate_initial_state(MODEL, [1, 2, 3], [1, 2, 3], samples=4),
            "samples must lie between the order 2 and the 3 samples given; got 4",
        ),
    ],
)
def test_arguments_that_do_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
