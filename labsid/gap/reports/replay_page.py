"""The script of a page that replays simulations, and its data: made from the JSON report alone."""

import json
import re
from typing import Any

import numpy as np

from labsid._texts import joined
from labsid.gap.effects.detected import UNSIMULATED
from labsid.gap.effects.families import DESCRIPTIONS, EFFECTS_BY_KEY
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import parameter_label, parameter_value
from labsid.gap.reports.javascript.models import script, structure
from labsid.gap.reports.quantities import closed_percent, in_units
from labsid.gap.reports.traces import packed

NOTHING = 1e-6  # of the fitted value: a smaller one is shown as zero
_IDENTITY = {"centre": 0.0, "unit": 1.0}


def page_script(report: dict[str, Any], own: str) -> str:
    """The script of the page: the simulations of the report in JavaScript, then its `own` part."""
    simulations = script(_hypothesis(one) for one in _replay(report)["combinations"])
    return f'"use strict";\n(() => {{\n{simulations}\n{own}}})();'


def page_data(report: dict[str, Any]) -> str:
    """What the script of the page reads, as JSON that may stand in a page."""
    from labsid.plots.gap_panels import panels

    replay = _replay(report)
    parts = {name: replay[name] for name in ("record", "holdout") if replay[name] is not None}
    combinations = [_combination(report, one) for one in replay["combinations"]]
    names = dict.fromkeys(name for one in combinations for name in one["names"])
    content = {
        "parts": parts,
        "panels": {name: panels(report, name) for name in parts},
        "u_scale": replay["u_scale"],
        "y_scale": replay["y_scale"],
        "unit": report.get("units", {}).get("y", ""),
        "plain": "The simulation as it is" if report["verdict"] == "none" else "The simulation before",
        "combinations": combinations,
        "effects": [{"name": name, "label": _title(name)} for name in names],
    }
    text = json.dumps(content, separators=(",", ":"), ensure_ascii=False)
    return _numbered(text).replace("<", "\\u003c")


def _replay(report: dict[str, Any]) -> dict[str, Any]:
    """The part of the report that is replayed; of a report without one, its traces."""
    if report.get("replay") is not None:
        return dict(report["replay"])
    return {
        "u_scale": _IDENTITY,
        "y_scale": _IDENTITY,
        "record": _from_traces(report["traces"]),
        "holdout": None if report["holdout_traces"] is None else _from_traces(report["holdout_traces"]),
        "accepted": [],
        "combinations": [],
    }


def _from_traces(traces: dict[str, list[Any]]) -> dict[str, Any]:
    kinds = {"t": "<f8", "u": "<f8", "y": "<f4", "before": "<f4", "after": "<f4"}
    return {name: packed(np.array(traces[name], float), kind) for name, kind in kinds.items()} | {
        "fitted": [],
        "scored": [],
    }


def _hypothesis(combination: dict[str, Any]) -> Hypothesis:
    return Hypothesis(tuple(EFFECTS_BY_KEY[key] for key in combination["effects"]))


def _combination(report: dict[str, Any], one: dict[str, Any]) -> dict[str, Any]:
    """A combination with its texts."""
    hypothesis, names = _hypothesis(one), one["names"]
    accepted = names == report["replay"]["accepted"]
    lower, upper = hypothesis.bounds
    model = structure(hypothesis, one["span"], one["reference"])
    return {
        "names": names,
        "accepted": accepted,
        "title": sentences.capitalised(joined([sentences.noun_without_article(name) for name in names])),
        "closed": _closed(report, names, accepted),
        "still": _still(one, names),
        "model": model | {"simulated": one["simulated"], "bounds": [lower.tolist(), upper.tolist()]},
        "theta": one["theta"],
        "gains": one["gains"],
        "constant": one["constant"],
        "holdout": one["holdout"],
        "sliders": [_slider(report, slider, len(names) > 1) for slider in one["sliders"]],
    }


def _closed(report: dict[str, Any], names: list[str], accepted: bool) -> str:
    """A sentence on the closed share."""
    gap = report["gap"]
    if accepted and gap["closed"] is not None:
        return f"As fitted, it closes {closed_percent(gap['closed'], gap['ci95'])} of the gap on the scored samples."
    row = next((row for row in report["ranking"] if sorted(row["name"].split("+")) == names), None)
    if row is None or row["closed"] is None:
        return ""
    place = "fitted samples" if report["verdict"] in ("none", "effect") else "scored samples"
    return f"As fitted, it closes {closed_percent(row['closed'])} of the gap on the {place}."


def _still(one: dict[str, Any], names: list[str]) -> str:
    """Why an effect has no slider."""
    missing = [name for name in names if name not in {slider["effect"] for slider in one["sliders"]}]
    missing = [name for name in missing if name not in UNSIMULATED and name in DESCRIPTIONS]
    if not missing:
        return ""
    nouns = joined([sentences.noun_without_article(name) for name in missing])
    if not one["simulated"]:
        return f"Your simulation cannot run in this page. What acts on its input stays as fitted: {nouns}."
    return f"Without a slider: {nouns}."


def _slider(report: dict[str, Any], slider: dict[str, Any], several: bool) -> dict[str, Any]:
    """A slider with a label, and the text of each position."""
    effect, parameter, unit = slider["effect"], slider["parameter"], slider["unit"]
    stated = in_units(unit, **report["units"]) if "units" in report else unit
    fitted = int(np.argmin(np.abs(slider["moves"])))
    least = NOTHING * abs(slider["values"][fitted])
    texts = []
    for value in slider["values"]:
        entry = {"value": value if abs(value) > least else 0.0, "stderr": 0.0, "unit": stated}
        shown, words = parameter_value(effect, parameter, entry)
        texts.append(f"{shown} {words}".strip())
    label = sentences.capitalised(parameter_label(effect, parameter, {"unit": stated, "of": unit}))
    return {
        "label": f"{_title(effect)}: {label[0].lower()}{label[1:]}" if several else label,
        "texts": texts,
        "fitted": fitted,
        **{key: slider[key] for key in ("moves", "theta", "gains", "of_one_record")},
    }


def _title(name: str) -> str:
    return sentences.capitalised(sentences.noun_without_article(name))


def _numbered(text: str) -> str:
    """The identifiers that bokeh counts on within a process, from 1 in every page."""
    order: dict[str, int] = {}
    return re.sub(r'(?<=")p\d{4,}(?=")', lambda found: f"p{order.setdefault(found[0], 1001 + len(order))}", text)
