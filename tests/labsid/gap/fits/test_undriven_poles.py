"""First-order rigs: poles without excitation imitate drifts and sinusoids; an additional mode or lag is named."""

from dataclasses import replace

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import Diagnosis, diagnose
from labsid.gap.effects import dynamics, input, output, tanks
from labsid.gap.fits.fitting import Fit, finish, minimize, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import LINEAR, fit_baseline, fit_driven_pole
from labsid.gap.fits.undriven_poles import has_undriven_pole, lag_became_mode, slowest_driven_rate
from labsid.gap.record.data import Data, scaled
from labsid.gap.search.beam_search import search_effects
from labsid.gap.search.pole_replacement import replace_undriven_pole
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

TS, SAMPLES, RATE, NOISE = 0.2, 500, 0.07, 0.008
FEW = (
    "input-delay",
    "input-dead-zone",
    "input-nonlinearity",
    "extra-lag",
    "resonance",
    "slow-mode",
    "output-drift",
    "load-step",
    "periodic-disturbance",
)
"""What an undriven pole may be taken for, and what may be taken for one."""
ALONG = np.linspace(0.0, 1.0, SAMPLES)
OWN = {
    "ramp": 0.5 * ALONG,
    "settling": 0.6 * (1.0 - np.exp(-2.0 * ALONG)),
    "wave": 0.25 * np.sin(2.0 * np.pi * 5.3 * ALONG + 1.0),
    "fast wave": 0.2 * np.sin(2.0 * np.pi * 22.0 * ALONG),
}


