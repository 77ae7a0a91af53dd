"""The sealed check from end to end: make the cases, run the diagnosis, compare with the labels, print the table."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.blind import limits
from labsid.blind.closure import compare_closure, held_out_samples, pooled_closure, simulate_linear_fit
from labsid.blind.experiment import Case, OrdinaryCase, redraw, run_experiment, to_record
from labsid.blind.metrics import CaseOutcome, Metric
from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.blind.rows import TIME_INVARIANT_EFFECTS
from labsid.blind.runner import Replay, run_batch, run_replays
from labsid.blind.score import ALONE, score_cases
from labsid.blind.suite import PER_ROW, diagnosis_hash, label_dict, make_cases
from labsid.blind.table import markdown, print_scores
from labsid.records.record import Record
from labsid.rig.switchable.simulation import poles

FRESH_RECORDS = 20


def run_sealed_check(
    suite: str = "dev",
    per_row: int | None = None,
    rows: Sequence[str] | None = None,
    jobs: int = 1,
    replays: int | None = None,
    report: Path | None = None,
    keep: Path | None = None,
) -> int:
    """Run the sealed check and print its table.

    Parameters
    ----------
    suite : {"dev", "final"}
    per_row : int, optional
        Records in each row of the table, or planted effects; by default 80 in `dev` and 220 in `final`.
    rows : sequence of str, optional
        Rows to run, and `limits`; by default all of `labsid.blind.rows.DEFAULT_ROWS`.
    jobs : int
        Number of parallel processes.
    replays : int, optional
        Number of records whose exported simulation is run on 20 fresh records; by default `per_row`.
    report : Path, optional
        Markdown file to which the table is also written.
    keep : Path, optional
        Folder in which the results stay, in one of its own for each version of the diagnosis, so that a second run
        continues an interrupted one.

    Returns
    -------
    int
        Exit status: 1 if a requirement is missed by more than chance, otherwise 0.

    Raises
    ------
    ValueError
        If the suite or a row does not exist, or `jobs` is below 1.
    """
    if jobs < 1:
        raise ValueError(f"jobs must be at least 1; got {jobs}. Give the number of processes.")
    folder = None if keep is None else keep / f"{diagnosis_hash():x}"
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    layout = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*layout, transient=True) as progress:
        making = progress.add_task("making rigs", total=None)
        made: list[Case | OrdinaryCase] = []
        others = [row for row in rows or () if row != limits.ROW]
        for case in make_cases(suite, per_row, others, jobs) if others or not rows else ():
            made.append(case)
            progress.update(making, completed=len(made))
        progress.update(making, total=len(made))
        running = progress.add_task("diagnosing", total=len(made))
        results, seconds = run_batch(made, jobs, lambda n: progress.update(running, completed=n), folder)
        refitting = progress.add_task("refitting the true structures", total=len(made))
        outcomes = []
        for case in made:
            outcomes.append(evaluate_case(case, results.get(case.name)))
            if isinstance(case, Case) and case.others:
                outcomes.append(CaseOutcome(label_dict(case) | {"row": ALONE}, results.get(case.alone)))
            progress.advance(refitting)
        again = [case for case in made if isinstance(case, Case) and is_repeatable(case)]
        again = again[: (per_row or PER_ROW[suite]) if replays is None else replays]
        playing = progress.add_task("simulating fresh records", total=len(again))
        replayed = evaluate_replays(again, jobs, lambda n: progress.update(playing, completed=n))
        planted: list[Metric] = []
        if limits.ROW in (rows or ()):
            progress.add_task("planting effects of the stated sizes", total=None)
            seed = limits.SEED if suite == "dev" else diagnosis_hash()
            planted = limits.limit_metrics(per_row or PER_ROW[suite], seed, jobs)
    scores = score_cases(outcomes, replayed, seconds)
    scores = replace(scores, metrics=(*scores.metrics, *planted))
    print_scores(scores, f"labsid gap blind --suite {suite}: {len(made)} records")
    if report is not None:
        report.write_text(markdown(scores), encoding="utf-8")
    return int(any(metric.fails() for metric in scores.metrics))


def evaluate_case(case: Case | OrdinaryCase, result: dict[str, Any] | None) -> CaseOutcome:
    """Combine label and result, and compute the closure of a clear single effect.

    Parameters
    ----------
    case : Case or OrdinaryCase
    result : dict or None

    Returns
    -------
    CaseOutcome
    """
    if isinstance(case, Case) and case.row in ("single-clear", "families") and result is not None:
        share = compare_closure(case, result)
        if share is not None:
            return CaseOutcome(label_dict(case), result, share.diagnosed, share.possible)
    return CaseOutcome(label_dict(case), result)


def is_repeatable(case: Case) -> bool:
    """Whether the effect recurs in another record of the rig, so that fresh records can test its simulation.

    Parameters
    ----------
    case : Case

    Returns
    -------
    bool
    """
    single = case.row in ("single-clear", "single-hard", "families")
    return single and case.holdout is None and case.sim is None and set(case.labels) <= TIME_INVARIANT_EFFECTS


def evaluate_replays(
    made: Sequence[Case], jobs: int, on_progress: Callable[[int], None] | None = None
) -> list[CaseOutcome]:
    """Run the exported simulation of each case on fresh records of the same rig.

    Parameters
    ----------
    made : sequence of Case
    jobs : int
    on_progress : callable, optional
        Called with the number of finished cases.

    Returns
    -------
    list of CaseOutcome
        With `fresh_closure` if the simulation ran on every record.
    """
    experiments = [[redraw(case.experiment, i) for i in range(FRESH_RECORDS)] for case in made]
    others = [
        [to_record(run_experiment(r), r.scales, f"other{i}") for i, r in enumerate(several)] for several in experiments
    ]
    replays = run_replays(list(zip(made, others, strict=True)), jobs, on_progress)
    outcomes = []
    for case, several, records, replay in zip(made, experiments, others, replays, strict=True):
        clean = [to_record(run_experiment(r), r.scales, case.name, clean=True).y for r in several]
        outcomes.append(
            CaseOutcome(label_dict(case), replay.result, fresh_closure=_fresh_closure(case, records, clean, replay))
        )
    return outcomes


def _fresh_closure(case: Case, records: Sequence[Record], clean: Sequence[FloatArray], replay: Replay) -> float | None:
    """Closure over the fresh records, relative to the best linear model of the samples that the diagnosis fitted."""
    after = [output for output in replay.outputs if output is not None]
    if replay.result is None or len(after) < len(records):
        return None
    scored = held_out_samples(case, replay.result)
    if scored is None:
        return None
    u, start = case.record.u, discrete_poles(poles(case.experiment.plain.motion))
    linear = fit_linear(u, case.record.y, start, counts=~scored)
    before = [simulate_linear_fit(linear, float(np.mean(u)), record) for record in records]
    return pooled_closure(clean, before, after)
