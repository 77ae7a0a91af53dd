"""Measured responses: those of a known system, within their errors, and of nothing where the record does not tell."""

import numpy as np
import pytest
from gap_reports import report
from scipy.signal import freqz, lfilter

from labsid.gap.reports.response_curves import ResponseCurves, find_response_curves
from labsid.gap.reports.traces import packed

TS, SAMPLES, UNITS = 0.5, 4000, (2.0, 5.0)  # of u and y
NUM, DEN = [0.0, 0.1], np.poly([0.95, 0.7])


def replayed(u: np.ndarray, y: np.ndarray, before: np.ndarray, after: np.ndarray) -> dict:
    """A report that holds these scaled signals."""
    named = {"y": y, "before": before, "after": after}
    part = {"start": 0.0, "Ts": TS, "u": packed(u, "<f8"), "fitted": [[0, u.size]], "scored": []}
    part |= {name: packed(x) for name, x in named.items()}
    scales = {"u_scale": {"centre": 7.0, "unit": UNITS[0]}, "y_scale": {"centre": 1.0, "unit": UNITS[1]}}
    return report("input-delay") | {"replay": {"record": part, "holdout": None, **scales}}


def curves(seed: int, noise: float = 0.05) -> ResponseCurves:
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(-1.0, 1.0, SAMPLES // 10), 10)
    y = lfilter(NUM, DEN, u)
    (found,) = find_response_curves(replayed(u, y + noise * rng.standard_normal(SAMPLES), 0.5 * y, y))
    assert found is not None
    return found


def test_the_step_response_is_that_of_the_system_in_the_units_of_the_record() -> None:
    found = curves(0).step
    assert found is not None
    true = UNITS[1] / UNITS[0] * np.cumsum(lfilter(NUM, DEN, np.eye(1, SAMPLES)[0]))
    at = np.round(found.x / TS).astype(int) - 1  # the sum of all lags below it
    np.testing.assert_allclose(found.after[-4:], true[at][-4:], rtol=0.02)
    np.testing.assert_allclose(found.before, 0.5 * found.after, rtol=1e-6)
    inside = [np.abs(one.measured - one.after) <= one.error for seed in range(12) if (one := curves(seed).step)]
    assert np.mean(inside) >= 0.85


def test_the_frequency_response_is_that_of_the_system_within_its_error() -> None:
    found = curves(1).frequency
    assert found is not None
    _, gain = freqz(NUM, DEN, 2.0 * np.pi * found.x * TS)
    gain = UNITS[1] / UNITS[0] * gain
    slow = found.x < 0.1
    np.testing.assert_allclose(np.abs(found.after[slow]), np.abs(gain[slow]), rtol=0.1)
    np.testing.assert_allclose(found.before, 0.5 * found.after, rtol=1e-6)
    inside = [
        np.abs(one.measured / one.after - 1.0) <= np.sqrt(2.0) * one.error
        for seed in range(12)
        if (one := curves(seed).frequency)
    ]
    assert np.mean(np.concatenate(inside)) >= 0.9


def test_noise_widens_the_errors_and_hides_what_is_not_coherent() -> None:
    clear, noisy = curves(2), curves(2, noise=1.0)
    assert clear.frequency is not None
    assert clear.step is not None
    assert noisy.frequency is not None
    assert noisy.frequency.x.size < clear.frequency.x.size
    assert noisy.step is None or noisy.step.error.mean() > 5.0 * clear.step.error.mean()


def test_only_samples_without_a_gap_count() -> None:
    rng = np.random.default_rng(3)
    u = np.repeat(rng.uniform(-1.0, 1.0, SAMPLES // 10), 10)
    y = lfilter(NUM, DEN, u)
    broken = np.where(np.arange(SAMPLES) == 1000, np.nan, np.where(np.arange(SAMPLES) < 1000, 50.0, y))
    (found,) = find_response_curves(replayed(u, broken, y, y))
    assert found is not None
    assert found.step is not None
    np.testing.assert_allclose(found.step.measured, found.step.after, atol=1e-4)


@pytest.mark.parametrize("why", ["no replay", "few samples", "constant input", "one step"])
def test_a_record_that_tells_no_response_has_none(why: str) -> None:
    base = report("input-delay")
    if why != "no replay":
        n = 100 if why == "few samples" else SAMPLES
        u = np.zeros(n) if why == "constant input" else (np.arange(n) > 0.1 * n).astype(float)
        noise = np.random.default_rng(0).standard_normal(n)
        base = replayed(u, noise, np.zeros(n), np.zeros(n))
    assert find_response_curves(base) == [None]
