"""Records that exercise an effect, and those that do not."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.blind.exercised import is_exercised
from labsid.rig.switchable.coupled.plants import draw_coupled_rig
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.setup import Actuator

PLAIN = draw_coupled_rig(np.random.default_rng(0), 1000, "two joints")
k = np.arange(400)
U = np.column_stack([np.sin(0.1 * k), np.sin(0.17 * k)])
STATES = np.column_stack([U, U])


def with_actuator(actuator: Actuator) -> CoupledSetup:
    return replace(PLAIN, actuators=(Actuator(), actuator))


@pytest.mark.parametrize(
    ("effect", "actuator", "right"),
    [
        ("input-delay", Actuator(delay=1.0), True),
        ("input-delay", Actuator(delay=0.9), False),
        ("input-dead-zone", Actuator(dead_low=-0.5, dead_high=0.5), True),
        ("input-dead-zone", Actuator(dead_low=-1.1, dead_high=0.5), False),
        ("input-off", Actuator(off_start=100, off_stop=160), True),
        ("input-off", Actuator(off_start=100, off_stop=110), False),
        ("input-saturation", Actuator(high=0.5), True),
    ],
)
def test_effects_at_an_input(effect: str, actuator: Actuator, right: bool) -> None:
    assert is_exercised(effect, with_actuator(actuator), U, STATES, U) == right


def test_a_command_that_rests_is_not_missed() -> None:
    resting = U.copy()
    resting[100:160, 1] = 0.3
    setup = with_actuator(Actuator(off_start=100, off_stop=160))
    assert not is_exercised("input-off", setup, resting, STATES, U)


@pytest.mark.parametrize(("level", "right"), [(0.5, True), (1.0, False)])
def test_a_stop_and_a_brim_are_reached_often(level: float, right: bool) -> None:
    states = np.minimum(STATES, level)
    stopped = replace(PLAIN.plant, stop_high=np.array([level, np.inf, np.inf, np.inf]))
    brimful = replace(PLAIN.plant, brim=np.array([np.inf, level, np.inf, np.inf]))
    assert is_exercised("end-stop", replace(PLAIN, plant=stopped), U, states, U) == right
    assert is_exercised("overflow", replace(PLAIN, plant=brimful), U, states, U) == right


def test_a_backlash_is_crossed_at_the_output_that_has_it() -> None:
    still = np.column_stack([U[:, 0], np.where(k % 200 < 180, 0.0, 1.0)])
    assert is_exercised("output-backlash", replace(PLAIN, plays=(0.1, 0.0)), U, STATES, still)
    assert not is_exercised("output-backlash", replace(PLAIN, plays=(0.0, 0.1)), U, STATES, still)
