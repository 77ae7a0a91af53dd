"""Straight lines, parabolas and other sums of powers fitted to points: the first examples of both lectures."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, as_signals, freeze
from labsid.least_squares.solve import LeastSquares, solve_least_squares


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """A small printed table.

    Attributes
    ----------
    x, y : ndarray, shape (n,)
        First row (u in the Reading notes) and second row of the table.
    source : str
        Where the table is printed.
    """

    x: FloatArray
    y: FloatArray
    source: str

    def __post_init__(self) -> None:
        freeze(self, x=self.x, y=self.y)


EXAMPLE_2_1 = Points(np.array([1.0, 2, 4, 5, 7]), np.array([1.0, 3, 5, 7, 8]), "Reading notes, Example 2-1")
SUSTECH_POINTS = Points(
    np.array([1, 0.5, -2, 3, 2.5]), np.array([1.4, 1.2, -3.6, 6.8, 4.5]), "SUSTech lecture, Least Squares Example"
)

LINE = (1, 0)  # [x, 1]
PARABOLA = (2, 1, 0)  # [x^2, x, 1], as in the Reading notes; SUSTech's is (0, 1, 2)


def power_regressors(x: ArrayLike, powers: Sequence[int]) -> FloatArray:
    """Build the regressors ``[x^p1, x^p2, ...]``, one row per point.

    Parameters
    ----------
    x : array_like, shape (n,)
    powers : sequence of int
        Exponents in the order of the parameters; different and not negative.

    Returns
    -------
    Phi : ndarray, shape (n, len(powers))

    Raises
    ------
    ValueError
        If `powers` is empty, repeats an exponent or contains a negative one.

    Notes
    -----
    Reading notes, Examples 2-1 and 2-2; SUSTech lecture, line and quadratic fit. The model is linear in its
    *parameters*, though not in x.
    """
    x = as_signal("x", x)
    if not powers or len(set(powers)) < len(powers) or min(powers) < 0:
        raise ValueError(f"powers must be different exponents, zero or more; got {list(powers)}.")
    return x[:, np.newaxis] ** np.asarray(powers)


def fit_powers(x: ArrayLike, y: ArrayLike, powers: Sequence[int]) -> LeastSquares:
    """Fit a sum of powers of x to y.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Points; at least as many as powers.
    powers : sequence of int
        Exponents in the order of the parameters; `LINE` is ``[a, b]`` of ``a x + b``.

    Returns
    -------
    LeastSquares
        ``status`` tells whether the points determine the curve.

    Raises
    ------
    ValueError
        If the lengths differ, there are fewer points than powers, or `powers` is invalid.

    Notes
    -----
    Reading notes, Examples 2-1, 2-2 and 2-4 and the program "Least squares example" (Fig. 5); SUSTech lecture,
    line and quadratic fit.
    """
    x, y = as_signals(x=x, y=y)
    return solve_least_squares(power_regressors(x, powers), y)
