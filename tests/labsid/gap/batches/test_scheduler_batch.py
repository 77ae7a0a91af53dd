"""Batches on the workers of a real Dask scheduler on loopback, and what may go wrong with them."""

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from dask_machines import Machines, machines_in
from gap_search import run_here

from labsid.cli.commands import main
from labsid.gap.batches import batch, scheduler
from labsid.gap.batches.batch import diagnose_folder
from labsid.gap.search import beam_search
from labsid.records.record import Record

pytest.importorskip("distributed", reason="pip install 'labsid[cluster]'")
SAMPLES, RECORDS = 150, 2
FEW = "from labsid.gap.search import beam_search\nbeam_search.CANDIDATES = beam_search.CANDIDATES[:2]\n"
"""For a worker that searches for few effects."""


@pytest.fixture
def machines(tmp_path: Path) -> Iterator[Machines]:
    with machines_in(tmp_path / "machines") as running:
        yield running


@pytest.fixture(scope="module")
def folder(
    tmp_path_factory: pytest.TempPathFactory,
    rig_record: Callable[..., Record],
    write_rig_record: Callable[[Path, Record], Path],
) -> Path:
    """Two records, one of them with a holdout, one that is none, and a rig with two runs."""
    folder = tmp_path_factory.mktemp("records")
    for number in range(RECORDS):
        write_rig_record(folder / f"run-{number}.csv", rig_record("none", SAMPLES, seed=number))
    write_rig_record(folder / "run-0.holdout.csv", rig_record("none", SAMPLES, seed=99))
    (folder / "rig").mkdir()
    for number in range(2):
        write_rig_record(folder / "rig" / f"run-{number}.csv", rig_record("none", SAMPLES, seed=20 + number))
    (folder / "words.csv").write_text("t,u,y\n1,2,three\n", encoding="utf-8")
    return folder


def reports(out: Path) -> dict[str, dict]:
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in out.glob("*.json")}


def test_a_worker_that_is_killed_costs_nothing_and_the_reports_are_those_of_this_machine(
    folder: Path, machines: Machines, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    preload = tmp_path / "few.py"
    preload.write_text(FEW, encoding="utf-8")
    machines.start()
    for _ in range(2):
        machines.add_worker("--preload", str(preload))
    finished: list[str] = []

    def progress(what: str, share: float) -> None:
        finished.append(what)
        if len(finished) == 2:
            machines.workers[0].kill()

    said = diagnose_folder(folder, tmp_path / "cluster", progress=progress, scheduler=machines.address)
    assert said.startswith("4 records and rigs: error 1, none 3")
    monkeypatch.setattr(batch, "run_tasks", run_here)
    monkeypatch.setattr(beam_search, "CANDIDATES", beam_search.CANDIDATES[:2])
    diagnose_folder(folder, tmp_path / "here", jobs=1)
    here, there = reports(tmp_path / "here"), reports(tmp_path / "cluster")
    assert here.keys() == there.keys()
    words = here.pop("words")
    assert there.pop("words")["verdict"] == words["verdict"] == "error"
    assert here == there
    machines.workers[1].kill()
    again = diagnose_folder(folder, tmp_path / "cluster", scheduler=machines.address)  # nothing is left to do
    assert "(4 from an earlier run)" in again


def test_what_is_wrong_with_the_cluster_is_said_in_one_line(
    folder: Path,
    machines: Machines,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(scheduler, "CONNECT_SECONDS", 1.0)
    monkeypatch.setattr(scheduler, "NO_WORKER_SECONDS", 0.5)
    monkeypatch.setattr(scheduler, "_POLL_SECONDS", 0.2)
    out = str(tmp_path / "out")
    command = ["gap", "batch", str(folder), "--out", out, "--scheduler"]

    def error(address: str) -> str:
        assert main([*command, address]) == 2
        return capsys.readouterr().err.splitlines()[-1]  # after the progress

    assert "expected an address such as tcp://HOST:8786" in error("nonsense")
    machines.start()
    assert "has no worker. Start some: dask worker tcp://" in error(machines.address)
    assert machines.scheduler is not None
    monkeypatch.setattr(scheduler, "CONNECT_SECONDS", 10.0)
    machines.add_worker()
    monkeypatch.setattr("labsid.gap.batches.batch.sources_version", lambda: "another")
    assert "has another labsid than this machine" in error(machines.address)
    monkeypatch.undo()
    machines.scheduler.kill()
    machines.scheduler.wait()
    monkeypatch.setattr(scheduler, "CONNECT_SECONDS", 1.0)
    assert "no Dask scheduler answers at" in error(machines.address)
    assert not list(Path(out).glob("run-*.json"))
    shutil.rmtree(out, ignore_errors=True)
