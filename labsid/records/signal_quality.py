"""What sensors, converters and loggers leave in raw samples: lattices, stops, held values, moving means."""

import numpy as np

from labsid._arrays import FloatArray


def runs(x: FloatArray) -> tuple[np.ndarray, np.ndarray]:
    """Starts and lengths of the stretches over which `x` keeps exactly the same value.

    Parameters
    ----------
    x : ndarray, shape (N,)
        N >= 1.

    Returns
    -------
    starts, lengths : ndarray of int, shape (number of stretches,)
    """
    starts = np.flatnonzero(np.concatenate([[True], x[1:] != x[:-1]]))
    return starts, np.diff(np.append(starts, x.size))


def lattice_step(x: FloatArray) -> float | None:
    """Step of the lattice on which all samples lie: a converter's resolution, or the digits of a text file.

    Parameters
    ----------
    x : ndarray, shape (N,)

    Returns
    -------
    float or None
        In the unit of `x`; None for fewer than three different values, or values on no lattice.
    """
    values = np.unique(x)
    span = float(values[-1] - values[0])
    gaps = np.diff(values)
    gaps = gaps[gaps > 1e-9 * span]  # one value written in two ways differs by rounding
    if gaps.size < 2:
        return None
    steps = round(span / float(gaps.min()))
    step = span / steps
    places = (values - values[0]) / step
    off = float(np.abs(places - np.round(places)).max())
    # Found by chance, the places would be spread evenly over the half steps.
    return step if off < 1e-3 else None


def scatter(x: FloatArray) -> float:
    """Standard deviation of the noise as seen from sample to sample; an upper bound while `x` also moves.

    Parameters
    ----------
    x : ndarray, shape (N,)
        N >= 5.

    Returns
    -------
    float
        From third differences, which a smooth signal hardly has; white noise has sqrt(20) times its own.
    """
    return float(np.median(np.abs(np.diff(x, 3))) / 0.6745 / np.sqrt(20))


def stuck_at_extreme(x: FloatArray, extreme: float) -> tuple[int, int]:
    """Count the samples that lie exactly at an extreme of `x`, as if against a stop.

    Parameters
    ----------
    x : ndarray, shape (N,)
    extreme : float
        The largest or smallest value of `x`.

    Returns
    -------
    samples, longest : int
        Their number and the longest stretch of them; both 0 where nothing looks stuck: fewer than five in a
        row, or the signal came to rest there by itself, slowing down before.
    """
    starts, lengths = runs(x)
    at_extreme = x[starts] == extreme
    longest = int(lengths[at_extreme].max())
    long = np.flatnonzero(at_extreme & (lengths >= 5))
    if not any(_hits_a_stop(x, starts, int(run)) for run in long):
        return 0, 0
    return int(lengths[at_extreme].sum()), longest


def _hits_a_stop(x: FloatArray, starts: np.ndarray, run: int) -> bool:
    """Whether `x` runs into this stretch at speed; one that settles stays ever longer at ever closer values."""
    k = starts[run]
    if run < 3 or k - starts[run - 3] > 6:
        return False
    before_last, last = np.abs(np.diff(x[k - 3 : k]))
    return bool(last > 0.8 * before_last)


def holds(x: FloatArray) -> list[tuple[int, int]]:
    """Stretches that repeat one value for longer than the noise on the lattice of `x` ever would.

    Parameters
    ----------
    x : ndarray, shape (N,)

    Returns
    -------
    list of (start, stop)
        Half-open, in order; a logger that kept its last value leaves them.
    """
    starts, lengths = runs(x)
    repeats = float(np.mean(lengths > 1))  # in a geometric law of lengths, the chance of one more repeat
    # Fewer than one such stretch in a thousand records by chance, and never fewer than four equal samples.
    longest = 4 if repeats == 0 else max(4, int(np.log(1e-3 / lengths.size) / np.log(min(repeats, 0.99))) + 2)
    return [(int(k), int(k + n)) for k, n in zip(starts, lengths, strict=True) if n >= longest]


def moving_mean_length(x: FloatArray, y: FloatArray, longest: int = 20) -> int | None:
    """The m for which `y` is exactly the mean of the last m samples of `x`.

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Before and after a suspected filter.
    longest : int
        The largest m to try.

    Returns
    -------
    int or None
        1 where both are the same, None where no m fits (up to the first m - 1 samples, which need a past).
    """
    tolerance = 1e-9 * float(np.ptp(x)) + 1e-12 * float(np.abs(x).max())
    total = np.concatenate([[0.0], np.cumsum(x)])
    for m in range(1, min(longest, x.size // 2) + 1):
        mean = (total[m:] - total[:-m]) / m
        if np.abs(mean - y[m - 1 :]).max() <= tolerance:
            return m
    return None
