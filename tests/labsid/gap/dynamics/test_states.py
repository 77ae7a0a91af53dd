"""The compiled loops of the dynamics, against scipy's integrators and matrix exponential, and by hand."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _rates, _states

UNLOADED = (0.0, None, None, None)
"""Arguments of a loop for an input that changes at the samples, without loads and drifts."""

Held = Callable[[FloatArray, FloatArray, Callable[[FloatArray, float], list[float]]], FloatArray]


@pytest.fixture(scope="module")
def w() -> FloatArray:
    """Levels, each held for a few samples."""
    return np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 20), 6)


def run_tanks(w: FloatArray, roots: tuple[bool, bool], brims: tuple[float, float], share: float) -> FloatArray:
    """Lower level from (0.6, 0.5), by the compiled loop."""
    return _states.simulate_tanks(w, 0.3, 0.2, *roots, *brims, share, 0.6, 0.5, 16)


@pytest.mark.parametrize("roots", [(False, False), (True, False), (False, True), (True, True)])
def test_tanks_without_a_brim(w: FloatArray, held: Held, roots: tuple[bool, bool]) -> None:
    flow = 0.9 + 0.5 * w

    def filling(h: FloatArray, value: float) -> list[float]:
        out = [np.sqrt(level) if root else level for level, root in zip(h, roots, strict=True)]
        return [0.3 * (value - out[0]), 0.2 * (out[0] - out[1])]

    expected = held(flow, np.array([0.6, 0.5]), filling)[:, 1]
    np.testing.assert_allclose(run_tanks(flow, roots, (np.inf, np.inf), 0.0), expected, atol=1e-4)


@pytest.mark.parametrize("root", [False, True])
def test_a_tank_overflows_the_more_the_higher_its_level_is_over_a_weir(w: FloatArray, held: Held, root: bool) -> None:
    flow = 0.9 + 0.5 * w

    def filling(h: FloatArray, value: float) -> list[float]:
        out = np.sqrt(np.maximum(h, 0.0)) if root else h
        over = 5.0 * max(h[1] - 0.8, 0.0) ** 1.5
        return [0.3 * (value - out[0]), 0.2 * (out[0] - out[1] - over)]

    expected = held(flow, np.array([0.6, 0.5]), filling)[:, 1]
    own = 0.3, 0.2, root, root, np.inf, 0.8, 0.0, 0.6, 0.5, 16
    np.testing.assert_allclose(_states.simulate_tanks(flow, *own, *UNLOADED, 5.0), expected, atol=1e-3)
    assert expected.max() > 0.9
    assert np.abs(_states.simulate_tanks(flow, *own) - expected).max() > 0.1


@pytest.mark.parametrize(
    ("brims", "share"), [((0.7, np.inf), 0.0), ((0.7, np.inf), 0.6), ((np.inf, 0.8), 0.0), ((0.7, 0.75), 1.0)]
)
@pytest.mark.parametrize("root", [False, True])
def test_tanks_overflow_and_the_lower_one_catches_a_share(
    w: FloatArray, brims: tuple[float, float], share: float, root: bool
) -> None:
    """Against Euler's method with 400 steps a sample, what flows over counted by the balance of the upper tank."""
    flow, fine = 0.9 + 0.5 * w, 400
    h1, h2, expected, over = 0.6, 0.5, [], 0
    for value in flow:
        expected.append(h2)
        for _ in range(fine):
            f1, f2 = (h1**0.5, h2**0.5) if root else (h1, h2)
            spilling = h1 >= brims[0] and value > f1
            into = f1 + (share * (value - f1) if spilling else 0.0)
            h1 = min(h1 + 0.3 * (value - f1) / fine, brims[0])
            h2 = min(h2 + 0.2 * (into - f2) / fine, brims[1])
            over += spilling or h2 == brims[1]
    assert over > 5 * fine
    np.testing.assert_allclose(run_tanks(flow, (root, root), brims, share), expected, atol=4e-3)


def test_an_empty_tank_stays_empty() -> None:
    level = _states.simulate_tanks(np.full(200, -1.0), 0.3, 0.2, True, True, np.inf, np.inf, 0.0, 0.6, 0.5, 8)
    assert np.all(level >= 0.0)
    assert level[-1] < 1e-3


@pytest.mark.parametrize("root", [False, True])
def test_diverging_tanks_return_nan(root: bool) -> None:
    level = _states.simulate_tanks(np.full(100, 2e6), 0.3, 0.2, root, False, np.inf, np.inf, 0.0, 0.6, 0.5, 2)
    assert np.isfinite(level[0])
    assert np.isnan(level[-1])


