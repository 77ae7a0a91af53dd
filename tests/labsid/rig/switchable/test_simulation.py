"""The rigs against independent integrators and against physics that can be worked by hand."""

from dataclasses import replace

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from labsid.rig.switchable._motion import (
    HEATED_NEAR,
    MASS,
    MOTOR_POSITION,
    MOTOR_SPEED,
    PARALLEL_MODE,
    SERIES_MODE,
    STATE_COUNT,
    TWO_TANKS,
    move,
)
from labsid.rig.switchable.inputs import draw_input
from labsid.rig.switchable.plants import RIGS, Scales, draw_rig, time_scale
from labsid.rig.switchable.setup import Actuator, Load, Sensor, Setup, plain_motion
from labsid.rig.switchable.simulation import (
    Noise,
    UnboundedOutputError,
    dropout_intervals,
    noise_samples,
    plant_output,
    poles,
    simulate_setup,
)
from labsid.rig.switchable.truth import true_linear_model

QUIET = Noise(0.0)
UNITS = Scales(Ts=1.0, u0=0.0, us=1.0, y0=0.0, ys=1.0)


def levels(samples: int = 600, hold: int = 40, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.repeat(rng.uniform(-1, 1, samples // hold), hold)


def exact(right_hand_side, x0, v: np.ndarray, **changes) -> np.ndarray:
    """States at the samples, by scipy's adaptive integrator, one held level after the other."""
    x, states = np.array(x0, dtype=float), []
    for level in v:
        states.append(x)
        run = solve_ivp(right_hand_side, (0, 1), x, args=(level,), rtol=1e-10, atol=1e-12, **changes)
        x = run.y[:, -1]
    return np.array(states)


@pytest.mark.parametrize("rig", RIGS)
def test_every_rig_without_effects_is_its_transfer_function(rig: str) -> None:
    setup = draw_rig(np.random.default_rng(7), 1500, (rig,))
    v = levels()
    model = true_linear_model(setup, UNITS)
    G = control.tf(model["num"], model["den"], 1.0)
    expected = control.forced_response(G, np.arange(v.size), v).outputs
    y = simulate_setup(setup, v, QUIET).clean
    assert np.max(np.abs(y - expected)) < 1e-6 * np.ptp(expected)
    np.testing.assert_allclose(np.sort(np.abs(control.poles(G))), np.sort(np.abs(np.exp(poles(setup.motion)))))


def test_euler_simulation_comes_closer_with_more_steps() -> None:
    setup = draw_rig(np.random.default_rng(3), 1500, ("heater, near sensor",))
    right = np.array(true_linear_model(setup, UNITS)["den"])
    errors = [np.abs(np.array(true_linear_model(setup, UNITS, steps)["den"]) - right).max() for steps in (4, 40, 400)]
    assert errors[0] > 5 * errors[1] > 25 * errors[2] > 0


def test_torricelli_tanks_agree_with_scipy() -> None:
    root, T0, T1 = 0.8, 12.0, 30.0

    def tanks(t, x, w):
        out = 2 / root * (np.sqrt(1 + root * x) - 1)
        return [(w - out[0]) / T0, (out[0] - out[1]) / T1]

    v = levels()
    setup = Setup("two tanks", plain_motion(TWO_TANKS, T0, T1)._replace(outflow_curvature=root))
    np.testing.assert_allclose(plant_output(setup, v), exact(tanks, [0, 0], v)[:, 1], atol=1e-7)


def test_a_duffing_mass_with_a_mode_and_both_lags_agrees_with_scipy() -> None:
    T, zeta, cubic, w0, z0, la, ls = 9.0, 0.2, 1.5, 0.5, 0.05, 0.7, 1.9

    def mass(t, x, w):
        pull = x[0] + cubic * x[0] ** 3 + 2 * zeta * T * x[1]
        mode = w0**2 * (x[2] - x[4]) - 2 * z0 * w0 * x[5]
        return [x[1], (x[4] - pull) / T**2, (w - x[2]) / la, (x[0] - x[3]) / ls, x[5], mode]

    v = levels()
    v[:5] = 0.0
    motion = plain_motion(MASS, T, 1.0)._replace(
        damping=zeta,
        cubic=cubic,
        actuator_lag=la,
        sensor_lag=ls,
        mode=SERIES_MODE,
        mode_frequency=w0,
        mode_damping=z0,
    )
    y = plant_output(Setup("mass", motion), v)
    np.testing.assert_allclose(y, exact(mass, np.zeros(6), v)[:, 3], atol=2e-6)


def test_a_parallel_mode_adds_its_share() -> None:
    v = levels()
    plain = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 20.0))
    mode = plain.motion._replace(mode=PARALLEL_MODE, mode_frequency=0.3, mode_damping=0.02, mode_share=0.4)
    G = control.tf([0.3**2], [1, 2 * 0.02 * 0.3, 0.3**2])
    v = np.concatenate([np.zeros(3), v])
    fine = np.repeat(v, 50)
    added = control.forced_response(control.sample_system(G, 1 / 50), np.arange(fine.size) / 50, fine).outputs[::50]
    difference = plant_output(replace(plain, motion=mode), v) - plant_output(plain, v)
    np.testing.assert_allclose(difference, 0.4 * added, atol=1e-5)


def test_dry_friction_takes_two_of_itself_from_every_swing_and_then_sticks() -> None:
    """The textbook case: an undamped mass loses 2F of amplitude in every half period, and stops within F."""
    friction, T = 0.1, 10.0
    motion = plain_motion(MASS, T, 1.0)._replace(dry_friction=friction)
    y = plant_output(Setup("mass", motion), np.zeros(400), start=(1.03, 0.0))
    swings = [abs(y[round(np.pi * T * k)]) for k in range(1, 5)]
    np.testing.assert_allclose(swings, 1.03 - 2 * friction * np.arange(1, 5), atol=2e-3)
    assert np.ptp(y[200:]) < 1e-12
    assert abs(y[-1]) < friction


def test_a_motor_with_dry_friction_does_not_start_below_it() -> None:
    motion = plain_motion(MOTOR_SPEED, 1.5, 20.0)._replace(dry_friction=0.3)
    v = np.repeat([0.0, 0.25, 0.8], 200)
    y = plant_output(Setup("motor", motion), v)
    assert np.all(y[:400] == 0.0)
    assert y[-1] == pytest.approx(0.5, abs=1e-3)


def test_friction_with_another_value_each_way_takes_two_of_each_from_the_swings() -> None:
    friction, back, T = 0.1, 0.04, 10.0
    motion = plain_motion(MASS, T, 1.0)._replace(dry_friction=friction, friction_back=back / friction - 1.0)
    y = plant_output(Setup("mass", motion), np.zeros(400), start=(1.03, 0.0))
    swings = [abs(y[round(np.pi * T * k)]) for k in range(1, 5)]  # the first swing is backwards
    expected = 1.03 - 2 * np.cumsum([back, friction, back, friction])
    np.testing.assert_allclose(swings, expected, atol=2e-3)


def test_a_motor_with_a_break_away_peak_starts_above_it_and_then_slides_with_less() -> None:
    motion = plain_motion(MOTOR_SPEED, 1.5, 20.0)._replace(dry_friction=0.3, friction_peak=0.5, friction_speed=0.05)
    y = plant_output(Setup("motor", motion), np.repeat([0.0, 0.44, 0.46, 0.9], 200))
    assert np.all(y[:401] == 0.0)  # 0.44 is below 0.3 (1 + 0.5)
    assert y[599] == pytest.approx(0.16, abs=1e-3)
    assert y[799] == pytest.approx(0.6, abs=1e-3)


@pytest.mark.parametrize("kind", [MASS, MOTOR_POSITION, MOTOR_SPEED])
def test_friction_smooth_about_rest_agrees_with_scipy(kind: int) -> None:
    T0, T1, friction, back = 5.0, 18.0, 0.25, 0.4
    speed = 0.005 if kind == MASS else 0.03

    def moving(t, x, w):
        moved = x[0 if kind == MOTOR_POSITION else 1]
        resisted = friction * np.tanh(moved / speed) * (1 + back if moved < 0 else 1)
        if kind == MASS:
            return [x[1], (w - x[0] - 2 * 0.2 * T0 * x[1] - resisted) / T0**2]
        if kind == MOTOR_POSITION:
            return [(w - x[0] - resisted) / T0, (x[0] - x[1]) / T1]
        return [(w - x[0]) / T0, (x[0] - x[1] - resisted) / T1]

    v = levels(200)
    motion = plain_motion(kind, T0, T1)._replace(
        damping=0.2, dry_friction=friction, friction_back=back, friction_speed=speed
    )
    expected = exact(moving, [0, 0], v)[:, 0 if kind == MASS else 1]
    np.testing.assert_allclose(plant_output(Setup("a rig", motion), v), expected, atol=2e-5)


@pytest.mark.parametrize("rate", [0.6, 1.0, 1.7])
def test_a_motor_breaks_away_at_its_friction(rate: float) -> None:
    motion = plain_motion(MOTOR_SPEED, 1.5, 20.0)._replace(dry_friction=0.3)
    per_sample = 20
    w = np.repeat([0.0, 0.25, 0.35, 0.25, -0.8], 200 * per_sample)
    none = np.zeros(w.size)
    y = move(motion, np.zeros(STATE_COUNT), w, w, none, np.full(w.size, rate), none, per_sample)
    assert np.all(y[:400] == 0.0)
    np.testing.assert_allclose(y[[599, 799, 999]], [0.05, 0.0, -0.5], atol=2e-3)


@pytest.mark.parametrize("spill_share", [0.0, 0.4, 1.0])
def test_the_upper_tank_stops_at_its_brim_and_the_lower_gets_what_is_caught(spill_share: float) -> None:
    motion = plain_motion(TWO_TANKS, 8.0, 20.0)._replace(brim_upper=0.5, spill_share=spill_share)
    y = plant_output(Setup("two tanks", motion), np.repeat([0.0, 1.0], 400))
    assert y[-1] == pytest.approx(0.5 + spill_share * 0.5, abs=1e-6)


def test_the_lower_tank_leaves_its_brim_as_soon_as_more_runs_out_than_in() -> None:
    motion = plain_motion(TWO_TANKS, 1.5, 20.0)._replace(brim_lower=0.5)
    v = np.repeat([0.0, 1.0, 0.4], 200)
    y = plant_output(Setup("two tanks", motion), v)
    assert y.max() == 0.5
    assert y[402] == 0.5  # the upper tank delivers 0.4 + 0.6 exp(-k / 1.5), more than 0.5 until k = 2.7
    assert y[403] < 0.5


def exact_with_stops(accelerate, v: np.ndarray, low: float, high: float, restitution: float, start: float = 0.0):
    """Positions at the samples of a motion between two stops, by scipy's adaptive integrator and its events."""
    p, speed, resting, positions = start, 0.0, False, []
    for level in v:
        positions.append(p)
        now = 0.0
        while now < 1.0:
            if resting and accelerate(p, 0.0, level) * (1.0 if p == high else -1.0) >= 0.0:
                break
            resting = False

            def motion(t, x, level=level):
                return [x[1], accelerate(x[0], x[1], level)]

            def at_low(t, x):
                return x[0] - low

            def at_high(t, x):
                return high - x[0]

            for event in (at_low, at_high):
                event.terminal, event.direction = True, -1.0
            run = solve_ivp(motion, (now, 1.0), [p, speed], events=(at_low, at_high), rtol=1e-11, atol=1e-13)
            now, (p, speed) = run.t[-1], run.y[:, -1]
            if run.status == 1:
                p = low if run.t_events[0].size else high
                speed = -restitution * speed
                resting = abs(speed) < 1e-4
                speed = 0.0 if resting else speed
    return np.array(positions)


@pytest.mark.parametrize("restitution", [0.0, 0.2])
@pytest.mark.parametrize("zeta", [0.15, 1.2])
def test_a_mass_between_two_stops_agrees_with_scipy(restitution: float, zeta: float) -> None:
    T, low, high = 8.0, -0.35, 0.5
    motion = plain_motion(MASS, T, 1.0)._replace(damping=zeta, stop_low=low, stop_high=high, restitution=restitution)
    v = levels(hold=25)
    y = plant_output(Setup("mass", motion), v)
    expected = exact_with_stops(lambda p, s, w: (w - p - 2 * zeta * T * s) / T**2, v, low, high, restitution)
    np.testing.assert_allclose(y, expected, atol=1e-5)
    assert (y.min(), y.max()) == (low, high)
    assert 0.05 < np.mean((y == low) | (y == high)) < 0.8


def test_a_position_axis_between_two_stops_agrees_with_scipy() -> None:
    T0, T1, low, high = 6.0, 25.0, -0.3, 0.25
    motion = plain_motion(MOTOR_POSITION, T0, T1)._replace(stop_low=low, stop_high=high)
    v = levels()
    y = plant_output(Setup("motor", motion), v)
    expected = exact_with_stops(lambda p, s, w: (w - p - (T0 + T1) * s) / (T0 * T1), v, low, high, 0.0)
    np.testing.assert_allclose(y, expected, atol=1e-6)
    assert (y.min(), y.max()) == (low, high)


def test_the_way_back_from_a_stop_starts_when_the_force_turns_and_not_later_as_behind_a_clipping_sensor() -> None:
    motion = plain_motion(MASS, 8.0, 1.0)._replace(damping=1.0)
    v = np.repeat([0.0, 1.0, 0.4], 100)
    stopped = plant_output(Setup("mass", motion._replace(stop_high=0.5)), v)
    clipped = np.minimum(plant_output(Setup("mass", motion), v), 0.5)
    assert np.all(stopped[150:201] == 0.5)
    assert stopped[201] < 0.5
    assert np.all(clipped[200:210] == 0.5)


def test_a_stop_is_left_within_a_step_when_a_ramp_turns_the_force() -> None:
    """The force of the spring, 0.5, is met halfway down the ramp from 1 to 0, at sample 200."""
    motion = plain_motion(MASS, 8.0, 1.0)._replace(damping=1.0, stop_high=0.5)
    slow = Actuator(slew=0.01)
    y = plant_output(Setup("mass", motion, actuator=slow), np.repeat([1.0, 0.0], [150, 250]))
    assert np.all(y[149:201] == 0.5)
    # (p - 0.5)'' = -0.01 t / T^2 at first, so that the mass is 0.01 t^3 / (6 T^2) away after t samples
    assert 0.5 - y[202] == pytest.approx(0.01 * 2**3 / (6 * 64), rel=0.2)


def test_a_motion_that_starts_beyond_a_stop_is_put_on_it() -> None:
    motion = plain_motion(MASS, 8.0, 1.0)._replace(damping=1.0, stop_low=-0.2)
    y = plant_output(Setup("mass", motion), np.zeros(100), start=(-0.4, 0.0))
    assert y[0] == -0.2
    assert y[-1] == pytest.approx(0.0, abs=1e-3)


def test_end_stops_need_a_position_without_dry_friction() -> None:
    tank = Setup("two tanks", plain_motion(TWO_TANKS, 5.0, 20.0)._replace(stop_high=0.5))
    mass = Setup("mass", plain_motion(MASS, 5.0, 1.0)._replace(stop_high=0.5, dry_friction=0.1))
    for setup in (tank, mass):
        with pytest.raises(ValueError, match="end stops need a position without dry friction; got a"):
            plant_output(setup, np.zeros(10))


@pytest.mark.parametrize("kind", [MASS, MOTOR_POSITION, MOTOR_SPEED])
def test_quadratic_drag_agrees_with_scipy(kind: int) -> None:
    T0, T1, drag, zero = 5.0, 18.0, {MASS: 20.0, MOTOR_POSITION: 300.0, MOTOR_SPEED: 0.9}[kind], 0.2

    def moving(t, x, w):
        if kind == MASS:
            return [x[1], (w - x[0] - 2 * 0.2 * T0 * x[1] - drag * x[1] * abs(x[1])) / T0**2]
        speed = (x[0] - x[1]) / T1
        if kind == MOTOR_POSITION:
            return [(w - x[0] - drag * speed * abs(speed)) / T0, speed]
        total = x[1] + zero
        return [(w - x[0]) / T0, speed - drag * (total * abs(total) - zero * abs(zero)) / T1]

    v = levels()
    motion = plain_motion(kind, T0, T1)._replace(drag=drag, damping=0.2, speed_zero=zero)
    y = plant_output(Setup("a rig", motion), v)
    expected = exact(moving, [0, 0], v)[:, 0 if kind == MASS else 1]
    np.testing.assert_allclose(y, expected, atol=2e-6)
    assert np.std(y - plant_output(Setup("a rig", motion._replace(drag=0.0)), v)) > 0.05 * np.std(y)


@pytest.mark.parametrize("kind", [HEATED_NEAR, MASS, TWO_TANKS])
def test_a_slow_mode_adds_its_share(kind: int) -> None:
    plain = Setup("a rig", plain_motion(kind, 4.0, 20.0)._replace(damping=0.3, loss=0.2))
    slow = replace(plain, motion=plain.motion._replace(slow_time=150.0, slow_share=-0.3))
    v = np.concatenate([np.zeros(5), levels()])
    pole = np.exp(-1 / 150.0)
    added = lfilter([0.0, 1 - pole], [1, -pole], v)
    np.testing.assert_allclose(plant_output(slow, v) - plant_output(plain, v), -0.3 * added, atol=1e-9)


@pytest.mark.parametrize("start", [0.0, -0.8])
def test_play_at_the_output_follows_the_process_between_the_samples(start: float) -> None:
    width, T, zeta, per_sample = 0.3, 2.0, 0.05, 160
    v = levels()
    G = control.sample_system(control.tf([1], [T**2, 2 * zeta * T, 1]), 1 / per_sample)
    fine = np.repeat(v, per_sample)
    process = control.forced_response(G, np.arange(fine.size) / per_sample, fine).outputs
    z, expected = 0.5 * width * start, []
    for value in process:
        z = min(max(z, value - 0.5 * width), value + 0.5 * width)
        expected.append(z)
    motion = plain_motion(MASS, T, 1.0)._replace(damping=zeta, play=width, play_start=start)
    y = plant_output(Setup("mass", motion), v)
    # the rig looks at the process 16 times a sample: a peak between is missed by up to 2 (1 - cos(1 / 64)) = 2.4e-4
    np.testing.assert_allclose(y, expected[::per_sample], atol=5e-4)
    assert np.mean(np.diff(y) == 0.0) > 0.02


def test_delays_of_whole_and_part_samples() -> None:
    plain = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 20.0))
    v = np.concatenate([np.zeros(20), levels()])
    y = plant_output(plain, v)
    whole = plant_output(replace(plain, actuator=Actuator(delay=3.0)), v)
    np.testing.assert_allclose(whole[3:], y[:-3], atol=1e-12)
    part = plant_output(replace(plain, actuator=Actuator(delay=2.5)), v)
    fine = np.repeat(v, 2)
    G = control.sample_system(control.tf([1], [2, 1]) * control.tf([1], [20, 1]), 0.5)
    expected = control.forced_response(G, np.arange(fine.size) / 2, fine).outputs
    np.testing.assert_allclose(part[3:], expected[1::2][: part.size - 3], atol=1e-7)


