"""Rigs of several signals without effects, against scipy and python-control, and what must hold on each of them."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.rig.switchable.coupled.inputs import draw_inputs
from labsid.rig.switchable.coupled.plants import RIGS, coupled_poles, coupled_time_scale, draw_coupled_rig
from labsid.rig.switchable.coupled.setup import CoupledSetup, linearised, with_states
from labsid.rig.switchable.coupled.simulation import plant_outputs, simulate_coupled
from labsid.rig.switchable.coupled.units import draw_units
from labsid.rig.switchable.simulation import Noise

RICH = ("levels", "multisine")


def drawn(rig: str, seed: int, samples: int = 800) -> tuple[CoupledSetup, np.ndarray]:
    rng = np.random.default_rng(seed)
    setup = draw_coupled_rig(rng, samples, rig)
    return setup, draw_inputs(rng, RICH, len(setup.inputs), samples, coupled_time_scale(setup.plant), False)


def linear_response(setup: CoupledSetup, v: np.ndarray) -> np.ndarray:
    """Response of the sampled linearisation by python-control, from the steady state of the first inputs."""
    A, B, C = linearised(setup.plant)
    sampled = control.sample_system(control.ss(A, B, C, np.zeros((C.shape[0], B.shape[1]))), 1.0)
    x0 = np.linalg.solve(A, -B @ v[0])
    return np.atleast_2d(control.forced_response(sampled, U=v.T, X0=x0).outputs).T


@pytest.mark.parametrize("rig", RIGS)
@settings(deadline=None, max_examples=5)
@given(seed=st.integers(0, 2**32 - 1))
def test_without_effects_a_rig_is_its_linearisation(rig: str, seed: int) -> None:
    setup, v = drawn(rig, seed)
    run = simulate_coupled(setup, v, [Noise(0.0)] * len(setup.outputs))
    np.testing.assert_allclose(run.clean, linear_response(setup, v), atol=1e-5 * np.ptp(run.clean))
    np.testing.assert_array_equal(run.clean, run.y)


@pytest.mark.parametrize("rig", RIGS)
@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 2**32 - 1), samples=st.integers(600, 2500))
def test_rigs_are_stable_and_faster_than_their_record(rig: str, seed: int, samples: int) -> None:
    setup = draw_coupled_rig(np.random.default_rng(seed), samples, rig)
    assert np.all(coupled_poles(setup.plant).real < 0.0)
    assert coupled_time_scale(setup.plant) < samples / 3
    assert (setup.plant.inputs, setup.plant.outputs) == (len(setup.inputs), len(setup.outputs))


@pytest.mark.parametrize("rig", ["two pairs of tanks", "two heaters", "two joints"])
def test_each_input_moves_its_own_output_most_and_the_other_one_too(rig: str) -> None:
    for seed in range(20):
        A, B, C = linearised(drawn(rig, seed)[0].plant)
        gain = C @ np.linalg.solve(-A, B)
        assert np.all(gain > 0.05)
        assert np.all(np.diag(gain) > gain[[1, 0], [0, 1]])


def test_the_other_heater_acts_after_its_own() -> None:
    setup, _ = drawn("two heaters", 3)
    step = np.column_stack([np.r_[0.0, np.ones(60)], np.zeros(61)])
    own, other = plant_outputs(setup, step).T
    assert np.argmax(own > 0.1 * own[-1]) < np.argmax(other > 0.1 * other[-1])


def test_a_draw_is_repeated_by_its_seed() -> None:
    for rig in RIGS:
        (one, v), (two, w) = drawn(rig, 4), drawn(rig, 4)
        np.testing.assert_array_equal(v, w)
        np.testing.assert_array_equal(plant_outputs(one, v), plant_outputs(two, w))


def test_there_is_no_other_rig() -> None:
    with pytest.raises(ValueError, match=r"rig must be one of two pairs of tanks, .*; got 'crane'"):
        draw_coupled_rig(np.random.default_rng(0), 1000, "crane")


@pytest.mark.parametrize("in_turn", [False, True])
def test_inputs_move_independently_or_one_at_a_time(in_turn: bool) -> None:
    for seed in range(10):
        v = draw_inputs(np.random.default_rng(seed), RICH, 2, 1500, 20.0, in_turn)
        assert np.max(np.abs(v)) <= 1.0
        assert np.all(np.std(v, axis=0) > 0.1)
        assert abs(np.corrcoef(v.T)[0, 1]) < 0.5
        assert np.all(np.any(v == 0.0, axis=1)) or not in_turn


def test_the_noise_of_one_output_leaves_the_other_one() -> None:
    setup, v = drawn("two heaters", 5)
    quiet, noisy = (simulate_coupled(setup, v, [Noise(sd, seed=1), Noise(0.0)]) for sd in (0.0, 0.01))
    assert np.std(noisy.y[:, 0] - quiet.y[:, 0]) == pytest.approx(0.01, rel=0.1)
    np.testing.assert_array_equal(noisy.y[:, 1], quiet.y[:, 1])


def test_units_convert_each_signal_and_a_pair_of_them() -> None:
    units = draw_units(np.random.default_rng(1), 2, 1)
    v = np.array([[0.0, 1.0]])
    np.testing.assert_allclose(units.u(v), [[units.u0[0], units.u0[1] + units.us[1]]])
    pair = units.pair(1, 0)
    assert (pair.u0, pair.us, pair.y0, pair.ys, pair.Ts) == (
        units.u0[1],
        units.us[1],
        units.y0[0],
        units.ys[0],
        units.Ts,
    )


def test_appended_states_change_nothing() -> None:
    setup, v = drawn("two joints", 6, 300)
    A = with_states(setup, 2)
    A.plant.A[-1, -1] = A.plant.A[-2, -2] = -1.0  # the steady state is defined
    np.testing.assert_allclose(plant_outputs(A, v), plant_outputs(setup, v), atol=1e-12)
