"""The main path of the diagnosis: a record and a simulation in, the answer out."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.baseline import Baseline, Simulation, check_bounded, make_baseline, read_exported
from labsid.gap.beam_search import Progress
from labsid.gap.clock import at_sampling_time, clock_findings, stated_sampling_time
from labsid.gap.data import scaled
from labsid.gap.decision import MIN_CONFIDENCE, confidence_in, decide
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.explanation import Explanation, explain
from labsid.gap.long_record import shorten_holdout, shorten_record
from labsid.gap.model_file import ExportedModel, export_model
from labsid.gap.record_findings import (
    PlateauGap,
    filter_length,
    findings_from_errors,
    findings_from_record,
    plateau_gap,
)
from labsid.gap.report import build_report
from labsid.gap.residual_tests import measure_residual
from labsid.gap.scores import GapScore, score_explanation
from labsid.gap.traces import figure_traces
from labsid.lab.findings import about_clipping
from labsid.records.record import Record

MIN_SAMPLES = 100  # samples


@dataclass(frozen=True, slots=True, eq=False)
class Diagnosis:
    """The answer.

    Attributes
    ----------
    report : dict
        What ``--json`` writes, in the contract's layout.
    model : RunningModel
        The simulation with the effects in it: what ``--export`` writes.
    """

    report: dict[str, Any]
    model: ExportedModel


def diagnose(
    record: Record,
    simulation: Simulation | None = None,
    *,
    holdout: Record | None = None,
    order: int = 2,
    exclude: Sequence[tuple[float, float]] = (),
    seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Say where a simulation and a rig disagree, which effect causes it, and how far adding it closes the gap.

    Parameters
    ----------
    record : Record
    simulation : dict, ndarray or callable, optional
        MODEL.json or an exported simulation; the output of any simulator on the record's input, shape (N,); or
        ``simulate(t, u) -> y``. Unless given, the lab's second-order structure fitted by output error.
    holdout : Record, optional
        Another record of the same rig to score on. Unless given, blocks spread over `record` are left out of the
        fits that are scored.
    order : int
        Of the fitted simulation: 1 to 4.
    exclude : sequence of (float, float)
        Stretches of time, in seconds, that count nowhere.
    seed : int
        Of the resampling behind the intervals, and of the proposed inputs.
    progress : callable, optional
        Called with what is being done and the share of it that is done.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ValueError
        If the record is too short or its input or output is constant, or the simulation does not fit it.
    """
    record, holdout = _common_sampling_time(record, holdout, simulation)
    _check_records(record, holdout)
    clocks = clock_findings(record, holdout)
    whole, part = record, shorten_record(record, simulation)
    record, simulation, notes = part.record, part.simulation, part.notes
    if holdout is not None:
        holdout, more = shorten_holdout(holdout, part.every)
        notes += more
    _check_records(record, holdout)
    if holdout is not None:
        holdout = Record(holdout.t, filtered_input(holdout), holdout.y, holdout.Ts, name=holdout.name)
    simulation = read_exported(simulation, record.Ts)
    scales = (simulation.u_scale, simulation.y_scale) if isinstance(simulation, ExportedModel) else None
    rows = _counted(record, exclude)
    data = scaled(filtered_input(record), record.y, rows, record.Ts, float(record.t[0]), scales)
    base = make_baseline(data, record.t, simulation, order)
    if base.output_only and holdout is not None:
        raise ValueError(
            "a simulated output is known on its own record only. Give a simulation that runs, or no holdout."
        )
    rng = np.random.default_rng(seed)
    explanation, score = _score(explain(data, base.structure, base.start, progress=progress), base, holdout, rng)
    left, plateau = measure_residual(explanation.data, explanation.best), _plateaus(record, base, explanation)
    unrepeated = plateau.left if plateau is not None and plateau.matters else 0.0
    confidence = confidence_in(explanation, left, score.closed, unrepeated)
    if (
        confidence < MIN_CONFIDENCE and explanation.trimmed
    ):  # small steps are left out for their names, and these are not given
        explanation, score = _score(explanation.untrimmed(), base, holdout, rng)
        left, plateau = measure_residual(explanation.data, explanation.best), _plateaus(record, base, explanation)
    decision = decide(explanation, left, base.before, confidence, at_stop=bool(about_clipping(record.y)))
    if decision.verdict != "unknown" and len(explanation.path) == 1:  # what was found, no simulation shows
        score = replace(score, closed=None, ci95=None, black_box=None)
    model = export_model(explanation.data, score.after_fit)
    report = build_report(record, explanation, base, decision, left, score, rng, holdout)
    seen = [*clocks, *findings_from_record(whole, plateau)]
    seen += findings_from_errors(record.u, record.y, *_outputs(base, explanation), explanation.data.rows)
    report["record"]["samples"] = len(whole)
    report["record_findings"] = [asdict(finding) for finding in seen]
    report["plateaus"] = None if plateau is None else asdict(plateau)
    report["screen"] = [*notes, *report["screen"]]
    report["holdout_traces"] = None
    if holdout is not None:
        linear = export_model(explanation.data, explanation.path[0])
        before = (
            linear.simulate(holdout.u, holdout.y) if base.simulate_record is None else base.simulate_record(holdout)
        )
        after = model.simulate(holdout.u, holdout.y)
        report["holdout_traces"] = figure_traces(holdout.t, holdout.u, holdout.y, before, after)
    return Diagnosis(report, model)


