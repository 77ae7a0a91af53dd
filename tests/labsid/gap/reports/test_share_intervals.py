"""Intervals of closed shares: they hold the true share, and there is none where the gap is not told from noise."""

import numpy as np
import pytest

from labsid.gap.reports.share_intervals import share_interval

SAMPLES = 2000


def errors(rng: np.random.Generator, missed: float) -> np.ndarray:
    """White noise of variance one, and a sinusoid that a simulation misses."""
    wave = np.sqrt(2.0) * missed * np.sin(0.05 * np.arange(SAMPLES))
    return np.asarray(wave + rng.standard_normal(SAMPLES))


def test_the_interval_holds_the_true_share_in_most_records() -> None:
    found = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        interval = share_interval(errors(rng, 4.0), errors(rng, 1.0), 1.0)
        assert interval is not None
        found.append(interval[0] <= 0.75 <= interval[1])
    assert np.mean(found) >= 0.9


def test_an_exact_fit_closes_all_and_a_worse_one_less_than_nothing() -> None:
    rng = np.random.default_rng(0)
    before = errors(rng, 4.0)
    exact = share_interval(before, np.zeros(SAMPLES), 1.0)
    assert exact == pytest.approx((1.0, 1.0))
    worse = share_interval(before, errors(rng, 6.0), 1.0)
    assert worse is not None
    assert worse[1] < 0.0


def test_without_a_gap_or_with_few_samples_there_is_none() -> None:
    rng = np.random.default_rng(0)
    noise = errors(rng, 0.0)
    assert share_interval(noise, noise, 1.0) is None
    assert share_interval(errors(rng, 4.0)[:99], errors(rng, 1.0)[:99], 1.0) is None
    assert share_interval(errors(rng, 4.0), np.full(SAMPLES, np.inf), 1.0) is None
