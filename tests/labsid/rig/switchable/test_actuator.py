"""Each block of the actuator against what it does by definition."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.rig.switchable.actuator import actuator_output, limited
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE, Actuator, Profile, profile_values

V = np.repeat([0.0, 1.0, -0.5, 0.2, 0.9, -1.0], 10)


def ends(actuator: Actuator, v: np.ndarray = V) -> np.ndarray:
    """Output of the actuator at the end of each sample."""
    begin, end = actuator_output(actuator, v)
    assert begin.shape == end.shape == (v.size * STEPS_PER_SAMPLE,)
    return end[STEPS_PER_SAMPLE - 1 :: STEPS_PER_SAMPLE]


def test_without_effects_the_command_is_held() -> None:
    begin, end = actuator_output(Actuator(), V)
    np.testing.assert_array_equal(begin, np.repeat(V, STEPS_PER_SAMPLE))
    np.testing.assert_array_equal(end, begin)


def test_limits_dead_band_and_curve() -> None:
    np.testing.assert_array_equal(ends(Actuator(low=-0.4, high=0.8)), np.clip(V, -0.4, 0.8))
    expected = np.where(V > 0.3, V - 0.3, np.where(V < -0.2, V + 0.2, 0.0))
    np.testing.assert_allclose(ends(Actuator(dead_low=-0.2, dead_high=0.3)), expected, atol=1e-15)
    np.testing.assert_allclose(ends(Actuator(c2=0.2, c3=-0.1)), V + 0.2 * V**2 - 0.1 * V**3)


def test_a_dead_band_with_a_jump() -> None:
    jumping = Actuator(dead_low=-0.2, dead_high=0.3, dead_jump=0.5)
    expected = np.where(V > 0.3, V - 0.15, np.where(V < -0.2, V + 0.1, 0.0))
    np.testing.assert_allclose(ends(jumping), expected, atol=1e-15)


def test_rounded_corners_change_only_the_corners() -> None:
    v = np.linspace(-2, 2, 401)
    soft, sharp = limited(v, -1, 1, 0.05), limited(v, -1, 1, 0.0)
    assert np.max(np.abs(soft - sharp)) == pytest.approx(0.025, rel=0.02)
    assert np.max(np.abs(soft - sharp)[np.abs(np.abs(v) - 1) > 0.5]) < 2e-3


def test_backlash_follows_only_beyond_its_play() -> None:
    v = np.array([0.0, 0.1, 0.5, 0.4, 0.1, 0.1, 0.6])
    np.testing.assert_allclose(ends(Actuator(backlash=0.4), v), [0, 0, 0.3, 0.3, 0.3, 0.3, 0.4])


def test_the_slew_is_the_largest_change_in_a_sample() -> None:
    begin, end = actuator_output(Actuator(slew=0.25), V)
    assert np.max(np.abs(end - begin)) == pytest.approx(0.25 / STEPS_PER_SAMPLE)
    np.testing.assert_allclose(begin[1:], end[:-1])
    np.testing.assert_allclose(ends(Actuator(slew=0.25))[10:15], [0.25, 0.5, 0.75, 1.0, 1.0])


def test_a_relay_switches_on_above_and_off_below() -> None:
    v = np.array([0.0, 0.4, 0.6, 0.4, 0.1, 0.4])
    np.testing.assert_allclose(ends(Actuator(relays=((0.2, 0.5, 1.0),)), v) - v, [0, 0, 1, 1, 0, 0])


def test_a_sticking_valve_waits_and_then_jumps() -> None:
    v = np.array([0.0, 0.2, 0.35, 0.4, 0.1, 0.0, -0.1])
    np.testing.assert_allclose(ends(Actuator(stick_band=0.3), v), [0, 0, 0.35, 0.35, 0.35, 0.0, 0.0])


def test_an_unmeasured_valve_turns_the_gain_up_and_down() -> None:
    factor = ends(Actuator(valve_spread=0.4, valve_hold=8.0, seed=2), np.ones(400))
    assert np.all(np.abs(factor - 1) <= 0.4)
    assert np.std(factor) == pytest.approx(0.4 / np.sqrt(3), rel=0.3)
    assert 15 < np.count_nonzero(np.diff(factor)) < 90


def test_a_failing_actuator_holds_its_last_output() -> None:
    expected = V.copy()
    expected[15:25] = V[14]
    np.testing.assert_array_equal(ends(Actuator(failures=((15, 25),))), expected)


def test_a_changing_gain_acts_from_the_true_zero() -> None:
    y = ends(Actuator(gain_change=0.5, zero=-1.0))
    assert y[-1] == pytest.approx(-1.0)  # the command is at the true zero
    assert y[45] == pytest.approx((0.9 + 1) * (1 + 0.5 * 46 / 60) - 1, abs=0.01)


def test_a_swinging_delay_stays_between_its_ends() -> None:
    v = np.zeros(400)
    v[100:] = 1.0
    instants = [
        np.argmax(actuator_output(replace(Actuator(delay=5.0, delay_swing=4.0), delay_period=period), v)[0] > 0)
        / STEPS_PER_SAMPLE
        for period in (30.0, 47.0, 81.0, 130.0)
    ]
    assert all(100.5 <= instant <= 109.5 for instant in instants)
    assert np.ptp(instants) > 1.0


@pytest.mark.parametrize("kind", ["ramp", "settle", "half-sine", "wander"])
def test_slow_profiles_start_at_zero_and_are_of_order_one(kind: str) -> None:
    values = profile_values(Profile(kind, 0.3, 5), np.linspace(0, 1, 500))
    assert values[0] == 0.0
    assert np.max(np.abs(values)) == pytest.approx(1.0, abs=0.01)
    assert np.max(np.abs(np.diff(values))) < 0.03


def test_an_unknown_profile_is_refused() -> None:
    with pytest.raises(ValueError, match="profile must be ramp"):
        profile_values(Profile("zigzag"), np.zeros(3))