@pytest.mark.parametrize("rates", [(40.0, 0.2), (3.0, 0.2), (0.2, 40.0), (90.0, 90.0)])
def test_fast_linear_tanks_are_accurate(w: FloatArray, rates: tuple[float, float]) -> None:
    """With as few steps as `responses` takes: the slower tank moves by a tenth of the way in half of one."""
    flow, substeps = 0.9 + 0.5 * w, int(max(np.ceil(min(rates) / 0.2), 2))
    (a, b), state, expected = rates, np.array([0.6, 0.5]), []
    system = np.array([[-a, 0.0, a], [b, -b, 0.0], [0.0, 0.0, 0.0]])
    for value in flow:
        expected.append(state[1])
        state = (expm(system) @ [*state, value])[:2]
    found = _states.simulate_tanks(flow, a, b, False, False, np.inf, np.inf, 0.0, 0.6, 0.5, substeps)
    np.testing.assert_allclose(found, expected, atol=0.025 if b > 1.0 > a else 5e-4)


@pytest.mark.parametrize("rate", [0.3, 4.0, 60.0])
@pytest.mark.parametrize(("level", "brim"), [(0.2, 0.7), (0.7, 0.7), (0.2, 2.0)])
def test_a_linear_tank_at_its_overflow_conserves_mass(rate: float, level: float, brim: float) -> None:
    """The inflow equals the change of level plus the outflow plus the overflow."""
    flow, share, h, fine = 1.5, 0.4, 0.5, 20_000
    now, below, over = level, 0.0, 0.0
    for _ in range(fine):  # Euler's method
        out = now
        now += rate * h / fine * (flow - out)
        spilt = max(now - brim, 0.0)
        now -= spilt
        below += out / fine
        over += spilt / (rate * h)
    found, leaving = _states.step_linear_tank(level, flow, rate, np.exp(-rate * h), brim, share, h)
    assert found == pytest.approx(now, abs=1e-3)
    assert leaving == pytest.approx(below + share * over, abs=1e-3)


@pytest.mark.parametrize("lag", [0.7, 5.0, 20.0])
def test_a_motor_receives_the_mean_of_a_fast_lag(w: FloatArray, held: Held, lag: float) -> None:
    """Half of the change in a step, as of a slow lag, would be up to half a step too little."""
    expected = held(w, np.array([0.3, 0.1]), lambda x, value: [0.4 * (x[1] - x[0]), lag * (value - x[1])])[:, 0]
    for substeps, error in ((1, 0.012), (2, 0.004)):
        found = _states.simulate_motor(w, 0.4, lag, 0.0, True, 0.3, 0.1, substeps)[:, 0]
        np.testing.assert_allclose(found, expected, atol=error)


SPRINGS = [(0.5, 0.05), (0.2, 0.3), (0.4, 0.04), (0.3, 1e-9), (1e-6, 1e-9), (3.0, 8.0)]


@pytest.mark.parametrize(("c", "k"), SPRINGS)
def test_linear_mechanics_is_exact_over_any_step(w: FloatArray, held: Held, c: float, k: float) -> None:
    """Over-damped, under-damped, on the limit, without a spring, without anything."""
    expected = held(w, np.array([0.3, -0.1]), lambda x, value: [x[1], value - c * x[1] - k * x[0]])
    for substeps in (1, 3):
        motion = _states.simulate_mass(w, c, k, 0.0, 0.0, 0.3, -0.1, substeps)
        np.testing.assert_allclose(motion, expected, rtol=2e-5, atol=2e-5 * np.abs(expected).max(axis=0).max())


@pytest.mark.parametrize("cubic", [0.4, -0.005])
def test_mechanics_with_a_cubic_spring(w: FloatArray, held: Held, cubic: float) -> None:
    def spring(x: FloatArray, value: float) -> list[float]:
        return [x[1], 0.4 * value - 0.3 * x[1] - 0.2 * x[0] - cubic * x[0] ** 3]

    expected = held(w, np.array([0.3, -0.1]), spring)
    motion = _states.simulate_mass(0.4 * w, 0.3, 0.2, 0.0, cubic, 0.3, -0.1, 12)
    np.testing.assert_allclose(motion, expected, atol=2e-3)


