"""Run the diagnosis as a separate process, in a folder that holds only the records."""

import json
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.blind.experiment import Case, OrdinaryCase
from labsid.blind.suite import write_case, write_record
from labsid.records.record import Record

_MAIN = "import sys\nfrom labsid.cli.commands import main\nsys.exit(main(sys.argv[1:]))"
_SEVERAL = "import json, sys\nfrom labsid.cli.commands import main\nfor line in json.load(sys.stdin):\n    main(line)"
SECONDS_TO_START = 60.0
SECONDS_A_RECORD = 60.0
"""Time limits (s); a result that is missing after them counts as wrong."""
MOST_RECORDS = 100  # of a folder, for the time limit


@dataclass(frozen=True, slots=True, eq=False)
class Replay:
    """Diagnosis of one record, and output of its exported simulation on other records.

    Attributes
    ----------
    result : dict or None
        The diagnosis; None if there is none.
    outputs : tuple of ndarray or None
        Simulated output for each of the other records; None if the simulation failed.
    """

    result: dict[str, Any] | None
    outputs: tuple[FloatArray | None, ...]


def run_batch(
    cases: Sequence[Case | OrdinaryCase],
    jobs: int,
    on_progress: Callable[[int], None] | None = None,
    keep: Path | None = None,
) -> tuple[dict[str, dict[str, Any]], float]:
    """Diagnose the records of all cases: with ``labsid gap batch``, or one by one where they need options.

    Parameters
    ----------
    cases : sequence of Case or OrdinaryCase
    jobs : int
    on_progress : callable, optional
        Called with the number of finished records.
    keep : Path, optional
        Folder in which the results stay, so that a second run continues an interrupted one.

    Returns
    -------
    tuple of dict and float
        Results by name, without missing, unreadable or late ones, and the time per record and core (s).
    """
    single = [case for case in cases if isinstance(case, OrdinaryCase) and case.options]
    together = [case for case in cases if case not in single]
    results: dict[str, dict[str, Any]] = {}
    seconds = 0.0
    if together:
        with TemporaryDirectory(prefix="labsid-blind-") as scratch:
            records = Path(scratch, "records")
            records.mkdir()
            for case in together:
                write_case(records, case)
            results, seconds = run_folder(records, jobs, on_progress, len(together), keep)
    begun = time.monotonic()
    with ThreadPoolExecutor(jobs) as pool:
        for number, result in enumerate(pool.map(lambda case: _run_single(case, keep), single)):
            if on_progress is not None:
                on_progress(len(together) + number + 1)
            if result is not None:
                results[single[number].name] = result
    spent = seconds * len(together) + (time.monotonic() - begun) * jobs
    return results, spent / max(len(cases), 1)


def diagnose_words(case: Case | OrdinaryCase) -> list[str]:
    """Words of the command line that diagnoses a case, after ``labsid``, in the folder of `write_case`.

    Parameters
    ----------
    case : Case or OrdinaryCase
    """
    words = ["gap", "diagnose"]
    if isinstance(case, OrdinaryCase):
        ending = next((ending for ending in case.made.files if ending.startswith(".sim.")), None)
        words += [f"{case.name}.csv", *([] if ending is None else ["--sim", f"{case.name}{ending}"]), *case.options]
        return words
    words += [f"{case.name}/{n}.csv" for n in range(1, len(case.others) + 2)] if case.others else [f"{case.name}.csv"]
    words += [] if case.sim is None else ["--sim", f"{case.name}.sim.json"]
    return words + ([] if case.holdout is None else ["--holdout", f"{case.name}.holdout.csv"])


def _run_single(case: OrdinaryCase, keep: Path | None) -> dict[str, Any] | None:
    """Diagnose one record in a process of its own; an error that is no report has the layout of the batch."""
    kept = None if keep is None else keep / f"{case.name}.json"
    if kept is not None and kept.exists():
        return _read_json(kept)
    with TemporaryDirectory(prefix="labsid-blind-") as scratch:
        write_case(Path(scratch), case)
        try:
            process = subprocess.run(
                [sys.executable, "-c", _MAIN, *diagnose_words(case), "--json", "result.json"],
                cwd=scratch,
                capture_output=True,
                text=True,
                timeout=SECONDS_TO_START + SECONDS_A_RECORD,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None
        result = _read_json(Path(scratch, "result.json"))
    if result is None:
        lines = process.stderr.strip().splitlines() or [f"exit status {process.returncode}"]
        result = {"verdict": "error", "message": lines[-1]}
    if kept is not None:
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(result), encoding="utf-8")
    return result


