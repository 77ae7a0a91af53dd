"""Effects at one signal: what they change, what they leave, and the limits that hold."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.rig.switchable.actuator import actuator_output
from labsid.rig.switchable.coupled.effects import EFFECTS, coupled_context, draw_placed_effect, rigs_with
from labsid.rig.switchable.coupled.inputs import draw_inputs
from labsid.rig.switchable.coupled.placed_effect import CoupledContext, PlacedEffect
from labsid.rig.switchable.coupled.plants import RIGS, coupled_time_scale, draw_coupled_rig
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.coupled.simulation import moved_states, plant_states, simulate_coupled
from labsid.rig.switchable.coupled.units import draw_units
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE, Actuator
from labsid.rig.switchable.simulation import Noise

OF_ONE_OUTPUT = [name for name in EFFECTS if name.startswith("output-")]


def drawn(effect: str, seed: int, samples: int = 700) -> tuple[CoupledContext, PlacedEffect]:
    rng = np.random.default_rng(seed)
    setup = draw_coupled_rig(rng, samples, str(rng.choice(rigs_with(effect))))
    v = draw_inputs(rng, ("levels", "multisine"), len(setup.inputs), samples, coupled_time_scale(setup.plant), False)
    at = coupled_context(setup, v)
    return at, draw_placed_effect(rng, effect, at)


def outputs(setup: CoupledSetup, v: np.ndarray) -> np.ndarray:
    return simulate_coupled(setup, v, [Noise(0.0)] * len(setup.outputs)).clean


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_effect_vanishes_at_strength_zero_and_grows(effect: str) -> None:
    for seed in range(3):
        at, placed = drawn(effect, seed)
        np.testing.assert_array_equal(outputs(placed.apply(at.setup, 0.0), at.v), at.y)
        weak, strong = (np.sqrt(np.mean((outputs(placed.apply(at.setup, s), at.v) - at.y) ** 2)) for s in (0.05, 0.8))
        assert weak < strong
        assert strong > 0.001 * np.std(at.y)
        assert placed.name == effect


@pytest.mark.parametrize("effect", EFFECTS)
def test_a_label_names_a_signal_of_the_rig_or_none_and_true_parameters(effect: str) -> None:
    for seed in range(3):
        at, placed = drawn(effect, seed)
        assert set(placed.signals) <= {None, *at.setup.inputs, *at.setup.outputs}
        if effect.startswith("input-"):
            assert placed.signals in [(name,) for name in at.setup.inputs]
        elif effect.startswith("output-"):
            assert placed.signals in [(name,) for name in at.setup.outputs]
        else:
            assert None in placed.signals
        units = draw_units(np.random.default_rng(seed), len(at.setup.inputs), len(at.setup.outputs))
        parameters = placed.parameters(placed.apply(at.setup, 0.5), units)
        assert json.loads(json.dumps(parameters, allow_nan=False)) == parameters


@pytest.mark.parametrize("effect", OF_ONE_OUTPUT)
def test_an_effect_at_an_output_leaves_the_other_one(effect: str) -> None:
    for seed in range(4):
        at, placed = drawn(effect, seed)
        changed = np.any(outputs(placed.apply(at.setup, 0.6), at.v) != at.y, axis=0)
        assert [name for name, c in zip(at.setup.outputs, changed, strict=True) if c] == [placed.signal]


@pytest.mark.parametrize("effect", ["coulomb-friction", "cubic-stiffness", "input-dead-zone"])
def test_an_effect_in_coupled_dynamics_or_at_an_input_changes_both_outputs(effect: str) -> None:
    for seed in range(6):
        at, placed = drawn(effect, seed)
        changed = np.std(outputs(placed.apply(at.setup, 0.6), at.v) - at.y, axis=0)
        assert np.all(changed > 0.0)


def test_a_tank_that_overflows_changes_the_output_below_it_alone_unless_a_pipe_joins_them() -> None:
    seen = set()
    for seed in range(40):
        at, placed = drawn("overflow", seed)
        if at.setup.rig != "two pairs of tanks":
            continue
        setup = placed.apply(at.setup, 0.7)
        changed = np.any(np.abs(outputs(setup, at.v) - at.y) > 1e-12, axis=0)
        piped = bool(at.setup.plant.A.any())
        tank = placed.parameters(setup, draw_units(np.random.default_rng(0), 2, 2))["tank"]
        assert changed[at.setup.outputs.index(tank.removeprefix("above "))]
        assert np.all(changed) == piped
        seen.add(piped)
    assert seen == {True, False}


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 2**32 - 1), s=st.floats(0.05, 1.0))
def test_levels_and_positions_stay_within_their_limits(seed: int, s: float) -> None:
    for effect in ("overflow", "end-stop", "sqrt-outflow"):
        at, placed = drawn(effect, seed, 600)
        setup = placed.apply(at.setup, s)
        x, p = plant_states(setup, at.v), setup.plant
        assert np.all(x <= p.brim)
        assert np.all((x >= p.stop_low) & (x <= p.stop_high))
        with np.errstate(divide="ignore"):
            assert np.all(x >= -1.0 / p.curvature - 1e-12)


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 2**32 - 1), s=st.floats(0.05, 1.0))
def test_sensors_and_actuators_stay_within_their_limits(seed: int, s: float) -> None:
    at, placed = drawn("output-saturation", seed, 600)
    setup = placed.apply(at.setup, s)
    y = outputs(setup, at.v)
    assert all(
        np.all((one >= sensor.low) & (one <= sensor.high)) for one, sensor in zip(y.T, setup.sensors, strict=True)
    )
    at, placed = drawn("output-backlash", seed, 600)
    setup = placed.apply(at.setup, s)
    assert np.all(np.abs(outputs(setup, at.v) - at.y) <= 0.5 * np.array(setup.plays) + 1e-12)


def test_a_joint_sticks_where_its_friction_exceeds_the_torque() -> None:
    at, placed = drawn("coulomb-friction", 1)
    setup = placed.apply(at.setup, 1.0)
    joint = placed.parameters(setup, draw_units(np.random.default_rng(0), 2, 2))["joint"] - 1
    speed = plant_states(setup, at.v)[:, 2 + joint]
    free = plant_states(at.setup, at.v)[:, 2 + joint]
    still = 1e-3 * np.std(free)
    assert np.mean(np.abs(speed) < still) > 5 * np.mean(np.abs(free) < still)
    assert np.std(speed) < np.std(free)


def test_friction_stops_a_mass_as_far_as_theory_says() -> None:
    """A joint released at q0 against a weak spring: a half period later it is at 2 F/k - q0."""
    at, placed = drawn("coulomb-friction", 2)
    setup = placed.apply(at.setup, 0.3)
    w = int(np.flatnonzero(setup.plant.friction)[0])
    q, F = w - 2, float(setup.plant.friction[w])
    p = setup.plant
    p.A[w, [0, 1, 2, 3]] = 0.0
    p.A[w, q] = -0.01
    v = np.zeros((32, 2))
    x0 = np.zeros(4)
    x0[q] = 4.0 * F / 0.01
    steps = np.zeros((v.shape[0] * STEPS_PER_SAMPLE, 2))
    path = moved_states(setup, x0, steps, steps, np.zeros(steps.shape[0]))
    assert path[:, q].min() == pytest.approx(-2.0 * F / 0.01, rel=1e-2)


def test_a_command_acts_in_steps_and_not_at_all_while_it_is_off() -> None:
    v = np.linspace(-1.0, 1.0, 21)
    end = actuator_output(Actuator(step=0.5), v)[1][STEPS_PER_SAMPLE - 1 :: STEPS_PER_SAMPLE]
    np.testing.assert_array_equal(np.unique(end), [-1.0, -0.5, 0.0, 0.5, 1.0])
    end = actuator_output(Actuator(off_start=5, off_stop=9, off_level=0.25), v)[1]
    off = np.repeat((np.arange(21) >= 5) & (np.arange(21) < 9), STEPS_PER_SAMPLE)
    assert np.all(end[off] == 0.25)
    np.testing.assert_array_equal(end[~off], np.repeat(v, STEPS_PER_SAMPLE)[~off])


def test_a_measured_disturbance_has_only_effects_that_it_may_have() -> None:
    for seed in range(60):
        _, placed = drawn("input-backlash", seed, 600)
        assert placed.signal != "pressure"


def test_effects_and_rigs_that_there_are_not() -> None:
    at, _ = drawn("input-delay", 0)
    with pytest.raises(ValueError, match=r"name must be one of input-saturation, .*; got 'rust'"):
        draw_placed_effect(np.random.default_rng(0), "rust", at)
    heaters = draw_coupled_rig(np.random.default_rng(0), 700, "two heaters")
    at = coupled_context(heaters, at.v[:, :2])
    with pytest.raises(ValueError, match="a rig of two heaters cannot have overflow"):
        draw_placed_effect(np.random.default_rng(0), "overflow", at)
    assert {rig for effect in EFFECTS for rig in rigs_with(effect)} == set(RIGS)
