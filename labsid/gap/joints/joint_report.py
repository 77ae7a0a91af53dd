"""The report of a model of several joints, from the reports of the joined outputs at each joint with an effect."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.joints.joint_search import AtJoint, Found
from labsid.gap.joints.views import ArmRecord
from labsid.gap.reports.layout import SCHEMA, listed_findings
from labsid.gap.reports.location import most_uneven_signal, operating_map, share_by_frequency, share_by_time
from labsid.gap.reports.traces import extreme_samples, figure_traces
from labsid.gap.signals.combined_report import KEPT
from labsid.gap.signals.preparation import Prepared
from labsid.gap.signals.roles import Signals
from labsid.gap.verdict.answer import Answer
from labsid.gap.verdict.decision import MIN_RIVAL_PROBABILITY, TEMPERATURE
from labsid.gap.verdict.scores import NO_GAP_MEAN_SQUARE, closed_share

MOST_RIVALS = 3
NONE_OF_MODEL = ("none", "unknown")  # verdicts without an effect


@dataclass(frozen=True, slots=True, eq=False)
class JointPart:
    """The report of the joined outputs, as seen at a joint.

    Attributes
    ----------
    at : AtJoint
    answer : Answer
    report : dict
        As of one output, in units of the noise.
    holdout : tuple, optional
        Another record, the outputs there before and after, shape (N, ny), and the samples that are scored.
    """

    at: AtJoint
    answer: Answer
    report: dict[str, Any]
    holdout: tuple[Signals, FloatArray, FloatArray, np.ndarray] | None = None

    @property
    def joint(self) -> dict[str, str]:
        """Names of the joint and of its actuator, as in the report."""
        one = self.at.view.arm.joints.joints[self.at.view.joint]
        return {"joint": one.joint, "actuator": one.actuator}


def combine_joints(
    prepared: Prepared, arm: ArmRecord, found: Found, parts: Sequence[JointPart], evaluations: Mapping[str, Any]
) -> dict[str, Any]:
    """Assemble the report.

    Parameters
    ----------
    prepared : Prepared
    arm : ArmRecord
    found : Found
    parts : sequence of JointPart
        In the order of `found.at`.
    evaluations : mapping
        Runs of the simulation.

    Returns
    -------
    dict
        JSON-ready, in the layout ``labsid.gap/4``.
    """
    signals, last = arm.signals, parts[-1]
    names, nu = signals.outputs, len(signals.inputs)
    units = prepared.units
    rivals = _rivals(found, parts)
    effects = _effects(parts, rivals, names)
    verdict = _verdict(parts, effects)
    record, outputs, scored = _compared(last)
    gap = _gap(last, record, outputs, scored)
    worst = max(
        names, key=lambda name: gap["outputs"][name]["before"] / max(gap["outputs"][name]["noise_floor"], 1e-300)
    )
    j = names.index(worst)
    before, after = (last.at.view.outputs(output) for output in _on_record(last))
    e = np.where(signals.rows[:, j], signals.y[:, j] - before[:, j], 0.0)
    main = _main(arm, j)
    return {
        "schema": SCHEMA,
        "verdict": verdict,
        "signals": {
            "inputs": [{"name": name, "unit": unit} for name, unit in zip(signals.inputs, units[:nu], strict=True)],
            "outputs": [{"name": name, "unit": unit} for name, unit in zip(names, units[nu:], strict=True)],
        },
        "effects": effects,
        "ambiguous": _ambiguous(parts, rivals, effects),
        "ranking": _ranking(arm, found, last),
        "where": {
            "path": effects[0]["path"] if effects else verdict,
            "time": share_by_time(signals.t, e, signals.Ts, np.zeros(e.size, bool)),
            "band_hz": share_by_frequency(e, signals.Ts),
            "operating": [
                cell | {"signal": {"u": main, "y": worst, "dy": f"rate of {worst}"}[str(cell["signal"])]}
                for cell in most_uneven_signal(signals.u[:, signals.inputs.index(main)], signals.y[:, j], signals.Ts, e)
            ],
            "map": operating_map(signals.u[:, signals.inputs.index(main)], signals.y[:, j], e),
            "output": worst,
            "outputs": _shares(gap),
        },
        "gap": gap | {"holdout": _of_first(last)},
        "noise": {
            name: {"sd": row["noise_floor"], "correlation_time": last.report["noise"]["correlation_time"]}
            for name, row in gap["outputs"].items()
        },
        "reference": "outside" if any(part.report["reference"] == "outside" for part in parts) else "inside",
        "novelty": last.report["novelty"],
        "unexplained": last.report["unexplained"]
        | {"share": 0.0 if gap["closed"] is None else 1.0 - gap["closed"], "output": worst},
        "limits": [],
        "next_experiment": None,
        "couplings": [],
        "findings": listed_findings(prepared.findings, prepared.notes),
        "record": {"name": signals.name, "samples": len(signals), "Ts": signals.Ts},
        "simulation": {
            "given": True,
            "output_only": False,
            "closed": False,
            "output": None,
            "model": None,
            "evaluations": dict(evaluations),
        },
        "numbers": last.report["numbers"],
        "inputs": {name: _input_trace(signals, i) for i, name in enumerate(signals.inputs)},
        "outputs": {
            name: _output(last, arm, gap["outputs"][name], k, before[:, k], after[:, k]) for k, name in enumerate(names)
        },
    }


def _verdict(parts: Sequence[JointPart], effects: Sequence[dict[str, Any]]) -> str:
    verdict = str(parts[-1].report["verdict"])
    if effects and verdict in NONE_OF_MODEL:
        return "partial"
    return verdict if effects or verdict in NONE_OF_MODEL else "unknown"


def _main(arm: ArmRecord, j: int) -> str:
    """The input of the joint of an output, or the first one."""
    return arm.signals.inputs[arm.joints.input_of(arm.joints.outputs[j][0])]


def _rivals(found: Found, parts: Sequence[JointPart]) -> list[tuple[str, int, float]]:
    """Single effects at other joints beside the first one found, with their weight over that of it."""
    first = parts[0]
    if not found.at[0].found or len(parts) > 1:
        return []
    names, joint = set(first.at.fit.hypothesis.names), first.at.view.joint
    own = [one.score for one in found.trials if one.joint == joint and one.name in names]
    if len(names) > 1 or not own:
        return []
    weights = [
        (one.name, one.joint, float(np.exp(-max(one.score - min(own), 0.0) / (2.0 * TEMPERATURE))))
        for one in found.trials
        if one.joint != joint
    ]
    return [one for one in weights if one[2] > MIN_RIVAL_PROBABILITY]


def _effects(
    parts: Sequence[JointPart], rivals: Sequence[tuple[str, int, float]], outputs: Sequence[str]
) -> list[dict[str, Any]]:
    """The effects of all joints, with the outputs that they change."""
    share = 1.0 / (1.0 + sum(weight for _, _, weight in rivals))
    found = []
    for part in parts:
        for effect in part.report["effects"]:
            at_input = effect["name"] in part.at.at_command and "joint" not in effect
            signal = part.at.view.arm.signals.inputs[part.at.view.main] if at_input else None
            placed = {"signal": signal, "outputs": list(outputs), "probability": effect["probability"] * share}
            found.append(effect | placed)
    return found


def _ambiguous(
    parts: Sequence[JointPart], rivals: Sequence[tuple[str, int, float]], effects: Sequence[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Alternatives that the record cannot exclude, each with its joint."""
    named = {(one["name"], one.get("joint")) for one in effects}
    joints = parts[0].at.view.arm.joints.joints
    at = [(name, part.joint["joint"]) for part in parts for name in part.report["ambiguous"]]
    at += [(name, joints[joint].joint) for name, joint, _ in rivals]
    return [
        {"name": name, "joint": joint, "signal": None}
        for name, joint in dict.fromkeys(one for one in at if one not in named)
    ][:MOST_RIVALS]


