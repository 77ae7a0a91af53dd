"""Diagnose a record of several inputs or outputs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.model_file import ExportedModel, export_model
from labsid.gap.reports.quantities import with_units
from labsid.gap.reports.report import build_report
from labsid.gap.reports.traces import figure_traces
from labsid.gap.search.beam_search import Progress
from labsid.gap.signals.combined_report import Part, combine
from labsid.gap.signals.preparation import Prepared, prepare, prepare_holdout
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.gap.signals.roles import Signals
from labsid.gap.signals.search import ExplainedOutput, Through, explain_outputs
from labsid.gap.verdict.answer import answer_from
from labsid.records.record import Record


def diagnose_signals(
    record: Record,
    *,
    holdout: Record | None = None,
    order: int = 2,
    exclude: Sequence[tuple[float, float]] = (),
    seed: int = 0,
    progress: Progress | None = None,
) -> SignalsDiagnosis:
    """Find the effects at every input and output of a record, and in its dynamics.

    Parameters
    ----------
    record : Record
        Of several inputs or outputs.
    holdout : Record, optional
        Another record of the same signals, for scoring.
    order : int
        Order of the response of an output to the input through which it is explained, 1 to 4; second to the others.
    exclude : sequence of (float, float)
        Time ranges, in seconds, that are neither fitted nor scored.
    seed : int
        Random seed of the confidence intervals.
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
    other = None if holdout is None else prepare_holdout(holdout, prepared)
    explained = explain_outputs(prepared.signals, order, progress)
    parts = [part for one in explained for part in _parts(prepared, one, other, seed, progress)]
    models = {prepared.signals.outputs[one.output]: _model(one.through[-1]) for one in explained}
    return SignalsDiagnosis(combine(prepared, explained, parts, other), models)


def _model(through: Through) -> ExportedModel:
    return export_model(through.explanation.data, through.explanation.best)


def _parts(
    prepared: Prepared, one: ExplainedOutput, other: Prepared | None, seed: int, progress: Progress | None
) -> list[Part]:
    """The report of an output through each input at which effects were found; the last one is that of the output."""
    signals, parts = prepared.signals, []
    for through in one.through:
        rng = np.random.default_rng(seed)
        record = _pair(signals, through.role.main, one.output)
        scored = None if other is None else _pair(other.signals, through.role.main, one.output)
        measured = None if other is None else other.signals.rows[:, one.output]
        further = None if other is None else _further(through, signals, other.signals)
        answer = answer_from(
            record, through.explanation, through.role.base, scored, rng, progress, measured, further
        )
        report = build_report(record, answer, through.role.base, rng, scored)
        units = prepared.units[through.role.main], prepared.units[len(signals.inputs) + one.output]
        report = with_units(report, *units) if all(units) else report
        before, after = answer.outputs
        y = np.where(signals.rows[:, one.output], record.y, before)
        report["traces"] = figure_traces(record.t, record.u, y, before, after, signals.rows[:, one.output])
        if scored is not None:
            back = answer.explanation.data.y_scale.back
            before, after = (np.asarray(back(output)) for output in answer.score.outputs)
            report["holdout_traces"] = figure_traces(scored.t, scored.u, scored.y, before, after, measured)
        parts.append(Part(one.output, through.role.main, report, float(np.std(record.y[signals.rows[:, one.output]]))))
    return parts


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
