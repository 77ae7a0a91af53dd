"""Which files and folders of a batch are records, rigs, simulations and holdouts."""

import shlex

import pytest

from labsid.cli.commands import main
from labsid.gap.batches.batch_files import command_of, find_records, find_runs, make_job, nouns
from labsid.records.reading import Reading


def test_find_records(tmp_path):
    names = "b.csv B2.CSV a.mat a.sim.json a.sim.csv a.holdout.csv c.holdout.mat .hidden.csv notes.txt summary.csv"
    for name in names.split():
        (tmp_path / name).touch()
    (tmp_path / "folder.csv").mkdir()
    assert [path.name for path in find_records(tmp_path, tmp_path / "out")] == [
        "B2.CSV",
        "a.mat",
        "b.csv",
        "summary.csv",
    ]
    assert [path.name for path in find_records(tmp_path, tmp_path)] == ["B2.CSV", "a.mat", "b.csv"]


def test_two_records_of_one_name_and_none_at_all(tmp_path):
    with pytest.raises(
        ValueError, match=r"holds no records \(\.csv, \.mat or another format of logs\), nor a folder of them"
    ):
        find_records(tmp_path, tmp_path)
    (tmp_path / "a.csv").touch()
    (tmp_path / "a.mat").touch()
    with pytest.raises(ValueError, match=r"a\.csv and a\.mat would share the report a\.json\. Rename"):
        find_records(tmp_path, tmp_path)


# Folders of runs ------------------------------------------------------------------------------------------


@pytest.fixture
def fleet(tmp_path):
    """A record, two rigs, and folders that hold no records."""
    names = "alone.csv rig.1/b.csv rig.1/a.mat rig.1/a.holdout.csv rig.1/notes.txt rig-2/x.csv "
    names += ".hidden/a.csv notes/readme.txt deep/er/a.csv rig.1.sim.json rig.1.holdout.mat alone.sim.json"
    for name in names.split():
        (tmp_path / name).parent.mkdir(exist_ok=True, parents=True)
        (tmp_path / name).touch()
    return tmp_path


def test_folders_with_records_are_rigs(fleet):
    found = find_records(fleet, fleet / "out")
    assert [path.name for path in found] == ["alone.csv", "rig-2", "rig.1"]
    assert [path.name for path in find_runs(fleet / "rig.1", fleet / "out")] == ["a.holdout.csv", "a.mat", "b.csv"]
    assert nouns(found) == ("record or rig", "records and rigs")
    assert nouns(found[1:]) == ("rig", "rigs")
    assert nouns(found[:1]) == ("record", "records")


def test_the_files_of_a_rig(fleet):
    job = make_job(fleet / "rig.1", fleet / "out", "1")
    assert (job.stem, job.report) == ("rig.1", fleet / "out" / "rig.1.json")
    assert job.files == {
        "records": [str(fleet / "rig.1" / name) for name in ("a.holdout.csv", "a.mat", "b.csv")],
        "sim": [str(fleet / "rig.1.sim.json")],
        "holdout": [str(fleet / "rig.1.holdout.mat")],
    }
    assert make_job(fleet / "rig.1", fleet / "out", "2").key != job.key
    alone = make_job(fleet / "alone.csv", fleet / "out", "1").files
    assert alone == {"records": [str(fleet / "alone.csv")], "sim": [str(fleet / "alone.sim.json")], "holdout": []}


def test_reports_in_the_folder_are_not_a_rig(fleet):
    (fleet / "out").mkdir()
    (fleet / "out" / "any.csv").touch()
    assert "out" not in [path.name for path in find_records(fleet, fleet / "out")]
    (fleet / "earlier").mkdir()
    (fleet / "earlier" / "summary.csv").write_text("stem,verdict,effects,probability,closed,error\n", encoding="utf-8")
    assert "earlier" not in [path.name for path in find_records(fleet, fleet / "out")]
    (fleet / "earlier" / "summary.csv").write_text("t,u,y\n", encoding="utf-8")
    assert "earlier" in [path.name for path in find_records(fleet, fleet / "out")]


def test_a_folder_with_the_name_of_a_record(fleet):
    (fleet / "rig-2.csv").touch()
    with pytest.raises(ValueError, match=r"rig-2 and rig-2\.csv would share the report rig-2\.json\. Rename one"):
        find_records(fleet, fleet / "out")


def test_a_simulation_among_the_runs(fleet):
    (fleet / "rig-2" / "x.sim.csv").touch()
    with pytest.raises(
        ValueError, match=r"x\.sim\.csv is in a folder of runs, .*beside the folder, as rig-2\.sim\.csv"
    ):
        find_records(fleet, fleet / "out")


# The command that repeats a job ---------------------------------------------------------------------------


def test_the_command_of_a_job_names_its_files_and_what_is_not_the_default(fleet):
    job = make_job(fleet / "rig.1", fleet / "out", "")
    said = command_of(job, fleet, 3, Reading(since=2.5, output="measured", decimate=2))
    files = "rig.1/a.holdout.csv rig.1/a.mat rig.1/b.csv --sim rig.1.sim.json --holdout rig.1.holdout.mat --seed 3"
    assert said == f"labsid gap diagnose {files} --LogData measured --from 2.5 --decimate 2 --html report.html"
    plain = make_job(fleet / "rig-2", fleet / "out", "")
    assert command_of(plain, fleet, 0, Reading()) == "labsid gap diagnose rig-2/x.csv --html report.html"


@pytest.mark.parametrize("name", ["-dash.csv", "it's <b>&$(x).csv", "100 %.csv"])
def test_the_command_works_as_printed_with_any_name(tmp_path, monkeypatch, capsys, name):
    (tmp_path / name).write_text("t,u,y\n0,1,2\n", encoding="utf-8")
    job = make_job(tmp_path / name, tmp_path / "out", "")
    monkeypatch.chdir(tmp_path)
    words = shlex.split(command_of(job, tmp_path, 1, Reading(Ts=0.5, time_unit="ms")))
    assert main(words[1:]) == 2
    error = capsys.readouterr().err
    assert "at least 2 samples" in error or "samples; got 1" in error, error
