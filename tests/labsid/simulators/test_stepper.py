"""Classes that are stepped: forces at their port against the same effects built in, and errors in one line."""

import re
from pathlib import Path

import numpy as np
import pytest
from stepped_rigs import Pendulum, built_in, command

from labsid.simulators.mjcf.one_joint import PREFIX
from labsid.simulators.process import open_in_process
from labsid.simulators.simulator import SimulatorError
from labsid.simulators.stepper import COLUMN, Stepper, stepper_simulator

TS = 0.005
U = command(0, 800)
T = TS * np.arange(U.size)


def inside(**changes: float) -> dict[str, float]:
    return {PREFIX + name: value for name, value in changes.items()}


class Stated(Pendulum):
    """The pendulum without save and restore, which states its mobility."""

    save = restore = None  # type: ignore[assignment]

    def mobility(self) -> float:
        return TS


class Plain(Pendulum):
    """The pendulum that can do neither."""

    save = restore = None  # type: ignore[assignment]


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"friction": 20.0}, 0.01),
        ({"friction": 60.0}, 0.01),
        ({"friction": 15.0, "peak": 10.0, "stribeck": 0.2}, 0.03),
        ({"damping": 5.0}, 0.01),
        ({"drag": 2.0}, 0.03),
        ({"stiffness": 40.0}, 0.01),
        ({"cubic": 60.0}, 0.01),
        ({"gravity_sin": -40.0, "gravity_cos": 10.0}, 0.01),
        ({"low": -0.3, "high": 0.45}, 0.04),
        ({"high": 0.45, "friction": 15.0}, 0.06),
        ({"load": 20.0, "onset": 1.2344}, 0.01),
        ({"wave_cos": 20.0, "wave_sin": 5.0, "frequency": 1.3}, 0.01),
        ({"lag": 0.03}, 0.01),
    ],
)
def test_changes_act_as_if_they_were_built_in(changes: dict[str, float], error: float) -> None:
    without, exact = built_in(U), built_in(U, **changes)
    simulate = stepper_simulator(Pendulum)
    np.testing.assert_allclose(simulate(T, U), without, atol=0.01 * np.std(without))
    y = simulate(T, U, inside(**changes))
    assert np.std(y - exact) < error * np.std(exact - without)


@pytest.mark.parametrize("kind", [Stated, Plain])
def test_friction_without_a_trial(kind: type) -> None:
    without, exact = built_in(U), built_in(U, friction=20.0)
    y = stepper_simulator(kind)(T, U, inside(friction=20.0))
    assert np.std(y - exact) < 0.04 * np.std(exact - without)


def test_a_joint_that_is_held_stands() -> None:
    for kind, most in ((Pendulum, 1e-12), (Stated, 1e-12), (Plain, 1e-9)):
        simulate = stepper_simulator(kind)
        held = np.full(400, 0.2)
        numbers = inside(friction=80.0, start=0.2 + 0.05)
        y, speed = (simulate(T[:400], held, numbers | {COLUMN: float(i)}) for i in (0, 2))
        assert np.abs(speed[20:]).max() < most
        assert np.ptp(y[20:]) < most


def test_a_joint_that_is_held_yields_to_more_than_its_friction() -> None:
    slope = np.linspace(0.0, 0.3, 400)  # the drive gives 200 times its distance
    speed = stepper_simulator(Pendulum)(T[:400], slope, inside(friction=30.0) | {COLUMN: 2.0})
    first = np.flatnonzero(speed > 1e-9)[0]
    assert 200.0 * slope[first] == pytest.approx(30.0, abs=1.0)


class Mass:
    """A unit mass that a force moves: exact."""

    def reset(self, position: float, speed: float) -> None:
        self.q, self.v = position, speed

    def motion(self) -> tuple[float, float]:
        return self.q, self.v

    def save(self) -> tuple[float, float]:
        return self.q, self.v

    def restore(self, state: tuple[float, float]) -> None:
        self.q, self.v = state

    def step(self, u: float, force: float) -> float:
        self.q += TS * self.v + 0.5 * TS**2 * (u + force)
        self.v += TS * (u + force)
        return self.q


def test_a_mass_slows_down_and_stands_exactly() -> None:
    y = stepper_simulator(Mass)(T, np.zeros(T.size), inside(friction=2.0, start_speed=3.0))
    slowing = np.minimum(T, 1.5)
    np.testing.assert_allclose(y, 3.0 * slowing - slowing**2, atol=1e-9)


def test_the_speed_of_a_class_without_motion_is_a_difference() -> None:
    class Silent(Pendulum):
        motion = None  # type: ignore[assignment]

    simulate = stepper_simulator(Silent)
    assert simulate.joint == Stepper("Silent", has_motion=False, solver="restore")
    assert not simulate.joint.holds(0.001)
    exact, without = built_in(U, damping=5.0), built_in(U)
    assert np.std(simulate(T, U, inside(damping=5.0)) - exact) < 0.1 * np.std(exact - without)


