"""A sensor that shows an absolute value: gains without the signs, and the fit of a rig that it measures."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from labsid._arrays import FloatArray
from labsid.gap.effects.base import Fitted
from labsid.gap.effects.context import Context
from labsid.gap.effects.folded import Absolute, unfolded
from labsid.gap.fits.fitting import rms
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.model_file import export_model, from_json_dict
from labsid.gap.record.data import Data, scaled
from labsid.gap.search.candidates import best_fit, trial_fits

ABSOLUTE = Absolute("absolute")

LOWEST = 3.0  # reading at the fold
NOISE = 0.01


def speed(u: FloatArray, c: float, k: float) -> FloatArray:
    """Output of y'' = -c y' - k y + k u + 0.4 k, integrated from sample to sample."""
    x, found = np.zeros(2), []
    for value in u:
        found.append(x[0])
        solved = solve_ivp(
            lambda t, x, value=value: [x[1], k * (value + 0.4 - x[0]) - c * x[1]], (0, 1), x, rtol=1e-8, atol=1e-10
        )
        x = solved.y[:, -1]
    return np.array(found)


def record(u: FloatArray, y: FloatArray) -> Data:
    """With noise."""
    return scaled(u, y + NOISE * y.std() * np.random.default_rng(5).standard_normal(y.size), np.ones(y.size, bool), 0.1)


@pytest.mark.parametrize("columns", [1, 3, 5])
def test_gains_are_found_without_the_signs(columns: int) -> None:
    rng = np.random.default_rng(columns)
    X, gains = rng.standard_normal((300, columns)), rng.standard_normal(columns)
    found, cost = unfolded(np.column_stack([X, X[:, 0]]), np.abs(X @ gains))  # of equal columns, only the sum counts
    np.testing.assert_allclose(np.abs(np.column_stack([X, X[:, 0]]) @ found), np.abs(X @ gains), atol=1e-8)
    assert cost < 1e-12


@pytest.mark.parametrize(("c", "k"), [(0.1, 0.02), (0.6, 0.08)])
def test_a_rig_behind_such_a_sensor_is_identified(levels: FloatArray, c: float, k: float) -> None:
    y = speed(levels, c, k)
    data = record(levels, LOWEST + np.abs(y))
    base = fit_baseline(data)
    assert rms(data, base) > 0.2
    fit = best_fit(data, trial_fits(data, base, (ABSOLUTE,), base))
    assert fit is not None
    assert rms(data, fit) < 1.1 * NOISE
    np.testing.assert_allclose(fit.rates, (c, k), rtol=0.1)
    values = ABSOLUTE.values(Fitted(fit.hypothesis, fit.theta, fit.gains, data))
    assert values["fold"].value == pytest.approx(LOWEST, abs=0.02)
    model = from_json_dict(export_model(data, fit).to_json_dict())
    other = speed(-levels[::-1], c, k)
    simulated = model.simulate(-levels[::-1], LOWEST + np.abs(other))
    np.testing.assert_allclose(simulated, LOWEST + np.abs(other), atol=0.1 * other.std())


def test_an_ordinary_sensor_is_not_tried(levels: FloatArray) -> None:
    data = record(levels, speed(levels, 0.3, 0.05))
    base = fit_baseline(data)
    assert not ABSOLUTE.applies(Context(data, base, base))


def test_the_reading_is_reflected_at_the_fold() -> None:
    own, z = np.array([-1.0]), np.array([-2.5, -1.0, 0.5])
    sensor = Absolute("absolute")
    np.testing.assert_array_equal(sensor.apply(z, own), [0.5, -1.0, 0.5])
    np.testing.assert_array_equal(sensor.slope(z, own), [-1.0, 1.0, 1.0])
