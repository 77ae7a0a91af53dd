"""Fits from the inverse dynamics are those of the simulated joint, also where it hardly moves or mostly rests."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.dynamics.responses import force_unit
from labsid.gap.effects.restarts import Restarts
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import LINEAR, fit_baseline, fit_highpass
from labsid.gap.record.data import Data, scaled
from labsid.gap.search.candidates import Trial
from labsid.gap.search.inverse_dynamics import joint_trials
from labsid.rig.switchable.joints import Joint, run_joint

TS, RATE = 0.01, 8.0
LOOP = Joint("position", gain=RATE**2, damping=1.2 * RATE, gravity=50.0, rest=0.4, limit=0.5, friction=4.0)
TORQUE = Joint("torque", gain=1.0, damping=3.0, gravity=20.0, rest=-0.5, friction=2.0)


def _command(joint: Joint, samples: int = 1500) -> np.ndarray:
    t = TS * np.arange(samples)
    waves = 1.4 * np.sin(1.1 * t) + 0.8 * np.sin(2.3 * t + 1.0)
    return waves if joint.loop == "position" else 8.0 * waves


def _record(joint: Joint, unit: float = 1.0, turned: bool = False) -> Data:
    """A record of a joint with 0.3 % of noise; `turned` with an encoder that counts against the torque."""
    command = _command(joint)
    start = float(command[0]) if joint.loop == "position" else joint.rest
    angle = run_joint(joint, command, TS, start)[:, 0]
    angle += 0.003 * np.std(angle) * np.random.default_rng(1).standard_normal(angle.size)
    u = unit * command if joint.loop == "position" else command
    return scaled(u, -unit * angle if turned else unit * angle, np.ones(u.size, bool), TS)


def _trials(data: Data, *names: str) -> list[Trial]:
    base = fit_baseline(data, LINEAR, None)
    return joint_trials(data, base, fit_highpass(data, base), names)


def _named(trial: Trial) -> dict[str, float]:
    return dict(zip((one.name for one in trial.hypothesis.parameters), trial.point.theta, strict=True))


@pytest.mark.parametrize(
    "unit", [pytest.param(1.0, id="radians", marks=pytest.mark.exhaustive), pytest.param(180.0 / np.pi, id="degrees")]
)
def test_the_joint_of_a_position_loop_is_found(unit: float) -> None:
    data = _record(LOOP, unit)
    best = _trials(data, "gravity", "coulomb-friction", "force-limit")[0]
    found = _named(best)
    in_angle = data.u_scale.unit / unit
    assert np.exp(found["log_k"]) == pytest.approx(LOOP.gain * TS**2, rel=0.4)
    assert found["torque"] * in_angle == pytest.approx(LOOP.gravity / LOOP.gain, rel=0.1)
    assert found["limit"] * in_angle == pytest.approx(LOOP.limit, rel=0.15)
    assert found["friction"] * in_angle == pytest.approx(LOOP.friction / LOOP.gain, rel=0.3)
    assert np.exp(found["log_turn"]) == pytest.approx(in_angle)
    assert np.sqrt(best.point.cost) < 0.05  # of the spread of the output; the noise is 0.003


@pytest.mark.parametrize(
    "turned", [pytest.param(False, id="same-sign", marks=pytest.mark.exhaustive), pytest.param(True, id="turned")]
)
def test_the_joint_that_a_torque_drives_is_found(turned: bool) -> None:
    data = _record(TORQUE, turned=turned)
    best = _trials(data, "gravity", "coulomb-friction")[0]
    found = _named(best)
    assert found["torque"] * data.u_scale.unit == pytest.approx(TORQUE.gravity, rel=0.1)
    assert found["friction"] * data.u_scale.unit == pytest.approx(TORQUE.friction, rel=0.3)
    assert np.exp(found["log_c"]) == pytest.approx(TORQUE.damping * TS, rel=0.3)
    assert np.sqrt(best.point.cost) < 0.01


def test_a_joint_that_swings_once_and_slowly_is_found() -> None:
    """The inertia hardly shows, and friction holds the joint for a third of the record."""
    t = TS * np.arange(700)
    command = 22.0 * np.sin(0.9 * t)
    angle = run_joint(TORQUE, command, TS, TORQUE.rest)[:, 0]
    noisy = angle + 0.005 * np.std(angle) * np.random.default_rng(2).standard_normal(t.size)
    data = scaled(command, noisy, np.ones(t.size, bool), TS)
    best = _trials(data, "gravity", "coulomb-friction")[0]
    found = _named(best)
    assert found["torque"] * data.u_scale.unit == pytest.approx(TORQUE.gravity, rel=0.15)
    assert found["friction"] * data.u_scale.unit == pytest.approx(TORQUE.friction, rel=0.3)
    assert np.sqrt(best.point.cost) < 0.02


def test_each_record_has_its_own_initial_states() -> None:
    one = _record(LOOP)
    late = 200 + int(np.argmax(np.abs(one.y[220:900] - one.y[200:880])))  # the second record begins in fast motion
    u, y = (np.concatenate([x, np.zeros(5), x[late:]]) for x in (one.u, one.y))
    second = one.samples + 5  # behind samples of neither
    pieces = ((0, one.samples), (second, u.size))
    data = replace(one, u=u, y=y, rows=np.ones(u.size, bool), pieces=pieces)
    base = fit_baseline(data, Hypothesis((Restarts(records=pieces[1:]),), 1), None)
    trials = joint_trials(data, base, fit_highpass(data, base), ("gravity", "coulomb-friction", "force-limit"))
    found = _named(trials[0])
    position = data.u_scale.of(np.asarray(data.y_scale.back(data.y)))
    assert found["z0 2"] == pytest.approx(position[second] - data.u[0], abs=0.01)
    assert found["z0"] == pytest.approx(position[0] - data.u[0], abs=0.01)
    slope = np.polyfit(np.arange(15), position[second : second + 15], 1)[0]
    unit = force_unit(np.exp(found["log_c"]), np.exp(found["log_k"]))
    assert found["v0 2"] * np.sqrt(unit) == pytest.approx(slope, rel=0.3)


def test_a_record_of_no_angle_has_no_such_starts() -> None:
    data = _record(LOOP, unit=1e-3)
    assert _trials(data, "gravity", "coulomb-friction", "force-limit") == []


def test_a_limit_without_a_loop_has_no_such_starts() -> None:
    assert _trials(_record(TORQUE), "gravity", "force-limit") == []
