"""Findings from the record itself: unrepeated plateaus, a filter, clipping, clock drift and feedback."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.record.controllers import FEEDBACK_F, find_control_law, is_one_line, is_relay
from labsid.lab.findings import Finding, about_clipping, about_filter, about_plateaus, about_rest
from labsid.lab.offset import find_offsets
from labsid.lab.plateaus import repeated_plateaus
from labsid.records.direction import gain_from_past
from labsid.records.formats import RawRecord
from labsid.records.record import Record
from labsid.records.signal_quality import moving_mean_length

BY_RELAY = "the input switches on the output"  # how the finding of a controller begins
BY_LAW = "the input follows from the output of the same sample"  # likewise
CLOCK_PARTS = 8  # parts of a record for which the delay is estimated; set by hand
MIN_SLIP = 1.0  # samples; set by hand
MIN_LINEARITY = 0.95
"""Share of the delay variance due to a constant rate; measured: 0.996 with two clocks, < 0.8 otherwise."""
UNRELATED_OUTPUT = 0.9
"""Rms error over standard deviation of the output, from which they are called unrelated; set by hand."""
MIN_PLATEAU_SHARE = 0.3
"""Of the scatter of the plateaus and of the gap, from which unrepeated plateaus matter; set by hand."""


@dataclass(frozen=True, slots=True)
class PlateauGap:
    """How much of the gap is due to plateaus of y that do not repeat when the level of u does.

    Attributes
    ----------
    repeat : bool
        Whether the plateaus repeat, within the noise.
    largest : float
        Largest difference of two plateaus at the same level of u, in the unit of y.
    scatter : float
        Standard deviation of the plateaus about their mean at each level of u, in the unit of y.
    missed : float
        The same standard deviation for the error of the simulation before.
    of_gap : float
        `missed` over the rms error of that simulation on the whole record: about 1 if the plateaus are all of the gap.
    left : float
        The same standard deviation for the explanation, less the noise, over `missed`: 0 if it explains the plateaus,
        about 1 if it does not.
    """

    repeat: bool
    largest: float
    scatter: float
    missed: float
    of_gap: float
    left: float

    @property
    def matters(self) -> bool:
        """Whether plateaus that do not repeat make up much of the gap."""
        return not self.repeat and self.of_gap > MIN_PLATEAU_SHARE and self.missed > MIN_PLATEAU_SHARE * self.scatter


def plateau_gap(
    u: FloatArray, y: FloatArray, before: FloatArray, after: FloatArray, included: np.ndarray
) -> PlateauGap | None:
    """Measure the errors of two simulations on the plateaus of a record.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        As recorded; a filtered input has no levels.
    before, after : ndarray, shape (N,)
        Free-run outputs of the simulation and of the explanation, in the unit of y.
    included : ndarray of bool, shape (N,)
        Samples to use.

    Returns
    -------
    PlateauGap or None
        None if y has not settled twice at any level of u.
    """
    plateaus = repeated_plateaus(u, y)
    if plateaus is None:
        return None
    missed, rms = plateaus.scatter(y - before, included), float(np.sqrt(np.mean((y - before)[included] ** 2)))
    scatter = plateaus.scatter(y - after, included) ** 2 - plateaus.by_chance(y - after, included) ** 2
    return PlateauGap(
        plateaus.repeat,
        plateaus.largest,
        plateaus.scatter(y, included),
        missed,
        missed / rms if rms > 0.0 else 0.0,
        float(np.sqrt(max(scatter, 0.0))) / missed if missed > 0.0 else 0.0,
    )


def findings_from_record(record: Record, plateau: PlateauGap | None) -> list[Finding]:
    """Report properties of the record that matter for every simulation of it.

    Parameters
    ----------
    record : Record
        Neither its input nor its output is constant.
    plateau : PlateauGap or None
        From `plateau_gap`.

    Returns
    -------
    list of Finding
        The findings of `labsid check` that concern the gap, with advice for the diagnosis.
    """
    raw = RawRecord(record.t, record.u, record.y, record.Ts, record.y_measured, record.y_noise_reduced)
    plateaus, offsets = repeated_plateaus(record.u, record.y), find_offsets(record.u, record.y)
    findings = []
    if plateaus is not None and plateau is not None and plateau.matters:
        findings.append(about_plateaus(plateaus))
    if filter_length(record) > 1:
        added = (
            "This sensor filter delays the record. The diagnosis applies the same filter to the input of the "
            "simulation, so the filter is not part of the gap."
        )
        findings += [_with_advice(finding, added) for finding in about_filter(raw, record.Ts)]
    findings += about_controller(record.u, record.y)
    if offsets.status == "settled" and offsets.settled[0] > 0:
        added = "The diagnosis estimates the initial state of the simulation, so the start is not part of the gap."
        findings.append(_with_advice(about_rest(record.u, record.y, offsets, record.Ts), added))
    return [*findings, *about_clipping(record.y)]


def findings_from_errors(
    u: FloatArray, y: FloatArray, before: FloatArray, after: FloatArray, included: np.ndarray
) -> list[Finding]:
    """Report an output unrelated to the input, two clocks, or feedback, as seen in simulation errors.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    before, after : ndarray, shape (N,)
        Free-run outputs of the simulation and of the best explanation.
    included : ndarray of bool, shape (N,)
        Samples to use.

    Returns
    -------
    list of Finding
        Empty if there are none.
    """
    findings = []
    e = np.where(included, y - after, 0.0)
    missed = float(np.sqrt(np.mean(e[included] ** 2)) / np.std(y[included]))
    if missed > UNRELATED_OUTPUT:
        text = (
            f"the output hardly depends on the input: the error of the best simulation is {missed:.0%} of the standard "
            "deviation of the output. A diagnosis of such a record is unreliable. Use an input of larger amplitude."
        )
        findings.append(Finding("warning", "excitation", text))
    slip = clock_slip(y, before, included)
    if slip is not None:
        text = (
            f"input and output are not synchronous: the output {'lags' if slip > 0.0 else 'leads'} increasingly, by "
            f"{abs(slip):.2g} samples over the record ({abs(slip) / y.size:.2%}), as with two clocks. Resample one of "
            "them accordingly."
        )
        return [*findings, Finding("warning", "clocks", text)]
    gain = gain_from_past(e[1:], u[:-1])  # one sample ahead: a controller responds to the output of the same sample
    if gain > FEEDBACK_F and not about_controller(u, y):
        text = (
            f"the error of the best simulation helps to predict the input (F = {gain:.3g}). Either the input depends "
            "on the output, as in a closed loop, and the noise then biases the fitted dynamics; or the output responds "
            "within one sample, which a strictly proper simulation cannot reproduce."
        )
        findings.append(Finding("warning", "feedback", text))
    return findings


def about_correction(corrected: float | None, limit: float) -> list[Finding]:
    """That an unstable rig was simulated beside its measured output, and by how much that corrects the simulation.

    Parameters
    ----------
    corrected : float or None
        Rms of what the correction moves the output, over that of what the input moves it; None for a free run.
    limit : float
        Above it, no cause explains everything.
    """
    if corrected is None:
        return []
    text = (
        "the rig is unstable or integrates its input: simulated from its input alone, its output would leave all "
        "bounds. The simulation is corrected by the measured output, with the weakest feedback that keeps it bounded; "
        f"the correction moves the output by {max(corrected, 0.01):.0%} of what the input moves "
        f"it{' at most' if corrected < 0.01 else ''}."
    )
    if corrected <= limit:
        return [Finding("note", "stability", text)]
    more = " So much hides what the simulation lacks: a cause that is named is at most a part."
    return [Finding("warning", "stability", text + more)]


def clock_slip(y: FloatArray, simulated: FloatArray, included: np.ndarray) -> float | None:
    """Estimate the delay that y gains on its simulation over the record, if it grows at a constant rate.

    Parameters
    ----------
    y, simulated : ndarray, shape (N,)
    included : ndarray of bool, shape (N,)
        Samples to use.

    Returns
    -------
    float or None
        In samples; None if it is under one sample or not linear in time.
    """
    lags, rate = [], np.gradient(simulated)
    for part in np.array_split(np.flatnonzero(included), CLOCK_PARTS):
        columns = np.column_stack([rate[part], simulated[part], np.ones(part.size)])
        lags.append(-np.linalg.lstsq(columns, (y - simulated)[part], rcond=None)[0][0])
    position = np.arange(CLOCK_PARTS) - 0.5 * (CLOCK_PARTS - 1)
    slope = float(position @ np.array(lags) / (position @ position))
    deviation = np.array(lags) - np.mean(lags)
    nonlinear = float(np.sum((deviation - slope * position) ** 2))
    slip = slope * CLOCK_PARTS
    return slip if abs(slip) > MIN_SLIP and nonlinear < (1.0 - MIN_LINEARITY) * float(deviation @ deviation) else None


def about_controller(u: FloatArray, y: FloatArray) -> list[Finding]:
    """That a direct term cannot be judged, if the input follows from the output of the same sample."""
    law = None
    if is_relay(u, y):
        how = f"{BY_RELAY}, as from a relay controller"
    elif (law := find_control_law(u, y)) is not None:
        how = f"{BY_LAW}, as from a controller with a gain of {abs(law.gain):.3g}"
    else:
        return []
    if law is not None and law.has_constant_reference and is_one_line(u, y):
        text = (
            "input and output follow from each other without delay, by one straight line: as from a static rig with a "
            f"gain of {1.0 / law.gain:.3g}, or from a controller with a gain of {abs(law.gain):.3g} whose reference "
            "does not move. Such a record does not tell which. Move the reference, or the input beside the controller, "
            "and log that."
        )
        return [Finding("warning", "feedback", text)]
    if law is not None and law.has_constant_reference:
        text = (
            f"{how} whose reference does not move. Nothing but disturbances and noise moves such a record, and their "
            "response through the controller cannot be told from that of the rig. Move the reference, or the input "
            "beside the controller, and log that."
        )
        return [Finding("warning", "feedback", text)]
    text = (
        f"{how}. Whether the output also responds within the sample cannot be judged from such a record; the "
        "simulation has no direct feedthrough."
    )
    return [Finding("note", "feedback", text)]


def filtered_input(record: Record) -> FloatArray:
    """The input, filtered by the same moving mean as the logged output, if the record has one.

    A moving mean commutes with linear dynamics, so filtering the input includes the logger's filter in the simulation.
    """
    length = filter_length(record)
    padded = np.concatenate([np.full(length - 1, record.u[0]), record.u])
    return np.convolve(padded, np.full(length, 1.0 / length), mode="valid")


def filter_length(record: Record) -> int:
    """Length of the moving mean in the logged output; 1 without one or if it is unknown."""
    return 1 if record.y_measured is None else moving_mean_length(record.y_measured, record.y) or 1


def _with_advice(finding: Finding, added: str) -> Finding:
    """The first sentence of a finding, followed by advice for the diagnosis instead of that for the lab."""
    return replace(finding, text=f"{finding.text.split('. ')[0].rstrip('.')}. {added}")
