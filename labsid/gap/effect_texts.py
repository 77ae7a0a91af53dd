"""The effects in the words of a control engineer: what each is called, what it does, and how to look for it."""

from dataclasses import dataclass
from string import Formatter
from typing import Any

from labsid.gap.quantities import UNITS, Quantity, percent, with_error


@dataclass(frozen=True, slots=True)
class EffectText:
    """One effect.

    Attributes
    ----------
    noun : str
        With its article, as the subject of "explains".
    clauses : tuple of str
        What the rig does, as whole clauses with parameters in braces. The first one whose parameters are all known
        holds; ``{size_y}`` is `size` in the unit y, ``{cubic+}`` and ``{cubic-}`` are its size, by its sign.
    meaning : str
        What that is, for a reader who has never heard of it, and what on the rig to look at.
    """

    noun: str
    clauses: tuple[str, ...]
    meaning: str


EFFECT_TEXTS: dict[str, EffectText] = {
    "input-delay": EffectText(
        "a transport delay",
        ("The rig answers each command {delay} late", "The rig answers each command late"),
        "The command takes that long to reach the process, on top of the one sample of every sampled system. "
        "Look for pipes, belts, buses and buffers.",
    ),
    "input-saturation": EffectText(
        "a limit of the actuator",
        (
            "The actuator stops at {low} and at {high}",
            "The actuator goes no lower than {low}",
            "The actuator goes no higher than {high}",
            "The actuator stops inside the range of the command",
        ),
        "Commands beyond the limit have no more effect than the limit itself. Look at end stops, supply voltage and "
        "limits in the amplifier or its software.",
    ),
    "input-dead-zone": EffectText(
        "a dead zone",
        (
            "The actuator does not move between {low} and {high}",
            "The actuator does not move until the command leaves a band",
        ),
        "Commands inside the band do nothing. Look for overlap of a valve, friction in the drive, or a threshold in "
        "the amplifier.",
    ),
    "input-backlash": EffectText(
        "backlash",
        (
            "The actuator has to cross a play of {width} each time it turns round",
            "The actuator has to cross a play each time it turns round",
        ),
        "After every change of direction the command moves for a while before anything follows. Look at gears, "
        "couplings and valve stems.",
    ),
    "input-rate-limit": EffectText(
        "a rate limit of the actuator",
        (
            "The actuator moves no faster than {rate} units a second",
            "The actuator moves more slowly than the command",
        ),
        "Fast changes of the command are followed at a fixed speed. Look at motor-driven valves and at ramps in the "
        "drive's software.",
    ),
    "input-nonlinearity": EffectText(
        "a curved characteristic of the actuator",
        ("The gain of the actuator changes with the size of the command",),
        "The same step of the command does more in one part of its range than in another. Look at the characteristic "
        "of the pump, the valve or the amplifier. In the table, d being the command less the middle: the actuator "
        "gives d + (quadratic coefficient) d² + (cubic coefficient) d³.",
    ),
    "extra-lag": EffectText(
        "an extra lag",
        (
            "Between command and record there is one more lag, of {tau}",
            "Between command and record there is one more lag",
        ),
        "Something smooths the signal with that time constant: actuator, process, sensor or filter, which the record "
        "cannot tell apart.",
    ),
    "resonance": EffectText(
        "a lightly damped mode",
        ("The rig rings at {frequency}, with a damping ratio of {damping}", "The rig rings"),
        "A part swings by itself after each disturbance. Look for flexible shafts, belts, supports, or sloshing.",
    ),
    "sqrt-outflow": EffectText(
        "a square-root outflow",
        ("The outflow goes with the square root of the level, not with the level",),
        "Torricelli's law: a full tank loses less for each unit of level than a nearly empty one, so gain and time "
        "constant change with the level. In the table: the command at which nothing flows in, so that the tank runs "
        "empty, and what the sensor would read then. Both may lie far outside the record.",
    ),
    "overflow": EffectText(
        "an overflow",
        ("A tank is full at {level} and takes no more", "A tank reaches its brim and takes no more"),
        "Beyond the brim the inflow is lost, or runs into the next tank. The brim is given as the reading that the "
        "sensor would settle at if the tank stayed just full. Of what spills, the next tank catches all (100 %), none "
        "(0 %) or a part.",
    ),
    "coulomb-friction": EffectText(
        "dry friction",
        ("Dry friction takes {friction} of the command before anything moves", "Dry friction holds against the motion"),
        "A force of constant size against every motion: small commands stick, and the motion stops short. Look at "
        "bearings, seals and guides.",
    ),
    "cubic-stiffness": EffectText(
        "a nonlinear spring",
        (
            "The rig grows stiffer away from rest, by {cubic+} times the square of the displacement",
            "The rig grows softer away from rest, by {cubic-} times the square of the displacement",
            "The restoring force is not in proportion to the displacement",
        ),
        "Far from rest the rig pushes back harder, or less hard, than near it. Look at springs near their end and at "
        "flexible parts.",
    ),
    "parameter-drift": EffectText(
        "a drift of the parameters",
        (
            "The gain of the rig changes by {drift:%} along the record",
            "The speed of the rig changes by {pole:%} along the record",
            "The rig changes slowly along the record",
        ),
        "The same command does not do the same at the end as at the beginning. Look at temperature, supply, wear and "
        "filling.",
    ),
    "output-drift": EffectText(
        "a drift of the sensor",
        ("The zero of the sensor wanders by ±{amplitude}", "The zero of the sensor wanders"),
        "A slow change of the reading that no command brings about. Look at warm-up, temperature and "
        "the sensor's supply.",
    ),
    "output-saturation": EffectText(
        "a clipping sensor",
        (
            "The sensor reads nothing below {low} and nothing above {high}",
            "The sensor reads nothing below {low}",
            "The sensor reads nothing above {high}",
            "The sensor stops at the end of its range",
        ),
        "The process goes on where the reading has stopped. Look at the range of the sensor and of the converter.",
    ),
    "output-nonlinearity": EffectText(
        "a curved characteristic of the sensor",
        ("The gain of the sensor changes along its range",),
        "The same change of the process reads as more in one part of the range than in another. Look at the "
        "calibration. In the table, d being the true output less the middle: the sensor reads "
        "d + (quadratic coefficient) d² + (cubic coefficient) d³.",
    ),
    "output-quantization": EffectText(
        "a coarse converter",
        ("The output is read in steps of {step}", "The output is read in coarse steps"),
        "The record can only take these values: whatever is smaller than a step is lost. Look at the resolution of the "
        "converter and at rounding in the logger.",
    ),
    "output-outliers": EffectText(
        "a spiking sensor",
        ("Single readings, {share:%} of them, are spikes", "Single readings are spikes"),
        "Isolated samples that the process cannot have produced. The fits leave them out. Look at loose contacts and "
        "electrical interference.",
    ),
    "output-dropout": EffectText(
        "a logger that holds its last value",
        (
            "The logger repeats its last value over {share:%} of the record",
            "The logger repeats its last value over stretches of the record",
        ),
        "New readings were missing, and the old one was written again. The fits leave these samples out. Look at the "
        "connection and at the load of the logging computer.",
    ),
    "load-step": EffectText(
        "a load step",
        (
            "An unmeasured load sets in at {onset} and moves the output by {size_y}",
            "An unmeasured load sets in at {onset} and adds {size_1:%} to the pull towards rest, as a leak does",
            "An unmeasured load sets in at {onset}",
            "An unmeasured load sets in during the record",
        ),
        "From that instant on something else acts on the process: an opened valve, a leak, a weight put on.",
    ),
    "periodic-disturbance": EffectText(
        "a periodic disturbance",
        (
            "The output swings at {frequency} with amplitude {amplitude}, whatever the command does",
            "The output swings, whatever the command does",
        ),
        "A steady swing that no command brings about. Look at pumps, fans, mains hum and neighbouring machines.",
    ),
    "coloured-noise": EffectText(
        "coloured noise",
        (
            "Noise of {amplitude} rms that forgets itself slowly lies on the output",
            "Noise that forgets itself slowly lies on the output",
        ),
        "A random disturbance that stays on one side for many samples. No input explains it, so no simulation can "
        "follow it; it sets how close any of them can come.",
    ),
    "parameter-mismatch": EffectText(
        "a parameter mismatch",
        ("The structure of the simulation is right, its numbers are wrong",),
        "The simulation follows the record once its coefficients are fitted again; nothing has to be added to it.",
    ),
}