def levels(hold: int = 14) -> FloatArray:
    """Levels between 1 and 3."""
    values = np.random.default_rng(8).uniform(1.0, 3.0, SAMPLES // hold + 1)
    return np.repeat(values, hold)[:SAMPLES]


def lag(u: FloatArray, rate: float = RATE) -> FloatArray:
    """A lag that follows `u` from its first value, the input held; `rate` a sample."""
    pole = np.exp(-rate)
    return u[0] + lfilter([0.0, 1.0 - pole], [1.0, -pole], u - u[0])


def mode(u: FloatArray, damping: float, frequency: float = 0.4) -> FloatArray:
    """A mode and a lag in a row; `frequency` in rad a sample."""
    pair = [1.0, 2.0 * damping * frequency, frequency**2]
    num, den, _ = cont2discrete(([frequency**2 * RATE], np.polymul(pair, [1.0, RATE])), 1.0)
    return u[0] + lfilter(num[0], den, u - u[0])


def record_of(y: FloatArray, u: FloatArray) -> Record:
    """The record with white noise."""
    noise = NOISE * np.random.default_rng(11).standard_normal(SAMPLES)
    return Record(TS * np.arange(SAMPLES), u, np.asarray(y + noise, np.float64), TS)


def names(diagnosis: Diagnosis) -> list[str]:
    """Names of the effects found."""
    return [effect["name"] for effect in diagnosis.report["effects"]]


def fitted(own: FloatArray) -> tuple[Fit, Data]:
    """The baseline fitted to a lag with a disturbance at the output."""
    u = levels()
    y = lag(u) + own + NOISE * np.random.default_rng(11).standard_normal(SAMPLES)
    data = scaled(u, y, np.ones(SAMPLES, bool), TS)
    return fit_baseline(data), data


@searched(*FEW)
def test_the_drift_of_a_first_order_rig_is_not_fitted_as_a_second_pole() -> None:
    u = levels()
    diagnosis = diagnose(record_of(lag(u) + OWN["settling"], u))
    assert names(diagnosis) == ["output-drift"]
    assert diagnosis.report["gap"]["before"] > 3.0 * diagnosis.report["gap"]["noise_floor"]


@searched(*FEW)
def test_a_sinusoid_on_a_first_order_rig_is_not_fitted_as_a_pole_pair() -> None:
    u = levels()
    diagnosis = diagnose(record_of(lag(u) + OWN["fast wave"], u))
    assert names(diagnosis) == ["periodic-disturbance"]
    cycles = 22.0 * SAMPLES / (SAMPLES - 1)
    found = diagnosis.report["effects"][0]["parameters"]["frequency"]["value"]
    assert found == pytest.approx(cycles / (SAMPLES * TS), rel=0.02)


@searched(*FEW)
def test_a_first_order_rig_has_no_gap() -> None:
    """From any initial state: its free response decays soon."""
    u = levels()
    y = lag(u) + 0.8 * np.exp(-RATE * np.arange(SAMPLES))
    assert diagnose(record_of(y, u)).report["verdict"] == "none"


def test_poles_without_excitation_are_detected() -> None:
    drifting, data = fitted(OWN["ramp"])
    assert has_undriven_pole(data, drifting)
    other = fit_driven_pole(data, LINEAR)
    assert other is not None
    assert not has_undriven_pole(data, other)
    assert other.cost > drifting.cost
    still, data = fitted(0.9 * np.exp(-RATE * np.arange(SAMPLES)))
    assert not has_undriven_pole(data, still)


def test_an_integrator_is_excited_by_the_input() -> None:
    u = levels() - 2.0
    y = np.cumsum(lag(u)) / 20.0 + NOISE * np.random.default_rng(11).standard_normal(SAMPLES)
    data = scaled(u, y, np.ones(SAMPLES, bool), TS)
    assert not has_undriven_pole(data, fit_baseline(data))


def test_nonlinear_dynamics_are_not_tested_for_undriven_poles() -> None:
    fit, data = fitted(OWN["ramp"])
    for effect in (tanks.SqrtOutflow("both"), dynamics.CubicStiffness()):
        hypothesis = Hypothesis((effect,))
        other = replace(fit, hypothesis=hypothesis, theta=np.zeros(len(hypothesis.parameters)))
        assert not has_undriven_pole(data, other)


@searched(*FEW)
def test_an_additional_mode_is_named_resonance_and_not_extra_lag() -> None:
    """One pole and a mode: the three poles could also be an oscillatory rig and a lag."""
    u, damping = levels(9), 0.06
    diagnosis = diagnose(record_of(mode(u, damping, 0.6), u))
    assert names(diagnosis) == ["resonance"]
    assert diagnosis.report["effects"][0]["parameters"]["damping"]["value"] == pytest.approx(damping, rel=0.2)


@searched(*FEW)
def test_an_additional_lag_on_an_oscillatory_rig_is_named_extra_lag() -> None:
    u = levels(9)
    diagnosis = diagnose(record_of(mode(u, 0.3, 0.15), u))
    assert names(diagnosis) == ["extra-lag"]


@searched("extra-lag", "output-drift")
def test_only_a_fit_with_an_extra_lag_can_hide_a_mode() -> None:
    fit, data = fitted(OWN["ramp"])
    levels_tried, _ = search_effects(data, LINEAR, None, 1, None)
    lagged = next(tried for names, tried in levels_tried[1].items() if names == ("output-drift",))
    assert not lag_became_mode(fit, lagged)
    light = Hypothesis((dynamics.ExtraLag(),))
    theta = np.zeros(len(light.parameters))
    theta[light.slices["plant"]][:2] = np.log(0.02), np.log(0.25)  # damping 0.02
    swinging = replace(fit, hypothesis=light, theta=theta)
    assert lag_became_mode(fit, swinging)
    assert not lag_became_mode(swinging, swinging)
    wandering = Hypothesis((output.Drift("1"),))
    assert not lag_became_mode(fit, replace(fit, hypothesis=wandering, theta=theta[: len(wandering.parameters)]))


@searched(*FEW)
def test_an_undriven_pole_beside_another_effect_is_replaced_by_the_disturbance_it_imitates() -> None:
    """A dead zone ahead of one pole, with a sinusoid at the output; the test below has a ramp."""
    u = levels()
    y = lag(np.sign(u - 2.0) * np.maximum(np.abs(u - 2.0) - 0.25, 0.0)) + 1.5 * OWN["wave"]
    diagnosis = diagnose(record_of(y, u))
    assert set(names(diagnosis)) == {"input-dead-zone", "periodic-disturbance"}


def test_replacing_an_undriven_pole_returns_the_steps_without_and_with_the_drift() -> None:
    u = levels()
    y = lag(np.sign(u - 2.0) * np.maximum(np.abs(u - 2.0) - 0.25, 0.0)) + 0.5 * ALONG
    data = scaled(u, y + NOISE * np.random.default_rng(11).standard_normal(SAMPLES), np.ones(SAMPLES, bool), TS)
    hypothesis = Hypothesis((input.DeadZone(),))
    numbers = {"low": -0.4, "high": 0.4, "log_c": np.log(RATE), "log_k": np.log(RATE) - 14.0}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    point = minimize(data, hypothesis, theta, iterations=30)
    assert point is not None
    fit = finish(data, hypothesis, point)
    assert has_undriven_pole(data, fit)
    steps = replace_undriven_pole(data, fit, -np.inf)
    assert steps is not None
    without, along = steps
    assert without.hypothesis == hypothesis
    assert along.hypothesis.names == ("input-dead-zone", "output-drift")
    assert not has_undriven_pole(data, along)
    assert rms(data, without) > 5.0 * rms(data, along)
    assert along.bic < fit.bic + 10.0
    assert replace_undriven_pole(data, along, -np.inf) is None


@searched(*FEW)
def test_a_slow_pole_whose_response_its_free_response_cancels_is_no_slow_rig():
    rng = np.random.default_rng(130)
    u = np.repeat(rng.integers(0, 2, 125) * 10.0, 12)
    y = lfilter([0.0, 1.0 - np.exp(-0.17)], [1.0, -np.exp(-0.17)], u)
    slow = lfilter([0.036], [1.0, -0.97], rng.standard_normal(u.size))
    data = scaled(u, y + slow * y.std(), np.ones(u.size, bool), 0.05)
    assert slowest_driven_rate(data, fit_driven_pole(data, LINEAR)) == pytest.approx(0.17, rel=0.15)
    report = diagnose(Record(np.arange(u.size) * 0.05, u, y + slow * y.std(), 0.05)).report
    assert [effect["name"] for effect in report["effects"]] == ["coloured-noise"]  # 30 samples, and the rig six
