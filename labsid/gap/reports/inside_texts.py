"""Texts on effects inside a simulation that opens: at which joint, or at the port of which class, and what of it."""

from typing import Any

from labsid.gap.effects.inside import MISMATCH
from labsid.gap.reports.quantities import Quantity, number

CLAUSES: dict[str, tuple[str, ...]] = {
    "coulomb-friction": (
        "At {place}, dry friction of {friction} opposes the motion, {break_away} from rest",
        "At {place}, dry friction of {friction} and {load:%} of the torque of its drive opposes the motion",
        "At {place}, dry friction of {friction} opposes the motion",
        "At {place}, dry friction of {load:%} of the torque of its drive opposes the motion",
        "At {place}, dry friction opposes the motion",
    ),
    "quadratic-drag": (
        "At {place}, a resistance of {drag} times the square of the speed opposes the motion",
        "At {place}, a resistance that grows with the square of the speed opposes the motion",
    ),
    "cubic-stiffness": (
        "At {place}, a spring gives {stiffness} times the cube of the displacement",
        "At {place}, a spring is not proportional to the displacement",
    ),
    "gravity": (
        "On {place}, a weight that the simulation lacks, or has wrong, gives up to {torque} towards {angle}",
        "On {place}, a weight acts that the simulation lacks, or has wrong",
    ),
    "end-stop": (
        "{mover} runs against stops at {low} and at {high}",
        "{mover} runs against a stop at {low}",
        "{mover} runs against a stop at {high}",
        "{mover} runs against a stop",
    ),
    "force-limit": (
        "{drive} gives no more than {limit}",
        "The force of {drive} is limited",
    ),
    "extra-lag": (
        "{drive} has a lag of {tau}",
        "{drive} has a lag",
    ),
    "input-backlash": (
        "{drive} moves it through a gear with a play of {width}",
        "{drive} moves it through a gear with a play",
    ),
    "load-step": (
        "From {onset} on, a load of {torque} acts on {place}",
        "A load acts on {place} from an instant on",
    ),
    "periodic-disturbance": (
        "A wave of {torque} at {frequency} acts on {place}",
        "A wave acts on {place}",
    ),
}
_FORCE = ("N m", "N", "units of force")
INSIDE_LABELS: dict[str, dict[str, str]] = {
    "friction": dict.fromkeys(_FORCE, "friction"),
    "break_away": dict.fromkeys(_FORCE, "friction at rest"),
    "width": dict.fromkeys(("rad", "m"), "play in the gear"),
    "drag": dict.fromkeys(("N m s²/rad²", "N s²/m²", "force s^2/y^2"), "drag"),
    "torque": dict.fromkeys(_FORCE, "largest torque"),
    "limit": dict.fromkeys(_FORCE, "largest force of the actuator"),
    "stiffness": dict.fromkeys(("N m/rad³", "N/m³", "force/y^3"), "force over the cube of the displacement"),
}
"""Labels of parameters in units of the joint, by unit."""
SIGNED = ("low", "high", "angle", "onset")  # positions, which may be near zero


def inside_clause(effect: dict[str, Any]) -> str:
    """What happens at the joint or the port, without the full stop."""
    port = effect.get("port")
    if effect["name"] == MISMATCH:
        return _numbers(effect["parameters"]) if port is None else _lacking(port, effect["parameters"])
    known: dict[str, Any] = _places_at(port) if port is not None else _places_of(effect["joint"], effect["actuator"])
    for name, entry in effect["parameters"].items():
        quantity = Quantity(entry["value"], entry["stderr"] or 0.0, entry["unit"])
        if name in SIGNED or quantity.stderr <= abs(quantity.value):
            known[name] = quantity
    for clause in CLAUSES.get(effect["name"], ()):
        try:
            return _capital(clause.format(**known))
        except KeyError:
            continue
    return _capital(f"{known['mover']} differs from the simulation")


def _places_of(joint: str, actuator: str) -> dict[str, str]:
    """What clauses call a joint and its actuator."""
    return {
        "place": f"the joint {joint}",
        "mover": f"the joint {joint}",
        "drive": f"the actuator {actuator} of the joint {joint}",
    }


def _places_at(stepper: str) -> dict[str, str]:
    """What clauses call a class that is stepped."""
    place = f"the port of {stepper}"
    return {"place": place, "mover": f"what moves at {place}", "drive": f"the command of {stepper}"}


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _lacking(stepper: str, parameters: dict[str, dict[str, Any]]) -> str:
    """What a class has too little or too much of."""
    parts = []
    for name, one in parameters.items():
        size = Quantity(abs(one["value"]), one["stderr"] or 0.0, one["unit"])
        parts.append(f"a {name} of {size} too {'little' if one['value'] > 0.0 else 'much'}")
    return f"At the port of {stepper}, the simulation has {' and '.join(parts)}"


def _numbers(parameters: dict[str, dict[str, Any]]) -> str:
    parts = [
        f"{name} is {Quantity(one['value'], one['stderr'] or 0.0, one['unit'])} in place of {number(one['nominal'])}"
        for name, one in parameters.items()
    ]
    return f"The number {' and '.join(parts)}"
