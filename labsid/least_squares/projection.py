"""The geometry of least squares: QR, the projection onto the columns of Phi, and all solutions."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_matrix, as_signal, freeze
from labsid.least_squares.linear_algebra import singular_values
from labsid.least_squares.solve import as_equations, solve_least_squares


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """Orthogonal decomposition of Y into a part in the column space of Phi and a residual.

    Attributes
    ----------
    Y_hat : ndarray, shape (n,)
        ``P Y = Phi theta``, the point of the column space that is nearest to Y.
    residual : ndarray, shape (n,)
        ``Y - Y_hat``, orthogonal to every column of Phi.
    angle : float
        Angle between Y and its projection in radians, 0 (Y lies in the column space) to pi/2.
    """

    Y_hat: FloatArray
    residual: FloatArray
    angle: float

    def __post_init__(self) -> None:
        freeze(self, Y_hat=self.Y_hat, residual=self.residual)


@dataclass(frozen=True, slots=True, eq=False)
class SolutionSet:
    """All solutions of the normal equations: ``theta + directions @ alpha`` for any alpha.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        The solution of minimum norm.
    directions : ndarray, shape (p, p - rank)
        Orthonormal basis of the null space of Phi; no columns if the solution is unique.
    rank : int
        Numerical rank of Phi.
    """

    theta: FloatArray
    directions: FloatArray
    rank: int

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta, directions=self.directions)


def qr_solution(Phi: ArrayLike, Y: ArrayLike) -> FloatArray:
    """Solve least squares by ``Phi = Q R`` and back substitution in ``R theta = Q'Y``.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, of full column rank.
    Y : array_like, shape (n,)
        Right-hand sides.

    Returns
    -------
    theta : ndarray, shape (p,)

    Raises
    ------
    ValueError
        If the shapes do not match or Phi lacks full column rank.

    Notes
    -----
    The normal equations become ``R'R theta = R'Q'Y``; cancelling R' avoids the squared condition number of eq. (8).
    """
    Phi, Y = as_equations(Phi, Y)
    rank, p = singular_values(Phi).rank, Phi.shape[1]
    if rank < p:
        raise ValueError(
            f"Phi must have full column rank for a unique solution; got rank {rank} of {p} columns. "
            "Use least_squares (minimum norm) or solution_set (all solutions)."
        )
    Q, R = np.linalg.qr(Phi)
    theta = Q.T @ Y
    for i in range(p - 1, -1, -1):
        theta[i] = (theta[i] - R[i, i + 1 :] @ theta[i + 1 :]) / R[i, i]
    return theta


def projection_matrix(Phi: ArrayLike) -> FloatArray:
    """Build the matrix that projects onto the columns of Phi: ``P = Phi (Phi'Phi)^-1 Phi'``.

    Parameters
    ----------
    Phi : array_like, shape (n, p)

    Returns
    -------
    P : ndarray, shape (n, n)
        Symmetric, ``P P = P``, trace equal to the rank of Phi; ``I - P`` gives the residual.

    Raises
    ------
    ValueError
        If Phi is not a finite matrix.

    Notes
    -----
    SUSTech lecture, "Geometric interpretation". Computed as ``U U'`` from the singular value decomposition, which
    does not require full column rank. `project` computes ``P Y`` without the n by n matrix.
    """
    parts = singular_values(as_matrix("Phi", Phi))
    U = parts.U[:, : parts.rank]
    P: FloatArray = U @ U.T
    return P


def project(Phi: ArrayLike, Y: ArrayLike) -> Projection:
    """Project Y onto the columns of Phi.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
    Y : array_like, shape (n,)

    Returns
    -------
    Projection

    Raises
    ------
    ValueError
        If the shapes do not fit.

    Notes
    -----
    SUSTech lecture, "Geometric interpretation": ``Phi theta`` is the projection, ``(Y - Phi theta)'Phi = 0``.
    """
    Phi, Y = as_equations(Phi, Y)
    fit = solve_least_squares(Phi, Y)
    Y_hat = Phi @ fit.theta
    angle = np.arctan2(np.linalg.norm(fit.residual), np.linalg.norm(Y_hat))
    return Projection(Y_hat, fit.residual, float(angle))


def solution_set(Phi: ArrayLike, Y: ArrayLike) -> SolutionSet:
    """Find all least-squares solutions: one, or infinitely many if the columns of Phi are linearly dependent.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
    Y : array_like, shape (n,)

    Returns
    -------
    SolutionSet

    Raises
    ------
    ValueError
        If the shapes do not match or there are fewer rows than columns.

    Notes
    -----
    SUSTech lecture, "Solution", case 2: ``[[1, 2], [2, 4]] theta = [4, 8]`` has ``[4, 0] + alpha [-2, 1]``.
    """
    Phi, Y = as_equations(Phi, Y)
    fit = solve_least_squares(Phi, Y)
    return SolutionSet(fit.theta, singular_values(Phi).V[:, fit.rank :], fit.rank)


def completed_square(Phi: ArrayLike, Y: ArrayLike, theta: ArrayLike) -> tuple[float, float]:
    """Split the sum of squared errors at theta into its minimum and the excess over it.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
    Y : array_like, shape (n,)
    theta : array_like, shape (p,)
        Parameters.

    Returns
    -------
    minimum : float
        ``Y'Y - Y'Phi (Phi'Phi)^-1 Phi'Y``, the same for every theta.
    excess : float
        ``x'Phi'Phi x`` with ``x = theta - (Phi'Phi)^-1 Phi'Y``: zero at the solution, never negative.

    Raises
    ------
    ValueError
        If the shapes do not fit.

    Notes
    -----
    Reading notes, lecture 2, "Derivation of the least squares algorithm", last line.
    """
    Phi, Y = as_equations(Phi, Y)
    theta = as_signal("theta", theta)
    if theta.size != Phi.shape[1]:
        raise ValueError(f"theta must have one entry per column of Phi ({Phi.shape[1]}); got {theta.size}.")
    fit = solve_least_squares(Phi, Y)
    away = Phi @ (theta - fit.theta)
    return 2 * fit.loss, float(away @ away)
