"""What the record itself shows, whatever is simulated: plateaus that do not repeat, a filter, a stop, a feedback."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.lab.findings import Finding, about_clipping, about_filter, about_plateaus, about_rest
from labsid.lab.offset import find_offsets
from labsid.lab.plateaus import repeated_plateaus
from labsid.records.direction import gain_from_past
from labsid.records.formats import RawRecord
from labsid.records.record import Record
from labsid.records.signal_quality import moving_mean_length

FEEDBACK_F = 10.0  # F statistic: 39 on the lab's closed loop, at most 5 on rigs in open loop
CLOCK_PARTS = 8  # of a record, in which its delay is looked at
MIN_SLIP = 1.0  # samples
MIN_STEADY = (
    0.95  # of the variance of the delays that a steady rate explains: 0.996 with two clocks, under 0.8 with effects
)
UNRELATED_OUTPUT = 0.9  # of the spread of the output: what a simulation misses that follows next to nothing
MIN_PLATEAU_SHARE = (
    0.3  # of the scatter of the levels, and of the gap: where a simulation misses less, the gap is about others
)


@dataclass(frozen=True, slots=True)
class PlateauGap:
    """How much of a gap is plateaus that do not repeat where the input does.

    Attributes
    ----------
    repeat : bool
        Whether they do repeat, within the noise.
    largest : float
        Largest difference of two of them at the same level of the input, in the unit of y.
    scatter : float
        Standard deviation of y on the plateaus of one level of the input about their mean.
    missed : float
        By how much the simulation before misses them: the same of its errors.
    of_gap : float
        The same over the rms error of that simulation on the whole record: about 1 where they are all of the gap.
    left : float
        The same for the explanation, over `missed`, less what noise may do: about 1 where it accounts for none of it,
        0 where for all.
    """

    repeat: bool
    largest: float
    scatter: float
    missed: float
    of_gap: float
    left: float

    @property
    def matters(self) -> bool:
        """Whether a good part of the gap is plateaus that do not repeat."""
        return not self.repeat and self.of_gap > MIN_PLATEAU_SHARE and self.missed > MIN_PLATEAU_SHARE * self.scatter


def plateau_gap(
    u: FloatArray, y: FloatArray, before: FloatArray, after: FloatArray, counted: np.ndarray
) -> PlateauGap | None:
    """Hold the plateaus of a record against the simulations of it.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        As recorded: an input that was averaged has no levels.
    before, after : ndarray, shape (N,)
        Free runs of the simulation and of the explanation, in the unit of y.
    counted : ndarray of bool, shape (N,)
        Samples on which they count.

    Returns
    -------
    PlateauGap or None
        None where y has not come to rest twice at one level of the input.
    """
    plateaus = repeated_plateaus(u, y)
    if plateaus is None:
        return None
    missed, rms = plateaus.scatter(y - before, counted), float(np.sqrt(np.mean((y - before)[counted] ** 2)))
    left = plateaus.scatter(y - after, counted) ** 2 - plateaus.by_chance(y - after, counted) ** 2
    return PlateauGap(
        plateaus.repeat,
        plateaus.largest,
        plateaus.scatter(y, counted),
        missed,
        missed / rms if rms > 0.0 else 0.0,
        float(np.sqrt(max(left, 0.0))) / missed if missed > 0.0 else 0.0,
    )


def findings_from_record(record: Record, plateau: PlateauGap | None) -> list[Finding]:
    """Say what anybody who looks at the record should know before any simulation is blamed.

    Parameters
    ----------
    record : Record
        Neither its input nor its output is constant.
    plateau : PlateauGap or None
        Of the simulations of it.

    Returns
    -------
    list of Finding
        Those of `labsid check` that bear on the gap, in the words of one who simulates; empty where nothing is to say.
    """
    raw = RawRecord(record.t, record.u, record.y, record.Ts, record.y_measured, record.y_noise_reduced)
    plateaus, offsets = repeated_plateaus(record.u, record.y), find_offsets(record.u, record.y)
    found = []
    if plateaus is not None and plateau is not None and plateau.matters:
        found.append(about_plateaus(plateaus))
    if filter_length(record) > 1:
        added = (
            "This filter in the path of the sensor delays the record. The input of the simulation is averaged in the "
            "same way here, so the filter is no part of the gap."
        )
        found += [_with_advice(finding, added) for finding in about_filter(raw, record.Ts)]
    if offsets.status == "settled" and offsets.settled[0] > 0:
        added = "The state in which the simulation begins is estimated, so the start by itself makes no gap."
        found.append(_with_advice(about_rest(record.u, record.y, offsets, record.Ts), added))
    return [*found, *about_clipping(record.y)]


def findings_from_errors(
    u: FloatArray, y: FloatArray, before: FloatArray, after: FloatArray, counted: np.ndarray
) -> list[Finding]:
    """Say what errors tell of a record: it cannot answer, is of two clocks, or is of a closed loop.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    before, after : ndarray, shape (N,)
        Free runs of the simulation and of the best explanation found.
    counted : ndarray of bool, shape (N,)
        Samples on which they count.

    Returns
    -------
    list of Finding
        Empty where nothing is to say.
    """
    found = []
    e = np.where(counted, y - after, 0.0)
    missed = float(np.sqrt(np.mean(e[counted] ** 2)) / np.std(y[counted]))
    if missed > UNRELATED_OUTPUT:
        text = (
            f"the output hardly follows the input: what the best simulation misses is {missed:.0%} of the spread of "
            "the output. What is found on such a record, and what is not, says little of the rig. Move the input more."
        )
        found.append(Finding("warning", "excitation", text))
    slip = clock_slip(y, before, counted)
    if slip is not None:
        text = (
            f"input and output do not keep the same time: at a steady rate the output comes ever "
            f"{'later' if slip > 0.0 else 'earlier'}, by {abs(slip):.2g} samples over the record "
            f"({abs(slip) / y.size:.2%}), as where two clocks stamp them. Resample one of them by that much."
        )
        return [*found, Finding("warning", "clocks", text)]
    gain = gain_from_past(e[1:], u[:-1])  # one sample ahead: a controller answers to the output of the same sample
    if gain > FEEDBACK_F:
        text = (
            f"what the best simulation misses helps to predict the input (F = {gain:.3g}). Either the input answers to "
            "the output, as in a closed loop: noise then reaches both, and dynamics fitted to them are biased. Or the "
            "output answers within one sample, which a strictly proper simulation cannot."
        )
        found.append(Finding("warning", "feedback", text))
    return found


def clock_slip(y: FloatArray, simulated: FloatArray, counted: np.ndarray) -> float | None:
    """By how many samples y falls behind a simulation of it from the first to the last sample, at a steady rate.

    Parameters
    ----------
    y, simulated : ndarray, shape (N,)
    counted : ndarray of bool, shape (N,)
        Samples on which they count.

    Returns
    -------
    float or None
        None where it is under one sample, or not steady: then it is no clock.
    """
    lags, rate = [], np.gradient(simulated)
    for part in np.array_split(np.flatnonzero(counted), CLOCK_PARTS):
        columns = np.column_stack([rate[part], simulated[part], np.ones(part.size)])
        lags.append(-np.linalg.lstsq(columns, (y - simulated)[part], rcond=None)[0][0])
    place = np.arange(CLOCK_PARTS) - 0.5 * (CLOCK_PARTS - 1)
    slope = float(place @ np.array(lags) / (place @ place))
    spread = np.array(lags) - np.mean(lags)
    wander = float(np.sum((spread - slope * place) ** 2))
    slip = slope * CLOCK_PARTS
    return slip if abs(slip) > MIN_SLIP and wander < (1.0 - MIN_STEADY) * float(spread @ spread) else None


def filter_length(record: Record) -> int:
    """Of how many samples the logger's output is the mean: 1 where it averages nothing, or nobody can know."""
    return 1 if record.y_measured is None else moving_mean_length(record.y_measured, record.y) or 1


def _with_advice(finding: Finding, added: str) -> Finding:
    """The first sentence, which stands by itself, and what the diagnosis makes of it in place of the lab's advice."""
    return replace(finding, text=f"{finding.text.split('. ')[0].rstrip('.')}. {added}")
