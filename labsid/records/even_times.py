"""Even sampling times fitted to the jittering time stamps of a logger."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze

MAX_DEVIATION = 0.3  # sampling times; a missing sample shifts some stamp by at least half a sampling time


@dataclass(frozen=True, slots=True, eq=False)
class EvenTimes:
    """Even times fitted to time stamps.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Times in seconds, one per stamp.
    Ts : float
        Sampling time in seconds.
    jitter : float
        Root-mean-square deviation of the stamps, in sampling times.
    """

    t: FloatArray
    Ts: float
    jitter: float

    def __post_init__(self) -> None:
        freeze(self, t=self.t)


def fit_even_times(stamps: FloatArray) -> EvenTimes | None:
    """Fit even times t0 + k Ts to time stamps by least squares.

    The result is rounded within its accuracy, so that two records of one rig get the same sampling time.

    Parameters
    ----------
    stamps : ndarray, shape (N,)
        Finite times in seconds, N >= 2.

    Returns
    -------
    EvenTimes or None
        None if a stamp deviates by more than `MAX_DEVIATION`: samples are missing, repeated or out of order.
    """
    k = np.arange(stamps.size) - 0.5 * (stamps.size - 1)
    since = stamps - stamps[0]
    middle, Ts = float(np.mean(since)), float(k @ since / (k @ k))
    off = since - middle - Ts * k
    if Ts <= 0.0 or np.abs(off).max() > MAX_DEVIATION * Ts:
        return None
    rms = float(np.sqrt(np.mean(off**2)))
    Ts = _short(Ts, rms / (stamps.size - 1))  # shifts the first and the last sample by at most half the rms
    start = float(stamps[0]) + middle + Ts * k[0]
    if rms > 0.0:
        start = round(start, -int(np.floor(np.log10(0.5 * rms)))) + 0.0  # no -0
    return EvenTimes(start + Ts * np.arange(stamps.size), Ts, rms / Ts)


def _short(Ts: float, slack: float) -> float:
    """The value within `slack` of Ts with the fewest digits, in seconds or as a rate (1/30 s is 30 Hz)."""
    for digits in range(1, 10):
        for candidate in (float(f"{Ts:.{digits}g}"), 1.0 / float(f"{1.0 / Ts:.{digits}g}")):
            if abs(candidate - Ts) <= slack:
                return candidate
    return Ts
