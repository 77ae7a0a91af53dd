"""Nonlinear least squares, ``min |y - g(theta)|^2``: Gauss-Newton, and Levenberg-Marquardt, which also converges."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.least_squares.linear_algebra import singular_values

Function = Callable[[FloatArray], ArrayLike]
Status = Literal["converged", "not determined", "not converged", "diverged"]


@dataclass(frozen=True, slots=True, eq=False)
class NonlinearFit:
    """Where the iteration went and what it found.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        The best parameters met.
    residual : ndarray, shape (n,)
        ``y - g(theta)``.
    sse : float
        ``J(theta)``, the sum of squared residuals.
    path : ndarray, shape (m, p)
        Parameters from the start to the last accepted step.
    path_sse : ndarray, shape (m,)
        ``J`` along it.
    covariance : ndarray, shape (p, p)
        ``s^2 (J'J)^-1`` of the model linearised at theta, ``s^2 = sse / (n - p)``; NaN unless converged, or for n = p.
    stderr : ndarray, shape (p,)
        The roots of its diagonal.
    status : {"converged", "not determined", "not converged", "diverged"}
        "converged": the residual is orthogonal to the columns of the Jacobian, a local minimum. "not determined": it
        is, but the Jacobian lacks full column rank, so that other parameters nearby do as well. "not converged": the
        steps ran out. "diverged": a Gauss-Newton step left the range of numbers, or the last is worse than the start.
    """

    theta: FloatArray
    residual: FloatArray
    sse: float
    path: FloatArray
    path_sse: FloatArray
    covariance: FloatArray
    stderr: FloatArray
    status: Status

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta, residual=self.residual, path=self.path, path_sse=self.path_sse)
        freeze(self, covariance=self.covariance, stderr=self.stderr)


def gauss_newton(g: Function, jacobian: Function, y: ArrayLike, theta0: ArrayLike, steps: int = 50) -> NonlinearFit:
    """Linearise g at theta, solve the linear least squares for the step, take it whole, repeat.

    Parameters
    ----------
    g : callable
        Takes theta, returns what it predicts for y, shape (n,).
    jacobian : callable
        Takes theta, returns ``dg_i/dtheta_j``, shape (n, p).
    y : array_like, shape (n,)
        Measurements; n at least p.
    theta0 : array_like, shape (p,)
        Where to start.
    steps : int
        After how many to give up.

    Returns
    -------
    NonlinearFit
        Look at its status: nothing keeps a whole step from overshooting.

    Raises
    ------
    ValueError
        If the shapes do not fit, or g or its Jacobian is not finite at the start.

    Notes
    -----
    SUSTech lecture, "Nonlinear Least Squares". Fast near a minimum with small residuals; the lesson is where it
    fails and `levenberg_marquardt` does not.
    """
    y, theta, residual, J = _start(g, jacobian, y, theta0, steps)
    path, path_sse = [theta], [float(residual @ residual)]
    finite = True
    for _ in range(steps):
        if _stationary(J, residual, y):
            break
        theta = theta + np.linalg.lstsq(J, residual, rcond=None)[0]
        residual, J, finite = _linearise(g, jacobian, y, theta)
        if not finite:
            break
        path, path_sse = [*path, theta], [*path_sse, float(residual @ residual)]
    uphill = not finite or path_sse[-1] > path_sse[0]
    if not uphill and _stationary(J, residual, y):
        return _result(theta, residual, J, path, path_sse, True, "converged")
    best = path[int(np.argmin(path_sse))]
    residual, J, _ = _linearise(g, jacobian, y, best)
    return _result(best, residual, J, path, path_sse, False, "diverged" if uphill else "not converged")


def levenberg_marquardt(
    g: Function, jacobian: Function, y: ArrayLike, theta0: ArrayLike, steps: int = 500
) -> NonlinearFit:
    """Take Gauss-Newton steps, shortened until each one goes downhill.

    Parameters
    ----------
    g : callable
        Takes theta, returns what it predicts for y, shape (n,).
    jacobian : callable
        Takes theta, returns ``dg_i/dtheta_j``, shape (n, p).
    y : array_like, shape (n,)
        Measurements; n at least p.
    theta0 : array_like, shape (p,)
        Where to start.
    steps : int
        After how many trial steps to give up.

    Returns
    -------
    NonlinearFit
        A local minimum; which one depends on the start.

    Raises
    ------
    ValueError
        If the shapes do not fit, or g or its Jacobian is not finite at the start.

    Notes
    -----
    SUSTech lecture, "Nonlinear Least Squares". The step solves ``(J'J + mu D) step = J'e``, as linear least squares
    with the rows ``sqrt(mu D)`` below J, so that J'J is never formed; D holds the largest squared column lengths met
    (Marquardt's scaling: the units of theta do not matter). mu falls after a good step, by how well the linear
    model foretold the gain, and rises after a bad one (Nielsen's rule): Gauss-Newton at one end, a short step down
    the gradient at the other.
    """
    y, theta, residual, J = _start(g, jacobian, y, theta0, steps)
    sse = float(residual @ residual)
    path, path_sse = [theta], [sse]
    D = np.sum(J**2, axis=0)
    mu, growth = 1e-3, 2.0
    for _ in range(steps):
        if _stationary(J, residual, y):
            break
        D = np.maximum(D, np.sum(J**2, axis=0))
        scale = np.sqrt(np.where(D > 0, D, 1.0))  # of the columns: theta may be of any units
        rows = np.vstack([J / scale, np.sqrt(mu) * np.eye(theta.size)])
        step = np.linalg.lstsq(rows, np.append(residual, np.zeros(theta.size)), rcond=None)[0] / scale
        trial, trial_J, finite = _linearise(g, jacobian, y, theta + step)
        foretold = float((J @ step) @ (2 * residual - J @ step))
        gain = sse - float(trial @ trial) if finite else -np.inf
        # At the end the gain drowns in the rounding of the sum of squares, while the slope still tells the better.
        level = abs(gain) <= 1e-12 * sse and np.max(_slopes(trial_J, trial)) < np.max(_slopes(J, residual))
        if level or (gain > 0 and foretold > 0):
            theta, residual, J, sse = theta + step, trial, trial_J, sse - gain
            path, path_sse = [*path, theta], [*path_sse, sse]
            mu, growth = mu * (1 / 3 if level else max(1 / 3, 1 - (2 * gain / foretold - 1) ** 3)), 2.0
        elif np.all(np.abs(step) <= np.finfo(float).eps * np.abs(theta)):
            break  # theta + step is theta
        else:
            mu, growth = mu * growth, growth * 2
    return _result(theta, residual, J, path, path_sse, _stationary(J, residual, y), "not converged")


def _start(
    g: Function, jacobian: Function, y: ArrayLike, theta0: ArrayLike, steps: int
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    y, theta = as_signal("y", y), as_signal("theta0", theta0)
    if y.size < theta.size:
        raise ValueError(f"y must hold at least as many measurements as unknowns ({theta.size}); got {y.size}.")
    if steps < 1:
        raise ValueError(f"steps must be at least 1; got {steps}.")
    for name, function, shape in (("g", g, (y.size,)), ("jacobian", jacobian, (y.size, theta.size))):
        got = np.shape(function(theta))
        if got != shape:
            raise ValueError(f"{name}(theta) must have shape {shape}; got {got}.")
    residual, J, finite = _linearise(g, jacobian, y, theta)
    if not finite:
        raise ValueError(f"g and its jacobian must be finite at theta0 = {theta.tolist()}. Start elsewhere.")
    return y, theta, residual, J


def _linearise(
    g: Function, jacobian: Function, y: FloatArray, theta: FloatArray
) -> tuple[FloatArray, FloatArray, bool]:
    """Residual and Jacobian at theta, and whether they and the sum of squares are finite."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        residual = y - np.asarray(g(theta), dtype=np.float64)
        J = np.asarray(jacobian(theta), dtype=np.float64)
        return residual, J, bool(np.isfinite(residual @ residual) and np.isfinite(np.sum(J**2)))


def _stationary(J: FloatArray, residual: FloatArray, y: FloatArray) -> bool:
    """Whether the residual is orthogonal to the columns of J, as far as the rounding of y allows."""
    rounding = 64 * np.finfo(float).eps * float(np.linalg.norm(y))
    return bool(np.all(_slopes(J, residual) <= 1e-9 * np.linalg.norm(residual) + rounding))


def _slopes(J: FloatArray, residual: FloatArray) -> FloatArray:
    """Length of the residual's part along each column of J."""
    lengths = np.linalg.norm(J, axis=0)
    return np.abs(J.T @ residual) / np.where(lengths > 0, lengths, 1.0)


def _result(
    theta: FloatArray,
    residual: FloatArray,
    J: FloatArray,
    path: list[FloatArray],
    path_sse: list[float],
    settled: bool,
    otherwise: Status,
) -> NonlinearFit:
    n, p = J.shape
    sse = float(residual @ residual)
    covariance = np.full((p, p), np.nan)
    status = otherwise
    if settled:
        scale = np.linalg.norm(J, axis=0)
        parts = singular_values(
            np.divide(J, scale, out=np.zeros_like(J), where=scale > 0)
        )  # units do not decide on rank
        # theta is known to about the root of the rounding unit, and so is J.
        status = "converged" if parts.s[-1] > 1e-8 * parts.s[0] else "not determined"
        if status == "converged" and n > p:
            covariance = sse / (n - p) * ((parts.V / parts.s**2) @ parts.V.T) / np.outer(scale, scale)
    return NonlinearFit(
        theta, residual, sse, np.array(path), np.array(path_sse), covariance, np.sqrt(np.diag(covariance)), status
    )