UNSIMULATED = ("output-dropout", "output-outliers", "output-quantization", "coloured-noise")
"""Effects that are seen in the samples, not by simulating them."""

STOP_EFFECTS = ("output-saturation", "overflow")
"""Effects that the record itself may show, by an output that stands at its extreme."""

_LABELS = {
    "low": "lower limit",
    "high": "upper limit",
    "width": "width of the play",
    "rate": "fastest change",
    "delay": "delay",
    "tau": "time constant",
    "frequency": "frequency",
    "damping": "damping ratio",
    "zero": "command of no inflow",
    "empty": "reading of the empty tank",
    "level": "reading at the brim",
    "upper": "the same at that of the upper tank",
    "caught": "share that the next tank catches",
    "friction": "friction, as a command",
    "cubic": "cubic coefficient",
    "c2": "quadratic coefficient",
    "c3": "cubic coefficient",
    "centre": "the middle",
    "drift": "change of the gain over the record",
    "pole": "change of the rate over the record",
    "amplitude": "amplitude",
    "step": "converter step",
    "share": "share of the samples",
    "onset": "begins at",
    "size": "change of the output in the end",
}
_SPECIFIC_LABELS: dict[tuple[str, ...], str] = {
    ("input-dead-zone", "low"): "lower edge of the band",
    ("input-dead-zone", "high"): "upper edge of the band",
    ("coloured-noise", "pole"): "pole (0: white, 1: endless memory)",
    ("coloured-noise", "amplitude"): "rms",
    ("load-step", "size", "1"): "growth of the pull towards rest",
}
_POSITIONS = {"low", "high", "level", "upper", "onset", "zero", "empty", "centre"}
"""Parameters that say where, not how much: they may well be near zero."""