def test_numbers_and_what_a_class_can_do(tmp_path: Path) -> None:
    source = (Path(__file__).parents[2] / "stepped_rigs.py").read_text(encoding="utf-8")
    (tmp_path / "rig.py").write_text(source, encoding="utf-8")
    simulate = open_in_process(f"{tmp_path / 'rig.py'}:Pendulum")
    assert simulate.label == "rig.py:Pendulum"
    assert simulate.nominal == {"k": 200.0, "d": 10.0, "g": 60.0, "limit": 200.0}
    assert simulate.joint == Stepper("rig.py:Pendulum", has_motion=True, solver="restore")
    assert simulate.joint.holds(0.02)
    assert stepper_simulator(Stated).joint.solver == "mobility"
    assert stepper_simulator(Plain).joint.holds(0.002)
    assert not stepper_simulator(Plain).joint.holds(0.0021)
    changed = inside(friction=20.0) | {"k": 150.0}
    np.testing.assert_array_equal(simulate(T, U, changed), stepper_simulator(Pendulum)(T, U, changed))


METHODS = {
    "__init__": "def __init__(self, a=1.0): self.a = a",
    "reset": "def reset(self, position, speed=0.0): self.q, self.v = position, speed",
    "step": "def step(self, u, force): self.v += u + force; self.q += self.v; return self.q",
    "motion": "def motion(self): return self.q, self.v",
    "save": "def save(self): return self.q, self.v",
    "restore": "def restore(self, state): self.q, self.v = state",
}


def written(path: Path, **changed: str) -> str:
    """A class with some methods changed; an empty one is left out."""
    methods = [text for text in (METHODS | changed).values() if text]
    path.write_text("class Rig:\n" + "\n".join(f"    {text}" for text in methods) + "\n", encoding="utf-8")
    return f"{path}:Rig"


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"step": ""}, "is a class without step. Give it reset(position, speed) and step(u, force) -> y"),
        ({"reset": "", "step": ""}, "is a class without reset and step"),
        ({"__init__": "def __init__(self, a): pass"}, "cannot be made as Rig(): missing a required argument: 'a'"),
        ({"reset": "def reset(self): pass"}, "has reset(); it must take (position, speed), or (y0)"),
        ({"reset": "def reset(self, a, b, c): pass"}, "has reset(a, b, c); it must take"),
        ({"step": "def step(self, u): return u"}, "has step(u); it must take (u, force)"),
        ({"restore": ""}, "has save and no restore"),
        ({"step": "def step(self, u, force): return [u, force]"}, "step returns a list; it must return"),
        ({"step": "def step(self, u, force): pass"}, "step returns nothing; it must return"),
        ({"step": "def step(self, u, force): return u / 0.0"}, "stopped with ZeroDivisionError: float division"),
        ({"restore": "def restore(self, state): pass"}, "after save, step and restore, a step differs"),
        ({"motion": "def motion(self): return self.q"}, "motion() must return (position, speed); got"),
        ({"__init__": "Ts = 0.01"}, "steps 0.01 s (its Ts), the record 0.005 s"),
        (
            {"step": "def step(self, u, force): self.v += u; self.q += self.v; return self.q"},
            "a force at its port does not raise the speed",
        ),
    ],
)
def test_errors_are_one_line(changed: dict[str, str], words: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=re.escape(words)) as caught:
        open_in_process(written(tmp_path / "rig.py", **changed))(T, U, inside(friction=1.0))
    assert "\n" not in str(caught.value)


def test_a_state_that_is_no_copy_is_noticed(tmp_path: Path) -> None:
    shared = {
        "__init__": "def __init__(self): self.x = [0.0, 0.0]",
        "reset": "def reset(self, position, speed=0.0): self.x = [position, speed]",
        "step": "def step(self, u, force): self.x[1] += u + force; self.x[0] += self.x[1]; return self.x[0]",
        "motion": "def motion(self): return self.x[0], self.x[1]",
        "save": "def save(self): return self.x",
        "restore": "def restore(self, state): self.x = state",
    }
    with pytest.raises(SimulatorError, match="Let save\\(\\) return a copy"):
        open_in_process(written(tmp_path / "rig.py", **shared))(T, U)
    whole = shared | {
        "save": "def save(self): return list(self.x)",
        "restore": "def restore(self, state): self.x = list(state)",
    }
    open_in_process(written(tmp_path / "rig.py", **whole))(T, U)


@pytest.mark.parametrize(
    ("reset", "takes"),
    [
        ("def reset(self, y0): self.q, self.v = y0, 0.0", False),
        ("def reset(self, y0, seed=0): self.q, self.v = y0, 0.0", False),
        ("def reset(self, position, v=0): self.q, self.v = position, v", True),
    ],
)
def test_reset_with_a_position_or_with_a_speed(reset: str, takes: bool, tmp_path: Path) -> None:
    simulate = open_in_process(written(tmp_path / "rig.py", reset=reset))
    assert simulate.joint.takes_speed is takes
    assert simulate(T, 0.0 * U, inside(start=0.3))[0] == 0.3
