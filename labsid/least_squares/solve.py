"""Linear least squares: normal equations (8), solution by singular values, and the appendix (A1)-(A6)."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze


@dataclass(frozen=True, slots=True, eq=False)
class LeastSquares:
    """A least-squares solution and its accuracy.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        The estimate; of minimum norm if it is not unique.
    residual : ndarray, shape (n,)
        ``E = Y - Phi theta``.
    loss : float
        ``V = 1/2 E'E``.
    rank : int
        Numerical rank of Phi.
    condition_number : float
        Largest over smallest singular value of Phi; infinite if the smallest is zero.
    sigma2 : float
        Estimated variance of the equation error, ``E'E / (n - p)``; NaN for n = p.
    covariance : ndarray, shape (p, p)
        ``sigma2 (Phi'Phi)^-1``; NaN if theta is not unique.
    stderr : ndarray, shape (p,)
        Standard errors of theta: the square roots of the diagonal of `covariance`.
    status : {"unique", "rank-deficient"}
        Whether Phi has full column rank, so that theta is unique.
    """

    theta: FloatArray
    residual: FloatArray
    loss: float
    rank: int
    condition_number: float
    sigma2: float
    covariance: FloatArray
    stderr: FloatArray
    status: Literal["unique", "rank-deficient"]

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta, residual=self.residual, covariance=self.covariance, stderr=self.stderr)


def normal_equations(Phi: ArrayLike, Y: ArrayLike) -> FloatArray:
    """Solve the normal equations, eq. (8), with the inverse of Phi'Phi.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, one row per equation.
    Y : array_like, shape (n,)
        Right-hand sides.

    Returns
    -------
    theta : ndarray, shape (p,)
        ``(Phi'Phi)^-1 Phi'Y``.

    Raises
    ------
    ValueError
        If the shapes do not match, or Phi'Phi is numerically singular.

    Notes
    -----
    UNSW lab, eq. (8). For teaching: forming Phi'Phi squares the condition number and loses twice as many digits.
    `solve_least_squares` computes the same solution without it.
    """
    Phi, Y = as_equations(Phi, Y)
    try:
        if np.linalg.matrix_rank(Phi) < Phi.shape[1]:
            raise np.linalg.LinAlgError
        inverse = np.linalg.inv(Phi.T @ Phi)
    except np.linalg.LinAlgError:
        raise ValueError(
            f"Phi'Phi must have an inverse; got a Phi of {Phi.shape[1]} columns with condition number "
            f"{np.linalg.cond(Phi):.2g}, squared in Phi'Phi. Excite the system more, lower the order, or use "
            "least_squares, whose status reports it."
        ) from None
    theta: FloatArray = inverse @ Phi.T @ Y
    return theta


def solve_least_squares(Phi: ArrayLike, Y: ArrayLike) -> LeastSquares:
    """Minimise ``1/2 |Y - Phi theta|^2`` by the singular value decomposition of Phi.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, one row per equation.
    Y : array_like, shape (n,)
        Right-hand sides.

    Returns
    -------
    LeastSquares

    Raises
    ------
    ValueError
        If the shapes do not match or there are fewer rows than columns.

    Notes
    -----
    UNSW lab, eq. (8) and (A5). Singular values below ``n * eps`` times the largest count as zero.
    """
    Phi, Y = as_equations(Phi, Y)
    n, p = Phi.shape
    left, s, right = np.linalg.svd(Phi, full_matrices=False)
    rank = int(np.sum(s > max(n, p) * np.finfo(float).eps * s[0]))
    theta = right[:rank].T @ ((left[:, :rank].T @ Y) / s[:rank])
    residual = Y - Phi @ theta
    squares = float(residual @ residual)
    sigma2 = squares / (n - p) if n > p else np.nan
    covariance = np.full((p, p), np.nan)
    if rank == p:
        covariance = sigma2 * (right.T / s**2) @ right
    return LeastSquares(
        theta=theta,
        residual=residual,
        loss=squares / 2,
        rank=rank,
        condition_number=float(s[0] / s[-1]) if s[-1] > 0 else np.inf,
        sigma2=sigma2,
        covariance=covariance,
        stderr=np.sqrt(np.diag(covariance)),
        status="unique" if rank == p else "rank-deficient",
    )


def two_equations(U: ArrayLike, Y: ArrayLike) -> FloatArray:
    """Solve two equations in two unknowns with the formulas of (A2).

    Parameters
    ----------
    U : array_like, shape (2, 2)
        ``[[u11, u12], [u21, u22]]``.
    Y : array_like, shape (2,)
        ``[y1, y2]``.

    Returns
    -------
    a : ndarray, shape (2,)
        ``[a1, a2]``.

    Raises
    ------
    ValueError
        If the shapes do not match or the determinant is zero.

    Notes
    -----
    UNSW lab, eq. (A1) and (A2).
    """
    U, Y = as_equations(U, Y, "U")
    if U.shape != (2, 2):
        raise ValueError(f"U must have shape (2, 2); got {U.shape}. For more equations use least_squares.")
    (u11, u12), (u21, u22) = U
    y1, y2 = Y
    det = u11 * u22 - u12 * u21
    if abs(det) <= 4 * np.finfo(float).eps * (abs(u11 * u22) + abs(u12 * u21)):
        raise ValueError(
            "the two equations must be independent; got determinant zero. The solution is not unique or does not exist."
        )
    return np.array([(u22 * y1 - u12 * y2) / det, (u11 * y2 - u21 * y1) / det])


def loss(Phi: ArrayLike, Y: ArrayLike, theta: ArrayLike) -> float:
    """Evaluate the loss function ``V(theta) = 1/2 E'E`` with ``E = Y - Phi theta``.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors.
    Y : array_like, shape (n,)
        Right-hand sides.
    theta : array_like, shape (p,)
        Parameters.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If the shapes do not fit.

    Notes
    -----
    UNSW lab, eq. (A4) and (A5).
    """
    Phi, Y, theta = _with_theta(Phi, Y, theta)
    E = Y - Phi @ theta
    return float(E @ E) / 2


def loss_gradient(Phi: ArrayLike, Y: ArrayLike, theta: ArrayLike) -> FloatArray:
    """Differentiate the loss: ``dV/dtheta = -Phi'Y + Phi'Phi theta``, zero at the least-squares solution.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors.
    Y : array_like, shape (n,)
        Right-hand sides.
    theta : array_like, shape (p,)
        Parameters.

    Returns
    -------
    ndarray, shape (p,)

    Raises
    ------
    ValueError
        If the shapes do not fit.

    Notes
    -----
    UNSW lab, eq. (A6). Computed as ``-Phi'E``, which is equal and has smaller rounding errors.
    """
    Phi, Y, theta = _with_theta(Phi, Y, theta)
    gradient: FloatArray = -Phi.T @ (Y - Phi @ theta)
    return gradient


def as_equations(Phi: ArrayLike, Y: ArrayLike, name: str = "Phi") -> tuple[FloatArray, FloatArray]:
    """Check the matrices of a least-squares problem.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, one row per equation; at least as many rows as columns.
    Y : array_like, shape (n,)
        Right-hand sides.
    name : str
        Name of Phi, for the error message.

    Returns
    -------
    Phi : ndarray, shape (n, p)
    Y : ndarray, shape (n,)

    Raises
    ------
    ValueError
        If the shapes do not match, there are fewer rows than columns, or a value is not finite.
    """
    Y = as_signal("Y", Y)
    Phi = np.asarray(Phi, dtype=np.float64)
    if Phi.ndim != 2 or 0 in Phi.shape:
        raise ValueError(f"{name} must be a matrix with one row per equation; got shape {Phi.shape}.")
    if not np.all(np.isfinite(Phi)):
        raise ValueError(f"{name} must be finite; got NaN or infinity. Repair or cut the record there.")
    if Phi.shape[0] != Y.size:
        raise ValueError(
            f"{name} and Y must have equally many rows; got {Phi.shape[0]} and {Y.size}. "
            "Build both from the same samples."
        )
    if Phi.shape[0] < Phi.shape[1]:
        raise ValueError(
            f"{name} must have at least as many rows as unknowns ({Phi.shape[1]}); got {Phi.shape[0]}. "
            "Give more samples or lower the order."
        )
    return Phi, Y


def _with_theta(Phi: ArrayLike, Y: ArrayLike, theta: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    Phi, Y = as_equations(Phi, Y)
    theta = as_signal("theta", theta)
    if theta.size != Phi.shape[1]:
        raise ValueError(f"theta must have one entry per column of Phi ({Phi.shape[1]}); got {theta.size}.")
    return Phi, Y, theta
