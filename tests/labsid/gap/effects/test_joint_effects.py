"""Gravity, limits in the loop of a drive and friction that grows with the load, against scipy and on records."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from gap_search import searched
from scipy.integrate import solve_ivp

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.dynamics import _states
from labsid.gap.dynamics.plant_form import NO_SPRING
from labsid.gap.effects.base import Fitted
from labsid.gap.effects.context import Context, unit_step_response
from labsid.gap.effects.families import CANDIDATES
from labsid.gap.effects.gravity import DEGREES, Gravity, angle_unit
from labsid.gap.fits.fitting import fit_from, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.known_scales import implied_count, known_bounds, known_gains
from labsid.gap.fits.linear_fits import fit_baseline, fit_highpass
from labsid.gap.model_file import from_json_dict
from labsid.gap.record.data import scaled
from labsid.gap.search.sets import SETS, set_around, set_fits
from labsid.records.record import Record
from labsid.rig.switchable.joints import SLIP, Joint, run_joint

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = (
    "input-saturation",
    "input-backlash",
    "resonance",
    "coulomb-friction",
    "cubic-stiffness",
    "gravity",
    "force-limit",
    "output-nonlinearity",
    "output-backlash",
)
"""Those of a joint, and those with which they may be confused."""

TS = 0.02
Load = Callable[[float, float, float], float]


@pytest.fixture(scope="module")
def goal() -> FloatArray:
    """Goal angles from -1.2 to 1.2 rad, each held for 15 to 40 samples."""
    rng = np.random.default_rng(8)
    return np.repeat(rng.uniform(-1.2, 1.2, 60), rng.integers(15, 41, 60))[:750]


def servo(
    goal: FloatArray,
    k: float = 60.0,
    d: float = 9.0,
    gravity: float = 0.0,
    friction: float = 0.0,
    limit: float = np.inf,
    share: float = 0.0,
    rest: float = 0.0,
    speed: bool = False,
    damped: float = 0.0,
    own: float | None = None,
) -> FloatArray:
    """Angle of a pendulum in a position loop, or of one in a speed loop, by scipy; friction turns over 1 mrad/s.

    `damped` is the share of the damping that the position loop gives, so that it is limited, too. The force that
    is transmitted is that of the drive, which gives the share `own` of the stiffness, or all but friction and damping.
    """

    def flow(t: float, x: FloatArray, value: float) -> list[float]:
        q, v = x
        asked = d * (value - v) if speed else k * (value - q) - damped * d * v
        drive = min(max(asked, -limit), limit) - (0.0 if speed else (1.0 - damped) * d * v)
        weight = gravity * np.sin(q - rest)
        transmitted = drive - weight + (0.0 if speed else d * v)
        if own is not None:
            transmitted = k * (value - own * q) if abs(asked) < limit else drive + d * v
        return [v, drive - weight - (friction + share * abs(transmitted)) * np.tanh(v / 1e-3)]

    found = [np.array([[0.0 if speed else goal[0], 0.0]])]
    changes = np.flatnonzero(np.diff(goal[:-1])) + 1
    for start, stop in pairwise([0, *changes, goal.size - 1]):
        solved = solve_ivp(
            flow,
            (0.0, TS * (stop - start)),
            found[-1][-1],
            args=(goal[start],),
            method="LSODA",
            t_eval=TS * np.arange(1, stop - start + 1),
            rtol=1e-7,
            atol=1e-9,
        )
        found.append(solved.y.T)
    return np.concatenate(found)[:, 0]


@pytest.mark.parametrize(
    "load",
    [
        {"gravity": 40.0},
        {"gravity": 90.0, "rest": 0.7},
        {"limit": 25.0},
        {"limit": 25.0, "damped": 1.0},
        {"limit": 25.0, "damped": 0.8, "gravity": 10.0},
        {"gravity": 40.0, "friction": 6.0},
        {"gravity": 40.0, "friction": 6.0, "limit": 45.0},
        {"gravity": 40.0, "friction": 3.0, "limit": 45.0, "share": 0.2},
        {"gravity": 40.0, "friction": 3.0, "limit": 45.0, "share": 0.2, "own": 1.0},
        {"friction": 3.0, "share": 0.3, "own": 0.4},
    ],
    ids=lambda load: "+".join(load),
)
def test_a_pendulum_in_a_position_loop(goal: FloatArray, load: dict[str, float]) -> None:
    expected = servo(goal, **load)
    k, c = 60.0 * TS**2, 9.0 * TS
    joint = (
        load.get("limit", np.inf) * TS**2,
        1.0,
        load.get("damped", 0.0),
        load.get("gravity", 0.0) * TS**2,
        1.0,
        load.get("rest", 0.0),
        load.get("share", 0.0),
        0.0,
        load.get("own", _states.ALL_FORCES),
    )
    friction = load.get("friction", 0.0) * TS**2
    found = _states.simulate_mass(k * goal, c, k, friction, 0.0, float(goal[0]), 0.0, 6, joint=joint)
    np.testing.assert_allclose(found[:, 0], expected, atol=4e-3 * np.ptp(expected))


@pytest.mark.parametrize("limit", [3.0, 8.0])
def test_a_speed_loop_at_its_limit(goal: FloatArray, limit: float) -> None:
    expected = servo(goal, limit=limit, speed=True)
    c = 9.0 * TS
    joint = (limit * TS**2, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, _states.ALL_FORCES)
    found = _states.simulate_mass(c * TS * goal, c, 0.0, 0.0, 0.0, 0.0, 0.0, 8, joint=joint)
    np.testing.assert_allclose(found[:, 0], expected, atol=5e-3 * np.ptp(expected))


def record_of(goal: FloatArray, y: FloatArray, noise: float = 0.003) -> Record:
    """A record with white noise, a share of the spread."""
    noisy = y + noise * np.std(y) * np.random.default_rng(1).standard_normal(y.size)
    return Record(TS * np.arange(goal.size), goal, noisy, TS)


@pytest.mark.parametrize(
    "unit", [pytest.param(1.0, id="radians", marks=pytest.mark.exhaustive), pytest.param(DEGREES, id="degrees")]
)
@searched(*FEW)
def test_gravity_is_named_with_its_torque_and_angle_and_its_export_plays(goal: FloatArray, unit: float) -> None:
    """Also stronger than the spring of the loop; the angle of rest is 0.5 rad."""
    y = unit * servo(goal, gravity=70.0, rest=0.5)
    record = record_of(unit * goal, y)
    found = diagnose(record)
    (effect,) = found.report["effects"]
    assert (found.report["verdict"], effect["name"]) == ("effect", "gravity")
    values = {name: one["value"] for name, one in effect["parameters"].items()}
    assert values["torque"] == pytest.approx(unit * 70.0 / 60.0, rel=0.03)
    assert values["angle"] == pytest.approx(unit * 0.5, rel=0.05)
    assert values["per_radian"] == pytest.approx(unit)
    assert effect["parameters"]["per_radian"]["stderr"] == pytest.approx(0.0, abs=1e-9)
    played = from_json_dict(found.model.to_json_dict()).simulate(record.u, record.y)
    assert np.std((played - y)[50:]) < 0.02 * np.std(y)


@pytest.mark.parametrize(
    "damped", [pytest.param(0.0, marks=pytest.mark.exhaustive), pytest.param(1.0, marks=pytest.mark.exhaustive), 0.85]
)
@searched(*FEW)
def test_a_limit_in_the_loop_is_named(goal: FloatArray, damped: float) -> None:
    """Of the position error alone, of the whole force of a PD controller, or with damping outside of it besides."""
    y = servo(goal, limit=25.0, damped=damped)
    report = diagnose(record_of(goal, y)).report
    (effect,) = report["effects"]
    assert (report["verdict"], effect["name"]) == ("effect", "force-limit")
    assert effect["parameters"]["limit"]["value"] == pytest.approx(25.0 / 60.0, rel=0.03)


@pytest.mark.parametrize("load", [pytest.param(0.0, marks=pytest.mark.exhaustive), 0.02])
@searched(*FEW)
def test_the_limit_of_a_loop_of_first_order_is_named(load: float) -> None:
    """A speed of 0.1 w' = clip(0.3 (u - w), 6) - load w, mostly at its limit: a linear model finds no pole of it."""
    u = np.repeat(np.random.default_rng(5).uniform(20.0, 180.0, 16), 75)
    w, steps = np.empty(u.size), 20
    speed = 100.0
    for n, goal in enumerate(u):
        w[n] = speed
        for _ in range(steps):
            torque = min(max(0.3 * (goal - speed), -6.0), 6.0)
            speed += TS / steps * (torque - load * speed) / 0.1
    y = w + 0.2 * np.random.default_rng(6).standard_normal(u.size)
    report = diagnose(record_of(u, y)).report
    (effect,) = report["effects"]
    assert (report["verdict"], effect["name"]) == ("effect", "force-limit")
    assert effect["parameters"]["limit"]["value"] == pytest.approx(20.0, rel=0.05)
    assert report["gap"]["after"] < 0.25


