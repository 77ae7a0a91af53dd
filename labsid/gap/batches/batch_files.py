"""The files of a batch: records, folders of runs of one rig, simulations, holdouts and reports."""

import hashlib
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path

from labsid._files import as_argument
from labsid.gap.batches.batch_summary import COLUMNS
from labsid.records.reading import Reading

RECORDS = (".csv", ".mat", ".xlsx", ".parquet", ".npz", ".h5", ".mf4", ".tdms", ".mcap", ".bag")
SIMULATIONS = (".sim.json", ".sim.csv")  # after the stem of the record
HOLDOUTS = (".holdout.csv", ".holdout.mat")
SUMMARY = "summary.csv"
OPTIONS = {"output": "LogData", "since": "from", "until": "to", "time_unit": "time-unit"}  # of attributes of `Reading`


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A record to diagnose, or several of one rig.

    Attributes
    ----------
    stem : str
        Name of the record without suffix, or of the folder of runs.
    records : tuple of Path
        The record, or the runs of one rig.
    sim, holdout : Path or None
    report : Path
        File for the report.
    key : str
        Hash of everything that the report depends on.
    """

    stem: str
    records: tuple[Path, ...]
    sim: Path | None
    holdout: Path | None
    report: Path
    key: str

    @property
    def files(self) -> dict[str, list[str]]:
        """The files to read, by the names of the attributes."""
        others = {"sim": self.sim, "holdout": self.holdout}
        named = {name: [] if path is None else [str(path)] for name, path in others.items()}
        return {"records": [str(path) for path in self.records], **named}


def find_records(folder: Path, out: Path) -> list[Path]:
    """Find the records of a folder and its sub-folders with records, in order of their stems.

    Parameters
    ----------
    folder : Path
    out : Path
        Folder of the reports; it may be in `folder`, and the summary in it is not a record.

    Returns
    -------
    list of Path
        Files, and folders with the runs of one rig each.

    Raises
    ------
    OSError
        If the folder does not exist, or a sub-folder cannot be read.
    ValueError
        If it contains no records, or two with the same stem, or the simulation of a rig is in the folder of its runs.
    """
    by_stem: dict[str, Path] = {}
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or (path.is_dir() and path.resolve() == out.resolve()):
            continue
        if not (find_runs(path, out) if path.is_dir() else _is_record(path, out)):
            continue
        stem = stem_of(path)
        if stem in by_stem:
            raise ValueError(
                f"{by_stem[stem].name} and {path.name} would share the report {stem}.json. Rename one of them."
            )
        by_stem[stem] = path
    if not by_stem:
        raise ValueError(f"{folder} holds no records (.csv, .mat or another format of logs), nor a folder of them.")
    return [by_stem[stem] for stem in sorted(by_stem)]


def find_runs(folder: Path, out: Path) -> tuple[Path, ...]:
    """The records in the folder of a rig, in order of their names; each is held out in turn, so holdouts are records.

    Raises
    ------
    OSError
        If the folder cannot be read.
    ValueError
        If it contains records and a simulation.
    """
    files = [path for path in sorted(folder.iterdir()) if not path.is_dir()]
    runs = tuple(path for path in files if _is_record(path, out, holdouts=True))
    for path in files if runs else ():
        if path.name.lower().endswith(SIMULATIONS):
            suffix = next(ending for ending in SIMULATIONS if path.name.lower().endswith(ending))
            raise ValueError(
                f"{path} is in a folder of runs, which share one simulation. Put it beside the folder, as "
                f"{folder.name}{suffix}."
            )
    return runs


def stem_of(path: Path) -> str:
    """Name of a record without suffix, or of a folder of runs."""
    return path.name if path.is_dir() else path.stem


def make_job(path: Path, out: Path, version: str) -> Job:
    """The job of a record or folder of runs.

    Parameters
    ----------
    path : Path
        As `find_records` returns it.
    out : Path
        Folder for the report.
    version : str
        Of the program and its settings; a part of the key.
    """
    stem = stem_of(path)
    records = find_runs(path, out) if path.is_dir() else (path,)
    sim, holdout = _companion(path, stem, SIMULATIONS), _companion(path, stem, HOLDOUTS)
    digest = hashlib.sha256(version.encode())
    for file in (sim, holdout, *records):
        digest.update(b"\0" if file is None else f"{file.name!r} {_hash(file)}\0".encode(errors="backslashreplace"))
    return Job(stem, records, sim, holdout, out / f"{stem}.json", digest.hexdigest())


def command_of(job: Job, folder: Path, seed: int, how: Reading) -> str:
    """The command that repeats the diagnosis of a job, to be run in the folder of records.

    Parameters
    ----------
    job : Job
    folder : Path
    seed : int
    how : Reading

    Returns
    -------
    str
        For a POSIX shell.
    """
    words = ["labsid", "gap", "diagnose", *(as_argument(path.relative_to(folder)) for path in job.records)]
    for option, path in (("--sim", job.sim), ("--holdout", job.holdout)):
        words += [] if path is None else [option, as_argument(path.relative_to(folder))]
    words += ["--seed", str(seed)] if seed else []
    for one in fields(Reading):
        value = getattr(how, one.name)
        words += [] if value == one.default else [f"--{OPTIONS.get(one.name, one.name)}", str(value)]
    return shlex.join([*words, "--html", "report.html"])


def nouns(paths: list[Path]) -> tuple[str, str]:
    """What records and folders of runs are called: one of them, and several."""
    folders = sum(path.is_dir() for path in paths)
    if not folders:
        return "record", "records"
    return ("rig", "rigs") if folders == len(paths) else ("record or rig", "records and rigs")


def _is_record(path: Path, out: Path, holdouts: bool = False) -> bool:
    """Whether the name is that of a record; with `holdouts`, also of a holdout."""
    name = path.name.lower()
    if path.suffix.lower() not in RECORDS or name.startswith(".") or name.endswith(SIMULATIONS):
        return False
    return (holdouts or not name.endswith(HOLDOUTS)) and not _is_summary(path, out)


def _is_summary(path: Path, out: Path) -> bool:
    """Whether a file is the summary of this or another batch."""
    if path.name.lower() != SUMMARY:
        return False
    header = ",".join(COLUMNS).encode()
    try:
        with path.open("rb") as file:
            return path.resolve() == (out / SUMMARY).resolve() or file.read(len(header)) == header
    except OSError:
        return False  # reported as a record


def _companion(path: Path, stem: str, endings: tuple[str, ...]) -> Path | None:
    paths: Iterator[Path] = (path.with_name(stem + ending) for ending in endings)
    return next((path for path in paths if path.exists()), None)


def _hash(path: Path) -> str:
    """Hash of a file, or the reason why it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        return repr(error)
