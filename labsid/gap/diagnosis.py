"""Diagnose the gap between a record and a simulation."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, replace
from functools import partial
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from labsid._arrays import FloatArray, up_to_next
from labsid._cores import on_cores
from labsid.gap.effects.drifts import GainStep
from labsid.gap.fits.fitting import Problem, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.identifiability import assess
from labsid.gap.fits.number_search import search_numbers
from labsid.gap.fits.unstable_poles import MOST_CORRECTED
from labsid.gap.joints.arm_diagnosis import diagnose_joints
from labsid.gap.limits.planning import planned_record, with_planted
from labsid.gap.limits.smallest_sizes import find_smallest_sizes
from labsid.gap.model_file import export_model
from labsid.gap.prepared import Prepared, prepare, prepare_several
from labsid.gap.record.data import Data
from labsid.gap.record.exclusion import MIN_SAMPLES
from labsid.gap.record.readings import along, readings_alone
from labsid.gap.record.record_findings import about_correction, findings_from_errors, findings_from_record, plateau_gap
from labsid.gap.reports.layout import listed_findings
from labsid.gap.reports.limit_rows import as_rows
from labsid.gap.reports.notebook_progress import runs_in_notebook, show_in_notebook
from labsid.gap.reports.quantities import with_names, with_units
from labsid.gap.reports.replay_data import ReplayData, replay_content
from labsid.gap.reports.report import about_shift, build_report, fit_of_limits, record_limits
from labsid.gap.reports.result import Diagnosis
from labsid.gap.reports.sentences import is_probable, number_sentences
from labsid.gap.reports.traces import figure_traces
from labsid.gap.search.beam_search import Progress, residual_is_white
from labsid.gap.search.explanation import Explanation
from labsid.gap.signals.diagnosis import diagnose_signals
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.gap.simulations.baseline import AnySimulation, Baseline, as_simulation
from labsid.gap.simulations.structure_choice import UNDECIDED_TERM, explain_record
from labsid.gap.verdict.answer import answer_from
from labsid.gap.verdict.several_records import findings_by_record, score_by_record
from labsid.gap.verdict.why import explain_verdict
from labsid.records.record import Record
from labsid.records.several_signals import one_signal_each
from labsid.simulators.meter import SEARCH_SHARE, RunMeter
from labsid.simulators.mjcf.several_joints import SeveralJoints
from labsid.simulators.simulator import Simulator

LIMITS_SCHEMA = "labsid.gap.limits/1"
CHANGED_RIG = (
    "The rig changed during the record, and with that change only noise is left. No simulation holds before and after "
    "it, so the holdout, of a run before or after, is not scored."
)
TESTED_SIZE = 1.5  # over the smallest size that is named


def diagnose(
    record: Record | Sequence[Record],
    simulation: AnySimulation | None = None,
    *,
    free: Sequence[str] = (),
    holdout: Record | None = None,
    order: int = 2,
    exclude: Sequence[tuple[float, float]] = (),
    seed: int = 0,
    evaluations: int | None = None,
    why: bool = False,
    jobs: int = 1,
    progress: Progress | None = None,
) -> Diagnosis | SignalsDiagnosis:
    """Find where a simulation and a rig disagree, which effects cause it, and the share of the gap that they close.

    Parameters
    ----------
    record : Record or sequence of Record
        Several records are runs of one rig: they share its parameters and effects, and each has its own offset and
        initial state. The gap is scored on each record with fits to the others.
    simulation : dict, ndarray, callable, simulator or system of python-control, optional
        MODEL.json or an exported simulation; the output of any simulator on the record's input, shape (N,);
        ``simulate(t, u, **numbers) -> y``, whose keyword defaults are its nominal numbers; or a system with one input
        and one output, which starts from rest at zero. Of several signals a function, with u of shape (N, nu) and y of
        shape (N, ny), a Simulator, or a system. By default a linear model of the given order, fitted by output
        error.
    free : sequence of str
        Numbers of a callable or nonlinear simulation that may be fitted: if only other values of them are needed, the
        cause is `parameter-mismatch`.
    holdout : Record, optional
        Another record of the same rig for scoring. By default, blocks of `record` are held out of the fits that are
        scored.
    order : int
        Order of the fitted model, 1 to 4.
    exclude : sequence of (float, float)
        Time ranges, in seconds, that are neither fitted nor scored.
    seed : int
        Random seed of the confidence intervals and the proposed input.
    evaluations : int, optional
        Largest number of runs of a given simulation, after which the search ends with what it has found; scoring that
        takes a few dozen more. No limit by default: a search usually takes one to ten thousand.
    why : bool
        Whether `Diagnosis.why` explains the verdict: each of its gates, and why the best other combinations of effects
        were not taken.
    jobs : int
        Largest number of processes, at most one for each core; the result is the same for any number. With a simulation
        that is run, and on systems other than Linux, one.
    progress : callable, optional
        Called with a description of the current step and the completed share. By default a notebook shows a bar.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ValueError
        If the record is too short, its input or output is constant, or the simulation does not match the record; if
        there is a number of evaluations, but no simulation that is run; if `why` is asked for of several signals.

    Notes
    -----
    BLAS runs on one thread, and as before afterwards: the matrices are small, and sums then have one order.
    """
    records = [record] if isinstance(record, Record) else record
    if isinstance(simulation, Simulator) and isinstance(simulation.joint, SeveralJoints):
        _check_several_signals(records, True, evaluations, why)
        with _on_one_thread(progress) as said:
            return diagnose_joints(
                records[0],
                simulation,
                free=free,
                holdout=holdout,
                exclude=exclude,
                seed=seed,
                evaluations=evaluations,
                progress=said if said is None else _with_runs(said, simulation.meter),
            )
    if any(run.several for run in records):
        _check_several_signals(records, simulation is not None, evaluations, why)
        with _on_one_thread(progress) as said, on_cores(jobs if simulation is None else 1):
            return diagnose_signals(
                records[0],
                simulation,
                free=free,
                holdout=holdout,
                order=order,
                exclude=exclude,
                seed=seed,
                evaluations=evaluations,
                progress=said,
            )
    if holdout is not None:
        one_signal_each(holdout, "the diagnosis of a record of one input and one output")
    simulation = as_simulation(simulation, records[0].Ts if records else 1.0, free)
    with _on_one_thread(progress) as progress:
        if len(records) == 1:
            prepared = prepare(records[0], simulation, holdout, order, exclude)
        else:
            prepared = prepare_several(records, simulation, holdout, order, exclude)
        _begin(prepared.base, evaluations)
        if progress is not None and prepared.base.is_run:
            progress = _with_runs(progress, prepared.base.meter)
        with on_cores(1 if prepared.base.is_run else jobs):
            with prepared.base.meter.searching(SEARCH_SHARE):
                explanation, undecided = _search(prepared, progress)
            if undecided:
                prepared = replace(prepared, notes=(*prepared.notes, UNDECIDED_TERM))
            if prepared.holdout is not None and _changed_during(explanation):
                notes = (*prepared.notes, CHANGED_RIG)
                prepared = replace(prepared, holdout=None, holdout_measured=None, notes=notes)
            return _as_logged(_report(prepared, explanation, seed, progress, why), records[0])


@contextmanager
def _on_one_thread(progress: Progress | None) -> Iterator[Progress | None]:
    """BLAS on one thread, and the progress; by default a bar in a notebook."""
    with threadpool_limits(1, "blas"), ExitStack() as stack:
        if progress is None and runs_in_notebook():
            progress = stack.enter_context(show_in_notebook())
        yield progress


def _check_several_signals(
    records: Sequence[Record], is_given: bool, evaluations: int | None, why: bool = False
) -> None:
    """Refuse what a record of several signals cannot be diagnosed with."""
    if why:
        raise ValueError(
            "a verdict is explained for one input and one output only; the record has several signals. Choose one of "
            "each by --inputs and --outputs, or omit --why."
        )
    if len(records) > 1:
        raise ValueError(
            f"got {len(records)} records of several signals; one can be diagnosed at a time. Give another run as the "
            "holdout."
        )
    _check_evaluations(evaluations, is_run=is_given)


def _as_logged(diagnosed: Diagnosis, record: Record) -> Diagnosis:
    """The result with the names of the columns of the record, and in its units if it states both."""
    summary = with_names(diagnosed.summary, *record.labels)
    return diagnosed.with_summary(with_units(summary, *record.units) if all(record.units) else summary)


def find_limits(
    record: Record,
    simulation: AnySimulation | None = None,
    *,
    free: Sequence[str] = (),
    order: int = 2,
    planned: tuple[FloatArray, float] | None = None,
    tests: int = 0,
    seed: int = 0,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """The smallest size at which a record, or a planned one, shows and names each effect.

    Parameters
    ----------
    record : Record
    simulation : dict, ndarray, callable, simulator or system of python-control, optional
        As for `diagnose`.
    free : sequence of str
        Numbers of the simulation that may be fitted.
    order : int
        Order of the fitted model, 1 to 4.
    planned : (ndarray, float), optional
        Input of an experiment that is not made yet, in the record's unit, and its sampling time in seconds: the limits
        are those of the fitted simulation on it, with the noise of `record`.
    tests : int
        How often each effect is planted at `TESTED_SIZE` times the smallest size that is named, and diagnosed.
    seed : int
        Random seed of the noise of these tests.
    progress : callable, optional
        Called with a description of the current step and the completed share.

    Returns
    -------
    dict
        JSON-ready: `verdict` on the record, `limits` as in the report, and `planned`, whether they are those of a
        planned input.

    Raises
    ------
    ValueError
        As for `diagnose`; if the planned input has another sampling time, is too short or constant.
    """
    simulation = as_simulation(simulation, one_signal_each(record, "the table of limits").Ts, free)
    with threadpool_limits(1, "blas"):
        prepared = prepare(record, simulation, None, order, ())
        _begin(prepared.base, None)
        if planned is not None:
            _check_planned(*planned, prepared.record)
        explanation, _ = _search(prepared, progress)
        answer = answer_from(prepared.record, explanation, prepared.base, None, np.random.default_rng(seed), progress)
        data, fit = answer.explanation.data, fit_of_limits(answer)
        noise = rms(data, fit)
        if planned is None:
            sizes = record_limits(answer)
        else:
            data, fit = planned_record(data, fit, planned[0])
            sizes = find_smallest_sizes(data, fit, noise, measured=False)
        rows = as_rows(sizes)
        rng = np.random.default_rng(seed)
        for number, (row, size) in enumerate(zip(rows, sizes, strict=True)):
            if tests and size.named is not None:
                if progress is not None:
                    progress("planted effects", number / len(rows))
                share = min(TESTED_SIZE * float(size.shares["named"] or 1.0), 1.0)
                outputs = [with_planted(data, fit, size, share, rng) for _ in range(tests)]
                t = np.asarray(data.start + data.Ts * np.arange(data.samples), np.float64)
                u = np.asarray(data.u_scale.back(data.u))
                planted = [Record(t, u, y, data.Ts, name=record.name) for y in outputs if y is not None]
                named = sum(size.name in _probable(diagnose(run, simulation, order=order)) for run in planted)
                row["tested"] = {"named": named, "of": len(planted)}
    limits = {
        "schema": LIMITS_SCHEMA,
        "record": {"name": record.name, "samples": len(record), "Ts": record.Ts},
        "verdict": answer.decision.verdict,
        "planned": planned is not None,
        "limits": rows,
    }
    return limits | ({"units": dict(zip("uy", record.units, strict=True))} if all(record.units) else {})


def _probable(diagnosed: Diagnosis | SignalsDiagnosis) -> set[str]:
    """Names of the effects that are more probable than not."""
    return {str(effect["name"]) for effect in diagnosed.summary["effects"] if is_probable(effect)}


def _check_planned(u: FloatArray, Ts: float, record: Record) -> None:
    """Reject a planned input that the fitted simulation cannot be run on."""
    if abs(Ts - record.Ts) > 1e-3 * record.Ts:
        raise ValueError(f"the planned input runs at {Ts:g} s, the record at {record.Ts:g} s. Resample the input.")
    if u.size < MIN_SAMPLES:
        raise ValueError(f"the planned input has {u.size} samples; at least {MIN_SAMPLES} are needed. Make it longer.")
    if np.ptp(u) == 0.0:
        raise ValueError(f"the planned input is constant ({u[0]:g}); no effect can be seen with it. Let it move.")


def _search(prepared: Prepared, progress: Progress | None) -> tuple[Explanation, bool]:
    """The effects that explain the record, and whether its structure is undecided; `explain_record` says more."""
    start = _start(prepared.data, prepared.base, progress)
    return explain_record(prepared.data, replace(prepared.base, start=start), progress)


def _start(data: Data, base: Baseline, progress: Progress | None) -> FloatArray | None:
    """Parameters from which the search starts: with the free numbers of a given simulation found over decades."""
    structure = base.structure
    if not structure.plant.free or (base.start is not None and structure.plant.simulation.port is None):
        return base.start
    if progress is not None:
        progress(f"free numbers at their nominal values: {_identifiability(data, structure)}", 0.0)
    return search_numbers(data, structure, base.start)


def _changed_during(explanation: Explanation) -> bool:
    """Whether the rig changed during the record, and nothing else did: no simulation holds on another run then."""
    names = explanation.best.hypothesis.names
    return GainStep.name in names and residual_is_white(explanation.data, explanation.best)


def _identifiability(data: Data, structure: Hypothesis) -> str:
    """What the record determines of the free numbers, before they are fitted."""
    problem = Problem(data, structure)
    nominal = problem.start(np.zeros(len(structure.parameters)))
    known = {} if nominal is None else assess(problem, nominal)
    if not known:
        return "they cannot be simulated there."
    numbers = [asdict(number) | {"name": name, "at_limit": False} for name, number in known.items()]
    return " ".join(number_sentences(numbers)) or "the record determines all of them."


def _begin(base: Baseline, evaluations: int | None) -> None:
    _check_evaluations(evaluations, base.is_run)
    base.meter.begin(evaluations)


def _check_evaluations(evaluations: int | None, is_run: bool) -> None:
    """Reject a number of evaluations that is none, or has no simulation that is run."""
    if evaluations is not None and evaluations < 1:
        raise ValueError(f"the number of evaluations must be at least 1; got {evaluations}. Omit it for no limit.")
    if evaluations is not None and not is_run:
        raise ValueError(
            f"got {evaluations} evaluations, but no simulation that is run: they limit the runs of a function, an FMU "
            "or a nonlinear system given as the simulation. Omit them."
        )


def _with_runs(progress: Progress, meter: RunMeter) -> Progress:
    """Progress that also says how often the given simulation has been run, and its share of the time."""
    return lambda what, share: progress(f"{what}, {meter}", share)


def _report(prepared: Prepared, explanation: Explanation, seed: int, progress: Progress | None, why: bool) -> Diagnosis:
    """The answer to a record as a report, with what the record shows by itself and the curves of its figures."""
    record, holdout, base = prepared.record, prepared.holdout, prepared.base
    rng = np.random.default_rng(seed)
    answer = answer_from(record, explanation, base, holdout, rng, progress, prepared.holdout_measured)
    data = answer.explanation.data
    model = export_model(data, answer.score.after_fit, answer.elsewhere, answer.start)
    joined, inside = prepared.joined, np.ones(len(record), bool)
    stabilised = base.structure.feedback is not None
    if joined is None:
        fitted = answer.before if base.given else explanation.path[0]  # to all samples, as the levels are
        plateau = (
            None
            if stabilised
            else plateau_gap(
                record.u, record.y, np.asarray(data.y_scale.back(fitted.output)), answer.outputs[1], data.rows
            )
        )
        whole = prepared.whole if data.at is None else readings_alone(prepared.record, data.at)
        of_record = findings_from_record(whole, plateau)
    else:
        inside = joined.inside
        of_record, plateau = findings_by_record(joined, answer.outputs, data)
    shown = up_to_next(prepared.measured)
    y = record.y if data.at is None else along(answer.outputs[1], record.y, data.at)
    known = np.where(inside & prepared.measured, y, answer.outputs[0])  # no error where nothing is measured
    record = Record(record.t, record.u, known, record.Ts, name=record.name)
    report = build_report(record, answer, base, rng, holdout)
    if joined is not None:
        report["records"] = score_by_record(joined, data, answer.score, answer.start)
    shown_outputs = answer.outputs if joined is None else map(data.y_scale.back, answer.score.outputs)
    before, after = (np.asarray(output)[inside] for output in shown_outputs)
    report["traces"] = figure_traces(record.t[inside], record.u[inside], y[inside], before, after, shown[inside])
    of_record += about_correction(report["gap"]["corrected"], MOST_CORRECTED)
    findings = [*prepared.findings, *of_record, *findings_from_errors(record.u, record.y, *answer.outputs, data.rows)]
    report["record"]["samples"] = len(prepared.whole) if joined is None else int(inside.sum())
    report["record_findings"] = [{"level": f.level, "topic": f.topic, "text": f.text} for f in findings]
    report["plateaus"] = None if plateau is None else asdict(plateau)
    report["screen"] = [*prepared.notes, *about_shift(base, answer), *report["screen"]]
    report["findings"] = listed_findings(findings, report["screen"])
    report["holdout_traces"], there = None, None
    if holdout is not None:
        before, after = (np.asarray(data.y_scale.back(output)) for output in answer.score.outputs)
        assert prepared.holdout_measured is not None
        holdout = replace(holdout, y=np.where(prepared.holdout_measured, holdout.y, np.nan))
        there = up_to_next(prepared.holdout_measured)
        report["holdout_traces"] = figure_traces(holdout.t, holdout.u, along(after, holdout.y), before, after, there)
    report["replay"] = None
    make = None if stabilised else partial(replay_content, record, inside, (shown, there), answer, holdout)
    replay = ReplayData(make)
    if base.is_run:
        replay()  # now, as its runs count
    report["simulation"]["evaluations"] = base.meter.counts() if base.is_run else None
    return Diagnosis(report, model, replay, explain_verdict(answer) if why else None)
