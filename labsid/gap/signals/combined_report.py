"""One report of all signals from the reports of the outputs."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np

from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.layout import SCHEMA, listed_findings
from labsid.gap.reports.traces import extreme_samples, packed
from labsid.gap.signals.preparation import Prepared
from labsid.gap.signals.roles import Signals
from labsid.gap.signals.search import ExplainedOutput
from labsid.gap.verdict.scores import NO_GAP_MEAN_SQUARE, closed_share

MOST_RIVALS = 3  # alternatives; definition: the report has three at most
MIN_CLOSED = 0.2  # share of the gap of an output, from which an effect elsewhere is said to change it; set by hand
KEPT = (  # of the report of an output
    "verdict",
    "gap",
    "noise",
    "where",
    "unexplained",
    "product",
    "explanation",
    "novelty",
    "reference",
    "screen",
    "traces",
    "holdout_traces",
    "dynamics",
    "replay",
)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The report of one output, explained through one input.

    Attributes
    ----------
    output, main : str
        Names of the output and of the input.
    report : dict
        As of one input and one output.
    sd : float
        Standard deviation of the output.
    mode : str
        How the output was simulated: ``"free"``, or ``"stabilised"`` beside measured outputs.
    together : bool
        Whether all outputs were simulated together, each with its own input: an effect in one of them moves the others.
    """

    output: str
    main: str
    report: dict[str, Any]
    sd: float
    mode: str = "free"
    together: bool = False

    @property
    def gap_size(self) -> float:
        """Rms error of the linear model over the noise."""
        gap = self.report["gap"]
        return float(gap["before"] / max(gap["noise_floor"], np.finfo(float).tiny))


def combine(prepared: Prepared, explained: Sequence[ExplainedOutput], parts: Sequence[Part]) -> dict[str, Any]:
    """Assemble the report of all signals.

    Parameters
    ----------
    prepared : Prepared
    explained : sequence of ExplainedOutput
    parts : sequence of Part
        By output, the last one of each explains everything that was found.

    Returns
    -------
    dict
        JSON-ready, in the layout ``labsid.gap/4``.
    """
    signals = prepared.signals
    last = {part.output: part for part in parts}
    worst = max(last.values(), key=lambda part: part.gap_size)
    effects = _effects(parts)
    gap = _gap(last)
    nu = len(signals.inputs)
    units = prepared.units
    shares = _shares(last)
    verdict = _verdict(effects, last)
    return {
        "schema": SCHEMA,
        "verdict": verdict,
        "signals": {
            "inputs": [{"name": name, "unit": unit} for name, unit in zip(signals.inputs, units[:nu], strict=True)],
            "outputs": [{"name": name, "unit": unit} for name, unit in zip(signals.outputs, units[nu:], strict=True)],
        },
        "effects": effects,
        "ambiguous": _ambiguous(parts, effects),
        "ranking": [row | {"signal": worst.main, "output": worst.output} for row in worst.report["ranking"]],
        "where": {
            **worst.report["where"],
            "path": effects[0]["path"] if effects else verdict,
            "operating": [
                cell | {"signal": _operating_name(str(cell["signal"]), worst)}
                for cell in worst.report["where"]["operating"]
            ],
            "output": worst.output,
            "outputs": shares,
        },
        "gap": gap | {"holdout": worst.report["gap"]["holdout"]},
        "noise": {name: part.report["noise"] for name, part in last.items()},
        "reference": "outside" if any(part.report["reference"] == "outside" for part in last.values()) else "inside",
        "unexplained": _unexplained(last, gap),
        "product": next((product for part in last.values() if (product := part.report["product"])), ""),
        "limits": [
            row | {"signal": {"u": part.main, "y": part.output}.get(row["signal"]), "output": part.output}
            for part in last.values()
            for row in part.report["limits"]
        ],
        "next_experiment": _experiment(signals.inputs, worst, prepared),
        "couplings": _couplings(signals.inputs, signals.outputs, explained),
        "findings": [
            *listed_findings(prepared.findings, prepared.notes),
            *_still(signals.inputs, explained),
            *chain.from_iterable(listed_findings((), part.report["screen"], name) for name, part in last.items()),
        ],
        "record": {"name": signals.name, "samples": len(signals), "Ts": signals.Ts},
        "simulation": {
            "given": signals.given is not None,
            "output_only": False,
            "closed": signals.given is not None and not signals.given.linear,
            "output": None,
            "model": None,
        },
        "numbers": [],
        "inputs": {name: _input_trace(signals, i) for i, name in enumerate(signals.inputs)},
        "input_samples": {name: packed(signals.u[:, i], "<f8") for i, name in enumerate(signals.inputs)},
        "outputs": {
            name: {
                "main": part.main,
                **{key: part.report[key] for key in KEPT if key in part.report},
            }
            for name, part in last.items()
        },
    }


