"""Gain, time constant and delay of the appendix."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.lab.step_response import (
    FirstOrderDelay,
    cut_held_step,
    first_order_response,
    fit_step_response,
)
from labsid.records.record import load_record

TRUTH = FirstOrderDelay(K=1.5, tau=4.0, td=1.2)
T = np.arange(-50, 600) * 0.05


def assert_near(found, truth, within):
    assert pytest.approx(truth.K, rel=within) == found.K
    assert found.tau == pytest.approx(truth.tau, rel=within)
    assert found.td == pytest.approx(truth.td, abs=within * truth.tau)


def test_the_response_by_hand():
    y = first_order_response(TRUTH, [-1, 0, 1.2, 1.2 + 4, 1.2 + 4 / 3, 1e6], 2.0)
    np.testing.assert_allclose(y / 3, [0, 0, 0, 1 - np.exp(-1), 1 - np.exp(-1 / 3), 1], rtol=1e-12)


def test_the_reading_of_a_clean_response_of_amplitude_2():
    fit = fit_step_response(T, 0.7 + first_order_response(TRUTH, T, 2.0), 2.0)
    assert fit.status == "settled"
    assert fit.y_initial == pytest.approx(0.7)
    assert fit.y_final == pytest.approx(0.7 + 3, rel=1e-2)
    assert fit.t_632 == pytest.approx(5.2, abs=0.05)
    assert fit.t_283 == pytest.approx(1.2 + 4 / 3, abs=0.05)
    assert_near(fit.reading, TRUTH, within=0.01)
    assert fit.reading.tau == pytest.approx(1.5 * (fit.t_632 - fit.t_283))
    assert fit.reading.td == pytest.approx(fit.t_632 - fit.reading.tau)
    assert pytest.approx((fit.y_final - fit.y_initial) / 2) == fit.reading.K


parameters = st.tuples(
    st.sampled_from([-1, 1]), st.floats(0.1, 20), st.floats(1, 6), st.floats(0, 8), st.sampled_from([-3.0, 0.5, 2.0])
)


@given(parameters, st.floats(-10, 10))
@settings(max_examples=60, deadline=None)
def test_the_refinement_recovers_a_known_truth(case, level):
    sign, K, tau, td, amplitude = case
    truth = FirstOrderDelay(sign * K, tau, td)
    y = level + first_order_response(truth, T, amplitude)
    fit = fit_step_response(T, y, amplitude)
    assert_near(fit.model, truth, within=0.02 if fit.status == "not settled" else 1e-3)
    np.testing.assert_allclose(fit.y_fit, y, atol=2e-3 * K * abs(amplitude))
    assert fit.mse <= fit.mse_reading + 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_noise_and_an_initial_offset_do_little_harm(seed):
    noise = 0.06 * np.random.default_rng(seed).standard_normal(T.size)  # 2 % of the way
    fit = fit_step_response(T, 5 + first_order_response(TRUTH, T, 2.0) + noise, 2.0)
    assert fit.status == "settled"
    assert_near(fit.reading, TRUTH, within=0.15)
    assert_near(fit.model, TRUTH, within=0.02)
    assert fit.mse == pytest.approx(0.0036, rel=0.2)
    assert fit.mse <= fit.mse_reading


def test_without_delay_the_time_constant_is_the_63_percent_time():
    fit = fit_step_response(T, first_order_response(FirstOrderDelay(1.0, 4.0, 0.0), T, 2.0), 2.0)
    assert 0 <= fit.reading.td < 0.05
    y = np.sqrt(np.maximum(T, 0) / 30)  # rises faster at first than any first order: the delay would be negative
    reading = fit_step_response(T, y, 1.0).reading
    assert reading.td == 0
    assert reading.tau == fit_step_response(T, y, 1.0).t_632


def test_an_unfinished_response_says_so_and_the_refinement_extrapolates():
    t = T[T < 8]
    fit = fit_step_response(t, first_order_response(TRUTH, t, 2.0), 2.0)
    assert fit.status == "not settled"
    assert fit.reading.K < 0.85 * TRUTH.K
    assert_near(fit.model, TRUTH, within=1e-3)


def test_an_oscillating_response_says_that_it_wants_a_higher_order():
    t = np.arange(400) * 0.05
    y = control.step_response(control.tf([1], [1, 0.6, 1]), t).outputs
    assert fit_step_response(t, y, 1.0).status == "overshoot"


def test_a_held_step_is_cut_by_hand():
    u = [2, 2, 2, 1.5, 1.5, 1.5, 1.5, 3, 3]
    t, y, amplitude = cut_held_step(u, np.arange(9.0), 0.5, change=0, before=2)
    np.testing.assert_array_equal(t, [-1, -0.5, 0, 0.5, 1, 1.5])
    np.testing.assert_array_equal(y, [1, 2, 3, 4, 5, 6])
    assert amplitude == -0.5
    t, y, amplitude = cut_held_step(u, np.arange(9.0), 0.5, change=1)
    np.testing.assert_array_equal(y, [3, 4, 5, 6, 7, 8])  # no further back than the input was held
    assert amplitude == 1.5


def test_the_steps_of_the_lab_file_agree_on_gain_and_time_constant(shared_data):
    record = load_record(shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat")
    for change in range(4):
        t, y, amplitude = cut_held_step(record.u, record.y, record.Ts, change)
        fit = fit_step_response(t, y, amplitude)
        assert fit.status == "settled"
        # The identified first-order model has gain 3.04 and time constant 33 s.
        assert 2.8 < fit.model.K < 3.2
        assert 28 < fit.model.tau < 38
        assert 0 <= fit.model.td < 2
    t, y, amplitude = cut_held_step(record.u, record.y, record.Ts, 4)  # the record ends in it
    assert fit_step_response(t, y, amplitude).status == "not settled"


def test_a_step_of_the_hair_dryer_shows_its_delay(shared_data):
    u, y = np.loadtxt(shared_data / "hair-dryer" / "dryer.dat").T
    t, response, amplitude = cut_held_step(u, y, 0.08, change=102)  # held for 26 samples, from rest
    fit = fit_step_response(t, response, amplitude)
    assert fit.status == "settled"
    assert 0.16 < fit.model.td < 0.32  # 3 samples in all
    assert 0.2 < fit.model.tau < 0.5


ramp = np.linspace(0, 1, 30)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fit_step_response(ramp, ramp, 0), r"amplitude must be the size of the step, not zero; got 0"),
        (lambda: fit_step_response(ramp, ramp[1:], 1), "t and y must have equal length; got 30 and 29"),
        (lambda: fit_step_response(ramp[::-1], ramp, 1), "t must increase; got a step back at sample 1"),
        (lambda: fit_step_response(1 + ramp, ramp, 1), r"t must be zero at the step.*; got t from 1 to 2 s"),
        (lambda: fit_step_response(ramp[:9], ramp[:9], 1), "at least 10 after it; .* with 8 samples after zero"),
        (lambda: fit_step_response(ramp, np.ones(30), 1), r"y must respond to the step; got a change of 0 in noise"),
        (lambda: cut_held_step([1, 2, 2], [0, 0, 0], 0.0), r"Ts must be a positive number of seconds; got 0\.0"),
        (lambda: cut_held_step([1, 2, 2], [0, 0, 0], 1.0, 1), r"number of input changes, 1; got 1\."),
        (lambda: cut_held_step([1, 1], [0, 0], 1.0), r"number of input changes, 0; got 0\."),
        (lambda: cut_held_step([1, 1], [0], 1.0), "u and y must have equal length; got 2 and 1"),
    ],
)
def test_responses_that_cannot_be_read(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_noise_that_hides_the_response_is_named():
    y = np.random.default_rng(0).standard_normal(T.size)
    with pytest.raises(ValueError, match=r"y must respond to the step; got a change of .* in noise of"):
        fit_step_response(T, y, 1.0)


def test_a_response_that_jumps_to_and_fro_cannot_be_read():
    y = np.where((np.arange(60) < 40) & (np.arange(60) % 2 == 0), 0.0, 1.0)
    with pytest.raises(ValueError, match=r"28\.3 % and 63\.2 % of its way at different times; got 19\.5 s for both"):
        fit_step_response(np.arange(60.0), y, 1.0)


@given(st.integers(0, 10**6), st.integers(12, 60), st.floats(0.05, 3))
@settings(max_examples=150, deadline=None)
def test_however_noisy_a_response_it_is_read_or_refused(seed, N, noise):
    t = np.arange(float(N))
    y = 1 - np.exp(-t / 5) + noise * np.random.default_rng(seed).standard_normal(N)
    try:
        fit = fit_step_response(t, y, 1.0)
    except ValueError:
        return
    assert 0 < fit.t_283 < fit.t_632 < N
    assert fit.reading.tau > 0
    assert fit.reading.td >= 0
    assert fit.model.tau > 0
    assert fit.mse <= fit.mse_reading + 1e-9