def test_leak_and_load_settle_where_the_balance_says() -> None:
    plain = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 10.0)._replace(level_zero=1.0))
    v = np.zeros(400)
    load = plant_output(replace(plain, load=Load(onset=100.0, size=-0.3)), v)
    leak = plant_output(replace(plain, load=Load(onset=100.0, leak=0.5)), v)
    assert np.all(load[:100] == 0)
    assert load[-1] == pytest.approx(-0.3, abs=1e-6)
    assert leak[-1] == pytest.approx(-1 / 3, abs=1e-6)  # y = -0.5 (y + 1)


def test_a_changing_pole_keeps_the_static_gain() -> None:
    plain = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 10.0))
    drifting = replace(plain, load=Load(pole_change=1.0))
    v = np.repeat([0.0, 1.0], 300)
    y = plant_output(drifting, v)
    assert y[-1] == pytest.approx(1.0, abs=1e-6)
    assert np.max(np.abs(y - plant_output(plain, v))) > 0.01


def test_the_converter_leaves_its_lattice_and_the_sensor_its_plateaus() -> None:
    plain = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 10.0), sensor=Sensor(step=0.05))
    y = simulate_setup(plain, levels(), Noise(0.02, seed=3)).y
    assert np.max(np.abs(y / 0.05 - np.rint(y / 0.05))) < 1e-9
    clipped = simulate_setup(replace(plain, sensor=Sensor(low=-0.2, high=0.3)), levels(), Noise(0.02, seed=3)).y
    assert clipped.min() == -0.2
    assert clipped.max() == 0.3
    assert np.sum(clipped == 0.3) > 20


