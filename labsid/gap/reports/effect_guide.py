"""What a record must contain for an effect to be found, and with what the effect is easily confused."""

from dataclasses import dataclass
from typing import Any

from labsid.gap.reports.effect_texts import EFFECT_TEXTS, noun, parameter_label
from labsid.gap.reports.quantities import UNITS


@dataclass(frozen=True, slots=True)
class EffectGuide:
    """One effect of the table.

    Attributes
    ----------
    path : str
        Where it acts: "input", "dynamics", "output", "disturbance" or "parameters".
    parameters : dict
        Unit of each parameter, in terms of u, y and seconds.
    excited_by : str
        The record that shows it.
    confused_with : tuple of str
        Names of effects that look alike on a poor record.
    """

    path: str
    parameters: dict[str, str]
    excited_by: str
    confused_with: tuple[str, ...] = ()


EFFECT_GUIDE: dict[str, EffectGuide] = {
    "input-delay": EffectGuide(
        "input", {"delay": "s"}, "Steps or fast changes of the input, sampled faster than the delay.", ("extra-lag",)
    ),
    "input-saturation": EffectGuide(
        "input",
        {"low": "u", "high": "u"},
        "An input that goes beyond the limit and back, with several levels inside it.",
        ("input-nonlinearity", "output-saturation", "input-rate-limit"),
    ),
    "input-dead-zone": EffectGuide(
        "input",
        {"low": "u", "high": "u", "jump_low": "u", "jump_high": "u", "ratio": "1"},
        "Small inputs on both sides of rest beside large ones.",
        ("coulomb-friction", "input-backlash", "input-nonlinearity"),
    ),
    "input-backlash": EffectGuide(
        "input",
        {"width": "u"},
        "Changes of direction after small and after large changes of the input.",
        ("input-dead-zone", "coulomb-friction", "input-delay"),
    ),
    "input-rate-limit": EffectGuide(
        "input",
        {"rate": "u/s"},
        "Steps of different sizes: the larger ones are slower.",
        ("extra-lag", "input-saturation"),
    ),
    "input-nonlinearity": EffectGuide(
        "input",
        {"c2": "1/u", "c3": "1/u^2", "centre": "u"},
        "Many levels of the input over its range.",
        ("output-nonlinearity", "sqrt-outflow", "input-saturation"),
    ),
    "input-off": EffectGuide(
        "input",
        {"onset": "s", "end": "s", "level": "u"},
        "A command that goes on changing while it is off.",
        ("load-step", "output-dropout", "parameter-drift"),
    ),
    "input-quantization": EffectGuide(
        "input",
        {"step": "u"},
        "A slow ramp of the command, or many of its levels.",
        ("input-nonlinearity", "input-dead-zone", "coloured-noise"),
    ),
    "extra-lag": EffectGuide(
        "dynamics",
        {"tau": "s"},
        "An input with energy near the inverse of the time constant.",
        ("input-delay", "resonance"),
    ),
    "resonance": EffectGuide(
        "dynamics",
        {"frequency": "Hz", "damping": "1"},
        "Steps, or an input with energy near the frequency of the mode.",
        ("extra-lag", "periodic-disturbance"),
    ),
    "sqrt-outflow": EffectGuide(
        "dynamics",
        {"zero": "u", "empty": "y"},
        "Levels over the whole height of the tank, nearly empty ones included.",
        ("input-nonlinearity", "output-nonlinearity", "overflow"),
    ),
    "overflow": EffectGuide(
        "dynamics",
        {"level": "y", "upper": "y", "caught": "1"},
        "Inputs that fill the tank to the brim, long enough to see the level rest there.",
        ("output-saturation", "input-saturation", "sqrt-outflow"),
    ),
    "coulomb-friction": EffectGuide(
        "dynamics",
        {"friction": "u", "break_away": "u", "load": "1", "give": "y"},
        "Slow motion, stops and changes of direction.",
        ("input-dead-zone", "input-backlash"),
    ),
    "cubic-stiffness": EffectGuide(
        "dynamics",
        {"cubic": "1/y^2"},
        "Small and large displacements to both sides.",
        ("output-nonlinearity", "input-nonlinearity"),
    ),
    "end-stop": EffectGuide(
        "dynamics",
        {"low": "y", "high": "y"},
        "Motion against the stop, with time for the force to turn and lead away from it.",
        ("output-saturation", "overflow", "cubic-stiffness"),
    ),
    "quadratic-drag": EffectGuide(
        "dynamics",
        {"drag": "u s^2/y^2"},
        "Slow and fast motion: small and large steps, without reaching a limit.",
        ("sqrt-outflow", "input-nonlinearity", "coulomb-friction"),
    ),
    "gravity": EffectGuide(
        "dynamics",
        {"torque": "u", "angle": "y", "per_radian": "y"},
        "Slow motion over a large range of angles, in both directions.",
        ("cubic-stiffness", "output-nonlinearity", "load-step"),
    ),
    "force-limit": EffectGuide(
        "dynamics",
        {"limit": "u"},
        "Large steps of the command beside small ones.",
        ("input-rate-limit", "input-saturation", "quadratic-drag"),
    ),
    "slow-mode": EffectGuide(
        "dynamics",
        {"tau": "s", "share": "1"},
        "Steps after which the input rests for several of the long time constants, and fast changes as well.",
        ("extra-lag", "output-drift", "load-step"),
    ),
    "parameter-drift": EffectGuide(
        "dynamics",
        {"drift": "1", "pole": "1"},
        "The same inputs at the beginning and at the end of a long record.",
        ("output-drift", "load-step"),
    ),
    "output-drift": EffectGuide(
        "output",
        {"amplitude": "y"},
        "A long record with stretches at the same input.",
        ("parameter-drift", "load-step"),
    ),
    "output-saturation": EffectGuide(
        "output",
        {"low": "y", "high": "y"},
        "Outputs beyond the range of the sensor, and back.",
        ("input-saturation", "overflow", "output-nonlinearity"),
    ),
    "output-nonlinearity": EffectGuide(
        "output",
        {"c2": "1/y", "c3": "1/y^2", "centre": "y", "fold": "y"},
        "Outputs over the whole range, reached slowly and fast.",
        ("input-nonlinearity", "sqrt-outflow", "cubic-stiffness"),
    ),
    "output-backlash": EffectGuide(
        "output",
        {"width": "y"},
        "Slow motion with changes of direction at several levels.",
        ("input-backlash", "coulomb-friction", "output-nonlinearity"),
    ),
    "output-quantization": EffectGuide("output", {"step": "y"}, "Any record: it shows in the samples themselves."),
    "output-outliers": EffectGuide("output", {"share": "1"}, "Any record: it shows in the samples themselves."),
    "output-dropout": EffectGuide("output", {"share": "1"}, "Any record whose output changes: held values repeat."),
    "load-step": EffectGuide(
        "disturbance",
        {"onset": "s", "size": "y"},
        "A record that goes on for several time constants after the load has started.",
        ("output-drift", "parameter-drift"),
    ),
    "periodic-disturbance": EffectGuide(
        "disturbance",
        {"frequency": "Hz", "amplitude": "y"},
        "Several periods, with stretches of constant input.",
        ("resonance", "coloured-noise"),
    ),
    "coloured-noise": EffectGuide(
        "disturbance",
        {"amplitude": "y", "pole": "1"},
        "A record much longer than the time over which the noise is correlated.",
        ("output-drift", "periodic-disturbance"),
    ),
    "coupling": EffectGuide(
        "dynamics",
        {"gain": "y/u"},
        "Several inputs, each of which moves while the others rest; only with --sim.",
        ("parameter-mismatch",),
    ),
    "parameter-mismatch": EffectGuide(
        "parameters", {}, "An input that excites the rig as a linear model needs it; only with --sim.", ("extra-lag",)
    ),
}


def effect_page(name: str) -> list[tuple[str, str]]:
    """Titles and texts on one effect.

    Raises
    ------
    ValueError
        If there is no such effect.
    """
    if name not in EFFECT_GUIDE:
        raise ValueError(f"there is no effect {name!r}; there are {', '.join(EFFECT_GUIDE)}.")
    guide = EFFECT_GUIDE[name]
    parameters = [_parameter(name, parameter, unit) for parameter, unit in guide.parameters.items()]
    rivals = ", ".join(f"{noun(rival)} ({rival})" for rival in guide.confused_with)
    rows = [
        ("effect", f"{noun(name)} ({name})"),
        ("path", guide.path),
        ("rig", EFFECT_TEXTS[name].meaning),
        ("parameters", "; ".join(parameters)),
        ("record", guide.excited_by),
        ("confused with", rivals),
    ]
    return [(title, text) for title, text in rows if text]


def _parameter(effect: str, name: str, unit: str) -> str:
    entry: dict[str, Any] = {"unit": unit}
    label, words = parameter_label(effect, name, entry), UNITS.get(unit, unit)
    return f"{name}: {label} ({words})" if words and "in units of" not in label else f"{name}: {label}"