def _signal(path: str, part: Part) -> str | None:
    """The signal at which an effect of a path acts; None in the dynamics and for disturbances."""
    return {"input": part.main, "output": part.output}.get(path)


def _effects(parts: Sequence[Part]) -> list[dict[str, Any]]:
    """Every effect once, with the outputs that it changes, largest gap first; its numbers are those of that output."""
    by_place: dict[tuple[str | None, ...], dict[str, Any]] = {}
    for part in sorted(parts, key=lambda part: -part.gap_size):
        for effect in part.report["effects"]:
            signal = _signal(effect["path"], part)
            pair = effect.get("from"), effect.get("to")
            own = by_place.setdefault((effect["name"], signal, *pair), effect | {"signal": signal, "outputs": []})
            if part.output not in own["outputs"]:
                own["outputs"].append(part.output)
            if part.together:
                closed = [part.output for part in parts if (part.report["gap"]["closed"] or 0.0) > MIN_CLOSED]
                own["outputs"] = list(dict.fromkeys([*own["outputs"], *closed]))
            if effect["probability"] > own["probability"]:
                own |= {key: effect[key] for key in ("probability", "chance")}
    return list(by_place.values())


def _verdict(effects: Sequence[dict[str, Any]], last: dict[str, Part]) -> str:
    verdicts = {part.report["verdict"] for part in last.values()}
    if not effects:
        return "unknown" if verdicts - {"none"} else "none"
    return "effect" if verdicts <= {"none", "effect"} else "partial"


def _gap(last: dict[str, Part]) -> dict[str, Any]:
    """The gap by output, and of all: rms of the errors over each output's noise, if there are several."""
    mode = max((part.mode for part in last.values()), key=("free", "stabilised").index)
    own = {name: part.report["gap"] for name, part in last.items()}
    sds = {name: part.sd for name, part in last.items()}
    by_output = {
        name: {key: gap[key] for key in ("before", "after", "noise_floor", "closed", "ci95")} | {"sd": sds[name]}
        for name, gap in own.items()
    }
    if len(own) == 1:
        (gap,) = own.values()
        return {key: gap[key] for key in ("before", "after", "noise_floor", "closed", "ci95")} | {
            "outputs": by_output,
            "mode": mode,
        }
    noise = {name: max(gap["noise_floor"], np.finfo(float).tiny) for name, gap in own.items()}
    before, after = (
        float(np.sqrt(np.mean([(gap[key] / noise[name]) ** 2 for name, gap in own.items()])))
        for key in ("before", "after")
    )
    open_gap = [
        max((gap["before"] / noise[name]) ** 2 - 1.0, 0.0) if gap["closed"] is not None else 0.0
        for name, gap in own.items()
    ]
    unsure = any(size and not gap["ci95"] for gap, size in zip(own.values(), open_gap, strict=True))
    closed = closed_share(before**2, after**2, 1.0) if before**2 > NO_GAP_MEAN_SQUARE and any(open_gap) else None
    return {
        "before": before,
        "after": after,
        "noise_floor": 1.0,
        "closed": closed,
        "ci95": None if closed is None or unsure else _interval(list(own.values()), open_gap),
        "over_sd": {
            key: float(np.sqrt(np.mean([(gap[key] / sds[name]) ** 2 for name, gap in own.items()])))
            for key in ("before", "after", "noise_floor")
        },
        "outputs": by_output,
        "mode": mode,
    }