def run_folder(
    records: Path,
    jobs: int,
    on_progress: Callable[[int], None] | None = None,
    count: int = MOST_RECORDS,
    keep: Path | None = None,
) -> tuple[dict[str, dict[str, Any]], float]:
    """Diagnose the records of a folder with ``labsid gap batch``.

    Parameters
    ----------
    records : Path
    jobs : int
    on_progress : callable, optional
        Called with the number of finished records.
    count : int
        Number of records, which determines the time limit.
    keep : Path, optional
        Folder in which the results stay; those that are there already are not made again.

    Returns
    -------
    tuple of dict and float
        Results by name, without missing and unreadable ones, and the time per record and core (s).
    """
    with TemporaryDirectory(prefix="labsid-blind-") as scratch:
        out = Path(scratch, "out") if keep is None else keep.resolve()
        kept_count = len(list(out.glob("*.json")))
        begun = time.monotonic()
        limit = begun + SECONDS_TO_START + SECONDS_A_RECORD * count / jobs
        command = [sys.executable, "-c", _MAIN, "gap", "batch", str(records), "--out", str(out), "--jobs", str(jobs)]
        process = subprocess.Popen(command, cwd=scratch, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            while process.poll() is None and time.monotonic() < limit:
                time.sleep(0.2)
                if on_progress is not None:
                    on_progress(len(list(out.glob("*.json"))))
        finally:
            if process.poll() is None:
                process.terminate()
            process.wait()
        seconds = time.monotonic() - begun
        results = {path.stem: _read_json(path) for path in sorted(out.glob("*.json"))}
    made = max(len(results) - kept_count, 1)
    return {name: result for name, result in results.items() if result is not None}, seconds * jobs / made


def run_replays(
    pairs: Sequence[tuple[Case, Sequence[Record]]], jobs: int, on_progress: Callable[[int], None] | None = None
) -> list[Replay]:
    """Diagnose each record alone, export the improved simulation and run it on other records.

    Parameters
    ----------
    pairs : sequence of (Case, sequence of Record)
    jobs : int
    on_progress : callable, optional
        Called with the number of finished cases.

    Returns
    -------
    list of Replay
        In the order of `pairs`.
    """
    done: list[None] = []

    def one(pair: tuple[Case, Sequence[Record]]) -> Replay:
        replay = _replay(*pair)
        done.append(None)
        if on_progress is not None:
            on_progress(len(done))
        return replay

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, pairs))


def _replay(case: Case, others: Sequence[Record]) -> Replay:
    with TemporaryDirectory(prefix="labsid-blind-") as scratch:
        folder = Path(scratch)
        write_case(folder, case)
        for i, record in enumerate(others):
            write_record(folder / f"other{i}.csv", record)
        diagnose = ["gap", "diagnose", f"{case.name}.csv", "--json", "result.json", "--export", "better.json"]
        if case.sim is not None:
            diagnose += ["--sim", f"{case.name}.sim.json"]
        lines = [diagnose]
        for i in range(len(others)):
            lines.append(["gap", "simulate", "better.json", f"other{i}.csv", "--out", f"played{i}.csv"])
        try:
            subprocess.run(
                [sys.executable, "-c", _SEVERAL],
                cwd=scratch,
                input=json.dumps(lines),
                text=True,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=SECONDS_TO_START + SECONDS_A_RECORD + 5.0 * len(others),
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Replay(None, (None,) * len(others))
        simulated = [_read_output(folder / f"played{i}.csv", len(record)) for i, record in enumerate(others)]
        return Replay(_read_json(folder / "result.json"), tuple(simulated))


def _read_json(path: Path) -> dict[str, Any] | None:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None


def _read_output(path: Path, samples: int) -> FloatArray | None:
    """Read the column ``y_sim``, or else ``y``, of a table with a header."""
    try:
        names = path.read_text(encoding="utf-8").splitlines()[0].split(",")
        table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
        column = table[:, names.index("y_sim" if "y_sim" in names else "y")]
    except (OSError, ValueError, IndexError):
        return None
    return column if column.size == samples and np.all(np.isfinite(column)) else None
