"""Diagnose the gap between a record and a simulation."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, replace
from itertools import chain
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from labsid._arrays import FloatArray, stretches_of, up_to_next
from labsid._cores import on_cores
from labsid.gap.dynamics.record_start import LEAST_START, MOST_SHARE
from labsid.gap.effects.drifts import GainStep
from labsid.gap.fits.fitting import Problem, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.identifiability import assess
from labsid.gap.fits.noisy_command import with_levels
from labsid.gap.fits.number_search import search_numbers
from labsid.gap.fits.unknown_input import about_unknown_input, after_unknown_input
from labsid.gap.fits.unstable_poles import MOST_CORRECTED
from labsid.gap.limits.planning import planned_record, with_planted
from labsid.gap.limits.smallest_sizes import find_smallest_sizes
from labsid.gap.model_file import ExportedModel, export_model
from labsid.gap.record.clock import at_sampling_time, clock_findings, stated_sampling_time
from labsid.gap.record.data import Data, scaled
from labsid.gap.record.exclusion import MIN_SAMPLES, included_samples
from labsid.gap.record.readings import along, at_readings, brought_to_samples, readings_alone
from labsid.gap.record.record_findings import (
    about_correction,
    filtered_input,
    findings_from_errors,
    findings_from_record,
    plateau_gap,
)
from labsid.gap.reports.layout import listed_findings
from labsid.gap.reports.limit_rows import as_rows
from labsid.gap.reports.notebook_progress import runs_in_notebook, show_in_notebook
from labsid.gap.reports.quantities import with_units
from labsid.gap.reports.replay_data import replay_content
from labsid.gap.reports.report import about_shift, build_report, fit_of_limits, record_limits
from labsid.gap.reports.result import Diagnosis
from labsid.gap.reports.sentences import is_probable, number_sentences
from labsid.gap.reports.traces import figure_traces
from labsid.gap.search.beam_search import Progress, residual_is_white
from labsid.gap.search.explanation import Explanation
from labsid.gap.signals.diagnosis import diagnose_signals
from labsid.gap.signals.result import SignalsDiagnosis
from labsid.gap.simulations.baseline import (
    AnySimulation,
    Baseline,
    Simulation,
    as_simulation,
    make_baseline,
    read_exported,
)
from labsid.gap.simulations.long_record import (
    MAX_OF_SEVERAL,
    MAX_SAMPLES,
    cut_alike,
    shorten_holdout,
    shorten_record,
    shorten_records,
)
from labsid.gap.simulations.model_check import TOPIC, check_model
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.gap.simulations.stepper_port import untried_inside
from labsid.gap.simulations.structure_choice import UNDECIDED_TERM, explain_record
from labsid.gap.verdict.answer import answer_from
from labsid.gap.verdict.several_records import (
    JoinedRecords,
    at_one_sampling_time,
    findings_by_record,
    join_records,
    label,
    score_by_record,
)
from labsid.gap.verdict.why import explain_verdict
from labsid.lab.findings import Finding
from labsid.records.record import Record, between_outputs, bridge_gaps
from labsid.records.several_signals import one_signal_each
from labsid.simulators.meter import SEARCH_SHARE, RunMeter
from labsid.simulators.simulator import Simulator
from labsid.simulators.stepper import Stepper

_Times = Sequence[tuple[float, float]]
MIN_SCORED = 10  # samples
MIN_HOLDOUT = LEAST_START + MIN_SCORED  # samples, of which the first determine the initial state
SIZES = 1e-50, 1e50  # of the range of a signal and of the sampling time: powers of their ratios stay finite
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
    simulation : dict, ndarray, callable, Simulator or system of python-control, optional
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
    if any(one.several for one in records):
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
            (one,) = records
            prepared = _prepare(one, simulation, holdout, order, exclude)
        else:
            prepared = _prepare_several(records, simulation, holdout, order, exclude)
        _begin(prepared.base, evaluations)
        if progress is not None and prepared.base.is_run:
            progress = _with_runs(progress, prepared.base.meter)
        with on_cores(1 if prepared.base.is_run else jobs):
            with prepared.base.meter.searching(SEARCH_SHARE):
                start = _start(prepared.data, prepared.base, progress)
                explanation, undecided = explain_record(prepared.data, replace(prepared.base, start=start), progress)
            if undecided:
                prepared = replace(prepared, notes=(*prepared.notes, UNDECIDED_TERM))
            if prepared.holdout is not None and _changed_during(explanation):
                notes = (*prepared.notes, CHANGED_RIG)
                prepared = replace(prepared, holdout=None, holdout_measured=None, notes=notes)
            return _in_units(_report(prepared, explanation, seed, progress, why), records[0].units)


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


def _in_units(found: Diagnosis, units: tuple[str, ...]) -> Diagnosis:
    """The result in the units of the record, if it states both."""
    return replace(found, report=with_units(found.report, *units)) if all(units) else found


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
    simulation : dict, ndarray, callable, Simulator or system of python-control, optional
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
        prepared = _prepare(record, simulation, None, order, ())
        _begin(prepared.base, None)
        if planned is not None:
            _check_planned(*planned, prepared.record)
        start = _start(prepared.data, prepared.base, progress)
        explanation, _ = explain_record(prepared.data, replace(prepared.base, start=start), progress)
        answer = answer_from(prepared.record, explanation, prepared.base, None, np.random.default_rng(seed), progress)
        data, fit = answer.explanation.data, fit_of_limits(answer)
        noise = rms(data, fit)
        if planned is None:
            found = record_limits(answer)
        else:
            data, fit = planned_record(data, fit, planned[0])
            found = find_smallest_sizes(data, fit, noise, measured=False)
        rows = as_rows(found)
        rng = np.random.default_rng(seed)
        for number, (row, one) in enumerate(zip(rows, found, strict=True)):
            if tests and one.named is not None:
                if progress is not None:
                    progress("planted effects", number / len(rows))
                share = min(TESTED_SIZE * float(one.shares["named"] or 1.0), 1.0)
                outputs = [with_planted(data, fit, one, share, rng) for _ in range(tests)]
                t = np.asarray(data.start + data.Ts * np.arange(data.samples), np.float64)
                u = np.asarray(data.u_scale.back(data.u))
                made = [Record(t, u, y, data.Ts, name=record.name) for y in outputs if y is not None]
                named = sum(one.name in _probable(diagnose(again, simulation, order=order)) for again in made)
                row["tested"] = {"named": named, "of": len(made)}
    limits = {
        "schema": LIMITS_SCHEMA,
        "record": {"name": record.name, "samples": len(record), "Ts": record.Ts},
        "verdict": answer.decision.verdict,
        "planned": planned is not None,
        "limits": rows,
    }
    return limits | ({"units": dict(zip("uy", record.units, strict=True))} if all(record.units) else {})


def _probable(found: Diagnosis | SignalsDiagnosis) -> set[str]:
    """Names of the effects that are more probable than not."""
    return {str(effect["name"]) for effect in found.report["effects"] if is_probable(effect)}


def _check_planned(u: FloatArray, Ts: float, record: Record) -> None:
    """Reject a planned input that the fitted simulation cannot be run on."""
    if abs(Ts - record.Ts) > 1e-3 * record.Ts:
        raise ValueError(f"the planned input runs at {Ts:g} s, the record at {record.Ts:g} s. Resample the input.")
    if u.size < MIN_SAMPLES:
        raise ValueError(f"the planned input has {u.size} samples; at least {MIN_SAMPLES} are needed. Make it longer.")
    if np.ptp(u) == 0.0:
        raise ValueError(f"the planned input is constant ({u[0]:g}); no effect can be seen with it. Let it move.")


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
    numbers = [asdict(one) | {"name": name, "at_limit": False} for name, one in known.items()]
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


@dataclass(frozen=True, slots=True, eq=False)
class _Prepared:
    """A record ready for the search.

    Attributes
    ----------
    whole, record : Record
        As given, and as diagnosed: at one sampling time and shortened.
    measured : ndarray of bool
        Mask of the samples of `record` that have an output.
    holdout : Record or None
        With the input filtered like that of `data`.
    holdout_measured : ndarray of bool or None
        As `measured`, of the holdout.
    data : Data
    base : Baseline
    findings : list of Finding
    notes : tuple of str
        Sentences on what was left out.
    joined : JoinedRecords or None
        With several records, how `record` was made of them.
    """

    whole: Record
    record: Record
    measured: np.ndarray
    holdout: Record | None
    holdout_measured: np.ndarray | None
    data: Data
    base: Baseline
    findings: list[Finding]
    notes: tuple[str, ...]
    joined: JoinedRecords | None = None


def _prepare(
    record: Record,
    simulation: Simulation | None,
    holdout: Record | None,
    order: int,
    exclude: Sequence[tuple[float, float]],
) -> _Prepared:
    as_given = record
    record, holdout = between_outputs(record), None if holdout is None else between_outputs(holdout)
    simulation = cut_alike(simulation, as_given, record)
    record, holdout = _common_sampling_time(record, holdout, simulation)
    findings = clock_findings(record, holdout)
    both = [record] if holdout is None else [record, holdout]
    compared = at_readings(both, simulation is not None, MAX_SAMPLES, ~included_samples(record.t, exclude))
    simulation = cut_alike(simulation, record, compared.records[0])
    (record, *rest), is_slow = compared.records, compared.is_slow
    holdout = rest[0] if rest else None
    gaps, record = _without_gaps(record)
    other_gaps: _Times = ()
    if holdout is not None:
        other_gaps, holdout = _without_gaps(holdout)
    _check_records(record, holdout)
    if holdout is not None:
        findings += _repeated([("the record", record), ("the holdout", holdout)])
    findings += _compared(record, simulation)
    whole, shortened = record, shorten_record(record, simulation, is_slow=is_slow)
    record, simulation, notes = shortened.record, shortened.simulation, compared.notes + shortened.notes
    if holdout is not None:
        holdout, more = shorten_holdout(holdout, shortened.every)
        notes += more
    _check_records(record, holdout)
    if holdout is not None:
        holdout = Record(holdout.t, filtered_input(holdout), holdout.y, holdout.Ts, name=holdout.name)
    simulation = read_exported(simulation, record.Ts)
    scales = (simulation.u_scale, simulation.y_scale) if isinstance(simulation, ExportedModel) else None
    measured = _measured(record, gaps)
    rows = _included(record, exclude, measured)
    if not isinstance(simulation, SimulatedOutput):  # which was made from the input as it is logged
        record, more = with_levels(record, rows)
        notes += more
        holdout = None if holdout is None else with_levels(holdout)[0]
    data = scaled(filtered_input(record), record.y, rows, record.Ts, float(record.t[0]), scales)
    if is_slow:
        data = replace(data, at=np.flatnonzero(measured), stride=compared.stride)
    else:
        unknown = after_unknown_input(data, record.u, measured)
        notes += about_unknown_input(unknown, record.Ts)
        data = replace(data, rows=data.rows & ~unknown) if unknown.any() else data
    base = make_baseline(data, record.t, simulation, order)
    if base.before is not None and compared.before is not None and len(record) == len(compared.records[0]):
        simulated = data.y_scale.back(base.before(data).output)
        record = brought_to_samples(record, np.flatnonzero(measured), compared.before, np.asarray(simulated))
        data = replace(data, y=data.y_scale.of(record.y))
        base = make_baseline(data, record.t, simulation, order)
    if base.output_only and holdout is not None:
        raise ValueError(
            "a simulated output is known on its own record only. Give a model or a function, or omit the holdout."
        )
    other = None if holdout is None else _measured_holdout(holdout, other_gaps)
    return _Prepared(whole, record, measured, holdout, other, data, base, findings, notes)


def _prepare_several(
    records: Sequence[Record],
    simulation: Simulation | None,
    holdout: Record | None,
    order: int,
    exclude: Sequence[tuple[float, float]],
) -> _Prepared:
    if not records:
        raise ValueError("there is no record. Give at least one.")
    if holdout is not None:
        raise ValueError("of several records each in turn is held out. Omit the holdout, or give it as one of them.")
    if len(exclude):
        raise ValueError("--exclude refers to the times of one record. Cut the records instead.")
    records = at_one_sampling_time(list(map(between_outputs, records)), stated_sampling_time(simulation))
    findings = [
        replace(finding, text=f"{label(record, number)}: {finding.text}")
        for number, record in enumerate(records, 1)
        for finding in clock_findings(record)
    ]
    compared = at_readings(records, simulation is not None, MAX_OF_SEVERAL)
    records = compared.records
    gaps, records = zip(*map(_without_gaps, records), strict=True)
    for number, record in enumerate(records, 1):
        _check_record(record, label(record, number))
    parts, notes = shorten_records(records)
    notes = compared.notes + notes
    for number, record in enumerate(parts, 1):
        _check_record(record, label(record, number))
    if not isinstance(simulation, SimulatedOutput):
        followed = list(map(with_levels, parts))
        parts, notes = (
            [part for part, _ in followed],
            notes + tuple(dict.fromkeys(chain(*(said for _, said in followed)))),
        )
    joined = join_records(parts, [_measured(part, times) for part, times in zip(parts, gaps, strict=True)])
    findings += _repeated([(f"the record {name}", one) for name, one in zip(joined.names, parts, strict=True)])
    simulation = read_exported(simulation, joined.record.Ts)
    scales = (simulation.u_scale, simulation.y_scale) if isinstance(simulation, ExportedModel) else None
    data = joined.data(scales)
    if compared.is_slow:
        data = replace(data, at=np.flatnonzero(data.rows), stride=compared.stride)
    base = make_baseline(data, joined.record.t, simulation, order)
    return _Prepared(joined.record, joined.record, joined.measured, None, None, data, base, findings, notes, joined)


def _report(
    prepared: _Prepared, explanation: Explanation, seed: int, progress: Progress | None, why: bool
) -> Diagnosis:
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
        found = findings_from_record(whole, plateau)
    else:
        inside = joined.inside
        found, plateau = findings_by_record(joined, answer.outputs, data)
    shown = up_to_next(prepared.measured)
    y = record.y if data.at is None else along(answer.outputs[1], record.y, data.at)
    known = np.where(inside & prepared.measured, y, answer.outputs[0])  # no error where nothing is measured
    record = Record(record.t, record.u, known, record.Ts, name=record.name)
    report = build_report(record, answer, base, rng, holdout)
    if joined is not None:
        report["records"] = score_by_record(joined, data, answer.score, answer.start)
    before, after = (output[inside] for output in answer.outputs)
    report["traces"] = figure_traces(record.t[inside], record.u[inside], y[inside], before, after, shown[inside])
    found += about_correction(report["gap"]["corrected"], MOST_CORRECTED)
    findings = [*prepared.findings, *found, *findings_from_errors(record.u, record.y, *answer.outputs, data.rows)]
    report["record"]["samples"] = len(prepared.whole) if joined is None else int(inside.sum())
    report["record_findings"] = [asdict(finding) for finding in findings]
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
    report["replay"] = None if stabilised else replay_content(record, inside, (shown, there), answer, holdout)
    report["simulation"]["evaluations"] = base.meter.counts() if base.is_run else None
    return Diagnosis(report, model, explain_verdict(answer) if why else None)


def _compared(record: Record, simulation: Simulation | None) -> list[Finding]:
    """What of a record and a simulation that opens does not fit together."""
    if not isinstance(simulation, Simulator) or simulation.joint is None:
        return []
    found = check_model(record, simulation)
    if isinstance(simulation.joint, Stepper):
        found.append(Finding("note", TOPIC, untried_inside(simulation.joint, record.Ts)))
    return found


def _without_gaps(record: Record) -> tuple[_Times, Record]:
    """Times without an output, and the record with straight lines there, which are neither fitted nor scored."""
    half = 0.5 * record.Ts
    times = [(record.t[k] - half, record.t[stop - 1] + half) for k, stop in stretches_of(record.missing)]
    return times, replace(record, y=bridge_gaps(record.y)) if times else record


def _measured(record: Record, gaps: _Times) -> np.ndarray:
    """Mask of the samples outside the gaps of the output."""
    rows = np.ones(len(record), bool)
    for start, stop in gaps:
        rows[np.searchsorted(record.t, start) : np.searchsorted(record.t, stop)] = False
    return rows


def _measured_holdout(holdout: Record, gaps: _Times) -> np.ndarray:
    """Mask of the samples of a holdout that have an output."""
    rows = _measured(holdout, gaps)
    scored = int(rows[max(LEAST_START, int(np.ceil(MOST_SHARE * rows.size))) :].sum())
    if scored < MIN_SCORED:
        raise ValueError(
            f"the holdout has an output at {scored} of its scored samples; at least {MIN_SCORED} are needed. Use "
            "another one."
        )
    return rows


def _included(record: Record, exclude: _Times, measured: np.ndarray) -> np.ndarray:
    """Mask of the samples with an output outside the excluded time ranges, which may be in no part that is used."""
    left = [(start, stop) for start, stop in exclude if np.any((record.t >= start) & (record.t < stop))]
    rows = measured & included_samples(record.t, left)
    if measured.sum() < MIN_SAMPLES:
        raise ValueError(
            f"the output of the record has {measured.sum()} readings; a diagnosis needs at least {MIN_SAMPLES}. Use a "
            "longer record."
        )
    if rows.sum() < MIN_SAMPLES:
        raise ValueError(f"--exclude leaves {rows.sum()} samples; at least {MIN_SAMPLES} are needed.")
    return rows


def _common_sampling_time(
    record: Record, holdout: Record | None, simulation: Simulation | None
) -> tuple[Record, Record | None]:
    """Bring records with clock jitter to one sampling time.

    It is that of the simulation if it has one, else that of a holdout without jitter, else that of the record.
    """
    record = at_sampling_time(record, stated_sampling_time(simulation))
    if holdout is None:
        return record, None
    if not holdout.jitter:
        record = at_sampling_time(record, holdout.Ts)
    return record, at_sampling_time(holdout, record.Ts)


def _check_records(record: Record, holdout: Record | None) -> None:
    """Reject a record that is too short or has a constant signal, and a holdout of another sampling time.

    A holdout is only scored, after the samples that determine its initial state: neither of its signals has to move.
    """
    _check_record(record, "the record")
    if holdout is not None and len(holdout) < MIN_HOLDOUT:
        raise ValueError(
            f"the holdout has {len(holdout)} samples; it needs at least {MIN_HOLDOUT}: its first {LEAST_START} "
            "determine the initial state and are not scored. Use a longer one."
        )
    if holdout is not None and abs(holdout.Ts - record.Ts) > 1e-6 * record.Ts:
        raise ValueError(f"the holdout runs at {holdout.Ts:g} s, the record at {record.Ts:g} s. Resample one of them.")


def _repeated(records: Sequence[tuple[str, Record]]) -> list[Finding]:
    """Which of the named records hold the samples of an earlier one."""
    found = []
    first: dict[tuple[bytes, bytes], str] = {}
    for name, record in records:
        other = first.setdefault((record.u.tobytes(), record.y.tobytes()), name)
        if other != name:
            text = f"{name} holds the samples of {other}: the error on it is not that on another run."
            found.append(Finding("warning", "samples", text))
    return found


def _check_record(record: Record, name: str) -> None:
    """Reject a record that is too short or has a constant signal."""
    if len(record) < MIN_SAMPLES:
        raise ValueError(
            f"{name} has {len(record)} samples; a diagnosis needs at least {MIN_SAMPLES}. Use a longer record."
        )
    for signal, values in (("u", record.u), ("y", record.y)):
        if np.ptp(values) == 0.0:
            raise ValueError(f"{signal} of {name} is constant ({values[0]:g}); nothing can be identified from it.")
        _check_size(f"the range of {signal} of {name}", float(np.ptp(values)))
    _check_size(f"the sampling time of {name}", record.Ts)


def _check_size(what: str, value: float) -> None:
    """Reject a size whose powers could overflow or vanish."""
    low, high = SIZES
    if not low <= value <= high:
        raise ValueError(f"{what} must be between {low:g} and {high:g}; got {value:g}. Give it in another unit.")
