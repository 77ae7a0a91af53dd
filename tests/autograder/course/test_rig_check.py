"""Whether a record carries the lab: each requirement on a record that breaks it, and the ways out."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from own_rigs import HOLD, LEVELS, MOTOR, motor_log, write_csv

from autograder.course.rig_check import check_rig
from autograder.course.rig_findings import about_rig
from labsid.checks.other_records.rig_model import RigModel, make_rig_log
from labsid.cli.commands import main
from labsid.lab.findings import Finding
from labsid.records.reading import Reading
from labsid.rig.lab.log import LabLog, log_to_record

ROOT = Path(__file__).resolve().parents[3]
TANKS = ROOT / "data" / "SysIdenData_StudentVersion.mat"


def run(u: np.ndarray, model: RigModel = MOTOR) -> LabLog:
    return make_rig_log(model, np.asarray(u, float), np.random.SeedSequence(1), "motor", ("V", "rpm"))


def findings(u: np.ndarray, model: RigModel = MOTOR) -> dict[str, list[Finding]]:
    found: dict[str, list[Finding]] = {}
    for one in about_rig(log_to_record(run(u, model))):
        found.setdefault(one.topic, []).append(one)
    return found


STAIRS = np.repeat(LEVELS, HOLD)


def test_the_labs_own_record_carries_the_lab() -> None:
    checked = check_rig(TANKS, Reading())
    assert checked.verdict == "carries the lab: yes"
    assert checked.advice == ()
    assert {one.level for one in checked.findings} == {"ok", "note"}


def test_a_motor_carries_the_lab(tmp_path: Path) -> None:
    assert check_rig(write_csv(tmp_path / "motor.csv", motor_log()), Reading()).carries


@pytest.mark.parametrize(
    ("u", "topic", "level", "said"),
    [
        (STAIRS[HOLD - 10 :], "rest", "refused", "10 samples (0.1 s) before the first change"),
        (np.repeat((4.0, 2.0, 6.0), HOLD), "steps", "refused", "changes 2 times"),
        (np.repeat((4.0, 2.0, 6.0, 2.0), (100, 60, 60, 300)), "two halves", "refused", "never in the second"),
        (np.r_[STAIRS[:HOLD], 4 + np.sin(np.arange(400) / 9)], "steps", "refused", "not held"),
        (np.r_[STAIRS[:HOLD], [4.01] * HOLD, STAIRS[HOLD:]], "first step", "refused", "the first step"),
    ],
)
def test_what_is_missing_is_named(u: np.ndarray, topic: str, level: str, said: str) -> None:
    one = next(one for one in findings(u)[topic] if one.level == level)
    assert said in one.text


def test_a_rest_at_zero_and_a_slow_logger_are_warned_of() -> None:
    at_zero = replace(MOTOR, u_rest=0.0, y_rest=0.0, y_start=0.0)
    (offsets,) = findings(STAIRS - LEVELS[0], at_zero)["offsets"]
    assert (offsets.level, "subtracts nothing" in offsets.text) == ("warning", True)
    fast = replace(MOTOR, Ts=0.001)
    (sampling,) = findings(np.repeat(LEVELS, 10 * HOLD), fast)["sampling"]
    assert (sampling.level, "--resample 0.00" in sampling.text) == ("warning", True)


def test_units_that_cost_digits_are_warned_of() -> None:
    small = replace(MOTOR, gain=3e-6, y_rest=1e-5, y_start=1e-5, noise=6e-8, lattice=0.0)
    (units,) = findings(STAIRS, small)["units"]
    assert (units.level, "about as large as the input" in units.text) == ("warning", True)
    assert "units" not in findings(STAIRS)


def test_a_start_up_that_does_not_settle_is_refused() -> None:
    (rest,) = findings(STAIRS[HOLD - 30 :], replace(MOTOR, y_start=10.0))["rest"]
    assert (rest.level, "does not settle" in rest.text) == ("refused", True)


def test_constant_signals_are_said() -> None:
    assert "input is constant" in findings(np.full(300, 4.0))["input"][0].text


def test_a_constant_input_is_said_once_and_the_advice_names_no_level_of_it(tmp_path: Path) -> None:
    checked = check_rig(write_csv(tmp_path / "constant.csv", run(np.full(300, 4.0))), Reading())
    assert [one.topic for one in checked.findings if one.level == "refused"] == ["input"]
    (advice,) = checked.advice
    assert "by steps to which the output responds clearly" in advice
    assert "about 4" not in advice


def test_a_later_start_is_found(tmp_path: Path) -> None:
    """The motor does not move until the third level, as in a dead zone."""
    u = np.repeat((0.0, 1.0, *LEVELS), HOLD)
    log = run(np.maximum(u, 2.0), replace(MOTOR, u_rest=2.0, y_rest=0.0, y_start=0.0, noise=0.0))
    path = write_csv(tmp_path / "dead-zone.csv", replace(log, u=u))
    checked = check_rig(path, Reading())
    assert not checked.carries
    (line,) = (line for line in checked.advice if "carries the lab from" in line)
    since = float(line.split()[-1].rstrip("."))
    assert check_rig(path, Reading(since=since)).carries


def test_a_step_alone_carries_the_lab_by_a_model(tmp_path: Path) -> None:
    path = write_csv(tmp_path / "step.csv", run(np.repeat((4.0, 6.0), (30, 400))))
    checked = check_rig(path, Reading())
    assert not checked.carries
    assert any("--simulated" in line for line in checked.advice)
    assert any(line.startswith("To record instead: sample every") for line in checked.advice)
    assert check_rig(path, Reading(), simulated=True).carries


def test_the_command_says_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["course", "rig", str(TANKS)]) == 0
    assert capsys.readouterr().out.startswith("carries the lab: yes\n")
    path = write_csv(tmp_path / "step.csv", run(np.repeat((4.0, 6.0), (30, 400))))
    assert main(["course", "rig", str(path)]) == 1
    assert "To record instead" in capsys.readouterr().out
    assert main(["course", "rig", str(path), "--simulated"]) == 0
    capsys.readouterr()
    bad = tmp_path / "notes.csv"
    bad.write_text("no numbers\n", encoding="utf-8")
    for given in (bad, tmp_path / "missing.csv"):
        assert main(["course", "rig", str(given)]) == 2
        told = capsys.readouterr()
        assert told.err.startswith("labsid: error: ")
        assert told.err.count("\n") == 1


def test_columns_that_are_not_known_are_listed_with_the_line_to_type(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    log = motor_log()
    (tmp_path / "logs").mkdir()
    monkeypatch.chdir(tmp_path)
    columns = np.column_stack([1000 * log.t, 1000 * log.u, log.y_measured])
    rows = (f"{t:.0f};{u:.1f};{y:.2f}".replace(".", ",") for t, u, y in columns)
    text = "Zeit [ms];Ankerspannung [mV];Drehzahl [1/min]\r\n" + "\r\n".join(rows)
    (tmp_path / "logs" / "antrieb.csv").write_text(text, encoding="cp1252")
    for command in ("course rig", "check"):
        assert main([*command.split(), "logs/antrieb.csv"]) == 2
        (line,) = (one for one in capsys.readouterr().out.splitlines() if one.startswith("Type: "))
        assert line == f"Type: labsid {command} logs/antrieb.csv --columns Zeit,Ankerspannung,Drehzahl"
        assert main(line.removeprefix("Type: labsid ").split()) == 0
        capsys.readouterr()


def test_a_model_that_is_refused_gives_no_advice_on_sampling() -> None:
    found = findings(np.r_[STAIRS[:HOLD], [4.01] * HOLD, STAIRS[HOLD:]])
    assert "refused" not in {one.level for one in found["order 2"]}
    assert "sampling" in found
    useless = findings(STAIRS, replace(MOTOR, noise=60.0))
    assert "refused" in {one.level for one in useless["order 2"]}
    assert "sampling" not in useless
