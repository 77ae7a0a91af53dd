"""Every record of a folder: diagnosed on all cores, one file an answer, going on where an earlier run stopped."""

import csv
import hashlib
import io
import json
import os
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labsid import __version__
from labsid._files import write_file, write_json
from labsid.gap.workers import ATTEMPTS, run_tasks, serve

if TYPE_CHECKING:  # it comes with the whole search, which only the workers need
    from labsid.gap.beam_search import Progress

SCHEMA = "labsid.gap/1"
RECORDS = (".csv", ".mat")
SIMULATIONS = (".sim.json", ".sim.csv")  # beside `<stem>.csv`, as what follows: no records
HOLDOUTS = (".holdout.csv", ".holdout.mat")
KEY = "made_from"
SUMMARY = "summary.csv"
COLUMNS = ("stem", "verdict", "effects", "probability", "closed", "error")
MOST_ERRORS = 5  # that the printed summary shows


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """One record with what belongs to it.

    Attributes
    ----------
    record : Path
    sim, holdout : Path or None
    answer : Path
        Where its answer goes.
    key : str
        A number of everything that the answer depends on.
    """

    record: Path
    sim: Path | None
    holdout: Path | None
    answer: Path
    key: str

    @property
    def stem(self) -> str:
        """Name of the record."""
        return self.record.stem


def diagnose_folder(
    folder: Path, out: Path, jobs: int | None = None, seed: int = 0, progress: "Progress | None" = None
) -> str:
    """Diagnose every record of a folder, each in a process of its own from a few that stay.

    Parameters
    ----------
    folder : Path
        Its files ``.csv`` and ``.mat`` are the records; ``<stem>.sim.json`` (or ``.sim.csv``) and
        ``<stem>.holdout.csv`` beside one are its simulation and its holdout.
    out : Path
        Folder for ``<stem>.json`` and ``summary.csv``; made where there is none. An answer that is there from an
        earlier run with the same files, version and seed is kept.
    jobs : int, optional
        Records at a time; as many as there are cores unless given.
    seed : int
        Of the resampling behind the intervals.
    progress : callable, optional
        Called with what is being done and the share of it that is done.

    Returns
    -------
    str
        What was found, in a few lines. A record that cannot be diagnosed has an answer with the verdict "error".

    Raises
    ------
    OSError
        If there is no such folder, or `out` cannot be written.
    ValueError
        If the folder holds no record, or two of one name.
    """
    records = find_records(folder, out)
    out.mkdir(parents=True, exist_ok=True)
    all_jobs = [_job(record, out, seed) for record in records]
    answers = {job.stem: kept for job in all_jobs if (kept := _kept(job)) is not None}
    before = len(answers)
    todo = [job for job in all_jobs if job.stem not in answers]
    if progress is not None:
        progress(f"{before} of {len(records)} records", before / len(records))
    tasks = [
        {"record": str(job.record), "sim": _text(job.sim), "holdout": _text(job.holdout), "seed": seed} for job in todo
    ]
    with closing(run_tasks(__name__, tasks, jobs or _cores())) as results:
        for number, answer in results:
            job = todo[number]
            answers[job.stem] = _finished(job, answer)
            write_json(job.answer, answers[job.stem])
            if progress is not None:
                progress(f"{len(answers)} of {len(records)} records", len(answers) / len(records))
    write_file(out / SUMMARY, _table(answers).encode())
    return _summary(answers, before, out / SUMMARY)


