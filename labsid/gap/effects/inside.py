"""Effects inside a simulation that opens: at its joint and at its actuator."""

from collections.abc import Mapping
from itertools import product
from typing import Any, ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.inside_parts import PARTS, InsidePort
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import Effect, Fitted, PlantEffect, Value
from labsid.gap.effects.context import Context, ParentFit, Structure
from labsid.gap.effects.description import Description
from labsid.gap.effects.disturbance import StepLoad, load_starts
from labsid.gap.effects.motion import MIN_STOPPED
from labsid.gap.effects.periodic import residual_cycles

INSIDE = "joint"
MISMATCH = "parameter-mismatch"
FORCE_QUANTILES = (0.98, 0.85, 0.6)  # of the size of the force, from which limits start; numerics
SHRUNK = 0.7 ** np.arange(1, 13)  # shares of a number that does not act, from which it may act; numerics
WOKEN = 0.1  # of the error: what a number moves where it acts; numerics
CONTACT_TIME = 0.02  # s, in which contacts come to rest by default in MuJoCo (solref); definition
STOP_DEPTH = 0.02  # of the range of the motion: within it of its end, the joint is at a stop; set by hand


class Inside(PlantEffect):
    """A change at the joint or the actuator of a simulation that opens.

    `variant` is "joint", or "joint-" and a form of it. Variants that are `apart` are different causes of one name,
    each of which is fitted. One that is `everywhere` acts outside a simulation that opens, too.
    """

    before_given = True
    only_given = True
    variants: ClassVar[tuple[str, ...]] = (INSIDE,)
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    apart: ClassVar[bool] = False
    everywhere: ClassVar[bool] = False

    @property
    def changes(self) -> tuple[str, ...]:
        """Changes that it switches on."""
        return self.parts[self.variant]

    def applies(self, context: Context) -> bool:
        """Whether the simulation opens, and nothing else makes these changes."""
        plant = context.parent.hypothesis.plant
        port = plant.simulation.port
        return port is not None and port.makes(self.changes) and not set(self.changes) & set(plant.inside)

    def alternatives(self, hypothesis: Structure) -> list[Effect]:
        """Other forms of this effect that the simulation can make."""
        port = hypothesis.plant.simulation.port
        forms = (form for form in super().alternatives(hypothesis) if isinstance(form, Inside))
        return [form for form in forms if port is None or port.makes(form.changes)]

    def extend(self, plant: Plant) -> Plant:
        """The simulation with these changes."""
        if plant.simulation.port is None:
            return plant
        return plant.modified(inside=(*plant.inside, *self.changes))


def port_of(fit: ParentFit | Fitted) -> InsidePort:
    """Where effects are put inside the simulation of a fit, which opens."""
    port = fit.hypothesis.plant.simulation.port
    assert port is not None
    return port


def in_units(fit: Fitted, change: str) -> list[float]:
    """Values of a change in the units of the simulation."""
    return [port_of(fit).value(part, fit.value(part.parameter.name)) for part in PARTS[change]]


def woken_numbers(context: Context) -> dict[str, float]:
    """Values in theta at which free numbers of the simulation begin to act that do not where the search stands.

    A limit that the simulation never reaches has no derivative, so no fit would find it. With friction, it may act.
    """
    plant, own = context.parent.hypothesis.plant, context.parent.plant_theta.copy()
    w = context.actuator
    nominal = plant.simulation.run(w, plant.numbers(own))
    least = WOKEN * float(np.std(context.residual))

    def moved(i: int, theta: float) -> float:
        changed = own.copy()
        changed[i] = theta
        output = plant.simulation.run(w, plant.numbers(changed))
        return float(np.std(output - nominal)) if np.isfinite(output).all() else np.inf

    woken = {}
    for i, number in enumerate(plant.free):
        size = number.number(float(own[i]))
        if size == 0.0 or max(moved(i, own[i] + step) for step in (number.step, -number.step)) > 0.0:
            continue
        trials = (number.theta(size * share) for share in SHRUNK)
        acting = next((theta for theta in trials if theta >= number.lower and moved(i, theta) > least), None)
        if acting is not None:
            woken[number.name] = acting
    return woken