def _interval(gaps: Sequence[dict[str, Any]], open_gap: Sequence[float]) -> list[float]:
    """Interval of the closed share of all outputs, from theirs as if they were at the same end together."""
    ends = []
    for end in (0, 1):
        left = [
            size * (1.0 - (one["ci95"][end] if one["ci95"] else 0.0)) ** 2
            for one, size in zip(gaps, open_gap, strict=True)
        ]
        ends.append(1.0 - float(np.sqrt(sum(left) / sum(open_gap))))
    return ends


def _shares(last: dict[str, Part]) -> dict[str, float]:
    """Share of each output in the gap, in units of its noise."""
    sizes = {name: max(part.gap_size**2 - 1.0, 0.0) for name, part in last.items()}
    total = sum(sizes.values())
    return {name: size / total if total else 0.0 for name, size in sizes.items()}


def _unexplained(last: dict[str, Part], gap: dict[str, Any]) -> dict[str, Any]:
    """What is left, of the output that has most of it."""
    left = {
        name: part.report["gap"]["after"] / max(part.report["gap"]["noise_floor"], np.finfo(float).tiny)
        for name, part in last.items()
    }
    most = max(left, key=lambda name: left[name])
    share = 0.0 if gap["closed"] is None else 1.0 - gap["closed"]
    return {**last[most].report["unexplained"], "share": share, "output": most}


def _ambiguous(parts: Sequence[Part], effects: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Alternatives that the record cannot exclude, each with its signal."""
    named = {(one["name"], one["signal"]) for one in effects}
    found: dict[tuple[str, str | None], None] = {}
    for part in sorted(parts, key=lambda part: -part.gap_size):
        for name in part.report["ambiguous"]:
            one = (name, _signal(DESCRIPTIONS[name].path, part))
            if one not in named:
                found.setdefault(one)
    return [{"name": name, "signal": signal} for name, signal in list(found)[:MOST_RIVALS]]


def _operating_name(signal: str, worst: Part) -> str:
    """Name of a signal of the worst output; `dy` is the rate of the output."""
    return {"u": worst.main, "y": worst.output, "dy": f"rate of {worst.output}"}[signal]


def _input_trace(signals: Signals, i: int) -> dict[str, list[float]]:
    """An input at the samples that preserve it in a figure."""
    u = signals.u[:, i]
    pick = extreme_samples([u])
    return {"t": signals.t[pick].tolist(), "u": u[pick].tolist()}


def _experiment(inputs: Sequence[str], worst: Part, prepared: Prepared) -> dict[str, Any] | None:
    """The proposed input, with the other inputs at rest."""
    found = worst.report["next_experiment"]
    if found is None:
        return None
    rest = {name: [float(prepared.signals.u[0, i])] * len(found["u"]) for i, name in enumerate(inputs)}
    return found | {"u": rest | {worst.main: found["u"]}}


def _couplings(
    inputs: Sequence[str], outputs: Sequence[str], explained: Sequence[ExplainedOutput]
) -> list[dict[str, Any]]:
    """Which input moves which output, and its share of the variance of all responses."""
    found = []
    for one in explained:
        power = np.where(one.search.parts.moves, one.search.parts.strength, 0.0) ** 2
        for i in np.flatnonzero(one.search.parts.moves).tolist():
            share = float(power[i] / power.sum())
            found.append({"from": inputs[i], "to": outputs[one.output], "share": share})
    return found


def _still(inputs: Sequence[str], explained: Sequence[ExplainedOutput]) -> list[dict[str, Any]]:
    """Inputs that move no output."""
    moves = np.any([one.search.parts.moves for one in explained], axis=0)
    return [
        {"kind": "signals", "signal": name, "text": f"{name} moves no output by more than chance."}
        for name, any_output in zip(inputs, moves, strict=True)
        if not any_output
    ]
