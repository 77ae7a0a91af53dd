"""Bias and spread of an estimator over many records, each with its standard error."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze


@dataclass(frozen=True, slots=True, eq=False)
class MonteCarlo:
    """Estimates from independent records of one system.

    Attributes
    ----------
    estimates : ndarray, shape (runs, p)
        One row a record; without the runs that gave no finite estimate.
    truth : ndarray, shape (p,)
    failed : int
        How many runs gave no finite estimate.
    """

    estimates: FloatArray
    truth: FloatArray
    failed: int

    def __post_init__(self) -> None:
        freeze(self, estimates=self.estimates, truth=self.truth)

    @property
    def mean(self) -> FloatArray:
        """Mean estimate, shape (p,)."""
        mean: FloatArray = self.estimates.mean(axis=0)
        return mean

    @property
    def spread(self) -> FloatArray:
        """Standard deviation of one estimate, shape (p,): what a single record's table is off by."""
        return np.std(self.estimates, axis=0, ddof=1)

    @property
    def bias(self) -> FloatArray:
        """Mean less truth, shape (p,)."""
        return self.mean - self.truth

    @property
    def bias_stderr(self) -> FloatArray:
        """Standard error of the bias, shape (p,): ``spread / sqrt(runs)``."""
        return self.spread / np.sqrt(len(self.estimates))

    @property
    def rmse(self) -> FloatArray:
        """Root of the mean squared error, shape (p,): bias and spread together."""
        return np.sqrt(np.mean((self.estimates - self.truth) ** 2, axis=0))


def run_monte_carlo(
    estimate: Callable[[np.random.Generator], ArrayLike], truth: ArrayLike, runs: int, seed: int
) -> MonteCarlo:
    """Repeat an experiment with independent noise.

    Parameters
    ----------
    estimate : callable
        Takes a random generator, makes a record with it and returns the estimate, shape (p,).
    truth : array_like, shape (p,)
        What the estimates should be.
    runs : int
        How many records; at least 2.
    seed : int
        The runs get independent streams of it, so that run i is the same whatever `runs` is.

    Returns
    -------
    MonteCarlo

    Raises
    ------
    ValueError
        If there are fewer than two runs or two finite estimates, or one has another length than the truth.

    Notes
    -----
    Reading lectures, L6, "Bias, consistency and model approximation". Errata: ``E(theta) = theta`` is unbiasedness;
    consistency is that bias and spread both vanish as the records get longer.
    """
    truth = as_signal("truth", truth)
    if runs < 2:
        raise ValueError(f"runs must be at least 2 to show a spread; got {runs}.")
    streams = np.random.SeedSequence(seed).spawn(runs)
    estimates = np.array([np.asarray(estimate(np.random.default_rng(stream)), dtype=np.float64) for stream in streams])
    if estimates.shape != (runs, truth.size):
        raise ValueError(f"estimate must return one value a true one ({truth.size}); got shape {estimates.shape[1:]}.")
    finite = np.all(np.isfinite(estimates), axis=1)
    if np.sum(finite) < 2:
        raise ValueError(f"at least 2 of the {runs} estimates must be finite; got {np.sum(finite)}.")
    return MonteCarlo(estimates[finite], truth, int(runs - np.sum(finite)))
