"""Texts on the effects: name, what the rig does, and where to look for the cause."""

from dataclasses import dataclass
from string import Formatter
from typing import Any

from labsid.gap.reports.inside_texts import INSIDE_LABELS, inside_clause
from labsid.gap.reports.quantities import UNITS, Quantity, number, percent, with_error


@dataclass(frozen=True, slots=True)
class EffectText:
    """Texts on one effect.

    Attributes
    ----------
    noun : str
        Name with its article.
    clauses : tuple of str
        What the rig does, with parameters in braces. The first clause whose parameters are all known is used.
        ``{size_y}`` is `size` in the unit y; ``{cubic+}`` and ``{cubic-}`` are the magnitude of a positive or negative
        `cubic`.
    meaning : str
        Explanation for a reader who does not know the effect, and parts of the rig to check.
    """

    noun: str
    clauses: tuple[str, ...]
    meaning: str


EFFECT_TEXTS: dict[str, EffectText] = {
    "input-delay": EffectText(
        "a transport delay",
        ("The rig responds to each command {delay} late", "The rig responds to each command late"),
        "The command reaches the process after this delay, in addition to the one sample of every sampled system. "
        "Look for pipes, belts, buses and buffers.",
    ),
    "input-saturation": EffectText(
        "a limit of the actuator",
        (
            "The actuator saturates at {low} and at {high}",
            "The actuator goes no lower than {low}",
            "The actuator goes no higher than {high}",
            "The actuator saturates within the range of the command",
        ),
        "Commands beyond the limit have the same effect as the limit. Check end stops, supply voltage and "
        "limits in the amplifier or its software.",
    ),
    "input-dead-zone": EffectText(
        "a dead zone",
        (
            "The actuator does not move between {low} and {high}",
            "The actuator does not move until the command exceeds {high}",
            "The actuator does not move until the command falls below {low}",
            "The actuator does not move until the command leaves a band",
        ),
        "Commands inside the band have no effect. Look for valve overlap, friction in the drive, or a threshold in "
        "the amplifier.",
    ),
    "input-backlash": EffectText(
        "backlash",
        (
            "The actuator crosses a play of {width} at each change of direction",
            "The actuator crosses a play at each change of direction",
        ),
        "After each change of direction the command must cross the play before the actuator follows. Check gears, "
        "couplings and valve stems.",
    ),
    "input-rate-limit": EffectText(
        "a rate limit of the actuator",
        (
            "The actuator moves no faster than {rate}",
            "The actuator moves more slowly than the command",
        ),
        "The actuator follows fast changes of the command at a limited rate. Check motor-driven valves and ramps in "
        "the drive's software.",
    ),
    "input-nonlinearity": EffectText(
        "a curved characteristic of the actuator",
        ("The gain of the actuator changes with the size of the command",),
        "The same step of the command has more effect in one part of its range than in another. Check the "
        "characteristic of the pump, the valve or the amplifier. With d the command minus the centre of the curve, the "
        "actuator gives d + (quadratic coefficient) d² + (cubic coefficient) d³.",
    ),
    "input-off": EffectText(
        "a command that is not applied",
        (
            "From {onset} to {end}, {level} acts instead of the command in the log",
            "From {onset} on, {level} acts instead of the command in the log",
            "For a part of the record the command is logged but not applied",
        ),
        "The log goes on with the command, and the rig does not get it: a drive that has tripped, an emergency stop, a "
        "loose cable, a set point that is frozen. Check the state of the drive during this time.",
    ),
    "input-quantization": EffectText(
        "a command that acts in coarse steps",
        ("The command acts in steps of {step}, which its log does not have", "The command acts in coarse steps"),
        "The command is rounded between the log and the rig. Look for a converter with few bits, a number that is sent "
        "as an integer, or a valve with notches.",
    ),
    "extra-lag": EffectText(
        "an extra lag",
        (
            "There is an additional lag of {tau} between command and record",
            "There is an additional lag between command and record",
        ),
        "Actuator, process, sensor or a filter smooths the signal with this time constant; the record does not show "
        "which.",
    ),
    "resonance": EffectText(
        "a lightly damped mode",
        ("The rig oscillates at {frequency} with a damping ratio of {damping}", "The rig oscillates after each change"),
        "Each change of the input or load excites a decaying oscillation. Look for flexible shafts, belts, supports, "
        "or sloshing.",
    ),
    "sqrt-outflow": EffectText(
        "a square-root outflow",
        ("The outflow is proportional to the square root of the level, not to the level",),
        "Torricelli's law: per unit of level, the outflow of a full tank changes less than that of a nearly empty "
        "one, so gain and time constant increase with the level. The parameters are the command without inflow and "
        "the sensor reading of the empty tank. Both may lie far outside the record.",
    ),
    "overflow": EffectText(
        "an overflow",
        ("A tank overflows at {level}", "A tank overflows"),
        "Inflow beyond the brim is lost or runs into the next tank. The brim is given as the reading at which the "
        "sensor would settle if the tank stayed just full. The next tank receives all of the overflow (100 %), none "
        "(0 %) or a part.",
    ),
    "coulomb-friction": EffectText(
        "dry friction",
        (
            "Motion starts only when the command overcomes dry friction of {friction}",
            "Dry friction opposes the motion",
        ),
        "A force of constant magnitude opposes every motion: small commands have no effect, and the motion stops "
        "early. Check bearings, seals and guides.",
    ),
    "cubic-stiffness": EffectText(
        "a nonlinear spring",
        (
            "The stiffness increases by {cubic+} times the square of the displacement",
            "The stiffness decreases by {cubic-} times the square of the displacement",
            "The restoring force is not proportional to the displacement",
        ),
        "Far from rest the rig is stiffer, or softer, than near rest. Check springs near the end of their travel and "
        "flexible parts.",
    ),
    "end-stop": EffectText(
        "an end stop",
        (
            "The motion runs against stops at {low} and at {high}",
            "The motion runs against a stop at {low}",
            "The motion runs against a stop at {high}",
            "The motion runs against a stop",
        ),
        "A moving part hits a mechanical stop, loses its speed there, and moves back as soon as the force turns. Look "
        "for the ends of slides, cylinders and valve stems, and for cables that are too short.",
    ),
    "quadratic-drag": EffectText(
        "a quadratic drag",
        (
            "A resistance of {drag} times the square of the speed opposes the motion",
            "A resistance that grows with the square of the speed opposes the motion",
        ),
        "The faster the motion, the more the rig is damped: twice the speed meets four times the resistance. Look for "
        "fans, propellers, fluid pushed through a narrow passage, and parts that move in air or water.",
    ),
    "gravity": EffectText(
        "gravity",
        (
            "A weight turns the joint towards {angle} with a torque of up to {torque}",
            "A weight turns the joint towards its angle of rest",
        ),
        "The torque is proportional to the sine of the angle between the joint and its rest. It is given as the "
        "command that holds it. Look for an arm or a load off the axis that the simulation lacks, or a wrong mass or "
        "centre of mass.",
    ),
    "force-limit": EffectText(
        "a limit in the loop of the drive",
        (
            "The drive gives no more force once the error of its loop exceeds {limit}",
            "The force of the drive is limited",
        ),
        "The loop inside the drive runs into the largest current or voltage: the command is reached later, not cut "
        "off. Check the limits of current, voltage and duty cycle in the drive, and the supply.",
    ),
    "slow-mode": EffectText(
        "a slow mode",
        (
            "A share of {share:%} of the response comes with a time constant of {tau}",
            "A part of the response comes much later than the rest",
        ),
        "After each step the output goes on creeping when the fast response has ended, or back, if the share is "
        "negative. Look for parts that warm up, creep of polymers, and a second volume beside the first.",
    ),
    "parameter-drift": EffectText(
        "a drift of the parameters",
        (
            "The gain of the rig changes by {drift:%} over the record",
            "The speed of response changes by {pole:%} over the record",
            "The parameters of the rig change slowly over the record",
        ),
        "The same command has a different effect at the end of the record than at the beginning. Check temperature, "
        "supply, wear and filling.",
    ),
    "output-drift": EffectText(
        "a drift of the sensor",
        ("The zero of the sensor drifts by ±{amplitude}", "The zero of the sensor drifts"),
        "The reading changes slowly, independent of the command. Check warm-up, temperature and the sensor's supply.",
    ),
    "output-saturation": EffectText(
        "a clipping sensor",
        (
            "The sensor clips below {low} and above {high}",
            "The sensor clips below {low}",
            "The sensor clips above {high}",
            "The sensor clips at the end of its range",
        ),
        "The process continues beyond the limit of the reading. Check the ranges of the sensor and of the converter.",
    ),
    "output-nonlinearity": EffectText(
        "a curved characteristic of the sensor",
        (
            "The sensor reads how far the output is from {fold}, but not on which side",
            "The gain of the sensor changes over its range",
        ),
        "The same change of the process gives a larger reading in one part of the range than in another. Check the "
        "calibration. A pulse counter, for example, reads the absolute value of a speed. With d the true output minus "
        "the centre of the curve, the sensor reads d + (quadratic coefficient) d² + (cubic coefficient) d³.",
    ),
    "output-backlash": EffectText(
        "a play of the sensor",
        (
            "The sensor crosses a play of {width} at each change of direction",
            "The sensor crosses a play at each change of direction",
        ),
        "After each change of direction the process moves through the play before the reading follows. Check the "
        "coupling of the sensor: gears, levers, cords and floats.",
    ),
    "output-quantization": EffectText(
        "a coarse converter",
        ("The output is quantised in steps of {step}", "The output is quantised in coarse steps"),
        "The record contains only multiples of the step, so smaller changes are lost. Check the resolution of the "
        "converter and rounding in the logger.",
    ),
    "output-outliers": EffectText(
        "a spiking sensor",
        ("Of the readings, {share:%} are isolated spikes", "Some readings are isolated spikes"),
        "Isolated samples that the process cannot have produced. The fits exclude them. Check for loose contacts and "
        "electrical interference.",
    ),
    "output-dropout": EffectText(
        "a logger that holds its last value",
        (
            "The logger repeats its last value over {share:%} of the record",
            "The logger repeats its last value over stretches of the record",
        ),
        "Where a new reading was missing, the logger wrote the last one again. The fits exclude these samples. Check "
        "the connection and the load of the logging computer.",
    ),
    "load-step": EffectText(
        "a load step",
        (
            "An unmeasured load starts at {onset} and changes the output by {size_y}",
            "An unmeasured load starts at {onset} and raises the rate of return to rest by {size_1:%}, as a leak does",
            "An unmeasured load starts at {onset}",
            "An unmeasured load starts during the record",
        ),
        "From this time on a further input acts on the process, such as an opened valve, a leak or an added weight.",
    ),
    "periodic-disturbance": EffectText(
        "a periodic disturbance",
        (
            "The output oscillates at {frequency} with amplitude {amplitude}, independent of the command",
            "The output oscillates, independent of the command",
        ),
        "A steady oscillation that the command does not cause. Check pumps, fans, mains hum and nearby machines.",
    ),
    "coloured-noise": EffectText(
        "coloured noise",
        (
            "The output contains noise of {amplitude} rms that is correlated over many samples",
            "The output contains noise that is correlated over many samples",
        ),
        "A random disturbance that keeps its sign for many samples. It does not depend on the input, so no simulation "
        "can reproduce it; it limits the accuracy of every simulation.",
    ),
    "coupling": EffectText(
        "a coupling",
        (
            "The input moves the output, and in the simulation it does not; the steady gain is {gain}",
            "The input moves the output, and in the simulation it does not",
        ),
        "The simulation has no path from this input to this output; the rig has one. Look for shared supplies, "
        "heat or flow between neighbours, and forces through a common frame.",
    ),
    "parameter-mismatch": EffectText(
        "a parameter mismatch",
        ("The structure of the simulation is right, but its parameters are wrong",),
        "With refitted coefficients the simulation reproduces the record; no effect has to be added.",
    ),
}

