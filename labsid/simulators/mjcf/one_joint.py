"""A model of one joint as a compiled loop: the arithmetic of a MuJoCo step, with changes of the joint and its actuator.

MuJoCo takes 3 to 5 microseconds for a step of such a model, this loop 0.05. It holds for one hinge or slide with one
actuator at it, without contacts, tendons, equalities or fluid, and Euler's or an implicit integrator; a caller compares
both on its record before it relies on the loop.

Source: the chapters "Computation" (constraint model, solver parameters, integrators) and "XML reference" of the
documentation of MuJoCo, https://mujoco.readthedocs.io.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil

import numpy as np

from labsid._arrays import FloatArray

STANDING_SOLREF = (0.004, 1.0)
STANDING_SOLIMP = (0.999, 0.999, 0.001, 0.5, 2.0)
"""With these a joint that dry friction holds creeps by 1e-4 to 3e-4 rad/s at 0.65 of it; by default by 0.07."""
MIN_IMPEDANCE, MAX_IMPEDANCE = 1e-4, 0.9999
EQUAL = 1e-6  # relative difference of two numbers that are the same
FREE = 1e30  # of a limit that is none
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
    "start",
    "start_speed",
    "start_lag",
)
"""Changes of a joint and its actuator, in SI units: `transmitted` is friction over the torque of the actuator, `peak`
the excess of friction at rest, which decays with the speed `stribeck`; `mass` sits at the end of the link; `low` and
`high` are stops, `limit` bounds the force of the actuator, `gain` is a relative change of its gain; `load` acts from
`onset` seconds on; `lag` is the time constant of an actuator that has no dynamics. `start` (from the default position),
`start_speed`, and `start_lag` (from the first command) are the initial state."""
SWITCHED_OFF = {"low": -FREE, "high": FREE, "limit": FREE, "stribeck": 1.0, "frequency": 1.0}
PREFIX = "inside "  # ahead of the name of a change among the numbers of a simulation
NO_LINKS, NO_GRAVITY = np.zeros((1, 19)), np.zeros(3)  # of a single joint, whose constants hold both
DYNAMICS = ("none", "filter", "filterexact", "integrator")
OUTPUTS = ("position", "speed", "force")

# Places in the array of constants.
(
    _INERTIA,
    _DAMPING,
    _DRAG,
    _STIFFNESS,
    _SPRINGREF,
    _CUBIC,
    _SIN,
    _COS,
    _CONSTANT,
    _FRICTION,
    _TRANSMITTED,
    _PEAK,
    _STRIBECK,
    _FRICTION_B,
    _FRICTION_IMPEDANCE,
    _LOW,
    _HIGH,
    _MARGIN,
    _LIMIT_B,
    _LIMIT_K,
    _D0,
    _D1,
    _WIDTH,
    _MID,
    _POWER,
    _GEAR,
    _GAIN0,
    _GAIN1,
    _GAIN2,
    _BIAS0,
    _BIAS1,
    _BIAS2,
    _DYNAMICS,
    _TIME_CONSTANT,
    _CTRL_LOW,
    _CTRL_HIGH,
    _FORCE_LOW,
    _FORCE_HIGH,
    _ACT_LOW,
    _ACT_HIGH,
    _JOINT_LOW,
    _JOINT_HIGH,
    _LOAD,
    _ONSET,
    _WAVE_COS,
    _WAVE_SIN,
    _OMEGA,
    _IMPLICIT,
) = range(48)


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
        )
        return np.ascontiguousarray(motion[:: steps if late else 1, 0, OUTPUTS.index(self.output)])

    def activation(self, command: float, changes: Mapping[str, float]) -> float:
        """Initial state of the actuator: a filter has followed the first command, an integrator holds the position."""
        if self.dynamics == "integrator":
            first = self.gear * (self.position + changes["start"]) if self.kind == "position" else 0.0
        else:
            first = min(max(command, self.ctrlrange[0]), self.ctrlrange[1])
        return min(max(first + changes["start_lag"], self.actrange[0]), self.actrange[1])

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
        c = np.empty(48)
        c[_INERTIA] = max(scale * (self.inertia - self.armature) + armature + at_tip * self.tip[0], 1e-12)
        c[_DAMPING] = own["damping"] + changes["damping"]
        c[_DRAG] = own["drag"] + changes["drag"]
        c[_STIFFNESS], c[_SPRINGREF] = own["stiffness"] + changes["stiffness"], own["springref"]
        c[_CUBIC] = own["cubic"] + changes["cubic"]
        c[_SIN] = heavy[0] + at_tip * self.tip[1] + changes["gravity_sin"]
        c[_COS] = heavy[1] + at_tip * self.tip[2] + changes["gravity_cos"]
        c[_CONSTANT] = heavy[2] + at_tip * self.tip[3]
        c[_FRICTION] = max(own["frictionloss"] + changes["friction"], 0.0)
        c[_TRANSMITTED], c[_PEAK] = changes["transmitted"], changes["peak"]
        c[_STRIBECK] = max(abs(changes["stribeck"]), 1e-9)
        c[_FRICTION_B] = friction_b
        c[_FRICTION_IMPEDANCE] = min(max(solimp[0], MIN_IMPEDANCE), MAX_IMPEDANCE)
        c[_LOW] = max(self.range[0], changes["low"])
        c[_HIGH] = min(self.range[1], changes["high"])
        c[_MARGIN] = self.range[2]
        c[_LIMIT_B], c[_LIMIT_K] = limit_b, limit_k
        c[_D0], c[_D1] = np.clip(self.solimp_limit[:2], MIN_IMPEDANCE, MAX_IMPEDANCE)
        c[_WIDTH], c[_MID], c[_POWER] = self.solimp_limit[2:]
        c[_GEAR] = gear
        c[_GAIN0 : _GAIN2 + 1] = gain
        c[_BIAS0 : _BIAS2 + 1] = bias
        lag = changes["lag"] if self.dynamics == "none" else 0.0
        c[_DYNAMICS] = DYNAMICS.index("filterexact" if lag > 0.0 else self.dynamics)
        c[_TIME_CONSTANT] = max(lag or numbers.get(f"{self.actuator}:timeconst", self.time_constant), 1e-9)
        c[_CTRL_LOW], c[_CTRL_HIGH] = self.ctrlrange
        limit = abs(changes["limit"])
        most = numbers.get(f"{self.actuator}:forcelimit", self.forcerange[1])
        c[_FORCE_LOW] = max(-most if self.symmetric else self.forcerange[0], -limit)
        c[_FORCE_HIGH] = min(most if self.symmetric else self.forcerange[1], limit)
        c[_ACT_LOW], c[_ACT_HIGH] = self.actrange
        c[_JOINT_LOW], c[_JOINT_HIGH] = self.jointrange
        c[_LOAD], c[_ONSET] = changes["load"], changes["onset"]
        c[_WAVE_COS], c[_WAVE_SIN] = changes["wave_cos"], changes["wave_sin"]
        c[_OMEGA] = 2.0 * np.pi * changes["frequency"]
        c[_IMPLICIT] = 2.0 if self.implicit else float(self.euler_damping)
        return c

    def _force(self, numbers: Mapping[str, float], changes: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        """Gain and bias of the actuator with their changes."""
        gain, bias = np.array(self.gain), np.array(self.bias)
        if self.kind != "torque":
            name = {"position": "kp", "velocity": "kv"}[self.kind]
            ratio = numbers.get(f"{self.actuator}:{name}", gain[0]) / gain[0] + changes["gain"]
            at = 1 if self.kind == "position" else 2
            gain, bias[at] = gain * ratio, bias[at] * ratio
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


def stiffness_of(solref: tuple[float, ...], solimp: tuple[float, ...], timestep: float) -> tuple[float, float]:
    """Damping b and stiffness k of a constraint's reference acceleration."""
    most = min(max(solimp[1], MIN_IMPEDANCE), MAX_IMPEDANCE)
    if solref[0] <= 0.0:
        return -solref[1] / most, -solref[0] / most**2
    time_constant = max(solref[0], 2.0 * timestep)
    return 2.0 / (most * time_constant), 1.0 / (most * time_constant * solref[1]) ** 2


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
) -> FloatArray:
    """Position, speed and force of the actuator of each joint at each sample, shape (N, n, 3).

    The arguments are those of the compiled loop; numba is loaded at the first call.
    """
    from labsid.simulators.mjcf._joint_loop import play_compiled

    return np.asarray(play_compiled(u, steps, h, q, v, act, c, links, gravity))
