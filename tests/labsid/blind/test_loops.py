"""The row `loop`: what is drawn, and the error of the best linear model of a rig in a loop."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.blind.experiment import OrdinaryCase
from labsid.blind.loops import LOOP_EFFECTS, RIG_ORDER, draw_loop, linear_loop_gap, observer, stabilised_error
from labsid.blind.strength import HARD_RATIOS
from labsid.rig.switchable.coupled.loop_rigs import LOOP_RIGS, UNBOUNDED_RIGS, draw_loop_rig
from labsid.rig.switchable.coupled.loop_simulation import simulate_loop
from labsid.rig.switchable.inputs import draw_input
from labsid.rig.switchable.simulation import Noise


@pytest.mark.parametrize("count", [3, pytest.param(5, marks=pytest.mark.exhaustive)])
def test_rigs_and_effects_take_turns_and_a_record_has_its_reference(
    count: int, dev_cases: Callable[[str, int], list[OrdinaryCase]]
) -> None:
    for i, case in enumerate(dev_cases("loop", count)):
        truth = case.made.truth
        effect = LOOP_EFFECTS[i]
        assert case.made.answers == (() if effect == "none" else (effect,),)
        assert case.kind == RIG_ORDER[i]
        assert truth["mode"] == ("stabilised" if case.kind in UNBOUNDED_RIGS else "free")
        assert case.options == ("--reference", "r")
        header, *lines = case.made.files[".csv"].splitlines()
        numbers = np.array([line.split(",") for line in lines], dtype=float)
        assert header == "t,r,u,y"
        assert numbers.shape == (truth["samples"], 4)
        assert np.isfinite(numbers).all()
        assert np.all(np.ptp(numbers, axis=0) > 0.0)
        assert truth["ratio"] >= 0.95 * HARD_RATIOS[0] if effect != "none" else truth["ratio"] <= 0.1
    assert {LOOP_EFFECTS[i] for i in range(len(LOOP_EFFECTS))} > {"none", "coulomb-friction"}


@pytest.mark.parametrize("rig", LOOP_RIGS)
def test_a_rig_without_effects_is_its_linearisation_to_the_noise(rig: str) -> None:
    plain, controller = draw_loop_rig(np.random.default_rng(1), rig)
    r = draw_input(np.random.default_rng(2), "levels", 1000, 30.0, True)
    run = simulate_loop(plain, controller, r, Noise(0.01, seed=1))
    assert linear_loop_gap(plain, run) < 1e-3 * 0.01
    if rig in UNBOUNDED_RIGS:  # and with the noise of the output it leaves about that noise
        assert stabilised_error(run.u, run.y, observer(plain.plant)) == pytest.approx(0.01, rel=0.15)


def test_the_poles_of_the_observer_are_stable_and_those_of_the_rig_otherwise() -> None:
    for rig in LOOP_RIGS:
        plain, _ = draw_loop_rig(np.random.default_rng(3), rig)
        assert np.all(np.abs(np.roots(observer(plain.plant))) < 1.0)


def test_the_stabilised_error_is_that_of_a_run_with_the_fitted_numbers() -> None:
    """An unstable system of order one with a square beside its input, fitted here by scipy on a grid."""
    rng = np.random.default_rng(4)
    u = rng.uniform(-1, 1, 400)
    y = np.zeros(400)
    for k in range(1, 400):
        u[k - 1] -= 0.5 * y[k - 1]  # feedback that holds it
        y[k] = 1.1 * y[k - 1] + u[k - 1] + 0.1 * u[k - 1] ** 2
    F = np.array([1.0, -1 / 1.1])
    found = stabilised_error(u, y, F)
    filtered = [lfilter([1.0], F, x) for x in (y, u)]
    one = np.r_[0.0, filtered[0][:-1]], np.r_[0.0, filtered[1][:-1]], np.r_[0.0, 0.0, filtered[1][:-2]]
    basis = np.column_stack([*one, np.ones(400), F[1] ** np.arange(400) * (-1.0) ** np.arange(400)])
    left = filtered[0] - basis @ np.linalg.lstsq(basis, filtered[0])[0]
    assert found == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-3)


def test_a_draw_is_repeated_by_its_seed() -> None:
    one, two = (draw_loop(np.random.default_rng([7, 5]), 2, "x") for _ in range(2))
    assert one is not None
    assert two is not None
    assert one.made.files == two.made.files
