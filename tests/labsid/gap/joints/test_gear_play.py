"""A play in the gear of one of several joints: named with the joint, and a joint of the mended model."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from gap_search import searched

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

from mjcf_arms import ANGLES, NOISE, TORQUES, behind_play, chain, geared, measured_chain, written

from labsid.gap.diagnosis import diagnose
from labsid.gap.joints.arm_diagnosis import JointsDiagnosis, replay_joints
from labsid.gap.joints.mjcf_export import write_mended_model
from labsid.gap.joints.views import arm_record, joint_view
from labsid.gap.search.explanation import explain
from labsid.gap.signals.preparation import prepare
from labsid.records.record import Record
from labsid.simulators.mjcf.simulation import open_mjcf
from labsid.simulators.mjcf.sources import MjcfSource

pytestmark = pytest.mark.usefixtures("without_limits")

SAMPLES, WIDTH = 300, 0.1


@searched("input-backlash", "input-dead-zone", "coulomb-friction", "parameter-mismatch")
def test_the_joint_is_named_and_the_model_mended(tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", chain(2))
    rig = written(tmp_path / "rig.xml", geared(chain(2), "elbow", WIDTH))
    found = diagnose(measured_chain(rig, 1, SAMPLES), open_mjcf(MjcfSource(model)))
    assert isinstance(found, JointsDiagnosis)
    (effect,) = found.report["effects"]
    assert (effect["name"], effect["joint"], effect["signal"]) == ("input-backlash", "elbow", None)
    width = effect["parameters"]["width"]
    assert (width["value"], width["unit"]) == (pytest.approx(WIDTH, rel=0.03), "rad")
    assert "moves it through a gear with a play of 0.1" in " ".join(str(found).split())
    better = tmp_path / "better.xml"
    (said,) = write_mended_model(better, found)
    assert "its comments say what was changed" in said
    assert 'name="elbow-play"' in better.read_text(encoding="utf-8")
    second = measured_chain(rig, 2, SAMPLES)
    error, before = (
        replay_joints(open_mjcf(MjcfSource(path)), second).rmse / (NOISE * np.std(second.y, axis=0))
        for path in (better, model)
    )
    assert error.max() < 1.3
    assert before.max() > 2.5


def best_form(model: Path, record: Record) -> str:
    """The form of backlash that explains a record, as seen at the elbow."""
    view = joint_view(arm_record(prepare(record).signals, open_mjcf(MjcfSource(model))), 1, {}, {})
    data = replace(view.data, tried=frozenset({"input-backlash"}))
    return explain(data, view.base.structure, view.base.start, 1).best.hypothesis.found[0].key


def test_a_play_between_actuator_and_sensor_is_another_form(tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", chain(2, "position"))
    rig = written(tmp_path / "rig.xml", geared(chain(2, "position"), "elbow", WIDTH))
    record = measured_chain(rig, 1, SAMPLES, ANGLES, seen=True)
    assert best_form(model, record) == "input-backlash/joint-seen"


def test_a_play_of_the_command_is_none_of_the_gear(tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", chain(2, "position"))
    record = measured_chain(model, 1, SAMPLES, ANGLES, partial(behind_play, width=0.25))
    assert best_form(model, record) == "input-backlash"


@pytest.mark.parametrize(("armature", "possible"), [("0.01", True), ("0", False)])
def test_a_rotor_needs_an_inertia(armature: str, possible: bool, tmp_path: Path) -> None:
    model = written(tmp_path / "arm.xml", chain(2).replace('armature="0.01"', f'armature="{armature}"'))
    arm_of = arm_record(prepare(measured_chain(model, 1, SAMPLES, TORQUES)).signals, open_mjcf(MjcfSource(model)))
    port = joint_view(arm_of, 1, {}, {}).base.structure.plant.simulation.port
    assert port.makes(("play",)) is possible
    assert port.makes(("friction",))
