"""Diagnose the records of a folder on all cores; a later run continues an interrupted one."""

import json
import os
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labsid._files import write_json, write_text
from labsid.gap.batches.batch_files import SUMMARY, Job, command_of, find_records, make_job, nouns
from labsid.gap.batches.batch_page import write_batch_page, write_record_pages
from labsid.gap.batches.batch_summary import csv_summary, text_summary
from labsid.gap.batches.scheduler import run_on_scheduler
from labsid.gap.batches.version import sources_version
from labsid.gap.batches.workers import ATTEMPTS, run_tasks, serve
from labsid.gap.reports.layout import SCHEMA
from labsid.records.reading import Reading

if TYPE_CHECKING:  # only the worker processes import the search
    from labsid.gap.search.beam_search import Progress

KEY = "made_from"  # entry of a report that identifies its input files, version and seed
PAGE = "summary.html"


def diagnose_folder(
    folder: Path,
    out: Path,
    jobs: int | None = None,
    seed: int = 0,
    progress: "Progress | None" = None,
    scheduler: str | None = None,
    html: bool = False,
    how: Reading | None = None,
) -> str:
    """Diagnose every record of a folder, and the records of each sub-folder together as runs of one rig.

    Parameters
    ----------
    folder : Path
        Files ``.csv`` and ``.mat`` are records; ``<stem>.sim.json`` (or ``.sim.csv``) and ``<stem>.holdout.csv`` are
        the simulation and the holdout of a record. A sub-folder with records is one rig with the folder's name as its
        stem; its simulation is beside the folder, and holdouts in it are runs like the others. Deeper folders are not
        read.
    out : Path
        Folder for ``<stem>.json``, ``summary.csv`` and ``summary.html``, created if missing. The reports of an earlier
        run with the same files, version and seed are kept.
    jobs : int, optional
        Number of processes; by default the number of cores.
    seed : int
        Random seed of the confidence intervals.
    progress : callable, optional
        Called with a description of the current step and the completed share.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``tcp://HOST:8786``, whose workers run the diagnoses.
    html : bool
        Also write ``<stem>.html`` for each report, on this machine.
    how : Reading, optional
        How each record is read.

    Returns
    -------
    str
        Summary of the verdicts. The report of a record that cannot be diagnosed has the verdict "error".

    Raises
    ------
    OSError
        If the folder does not exist, a sub-folder cannot be read, or `out` cannot be written.
    ValueError
        If the folder contains no records, or two with the same stem, or a sub-folder with records and a simulation; or
        the scheduler or its workers fail; or the page of a record would be ``summary.html``.
    """
    how = how or Reading()
    records = find_records(folder, out)
    noun, plural = nouns(records)
    made_from = " ".join([sources_version(), str(seed), *([repr(how)] if how != Reading() else [])])
    all_jobs = [make_job(record, out, made_from) for record in records]
    for job in all_jobs if html else ():
        if job.stem.lower() == Path(PAGE).stem:
            raise ValueError(f"the page of {job.stem} would replace {PAGE}. Rename the {noun}, or omit --html.")
    out.mkdir(parents=True, exist_ok=True)
    reports = {job.stem: report for job in all_jobs if (report := _earlier_report(job)) is not None}
    kept = len(reports)
    todo = [job for job in all_jobs if job.stem not in reports]
    if progress is not None:
        progress(f"{kept} of {len(records)} {plural}", kept / len(records))
    tasks = [{"files": job.files, "seed": seed, "how": asdict(how)} for job in todo]
    if scheduler is None:
        running = run_tasks(__name__, tasks, jobs or _cores())
    else:
        running = run_on_scheduler(_diagnose, sources_version(), tasks, scheduler)
    with closing(running) as results:
        for number, result in results:
            job = todo[number]
            reports[job.stem] = _report(job, result, command_of(job, folder, seed, how))
            write_json(job.report, reports[job.stem])
            if progress is not None:
                progress(f"{len(reports)} of {len(records)} {plural}", len(reports) / len(records))
    write_text(out / SUMMARY, csv_summary(reports))
    failed = write_record_pages(out, reports, jobs or _cores(), progress) if html else {}
    write_batch_page(out / PAGE, folder.resolve().name, reports, (noun, plural))
    failures = [f"  no page of {stem}: {reason}" for stem, reason in failed.items()]
    return "\n".join([text_summary(reports, kept, out / SUMMARY, plural), f"Page: {out / PAGE}", *failures])


def run_worker() -> None:
    """Main function of a worker process of `run_tasks`."""
    serve(_diagnose)


def _diagnose(task: dict[str, Any]) -> dict[str, Any]:
    """Diagnose one record or several of one rig; an error becomes a report with the verdict "error"."""
    from labsid.gap.diagnosis import diagnose
    from labsid.gap.simulations.simulation_files import load_simulation
    from labsid.records.record import read_record

    files: dict[str, list[str]] = task["files"]
    try:
        how = Reading(**task["how"])
        records = [read_record(path, how) for path in files["records"]]
        holdout = next((read_record(path, how) for path in files["holdout"]), None)
        simulation = next((load_simulation(Path(path), records[0], len(records) > 1) for path in files["sim"]), None)
        report = diagnose(records, simulation, holdout=holdout, seed=task["seed"]).report
        json.dumps(report, allow_nan=False)
    except ValueError as error:
        return _error(str(error))
    except OSError as error:
        return _error(f"{error.filename or files['records'][0]}: {error.strerror or error}", keep=False)
    except Exception as error:
        what = f"{type(error).__name__}: {error}".removesuffix(": ")
        return _error(
            f"labsid failed, and the record is not at fault. Please report this, with the record: {what}", False
        )
    return {"report": report, "keep": True}


def _error(message: str, keep: bool = True) -> dict[str, Any]:
    report = {"schema": SCHEMA, "verdict": "error", "message": " ".join(message.split())}
    return {"report": report, "keep": keep}


def _report(job: Job, result: dict[str, Any] | None, command: str) -> dict[str, Any]:
    """The report to write, with the key that lets a later run keep it unless the error may be temporary."""
    if result is None:
        result = _error(f"the process was killed {ATTEMPTS} times, possibly for lack of memory.", keep=False)
    report: dict[str, Any] = result["report"]
    report = report if report["verdict"] == "error" else report | {"command": command}
    return report | {KEY: job.key} if result["keep"] else report


def _earlier_report(job: Job) -> dict[str, Any] | None:
    """The report of an earlier run on the same files with the same version and seed."""
    try:
        content = json.loads(job.report.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) and content.get(KEY) == job.key else None


def _cores() -> int:
    """Number of cores available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
