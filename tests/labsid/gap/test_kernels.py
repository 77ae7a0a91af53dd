"""The compiled loops, against scipy's integrators and filters, and by hand."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap import _kernels

Held = Callable[[FloatArray, FloatArray, Callable[[FloatArray, float], list[float]]], FloatArray]


@pytest.fixture(scope="module")
def w() -> FloatArray:
    """Levels, each held for a few samples."""
    return np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 20), 6)


def test_second_order_is_the_filter_with_a_sample_of_delay(w: FloatArray) -> None:
    expected = lfilter([0.0, 1.0], [1.0, -1.5, 0.6], w)
    np.testing.assert_allclose(_kernels.second_order(w, -1.5, 0.6), expected, atol=1e-12)


def test_section_holds_both_numerator_terms_and_both_initial_states(w: FloatArray) -> None:
    columns = _kernels.section(w, -1.5, 0.6)
    once = lfilter([0.0, 1.0], [1.0, -1.5, 0.6], w)
    free = lfilter([1.0], [1.0, -1.5, 0.6], np.eye(1, w.size)[0])
    later = np.concatenate([[0.0], once[:-1]]), np.concatenate([[0.0], free[:-1]])
    np.testing.assert_allclose(columns, np.column_stack([once, later[0], free, later[1]]), atol=1e-12)


def test_first_order_has_gain_one(w: FloatArray) -> None:
    np.testing.assert_allclose(_kernels.first_order(w, 0.8), lfilter([0.0, 0.2], [1.0, -0.8], w), atol=1e-12)


def test_whiten_is_the_moving_average_filter_of_every_column(w: FloatArray) -> None:
    X = np.column_stack([w, w[::-1]])
    expected = lfilter([1.0, -0.7, 0.2], [1.0], X, axis=0)
    np.testing.assert_allclose(_kernels.whiten(X, np.array([0.7, -0.2])), expected, atol=1e-12)
    np.testing.assert_array_equal(_kernels.whiten(X, np.zeros(0)), X)


def test_backlash_by_hand() -> None:
    w = np.array([0.0, 1.0, 2.0, 1.5, 0.0, -1.0])
    np.testing.assert_allclose(_kernels.backlash(w, 1.0, 0.5), [0.0, 0.5, 1.5, 1.5, 0.5, -0.5])


def test_where_in_the_play_a_record_begins() -> None:
    still = np.zeros(3)
    np.testing.assert_allclose(_kernels.backlash(still, 1.0, 0.0), -0.5)
    np.testing.assert_allclose(_kernels.backlash(still, 1.0, 1.0), 0.5)


def test_backlash_never_leaves_the_play_and_moves_only_when_it_is_taken_up(w: FloatArray) -> None:
    out = _kernels.backlash(w, 0.6, 0.5)
    assert np.abs(w - out).max() <= 0.3 + 1e-12
    moved = np.flatnonzero(np.diff(out) != 0.0) + 1
    assert 0 < moved.size < w.size
    np.testing.assert_allclose(np.abs(w - out)[moved], 0.3)


def test_rate_limit_by_hand() -> None:
    w = np.array([0.0, 1.0, 1.0, 1.0, 1.0, -1.0])
    # 0.8 to 1 within the first half of sample 3, then at rest: its mean is 0.95.
    np.testing.assert_allclose(_kernels.rate_limit(w, 0.4, 0.0), [0.0, 0.2, 0.6, 0.95, 1.0, 0.8])


def test_rate_limit_is_the_mean_of_the_slewing_actuator(w: FloatArray) -> None:
    fine, now, means = 4000, w[0], []
    for value in w:
        way = np.arange(fine) / fine * 0.13 * np.sign(value - now)
        path = now + np.where(np.abs(way) < abs(value - now), way, value - now)
        means.append(path.mean())
        now += np.clip(value - now, -0.13, 0.13)
    np.testing.assert_allclose(_kernels.rate_limit(w, 0.13, float(w[0])), means, atol=1e-4)


def run_tanks(w: FloatArray, roots: tuple[bool, bool], brims: tuple[float, float], share: float) -> FloatArray:
    """Lower level from (0.6, 0.5), by the compiled loop."""
    return _kernels.tanks(w, 0.3, 0.2, *roots, *brims, share, 0.6, 0.5, 16)


@pytest.mark.parametrize("roots", [(False, False), (True, False), (False, True), (True, True)])
def test_tanks_without_a_brim(w: FloatArray, held: Held, roots: tuple[bool, bool]) -> None:
    flow = 0.9 + 0.5 * w

    def filling(h: FloatArray, value: float) -> list[float]:
        out = [np.sqrt(level) if root else level for level, root in zip(h, roots, strict=True)]
        return [0.3 * (value - out[0]), 0.2 * (out[0] - out[1])]

    expected = held(flow, np.array([0.6, 0.5]), filling)[:, 1]
    np.testing.assert_allclose(run_tanks(flow, roots, (np.inf, np.inf), 0.0), expected, atol=1e-4)


@pytest.mark.parametrize(
    ("brims", "share"), [((0.7, np.inf), 0.0), ((0.7, np.inf), 0.6), ((np.inf, 0.8), 0.0), ((0.7, 0.75), 1.0)]
)
@pytest.mark.parametrize("root", [False, True])
def test_tanks_overflow_and_the_lower_one_catches_a_share(
    w: FloatArray, brims: tuple[float, float], share: float, root: bool
) -> None:
    """Against Euler's method with 1,000 steps a sample, what flows over counted by the balance of the upper tank."""
    flow, fine = 0.9 + 0.5 * w, 1000
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
    level = _kernels.tanks(np.full(200, -1.0), 0.3, 0.2, True, True, np.inf, np.inf, 0.0, 0.6, 0.5, 8)
    assert np.all(level >= 0.0)
    assert level[-1] < 1e-3


