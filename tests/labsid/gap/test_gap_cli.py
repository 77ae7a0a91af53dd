"""The command line of `labsid gap`: the files written, and one-line errors with exit status 2."""

import json
import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gap_search import limits_of, searched

from labsid.cli.commands import main
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.gap.simulations.simulation_files import load_simulation
from labsid.records.record import Record, load_record

ROOT = Path(__file__).resolve().parents[3]
DEN = np.poly([0.95, 0.8]).tolist()
FEW = ("input-delay", "input-saturation", "extra-lag", "output-saturation", "load-step")


@pytest.fixture
def labsid(capsys, tmp_path, monkeypatch):
    """Run the command in a scratch folder: status, standard output, standard error. It searches for few effects."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        with searched(*FEW):
            status = main(["gap", *map(str, arguments)])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


@pytest.fixture
def refused(labsid):
    """Run the command and expect exit status 2 with one line that contains `words`."""

    def run(words, *arguments):
        status, out, err = labsid(*arguments)
        assert (status, out) == (2, "")
        assert err.startswith("labsid: error: ")
        assert err.count("\n") == 1
        assert words in err

    return run


@pytest.fixture(scope="module")
def plain(rig_record):
    return rig_record("none", 200)


@pytest.fixture
def record(plain, tmp_path, write_rig_record):
    return write_rig_record(tmp_path / "record.csv", plain)


@pytest.fixture
def written(tmp_path, write_rig_record, plain):
    """Write a record with changed columns, also ones that `Record` would reject."""

    def write(**changed):
        columns = {name: changed.get(name, getattr(plain, name)) for name in ("t", "u", "y")}
        lines = [",".join(map(repr, row)) for row in np.column_stack(list(columns.values())).tolist()]
        path = tmp_path / "changed.csv"
        path.write_text("\n".join(["t,u,y", *lines]))
        return path

    return write


# What is explained ----------------------------------------------------------------------------------------


def test_why_follows_the_report_and_changes_nothing(labsid, record, tmp_path):
    """`--why` prints the gates after the same report; the JSON, its command line included, is the same."""
    status, plain, err = labsid("diagnose", record, "--json", "plain.json")
    explained = labsid("diagnose", record, "--why", "--json", "why.json")
    assert (status, err, explained[0], explained[2]) == (0, "", 0, "")
    assert explained[1].startswith(plain)
    assert "[verdict/decision.MIN_CONFIDENCE]" in explained[1].removeprefix(plain)
    assert explained[1].rstrip().endswith("Verdict none: no gap beyond noise.")
    assert (tmp_path / "why.json").read_text() == (tmp_path / "plain.json").read_text()


def test_why_is_refused_for_several_signals(refused, tmp_path):
    """In one line, before the search, with what to type instead."""
    rows = np.random.default_rng(0).standard_normal((100, 3)).tolist()
    lines = [",".join(map(repr, [0.1 * k, *row])) for k, row in enumerate(rows)]
    (tmp_path / "two.csv").write_text("\n".join(["t,u1,u2,y", *lines]))
    refused("Choose one of each by --inputs and --outputs, or omit --why", "diagnose", "two.csv", "--why")


def test_the_diagnosis_of_the_readme_runs_as_printed(capsys, monkeypatch):
    """The first command of the README prints the text beneath it: the same words, and numbers within 2 %."""
    monkeypatch.chdir(ROOT)
    section = (ROOT / "README.md").read_text(encoding="utf-8").partition("## One diagnosis")[2]
    (command,) = re.findall(r"^    \.venv/bin/labsid (.*)$", section.partition("\n## ")[0], re.M)
    (printed,) = re.findall(r"```text\n(.*?)```", section.partition("\n## ")[0], re.S)
    assert main(shlex.split(command)) == 0
    begins = capsys.readouterr().out.splitlines()[: printed.count("\n")]
    number = r"-?\d+(?:\.\d+)?"
    texts = (printed.rstrip(), "\n".join(begins))
    words = [re.sub(number, "#", text).split() for text in texts]
    stated, found = ([float(value) for value in re.findall(number, text)] for text in texts)
    assert words[0] == words[1]
    assert found == pytest.approx(stated, rel=0.02)


# What is written ------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("undrawn")
def test_simulate_runs_the_exported_model(labsid, record, tmp_path):
    status, out, err = labsid("diagnose", record, "--json", "a.json", "--export", "better.json", "--html", "a.html")
    assert (status, err) == (0, "")
    assert out.strip()
    answer = json.loads((tmp_path / "a.json").read_text())
    assert (answer["schema"], answer["verdict"]) == ("labsid.gap/4", "none")
    assert (tmp_path / "a.html").read_text().lstrip().lower().startswith("<!doctype html>")
    status, out, err = labsid("simulate", "better.json", record, "--out", "played.csv")
    assert (status, err) == (0, "")
    table = np.genfromtxt(tmp_path / "played.csv", delimiter=",", names=True)
    assert table.dtype.names == ("t", "u", "y", "y_sim")
    rmse = float(np.sqrt(np.mean((table["y"] - table["y_sim"])[50:] ** 2)))
    assert out == f"200 samples, free run: rmse {rmse:.6g} after the first 50 samples\n"
    assert rmse == pytest.approx(answer["gap"]["after"], rel=0.3)


@pytest.mark.usefixtures("undrawn")
def test_a_record_without_its_first_outputs_is_simulated_from_its_first_one(labsid, plain, tmp_path):
    """The state would be estimated from outputs that are not there; a simulated output is cut like the record."""
    (tmp_path / "model.json").write_text(json.dumps({"num": [0.5], "den": [1.0, -1.0], "dt": plain.Ts}))
    rows = list(zip(plain.t.tolist(), plain.u.tolist(), (0.5 * np.cumsum(plain.u)).tolist(), strict=True))
    late = [f"{t},{u},{y if k >= 60 else ''}" for k, (t, u, y) in enumerate(rows)]
    (tmp_path / "late.csv").write_text("\n".join(["t,u,y", *late]))
    (tmp_path / "sim.csv").write_text("\n".join(["t,y", *(f"{t},{y}" for t, _, y in rows)]))
    status, out, err = labsid("simulate", "model.json", "late.csv")
    assert (status, err) == (0, "")
    assert out.startswith("140 samples, free run: rmse 0.")
    assert "note: y is missing in the first 60 samples; these are left out.\n" in out
    simulated = load_simulation("sim.csv", load_record("late.csv"))
    assert isinstance(simulated, SimulatedOutput)
    np.testing.assert_allclose(simulated.y, [y for *_, y in rows[60:]])


def test_the_report_contains_the_command_that_reproduces_it(labsid, record, tmp_path):
    """Files appear by name and output options are omitted, so the report does not depend on the folder."""
    arguments = ("--exclude", "5:6", "--exclude", "7:8.5", "--seed", "3", "--order", "1", "--Ts", "0.5")
    assert labsid("diagnose", record, *arguments, "--json", "a.json")[0] == 0
    said = json.loads((tmp_path / "a.json").read_text())["command"]
    assert said.startswith("labsid gap diagnose record.csv --")
    assert sorted(shlex.split(said)[4:]) == sorted([*arguments, "--html", "report.html"])


def test_two_processes_give_the_same_answer(tmp_path, monkeypatch, rig_record, write_rig_record):
    """The hash seed does not change the report: that of this process is hardly ever the other one."""
    monkeypatch.chdir(tmp_path)
    write_rig_record(tmp_path / "record.csv", rig_record("input-saturation", 200))
    one, two = (
        ["gap", "diagnose", "record.csv", "--json", f"{k}.json", "--export", f"better-{k}.json"] for k in (1, 2)
    )
    assert main(one) == 0
    command = [sys.executable, "-c", "import sys; from labsid.cli.commands import main; sys.exit(main())", *two]
    seed = "1" if os.environ.get("PYTHONHASHSEED") == "2" else "2"
    environment = os.environ | {"PYTHONHASHSEED": seed}
    subprocess.run(command, cwd=tmp_path, env=environment, check=True, stdout=subprocess.DEVNULL)
    assert json.loads((tmp_path / "1.json").read_text())["verdict"] == "effect"
    for name in ("{}.json", "better-{}.json"):
        assert (tmp_path / name.format(1)).read_bytes() == (tmp_path / name.format(2)).read_bytes()


def test_excluded_stretches_are_neither_fitted_nor_scored(labsid, plain, written, tmp_path):
    y = plain.y.copy()
    y[80:110] += 3.0
    path = written(y=y)
    assert labsid("diagnose", path, "--exclude", "40:55", "--json", "a.json")[0] == 0
    assert json.loads((tmp_path / "a.json").read_text())["verdict"] == "none"


# Records that cannot be diagnosed -------------------------------------------------------------------------


def test_invalid_record_files(refused, tmp_path):
    (tmp_path / "empty.csv").touch()
    (tmp_path / "noise.csv").write_bytes(bytes(range(256)) * 8)
    (tmp_path / "head.csv").write_text("t,u,y\n")
    for words, name in (
        ("empty.csv: it is empty", "empty.csv"),
        ("neither a MAT-file nor text", "noise.csv"),
        ("no data under it", "head.csv"),
        ("No such file", "none.csv"),
        ("Is a directory", "."),
    ):
        refused(words, "diagnose", name)


def with_one(values, k, value):
    values = values.copy()
    values[k] = value
    return values


@pytest.mark.parametrize(
    ("words", "changed"),
    [
        ("y must be finite; got inf at sample 50", lambda r: {"y": with_one(r.y, 50, np.inf)}),
        ("u of the record is constant (2)", lambda r: {"u": np.full(200, 2.0)}),
        ("y of the record is constant (1)", lambda r: {"y": np.ones(200)}),
        ("has 10 samples; a diagnosis needs at least 100", lambda r: {name: getattr(r, name)[:10] for name in "tuy"}),
        ("--resample", lambda r: {"t": r.t + 0.2 * np.sin(np.arange(200.0))}),
        ("has 40 samples; a diagnosis needs at least 100", lambda r: {"y": r.y[np.arange(200) // 5 * 5]}),
    ],
)
def test_records_that_cannot_be_diagnosed(refused, written, plain, words, changed):
    refused(words, "diagnose", written(**changed(plain)))


@pytest.mark.parametrize(
    ("words", "changed"),
    [
        ("the holdout runs at 1 s, the record at 0.5 s", lambda r: {"t": 2.0 * r.t}),
        ("the holdout has 59 samples", lambda r: {name: getattr(r, name)[:59] for name in "tuy"}),
        ("y must be finite", lambda r: {"y": with_one(r.y, 3, np.inf)}),
    ],
)
def test_holdouts_that_do_not_fit(refused, record, written, plain, words, changed):
    refused(words, "diagnose", record, "--holdout", written(**changed(plain)))


@pytest.mark.parametrize(
    "changed",
    [
        lambda r: {"u": np.full(200, r.u[0]), "y": np.full(200, r.y[0])},
        lambda r: {name: getattr(r, name)[:60] for name in "tuy"},
    ],
    ids=["at rest", "60 samples"],
)
def test_a_holdout_is_only_scored(labsid, record, written, plain, changed):
    status, out, err = labsid("diagnose", record, "--holdout", written(**changed(plain)))
    assert (status, err) == (0, "")
    assert "nan" not in re.findall(r"\w+", out)


# Options --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("stretch", ["nonsense", "5", "5:", ":", "5:3", "nan:3"])
def test_invalid_stretches(refused, record, stretch):
    refused(
        f"--exclude must be T0:T1 in seconds with T0 < T1; got '{stretch}'", "diagnose", record, "--exclude", stretch
    )


def test_invalid_options(refused, record):
    refused("--exclude leaves 0 samples", "diagnose", record, "--exclude", "0:1000")
    refused("--exclude leaves 50 samples", "diagnose", record, "--exclude", "25:100")
    refused(
        "--exclude 1000:2000 contains no sample: the record runs from 0 to 99.5 s",
        "diagnose",
        record,
        "--exclude",
        "1000:2000",
    )
    refused("--order must be at least 1; got 0", "diagnose", record, "--order", "0")
    refused("--order must be at most 4; got 5", "diagnose", record, "--order", "5")
    refused("--seed", "diagnose", record, "--seed", "-1")
    refused("--jobs", "batch", ".", "--out", "out", "--jobs", "0")


def test_outputs_that_cannot_be_written(refused, record, tmp_path):
    for option in ("--json", "--html", "--export"):
        refused("no such folder", "diagnose", record, option, tmp_path / "nowhere" / "a.json")
        refused("it is a folder", "diagnose", record, option, ".")
        refused("record.csv is named twice", "diagnose", record, option, record)
    refused("a.json is named twice", "diagnose", record, "--json", "a.json", "--export", "./a.json")
    (tmp_path / "better.json").write_text(json.dumps({"num": [0.01], "den": DEN, "dt": 0.5}))
    refused("it is a folder", "simulate", "better.json", record, "--out", ".")
    refused("File exists", "batch", ".", "--out", record)


def test_folders_without_records(refused, record, tmp_path):
    refused("No such file or directory", "batch", "nowhere", "--out", "out")
    refused("Not a directory", "batch", record, "--out", "out")
    (tmp_path / "bare").mkdir()
    refused("bare holds no records (.csv, .mat or another format of logs)", "batch", "bare", "--out", "out")
    assert not os.path.exists(tmp_path / "out")


# Simulations ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["diagnose", "simulate"])
@pytest.mark.parametrize(
    ("words", "content"),
    [
        ("not JSON", "{"),
        ("must hold a JSON object; got list", "[]"),
        ("the model has no 'num'", "{}"),
        ("dt must be the record's sampling time 0.5 s; got 0.25 s", {"dt": 0.25}),
        ("the model must be proper", {"num": [1.0, 0.0, 0.0, 0.0]}),
        ("den must begin with the highest power of z", {"den": [0.0, *DEN]}),
        ("lists of finite numbers", {"num": []}),
        ("the simulation is unstable on this record", {"den": [1.0, -2.5, 1.0]}),
    ],
)
def test_invalid_models(refused, record, tmp_path, command, words, content):
    if isinstance(content, dict):
        content = json.dumps({"num": [0.01], "den": DEN, "dt": 0.5} | content)
    (tmp_path / "model.json").write_text(content)
    arguments = (record, "--sim", "model.json") if command == "diagnose" else ("model.json", record)
    refused(words, command, *arguments)


def test_simulated_outputs_at_other_times(refused, record, plain, tmp_path):
    series = tmp_path / "sim.csv"
    for t, head, words in (
        (plain.t + 1.0, "t,y", "must hold the output at all times of the record"),
        (plain.t[:-2], "t,y", "got 0 to 98.5 s"),
        (plain.t, "time,y", "with the header t,y"),
    ):
        np.savetxt(series, np.column_stack([t, plain.y[: t.size]]), delimiter=",", header=head, comments="")
        refused(words, "diagnose", record, "--sim", series)
    np.savetxt(series, np.column_stack([plain.t, plain.y]), delimiter=",", header="t,y", comments="")
    refused("known on its own record only", "diagnose", record, "--sim", series, "--holdout", record)
    refused("not JSON", "simulate", series, record)


def test_an_exported_simulation_of_another_sampling_time(labsid, refused, record, plain, tmp_path, write_rig_record):
    assert labsid("diagnose", record, "--export", "better.json")[0] == 0
    other = Record(2.0 * plain.t, plain.u, plain.y, 1.0)
    write_rig_record(tmp_path / "other.csv", other)
    words = "the simulation runs at 0.5 s, the record at 1 s"
    refused(words, "simulate", "better.json", "other.csv")
    refused(words, "diagnose", "other.csv", "--sim", "better.json")


def test_a_sealed_check_that_is_terminated_ends_as_if_interrupted(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """So that it ends the batch that it has started."""

    def terminated(**options: Any) -> int:
        signal.raise_signal(signal.SIGTERM)
        return 0

    monkeypatch.setattr("labsid.blind.check.run_sealed_check", terminated)
    before = signal.getsignal(signal.SIGTERM)
    try:
        assert main(["gap", "blind"]) == 2
    finally:
        signal.signal(signal.SIGTERM, before)
    assert capsys.readouterr().err.endswith("interrupted\n")


# Limits ---------------------------------------------------------------------------------------------------


@pytest.fixture
def planned(tmp_path):
    """Write a planned input, t,u, that has been changed."""

    def write(u=None, Ts=0.5, header="t,u"):
        u = np.repeat([1.0, 3.0, 2.0, 4.0], 50) if u is None else u
        rows = [f"{Ts * k!r},{float(value)!r}" for k, value in enumerate(u)]
        path = tmp_path / "next.csv"
        path.write_text("\n".join([header, *rows]))
        return path

    return write


def test_limits_of_a_record_and_of_a_planned_input(labsid, record, planned, tmp_path):
    status, out, _ = labsid("limits", record, "--json", tmp_path / "limits.json", "--units", "V,mm")
    assert status == 0
    assert "record: 200 samples, verdict none. What the record can show:" in out
    found = json.loads((tmp_path / "limits.json").read_text())
    assert (found["schema"], found["planned"], found["verdict"]) == ("labsid.gap.limits/1", False, "none")
    assert found["units"] == {"u": "V", "y": "mm"}
    keys = {"name", "signal", "parameter", "unit", "detect", "named", "rival", "excluded_above", "why", "tested"}
    assert all(keys <= set(row) for row in found["limits"])
    assert any(row["excluded_above"] is not None for row in found["limits"])

    status, out, _ = labsid("limits", record, "--input", planned(), "--json", tmp_path / "planned.json")
    assert status == 0
    assert "What a record with the planned input can show:" in " ".join(out.split())
    later = json.loads((tmp_path / "planned.json").read_text())
    assert later["planned"]
    assert all(row["excluded_above"] is None for row in later["limits"])
    assert any(row["detect"] is not None for row in later["limits"])


@searched(*FEW)
def test_planted_effects_are_counted(record, tmp_path):
    """Of the effects that the search of these tests has, most of the planted ones are named."""
    with limits_of("load-step"):
        assert main(["gap", "limits", str(record), "--test", "2", "--json", str(tmp_path / "limits.json")]) == 0
    (row,) = json.loads((tmp_path / "limits.json").read_text())["limits"]
    assert row["tested"]["of"] == 2
    assert row["tested"]["named"] >= 1


def test_planned_inputs_that_do_not_fit(refused, record, planned, tmp_path):
    for words, changes in (
        ("the planned input runs at 1 s, the record at 0.5 s. Resample the input.", {"Ts": 1.0}),
        ("the planned input has 60 samples; at least 100 are needed", {"u": np.arange(60.0)}),
        ("the planned input is constant (2)", {"u": np.full(200, 2.0)}),
        ("must be finite", {"u": with_one(np.arange(200.0), 50, np.nan)}),
        ("next.csv: ", {"header": "t,v"}),
    ):
        refused(words, "limits", record, "--input", planned(**changes))
    refused("No such file", "limits", record, "--input", "none.csv")
    refused("is named twice", "limits", record, "--input", planned(), "--json", tmp_path / "next.csv")
    refused("--test", "limits", record, "--test", "-1")
