"""Random rigs: tanks, motors, heaters and masses on springs, with parameters that occur in a laboratory."""

from dataclasses import dataclass, replace

import numpy as np

from labsid.rig.switchable._motion import (
    HEATED_FAR,
    HEATED_NEAR,
    LAGGED_TANK,
    MASS,
    MOTOR_POSITION,
    MOTOR_SPEED,
    TWO_TANKS,
)
from labsid.rig.switchable.setup import Actuator, Setup, plain_motion
from labsid.rig.switchable.simulation import poles

SLOWEST = 100.0
FASTEST = 1.5

RIGS = (
    "two tanks",
    "tank with a lag",
    "motor, speed",
    "motor, position on a leaky integrator",
    "motor, position against a spring",
    "heater, far sensor",
    "heater, near sensor",
    "mass on a spring",
)


@dataclass(frozen=True, slots=True)
class Scales:
    """Conversion from rig units to the record's units: ``u = u0 + us v``, ``y = y0 + ys x``, ``t = Ts k``.

    Attributes
    ----------
    Ts : float
        Sampling time (s).
    u0, us, y0, ys : float
        Operating point and scale of input and output, in the record's units.
    """

    Ts: float
    u0: float
    us: float
    y0: float
    ys: float


def draw_rig(rng: np.random.Generator, samples: int, rigs: tuple[str, ...] = RIGS) -> Setup:
    """Draw a rig without effects.

    Parameters
    ----------
    rng : Generator
    samples : int
        Length of the record; the slowest time constant is at most a twelfth of it.
    rigs : tuple of str
        Rigs to draw from.

    Returns
    -------
    Setup
    """
    name = str(rng.choice(rigs))
    slowest = min(SLOWEST, samples / 12)
    slow = float(np.exp(rng.uniform(np.log(6.0), np.log(slowest))))
    fast = float(max(FASTEST, slow * np.exp(rng.uniform(np.log(0.08), np.log(0.7)))))
    actuator = Actuator(zero=-float(rng.uniform(1.0, 1.6)))
    if name == "two tanks":
        T = (slow, fast) if rng.random() < 0.35 else (fast, slow)
        motion = plain_motion(TWO_TANKS, *T)
    elif name == "tank with a lag":
        motion = plain_motion(LAGGED_TANK, min(fast, 10.0), slow)
    elif name == "motor, speed":
        motion = plain_motion(MOTOR_SPEED, min(fast, 12.0), slow)
    elif name == "motor, position on a leaky integrator":
        motion = plain_motion(MOTOR_POSITION, fast, slow)
    elif name == "motor, position against a spring":
        motion = plain_motion(MASS, min(max(slow / 3, 2.0), 30.0), 1.0)._replace(damping=rng.uniform(0.8, 1.6))
    elif name == "mass on a spring":
        damping = float(np.exp(rng.uniform(np.log(0.1), np.log(1.2))))
        motion = plain_motion(MASS, min(max(slow / 4, 2.0), 20.0), 1.0)._replace(damping=damping)
    else:
        kind = HEATED_NEAR if name == "heater, near sensor" else HEATED_FAR
        ratio = rng.uniform(0.3, 2.0)
        motion = plain_motion(kind, ratio, 1.0)._replace(coupling=rng.uniform(0.4, 2.5), loss=rng.uniform(0.1, 0.6))
        longest = float(np.max(-1 / poles(motion).real))
        motion = motion._replace(T0=ratio * slow / longest, T1=slow / longest)
    if name.startswith("motor") or name == "mass on a spring":
        actuator = replace(actuator, zero=0.0)
    if name == "motor, speed":
        motion = motion._replace(speed_zero=float(rng.uniform(-0.25, 0.25)))
    return Setup(rig=name, motion=motion._replace(level_zero=-actuator.zero), actuator=actuator)


def draw_scales(rng: np.random.Generator) -> Scales:
    """Draw the units and the operating point; the output scale is sometimes negative.

    Parameters
    ----------
    rng : Generator

    Returns
    -------
    Scales
    """
    us = float(np.exp(rng.uniform(np.log(0.2), np.log(20.0))))
    ys = float(np.exp(rng.uniform(np.log(0.02), np.log(200.0)))) * (-1.0 if rng.random() < 0.15 else 1.0)
    if rng.random() < 0.15:
        us *= 1000.0
    u0 = us * float(rng.uniform(-0.5, 3.0))
    y0 = abs(ys) * float(rng.uniform(-2.0, 5.0))
    Ts = float(rng.choice([0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.25, 0.5, 0.75, 1.0, 2.0, 5.0, 10.0]))
    return Scales(Ts=Ts, u0=_rounded(u0), us=_rounded(us), y0=_rounded(y0), ys=_rounded(ys))


def time_scale(setup: Setup) -> float:
    """Longest time constant of the plant, or time scale of its oscillation, in samples.

    Parameters
    ----------
    setup : Setup

    Returns
    -------
    float
    """
    if setup.motion.kind == MASS:
        return float(setup.motion.T0 * max(2 * setup.motion.damping, 2.0))
    return float(np.max(-1 / poles(setup.motion).real))


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")
