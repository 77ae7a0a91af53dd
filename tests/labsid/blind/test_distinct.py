"""Records that show an effect, and such as another effect would leave too."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.blind.distinct import is_distinct, left_by_overflow
from labsid.blind.draws import draw_experiment, on_stops
from labsid.blind.experiment import Experiment
from labsid.blind.strength import clean_output
from labsid.rig.switchable._motion import Motion
from labsid.rig.switchable.setup import Setup

AXIS, MASS = "motor, position on a leaky integrator", "mass on a spring"


def an_experiment(rig: str, seed: int = 0, **motion: float) -> Experiment:
    made = draw_experiment(np.random.default_rng(seed), "", 2000, ("levels",), (rig,))
    plain = replace(made.plain, motion=made.plain.motion._replace(**motion))
    return replace(made, plain=plain, setup=plain, start=(0.0, 0.0))


def with_motion(experiment: Experiment, **motion: float) -> Setup:
    changed: Motion = experiment.plain.motion._replace(**motion)
    return replace(experiment.plain, motion=changed)


def test_an_overflow_imitates_one_stop_of_an_axis_whose_speed_settles_at_once() -> None:
    fast, slow = an_experiment(AXIS, T0=0.1, T1=30.0), an_experiment(AXIS, T0=20.0, T1=30.0)
    left = [left_by_overflow(e, with_motion(e, stop_high=0.2)) / np.std(clean_output(e, e.plain)) for e in (fast, slow)]
    assert left[0] < 0.005 < 0.02 < left[1]
    low = with_motion(slow, stop_low=-0.2)
    assert 0.005 < left_by_overflow(slow, low) < np.inf


def test_an_overflow_imitates_neither_two_stops_nor_a_swinging_mass() -> None:
    axis, mass = an_experiment(AXIS), an_experiment(MASS, damping=0.3)
    assert left_by_overflow(axis, with_motion(axis, stop_low=-0.2, stop_high=0.2)) == np.inf
    assert left_by_overflow(mass, with_motion(mass, stop_high=0.2)) == np.inf


def test_an_end_stop_counts_if_the_motion_rests_on_it_and_the_noise_does_not_hide_it() -> None:
    axis = an_experiment(AXIS, T0=20.0, T1=30.0)
    y = clean_output(axis, axis.plain)
    touched, missed = with_motion(axis, stop_high=0.4 * y.max()), with_motion(axis, stop_high=y.max() + 0.01)
    assert on_stops(axis, touched)[1].mean() > 0.03
    assert not on_stops(axis, missed).any()
    left = left_by_overflow(axis, touched)
    assert is_distinct("end-stop", axis, touched, 0.5 * left)
    assert not is_distinct("end-stop", axis, touched, 2.0 * left)
    assert not is_distinct("end-stop", axis, missed, 1e-6)


def test_play_counts_if_the_sensor_crosses_it() -> None:
    axis = an_experiment(AXIS)
    range_ = np.ptp(clean_output(axis, axis.plain))
    assert is_distinct("output-backlash", axis, with_motion(axis, play=0.1 * range_), 0.01)
    assert not is_distinct("output-backlash", axis, with_motion(axis, play=0.95 * range_), 0.01)


@pytest.mark.parametrize(("share", "times", "counts"), [(0.3, 8.0, True), (-0.1, 8.0, False), (0.3, 4.0, False)])
def test_a_slow_mode_is_large_and_slow(share: float, times: float, counts: bool) -> None:
    axis = an_experiment(AXIS)
    slow = with_motion(axis, slow_share=share, slow_time=times * axis.time)
    assert is_distinct("slow-mode", axis, slow, 0.01) is counts
