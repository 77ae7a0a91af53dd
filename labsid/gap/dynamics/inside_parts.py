"""Changes inside a simulation that opens: at its joint and at its actuator."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter

PREFIX = "inside "  # ahead of the name of a change among the numbers of a simulation
FAR = 50.0  # scaled: larger than any change that a record shows; numerics
FREQUENT = 1e7  # cycles in a record; numerics


@dataclass(frozen=True, slots=True)
class Part:
    """One parameter of a change.

    Attributes
    ----------
    change : str
        Name of the number in the simulation.
    unit : str
        Of the scaled parameter, among the units of an `InsidePort`.
    parameter : Parameter
    """

    change: str
    unit: str
    parameter: Parameter


def _part(change: str, unit: str, lower: float, upper: float, **others: float) -> Part:
    return Part(change, unit, Parameter(f"in_{change}", lower, upper, others.pop("step", 1e-3), **others))


def _play(change: str) -> tuple[Part, ...]:
    """Width of a play, the time in which its teeth come to rest, and the initial position in it."""
    return (
        Part(change, "position", Parameter(f"in_{change}", 0.0, 20.0, 1e-3, leap=0.03)),
        Part("contact_time", "sample", Parameter("log_contact", -4.0, 4.0, 1e-2)),
        Part("start_play", "one", Parameter("in_start_play", -0.5, 0.5, 1e-2)),
    )


FRICTION = Part("friction", "torque", Parameter("friction", 0.0, 20.0, 1e-3, leap=0.03))
PARTS: dict[str, tuple[Part, ...]] = {
    "friction": (FRICTION,),
    "transmitted": (_part("transmitted", "one", 0.0, 1.5),),
    "peak": (
        _part("peak", "torque", 0.0, 20.0),
        Part("stribeck", "speed", Parameter("log_stribeck", -6.0, 1.0, 1e-2, start=-2.0)),
    ),
    "damping": (_part("damping", "damping", -FAR, FAR),),
    "drag": (_part("drag", "drag", 0.0, 200.0),),
    "armature": (_part("armature", "inertia", -FAR, FAR),),
    "stiffness": (_part("stiffness", "stiffness", -FAR, FAR),),
    "cubic": (_part("cubic", "cubic", -FAR, FAR),),
    "gravity": (_part("gravity_sin", "torque", -FAR, FAR), _part("gravity_cos", "torque", -FAR, FAR)),
    "mass": (_part("mass", "mass", -FAR, FAR),),
    "gain": (_part("gain", "one", -5.0, 50.0),),
    "lag": (Part("lag", "sample", Parameter("log_lag", -4.0, 8.0, 1e-3)),),
    "low": (Part("low", "place", Parameter("stop_low", -FAR, FAR, 1e-3, leap=0.05)),),
    "high": (Part("high", "place", Parameter("stop_high", -FAR, FAR, 1e-3, leap=0.05)),),
    "limit": (Part("limit", "force", Parameter("limit", 1e-3, FAR, 1e-3, leap=0.05, start=FAR)),),
    "play": _play("play"),
    "seen_play": _play("seen_play"),
    "load": (
        Part("load", "torque", Parameter("load", -20.0, 20.0, 1e-3)),
        Part("onset", "span", Parameter("onset", 0.0, 1.0, 2e-4, leap=0.004)),
    ),
    "wave": (
        Part("frequency", "cycle", Parameter("cycles", 2.2, FREQUENT, 1e-3)),
        Part("wave_cos", "torque", Parameter("shake_cos", -20.0, 20.0, 1e-3)),
        Part("wave_sin", "torque", Parameter("shake_sin", -20.0, 20.0, 1e-3)),
    ),
}
"""The changes that effects switch on, with their parameters in theta."""
STATE_OF_ACTUATOR = Parameter("i0", -FAR, FAR, 1e-2)
STATES = (Parameter("z0", -FAR, FAR, 1e-3, leap=0.05), Parameter("v0", -FAR, FAR, 1e-3))
"""Initial position, from the model's default one, and initial speed."""
STATE_NUMBERS = {"z0": ("start", "position"), "v0": ("start_speed", "speed"), "i0": ("start_lag", "command")}
"""Name of the number in the simulation of each state, and its unit."""
IN_TIME = ("load", "wave")
UNITS_OF_A_STEPPER = {
    "torque": "units of force",
    "damping": "force s/y",
    "drag": "force s^2/y^2",
    "stiffness": "force/y",
    "cubic": "force/y^3",
    "position": "y",
    "speed": "y/s",
}


