"""The command as a user meets it: exit status, one line on stderr, what is printed and written."""

import importlib.metadata
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import typer
from scipy.io import savemat

from labsid import __version__
from labsid.records.record import load_record

LABSID = [sys.executable, "-c", "import sys; from labsid.cli.commands import main; sys.exit(main())"]


@pytest.fixture
def refused(labsid):
    """Run what must end with status 2 and one clear line; gives the line and what was printed before."""

    def run(*arguments):
        status, out, err = labsid(*arguments)
        assert status == 2
        assert err.startswith("labsid: error: ")
        assert err.count("\n") == 1
        assert "Traceback" not in err
        assert "usable for the lab: yes" not in out
        return err, out

    return run


@pytest.fixture
def tank(write_log, staircase):
    s = staircase
    return write_log(s["t"][:, None], np.column_stack([s["measured"], s["y"]]), s["u"][:, None], file="tank.mat")


def as_csv(t, u, y):
    return "t,u,y\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in np.column_stack([t, u, y]).tolist())


# Worked values --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "theta", "mse", "condition"),
    [
        (
            ["--order", "2", "--start", "2"],
            [1.37746171, -0.39246554, -0.00666983, 0.05140205],
            {"all": "8.9450e-04", "second_half": "2.31725e-02", "second_half_carried": "1.24894e-03"},
            "269.75",
        ),
        (["--order", "1", "--start", "1"], [0.9775761, 0.06811909], {"all": "9.2428e-04"}, None),
        (["--order", "1"], None, {"all": "9.2421e-04"}, None),
    ],
)
def test_the_worked_values_of_the_labs_file(labsid, shared_data, tmp_path, options, theta, mse, condition):
    record, out = shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat", tmp_path / "out.json"
    status, text, err = labsid("identify", record, *options, "--json", out)
    assert (status, err) == (0, "")
    found = json.loads(out.read_text())
    assert (found["Ts"], found["samples"], found["settled"], found["u_offset"]) == (0.75, 903, [0, 51], 2.0)
    assert f"{found['y_offset']:.8f}" == "2.32781863"
    if theta is not None:
        assert [float(f"{value:.8f}") for value in found["theta"]] == theta
        printed = [float(number) for number in re.findall(r"^  -?[ab]\d +(\S+) +± ", text, re.MULTILINE)]
        assert printed == pytest.approx(theta, rel=0.05)
    for name, printed in mse.items():
        digits = len(printed.split("e")[0]) - 2
        assert f"{found['mse'][name]:.{digits}e}" == printed
    if condition is not None:
        assert f"{found['condition_number']:.2f}" == condition


def test_identify_writes_the_fixed_keys(labsid, tank, tmp_path):
    out, model = tmp_path / "out.json", tmp_path / "model.json"
    status, _, err = labsid("identify", tank, "--json", out, "--model", model)
    assert (status, err) == (0, "")
    found = json.loads(out.read_text())
    assert list(found) == [
        "Ts", "samples", "u_offset", "y_offset", "settled", "order", "theta", "a", "b", "poles", "mse",
        "condition_number",
    ]  # fmt: skip
    assert list(found["mse"]) == ["all", "second_half", "second_half_carried"]
    assert found["a"] == [1.0, -found["theta"][0], -found["theta"][1]]
    assert found["b"] == found["theta"][2:]
    np.testing.assert_allclose(np.poly([complex(*pole) for pole in found["poles"]]), found["a"], atol=1e-12)
    written = json.loads(model.read_text())
    assert written == {
        "num": [0.0, *found["b"]], "den": found["a"], "dt": 0.75, "u0": 2.0, "y0": found["y_offset"]
    }  # fmt: skip


def test_output_measured_and_other_layouts(labsid, tank, write_text, staircase, tmp_path):
    s = staircase
    results = []
    for arguments in (
        [tank, "--LogData", "measured"],
        [write_text(as_csv(s["t"], s["u"], s["measured"]))],
        [write_text(as_csv(s["t"], s["u"], s["measured"]), "b.txt"), "--columns", "2,y", "--Ts", "0.75"],
    ):
        assert labsid("identify", *arguments, "--json", tmp_path / "out.json")[0] == 0
        results.append((tmp_path / "out.json").read_text())
    assert results[0] == results[1] == results[2]
    labsid("identify", tank, "--json", tmp_path / "out.json")
    assert (tmp_path / "out.json").read_text() != results[0]


