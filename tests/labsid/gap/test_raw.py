"""Single samples: held stretches, spikes and lattices, and what only looks like them."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.answer import _screen
from labsid.gap.raw import RawFaults, find_held, find_spikes
from labsid.gap.which import Explained
from labsid.signal_quality import lattice_step


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


def test_on_a_lattice_only_a_far_longer_stretch_is_a_hold() -> None:
    """A slow wave on a coarse converter rests on its steps for a few samples everywhere."""
    wave = np.round(20.0 * np.sin(0.02 * np.arange(600))) / 20.0
    step = lattice_step(wave)
    assert step == pytest.approx(0.05)
    assert find_held(wave, step) == ()
    wave[200:330] = wave[200]
    assert any(start <= 210 and stop >= 320 for start, stop in find_held(wave, step))


@pytest.mark.parametrize("length", [1, 2])
def test_isolated_samples_far_off_are_spikes(noise: np.ndarray, length: int) -> None:
    noise[50 : 50 + length] += 15.0
    noise[300] -= 15.0
    expected = [*range(50, 50 + length), 300]
    assert np.flatnonzero(find_spikes(noise, np.ones(400, bool))).tolist() == expected


def test_noise_has_no_spikes(noise: np.ndarray) -> None:
    assert not find_spikes(noise, np.ones(400, bool)).any()


@pytest.mark.parametrize("first", [0.0, 15.0, 45.0])
def test_a_jump_that_stays_is_no_spike(noise: np.ndarray, first: float) -> None:
    """Nor is a first reading half way up, or a little beyond."""
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


def test_bad_samples_are_the_held_and_the_spikes() -> None:
    held, spikes = np.zeros(5, bool), np.zeros(5, bool)
    held[1], spikes[3] = True, True
    assert RawFaults(held, ((1, 2),), spikes, None).bad.tolist() == [False, True, False, True, False]


def test_a_record_that_begins_at_rest_holds_nothing(noise: np.ndarray) -> None:
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


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        ((), []),
        ((4,), ["1 isolated sample stands far from its neighbours; the fits leave it out."]),
        ((4, 9), ["2 isolated samples stand far from their neighbours; the fits leave them out."]),
    ],
)
def test_what_the_samples_say_is_counted_in_words(plain: Explained, bad: tuple[int, ...], said: list[str]) -> None:
    none = np.zeros(plain.data.samples, bool)
    spikes = none.copy()
    spikes[list(bad)] = True
    assert _screen(replace(plain, faults=RawFaults(none, (), spikes, None))) == said