def test_a_spring_that_swings_quickly_is_followed_with_few_steps(held: Held) -> None:
    """At a ninth of the sampling rate: error within two thousandths with three steps a sample."""
    w = 0.3 * np.random.default_rng(4).standard_normal(300)

    def spring(x: FloatArray, value: float) -> list[float]:
        return [x[1], value - 0.07 * x[1] - 0.49 * x[0] - 0.02 * x[0] ** 3]

    expected = held(w, np.zeros(2), spring)[:, 0]
    followed = _states.simulate_mass(w, 0.07, 0.49, 0.0, 0.02, 0.0, 0.0, 3)[:, 0]
    assert 0.02 * np.mean(expected**4) > 0.02 * 0.49 * np.mean(expected**2)  # it does harden
    assert np.std(followed - expected) < 2e-3 * np.std(expected)


def test_a_diverging_softening_spring_returns_nan() -> None:
    motion = _states.simulate_mass(np.full(400, 3.0), 0.3, 0.2, 0.0, -0.05, 0.0, 0.0, 4)
    assert np.isnan(motion[-1, 0])


def stick_slip(
    w: FloatArray, state: FloatArray, friction: float, net: Callable[[FloatArray, float], float], at: int
) -> FloatArray:
    """States at the samples where `net` less dry friction accelerates state[at]; it sticks where `net` is too weak."""
    states = [np.asarray(state, float)]

    def flow(t: float, x: FloatArray, value: float, sign: float) -> list[float]:
        pull = net(x, value) - friction * sign
        return [x[1], pull] if at == 1 else [pull]

    for value in w[:-1]:
        x, t = states[-1].copy(), 0.0
        while t < 1.0:
            sign = np.sign(x[at])
            if sign == 0.0:
                pull = net(x, value)
                if abs(pull) <= friction:
                    break
                sign = np.sign(pull)

            def stops(t: float, x: FloatArray, value: float, sign: float) -> float:
                return float(x[at])

            stops.terminal, stops.direction = True, -sign
            solved = solve_ivp(flow, (t, 1.0), x, args=(value, sign), events=stops, rtol=1e-9, atol=1e-12)
            x, t = solved.y[:, -1].copy(), float(solved.t[-1])
            if solved.status == 1:
                x[at] = 0.0
        states.append(x)
    return np.array(states)


def test_mechanics_with_friction_slips_turns_and_sticks(w: FloatArray) -> None:
    c, k, friction = 0.3, 0.2, 0.25
    expected = stick_slip(w, np.array([0.4, 0.2]), friction, lambda x, value: value - c * x[1] - k * x[0], 1)
    stuck = np.all(np.diff(expected, axis=0) == 0.0, axis=1)
    assert 5 < stuck.sum() < 100
    coarse, fine = (_states.simulate_mass(w, c, k, friction, 0.0, 0.4, 0.2, n)[:, 0] for n in (6, 48))
    scale = expected[:, 0].std()
    assert np.abs(coarse - expected[:, 0]).max() < 0.03 * scale
    assert np.abs(fine - expected[:, 0]).max() < 0.004 * scale
    assert np.all(np.diff(fine)[stuck][1:] < 1e-3 * scale)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7])
def test_a_mass_rebounds_from_a_stop_and_comes_to_rest_there(w: FloatArray, share: float) -> None:
    c, k, stop = 0.3, 0.2, 0.8
    x, expected, hits = np.array([0.4, 0.2]), [], 0

    def hit(t: float, x: FloatArray, value: float) -> float:
        return float(x[0] - stop)

    hit.terminal, hit.direction = True, 1.0
    for value in w:
        expected.append(x[0])
        t = 0.0
        while t < 1.0:
            if x[0] >= stop and abs(x[1]) < 1e-3 and value > k * stop:
                x = np.array([stop, 0.0])  # it is pressed against the stop
                break
            flow = lambda t, x, value: [x[1], value - c * x[1] - k * x[0]]  # noqa: E731
            solved = solve_ivp(flow, (t, 1.0), x, args=(value,), events=hit, rtol=1e-9, atol=1e-12)
            x, t = solved.y[:, -1].copy(), float(solved.t[-1])
            if solved.status == 1:
                x, hits = np.array([stop, -share * x[1]]), hits + 1
    coarse, fine = (
        _states.simulate_mass(
            w, c, k, 0.0, 0.0, 0.4, 0.2, n, 0.0, None, None, None, _states.SHARP, 0.0, (-np.inf, stop, share)
        )
        for n in (6, 96)
    )
    assert hits >= 3
    assert np.abs(coarse[:, 0] - expected).max() < 0.1 * np.std(expected)
    assert np.abs(fine[:, 0] - expected).max() < 0.01 * np.std(expected)