UNSIMULATED = ("output-dropout", "output-outliers", "output-quantization", "coloured-noise")
"""Effects that are detected in the samples, not by simulation."""

_LABELS = {
    "low": "lower limit",
    "high": "upper limit",
    "width": "play",
    "rate": "largest rate",
    "delay": "delay",
    "tau": "time constant",
    "frequency": "frequency",
    "damping": "damping ratio",
    "zero": "command without inflow",
    "empty": "reading of the empty tank",
    "level": "reading at the brim",
    "upper": "reading at the brim of the upper tank",
    "caught": "share received by the next tank",
    "friction": "friction, in units of the command",
    "drag": "drag: command that holds it, over the square of the speed",
    "torque": "largest torque, in units of the command",
    "angle": "angle of rest",
    "per_radian": "output per radian",
    "limit": "error of the loop at the limit, in units of the command",
    "load": "share of the transmitted force that is added to the friction",
    "break_away": "friction at rest, in units of the command",
    "give": "way before the bodies slide",
    "jump_low": "step at the lower edge",
    "jump_high": "step at the upper edge",
    "ratio": "gain below the band over the gain above it",
    "cubic": "cubic coefficient",
    "fold": "lowest reading, at which the sign is lost",
    "c2": "quadratic coefficient",
    "c3": "cubic coefficient",
    "centre": "centre of the curve",
    "drift": "change of the gain over the record",
    "pole": "change of the speed of response over the record",
    "amplitude": "amplitude",
    "step": "converter step",
    "share": "share of the samples",
    "onset": "start",
    "end": "end of it",
    "size": "final change of the output",
}
_SPECIFIC_LABELS: dict[tuple[str, ...], str] = {
    ("coupling", "gain"): "steady gain",
    ("input-dead-zone", "low"): "lower edge of the band",
    ("input-dead-zone", "high"): "upper edge of the band",
    ("end-stop", "low"): "lower stop",
    ("end-stop", "high"): "upper stop",
    ("slow-mode", "share"): "share of the static gain",
    ("coloured-noise", "pole"): "pole (0: white; near 1: slow)",
    ("coloured-noise", "amplitude"): "rms",
    ("input-off", "level"): "command that acts",
    ("input-quantization", "step"): "step of the command that acts",
    ("load-step", "size", "1"): "increase of the rate of return to rest",
}
_POSITIONS = {"low", "high", "level", "upper", "onset", "end", "zero", "empty", "centre", "fold", "angle"}
"""Positions, which may be near zero; the other parameters are magnitudes."""

