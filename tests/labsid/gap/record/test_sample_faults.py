"""Sample faults: held stretches, spikes and lattices, and what resembles them."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap.record.sample_faults import (
    find_bad_start,
    find_lattice,
    find_spikes,
    flat_samples,
    without_limited,
    without_responses,
    without_rest,
    without_slow_ends,
)
from labsid.records.signal_quality import find_held, lattice_step


@pytest.fixture
def noise() -> np.ndarray:
    """White noise, 400 samples."""
    return np.random.default_rng(1).standard_normal(400)


def test_a_held_stretch_begins_behind_its_first_reading(noise: np.ndarray) -> None:
    noise[100:108] = noise[100]
    noise[250:290] = noise[250]
    assert find_held(noise, None) == ((101, 108), (251, 290))


def test_two_equal_readings_are_no_hold(noise: np.ndarray) -> None:
    noise[100] = noise[99]
    assert find_held(noise, None) == ()


def test_a_sensor_on_its_stop_does_not_hold(noise: np.ndarray) -> None:
    assert find_held(np.clip(noise, -1.0, 1.0), None) == ()


def test_a_value_to_which_the_output_comes_back_is_a_stop_or_rest(noise: np.ndarray) -> None:
    for start in (60, 150, 300):
        noise[start : start + 30] = 0.25
    noise[200:230] = noise[200]
    assert find_held(noise, None) == ((201, 230),)


def test_a_logger_that_sleeps_often_may_do_so_at_the_extreme_too(noise: np.ndarray) -> None:
    """Two holds elsewhere may be chance, three are a habit."""
    for start in (60, 150):
        noise[start : start + 8] = noise[start]
    noise[300:308] = noise.max() + 1.0
    assert find_held(noise, None) == ((61, 68), (151, 158))
    noise[220:228] = noise[220]
    assert find_held(noise, None) == ((61, 68), (151, 158), (221, 228), (301, 308))


def test_a_logger_that_sleeps_often_may_do_so_from_the_first_sample_on() -> None:
    """Alone, equal readings at the start are rest; where the output then jumps, and others follow, they are a hold."""
    swing = np.sin(0.03 * np.arange(400)) + 1e-3 * np.random.default_rng(1).standard_normal(400)
    swing[:9] = swing[0]
    assert find_held(swing, None) == ()
    for start in (100, 200, 300):
        swing[start : start + 9] = swing[start]
    assert find_held(swing, None) == ((1, 9), (101, 109), (201, 209), (301, 309))
    swing[:9] = swing[9]  # at rest until it moves
    assert find_held(swing, None) == ((101, 109), (201, 209), (301, 309))


def test_a_fine_lattice_is_ignored(noise: np.ndarray) -> None:
    """Below a ten-thousandth of the range, equal readings are not due to the converter."""
    noise[100:104] = noise[100]
    step = np.ptp(noise)
    assert find_held(noise, 0.5e-4 * step) == ((101, 104),)
    assert find_held(noise, 0.05 * step) == ()


def test_on_a_lattice_only_a_far_longer_stretch_is_a_hold() -> None:
    """A slow wave on a coarse converter rests on its steps for a few samples everywhere."""
    wave = np.round(20.0 * np.sin(0.02 * np.arange(600))) / 20.0
    step = lattice_step(wave)
    assert step == pytest.approx(0.05)
    assert find_held(wave, step) == ()
    wave[200:330] = wave[200]
    ((start, stop),) = find_held(wave, step)
    assert start <= 210
    assert stop == 330


@pytest.mark.parametrize(
    ("onward", "held"),
    [
        ([5, 5, 4, 4], True),  # the output has gone elsewhere meanwhile
        ([1, 2, 2, 3], False),  # it goes on as if nothing had been
        ([1, 1, 1, 2], False),
        ([3, 6, 9, 12], False),  # a highpass move begins
        ([-6, -8, -9, -9], True),
    ],
)
def test_on_a_lattice_a_hold_ends_with_a_jump(onward: list[int], held: bool) -> None:
    steps = np.random.default_rng(1).integers(-9, 9, 300).astype(float)
    steps[150:190] = 2
    steps[190:194] = 2 + np.array(onward)
    assert find_held(steps, 1.0) == (((151, 190),) if held else ())


def test_on_a_lattice_the_end_of_the_record_is_no_jump() -> None:
    steps = np.random.default_rng(1).integers(-9, 9, 300).astype(float)
    steps[260:] = 2
    assert find_held(steps, 1.0) == ()


def test_deviations_within_a_converter_step_are_no_spikes(noise: np.ndarray) -> None:
    """A quiet output on a coarse lattice: most readings agree, some are the neighbouring value."""
    e = 0.01 * noise
    e[[50, 120, 300]] += 1.0
    usable = np.ones(400, bool)
    assert np.flatnonzero(find_spikes(e, usable)).tolist() == [50, 120, 300]
    assert not find_spikes(e, usable, 1.1).any()
    e[120] += 1.0
    assert np.flatnonzero(find_spikes(e, usable, 1.1)).tolist() == [120]


@pytest.mark.parametrize("on_stop", [0.0, 0.4, 0.8])
def test_noise_has_no_spikes_at_a_sensor_limit(noise: np.ndarray, on_stop: float) -> None:
    """At the limit the residual is zero; its median would indicate no noise."""
    e = noise.copy()
    for block in np.array_split(np.arange(400), 5):
        e[block[: round(on_stop * block.size)]] = 0.0
    usable = np.ones(400, bool)
    assert not find_spikes(e, usable).any()
    e[395] += 15.0
    assert np.flatnonzero(find_spikes(e, usable)).tolist() == [395]


@pytest.mark.parametrize("length", [1, 2])
def test_isolated_samples_far_off_are_spikes(noise: np.ndarray, length: int) -> None:
    noise[50 : 50 + length] += 15.0
    noise[300] -= 15.0
    expected = [*range(50, 50 + length), 300]
    assert np.flatnonzero(find_spikes(noise, np.ones(400, bool))).tolist() == expected


def test_three_in_a_row_are_spikes_if_they_are_unlike_each_other(noise: np.ndarray) -> None:
    """Three similar values are a real event."""
    noise[50:53] += [-40.0, 30.0, 60.0]
    noise[300:303] += 30.0
    assert np.flatnonzero(find_spikes(noise, np.ones(400, bool))).tolist() == [50, 51, 52]


def test_noise_has_no_spikes(noise: np.ndarray) -> None:
    assert not find_spikes(noise, np.ones(400, bool)).any()


@pytest.mark.parametrize("first", [0.0, 15.0, 45.0])
def test_a_jump_that_stays_is_no_spike(noise: np.ndarray, first: float) -> None:
    """Nor is a reading on the edge of the jump."""
    noise[199] += first
    noise[200:] += 30.0
    assert not find_spikes(noise, np.ones(400, bool)).any()


def test_a_ramp_and_a_longer_bump_are_no_spikes(noise: np.ndarray) -> None:
    noise[200:212] += 25.0
    noise += np.linspace(0.0, 200.0, 400)
    assert not find_spikes(noise, np.ones(400, bool)).any()


def test_samples_that_are_no_readings_are_no_spikes(noise: np.ndarray) -> None:
    noise[50], noise[120] = 40.0, 40.0
    usable = np.ones(400, bool)
    usable[120] = False
    assert np.flatnonzero(find_spikes(noise, usable)).tolist() == [50]


def test_too_few_samples_have_no_spikes() -> None:
    assert not find_spikes(np.array([0.0, 0.0, 9.0, 0.0, 0.1, 0.0]), np.ones(6, bool)).any()


def test_a_lattice_is_found_and_a_fine_scale_is_none(noise: np.ndarray) -> None:
    assert lattice_step(np.round(noise / 0.25) * 0.25) == pytest.approx(0.25)
    assert lattice_step(noise) is None


def test_an_initial_rest_is_no_held_stretch(noise: np.ndarray) -> None:
    y = noise.copy()
    y[:40] = y[0]
    assert find_held(y, None) == ()
    y[60:100] = y[60]
    assert find_held(y, None) == ((61, 100),)


def test_a_spike_may_stand_at_the_end_of_the_record_but_not_at_its_start(noise: np.ndarray) -> None:
    e = noise.copy()
    e[[0, -1]] = 12.0 * np.std(noise)
    spikes = find_spikes(e, np.ones(e.size, bool))
    assert np.flatnonzero(spikes).tolist() == [e.size - 1]


def test_a_lattice_is_found_although_a_few_samples_lie_off_it() -> None:
    """Spikes added after the converter are off the lattice."""
    y = np.round(8.0 * np.sin(0.05 * np.arange(400))) / 8.0
    lattice, off = find_lattice(y)
    assert lattice == pytest.approx(0.125)
    assert not off.any()
    y[[50, 130, 260]] += 1.2345, -2.1, 0.777
    assert lattice_step(y) is None
    lattice, off = find_lattice(y)
    assert lattice == pytest.approx(0.125)
    assert np.flatnonzero(off).tolist() == [50, 130, 260]


def test_a_value_of_the_lattice_that_comes_only_once_is_on_it() -> None:
    """The top of a single swing, as a converter reads it, is no spike; nor is rounding of the last digit."""
    y = np.round(8.0 * np.sin(0.05 * np.arange(400))) / 8.0
    y[200] += 2.5
    y[[50, 130]] += 0.03, 1.2345
    y[300] += 1e-9
    lattice, off = find_lattice(y)
    assert lattice == pytest.approx(0.125)
    assert (y == y[200]).sum() == 1
    assert np.flatnonzero(off).tolist() == [50, 130]


@pytest.mark.parametrize("times", [1, 3])
def test_continuous_values_lie_on_no_lattice_held_or_not(noise: np.ndarray, times: int) -> None:
    lattice, off = find_lattice(np.repeat(noise, times))
    assert lattice is None
    assert not off.any()


def test_values_of_which_many_come_only_once_lie_on_no_lattice(noise: np.ndarray) -> None:
    y = np.round(8.0 * np.sin(0.05 * np.arange(400))) / 8.0
    y[::8] = noise[::8]
    assert find_lattice(y)[0] is None


def test_a_hold_that_begins_on_the_stop_of_the_sensor_ends_with_a_jump(noise: np.ndarray) -> None:
    y = np.minimum(np.sin(0.05 * np.arange(400)) + 0.01 * noise, 0.7)
    assert np.all(y[141:174] == 0.7)
    assert find_held(y, None) == ()
    y[141:176] = 0.7  # it leaves the stop a moment later: no jump
    assert find_held(y, None) == ()
    y[141:200] = 0.7
    assert find_held(y, None) == ((142, 200),)


def test_noise_makes_a_coarse_converter_jump_off_the_stop_of_the_sensor() -> None:
    restless = np.where(np.arange(70) % 2, 66, 63)
    restless[:2] = (
        67,
        66,
    )  # leaves the stop as a hold ends, but no further than noise
    y = 0.01 * np.tile(np.concatenate([restless, np.full(30, 70)]), 4)[30:]
    assert find_held(y, 0.01) == ()
    y[70:75] = 0.5, 0.48, 0.5, 0.48, 0.5  # the output has gone far away meanwhile
    assert find_held(y, 0.01) == ((41, 70),)


@pytest.mark.parametrize(("first", "expected"), [(0.02, False), (0.3, False), (1.5, True), (-40.0, True)])
def test_a_first_sample_that_the_rig_cannot_have_left_is_bad(first: float, expected: bool) -> None:
    rng = np.random.default_rng(2)
    w = np.repeat(rng.uniform(-1.0, 1.0, 40), 15)
    y = lfilter([0.0, 0.2], [1.0, -0.8], w) + 0.01 * rng.standard_normal(w.size)
    y[0] += first
    found = find_bad_start(y)
    assert found[0] == expected
    assert not found[1:].any()


def test_spikes_at_changes_of_the_input_are_a_response() -> None:
    """A rig that passes its input on within the sample, and two spikes of the sensor elsewhere."""
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(-1.0, 1.0, 40), 20)
    passed = np.diff(u, prepend=u[:1])  # what a strictly proper simulation leaves
    e = passed + 0.01 * rng.standard_normal(u.size)
    e[[110, 333]] += 1.0
    everywhere = np.ones(u.size, bool)
    found = find_spikes(e, everywhere)
    assert found[20::20].sum() > 30
    assert np.flatnonzero(without_responses(found, u)).tolist() == [110, 333]


@pytest.mark.parametrize("hold", [1, 2, 20])
@pytest.mark.parametrize("seed", range(5))
def test_spikes_that_meet_changes_of_the_input_by_chance_stay(hold: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1.0, 1.0, 800 // hold), hold)
    spikes = np.zeros(u.size, bool)
    spikes[rng.choice(u.size, 12, replace=False)] = True
    np.testing.assert_array_equal(without_responses(spikes, u), spikes)
    nothing = np.zeros(u.size, bool)
    np.testing.assert_array_equal(without_responses(nothing, u), nothing)


@pytest.mark.parametrize("delay", [0, 7])
def test_a_rig_without_noise_rests_until_its_input_changes(delay: int) -> None:
    u = np.repeat(np.random.default_rng(4).uniform(-1.0, 1.0, 20), 40)
    y = np.concatenate([np.full(delay, u[0]), u[: u.size - delay]])
    held = find_held(y, None)
    assert len(held) > 10
    assert without_rest(held, u) == ()


def test_holds_at_other_instants_than_the_input_changes_stay(noise: np.ndarray) -> None:
    u = np.repeat(np.random.default_rng(4).uniform(-1.0, 1.0, 20), 20)
    for start in (53, 148, 231):
        noise[start : start + 9] = noise[start]
    held = find_held(noise, None)
    assert len(held) == 3
    assert without_rest(held, u) == held
    assert without_rest((), u) == ()


def test_flat_stretches_and_their_neighbours_are_marked(noise: np.ndarray) -> None:
    noise[100:104] = noise[100]
    noise[200:203] = noise[200]
    assert np.flatnonzero(flat_samples(noise)).tolist() == [99, 100, 101, 102, 103, 104]


def test_rest_that_goes_on_by_next_to_nothing_is_no_hold() -> None:
    y = np.repeat([0.0, 1.0, 1.0 + 1e-7, 1.0 + 2e-7, 3.0], [5, 9, 7, 20, 2])
    stretches = ((1, 5), (6, 14), (15, 21), (22, 41), (42, 43))
    assert without_slow_ends(stretches, y, 1e-4) == ((1, 5), (22, 41), (42, 43))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_lowest_readings_that_are_too_high_are_those_of_a_limit(noise: np.ndarray, sign: float) -> None:
    """Or the highest ones that are too low; spikes elsewhere, and those that point outside, stay."""
    true = sign * noise
    limit = np.partition(noise, 6)[6]
    limited = noise < limit
    y = sign * np.maximum(noise, limit)
    assert not without_limited(limited, y - true, y).any()
    outside = sign * np.where(limited, noise - 1.0, noise)
    np.testing.assert_array_equal(without_limited(limited, outside - true, outside), limited)
    anywhere = np.arange(noise.size) % 67 == 5
    y = np.where(anywhere, true + 0.5, true)
    np.testing.assert_array_equal(without_limited(anywhere, y - true, y), anywhere)
    assert not without_limited(np.zeros(noise.size, bool), y - true, y).any()
