"""Covariance of the estimate, and confidence intervals by Student's t."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from labsid._arrays import FloatArray, as_matrix, freeze
from labsid.least_squares.linear_algebra import singular_values
from labsid.least_squares.solve import LeastSquares


@dataclass(frozen=True, slots=True, eq=False)
class ConfidenceIntervals:
    """Confidence intervals of the parameters.

    Attributes
    ----------
    lower, upper : ndarray, shape (p,)
        ``theta -+ t * stderr``; NaN if the fit has no standard errors (rank-deficient, or n = p).
    confidence : float
        Probability that the interval of one parameter contains its true value.
    degrees_of_freedom : int
        Equations minus unknowns, n - p.
    """

    lower: FloatArray
    upper: FloatArray
    confidence: float
    degrees_of_freedom: int

    def __post_init__(self) -> None:
        freeze(self, lower=self.lower, upper=self.upper)


def parameter_covariance(Phi: ArrayLike, sigma2: float) -> FloatArray:
    """Compute ``cov(theta) = sigma^2 (Phi'Phi)^-1`` for a known variance of the noise.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, of full column rank.
    sigma2 : float
        Variance of the white noise, in the square of the unit of y.

    Returns
    -------
    ndarray, shape (p, p)

    Raises
    ------
    ValueError
        If Phi lacks full column rank or `sigma2` is negative.

    Notes
    -----
    Reading notes, lecture 6, Lemma 1 (ii). For N samples of a stationary signal it decreases as 1/N. Exact for
    deterministic regressors; asymptotic if they include lagged outputs (Errata). `LeastSquares.covariance` is the
    same with sigma^2 estimated from the residual.
    """
    Phi = as_matrix("Phi", Phi)
    if not (np.isfinite(sigma2) and sigma2 >= 0):
        raise ValueError(f"sigma2 must be a variance, zero or more; got {sigma2}.")
    parts = singular_values(Phi)
    if parts.rank < Phi.shape[1]:
        raise ValueError(
            f"Phi must have full column rank; got rank {parts.rank} of {Phi.shape[1]} columns. "
            "Excite the system more or lower the order."
        )
    covariance: FloatArray = sigma2 * (parts.V / parts.s**2) @ parts.V.T
    return covariance


def confidence_intervals(fit: LeastSquares, confidence: float = 0.95) -> ConfidenceIntervals:
    """Compute a confidence interval for each parameter of a fit.

    Parameters
    ----------
    fit : LeastSquares
    confidence : float
        Between 0 and 1.

    Returns
    -------
    ConfidenceIntervals

    Raises
    ------
    ValueError
        If `confidence` is not between 0 and 1.

    Notes
    -----
    From the covariance of Lemma 1 (Reading notes, lecture 6). Student's t with n - p degrees of freedom accounts for
    the estimation of sigma^2. Exact for Gaussian noise and deterministic regressors.
    """
    if not 0 < confidence < 1:
        raise ValueError(f"confidence must lie between 0 and 1; got {confidence}. For 95 % give 0.95.")
    degrees_of_freedom = fit.residual.size - fit.theta.size
    quantile = stdtrit(degrees_of_freedom, (1 + confidence) / 2) if degrees_of_freedom > 0 else np.nan
    half = quantile * fit.stderr
    return ConfidenceIntervals(fit.theta - half, fit.theta + half, confidence, degrees_of_freedom)
