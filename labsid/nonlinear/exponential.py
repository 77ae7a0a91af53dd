"""Fitting ``y = b e^(a x)``: through the logarithm, and as what it is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, as_signals, freeze
from labsid.least_squares.curve_fit import LINE, fit_powers
from labsid.nonlinear.solve import NonlinearFit, levenberg_marquardt


@dataclass(frozen=True, slots=True, eq=False)
class LogarithmFit:
    """A straight line through the logarithms.

    Attributes
    ----------
    a, b : float
        Of ``b e^(a x)``; the line is ``ln y = a x + ln b``.
    log_residual : ndarray, shape (n,)
        ``ln y - a x - ln b``: what the line minimises the squares of; about the *relative* error.
    sse : float
        Sum of squares of ``y - b e^(a x)``: what it does not minimise.
    """

    a: float
    b: float
    log_residual: FloatArray
    sse: float

    def __post_init__(self) -> None:
        freeze(self, log_residual=self.log_residual)


def evaluate_exponential(x: ArrayLike, a: float, b: float) -> FloatArray:
    """Evaluate ``b e^(a x)``.

    Parameters
    ----------
    x : array_like, shape (n,)
    a, b : float

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    ValueError
        If x is not one finite signal.
    """
    return b * np.exp(a * as_signal("x", x))


def fit_exponential_by_logarithm(x: ArrayLike, y: ArrayLike) -> LogarithmFit:
    """Fit a straight line to ``ln y``: linear least squares, but another criterion.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Points; every y positive, at least two different x.

    Returns
    -------
    LogarithmFit

    Raises
    ------
    ValueError
        If a y is not positive, the lengths differ, or all x are equal.

    Notes
    -----
    SUSTech lecture, exponential fit, the slide that takes logarithms. Errata: the lecture uses "the same data", whose
    third sample is -3.6 and has no logarithm. For positive y it weighs each point by 1/y where the noise is the same
    on all: use `fit_exponential`, for which this is a good start.
    """
    x, y = as_signals(x=x, y=y)
    if np.any(y <= 0):
        where = int(np.argmax(y <= 0))
        raise ValueError(
            f"y must be positive to have a logarithm; got {y[where]:g} at point {where}. "
            "Use fit_exponential, which fits the curve itself."
        )
    _check_spread(x)
    line = fit_powers(x, np.log(y), LINE)
    a, b = float(line.theta[0]), float(np.exp(line.theta[1]))
    errors = y - evaluate_exponential(x, a, b)
    return LogarithmFit(a, b, line.residual, float(errors @ errors))


def fit_exponential(x: ArrayLike, y: ArrayLike) -> NonlinearFit:
    """Minimise ``|y - b e^(a x)|^2`` by Levenberg-Marquardt; y may have any sign.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Points; at least two different x.

    Returns
    -------
    NonlinearFit
        ``theta = [a, b]``.

    Raises
    ------
    ValueError
        If the lengths differ, all x are equal, or x lies so far from zero that b leaves the range of numbers.

    Notes
    -----
    SUSTech lecture, exponential fit, the slide with ``min |y - b e^(a x)|^2`` (Errata: the lecture labels the other
    one "method 2"). On its data: a = 0.88402534, b = 0.48571061. It starts from the best of a scan over rates up to
    e^8 over the range of x: b enters linearly, so that each a has its best b.
    """
    x, y = as_signals(at_least=2, x=x, y=y)
    _check_spread(x)
    rates = np.linspace(-8, 8, 65) / np.ptp(x)
    # Shifting x by its middle changes b alone, and keeps e^(a x) small wherever x lies.
    middle = (x.min() + x.max()) / 2
    curves = np.exp(rates[:, np.newaxis] * (x - middle))
    scales = curves @ y / np.sum(curves**2, axis=1)
    sse = np.sum((y - scales[:, np.newaxis] * curves) ** 2, axis=1)
    best = int(np.argmin(sse))

    def g(theta: FloatArray) -> FloatArray:
        return evaluate_exponential(x - middle, theta[0], theta[1])

    def jacobian(theta: FloatArray) -> FloatArray:
        growth = evaluate_exponential(x - middle, theta[0], 1.0)
        return np.column_stack([theta[1] * (x - middle) * growth, growth])

    return _shifted(levenberg_marquardt(g, jacobian, y, [rates[best], scales[best]]), middle)


def _shifted(fit: NonlinearFit, middle: float) -> NonlinearFit:
    """Turn the fit of ``c e^(a (x - middle))`` into that of ``b e^(a x)``: b = c e^(-a middle)."""
    path = fit.path.copy()
    with np.errstate(over="ignore"):
        path[:, 1] *= np.exp(-fit.path[:, 0] * middle)
        a, c = fit.theta
        factor = np.exp(-a * middle)
    b = c * factor
    if not 0 < factor < np.inf:
        raise ValueError(
            f"x must lie nearer to zero, where b is the value of the curve; got x around {middle:g} with a = {a:.4g}, "
            "for which b leaves the range of numbers. Subtract a constant from x."
        )
    change = np.array([[1.0, 0.0], [-middle * b, factor]])
    covariance = change @ fit.covariance @ change.T
    return NonlinearFit(
        np.array([a, b]),
        fit.residual,
        fit.sse,
        path,
        fit.path_sse,
        covariance,
        np.sqrt(np.diag(covariance)),
        fit.status,
    )


def _check_spread(x: FloatArray) -> None:
    if np.ptp(x) == 0:
        raise ValueError(f"x must take at least two values; got {x[0]:g} throughout.")
