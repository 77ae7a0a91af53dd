"""A fleet of rigs: records diagnosed on two Dask workers, one of which is killed midway."""

import csv
import json
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from bars_grading_figures import Metric, none
from dask_machines import machines_in
from scipy.signal import lfilter

from labsid.gap.batches.batch import diagnose_folder

SAMPLES, TS, HOLD, NOISE = 1000, 0.1, 20, 0.01
REPEATED = 10  # records that are also diagnosed on this machine


def write_records(folder: Path, count: int) -> None:
    """Records of rigs of two lags, every second one with a limit of the actuator."""
    folder.mkdir()
    for number in range(count):
        rng = np.random.default_rng(number)
        u = np.repeat(rng.uniform(-1.0, 1.0, SAMPLES // HOLD), HOLD)
        w = np.clip(u, -0.6, 0.5) if number % 2 else u
        y = lfilter([0.0, 0.02], np.poly(rng.uniform((0.9, 0.6), (0.95, 0.85))), w)
        y = y + NOISE * np.std(y) * rng.standard_normal(SAMPLES)
        rows = np.column_stack([TS * np.arange(SAMPLES), u, y])
        np.savetxt(folder / f"rig-{number:04d}.csv", rows, fmt="%.8g", delimiter=",", header="t,u,y", comments="")


def measure(folder: Path, count: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Diagnose `count` records in an empty folder; kill a worker when half of them are done."""
    records, out = folder / "records", folder / "reports"
    write_records(records, count)
    finished: list[str] = []
    with machines_in(folder / "machines") as machines:
        machines.start(workers=2)

        def progress(what: str, share: float) -> None:
            finished.append(what)
            if len(finished) == count // 2:
                machines.workers[0].kill()
                say(f"a worker is killed after {what}")
            elif len(finished) % max(count // 10, 1) == 0:
                say(what)

        began = time.perf_counter()
        say(diagnose_folder(records, out, progress=progress, scheduler=machines.address).splitlines()[0])
        seconds = time.perf_counter() - began
    reports = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in out.glob("rig-*.json")}
    with (out / "summary.csv").open(newline="", encoding="utf-8") as file:
        rows = Counter(row["stem"] for row in csv.DictReader(file))
    expected = {path.stem for path in records.iterdir()}
    sound = {stem for stem, report in reports.items() if report["verdict"] != "error"} & rows.keys()
    doubled = max(len(finished) - 1 - count, 0) + sum(rows.values()) - len(rows)  # the first call is the start
    differing = _differing(records, folder / "again", reports)
    what = f"{count:,} records of {SAMPLES:,} samples on two workers, one killed midway: lost / doubled / "
    yield none(f"{what}other than on one machine ({REPEATED} of them)", len(expected - sound), doubled, differing)
    yield Metric("the same: time", f"{seconds:.0f} s", status="no bar")


def _differing(records: Path, again: Path, reports: dict[str, dict]) -> int:
    """How many of some records have another report when they are diagnosed on this machine."""
    few = again / "records"
    few.mkdir(parents=True)
    stems = sorted(reports)[:: max(len(reports) // REPEATED, 1)][:REPEATED]
    for stem in stems:
        (few / f"{stem}.csv").write_bytes((records / f"{stem}.csv").read_bytes())
    diagnose_folder(few, again / "reports", jobs=1)
    here = {stem: json.loads((again / "reports" / f"{stem}.json").read_text(encoding="utf-8")) for stem in stems}
    return sum(here[stem] != reports[stem] for stem in stems)
