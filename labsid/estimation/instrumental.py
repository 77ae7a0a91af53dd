"""Instrumental variables: consistent where coloured noise biases least squares."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import (
    PolynomialModel,
    Structure,
    build_equations,
    fit_structure,
    model_from_theta,
)


@dataclass(frozen=True, slots=True, eq=False)
class InstrumentalSolution:
    """The solution of ``Z'Phi theta = Z'Y``.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        The estimate; NaN where ``Z'Phi`` is singular.
    residual : ndarray, shape (n,)
        ``Y - Phi theta``; orthogonal to Z, not to Phi.
    condition_number : float
        Of ``Z'Phi`` with the columns of both scaled to length one; infinite where it is singular.
    status : {"unique", "singular"}
        Whether ``Z'Phi`` has an inverse.
    """

    theta: FloatArray
    residual: FloatArray
    condition_number: float
    status: Literal["unique", "singular"]

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta, residual=self.residual)


@dataclass(frozen=True, slots=True, eq=False)
class InstrumentalFit:
    """An ARX model by instrumental variables and how it was reached.

    Attributes
    ----------
    model : PolynomialModel
        The last one with finite parameters.
    y_model : ndarray, shape (N,)
        Noise-free output of the model before, which made the last instruments.
    solution : InstrumentalSolution
        The last one.
    path : ndarray, shape (iterations + 1, p)
        ``[a1, ..., b1, ...]``: least squares, then after each iteration.
    status : {"converged", "not converged", "unstable", "singular"}
        "unstable": a model on the way has a pole outside the unit circle, so that its output is no instrument.
        "singular": ``Z'Phi`` has no inverse.
    """

    model: PolynomialModel
    y_model: FloatArray
    solution: InstrumentalSolution
    path: FloatArray
    status: Literal["converged", "not converged", "unstable", "singular"]

    def __post_init__(self) -> None:
        freeze(self, y_model=self.y_model, path=self.path)


def instrumental_variables(Z: ArrayLike, Phi: ArrayLike, Y: ArrayLike) -> InstrumentalSolution:
    """Solve ``Z'Phi theta = Z'Y``; with ``Z = Phi`` that is least squares.

    Parameters
    ----------
    Z : array_like, shape (n, p)
        Instruments: correlated with the regressors, not with the noise, whose mean is zero.
    Phi : array_like, shape (n, p)
        Regressors.
    Y : array_like, shape (n,)
        Right-hand sides.

    Returns
    -------
    InstrumentalSolution

    Raises
    ------
    ValueError
        If the shapes do not fit or a number is not finite.

    Notes
    -----
    Reading lectures, L8. Errata: the printed sum holds ``z'(t) y(t)`` for ``z(t) y(t)``; and the estimate is
    consistent, not unbiased. A singular value of the scaled ``Z'Phi`` below ``n * eps`` counts as zero.
    """
    Y = as_signal("Y", Y)
    Z, Phi = np.asarray(Z, dtype=np.float64), np.asarray(Phi, dtype=np.float64)
    if Phi.ndim != 2 or 0 in Phi.shape or Z.shape != Phi.shape or Phi.shape[0] != Y.size:
        raise ValueError(
            f"Z and Phi must have equal shapes, with one row an entry of Y; got {Z.shape}, {Phi.shape} and {Y.size}."
        )
    if not (np.all(np.isfinite(Z)) and np.all(np.isfinite(Phi))):
        raise ValueError("Z and Phi must be finite; got NaN or infinity. Repair or cut the record there.")
    z_length, phi_length = (np.linalg.norm(X, axis=0) for X in (Z, Phi))
    scaled_Z = Z / np.where(z_length > 0, z_length, 1)
    scaled_Phi = Phi / np.where(phi_length > 0, phi_length, 1)
    M = scaled_Z.T @ scaled_Phi
    s = np.linalg.svd(M, compute_uv=False)
    if s[-1] <= Y.size * np.finfo(float).eps:
        nothing = np.full(Phi.shape[1], np.nan)
        return InstrumentalSolution(nothing, np.full(Y.size, np.nan), np.inf, "singular")
    theta = np.linalg.solve(M, scaled_Z.T @ Y) / phi_length
    return InstrumentalSolution(theta, Y - Phi @ theta, float(s[0] / s[-1]), "unique")


def fit_instrumental(
    structure: Structure, u: ArrayLike, y: ArrayLike, Ts: float = 1.0, iterations: int = 50
) -> InstrumentalFit:
    """Identify an ARX model with the noise-free output of the model itself as instrument, over and over.

    Parameters
    ----------
    structure : Structure
        With past outputs and inputs, and nc = 0.
    u, y : array_like, shape (N,)
        Input and output.
    Ts : float
        Sampling time in seconds.
    iterations : int
        After how many solutions to give up.

    Returns
    -------
    InstrumentalFit
        Converged once no parameter moves by more than 1e-9.

    Raises
    ------
    ValueError
        If the structure does not suit, or the data do not fit it.

    Notes
    -----
    Reading lectures, L8, "Choice of the instrumental variable". The first instruments come from the least-squares
    estimates: biased, but their output is computed from u alone, so it does not contain the noise. The estimate is
    consistent only for noise of mean zero: subtract the means of u and y first.
    """
    if structure.na < 1 or structure.nb < 1 or structure.nc or iterations < 1:
        raise ValueError(
            "structure must be ARX, with past outputs and inputs, and iterations at least 1; got "
            f"{structure} and {iterations}."
        )
    first = fit_structure(structure, u, y, Ts)
    model, Phi, Y = first.model, first.regression.Phi, first.regression.Y
    path: list[FloatArray] = [model.theta]
    y_model, solution = np.zeros(np.size(y)), InstrumentalSolution(model.theta, first.fit.residual, np.inf, "singular")
    status: Literal["converged", "not converged", "unstable", "singular"] = "not converged"
    for _ in range(iterations):
        if np.any(np.abs(np.roots(model.a)) >= 1):
            status = "unstable"
            break
        y_model = free_run(model, u)
        solution = instrumental_variables(build_equations(structure, u, y_model).Phi, Phi, Y)
        path.append(solution.theta)
        if solution.status == "singular":
            status = "singular"
            break
        model = model_from_theta(structure, solution.theta, Ts)
        if np.max(np.abs(path[-1] - path[-2])) <= 1e-9:
            status = "converged"
            break
    return InstrumentalFit(model, y_model, solution, np.array(path), status)