def test_a_set_finds_the_three_effects_of_a_joint(goal: FloatArray) -> None:
    y = servo(goal, gravity=50.0, friction=8.0, limit=45.0)
    record = record_of(goal, y)
    data = scaled(record.u, record.y, np.ones(goal.size, bool), TS)
    base = fit_baseline(data)
    names = ("gravity", "coulomb-friction", "force-limit")
    fits = {frozenset(fit.hypothesis.names): fit for fit in set_fits(data, base, fit_highpass(data, base), CANDIDATES)}
    fit = fits[frozenset(names)]
    assert rms(data, fit) < 0.02
    assert rms(data, fit) < 0.2 * rms(data, base)
    found = {
        name: value.value
        for effect in fit.hypothesis.effects
        for name, value in effect.values(Fitted.of(fit, data)).items()
    }
    assert found["torque"] == pytest.approx(50.0 / 60.0, rel=0.1)
    assert found["friction"] == pytest.approx(8.0 / 60.0, rel=0.15)
    assert found["limit"] == pytest.approx(45.0 / 60.0, rel=0.1)


@pytest.mark.parametrize(("law", "own"), [("load", None), ("drive", 1.0)])
def test_friction_that_grows_with_the_load_is_fitted(goal: FloatArray, law: str, own: float | None) -> None:
    """With all that the gear transmits, or with the force of the drive alone."""
    y = servo(goal, gravity=50.0, friction=2.0, share=0.25, own=own)
    data = scaled(goal, y, np.ones(goal.size, bool), TS)
    (group,) = (group for group in CANDIDATES if group[0].name == "coulomb-friction")
    hypothesis = Hypothesis((Gravity(), type(group[0])(f"position-{law}")))
    given = {
        "log_c": np.log(9.0 * TS),
        "log_k": np.log(60.0 * TS**2),
        "torque": 50.0 / 60.0 / data.u_scale.unit,
        "log_turn": np.log(data.u_scale.unit),
        "angle": -goal[0],
        "friction": 0.02,
        "load_share": 0.1,
        "driven_share": 0.8,
    }
    start = np.array([given.get(parameter.name, 0.0) for parameter in hypothesis.parameters])
    fit = fit_from(data, hypothesis, start, iterations=30)
    assert fit is not None
    values = hypothesis.effects[1].values(Fitted.of(fit, data))
    assert values["load"].value == pytest.approx(0.25, rel=0.1)
    assert values["friction"].value == pytest.approx(2.0 / 60.0, rel=0.15)


