"""A model of one joint as a compiled loop: the arithmetic of a MuJoCo step, with changes of the joint and its actuator.

MuJoCo takes 3 to 5 microseconds for a step of such a model, this loop 0.05. It holds for one hinge or slide with one
actuator at it, without contacts, tendons, equalities or fluid, and Euler's or an implicit integrator; a caller compares
both on its record before it relies on the loop.

Source: the chapters "Computation" (constraint model, solver parameters, integrators) and "XML reference" of the
documentation of MuJoCo, https://mujoco.readthedocs.io.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.mjcf import loop_constants as at
from labsid.simulators.mjcf.gear_play import NO_PLAY, GearPlay, fold_play, split_play
from labsid.simulators.mjcf.loop_constants import FREE, MAX_IMPEDANCE, MIN_IMPEDANCE, stiffness_of

STANDING_SOLREF = (0.004, 1.0)
STANDING_SOLIMP = (0.999, 0.999, 0.001, 0.5, 2.0)
"""With these a joint that dry friction holds creeps by 1e-4 to 3e-4 rad/s at 0.65 of it; by default by 0.07."""
EQUAL = 1e-6  # relative difference of two numbers that are the same
CHANGES = (
    "friction",
    "transmitted",
    "peak",
    "stribeck",
    "damping",
    "drag",
    "armature",
    "stiffness",
    "cubic",
    "gravity_sin",
    "gravity_cos",
    "mass",
    "low",
    "high",
    "limit",
    "gain",
    "kv",
    "load",
    "onset",
    "wave_cos",
    "wave_sin",
    "frequency",
    "lag",
    "play",
    "seen_play",
    "contact_time",
    "start",
    "start_speed",
    "start_lag",
    "start_play",
)
"""Changes of a joint and its actuator, in SI units: `transmitted` is friction over the torque of the actuator, `peak`
the excess of friction at rest, which decays with the speed `stribeck`; `mass` sits at the end of the link; `low` and
`high` are stops, `limit` bounds the force of the actuator, `gain` is a relative change of its gain; `load` acts from
`onset` seconds on; `lag` is the time constant of an actuator that has no dynamics. `play` is the width of a play in the
gear behind the sensor, `seen_play` of one between the actuator and the sensor; the teeth come to rest within
`contact_time` seconds. `start` (from the default position), `start_speed`, `start_lag` (from the first command) and
`start_play` (share of the play, from its middle) are the initial state."""
SWITCHED_OFF = {
    "low": -FREE,
    "high": FREE,
    "limit": FREE,
    "stribeck": 1.0,
    "frequency": 1.0,
    "contact_time": 0.02,
}
PREFIX = "inside "  # ahead of the name of a change among the numbers of a simulation
NO_LINKS, NO_GRAVITY = np.zeros((1, 19)), np.zeros(3)  # of a single joint, whose constants hold both
DYNAMICS = ("none", "filter", "filterexact", "integrator")
OUTPUTS = ("position", "speed", "force")


@dataclass(frozen=True, slots=True, eq=False)
class OneJoint:
    """A model of one joint, in SI units.

    Attributes
    ----------
    joint, actuator, link : str
        Names.
    output : str
        "position", "speed" or "force" of the actuator.
    timestep : float
    slides : bool
        Whether the joint slides; otherwise it turns.
    inertia, armature : float
        Of everything that moves, and the part of it that is armature.
    gravity : tuple of float
        Torque on the joint: over sin q, cos q, and constant.
    mass : float
        Of everything that moves.
    tip : tuple of float
        Of a unit mass at the end of the link: inertia, and torque over sin q, cos q, and constant.
    position : float
        Position in the model's default configuration.
    passive : dict
        damping, drag, stiffness, springref, cubic, frictionloss.
    solref_friction, solimp_friction, solref_limit, solimp_limit : tuple of float
    range : tuple of float
        Stops of the model, and the margin at which they act.
    gear : float
    gain, bias : tuple of float
        Of the actuator: constant, over its length and over its speed.
    dynamics : str
        "none", "filter", "filterexact" or "integrator".
    time_constant : float
    ctrlrange, forcerange, actrange, jointrange : tuple of float
    implicit : bool
        Whether the integrator takes the derivatives of all forces by the speed, or of damping only.
    euler_damping : bool
        Whether Euler's method takes damping implicitly.
    delay : float
        Of the actuator, in seconds.
    geoms : tuple of str
        Names.
    """

    joint: str
    actuator: str
    link: str
    output: str
    timestep: float
    slides: bool
    inertia: float
    armature: float
    gravity: tuple[float, float, float]
    mass: float
    tip: tuple[float, float, float, float]
    position: float
    passive: Mapping[str, float]
    solref_friction: tuple[float, ...]
    solimp_friction: tuple[float, ...]
    solref_limit: tuple[float, ...]
    solimp_limit: tuple[float, ...]
    range: tuple[float, float, float]
    gear: float
    gain: tuple[float, float, float]
    bias: tuple[float, float, float]
    dynamics: str
    time_constant: float
    ctrlrange: tuple[float, float]
    forcerange: tuple[float, float]
    actrange: tuple[float, float]
    jointrange: tuple[float, float]
    implicit: bool
    euler_damping: bool = True
    delay: float = 0.0
    geoms: tuple[str, ...] = ()

    def run(self, t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> FloatArray:
        """Output for a command that is held between samples.

        Parameters
        ----------
        t, u : ndarray, shape (N,)
        numbers : mapping
            Numbers of the model by name, and changes by name behind `PREFIX`.

        Returns
        -------
        ndarray, shape (N,)
        """
        steps = substeps(float(t[1] - t[0]) if t.size > 1 else self.timestep, self.timestep)
        changes = changes_in(numbers)
        late, command = ceil(self.delay / self.timestep - 1e-9), np.ascontiguousarray(u, np.float64)
        if late:
            command = np.concatenate([np.full(late, u[0]), np.repeat(command, steps)[: u.size * steps - late]])
        motion = run_loop(
            command[:, None],
            1 if late else steps,
            self.timestep,
            np.array([self.position + changes["start"]]),
            np.array([changes["start_speed"]]),
            np.array([self.activation(float(u[0]), changes)]),
            self.constants(numbers, changes)[None, :],
            plays=[self.play(changes)],
        )
        return np.ascontiguousarray(motion[:: steps if late else 1, 0, OUTPUTS.index(self.output)])

    def activation(self, command: float, changes: Mapping[str, float]) -> float:
        """Initial state of the actuator: a filter has followed the first command, an integrator holds the position."""
        if self.dynamics == "integrator":
            first = self.gear * (self.position + changes["start"]) if self.kind == "position" else 0.0
        else:
            first = min(max(command, self.ctrlrange[0]), self.ctrlrange[1])
        return min(max(first + changes["start_lag"], self.actrange[0]), self.actrange[1])

    def play(self, changes: Mapping[str, float]) -> GearPlay:
        """The play in the gear, whose rotor has the armature of the joint."""
        width = max(changes["play"], changes["seen_play"])
        if width <= 0.0:
            return NO_PLAY
        contact = stiffness_of((changes["contact_time"], 1.0), self.solimp_limit, self.timestep)
        seen, armature = changes["seen_play"] > 0.0, self.armature + changes["armature"]
        return GearPlay(width, changes["start_play"] * width, seen, armature, contact, self.solimp_limit)

    def constants(self, numbers: Mapping[str, float], changes: Mapping[str, float]) -> FloatArray:
        """The array of constants of `run_loop`."""
        own = {key: numbers.get(f"{self.joint}:{key}", value) for key, value in self.passive.items()}
        armature = numbers.get(f"{self.joint}:armature", self.armature) + changes["armature"]
        scale = numbers.get(f"{self.link}:mass", self.mass) / self.mass if self.mass else 1.0
        at_tip, heavy = changes["mass"], [scale * own_part for own_part in self.gravity]
        held = changes["friction"] or changes["transmitted"] or changes["peak"]
        solref = STANDING_SOLREF if held else self.solref_friction
        solimp = STANDING_SOLIMP if held else self.solimp_friction
        friction_b, _ = stiffness_of(solref, solimp, self.timestep)
        limit_b, limit_k = stiffness_of(self.solref_limit, self.solimp_limit, self.timestep)
        gear = numbers.get(f"{self.actuator}:gear", self.gear)
        gain, bias = self._force(numbers, changes)
        c = np.empty(at.COUNT)
        c[at.INERTIA] = max(scale * (self.inertia - self.armature) + armature + at_tip * self.tip[0], 1e-12)
        c[at.DAMPING] = own["damping"] + changes["damping"]
        c[at.DRAG] = own["drag"] + changes["drag"]
        c[at.STIFFNESS], c[at.SPRINGREF] = own["stiffness"] + changes["stiffness"], own["springref"]
        c[at.CUBIC] = own["cubic"] + changes["cubic"]
        c[at.SIN] = heavy[0] + at_tip * self.tip[1] + changes["gravity_sin"]
        c[at.COS] = heavy[1] + at_tip * self.tip[2] + changes["gravity_cos"]
        c[at.CONSTANT] = heavy[2] + at_tip * self.tip[3]
        c[at.FRICTION] = max(own["frictionloss"] + changes["friction"], 0.0)
        c[at.TRANSMITTED], c[at.PEAK] = changes["transmitted"], changes["peak"]
        c[at.STRIBECK] = max(abs(changes["stribeck"]), 1e-9)
        c[at.FRICTION_B] = friction_b
        c[at.FRICTION_IMPEDANCE] = min(max(solimp[0], MIN_IMPEDANCE), MAX_IMPEDANCE)
        c[at.LOW] = max(self.range[0], changes["low"])
        c[at.HIGH] = min(self.range[1], changes["high"])
        c[at.MARGIN] = self.range[2]
        c[at.LIMIT_B], c[at.LIMIT_K] = limit_b, limit_k
        c[at.D0], c[at.D1] = np.clip(self.solimp_limit[:2], MIN_IMPEDANCE, MAX_IMPEDANCE)
        c[at.WIDTH], c[at.MID], c[at.POWER] = self.solimp_limit[2:]
        c[at.GEAR] = gear
        c[at.GAIN0 : at.GAIN2 + 1] = gain
        c[at.BIAS0 : at.BIAS2 + 1] = bias
        lag = changes["lag"] if self.dynamics == "none" else 0.0
        c[at.DYNAMICS] = DYNAMICS.index("filterexact" if lag > 0.0 else self.dynamics)
        c[at.TIME_CONSTANT] = max(lag or numbers.get(f"{self.actuator}:timeconst", self.time_constant), 1e-9)
        c[at.CTRL_LOW], c[at.CTRL_HIGH] = self.ctrlrange
        limit = abs(changes["limit"])
        most = numbers.get(f"{self.actuator}:forcelimit", self.forcerange[1])
        c[at.FORCE_LOW] = max(-most if self.symmetric else self.forcerange[0], -limit)
        c[at.FORCE_HIGH] = min(most if self.symmetric else self.forcerange[1], limit)
        c[at.ACT_LOW], c[at.ACT_HIGH] = self.actrange
        c[at.JOINT_LOW], c[at.JOINT_HIGH] = self.jointrange
        c[at.LOAD], c[at.ONSET] = changes["load"], changes["onset"]
        c[at.WAVE_COS], c[at.WAVE_SIN] = changes["wave_cos"], changes["wave_sin"]
        c[at.OMEGA] = 2.0 * np.pi * changes["frequency"]
        c[at.IMPLICIT] = 2.0 if self.implicit else float(self.euler_damping)
        return c

    def _force(self, numbers: Mapping[str, float], changes: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        """Gain and bias of the actuator with their changes."""
        gain, bias = np.array(self.gain), np.array(self.bias)
        if self.kind != "torque":
            name = {"position": "kp", "velocity": "kv"}[self.kind]
            ratio = numbers.get(f"{self.actuator}:{name}", gain[0]) / gain[0] + changes["gain"]
            column = 1 if self.kind == "position" else 2
            gain, bias[column] = gain * ratio, bias[column] * ratio
            if self.kind == "position":
                bias[2] = -numbers.get(f"{self.actuator}:kv", -bias[2])
        else:
            gain = gain * (numbers.get(f"{self.actuator}:gain", gain[0]) / (gain[0] or 1.0) + changes["gain"])
        bias[2] -= changes["kv"]
        return gain, bias

    @property
    def place(self) -> str:
        """Where effects are put, in words."""
        return f"the joint {self.joint}"

    @property
    def kind(self) -> str:
        """What the command is: "torque", "position" or "velocity"."""
        gain, bias = self.gain, self.bias
        if gain[0] and abs(gain[0] + bias[1]) < EQUAL * abs(gain[0]):
            return "position"
        if gain[0] and not bias[1] and abs(gain[0] + bias[2]) < EQUAL * abs(gain[0]):
            return "velocity"
        return "torque"

    @property
    def symmetric(self) -> bool:
        """Whether the force of the actuator is limited, to both sides alike."""
        return self.forcerange[1] < FREE and self.forcerange[0] == -self.forcerange[1]

    def nominal(self) -> dict[str, float]:
        """Numbers of the model that may be fitted, by name."""
        numbers = {f"{self.joint}:{key}": value for key, value in self.passive.items() if key != "springref"}
        numbers[f"{self.joint}:armature"] = self.armature
        if self.passive["stiffness"]:
            numbers[f"{self.joint}:springref"] = self.passive["springref"]
        if self.mass:
            numbers[f"{self.link}:mass"] = self.mass
        if not self.actuator:
            return numbers
        kind = self.kind
        own = {"position": ("kp", self.gain[0]), "velocity": ("kv", self.gain[0]), "torque": ("gain", self.gain[0])}
        numbers[f"{self.actuator}:{own[kind][0]}"] = own[kind][1]
        if kind == "position":
            numbers[f"{self.actuator}:kv"] = -self.bias[2]
        if self.dynamics in ("filter", "filterexact"):
            numbers[f"{self.actuator}:timeconst"] = self.time_constant
        if self.symmetric:
            numbers[f"{self.actuator}:forcelimit"] = self.forcerange[1]
        return numbers


def changes_in(numbers: Mapping[str, float], joint: str = "") -> dict[str, float]:
    """All changes by name, those without a number switched off; of one of several joints those with its name."""
    ahead = prefix_of(joint)
    return {name: numbers.get(ahead + name, SWITCHED_OFF.get(name, 0.0)) for name in CHANGES}


def prefix_of(joint: str = "") -> str:
    """What stands ahead of the name of a change among the numbers of a simulation; with one of several joints."""
    return f"{PREFIX}{joint}:" if joint else PREFIX


def substeps(Ts: float, timestep: float) -> int:
    """Steps of a model for each sample.

    Raises
    ------
    ValueError
        If the sampling time is no multiple of the timestep.
    """
    count = round(Ts / timestep)
    if count < 1 or abs(count * timestep - Ts) > 1e-3 * timestep * max(count, 1):
        near = Ts / max(count, 1)
        raise ValueError(
            f"the sampling time {Ts:g} s is no multiple of the timestep {timestep:g} s of the model. Set that to "
            f"{near:.6g}, or resample the record with --resample {max(count, 1) * timestep:g}."
        )
    return count


def run_loop(
    u: FloatArray,
    steps: int,
    h: float,
    q: FloatArray,
    v: FloatArray,
    act: FloatArray,
    c: FloatArray,
    links: FloatArray = NO_LINKS,
    gravity: FloatArray = NO_GRAVITY,
    plays: Sequence[GearPlay] = (),
) -> FloatArray:
    """Position, speed and force of the actuator of each joint at each sample, shape (N, n, 3).

    The arguments are those of the compiled loop, and the play in the gear of each joint; numba is loaded at the first
    call.
    """
    from labsid.simulators.mjcf._joint_loop import play_compiled

    if not any(one.width for one in plays):
        return np.asarray(play_compiled(u, steps, h, q, v, act, c, links, gravity))
    u, q, v, act, c, links, gravity = split_play(plays, u, q, v, act, c, links, gravity)
    return fold_play(plays, np.asarray(play_compiled(u, steps, h, q, v, act, c, links, gravity)))
