"""Levels under a staircase: where they are, whether they repeat, and how far they scatter."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.lab.plateaus import MAX_PERIODS, repeated_plateaus


def staircase(levels: list[float], ends: list[float], noise: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """100 samples a level; y goes to each end with a time constant of 5 samples."""
    u, y, at = np.repeat(levels, 100), [], ends[0]
    for end in ends:
        y.append(end + (at - end) * np.exp(-np.arange(1, 101) / 5.0))
        at = end
    return u, np.concatenate(y) + noise * np.random.default_rng(0).standard_normal(u.size)


def test_levels_that_repeat_and_levels_that_do_not() -> None:
    u, y = staircase([1, 2, 1, 2], [10.0, 20.0, 10.0, 20.0], noise=0.05)
    found = repeated_plateaus(u, y)
    assert found is not None
    assert found.repeat
    assert found.stretches == {1.0: ((75, 100), (275, 300)), 2.0: ((175, 200), (375, 400))}
    assert found.noise == pytest.approx(0.05, rel=0.4)
    u, y = staircase([1, 2, 1, 2], [10.0, 20.0, 10.5, 20.1])
    found = repeated_plateaus(u, y)
    assert found is not None
    assert not found.repeat
    assert found.ends[1.0] == pytest.approx((10.0, 10.5))
    assert found.largest == pytest.approx(0.5, rel=1e-4)
    assert found.span == pytest.approx(10.1, abs=0.01)


def test_the_scatter_is_about_the_mean_of_each_level_and_counts_what_it_should() -> None:
    u, y = staircase([1, 2, 1, 2, 1], [10.0, 20.0, 11.0, 20.0, 12.0])
    found = repeated_plateaus(u, y)
    assert found is not None
    all_of_it = np.ones(u.size, bool)
    assert found.scatter(y, all_of_it) == pytest.approx(np.sqrt(2.0 / 3.0))  # squares 1 and 1 of 3 degrees of freedom
    assert found.scatter(y - u, all_of_it) == pytest.approx(found.scatter(y, all_of_it))
    y[290] = 1e6
    assert found.scatter(y, np.arange(u.size) != 290) == pytest.approx(np.sqrt(2.0 / 3.0), abs=1e-3)
    assert found.scatter(y, np.zeros(u.size, bool)) == 0.0


@pytest.mark.parametrize("pole", [0.0, 0.7])
def test_noise_alone_rarely_scatters_the_ends_further_than_it_may(pole: float) -> None:
    u, clean = staircase([1, 2, 3, 2, 1, 2, 3], [10.0, 20.0, 30.0, 20.0, 10.0, 20.0, 30.0])
    found = repeated_plateaus(u, clean)
    assert found is not None
    counted, further = np.ones(u.size, bool), 0
    assert found.by_chance(np.zeros(u.size), counted) == 0.0
    for seed in range(200):
        noise = lfilter([1.0], [1.0, -pole], np.random.default_rng(seed).standard_normal(u.size))
        further += found.scatter(noise, counted) > found.by_chance(noise, counted)
    assert 0 < further < (30 if pole == 0.0 else 60)  # of slow noise, tails of 25 samples show a part
    moved = np.where((u == 2.0) & (np.arange(u.size) < 300), 1.0, 0.0)
    assert found.scatter(moved, counted) > 0.3
    assert found.by_chance(moved, counted) == 0.0


@pytest.mark.parametrize(
    ("levels", "ends"), [([1, 2, 3], [10.0, 20.0, 30.0]), ([1, 2] * (MAX_PERIODS // 2 + 1), [10.0, 20.0] * 26)]
)
def test_levels_that_come_once_and_inputs_that_never_rest_have_none(levels: list[float], ends: list[float]) -> None:
    assert repeated_plateaus(*staircase(levels, ends)) is None


def test_what_still_moves_at_its_end_is_no_plateau() -> None:
    u = np.repeat([1.0, 2.0, 1.0, 2.0], 100)
    assert repeated_plateaus(u, np.cumsum(u - 1.5)) is None
