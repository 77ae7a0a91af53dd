"""Sliders: every position gives the value that it shows, the other parameters of the effect held."""

from collections.abc import Iterator

import numpy as np
import pytest

from labsid.gap.effects.base import Effect, Fitted
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.noise_model import Noise
from labsid.gap.record.data import Data, scaled
from labsid.gap.reports.sliders import Slider, parameter_sliders

SAMPLES = 300
# Parameters in theta with which each effect acts; the others start where the search starts them.
ACTING = {
    "input-saturation/both": {"low": -0.7, "high": 0.8},
    "input-dead-zone": {"low": -0.4, "high": 0.3},
    "input-backlash": {"width": 0.4, "position": 0.5},
    "input-rate-limit": {"log_rate": -1.0},
    "input-delay": {"delay": 3.2},
    "extra-lag": {"log_lag": 1.0},
    "resonance": {"log_frequency": -0.7, "log_damping": -2.3},
    "sqrt-outflow/both": {"zero": -3.0},
    "coulomb-friction/position": {"friction": 0.3},
    "output-saturation/high": {"high": 0.8},
    "output-nonlinearity": {"c2": 0.1, "c3": -0.05},
    "output-drift/3": {},
    "load-step": {"onset": 0.4},
    "periodic-disturbance": {"cycles": 7.3},
    "parameter-drift/gain-1": {"shape1": 0.2, "angle": 0.1},
}


@pytest.fixture(scope="module")
def data() -> Data:
    """Levels, each held for 10 samples."""
    rng = np.random.default_rng(5)
    u = np.repeat(rng.uniform(-2.0, 2.0, SAMPLES // 10), 10)
    return scaled(u, np.cumsum(u) + rng.standard_normal(SAMPLES), np.ones(SAMPLES, bool), 0.5)


def fit_with(data: Data, effect: Effect, own: dict[str, float]) -> Fit:
    """A fit with these parameters."""
    hypothesis = Hypothesis((effect,))
    theta = np.array([own.get(one.name, one.start) for one in hypothesis.parameters])
    start = hypothesis.slices["plant"].start
    theta[start : start + 2] = hypothesis.plant.starts(0.5, 0.05)[0][:2]
    columns = hypothesis.design(theta, data.u).columns
    gains = np.random.default_rng(2).uniform(0.5, 1.5, columns.shape[1])
    output = hypothesis.output(theta, gains, data.u)
    return Fit(hypothesis, theta, gains, output, 1.0, Noise(np.zeros(0), 1.0, 0.0, SAMPLES), 0.0)


def at_positions(data: Data, fit: Fit, effect: Effect, slider: Slider) -> Iterator[dict[str, float]]:
    """The parameters of the effect at each position."""
    for move in slider.moves:
        theta, gains = fit.theta + move * slider.theta, fit.gains + move * slider.gains
        found = effect.values(Fitted(fit.hypothesis, theta, gains, data))
        yield {name: one.value for name, one in found.items()}


@pytest.mark.parametrize("key", ACTING)
def test_a_position_gives_its_value_and_leaves_the_others(key: str, data: Data) -> None:
    effect = EFFECTS_BY_KEY[key]
    fit = fit_with(data, effect, ACTING[key])
    found = parameter_sliders(data, fit, effect)
    values = effect.values(Fitted(fit.hypothesis, fit.theta, fit.gains, data))
    assert {one.parameter for one in found} == set(values) - {"centre"}
    lower, upper = fit.hypothesis.bounds
    for slider in found:
        fitted = float(slider.values[slider.moves == 0.0].item())
        assert fitted == pytest.approx(values[slider.parameter].value)
        assert slider.unit == values[slider.parameter].unit
        assert np.all(np.diff(slider.values) > 0.0)
        reached = list(at_positions(data, fit, effect, slider))
        span = slider.values[-1] - slider.values[0]
        shown = np.array([one[slider.parameter] for one in reached])
        assert shown == pytest.approx(slider.values, abs=2e-3 * span)
        for other in set(values) - {slider.parameter}:
            ends = np.array([one[other] for one in (reached[0], reached[-1])])
            assert ends == pytest.approx(values[other].value, rel=0.02, abs=1e-9)
        for end in (slider.moves[0], slider.moves[-1]):
            theta = fit.theta + end * slider.theta
            assert np.all((theta >= lower - 1e-9) & (theta <= upper + 1e-9))


def test_the_size_of_a_drift_goes_down_to_nothing(data: Data) -> None:
    effect = EFFECTS_BY_KEY["output-drift/3"]
    fit = fit_with(data, effect, {})
    (slider,) = parameter_sliders(data, fit, effect)
    assert slider.of_one_record
    assert slider.values[0] == pytest.approx(0.0, abs=1e-9)
    assert slider.gains[-3:] * slider.moves[0] == pytest.approx(-fit.gains[-3:])


def test_a_parameter_at_its_bound_moves_one_way(data: Data) -> None:
    effect = EFFECTS_BY_KEY["input-backlash"]
    (slider,) = parameter_sliders(data, fit_with(data, effect, {"width": 7.9, "position": 0.5}), effect)
    assert slider.moves[-1] < -0.1 * slider.moves[0]


def test_an_effect_of_no_size_has_no_slider(data: Data) -> None:
    effect = EFFECTS_BY_KEY["input-delay"]
    assert parameter_sliders(data, fit_with(data, effect, {"delay": 0.0}), effect) == []


def test_a_side_that_the_record_does_not_reach_has_none(data: Data) -> None:
    effect = EFFECTS_BY_KEY["input-dead-zone"]
    found = parameter_sliders(data, fit_with(data, effect, {"low": -5.0, "high": 0.3}), effect)
    assert [one.parameter for one in found] == ["high"]
