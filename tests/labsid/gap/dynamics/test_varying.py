"""Dynamics whose rates change along the record: against the matrix exponential and scipy's integrators."""

from collections.abc import Callable

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.drifts import PoleDrift
from labsid.gap.fits.fitting import rms
from labsid.gap.fits.linear_fits import fit_baseline, fit_highpass
from labsid.gap.record.data import scaled
from labsid.gap.search.candidates import best_fit, trial_fits

C, K = 0.5, 0.05


def theta_of(plant: Plant, **values: float) -> FloatArray:
    """The named parameters of the plant; the others are zero."""
    return np.array([values.pop(parameter.name, 0.0) for parameter in plant.parameters])


def left(columns: FloatArray, y: FloatArray) -> float:
    """Largest distance of y from the span of the columns."""
    return float(np.abs(y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]).max())


def test_rates_that_do_not_vary_give_the_linear_columns(levels: FloatArray) -> None:
    plant = Plant(kind="varying", drift_degree=2)
    columns = plant.columns(theta_of(plant, log_c=np.log(C), log_k=np.log(K)), levels, levels.size, 0.0)
    sampled = control.c2d(control.ss(control.tf([0.3, K], [1.0, C, K])), 1.0)
    expected = control.forced_response(sampled, np.arange(levels.size), levels, np.full(2, 0.7)).outputs
    assert left(columns, expected) < 1e-9


@pytest.mark.parametrize("course", ["slow", "step"])
def test_varying_rates_follow_their_course(levels: FloatArray, course: str) -> None:
    """Against the matrix exponential from sample to sample: k goes with r, c with a share of it."""
    w, samples = levels[:240], 240
    if course == "slow":
        plant = Plant(kind="varying", drift_degree=3)
        x = np.linspace(-1.0, 1.0, samples)
        log_r = 0.4 * x + 0.3 * (2.0 * x**2 - 1.0) - 0.2 * (4.0 * x**3 - 3.0 * x)
        own = {"bend1": 0.3, "bend2": -0.2}
    else:
        plant = Plant(kind="leak")
        log_r = np.where(np.arange(samples) >= 96, 0.4, 0.0)
        own = {"onset": 0.4}
    r = np.exp(log_r)
    state, moved, y, free = np.zeros(3), np.eye(3)[:, :2], [], []
    for value, damping, spring in zip(w, C * (1.0 + 0.25 * (r - 1.0)), K * r, strict=True):
        y.append(state[0] * K)
        free.append(moved[0])
        state[2] = value
        step = expm(np.array([[0, 1, 0], [-spring, -damping, 1], [0, 0, 0]]))
        state, moved = step @ state, step @ moved
    theta = theta_of(plant, log_c=np.log(C), log_k=np.log(K), drift=0.4, share_c=0.25, **own)
    columns = plant.columns(theta, w, samples, 0.0)
    np.testing.assert_allclose(columns[:, 0], y, atol=1e-8)
    np.testing.assert_allclose(columns[:, plant.state_columns], free, atol=1e-8)  # free motions by these rates, too


def balances(w: FloatArray, first: float, rate: Callable[[float], float]) -> FloatArray:
    """Two lags in a row, the latter a balance of inflow and of an outflow whose rate varies; the input is held."""

    def flow(t: float, x: FloatArray) -> list[float]:
        return [first * (w[min(int(t), w.size - 1)] - x[0]), x[0] - rate(t) * x[1]]

    state, out = np.array([w[0], w[0] / rate(0.0)]), []
    for k in range(w.size):
        out.append(state[1])
        state = solve_ivp(flow, (k, k + 1 - 1e-12), state, rtol=1e-8, atol=1e-10).y[:, -1]
    return np.array(out)


def test_the_rate_of_the_latter_of_two_lags_turns_the_spring_by_its_derivative(levels: FloatArray) -> None:
    """y' = x - b y behind x' = a (w - x): y'' + (a + b) y' + (a b + b') y = a w."""
    w, a, b, samples = levels[:300], 0.3, 0.1, 300

    def rate(t: float) -> float:
        x = 2.0 * (t - 0.5) / (samples - 1) - 1.0  # the loop holds the rates over each sample
        return b * float(np.exp(0.5 * x - 0.4 * (2.0 * x**2 - 1.0)))

    y = balances(w, a, rate)
    plant = Plant(kind="varying", drift_degree=2)
    own = {"log_c": np.log(a + b), "log_k": np.log(a * b), "drift": 0.5, "bend1": -0.4, "share_c": b / (a + b)}
    missed = [
        left(np.column_stack([plant.columns(theta_of(plant, turn=turn, **own), w, samples), np.ones(samples)]), y)
        for turn in (b / (a + b), 0.0)
    ]
    assert missed[0] < 0.003 * np.std(y)
    assert missed[1] > 10.0 * missed[0]


def test_a_latter_lag_that_doubles_its_rate_along_a_half_sine_is_a_drift_of_the_pole(levels: FloatArray) -> None:
    y = balances(levels, 0.3, lambda t: 0.1 * (1.0 + np.sin(np.pi * t / levels.size)))
    noise = 0.01 * np.std(y) * np.random.default_rng(1).standard_normal(y.size)
    data = scaled(levels, y + noise, np.ones(y.size, bool), 1.0)
    base = fit_baseline(data)
    found = best_fit(data, trial_fits(data, base, (PoleDrift("4"),), fit_highpass(data, base)))
    assert found is not None
    assert rms(data, base) > 0.05
    assert rms(data, found) < 0.0105
    straight = best_fit(data, trial_fits(data, base, (PoleDrift("1"),), fit_highpass(data, base)))
    assert straight is None or rms(data, straight) > 3.0 * rms(data, found)
