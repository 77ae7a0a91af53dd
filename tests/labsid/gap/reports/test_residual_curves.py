"""Correlations and spectra of the errors, from the samples of the report that count."""

import base64

import numpy as np
import pytest
from gap_reports import report

from labsid.gap.reports.residual_curves import find_residual_curves
from labsid.gap.reports.traces import packed

SAMPLES, UNIT, TS = 4000, 3.0, 0.5


def replayed(e: np.ndarray, fitted: list[list[int]] | None = None) -> dict:
    """A report whose simulation after leaves the scaled error `e`, and twice that before."""
    u = np.random.default_rng(1).standard_normal(SAMPLES)
    y = np.sin(0.01 * np.arange(SAMPLES))
    part = {"start": 0.0, "Ts": TS, "u": packed(u, "<f8"), "y": packed(y)}
    part |= {"before": packed(y - 2.0 * e), "after": packed(y - e), "fitted": fitted or [[0, SAMPLES]], "scored": []}
    return report("input-delay") | {
        "replay": {"record": part, "holdout": None, "y_scale": {"centre": 1.0, "unit": UNIT}}
    }


def white(seed: int = 0) -> np.ndarray:
    """Noise with a standard deviation of a tenth."""
    return 0.1 * np.random.default_rng(seed).standard_normal(SAMPLES)


def test_white_noise_stays_within_the_bands_and_has_a_flat_spectrum_in_units():
    found = find_residual_curves(replayed(white()))
    assert found.autocorrelation.outside.size <= 4
    assert found.with_input.outside.size <= 6
    np.testing.assert_allclose(found.before, 2.0 * found.after, rtol=1e-3)
    density = UNIT * 0.1 * np.sqrt(2.0 * TS)
    assert np.sqrt(np.mean(found.after**2)) == pytest.approx(density, rel=0.05)


def test_a_missed_response_correlates_with_the_input():
    shown = replayed(white())
    u = np.frombuffer(base64.b64decode(shown["replay"]["record"]["u"]), "<f8")
    late = replayed(white() + 0.1 * np.concatenate([np.zeros(3), u[:-3]]))
    found = find_residual_curves(late)
    assert found.with_input.lags[np.argmax(np.abs(found.with_input.values))] == 3


def test_samples_that_do_not_count_do_not_matter():
    e = white()
    e[2000] = 500.0
    found = find_residual_curves(replayed(e, [[0, 2000], [2001, SAMPLES]]))
    assert found.autocorrelation.outside.size <= 4


def test_a_report_without_all_samples_has_no_curves():
    assert find_residual_curves(report("input-delay") | {"replay": None}) is None
    assert find_residual_curves(replayed(np.zeros(SAMPLES))) is None
