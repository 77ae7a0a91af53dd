"""The suites of the sealed check: `dev` has fixed seeds; the seeds of `final` depend on the diagnosis's source code."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from labsid.blind.experiment import Case, OrdinaryCase
from labsid.blind.rows import DEFAULT_ROWS, ROWS
from labsid.records.record import Record
from labsid.rig.switchable.simulation import UnboundedOutputError

PER_ROW = {"dev": 80, "final": 220}
_MOST_DRAWS = 400
_DEV = 20260


def make_cases(
    suite: str, per_row: int | None = None, rows: Sequence[str] | None = None, jobs: int = 1
) -> Iterator[Case | OrdinaryCase]:
    """Make the cases of a suite, row by row.

    Parameters
    ----------
    suite : {"dev", "final"}
    per_row : int, optional
        Cases in each row; by default 80 in `dev` and 220 in `final`.
    rows : sequence of str, optional
        Rows to make; by default all but those of `labsid.blind.rows.ON_REQUEST`.
    jobs : int
        Number of parallel processes.

    Yields
    ------
    Case or OrdinaryCase

    Raises
    ------
    ValueError
        If the suite or a row does not exist.
    RuntimeError
        If a case could not be drawn, which means that the ranges of its row are wrong.
    """
    if suite not in PER_ROW:
        raise ValueError(f"suite must be dev or final; got {suite!r}. Name one of these.")
    unknown = [row for row in rows or () if row not in ROWS]
    if unknown:
        raise ValueError(f"rows must be of {', '.join(ROWS)}; got {unknown[0]!r}. Name some of these.")
    entropy = _DEV if suite == "dev" else diagnosis_hash()
    count = PER_ROW[suite] if per_row is None else per_row
    wanted = [(entropy, row, i) for row in ROWS if row in (rows or DEFAULT_ROWS) for i in range(count)]
    if jobs == 1:
        yield from map(_made, wanted)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_made, wanted)


def _made(which: tuple[int, str, int]) -> Case | OrdinaryCase:
    """Draw one case."""
    entropy, row, i = which
    name = hashlib.sha256(f"{entropy} {row} {i}".encode()).hexdigest()[:10]
    for attempt in range(_MOST_DRAWS):
        try:
            case = ROWS[row](np.random.default_rng([entropy, list(ROWS).index(row), i, attempt]), i, f"r{name}")
        except UnboundedOutputError:
            continue
        if case is not None:
            return case
    raise RuntimeError(f"no case {i} of {row} in {_MOST_DRAWS} draws")


def write_suite(
    folder: Path, suite: str = "dev", per_row: int | None = None, rows: Sequence[str] | None = None
) -> Path:
    """Write a suite to files: the records into `folder`, the labels beside it.

    Parameters
    ----------
    folder : Path
        Created if missing. Receives ``<name>.csv`` and, if present, ``<name>.holdout.csv`` and the simulation
        (``<name>.sim.json``, ``<name>.sim.csv`` or ``<name>.py``); of several runs of a rig a folder ``<name>`` and
        the first one alone. Nothing in it reveals the labels.
    suite : {"dev", "final"}
    per_row : int, optional
    rows : sequence of str, optional

    Returns
    -------
    Path
        ``<folder>.labels.json``, beside the folder, with one object per record, by name.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    labels = {}
    for case in make_cases(suite, per_row, rows):
        write_case(folder, case)
        labels[case.name] = label_dict(case)
    path = folder.with_name(f"{folder.name}.labels.json")
    path.write_text(json.dumps(labels, indent=1), encoding="utf-8")
    return path


def write_case(folder: Path, case: Case | OrdinaryCase) -> None:
    """Write the files of a case that the diagnosis may read.

    Parameters
    ----------
    folder : Path
    case : Case or OrdinaryCase
    """
    if isinstance(case, OrdinaryCase):
        for ending, text in case.made.files.items():
            (folder / f"{case.name}{ending}").write_text(text, encoding="utf-8")
        return
    if case.others:
        runs = folder / case.name
        runs.mkdir(exist_ok=True)
        for number, record in enumerate((case.record, *case.others), 1):
            write_record(runs / f"{number}.csv", record)
    write_record(folder / f"{case.alone if case.others else case.name}.csv", case.record)
    if case.sim is not None:
        (folder / f"{case.name}.sim.json").write_text(json.dumps(case.sim), encoding="utf-8")
    if case.holdout is not None:
        write_record(folder / f"{case.name}.holdout.csv", case.holdout)


def write_record(path: Path, record: Record) -> None:
    """Write a record as text with the header ``t,u,y``.

    Parameters
    ----------
    path : Path
    record : Record
    """
    table = np.column_stack([record.t, record.u, record.y])
    np.savetxt(path, table, fmt="%.10g", delimiter=",", header="t,u,y", comments="")


def label_dict(case: Case | OrdinaryCase) -> dict[str, Any]:
    """Label of a case in a serialisable form.

    Parameters
    ----------
    case : Case or OrdinaryCase

    Returns
    -------
    dict
        Of an ordinary record, `labels` is the first one of its right `answers`.
    """
    if isinstance(case, OrdinaryCase):
        made = case.made
        return {
            "row": case.row,
            "labels": list(made.answers[0]),
            "answers": [list(answer) for answer in made.answers],
            "truth": {"kind": case.kind, **made.truth},
            "numbers": None if made.numbers is None else asdict(made.numbers),
            "options": list(case.options),
        }
    experiment = case.experiment
    return {
        "row": case.row,
        "labels": list(case.labels),
        "level": case.level,
        "ratio": case.ratio,
        "sigma": case.sigma,
        "u_range": float(np.ptp(case.record.u)),
        "y_range": float(np.ptp(case.record.y)),
        "truth": case.truth,
        "rig": experiment.plain.rig,
        "input": experiment.input,
        "samples": experiment.samples,
        "Ts": experiment.scales.Ts,
        "from_rest": experiment.from_rest,
        "noise": {"share": experiment.noise.share, "pole": experiment.noise.colour},
        "sim": case.sim is not None,
        "holdout": case.holdout is not None,
    }


def diagnosis_hash() -> int:
    """Hash of the source code of the diagnosis."""
    folder = Path(__file__).resolve().parent.parent / "gap"
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return int.from_bytes(digest.digest()[:6], "big")
