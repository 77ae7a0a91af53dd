"""Random rigs that a controller holds: an upright pendulum, which falls without it, a hanging one, and an axis."""

from dataclasses import dataclass

import numpy as np

from labsid.rig.switchable.coupled.setup import CoupledSetup, linear_plant, plain_setup

LOOP_RIGS = ("upright pendulum", "hanging pendulum", "axis")
UNBOUNDED_RIGS = ("upright pendulum", "axis")
"""Rigs that are unstable or integrate: without the controller their output does not stay bounded."""

_STIFFNESS = {"upright pendulum": 1.0, "hanging pendulum": -1.0, "axis": 0.0}
"""Angular acceleration by gravity per radian, over that per unit of the input."""


@dataclass(frozen=True, slots=True)
class Controller:
    """PD controller with filtered derivative of the output, one sample of delay and a limit.

    ``u(k+1) = kp (r(k) - y(k)) - d(k)`` with ``d(k) = c d(k-1) + kd (1-c) (y(k) - y(k-1))``, between the limits.

    Attributes
    ----------
    kp, kd : float
        Proportional gain, and derivative gain per sample.
    filter_pole : float
        The pole c of the derivative's filter.
    limit : float
        Largest absolute value of u.
    """

    kp: float
    kd: float
    filter_pole: float
    limit: float = np.inf


def draw_loop_rig(rng: np.random.Generator, rig: str) -> tuple[CoupledSetup, Controller]:
    """Draw a rig without effects and a controller that stabilises it.

    Parameters
    ----------
    rng : Generator
    rig : str
        One of `LOOP_RIGS`.

    Returns
    -------
    tuple of CoupledSetup and Controller

    Raises
    ------
    ValueError
        If there is no such rig.
    """
    if rig not in LOOP_RIGS:
        raise ValueError(f"rig must be one of {', '.join(LOOP_RIGS)}; got {rig!r}. Name one of these.")
    T = float(rng.uniform(18.0, 40.0))
    damping = float(rng.uniform(0.1, 0.6) if rig != "axis" else rng.uniform(0.5, 2.0)) / T
    a, b = _STIFFNESS[rig] / T**2, 1 / T**2
    A = np.array([[0.0, 1.0], [a, -damping]])
    plant = linear_plant(A, np.array([[0.0], [b]]), np.array([[1.0, 0.0]]), speed_of=np.array([1, -1]))
    bandwidth = float(rng.uniform(1.2, 2.0)) / T
    kp = (bandwidth**2 + a) / b
    kd = max(2 * float(rng.uniform(0.6, 1.0)) * bandwidth - damping, 0.0) / b
    return plain_setup(rig, ("u",), ("y",), plant), Controller(kp, kd, float(np.exp(-1 / rng.uniform(0.7, 2.5))))