def test_a_mass_that_sticks_does_not_creep() -> None:
    motion = _states.simulate_mass(np.full(50, 0.2), 0.3, 0.2, 0.25, 0.0, 0.0, 0.0, 4)
    np.testing.assert_array_equal(motion, 0.0)


@pytest.mark.parametrize("lag_first", [True, False])
def test_speed_with_friction_and_a_lag(w: FloatArray, lag_first: bool) -> None:
    a, b, friction, clock = 0.4, 0.7, 0.25, 32
    keep = np.exp(-b / clock)
    steps = np.repeat(w, clock)

    def lagged(signal: FloatArray, start: float) -> FloatArray:
        """Behind the lag, on a clock so fast that the mean over a step will do."""
        return start + lfilter([0.0, 1.0 - keep], [1.0, -keep], signal - start)

    def moved(drive: FloatArray) -> FloatArray:
        """The speed on the fast clock."""
        return stick_slip(drive, np.array([0.3]), friction * a / clock, lambda v, x: a / clock * (x - v[0]), 0)[:, 0]

    def middle(signal: FloatArray) -> FloatArray:
        return np.append(0.5 * (signal[:-1] + signal[1:]), signal[-1])

    start = 0.1 if lag_first else 0.3
    expected = (moved(middle(lagged(steps, start))) if lag_first else lagged(middle(moved(steps)), start))[::clock]
    motion = _states.simulate_motor(w, a, b, friction, lag_first, 0.3, start, 3)
    np.testing.assert_allclose(motion[:, 0], expected, atol=0.006)
    assert 5 < (motion[:, 1] == 0.0).sum() < 100


@pytest.mark.parametrize("smooth", [0.05, 0.2, 0.6])
def test_friction_that_is_smooth_about_rest(w: FloatArray, held: Held, smooth: float) -> None:
    c, k, friction, a = 0.3, 0.2, 0.25, 0.3
    law = smooth, 0.0, 1.0

    def mass(x: FloatArray, value: float) -> list[float]:
        return [x[1], value - c * x[1] - k * x[0] - friction * float(np.tanh(x[1] / smooth))]

    def motor(x: FloatArray, value: float) -> list[float]:
        return [a * (value - x[0] - friction * float(np.tanh(x[0] / smooth)))]

    moved = held(w, np.array([0.4, 0.2]), mass)
    found = _states.simulate_mass(w, c, k, friction, 0.0, 0.4, 0.2, 8, *UNLOADED, law)
    np.testing.assert_allclose(found, moved, atol=0.02 * moved[:, 0].std())
    turned = held(w, np.array([0.3]), motor)[:, 0]
    found = _states.simulate_motor(w, a, 1e3, friction, True, 0.3, float(w[0]), 6, *UNLOADED, law)
    np.testing.assert_allclose(found[:, 1], turned, atol=0.01)


def test_friction_with_a_break_away_peak() -> None:
    """A slow ramp of force: the mass and the motor start at the peak and jump, because they then slide more easily."""
    ramp = np.linspace(0.0, 1.0, 400)
    law = 0.0, 0.2, 0.05
    motor = _states.simulate_motor(ramp, 0.5, 1e3, 0.3, True, 0.0, 0.0, 12, *UNLOADED, law)[:, 1]
    mass = _states.simulate_mass(ramp, 1.0, 1e-6, 0.3, 0.0, 0.0, 0.0, 12, *UNLOADED, law)[:, 1]
    for speed in (motor, mass):
        start = int(np.argmax(speed > 0.0))
        assert ramp[start] == pytest.approx(0.5, abs=0.01)
        assert speed[start + 15] == pytest.approx(ramp[start + 14] - 0.3, abs=0.02)