class Friction(Inside):
    """Dry friction of the joint; "joint-load" grows with the torque of the actuator, "joint-peak" breaks away."""

    name = "coulomb-friction"
    sizes = ("friction",)
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {
        INSIDE: ("friction",),
        "joint-load": ("friction", "transmitted"),
        "joint-peak": ("friction", "peak"),
    }
    richer: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("joint-load", "joint-peak")}
    planted_variants = ()

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Weak to strong friction, also with idle numbers where they begin to act."""
        more = {"joint-load": {"in_transmitted": 0.1}, "joint-peak": {"in_peak": 0.1}}.get(self.variant, {})
        woken = [{}, awake] if (awake := woken_numbers(context)) else [{}]
        return [{"friction": size} | more | numbers for numbers in woken for size in (0.05, 0.2, 0.6)]

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Begin with a little of what this form adds."""
        for name in ("in_transmitted", "in_peak"):
            if name in (own := [parameter.name for parameter in hypothesis.plant.parameters]):
                theta[hypothesis.slices["plant"].start + own.index(name)] = 0.05

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`friction`, and `load`, its share of the torque of the actuator, or `break_away` from rest."""
        torque = port_of(fit).unit_of("torque")
        (sliding,) = in_units(fit, "friction")
        found = {"friction": Value(sliding, torque)}
        if self.variant == "joint-load":
            found["load"] = Value(in_units(fit, "transmitted")[0], "1")
        if self.variant == "joint-peak":
            found["break_away"] = Value(sliding + in_units(fit, "peak")[0], torque)
        return found


class Drag(Inside):
    """Resistance with the square of the joint's speed."""

    name = "quadratic-drag"
    sizes = ("in_drag",)
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("drag",)}

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Weak and strong drag."""
        return [{"in_drag": size} for size in (0.05, 0.5)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`drag`."""
        return {"drag": Value(in_units(fit, "drag")[0], port_of(fit).unit_of("drag"))}


class Spring(Inside):
    """A force with the cube of the joint's distance from the rest of its spring."""

    name = "cubic-stiffness"
    sizes = ("in_cubic",)
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("cubic",)}

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Hardening and softening."""
        return [{"in_cubic": size} for size in (0.05, 0.5, -0.02)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`stiffness`, of the cube."""
        return {"stiffness": Value(in_units(fit, "cubic")[0], port_of(fit).unit_of("cubic"))}


class Gravity(Inside):
    """A torque with the sine of the joint's angle, that the simulation lacks or has wrong."""

    name = "gravity"
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("gravity",)}

    def applies(self, context: Context) -> bool:
        """A joint that turns."""
        return super().applies(context) and not port_of(context.parent).slides

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Weak and strong torques towards four angles."""
        directions = [(-1.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        return [
            {"in_gravity_sin": size * sine, "in_gravity_cos": size * cosine}
            for size, (sine, cosine) in product((0.1, 0.6), directions)
        ]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`torque`, and the `angle` of rest at which it vanishes."""
        sine, cosine = in_units(fit, "gravity")
        port = port_of(fit)
        angle = float(np.arctan2(cosine, -sine))
        return {
            "torque": Value(float(np.hypot(sine, cosine)), port.unit_of("torque")),
            "angle": Value(angle, port.unit_of("position")),
        }


