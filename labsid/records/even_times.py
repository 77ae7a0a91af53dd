"""The even times behind stamps that jitter, as an ordinary logger writes them."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze

NEAR = 0.3  # of the sampling time, off the even times: more is no jitter, and a missing sample is half of it at least


@dataclass(frozen=True, slots=True, eq=False)
class EvenTimes:
    """The even times next to some stamps.

    Attributes
    ----------
    t : ndarray, shape (N,)
        In seconds, one for each stamp.
    Ts : float
        Sampling time in seconds.
    jitter : float
        Root mean square of what the stamps are off, in sampling times.
    """

    t: FloatArray
    Ts: float
    jitter: float

    def __post_init__(self) -> None:
        freeze(self, t=self.t)


def fit_even_times(stamps: FloatArray) -> EvenTimes | None:
    """Find even times t0 + k Ts to which all stamps are near: by least squares, then rounded as far as these allow.

    Rounded, because two records of one rig, or a record and a simulation, are to have the same sampling time.

    Parameters
    ----------
    stamps : ndarray, shape (N,)
        In seconds, sound, N >= 2.

    Returns
    -------
    EvenTimes or None
        None if a stamp is off by more than `NEAR`: samples are missing, or doubled, or out of order.
    """
    k = np.arange(stamps.size) - 0.5 * (stamps.size - 1)
    since = stamps - stamps[0]
    middle, Ts = float(np.mean(since)), float(k @ since / (k @ k))
    off = since - middle - Ts * k
    if Ts <= 0.0 or np.abs(off).max() > NEAR * Ts:
        return None
    rms = float(np.sqrt(np.mean(off**2)))
    Ts = _short(Ts, rms / (stamps.size - 1))  # at the first and the last sample this is half the rms
    start = float(stamps[0]) + middle + Ts * k[0]
    if rms > 0.0:
        start = round(start, -int(np.floor(np.log10(0.5 * rms)))) + 0.0  # no -0
    return EvenTimes(start + Ts * np.arange(stamps.size), Ts, rms / Ts)


def _short(Ts: float, slack: float) -> float:
    """The sampling time of the fewest digits within `slack`, its own or those of its rate: 1/30 s is 30 Hz."""
    for digits in range(1, 10):
        for candidate in (float(f"{Ts:.{digits}g}"), 1.0 / float(f"{1.0 / Ts:.{digits}g}")):
            if abs(candidate - Ts) <= slack:
                return candidate
    return Ts