@pytest.mark.parametrize(("share", "turn"), [(0.0, 0.0), (0.7, 0.4)])
def test_varying_rates_are_exact_from_sample_to_sample(w: FloatArray, share: float, turn: float) -> None:
    """Driven from zero by each force, then free from z = 1 and from z' = 1."""
    course = 0.6 * np.sin(np.linspace(0.0, 4.0, w.size))
    change = np.expm1(course)
    c, k = 0.5 * (1.0 + share * change), 0.05 * (1.0 + change) + 0.5 * turn * np.gradient(change)
    k = np.maximum(k, 1e-11)
    forces = np.column_stack([w, w * course, np.ones(w.size), course])
    x, expected = np.zeros((3, 6)), []
    x[0, 4] = x[1, 5] = 1.0
    for values, damping, spring in zip(forces, c, k, strict=True):
        expected.append([*x[:2, :2].T.flat, *x[0, 2:]])
        x[2, :4] = values
        x = expm(np.array([[0.0, 1.0, 0.0], [-spring, -damping, 1.0], [0.0, 0.0, 0.0]])) @ x
    found = _rates.simulate_varying(w, course, change, 0.5, 0.05, share, turn)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_rates_stay_within_their_bounds() -> None:
    assert _rates.changed_rates(0.5, 0.1, 1.0, -2.0) == (1e-6, 1e-11)
    assert _rates.changed_rates(0.5, 0.1, 1.0, 1e4) == (50.0, 90.0)
    assert _rates.changed_rates(0.5, 0.1, 0.5, 1.0) == (0.75, 0.2)


@pytest.mark.parametrize("onset", [0.0, 40.0, 60.3, 1e3])
def test_rates_that_step_are_exact_from_sample_to_sample(w: FloatArray, onset: float) -> None:
    """As `scipy.linalg.expm` over each part of a sample, with a drop and a step of the speed between them."""
    kick, push = 0.3, 0.2
    before, after = (0.5, 0.05), (0.3, 0.2)
    x, expected = np.zeros((3, 5)), []
    x[0, 3] = x[1, 4] = 1.0

    def advance(x: FloatArray, rates: tuple[float, float], time: float) -> FloatArray:
        c, k = rates
        return expm(np.array([[0.0, 1.0, 0.0], [-k, -c, 1.0], [0.0, 0.0, 0.0]]) * time) @ x

    for n, value in enumerate(w):
        expected.append(x[:2].T.reshape(-1))
        x[2, :2] = value, 1.0
        x = advance(x, before, min(max(onset - n, 0.0), 1.0))
        if n <= onset < n + 1:
            x[1] -= kick * x[0]
            x[1, 2], x[2, 2] = push, 1.0
        x = advance(x, after, min(max(n + 1 - onset, 0.0), 1.0))
    forces = np.column_stack([w, np.ones(w.size)])
    found = _rates.simulate_stepped(forces, *zip(before, after, strict=True), onset, kick, push)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def faster(w: FloatArray, times: int, late: float) -> FloatArray:
    """`w` on a clock so many times as fast, each level later by `late` of an old sample."""
    fine = np.repeat(w, times)
    steps = round(late * times)
    return np.concatenate([np.full(steps, w[0]), fine])[: fine.size]


def tanks_of(w: FloatArray, clock: int, substeps: int, late: float) -> FloatArray:
    """Roots and brims, on a clock so many times as fast."""
    own = (True, True, 0.9, 0.8, 0.5, 0.6, 0.5)
    level = _states.simulate_tanks(0.9 + 0.5 * w, 0.3 / clock, 0.2 / clock, *own, substeps, late)
    return level[::clock, None]


def mass_of(w: FloatArray, clock: int, substeps: int, late: float) -> FloatArray:
    """Friction and a cubic spring: forces count with the square of the clock, the speed with the clock itself."""
    unit = clock**2
    own = (0.3 / clock, 0.2 / unit, 0.1 / unit, 0.05 / unit, 0.4, 0.2 / clock)
    motion = _states.simulate_mass(w / unit, *own, substeps, late)
    return motion[::clock] * [1.0, clock]


def motor_of(w: FloatArray, clock: int, substeps: int, late: float) -> FloatArray:
    """A motor whose drive lags."""
    return _states.simulate_motor(w, 0.4 / clock, 0.7 / clock, 0.2, True, 0.3, 0.1, substeps, late)[::clock]


@pytest.mark.parametrize(("late", "times"), [(0.5, 2), (0.3, 10), (1.0, 1)])
@pytest.mark.parametrize("run", [tanks_of, mass_of, motor_of])
def test_an_input_that_changes_within_a_sample_is_one_on_a_faster_clock(
    w: FloatArray, run: Callable[..., FloatArray], late: float, times: int
) -> None:
    expected = run(faster(w, times, late), times, 2, 0.0)
    np.testing.assert_allclose(run(w, 1, 2 * times, late), expected, atol=1e-9)
    assert np.abs(run(w, 1, 2 * times, 0.0) - expected).max() > 0.01


