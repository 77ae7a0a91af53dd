"""What the converter and the logger did to single samples: spikes, held values, a coarse lattice."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.signal_quality import runs

SPIKE = 6.0  # robust standard deviations at which an isolated sample is one
LONGEST_SPIKE = 2  # samples
SHORTEST_HOLD = 3  # equal samples in a row


@dataclass(frozen=True, slots=True, eq=False)
class RawFaults:
    """Samples that no simulation of the rig can give.

    Attributes
    ----------
    held : ndarray of bool, shape (N,)
        The logger repeats its last value here.
    stretches : tuple of (int, int)
        The held stretches, half-open.
    spikes : ndarray of bool, shape (N,)
    lattice : float or None
        Converter step in the unit of y.
    """

    held: np.ndarray
    stretches: tuple[tuple[int, int], ...]
    spikes: np.ndarray
    lattice: float | None

    @property
    def bad(self) -> np.ndarray:
        """Samples that the fits leave out."""
        return self.held | self.spikes


def find_held(y: FloatArray, lattice: float | None) -> tuple[tuple[int, int], ...]:
    """Stretches over which the logger holds its last value: the first sample of each is still a reading.

    On a fine scale two equal readings in a row are a hold; on a converter's lattice a stretch must be far longer than
    those that rest and a slow motion make.
    """
    starts, lengths = runs(y)
    least = SHORTEST_HOLD
    if lattice is not None and lattice > 1e-4 * np.ptp(y):
        usual = float(np.quantile(np.repeat(lengths, lengths), 0.5))
        least = max(least, int(6 * usual) + 3)
    extreme = (y[starts] == y.max()) | (y[starts] == y.min())  # the sensor on its stop, not the logger asleep
    return tuple(
        (int(start) + 1, int(start + length))
        for start, length, stop in zip(starts, lengths, extreme, strict=True)
        if length >= least and not stop and start > 0  # a record that begins at rest holds nothing
    )


def find_spikes(e: FloatArray, usable: np.ndarray, threshold: float = SPIKE) -> np.ndarray:
    """Isolated samples of the residual `e` that stand far from their neighbours on both sides.

    Parameters
    ----------
    e : ndarray, shape (N,)
    usable : ndarray of bool, shape (N,)
        Samples that are readings at all.
    threshold : float
        In robust standard deviations of the distance from the median of the neighbourhood.
    """
    spikes = np.zeros(e.size, bool)
    at = np.flatnonzero(usable)
    if at.size < 15:
        return spikes
    x = e[at]
    padded = np.pad(x, 3, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 7)
    off = x - np.median(windows, axis=1)
    spread = 1.4826 * float(np.median(np.abs(off)))
    if spread == 0.0:
        spread = float(np.std(off)) or 1.0
    far = np.abs(off) > threshold * spread
    starts, lengths = runs(far.astype(float))
    for start, length in zip(starts, lengths, strict=True):
        if far[start] and length <= LONGEST_SPIKE and start > 0:  # at its start a simulation may not be under way yet
            stop = start + length
            before = x[start - 1]
            behind = x[stop] if stop < x.size else before
            height = float(np.abs(x[start : start + length] - 0.5 * (before + behind)).min())
            if height < 3.0 * abs(behind - before):  # a jump that stays is no spike
                continue
            spikes[at[start : start + length]] = True
    return spikes
