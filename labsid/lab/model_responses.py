"""Frequency and step response, poles and zeros of an identified model, with their 95 % errors."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.lab.arx import ArxModel
from labsid.model_structures.roots import Root, roots_with_errors

DEVIATIONS = 1.96  # for 95 %
POINTS = 200
LOWEST = 0.1  # of the corner frequency of the slowest pole
SETTLED = 6.0  # longest time constants, over which the step response is shown
LONGEST = 2000  # samples of a step response


@dataclass(frozen=True, slots=True, eq=False)
class ModelResponses:
    """What the figure of an identification shows of its model.

    Attributes
    ----------
    frequency : ndarray, shape (n,)
        In hertz, up to the Nyquist frequency.
    gain : ndarray of complex, shape (n,)
        Unit of y over unit of u.
    gain_error, phase_error : ndarray, shape (n,)
        95 % errors, relative and in radians.
    time, step, step_error : ndarray, shape (m,)
        Seconds after a unit step of the input, the output, and its 95 % error.
    poles, zeros : tuple of Root
    """

    frequency: FloatArray
    gain: np.ndarray
    gain_error: FloatArray
    phase_error: FloatArray
    time: FloatArray
    step: FloatArray
    step_error: FloatArray
    poles: tuple[Root, ...]
    zeros: tuple[Root, ...]


def responses_of_model(model: ArxModel, covariance: FloatArray) -> ModelResponses:
    """Responses of a model and their errors, to first order in the covariance of theta.

    Parameters
    ----------
    model : ArxModel
    covariance : ndarray, shape (2 n, 2 n)
        Of theta.

    Returns
    -------
    ModelResponses

    Notes
    -----
    With ``theta = [-a, b]``, ``G = B / A`` moves by ``z^-i G / A`` per unit of -a_i, and by ``z^-i / A`` per unit of
    b_i. The covariance is that of least squares, whose errors are too small where the equation error is coloured.
    """
    n, Ts = model.order, model.Ts
    tau = _longest_time(model)
    frequency = np.geomspace(min(LOWEST / (2.0 * np.pi * tau), 0.05 / Ts), 0.5 / Ts, POINTS)
    z = np.exp(2j * np.pi * frequency * Ts)
    delays = z[:, None] ** -np.arange(1, n + 1)
    denominator = 1.0 + delays @ model.a[1:]
    gain = (delays @ model.b) / denominator
    slopes = np.hstack([delays * gain[:, None], delays]) / denominator[:, None]
    relative = slopes / gain[:, None]
    time, step, step_slopes = _step_response(model, tau)
    den_spread, num_spread = np.zeros((n + 1, n + 1)), covariance[n:, n:]
    den_spread[1:, 1:] = covariance[:n, :n]
    return ModelResponses(
        frequency,
        gain,
        _errors(relative.real, covariance),
        _errors(relative.imag, covariance),
        time,
        step,
        _errors(step_slopes, covariance),
        roots_with_errors(model.a, den_spread),
        roots_with_errors(model.b, num_spread),
    )


def _errors(slopes: FloatArray, covariance: FloatArray) -> FloatArray:
    """95 % errors of values with these slopes by theta."""
    return np.asarray(DEVIATIONS * np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slopes, covariance, slopes), 0.0)))


def _longest_time(model: ArxModel) -> float:
    """Time in which the slowest pole decays, or grows, by e; in seconds, at least a sample."""
    rates = np.abs(np.log(np.maximum(np.abs(model.poles), 1e-12)))
    return model.Ts / float(np.clip(rates.min(), SETTLED / LONGEST, 1.0))


def _step_response(model: ArxModel, tau: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times, response to a unit step, and its slopes by theta."""
    from scipy.signal import lfilter  # slow to import

    steps = np.ones(int(np.ceil(SETTLED * tau / model.Ts)) + 1)
    output = lfilter([0.0, *model.b], model.a, steps)

    def delayed(x: FloatArray) -> list[FloatArray]:
        return [np.concatenate([np.zeros(i), x[: x.size - i]]) for i in range(1, model.order + 1)]

    slopes = [lfilter([1.0], model.a, x) for x in (*delayed(output), *delayed(steps))]
    return np.asarray(model.Ts * np.arange(steps.size), float), np.asarray(output), np.array(slopes, float).T