_SHARES = {"drift", "share", "caught", "size", "pole", "load"}  # dimensionless parameters that are written in per cent


def noun(name: str) -> str:
    """Name of an effect with its article; an unknown name is returned unchanged."""
    text = EFFECT_TEXTS.get(name)
    return name if text is None else text.noun


def clause(effect: dict[str, Any]) -> str:
    """What the rig does, without the full stop."""
    if effect.get("joint"):
        return inside_clause(effect)
    known: dict[str, Quantity] = {}
    for name, entry in effect["parameters"].items():
        quantity = Quantity(entry["value"], entry["stderr"] or 0.0, entry["unit"])
        if name not in _POSITIONS and quantity.stderr > abs(quantity.value):
            continue  # not significantly different from zero
        size = Quantity(abs(quantity.value), quantity.stderr, quantity.unit)
        sign = "+" if quantity.value >= 0.0 else "-"
        known |= {name: quantity, f"{name}_{entry.get('of', quantity.unit)}": quantity, f"{name}{sign}": size}
    text = EFFECT_TEXTS.get(effect["name"])
    for form in () if text is None else text.clauses:
        if all(field in known for _, field, _, _ in Formatter().parse(form) if field is not None):
            return form.format(**known)
    return f"The record shows {noun(effect['name'])}"


