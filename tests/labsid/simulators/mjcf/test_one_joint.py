"""The compiled loop of a joint against MuJoCo, with and without changes."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

from mjcf_arms import MOTOR, SERVO, SPEED, TS, arm, commands, player, written

from labsid.simulators.mjcf.one_joint import PREFIX, OneJoint, substeps

STANDS = 'solreffriction="0.004 1" solimpfriction="0.999 0.999 0.001"'
MODELS = {
    "motor": arm(MOTOR),
    "euler": arm(MOTOR, 'damping="0.05 0.3"').replace("implicitfast", "Euler"),
    "spring": arm(MOTOR, 'damping="0.05" stiffness="1 0 2" springref="20"'),
    "soft friction": arm(MOTOR, 'damping="0.05" frictionloss="0.2"'),
    "friction": arm(MOTOR, f'damping="0.05" frictionloss="0.2" {STANDS}'),
    "stops": arm(MOTOR, 'damping="0.05" range="-20 30"'),
    "geared": arm('<motor name="motor" joint="elbow" gear="5" forcerange="-0.1 0.1"/>'),
    "servo": arm('<position name="servo" joint="elbow" kp="8" kv="0.3" forcerange="-2 2"/>'),
    "filtered": arm('<position name="servo" joint="elbow" kp="8" timeconst="0.05" ctrlrange="-0.5 0.5"/>'),
    "late": arm('<position name="servo" joint="elbow" kp="8" kv="0.3" delay="0.025" nsample="20"/>'),
    "speed": arm(SPEED),
    "integrating": arm('<intvelocity name="drive" joint="elbow" kp="8" kv="0.3" actrange="-1 1"/>'),
}
CHANGES = (
    {},
    {"friction": 0.05, "transmitted": 0.2, "peak": 0.05, "stribeck": 0.1},
    {"damping": 0.02, "drag": 0.01, "armature": 0.003, "stiffness": 0.1, "cubic": 0.2, "start": 0.1},
    {"gravity_sin": 0.3, "gravity_cos": 0.1, "load": 0.1, "onset": 1.013, "wave_cos": 0.05, "frequency": 1.3},
    {"friction": 0.1, "mass": 0.2, "low": -0.2, "high": 0.3, "limit": 0.4, "gain": 0.1, "kv": 0.02, "lag": 0.03},
)


@pytest.mark.parametrize("name", MODELS)
def test_the_loop_moves_as_mujoco(name: str, tmp_path: Path) -> None:
    played = player(written(tmp_path / "arm.xml", MODELS[name]))
    u = commands(1, 200)
    t = TS * np.arange(u.size)
    for changes in CHANGES:
        numbers = {PREFIX + key: value for key, value in changes.items()}
        exact = played.run(t, u, numbers)
        np.testing.assert_allclose(played.one.run(t, u, numbers), exact, atol=1e-9 * np.ptp(exact))


def test_friction_that_is_put_in_holds_the_joint(tmp_path: Path) -> None:
    one = player(written(tmp_path / "arm.xml", arm(MOTOR, option='gravity="0 0 0"'))).one
    u = np.full(300, 0.065)
    y = one.run(TS * np.arange(u.size), u, {PREFIX + "friction": 0.1})
    assert 0.0 < (y[-1] - y[100]) / (2.0) < 1e-3  # rad/s of creep at 0.65 of the friction


def test_numbers_of_the_model_act(tmp_path: Path) -> None:
    one = player(written(tmp_path / "arm.xml", arm())).one
    u = commands(1, 100)
    t = TS * np.arange(u.size)
    assert set(one.nominal()) >= {"elbow:damping", "elbow:armature", "link:mass", "servo:kp", "servo:kv"}
    for name, value in one.nominal().items():
        changed = one.run(t, u, {name: value + 0.5})
        assert not np.allclose(changed, one.run(t, u, {})), name
    np.testing.assert_allclose(one.run(t, u, one.nominal()), one.run(t, u, {}), rtol=1e-12)
    twice = one.run(t, u, {"elbow:damping": 0.1})
    np.testing.assert_allclose(one.run(t, u, {PREFIX + "damping": 0.05}), twice, rtol=1e-12)


def test_a_sampling_time_that_the_timestep_does_not_divide_is_refused() -> None:
    assert substeps(0.01, 0.002) == 5
    with pytest.raises(ValueError, match=r"no multiple of the timestep 0.003 s .* Set that to 0.00333333"):
        substeps(0.01, 0.003)


def test_kinds_of_actuators(tmp_path: Path) -> None:
    def kind(actuator: str) -> OneJoint:
        return player(written(tmp_path / "arm.xml", arm(actuator))).one

    assert [kind(one).kind for one in (MOTOR, SERVO, SPEED)] == ["torque", "position", "velocity"]
