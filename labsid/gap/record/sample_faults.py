"""Faults of single samples: spikes, held values, and the step of a coarse converter."""

from dataclasses import dataclass

import numpy as np
from scipy.special import bdtrc

from labsid._arrays import FloatArray
from labsid.records.signal_quality import lattice_step, runs

SPIKE_THRESHOLD = 6.0  # robust standard deviations from which an isolated sample is a spike; set by hand
SMALLEST_SPIKE = 1e-3  # of the spread of y: less is the error of a simulation; set by hand
INSTANT = 0.05  # samples: an error in time that a simulation may have; set by hand
RESOLVED = 2.0  # over the error of a right simulation, from which a sample is a spike; set by hand
LONGEST_SPIKE = 2  # samples; set by hand
MAX_SPIKE_RUN = 3  # adjacent spikes of different values; set by hand
OFF_LATTICE = 0.05  # converter steps from the lattice, above rounding errors; set by hand
FIRST_JUMP = 0.25  # of the range of the other samples, from which the first sample may be bad; set by hand
FIRST_JUMP_RATIO = 5.0  # of that jump over nearly the largest change elsewhere; set by hand
NEARLY_ALL = 0.99  # of the samples; set by hand
MIN_REPEATED = 0.9  # share of the samples whose value recurs; set by hand
CHANCE = 1e-4  # probability that so many spikes, or ends of held stretches, are at changes of the input; set by hand
FLAT = 4  # equal readings in a row; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class SampleFaults:
    """Samples that no simulation of the rig can reproduce.

    Attributes
    ----------
    held : ndarray of bool, shape (N,)
        Samples at which the logger repeats its last value.
    stretches : tuple of (int, int)
        The held stretches, half-open.
    spikes : ndarray of bool, shape (N,)
    lattice : float or None
        Converter step in the unit of y.
    resolution : ndarray, shape (N,), optional
        Error of a right simulation at each reading, from `reading_errors`.
    """

    held: np.ndarray
    stretches: tuple[tuple[int, int], ...]
    spikes: np.ndarray
    lattice: float | None
    resolution: FloatArray | None = None

    def beyond_resolution(self, e: FloatArray) -> np.ndarray:
        """Samples whose error is larger than that of a right simulation, shape (N,)."""
        return np.ones(e.size, bool) if self.resolution is None else np.asarray(np.abs(e) > self.resolution)


def reading_errors(y: FloatArray, digits: FloatArray) -> FloatArray:
    """Largest error of a right simulation at each reading: of its digits, and of the instant of a change.

    A simulation of second order has a second time constant, of a few hundredths of a sample, where the rig has none.

    Parameters
    ----------
    y : ndarray, shape (N,)
        Readings.
    digits : ndarray, shape (N,)
        Step of their printed digits, in the same unit.

    Returns
    -------
    ndarray, shape (N,)
    """
    change = np.abs(np.diff(y, prepend=y[:1], append=y[-1:]))
    return np.asarray(digits + INSTANT * np.maximum(change[:-1], change[1:]))


def find_lattice(y: FloatArray) -> tuple[float | None, np.ndarray]:
    """Find the converter step, and the samples off its lattice: spikes added after the conversion.

    Parameters
    ----------
    y : ndarray, shape (N,)

    Returns
    -------
    lattice : float or None
    off : ndarray of bool, shape (N,)
    """
    nowhere = np.zeros(y.size, bool)
    lattice = lattice_step(y)
    if lattice is not None:
        return lattice, nowhere
    _, which, count = np.unique(y, return_inverse=True, return_counts=True)
    again = count[which] > 1
    lattice = lattice_step(y[again]) if again.mean() > MIN_REPEATED else None
    if lattice is None:
        return None, nowhere
    steps = (y - y[again][0]) / lattice
    return lattice, np.abs(steps - np.round(steps)) > OFF_LATTICE


def find_bad_start(y: FloatArray) -> np.ndarray:
    """Mark the first sample if the second one is farther from it than the rig moves in a sample: the logger's start-up.

    The residual of a fit does not show such a sample: a fast pole takes it for its initial state.

    Parameters
    ----------
    y : ndarray, shape (N,)
        Readings.

    Returns
    -------
    ndarray of bool, shape (N,)
    """
    bad = np.zeros(y.size, bool)
    low, high = np.quantile(y[1:], (1.0 - NEARLY_ALL, NEARLY_ALL))
    change = float(np.quantile(np.abs(np.diff(y[1:])), NEARLY_ALL))
    bad[0] = abs(y[0] - y[1]) > max(FIRST_JUMP * (high - low), FIRST_JUMP_RATIO * change)
    return bad


def without_slow_ends(
    stretches: tuple[tuple[int, int], ...], y: FloatArray, least: float
) -> tuple[tuple[int, int], ...]:
    """Held stretches, without those from which the output goes on by less than `least`: it comes to rest there.

    Parameters
    ----------
    stretches : tuple of (int, int)
        Half-open.
    y : ndarray, shape (N,)
        Readings.
    least : float
        In the unit of `y`.
    """
    return tuple(stretch for stretch in stretches if stretch[1] >= y.size or abs(y[stretch[1]] - y[stretch[0]]) > least)