def test_a_change_within_a_step_of_the_loop_counts_by_its_mean(w: FloatArray) -> None:
    """A quarter of a sample late is half of the first of two steps."""
    exact = _states.simulate_mass(w, 0.5, 0.05, 0.0, 0.0, 0.3, -0.1, 4, 0.25)
    np.testing.assert_allclose(_states.simulate_mass(w, 0.5, 0.05, 0.0, 0.0, 0.3, -0.1, 2, 0.25), exact, atol=0.04)
    np.testing.assert_allclose(_states.simulate_mass(w, 0.5, 0.05, 0.0, 0.0, 0.3, -0.1, 1, 0.25), exact, atol=0.12)
    assert np.abs(_states.simulate_mass(w, 0.5, 0.05, 0.0, 0.0, 0.3, -0.1, 1, 0.0) - exact).max() > 0.4


ONSET = 50
LOADS = [(0.2, 0.0), (0.0, 0.4), (0.15, -0.3)]  # load, leak


def begun(w: FloatArray, load: float, leak: float, at: float = ONSET) -> tuple[FloatArray, FloatArray]:
    """A load and a leak from the sample `at` on."""
    active = np.clip(np.arange(1, w.size + 1) - at, 0.0, 1.0)
    return load * active, leak * active


@pytest.mark.parametrize(("load", "leak"), LOADS)
@pytest.mark.parametrize("root", [False, True])
def test_a_load_on_the_lower_tank(w: FloatArray, held: Held, root: bool, load: float, leak: float) -> None:
    flow = 0.9 + 0.5 * w

    def filling(h: FloatArray, sample: float) -> list[float]:
        out = np.sqrt(np.maximum(h, 0.0)) if root else h
        lost = load + leak * h[1] if sample >= ONSET else 0.0
        return [0.3 * (flow[int(sample)] - out[0]), 0.2 * (out[0] - out[1] - lost)]

    expected = held(np.arange(w.size, dtype=float), np.array([0.6, 0.5]), filling)[:, 1]
    brims = (np.inf, np.inf, 0.0)
    found = _states.simulate_tanks(flow, 0.3, 0.2, root, root, *brims, 0.6, 0.5, 16, 0.0, *begun(w, load, leak))
    without = _states.simulate_tanks(flow, 0.3, 0.2, root, root, *brims, 0.6, 0.5, 16)
    np.testing.assert_array_equal(found[: ONSET + 1], without[: ONSET + 1])
    np.testing.assert_allclose(found, expected, atol=4e-3)
    assert np.abs(found - without).max() > 0.05


@pytest.mark.parametrize(("load", "leak"), LOADS)
def test_a_load_on_a_mass(w: FloatArray, held: Held, load: float, leak: float) -> None:
    c, k, cubic = 0.3, 0.2, 0.05

    def spring(x: FloatArray, sample: float) -> list[float]:
        lost = load + leak * k * x[0] if sample >= ONSET else 0.0
        return [x[1], 0.4 * w[int(sample)] - c * x[1] - k * x[0] - cubic * x[0] ** 3 - lost]

    expected = held(np.arange(w.size, dtype=float), np.array([0.3, -0.1]), spring)
    found = _states.simulate_mass(0.4 * w, c, k, 0.0, cubic, 0.3, -0.1, 16, 0.0, *begun(w, load, leak))
    np.testing.assert_allclose(found, expected, atol=2e-3)
    assert np.abs(found - _states.simulate_mass(0.4 * w, c, k, 0.0, cubic, 0.3, -0.1, 16)).max() > 0.05


@pytest.mark.parametrize(("load", "leak"), LOADS)
def test_a_load_on_a_mass_and_on_a_motor_that_stick(w: FloatArray, load: float, leak: float) -> None:
    c, k, friction, samples = 0.3, 0.2, 0.25, np.arange(w.size, dtype=float)

    def lost(sample: float, state: float) -> float:
        return load + leak * state if sample >= ONSET else 0.0

    def force(x: FloatArray, sample: float) -> float:
        return float(w[int(sample)] - c * x[1] - k * x[0] - lost(sample, k * x[0]))

    expected = stick_slip(samples, np.array([0.4, 0.2]), friction, force, 1)[:, 0]
    found = _states.simulate_mass(w, c, k, friction, 0.0, 0.4, 0.2, 48, 0.0, *begun(w, load, leak))[:, 0]
    assert np.abs(found - expected).max() < 0.01 * expected.std()

    def drive(v: FloatArray, sample: float) -> float:
        return float(0.4 * (w[int(sample)] - v[0] - lost(sample, v[0])))

    expected = stick_slip(samples, np.array([0.3]), 0.4 * friction, drive, 0)[:, 0]
    found = _states.simulate_motor(w, 0.4, 0.7, friction, False, 0.3, 0.3, 24, 0.0, *begun(w, load, leak))[:, 1]
    np.testing.assert_allclose(found, expected, atol=4e-3)
    assert np.abs(found - _states.simulate_motor(w, 0.4, 0.7, friction, False, 0.3, 0.3, 24)[:, 1]).max() > 0.03