def parameter_label(effect: str, parameter: str, entry: dict[str, Any]) -> str:
    """Label of a parameter of an effect; a number of a given simulation keeps its name."""
    if "nominal" in entry:
        return f"{parameter}, nominally {number(entry['nominal'])}"
    for key in ((effect, parameter, entry.get("of", entry["unit"])), (effect, parameter)):
        if key in _SPECIFIC_LABELS:
            return _SPECIFIC_LABELS[key]
    if entry["unit"] in INSIDE_LABELS.get(parameter, {}):
        return INSIDE_LABELS[parameter][entry["unit"]]
    return _LABELS.get(parameter, parameter)


def parameter_value(effect: str, parameter: str, entry: dict[str, Any]) -> tuple[str, str]:
    """A parameter's value with its standard error, and its unit in words."""
    value, stderr, unit = entry["value"], entry["stderr"], entry["unit"]
    if unit == "1" and parameter in _SHARES and effect != "coloured-noise":
        if stderr:
            return with_error(100.0 * value, 100.0 * stderr), "%"
        return percent(value).removesuffix(" %"), "%"
    if not entry.get("determined", True):
        return with_error(value, stderr), "not determined by itself"
    if entry.get("at_limit"):
        return with_error(value, stderr), "at its limit"
    return with_error(value, stderr), UNITS.get(unit, unit)


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
