"""The sign of a, eq. (1) and (2), and identification."""

import json

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.lab.arx import ArxModel, arx_from_theta, canonical_form, fit_arx, to_gap_model, to_ss, to_tf
from labsid.lab.excitation import prbs
from labsid.lab.simulation import simulate

# y(k) = 1.5 y(k-1) - 0.7 y(k-2) + 0.5 u(k-1) + 0.2 u(k-2)
MODEL = ArxModel([1, -1.5, 0.7], [0.5, 0.2], 0.75)

poles = st.lists(st.floats(-0.95, 0.95), min_size=1, max_size=4)


def model_with(poles, seed):
    b = np.random.default_rng(seed).uniform(0.1, 1, len(poles))
    return ArxModel(np.poly(poles), b, 0.5)


def test_theta_is_that_of_eq_4_with_minus_a():
    np.testing.assert_array_equal(MODEL.theta, [1.5, -0.7, 0.5, 0.2])
    assert MODEL.order == 2


def test_theta_and_back():
    model = arx_from_theta([1.5, -0.7, 0.5, 0.2], 0.75, u_offset=2.0, y_offset=2.3)
    np.testing.assert_array_equal(model.a, MODEL.a)
    np.testing.assert_array_equal(model.b, MODEL.b)
    assert (model.Ts, model.u_offset, model.y_offset) == (0.75, 2.0, 2.3)


def test_poles_are_the_roots_of_the_denominator_largest_first():
    model = ArxModel(np.poly([0.2, -0.9, 0.5]), [1, 0, 0], 1.0)
    np.testing.assert_allclose(model.poles, [-0.9, 0.5, 0.2], atol=1e-12)
    assert model.is_stable
    pair = ArxModel([1, -1.5, 0.7], [1, 0], 1.0).poles
    np.testing.assert_allclose(pair, [0.75 - 0.370809924j, 0.75 + 0.370809924j], rtol=1e-8)
    assert ArxModel([1, 0], [1], 1.0).poles.tolist() == [0]


@pytest.mark.parametrize(("pole", "stable"), [(0.999, True), (1.0, False), (-1.2, False)])
def test_stability(pole, stable):
    assert ArxModel([1, -pole], [1], 1.0).is_stable is stable


def test_static_gain():
    assert MODEL.static_gain == pytest.approx(0.7 / 0.2)
    assert to_tf(MODEL).dcgain() == pytest.approx(MODEL.static_gain)
    assert ArxModel([1, -1], [1], 1.0).static_gain == np.inf
    assert np.isnan(ArxModel([1, -1], [0], 1.0).static_gain)


def test_the_canonical_form_of_eq_2():
    G, H, C, D = canonical_form(MODEL)
    np.testing.assert_array_equal(G, [[0, 1], [-0.7, 1.5]])
    np.testing.assert_array_equal(H, [[0], [1]])
    np.testing.assert_array_equal(C, [[0.2, 0.5]])
    np.testing.assert_array_equal(D, [[0]])


def test_the_canonical_form_of_order_3():
    G, H, C, _ = canonical_form(ArxModel([1, 0.1, 0.2, 0.3], [4, 5, 6], 1.0))
    np.testing.assert_array_equal(G, [[0, 1, 0], [0, 0, 1], [-0.3, -0.2, -0.1]])
    np.testing.assert_array_equal(H, [[0], [0], [1]])
    np.testing.assert_array_equal(C, [[6, 5, 4]])


def test_transfer_function_and_state_space_are_displayed_as_the_lab_asks():
    text = str(to_tf(MODEL))
    assert "0.5 z + 0.2" in text
    assert "z^2 - 1.5 z + 0.7" in text
    assert "dt = 0.75" in text
    shown = str(to_ss(MODEL))
    assert "C = [[0.2 0.5]]" in shown
    assert "dt = 0.75" in shown


@given(poles, st.integers(0, 1000))
@settings(max_examples=60, deadline=None)
def test_transfer_function_and_state_space_are_one_system_and_eq_1(poles, seed):
    model = model_with(poles, seed)
    omega = np.array([0.1, 0.7, 2.0, 5.0])
    z = np.exp(1j * omega * model.Ts)
    expected = np.polyval(model.b, z) / np.polyval(model.a, z)
    for system in (to_tf(model), to_ss(model)):
        assert system.dt == model.Ts
        response = np.array([system(point) for point in z])
        np.testing.assert_allclose(response, expected, rtol=1e-6)


@given(poles, st.integers(0, 1000))
@settings(max_examples=60, deadline=None)
def test_the_sign_of_a_is_the_one_stated(poles, seed):
    """The free run of python-control's system satisfies the difference equation, eq. (3)."""
    model = model_with(poles, seed)
    u = np.random.default_rng(seed).standard_normal(30)
    y = control.forced_response(to_tf(model), inputs=u).outputs
    n = model.order
    for k in range(n, 30):
        past_y, past_u = y[k - n : k][::-1], u[k - n : k][::-1]
        assert y[k] + model.a[1:] @ past_y == pytest.approx(model.b @ past_u, abs=1e-8)