def _counted(record: Record, exclude: Sequence[tuple[float, float]]) -> np.ndarray:
    """The samples that `exclude` leaves."""
    rows = np.ones(len(record), bool)
    for start, stop in exclude:
        inside = (record.t >= start) & (record.t < stop)
        if not inside.any():
            span = f"{record.t[0]:g} to {record.t[-1]:g} s"
            raise ValueError(f"--exclude {start:g}:{stop:g} holds no sample: the record runs from {span}.")
        rows &= ~inside
    if rows.sum() < MIN_SAMPLES:
        raise ValueError(f"--exclude leaves {rows.sum()} samples; at least {MIN_SAMPLES} must stay.")
    return rows


def _score(
    explanation: Explanation, base: Baseline, holdout: Record | None, rng: np.random.Generator
) -> tuple[Explanation, GapScore]:
    """How far an explanation closes the gap; where it helps a given simulation not at all, it is none.

    A slow disturbance cannot be foretold on samples that no fit has seen, and stands nevertheless.
    """
    data = explanation.data
    other = None if holdout is None else (data.u_scale.of(holdout.u), data.y_scale.of(holdout.y))
    played = None
    if holdout is not None and base.simulate_record is not None:
        played = data.y_scale.of(check_bounded(base.simulate_record(holdout), holdout.y))
    score = score_explanation(explanation, base.before, other, rng, played)
    foretold = not any(isinstance(effect, AdditiveEffect) for effect in explanation.best.hypothesis.effects)
    if base.given and len(explanation.path) > 1 and foretold and (score.closed or 0.0) <= 0.0:
        explanation = explanation.up_to(0)
        score = score_explanation(explanation, base.before, other, rng, played)
    return explanation, score


def _outputs(base: Baseline, explanation: Explanation) -> tuple[FloatArray, FloatArray]:
    """Output of the simulation before and after, in the record's unit."""
    before = base.before or explanation.path[0]
    back = explanation.data.y_scale.back
    return np.asarray(back(before.output)), np.asarray(back(explanation.best.output))


def _plateaus(record: Record, base: Baseline, explanation: Explanation) -> PlateauGap | None:
    return plateau_gap(record.u, record.y, *_outputs(base, explanation), explanation.data.rows)


def filtered_input(record: Record) -> FloatArray:
    """The input, averaged as the logger averages its output where the record shows that it does.

    The mean of the last m samples commutes with linear dynamics: with it in front, the simulation has the logger's
    filter in it, and the filter is no gap.
    """
    length = filter_length(record)
    padded = np.concatenate([np.full(length - 1, record.u[0]), record.u])
    return np.convolve(padded, np.full(length, 1.0 / length), mode="valid")


def _common_sampling_time(
    record: Record, holdout: Record | None, simulation: Simulation | None
) -> tuple[Record, Record | None]:
    """Both records at one sampling time, as far as clocks that jitter leave it open.

    It is that of the simulation if that has one, or of a holdout whose clock does not jitter, or else of the record.
    """
    if isinstance(simulation, ExportedModel):
        record = at_sampling_time(record, simulation.Ts)
    elif isinstance(simulation, dict):
        record = at_sampling_time(record, stated_sampling_time(simulation))
    if holdout is None:
        return record, None
    if not holdout.jitter:
        record = at_sampling_time(record, holdout.Ts)
    return record, at_sampling_time(holdout, record.Ts)


def _check_records(record: Record, holdout: Record | None) -> None:
    """Refuse what no method could answer on."""
    for name, one in (("the record", record), ("the holdout", holdout)):
        if one is None:
            continue
        if len(one) < MIN_SAMPLES:
            raise ValueError(f"{name} has {len(one)} samples; a diagnosis needs at least {MIN_SAMPLES}. Record longer.")
        for signal, values in (("u", one.u), ("y", one.y)):
            if np.ptp(values) == 0.0:
                raise ValueError(f"{signal} of {name} is constant ({values[0]:g}); nothing can be identified from it.")
    if holdout is not None and abs(holdout.Ts - record.Ts) > 1e-6 * record.Ts:
        raise ValueError(f"the holdout runs at {holdout.Ts:g} s, the record at {record.Ts:g} s. Resample one of them.")