def _ranking(arm: ArmRecord, found: Found, last: JointPart) -> list[dict[str, Any]]:
    """What was fitted at the joint that was searched last, then the trials at all joints."""
    own = [row | last.joint for row in last.report["ranking"]]
    listed = {(row["name"], row["joint"]) for row in own}
    trials = [
        {
            "name": one.name,
            "joint": arm.joints.joints[one.joint].joint,
            "probability": 0.0,
            "rmse": float(np.sqrt(one.error)),
            "closed": None,
        }
        for one in found.trials
    ]
    return own + [row for row in trials if (row["name"], row["joint"]) not in listed]


def _on_record(part: JointPart) -> tuple[FloatArray, FloatArray]:
    """Joined outputs before and after, as fitted to the record."""
    return part.answer.before.output, part.answer.explanation.best.output


def _compared(part: JointPart) -> tuple[Signals, tuple[FloatArray, FloatArray], np.ndarray]:
    """The record on which the gap is scored, the outputs there before and after, and the samples that count."""
    view = part.at.view
    if part.holdout is not None:
        signals, before, after, scored = part.holdout
        return signals, (before, after), scored[:, None] & signals.rows
    before, after = (view.outputs(output) for output in part.answer.score.outputs)
    pieces = {j: part.answer.score.scored[slice(*piece)] for j, piece in zip(view.order, view.data.beside, strict=True)}
    return view.arm.signals, (before, after), np.column_stack([pieces[j] for j in range(len(pieces))])


