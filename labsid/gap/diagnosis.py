"""Diagnose the gap between a record and a simulation."""

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
    """Result of `diagnose`.

    Attributes
    ----------
    report : dict
        In the layout ``labsid.gap/1``; ``--json`` writes it.
    model : ExportedModel
        The simulation with the effects added; ``--export`` writes it.
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
    """Find where a simulation and a rig disagree, which effects cause it, and the share of the gap that they close.

    Parameters
    ----------
    record : Record
    simulation : dict, ndarray or callable, optional
        MODEL.json or an exported simulation; the output of any simulator on the record's input, shape (N,); or
        ``simulate(t, u) -> y``. By default a linear model of the given order, fitted by output error.
    holdout : Record, optional
        Another record of the same rig for scoring. By default, blocks of `record` are held out of the fits that are
        scored.
    order : int
        Order of the fitted model, 1 to 4.
    exclude : sequence of (float, float)
        Time ranges, in seconds, that are neither fitted nor scored.
    seed : int
        Random seed of the confidence intervals and the proposed input.
    progress : callable, optional
        Called with a description of the current step and the completed share.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ValueError
        If the record is too short, its input or output is constant, or the simulation does not match the record.
    """
    record, holdout = _common_sampling_time(record, holdout, simulation)
    _check_records(record, holdout)
    clocks = clock_findings(record, holdout)
    whole, shortened = record, shorten_record(record, simulation)
    record, simulation, notes = shortened.record, shortened.simulation, shortened.notes
    if holdout is not None:
        holdout, more = shorten_holdout(holdout, shortened.every)
        notes += more
    _check_records(record, holdout)
    if holdout is not None:
        holdout = Record(holdout.t, filtered_input(holdout), holdout.y, holdout.Ts, name=holdout.name)
    simulation = read_exported(simulation, record.Ts)
    scales = (simulation.u_scale, simulation.y_scale) if isinstance(simulation, ExportedModel) else None
    rows = _included(record, exclude)
    data = scaled(filtered_input(record), record.y, rows, record.Ts, float(record.t[0]), scales)
    base = make_baseline(data, record.t, simulation, order)
    if base.output_only and holdout is not None:
        raise ValueError(
            "a simulated output is known on its own record only. Give a model or a function, or omit the holdout."
        )
    rng = np.random.default_rng(seed)
    explanation, score = _score(explain(data, base.structure, base.start, progress=progress), base, holdout, rng)
    left, plateau = measure_residual(explanation.data, explanation.best), _plateaus(record, base, explanation)
    unrepeated = plateau.left if plateau is not None and plateau.matters else 0.0
    confidence = confidence_in(explanation, left, score.closed, unrepeated)
    if confidence < MIN_CONFIDENCE and explanation.trimmed:  # no effect is named, so keep the small ones
        explanation, score = _score(explanation.untrimmed(), base, holdout, rng)
        left, plateau = measure_residual(explanation.data, explanation.best), _plateaus(record, base, explanation)
    decision = decide(explanation, left, base.before, confidence, at_stop=bool(about_clipping(record.y)))
    if decision.verdict != "unknown" and len(explanation.path) == 1:  # no simulated effect was added
        score = replace(score, closed=None, ci95=None, black_box=None)
    model = export_model(explanation.data, score.after_fit)
    report = build_report(record, explanation, base, decision, left, score, rng, holdout)
    findings = [*clocks, *findings_from_record(whole, plateau)]
    findings += findings_from_errors(record.u, record.y, *_outputs(base, explanation), explanation.data.rows)
    report["record"]["samples"] = len(whole)
    report["record_findings"] = [asdict(finding) for finding in findings]
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


def _included(record: Record, exclude: Sequence[tuple[float, float]]) -> np.ndarray:
    """Mask of the samples outside the excluded time ranges."""
    rows = np.ones(len(record), bool)
    for start, stop in exclude:
        inside = (record.t >= start) & (record.t < stop)
        if not inside.any():
            span = f"{record.t[0]:g} to {record.t[-1]:g} s"
            raise ValueError(f"--exclude {start:g}:{stop:g} contains no sample: the record runs from {span}.")
        rows &= ~inside
    if rows.sum() < MIN_SAMPLES:
        raise ValueError(f"--exclude leaves {rows.sum()} samples; at least {MIN_SAMPLES} are needed.")
    return rows


def _score(
    explanation: Explanation, base: Baseline, holdout: Record | None, rng: np.random.Generator
) -> tuple[Explanation, GapScore]:
    """Score an explanation; reject it if it does not improve a given simulation on held-out samples.

    A disturbance cannot be predicted on held-out samples, so an explanation with one is not rejected.
    """
    data = explanation.data
    other = None if holdout is None else (data.u_scale.of(holdout.u), data.y_scale.of(holdout.y))
    given_output = None
    if holdout is not None and base.simulate_record is not None:
        given_output = data.y_scale.of(check_bounded(base.simulate_record(holdout), holdout.y))
    score = score_explanation(explanation, base.before, other, rng, given_output)
    predictable = not any(isinstance(effect, AdditiveEffect) for effect in explanation.best.hypothesis.effects)
    if base.given and len(explanation.path) > 1 and predictable and (score.closed or 0.0) <= 0.0:
        explanation = explanation.up_to(0)
        score = score_explanation(explanation, base.before, other, rng, given_output)
    return explanation, score


def _outputs(base: Baseline, explanation: Explanation) -> tuple[FloatArray, FloatArray]:
    """Outputs of the simulation before and after, in the unit of the record."""
    before = base.before or explanation.path[0]
    back = explanation.data.y_scale.back
    return np.asarray(back(before.output)), np.asarray(back(explanation.best.output))


def _plateaus(record: Record, base: Baseline, explanation: Explanation) -> PlateauGap | None:
    return plateau_gap(record.u, record.y, *_outputs(base, explanation), explanation.data.rows)


def filtered_input(record: Record) -> FloatArray:
    """The input, filtered by the same moving mean as the logged output, if the record has one.

    A moving mean commutes with linear dynamics, so filtering the input includes the logger's filter in the simulation.
    """
    length = filter_length(record)
    padded = np.concatenate([np.full(length - 1, record.u[0]), record.u])
    return np.convolve(padded, np.full(length, 1.0 / length), mode="valid")


def _common_sampling_time(
    record: Record, holdout: Record | None, simulation: Simulation | None
) -> tuple[Record, Record | None]:
    """Bring records with clock jitter to one sampling time.

    It is that of the simulation if it has one, else that of a holdout without jitter, else that of the record.
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
    """Reject records that are too short, have a constant signal, or differ in their sampling time."""
    for name, one in (("the record", record), ("the holdout", holdout)):
        if one is None:
            continue
        if len(one) < MIN_SAMPLES:
            raise ValueError(
                f"{name} has {len(one)} samples; a diagnosis needs at least {MIN_SAMPLES}. Use a longer record."
            )
        for signal, values in (("u", one.u), ("y", one.y)):
            if np.ptp(values) == 0.0:
                raise ValueError(f"{signal} of {name} is constant ({values[0]:g}); nothing can be identified from it.")
    if holdout is not None and abs(holdout.Ts - record.Ts) > 1e-6 * record.Ts:
        raise ValueError(f"the holdout runs at {holdout.Ts:g} s, the record at {record.Ts:g} s. Resample one of them.")
