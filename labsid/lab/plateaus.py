"""Levels at which the output settles under a staircase input, and whether they repeat at equal inputs."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.signal_quality import runs

MAX_PERIODS = 50  # of a staircase input; with more, y hardly settles
MAX_DRIFT = 0.03  # share of the range of y: largest difference between the means of a tail's halves
MAX_AUTOCORRELATION = 0.9  # upper limit for the estimate at lag one
MIN_DIFFERENCE = 0.015  # share of the range of y: smallest relevant difference of levels


@dataclass(frozen=True, slots=True)
class Plateaus:
    """Settled tails of the input periods at levels that occur more than once.

    Attributes
    ----------
    stretches : dict
        Level of u -> the settled tails of its periods, each (start, stop), half-open.
    ends : dict
        Level of u -> the mean of y over each of these tails.
    largest : float
        Largest difference of two means at one level, in the unit of y.
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
        """Whether y returns to the same level at the same input."""
        return self.largest <= max(MIN_DIFFERENCE * self.span, 2 * self.noise)

    def by_chance(self, x: FloatArray, counted: np.ndarray) -> float:
        """Upper limit of `scatter` for repeating plateaus, from the noise within the tails.

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
        lag_products = sum(float(tail[1:] @ tail[:-1]) for tail in tails)
        rho = float(np.clip(lag_products / square, 0.0, MAX_AUTOCORRELATION))
        length = float(np.median([tail.size for tail in tails]))
        of_means = square / freedom / length * (1.0 + rho) / (1.0 - rho)
        ends = max(len(tails) - len(self.stretches), 1)
        return float(np.sqrt(of_means * (1.0 + 2.0 * np.sqrt(2.0 / ends))))

    def scatter(self, x: FloatArray, counted: np.ndarray) -> float:
        """Standard deviation of the tail means of a signal about the mean of their level; 0 if there are too few.

        Parameters
        ----------
        x : ndarray, shape (N,)
            y, or the residual of a simulation.
        counted : ndarray of bool, shape (N,)
            The valid samples.
        """
        means = [
            np.array([x[a:b][counted[a:b]].mean() for a, b in own if counted[a:b].any()])
            for own in self.stretches.values()
        ]
        freedom = sum(own.size - 1 for own in means if own.size)
        square = sum(float(np.sum((own - own.mean()) ** 2)) for own in means if own.size)
        return float(np.sqrt(square / freedom)) if freedom else 0.0


def repeated_plateaus(u: FloatArray, y: FloatArray) -> Plateaus | None:
    """Find the settled tails of y at input levels that occur more than once.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        N >= 1.

    Returns
    -------
    Plateaus or None
        None if no level has two settled tails.
    """
    starts, lengths = runs(u)
    if starts.size > MAX_PERIODS:
        return None
    span, noise = float(np.ptp(y)), []
    tails: dict[float, list[tuple[int, int]]] = {}
    for start, length in zip(starts.tolist(), lengths.tolist(), strict=True):
        stop = start + length
        tail = y[stop - length // 4 : stop]
        half = tail.size // 2
        cut_short = start > 0 and length < np.median(lengths) / 2
        if cut_short or half < 5 or abs(tail[half:].mean() - tail[:half].mean()) > MAX_DRIFT * span:
            continue
        tails.setdefault(float(u[start]), []).append((stop - length // 4, stop))
        noise.append(float(tail.std()))
    stretches = {level: tuple(own) for level, own in sorted(tails.items()) if len(own) > 1}
    if not stretches:
        return None
    ends = {level: tuple(float(y[a:b].mean()) for a, b in own) for level, own in stretches.items()}
    largest = max(max(own) - min(own) for own in ends.values())
    return Plateaus(stretches, ends, largest, span, float(np.median(noise)))
