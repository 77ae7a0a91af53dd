"""Batches: invalid records, second runs, folders of runs, and interrupts."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from gap_reports import report as gap_report
from gap_search import run_here, searched

from labsid.gap.batches import batch
from labsid.gap.batches.batch import diagnose_folder
from labsid.gap.batches.batch_summary import csv_summary

LABSID = [sys.executable, "-c", "import sys; from labsid.cli.commands import main; sys.exit(main())"]
SAMPLES = 150
FEW = ("input-delay", "load-step")


@pytest.fixture(scope="module")
def folder(tmp_path_factory, rig_record, write_rig_record):
    """Two records, one with a simulation and a holdout, and two invalid files."""
    folder = tmp_path_factory.mktemp("records")
    write_rig_record(folder / "b.csv", rig_record("none", SAMPLES))
    write_rig_record(folder / "a.csv", rig_record("none", SAMPLES, seed=4))
    write_rig_record(folder / "a.holdout.csv", rig_record("none", SAMPLES, seed=5))
    den = np.poly([0.95, 0.8]).tolist()
    u0 = float(rig_record("none", SAMPLES, seed=4).u[0])
    (folder / "a.sim.json").write_text(json.dumps({"num": [0.01, 0.0], "den": den, "dt": 0.5, "u0": u0, "y0": u0}))
    (folder / "empty.csv").touch()
    (folder / "words.csv").write_text("t,u,y\n1,2,three\n")
    return folder


@pytest.fixture(scope="module")
def finished(folder, tmp_path_factory):
    """The folder of reports after one run in this process, the summary printed, and the progress messages.

    `test_workers.py` has two processes at work, below one is interrupted, and `counted` gives the results in another
    order.
    """
    out = tmp_path_factory.mktemp("out") / "new" / "answers"
    told = []
    with searched(*FEW), pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch, "run_tasks", run_here)
        printed = diagnose_folder(folder, out, jobs=1, progress=lambda what, share: told.append((what, share)))
    return out, printed, told


@pytest.fixture
def counted(monkeypatch):
    """Names of the records diagnosed; the diagnosis itself is replaced by a constant report, and the last is first."""
    asked = []

    def run_tasks(module, tasks, jobs):
        assert module == "labsid.gap.batches.batch"
        names = ["+".join(os.path.basename(path) for path in task["files"]["records"]) for task in tasks]
        asked.extend(names)
        for number, (task, name) in reversed(list(enumerate(zip(tasks, names, strict=True)))):
            report = gap_report(verdict="none") | {"seed": task["seed"]}
            yield number, None if name.startswith("killed") else {"report": report, "keep": True}

    monkeypatch.setattr(batch, "run_tasks", run_tasks)
    return asked


def summary_of(out):
    with (out / "summary.csv").open(newline="") as file:
        return list(csv.DictReader(file))


# One real run ---------------------------------------------------------------------------------------------


def test_every_record_gets_a_report(finished):
    out, _, _ = finished
    assert sorted(path.name for path in out.iterdir()) == [
        "a.json",
        "b.json",
        "empty.json",
        "summary.csv",
        "summary.html",
        "words.json",
    ]
    answers = {path.stem: json.loads(path.read_text()) for path in out.glob("*.json")}
    assert {answer["schema"] for answer in answers.values()} == {"labsid.gap/4"}
    assert (answers["a"]["verdict"], answers["b"]["verdict"]) == ("none", "none")
    assert answers["a"]["simulation"]["given"]
    assert not answers["b"]["simulation"]["given"]
    assert len(answers["a"]["gap"]["holdout"]) <= 1  # a record of its own, not blocks of this one
    assert len(answers["b"]["gap"]["holdout"]) > 1
    assert answers["a"]["command"].startswith("labsid gap diagnose a.csv --sim a.sim.json --holdout a.holdout")
    assert answers["empty"]["verdict"] == answers["words"]["verdict"] == "error"
    assert "is empty" in answers["empty"]["message"]
    assert "\n" not in answers["words"]["message"]


def test_a_fault_of_the_program_is_said_in_words_and_tried_again(folder, monkeypatch):
    def fails(*records, **how):
        raise ZeroDivisionError("division by\nzero")

    monkeypatch.setattr("labsid.gap.diagnosis.diagnose", fails)
    task = {"files": {"records": [str(folder / "b.csv")], "holdout": [], "sim": []}, "seed": 0, "how": {}}
    found = batch._diagnose(task)
    assert found["report"]["message"] == (
        "labsid failed, and the record is not at fault. Please report this, with the record: "
        "ZeroDivisionError: division by zero"
    )
    assert not found["keep"]


def test_the_table_and_what_is_printed(finished):
    out, printed, told = finished
    rows = summary_of(out)
    assert list(rows[0]) == ["stem", "verdict", "effects", "probability", "closed", "error"]
    assert [row["stem"] for row in rows] == ["a", "b", "empty", "words"]
    closed = json.loads((out / "b.json").read_text())["gap"]["closed"]
    assert {**rows[1], "closed": ""} == dict.fromkeys(rows[1], "") | {"stem": "b", "verdict": "none"}
    assert float(rows[1]["closed"] or "nan") == pytest.approx(np.nan if closed is None else closed, nan_ok=True)
    assert rows[2]["error"] == json.loads((out / "empty.json").read_text())["message"]
    assert printed.startswith("4 records: error 2, none 2\n")
    assert f"  empty: {rows[2]['error']}\n" in printed
    assert printed.endswith(f"Summary: {out / 'summary.csv'}\nPage: {out / 'summary.html'}")
    assert told[0] == ("0 of 4 records", 0.0)
    assert told[-1] == ("4 of 4 records", 1.0)


@pytest.mark.exhaustive  # below, that of a folder of runs equals it
@searched(*FEW)
def test_a_report_equals_that_of_diagnose(finished, folder, tmp_path):
    from labsid.cli.commands import main

    assert main(["gap", "diagnose", str(folder / "b.csv"), "--json", str(tmp_path / "b.json")]) == 0
    answer = json.loads((finished[0] / "b.json").read_text())
    del answer["made_from"]
    alone = json.loads((tmp_path / "b.json").read_text())
    assert alone["command"] == "labsid gap diagnose b.csv --html report.html"
    assert answer == alone


def test_the_summary_page_lists_every_record(finished):
    out, _, _ = finished
    page = (out / "summary.html").read_text(encoding="utf-8")
    assert "4 records: 2 without a gap, 2 not diagnosed" in page
    assert sorted(re.findall(r'href="([^"]*)"', page)) == ["a.json", "b.json", "empty.json", "words.json"]
    assert json.loads((out / "empty.json").read_text())["message"] in page


# What a second run keeps ----------------------------------------------------------------------------------


@pytest.fixture
def copied(finished, folder, tmp_path):
    """Copies of the records and reports that a test may change."""
    shutil.copytree(folder, tmp_path / "records")
    shutil.copytree(finished[0], tmp_path / "out")
    return tmp_path / "records", tmp_path / "out"


def test_a_second_run_keeps_every_report(copied, counted):
    records, out = copied
    before = {path.name: path.stat().st_mtime_ns for path in out.glob("*.json")}
    assert "4 records: error 2, none 2 (4 from an earlier run)" in diagnose_folder(records, out)
    assert counted == []
    assert {path.name: path.stat().st_mtime_ns for path in out.glob("*.json")} == before


@pytest.mark.parametrize(
    ("change", "again"),
    [
        (lambda records, out: (records / "b.csv").open("a").write("\n"), ["b.csv"]),
        (lambda records, out: (records / "a.sim.json").open("a").write("\n"), ["a.csv"]),
        (lambda records, out: (records / "a.holdout.csv").unlink(), ["a.csv"]),
        (lambda records, out: (out / "b.json").unlink(), ["b.csv"]),
        (lambda records, out: (out / "b.json").write_text('{"verdict": "no'), ["b.csv"]),
        (lambda records, out: (out / "b.json").write_text('["none"]'), ["b.csv"]),
    ],
)
@pytest.mark.filterwarnings("ignore::ResourceWarning")
def test_records_with_changed_files_are_diagnosed_again(copied, counted, change, again):
    change(*copied)
    diagnose_folder(*copied)
    assert counted == again


def test_a_second_run_adds_the_missing_pages_of_the_records(copied, counted):
    records, out = copied
    (out / "a.html").touch()
    diagnose_folder(records, out, jobs=1, html=True)
    assert counted == []
    assert sorted(path.name for path in out.glob("*.html")) == ["a.html", "b.html", "summary.html"]
    links = re.findall(r'href="([^"]*)"', (out / "summary.html").read_text(encoding="utf-8"))
    assert sorted(links) == ["a.html", "b.html", "empty.json", "words.json"]
    page = (out / "b.html").read_text(encoding="utf-8")  # `test_batch_page.py`: it is that of the report
    assert "There is no gap beyond noise" in page
    assert page.count('src="data:image/png;base64,') > 2


def test_a_record_whose_page_would_be_the_summary(tmp_path):
    (tmp_path / "Summary.mat").touch()
    with pytest.raises(ValueError, match=r"page of Summary would replace summary\.html\. Rename the record"):
        diagnose_folder(tmp_path, tmp_path / "out", html=True)


def test_another_seed_or_version_starts_anew(copied, counted, monkeypatch):
    diagnose_folder(*copied, seed=1)
    assert counted == ["a.csv", "b.csv", "empty.csv", "words.csv"]
    assert json.loads((copied[1] / "b.json").read_text())["seed"] == 1
    counted.clear()
    monkeypatch.setattr(batch, "sources_version", lambda: "another")
    diagnose_folder(*copied, seed=1)
    assert len(counted) == 4


def test_a_killed_record_is_an_error_that_the_next_run_tries_again(tmp_path, counted):
    for name in ("killed.csv", "other.csv"):
        (tmp_path / name).write_text("t,u,y\n")
    out = tmp_path / "out"
    diagnose_folder(tmp_path, out)
    answer = json.loads((out / "killed.json").read_text())
    assert answer == {
        "schema": "labsid.gap/4",
        "verdict": "error",
        "message": "the process was killed 2 times, possibly for lack of memory.",
    }
    diagnose_folder(tmp_path, out)
    assert counted == ["killed.csv", "other.csv", "killed.csv"]


def test_effects_and_figures_in_the_table(tmp_path, monkeypatch):
    (tmp_path / "pair.csv").touch()
    effects = [{"name": "input-delay", "probability": 0.98765432}, {"name": "load-step", "probability": 0.5}]
    report = gap_report("input-delay") | {"effects": effects}
    report["gap"]["closed"] = 0.75
    monkeypatch.setattr(batch, "run_tasks", lambda *_: (x for x in [(0, {"report": report, "keep": True})]))
    printed = diagnose_folder(tmp_path, tmp_path / "out")
    assert (tmp_path / "out" / "summary.csv").read_text().splitlines()[1] == (
        "pair,effect,input-delay+load-step,0.987654,0.75,"
    )
    assert "     1  input-delay+load-step\n" in printed


# Folders of runs ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def fleet(tmp_path_factory, rig_record, write_rig_record):
    """A record, a rig with two runs and a simulation, a rig with one run, and one with an invalid run."""
    folder = tmp_path_factory.mktemp("fleet")
    write_rig_record(folder / "alone.csv", rig_record("none", SAMPLES))
    for name, seeds in {"rig-01": (4, 5), "rig.2": (6,), "rig-03": (7,)}.items():
        (folder / name).mkdir()
        for seed in seeds:
            write_rig_record(folder / name / f"run-{seed}.csv", rig_record("none", SAMPLES, seed=seed))
    (folder / "rig-03" / "words.csv").write_text("t,u,y\n1,2,three\n")
    return folder


@pytest.fixture(scope="module")
def fleet_out(fleet, tmp_path_factory):
    """The folder of reports, and the summary printed; diagnosed in this process by a search for few effects."""
    out = tmp_path_factory.mktemp("fleet-out")
    with searched(*FEW), pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch, "run_tasks", run_here)
        return out, diagnose_folder(fleet, out, jobs=1)


@searched(*FEW)
def test_a_folder_of_runs_is_one_rig(fleet, fleet_out, tmp_path):
    from labsid.cli.commands import main

    out, printed = fleet_out
    assert [row["stem"] for row in summary_of(out)] == ["alone", "rig-01", "rig-03", "rig.2"]
    assert printed.startswith("4 records and rigs: error 1, none 3\n")
    runs = [str(fleet / "rig-01" / f"run-{seed}.csv") for seed in (4, 5)]
    assert main(["gap", "diagnose", *runs, "--json", str(tmp_path / "rig.json")]) == 0
    together, alone = (json.loads(path.read_text()) for path in (out / "rig-01.json", tmp_path / "rig.json"))
    assert [row["name"] for row in together["records"]] == ["run-4", "run-5"]
    del together["made_from"], alone["command"]
    assert together.pop("command") == "labsid gap diagnose rig-01/run-4.csv rig-01/run-5.csv --html report.html"
    assert together == alone
    assert "records" not in json.loads((out / "rig.2.json").read_text())
    assert json.loads((out / "rig-03.json").read_text())["message"].startswith("words.csv: ")
    page = (out / "summary.html").read_text(encoding="utf-8")
    assert "4 records and rigs: 3 without a gap, 1 not diagnosed" in page
    assert page.count("2 runs") == 1


@pytest.mark.parametrize(
    ("change", "again"),
    [
        (lambda fleet: None, []),
        (lambda fleet: (fleet / "rig-01" / "run-5.csv").open("a").write("\n"), ["run-4.csv+run-5.csv"]),
        (lambda fleet: (fleet / "rig-01" / "run-5.csv").unlink(), ["run-4.csv"]),
        (lambda fleet: (fleet / "rig-01" / "run-4.csv").rename(fleet / "rig-01" / "x.csv"), ["run-5.csv+x.csv"]),
        (lambda fleet: (fleet / "rig-01.sim.json").touch(), ["run-4.csv+run-5.csv"]),
        (lambda fleet: (fleet / "rig.2.holdout.csv").touch(), ["run-6.csv"]),
    ],
)
@pytest.mark.filterwarnings("ignore::ResourceWarning")
def test_rigs_with_changed_files_are_diagnosed_again(fleet, fleet_out, tmp_path, counted, change, again):
    shutil.copytree(fleet, tmp_path / "fleet")
    shutil.copytree(fleet_out[0], tmp_path / "out")
    change(tmp_path / "fleet")
    diagnose_folder(tmp_path / "fleet", tmp_path / "out")
    assert counted == again


# Ctrl-C ---------------------------------------------------------------------------------------------------


@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C cannot be sent to one process there")
def test_an_interrupted_run_keeps_finished_reports(tmp_path, rig_record, write_rig_record):
    for number in range(6):
        write_rig_record(tmp_path / f"r{number}.csv", rig_record("none", SAMPLES, seed=number))
    out = tmp_path / "out"
    command = [*LABSID, "gap", "batch", str(tmp_path), "--out", str(out), "--jobs", "1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        for _ in range(1200):
            if list(out.glob("*.json")):
                break
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        printed, said = process.communicate(timeout=60)
    assert (process.returncode, printed) == (2, "")
    *progress, last = said.splitlines()
    assert last == f"labsid: error: interrupted; the finished reports are in {out}. Run the command again to continue."
    assert progress[0] == "0 of 6 records"
    assert all(line.endswith("of 6 records") for line in progress)
    kept = sorted(out.iterdir())
    assert 1 <= len(kept) < 6
    assert all(json.loads(path.read_text())["verdict"] == "none" for path in kept)


def test_no_name_of_a_file_is_a_formula_in_the_summary():
    reports = {name: gap_report(verdict="none") for name in ("=cmd|' /C calc'!A0", "-1+2", "plain")}
    rows = list(csv.DictReader(csv_summary(reports).splitlines()))
    assert [row["stem"] for row in rows] == ["'-1+2", "'=cmd|' /C calc'!A0", "plain"]