def test_the_former_name_of_an_option_works_and_says_the_new_one(labsid, tank, tmp_path):
    results = []
    for option in ("--LogData", "--output"):
        status, _, error = labsid("identify", tank, option, "measured", "--json", tmp_path / "out.json")
        assert status == 0
        results.append((tmp_path / "out.json").read_text())
    assert results[0] == results[1]
    assert error == "note: --output is now --LogData\n"
    assert "--output" not in labsid("identify", "--help")[1].replace("--outputs", "")


@pytest.mark.parametrize(
    ("record", "options", "status"),
    [
        ("unsw-water-tank/SysIdenData_StudentVersion.mat", [], 0),
        ("unsw-water-tank/SysIdenData_4.mat", [], 0),
        ("unsw-water-tank/SysIdenData_8.mat", ["--LogData", "measured"], 0),
        ("unsw-water-tank/SFControlData_0.mat", [], 0),
        ("hair-dryer/dryer.dat", ["--columns", "u,y", "--Ts", "0.08"], 0),
        ("hair-dryer/dryer.dat", ["--columns", "1,2", "--Ts", "0.08"], 0),
        ("cascaded-tanks/dataBenchmark.csv", ["--columns", "uEst,yEst", "--Ts", "4"], 0),
        ("cascaded-tanks/dataBenchmark.csv", [], 2),
    ],
)
def test_the_real_records_through_both_commands(labsid, shared_data, record, options, status):
    for command in ("check", "identify"):
        found, out, err = labsid(command, shared_data / record, *options)
        assert found == status
        assert bool(err) == bool(status)
        assert bool(out) == (not status or command == "check")  # check also describes what it refuses


def test_the_settled_part_of_the_empty_tank_starts(labsid, shared_data, tmp_path):
    for number, level, first in ((4, 2.423, 308), (8, 2.806, 240)):
        record = shared_data / "unsw-water-tank" / f"SysIdenData_{number}.mat"
        status, out, _ = labsid("identify", record, "--json", tmp_path / "out.json")
        found = json.loads((tmp_path / "out.json").read_text())
        assert status == 0
        assert found["y_offset"] == pytest.approx(level, abs=0.012)
        assert found["settled"][0] > 100
        assert found["settled"][1] == first
        assert "Warning: the record does not start at rest" in out


# Bad input ------------------------------------------------------------------------------------------------


