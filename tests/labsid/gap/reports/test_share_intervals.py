"""Intervals of closed shares: they hold the true share, and there is none where the gap is not told from noise."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.reports.share_intervals import share_interval
from labsid.gap.reports.traces import record_traces
from labsid.records.record import Record

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


def run(seed: int, curve: float, name: str) -> Record:
    """Two lags behind a limit of the actuator, and a curve of the sensor that no candidate of the search has."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(1.0, 4.0, 32), 20)
    w = np.minimum(u, 3.0)
    y = w[0] + lfilter([0.0, 0.01], np.poly([0.95, 0.8]), w - w[0])
    return Record(0.5 * np.arange(u.size), u, y + curve * y**3 + 0.005 * rng.standard_normal(u.size), 0.5, name=name)


@pytest.mark.parametrize(("curve", "second"), [(0.0, False), (0.02, False), (0.02, True)])
@searched("input-saturation", "load-step")
def test_the_ranking_has_intervals_around_its_shares(curve: float, second: bool) -> None:
    holdout = run(2, curve, "second") if second else None
    found = diagnose(run(1, curve, "first"), holdout=holdout).report
    assert found["verdict"] == ("effect" if curve == 0.0 else "partial")
    known = [row for row in found["ranking"] if row.get("ci95") is not None]
    assert "input-saturation" in {row["name"] for row in known}
    for row in known:
        low, high = row["ci95"]
        assert -1.0 <= low < row["closed"] < high <= 1.0


@searched("input-saturation")
def test_several_records_have_the_traces_of_the_fits_that_are_scored() -> None:
    found = diagnose([run(1, 0.02, "first"), run(2, 0.02, "second")]).report
    assert all("ci95" not in row for row in found["ranking"])
    for row, trace in zip(found["records"], record_traces(found), strict=True):
        scored = trace["counts"] > 0.0
        assert scored.sum() == row["samples"] - row["unscored"]
        for name in ("before", "after"):
            error = np.sqrt(np.mean((trace["y"] - trace[name])[scored] ** 2))
            assert error == pytest.approx(row[name], rel=1e-4)
