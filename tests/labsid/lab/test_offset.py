"""The lab's offset loop, and the settled tail where the lab's rule is not enough."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import loadmat
from scipy.signal import lfilter

from labsid.lab.offset import (
    find_offsets,
    find_signal_offsets,
    first_period_length,
    mean_of_first_period,
    mid_range,
    remove_offsets,
)


def levels_after(first_period, samples=600, hold=150):
    """The lab's staircase: 2.0 V for the first period, then 1.6 V and 2.2 V by turns."""
    k = np.arange(first_period + samples)
    later = np.where((k - first_period) // hold % 2 == 0, 1.6, 2.2)
    return np.where(k < first_period, 2.0, later)


def tank(u, tau, start, noise=0.0, seed=0):
    """First-order answer to u - 2.0 about a level of 1, from `start`, noise in shares of the range."""
    r = np.exp(-1 / tau)
    y = lfilter([0, 1 - r], [1, -r], (u - 2.0) / 0.6) + (start - 1) * r ** np.arange(u.size)
    return 1 + y + noise * np.ptp(y) * np.random.default_rng(seed).standard_normal(u.size)


def rig_log(shared_data, name):
    log = loadmat(shared_data / "unsw-water-tank" / f"SysIdenData_{name}.mat", squeeze_me=True, struct_as_record=False)[
        "LogData"
    ]
    return log.signals[1].values, log.signals[0].values[:, 1]


def test_first_period_by_hand():
    assert first_period_length([2, 2, 2, 1.6, 2, 2]) == 3
    assert first_period_length([1, 0]) == 1


def test_mean_of_first_period_by_hand():
    assert mean_of_first_period([2, 2, 2, 1.6], [1.0, 2.0, 6.0, 100.0]) == 3.0


def test_mid_range_is_not_the_first_value_when_the_range_is_not_symmetric():
    u = [2.0, 2.0, 1.6, 2.2]
    assert mid_range(u) == pytest.approx(1.9)
    assert find_offsets(u, np.zeros(4)).u_offset == 2.0


def test_the_lab_file_starts_settled_and_gets_the_mean_over_the_whole_first_period(shared_data):
    u, y = rig_log(shared_data, "StudentVersion")
    offsets = find_offsets(u, y)
    assert offsets.status == "settled"
    assert offsets.settled == (0, 51)
    assert offsets.first_period == 51
    assert offsets.u_offset == 2.0
    assert offsets.y_offset == pytest.approx(2.32781863, abs=5e-9)
    assert offsets.y_offset == mean_of_first_period(u, y)
    assert mid_range(u) == pytest.approx(1.9)


@pytest.mark.parametrize(
    ("name", "first_period", "level", "within"), [("4", 308, 2.423, 0.010), ("8", 240, 2.806, 0.012)]
)
def test_the_runs_from_an_empty_tank_are_averaged_where_they_have_settled(
    shared_data, name, first_period, level, within
):
    u, y = rig_log(shared_data, name)
    offsets = find_offsets(u, y)
    assert offsets.status == "settled"
    assert offsets.first_period == offsets.settled[1] == first_period
    assert offsets.settled[0] > 100
    assert abs(offsets.y_offset - level) < within
    assert abs(mean_of_first_period(u, y) - level) > 0.25  # what the lab's rule would have given


@pytest.mark.parametrize(
    ("periods_per_tau", "noise"), [(7, 0), (7, 0.002), *((n, s) for n in (10, 20, 50) for s in (0, 0.002, 0.005))]
)
@pytest.mark.parametrize("first_period", [40, 100, 250, 1000])
def test_a_start_up_that_settles_is_found_settled_and_its_level_right(periods_per_tau, first_period, noise):
    u = levels_after(first_period)
    for seed in range(5):
        y = tank(u, first_period / periods_per_tau, start=0.0, noise=noise, seed=seed)
        offsets = find_offsets(u, y)
        assert offsets.status == "settled"
        assert offsets.settled[0] > 0
        assert abs(offsets.y_offset - 1) < 0.008 * np.ptp(y)


@pytest.mark.parametrize("periods_per_tau", [0.3, 1, 2, 3])
@pytest.mark.parametrize("first_period", [40, 100, 250, 1000])
@pytest.mark.parametrize("noise", [0, 0.002, 0.005])
def test_a_start_up_that_does_not_settle_is_not_called_settled(periods_per_tau, first_period, noise):
    u = levels_after(first_period)
    for seed in range(5):
        y = tank(u, first_period / periods_per_tau, start=0.0, noise=noise, seed=seed)
        offsets = find_offsets(u, y)
        assert offsets.status == "not settled"
        assert offsets.settled == (first_period - -(-first_period // 4), first_period)
        assert offsets.y_offset == pytest.approx(np.mean(y[slice(*offsets.settled)]))


@pytest.mark.parametrize("first_period", [8, 51, 400])
@pytest.mark.parametrize("noise", [0, 0.002, 0.005])
def test_a_record_that_starts_settled_keeps_the_lab_rule(first_period, noise):
    u = levels_after(first_period)
    for seed in range(5):
        y = tank(u, tau=30, start=1.0, noise=noise, seed=seed)
        offsets = find_offsets(u, y)
        assert offsets.settled == (0, first_period)
        assert offsets.status == "settled"
        assert offsets.y_offset == pytest.approx(mean_of_first_period(u, y))


def bias_and_rise(x):
    """Bias of the mean, and rise of the line, of ``1 - exp(-t)`` over x time constants, for a remainder of 1."""
    bias = (1 - np.exp(-x)) / x
    rise = 12 * (bias / 2 - (1 - (1 + x) * np.exp(-x)) / x**2)
    return bias, rise


@pytest.mark.parametrize(("x", "ratio"), [(1, 1.0), (3, 0.4), (10, 0.2), (1000, 1 / 6)])
def test_a_rise_biases_the_mean_by_more_than_its_sixth(x, ratio):
    bias, rise = bias_and_rise(x)
    assert bias / rise == pytest.approx(ratio, rel=0.06)
    k = np.arange(20_000) / 20_000
    y = 1 - np.exp(-k * x)
    assert 1 - y.mean() == pytest.approx(bias, rel=0.03)
    assert np.polyfit(k, y, 1)[0] == pytest.approx(rise, rel=0.03)


@pytest.mark.parametrize(("periods_per_tau", "bias"), [(6, 0.0064), (10, 0.0025), (20, 0.0013)])
def test_settled_leaves_a_bias_of_less_than_seven_thousandths(periods_per_tau, bias):
    y = tank(levels_after(1000, hold=600), 1000 / periods_per_tau, start=0.0)
    y[1000:] = np.clip(y[1000:], 0, 1)
    offsets = find_offsets(levels_after(1000, hold=600), y)
    assert offsets.status == "settled"
    assert 1 - offsets.y_offset == pytest.approx(bias, rel=0.1)


def test_a_short_first_period_is_called_settled_though_the_output_moves():
    u = levels_after(40)
    offsets = find_offsets(u, tank(u, tau=200, start=0.97))
    assert (offsets.status, offsets.settled) == ("settled", (0, 40))
    bias, rise = bias_and_rise(0.2)
    assert 1 - offsets.y_offset == pytest.approx(0.03 * bias, rel=0.03)
    assert bias > 5 * rise


def test_an_overshooting_start_up_is_not_averaged_though_its_trend_cancels():
    u = levels_after(200)
    k = np.arange(200)
    y = np.concatenate([1 - np.exp(-k / 15) * np.cos(k / 8), tank(u, 20, 1.0)[200:]])
    offsets = find_offsets(u, y)
    assert offsets.status == "settled"
    assert offsets.settled[0] > 30
    assert offsets.y_offset == pytest.approx(1, abs=0.005)


def test_too_short_a_first_period_is_averaged_and_says_so():
    u = np.array([2.0] * 7 + [1.6] * 20)
    y = np.arange(27.0)
    offsets = find_offsets(u, y)
    assert offsets.status == "too short"
    assert offsets.settled == (0, 7)
    assert offsets.y_offset == 3.0


def test_a_constant_output_is_settled():
    assert find_offsets(levels_after(20), np.full(620, 2.5)).settled == (0, 20)


signals = st.integers(1, 120).flatmap(
    lambda first: st.tuples(
        st.just(first),
        st.lists(st.integers(-5000, 5000), min_size=first + 5, max_size=first + 60),
    )
)


@given(signals, st.floats(-100, 100), st.sampled_from([0.25, 0.5, 2.0, 8.0]))
@settings(max_examples=200, deadline=None)
def test_offsets_follow_shift_and_scale_of_the_output(case, shift, scale):
    first_period, values = case
    y = np.array(values) / 1000
    u = np.where(np.arange(y.size) < first_period, 2.0, 1.6)
    offsets = find_offsets(u, y)
    k0, k1 = offsets.settled
    assert 0 <= k0 < k1 == first_period
    assert offsets.y_offset == pytest.approx(np.mean(y[k0:k1]), abs=1e-12)
    scaled = find_offsets(u, y * scale)  # powers of two: not even the rounding changes
    assert (scaled.settled, scaled.status) == (offsets.settled, offsets.status)
    assert scaled.y_offset == pytest.approx(scale * offsets.y_offset, abs=1e-12)
    shifted = find_offsets(u + 1, y + shift)
    assert shifted.u_offset == 3.0
    if shifted.settled == offsets.settled:
        assert shifted.y_offset == pytest.approx(offsets.y_offset + shift, abs=1e-9)
    else:  # only a tail that sits on the very limit may tip over by rounding
        assert {shifted.status, offsets.status} <= {"settled", "not settled"}


def test_removing_the_offsets_leaves_zero_at_the_start():
    u, y = np.array([2.0, 2, 2, 1.6]), np.array([1.0, 2, 6, 7])
    u_free, y_free = remove_offsets(u, y, find_offsets(u, y))
    np.testing.assert_allclose(u_free, [0, 0, 0, -0.4])
    np.testing.assert_allclose(y_free, [-2, -1, 3, 4])
    assert u[0] == 2.0  # the arguments are left alone


def test_a_constant_input_is_refused():
    message = r"u must change at least once; got the constant 2 over all 50 samples\. A constant input excites"
    for call in (first_period_length, lambda u: mean_of_first_period(u, u), lambda u: find_offsets(u, u)):
        with pytest.raises(ValueError, match=message):
            call(np.full(50, 2.0))


def test_lengths_must_agree():
    for call in (mean_of_first_period, find_offsets):
        with pytest.raises(ValueError, match="u and y must have equal length; got 3 and 4"):
            call([2, 2, 1], [0, 0, 0, 0])
    with pytest.raises(ValueError, match="u and y must have equal length; got 3 and 4"):
        remove_offsets([2, 2, 1], [0, 0, 0, 0], find_offsets([2, 2, 1], [0, 0, 0]))


def test_one_sample_is_too_few():
    with pytest.raises(ValueError, match="u must have at least 2 samples; got 1"):
        first_period_length([2.0])


# Several signals ------------------------------------------------------------------------------------------


def test_offsets_of_several_signals_are_those_of_the_lab_until_the_first_input_changes():
    rng = np.random.default_rng(1)
    u = np.column_stack([np.repeat([1.0, 2.0], [60, 40]), np.repeat([5.0, 4.0], [30, 70])])
    y = 3.0 + 0.01 * rng.standard_normal((100, 2)) + np.repeat([[0.0], [1.0]], [30, 70], axis=0)
    found = find_signal_offsets(u, y)
    assert (found.status, found.first) == ("rest", 1)
    np.testing.assert_array_equal(found.u_offset, [1.0, 5.0])
    for column, offset, one in zip(y.T, found.y_offset, found.outputs, strict=True):
        assert offset == find_offsets(u[:, 1], column).y_offset == one.y_offset
        assert one.first_period == 30


def test_inputs_that_move_from_the_start_have_means_and_steps_at_once_the_first_sample():
    rng = np.random.default_rng(2)
    u, y = rng.standard_normal((100, 2)) + 7, rng.standard_normal((100, 1))
    found = find_signal_offsets(u, y, stop=50)
    assert found.status == "means"
    np.testing.assert_array_equal(found.u_offset, u[:50].mean(axis=0))
    np.testing.assert_array_equal(found.y_offset, y[:50].mean(axis=0))
    step = find_signal_offsets(np.repeat([[0.0], [50.0]], [2, 98], axis=0), y)
    assert (step.status, step.u_offset[0], step.outputs[0].status) == ("rest", 0.0, "too short")
    with pytest.raises(ValueError, match="u must change at least once"):
        find_signal_offsets(np.ones((100, 2)), y)
