"""Diagnose a record of several inputs or outputs."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.model_file import export_model
from labsid.gap.record.clock import clock_findings
from labsid.gap.reports.quantities import with_units
from labsid.gap.reports.replay_data import shown_signals
from labsid.gap.reports.report import build_report
from labsid.gap.reports.traces import figure_traces
from labsid.gap.search.beam_search import Progress
from labsid.gap.signals.combined_report import Part, combine
from labsid.gap.signals.couplings import couplings_of, with_couplings
from labsid.gap.signals.given import as_system, simulate_elsewhere
from labsid.gap.signals.linear_free_run import simulate_linear_models
from labsid.gap.signals.neighbours import Coupled, simulate_together
from labsid.gap.signals.preparation import Prepared, prepare, prepare_holdout
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.gap.signals.roles import Role, Signals
from labsid.gap.signals.search import ExplainedOutput, Through, explain_outputs
from labsid.gap.simulations.baseline import AnySimulation, Baseline
from labsid.gap.system_file import Actuator, ExportedOutput, ExportedSystem
from labsid.gap.verdict.answer import Answer, answer_from
from labsid.gap.verdict.scores import NO_GAP_MEAN_SQUARE, GapScore, closed_share
from labsid.records.record import Record
from labsid.simulators.meter import SEARCH_SHARE


def diagnose_signals(
    record: Record,
    simulation: AnySimulation | None = None,
    *,
    free: Sequence[str] = (),
    holdout: Record | None = None,
    order: int = 2,
    exclude: Sequence[tuple[float, float]] = (),
    seed: int = 0,
    evaluations: int | None = None,
    progress: Progress | None = None,
) -> SignalsDiagnosis:
    """Find the effects at every input and output of a record, and in its dynamics.

    Parameters
    ----------
    record : Record
        Of several inputs or outputs.
    simulation : AnySimulation, optional
        A simulation of all of them; see `as_system`.
    free : sequence of str
        Numbers of it that may be fitted.
    holdout : Record, optional
        Another record of the same signals, for scoring.
    order : int
        Order of the response of an output to the input through which it is explained, 1 to 4; second to the others.
    exclude : sequence of (float, float)
        Time ranges, in seconds, that are neither fitted nor scored.
    seed : int
        Random seed of the confidence intervals.
    evaluations : int, optional
        Largest number of runs of the simulation in the search.
    progress : callable, optional

    Returns
    -------
    SignalsDiagnosis

    Raises
    ------
    ValueError
        If a signal cannot be used.
    """
    prepared = prepare(record, exclude)
    scored_holdout = None if holdout is None else prepare_holdout(holdout, prepared)
    prepared = replace(prepared, findings=(*clock_findings(record, holdout), *prepared.findings))
    prepared = _with_simulation(prepared, simulation, record.outputs, free)
    given = prepared.signals.given
    if given is None:
        explained = explain_outputs(prepared.signals, order, progress)
    else:
        given.simulator.meter.begin(evaluations)
        with given.simulator.meter.searching(SEARCH_SHARE):
            explained = explain_outputs(prepared.signals, order, progress)
    made = [_parts(prepared, output, scored_holdout, seed, progress) for output in explained]
    parts = [part for parts, _ in made for part in parts]
    if explained[0].search.signals is not prepared.signals:  # beside measured neighbours
        parts = _simulated_together(
            prepared, explained, parts, [answer.score for _, answer in made], scored_holdout, order
        )
    system = _system(prepared.signals, explained, [answer for _, answer in made], record.outputs)
    models = {name: output.model for name, output in system.outputs.items()}
    exportable = None if explained[0].search.signals is not prepared.signals else system
    return SignalsDiagnosis(combine(prepared, explained, parts), models, exportable)


def _with_simulation(
    prepared: Prepared, simulation: AnySimulation | None, outputs: Sequence[str], free: Sequence[str]
) -> Prepared:
    """The record with a given simulation, and the paths between its signals that it lacks."""
    signals = prepared.signals
    record = Record(
        signals.t, signals.u, signals.y, signals.Ts, name=signals.name, inputs=signals.inputs, outputs=signals.outputs
    )
    given = as_system(simulation, record, outputs, free)
    if given is None:
        return prepared
    signals = replace(signals, given=given)
    couplings = tuple(couplings_of(signals, j) for j in range(len(signals.outputs)))
    return replace(prepared, signals=replace(signals, given=replace(given, couplings=couplings)))


def _system(
    signals: Signals, explained: Sequence[ExplainedOutput], answers: Sequence[Answer], outputs: Sequence[str]
) -> ExportedSystem:
    """The corrected simulation of every output through the input by which everything that was found is explained."""
    found = {}
    for one, answer in zip(explained, answers, strict=True):
        through = one.through[-1]
        inputs = one.search.signals.inputs
        model = export_model(answer.explanation.data, answer.score.after_fit, answer.elsewhere, answer.start)
        actuators = tuple(Actuator.of(inputs[at.role.main], at.fit) for at in through.others)
        found[signals.outputs[one.output]] = ExportedOutput(model, inputs[through.role.main], actuators)
    return ExportedSystem(signals.inputs, signals.input_scales, found, tuple(outputs))


def _parts(
    prepared: Prepared, one: ExplainedOutput, other: Prepared | None, seed: int, progress: Progress | None
) -> tuple[list[Part], Answer]:
    """The report of an output through each input at which effects were found; the last one is that of the output."""
    whole, signals, parts = prepared.signals, one.search.signals, []
    name = whole.outputs[one.output]
    scored_signals = None if other is None else _seen_as(signals, other.signals)
    for through in one.through:
        rng = np.random.default_rng(seed)
        i, j = through.role.main, through.role.output
        record = _pair(signals, i, j)
        scored = None if scored_signals is None else _pair(scored_signals, i, j)
        measured = None if scored_signals is None else scored_signals.rows[:, j]
        further = None if scored_signals is None else _further(through, signals, scored_signals)
        base = _on_holdout(through.role, signals, scored_signals)
        answer = answer_from(record, through.explanation, base, scored, rng, progress, measured, further)
        report = build_report(record, answer, through.role.base, rng, scored)
        report = with_couplings(report, whole, one.output, answer.explanation.path[0])
        units = prepared.units[whole.inputs.index(signals.inputs[i])], prepared.units[len(whole.inputs) + one.output]
        report = with_units(report, *units) if all(units) else report
        before, after = answer.outputs
        rows = signals.rows[:, j]
        report["replay"] = shown_signals(record, np.ones(len(record), bool), (rows, measured), answer, scored)
        report["traces"] = figure_traces(record.t, record.u, np.where(rows, record.y, before), before, after, rows)
        if scored is not None:
            back = answer.explanation.data.y_scale.back
            before, after = (np.asarray(back(output)) for output in answer.score.outputs)
            report["holdout_traces"] = figure_traces(scored.t, scored.u, scored.y, before, after, measured)
        parts.append(Part(name, signals.inputs[i], report, float(np.std(record.y[rows]))))
    return parts, answer


def _on_holdout(role: Role, signals: Signals, other: Signals | None) -> Baseline:
    """The baseline of an output, its given simulation on another record with all inputs of that one."""
    if other is None or signals.given is None:
        return role.base
    rates = role.base.structure.plant.simulation.rates if role.kind == "given" else role.rates
    run = partial(simulate_elsewhere, signals.given, other.t, other.u, role.output, rates)
    return replace(role.base, simulate_record=run)


def _seen_as(signals: Signals, other: Signals) -> Signals:
    """Another record with the inputs and outputs of `signals`, among which there may be outputs as inputs."""
    columns = {**dict(zip(other.inputs, other.u.T, strict=True)), **dict(zip(other.outputs, other.y.T, strict=True))}
    rows = dict(zip(other.outputs, other.rows.T, strict=True))
    return replace(
        other,
        u=np.column_stack([columns[name] for name in signals.inputs]),
        y=np.column_stack([columns[name] for name in signals.outputs]),
        rows=np.column_stack([rows[name] for name in signals.outputs]),
        inputs=signals.inputs,
        outputs=signals.outputs,
    )


def _simulated_together(
    prepared: Prepared,
    explained: Sequence[ExplainedOutput],
    parts: Sequence[Part],
    scores: Sequence[GapScore],
    other: Prepared | None,
    order: int,
) -> list[Part]:
    """The parts with errors of the free run of all outputs together, before that of the linear model of each output."""
    signals = prepared.signals if other is None else other.signals
    coupled = [
        Coupled(output.search.signals, output.through[-1].explanation.data, score.after_fit)
        for output, score in zip(explained, scores, strict=True)
    ]
    together = simulate_together(signals, coupled, other is not None)
    before = simulate_linear_models(prepared.signals, order, None if other is None else other.signals)
    if together is None:
        return [replace(part, mode="stabilised") for part in parts]
    named = any(part.report["effects"] for part in parts)
    changed = []
    for j, (part, score) in enumerate(zip(parts, scores, strict=True)):
        errors = [float(np.sqrt(np.mean((signals.y[:, j] - y[:, j])[score.scored] ** 2))) for y in (before, together)]
        own, floor = part.report["gap"], part.report["gap"]["noise_floor"]
        gap = named and errors[0] ** 2 > NO_GAP_MEAN_SQUARE * floor**2
        own = own | {
            "before": errors[0],
            "after": errors[1] if named else errors[0],
            "closed": closed_share(errors[0] ** 2, errors[1] ** 2, floor**2) if gap else None,
            "ci95": own["ci95"] if gap else None,
        }
        changed.append(replace(part, report=part.report | {"gap": own}, together=True))
    return changed


def _pair(signals: Signals, i: int, j: int) -> Record:
    return Record(signals.t, signals.u[:, i], signals.y[:, j], signals.Ts, name=signals.name)


def _further(through: Through, fitted: Signals, other: Signals) -> dict[str, FloatArray]:
    """The other inputs of another record, scaled as in the fits, after the effects found at them."""
    found = {at.role.main: at for at in through.others}
    scaled = {i: scale.of(other.u[:, i]) for i, scale in enumerate(fitted.input_scales)}
    return {
        fitted.inputs[i]: found[i].applied(u) if i in found else np.asarray(u)
        for i, u in scaled.items()
        if fitted.inputs[i] in through.role.further
    }
