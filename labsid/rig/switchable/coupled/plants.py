"""Random rigs of several signals: two pairs of tanks, two heaters, two joints, and a valve with its supply pressure."""

from collections.abc import Callable

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable.coupled.setup import CoupledSetup, Plant, linear_plant, linearised, plain_setup

SLOWEST, FASTEST = 100.0, 1.5
"""Largest and smallest time constant in samples."""


def draw_coupled_rig(rng: np.random.Generator, samples: int, rig: str) -> CoupledSetup:
    """Draw a rig without effects.

    Parameters
    ----------
    rng : Generator
    samples : int
        Length of the record; the slowest time constant is about a twelfth of it at most.
    rig : str
        One of `RIGS`.

    Returns
    -------
    CoupledSetup

    Raises
    ------
    ValueError
        If there is no such rig.
    """
    if rig not in _RIGS:
        raise ValueError(f"rig must be one of {', '.join(RIGS)}; got {rig!r}. Name one of these.")
    draw, inputs, outputs = _RIGS[rig]
    slow = float(np.exp(rng.uniform(np.log(8.0), np.log(min(SLOWEST, samples / 12)))))
    return plain_setup(rig, inputs, outputs, draw(rng, slow))


def coupled_poles(plant: Plant) -> FloatArray:
    """Poles of the linearised plant in continuous time with a sample as the unit.

    Parameters
    ----------
    plant : Plant

    Returns
    -------
    ndarray of complex, shape (n,)
    """
    A, _, _ = linearised(plant)
    return np.linalg.eigvals(A).astype(complex)


def coupled_time_scale(plant: Plant) -> float:
    """Longest time constant of the plant, or time scale of its oscillation, in samples.

    Parameters
    ----------
    plant : Plant

    Returns
    -------
    float
    """
    p = coupled_poles(plant)
    return float(np.max(np.where(np.abs(p.imag) > 1e-9, 2.0 / np.abs(p), -1.0 / p.real)))


def _tanks(rng: np.random.Generator, slow: float) -> Plant:
    """Two upper tanks that empty into two lower ones, whose levels are measured.

    Each pump fills the tanks of its own side most, and the other upper tank; a pipe may join the lower tanks.
    """
    upper = np.maximum(slow * rng.uniform(0.15, 0.5, 2), FASTEST)
    lower = slow * rng.uniform(0.6, 1.0, 2)
    own = rng.uniform(0.6, 0.85, 2)
    pipe = float(rng.choice([0.0, rng.uniform(0.1, 0.4)]))
    to_lower = bool(rng.random() < 0.4)  # as in the quadruple tank: the pump's own share goes to the lower tank
    A, flow, B = np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 2))
    for i, j in ((0, 1), (1, 0)):
        flow[i, i] = -1 / upper[i]
        flow[2 + i, i], flow[2 + i, 2 + i] = 1 / lower[i], -1 / lower[i]
        A[2 + i, 2 + i], A[2 + i, 2 + j] = -pipe / lower[i], pipe / lower[i]
        B[(2 + i, i) if to_lower else (i, i)] = own[i] / (lower[i] if to_lower else upper[i])
        B[j, i] = (1 - own[i]) / upper[j]
    return linear_plant(A, B, np.eye(4)[2:], flow)


def _heaters(rng: np.random.Generator, slow: float) -> Plant:
    """Two heated blocks beside each other, each with a sensor that follows it with a lag."""
    block = slow * rng.uniform(0.6, 1.0, 2)
    sensor = np.maximum(slow * rng.uniform(0.05, 0.35, 2), FASTEST)
    exchange = float(rng.uniform(0.2, 0.7))
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    for i, j in ((0, 1), (1, 0)):
        A[i, i], A[i, j] = -(1 + exchange) / block[i], exchange / block[i]
        A[2 + i, i], A[2 + i, 2 + i] = 1 / sensor[i], -1 / sensor[i]
        B[i, i] = 1 / block[i]
    return linear_plant(A, B, np.eye(4)[2:])


def _joints(rng: np.random.Generator, slow: float) -> Plant:
    """Two inertias, each driven by a torque against its spring and damper, joined by a spring and a damper."""
    T = np.clip(slow / 4, 2.5, 20.0) * rng.uniform(0.7, 1.4, 2)
    damping = np.exp(rng.uniform(np.log(0.15), np.log(0.9), 2))
    spring, damper = float(rng.uniform(0.2, 0.7)), float(rng.uniform(0.0, 0.3))
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    for i, j in ((0, 1), (1, 0)):
        A[i, 2 + i] = 1.0
        A[2 + i, i], A[2 + i, j] = -(1 + spring) / T[i] ** 2, spring / T[i] ** 2
        A[2 + i, 2 + i] = -(2 * damping[i] * T[i] + damper * T[i]) / T[i] ** 2
        A[2 + i, 2 + j] = damper * T[i] / T[i] ** 2
        B[2 + i, i] = 1 / T[i] ** 2
    return linear_plant(A, B, np.eye(4)[:2], speed_of=np.array([2, 3, -1, -1]))


def _valve(rng: np.random.Generator, slow: float) -> Plant:
    """A valve that fills a tank through a line, with a supply pressure that disturbs the flow, and is measured."""
    line = max(slow * float(rng.uniform(0.1, 0.6)), FASTEST)
    pressure = float(rng.uniform(0.3, 0.8) * rng.choice([-1.0, 1.0], p=[0.3, 0.7]))
    after = bool(rng.random() < 0.5)  # the pressure acts behind the line
    B = np.array([[1 / line, 0.0 if after else pressure / line], [0.0, pressure / slow if after else 0.0]])
    flow = np.array([[0.0, 0.0], [0.0, -1 / slow]])
    A = np.array([[-1 / line, 0.0], [1 / slow, 0.0]])
    return linear_plant(A, B, np.array([[0.0, 1.0]]), flow)


_RIGS: dict[str, tuple[Callable[[np.random.Generator, float], Plant], tuple[str, ...], tuple[str, ...]]] = {
    "two pairs of tanks": (_tanks, ("pump1", "pump2"), ("level1", "level2")),
    "two heaters": (_heaters, ("heater1", "heater2"), ("sensor1", "sensor2")),
    "two joints": (_joints, ("torque1", "torque2"), ("angle1", "angle2")),
    "valve and supply pressure": (_valve, ("valve", "pressure"), ("level",)),
}

RIGS = tuple(_RIGS)
