"""Resampling and decimation of signals: band-limited for outputs, held for inputs that are held."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.signal_quality import runs

MAX_SAMPLES = 20_000_000  # of a resampled record
_HELD_SHARE = 0.5  # of the samples that repeat the one before, from which an input is held between changes
_TAPS = 8  # of the filter on each side, in new sampling times
_GAP = 1.75  # usual intervals; what is longer is a gap in which the output stays missing


def is_held(u: FloatArray) -> bool:
    """Whether an input moves in steps and is held between them, as a command is; missing samples are left out."""
    known = u[np.isfinite(u)]
    return known.size >= 10 and float(np.mean(known[1:] == known[:-1])) > _HELD_SHARE


def hold(u: FloatArray) -> FloatArray:
    """Fill missing samples with the value before them."""
    known = np.isfinite(u)
    place = np.maximum.accumulate(np.where(known, np.arange(u.size), -1))
    return np.where(place >= 0, u[np.maximum(place, 0)], np.nan)


def held_at(t: FloatArray, stamps: FloatArray, u: FloatArray) -> FloatArray:
    """The latest value at or before each time; NaN before the first."""
    known = np.isfinite(u) & np.isfinite(stamps)
    stamps, u = stamps[known], u[known]
    near = 1e-6 * float(np.median(np.diff(t))) if t.size > 1 else 0.0  # rounding errors of the stamps
    place = np.searchsorted(stamps, t + near, side="right") - 1
    return np.where(place >= 0, u[np.maximum(place, 0)], np.nan) if u.size else np.full(t.size, np.nan)


def band_limited_at(t: FloatArray, stamps: FloatArray, x: FloatArray) -> FloatArray:
    """A signal at even times, without what is faster than half their rate; NaN in its gaps and outside.

    Parameters
    ----------
    t : ndarray, shape (M,)
        Even times in seconds, M >= 2.
    stamps, x : ndarray, shape (N,)
        The samples and their times; missing ones are left out.

    Notes
    -----
    A cubic spline through the samples; where the new sampling time is longer than theirs, a windowed-sinc filter with
    its cut-off at 0.8 of half the new rate runs over it first.
    """
    from scipy.interpolate import CubicSpline
    from scipy.signal import firwin

    known = np.isfinite(x) & np.isfinite(stamps)
    stamps, x = stamps[known], x[known]
    if x.size < 4:
        return np.full(t.size, np.nan)
    spline = CubicSpline(stamps, x)
    usual, Ts = float(np.median(np.diff(stamps))), float(t[1] - t[0])
    finer = int(min(np.ceil(Ts / usual - 1e-6), 1000))
    if finer <= 1:
        y = np.asarray(spline(t))
    else:
        side = _TAPS * finer
        fine = t[0] + Ts / finer * np.arange(-side, (t.size - 1) * finer + side + 1)
        taps = firwin(2 * side + 1, 0.8 / finer)
        y = np.convolve(np.asarray(spline(np.clip(fine, stamps[0], stamps[-1]))), taps, "valid")[::finer]
    previous = np.clip(np.searchsorted(stamps, t, side="right") - 1, 0, stamps.size - 2)
    near = 1e-6 * Ts
    in_gap = (stamps[previous + 1] - stamps[previous] > _GAP * max(usual, Ts)) & (
        (t > stamps[previous] + near) & (t < stamps[previous + 1] - near)
    )
    outside = (t < stamps[0] - near) | (t > stamps[-1] + near)
    return np.asarray(np.where(in_gap | outside, np.nan, y), np.float64)


def even_grid(start: float, stop: float, Ts: float) -> FloatArray:
    """The times start, start + Ts ... up to stop.

    Raises
    ------
    ValueError
        If there are too few or too many.
    """
    count = (stop - start) / Ts + 1.0 + 1e-6
    if not 2.0 <= count <= MAX_SAMPLES:
        raise ValueError(
            f"resample {Ts:g} s makes {max(count, 0.0):.3g} samples of {stop - start:g} s; there must be 2 to "
            f"{MAX_SAMPLES:g}. Choose another sampling time."
        )
    return start + Ts * np.arange(int(count), dtype=np.float64)


def decimate(x: FloatArray, every: int) -> FloatArray:
    """Every n-th sample of a signal, low-pass filtered without delay; NaN where a sample was missing nearby.

    Parameters
    ----------
    x : ndarray, shape (N,)
    every : int
        n >= 2.
    """
    from scipy.signal import firwin

    side = _TAPS * every
    known = np.isfinite(x)
    if not known.any():
        return x[::every]
    filled = np.interp(np.arange(x.size), np.flatnonzero(known), x[known])
    padded = np.concatenate([np.full(side, filled[0]), filled, np.full(side, filled[-1])])
    y = np.convolve(padded, firwin(2 * side + 1, 0.8 / every), "valid")[::every]
    lost = np.convolve(
        np.pad(~known, every // 2, constant_values=False).astype(float), np.ones(2 * (every // 2) + 1), "valid"
    )
    return np.where(lost[::every] > 0.0, np.nan, y)


def longest_hold(missing: np.ndarray) -> int:
    """Longest run of True."""
    starts, lengths = runs(missing.astype(np.float64))
    return int(lengths[missing[starts]].max(initial=0))