def test_the_sample_in_which_a_load_begins_counts_in_part(w: FloatArray) -> None:
    """A load on a mass or on a motor without a lag ahead is that much less input."""
    at = 50.25
    less = w - 0.3 * np.clip(np.arange(1, w.size + 1) - at, 0.0, 1.0)
    found = _states.simulate_mass(w, 0.3, 0.2, 0.1, 0.05, 0.4, 0.2, 4, 0.0, *begun(w, 0.3, 0.0, at))
    np.testing.assert_allclose(found, _states.simulate_mass(less, 0.3, 0.2, 0.1, 0.05, 0.4, 0.2, 4), atol=1e-12)
    found = _states.simulate_motor(w, 0.4, 0.7, 0.1, False, 0.3, 0.3, 3, 0.0, *begun(w, 0.3, 0.0, at))
    np.testing.assert_allclose(found, _states.simulate_motor(less, 0.4, 0.7, 0.1, False, 0.3, 0.3, 3), atol=1e-12)


WAVE = 0.2, -0.1, 0.37  # cosine, sine, radians a sample


def swing(sample: float) -> float:
    """The wave in the middle of a sample."""
    phase = WAVE[2] * (int(sample) + 0.5)
    return float(WAVE[0] * np.cos(phase) + WAVE[1] * np.sin(phase))


SWINGING = 0.0, np.array([swing(sample) for sample in range(120)])  # not late


@pytest.mark.parametrize("root", [False, True])
def test_a_wave_at_the_lower_tank(w: FloatArray, held: Held, root: bool) -> None:
    flow = 0.9 + 0.5 * w

    def filling(h: FloatArray, sample: float) -> list[float]:
        out = np.sqrt(np.maximum(h, 0.0)) if root else h
        return [0.3 * (flow[int(sample)] - out[0]), 0.2 * (out[0] - out[1] - swing(sample))]

    expected = held(np.arange(w.size, dtype=float), np.array([0.6, 0.5]), filling)[:, 1]
    own = (0.3, 0.2, root, root, np.inf, np.inf, 0.0, 0.6, 0.5, 16)
    np.testing.assert_allclose(_states.simulate_tanks(flow, *own, *SWINGING), expected, atol=1e-4)
    assert np.abs(_states.simulate_tanks(flow, *own) - expected).max() > 0.05


def test_a_wave_at_a_mass(w: FloatArray, held: Held) -> None:
    def spring(x: FloatArray, sample: float) -> list[float]:
        return [x[1], 0.4 * w[int(sample)] - swing(sample) - 0.3 * x[1] - 0.2 * x[0] - 0.05 * x[0] ** 3]

    expected = held(np.arange(w.size, dtype=float), np.array([0.3, -0.1]), spring)
    found = _states.simulate_mass(0.4 * w, 0.3, 0.2, 0.0, 0.05, 0.3, -0.1, 16, *SWINGING)
    np.testing.assert_allclose(found, expected, atol=2e-3)


@pytest.mark.parametrize("lag_first", [True, False])
def test_a_wave_at_a_motor(w: FloatArray, held: Held, lag_first: bool) -> None:
    def turning(x: FloatArray, sample: float) -> list[float]:
        drive, follows = (x[1], w[int(sample)]) if lag_first else (w[int(sample)], x[0])
        return [0.4 * (drive - swing(sample) - x[0]), 0.7 * (follows - x[1])]

    expected = held(np.arange(w.size, dtype=float), np.array([0.3, 0.1]), turning)
    found = _states.simulate_motor(w, 0.4, 0.7, 0.0, lag_first, 0.3, 0.1, 32, *SWINGING)
    np.testing.assert_allclose(found[:, 1], expected[:, 0], atol=1e-4)
    np.testing.assert_allclose(found[:, 0], expected[:, 0 if lag_first else 1], atol=1e-4)


