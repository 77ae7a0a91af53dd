"""The main path of the diagnosis: a record and a simulation in, the answer out."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.baseline import Baseline, Simulation, as_running, baseline_of, bounded
from labsid.gap.beam_search import Progress
from labsid.gap.clock import clock_findings, in_step, stated_sampling
from labsid.gap.context import scaled
from labsid.gap.decision import IS_RIGHT, decide, trusted
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.explanation import Explained, explain
from labsid.gap.leftover import leftover
from labsid.gap.long_record import holdout_part, part_of
from labsid.gap.model_file import RunningModel, running_model
from labsid.gap.record_findings import PlateauGap, error_findings, filter_length, plateau_gap, record_findings
from labsid.gap.report import answer
from labsid.gap.scores import HowMuch, how_much_of
from labsid.gap.traces import traces
from labsid.lab.findings import about_clipping
from labsid.records.record import Record

FEWEST = 100  # samples


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
    model: RunningModel


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
    record, holdout = _in_step(record, holdout, simulation)
    _check(record, holdout)
    clocks = clock_findings(record, holdout)
    whole, part = record, part_of(record, simulation)
    record, simulation, notes = part.record, part.simulation, part.notes
    if holdout is not None:
        holdout, more = holdout_part(holdout, part.every)
        notes += more
    _check(record, holdout)
    if holdout is not None:
        holdout = Record(holdout.t, behind_filter(holdout), holdout.y, holdout.Ts, name=holdout.name)
    simulation = as_running(simulation, record.Ts)
    scales = (simulation.u_scale, simulation.y_scale) if isinstance(simulation, RunningModel) else None
    rows = _counted(record, exclude)
    data = scaled(behind_filter(record), record.y, rows, record.Ts, float(record.t[0]), scales)
    base = baseline_of(data, record.t, simulation, order)
    if base.output_only and holdout is not None:
        raise ValueError(
            "a simulated output is known on its own record only. Give a simulation that runs, or no holdout."
        )
    rng = np.random.default_rng(seed)
    explained, amount = _scored(explain(data, base.free, base.start, progress=progress), base, holdout, rng)
    left, plateau = leftover(explained.data, explained.best), _plateaus(record, base, explained)
    unrepeated = plateau.left if plateau is not None and plateau.matters else 0.0
    trust = trusted(explained, left, amount.closed, unrepeated)
    if trust < IS_RIGHT and explained.cut:  # small steps are left out for their names, and these are not given
        explained, amount = _scored(explained.uncut(), base, holdout, rng)
        left, plateau = leftover(explained.data, explained.best), _plateaus(record, base, explained)
    decision = decide(explained, left, base.before, trust, stopped=bool(about_clipping(record.y)))
    if decision.verdict != "unknown" and len(explained.path) == 1:  # what was found, no simulation shows
        amount = replace(amount, closed=None, ci95=None, black_box=None)
    model = running_model(explained.data, amount.after_fit)
    report = answer(record, explained, base, decision, left, amount, rng, holdout)
    seen = [*clocks, *record_findings(whole, plateau)]
    seen += error_findings(record.u, record.y, *_ends(base, explained), explained.data.rows)
    report["record"]["samples"] = len(whole)
    report["record_findings"] = [asdict(finding) for finding in seen]
    report["plateaus"] = None if plateau is None else asdict(plateau)
    report["screen"] = [*notes, *report["screen"]]
    report["holdout_traces"] = None
    if holdout is not None:
        linear = running_model(explained.data, explained.path[0])
        before = linear.simulate(holdout.u, holdout.y) if base.elsewhere is None else base.elsewhere(holdout)
        after = model.simulate(holdout.u, holdout.y)
        report["holdout_traces"] = traces(holdout.t, holdout.u, holdout.y, before, after)
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
    if rows.sum() < FEWEST:
        raise ValueError(f"--exclude leaves {rows.sum()} samples; at least {FEWEST} must stay.")
    return rows


def _scored(
    explained: Explained, base: Baseline, holdout: Record | None, rng: np.random.Generator
) -> tuple[Explained, HowMuch]:
    """How far an explanation closes the gap; where it helps a given simulation not at all, it is none.

    A slow disturbance cannot be foretold on samples that no fit has seen, and stands nevertheless.
    """
    data = explained.data
    other = None if holdout is None else (data.u_scale.of(holdout.u), data.y_scale.of(holdout.y))
    played = None
    if holdout is not None and base.elsewhere is not None:
        played = data.y_scale.of(bounded(base.elsewhere(holdout), holdout.y))
    amount = how_much_of(explained, base.before, other, rng, played)
    foretold = not any(isinstance(effect, AdditiveEffect) for effect in explained.best.hypothesis.effects)
    if base.given and len(explained.path) > 1 and foretold and (amount.closed or 0.0) <= 0.0:
        explained = explained.up_to(0)
        amount = how_much_of(explained, base.before, other, rng, played)
    return explained, amount


def _ends(base: Baseline, explained: Explained) -> tuple[FloatArray, FloatArray]:
    """Output of the simulation before and after, in the record's unit."""
    before = base.before or explained.path[0]
    back = explained.data.y_scale.back
    return np.asarray(back(before.output)), np.asarray(back(explained.best.output))


def _plateaus(record: Record, base: Baseline, explained: Explained) -> PlateauGap | None:
    return plateau_gap(record.u, record.y, *_ends(base, explained), explained.data.rows)


def behind_filter(record: Record) -> FloatArray:
    """The input, averaged as the logger averages its output where the record shows that it does.

    The mean of the last m samples commutes with linear dynamics: with it in front, the simulation has the logger's
    filter in it, and the filter is no gap.
    """
    length = filter_length(record)
    padded = np.concatenate([np.full(length - 1, record.u[0]), record.u])
    return np.convolve(padded, np.full(length, 1.0 / length), mode="valid")


def _in_step(record: Record, holdout: Record | None, simulation: Simulation | None) -> tuple[Record, Record | None]:
    """Both records at one sampling time, as far as clocks that jitter leave it open.

    It is that of the simulation if that has one, or of a holdout whose clock does not jitter, or else of the record.
    """
    if isinstance(simulation, RunningModel):
        record = in_step(record, simulation.Ts)
    elif isinstance(simulation, dict):
        record = in_step(record, stated_sampling(simulation))
    if holdout is None:
        return record, None
    if not holdout.jitter:
        record = in_step(record, holdout.Ts)
    return record, in_step(holdout, record.Ts)


def _check(record: Record, holdout: Record | None) -> None:
    """Refuse what no method could answer on."""
    for name, one in (("the record", record), ("the holdout", holdout)):
        if one is None:
            continue
        if len(one) < FEWEST:
            raise ValueError(f"{name} has {len(one)} samples; a diagnosis needs at least {FEWEST}. Record longer.")
        for signal, values in (("u", one.u), ("y", one.y)):
            if np.ptp(values) == 0.0:
                raise ValueError(f"{signal} of {name} is constant ({values[0]:g}); nothing can be identified from it.")
    if holdout is not None and abs(holdout.Ts - record.Ts) > 1e-6 * record.Ts:
        raise ValueError(f"the holdout runs at {holdout.Ts:g} s, the record at {record.Ts:g} s. Resample one of them.")
