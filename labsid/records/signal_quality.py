"""Artefacts of sensors, converters and loggers in raw samples: lattices, stops, held values, moving means."""

import numpy as np

from labsid._arrays import FloatArray

MIN_HOLD = 3  # equal samples in a row
RARE_REPEATS = 0.01  # share of values that occur twice in a row; above it, noise repeats values
FINE_STEP = 1e-4  # of the range: below this converter step, equal samples are rare by chance
LARGE_MOVE = 4.0  # median changes between samples: a jump away from the sensor's limit
SEVERAL_HOLDS = 3
NEAR, NEAR_SHARE = 10, 0.02  # of the smallest changes from one reading to the next, whose density is taken
MOSTLY_NEW = 0.99  # of the readings, that occur once where no lattice makes them equal
MOST_BY_CHANCE = 0.1  # repeats of a record
ISOLATED = 15.0  # robust standard deviations from the middle of the samples beside it: a spike
BACK = 0.3  # of its height: the samples beside a spike differ by less
MIN_CROWDED = 4.0  # samples at a limit over those one converter step before it; a smooth extreme has at most 2.4
QUIET_INPUT = 0.05  # of the range of the input, which moves by less where it does not cause a spike
SPIKES = 0.01  # of the samples; more of them are the course of the output


def digits_of(value: float, span: float, least: int = 4) -> str:
    """A value with the digits that tell it from others of its signal: to a ten-thousandth of the range.

    Parameters
    ----------
    value : float
    span : float
        Range of the signal.
    least : int
        Fewest significant digits.
    """
    if not (np.isfinite(value) and np.isfinite(span)) or span <= 0.0 or value == 0.0:
        return f"{value:.{least}g}"
    digits = int(np.clip(np.ceil(np.log10(abs(value) / span)) + 4, least, 16))
    return f"{value:.{digits}g}"


def runs(x: FloatArray) -> tuple[np.ndarray, np.ndarray]:
    """Starts and lengths of the runs of exactly equal values.

    Parameters
    ----------
    x : ndarray, shape (N,)
        N >= 1.

    Returns
    -------
    starts, lengths : ndarray of int, shape (number of runs,)
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
        In the unit of `x`; None for fewer than three different values, or if there is no lattice.
    """
    values = np.unique(x)
    span = float(values[-1] - values[0])
    gaps = np.diff(values)
    gaps = gaps[gaps > 1e-9 * span]  # smaller gaps are rounding errors
    if gaps.size < 2:
        return None
    steps = round(span / float(gaps.min()))
    step = span / steps
    places = (values - values[0]) / step
    off = float(np.abs(places - np.round(places)).max())
    # Without a lattice, the fractional parts would be spread evenly.
    return step if off < 1e-3 else None


def scatter(x: FloatArray) -> float:
    """Standard deviation of the noise, from third differences; an upper bound while `x` also moves.

    Parameters
    ----------
    x : ndarray, shape (N,)
        N >= 5.

    Returns
    -------
    float
        Third differences are small for a smooth signal; white noise has sqrt(20) times its own standard deviation.
    """
    return float(np.median(np.abs(np.diff(x, 3))) / 0.6745 / np.sqrt(20))


def stuck_at_extreme(x: FloatArray, extreme: float) -> tuple[int, int]:
    """Count the samples that lie exactly at an extreme of `x`, as at a stop.

    Parameters
    ----------
    x : ndarray, shape (N,)
    extreme : float
        The largest or smallest value of `x`.

    Returns
    -------
    samples, longest : int
        Their number and the longest run of them; both 0 if no run is of five samples or more, if the signal
        slows down before it, as it does when it settles, or if it lies on a lattice, on which a smooth extreme
        repeats one value, and is not far more often there than one step before.
    """
    starts, lengths = runs(x)
    at_extreme = x[starts] == extreme
    longest = int(lengths[at_extreme].max())
    long = np.flatnonzero(at_extreme & (lengths >= 5))
    if not any(_hits_a_stop(x, starts, int(run)) for run in long):
        return 0, 0
    samples = int(lengths[at_extreme].sum())
    step = lattice_step(x) or lattice_step(x[starts[lengths > 1]])  # a log between whose samples others are worked out
    if step is not None and samples < MIN_CROWDED * _one_step_before(x, extreme, step):
        return 0, 0
    return samples, longest


def _one_step_before(x: FloatArray, extreme: float, step: float) -> int:
    """Number of samples one step of the lattice from an extreme."""
    distance = np.abs(x - extreme)
    return int(np.sum((distance > 0.5 * step) & (distance < 1.5 * step)))


def _hits_a_stop(x: FloatArray, starts: np.ndarray, run: int) -> bool:
    """Whether `x` enters this run without slowing down, as a settling signal would."""
    k = starts[run]
    if run < 3 or k - starts[run - 3] > 6:
        return False
    before_last, last = np.abs(np.diff(x[k - 3 : k]))
    return bool(last > 0.8 * before_last)


