"""Texts on the effects: name, what the rig does, and where to look for the cause."""

from collections.abc import Callable
from dataclasses import dataclass
from string import Formatter
from typing import Any

from labsid.gap.effects.description import Reported
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.inside_texts import INSIDE_LABELS, inside_clause
from labsid.gap.reports.quantities import Quantity, number, percent, unit_in_words, with_error


def noun(name: str) -> str:
    """Name of an effect with its article; an unknown name is returned unchanged."""
    text = DESCRIPTIONS.get(name)
    return name if text is None else text.noun


def clause(effect: dict[str, Any]) -> str:
    """What the rig does, without the full stop."""
    if effect.get("joint") or effect.get("port"):
        return inside_clause(effect)
    text = DESCRIPTIONS.get(effect["name"])
    parameters = {} if text is None else text.parameters
    known: dict[str, Quantity] = {}
    for name, entry in effect["parameters"].items():
        quantity = Quantity(entry["value"], entry["stderr"] or 0.0, entry["unit"])
        position = name in parameters and parameters[name].position
        if not position and quantity.stderr >= abs(quantity.value):
            continue  # not significantly different from zero
        size = Quantity(abs(quantity.value), quantity.stderr, quantity.unit)
        sign = "+" if quantity.value >= 0.0 else "-"
        known |= {name: quantity, f"{name}_{entry.get('of', quantity.unit)}": quantity, f"{name}{sign}": size}
    for form in () if text is None else text.clauses:
        if all(field in known for _, field, _, _ in Formatter().parse(form) if field is not None):
            return form.format(**known)
    return f"The record shows {noun(effect['name'])}"


def parameter_label(effect: str, parameter: str, entry: dict[str, Any]) -> str:
    """Label of a parameter of an effect; a number of a given simulation keeps its name."""
    if "nominal" in entry:
        return f"{parameter}, nominally {number(entry['nominal'])}"
    if entry["unit"] in INSIDE_LABELS.get(parameter, {}):
        return INSIDE_LABELS[parameter][entry["unit"]]
    reported = _reported(effect, parameter)
    return parameter if reported is None else reported.labels.get(entry.get("of", entry["unit"]), reported.label)


def _reported(effect: str, parameter: str) -> Reported | None:
    """The description of a parameter; None for one that the effect does not have, as a number of a simulation."""
    text = DESCRIPTIONS.get(effect)
    return None if text is None else text.parameters.get(parameter)


def parameter_value(
    effect: str,
    parameter: str,
    entry: dict[str, Any],
    pair: dict[str, Any],
    write: Callable[[float, float | None], str] = with_error,
) -> tuple[str, str]:
    """A parameter's value as `write` gives it, by default with its standard error, and its unit in words.

    `pair` has the names and stated units of input and output, as far as they are known.
    """
    value, stderr, unit = entry["value"], entry["stderr"], entry["unit"]
    reported = _reported(effect, parameter)
    if unit == "1" and reported is not None and reported.share:
        if stderr:
            return write(100.0 * value, 100.0 * stderr), "%"
        return percent(value).removesuffix(" %"), "%"
    if not entry.get("determined", True):
        return write(value, stderr), "not determined by itself"
    if entry.get("at_limit"):
        return write(value, stderr), "at its limit"
    return write(value, stderr), unit_in_words(unit, pair)


def place_at(effect: dict[str, Any]) -> str:
    """Where an effect of several signals acts, as ``at valve``; empty in the dynamics, or for one signal."""
    if effect.get("from"):
        return f"from {effect['from']} to {effect['to']}"
    where = effect.get("signal") or effect.get("joint")
    return f"at {where}" if where else ""


def parameter_rows(effect: dict[str, Any], pair: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Label, value and unit of each parameter of an effect, with a mark on those that may be zero.

    `pair` is as in `parameter_value`.
    """
    sizes = [name for name in effect["parameters"] if not _is_place(effect["name"], name)]
    may_be_zero = [name for name in sizes if _may_be_zero(effect["parameters"][name])]
    mark = "determined together only" if may_be_zero == sizes and len(sizes) > 1 else "not told from zero"
    rows = []
    for name, entry in effect["parameters"].items():
        value, unit = parameter_value(effect["name"], name, entry, pair)
        limit = "at the limit of its search" if name in effect.get("at_limit", ()) else ""
        unit = ", ".join(text for text in (unit, mark if name in may_be_zero else "", limit) if text)
        rows.append((parameter_label(effect["name"], name, entry), value, unit))
    return rows


def _is_place(effect: str, parameter: str) -> bool:
    """Whether a parameter is a place or an instant, of which zero is one like others."""
    reported = _reported(effect, parameter)
    return reported is not None and reported.position


def _may_be_zero(entry: dict[str, Any]) -> bool:
    return bool((entry["stderr"] or 0.0) > abs(entry["value"]))


@dataclass(frozen=True, slots=True)
class RemainingErrorText:
    """Texts on a kind of error that an explanation leaves.

    Attributes
    ----------
    label : str
        Short name, as of a bar.
    what : str
        What the error does, as a predicate.
    look : str
        Where on the rig to look for its cause.
    """

    label: str
    what: str
    look: str


REMAINING_ERRORS: dict[str, RemainingErrorText] = {
    "linear": RemainingErrorText(
        "linear dynamics",
        "follows the input through further linear dynamics",
        "Look for a second volume, a flexible shaft, or a filter in the drive or the sensor. Without --sim, try a "
        "higher --order.",
    ),
    "input": RemainingErrorText(
        "a curve or hysteresis at the input",
        "follows the input through a curve or a hysteresis ahead of the process",
        "Measure the characteristic of the actuator, up and down: pump, valve or amplifier.",
    ),
    "output": RemainingErrorText(
        "a curve at the output",
        "follows the simulated output through a static curve",
        "Calibrate the sensor over its whole range.",
    ),
    "nonlinear": RemainingErrorText(
        "nonlinear dynamics",
        "follows the input through nonlinear dynamics",
        "Look for friction, stops, and resistances or gains that depend on the operating point.",
    ),
    "time": RemainingErrorText(
        "a change with time",
        "follows the input in a way that changes with time",
        "Compare the beginning with the end of the record: temperature, supply, wear, a second operator.",
    ),
    "disturbance": RemainingErrorText(
        "not predicted by the models tried",
        "is predicted by none of the models of past inputs that were tried",
        "Apply the same input again. What does not repeat is a disturbance: look for loads, other inputs and sensor "
        "noise. What repeats is an effect that these models lack.",
    ),
}
