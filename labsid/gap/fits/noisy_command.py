"""Commands that are constant between their changes and logged with noise, as by a converter that measures them."""

from dataclasses import replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.dynamics import DirectFeedthrough
from labsid.gap.fits.fitting import mean_square
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.record.data import scaled
from labsid.records.record import Record

JUMP = 7.5  # noises in the least change of the command: those of the noise alone are smaller; set by hand
MIN_JUMPS = 3  # changes of the command, at least; set by hand
MIN_RANGE = 10.0  # noises between the lowest level and the highest; set by hand
SAME_LEVEL = 4.0  # standard errors between the means of two stretches of one level; set by hand
TOLERANCE = 0.15  # relative difference of the noise about the levels from that of neighbouring samples; set by hand
MIN_GAIN = 12.0  # of twice the log likelihood, by the levels in the place of the log; set by hand
WHITE = 4.0  # standard errors of the correlation of neighbouring samples about the levels; set by hand


def levels_behind_noise(u: FloatArray) -> FloatArray | None:
    """Levels of a command that is constant between its changes but for white noise.

    Parameters
    ----------
    u : ndarray, shape (N,)

    Returns
    -------
    ndarray, shape (N,), or None
        None for any other signal.
    """
    steps = np.diff(u)
    noise = float(np.median(np.abs(steps))) / (0.6745 * np.sqrt(2.0))
    starts = np.append(0, np.flatnonzero(np.abs(steps) > JUMP * noise) + 1)
    if noise == 0.0 or not MIN_JUMPS < starts.size < u.size / 3:
        return None
    lengths = np.diff(np.append(starts, u.size))
    means = np.add.reduceat(u, starts) / lengths
    for levels in (_pooled(means, lengths, noise), means):
        behind = np.repeat(levels, lengths)
        if np.ptp(levels) > MIN_RANGE * noise and _is_white(u - behind, noise):
            return behind
    return None


def _pooled(means: FloatArray, lengths: FloatArray, noise: float) -> FloatArray:
    """The means of stretches, with one value for those that the noise does not tell apart."""
    order = np.argsort(means)
    error = noise / np.sqrt(lengths[order])
    apart = np.diff(means[order]) > SAME_LEVEL * np.hypot(error[1:], error[:-1])
    group = np.append(0, np.cumsum(apart))
    level = np.bincount(group, (means * lengths)[order]) / np.bincount(group, lengths[order])
    pooled = np.empty_like(means)
    pooled[order] = level[group]
    return pooled


def _is_white(error: FloatArray, noise: float) -> bool:
    """Whether what is left about the levels is white and as large as the differences of neighbours say."""
    size = float(np.std(error))
    correlation = float(error[1:] @ error[:-1]) / max(float(error @ error), np.finfo(float).tiny)
    return abs(size / noise - 1.0) < TOLERANCE and abs(correlation) < WHITE / np.sqrt(error.size)


def with_levels(record: Record, rows: np.ndarray | None = None) -> tuple[Record, tuple[str, ...]]:
    """The record with the levels of its command as the input, if the rig followed them and not the noise of their log.

    Parameters
    ----------
    record : Record
    rows : ndarray of bool, shape (N,), optional
        Samples on which this is decided; by default all.

    Returns
    -------
    record : Record
    notes : tuple of str
        A sentence that says so; empty if the record is returned as it is.
    """
    levels = levels_behind_noise(record.u)
    if levels is None:
        return record, ()
    noise, rows = float(np.std(record.u - levels)), np.ones(len(record), bool) if rows is None else rows
    structure = Hypothesis((DirectFeedthrough(),), 1)  # for rigs that respond at once, too
    logs = [scaled(u, record.y, rows, record.Ts) for u in (record.u, levels)]
    noisy, followed = (mean_square(one, fit_baseline(one, structure)) for one in logs)
    if rows.sum() * np.log(noisy / max(followed, np.finfo(float).tiny)) <= MIN_GAIN:
        return record, ()
    said = (
        f"The input is constant between its changes but for noise of {noise:.2g} rms. The output follows the levels "
        "and not that noise, so it is noise of the log: the levels are used as the input."
    )
    return replace(record, u=levels), (said,)
