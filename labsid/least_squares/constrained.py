"""Constrained least squares: known parameters, linear equations, bounds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import lsq_linear

from labsid._arrays import FloatArray, as_matrix, as_signal, freeze
from labsid.least_squares.linear_algebra import singular_values
from labsid.least_squares.solve import LeastSquares, as_equations, solve_least_squares


@dataclass(frozen=True, slots=True, eq=False)
class KnownParametersFit:
    """A regression with some known parameters.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        All parameters, known and estimated.
    free : tuple of int
        Indices of the estimated parameters.
    fit : LeastSquares
        The regression of ``Y`` minus the known part on the columns `free`.
    """

    theta: FloatArray
    free: tuple[int, ...]
    fit: LeastSquares

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta)


@dataclass(frozen=True, slots=True, eq=False)
class ConstrainedFit:
    """A constrained least-squares solution.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        The estimate; with equations that leave it not unique, the one of minimum norm.
    residual : ndarray, shape (n,)
        ``Y - Phi theta``. Not orthogonal to Phi if a constraint is active.
    loss : float
        ``V = 1/2 E'E``, never below the unconstrained minimum.
    multipliers : ndarray, shape (r,) or (p,)
        Lagrange multipliers. For equations ``dV/db``, one per equation. For bounds ``dV/dtheta``, one per
        parameter: zero off the bounds, positive at a lower bound, negative at an upper one.
    active : tuple of int
        Indices of the active constraints: all equations, or the parameters that lie on a bound.
    status : {"unique", "not unique"}
        Whether the data and the constraints determine theta.
    """

    theta: FloatArray
    residual: FloatArray
    loss: float
    multipliers: FloatArray
    active: tuple[int, ...]
    status: Literal["unique", "not unique"]

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta, residual=self.residual, multipliers=self.multipliers)


def fit_with_known(Phi: ArrayLike, Y: ArrayLike, known: Mapping[int, float]) -> KnownParametersFit:
    """Estimate the unknown parameters of a regression when the others are known.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors of all parameters; at least as many rows as unknown parameters.
    Y : array_like, shape (n,)
        Right-hand sides.
    known : mapping of int to float
        Index in theta (zero-based) and value of each known parameter. At least one must remain unknown.

    Returns
    -------
    KnownParametersFit

    Raises
    ------
    ValueError
        If the shapes do not match, an index is out of range, a value is not finite, or no parameter is unknown.

    Notes
    -----
    SUSTech lecture, system id example 1: ``y(k) + a y(k-2) = u(k-1) + b u(k-3)`` has the known coefficient 1
    at u(k-1), so that ``y(k) - u(k-1)`` is regressed on ``[-y(k-2), u(k-3)]``. Errata: printed with an
    additional middle column, and the last row as ``y(20) - u(17)``.
    """
    Phi, Y = _rows(Phi, Y)
    p = Phi.shape[1]
    outside = [place for place in known if not 0 <= place < p]
    if outside:
        raise ValueError(f"known must name places 0 to {p - 1} of theta; got {outside[0]}.")
    free = tuple(place for place in range(p) if place not in known)
    if not free:
        raise ValueError(f"known must leave a parameter to estimate; got all {p} of them.")
    theta = np.zeros(p)
    for place, value in known.items():
        if not np.isfinite(value):
            raise ValueError(f"known values must be finite; got {value} for place {place}.")
        theta[place] = value
    fit = solve_least_squares(Phi[:, free], Y - Phi @ theta)
    theta[list(free)] = fit.theta
    return KnownParametersFit(theta, free, fit)


def least_squares_with_equations(Phi: ArrayLike, Y: ArrayLike, A: ArrayLike, b: ArrayLike) -> ConstrainedFit:
    """Minimise ``1/2 |Y - Phi theta|^2`` over the set ``A theta = b``.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        At least p - r rows.
    Y : array_like, shape (n,)
    A : array_like, shape (r, p)
        Constraints, one row per equation; full row rank, r at most p.
    b : array_like, shape (r,)

    Returns
    -------
    ConstrainedFit

    Raises
    ------
    ValueError
        If the shapes do not match or the rows of A are linearly dependent.

    Notes
    -----
    SUSTech lecture, "Problem Statement", for a constraint set that is a plane. Every theta of the set is
    ``theta0 + Z w`` with A theta0 = b and A Z = 0: ordinary least squares in w. The multipliers m solve
    ``Phi'(Phi theta - Y) = A'm``. A known static gain is such a set: for the lab's theta,
    ``b1 + b2 + gain (-a1 - a2) = gain``.
    """
    Phi, Y = _rows(Phi, Y)
    A, b = as_matrix("A", A), as_signal("b", b)
    p = Phi.shape[1]
    if A.shape[1] != p or A.shape[0] != b.size:
        raise ValueError(
            f"A must have {p} columns, as Phi, and as many rows as b has entries; got {A.shape} and {b.size}."
        )
    parts = singular_values(A)
    if parts.rank < A.shape[0]:
        raise ValueError(
            f"the rows of A must be independent; got rank {parts.rank} of {A.shape[0]} rows. Drop the constraints "
            "that follow from the others or contradict them."
        )
    theta = parts.V @ ((parts.U.T @ b) / parts.s)
    status: Literal["unique", "not unique"] = "unique"
    Z = np.linalg.svd(A)[2][A.shape[0] :].T
    if Z.shape[1]:
        fit = solve_least_squares(Phi @ Z, Y - Phi @ theta)
        theta = theta + Z @ fit.theta
        status = "unique" if fit.status == "unique" else "not unique"
    residual = Y - Phi @ theta
    multipliers = parts.U @ ((parts.V.T @ (-Phi.T @ residual)) / parts.s)
    return ConstrainedFit(
        theta, residual, float(residual @ residual) / 2, multipliers, tuple(range(A.shape[0])), status
    )


def least_squares_in_box(Phi: ArrayLike, Y: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> ConstrainedFit:
    """Minimise ``1/2 |Y - Phi theta|^2`` over the box ``lower <= theta <= upper``.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
    Y : array_like, shape (n,)
    lower, upper : array_like, shape (p,)
        Bounds; infinite for none.

    Returns
    -------
    ConstrainedFit

    Raises
    ------
    ValueError
        If the shapes do not match or a lower bound is not below its upper bound.

    Notes
    -----
    SUSTech lecture, "Problem Statement", for a set of feasible parameters such as positive ones. Clipping the
    unconstrained solution is *not* equivalent: the other parameters change, too. Solved by scipy's bounded-variable
    least squares, an active-set method. For a known parameter use `fit_with_known`.
    """
    Phi, Y = as_equations(Phi, Y)
    p = Phi.shape[1]
    lower, upper = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
    if lower.shape != (p,) or upper.shape != (p,):
        raise ValueError(
            f"lower and upper must have one entry per parameter ({p}); got shapes {lower.shape} and {upper.shape}."
        )
    if not np.all(lower < upper):
        where = int(np.flatnonzero(~(lower < upper))[0])
        raise ValueError(
            f"lower must be below upper; got {lower[where]} and {upper[where]} for parameter {where}. "
            "For a known parameter use fit_with_known."
        )
    unconstrained = solve_least_squares(Phi, Y).theta
    if np.all((lower <= unconstrained) & (unconstrained <= upper)):
        theta = unconstrained
    else:
        theta = lsq_linear(Phi, Y, (lower, upper), method="bvls").x
    residual = Y - Phi @ theta
    on_bound = (theta <= lower) | (theta >= upper)
    multipliers = np.where(on_bound, -Phi.T @ residual, 0.0)
    moving = Phi[:, ~on_bound]
    determined = not moving.size or singular_values(moving).rank == moving.shape[1]
    return ConstrainedFit(
        theta,
        residual,
        float(residual @ residual) / 2,
        multipliers,
        tuple(int(place) for place in np.flatnonzero(on_bound)),
        "unique" if determined else "not unique",
    )


def _rows(Phi: ArrayLike, Y: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Check Phi and Y as `as_equations` does, except for the number of rows."""
    Phi, Y = as_matrix("Phi", Phi), as_signal("Y", Y)
    if Phi.shape[0] != Y.size:
        raise ValueError(
            f"Phi and Y must have equally many rows; got {Phi.shape[0]} and {Y.size}. Build both from the same samples."
        )
    return Phi, Y
