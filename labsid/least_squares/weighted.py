"""Weighted least squares, and the weights of a forgetting factor."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal
from labsid.least_squares.solve import LeastSquares, as_equations, solve_least_squares


def weighted_least_squares(Phi: ArrayLike, Y: ArrayLike, weights: ArrayLike) -> LeastSquares:
    """Minimise ``1/2 sum w(k) (Y(k) - phi'(k) theta)^2``.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, one row per equation.
    Y : array_like, shape (n,)
        Right-hand sides.
    weights : array_like, shape (n,)
        Positive. The reciprocal noise variances give the best linear unbiased estimate.

    Returns
    -------
    LeastSquares
        ``theta = (Phi'W Phi)^-1 Phi'W Y``. `residual` is ``Y - Phi theta``, unweighted; `loss`, `rank` and
        `condition_number` belong to the weighted equations; `sigma2` is the noise variance at weight one, and
        `covariance` is ``sigma2 (Phi'W Phi)^-1``.

    Raises
    ------
    ValueError
        If the shapes do not match or a weight is not positive.

    Notes
    -----
    Solved as ordinary least squares after multiplying each equation by the square root of its weight. With
    `forgetting_weights`, this is the criterion of RLS with a forgetting factor (Reading notes, lecture 5). Those
    weights express age, not variance, so that `covariance` is then only nominal.
    """
    Phi, Y = as_equations(Phi, Y)
    weights = as_signal("weights", weights)
    if weights.size != Y.size:
        raise ValueError(f"weights must have one entry per equation ({Y.size}); got {weights.size}.")
    if np.any(weights <= 0):
        raise ValueError(
            f"weights must be positive; got {weights.min():g} at equation {np.argmin(weights)}. "
            "To leave an equation out, drop its row."
        )
    root = np.sqrt(weights)
    fit = solve_least_squares(root[:, np.newaxis] * Phi, root * Y)
    return replace(fit, residual=Y - Phi @ fit.theta)


def forgetting_weights(n: int, forgetting: float) -> FloatArray:
    """Compute exponential weights by age, ``lambda^(n - t)`` for t = 1 .. n.

    Parameters
    ----------
    n : int
        Number of samples; the last has weight one.
    forgetting : float
        The forgetting factor lambda, above 0 and at most 1. The memory is about ``1 / (1 - lambda)`` samples.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    ValueError
        If `n` is below 1, `forgetting` is out of range, or the oldest weight underflows.

    Notes
    -----
    Reading notes, lecture 5, "RLS algorithm with a forgetting factor".
    """
    if n < 1:
        raise ValueError(f"n must be at least 1; got {n}.")
    if not 0 < forgetting <= 1:
        raise ValueError(f"forgetting must be above 0 and at most 1; got {forgetting}.")
    if (n - 1) * np.log(forgetting) < np.log(np.finfo(float).tiny):
        raise ValueError(
            f"forgetting {forgetting} makes the oldest of {n} weights vanish. Cut the record to its last samples, "
            "or use the recursive form, which needs no weights."
        )
    return forgetting ** np.arange(n - 1, -1, -1, dtype=np.float64)
