"""Diagnose the records of a folder on all cores; a later run continues an interrupted one."""

import hashlib
import json
import os
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labsid._files import write_json, write_text
from labsid.gap.batch_page import write_batch_page, write_record_pages
from labsid.gap.batch_summary import csv_summary, text_summary
from labsid.gap.scheduler import run_on_scheduler
from labsid.gap.version import sources_version
from labsid.gap.workers import ATTEMPTS, run_tasks, serve

if TYPE_CHECKING:  # only the worker processes import the search
    from labsid.gap.beam_search import Progress

SCHEMA = "labsid.gap/2"
RECORDS = (".csv", ".mat")
SIMULATIONS = (".sim.json", ".sim.csv")  # after the stem of the record
HOLDOUTS = (".holdout.csv", ".holdout.mat")
KEY = "made_from"  # entry of a report that identifies its input files, version and seed
SUMMARY = "summary.csv"
PAGE = "summary.html"


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A record to diagnose.

    Attributes
    ----------
    record : Path
    sim, holdout : Path or None
    report : Path
        File for the report.
    key : str
        Hash of everything that the report depends on.
    """

    record: Path
    sim: Path | None
    holdout: Path | None
    report: Path
    key: str

    @property
    def stem(self) -> str:
        """Name of the record."""
        return self.record.stem


def diagnose_folder(
    folder: Path,
    out: Path,
    jobs: int | None = None,
    seed: int = 0,
    progress: "Progress | None" = None,
    scheduler: str | None = None,
    html: bool = False,
) -> str:
    """Diagnose every record of a folder.

    Parameters
    ----------
    folder : Path
        Files ``.csv`` and ``.mat`` are records; ``<stem>.sim.json`` (or ``.sim.csv``) and ``<stem>.holdout.csv`` are
        the simulation and the holdout of a record.
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
        Also write ``<stem>.html`` for each record, on this machine.

    Returns
    -------
    str
        Summary of the verdicts. The report of a record that cannot be diagnosed has the verdict "error".

    Raises
    ------
    OSError
        If the folder does not exist, or `out` cannot be written.
    ValueError
        If the folder contains no records, or two with the same stem, or the scheduler or its workers fail, or the page
        of a record would be ``summary.html``.
    """
    records = find_records(folder, out)
    for record in records if html else ():
        if record.stem.lower() == Path(PAGE).stem:
            raise ValueError(f"the page of {record.name} would replace {PAGE}. Rename the record, or omit --html.")
    out.mkdir(parents=True, exist_ok=True)
    all_jobs = [_job(record, out, seed) for record in records]
    reports = {job.stem: report for job in all_jobs if (report := _earlier_report(job)) is not None}
    before = len(reports)
    todo = [job for job in all_jobs if job.stem not in reports]
    if progress is not None:
        progress(f"{before} of {len(records)} records", before / len(records))
    tasks = [
        {"record": str(job.record), "sim": _text(job.sim), "holdout": _text(job.holdout), "seed": seed} for job in todo
    ]
    if scheduler is None:
        running = run_tasks(__name__, tasks, jobs or _cores())
    else:
        running = run_on_scheduler(_diagnose, sources_version(), tasks, scheduler)
    with closing(running) as results:
        for number, result in results:
            job = todo[number]
            reports[job.stem] = _report(job, result)
            write_json(job.report, reports[job.stem])
            if progress is not None:
                progress(f"{len(reports)} of {len(records)} records", len(reports) / len(records))
    write_text(out / SUMMARY, csv_summary(reports))
    failed = write_record_pages(out, reports, jobs or _cores(), progress) if html else {}
    write_batch_page(out / PAGE, folder.resolve().name, reports)
    failures = [f"\n  no page of {stem}: {reason}" for stem, reason in failed.items()]
    return text_summary(reports, before, out / SUMMARY) + "".join(failures)


def find_records(folder: Path, out: Path) -> list[Path]:
    """Find the records of a folder, in order of their stems; the summary in `out` is not a record.

    Raises
    ------
    OSError
        If the folder does not exist.
    ValueError
        If it contains no records, or two with the same stem.
    """
    found: dict[str, Path] = {}
    for path in sorted(folder.iterdir()):
        name = path.name.lower()
        if path.suffix.lower() not in RECORDS or name.startswith(".") or name.endswith((*SIMULATIONS, *HOLDOUTS)):
            continue
        if path.is_dir() or path.resolve() == (out / SUMMARY).resolve():
            continue
        if path.stem in found:
            raise ValueError(
                f"{found[path.stem].name} and {path.name} would share the report {path.stem}.json. Rename one of them."
            )
        found[path.stem] = path
    if not found:
        raise ValueError(f"{folder} holds no records (.csv or .mat).")
    return [found[stem] for stem in sorted(found)]


def run_worker() -> None:
    """Main function of a worker process of `run_tasks`."""
    serve(_diagnose)


def _diagnose(task: dict[str, Any]) -> dict[str, Any]:
    """Diagnose one record; an error becomes a report with the verdict "error"."""
    from labsid.gap.diagnosis import diagnose
    from labsid.gap.simulation_files import load_simulation
    from labsid.records.record import load_record

    try:
        record = load_record(task["record"], allow_jitter=True)
        holdout = None if task["holdout"] is None else load_record(task["holdout"], allow_jitter=True)
        simulation = None if task["sim"] is None else load_simulation(Path(task["sim"]), record)
        report = diagnose(record, simulation, holdout=holdout, seed=task["seed"]).report
        json.dumps(report, allow_nan=False)
    except ValueError as error:
        return _error(str(error))
    except OSError as error:
        return _error(f"{error.filename or task['record']}: {error.strerror or error}", keep=False)
    except Exception as error:
        return _error(f"internal error: {error!r}", keep=False)
    return {"report": report, "keep": True}


def _error(message: str, keep: bool = True) -> dict[str, Any]:
    report = {"schema": SCHEMA, "verdict": "error", "message": " ".join(message.split())}
    return {"report": report, "keep": keep}


def _report(job: Job, result: dict[str, Any] | None) -> dict[str, Any]:
    """The report to write, with the key that lets a later run keep it unless the error may be temporary."""
    if result is None:
        result = _error(f"the process was killed {ATTEMPTS} times, possibly for lack of memory.", keep=False)
    report: dict[str, Any] = result["report"]
    return report | {KEY: job.key} if result["keep"] else report


def _job(record: Path, out: Path, seed: int) -> Job:
    sim, holdout = _companion(record, SIMULATIONS), _companion(record, HOLDOUTS)
    digest = hashlib.sha256(f"{sources_version()} {seed}".encode())
    for path in (record, sim, holdout):
        digest.update(b"\0" if path is None else f"{path.suffix.lower()} {_hash(path)}".encode())
    return Job(record, sim, holdout, out / f"{record.stem}.json", digest.hexdigest())


def _companion(record: Path, endings: tuple[str, ...]) -> Path | None:
    paths = [record.with_name(record.stem + ending) for ending in endings]
    return next((path for path in paths if path.exists()), None)


def _hash(path: Path) -> str:
    """Hash of a file, or the reason why it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        return repr(error)


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


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)