_SHARES = {"drift", "share", "caught", "size", "pole"}  # without a unit: to be read in per cent


def noun(name: str) -> str:
    """What an effect is called, with its article; a name that the table does not hold as it is."""
    words = EFFECT_TEXTS.get(name)
    return name if words is None else words.noun


def clause(effect: dict[str, Any]) -> str:
    """What the rig does, as a clause without its full stop."""
    known: dict[str, Quantity] = {}
    for name, entry in effect["parameters"].items():
        quantity = Quantity(entry["value"], entry["stderr"], entry["unit"])
        if name not in _POSITIONS and quantity.stderr > abs(quantity.value):
            continue  # the number says nothing
        size = Quantity(abs(quantity.value), quantity.stderr, quantity.unit)
        sign = "+" if quantity.value >= 0.0 else "-"
        known |= {name: quantity, f"{name}_{quantity.unit}": quantity, f"{name}{sign}": size}
    words = EFFECT_TEXTS.get(effect["name"])
    for form in () if words is None else words.clauses:
        if all(field in known for _, field, _, _ in Formatter().parse(form) if field is not None):
            return form.format(**known)
    return f"The record shows {noun(effect['name'])}"


def parameter_label(effect: str, parameter: str, unit: str) -> str:
    """What a parameter of an effect is called."""
    for key in ((effect, parameter, unit), (effect, parameter)):
        if key in _SPECIFIC_LABELS:
            return _SPECIFIC_LABELS[key]
    return _LABELS.get(parameter, parameter)


def parameter_value(effect: str, parameter: str, entry: dict[str, Any]) -> tuple[str, str]:
    """A parameter's value with its standard error, and its unit in words."""
    value, stderr, unit = entry["value"], entry["stderr"], entry["unit"]
    if unit == "1" and parameter in _SHARES and effect != "coloured-noise":
        if stderr > 0.0:
            return with_error(100.0 * value, 100.0 * stderr), "%"
        return percent(value).removesuffix(" %"), "%"
    return with_error(value, stderr), UNITS.get(unit, unit)
