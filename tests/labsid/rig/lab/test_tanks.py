"""The coupled tanks against hand-worked Torricelli and against scipy's integrator."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from labsid.rig.lab.integration import simulate_rig
from labsid.rig.lab.tanks import GRAVITY, TankParameters, pump_flow, steady_levels, tank_rig

LAB_INPUT = np.repeat([2.0, 1.6, 2.2, 2.0, 1.6, 2.2], [51, 200, 200, 200, 200, 52])
TS = 0.75


def oracle(p, u, x0):
    """The two balances written again, with the rig's volumes, and given to scipy stretch by stretch."""

    def rates(t, h, v):
        q1 = p.upper_orifice * np.sqrt(2 * GRAVITY * max(h[0], 0))
        q2 = p.lower_orifice * np.sqrt(2 * GRAVITY * max(h[1], 0))
        return [(p.pump_gain * v - q1) / p.upper_area, (q1 - q2) / p.lower_area]

    edges = np.concatenate([[0], np.flatnonzero(np.diff(u)) + 1, [u.size - 1]])
    states = np.empty((u.size, 2))
    states[0] = x0
    for k0, k1 in pairwise(edges):
        t = TS * np.arange(k0, k1 + 1)
        solution = solve_ivp(rates, (t[0], t[-1]), states[k0], "DOP853", t, args=(u[k0],), rtol=1e-11, atol=1e-11)
        states[k0 : k1 + 1] = solution.y.T
    return states


def test_a_tank_drains_as_torricelli_says():
    # Pump off, upper tank alone: sqrt(h) falls linearly, h = (sqrt(h0) - a sqrt(2 g) t / (2 A))^2.
    p = TankParameters(upper_area=10.0, upper_orifice=0.2)
    h0 = 16.0
    states = simulate_rig(tank_rig(p), np.zeros(8), TS, (h0, 0.0)).states
    t = TS * np.arange(8)
    by_hand = (np.sqrt(h0) - 0.2 * np.sqrt(2 * 981.0) / (2 * 10.0) * t) ** 2
    np.testing.assert_allclose(states[:, 0], by_hand, atol=1e-6)


def test_steady_levels_by_hand():
    # 27.1 cm^3/s/V at 2 V: 54.2 cm^3/s through 0.277 cm^2 takes (54.2 / 0.277)^2 / (2 * 981) = 19.51 cm.
    upper, lower = steady_levels(TankParameters(), 2.0)
    assert pump_flow(TankParameters(), 2.0) == pytest.approx(54.2)
    assert lower == pytest.approx(19.514, abs=1e-3)
    assert upper == pytest.approx(5.9891, abs=1e-3)


def test_the_rig_stays_where_it_is_steady():
    p = TankParameters()
    start = steady_levels(p, 1.8)
    states = simulate_rig(tank_rig(p), np.full(400, 1.8), TS, start).states
    np.testing.assert_allclose(states, np.tile(start, (400, 1)), rtol=1e-12)


def test_the_sensor_reads_the_lower_level():
    p = TankParameters(sensor_gain=0.2, sensor_zero=-0.5)
    assert tank_rig(p).output(np.array([[3.0, 10.0], [5.0, 0.0]])).tolist() == [1.5, -0.5]


def test_scipy_agrees_over_the_whole_lab_record():
    p = TankParameters()
    start = steady_levels(p, 2.0)
    states = simulate_rig(tank_rig(p), LAB_INPUT, TS, start).states
    np.testing.assert_allclose(states, oracle(p, LAB_INPUT, start), atol=2e-6)


def test_scipy_agrees_from_empty_tanks():
    p = TankParameters()
    states = simulate_rig(tank_rig(p), LAB_INPUT, TS, (0.0, 0.0)).states
    exact = oracle(p, LAB_INPUT, (0.0, 0.0))
    # The slope of the root at an empty tank is infinite: the first steps cost 0.04 mm, later ones nothing.
    np.testing.assert_allclose(states, exact, atol=4e-3)
    np.testing.assert_allclose(states[100:], exact[100:], atol=1e-4)
    assert (states >= 0).all()


def test_halving_the_step_changes_less_than_a_converter_step():
    p = TankParameters()
    start = steady_levels(p, 2.0)
    coarse, fine = (simulate_rig(tank_rig(p), LAB_INPUT, TS, start, max_step=step).y for step in (0.1, 0.05))
    assert np.abs(coarse - fine).max() < 1e-7


def test_water_is_conserved():
    p = TankParameters()
    states = simulate_rig(tank_rig(p), LAB_INPUT, TS, (0.0, 0.0), max_step=0.01).states
    volume = p.upper_area * states[:, 0] + p.lower_area * states[:, 1]
    pumped = np.concatenate([[0.0], np.cumsum(p.pump_gain * LAB_INPUT[:-1] * TS)])
    out = p.lower_orifice * np.sqrt(2 * GRAVITY * states[:, 1])
    drained = np.concatenate([[0.0], np.cumsum((out[1:] + out[:-1]) / 2 * TS)])
    # The trapezium of the outflow is the only inexact term here.
    np.testing.assert_allclose(pumped - drained, volume, atol=0.01 * volume.max())


def test_a_small_step_shows_the_two_time_constants():
    # Linearised at 2 V, a tank has tau = 2 A h / q.
    p = TankParameters()
    upper, lower = steady_levels(p, 2.0)
    tau = np.array([p.upper_area * upper, p.lower_area * lower]) * 2 / pump_flow(p, 2.0)
    assert tau == pytest.approx([0.884, 28.8], rel=1e-3)
    t = TS * np.arange(200)
    step = simulate_rig(tank_rig(p), np.full(200, 2.001), TS, (upper, lower)).states[:, 1] - lower
    linear = 1 - (tau[1] * np.exp(-t / tau[1]) - tau[0] * np.exp(-t / tau[0])) / (tau[1] - tau[0])
    np.testing.assert_allclose(step, 2 * lower / 2.0 * 0.001 * linear, atol=1e-3 * step.max())


def test_a_pump_does_not_run_backwards():
    assert pump_flow(TankParameters(), -1.0) == 0.0
    assert steady_levels(TankParameters(), -1.0) == (0.0, 0.0)


def test_tanks_that_run_dry_stay_dry():
    states = simulate_rig(tank_rig(TankParameters()), np.zeros(200), TS, steady_levels(TankParameters(), 2.0)).states
    assert (states >= 0).all()
    assert (states[-1] == 0).all()


def test_a_level_over_the_brim_is_refused():
    with pytest.raises(ValueError, match=r"the lower level \(cm\) must stay below 40; got 40\.\d+ at t = "):
        simulate_rig(tank_rig(TankParameters()), np.full(400, 3.0), TS, (0.0, 0.0))


@pytest.mark.parametrize("name", ["upper_area", "lower_orifice", "pump_gain", "sensor_gain", "lower_height"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("inf"), float("nan")])
def test_a_length_area_or_gain_must_be_positive(name, value):
    with pytest.raises(ValueError, match=f"{name} must be a positive finite number; got"):
        replace(TankParameters(), **{name: value})


def test_the_sensor_zero_may_have_either_sign_but_must_be_finite():
    assert TankParameters(sensor_zero=-3.0).sensor_zero == -3.0
    with pytest.raises(ValueError, match="sensor_zero must be a finite number; got nan"):
        TankParameters(sensor_zero=float("nan"))