def test_a_sinusoid_on_a_sticking_state_equals_less_input(w: FloatArray) -> None:
    less = w - [swing(sample) for sample in range(w.size)]
    found = _states.simulate_mass(w, 0.3, 0.2, 0.1, 0.05, 0.4, 0.2, 4, *SWINGING)
    np.testing.assert_allclose(found, _states.simulate_mass(less, 0.3, 0.2, 0.1, 0.05, 0.4, 0.2, 4), atol=1e-12)
    found = _states.simulate_motor(w, 0.4, 0.7, 0.1, False, 0.3, 0.3, 3, *SWINGING)
    np.testing.assert_allclose(found, _states.simulate_motor(less, 0.4, 0.7, 0.1, False, 0.3, 0.3, 3), atol=1e-12)


PACE = np.exp(np.linspace(-0.5, 0.7, 120))  # of a rate that drifts, one value a sample


@pytest.mark.parametrize("root", [False, True])
def test_a_lower_tank_whose_outflow_drifts(w: FloatArray, held: Held, root: bool) -> None:
    flow = 0.9 + 0.5 * w

    def filling(h: FloatArray, sample: float) -> list[float]:
        out = np.sqrt(h) if root else h
        return [0.3 * (flow[int(sample)] - out[0]), 0.2 * PACE[int(sample)] * (out[0] - out[1])]

    expected = held(np.arange(w.size, dtype=float), np.array([0.6, 0.5]), filling)[:, 1]
    own = (0.3, 0.2, root, root, np.inf, np.inf, 0.0, 0.6, 0.5, 16)
    np.testing.assert_allclose(_states.simulate_tanks(flow, *own, pace=PACE), expected, atol=1e-4)
    assert np.abs(_states.simulate_tanks(flow, *own) - expected).max() > 0.03


def test_a_hardening_spring_that_drifts(w: FloatArray, held: Held) -> None:
    def spring(x: FloatArray, sample: float) -> list[float]:
        return [x[1], 0.4 * w[int(sample)] - 0.3 * x[1] - 0.2 * PACE[int(sample)] * x[0] - 0.05 * x[0] ** 3]

    expected = held(np.arange(w.size, dtype=float), np.array([0.3, -0.1]), spring)
    found = _states.simulate_mass(0.4 * w, 0.3, 0.2, 0.0, 0.05, 0.3, -0.1, 16, pace=PACE)
    np.testing.assert_allclose(found, expected, atol=2e-3)


@pytest.mark.parametrize("lag_first", [True, False])
def test_a_motor_of_which_the_latter_rate_drifts(w: FloatArray, held: Held, lag_first: bool) -> None:
    """The states are the speed and the lag."""

    def turning(x: FloatArray, sample: float) -> list[float]:
        pace, command = PACE[int(sample)], w[int(sample)]
        if lag_first:
            return [0.4 * pace * (x[1] - x[0]), 0.7 * (command - x[1])]
        return [0.4 * (command - x[0]), 0.7 * pace * (x[0] - x[1])]

    expected = held(np.arange(w.size, dtype=float), np.array([0.3, 0.1]), turning)
    found = _states.simulate_motor(w, 0.4, 0.7, 0.0, lag_first, 0.3, 0.1, 32, pace=PACE)
    np.testing.assert_allclose(found[:, 1], expected[:, 0], atol=1e-4)
    np.testing.assert_allclose(found[:, 0], expected[:, 0 if lag_first else 1], atol=1e-4)


def test_drifting_rates_with_friction(w: FloatArray) -> None:
    """A mass on a spring, and a motor: within a sample it is the motor of another rate."""
    friction, samples = 0.25, np.arange(w.size, dtype=float)

    def force(x: FloatArray, sample: float) -> float:
        return float(w[int(sample)] - 0.3 * x[1] - 0.2 * PACE[int(sample)] * x[0])

    expected = stick_slip(samples, np.array([0.4, 0.2]), friction, force, 1)[:, 0]
    found = _states.simulate_mass(w, 0.3, 0.2, friction, 0.0, 0.4, 0.2, 48, pace=PACE)[:, 0]
    assert np.abs(found - expected).max() < 0.01 * expected.std()

    at_once = 1000.0  # rate of a lag that is none
    speeds = [0.3]
    for command, pace in zip(w[:-1], PACE, strict=False):
        still = np.full(2, command)
        onward = _states.simulate_motor(still, 0.4 * pace, at_once, friction, True, speeds[-1], command, 24)
        speeds.append(onward[1, 1])
    assert min(np.abs(speeds)) == 0.0
    found = _states.simulate_motor(w, 0.4, at_once, friction, True, 0.3, w[0], 24, pace=PACE)[:, 1]
    np.testing.assert_allclose(found, speeds, atol=2e-3)
