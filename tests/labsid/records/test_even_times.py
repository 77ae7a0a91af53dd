"""Stamps that jitter: the even times behind them, and what is no jitter."""

import numpy as np
import pytest

from labsid.records.even_times import fit_even_times

K = np.arange(1000)


@pytest.fixture(scope="module")
def shaken():
    """Normal jitter of 3 % about even times at 0.05 s."""
    return 0.05 * (K + 0.03 * np.random.default_rng(0).standard_normal(1000))


def test_even_times_are_what_least_squares_finds(shaken):
    found = fit_even_times(shaken)
    slope, start = np.polyfit(K, shaken, 1)
    rest = (shaken - np.polyval([slope, start], K)) / slope
    assert found.jitter == pytest.approx(np.sqrt(np.mean(rest**2)), rel=1e-4)
    assert np.abs(found.t - np.polyval([slope, start], K)).max() < found.jitter * found.Ts


def test_the_sampling_time_is_the_round_one_that_the_jitter_allows(shaken):
    assert fit_even_times(shaken).Ts == 0.05
    assert fit_even_times(shaken + 1.7e9).Ts == 0.05
    assert fit_even_times(shaken / 60).Ts == pytest.approx(0.05 / 60, rel=1e-12)
    assert fit_even_times(np.round(K / 30, 3)).Ts == pytest.approx(1 / 30, rel=1e-12)
    assert fit_even_times(K * 0.0512345).Ts == pytest.approx(0.0512345, rel=1e-12)


def test_the_first_time_is_rounded_no_further_than_the_jitter(shaken):
    first = fit_even_times(shaken).t[0]
    assert first == round(first, 4) == pytest.approx(0.0, abs=0.0003)
    assert fit_even_times(shaken + 12.34).t[0] == pytest.approx(12.34, abs=0.0005)
    assert fit_even_times(K * 0.5 + 3e-7).t[0] == pytest.approx(3e-7, abs=1e-12)


def test_a_stamp_may_be_off_by_three_tenths_of_the_sampling_time_and_no_more():
    for off, near in ((0.28, True), (-0.28, True), (0.32, False), (-0.32, False)):
        stamps = K.astype(float)
        stamps[500] += off
        assert (fit_even_times(stamps) is not None) == near


@pytest.mark.parametrize("missing", [1, 2, 500, 996, 997])
def test_a_missing_or_a_doubled_stamp_is_no_jitter(shaken, missing):
    assert fit_even_times(np.delete(shaken, missing)) is None
    assert fit_even_times(np.insert(shaken, missing, shaken[missing])) is None


def test_time_that_runs_backwards_or_not_at_all_is_no_jitter(shaken):
    swapped = shaken.copy()
    swapped[[500, 501]] = swapped[[501, 500]]
    for stamps in (swapped, shaken[::-1], np.zeros(1000)):
        assert fit_even_times(stamps) is None
