"""Texts on effects inside a simulation that opens: at which joint, and what of it."""

from typing import Any

from labsid.gap.effects.inside import MISMATCH
from labsid.gap.reports.quantities import Quantity, number

CLAUSES: dict[str, tuple[str, ...]] = {
    "coulomb-friction": (
        "At the joint {joint}, dry friction of {friction} opposes the motion, {break_away} from rest",
        "At the joint {joint}, dry friction of {friction} and {load:%} of the torque of its drive opposes the motion",
        "At the joint {joint}, dry friction of {friction} opposes the motion",
        "At the joint {joint}, dry friction of {load:%} of the torque of its drive opposes the motion",
        "At the joint {joint}, dry friction opposes the motion",
    ),
    "quadratic-drag": (
        "At the joint {joint}, a resistance of {drag} times the square of the speed opposes the motion",
        "At the joint {joint}, a resistance that grows with the square of the speed opposes the motion",
    ),
    "cubic-stiffness": (
        "At the joint {joint}, a spring gives {stiffness} times the cube of the displacement",
        "At the joint {joint}, a spring is not proportional to the displacement",
    ),
    "gravity": (
        "On the joint {joint}, a weight that the simulation lacks, or has wrong, gives up to {torque} towards {angle}",
        "On the joint {joint}, a weight acts that the simulation lacks, or has wrong",
    ),
    "end-stop": (
        "The joint {joint} runs against stops at {low} and at {high}",
        "The joint {joint} runs against a stop at {low}",
        "The joint {joint} runs against a stop at {high}",
        "The joint {joint} runs against a stop",
    ),
    "force-limit": (
        "The actuator {actuator} of the joint {joint} gives no more than {limit}",
        "The force of the actuator {actuator} of the joint {joint} is limited",
    ),
    "extra-lag": (
        "The actuator {actuator} of the joint {joint} has a lag of {tau}",
        "The actuator {actuator} of the joint {joint} has a lag",
    ),
    "load-step": (
        "From {onset} on, a load of {torque} acts on the joint {joint}",
        "A load acts on the joint {joint} from an instant on",
    ),
    "periodic-disturbance": (
        "A wave of {torque} at {frequency} acts on the joint {joint}",
        "A wave acts on the joint {joint}",
    ),
}
_FORCE = ("N m", "N")
INSIDE_LABELS: dict[str, dict[str, str]] = {
    "friction": dict.fromkeys(_FORCE, "friction"),
    "break_away": dict.fromkeys(_FORCE, "friction at rest"),
    "drag": dict.fromkeys(("N m s²/rad²", "N s²/m²"), "drag"),
    "torque": dict.fromkeys(_FORCE, "largest torque"),
    "limit": dict.fromkeys(_FORCE, "largest force of the actuator"),
    "stiffness": dict.fromkeys(("N m/rad³", "N/m³"), "force over the cube of the displacement"),
}
"""Labels of parameters in units of the joint, by unit."""
SIGNED = ("low", "high", "angle", "onset")  # positions, which may be near zero


def inside_clause(effect: dict[str, Any]) -> str:
    """What happens at the joint, without the full stop."""
    if effect["name"] == MISMATCH:
        return _numbers(effect["parameters"])
    known: dict[str, Any] = {"joint": effect["joint"], "actuator": effect["actuator"]}
    for name, entry in effect["parameters"].items():
        quantity = Quantity(entry["value"], entry["stderr"] or 0.0, entry["unit"])
        if name in SIGNED or quantity.stderr <= abs(quantity.value):
            known[name] = quantity
    for clause in CLAUSES.get(effect["name"], ()):
        try:
            return clause.format(**known)
        except KeyError:
            continue
    return f"The joint {effect['joint']} differs from the simulation"


def _numbers(parameters: dict[str, dict[str, Any]]) -> str:
    parts = [
        f"{name} is {Quantity(one['value'], one['stderr'] or 0.0, one['unit'])} in place of {number(one['nominal'])}"
        for name, one in parameters.items()
    ]
    return f"The number {' and '.join(parts)}"