@pytest.mark.parametrize(("swing", "unit"), [(0.1, 0.0), (2.0, 1.0), (12.0, 1.0), (90.0, DEGREES), (2e3, 0.0)])
def test_the_unit_of_the_angle_follows_from_its_range(swing: float, unit: float) -> None:
    y = np.linspace(3.0, 3.0 + swing, 400)
    assert angle_unit(scaled(y, y, np.ones(400, bool), TS)) == unit


def test_the_gain_and_the_unit_of_the_angle_of_a_position_loop_are_not_estimated(goal: FloatArray) -> None:
    data = scaled(goal, 0.5 * goal, np.ones(goal.size, bool), TS)
    hypothesis = Hypothesis((Gravity(),))
    assert known_gains(data, hypothesis) == pytest.approx(data.u_scale.unit / data.y_scale.unit)
    place = hypothesis.slices["plant"].start + hypothesis.plant.index("log_turn")
    lower, upper = known_bounds(data, hypothesis)
    assert lower[place] == upper[place] == pytest.approx(np.log(data.u_scale.unit))
    free = Hypothesis((Gravity("unsprung"),))
    assert known_gains(data, free).size == 0
    stiffness = free.slices["plant"].start + free.plant.index("log_k")
    lower, upper = known_bounds(data, free)
    assert lower[stiffness] == upper[stiffness] == NO_SPRING
    np.testing.assert_array_equal(np.flatnonzero(lower == upper), [stiffness])


