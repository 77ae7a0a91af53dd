"""Levels at which the output rests under a staircase input, and whether they repeat where the input does."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.signal_quality import runs

MOST_PERIODS = 50  # an input of more is no staircase on which anything comes to rest
STILL = 0.03  # of the range of y: what a settled tail moves at most from its first half to its second
MEMORY = 0.9  # autocorrelation of the noise that is believed at most
SMALLEST = 0.015  # of the range of y: a difference of levels that counts


@dataclass(frozen=True, slots=True)
class Plateaus:
    """Settled ends of input periods at levels that come back.

    Attributes
    ----------
    stretches : dict
        Level of u -> the settled tails of its periods, each (start, stop), half-open.
    ends : dict
        Level of u -> the mean of y over each of these tails.
    largest : float
        Largest difference of two ends at one level, in the unit of y.
    span : float
        Range of y.
    noise : float
        Standard deviation of y within a tail.
    """

    stretches: dict[float, tuple[tuple[int, int], ...]]
    ends: dict[float, tuple[float, ...]]
    largest: float
    span: float
    noise: float

    @property
    def repeat(self) -> bool:
        """Whether y comes back to the same levels at the same input."""
        return self.largest <= max(SMALLEST * self.span, 2 * self.noise)

    def by_chance(self, x: FloatArray, counted: np.ndarray) -> float:
        """How large `scatter` may well be by nothing but the noise that is seen within the tails.

        Parameters
        ----------
        x : ndarray, shape (N,)
        counted : ndarray of bool, shape (N,)
        """
        tails = [x[a:b][counted[a:b]] for own in self.stretches.values() for a, b in own]
        tails = [tail - tail.mean() for tail in tails if tail.size > 1]
        freedom = sum(tail.size - 1 for tail in tails)
        square = sum(float(tail @ tail) for tail in tails)
        if not square:
            return 0.0
        memory = float(np.clip(sum(float(tail[1:] @ tail[:-1]) for tail in tails) / square, 0.0, MEMORY))
        length = float(np.median([tail.size for tail in tails]))
        of_means = square / freedom / length * (1.0 + memory) / (1.0 - memory)
        ends = max(len(tails) - len(self.stretches), 1)
        return float(np.sqrt(of_means * (1.0 + 2.0 * np.sqrt(2.0 / ends))))

    def scatter(self, x: FloatArray, counted: np.ndarray) -> float:
        """Standard deviation of the ends of a signal about the mean of their level; 0 where too few of them count.

        Parameters
        ----------
        x : ndarray, shape (N,)
            y itself, or what a simulation leaves of it.
        counted : ndarray of bool, shape (N,)
            Its readings that are to be trusted.
        """
        means = [
            np.array([x[a:b][counted[a:b]].mean() for a, b in own if counted[a:b].any()])
            for own in self.stretches.values()
        ]
        freedom = sum(own.size - 1 for own in means if own.size)
        square = sum(float(np.sum((own - own.mean()) ** 2)) for own in means if own.size)
        return float(np.sqrt(square / freedom)) if freedom else 0.0


def repeated_plateaus(u: FloatArray, y: FloatArray) -> Plateaus | None:
    """Find where y has come to rest at the same level of the input more than once.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        N >= 1.

    Returns
    -------
    Plateaus or None
        None if there are no two such places.
    """
    starts, lengths = runs(u)
    if starts.size > MOST_PERIODS:
        return None
    span, noise = float(np.ptp(y)), []
    tails: dict[float, list[tuple[int, int]]] = {}
    for start, length in zip(starts.tolist(), lengths.tolist(), strict=True):
        stop = start + length
        tail = y[stop - length // 4 : stop]
        half = tail.size // 2
        cut_short = start > 0 and length < np.median(lengths) / 2
        if cut_short or half < 5 or abs(tail[half:].mean() - tail[:half].mean()) > STILL * span:
            continue
        tails.setdefault(float(u[start]), []).append((stop - length // 4, stop))
        noise.append(float(tail.std()))
    stretches = {level: tuple(own) for level, own in sorted(tails.items()) if len(own) > 1}
    if not stretches:
        return None
    ends = {level: tuple(float(y[a:b].mean()) for a, b in own) for level, own in stretches.items()}
    largest = max(max(own) - min(own) for own in ends.values())
    return Plateaus(stretches, ends, largest, span, float(np.median(noise)))