def find_records(folder: Path, out: Path) -> list[Path]:
    """The records of a folder by name; what `out` holds by itself is none.

    Raises
    ------
    OSError
        If there is no such folder.
    ValueError
        If it holds no record, or two of one name.
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
                f"{found[path.stem].name} and {path.name} would share the answer {path.stem}.json. Rename one of them."
            )
        found[path.stem] = path
    if not found:
        raise ValueError(f"{folder} holds no records (.csv or .mat).")
    return [found[stem] for stem in sorted(found)]


def work() -> None:
    """Answer for `run_tasks`: the life of one process."""
    serve(_answer)


def _answer(task: dict[str, Any]) -> dict[str, Any]:
    """Diagnose one record; whatever goes wrong with it is an answer, too."""
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
        return _error(f"{error.filename or task['record']}: {error.strerror or error}", lasting=False)
    except Exception as error:
        return _error(f"a fault of the program: {error!r}", lasting=False)
    return {"report": report, "lasting": True}


def _error(message: str, lasting: bool = True) -> dict[str, Any]:
    report = {"schema": SCHEMA, "verdict": "error", "message": " ".join(message.split())}
    return {"report": report, "lasting": lasting}


def _finished(job: Job, answer: dict[str, Any] | None) -> dict[str, Any]:
    """The report as it is written: with the key by which a later run knows it, unless another try may end better."""
    if answer is None:
        answer = _error(f"its process was killed {ATTEMPTS} times; out of memory perhaps.", lasting=False)
    report: dict[str, Any] = answer["report"]
    return report | {KEY: job.key} if answer["lasting"] else report


def _job(record: Path, out: Path, seed: int) -> Job:
    sim, holdout = _companion(record, SIMULATIONS), _companion(record, HOLDOUTS)
    digest = hashlib.sha256(f"{_version()} {seed}".encode())
    for path in (record, sim, holdout):
        digest.update(b"\0" if path is None else f"{path.suffix.lower()} {_hash(path)}".encode())
    return Job(record, sim, holdout, out / f"{record.stem}.json", digest.hexdigest())


def _companion(record: Path, endings: tuple[str, ...]) -> Path | None:
    paths = [record.with_name(record.stem + ending) for ending in endings]
    return next((path for path in paths if path.exists()), None)


def _hash(path: Path) -> str:
    """Hash of a file; of one that cannot be read, the reason."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        return repr(error)


@cache
def _version() -> str:
    """Version and sources of the diagnosis: while it is being worked on, the version alone does not change."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return f"{__version__} {digest.hexdigest()}"


def _kept(job: Job) -> dict[str, Any] | None:
    """The answer of an earlier run, if it was made from the same files by the same version."""
    try:
        content = json.loads(job.answer.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) and content.get(KEY) == job.key else None


def _table(answers: dict[str, dict[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(_row(stem, answers[stem]) for stem in sorted(answers))
    return text.getvalue()


def _row(stem: str, report: dict[str, Any]) -> Iterator[str]:
    effects = report.get("effects", [])
    probability = effects[0]["probability"] if effects else None
    closed = report.get("gap", {}).get("closed")
    yield from (stem, report["verdict"], "+".join(effect["name"] for effect in effects))
    yield from ("" if value is None else f"{value:.6g}" for value in (probability, closed))
    yield report.get("message", "")


def _summary(answers: dict[str, dict[str, Any]], kept: int, table: Path) -> str:
    verdicts = Counter(report["verdict"] for report in answers.values())
    counts = ", ".join(f"{verdict} {verdicts[verdict]}" for verdict in sorted(verdicts))
    earlier = f" ({kept} from an earlier run)" if kept else ""
    lines = [f"{len(answers)} records: {counts}{earlier}"]
    found = [report["effects"] for report in answers.values() if report.get("effects")]
    names = Counter("+".join(effect["name"] for effect in effects) for effects in found)
    lines += [f"  {count:4d}  {name}" for name, count in names.most_common()]
    errors = [f"  {stem}: {answers[stem]['message']}" for stem in sorted(answers) if "message" in answers[stem]]
    lines += errors[:MOST_ERRORS]
    if len(errors) > MOST_ERRORS:
        lines.append(f"  and {len(errors) - MOST_ERRORS} more errors")
    return "\n".join([*lines, f"All of them: {table}"])


def _cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)
