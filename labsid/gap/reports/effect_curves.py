"""The curve of each effect of a report, with its error, for a figure: from the parameters that the report states."""

from typing import Any

import numpy as np

from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.effects.sketch import Seen
from labsid.gap.reports.sentences import capitalised, noun_without_article
from labsid.plots.signal_names import LONGEST, fitted, pair_of_effect, unit_of

DEVIATIONS = 1.96  # of a parameter, for 95 %


def effect_curve(report: dict[str, Any], effect: dict[str, Any]) -> dict[str, Any] | None:
    """What an effect does, at the parameters that were found.

    Parameters
    ----------
    report : dict
    effect : dict
        One of its effects.

    Returns
    -------
    dict or None
        ``x``, ``curve`` and ``plain``, its heights with and without the effect; ``band``, the 95 % error of the heights
        by that of the parameters; ``marks``, places on the axis of x with their 95 % error; ``visits``, the samples
        of the record on it; ``labels`` of both axes; ``title``. None without a curve.
    """
    if "course" in effect:
        return _course_in_time(report, effect)
    description = DESCRIPTIONS.get(effect["name"])
    sketch = None if description is None else description.sketch
    known = {name: one for name, one in effect["parameters"].items() if one["value"] is not None}
    p = {name: float(one["value"]) for name, one in known.items()}
    if sketch is None or not sketch.is_drawn(p):
        return None
    seen, units = _seen(report, effect, {name: one.get("of", one["unit"]) for name, one in known.items()})
    x = sketch.points(p, seen)
    curve, plain = sketch.curve(x, p, seen), sketch.plain(x, p, seen)
    errors = {name: DEVIATIONS * float(one.get("stderr") or 0.0) for name, one in known.items()}
    moved = [sketch.curve(x, p | {name: p[name] + errors[name]}, seen) for name in p if name not in sketch.marks]
    band = np.sqrt(sum(((other - curve) ** 2 for other in moved), np.zeros(x.size)))
    if not all(np.isfinite(line).all() for line in (curve, plain, band)):
        return None
    return {
        "title": capitalised(noun_without_article(effect["name"])),
        "x": x,
        "curve": curve,
        "plain": plain,
        "band": band,
        "marks": [(p[name], errors[name]) for name in sketch.marks if name in p],
        "visits": {"u": seen.u, "y": seen.y}.get(sketch.over, np.zeros(0)),
        "labels": (
            _labelled(sketch.across, "s" if sketch.over == "t" else sketch.over, known, units),
            _labelled(sketch.label, sketch.unit, known, units),
        ),
    }


def _course_in_time(report: dict[str, Any], effect: dict[str, Any]) -> dict[str, Any]:
    """A drift in time, with the 95 % error of its amplitude."""
    t, y = (np.array(effect["course"][name], float) for name in ("t", "y"))
    amplitude = effect["parameters"]["amplitude"]
    error = DEVIATIONS * float(amplitude.get("stderr") or 0.0) / max(abs(float(amplitude["value"])), 1e-300)
    _, units = _seen(report, effect, {})
    return {
        "title": capitalised(noun_without_article(effect["name"])),
        "x": t,
        "curve": y,
        "plain": np.zeros(t.size),
        "band": np.abs(y) * error,
        "marks": [],
        "visits": np.zeros(0),
        "labels": ("Time (s)", _labelled("Change of the reading", "y", {}, units)),
    }


def _seen(report: dict[str, Any], effect: dict[str, Any], of: dict[str, str]) -> tuple[Seen, dict[str, str]]:
    """Samples of the record around an effect, and the units of its input and output."""
    if "signals" not in report:
        traces = report["traces"]
        units = {signal: unit_of(report, signal) for signal in ("u", "y")}
    else:
        traces, pair = report["outputs"][effect["outputs"][0]]["traces"], pair_of_effect(report, effect)
        if effect["signal"] in report.get("inputs", {}):
            traces = traces | {"u": report["inputs"][effect["signal"]]["u"]}
        short = {key: fitted(name, LONGEST, 1)[0] for key, name in pair["names"].items()}
        units = {key: ", ".join([name, *filter(None, [pair["units"].get(key)])]) for key, name in short.items()}
    t, u, y = (np.array(traces[name], float) for name in ("t", "u", "y"))
    return Seen(t, u, y, of), units


def _labelled(text: str, unit: str, known: dict[str, dict[str, Any]], units: dict[str, str]) -> str:
    """A label with its unit; a unit may be that of a parameter."""
    of = known[unit].get("of", known[unit]["unit"]) if unit in known else unit
    shown = units.get(of, of)
    return f"{text} ({shown})" if shown and f"({shown})" not in text else text
