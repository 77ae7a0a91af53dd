"""Step 8 of the gap: the effect, where in the loop it acts, and its parameters; only the judge can tell."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from labsid.checks.compare import as_number, kind_of
from labsid.checks.question import Ask
from labsid.checks.values import Unreadable
from labsid.checks.verdict import NoAnswer, Verdict
from labsid.lab.offset import first_period_length
from labsid.records.record import Record
from labsid.rig.switchable.withheld_effects import EFFECT_PARAMETERS, EFFECT_PATHS

if TYPE_CHECKING:
    from labsid.rig.switchable.withheld import WithheldRig

LEVEL = 0.02
"""Tolerance of a level, as a share of the range of its signal on the record."""
DELAY = 1.6
"""Tolerance of a delay (s): about two samples, as a free numerator can take one off it or put one on."""
CURVE = 0.08
"""Relative tolerance of a `c2`, and of the distance of `empty` from rest."""

_STOPS = {"input-saturation", "overflow", "output-saturation"}
_CURVES = {"input-nonlinearity", "sqrt-outflow", "output-nonlinearity"}
_NOTED = "is noted, and judged at grading. Your evidence is step 7."


def check_effect(ask: Ask) -> Verdict:
    """Step 8: the name of the effect."""
    got = _named_effect(ask)
    rig = _rig(ask)
    if rig is None:
        return Verdict(True, f"{got} {_NOTED}", noted=True)
    if got == rig.effect:
        return Verdict(True, "this is what your rig has.")
    for family, what, hint in (
        (_STOPS, "stops", "how the output comes to the flat stretch and how it leaves it"),
        (_CURVES, "curves", "the error of each on the held-out half, with the linear part refitted"),
    ):
        if {got, rig.effect} <= family:
            return Verdict(
                False,
                f"The shape is right, but your rig has another of the {what}: what tells them apart is {hint}.",
                f"another of the {what}",
            )
    return Verdict(
        False,
        "Your rig has another effect. Which one closes the gap on the held-out half, refitted together with the linear "
        "part?",
        "another effect",
    )


def check_path(ask: Ask) -> Verdict:
    """Step 8: where in the loop the effect acts."""
    got = _text("path", ask)
    places = sorted(set(EFFECT_PATHS.values()))
    if got in EFFECT_PATHS:
        raise NoAnswer(
            '`path` is the name of an effect: give the place, "input", "dynamics" or "output".', "effect for path"
        )
    if got not in places:
        raise NoAnswer(f"`path` is {got!r}; it should be one of {', '.join(places)}.", "not a path")
    rig = _rig(ask)
    if rig is None:
        named = EFFECT_PATHS[_named_effect(ask)]
        if got != named:
            return Verdict(False, "The effect that you named acts in another place: look at the list.", "another path")
        return Verdict(True, f"{got} {_NOTED}", noted=True)
    if got == rig.path:
        return Verdict(True, "this is where the effect acts.")
    if got == "output":
        return Verdict(
            False,
            "The gap shows at the output, as every gap does; what makes it acts before.",
            "where it shows for where it arises",
        )
    return Verdict(False, "The effect acts in another place in the loop.", "another path")


def check_parameters(ask: Ask) -> Verdict:
    """Step 8: the parameters of the effect, in volts and seconds."""
    value = ask.value("parameters")
    if isinstance(value, Unreadable) and value.kind == "dict":
        raise NoAnswer(
            "a key of `parameters` is no text. Each parameter has a key of its own, one text in quotes: "
            '`{"low": 1.2, "high": 3.4}`.',
            "names of parameters",
        )
    if not isinstance(value, Mapping):
        what = kind_of(value)
        if isinstance(value, np.ndarray) and value.ndim == 1:
            what = f"{value.size} numbers without keys"
        raise NoAnswer(
            '`parameters` should be a dictionary, with a key for each value, such as {"low": 1.2, "high": 3.4}; it is '
            f"{what}.",
            "not a dictionary",
        )
    rig = _rig(ask)
    wanted = EFFECT_PARAMETERS[_named_effect(ask) if rig is None else rig.effect]
    # a note of the unit beside the numbers is no parameter
    if {name for name, part in value.items() if not isinstance(part, str)} != set(wanted):
        texts = [name for name in wanted if isinstance(value.get(name), str)]
        if texts and rig is None:
            raise NoAnswer(
                f'`parameters["{texts[0]}"]` is text: give the number alone, without quotes and unit.',
                "text for a number",
            )
        if rig is None:
            names = ", ".join(f'"{name}"' for name in value) or "(none)"
            asked = ", ".join(f'"{name}"' for name in wanted)
            joined = [name for name in value if len([parameter for parameter in wanted if parameter in name]) > 1]
            apart = f' "{joined[0]}" is one key: each name has one of its own.' if joined else ""
            raise NoAnswer(
                f"`parameters` has the keys {names}; the list gives {asked} for the effect you named.{apart}",
                "names of parameters",
            )
        raise NoAnswer(
            "`parameters` does not have the names that the list gives for the effect of your rig.",
            "names of parameters",
        )
    got = {name: as_number(f'parameters["{name}"]', value[name]) for name in wanted}
    if rig is None:
        impossible = _impossible(got, _named_effect(ask), ask.record)
        if impossible is not None:
            return Verdict(False, *impossible)
        return Verdict(True, f"{', '.join(wanted)} noted. How near they are, grading tells.", noted=True)
    tolerance = _tolerances(rig, ask.record)

    def same(one: Mapping[str, float]) -> bool:
        return all(abs(one[name] - rig.parameters[name]) <= tolerance[name] for name in wanted)

    if same(got):
        return Verdict(True, "with these somebody could repair the rig.")
    for name, hint, mended in _slips(got, rig, ask.record):
        if same(mended):
            return Verdict(False, hint, name)
    return Verdict(False, f"{' and '.join(wanted)}: not within the tolerance of the question.")


def _impossible(got: Mapping[str, float], effect: str, record: Record) -> tuple[str, str] | None:
    """What no rig has, whatever its effect: what is wrong, and the name of the slip."""
    signal, x = ("u", record.u) if EFFECT_PATHS[effect] == "input" else ("y", record.y)
    rest = float(x[0]) if signal == "u" else float(np.mean(x[: first_period_length(record.u)]))
    low, high = float(np.min(x)), float(np.max(x))
    if "low" in got and got["low"] >= got["high"]:
        return f"`low` is {got['low']:.4g} and `high` {got['high']:.4g}: they are swapped.", "low and high swapped"
    for name in ("low", "high", "level"):
        if name in got and not low <= got[name] <= high and low <= got[name] + rest <= high:
            return (
                f"`{name}` is {got[name]:.4g}, and `{signal}_act` runs from {low:.3g} to {high:.3g} V: "
                f"this is a deviation from rest. Give the voltage itself, `{signal}_offset` included.",
                "offset left out",
            )
    if "low" in got and (got["high"] < low or got["low"] > high):
        return (
            f"`low` and `high` are {got['low']:.4g} and {got['high']:.4g}, and `{signal}_act` runs from {low:.3g} to "
            f"{high:.3g} V: both are outside. They are voltages of this signal.",
            "not in volts",
        )
    if "empty" in got and got["empty"] >= low:
        return (
            f"`empty` is {got['empty']:.4g} V, but your record goes down to {low:.3g} V: the sensor of "
            f"an empty tank shows less than that. (The distance from rest is not the level: take it off `y_offset`.)",
            "distance for level",
        )
    if "delay" in got and not 0 < got["delay"] < float(record.t[-1]) / 4:
        return f"`delay` is {got['delay']:.4g} s: a rig answers later, and within seconds.", "sign"
    return None


def _slips(got: Mapping[str, float], rig: "WithheldRig", record: Record) -> list[tuple[str, str, Mapping[str, float]]]:
    """What the answer would be if one thing in it were mended: name of the slip, hint, mended answer."""
    offset = record.u[0] if rig.path == "input" else rig.scales.y0
    slips: list[tuple[str, str, Mapping[str, float]]] = [
        (
            "offset left out",
            "`parameters` are deviations from rest: put the offset back on, so that they can be read at the rig.",
            {name: value + offset for name, value in got.items()},
        ),
        (
            "the other offset",
            "`parameters` have the offset of the other signal in them.",
            {name: value + record.u[0] - rig.scales.y0 for name, value in got.items()},
        ),
        (
            "the other offset",
            "`parameters` have the offset of the other signal in them.",
            {name: value - record.u[0] + rig.scales.y0 for name, value in got.items()},
        ),
        ("sign", "`parameters` have the wrong sign.", {name: -value for name, value in got.items()}),
        ("millivolts", "`parameters` are in millivolts.", {name: value / 1000 for name, value in got.items()}),
    ]
    if "delay" in got:
        slips.append(
            ("samples for seconds", "The delay is in samples: times `Ts`.", {"delay": got["delay"] * record.Ts})
        )
    if "low" in got:
        swapped = {"low": got["high"], "high": got["low"]}
        slips.append(("low and high swapped", "`low` and `high` are swapped.", swapped))
    if "empty" in got:
        slips.append(
            (
                "distance for level",
                "`empty` is the distance from rest down to the empty tank; give what the sensor would show there.",
                {"empty": rig.scales.y0 - got["empty"]},
            )
        )
    return slips


def _tolerances(rig: "WithheldRig", record: Record) -> dict[str, float]:
    level = LEVEL * float(np.ptp(record.u if rig.path == "input" else record.y))
    truth = rig.parameters
    every = {"delay": DELAY, "low": level, "high": level, "level": level}
    if "c2" in truth:
        every["c2"] = CURVE * abs(truth["c2"])
    if "empty" in truth:
        every["empty"] = CURVE * (rig.scales.y0 - truth["empty"])
    return every


def _named_effect(ask: Ask) -> str:
    said = _text("effect", ask)
    got = said.replace("_", "-").replace(" ", "-")
    if got not in EFFECT_PATHS:
        several = [name for name in EFFECT_PATHS if name in got]
        if len(several) > 1:
            text = f"`effect` names {len(several)} effects, {' and '.join(several)}: give one, as a text by itself."
            raise NoAnswer(text, "two effects")
        raise NoAnswer(
            f"`effect` is {said!r}, which is not in the list: {', '.join(EFFECT_PATHS)}.", "not a name of the list"
        )
    return got


def _text(name: str, ask: Ask) -> str:
    value = ask.value(name)
    if not isinstance(value, str):
        example = "input" if name == "path" else "input-delay"
        raise NoAnswer(
            f'`{name}` should be one text in quotes, such as "{example}"; it is {kind_of(value)}.', "not a text"
        )
    return value.strip().lower()


def _rig(ask: Ask) -> "WithheldRig | None":
    """The rig as only the judge can make it; None in the notebook."""
    if ask.origin is None:
        return None
    from labsid.rig.switchable.withheld import withheld_rig

    return withheld_rig(ask.origin.student, ask.origin.secret)
