"""The page of an effect: what it is, its parameters, the record that shows it, and what it is confused with."""

from typing import Any

from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.effect_texts import noun, parameter_label
from labsid.gap.reports.quantities import UNITS


def effect_page(name: str) -> list[tuple[str, str]]:
    """Titles and texts on one effect.

    Raises
    ------
    ValueError
        If there is no such effect.
    """
    if name not in DESCRIPTIONS:
        raise ValueError(f"there is no effect {name!r}; there are {', '.join(DESCRIPTIONS)}.")
    guide = DESCRIPTIONS[name]
    parameters = [_parameter(name, parameter, one.unit) for parameter, one in guide.parameters.items()]
    rivals = ", ".join(f"{noun(rival)} ({rival})" for rival in guide.confused_with)
    rows = [
        ("effect", f"{noun(name)} ({name})"),
        ("path", guide.path),
        ("rig", guide.meaning),
        ("parameters", "; ".join(parameters)),
        ("record", guide.excited_by),
        ("confused with", rivals),
    ]
    return [(title, text) for title, text in rows if text]


def _parameter(effect: str, name: str, unit: str) -> str:
    entry: dict[str, Any] = {"unit": unit}
    label, words = parameter_label(effect, name, entry), UNITS.get(unit, unit)
    return f"{name}: {label} ({words})" if words and "in units of" not in label else f"{name}: {label}"
