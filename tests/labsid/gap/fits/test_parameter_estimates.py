"""Parameters in the record's units and their standard errors, against the scatter over repeated records."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labsid._arrays import FloatArray
from labsid.gap.effects import disturbance, input, periodic
from labsid.gap.effects.base import Effect, Fitted
from labsid.gap.fits.fitting import Fit, finish, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.parameter_estimates import estimate_parameters, has_place, parameters_at_limit
from labsid.gap.record.data import Data, Scale
from labsid.gap.search.refinement import converge

RECORDS = 50
GAINS = np.array([0.03, 0.02, 0.0, 0.0, 0.0, 0.1])
Make = Callable[[int], tuple[Data, Fit]]


def maker(effect: Effect, own: list[float], extra: list[float], u: FloatArray) -> Make:
    """Records of one truth with fresh noise, each fitted from the truth on."""
    hypothesis = Hypothesis((effect,))
    theta = np.zeros(len(hypothesis.parameters))
    theta[0] = 0.25
    theta[hypothesis.slices["plant"]] = np.log([0.5, 0.05])
    theta[hypothesis.slices[effect.key]] = own
    gains = np.concatenate([GAINS, extra])
    clean = hypothesis.output(theta, gains, u)

    def make(seed: int) -> tuple[Data, Fit]:
        y = clean + 0.02 * np.random.default_rng(seed).standard_normal(u.size)
        data = Data(u, y, np.ones(u.size, bool), 0.2, Scale(2.0, 0.5), Scale(10.0, 3.0), 4.0)
        point = minimize(data, hypothesis, theta, gains, iterations=8)
        assert point is not None
        return data, finish(data, hypothesis, point)

    return make


CASES = {
    "dead zone": (input.DeadZone(), [-0.4, 0.3], [], {"low": 1.8, "high": 2.15}),
    "saturation": (input.Saturation("high"), [0.8], [], {"high": 2.4}),
    "sinusoid": (periodic.Periodic(), [11.3], [0.1, 0.05], {"frequency": 11.3 / 80.0, "amplitude": 3.0 * 0.1118034}),
    "curve": (input.Nonlinearity(), [0.2, 0.1], [], {"c2": 0.4, "c3": 0.4}),
}


@pytest.mark.parametrize("case", CASES)
def test_standard_errors_are_the_scatter_over_repeated_records(levels: FloatArray, case: str) -> None:
    """50 records: the estimate of a scatter scatters by 10 % itself."""
    effect, own, extra, truth = CASES[case]
    make = maker(effect, own, extra, levels[:400])
    found: dict[str, list[float]] = {name: [] for name in truth}
    errors: dict[str, list[float]] = {name: [] for name in truth}
    for seed in range(RECORDS):
        parameters = estimate_parameters(*make(seed), effect)
        assert set(truth) <= set(parameters)
        for name in truth:
            found[name].append(float(parameters[name]["value"]))
            errors[name].append(float(parameters[name]["stderr"]))
    for name, value in truth.items():
        scatter, stated = np.std(found[name]), np.mean(errors[name])
        assert 0.65 < stated / scatter < 1.5, (name, stated, scatter)
        assert abs(np.mean(found[name]) - value) < 5.0 * scatter / np.sqrt(RECORDS) + 0.02 * abs(value)


def test_every_parameter_has_a_value_a_standard_error_and_a_unit(levels: FloatArray) -> None:
    data, fit = maker(input.DeadZone(), [-0.4, 0.3], [], levels[:400])(0)
    parameters = estimate_parameters(data, fit, fit.hypothesis.effects[0])
    assert set(parameters) == {"low", "high"}
    for parameter in parameters.values():
        assert list(parameter) == ["value", "stderr", "unit"]
        assert parameter["unit"] == "u"


def test_a_number_at_the_end_of_its_search_says_so(levels: FloatArray) -> None:
    effect, own, extra, _ = CASES["sinusoid"]
    data, fit = maker(effect, own, extra, levels[:400])(0)
    place = fit.hypothesis.slices[effect.key].start
    theta = fit.theta.copy()
    theta[place] = fit.hypothesis.bounds[1][place]
    assert parameters_at_limit(data, fit, effect) == []
    assert parameters_at_limit(data, replace(fit, theta=theta), effect) == ["frequency"]


def test_a_place_that_the_record_does_not_show_is_not_known(levels: FloatArray) -> None:
    data, fit = maker(input.DeadZone(), [-0.4, 0.3], [], levels[:400])(0)
    (effect,) = fit.hypothesis.effects
    assert has_place(data, fit, effect, ("low", "high"))
    assert has_place(data, fit, effect, ())
    noisy = replace(fit, noise=replace(fit.noise, sigma2=1e12 * fit.noise.sigma2))
    assert not has_place(data, noisy, effect, ("low", "high"))


def test_more_samples_make_the_numbers_surer(levels: FloatArray) -> None:
    errors = []
    for samples in (200, 600):
        data, fit = maker(input.DeadZone(), [-0.4, 0.3], [], levels[:samples])(0)
        errors.append(estimate_parameters(data, fit, fit.hypothesis.effects[0])["low"]["stderr"])
    assert errors[1] < errors[0]


ONSETS = {
    "load step": (disturbance.LoadStep(), {}, [0.1, 0.02], 0.05, 0.631),
    "leak": (disturbance.Leak("leak"), {"drift": 0.4}, [], 0.004, 0.5),
}


@pytest.mark.parametrize("case", ONSETS)
def test_the_error_of_an_instant_is_no_smaller_than_it_is(case: str) -> None:
    """The error hardly changes while an instant moves within a sample: linear propagation gave 0.04 to 570 samples."""
    effect, own, extra, noise, onset = ONSETS[case]
    samples, count = 400, 12
    u = np.repeat(np.random.default_rng(5).uniform(-1.5, 1.5, samples // 8), 8)
    hypothesis = Hypothesis((effect,))
    names = [parameter.name for parameter in hypothesis.parameters]
    truth = {"delay": 0.25, "log_c": np.log(0.5), "log_k": np.log(0.05), "onset": onset} | own
    theta = np.array([truth.get(name, 0.0) for name in names])
    gains = np.zeros(hypothesis.design(theta, u).columns.shape[1])
    gains[:2], gains[-1] = (0.03, 0.02), 0.1
    gains[gains.size - len(extra) :] = extra
    clean = hypothesis.output(theta, gains, u)
    off = []
    for seed in range(count):
        y = clean + noise * np.random.default_rng(seed).standard_normal(samples)
        data = Data(u, y, np.ones(samples, bool), 1.0, Scale(0.0, 1.0), Scale(0.0, 1.0))
        point = minimize(data, hypothesis, theta, gains, iterations=25)
        assert point is not None
        found = estimate_parameters(data, converge(data, finish(data, hypothesis, point)), effect)["onset"]
        assert 0.1 < found["stderr"] < 30.0
        off.append((found["value"] - onset * samples) / found["stderr"])
    assert np.mean(np.abs(off) < 2.0) >= 0.8
    assert np.sqrt(np.mean(np.square(off))) > 0.3


def test_marked_is_where_the_effect_acts(levels: FloatArray) -> None:
    data, fit = maker(disturbance.LoadStep(), [0.5], [0.05, 0.02], levels[:400])(0)
    at = np.flatnonzero(fit.hypothesis.effects[0].active_samples(Fitted.of(fit, data)))
    assert at[-1] == 399
    assert at.size == pytest.approx(200, abs=2)