def without_rest(stretches: tuple[tuple[int, int], ...], u: FloatArray) -> tuple[tuple[int, int], ...]:
    """Held stretches, without those that end where the input changes, or a delay later: rest of a rig without noise.

    Parameters
    ----------
    stretches : tuple of (int, int)
        Half-open.
    u : ndarray, shape (N,)
        The input.
    """
    if not stretches:
        return stretches
    changes = np.diff(u, prepend=u[:1]) != 0.0
    ends = np.array([stop for _, stop in stretches if stop < u.size], int)
    lags = min(int(0.1 * u.size), int(ends.min(initial=u.size)))
    ended = np.array([changes[ends - lag] for lag in range(lags + 1)])
    most = int(ended.sum(axis=1).argmax())
    count = int(ended[most].sum())
    if (lags + 1) * bdtrc(count - 1, ends.size, changes.mean()) > CHANCE:
        return stretches
    rest = {int(end) for end in ends[ended[most]]} | {u.size}
    return tuple(stretch for stretch in stretches if stretch[1] not in rest)


def flat_samples(y: FloatArray) -> np.ndarray:
    """Samples of at least `FLAT` equal readings in a row, and their neighbours: a limit, or rest without noise.

    Parameters
    ----------
    y : ndarray, shape (N,)
        Readings.

    Returns
    -------
    ndarray of bool, shape (N,)
    """
    lengths = runs(y)[1]
    flat = np.repeat(lengths >= FLAT, lengths)
    return np.asarray(flat | np.roll(flat, 1) | np.roll(flat, -1))


def find_spikes(
    e: FloatArray, usable: np.ndarray, lattice: float = 0.0, resolution: FloatArray | None = None
) -> np.ndarray:
    """Find isolated samples of the residual `e` far from their neighbours on both sides.

    Parameters
    ----------
    e : ndarray, shape (N,)
    usable : ndarray of bool, shape (N,)
        Samples that are true readings.
    lattice : float
        Converter step; smaller distances are rounding.
    resolution : ndarray, shape (N,), optional
        Error of a right simulation at each reading.
    """
    spikes = np.zeros(e.size, bool)
    at = np.flatnonzero(usable)
    if at.size < 15:
        return spikes
    x = e[at]
    padded = np.pad(x, 3, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 7)
    off = x - np.median(windows, axis=1)
    away = np.abs(off)
    if not lattice:  # at the sensor's limit there is no noise
        away = away[away > 0.0]
    spread = 1.4826 * float(np.median(away)) if away.size else 0.0
    if spread == 0.0:
        spread = float(np.std(off)) or 1.0
    least = np.full(x.size, max(SPIKE_THRESHOLD * spread, lattice, SMALLEST_SPIKE))
    if resolution is not None:
        least = np.maximum(least, RESOLVED * resolution[at])
    far = np.abs(off) > least
    starts, lengths = runs(far.astype(float))
    for start, length in zip(starts, lengths, strict=True):
        stop = start + length
        several = length <= MAX_SPIKE_RUN and bool(np.all(np.abs(np.diff(x[start:stop])) > least[start + 1 : stop]))
        alone = length <= LONGEST_SPIKE or several
        if far[start] and alone and start > 0:  # the initial state may still be wrong at the first sample
            ahead = x[start - 1]
            behind = x[stop] if stop < x.size else ahead
            height = float(np.abs(x[start : start + length] - 0.5 * (ahead + behind)).min())
            if height < 3.0 * abs(behind - ahead):  # a lasting jump is not a spike
                continue
            spikes[at[start : start + length]] = True
    return spikes


def without_responses(spikes: np.ndarray, u: FloatArray) -> np.ndarray:
    """Spikes of the sensor, without those at changes of the input if more of them are there than by chance.

    A rig that responds within the sample in which its input changes leaves such spikes in the residual of a strictly
    proper simulation.

    Parameters
    ----------
    spikes : ndarray of bool, shape (N,)
    u : ndarray, shape (N,)
        The input.
    """
    changes = np.diff(u, prepend=u[:1]) != 0.0
    count, there = int(spikes.sum()), int((spikes & changes).sum())
    by_chance = bdtrc(there - 1, count, changes.mean()) > CHANCE  # the binomial probability of that many
    return spikes if by_chance else spikes & ~changes


def without_limited(spikes: np.ndarray, e: FloatArray, y: FloatArray) -> np.ndarray:
    """Spikes of the sensor, without those that a limit of the sensor makes.

    Such readings are the lowest, and too high, or the highest, and too low; more of them than by chance.

    Parameters
    ----------
    spikes : ndarray of bool, shape (N,)
    e : ndarray, shape (N,)
        Readings less those of a simulation.
    y : ndarray, shape (N,)
        Readings.
    """
    left = spikes.copy()
    for sign in (1.0, -1.0):
        inward = spikes & (sign * e > 0.0)
        count = int(inward.sum())
        most = min(2 * count, y.size) - 1
        if count:
            extreme = inward & (sign * y <= np.partition(sign * y, most)[most])
            if bdtrc(int(extreme.sum()) - 1, count, (most + 1) / y.size) < CHANCE:
                left &= ~extreme
    return left