def bad_files(folder: Path, s: dict) -> dict[str, tuple[Path, str]]:
    """Each bad input of the lab, and what its line must say."""
    n = 600

    outputs = np.column_stack([s["measured"], s["y"]])

    def log(name, time=s["t"][:, None], outputs=outputs, u=s["u"][:, None]):
        signals = np.empty((1, 2), dtype=[("values", object)])
        signals[0, 0], signals[0, 1] = (outputs,), (u,)
        savemat(folder / name, {"LogData": {"time": time, "signals": signals}})
        return folder / name

    def text(name, content):
        (folder / name).write_text(content)
        return folder / name

    def csv(name, t=s["t"], u=s["u"], y=s["y"]):
        return text(name, as_csv(t, u, y))

    def changed(values, index, value):
        values = np.array(values)
        values[index] = value
        return values

    whole = log("whole.mat").read_bytes()
    (folder / "cut.mat").write_bytes(whole[: len(whole) // 2])
    (folder / "hdf5.mat").write_bytes(b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n" + bytes(64))
    savemat(folder / "other.mat", {"time": s["t"], "level": s["y"]})
    back = changed(s["t"], slice(300, n), s["t"][300:] - 30)
    return {
        "no such file": (folder / "none.mat", "none.mat: No such file"),
        "folder": (folder, "directory"),
        "empty mat": (text("empty.mat", ""), "empty.mat: it is empty"),
        "empty csv": (text("empty.csv", ""), "empty.csv: it is empty"),
        "header only": (text("header.csv", "t,u,y\n"), "no data under it"),
        "one sample": (text("one.csv", "t,u,y\n0,1,2\n"), "at least 2 samples; got 1"),
        "one sample mat": (log("one.mat", np.zeros((1, 1)), outputs[:1], s["u"][:1, None]), "at least 2 samples"),
        "lengths": (log("lengths.mat", outputs=outputs[:-3]), "equal length; t has 600, u has 600, y has 597"),
        "lengths u": (log("lengths-u.mat", u=s["u"][:500, None]), "equal length; t has 600, u has 500"),
        "cut off": (folder / "cut.mat", "cut off or damaged"),
        "hdf5": (folder / "hdf5.mat", "'-v7')"),
        "no LogData": (folder / "other.mat", "it holds time, level"),
        "text called mat": (text("text.mat", "t,u,y\n0,1,2\n"), "it is no MAT-file"),
        "swapped columns": (log("swapped.mat", outputs=s["u"][:, None], u=outputs), "are swapped"),
        "swapped signals": (csv("swapped.csv", u=s["y"], y=s["u"]), "look swapped"),
        "no y": (csv("nan.csv", y=np.full(n, np.nan)), "y must be finite; got nan at sample 0"),
        "nan in a moving u": (log("nan.mat", u=changed(s["y"], 9, np.nan)[:, None]), "got nan at sample 9"),
        "infinity in t": (csv("inf.csv", t=changed(s["t"], 3, np.inf)), "t must be finite; got inf at sample 3"),
        "time backwards": (csv("back.csv", t=back), "time goes backwards from sample 299"),
        "time stands still": (csv("still.csv", t=changed(s["t"], 5, s["t"][4])), "time stands still from sample 4"),
        "gap": (csv("gap.csv", t=np.where(s["t"] > 75, s["t"] + 900, s["t"])), "irregular: 0.75 s as a rule"),
        "no number": (text("word.csv", "t,u,y\n0,1,2\n1,x,2\n"), "line 3, column 2: 'x' is not a number"),
        "no columns": (text("columns.csv", "a,b,c\n0,1,2\n1,1,2\n"), "the columns are a, b, c"),
    }


BAD = (
    "no such file", "folder", "empty mat", "empty csv", "header only", "one sample", "one sample mat", "lengths",
    "lengths u", "cut off", "hdf5", "no LogData", "text called mat", "swapped columns", "swapped signals", "no y",
    "nan in a moving u", "infinity in t", "time backwards", "time stands still", "gap", "no number", "no columns",
)  # fmt: skip


@pytest.mark.parametrize("bad", BAD)
def test_bad_input_gets_one_clear_line(refused, staircase, tmp_path, bad):
    cases = bad_files(tmp_path, staircase)
    assert set(cases) == set(BAD)
    path, says = cases[bad]
    for command in ("identify", "check"):
        err, out = refused(command, path)
        assert says in err
        assert command == "check" or out == ""


DESCRIBED = ("lengths", "no y", "nan in a moving u", "time backwards", "gap", "swapped signals", "one sample")


@pytest.mark.parametrize("bad", DESCRIBED)
def test_check_describes_what_it_refuses(refused, staircase, tmp_path, bad):
    out = refused("check", bad_files(tmp_path, staircase)[bad][0], "--json", tmp_path / "out.json")[1]
    assert out.startswith("usable for the lab: no, because")
    found = json.loads((tmp_path / "out.json").read_text())
    assert found["refused"]
    assert "refused" in {finding["level"] for finding in found["findings"]}


def test_what_only_identify_refuses(labsid, refused, write_text, staircase):
    s = staircase
    constant = write_text(as_csv(s["t"], np.full(600, 2.0), s["y"]), "constant.csv")
    assert "u must change at least once; got the constant 2" in refused("identify", constant)[0]
    short = write_text(as_csv(s["t"][:9], s["u"][96:105], s["y"][96:105]), "short.csv")
    assert "got start 2 and 4 samples there" in refused("identify", short)[0]
    still = write_text(
        as_csv(s["t"], np.r_[np.full(400, 2.0), np.full(200, 1.6)], np.r_[np.full(400, 2.3), s["y"][100:300]])
    )
    assert "persistently exciting" in refused("identify", still)[0]
    for record in (constant, short, still):
        status, out, err = labsid("check", record)
        assert (status, err) == (0, "")
        assert out.startswith("usable for the lab: no, because")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["identify"], "Missing argument 'RECORD'. See labsid identify --help."),
        (["identify", "tank.mat", "--order", "two"], "'--order'"),
        (["identify", "tank.mat", "--order", "0"], "order must be at least 1; got 0"),
        (["identify", "tank.mat", "--start", "-1"], "start must be 0 or more"),
        (["identify", "tank.mat", "--start", "299"], "got start 299 and 300 samples there"),
        (["identify", "tank.mat", "--LogData", "smooth"], "'--LogData'"),
        (
            ["identify", "tank.mat", "--output", "out.json"],
            "--output names no file: it is the former name of --LogData",
        ),
        (["identify", "tank.mat", "--Ts", "-1"], "Ts must be a positive number"),
        (["identify", "tank.mat", "--Ts", "1"], "Ts = 1 s disagrees with the times"),
        (["identify", "tank.mat", "--columns", "t,u"], "there is no variable 't' in it; it holds LogData"),
        (["identify", "tank.mat", "--json", "nowhere/out.json"], "there is no such folder to write to"),
        (["identify", "tank.mat", "--model", "."], "it is a folder; name a file"),
        (["check", "tank.mat", "--loud"], "No such option: --loud"),
        (["chek", "tank.mat"], "No such command 'chek'"),
        (["data"], "Missing command. See labsid data --help."),
        (["data", "make", "--out", "out.csv"], "must end in .mat; got 'out.csv'"),
        (["data", "make", "--student", "z1"], "student and secret go together"),
        (["data", "make", "--student", "z1", "--secret", "none.txt"], "none.txt: No such file"),
        (["data", "make", "--out", "nowhere/a.mat"], "there is no such folder to write to"),
    ],
)
def test_bad_usage_gets_one_clear_line(refused, tank, monkeypatch, arguments, says):
    monkeypatch.chdir(tank.parent)
    err, out = refused(*arguments)
    assert says in err
    assert out == ""
    assert [entry.name for entry in tank.parent.iterdir()] == ["tank.mat"]


