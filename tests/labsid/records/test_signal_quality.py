"""What sensors and loggers leave in raw samples: found where it was put in, and only there."""

import numpy as np
import pytest

from labsid.records.signal_quality import (
    find_held,
    lattice_step,
    moving_mean_length,
    runs,
    scatter,
    shortest_repeat,
    stuck_at_extreme,
)

WAVE = np.sin(np.arange(600) / 15)


def noisy(seed=0, size=600, sd=0.01):
    return WAVE[:size] + sd * np.random.default_rng(seed).standard_normal(size)


def test_runs_by_hand():
    starts, lengths = runs(np.array([3.0, 3.0, 1.0, 3.0, 3.0, 3.0]))
    assert starts.tolist() == [0, 2, 3]
    assert lengths.tolist() == [2, 1, 3]


@pytest.mark.parametrize("step", [5 / 1024, 0.001, 0.3, 1.0])
def test_the_lattice_of_a_converter_is_found(step):
    assert lattice_step(np.round(noisy() / step) * step + 0.123) == pytest.approx(step, rel=1e-9)


def test_no_lattice_in_other_samples():
    assert lattice_step(noisy()) is None
    assert lattice_step(np.repeat([1.6, 2.0], 50)) is None
    assert lattice_step(np.array([0.0, 1.0, 1.0 + np.pi])) is None


@pytest.mark.parametrize("sd", [0.003, 0.02])
def test_scatter_is_the_noise_of_a_slow_signal(sd):
    k = np.arange(4000)
    x = np.sin(k / 60) + sd * np.random.default_rng(2).standard_normal(k.size)
    assert scatter(x) == pytest.approx(sd, rel=0.08)


def test_a_stop_is_seen_at_either_end():
    x = np.clip(noisy(), -0.8, 0.6)
    samples, longest = stuck_at_extreme(x, 0.6)
    assert samples == np.sum(x == 0.6)
    assert 20 < longest <= samples
    assert stuck_at_extreme(x, -0.8)[0] == np.sum(x == -0.8)


@pytest.mark.parametrize(
    "x",
    [
        noisy(),
        np.round(noisy() / 0.005) * 0.005,
        np.round((1 - np.exp(-np.arange(300) / 20)) / 0.01) * 0.01,
        np.round(1 - 0.5 ** np.arange(100.0), 3),
        1 - 0.5 ** np.arange(100.0),
        np.repeat([1.6, 2.0, 2.2], 100),
    ],
    ids=["noise", "lattice", "slowly to rest", "quickly to rest", "to rest exactly", "staircase"],
)
def test_no_stop_in_other_samples(x):
    assert stuck_at_extreme(x, x.max()) == (0, 0)
    assert stuck_at_extreme(x, x.min()) == (0, 0)


def test_held_stretches_are_found_to_the_sample():
    x = noisy()
    x[100:112], x[400:404] = x[99], x[399]
    assert find_held(x, lattice_step(x)) == ((100, 112), (400, 404))


def test_a_lattice_repeats_values_by_itself():
    x = np.round(noisy(sd=0.005) / 0.01) * 0.01
    assert runs(x)[1].max() >= 3
    assert find_held(x, lattice_step(x)) == ()
    x[200:230] = x[199]
    assert len(find_held(x, lattice_step(x))) == 1


@pytest.mark.parametrize("m", [1, 2, 5, 20])
def test_the_length_of_a_moving_mean(m):
    x = noisy(1)
    y = np.convolve(x, np.ones(m) / m)[: x.size]
    y[: m - 1] = 77.0  # whatever went before the record
    assert moving_mean_length(x, y) == m


def test_other_filters_are_no_moving_mean():
    x = noisy(1)
    assert moving_mean_length(x, np.convolve(x, [0.5, 0.3, 0.2])[: x.size]) is None
    assert moving_mean_length(x, np.round(np.convolve(x, np.ones(5) / 5)[: x.size], 4)) is None
    assert moving_mean_length(x, np.convolve(x, np.ones(30) / 30)[: x.size]) is None


@pytest.mark.parametrize(("digits", "shortest"), [(12, 2), (6, 2), (3, 3), (2, 3)])
def test_two_equal_readings_are_a_hold_only_where_chance_makes_none_equal(digits, shortest):
    x = np.round(noisy(3), digits)
    assert shortest_repeat(x, 10.0**-digits) == shortest


def test_readings_of_a_converter_that_are_printed_with_other_digits_are_equal_by_chance():
    assert shortest_repeat(np.round(np.round(noisy(4) / 0.002061) * 0.002061, 5), 1e-5) == 3
    stale = noisy(5)
    stale[100:500:50] = stale[99:499:50]
    assert shortest_repeat(stale, 0.0) == 2


def test_a_record_of_few_changes_has_no_short_holds():
    assert shortest_repeat(np.repeat([0.0, 1.0, 2.0], 100), 0.0) == 3


@pytest.mark.parametrize("step", [0.02, 0.05])
def test_a_smooth_extreme_on_a_lattice_is_no_stop(step):
    """A coarse encoder repeats its highest value at every smooth maximum; a limit does so far more often."""
    told = 0
    for seed in range(40):
        coarse = np.round(noisy(seed, sd=0.4 * step) / step) * step
        assert stuck_at_extreme(coarse, coarse.max()) == (0, 0), seed
        clipped = np.minimum(coarse, round(0.6 / step) * step)
        told += stuck_at_extreme(clipped, clipped.max())[0] > 0
    assert told > 35


def test_a_smooth_extreme_on_a_lattice_is_no_stop_where_some_samples_lie_between_its_values():
    """A log that was resampled: every eighth sample is worked out from the two readings beside it."""
    told = 0
    for seed in range(40):
        resampled = np.round(noisy(seed, sd=0.008) / 0.02) * 0.02
        between = np.arange(4, resampled.size - 1, 8)
        resampled[between] = 0.37 * resampled[between - 1] + 0.63 * resampled[between + 1]
        assert stuck_at_extreme(resampled, resampled.max()) == (0, 0), seed
        clipped = np.minimum(resampled, 0.6)
        told += stuck_at_extreme(clipped, clipped.max())[0] > 0
    assert told > 35