def test_without_a_spring_neither_the_gain_nor_the_zero_of_the_angle_is_counted() -> None:
    """Otherwise a softening spring, which has neither, would win over a pendulum that fits as well."""
    assert implied_count(Hypothesis((Gravity(),))) == 0
    assert implied_count(Hypothesis((Gravity("unsprung"),))) == 2


@searched(*FEW)
def test_the_numbers_of_a_pendulum_are_within_their_errors() -> None:
    """0.02 q'' = u - 0.03 q' - 0.981 sin q, which turns slowly: a unit of the angle far from the search's start."""
    u = np.repeat(np.random.default_rng(5).uniform(-0.6, 0.6, 30), 80)
    q = np.empty(u.size)
    state = np.zeros(2)
    for n, torque in enumerate(u):
        q[n] = state[0]
        law = lambda _, x, torque=torque: [x[1], (torque - 0.03 * x[1] - 0.981 * np.sin(x[0])) / 0.02]  # noqa: E731
        state = solve_ivp(law, (0.0, 0.01), state, rtol=1e-9, atol=1e-11).y[:, -1]
    y = q + 0.003 * np.random.default_rng(6).standard_normal(u.size)
    (effect,) = diagnose(Record(0.01 * np.arange(u.size), u, y, 0.01)).report["effects"]
    assert effect["name"] == "gravity"
    for name, true in {"torque": 0.981, "angle": 0.0, "per_radian": 1.0}.items():
        found = effect["parameters"][name]
        assert abs(found["value"] - true) < 4.0 * found["stderr"]
        assert found["stderr"] < 0.003


@pytest.mark.parametrize(
    ("gain", "range_", "applies"), [(0.5, 1.0, True), (30.0, 1.0, False), (0.5, 0.01, False), (0.2, 2.0, False)]
)
def test_gravity_needs_an_angle_that_follows_its_command(
    goal: FloatArray, two_poles: Callable[..., FloatArray], gain: float, range_: float, applies: bool
) -> None:
    u = range_ * goal
    noise = 0.01 * range_ * np.random.default_rng(2).standard_normal(u.size)
    data = scaled(u, gain * two_poles(u) + gain * noise, np.ones(u.size, bool), TS)
    base = fit_baseline(data)
    assert Gravity().applies(Context(data, base, base)) == applies


def test_an_output_follows_its_command_also_where_its_linear_model_swings_on(
    goal: FloatArray, two_poles: Callable[..., FloatArray]
) -> None:
    """The value at the end of a step response without damping is one of its phase, and may be negative."""
    data = scaled(goal, 0.5 * two_poles(goal), np.ones(goal.size, bool), TS)
    base = fit_baseline(data)
    for rate in 0.01, 0.02, 0.04:
        swinging = replace(base, theta=np.array([0.0, -14.0, 2.0 * np.log(rate)]))
        gains = np.eye(1, base.gains.size)[0]
        step = unit_step_response(swinging.hypothesis, swinging.theta, gains, 2000)
        assert np.ptp(step[-1000:]) > 1.5 * step.mean()
        assert Context(data, replace(swinging, gains=0.5 * gains / step.mean()), base).follows


def test_a_set_is_found_in_an_explanation_that_contains_it() -> None:
    names = frozenset({"gravity", "coulomb-friction", "resonance"})
    assert set_around("gravity", names) == {"gravity", "coulomb-friction"}
    assert set_around("resonance", names) == frozenset()
    assert set_around("gravity", names | {"force-limit"}) == {"gravity", "coulomb-friction", "force-limit"}
    assert all(one.reason.endswith(".") for one in SETS)
    assert {name for one in SETS for name in one.names} <= {group[0].name for group in CANDIDATES}


