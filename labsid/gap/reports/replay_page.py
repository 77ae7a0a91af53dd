"""The script of a page that replays simulations, and its data: made from the JSON report alone."""

import base64
import json
import re
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid._texts import joined
from labsid.gap.effects.detected import UNSIMULATED
from labsid.gap.effects.families import DESCRIPTIONS, EFFECTS_BY_KEY
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import parameter_label, parameter_value
from labsid.gap.reports.javascript.models import script, structure
from labsid.gap.reports.quantities import closed_percent, in_units, rounded
from labsid.gap.reports.traces import packed, worst_of_records, worst_stretch

LONG = 6000  # samples, from which the panels open at the worst stretch, below a strip of the whole
LARGEST, NONE = 32767, -32768  # steps of an output in 16 bits, and what stands for none
INPUT_STEPS = 2**24 - 1  # of the range of an input, in 24 bits
ROUNDING = 0.1  # of the noise: outputs of a long record are rounded to less, which moves an rms error by 0.05 %
NOTHING = 1e-6  # of the fitted value: a smaller one is shown as zero
_IDENTITY = {"centre": 0.0, "unit": 1.0}


def page_script(report: dict[str, Any], own: str) -> str:
    """The script of the page: the simulations of the report in JavaScript, then its `own` part, which may await."""
    simulations = script(_hypothesis(one) for one in _replay(report)["combinations"])
    return f'"use strict";\n(async () => {{\n{simulations}\n{own}}})();'


def page_data(report: dict[str, Any]) -> str:
    """What the script of the page reads, as JSON that may stand in a page."""
    from labsid.plots.gap_panels import panels

    replay = _replay(report)
    parts = {name: dict(replay[name]) for name in ("record", "holdout") if replay[name] is not None}
    refitted = sentences.is_mismatch(report) and not replay["accepted"]
    if replay["combinations"] and not refitted:
        del parts["record"]["after"]  # the page simulates it
        accepted = [one for one in replay["combinations"] if one["names"] == replay["accepted"]]
        if "holdout" in parts and accepted and accepted[0]["holdout"]:
            del parts["holdout"]["after"]
    pieces = _pieces(report)
    long = [] if pieces else [name for name, part in parts.items() if _samples(part) >= LONG]
    combinations = [_combination(report, one) for one in replay["combinations"]]
    names = dict.fromkeys(name for one in combinations for name in one["names"])
    finest = ROUNDING * report["gap"]["noise_floor"] / replay["y_scale"]["unit"]
    content = {
        "parts": {name: _short(part, finest) if name in long else part for name, part in parts.items()},
        "panels": {name: panels(report, name, name in long) for name in parts},
        "worst": {name: _worst(report, name) for name in parts},
        "pieces": pieces,
        "long": long,
        "u_scale": replay["u_scale"],
        "y_scale": replay["y_scale"],
        "unit": report.get("units", {}).get("y", ""),
        "refitted": refitted,
        "plain": "The simulation as it is"
        if report["verdict"] == "none"
        else "Your simulation with its fitted values"
        if refitted
        else "The simulation before",
        "combinations": combinations,
        "effects": [{"name": name, "label": _title(name)} for name in names],
    }
    text = json.dumps(content, separators=(",", ":"), ensure_ascii=False)
    return _numbered(text).replace("<", "\\u003c")


def _short(part: dict[str, Any], finest: float) -> dict[str, Any]:
    """A long part in less than half of the size: the input in 24 bits, and outputs in steps that noise covers."""
    u = np.frombuffer(base64.b64decode(part["u"]), "<f8")
    outputs = {name: _unpacked(part[name]) for name in ("y", "before", "after") if name in part}
    known = {name: np.isfinite(x) for name, x in outputs.items()}
    lows = [float(x[known[name]].min()) for name, x in outputs.items() if known[name].any()]
    low, steps = min(lows, default=0.0), {}
    for name, x in outputs.items():
        if not (x[known[name]] - low).max(initial=0.0) < 2 * LARGEST * finest:
            return part | {"u": _input_in_steps(u)}
        counts = np.where(known[name], np.round((np.nan_to_num(x) - low) / finest), 0.0)
        steps[name] = counts - LARGEST
    written: dict[str, Any] = {}
    for name, counts in steps.items():
        on_y = name != "y" and not (known[name] & ~known["y"]).any() and np.abs(counts - steps["y"]).max() <= LARGEST
        held = np.where(known[name], counts - steps["y"] if on_y else counts, NONE)
        written[name] = {
            "low": low + LARGEST * finest,
            "step": finest,
            "on_y": bool(on_y),
            "steps": _in_planes(held, 2),
        }
    return part | {"u": _input_in_steps(u)} | written


def _unpacked(text: str) -> FloatArray:
    return np.frombuffer(base64.b64decode(text), "<f4").astype(float)


