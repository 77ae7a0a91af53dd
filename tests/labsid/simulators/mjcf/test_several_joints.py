"""Models of several joints: the compiled loop against MuJoCo, and their signals."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

from mjcf_arms import TORQUES, TS, chain, commands, written

from labsid.simulators.mjcf.opening import open_model
from labsid.simulators.mjcf.playing import Player
from labsid.simulators.mjcf.simulation import open_mjcf
from labsid.simulators.mjcf.sources import MjcfSource

SAMPLES = 150
ACROSS = ('axis="1 0 0"', 'axis="0.3 1 0.2" pos="0.01 0.02 0"')
SLIDE = ('<joint name="elbow" axis="0 1 0"', '<joint name="elbow" type="slide" axis="0.2 0 1"')
EULER = ('integrator="implicitfast"', 'integrator="Euler"')
CHANGES: dict[str, dict[str, float]] = {
    "as it is": {},
    "friction": {"inside shoulder:friction": 0.2, "inside elbow:friction": 0.1, "inside elbow:transmitted": 0.1},
    "stops": {"inside elbow:low": -0.2, "inside elbow:high": 0.2},
    "masses": {"inside elbow:mass": 0.3, "link1:mass": 1.4},
    "forces": {"inside shoulder:gravity_sin": 0.8, "inside elbow:load": 0.2, "inside elbow:onset": 0.6},
    "actuator": {"inside elbow:limit": 0.2, "inside elbow:lag": 0.05, "inside shoulder:armature": 0.03},
    "start": {"inside shoulder:start": 0.3, "inside elbow:start_speed": 1.0, "elbow:damping": 0.2},
}


@pytest.mark.parametrize("what", CHANGES)
@pytest.mark.parametrize(
    ("count", "kind", "edits"), [(2, "motor", ()), (3, "position", (ACROSS,)), (2, "position", (SLIDE, EULER))]
)
def test_the_loop_moves_as_mujoco(
    what: str, count: int, kind: str, edits: tuple[tuple[str, str], ...], tmp_path: Path
) -> None:
    text = chain(count, kind)
    for before, after in edits:
        assert before in text
        text = text.replace(before, after)
    rig = Player(open_model(MjcfSource(written(tmp_path / "arm.xml", text))))
    t, u = TS * np.arange(SAMPLES), np.column_stack([commands(i, SAMPLES, TORQUES[i]) for i in range(count)])
    played = rig.run(t, u, CHANGES[what])
    assert np.std(played) > 0.01
    apart = np.abs(played - rig.one.run(t, u, CHANGES[what])).max() / np.ptp(played)
    assert apart < (1e-3 if what == "friction" else 1e-9)  # the solver of MuJoCo ends at a tolerance


def test_inputs_and_outputs_by_name(tmp_path: Path) -> None:
    text = chain(2).replace("</actuator>", '</actuator><sensor><jointvel name="rate" joint="elbow"/></sensor>')
    model = written(tmp_path / "arm.xml", text)
    simulate = open_mjcf(MjcfSource(model, "elbow-motor,shoulder-motor", "rate,shoulder"))
    assert (simulate.inputs, simulate.outputs) == (("elbow-motor", "shoulder-motor"), ("rate", "shoulder"))
    assert simulate.source == f"{model}:elbow-motor,shoulder-motor:rate,shoulder"
    assert {"shoulder:damping", "link2:mass", "elbow-motor:gain"} <= set(simulate.nominal)
    t, u = TS * np.arange(50), np.tile([0.1, 0.0], (50, 1))
    y = simulate(t, u)
    assert y[10, 0] > 10.0 * abs(y[10, 1]) > 0.0  # a torque at the elbow turns it faster than it turns the shoulder
    np.testing.assert_allclose(simulate.joint.run(t, u, {}), y, atol=1e-12)


@pytest.mark.parametrize(
    ("actuators", "words"),
    [
        ("elbow-motor", "has 2 actuators; --inputs names elbow-motor. Name the columns of all of them"),
        ("elbow-motor,elbow-motor", "names an actuator of .* twice"),
        ("elbow-motor,wrist", "has no actuator 'wrist'; it has shoulder-motor, elbow-motor"),
    ],
)
def test_inputs_that_do_not_fit_are_refused(actuators: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=words):
        open_model(MjcfSource(written(tmp_path / "arm.xml", chain(2)), actuators))