class EndStop(Inside):
    """A stop of the joint, "joint-low", "joint-high" or both."""

    name = "end-stop"
    variants: ClassVar[tuple[str, ...]] = ("joint-high", "joint-low")
    richer: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "joint-high": ("joint-both",),
        "joint-low": ("joint-both",),
    }
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "joint-high": ("high",),
        "joint-low": ("low",),
        "joint-both": ("low", "high"),
    }
    absent: ClassVar[Mapping[str, float]] = {"stop_low": -50.0, "stop_high": 50.0}

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Stops at the ends of the motion, and 5 and 20 % of its range within them."""
        port, data = port_of(context.parent), context.data.first_output
        position = port.position_of(data.y[data.rows]) if port.reads else None
        if position is None:
            return [{f"stop_{side}": sign * at for side, sign in self._sides()} for at in (0.9, 0.6, 0.3)]
        low, high = np.quantile((position - port.place) / port.units["place"], (0.005, 0.995))
        ends = {"low": (low, 1.0), "high": (high, -1.0)}
        return [
            {f"stop_{side}": ends[side][0] + ends[side][1] * part * (high - low) for side, _ in self._sides()}
            for part in (0.0, 0.05, 0.2)
        ]

    def _sides(self) -> list[tuple[str, float]]:
        return [(side, {"low": -1.0, "high": 1.0}[side]) for side in self.changes]

    def carry_over(self, fit: ParentFit, hypothesis: Structure, theta: FloatArray) -> None:
        """Begin a second stop at the end of the motion on its side."""
        before, now = fit.hypothesis.plant, hypothesis.plant
        port = now.simulation.port
        new = [name for name in ("low", "high") if name in now.inside and name not in before.inside]
        if port is None or len(new) != 1 or not {"low", "high"} & set(before.inside) or not port.reads:
            return
        y = port.position_of(fit.output[: port.samples])
        at = np.quantile(y, 0.02 if new[0] == "low" else 0.98)
        theta[hypothesis.slices["plant"].start + now.index(f"stop_{new[0]}")] = (at - port.place) / port.units["place"]

    def active_samples(self, fit: Fitted) -> np.ndarray:
        """The samples at which the joint is at a stop."""
        port = port_of(fit)
        if not port.reads:
            return np.zeros(fit.data.samples, bool)
        own = fit.data.first_output.samples
        position = port.position_of(fit.output[:own] - fit.gains[1])
        depth = STOP_DEPTH * float(np.ptp(position))
        at = np.zeros(fit.data.samples, bool)
        for side, sign in self._sides():
            at[:own] |= sign * (position - in_units(fit, side)[0]) > -depth
        return at

    def is_plausible(self, fit: Fitted) -> bool:
        """Require that the joint reaches a stop."""
        return not port_of(fit).reads or bool(self.active_samples(fit).sum() >= MIN_STOPPED)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`low` and `high`."""
        unit = port_of(fit).unit_of("position")
        return {side: Value(in_units(fit, side)[0], unit) for side, _ in self._sides()}


class ForceLimit(Inside):
    """The force of a position or velocity servo is bounded."""

    name = "force-limit"
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("limit",)}
    absent: ClassVar[Mapping[str, float]] = {"limit": 50.0}

    def applies(self, context: Context) -> bool:
        """A servo: a bounded torque is a bounded command."""
        return super().applies(context) and port_of(context.parent).kind != "torque"

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Limits that the force of the simulation exceeds seldom and often."""
        forces = port_of(context.parent).forces
        return [{"limit": float(np.quantile(forces, share))} for share in FORCE_QUANTILES]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`limit`, of the actuator."""
        return {"limit": Value(in_units(fit, "limit")[0], port_of(fit).unit_of("torque"))}


class Lag(Inside):
    """A lag of the actuator, if the simulation has none."""

    name = "extra-lag"
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("lag",)}

    def applies(self, context: Context) -> bool:
        """An actuator without dynamics: those of another one have a time constant that may be wrong."""
        return super().applies(context) and not port_of(context.parent).has_state

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Short to long lags, in samples."""
        return [{"log_lag": float(np.log(samples))} for samples in (1.0, 4.0, 16.0)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`tau` in seconds."""
        return {"tau": Value(in_units(fit, "lag")[0], "s")}


class Play(Inside):
    """A play in the gear, which its sensor does not see, or "joint-seen" does: the link moves freely within it.

    A play ahead of the drive, in the command, is another form of the same name.
    """

    name = "input-backlash"
    everywhere = True
    variants: ClassVar[tuple[str, ...]] = (INSIDE, "joint-seen")
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("play",), "joint-seen": ("seen_play",)}

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Narrow and wide plays, with the contacts that MuJoCo has by default."""
        contact = float(np.log(CONTACT_TIME / port_of(context.parent).units["sample"]))
        (change,) = self.changes
        return [{f"in_{change}": width, "log_contact": contact} for width in (0.05, 0.2, 0.6)]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`width`."""
        return {"width": Value(in_units(fit, self.changes[0])[0], port_of(fit).unit_of("position"))}


class Load(Inside, StepLoad):
    """A force on the joint that begins at an instant."""

    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("load",)}

    def applies(self, context: Context) -> bool:
        """In one record: a load belongs to a record."""
        return super().applies(context) and not context.data.pieces

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Onsets at which a load step reduces the residual most, of either sign."""
        return load_starts(context.of_first_output)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`onset` in seconds, and `torque`."""
        size, onset = in_units(fit, "load")
        return {"onset": Value(onset + fit.data.start, "s"), "torque": Value(size, port_of(fit).unit_of("torque"))}