def test_an_absolute_value_sensor_folds_the_output_at_its_zero() -> None:
    plain = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 10.0))
    y = simulate_setup(plain, levels(), QUIET).clean
    folded = simulate_setup(replace(plain, sensor=Sensor(fold=-0.1)), levels(), QUIET).clean
    np.testing.assert_allclose(folded, np.where(y > -0.1, y, -0.2 - y), atol=1e-12)
    assert np.mean(y < -0.1) > 0.1


def test_held_stretches_are_held_and_apart() -> None:
    sensor = Sensor(dropout_share=0.2, dropout_length=12.0, seed=4)
    simulated = simulate_setup(
        Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 10.0), sensor=sensor), levels(), Noise(0.01)
    )
    assert simulated.dropouts == dropout_intervals(sensor, 600)
    for (start, stop), (following, _) in zip(simulated.dropouts, [*simulated.dropouts[1:], (600, 600)], strict=True):
        assert np.ptp(simulated.y[start - 1 : stop]) == 0
        assert stop < following or stop <= 600
    share = sum(stop - start for start, stop in simulated.dropouts) / 600
    assert share == pytest.approx(0.2, abs=0.06)


def test_spikes_are_as_many_as_asked_for() -> None:
    sensor = Sensor(outlier_share=0.02, outlier_size=5.0, seed=1)
    plain = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 10.0))
    v = levels()
    extra = simulate_setup(replace(plain, sensor=sensor), v, QUIET).y - simulate_setup(plain, v, QUIET).y
    assert np.count_nonzero(extra) == 12
    assert np.all(np.abs(extra[extra != 0]) >= 3.0 - 1e-12)


