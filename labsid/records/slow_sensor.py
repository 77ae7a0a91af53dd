"""Readings of a sensor that is slower than the logger: held until the next one, or with empty samples between."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from labsid._arrays import FloatArray
from labsid.records.signal_quality import lattice_step, runs

MIN_READINGS = 20  # changes of a signal: by chance, none is at a sample of its own in 1 of 2^19
MOST_SINGLE = 0.02  # of the distances between changes that may be one sample: the sensor is slower than the logger
FEWEST_SINGLE = 1e-12  # chance that as many changes follow the ticks of a clock that they do not have
SHORT = 4.0, 20.0, np.inf  # periods: distances from which the period of a clock is found, one after the other
ON_TIME = 1e-6  # samples: rounding of a tick
SMALL_STEP = 0.02  # of the usual change between readings: equal ones are rare by chance on a lattice below it


@dataclass(frozen=True, slots=True, eq=False)
class SlowReadings:
    """When a slow sensor is read.

    Attributes
    ----------
    at : ndarray of int, shape (M,)
        The samples with a reading of their own, ascending; readings that are lost are not among them.
    every : float
        The period of the clock in samples; without one, the mean distance of the readings.
    first : float or None
        The first tick, in samples, of a clock that explains all readings: each is seen at the first sample from its
        tick on. None without one.
    """

    at: np.ndarray
    every: float
    first: float | None

    @property
    def is_even(self) -> bool:
        """Whether the readings are at every so many samples, a whole number."""
        return self.first is not None and self.every == round(self.every)


def find_readings(u: FloatArray, y: FloatArray) -> SlowReadings | None:
    """Find the readings of a sensor that is slower than the logger.

    Held readings show as changes of `y`. On a coarse lattice, where two readings in a row are often equal, they must
    be at the ticks of a clock: a slow motion over a lattice changes as seldom, but not as regularly.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        Input, and output with NaN where it is missing.

    Returns
    -------
    SlowReadings or None
        None if `y` has a reading of its own at most samples, changes where `u` does and hardly elsewhere, or hardly at
        all.
    """
    there = np.flatnonzero(~np.isnan(y))
    if there.size <= MIN_READINGS:
        return None
    if np.median(np.diff(there)) > 1.0:
        clock = _clock(there)
        return SlowReadings(there, *(clock or (float(np.diff(there).mean()), None)))
    starts = runs(y[there])[0]
    changes = there[starts]
    if changes.size <= MIN_READINGS or _follows(changes[1:], runs(u)[0][1:]):
        return None
    # A change after missing samples may have been there before; the value before the first change has no beginning.
    seen = changes[1:][there[starts[1:] - 1] == changes[1:] - 1]
    if seen.size < MIN_READINGS or np.mean(np.diff(seen) == 1) > MOST_SINGLE:
        return None
    clock = _clock(seen)
    if clock is not None:
        at = _samples_of(_ticks(*clock, y.size))
        at = at[at < y.size]
        return SlowReadings(at[~np.isnan(y[at])], *clock)
    return SlowReadings(seen, float(np.diff(seen).mean()), None) if differ_by_size(y[there[starts]]) else None


def differ_by_size(readings: FloatArray) -> bool:
    """Whether readings that differ would hardly be equal by chance: their lattice, if any, is fine beside the steps."""
    return (lattice_step(readings) or 0.0) <= SMALL_STEP * float(np.median(np.abs(np.diff(readings))))


def _clock(at: np.ndarray) -> tuple[float, float] | None:
    """The period and the first tick, in samples, of a clock whose readings are seen at samples `at`; None without one.

    Some ticks may have none. The first tick is not before 0.
    """
    apart = np.diff(at).astype(float)
    shortest = float(np.quantile(apart, MOST_SINGLE, method="inverted_cdf"))
    if (common := int(np.gcd.reduce(np.diff(at)))) > 1:
        return float(common), float(at[0] % common)
    period = float(apart[apart <= shortest + 1.0].mean())
    for longest in SHORT:
        known = apart <= longest * period
        period = float(apart[known].sum() / np.round(apart[known] / period).sum())
    if at.size * np.log(max(period, 1.0)) < -np.log(FEWEST_SINGLE):
        return None
    ticks = np.concatenate([[0.0], np.cumsum(np.round(apart / period))])
    line = np.column_stack([ticks, np.ones(at.size)])  # the period, and half a sample more than the first tick
    rows = np.column_stack([np.vstack([line, -line]), -np.ones(2 * at.size)])  # and the largest deviation from it
    fitted = linprog([0.0, 0.0, 1.0], rows, np.concatenate([at, -at]), bounds=[(None, None)] * 3)
    if not fitted.success or fitted.x[2] > 0.5 + ON_TIME:
        return None
    period = float(fitted.x[0])
    late = at - period * ticks
    first = 0.5 * (float(late.max()) - 1.0 + float(late.min()))
    return period, first - period * np.floor(first / period + ON_TIME)


def _ticks(every: float, first: float, samples: int) -> FloatArray:
    return np.arange(first, samples - 1 + ON_TIME, every)


def _samples_of(ticks: FloatArray) -> np.ndarray:
    """Samples at which held readings of a clock are surely seen: the next one, also where a tick rounds to a sample."""
    whole = np.floor(ticks + ON_TIME).astype(int)
    return whole if np.ptp(ticks - whole) < ON_TIME else whole + 1


def read_at_ticks(readings: SlowReadings, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The ticks of a clock, in samples, and the reading of each; NaN where it is missing."""
    assert readings.first is not None
    ticks = _ticks(readings.every, readings.first, y.size)
    late, early = (np.minimum(at, y.size - 1) for at in (_samples_of(ticks), np.ceil(ticks - ON_TIME).astype(int)))
    return ticks, np.where(np.isnan(y[late]), y[early], y[late])


def _follows(changes: np.ndarray, of_input: np.ndarray) -> bool:
    """Whether the output changes where the input does and hardly elsewhere, of inputs that change as seldom."""
    return of_input.size < 2 * changes.size < 4 * of_input.size