class Wave(Inside):
    """A sinusoidal force on the joint."""

    name = "periodic-disturbance"
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {INSIDE: ("wave",)}

    def applies(self, context: Context) -> bool:
        """In one record: its phase belongs to a record."""
        return super().applies(context) and not context.data.pieces

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """The highest narrow peaks in the spectrum of the residual, of two phases."""
        return [
            {"cycles": at, "shake_cos": cosine, "shake_sin": sine}
            for at in residual_cycles(context.of_first_output)
            for cosine, sine in ((0.1, 0.0), (0.0, 0.1), (-0.1, 0.0), (0.0, -0.1))
        ]

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`frequency` and `torque`."""
        frequency, cosine, sine = in_units(fit, "wave")
        torque = Value(float(np.hypot(cosine, sine)), port_of(fit).unit_of("torque"))
        return {"frequency": Value(frequency, "Hz"), "torque": torque}


class Mismatch(Inside):
    """A number of the joint or its actuator that is wrong; `variant` is "joint-" and what is wrong."""

    name = MISMATCH
    description = Description(
        path="parameters",
        noun="a parameter mismatch",
        clauses=("The structure of the simulation is right, but its parameters are wrong",),
        meaning="With refitted coefficients the simulation reproduces the record; no effect has to be added.",
        excited_by="An input that excites the rig as a linear model needs it; only with --sim.",
        confused_with=("extra-lag",),
        given_only=True,
    )
    variants: ClassVar[tuple[str, ...]] = tuple(
        f"joint-{what}" for what in ("damping", "armature", "stiffness", "gain", "mass")
    )
    apart = True
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {
        f"joint-{what}": (what,) for what in ("damping", "armature", "stiffness", "gain", "mass")
    }

    @property
    def what(self) -> str:
        """The number that is wrong."""
        return self.changes[0]

    def applies(self, context: Context) -> bool:
        """Whether none of the numbers is free anyway."""
        return super().applies(context) and not context.parent.hypothesis.plant.free

    def plant_starts(self, context: Context) -> list[dict[str, float]]:
        """Larger and smaller numbers."""
        return [{f"in_{self.what}": size} for size in (0.1, 0.6, -0.1, -0.4)]

    def is_plausible(self, fit: Fitted) -> bool:
        """Require a number that may be: no negative damping, inertia, mass or gain, where all of it is known."""
        (value,) = self.values(fit).values()
        return self.what == "stiffness" or value.value > 0.0 or bool(port_of(fit).stepper)

    def values(self, fit: Fitted) -> dict[str, Value]:
        """The number, under its name in the model; of a class that is stepped what it lacks of it."""
        port, (change,) = port_of(fit), in_units(fit, self.what)
        if port.stepper:
            return {self.what: Value(change, port.unit_of(self.what))}
        name = port.names[self.what]
        nominal = port.nominal[name]
        if self.what == "gain":
            return {name: Value(nominal * (1.0 + change), "")}
        unit = {"armature": "inertia"}.get(self.what, self.what)
        return {name: Value(nominal + change, port.unit_of(unit))}


def place_inside(fit: ParentFit, effect: Effect | None) -> dict[str, Any]:
    """The `joint` and the `actuator`, or the `port`, at which an effect acts; empty for one outside a simulation."""
    port = fit.hypothesis.plant.simulation.port
    if port is None or not isinstance(effect, Inside):
        return {}
    return {"port": port.stepper} if port.stepper else {"joint": port.joint, "actuator": port.actuator}


def with_nominal(fit: ParentFit, parameters: dict[str, dict[str, object]]) -> dict[str, dict[str, object]]:
    """Parameters of an effect; numbers of a simulation that opens with their nominal values."""
    port = fit.hypothesis.plant.simulation.port
    nominal = {} if port is None else port.nominal
    return {name: entry | ({"nominal": nominal[name]} if name in nominal else {}) for name, entry in parameters.items()}


def is_apart(family: type[Effect]) -> bool:
    """Whether the forms of a family are different causes of one name."""
    return issubclass(family, Inside) and family.apart


FAMILIES: tuple[type[Inside], ...] = (
    Friction,
    Drag,
    Spring,
    Gravity,
    EndStop,
    ForceLimit,
    Lag,
    Play,
    Load,
    Wave,
    Mismatch,
)
"""In the order of the search."""
INSIDE_NAMES = frozenset(family.name for family in FAMILIES if not family.everywhere)
"""Effects that act inside a simulation that opens, and not around it."""
