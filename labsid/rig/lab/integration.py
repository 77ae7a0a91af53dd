"""The bench that every simulated rig stands on: what a rig is made of, and how one is run."""

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
    """A piecewise constant signal in continuous time: what an actuator is told, or does.

    Parameters
    ----------
    times : ndarray, shape (M,)
        Instants in seconds, increasing, at which a value begins.
    values : ndarray, shape (M,)
        ``values[i]`` holds from ``times[i]`` to ``times[i + 1]``, the last one for ever (V).
    """

    times: FloatArray
    values: FloatArray

    def __post_init__(self) -> None:
        freeze(self, times=self.times, values=self.values)

    def at(self, t: ArrayLike) -> FloatArray:
        """Value at the times `t`; before the first instant, the first value."""
        index = np.searchsorted(self.times, t, side="right") - 1
        return self.values[np.maximum(index, 0)]


@dataclass(frozen=True, slots=True, eq=False)
class Rig:
    """A lab rig: what moves, what drives it, what is measured.

    An unmodelled effect is one more function in one of the chains, or another derivative.

    Parameters
    ----------
    derivative : callable
        ``derivative(t, x, v) -> dx/dt`` in continuous time: time (s), state, and what the actuator does (V).
    output : callable
        ``output(states) -> volts``: what an ideal sensor shows, from states of shape (N, n).
    state_names : tuple of str
        What each state is, for messages.
    lowest : tuple of float
        Where each state stops: a tank is never emptier than empty. ``-inf`` for a state without a stop.
    highest : tuple of float
        How far each state may go before `derivative` is no longer the physics (the brim of a tank).
    actuator : tuple of callable
        ``block(drive) -> drive``, in the order from the command to the plant.
    sensor : tuple of callable
        ``block(t, volts) -> volts`` at the sampling instants, in the order from the plant to the log.
    """

    derivative: Derivative
    output: Callable[[FloatArray], FloatArray]
    state_names: tuple[str, ...]
    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    actuator: tuple[Callable[[Drive], Drive], ...] = ()
    sensor: tuple[Callable[[FloatArray, FloatArray], FloatArray], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What one run of a rig left behind.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Sampling instants in seconds, from 0.
    u : ndarray, shape (N,)
        The commanded input (V).
    states : ndarray, shape (N, n)
        The true states at the sampling instants; no student sees them.
    y : ndarray, shape (N,)
        What the sensor chain put out (V).
    """

    t: FloatArray
    u: FloatArray
    states: FloatArray
    y: FloatArray

    def __post_init__(self) -> None:
        freeze(self, t=self.t, u=self.u, states=self.states, y=self.y)


def hold(u: ArrayLike, Ts: float) -> Drive:
    """Zero-order hold: the command as a drive, ``u[k]`` from ``k Ts`` on.

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


def run(rig: Rig, u: ArrayLike, Ts: float, x0: Sequence[float], max_step: float = 0.1) -> Run:
    """Run a rig on an input and sample it.

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
        The longest integration step in seconds.

    Returns
    -------
    Run
        Sample k is taken at ``k Ts``, before ``u[k]`` has had any effect.

    Raises
    ------
    ValueError
        If an argument is malformed, or a state goes where the rig's physics no longer holds.
    """
    if len(x0) != len(rig.state_names):
        raise ValueError(f"x0 must hold {len(rig.state_names)} states ({', '.join(rig.state_names)}); got {len(x0)}.")
    command = hold(u, Ts)
    drive = command
    for actuate in rig.actuator:
        drive = actuate(drive)
    t = command.times
    states = integrate(rig.derivative, x0, drive, t, max_step, rig.lowest)
    _refuse_out_of_range(rig, t, states)
    y = rig.output(states)
    for measure in rig.sensor:
        y = measure(t, y)
    return Run(t=t, u=command.values, states=states, y=y)


def integrate(
    derivative: Derivative,
    x0: Sequence[float],
    drive: Drive,
    t: ArrayLike,
    max_step: float,
    lowest: Sequence[float],
) -> FloatArray:
    """Integrate ``dx/dt = derivative(t, x, v)`` by the classical Runge-Kutta method of order four.

    Steps end at every instant of `t` and at every edge of the drive, so that no step straddles a jump and
    the order holds; in between they are equal and no longer than `max_step`. The cost is linear in time.

    Parameters
    ----------
    derivative : callable
        ``derivative(t, x, v)``, on tuples of floats.
    x0 : sequence of float, length n
        State at ``t[0]``.
    drive : Drive
        The input ``v``.
    t : array_like, shape (N,)
        Instants in seconds at which the state is wanted, increasing.
    max_step : float
        In seconds.
    lowest : sequence of float, length n
        A step that ends below it ends on it.

    Returns
    -------
    ndarray, shape (N, n)

    Raises
    ------
    ValueError
        If `max_step` is not positive.

    Notes
    -----
    Plain floats, not arrays: sums, products and roots of Python floats are rounded in the same way on every
    platform, so a record made from a secret on one machine is the record made from it on another.
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
    k2 = derivative(t + half, _moved(x, half, k1), v)
    k3 = derivative(t + half, _moved(x, half, k2), v)
    k4 = derivative(t + h, _moved(x, h, k3), v)
    slope = [a + 2 * b + 2 * c + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
    return _moved(x, h / 6, slope)


def _moved(x: State, h: float, slope: Sequence[float]) -> State:
    return tuple([xi + h * si for xi, si in zip(x, slope, strict=True)])


def _refuse_out_of_range(rig: Rig, t: FloatArray, states: FloatArray) -> None:
    beyond = np.argwhere(~(states <= np.array(rig.highest)))
    if beyond.size:
        k, i = beyond[0]
        raise ValueError(
            f"{rig.state_names[i]} must stay below {rig.highest[i]:g}; got {states[k, i]:.4g} "
            f"at t = {t[k]:g} s. Lower the input, or start lower."
        )
