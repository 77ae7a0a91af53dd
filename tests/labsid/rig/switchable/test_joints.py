"""Joints with the friction of bristles, against scipy and by hand."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from labsid._arrays import FloatArray
from labsid.rig.switchable.joints import EFFECTS, LAWS, SLIP, Joint, run_joint

TS = 0.01


@pytest.fixture(scope="module")
def command() -> FloatArray:
    """Levels between -1 and 1, each held for 30 samples."""
    return np.repeat(np.random.default_rng(5).uniform(-1.0, 1.0, 10), 30)


def by_scipy(joint: Joint, command: FloatArray) -> FloatArray:
    """Angle and speed by an implicit method with the equations written out again."""

    def flow(t: float, x: FloatArray, value: float) -> list[float]:
        q, v, z = x
        error = {"position": value - q, "speed": value - v, "torque": value}[joint.loop]
        drive = joint.gain * np.clip(error, -joint.limit, joint.limit)
        weight = joint.gravity * np.sin(q - joint.rest)
        level = {
            "dahl": joint.friction,
            "lugre": joint.friction * (1.0 + joint.excess * np.exp(-((v / joint.stribeck) ** 2))),
            "gear": joint.friction + joint.excess * abs(drive - weight),
        }[joint.law]
        if joint.friction == 0.0:
            return [v, drive - joint.damping * v - weight, 0.0]
        stiffness = joint.friction / SLIP
        change = v - abs(v) * z * stiffness / level
        force = stiffness * z + (np.sqrt(stiffness) * change if joint.law == "lugre" else 0.0)
        return [v, drive - joint.damping * v - weight - force, change]

    x, found = np.zeros(3), []
    for value in command:
        found.append(x[:2])
        x = solve_ivp(flow, (0.0, TS), x, args=(value,), method="Radau", rtol=1e-7, atol=1e-9).y[:, -1]
    return np.array(found)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("loop", ["position", "speed", "torque"])
def test_the_motion_is_that_of_scipy(command: FloatArray, loop: str, law: str) -> None:
    gain = {"position": 60.0, "speed": 9.0, "torque": 1.0}[loop]
    joint = Joint(loop, gain, 5.0, 20.0, 0.3, np.inf if loop == "torque" else 0.5, law, 3.0, 0.3)
    scaled = command * (40.0 if loop == "torque" else 1.0)
    found = run_joint(joint, scaled, TS)
    np.testing.assert_allclose(found, by_scipy(joint, scaled), atol=2e-4 * np.ptp(found))


def test_without_effects_a_position_loop_is_linear(command: FloatArray) -> None:
    joint = Joint("position", 60.0, 9.0, 20.0, 0.0, 0.5, "lugre", 3.0, 0.3)
    assert joint.effects == EFFECTS
    for effect in EFFECTS:
        joint = joint.without(effect)
    assert joint.effects == ()
    one, two = (run_joint(joint, factor * command, TS) for factor in (1.0, 2.5))
    np.testing.assert_allclose(two, 2.5 * one, atol=1e-9)


def test_friction_holds_a_small_torque(command: FloatArray) -> None:
    """Within the level of friction the bristles bend and the joint rests; beyond it the joint moves on."""
    joint = Joint("torque", 1.0, 2.0, law="dahl", friction=3.0)
    held, moved = (run_joint(joint, np.full(1500, torque), TS)[:, 0] for torque in (1.5, 6.0))
    assert 0.0 < held[-1] < 3.0 * SLIP
    assert abs(held[-1] - held[1000]) < 0.02 * SLIP
    assert moved[-1] > 1.0


@pytest.mark.parametrize(
    ("changed", "words"), [({"loop": "current"}, "loop must be"), ({"law": "stribeck"}, "law must")]
)
def test_an_unknown_loop_or_law_is_refused(command: FloatArray, changed: dict[str, str], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        run_joint(Joint(**({"loop": "torque", "gain": 1.0, "damping": 1.0} | changed)), command, TS)  # type: ignore[arg-type]
