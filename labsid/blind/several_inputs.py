"""Best linear model of one output and several inputs, independent of `labsid.gap`: an output-error fit."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.blind.output_error import projected_residual

_EXACT = 1e-6
"""Error over the standard deviation of the output below which a model counts as exact."""

_LARGEST = 9.0
"""Largest value of the inverse hyperbolic tangent of a reflection coefficient."""


def linear_error(
    u: FloatArray, y: FloatArray, poles: Sequence[complex], delay: int = 0, thorough: bool = True
) -> float:
    """Rms error of the best output-error model with a common denominator, offset and initial state.

    Parameters
    ----------
    u : ndarray, shape (N, nu)
    y : ndarray, shape (N,)
    poles : sequence of complex
        Discrete-time start values; their number is the order.
    delay : int
        Further delay of all inputs in samples, for which the model has numerator coefficients as well.
    thorough : bool
        Whether to start from faster and slower poles as well.

    Returns
    -------
    float

    Notes
    -----
    For a given denominator the problem is linear least squares. scipy minimizes over the denominator alone: a product
    of sections of second order, and one of first order if the order is odd, each in transformed reflection
    coefficients, for which every finite point is stable.
    """
    scale = float(np.std(y)) or 1.0
    target = (y - y.mean()) / scale
    impulse = np.zeros(y.size)
    impulse[0] = 1.0
    signals = np.vstack([(u - u[0]).T, impulse])
    weight = np.ones(y.size)

    def residual(theta: FloatArray) -> FloatArray:
        return np.asarray(projected_residual(_basis(signals, theta, len(poles), delay), target, weight))

    powers = (1.0, 0.5, 2.0) if thorough else (1.0,)
    errors = []
    for power in powers:
        start = _sections([p**power for p in poles])
        if float(np.sqrt(np.mean(residual(start) ** 2))) < _EXACT:
            return 0.0
        fitted = least_squares(residual, start, method="lm", x_scale="jac", ftol=1e-6, xtol=1e-6, max_nfev=150)
        errors.append(float(np.sqrt(2 * fitted.cost / y.size)))
    return scale * min(errors)


def _sections(poles: Sequence[complex]) -> FloatArray:
    """Transformed reflection coefficients of the sections that have these poles."""
    swinging = [p for p in poles if p.imag > 1e-12]
    real = sorted(p.real for p in poles if abs(p.imag) <= 1e-12)
    pairs = [(2 * p.real, abs(p) ** 2) for p in swinging]
    pairs += [(a + b, a * b) for a, b in zip(real[0::2], real[1::2], strict=False)]
    k = [value for s, p in pairs for value in (-s / (1 + p), p)]
    k += [-real[-1]] if len(real) % 2 else []
    return np.arctanh(np.clip(k, -0.999999, 0.999999))


def _basis(signals: FloatArray, theta: FloatArray, order: int, delay: int) -> FloatArray:
    """Regressors for a given denominator: each input through the sections, a constant, and free responses."""
    k = np.tanh(np.clip(theta, -_LARGEST, _LARGEST))
    columns = []
    through = signals
    for at in range(0, order, 2):
        a = [1.0, k[at] * (1 + k[at + 1]), k[at + 1]] if at + 1 < order else [1.0, k[at]]
        through = lfilter([1.0], a, through)
        for late in range(len(a) - 1):
            columns += [_later(signal, late + 1) for signal in through[:-1]]
            columns.append(_later(through[-1], late))
    for late in range(order + 1, order + 1 + delay):
        columns += [_later(signal, late) for signal in through[:-1]]
    return np.column_stack([*columns, np.ones(signals.shape[1])])


def _later(x: FloatArray, samples: int) -> FloatArray:
    return np.concatenate([np.zeros(samples), x[: x.size - samples]])
