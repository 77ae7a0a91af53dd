"""Play in the gear of a joint: the compiled loop against MuJoCo with a second joint between stops."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="pip install 'labsid[mujoco]'")

from mjcf_arms import MOTOR, SERVO, TORQUES, TS, arm, chain, commands, geared, player, written

SAMPLES, WIDTH, CONTACT = 150, 0.1, 0.01
SLIDE = ('name="elbow" axis="0 1 0"', 'name="elbow" type="slide" axis="0.3 0 1"')
SPRUNG = 'damping="0.05" armature="0.01" stiffness="20"'


def played(text: str, joint: str, u: np.ndarray, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Positions of the joints with actuators as MuJoCo moves them with a play at one of them, and of its link."""
    rig = player(written(folder / "rig.xml", geared(text, joint, WIDTH, CONTACT)))
    position = rig.play(TS * np.arange(len(u)), u, {})[0][:, :, 0]
    rotors = position[:, rig.opened.inputs]
    place = [one.joint for one in rig.joints].index(f"{joint}-play")
    links = rotors.copy()
    links[:, rig.opened.inputs.index(place - 1)] += position[:, place]
    return rotors, links


@pytest.mark.parametrize(("count", "kind", "joint"), [(2, "motor", "elbow"), (3, "position", "shoulder")])
@pytest.mark.parametrize("change", ["play", "seen_play"])
def test_the_loop_moves_as_mujoco_with_a_second_joint(
    count: int, kind: str, joint: str, change: str, tmp_path: Path
) -> None:
    u = np.column_stack([commands(i, SAMPLES, TORQUES[i]) for i in range(count)])
    rotors, links = played(chain(count, kind), joint, u, tmp_path)
    loop = player(written(tmp_path / "arm.xml", chain(count, kind))).one
    numbers = {f"inside {joint}:{change}": WIDTH, f"inside {joint}:contact_time": CONTACT}
    found, without = (loop.run(TS * np.arange(SAMPLES), u, own) for own in (numbers, {}))
    exact = links if change == "seen_play" else rotors
    assert np.abs(found - exact).max() < 1e-9 * np.ptp(exact)
    assert np.abs(without - exact).max() > 0.01 * np.ptp(exact)


@pytest.mark.parametrize("actuator", [MOTOR, SERVO])
@pytest.mark.parametrize("slides", [False, True])
def test_a_single_joint_has_the_same_play(actuator: str, slides: bool, tmp_path: Path) -> None:
    text = arm(actuator, SPRUNG).replace(*SLIDE) if slides else arm(actuator)
    u = commands(3, SAMPLES, 0.9)
    rotors, links = played(text, "elbow", u[:, None], tmp_path)
    loop = player(written(tmp_path / "arm.xml", text)).one
    for change, exact in (("play", rotors[:, 0]), ("seen_play", links[:, 0])):
        numbers = {f"inside {change}": WIDTH, "inside contact_time": CONTACT}
        found = loop.run(TS * np.arange(SAMPLES), u, numbers)
        assert np.abs(found - exact).max() < 1e-9 * np.ptp(exact)


def test_the_link_starts_where_its_sensor_reads_it(tmp_path: Path) -> None:
    loop = player(written(tmp_path / "arm.xml", arm())).one
    numbers = {"inside seen_play": WIDTH, "inside start_play": 0.3, "inside start": 0.2}
    y = loop.run(TS * np.arange(20), np.zeros(20), numbers)
    assert y[0] == pytest.approx(0.2)


def test_a_rotor_without_armature_stays_bounded(tmp_path: Path) -> None:
    loop = player(written(tmp_path / "arm.xml", chain(2).replace('armature="0.01"', ""))).one
    u = np.column_stack([commands(i, SAMPLES, TORQUES[i]) for i in range(2)])
    y = loop.run(TS * np.arange(SAMPLES), u, {"inside elbow:play": 0.002})
    assert np.abs(y).max() < 10.0
