"""Least squares for the difference equation of one output, with one input or several."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid.lab.regressor import build_phi
from labsid.least_squares.solve import LeastSquares, solve_least_squares
from labsid.model_structures.structures import Regression


@dataclass(frozen=True, slots=True, eq=False)
class Equation:
    """The regression of one output and its least-squares solution.

    Attributes
    ----------
    regression : Regression
    fit : LeastSquares
    """

    regression: Regression
    fit: LeastSquares


def fit_equation(
    u: ArrayLike,
    y: ArrayLike,
    order: int = 2,
    start: int | None = None,
    stop: int | None = None,
    measured: NDArray[np.bool_] | None = None,
) -> Equation:
    """Fit ``y(k) = phi'(k) theta`` to offset-free data.

    Parameters
    ----------
    u : array_like, shape (N,) or (N, nu)
        Offset-free inputs.
    y : array_like, shape (N,)
        Offset-free output.
    order : int
        Order of the equation.
    start, stop : int, optional
        Rows to use; see `build_phi`.
    measured : ndarray of bool, shape (N,), optional
        Samples that were measured; rows of Phi with another one are left out. Default: all.

    Returns
    -------
    Equation
        ``fit.status`` tells whether the parameters are unique.

    Raises
    ------
    ValueError
        As `build_phi`, or if too few rows are complete.

    Notes
    -----
    UNSW lab, exercise 2a and 2b.
    """
    regression = build_phi(u, y, order, start, stop)
    if measured is not None and not measured.all():
        regression = _complete_rows(regression, measured)
    return Equation(regression, solve_least_squares(regression.Phi, regression.Y))


def _complete_rows(regression: Regression, measured: NDArray[np.bool_]) -> Regression:
    """Only the rows whose outputs were all measured."""
    order = regression.order
    complete = np.concatenate([np.ones(order, bool), measured])
    complete = np.all([complete[order - lag : order - lag + measured.size] for lag in range(order + 1)], axis=0)
    rows = complete[regression.start : regression.stop]
    if rows.sum() < regression.Phi.shape[1]:
        raise ValueError(
            f"of {rows.size} rows of Phi only {rows.sum()} have all their outputs, too few for the "
            f"{regression.Phi.shape[1]} unknowns of order {order}. Read the log at the sampling time of its output "
            "(--resample), or lower the order."
        )
    return replace(regression, Phi=regression.Phi[rows], Y=regression.Y[rows])
