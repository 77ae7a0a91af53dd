"""Maximum likelihood for Gaussian noise: the parameters under which the record is most probable."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize
from scipy.signal import lfilter

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.estimation.armax import fit_armax
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.prediction import prediction_errors
from labsid.model_structures.structures import PolynomialModel, Structure, build_equations, model_from_theta
from labsid.nonlinear.solve import levenberg_marquardt


@dataclass(frozen=True, slots=True, eq=False)
class Likelihood:
    """Parameters of a linear regression with Gaussian noise, found by climbing the likelihood.

    Attributes
    ----------
    theta : ndarray, shape (p,)
    sigma2 : float
        Variance of the noise: ``E'E / n``, smaller than the unbiased estimate by the factor ``(n - p) / n``.
    log_likelihood : float
        At the maximum.
    status : str
        "converged", or what the optimiser said.
    """

    theta: FloatArray
    sigma2: float
    log_likelihood: float
    status: str

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta)


@dataclass(frozen=True, slots=True, eq=False)
class LikelihoodFit:
    """A model of maximum likelihood.

    Attributes
    ----------
    model : PolynomialModel
    e : ndarray, shape (N,)
        Prediction errors.
    sigma2 : float
        Variance of the noise, the mean of the squared prediction errors.
    log_likelihood : float
    stderr : ndarray, shape (p,)
        Standard errors of ``[a1, ..., b1, ..., c1, ...]`` for a long record; NaN unless converged.
    status : {"converged", "not determined", "not converged", "diverged"}
        As in `NonlinearFit`. "not determined": the model is over-parameterised.
    """

    model: PolynomialModel
    e: FloatArray
    sigma2: float
    log_likelihood: float
    stderr: FloatArray
    status: str

    def __post_init__(self) -> None:
        freeze(self, e=self.e, stderr=self.stderr)


def log_likelihood(e: ArrayLike, sigma2: float) -> float:
    """Evaluate ``log L = -N/2 log(2 pi sigma^2) - sum e^2 / (2 sigma^2)``.

    Parameters
    ----------
    e : array_like, shape (N,)
        Errors, independent and Gaussian with zero mean.
    sigma2 : float
        Their variance.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If the variance is not positive.

    Notes
    -----
    Reading lectures, L8, "Maximum likelihood estimation". Errata: the printed density has ``1 / sqrt(2 pi sigma)`` for
    ``1 / (sqrt(2 pi) sigma)``.
    """
    e = as_signal("e", e)
    if not (sigma2 > 0 and np.isfinite(sigma2)):
        raise ValueError(f"sigma2 must be a positive variance; got {sigma2}.")
    return float(-e.size / 2 * np.log(2 * np.pi * sigma2) - e @ e / (2 * sigma2))


def maximise_likelihood(Phi: ArrayLike, Y: ArrayLike) -> Likelihood:
    """Climb the likelihood of ``Y = Phi theta + e`` without using that the top is the least-squares solution.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, of full column rank.
    Y : array_like, shape (n,)
        Outputs.

    Returns
    -------
    Likelihood

    Raises
    ------
    ValueError
        If the shapes do not fit, Phi lacks full column rank, or Phi explains Y without error: the likelihood then has
        no maximum.

    Notes
    -----
    Reading lectures, L8: numerically, what the lecture proves. The climb (BFGS) is over theta and ``log sigma`` at
    once, with the columns of Phi and Y scaled to mean square one.
    """
    exact = solve_least_squares(Phi, Y)
    Phi, Y = np.asarray(Phi, dtype=np.float64), as_signal("Y", Y)
    n, p = Phi.shape
    if exact.status != "unique" or 2 * exact.loss <= (n * np.finfo(float).eps) ** 2 * (Y @ Y):
        raise ValueError(
            "the likelihood must have one maximum; got a Phi that lacks full column rank or explains Y without error."
        )
    column, height = np.sqrt(np.mean(Phi**2, axis=0)), np.sqrt(np.mean(Y**2))
    X, t = Phi / column, Y / height

    def height_and_slope(parameters: FloatArray) -> tuple[float, FloatArray]:
        e = t - X @ parameters[:p]
        variance = float(np.exp(2 * parameters[p]))
        slope = np.append(X.T @ e / variance, e @ e / variance - n)
        return -log_likelihood(e, variance) / n, -slope / n

    optimum = minimize(height_and_slope, np.zeros(p + 1), jac=True, method="BFGS", options={"gtol": 1e-10})
    # Near the top the gain is lost in rounding before the slope is: BFGS then reports that it can climb no further.
    slope = float(np.max(np.abs(optimum.jac)))
    theta, sigma2 = optimum.x[:p] * height / column, float(np.exp(2 * optimum.x[p])) * height**2
    status = "converged" if slope < 1e-7 else str(optimum.message)
    return Likelihood(theta, sigma2, log_likelihood(Y - Phi @ theta, sigma2), status)


def fit_likelihood(structure: Structure, u: ArrayLike | None, y: ArrayLike, Ts: float = 1.0) -> LikelihoodFit:
    """Identify an ARX, ARMAX or ARMA model by maximum likelihood: the least sum of squared prediction errors.

    Parameters
    ----------
    structure : Structure
    u : array_like, shape (N,), or None
        Input; None without one.
    y : array_like, shape (N,)
        Output.
    Ts : float
        Sampling time in seconds.

    Returns
    -------
    LikelihoodFit

    Raises
    ------
    ValueError
        If the data do not fit the structure.

    Notes
    -----
    Reading lectures, L8. For Gaussian noise ``log L`` is largest where ``sum epsilon^2`` is least; with nc = 0 that is
    least squares. Otherwise epsilon depends on theta through the filter 1/C, and its derivatives are the regressor
    passed through it, ``psi = phi / C``. The start is pseudo-linear regression where that gives an invertible C, and
    C = 1 elsewhere; lags before sample 0 are zero.
    """
    y = as_signal("y", y)

    def predicted(theta: FloatArray) -> FloatArray:
        model = model_from_theta(structure, theta)
        if np.any(np.abs(np.roots(model.c)) >= 1):
            return np.full(y.size, np.inf)
        return y - prediction_errors(model, u, y)

    def sensitivities(theta: FloatArray) -> FloatArray:
        model = model_from_theta(structure, theta)
        if np.any(np.abs(np.roots(model.c)) >= 1):
            return np.full((y.size, theta.size), np.inf)
        e = prediction_errors(model, u, y)
        Phi = build_equations(structure, u, y, e, start=0).Phi
        psi: FloatArray = lfilter([1.0], model.c, Phi, axis=0)
        return psi

    fitted = levenberg_marquardt(predicted, sensitivities, y, _first_guess(structure, u, y))
    model = model_from_theta(structure, fitted.theta, Ts)
    sigma2 = fitted.sse / y.size
    height = log_likelihood(fitted.residual, sigma2) if sigma2 > 0 else np.inf
    return LikelihoodFit(model, fitted.residual, sigma2, height, fitted.stderr, fitted.status)


def _first_guess(structure: Structure, u: ArrayLike | None, y: FloatArray) -> FloatArray:
    if structure.nc:
        pseudo_linear = fit_armax(structure, u, y)
        if pseudo_linear.status != "not invertible":
            return pseudo_linear.model.theta
    theta = np.zeros(structure.parameters)
    linear = Structure(structure.na, structure.nb, delay=structure.delay) if structure.na + structure.nb else None
    if linear is not None:
        equations = build_equations(linear, u, y)
        theta[: linear.parameters] = solve_least_squares(equations.Phi, equations.Y).theta
    return theta