def _gap(
    part: JointPart, signals: Signals, outputs: tuple[FloatArray, FloatArray], scored: np.ndarray
) -> dict[str, Any]:
    """The gap by output, and of all: rms of the errors over each output's noise."""
    view, score = part.at.view, part.answer.score
    fitted = view.outputs(score.after_fit.output)
    rows = view.arm.signals.rows
    left = np.array([np.mean((view.arm.signals.y - fitted)[rows[:, j], j] ** 2) for j in range(fitted.shape[1])])
    weights = np.array([scale.unit for scale in view.arm.scales]) ** 2
    unit = view.data.y_scale.unit
    correct = min((score.floor * unit) ** 2 / max(float(np.mean(left / weights)), 1e-300), 1.0)
    found: dict[str, dict[str, Any]] = {}
    for j, name in enumerate(signals.outputs):
        before, after = (float(np.mean((signals.y - one)[scored[:, j], j] ** 2)) for one in outputs)
        floor = correct * float(left[j])
        named = score.closed is not None and before > NO_GAP_MEAN_SQUARE * floor
        found[name] = {
            "before": float(np.sqrt(before)),
            "after": float(np.sqrt(after)),
            "noise_floor": float(np.sqrt(floor)),
            "closed": closed_share(before, after, floor) if named else None,
            "ci95": None,
            "sd": float(np.std(signals.y[scored[:, j], j])),
        }
    over_noise, over_sd = (
        {
            key: float(np.sqrt(np.mean([(row[key] / max(row[of], 1e-300)) ** 2 for row in found.values()])))
            for key in ("before", "after", "noise_floor")
        }
        for of in ("noise_floor", "sd")
    )
    before, after = over_noise["before"], over_noise["after"]
    closed = closed_share(before**2, after**2, 1.0) if score.closed is not None else None
    ci95 = None if score.ci95 is None or part.holdout is not None else list(score.ci95)
    return over_noise | {
        "closed": closed,
        "ci95": ci95,
        "over_sd": over_sd,
        "outputs": found,
        "mode": "free",
        "corrected": None,
    }


def _shares(gap: dict[str, Any]) -> dict[str, float]:
    """Share of each output in the gap, in units of its noise."""
    sizes = {
        name: max((row["before"] / max(row["noise_floor"], 1e-300)) ** 2 - 1.0, 0.0)
        for name, row in gap["outputs"].items()
    }
    total = sum(sizes.values())
    return {name: size / total if total else 0.0 for name, size in sizes.items()}


def _output(
    part: JointPart, arm: ArmRecord, gap: dict[str, Any], j: int, before: FloatArray, after: FloatArray
) -> dict[str, Any]:
    """What is reported of one output."""
    signals, main = arm.signals, _main(arm, j)
    u = signals.u[:, signals.inputs.index(main)]
    shown = np.where(signals.rows[:, j], signals.y[:, j], before)
    found: dict[str, Any] = {key: part.report[key] for key in KEPT if key in part.report} | {
        "main": main,
        "gap": gap | {"holdout": _of_first(part)},
        "traces": figure_traces(signals.t, u, shown, before, after, signals.rows[:, j]),
    }
    if part.holdout is not None:
        other, first, second, _ = part.holdout
        own = other.u[:, signals.inputs.index(main)]
        found["holdout_traces"] = figure_traces(
            other.t, own, other.y[:, j], first[:, j], second[:, j], other.rows[:, j]
        )
    return found


def _of_first(part: JointPart) -> list[list[float]]:
    """The stretches of time that are scored: the same in each output."""
    if part.holdout is not None:
        signals, _, _, scored = part.holdout
        return [[float(signals.t[scored][0]), float(signals.t[-1])]]
    end = float(part.at.view.arm.signals.t[-1]) + part.at.view.data.Ts
    return [stretch for stretch in part.report["gap"]["holdout"] if stretch[0] < end]


def _input_trace(signals: Signals, i: int) -> dict[str, list[float]]:
    """An input at the samples that preserve it in a figure."""
    u = signals.u[:, i]
    pick = extreme_samples([u])
    return {"t": signals.t[pick].tolist(), "u": u[pick].tolist()}