# Other commands -------------------------------------------------------------------------------------------


def test_help_and_version(labsid):
    status, out, err = labsid()
    assert (status, err) == (0, "")
    assert labsid("--help")[1] == out
    for command in ("check", "identify", "data"):
        assert f"  {command} " in out
        status, described, err = labsid(command, "--help")
        assert (status, err) == (0, "")
        assert described.startswith(f"Usage: labsid {command}")
    assert labsid("--version") == (0, f"labsid {__version__}\n", "")


def test_data_make(labsid, refused, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert labsid("data", "make")[0] == 0
    record = load_record("SysIdenData_StudentVersion.mat")
    assert (len(record), record.Ts) == (903, 0.75)
    assert "already exists and is not overwritten" in refused("data", "make")[0]
    Path("secret").write_text("correct horse battery staple\n")
    files = []
    for student, name in (("z1", "a.mat"), ("z1", "b.mat"), ("z2", "c.mat")):
        status, out, _ = labsid("data", "make", "--student", student, "--secret", "secret", "--out", name)
        assert (status, out) == (0, f"wrote {name}: 903 samples, one every 0.75 s\n")
        files.append(Path(name).read_bytes())
    assert files[0] == files[1] != files[2]
    status, out, _ = labsid("check", "a.mat")
    assert status == 0
    assert out.startswith("usable for the lab: yes")


class EntryPoint:
    group = "labsid.commands"

    def __init__(self, name, loaded):
        self.name, self.loaded = name, loaded

    def load(self):
        if isinstance(self.loaded, Exception):
            raise self.loaded
        return self.loaded


@pytest.fixture
def contributed(monkeypatch):
    def contribute(**commands):
        points = [EntryPoint(name, loaded) for name, loaded in commands.items()]
        monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: points)

    return contribute


def test_contributed_groups_and_commands(contributed, labsid, refused):
    course = typer.Typer(help="Run a course.")

    @course.command()
    def build(jobs: int = 1):
        print(f"built by {jobs}")

    @course.command()
    def stop():
        raise typer.Exit(2)

    def show(folder: Path = Path()):
        """Show the folder."""
        raise ValueError(f"cannot open\n{folder}")

    contributed(course=course, show=show)
    out = labsid("--help")[1]
    assert "course    Run a course." in out
    assert "show      Show the folder." in out
    assert labsid("course", "build", "--jobs", "3") == (0, "built by 3\n", "")
    assert labsid("course", "stop") == (2, "", "")
    assert labsid("course", "--help")[1].startswith("Usage: labsid course")
    assert refused("show", "--folder", "x")[0] == "labsid: error: cannot open x\n"


def test_a_group_that_shows_its_help_without_a_command(contributed, labsid):
    course = typer.Typer(help="Run a course.", no_args_is_help=True)
    course.command()(lambda: None)
    course.command("other")(lambda: None)
    contributed(course=course)
    status, out, err = labsid("course")
    assert status == 2
    assert "Usage: labsid course" in out + err


def test_a_command_whose_packages_are_missing_says_what_to_install(contributed, labsid, refused):
    contributed(demo=ModuleNotFoundError("No module named 'jupyterlab'"), course=ImportError("no nbgrader"))
    assert 'demo      (not installed: pip install "labsid[autograder]")' in labsid("--help")[1]
    line = "this command needs more packages (No module named 'jupyterlab'). Install them: pip install"
    assert line in refused("demo", "--folder", "x", "y")[0]
    assert "no nbgrader" in refused("course", "build")[0]


