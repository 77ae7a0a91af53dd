"""Quadratic forms x'Mx: definiteness, and the surfaces of Figs. 3 and 4."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_square, freeze, frozen_array
from labsid.least_squares.linear_algebra import symmetric_and_skew

Kind = Literal[
    "positive definite", "positive semidefinite", "negative definite", "negative semidefinite", "indefinite", "zero"
]

# The matrices of the second MATLAB program.
BOWL = frozen_array([[0.32, -0.11], [-0.11, 0.52]])
SADDLE = frozen_array([[-0.072, 1.373], [0.28, 0.18]])


@dataclass(frozen=True, slots=True, eq=False)
class Definiteness:
    """Definiteness of ``x'Mx``, from the eigenvalues of the symmetric part of M.

    Attributes
    ----------
    kind : str
        "positive definite" (bowl), "negative definite" (hill), "positive semidefinite" or "negative semidefinite"
        (a trough: zero along some x), "indefinite" (saddle), or "zero".
    eigenvalues : ndarray, shape (n,)
        Of ``(M + M')/2``, in ascending order; the first and last are the extremes of the form on the unit sphere.
    """

    kind: Kind
    eigenvalues: FloatArray

    def __post_init__(self) -> None:
        freeze(self, eigenvalues=self.eigenvalues)


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """The surface ``f = x'Mx`` over a disc.

    Attributes
    ----------
    x1, x2, f : ndarray, shape (rings + 1, 2 * rings + 1)
        Points of a polar grid, and the values of the form.
    definiteness : Definiteness
    """

    x1: FloatArray
    x2: FloatArray
    f: FloatArray
    definiteness: Definiteness

    def __post_init__(self) -> None:
        freeze(self, x1=self.x1, x2=self.x2, f=self.f)


def evaluate_quadratic_form(M: ArrayLike, x: ArrayLike) -> FloatArray:
    """Evaluate ``x'Mx`` at one or more points.

    Parameters
    ----------
    M : array_like, shape (n, n)
    x : array_like, shape (..., n)

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    ValueError
        If M is not square or the size of x differs.

    Notes
    -----
    Reading notes, lecture 2.
    """
    M = as_square("M", M)
    x = np.asarray(x, dtype=np.float64)
    if x.ndim == 0 or x.shape[-1] != M.shape[0]:
        raise ValueError(f"x must have {M.shape[0]} entries per point, as M has rows; got shape {x.shape}.")
    form: FloatArray = np.einsum("...i,ij,...j->...", x, M, x)
    return form


def definiteness(M: ArrayLike) -> Definiteness:
    """Classify a matrix by the definiteness of its quadratic form.

    Parameters
    ----------
    M : array_like, shape (n, n)
        Need not be symmetric; the skew-symmetric part does not contribute to ``x'Mx``.

    Returns
    -------
    Definiteness
        Eigenvalues within ``n * eps`` of the largest magnitude count as zero.

    Raises
    ------
    ValueError
        If M is not a finite square matrix.

    Notes
    -----
    Reading notes, lecture 2. Errata: ``phi'phi`` is printed as positive definite; it is positive semidefinite,
    and definite if and only if phi has full column rank (``phi x = 0`` only for x = 0).
    """
    symmetric, _ = symmetric_and_skew(as_square("M", M))
    eigenvalues = np.linalg.eigvalsh(symmetric).astype(np.float64)
    zero = eigenvalues.size * np.finfo(float).eps * np.max(np.abs(eigenvalues))
    above, below = bool(np.any(eigenvalues > zero)), bool(np.any(eigenvalues < -zero))
    flat = bool(np.any(np.abs(eigenvalues) <= zero))
    kind: Kind
    if above and below:
        kind = "indefinite"
    elif above:
        kind = "positive semidefinite" if flat else "positive definite"
    elif below:
        kind = "negative semidefinite" if flat else "negative definite"
    else:
        kind = "zero"
    return Definiteness(kind, eigenvalues)


def surface(M: ArrayLike, radius: float = 1.0, rings: int = 20) -> Surface:
    """Evaluate ``x'Mx`` on a polar grid, as the second MATLAB program does.

    Parameters
    ----------
    M : array_like, shape (2, 2)
    radius : float
        Radius of the disc.
    rings : int
        Rings of the grid.

    Returns
    -------
    Surface

    Raises
    ------
    ValueError
        If M is not 2 by 2, or `radius` or `rings` is not positive.

    Notes
    -----
    Reading notes, Figs. 3 and 4, and the program "Positive definite example" (``cplxgrid(20)`` and ``surfc``).
    """
    M = as_square("M", M)
    if M.shape != (2, 2):
        raise ValueError(f"M must have shape (2, 2) for a surface over the plane; got {M.shape}.")
    if not radius > 0 or rings < 1:
        raise ValueError(f"radius must be positive and rings at least 1; got {radius} and {rings}.")
    r = radius * np.arange(rings + 1)[:, np.newaxis] / rings
    angle = np.pi * np.arange(-rings, rings + 1) / rings
    x1, x2 = r * np.cos(angle), r * np.sin(angle)
    return Surface(x1, x2, evaluate_quadratic_form(M, np.stack([x1, x2], axis=-1)), definiteness(M))


def random_positive_definite(rng: np.random.Generator, n: int = 2) -> FloatArray:
    """Draw a matrix ``M M'``, positive definite with probability one.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of M, whose entries are standard normal.
    n : int
        Rows and columns.

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    ValueError
        If `n` is below 1.

    Notes
    -----
    Reading notes, the program "Positive definite example", choice "rand pd".
    """
    if n < 1:
        raise ValueError(f"n must be at least 1; got {n}.")
    M = rng.standard_normal((n, n))
    return M @ M.T
