"""Rigs with their controller, against python-control, and what a controller must keep."""

from dataclasses import replace

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.rig.switchable.coupled.effects import draw_placed_effect
from labsid.rig.switchable.coupled.loop_rigs import LOOP_RIGS, UNBOUNDED_RIGS, draw_loop_rig
from labsid.rig.switchable.coupled.loop_simulation import simulate_loop
from labsid.rig.switchable.coupled.placed_effect import CoupledContext
from labsid.rig.switchable.coupled.plants import coupled_poles
from labsid.rig.switchable.coupled.setup import linearised
from labsid.rig.switchable.coupled.simulation import plant_outputs
from labsid.rig.switchable.inputs import draw_input
from labsid.rig.switchable.setup import Actuator
from labsid.rig.switchable.simulation import Noise, UnboundedOutputError


def reference(seed: int, samples: int = 600) -> np.ndarray:
    return draw_input(np.random.default_rng(seed), "levels", samples, 30.0, True)


@pytest.mark.parametrize("rig", LOOP_RIGS)
def test_the_loop_is_that_of_python_control(rig: str) -> None:
    for seed in range(3):
        plain, c = draw_loop_rig(np.random.default_rng(seed), rig)
        A, B, C = linearised(plain.plant)
        G = control.sample_system(control.ss(A, B, C, 0.0), 1.0)
        derivative = control.tf([c.kd * (1 - c.filter_pole), -c.kd * (1 - c.filter_pole)], [1.0, -c.filter_pole], 1.0)
        back = control.tf([c.kp], [1.0], 1.0) + derivative
        delay = control.tf([1.0], [1.0, 0.0], 1.0)
        u_of_r = control.feedback(control.ss(delay), control.ss(back) * G)
        r = reference(seed)
        u = control.forced_response(u_of_r, U=c.kp * r).outputs
        run = simulate_loop(plain, c, r, Noise(0.0))
        np.testing.assert_allclose(run.u, u, atol=1e-6)
        np.testing.assert_allclose(
            run.y, control.forced_response(u_of_r * control.ss(G), U=c.kp * r).outputs, atol=1e-6
        )


@pytest.mark.parametrize("rig", LOOP_RIGS)
@settings(deadline=None, max_examples=8)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_controller_holds_every_rig_within_its_limit(rig: str, seed: int) -> None:
    plain, controller = draw_loop_rig(np.random.default_rng(seed), rig)
    r = reference(seed)
    run = simulate_loop(plain, controller, r, Noise(0.01, seed=seed))
    assert np.all(np.abs(run.y) < 4.0)
    limited = replace(controller, limit=float(0.9 * np.max(np.abs(run.u))))
    assert np.all(np.abs(simulate_loop(plain, limited, r, Noise(0.0)).u) <= limited.limit)
    assert bool(np.max(coupled_poles(plain.plant).real) > -1e-12) == (rig in UNBOUNDED_RIGS)


def test_without_effects_the_actuator_follows_the_logged_input() -> None:
    """A quiet run repeated with another noise differs by the answer of the controller to it."""
    plain, controller = draw_loop_rig(np.random.default_rng(1), "upright pendulum")
    r = reference(1)
    one, two = (simulate_loop(plain, controller, r, Noise(sd, seed=3)) for sd in (0.0, 0.02))
    assert np.std(two.u - one.u) > 0.02
    assert np.std(two.y - two.clean) == pytest.approx(0.02, rel=0.1)


@pytest.mark.parametrize(
    "effect", ["input-delay", "input-backlash", "coulomb-friction", "output-backlash", "extra-lag"]
)
def test_effects_of_rigs_of_several_signals_act_in_the_loop(effect: str) -> None:
    plain, controller = draw_loop_rig(np.random.default_rng(2), "hanging pendulum")
    r = reference(2)
    quiet = simulate_loop(plain, controller, r, Noise(0.0))
    at = CoupledContext(plain, quiet.u[:, np.newaxis], quiet.y[:, np.newaxis], quiet.states, 30.0)
    placed = draw_placed_effect(np.random.default_rng(0), effect, at)
    same = simulate_loop(placed.apply(plain, 0.0), controller, r, Noise(0.0))
    np.testing.assert_array_equal(same.y, quiet.y)
    other = simulate_loop(placed.apply(plain, 0.15), controller, r, Noise(0.0))
    assert np.std(other.y - quiet.y) > 0.002 * np.std(quiet.y)


def test_an_actuator_in_the_loop_is_that_of_an_open_one() -> None:
    """The angle that the logged input gives in open loop, through the same actuator."""
    plain, controller = draw_loop_rig(np.random.default_rng(4), "hanging pendulum")
    actuator = Actuator(
        delay=2.25, low=-0.6, dead_high=0.05, backlash=0.1, slew=0.08, c2=0.1, step=0.02, off_start=300, off_stop=340
    )
    rig = replace(plain, actuators=(actuator,))
    run = simulate_loop(rig, controller, reference(4), Noise(0.001, seed=1))
    np.testing.assert_allclose(plant_outputs(rig, run.u[:, np.newaxis])[:, 0], run.clean, atol=1e-9)


def test_an_upright_pendulum_falls_if_its_input_comes_too_late() -> None:
    plain, controller = draw_loop_rig(np.random.default_rng(3), "upright pendulum")
    late = replace(plain, actuators=(Actuator(delay=60.0),))
    with pytest.raises(UnboundedOutputError, match="the controller must hold the upright pendulum; it falls"):
        simulate_loop(late, controller, reference(3), Noise(0.0))


def test_there_is_no_other_rig() -> None:
    with pytest.raises(ValueError, match=r"rig must be one of upright pendulum, .*; got 'ball'"):
        draw_loop_rig(np.random.default_rng(0), "ball")
