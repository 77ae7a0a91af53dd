"""When a slow sensor is read: found from its changes, with clocks of their own, lost readings and coarse lattices."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.records.slow_sensor import find_readings


@pytest.mark.parametrize(("every", "first"), [(2, 1), (3, 0), (7, 5)])
def test_a_sensor_slower_than_the_logger_is_seen(every, first):
    rng = np.random.default_rng(every)
    u = np.repeat(rng.uniform(-1, 1, 30), 20)
    readings = lfilter([0, 0.1], [1, -0.9], u) + 0.01 * rng.standard_normal(u.size)
    y = readings[np.maximum((np.arange(u.size) - first) // every, 0) * every + first]
    np.testing.assert_array_equal(find_readings(u, y).at, np.arange(first, u.size, every))
    y[333:] = readings[333:]
    assert find_readings(u, y) is None


@pytest.mark.parametrize("every", [2.4, 3.3, 6.7])
def test_a_slow_sensor_with_a_clock_of_its_own_is_seen(every):
    rng = np.random.default_rng(4)
    u = np.repeat(rng.uniform(-1, 1, 30), 20)
    readings = lfilter([0, 0.1], [1, -0.9], u) + 0.01 * rng.standard_normal(u.size)
    at = np.ceil(np.floor(np.arange(u.size) / every) * every).astype(int)
    np.testing.assert_array_equal(find_readings(u, readings[at]).at, np.unique(at)[1:])


@pytest.mark.parametrize("held", [1, 2, 4])
def test_a_sensor_slower_than_a_command_that_moves_is_seen(held):
    """Also where the command changes at every sample, or faster than the sensor reads."""
    rng = np.random.default_rng(held)
    u = np.repeat(rng.uniform(-1, 1, 600 // held), held)
    readings = lfilter([0, 0.1], [1, -0.9], u) + 0.01 * rng.standard_normal(u.size)
    at = np.arange(u.size) // 8 * 8
    np.testing.assert_array_equal(find_readings(u, readings[at]).at, np.unique(at))


def test_an_output_that_rests_between_steps_of_the_input_is_no_slow_sensor():
    u = np.repeat(np.random.default_rng(0).uniform(-1, 1, 60), 10)
    assert find_readings(u, 2 * u) is None


def read_at(at, digits=7, samples=1200, empty=False, seed=0):
    """A record whose sensor is read at these samples, and holds its reading or has none between."""
    rng = np.random.default_rng(seed)
    u = lfilter([0.5], [1, -0.5], rng.uniform(-1, 1, samples))
    y = np.round(lfilter([0, 0.1], [1, -0.9], u) + 0.005 * rng.standard_normal(samples), digits)
    seen = at[np.searchsorted(at, np.arange(samples), side="right") - 1]
    return u, np.where(np.isin(np.arange(samples), at), y, np.nan) if empty else y[np.maximum(seen, 0)]


EVEN = np.arange(0, 1200, 5)


@pytest.mark.parametrize("where", [slice(500, 501), slice(500, 560)])
def test_missing_samples_hide_no_slow_sensor(where):
    u, y = read_at(EVEN)
    y[where] = np.nan
    found = find_readings(u, y)
    assert (found.every, found.first) == (5.0, 0.0)
    np.testing.assert_array_equal(found.at, [k for k in EVEN if not np.isnan(y[k])])


@pytest.mark.parametrize("empty", [False, True])
def test_lost_readings_are_not_read(empty):
    kept = EVEN[np.random.default_rng(3).random(EVEN.size) > 0.1]
    found = find_readings(*read_at(kept, empty=empty))
    assert found.is_even
    assert set(kept[1:]) <= set(found.at) <= set(EVEN)


@pytest.mark.parametrize("empty", [False, True])
def test_readings_at_no_clock_are_taken_where_they_are(empty):
    at = np.cumsum(np.random.default_rng(4).integers(3, 8, 400))
    at = at[at < 1200]
    found = find_readings(*read_at(at, empty=empty))
    assert found.first is None
    np.testing.assert_array_equal(found.at[-200:], at[-200:])


def test_a_clock_that_starts_anew_leaves_its_readings():
    at = np.concatenate([np.arange(0, 600, 5), np.arange(603, 1200, 5)])
    found = find_readings(*read_at(at))
    assert found.first is None
    np.testing.assert_array_equal(found.at, at[1:])


def test_a_clock_is_found_on_a_coarse_lattice_and_beside_lost_readings():
    ticks = 2.2 + 4.31 * np.arange(278)
    at = np.ceil(ticks).astype(int)
    for readings in (read_at(at, digits=1), read_at(at[np.random.default_rng(5).random(at.size) > 0.1])):
        found = find_readings(*readings)
        assert found.every == pytest.approx(4.31, abs=2e-3)
        np.testing.assert_allclose(found.at[-1] - found.at[0], at[-1] - at[1], atol=5)


def test_slow_motion_over_a_coarse_lattice_is_no_slow_sensor():
    """Nor an output of which every other sample repeats the one before by chance."""
    rng = np.random.default_rng(6)
    u = np.repeat(rng.uniform(-1, 1, 40), 30)
    y = lfilter([0, 0.01], [1, -0.99], u)
    assert find_readings(u, np.round(y / 0.02)) is None
    fast = lfilter([0.5], [1, -0.5], rng.uniform(-1, 1, 1200))
    assert find_readings(u, fast[np.maximum.accumulate(np.where(rng.random(1200) < 0.5, np.arange(1200), 0))]) is None