@given(poles, st.integers(0, 1000), st.integers(0, 6))
@settings(max_examples=60, deadline=None)
def test_a_known_truth_is_recovered_from_noise_free_data(poles, seed, start):
    model = model_with(poles, seed)
    u = prbs(200, register=8)
    fit = fit_arx(u, simulate(model, u), model.Ts, order=model.order, start=start)
    if fit.fit.condition_number < 1e5:  # beyond, poles and zeros nearly cancel and theta is free
        np.testing.assert_allclose(fit.model.theta, model.theta, atol=1e-7)
    assert fit.fit.loss < 1e-16


def test_a_known_truth_is_recovered_from_noise_within_its_standard_errors():
    rng = np.random.default_rng(4)
    u = rng.standard_normal(5000)
    e = 0.1 * rng.standard_normal(5000)
    y = simulate(MODEL, u)
    # Equation error: the noise that ARX supposes enters through 1 / A(q).
    y += simulate(ArxModel(MODEL.a, [1.0, 0.0], 0.75), np.append(e[1:], 0))
    fit = fit_arx(u, y, 0.75)
    assert np.all(np.abs(fit.model.theta - MODEL.theta) < 4 * fit.fit.stderr)
    assert np.max(fit.fit.stderr) < 0.003
    assert fit.fit.sigma2 == pytest.approx(0.01, rel=0.05)


@given(st.integers(0, 1000), st.sampled_from([0.1, 3.0, 50.0]), st.sampled_from([0.2, 7.0]))
@settings(max_examples=40, deadline=None)
def test_scaling_u_and_y_scales_b_alone(seed, scale_u, scale_y):
    u, y = np.random.default_rng(seed).standard_normal((2, 60))
    plain = fit_arx(u, y, 1.0).model
    scaled = fit_arx(scale_u * u, scale_y * y, 1.0).model
    np.testing.assert_allclose(scaled.a, plain.a, atol=1e-9)
    np.testing.assert_allclose(scaled.b, plain.b * scale_y / scale_u, atol=1e-9 * scale_y / scale_u)


@given(st.integers(0, 1000), st.integers(1, 9))
@settings(max_examples=40, deadline=None)
def test_a_shift_in_time_changes_nothing(seed, shift):
    u, y = np.random.default_rng(seed).standard_normal((2, 80))
    here = fit_arx(u, y, 1.0, start=10, stop=60).model.theta
    padded = np.zeros(shift)
    later = fit_arx(np.append(padded, u), np.append(padded, y), 1.0, start=10 + shift, stop=60 + shift)
    np.testing.assert_array_equal(here, later.model.theta)


def test_an_input_that_excites_nothing_is_a_status_of_the_fit():
    y = np.random.default_rng(0).standard_normal(30)
    assert fit_arx(np.zeros(30), y, 1.0).fit.status == "rank-deficient"


def test_the_model_file_of_the_gap_command():
    model = arx_from_theta([1.5, -0.7, 0.5, 0.2], 0.75, u_offset=2.0, y_offset=2.3)
    written = json.loads(json.dumps(to_gap_model(model)))
    assert written == {"num": [0, 0.5, 0.2], "den": [1, -1.5, 0.7], "dt": 0.75, "u0": 2.0, "y0": 2.3}
    system = control.tf(written["num"], written["den"], written["dt"])  # descending powers of z
    assert system(1.3) == pytest.approx(to_tf(model)(1.3))


def test_the_model_is_read_only():
    with pytest.raises(ValueError, match="read-only"):
        MODEL.a[1] = 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ArxModel([2, 1], [1], 1.0), r"a must be \[1, a1, \.\.\., an\].*; got a = \[2\.0, 1\.0\]"),
        (lambda: ArxModel([1, 1, 1], [1], 1.0), r"and b = \[1\.0\]\. Divide by the first coefficient"),
        (lambda: ArxModel([1], [1], 1.0), "a must have at least 2 samples; got 1"),
        (lambda: ArxModel([1, np.nan], [1], 1.0), "a must be finite"),
        (lambda: ArxModel([1, 1], [1], 0.0), r"Ts must be a positive number of seconds; got 0\.0"),
        (lambda: ArxModel([1, 1], [1], np.nan), "Ts must be a positive number of seconds; got nan"),
        (lambda: arx_from_theta([1, 2, 3], 1.0), "an even number of entries; got 3"),
    ],
)
def test_models_that_are_none(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_several_inputs_are_for_a_system():
    with pytest.raises(ValueError, match=r"u must be one signal .*; got shape \(20, 2\)"):
        fit_arx(np.ones((20, 2)), np.ones(20), 1.0)
