"""Poles and zeros with their standard errors, from the covariance of the coefficients."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, freeze

CHI2_OF_ONE, CHI2_OF_TWO = 3.841, 5.991  # quantiles of 95 % with one and two degrees of freedom
ROUND_OFF = 1e-12  # of the largest coefficient: a smaller leading one is zero


@dataclass(frozen=True, slots=True, eq=False)
class Root:
    """A pole or a zero.

    Attributes
    ----------
    value : complex
    covariance : ndarray, shape (2, 2)
        Of its real and imaginary part; NaN where it is unknown.
    """

    value: complex
    covariance: FloatArray

    def __post_init__(self) -> None:
        freeze(self, covariance=np.asarray(self.covariance, float))

    def ellipse(self, points: int = 73) -> FloatArray | None:
        """The 95 % region: real and imaginary parts of a closed curve, shape (2, points); None if it is unknown."""
        if not np.isfinite(self.covariance).all():
            return None
        values, vectors = np.linalg.eigh(self.covariance)
        angle = np.linspace(0.0, 2.0 * np.pi, points)
        quantile = CHI2_OF_TWO if self.covariance[1, 1] > 0.0 else CHI2_OF_ONE  # a real root moves along its axis
        axes = vectors * np.sqrt(quantile * np.maximum(values, 0.0))
        centre = np.array([[self.value.real], [self.value.imag]])
        return np.asarray(centre + axes @ np.array([np.cos(angle), np.sin(angle)]))


def roots_with_errors(coefficients: ArrayLike, covariance: ArrayLike | None = None) -> tuple[Root, ...]:
    """Roots of a polynomial, and how far they move with its coefficients.

    Parameters
    ----------
    coefficients : array_like, shape (n + 1,)
        In descending powers; leading zeros are left out.
    covariance : array_like, shape (n + 1, n + 1), optional
        Of the coefficients; without it, that of the roots is unknown.

    Returns
    -------
    tuple of Root
        By falling magnitude, those above the real axis first.

    Notes
    -----
    To first order, the root r of p moves by ``-r^(n - i) / p'(r)`` per unit of the coefficient c_i; it has no such
    derivative where it is a double one.
    """
    p = np.atleast_1d(np.asarray(coefficients, float))
    first = int(np.argmax(np.abs(p) > ROUND_OFF * np.abs(p).max(initial=0.0)))
    p = p[first:]
    roots = np.roots(p).astype(complex)
    roots = roots[np.lexsort((-roots.imag, -np.abs(roots).round(12)))]
    unknown = np.full((2, 2), np.nan)
    if covariance is None:
        return tuple(Root(complex(root), unknown) for root in roots)
    spread = np.asarray(covariance, float)[first:, first:]
    powers = np.arange(p.size - 1, -1, -1)
    found = []
    for root in roots:
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = -(root**powers) / np.polyval(np.polyder(p), root)
        moves = np.array([slope.real, slope.imag])
        own = moves @ spread @ moves.T if np.isfinite(moves).all() else unknown
        found.append(Root(complex(root), own))
    return tuple(found)
