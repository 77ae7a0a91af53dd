"""Step-response modelling of the appendix: gain, time constant and delay from a recorded step."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares as nonlinear_least_squares

from labsid._arrays import FloatArray, as_signal, as_signals, freeze

FEWEST = 10  # samples after the step


@dataclass(frozen=True, slots=True, eq=False)
class FirstOrderDelay:
    """``G(s) = K e^(-td s) / (tau s + 1)``.

    Attributes
    ----------
    K : float
        Gain, unit of y over unit of u.
    tau : float
        Time constant in seconds.
    td : float
        Pure delay in seconds.
    """

    K: float
    tau: float
    td: float


@dataclass(frozen=True, slots=True, eq=False)
class StepResponseFit:
    """A first-order model with delay, read off a step response and refined by least squares.

    Attributes
    ----------
    reading : FirstOrderDelay
        By the graphical method of Fig. A1.
    model : FirstOrderDelay
        By least squares on all samples, started from the reading.
    amplitude : float
        Size of the step.
    y_initial, y_final : float
        Levels before and after the step, as read.
    t_283, t_632 : float
        Times at which the response reaches 28.3 % and 63.2 % of its change, as read.
    y_fit : ndarray, shape (N,)
        Output of `model` at the recorded times, `y_initial` included.
    mse_reading, mse : float
        Mean squared error of the reading and of the refined model.
    status : {"settled", "not settled", "overshoot"}
        "not settled": the record ends before the response settles, so that the final level as read is too low;
        the refinement extrapolates. "overshoot": the response exceeds its final level by over 5 % of the change
        and requires a model of second or higher order.
    """

    reading: FirstOrderDelay
    model: FirstOrderDelay
    amplitude: float
    y_initial: float
    y_final: float
    t_283: float
    t_632: float
    y_fit: FloatArray
    mse_reading: float
    mse: float
    status: Literal["settled", "not settled", "overshoot"]

    def __post_init__(self) -> None:
        freeze(self, y_fit=self.y_fit)


def first_order_response(model: FirstOrderDelay, t: ArrayLike, amplitude: float) -> FloatArray:
    """Evaluate the step response ``K amplitude (1 - e^(-(t - td) / tau))``, zero until t = td.

    Parameters
    ----------
    model : FirstOrderDelay
    t : array_like, shape (N,)
        Time since the step, in seconds.
    amplitude : float
        Size of the step.

    Returns
    -------
    y : ndarray, shape (N,)
        Deviation from the level before the step.

    Notes
    -----
    UNSW lab, appendix, Fig. A1.
    """
    t = as_signal("t", t)
    return model.K * amplitude * _unit_response(t, model.tau, model.td)


def fit_step_response(t: ArrayLike, y: ArrayLike, amplitude: float) -> StepResponseFit:
    """Model a recorded step response by a gain, a time constant and a delay.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds, increasing, zero at the instant of the step. The samples at t <= 0 are averaged to the
        initial level.
    y : array_like, shape (N,)
        Recorded output.
    amplitude : float
        Size of the step (2 in the lab), negative for a step down.

    Returns
    -------
    StepResponseFit

    Raises
    ------
    ValueError
        If the amplitude is zero, t does not increase through zero, fewer than 10 samples follow the step, or
        y does not respond to it.

    Notes
    -----
    UNSW lab, appendix, Fig. A1. The lab does not state how the values were read; this is the classic two-point
    method. With y at its initial level before the step and at its final level in the last tenth,

        K = (y_final - y_initial) / amplitude,   tau = 3/2 (t_632 - t_283),   td = t_632 - tau,

    because a first-order response reaches 28.3 % of its change at td + tau / 3 and 63.2 % at td + tau. If the
    delay comes out negative, td = 0 and tau = t_632. On a noisy response, the crossing of a level is midway
    between the first sample above it and the last sample below it.
    """
    t, y = as_signals(t=t, y=y)
    if not (np.isfinite(amplitude) and amplitude != 0):
        raise ValueError(f"amplitude must be the size of the step, not zero; got {amplitude}.")
    if np.any(np.diff(t) <= 0):
        raise ValueError(f"t must increase; got a step back at sample {int(np.argmax(np.diff(t) <= 0)) + 1}.")
    after = t > 0
    if t[0] > 0 or np.sum(after) < FEWEST:
        raise ValueError(
            f"t must be zero at the step, with a sample there or before and at least {FEWEST} after it; "
            f"got t from {t[0]:g} to {t[-1]:g} s with {np.sum(after)} samples after zero. "
            "Subtract the time of the step from t, or record for longer."
        )
    y_initial = float(np.mean(y[~after]))
    tail = y[-max(3, int(np.sum(after)) // 10) :]
    y_final = float(np.mean(tail))
    change = y_final - y_initial
    noise = float(np.std(np.diff(tail)) / np.sqrt(2))
    if abs(change) <= 3 * noise or change == 0:
        raise ValueError(
            f"y must respond to the step; got a change of {change:.4g} in noise of {noise:.2g}. "
            "Use a larger step, or record for longer."
        )
    t_after, way = np.append(0.0, t[after]), np.append(0.0, (y[after] - y_initial) / change)
    t_283, t_632 = _crossings(t_after, way)
    if t_283 == t_632:
        raise ValueError(
            f"y must pass 28.3 % and 63.2 % of its way at different times; got {t_632:.4g} s for both: the "
            "noise is too large. Use a larger step, or average several."
        )
    tau = 1.5 * (t_632 - t_283)
    td = t_632 - tau
    if td < 0:
        tau, td = t_632, 0.0
    reading = FirstOrderDelay(change / amplitude, tau, td)
    model = _refine(t, y - y_initial, amplitude, reading)
    y_fit = y_initial + first_order_response(model, t, amplitude)
    return StepResponseFit(
        reading=reading,
        model=model,
        amplitude=float(amplitude),
        y_initial=y_initial,
        y_final=y_final,
        t_283=t_283,
        t_632=t_632,
        y_fit=y_fit,
        mse_reading=float(np.mean((y - y_initial - first_order_response(reading, t, amplitude)) ** 2)),
        mse=float(np.mean((y - y_fit) ** 2)),
        status=_status(float(t[-1]), float(np.max(way)), noise / abs(change), model),
    )


def cut_held_step(
    u: ArrayLike, y: ArrayLike, Ts: float, change: int = 0, before: int = 10
) -> tuple[FloatArray, FloatArray, float]:
    """Cut one step out of a record: from a change of the input to the next one.

    Parameters
    ----------
    u, y : array_like, shape (N,)
        Input (exact levels) and output as recorded.
    Ts : float
        Sampling time in seconds.
    change : int
        Index of the change of the input, from 0.
    before : int
        Samples to keep before the step, at most those since the previous change.

    Returns
    -------
    t : ndarray
        Time in seconds, zero at the first sample of the new input.
    y : ndarray
        The output at those times.
    amplitude : float
        Size of the step.

    Raises
    ------
    ValueError
        If the lengths differ, `Ts` is not positive, or there is no such change.
    """
    u, y = as_signals(u=u, y=y)
    if not (np.isfinite(Ts) and Ts > 0):
        raise ValueError(f"Ts must be a positive number of seconds; got {Ts}.")
    changes = np.flatnonzero(np.diff(u)) + 1
    if not 0 <= change < changes.size:
        raise ValueError(f"change must lie below the number of input changes, {changes.size}; got {change}.")
    edges = np.concatenate([[0], changes, [u.size]])
    step, stop = int(edges[change + 1]), int(edges[change + 2])
    start = max(step - before, int(edges[change]))
    t = Ts * np.arange(start - step, stop - step, dtype=np.float64)
    return t, y[start:stop], float(u[step] - u[step - 1])


def _unit_response(t: FloatArray, tau: float, td: float) -> FloatArray:
    response: FloatArray = -np.expm1(-np.maximum(t - td, 0.0) / tau)
    return response


def _crossings(t: FloatArray, way: FloatArray) -> tuple[float, float]:
    """Times at which `way`, zero at first, reaches 28.3 % and 63.2 %; the former is never the later one."""
    low, high = 1 - np.exp(-1 / 3), 1 - np.exp(-1)
    stop = int(np.flatnonzero(way >= high)[-1]) + 1
    return _crossing(t[:stop], way[:stop], low), _crossing(t[:stop], way[:stop], high)


def _crossing(t: FloatArray, way: FloatArray, level: float) -> float:
    """Time at which `way`, which ends above `level`, crosses it; interpolated if it does so once."""
    first, last = int(np.argmax(way >= level)), int(np.flatnonzero(way < level)[-1])
    if last < first:
        share = (level - way[last]) / (way[first] - way[last])
        return float(t[last] + share * (t[first] - t[last]))
    return float((t[first] + t[last]) / 2)


def _refine(t: FloatArray, y: FloatArray, amplitude: float, reading: FirstOrderDelay) -> FirstOrderDelay:
    """Least squares over all samples: nonlinear in tau and td, linear in the gain."""

    def gain(tau: float, td: float) -> float:
        unit = amplitude * _unit_response(t, tau, td)
        return float(unit @ y) / max(float(unit @ unit), np.finfo(float).tiny)

    def error(searched: FloatArray) -> FloatArray:
        tau, td = np.exp(searched[0]), searched[1]
        return gain(tau, td) * amplitude * _unit_response(t, tau, td) - y

    span = float(t[-1])
    lower, upper = np.array([np.log(1e-3 * span / t.size), 0.0]), np.array([np.log(100 * span), span])
    start = np.clip([np.log(reading.tau), reading.td], lower, upper)
    refined = nonlinear_least_squares(error, start, bounds=(lower, upper), x_scale=[1.0, reading.tau])
    tau, td = float(np.exp(refined.x[0])), float(refined.x[1])
    return FirstOrderDelay(gain(tau, td), tau, td)


def _status(
    t_end: float, furthest: float, noise: float, model: FirstOrderDelay
) -> Literal["settled", "not settled", "overshoot"]:
    if furthest > 1.05 + 4 * noise:
        return "overshoot"
    return "settled" if t_end - model.td >= 4 * model.tau else "not settled"