def test_tanks_that_diverge_end_in_nan(w: FloatArray) -> None:
    level = _kernels.tanks(w, 50.0, 0.2, False, False, np.inf, np.inf, 0.0, 0.6, 0.5, 2)
    assert np.isfinite(level[0])
    assert np.isnan(level[-1])


SPRINGS = [(0.5, 0.05), (0.2, 0.3), (0.4, 0.04), (0.3, 1e-9), (1e-6, 1e-9), (3.0, 8.0)]


@pytest.mark.parametrize(("c", "k"), SPRINGS)
def test_linear_mechanics_is_exact_over_any_step(w: FloatArray, held: Held, c: float, k: float) -> None:
    """Over-damped, under-damped, on the limit, without a spring, without anything."""
    expected = held(w, np.array([0.3, -0.1]), lambda x, value: [x[1], value - c * x[1] - k * x[0]])
    for substeps in (1, 3):
        motion = _kernels.mechanics(w, c, k, 0.0, 0.0, 0.3, -0.1, substeps)
        np.testing.assert_allclose(motion, expected, rtol=2e-5, atol=2e-5 * np.abs(expected).max(axis=0).max())


@pytest.mark.parametrize("cubic", [0.4, -0.005])
def test_mechanics_with_a_cubic_spring(w: FloatArray, held: Held, cubic: float) -> None:
    def spring(x: FloatArray, value: float) -> list[float]:
        return [x[1], 0.4 * value - 0.3 * x[1] - 0.2 * x[0] - cubic * x[0] ** 3]

    expected = held(w, np.array([0.3, -0.1]), spring)
    motion = _kernels.mechanics(0.4 * w, 0.3, 0.2, 0.0, cubic, 0.3, -0.1, 12)
    np.testing.assert_allclose(motion, expected, atol=2e-3)


def test_a_softening_spring_that_gives_way_ends_in_nan() -> None:
    motion = _kernels.mechanics(np.full(400, 3.0), 0.3, 0.2, 0.0, -0.05, 0.0, 0.0, 4)
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
    coarse, fine = (_kernels.mechanics(w, c, k, friction, 0.0, 0.4, 0.2, n)[:, 0] for n in (6, 48))
    scale = expected[:, 0].std()
    assert np.abs(coarse - expected[:, 0]).max() < 0.03 * scale
    assert np.abs(fine - expected[:, 0]).max() < 0.004 * scale
    assert np.all(np.diff(fine)[stuck][1:] < 1e-3 * scale)


def test_a_mass_that_sticks_does_not_creep() -> None:
    motion = _kernels.mechanics(np.full(50, 0.2), 0.3, 0.2, 0.25, 0.0, 0.0, 0.0, 4)
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
    motion = _kernels.speed(w, a, b, friction, lag_first, 0.3, start, 3)
    np.testing.assert_allclose(motion[:, 0], expected, atol=0.006)
    assert 5 < (motion[:, 1] == 0.0).sum() < 100


def test_varying_rates_are_exact_from_sample_to_sample(w: FloatArray) -> None:
    c, k = np.linspace(0.5, 0.2, w.size), np.linspace(0.05, 0.3, w.size)
    inputs = np.column_stack([w, np.ones(w.size)])
    x, expected = np.zeros((3, 2)), []
    for values, damping, spring in zip(inputs, c, k, strict=True):
        expected.append(x[:2].T.reshape(-1))
        x[2] = values
        x = expm(np.array([[0.0, 1.0, 0.0], [-spring, -damping, 1.0], [0.0, 0.0, 0.0]])) @ x
    np.testing.assert_allclose(_kernels.varying(inputs, c, k), expected, atol=1e-9)


def test_varying_rates_that_diverge_end_in_nan() -> None:
    motion = _kernels.varying(np.ones((200, 1)), np.full(200, -1.0), np.full(200, 0.1))
    assert np.isnan(motion[-1, 0])