def _input_in_steps(u: FloatArray) -> dict[str, Any]:
    """A signal as whole numbers of 24 bits, as precise as one in single precision."""
    low, step = float(u.min()), float(np.ptp(u)) / INPUT_STEPS or 1.0
    return {"low": low, "step": step, "planes": _in_planes(np.round((u - low) / step), 3)}


def _in_planes(numbers: FloatArray, size: int) -> str:
    """Whole numbers of `size` bytes in base64: the lowest bytes of all first, as equal bytes pack well."""
    whole = numbers.astype("<i4").view(np.uint8).reshape(-1, 4)
    return base64.b64encode(whole[:, :size].T.tobytes()).decode("ascii")


def _samples(part: dict[str, Any]) -> int:
    """Samples of a part, each 8 bytes in base64."""
    return len(part["u"]) * 3 // 4 // 8


def _worst(report: dict[str, Any], name: str) -> list[float] | None:
    """Ends of the worst stretch in seconds; None without a gap, or where the report does not hold all samples."""
    if report["verdict"] == "none":
        return None
    found = worst_of_records(report)[2] if report.get("records") else worst_stretch(report, name)
    return None if found is None else [float(found["t"][0]), float(found["t"][-1])]


def _pieces(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Name, first sample and number of samples of each of several records, and whether the worst stretch is there."""
    if not report.get("records") or report.get("replay") is None:
        return []
    worst = worst_of_records(report)[0]
    return [
        {
            "name": row["name"],
            "start": round(row["start"] / report["record"]["Ts"]),
            "samples": row["samples"],
            "worst": row["name"] == worst,
        }
        for row in report["records"]
    ]


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
        "still": " ".join([*_still(one, names), *(_fitted_apart(report) if accepted and one["sliders"] else [])]),
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


def _still(one: dict[str, Any], names: list[str]) -> list[str]:
    """Why an effect has no slider, and which parameters are at the limits of their search."""
    missing = [name for name in names if name not in {slider["effect"] for slider in one["sliders"]}]
    missing = [name for name in missing if name not in UNSIMULATED and name in DESCRIPTIONS]
    nouns = joined([sentences.noun_without_article(name) for name in missing])
    texts = [f"Without a slider: {nouns}."] if missing else []
    if missing and not one["simulated"]:
        texts = [f"Your simulation cannot run in this page. What acts on its input stays as fitted: {nouns}."]
    for slider in one["sliders"]:
        fitted = slider["values"][int(np.argmin(np.abs(slider["moves"])))]
        if fitted != 0.0 and 0.0 in (slider["moves"][0], slider["moves"][-1]):
            label = parameter_label(slider["effect"], slider["parameter"], slider)
            texts.append(f"{_title(slider['effect'])}: {label} is at the limit of its search.")
    return texts


def _fitted_apart(report: dict[str, Any]) -> list[str]:
    """That the sliders start at other values than those of the table, if they do."""
    if report["verdict"] != "effect" or report["holdout_traces"] is not None or not report["effects"]:
        return []
    return [
        "The sliders start at the values of the exported simulation, which is fitted without the scored samples; the "
        "values with ± are fitted to all samples."
    ]


def _slider(report: dict[str, Any], slider: dict[str, Any], several: bool) -> dict[str, Any]:
    """A slider with a label, and the text of each position."""
    effect, parameter, unit = slider["effect"], slider["parameter"], slider["unit"]
    of_unit = {"unit": in_units(unit, **report["units"]) if "units" in report else unit, "of": unit}
    fitted = int(np.argmin(np.abs(slider["moves"])))
    least = NOTHING * abs(slider["values"][fitted])
    stderr = _entry(report, effect, parameter).get("stderr")
    texts = []
    for value in slider["values"]:
        entry = {"value": value if abs(value) > least else 0.0, "stderr": stderr, **of_unit}
        texts.append(" ".join(parameter_value(effect, parameter, entry, report, rounded)).strip())
    label = sentences.capitalised(parameter_label(effect, parameter, of_unit))
    return {
        "label": f"{_title(effect)}: {label[0].lower()}{label[1:]}" if several else label,
        "texts": texts,
        "fitted": fitted,
        **{key: slider[key] for key in ("moves", "theta", "gains", "of_one_record")},
    }


def _entry(report: dict[str, Any], effect: str, parameter: str) -> dict[str, Any]:
    """A parameter as the report states it; empty if the effect was not found."""
    own = (one["parameters"].get(parameter, {}) for one in report["effects"] if one["name"] == effect)
    return next(own, {})


def _title(name: str) -> str:
    return sentences.capitalised(sentences.noun_without_article(name))


def _numbered(text: str) -> str:
    """The identifiers that bokeh counts on within a process, from 1 in every page."""
    order: dict[str, int] = {}
    return re.sub(r'(?<=")p\d{4,}(?=")', lambda found: f"p{order.setdefault(found[0], 1001 + len(order))}", text)
