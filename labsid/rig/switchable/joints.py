"""Joints: a position loop, a speed loop or a torque moves an inertia against gravity and friction.

Friction is that of bristles (Dahl, LuGre), whose level may fall with the speed or grow with the force that the gear
transmits. Units: seconds, radians, and torques over the moment of inertia.

Sources: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of systems with friction",
IEEE Trans. Automatic Control 40 (1995) 419-425; P. Dahl, "A solid friction model", Aerospace Corporation (1968).
"""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled

LOOPS = ("position", "speed", "torque")
LAWS = ("dahl", "lugre", "gear")
EFFECTS = ("coulomb-friction", "gravity", "force-limit")
"""Effects of a joint, which can be left out one by one."""

LARGEST_STEP = 5e-4  # s, of the integration
SLIP = 4e-3  # radians: deflection of the bristles at which they slip


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint.

    Attributes
    ----------
    loop : str
        What the command is: the "position" or the "speed" that a controller in the drive follows, or the "torque".
    gain : float
        Of the controller, acceleration per radian or per radian a second; 1 with a torque.
    damping : float
        Viscous friction (1/s).
    gravity, rest : float
        Largest acceleration by gravity (rad/s^2), and the angle at which it vanishes and is stable (rad).
    limit : float
        Error of the loop at which the drive gives all it has; infinity without a limit.
    law : str
        Of the friction: "dahl"; "lugre" with a level that falls with the speed; "gear" with one that grows with the
        transmitted force.
    friction : float
        Level of friction (rad/s^2); zero without friction.
    excess : float
        Of "lugre": level at rest over that in motion, less one. Of "gear": the share of the transmitted force.
    stribeck : float
        Speed over which the level falls (rad/s).
    """

    loop: str
    gain: float
    damping: float
    gravity: float = 0.0
    rest: float = 0.0
    limit: float = np.inf
    law: str = "dahl"
    friction: float = 0.0
    excess: float = 0.0
    stribeck: float = 0.1

    def without(self, effect: str) -> "Joint":
        """The joint without one of its `EFFECTS`.

        Parameters
        ----------
        effect : str
        """
        changes = {
            "coulomb-friction": {"friction": 0.0, "excess": 0.0},
            "gravity": {"gravity": 0.0},
            "force-limit": {"limit": np.inf},
        }
        return replace(self, **changes[effect])  # type: ignore[arg-type]

    @property
    def effects(self) -> tuple[str, ...]:
        """The `EFFECTS` that the joint has."""
        there = (self.friction > 0.0, self.gravity > 0.0, np.isfinite(self.limit))
        return tuple(name for name, has in zip(EFFECTS, there, strict=True) if has)


def run_joint(joint: Joint, command: FloatArray, Ts: float, start: float = 0.0) -> FloatArray:
    """Angle and speed of a joint at the sampling instants.

    Parameters
    ----------
    joint : Joint
    command : ndarray, shape (N,)
        Held between samples: radians, radians a second, or a torque over the moment of inertia.
    Ts : float
        Sampling time (s).
    start : float
        Angle at the start, at rest.

    Returns
    -------
    ndarray, shape (N, 2)

    Raises
    ------
    ValueError
        If there is no such loop or law of friction.
    """
    if joint.loop not in LOOPS:
        raise ValueError(f"loop must be one of {', '.join(LOOPS)}; got {joint.loop!r}.")
    if joint.law not in LAWS:
        raise ValueError(f"law must be one of {', '.join(LAWS)}; got {joint.law!r}.")
    steps = int(np.ceil(Ts / LARGEST_STEP))
    friction = (joint.friction, joint.excess, joint.stribeck)
    numbers = np.array([joint.gain, joint.damping, joint.gravity, joint.rest, joint.limit, *friction])
    return _run(
        np.ascontiguousarray(command, np.float64),
        Ts,
        steps,
        start,
        LOOPS.index(joint.loop),
        LAWS.index(joint.law),
        numbers,
    )


@compiled()
def _run(
    command: FloatArray, Ts: float, steps: int, start: float, loop: int, law: int, numbers: FloatArray
) -> FloatArray:
    """Classical fourth-order Runge-Kutta method."""
    out = np.empty((command.size, 2))
    h = Ts / steps
    q, v, z = start, 0.0, 0.0
    for n in range(command.size):
        out[n, 0], out[n, 1] = q, v
        for _ in range(steps):
            q1, v1, z1 = _rates(q, v, z, command[n], loop, law, numbers)
            q2, v2, z2 = _rates(q + 0.5 * h * q1, v + 0.5 * h * v1, z + 0.5 * h * z1, command[n], loop, law, numbers)
            q3, v3, z3 = _rates(q + 0.5 * h * q2, v + 0.5 * h * v2, z + 0.5 * h * z2, command[n], loop, law, numbers)
            q4, v4, z4 = _rates(q + h * q3, v + h * v3, z + h * z3, command[n], loop, law, numbers)
            q += h / 6.0 * (q1 + 2.0 * q2 + 2.0 * q3 + q4)
            v += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4)
            z += h / 6.0 * (z1 + 2.0 * z2 + 2.0 * z3 + z4)
    return out


@compiled()
def _rates(
    q: float, v: float, z: float, command: float, loop: int, law: int, numbers: FloatArray
) -> tuple[float, float, float]:
    """Derivatives of angle, speed and deflection of the bristles."""
    gain, damping, gravity, rest, limit, friction, excess, stribeck = numbers
    error = command - q if loop == 0 else command - v if loop == 1 else command
    drive = gain * min(max(error, -limit), limit)
    weight = gravity * np.sin(q - rest)
    level = friction
    if law == 1:
        level *= 1.0 + excess * np.exp(-((v / stribeck) ** 2))
    elif law == 2:
        level += excess * abs(drive - weight)
    if level <= 0.0:
        return v, drive - damping * v - weight, 0.0
    stiffness = (friction if friction > 0.0 else level) / SLIP
    deflecting = v - abs(v) * z * stiffness / level
    bristles = stiffness * z + (np.sqrt(stiffness) * deflecting if law == 1 else 0.0)
    return v, drive - damping * v - weight - bristles, deflecting