@pytest.mark.parametrize(("law", "share"), [("dahl", 0.0), ("gear", 0.25)])
def test_a_mass_with_friction_that_gives(goal: FloatArray, law: str, share: float) -> None:
    """Against the Runge-Kutta method of the rigs; rigid friction differs by far more."""
    joint = Joint("position", gain=64.0, damping=9.6, law=law, friction=4.0, excess=share)
    expected = run_joint(joint, goal, TS, float(goal[0]))[:, 0] - goal[0]
    k, c = joint.gain * TS**2, joint.damping * TS

    def error(stiff: float) -> float:
        own = (np.inf, 1.0, 0.0, 0.0, 0.0, 0.0, share, stiff, _states.ALL_FORCES)
        drive, friction = k * (goal - goal[0]), joint.friction * TS**2
        found = _states.simulate_mass(drive, c, k, friction, 0.0, 0.0, 0.0, 10, joint=own)[:, 0]
        return float(np.sqrt(np.mean((found - expected) ** 2)))

    bent = error(joint.friction / SLIP * TS**2)
    assert bent < (6e-4 if share else 1e-4)
    assert error(0.0) > 15.0 * bent


def test_a_mass_whose_friction_gives_and_is_larger_at_rest() -> None:
    """Against the LuGre model of the rigs, whose bristles are damped; each half of the law alone is worse."""
    t = TS * np.arange(2000)
    goal = 0.8 * np.sin(1.1 * t) + 0.4 * np.sin(2.3 * t + 1.0)
    joint = Joint("position", gain=64.0, damping=9.6, law="lugre", friction=4.0, excess=0.6)
    expected = run_joint(joint, goal, TS, float(goal[0]))[:, 0] - goal[0]
    k, c, friction = joint.gain * TS**2, joint.damping * TS, joint.friction * TS**2

    def error(peak: float, stiff: float) -> float:
        law = (0.0, peak * friction, joint.stribeck * TS)
        own = (np.inf, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, stiff, _states.ALL_FORCES)
        drive = k * (goal - goal[0])
        found = _states.simulate_mass(drive, c, k, friction, 0.0, 0.0, 0.0, 4, law=law, joint=own)[:, 0]
        return float(np.sqrt(np.mean((found - expected) ** 2)))

    both = error(0.6, friction / SLIP)
    assert both < 2e-3
    assert min(error(0.0, friction / SLIP), error(0.6, 0.0)) > 2.0 * both


def test_a_motor_with_friction_that_gives(goal: FloatArray) -> None:
    joint = Joint("speed", gain=8.0, damping=0.4, law="dahl", friction=2.0)
    expected = run_joint(joint, goal, TS)[:, 1]
    rate = joint.gain + joint.damping

    def error(stiff: float) -> float:
        drive, friction = goal * joint.gain / rate, joint.friction / rate
        found = _states.simulate_motor(
            drive, rate * TS, 1e3, friction, False, 0.0, 0.0, 16, bristles=(0.0, stiff / rate)
        )[:, 1]
        return float(np.sqrt(np.mean((found - expected) ** 2)))

    bent = error(joint.friction / SLIP * TS)
    assert bent < 1e-4
    assert error(0.0) > 50.0 * bent


@searched(*FEW)
def test_friction_that_gives_is_friction_with_its_way_and_no_mode(goal: FloatArray) -> None:
    """The bristles of a rigid law would be left as a lightly damped mode, or as play."""
    joint = Joint("position", gain=64.0, damping=9.6, law="dahl", friction=6.0)
    record = record_of(goal, run_joint(joint, goal, TS, float(goal[0]))[:, 0])
    found = diagnose(record)
    (effect,) = found.report["effects"]
    assert (found.report["verdict"], effect["name"]) == ("effect", "coulomb-friction")
    values = {name: one["value"] for name, one in effect["parameters"].items()}
    assert values["friction"] == pytest.approx(joint.friction / joint.gain, rel=0.1)
    assert values["give"] == pytest.approx(SLIP, rel=0.5)
    played = found.model.simulate(record.u, record.y)
    assert np.std(played - record.y) < 1.05 * 0.003 * np.std(record.y)
