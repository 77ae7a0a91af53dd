"""Responses of linear systems, and the inputs."""

import numpy as np
import pytest
from control import forced_response, tf

from labsid.rig.ordinary.measured import DIRECT
from labsid.rig.ordinary.record_files import table_text
from labsid.rig.ordinary.signals import SIGNALS, draw_signal
from labsid.rig.ordinary.systems import (
    System,
    draw_first_order,
    draw_integrating,
    draw_second_order,
    response,
)

STRICTLY_PROPER = (draw_first_order, draw_second_order, draw_integrating)


@pytest.mark.parametrize("draw", [*STRICTLY_PROPER, *list(DIRECT.values())[1:]])
def test_responses_are_those_of_python_control(draw) -> None:
    rng = np.random.default_rng(5)
    for _ in range(4):
        system = draw(rng)
        u = np.concatenate([[0.0, 0.0], draw_signal(rng, "ramps", 400, system.time)])
        expected = forced_response(tf(system.num, system.den), np.arange(402), u, initial_state=0).outputs
        np.testing.assert_allclose(response(system, u, between="linear"), expected, atol=1e-8 * np.ptp(expected))


def test_a_lag_worked_by_hand() -> None:
    lag = System((3.0,), (2.0, 1.0), 2.0)
    k = np.arange(10)
    np.testing.assert_allclose(response(lag, np.ones(10)), 3.0 * (1.0 - np.exp(-k / 2.0)))
    np.testing.assert_allclose(response(lag, np.ones(10), settled=True), 3.0)
    np.testing.assert_allclose(response(lag, np.ones(10), delay=4)[4:], 3.0 * (1.0 - np.exp(-k[:6] / 2.0)))


@pytest.mark.parametrize("draw", STRICTLY_PROPER)
def test_strictly_proper_systems_move_one_sample_later(draw) -> None:
    u = np.concatenate([np.zeros(5), np.ones(5)])
    y = response(draw(np.random.default_rng(2)), u)
    assert np.all(y[:6] == 0.0)
    assert y[6] != 0.0


@pytest.mark.parametrize("draw", DIRECT.values())
def test_direct_systems_move_in_the_same_sample(draw) -> None:
    u = np.concatenate([np.zeros(5), np.ones(5)])
    y = response(draw(np.random.default_rng(2)), u)
    assert np.all(y[:5] == 0.0)
    assert y[5] != 0.0


@pytest.mark.parametrize("kind", SIGNALS)
def test_signals_reach_one_and_move(kind: str) -> None:
    for seed in range(5):
        v = draw_signal(np.random.default_rng(seed), kind, 900, 20.0)
        assert v.size == 900
        assert np.max(np.abs(v)) == pytest.approx(1.0)
        assert np.count_nonzero(np.diff(v)) >= 3


def test_single_precision_is_printed_as_such() -> None:
    t, x = np.array([0.0, 0.1]), np.array([1.0 / 3.0, 1e-3])
    assert table_text("t,x", "float32", t, x) == "t,x\n0,0.333333343\n0.100000001,0.00100000005\n"
    assert table_text("t,x", "%.4g", t, x) == "t,x\n0,0.3333\n0.1,0.001\n"
