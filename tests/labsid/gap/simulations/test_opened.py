"""Effects inside a model of one joint: what is named, at which joint, and the mended model."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

import mujoco
from gap_search import searched
from mjcf_arms import MOTOR, NOISE, SERVO, TS, arm, measured, written

from labsid.cli.commands import main
from labsid.gap.diagnosis import diagnose
from labsid.gap.joints import mjcf_export
from labsid.gap.joints.mjcf_export import write_mended_model
from labsid.gap.model_file import from_json_dict
from labsid.gap.simulations.simulation_files import replay
from labsid.records.record import Record
from labsid.simulators.mjcf.describing import describe_model
from labsid.simulators.mjcf.one_joint import PREFIX
from labsid.simulators.mjcf.opening import open_model
from labsid.simulators.mjcf.sources import MjcfSource
from labsid.simulators.process import open_in_process

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = ("coulomb-friction", "parameter-mismatch", "input-dead-zone")


def saved(record: Record, path: Path) -> Path:
    """The record as .csv."""
    rows = np.column_stack([record.t, record.u, record.y])
    np.savetxt(path, rows, delimiter=",", header="t,u,y", comments="", fmt="%.9g")
    return path


@searched(*FEW)
def test_friction_is_named_at_the_joint_and_mended_in_the_model(tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", arm(SERVO))
    rig, other = (measured(model, seed, friction=0.3) for seed in (1, 2))
    found = diagnose(rig, open_in_process(str(model)))
    (effect,) = found.report["effects"]
    assert (effect["name"], effect["joint"], effect["actuator"]) == ("coulomb-friction", "elbow", "servo")
    friction = effect["parameters"]["friction"]
    assert friction["unit"] == "N m"
    assert abs(friction["value"] - 0.3) < 4.0 * friction["stderr"] < 0.03
    assert re.search(r"At the joint elbow, dry friction of 0\.(29|30)\d* N m opposes the motion", str(found))
    better = tmp_path / "better.xml"
    assert write_mended_model(better, found) == [f"{better}: the mended model; its comments say what was changed."]
    mended = mujoco.MjModel.from_xml_path(str(better))
    assert mended.dof_frictionloss[0] == pytest.approx(0.3, abs=0.01)
    assert mended.dof_solref[0].tolist() == [0.004, 1.0]
    assert "<!-- At the joint elbow, dry friction of 0." in better.read_text(encoding="utf-8")
    assert replay(better, other).rmse < 1.2 * NOISE * np.std(other.y)
    assert diagnose(rig, open_in_process(str(better))).verdict == "none"


@searched("coulomb-friction")
def test_friction_with_the_load_goes_to_a_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = written(Path("arm.xml"), arm(SERVO))
    rig = measured(model, 1, friction=0.05, transmitted=0.25)
    found = diagnose(rig, open_in_process(str(model)))
    (effect,) = found.report["effects"]
    assert effect["parameters"]["load"]["value"] == pytest.approx(0.25, abs=0.02)
    assert write_mended_model(Path("better.xml"), found)[1].startswith("better.py: steps it with what MJCF has not")
    assert replay(Path("better.py"), rig).rmse < 1.2 * NOISE * np.std(rig.y)
    json_file = json.loads(json.dumps(found.model.to_json_dict()))
    np.testing.assert_allclose(from_json_dict(json_file).simulate(rig.u, rig.y), found.model.simulate(rig.u, rig.y))


@searched("parameter-mismatch", "input-dead-zone")
def test_a_wrong_number_is_named_and_a_right_model_is_none(tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", arm(SERVO))
    simulation = open_in_process(str(model))
    assert diagnose(measured(model, 1), simulation).verdict == "none"
    found = diagnose(measured(model, 1, armature=0.015), simulation)
    (effect,) = found.report["effects"]
    assert effect["name"] == "parameter-mismatch"
    assert effect["parameters"]["elbow:armature"]["value"] == pytest.approx(0.025, abs=0.001)
    assert "elbow:armature is 0.02" in str(found)
    write_mended_model(tmp_path / "better.xml", found)
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "better.xml")).dof_armature[0] == pytest.approx(0.025, abs=0.001)


@searched("coulomb-friction")
def test_free_numbers_of_a_joint(tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", arm(SERVO))
    found = diagnose(measured(model, 1, damping=0.1), open_in_process(str(model)), free=["elbow:damping", "servo:kp"])
    (effect,) = found.report["effects"]
    assert effect["name"] == "parameter-mismatch"
    assert effect["parameters"]["elbow:damping"]["value"] == pytest.approx(0.15, abs=0.01)


@searched("coulomb-friction")
def test_several_runs_each_start_where_they_do(tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", arm(SERVO))
    runs = [measured(model, seed, 300, friction=0.3, start=start) for seed, start in ((1, 0.0), (2, 0.4))]
    found = diagnose(runs, open_in_process(str(model)))
    assert [effect["name"] for effect in found.report["effects"]] == ["coulomb-friction"]
    assert found.report["gap"]["after"] < 1.3 * found.report["gap"]["noise_floor"]


@pytest.mark.parametrize("what", ["gravity", "mass", "gain", "stop", "limit", "lag"])
def test_a_mended_model_moves_as_the_fit(what: str, tmp_path: Path) -> None:
    """The attributes that are written against the compiled loop with the same changes."""
    changes = {
        "gravity": {"gravity_sin": -0.4, "gravity_cos": 0.2},
        "mass": {"mass": 0.3},
        "gain": {"gain": -0.2, "damping": 0.05, "drag": 0.02},
        "stop": {"low": -0.3, "high": 0.4},
        "limit": {"limit": 0.7, "armature": 0.02},
        "lag": {"lag": 0.04, "stiffness": 0.4, "cubic": 0.3},
    }[what]
    model = written(tmp_path / "arm.xml", arm(SERVO))
    opened = open_model(MjcfSource(model))
    one, spec = describe_model(opened), mujoco.MjSpec.from_file(str(model))
    numbers = {PREFIX + name: value for name, value in changes.items()}
    assert mjcf_export._change_joint(spec, opened, 0, one, numbers) == []
    spec.compile()
    mended = describe_model(open_model(MjcfSource(written(tmp_path / "better.xml", spec.to_xml()))))
    t, u = TS * np.arange(300), np.repeat(np.linspace(-1.0, 1.0, 10), 30)
    exact = one.run(t, u, numbers)
    np.testing.assert_allclose(replace(mended, output="position").run(t, u, {}), exact, atol=1e-4 * np.ptp(exact))


@pytest.mark.parametrize(
    ("change", "option", "words"),
    [
        (lambda r: (r.u, -r.y), [], "moves against the position of the joint elbow. --match y=-1 mends it"),
        (lambda r: (r.u, np.degrees(r.y)), [], "the log seems to be in degrees. --match y=57.2958 mends it"),
        (
            lambda r: (r.u, 5.0 * r.y),
            [],
            "times as far as the position of the joint elbow in the simulation: by a gear, or",
        ),
        (lambda r: (r.u, r.y + 1.0), [], "at the zero of the joint elbow. --match zero="),
        (lambda r: (r.u, np.append(r.y[3:], r.y[-3:])), [], "later, by 3 samples. --match shift=3 mends it"),
        (lambda r: (r.u, np.degrees(r.y)), ["--match", "y=57.2958"], "agree in sign, units, time and limits"),
        (lambda r: (r.u, r.y), [], "agree in sign, units, time and limits"),
    ],
)
def test_check_says_what_does_not_fit(change, option, words, tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = written(Path("arm.xml"), arm(SERVO))
    record = measured(model, 1, 1500, friction=0.05)
    u, y = change(record)
    saved(Record(record.t, u, y, TS), Path("run.csv"))
    status = main(["gap", "check", "run.csv", "--sim", "arm.xml", *option])
    printed = capsys.readouterr().out
    assert words in printed
    assert status == int("warning" in printed)


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (arm(MOTOR), "the position follows the command, as with a position servo"),
        (arm(SERVO.replace("/>", ' ctrlrange="-0.5 0.5"/>')), "lie beyond the ctrlrange -0.5 to 0.5"),
        (
            arm(SERVO).replace("<worldbody>", '<worldbody><geom name="wall" pos="0.12 0 -0.25" size="0.05"/>'),
            "wall and rod",
        ),
    ],
)
def test_check_of_models_that_differ(model: str, words: str, tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    stiff = SERVO.replace('kp="6" kv="0.25"', 'kp="60" kv="4"')
    record = measured(written(Path("rig.xml"), arm(stiff)), 1)
    saved(record, Path("run.csv"))
    written(Path("arm.xml"), model)
    main(["gap", "check", "run.csv", "--sim", "arm.xml"])
    assert words in capsys.readouterr().out


@searched("coulomb-friction")
def test_the_command_line(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = written(Path("arm.xml"), arm(SERVO))
    saved(measured(model, 1, friction=0.3), Path("run.csv"))
    names = ["--inputs", "servo", "--outputs", "elbow"]
    assert main(["gap", "diagnose", "run.csv", "--sim", "arm.xml", *names, "--export", "better.xml"]) == 0
    assert "better.xml: the mended model" in capsys.readouterr().out
    assert main(["gap", "simulate", "better.xml", "run.csv"]) == 0
    for arguments, words in (
        (["diagnose", "run.csv", "--sim", "arm.xml", "--inputs", "knee"], "has no actuator 'knee'; it has servo"),
        (["diagnose", "run.csv", "--sim", "arm.xml", "--free", "knee:damping"], "it has elbow:damping"),
        (["diagnose", "run.csv", "--sim", "arm.xml", "--match", "y=0"], "neither u nor y may be zero"),
        (["diagnose", "run.csv", "--sim", "x.json", "--inputs", "servo"], "there is no column 'servo'"),
        (["simulate", "x.json", "run.csv", "--inputs", "servo"], "are for a model of MuJoCo"),
        (["check", "run.csv", "--sim", "x.json"], "must be a model of MuJoCo"),
        (["diagnose", "run.csv", "--export", "better.xml"], "needs a model of MuJoCo as the simulation"),
    ):
        assert main(["gap", *arguments]) == 2
        said = capsys.readouterr().err
        assert words in said
        assert said.count("\n") == 1