def test_our_own_commands_do_not_load_the_others(contributed, labsid, tank, monkeypatch):
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: pytest.fail("loaded"))
    assert labsid("check", tank)[0] == 0


# As a process ---------------------------------------------------------------------------------------------


def test_as_a_process(tank):
    done = subprocess.run([*LABSID, "identify", str(tank)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("tank: 600 samples, Ts = 0.75 s\n")
    done = subprocess.run([*LABSID, "identify", "none.mat"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "labsid: error: none.mat: No such file or directory\n"


def test_check_imports_neither_control_nor_matplotlib(tank):
    program = (
        "import sys; from labsid.cli.commands import main; status = main(sys.argv[1:]); "
        "sys.exit(status or bool({'control', 'matplotlib', 'numba'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program, "check", str(tank)], capture_output=True, check=False)
    assert done.returncode == 0


@pytest.mark.skipif(os.name == "nt", reason="Windows has no broken pipes")
def test_a_reader_that_leaves_is_no_error(tank):
    reader, writer = os.pipe()
    os.close(reader)
    try:
        done = subprocess.run([*LABSID, "check", str(tank)], stdout=writer, stderr=subprocess.PIPE, check=False)
    finally:
        os.close(writer)
    assert done.stderr == b""
    assert done.returncode == 1


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs a named pipe to wait on")
def test_an_interrupted_run_ends_with_one_line(tmp_path):
    """A named pipe holds the command in the middle of reading: opening our end waits until it is there."""
    os.mkfifo(tmp_path / "slow.csv")
    command = [*LABSID, "check", str(tmp_path / "slow.csv")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        with open(tmp_path / "slow.csv", "w") as pipe:
            pipe.write("t,u,y\n")
            pipe.flush()
            process.send_signal(signal.SIGINT)
        # The end of the file wakes a read that the signal came just too early for.
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (2, "", "labsid: error: interrupted\n")


def test_no_warning_of_numpy_stands_before_the_line(refused, monkeypatch, tank):
    def warn(*arguments, **settings):
        np.float64(1.0) / np.float64(0.0)
        raise ValueError("got inf")

    monkeypatch.setattr("labsid.records.formats.read_raw", warn)
    assert refused("check", tank)[0] == "labsid: error: got inf\n"


def test_a_line_of_megabytes_is_cut(refused, monkeypatch, tank, tmp_path):
    (tmp_path / "wide.csv").write_text(",".join(["x" * 1000] * 900) + "\n1,2,3\n", encoding="utf-8")
    assert len(refused("check", tmp_path / "wide.csv")[0]) < 1100

    def stop(*arguments, **settings):
        raise ValueError("x" * 2_000_000)

    monkeypatch.setattr("labsid.records.formats.read_raw", stop)
    line, _ = refused("check", tank)
    assert len(line) < 1100
    assert line.endswith("…\n")


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (MemoryError(), "there is not enough memory for this"),
        (RuntimeError("can't start new thread"), "this machine starts no more threads"),
    ],
)
def test_a_machine_that_has_no_more_is_said(refused, monkeypatch, tank, error, said):
    def stop(*arguments, **settings):
        raise error

    monkeypatch.setattr("labsid.records.formats.read_raw", stop)
    assert said in refused("check", tank)[0]


# Figures --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml")])
def test_identify_draws_the_model(labsid, tank, tmp_path, suffix, start):
    path = tmp_path / f"model{suffix}"
    status, _, err = labsid("identify", tank, "--plot", path)
    assert (status, err) == (0, "")
    assert path.read_bytes().startswith(start)


def test_a_figure_has_a_suffix_and_a_folder(refused, tank, tmp_path):
    assert "--plot must end in .png or .svg; got 'model.pdf'" in refused("identify", tank, "--plot", "model.pdf")[0]
    assert "no such folder" in refused("identify", tank, "--plot", tmp_path / "none" / "model.png")[0]


def test_check_draws_a_record_and_also_one_that_it_refuses(labsid, tank, tmp_path):
    path, bad = tmp_path / "record.svg", tmp_path / "bad.csv"
    assert labsid("check", tank, "--plot", path)[0] == 0
    assert path.read_text().startswith("<?xml")
    t = np.arange(100.0)
    t[50:] += 7.0
    bad.write_text(as_csv(t, np.sin(t), np.cos(t)))
    refused_figure = tmp_path / "bad.png"
    assert labsid("check", bad, "--plot", refused_figure)[0] == 2
    assert refused_figure.read_bytes().startswith(b"\x89PNG")
