"""Correlations and spectra of the errors, for the figure of the residual: from the JSON report alone."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import welch

from labsid._arrays import FloatArray
from labsid.gap.reports.traces import unpacked
from labsid.model_structures.residuals import Correlation, autocorrelation, cross_correlation

LAGS = 20  # as in the tests of the report
SEGMENT = 256  # samples of a spectrum
FEWEST = 4 * LAGS  # samples from which there are correlations


@dataclass(frozen=True, slots=True, eq=False)
class ResidualCurves:
    """What the figure of the residual shows.

    Attributes
    ----------
    autocorrelation, with_input : Correlation
        Of the error after, with itself and with the input.
    frequency : ndarray
        In hertz.
    before, after : ndarray
        Amplitude densities of the errors, in units of y per root of hertz.
    """

    autocorrelation: Correlation
    with_input: Correlation
    frequency: FloatArray
    before: FloatArray
    after: FloatArray


def find_residual_curves(report: dict[str, Any]) -> ResidualCurves | None:
    """Correlations and spectra of the errors on the samples that count; None if the report does not hold all samples.

    Parameters
    ----------
    report : dict
        Where the record shows no gap and the holdout does, the errors are those on the holdout.
    """
    replay = report.get("replay")
    if replay is None:
        return None
    part = replay["holdout" if "only_on_holdout" in report else "record"]
    trace = unpacked(part)
    u, y, simulated = trace["u"], trace["y"], (trace["before"], trace["after"])
    counted = (trace["counts"] > 0.0) & np.isfinite(y) & np.isfinite(trace["after"])
    if counted.sum() < FEWEST or np.ptp(u) == 0.0:
        return None
    errors = [np.where(counted, y - one - np.mean((y - one)[counted]), 0.0) for one in simulated]
    if min(float(np.ptp(e)) for e in errors) == 0.0:
        return None
    frequency, *powers = _spectra(errors, part["Ts"])
    amplitudes = (np.sqrt(power) * replay["y_scale"]["unit"] for power in powers)
    after = errors[1]
    return ResidualCurves(autocorrelation(after, LAGS), cross_correlation(u, after, LAGS), frequency, *amplitudes)


def _spectra(errors: list[FloatArray], Ts: float) -> list[FloatArray]:
    """Frequencies above zero, and the power density of each error there."""
    found = [welch(e, 1.0 / Ts, nperseg=min(SEGMENT, e.size)) for e in errors]
    return [found[0][0][1:], *(power[1:] for _, power in found)]
