"""Batch identification of ARMAX models by pseudo-linear regression."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, freeze
from labsid.least_squares.solve import LeastSquares, solve_least_squares
from labsid.model_structures.prediction import prediction_errors
from labsid.model_structures.structures import PolynomialModel, Structure, build_equations, model_from_theta

Status = Literal["converged", "not converged", "not invertible", "rank-deficient"]


@dataclass(frozen=True, slots=True, eq=False)
class ArmaxFit:
    """An ARMAX model and how it was reached.

    Attributes
    ----------
    model : PolynomialModel
    e : ndarray, shape (N,)
        Prediction errors, the estimate of the noise: of `model`, or with status "not invertible" of the last model
        that has any.
    fit : LeastSquares
        The last regression. Its standard errors take the noise in the regressors for measured: see `fit_likelihood`.
    path : ndarray, shape (iterations, p)
        ``[a1, ..., b1, ..., c1, ...]`` after each regression.
    status : {"converged", "not converged", "not invertible", "rank-deficient"}
        "not invertible": C has a root outside the unit circle, so that the noise cannot be found from the data.
        "rank-deficient": the last regression has no unique solution; the model is over-parameterised.
    """

    model: PolynomialModel
    e: FloatArray
    fit: LeastSquares
    path: FloatArray
    status: Status

    def __post_init__(self) -> None:
        freeze(self, e=self.e, path=self.path)


def fit_armax(
    structure: Structure, u: ArrayLike | None, y: ArrayLike, Ts: float = 1.0, iterations: int = 200
) -> ArmaxFit:
    """Identify an ARMAX (or ARMA) model: regress, take the prediction errors for the noise, regress again.

    Parameters
    ----------
    structure : Structure
        With nc at least 1.
    u : array_like, shape (N,), or None
        Input; None for ARMA.
    y : array_like, shape (N,)
        Output.
    Ts : float
        Sampling time in seconds.
    iterations : int
        After how many regressions to give up.

    Returns
    -------
    ArmaxFit
        Converged once the regression would move no parameter by more than 1e-9.

    Raises
    ------
    ValueError
        If nc is zero or the data do not fit the structure.

    Notes
    -----
    Reading lectures, L7, over the whole record at once instead of sample by sample. It starts from the residuals of
    an AR(X) model of higher order. Where the real part of ``1 / C - 1/2`` is positive on the unit circle the steps
    point towards the solution; they are halved as often as they stop getting smaller.
    """
    if structure.nc < 1 or iterations < 1:
        raise ValueError(
            f"nc and iterations must be at least 1; got {structure.nc} and {iterations}. Without noise terms, "
            "fit_structure needs no iteration."
        )
    e = _first_noise(structure, u, y)
    path: list[FloatArray] = []
    theta, share, last = np.zeros(structure.parameters), 1.0, np.inf
    status: Status = "not converged"
    for _ in range(iterations):
        equations = build_equations(structure, u, y, e)
        fit = solve_least_squares(equations.Phi, equations.Y)
        step = fit.theta - theta
        size = float(np.max(np.abs(step)))
        # The whole step may overshoot for ever, as on System 2; a smaller share of it settles (see Notes).
        share = share / 2 if path and size > 0.9 * last else share
        last = size
        theta = theta + share * step if path else fit.theta
        path.append(theta)
        model = model_from_theta(structure, theta, Ts)
        if np.any(np.abs(np.roots(model.c)) >= 1):
            status = "not invertible"
            break
        e = prediction_errors(model, u, y)
        if fit.status == "rank-deficient":
            status = "rank-deficient"
            break
        if size <= 1e-9:
            status = "converged"
            break
    return ArmaxFit(model, e, fit, np.array(path), status)


def _first_noise(structure: Structure, u: ArrayLike | None, y: ArrayLike) -> FloatArray:
    """Residuals of an AR(X) model long enough to whiten them, as far as the record allows; zero before it starts."""
    samples = np.size(y)
    more = 2 * structure.nc + 6
    inputs = structure.nb + more if structure.nb else 0
    outputs = structure.na + more
    if samples < 4 * (inputs + outputs):
        outputs, inputs = max(structure.na, 1), structure.nb
    longer = Structure(outputs, inputs, delay=structure.delay)
    equations = build_equations(longer, u, y)
    e = np.zeros(samples)
    e[equations.start :] = solve_least_squares(equations.Phi, equations.Y).residual
    return e
