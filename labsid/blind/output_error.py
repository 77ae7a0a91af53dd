"""Output-error fit of the sealed check, independent of `labsid.gap`: the error of the best linear model."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from labsid._arrays import FloatArray, freeze
from labsid._compiled import compiled


@dataclass(frozen=True, slots=True, eq=False)
class LinearFit:
    """A second-order output-error model.

    Attributes
    ----------
    a : ndarray, shape (3,)
        ``1, a1, a2``.
    b : ndarray, shape (taps,)
        ``b1, b2, ...``, coefficients of ``u(k-1), u(k-2), ...``.
    offset : float
        Constant added to the output.
    y : ndarray, shape (N,)
        Free-run output from the estimated initial state.
    rmse : float
        Root mean square error over the samples that count.
    """

    a: FloatArray
    b: FloatArray
    offset: float
    y: FloatArray
    rmse: float

    def __post_init__(self) -> None:
        freeze(self, a=self.a, b=self.b, y=self.y)


def fit_linear(
    u: FloatArray,
    y: FloatArray,
    poles: Sequence[complex],
    counts: NDArray[np.bool_] | None = None,
    taps: int = 2,
    thorough: bool = True,
) -> LinearFit:
    """Fit a second-order output-error model with offset and initial state.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    poles : sequence of complex, length 2
        Discrete-time start values.
    counts : ndarray of bool, shape (N,), optional
        Samples that count in the fit; the model is simulated over all of them.
    taps : int
        Number of numerator coefficients: 2, or 3 for a fractional delay.
    thorough : bool
        Whether to start from faster and slower poles as well.

    Returns
    -------
    LinearFit

    Notes
    -----
    For a given denominator the problem is linear least squares. scipy minimizes over the denominator alone, in
    transformed reflection coefficients, for which every finite point is stable.
    """
    u = np.ascontiguousarray(u, dtype=np.float64)
    y = np.ascontiguousarray(y, dtype=np.float64)
    weight = np.ones(y.size) if counts is None else np.asarray(counts, dtype=np.float64)
    u = u - u.mean()
    scale = float(np.std(y)) or 1.0
    target = (y - y.mean()) / scale

    def residual(theta: FloatArray) -> FloatArray:
        a1, a2 = _denominator(theta)
        return np.asarray(projected_residual(_basis(u, a1, a2, taps), target, weight))

    def search(theta: FloatArray) -> tuple[float, FloatArray]:
        fitted = least_squares(residual, theta, method="lm", x_scale="jac", ftol=1e-8, xtol=1e-8, max_nfev=60)
        return float(fitted.cost), fitted.x

    powers = (1.0, 0.5, 2.0) if thorough else (1.0,)
    starts = [_reflection([p**power for p in poles]) for power in powers]
    _, theta = min((search(start) for start in starts), key=lambda result: result[0])
    a1, a2 = _denominator(theta)
    basis = _basis(u, a1, a2, taps)
    coefficients = np.linalg.lstsq(basis * weight[:, np.newaxis], target * weight, rcond=None)[0]
    run = y.mean() + scale * (basis @ coefficients)
    b = scale * coefficients[:taps]
    used = weight > 0
    return LinearFit(
        a=np.array([1.0, a1, a2]),
        b=b,
        offset=float(y.mean() + scale * coefficients[taps]),
        y=run,
        rmse=float(np.sqrt(np.mean((y - run)[used] ** 2))),
    )


def discrete_poles(poles: FloatArray) -> list[complex]:
    """Discrete-time poles from continuous-time poles in samples.

    Parameters
    ----------
    poles : ndarray of complex

    Returns
    -------
    list of complex
    """
    return [complex(p) for p in np.exp(poles)]


def _reflection(poles: Sequence[complex]) -> FloatArray:
    a1 = -float(np.real(poles[0] + poles[1]))
    a2 = float(np.real(poles[0] * poles[1]))
    k = np.clip([a1 / (1 + a2), a2], -0.99999, 0.99999)
    return np.arctanh(k)


def _denominator(theta: FloatArray) -> tuple[float, float]:
    k1, k2 = np.tanh(np.clip(theta, -9.0, 9.0))
    return float(k1 * (1 + k2)), float(k2)


@compiled()
def _basis(u: FloatArray, a1: float, a2: float, taps: int) -> FloatArray:
    """Regressors for a given denominator: filtered inputs, a constant and two free responses."""
    n = u.size
    basis = np.zeros((n, taps + 3))
    free0, free1 = 1.0, -a1
    previous, earlier = u[0] / (1.0 + a1 + a2), u[0] / (1.0 + a1 + a2)
    for k in range(n):
        if k == 0:
            now = previous
        else:
            now = u[k - 1] - a1 * previous - a2 * earlier
            earlier, previous = previous, now
        basis[k, 0] = now
        for j in range(1, taps):
            basis[k, j] = basis[k - j, 0] if k >= j else basis[0, 0]
        basis[k, taps] = 1.0
        basis[k, taps + 1] = free0
        basis[k, taps + 2] = free1
        free0, free1 = free1, -a1 * free1 - a2 * free0
    return basis


@compiled()
def projected_residual(basis: FloatArray, y: FloatArray, weight: FloatArray) -> FloatArray:
    """Least-squares residual of the weighted y, by repeated Gram-Schmidt; shapes (N, m), (N,) and (N,)."""
    n, m = basis.shape
    q = np.empty((m, n))
    for j in range(m):
        for k in range(n):
            q[j, k] = basis[k, j] * weight[k]
        size = 0.0
        for k in range(n):
            size += q[j, k] ** 2
        for _ in range(2):
            for i in range(j):
                s = 0.0
                for k in range(n):
                    s += q[i, k] * q[j, k]
                for k in range(n):
                    q[j, k] -= s * q[i, k]
        orthogonal = 0.0
        for k in range(n):
            orthogonal += q[j, k] ** 2
        unit = 1.0 / np.sqrt(orthogonal) if orthogonal > 1e-22 * size else 0.0
        for k in range(n):
            q[j, k] *= unit
    r = y * weight
    for _ in range(2):
        for j in range(m):
            s = 0.0
            for k in range(n):
                s += q[j, k] * r[k]
            for k in range(n):
                r[k] -= s * q[j, k]
    return r