def find_held(y: FloatArray, lattice: float | None, shortest: int = MIN_HOLD) -> tuple[tuple[int, int], ...]:
    """Find the runs in which the logger repeats its last value.

    Parameters
    ----------
    y : ndarray, shape (N,)
    lattice : float or None
        Converter step of y; None if there is none.
    shortest : int
        Shortest run of equal values that may be a hold; see `shortest_hold`.

    Returns
    -------
    tuple of (start, stop)
        Half-open, in order, without the first sample of each run, which is a true reading.

    Notes
    -----
    On a fine lattice, a few equal readings are a hold, unless the output returns to that value: then it is the sensor's
    limit, or rest. On a coarse lattice, rest and slow motion also give equal readings; there a hold ends with a jump.
    """
    starts, lengths = runs(y)
    step = 0.0 if lattice is None else lattice
    fine = step <= FINE_STEP * np.ptp(y)
    long = lengths >= shortest
    moves = np.abs(np.diff(y, append=[y[-1]] * 2))
    jump, onward = moves[starts + lengths - 1], moves[starts + lengths]
    usual = max(1.5 * step, LARGE_MOVE * float(np.median(moves[moves > 0.0])))
    jumps = (jump > (usual if fine else 1.5 * step)) & (jump > 2.0 * onward)
    if not fine:
        long &= jumps & (lengths >= 2.0 * np.median(np.repeat(lengths, lengths)) + 3.0)
    # Equal readings at the start are rest, unless they end with a jump and there are several holds elsewhere.
    long &= (starts > 0) | (jumps & (np.count_nonzero(long & jumps & (starts > 0)) >= SEVERAL_HOLDS))
    starts, lengths, jumps, jump = starts[long], lengths[long], jumps[long], jump[long]
    values, which, count = np.unique(y[starts], return_inverse=True, return_counts=True)
    again = count > 1
    extreme = (values == y.max()) | (values == y.min())
    if not fine:
        stop = extreme
        jumps &= ~(again & extreme)[which] | (
            jump > LARGE_MOVE * np.median(moves)
        )  # noise causes small jumps off a limit
    elif (~again & ~extreme).sum() >= SEVERAL_HOLDS:  # a logger with several holds may hold at the extreme, too
        stop = again
    else:
        stop = again | extreme
    return tuple(
        (int(start) + 1, int(start + length))
        for start, length, jumped, stopped in zip(starts, lengths, jumps, stop[which], strict=True)
        if jumped or not stopped
    )


def shortest_repeat(x: FloatArray, step: float) -> int:
    """Shortest run of equal readings that may be a hold: two, if chance makes them equal in few records.

    Parameters
    ----------
    x : ndarray, shape (N,)
    step : float
        Resolution of the readings; 0 of exact ones.

    Returns
    -------
    int
        2, or `MIN_HOLD` where two readings in a row are often equal.
    """
    moves = np.sort(np.abs(np.diff(x)))
    moves = moves[moves > 0.0]
    near = max(NEAR, int(NEAR_SHARE * x.size))
    if near >= moves.size:
        return MIN_HOLD
    readings = x[runs(x)[0]]
    if (
        np.unique(readings).size < MOSTLY_NEW * readings.size
    ):  # on the lattice of a converter, printed with other digits
        step = max(step, float(moves[0]))
    by_chance = 0.5 * step * near / moves[near]  # changes are as dense at zero as next to it
    return 2 if by_chance < MOST_BY_CHANCE else MIN_HOLD


def shortest_hold(x: FloatArray) -> int:
    """Shortest run of equal values that noise rarely makes: in one of a thousand records.

    Parameters
    ----------
    x : ndarray, shape (N,)

    Returns
    -------
    int
    """
    lengths = runs(x)[1]
    repeats = float(np.mean(lengths == 2))  # approximate probability that noise repeats a value
    if repeats < RARE_REPEATS:
        return MIN_HOLD
    return max(MIN_HOLD, int(np.log(1e-3 / lengths.size) / np.log(repeats)) + 2)


def isolated_samples(u: FloatArray, y: FloatArray) -> np.ndarray:
    """Single samples of an output far from both beside them, where the input does not move.

    Parameters
    ----------
    u, y : ndarray, shape (N,)

    Returns
    -------
    ndarray of int
        Empty if there are so many that they are the course of the output.
    """
    none = np.zeros(0, int)
    if y.size < 5 or np.shape(u) != np.shape(y):
        return none
    height, beside = y[1:-1] - 0.5 * (y[:-2] + y[2:]), np.abs(y[2:] - y[:-2])
    spread = float(np.median(np.abs(height - np.median(height)))) / 0.6745
    high = (np.abs(height) > ISOLATED * spread) & (beside < BACK * np.abs(height)) & (spread > 0.0)
    moves = np.abs(np.diff(u, prepend=u[:1])) > QUIET_INPUT * np.ptp(u)
    high &= ~(moves[1:-1] | moves[:-2] | moves[2:])
    at = np.flatnonzero(high) + 1
    return at if at.size <= max(SPIKES * y.size, 1.0) else none


def moving_mean_length(x: FloatArray, y: FloatArray, longest: int = 20) -> int | None:
    """Find the m for which `y` is exactly the mean of the last m samples of `x`.

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Signals before and after a possible filter.
    longest : int
        The largest m to try.

    Returns
    -------
    int or None
        1 if both are the same; None if no m fits. The first m - 1 samples are not compared.
    """
    tolerance = 1e-9 * float(np.ptp(x)) + 1e-12 * float(np.abs(x).max())
    total = np.concatenate([[0.0], np.cumsum(x)])
    for m in range(1, min(longest, x.size // 2) + 1):
        mean = (total[m:] - total[:-m]) / m
        if np.abs(mean - y[m - 1 :]).max() <= tolerance:
            return m
    return None
