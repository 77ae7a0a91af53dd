"""The rigs against independent integrators and against physics that can be worked by hand."""

from dataclasses import replace

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from labsid.rig.switchable._motion import MASS, MOTOR_SPEED, PARALLEL_MODE, SERIES_MODE, STATE_COUNT, TWO_TANKS, move
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
