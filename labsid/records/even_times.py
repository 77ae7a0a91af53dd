"""Even sampling times fitted to the time stamps of a logger."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze

MAX_DEVIATION = 0.3  # sampling times; a missing sample shifts some stamp by at least half a sampling time
MAX_BY_WORD = 0.4  # the same, where the caller says that the samples are even
MAX_JITTER = 0.1  # sampling times, by which stamps of samples that are taken as even may deviate
MAX_DROPPED = 0.2  # of the rows: a record with more of them dropped is not one of even sampling,
FEW_PAUSES, MAX_PAUSED = 3, 1 / 3  # unless the logger paused a few times only


@dataclass(frozen=True, slots=True, eq=False)
class EvenTimes:
    """Even times fitted to time stamps.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Times in seconds, one per stamp, or more if rows were dropped.
    Ts : float
        Sampling time in seconds.
    jitter : float
        Root-mean-square deviation of the stamps, in sampling times.
    largest : float
        Largest deviation of a stamp, in sampling times.
    places : ndarray of int, shape (number of stamps,)
        Index in `t` of each stamp.
    """

    t: FloatArray
    Ts: float
    jitter: float
    largest: float
    places: np.ndarray

    def __post_init__(self) -> None:
        freeze(self, t=self.t)


def fit_even_times(stamps: FloatArray, most: float = MAX_DEVIATION) -> EvenTimes | None:
    """Fit even times t0 + k Ts to time stamps by least squares.

    The result is rounded within its accuracy, so that two records of one rig get the same sampling time.

    Parameters
    ----------
    stamps : ndarray, shape (N,)
        Finite times in seconds, N >= 2.
    most : float
        Largest deviation in sampling times.

    Returns
    -------
    EvenTimes or None
        None if a stamp deviates by more than `most`: samples are missing, repeated or out of order.
    """
    fitted = _line(stamps, np.arange(stamps.size))
    return fitted if fitted is not None and fitted.largest <= most else None


def fit_dropped_rows(stamps: FloatArray) -> EvenTimes | None:
    """Fit even times to time stamps of which some rows were dropped.

    Parameters
    ----------
    stamps : ndarray, shape (N,)
        Finite increasing times in seconds, N >= 3.

    Returns
    -------
    EvenTimes or None
        None if more than `MAX_DROPPED` of the rows would be missing (`MAX_PAUSED` in a few pauses), or a stamp deviates
        by more than `MAX_DEVIATION`.
    """
    steps = np.diff(stamps)
    usual = float(np.median(steps))
    if usual <= 0.0 or float(stamps[-1] - stamps[0]) > 2.0 * usual * stamps.size:
        return None
    places = np.concatenate([[0], np.cumsum(np.maximum(np.round(steps / usual), 1.0))]).astype(np.int64)
    fitted = _line(stamps, places)
    for _ in range(3):
        if fitted is None:
            return None
        again = np.round((stamps - fitted.t[0]) / fitted.Ts).astype(np.int64)
        again -= again[0]
        if np.any(np.diff(again) < 1) or np.array_equal(again, fitted.places):
            break
        fitted = _line(stamps, again)
    if fitted is None:
        return None
    dropped = fitted.t.size - stamps.size
    few = int(np.sum(np.diff(fitted.places) > 1)) <= FEW_PAUSES
    most = (MAX_PAUSED if few else MAX_DROPPED) * stamps.size
    return fitted if fitted.largest <= MAX_DEVIATION and dropped <= most else None


def fit_coarse_stamps(stamps: FloatArray) -> EvenTimes | None:
    """Fit even times to stamps that several samples share: of a coarse clock, or of a buffer that is written at once.

    Parameters
    ----------
    stamps : ndarray, shape (N,)
        Finite times in seconds that do not decrease.

    Returns
    -------
    EvenTimes or None
        None unless stamps repeat, in each batch as often or as a clock of that resolution would.
    """
    starts = np.flatnonzero(np.concatenate([[True], stamps[1:] != stamps[:-1]]))
    lengths = np.diff(np.append(starts, stamps.size))
    if starts.size < 3 or np.median(lengths) < 2 or np.ptp(lengths[1:-1]) > 1:
        return None
    fitted = _line(stamps, np.arange(stamps.size))
    step = float(np.diff(stamps[starts]).min())
    if fitted is None or not step > fitted.Ts:
        return None
    return fitted if fitted.largest * fitted.Ts <= 0.5 * step + MAX_JITTER * fitted.Ts else None


def resolution(stamps: FloatArray) -> float:
    """The decimal digit to which stamps are written, in seconds: 0.001 for milliseconds; 0 if there are too many."""
    since = stamps - stamps[0]
    for digits in range(10):
        scaled = since * 10.0**digits
        if np.abs(scaled - np.round(scaled)).max() < 1e-3:
            return float(10.0**-digits)
    return 0.0


def _line(stamps: FloatArray, places: np.ndarray) -> EvenTimes | None:
    k = places - float(np.mean(places))
    since = stamps - stamps[0]
    middle, Ts = float(np.mean(since)), float(k @ since / (k @ k))
    off = since - middle - Ts * k
    if not Ts > 0.0:
        return None
    largest, rms = float(np.abs(off).max()), float(np.sqrt(np.mean(off**2)))
    Ts = _short(Ts, rms / (stamps.size - 1))  # shifts the first and the last sample by at most half the rms
    start = float(stamps[0]) + middle + Ts * float(k[0])
    if rms > 0.0:
        start = round(start, -int(np.floor(np.log10(0.5 * rms)))) + 0.0  # no -0
    t = start + Ts * np.arange(int(places[-1]) + 1, dtype=np.float64)
    return EvenTimes(t, Ts, rms / Ts, largest / Ts, places)


def _short(Ts: float, slack: float) -> float:
    """The value within `slack` of Ts with the fewest digits, in seconds or as a rate (1/30 s is 30 Hz)."""
    for digits in range(1, 10):
        for candidate in (float(f"{Ts:.{digits}g}"), 1.0 / float(f"{1.0 / Ts:.{digits}g}")):
            if abs(candidate - Ts) <= slack:
                return candidate
    return Ts
