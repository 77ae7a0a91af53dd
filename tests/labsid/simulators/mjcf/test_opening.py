"""Models of MuJoCo that are opened, and those that are refused in one line."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

from mjcf_arms import MOTOR, SERVO, arm, written

from labsid.simulators.mjcf.opening import OpenedJoint, OpenedOutput, open_model
from labsid.simulators.mjcf.simulation import open_mjcf
from labsid.simulators.mjcf.sources import MjcfSource, is_mjcf, parse_mjcf

TWO = arm(MOTOR + '<motor name="other" joint="elbow"/>')
SENSORS = arm(more='<sensor><jointvel name="speed" joint="elbow"/><clock name="clock"/></sensor>')
URDF = """<robot name="arm"><mujoco><compiler fusestatic="false"/></mujoco><link name="base"/>
<link name="rod"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="elbow" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"""


def test_names_of_models() -> None:
    assert parse_mjcf("a/arm.xml:motor:elbow:trust") == MjcfSource(Path("a/arm.xml"), "motor", "elbow", True)
    assert str(parse_mjcf("arm.xml:motor")) == "arm.xml:motor"
    assert is_mjcf("arm.URDF")
    assert not is_mjcf("rig.py:simulate")


@pytest.mark.parametrize(
    ("text", "names", "words"),
    [
        ("<mujoco", {}, "is no XML that can be read"),
        ("<mujoco><worldbody><joint/></worldbody></mujoco>", {}, "cannot be loaded by MuJoCo"),
        (arm(""), {}, "has no actuator, so nothing takes the input"),
        (URDF, {}, "has no actuator"),
        (TWO, {}, "the joint elbow of .* has more than one actuator, which cannot be opened"),
        (TWO, {"actuator": "third"}, "has no actuator 'third'; it has motor, other"),
        (arm(), {"output": "knee"}, "has no joint or sensor 'knee'; it has the joints elbow"),
        (SENSORS, {"output": "knee"}, "joints elbow and the sensors speed, clock"),
        (SENSORS, {"output": "clock"}, "is of the kind clock; an output is a joint, or a sensor of the kind jointpos"),
        (arm('<adhesion name="glue" body="link" ctrlrange="0 1"/>'), {}, "the actuator glue of .* acts on no joint"),
        (arm(more='<asset><mesh name="m" file="../m.obj"/></asset>'), {}, "outside the folder of the model.* --trust"),
        (arm(more='<extension><plugin plugin="mine"/></extension>'), {}, "loads a plugin.* Add --trust"),
        (
            TWO,
            {"actuator": "motor"},
            "2 actuators; --inputs names motor. Name the columns of all of them, or remove other",
        ),
    ],
)
def test_models_that_cannot_be_used_are_refused_in_one_line(
    text: str, names: dict[str, str], words: str, tmp_path: Path
) -> None:
    path = written(tmp_path / "arm.xml", text)
    with pytest.raises(ValueError, match=words) as refused:
        open_mjcf(MjcfSource(path, **names))
    assert "\n" not in str(refused.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"arm.xml does not exist"):
        open_model(MjcfSource(tmp_path / "arm.xml"))


def test_without_mujoco_the_line_to_type_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path / "arm.xml", arm(SERVO))
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ValueError, match=r'Type: pip install "labsid\[mujoco\]"'):
        open_model(MjcfSource(path))


def test_a_sensor_as_the_output(tmp_path: Path) -> None:
    opened = open_model(MjcfSource(written(tmp_path / "arm.xml", SENSORS), output="speed"))
    assert opened.outputs == (OpenedOutput("speed", 0, "speed"),)
    assert opened.joints == (OpenedJoint(0, 0, "elbow", "servo", "link"),)
