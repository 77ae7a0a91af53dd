"""Simulation of a lab rig: a plant with actuator and sensor chains, integrated by a fixed-step Runge-Kutta method."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze

State = tuple[float, ...]
Derivative = Callable[[float, State, float], State]


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """A piecewise constant signal in continuous time.

    Parameters
    ----------
    times : ndarray, shape (M,)
        Instants at which a value begins, increasing (s).
    values : ndarray, shape (M,)
        ``values[i]`` holds from ``times[i]`` to ``times[i + 1]``; the last value holds for all later times (V).
    """

    times: FloatArray
    values: FloatArray

    def __post_init__(self) -> None:
        freeze(self, times=self.times, values=self.values)

    def at(self, t: ArrayLike) -> FloatArray:
        """Values at the times `t`; the first value applies before the first instant."""
        index = np.searchsorted(self.times, t, side="right") - 1
        return self.values[np.maximum(index, 0)]


@dataclass(frozen=True, slots=True, eq=False)
class Rig:
    """A lab rig: plant, actuator chain and sensor chain.

    Parameters
    ----------
    derivative : callable
        ``derivative(t, x, v) -> dx/dt`` of time (s), state and actuator output (V).
    output : callable
        ``output(states) -> volts``: output of an ideal sensor for states of shape (N, n).
    state_names : tuple of str
        Name of each state, for messages.
    lowest : tuple of float
        Lower bound at which each state stops, such as an empty tank; ``-inf`` if there is none.
    highest : tuple of float
        Largest value of each state for which `derivative` is valid, such as the brim of a tank.
    actuator : tuple of callable
        ``block(drive) -> drive``, in order from the command to the plant.
    sensor : tuple of callable
        ``block(t, volts) -> volts`` at the sampling instants, in order from the plant to the log.
    """

    derivative: Derivative
    output: Callable[[FloatArray], FloatArray]
    state_names: tuple[str, ...]
    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    actuator: tuple[Callable[[Drive], Drive], ...] = ()
    sensor: tuple[Callable[[FloatArray, FloatArray], FloatArray], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class RigRun:
    """Signals of one run of a rig.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Sampling instants, from 0 (s).
    u : ndarray, shape (N,)
        Commanded input (V).
    states : ndarray, shape (N, n)
        True states at the sampling instants.
    y : ndarray, shape (N,)
        Output of the sensor chain (V).
    """

    t: FloatArray
    u: FloatArray
    states: FloatArray
    y: FloatArray

    def __post_init__(self) -> None:
        freeze(self, t=self.t, u=self.u, states=self.states, y=self.y)


def zero_order_hold(u: ArrayLike, Ts: float) -> Drive:
    """Zero-order hold: ``u[k]`` holds from ``k Ts`` on.

    Parameters
    ----------
    u : array_like, shape (N,)
        Commanded input (V).
    Ts : float
        Sampling time in seconds.

    Returns
    -------
    Drive

    Raises
    ------
    ValueError
        If `u` is not a finite signal or `Ts` is not positive.
    """
    u = as_signal("u", u)
    if not Ts > 0:
        raise ValueError(f"Ts must be a positive time in seconds; got {Ts}.")
    return Drive(times=Ts * np.arange(u.size, dtype=np.float64), values=u)


def simulate_rig(rig: Rig, u: ArrayLike, Ts: float, x0: Sequence[float], max_step: float = 0.1) -> RigRun:
    """Simulate a rig and sample its output.

    Parameters
    ----------
    rig : Rig
    u : array_like, shape (N,)
        Commanded input, held over each sample (V).
    Ts : float
        Sampling time in seconds.
    x0 : sequence of float, length n
        State at t = 0.
    max_step : float
        Longest integration step (s).

    Returns
    -------
    RigRun
        Sample k is taken at ``k Ts``, before ``u[k]`` takes effect.

    Raises
    ------
    ValueError
        If an argument is malformed, or a state exceeds the range of the rig's model.
    """
    if len(x0) != len(rig.state_names):
        raise ValueError(f"x0 must hold {len(rig.state_names)} states ({', '.join(rig.state_names)}); got {len(x0)}.")
    command = zero_order_hold(u, Ts)
    drive = command
    for actuate in rig.actuator:
        drive = actuate(drive)
    t = command.times
    states = integrate(rig.derivative, x0, drive, t, max_step, rig.lowest)
    _check_range(rig, t, states)
    y = rig.output(states)
    for measure in rig.sensor:
        y = measure(t, y)
    return RigRun(t=t, u=command.values, states=states, y=y)


def integrate(
    derivative: Derivative,
    x0: Sequence[float],
    drive: Drive,
    t: ArrayLike,
    max_step: float,
    lowest: Sequence[float],
) -> FloatArray:
    """Integrate ``dx/dt = derivative(t, x, v)`` by the classical Runge-Kutta method of order four.

    Steps end at every instant of `t` and at every jump of the drive, which preserves the order of the method;
    in between they are equal and no longer than `max_step`.

    Parameters
    ----------
    derivative : callable
        ``derivative(t, x, v)``, on tuples of floats.
    x0 : sequence of float, length n
        State at ``t[0]``.
    drive : Drive
        The input ``v``.
    t : array_like, shape (N,)
        Instants of the returned states, increasing (s).
    max_step : float
        Longest integration step (s).
    lowest : sequence of float, length n
        Lower bound of each state, applied after every step.

    Returns
    -------
    ndarray, shape (N, n)

    Raises
    ------
    ValueError
        If `max_step` is not positive.

    Notes
    -----
    Uses Python floats instead of arrays: their sums, products and square roots round equally on every platform, so
    a secret gives the same record on every machine.
    """
    if not max_step > 0:
        raise ValueError(f"max_step must be a positive time in seconds; got {max_step}.")
    t = as_signal("t", t)
    inside = (drive.times > t[0]) & (drive.times < t[-1])
    instants = np.union1d(t, drive.times[inside])
    values = drive.at(instants).tolist()
    wanted = np.isin(instants, t).tolist()
    x = tuple(float(value) for value in x0)
    states = [x]
    for (begin, end), v, keep in zip(pairwise(instants.tolist()), values, wanted[1:], strict=False):
        steps = ceil((end - begin) / max_step)
        h = (end - begin) / steps
        for i in range(steps):
            x = tuple(map(max, _runge_kutta_step(derivative, begin + i * h, x, v, h), lowest))
        if keep:
            states.append(x)
    return np.array(states)


def _runge_kutta_step(derivative: Derivative, t: float, x: State, v: float, h: float) -> State:
    half = 0.5 * h
    k1 = derivative(t, x, v)
    k2 = derivative(t + half, _advance(x, half, k1), v)
    k3 = derivative(t + half, _advance(x, half, k2), v)
    k4 = derivative(t + h, _advance(x, h, k3), v)
    slope = [a + 2 * b + 2 * c + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
    return _advance(x, h / 6, slope)


def _advance(x: State, h: float, slope: Sequence[float]) -> State:
    return tuple([xi + h * si for xi, si in zip(x, slope, strict=True)])


def _check_range(rig: Rig, t: FloatArray, states: FloatArray) -> None:
    beyond = np.argwhere(~(states <= np.array(rig.highest)))
    if beyond.size:
        k, i = beyond[0]
        raise ValueError(
            f"{rig.state_names[i]} must stay below {rig.highest[i]:g}; got {states[k, i]:.4g} "
            f"at t = {t[k]:g} s. Lower the input or the initial state."
        )
