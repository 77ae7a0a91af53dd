"""Effects at one of several joints: named with the joint, and the mended model."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from gap_search import searched

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

import mujoco  # type: ignore[import-untyped, unused-ignore]
from mjcf_arms import NOISE, TORQUES, beyond_band, chain, measured_chain, written

from labsid.gap.diagnosis import diagnose
from labsid.gap.joints.arm_diagnosis import JointsDiagnosis, replay_joints
from labsid.gap.joints.joint_check import check_record_of_joints
from labsid.gap.joints.joint_numbers import numbers_by_joint, sentences_by_joint
from labsid.gap.joints.joint_search import find_at_joints
from labsid.gap.joints.mjcf_export import write_mended_model
from labsid.gap.joints.views import arm_record, joint_view
from labsid.gap.search.explanation import explain
from labsid.gap.signals.preparation import prepare
from labsid.records.record import Record
from labsid.simulators.mjcf.simulation import open_mjcf
from labsid.simulators.mjcf.sources import MjcfSource

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = ("input-delay", "input-backlash", "input-dead-zone", "coulomb-friction", "parameter-mismatch", "load-step")

SAMPLES = 240
FRICTION = {"inside elbow:friction": 0.08}


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("arm") / "arm.xml", chain(2))


@pytest.fixture(scope="module")
def found(model: Path) -> JointsDiagnosis:
    with searched(*FEW):
        diagnosed = diagnose(measured_chain(model, 1, SAMPLES, **FRICTION), open_mjcf(MjcfSource(model)))
    assert isinstance(diagnosed, JointsDiagnosis)
    return diagnosed


def test_the_joint_with_friction_is_named(found: JointsDiagnosis) -> None:
    (effect,) = found.report["effects"]
    assert (effect["name"], effect["joint"], effect["actuator"]) == ("coulomb-friction", "elbow", "elbow-motor")
    assert effect["probability"] > 0.8
    assert effect["parameters"]["friction"]["value"] == pytest.approx(0.08, rel=0.02)
    assert "at the joint elbow, dry friction of" in str(found)
    gap = found.report["gap"]["outputs"]
    assert all(gap[name]["closed"] > 0.95 for name in ("shoulder", "elbow"))
    assert "coulomb-friction at elbow" in repr(found)
    assert {row["joint"] for row in found.report["ranking"]} == {"shoulder", "elbow"}


def test_the_mended_model_holds_on_another_record(found: JointsDiagnosis, model: Path, tmp_path: Path) -> None:
    second = measured_chain(model, 2, SAMPLES, **FRICTION)
    better = tmp_path / "better.xml"
    (said,) = write_mended_model(better, found)
    assert "its comments say what was changed" in said
    assert "At the joint elbow, dry friction" in better.read_text(encoding="utf-8")
    spec = mujoco.MjModel.from_xml_path(str(better))
    np.testing.assert_allclose(spec.dof_frictionloss, [0.0, 0.08], atol=2e-3)
    error, before = (
        replay_joints(open_mjcf(MjcfSource(path)), second).rmse / (NOISE * np.std(second.y, axis=0))
        for path in (better, model)
    )
    assert (error < 1.3).all()
    assert before.max() > 3.0


def test_within_a_dead_zone_the_command_is_zero(model: Path) -> None:
    """Though the mean of the command is not."""
    half = 0.17
    record = measured_chain(model, 5, SAMPLES, TORQUES, partial(beyond_band, half=half))
    assert abs(record.u[:, 1].mean()) > 0.05
    view = joint_view(arm_record(prepare(record).signals, open_mjcf(MjcfSource(model))), 1, {}, {})
    data = replace(view.data, tried=frozenset({"input-dead-zone"}))
    fit = explain(data, view.base.structure, view.base.start, 1).best
    (effect,) = fit.hypothesis.found
    ends = data.u_scale.back(np.sort(fit.theta[fit.hypothesis.slices[effect.key]][:2]))
    np.testing.assert_allclose(ends, np.multiply(TORQUES[1], [-half, half]), atol=0.01)
    assert np.sqrt(fit.free_run) * data.y_scale.unit < 1.2


@searched(*FEW)
def test_without_a_gap_no_effect_is_found(model: Path) -> None:
    record = measured_chain(model, 3, SAMPLES)
    simulate = open_mjcf(MjcfSource(model))
    arm = arm_record(prepare(record).signals, simulate)
    assert not find_at_joints(arm, most=1).at[0].found


def test_a_view_simulates_all_outputs(model: Path) -> None:
    record = measured_chain(model, 4, SAMPLES, **FRICTION)
    arm = arm_record(prepare(record).signals, open_mjcf(MjcfSource(model)))
    exact = arm.joints.run(record.t, record.u, arm.start | FRICTION)
    view = joint_view(arm, 1, FRICTION, {})
    assert view.order == (1, 0)
    plant = view.base.structure.plant
    assert view.base.start is not None
    theta = view.base.start[view.base.structure.slices["plant"]]
    joined = plant.simulation.run(view.data.u, plant.numbers(theta))
    np.testing.assert_allclose(view.outputs(joined), exact, atol=1e-9)


def test_the_numbers_of_each_joint_that_a_record_determines(model: Path) -> None:
    record = measured_chain(model, 6, SAMPLES)
    arm = arm_record(prepare(record).signals, open_mjcf(MjcfSource(model)))
    numbers = numbers_by_joint(arm)
    assert set(numbers) == {"shoulder", "elbow"}
    own = {one["name"]: one for one in numbers["elbow"]}
    assert own["elbow:damping"]["determined"]
    assert 0.0 < own["elbow:damping"]["stderr"] < 0.06
    assert all(text.startswith(("shoulder: The record", "elbow: The record")) for text in sentences_by_joint(numbers))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda r: (r.u, r.y * [1.0, -1.0]), "elbow: the output moves against the position of the joint elbow"),
        (lambda r: (r.u, np.degrees(r.y)), "shoulder: the log seems to be in degrees"),
        (lambda r: (r.u, r.y), ""),
    ],
)
def test_what_does_not_fit_is_said_by_output(change, words: str, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    model = written(tmp_path / "arm.xml", chain(2, "position"))
    record = measured_chain(model, 5, 500)
    u, y = change(record)
    changed = Record(record.t, u, y, record.Ts, inputs=record.inputs, outputs=record.outputs)
    texts = [
        one.text for one in check_record_of_joints(changed, open_mjcf(MjcfSource(model))) if one.level == "warning"
    ]
    assert any(words in text for text in texts) if words else not texts