def test_noise_has_its_standard_deviation_and_its_colour() -> None:
    white = noise_samples(Noise(0.3, seed=1), 200_000)
    assert np.std(white) == pytest.approx(0.3, rel=0.01)
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.01
    coloured = noise_samples(Noise(0.3, 1.0, 0.7, seed=1), 200_000)
    assert np.std(coloured) == pytest.approx(0.3, rel=0.02)
    assert np.corrcoef(coloured[1:], coloured[:-1])[0, 1] == pytest.approx(0.7, abs=0.01)
    innovation = coloured[1:] - 0.7 * coloured[:-1]
    assert np.std(innovation) > 0.7 * np.std(coloured)


def test_a_run_repeats_and_a_seed_changes_only_the_noise() -> None:
    setup = Setup("motor", plain_motion(MOTOR_SPEED, 2.0, 10.0))
    v = levels()
    one, again, other = (simulate_setup(setup, v, Noise(0.1, seed=seed)) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.y, again.y)
    np.testing.assert_array_equal(one.clean, other.clean)
    assert np.any(one.y != other.y)


def test_a_rig_that_runs_away_says_so() -> None:
    motion = plain_motion(MASS, 5.0, 1.0)._replace(damping=0.3, cubic=-2.0)
    with pytest.raises(UnboundedOutputError, match="must stay bounded"):
        plant_output(Setup("mass", motion), np.full(400, 5.0))


@pytest.mark.parametrize("rig", RIGS)
def test_drawn_rigs_are_such_as_a_lab_has(rig: str) -> None:
    for seed in range(60):
        setup = draw_rig(np.random.default_rng(seed), 1500, (rig,))
        times = -1 / poles(setup.motion).real
        assert np.all(times > 0.4)
        assert np.max(np.abs(1 / poles(setup.motion))) < 102
        assert 2 < time_scale(setup) < 130


@pytest.mark.parametrize("kind", ["step", "staircase", "levels", "two-level", "multisine", "ramps", "square"])
def test_inputs_have_their_length_range_and_rest(kind: str) -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        v = draw_input(rng, kind, 700, 20.0, from_rest=True)
        assert v.shape == (700,)
        assert np.max(np.abs(v)) == 1.0
        assert np.all(v[:12] == 0)
        assert (np.unique(v[60:]).size <= 2) == (kind in ("step", "two-level", "square"))


def test_an_unknown_input_is_refused() -> None:
    with pytest.raises(ValueError, match="kind must be one of step, staircase"):
        draw_input(np.random.default_rng(0), "sawtooth", 100, 10.0, from_rest=True)