@dataclass(frozen=True, slots=True, eq=False)
class InsidePort:
    """Where effects are put inside a simulation: a joint and its actuator, or the port of a class that is stepped.

    Attributes
    ----------
    joint, actuator : str
        Names, for the report.
    kind : str
        What the command is: "torque", "position" or "velocity".
    slides : bool
        Whether the joint slides.
    units : dict
        Size of each scaled parameter, in the simulation's units, by the unit of a `Part`.
    place : float
        Position that is zero in scaled positions of stops.
    nominal : dict
        Numbers of the model by name.
    position : float
        Of the joint in its default configuration.
    names : dict
        Name in the model of each number that may be wrong.
    has_state : bool
        Whether the actuator has a state.
    reads : bool
        Whether the output is the position.
    scale : tuple of float
        Centre and unit of the output.
    forces : ndarray
        Sizes of the force of the actuator along the record, in the unit "force".
    stepper : str
        Of a class that is stepped its name, such as ``rig.py:Rig``; it has no joint that is known. Empty for a joint.
    unable : tuple of str
        Changes that cannot be made.
    takes_speed : bool
        Whether the initial speed can be chosen.
    prefix : str
        Ahead of the names of its changes among the numbers of the simulation.
    others : dict
        By name of each other joint of a model of several: sizes of its initial position and speed.
    samples : int, optional
        Of the output that it reads, the first of several; None of a single one.
    """

    joint: str
    actuator: str
    kind: str
    slides: bool
    units: Mapping[str, float]
    place: float
    nominal: Mapping[str, float]
    position: float = 0.0
    names: Mapping[str, str] = field(default_factory=dict)
    has_state: bool = False
    reads: bool = True
    scale: tuple[float, float] = (0.0, 1.0)
    forces: FloatArray = field(default_factory=lambda: np.ones(1))
    stepper: str = ""
    unable: tuple[str, ...] = ()
    takes_speed: bool = True
    prefix: str = PREFIX
    others: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    samples: int | None = None

    def to_json_dict(self) -> dict[str, Any]:
        """All but the forces along the record."""
        names = (one.name for one in fields(self) if one.name != "forces")
        return {name: value if not isinstance(value := getattr(self, name), Mapping) else dict(value) for name in names}

    def position_of(self, output: FloatArray) -> FloatArray:
        """Position of the joint for a scaled output that reads it."""
        return self.scale[0] + self.scale[1] * output

    def states(self, changes: Iterable[str]) -> tuple[Parameter, ...]:
        """Parameters of the initial state."""
        own = STATES if self.takes_speed else STATES[:1]
        further = tuple(replace(state, name=f"{state.name} {name}") for name in self.others for state in STATES)
        return (*own, *((STATE_OF_ACTUATOR,) if self.has_state or "lag" in changes else ()), *further)

    def makes(self, changes: Iterable[str]) -> bool:
        """Whether all of these changes can be made."""
        return not set(changes) & set(self.unable)

    def parameters(self, changes: Iterable[str]) -> tuple[Parameter, ...]:
        """Parameters in theta of these changes, and of the initial state."""
        return (*(part.parameter for change in changes for part in PARTS[change]), *self.states(changes))

    def value(self, part: Part, theta: float) -> float:
        """A number in the simulation's unit, for a parameter in theta."""
        if part.change in ("stribeck", "lag", "contact_time"):
            theta = float(np.exp(theta))
        return theta * self.units[part.unit] + (self.place if part.unit == "place" else 0.0)

    def numbers(self, changes: Iterable[str], theta: Iterable[float]) -> dict[str, float]:
        """Numbers of the simulation for the parameters of these changes, and of the initial state behind them."""
        parts = [part for change in changes for part in PARTS[change]]
        values = list(theta)
        found = {self.prefix + part.change: self.value(part, x) for part, x in zip(parts, values, strict=False)}
        states = values[len(parts) : len(parts) + len(self.states(changes))]
        for state, value in zip(self.states(changes), states, strict=True):
            name, size = self.state_number(state)
            found[name] = value * size
        return found

    def state_number(self, state: Parameter) -> tuple[str, float]:
        """The number of the simulation for a parameter of the initial state, and its size."""
        kind, _, other = state.name.partition(" ")
        name, unit = STATE_NUMBERS[kind]
        if other:
            return f"{PREFIX}{other}:{name}", self.others[other][unit == "speed"]
        return self.prefix + name, self.units[unit]

    def unit_of(self, what: str) -> str:
        """Unit in words: "torque", "damping", "inertia", "stiffness", "position" or "mass"."""
        if self.stepper:
            return UNITS_OF_A_STEPPER.get(what, "")
        turning = {
            "torque": "N m",
            "damping": "N m s/rad",
            "drag": "N m s²/rad²",
            "inertia": "kg m²",
            "stiffness": "N m/rad",
            "cubic": "N m/rad³",
            "position": "rad",
            "speed": "rad/s",
        }
        sliding = {
            "torque": "N",
            "damping": "N s/m",
            "drag": "N s²/m²",
            "inertia": "kg",
            "stiffness": "N/m",
            "cubic": "N/m³",
            "position": "m",
            "speed": "m/s",
        }
        return (sliding if self.slides else turning).get(what, {"mass": "kg"}.get(what, ""))


def port_from_json(content: Any) -> InsidePort:
    """Read what `InsidePort.to_json_dict` wrote.

    Raises
    ------
    ValueError
        If it has another form.
    """
    try:
        tuples = {name: tuple(content.get(name, ())) for name in ("scale", "unable")}
        return InsidePort(**{**content, **tuples, "forces": np.ones(1)})
    except (TypeError, KeyError):
        raise ValueError('not an exported simulation: its "port" has the wrong form. Export it again.') from None
