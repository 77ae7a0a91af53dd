"""Loads that end, and gains that change once, at the actuator or in the reading: named, with instants and sizes."""

from collections.abc import Callable

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap import diagnose
from labsid.gap.effects.disturbance import LoadStep, PassingLoad
from labsid.gap.effects.drifts import GainStep, ReadingStep
from labsid.gap.fits.fitting import fit_from
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.fits.parameter_estimates import estimate_parameters
from labsid.gap.record.data import Data, scaled
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = (
    "input-off",
    "input-nonlinearity",
    "extra-lag",
    "slow-mode",
    "parameter-drift",
    "output-drift",
    "output-nonlinearity",
    "load-step",
)
"""What changes at an instant, and what a rig that changed may be taken for."""

TS = 2.0
SAMPLES = 900
TIME_CONSTANT = 20.0
NOISE = 0.02


def moves(seed: int) -> FloatArray:
    """An operator's moves: levels that last 20 to 60 samples."""
    rng = np.random.default_rng(seed)
    levels = np.repeat(rng.uniform(1.0, 6.0, 60), rng.integers(20, 60, 60))
    return np.asarray(levels[:SAMPLES])


def first_order(u: FloatArray, time_constant: float = TIME_CONSTANT) -> FloatArray:
    """1.5/(T s + 1), the input held between the samples."""
    pole = np.exp(-TS / time_constant)
    return np.asarray(lfilter([0.0, 1.5 * (1.0 - pole)], [1.0, -pole], u - u[0]) + 1.5 * u[0])


def slower(u: FloatArray) -> FloatArray:
    """The same, whose time constant is twice as long from sample 480 on."""
    y = first_order(u)
    pole = np.exp(-TS / (2.0 * TIME_CONSTANT))
    for n in range(481, SAMPLES):
        y[n] = pole * y[n - 1] + 1.5 * (1.0 - pole) * u[n - 1]
    return y


def after(onset: int, end: int = SAMPLES) -> FloatArray:
    """One from a sample to another one."""
    return np.where((np.arange(SAMPLES) >= onset) & (np.arange(SAMPLES) < end), 1.0, 0.0)


def recorded(simulated: Callable[[FloatArray], FloatArray], seed: int) -> Record:
    """A record of a rig with noise of its sensor."""
    u = moves(seed)
    noise = NOISE * np.random.default_rng(1000 + seed).standard_normal(SAMPLES)
    return Record(np.arange(SAMPLES) * TS, u, simulated(u) + noise, TS)


def data_of(record: Record) -> Data:
    """The record as the search counts it."""
    return scaled(np.asarray(record.u), np.asarray(record.y), np.ones(SAMPLES, bool), TS)


RIGS: dict[str, tuple[str, Callable[[FloatArray], FloatArray], dict[str, float]]] = {
    "load that ends": (
        "load-step",
        lambda u: first_order(u - 1.2 * after(350, 600)),
        {"onset": 700.0, "end": 1200.0, "size": -1.8},
    ),
    "gain of the actuator": (
        "parameter-drift",
        lambda u: first_order(u * (1.0 + 0.4 * after(480))),
        {"onset": 960.0, "drift": 0.4},
    ),
    "speed of response": ("parameter-drift", slower, {"onset": 960.0, "pole": -0.5}),
    "gain of the reading": (
        "parameter-drift",
        lambda u: first_order(u) * (1.0 - 0.4 * after(480)),
        {"onset": 960.0, "drift": -0.4},
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("rig", RIGS)
@searched(*FEW)
def test_what_changes_at_an_instant_is_named_with_its_numbers(rig: str) -> None:
    name, simulated, truth = RIGS[rig]
    found = diagnose(recorded(simulated, 3))
    assert [one["name"] for one in found.report["effects"]] == [name]
    best = found.report["effects"][0]
    assert best["probability"] > 0.85
    numbers = best["parameters"]
    for parameter, value in truth.items():
        error = numbers[parameter]["stderr"]
        assert abs(numbers[parameter]["value"] - value) < 4.0 * error, parameter
        assert error < 0.02 * abs(value), parameter


@pytest.mark.slow
def test_errors_of_instants_are_those_of_repeated_records() -> None:
    """Of a load whose instants a record shows within a tenth of a sample."""
    misses = []
    for seed in range(24):
        data = data_of(recorded(lambda u: first_order(u - 1.2 * after(350, 600)), seed))
        base = fit_baseline(data)
        fit = fit_from(data, base.hypothesis.plus(PassingLoad("ends")), np.append(base.theta, [0.39, 0.66]), 40)
        assert fit is not None
        numbers = estimate_parameters(data, fit, PassingLoad("ends"))
        misses += [(numbers[n]["value"] - x) / numbers[n]["stderr"] for n, x in (("onset", 700.0), ("end", 1200.0))]
    assert 0.6 < np.sqrt(np.mean(np.square(misses))) < 1.4


@pytest.mark.parametrize("effect", [GainStep("step"), ReadingStep("step")], ids=["actuator", "reading"])
def test_a_gain_step_of_size_zero_changes_nothing(effect: GainStep | ReadingStep) -> None:
    x = moves(1)
    own = np.array([0.4, 0.0, 0.7])
    changed = effect.apply(x, own, x.size) if isinstance(effect, GainStep) else effect.apply(x, own)
    np.testing.assert_array_equal(changed, x)


def test_the_slope_of_a_reading_is_its_derivative() -> None:
    x, own = moves(2), np.array([0.4003, -0.3, 0.7])
    effect = ReadingStep("step")
    difference = (effect.apply(x + 0.5, own) - effect.apply(x - 0.5, own)) / 1.0
    np.testing.assert_allclose(effect.slope(x, own), difference, atol=1e-12)


def test_a_load_that_ends_at_the_end_of_the_record_is_one_that_begins() -> None:
    data = data_of(recorded(first_order, 1))
    base = fit_baseline(data)
    plant, rates = base.hypothesis.plant, base.theta[base.hypothesis.slices["plant"]]
    passing = PassingLoad("ends").columns(np.array([0.4, 1.0]), SAMPLES, SAMPLES, plant, rates)
    np.testing.assert_allclose(
        passing[:-1], LoadStep().columns(np.array([0.4]), SAMPLES, SAMPLES, plant, rates)[:-1], atol=1e-9
    )


@pytest.mark.slow
@searched(*FEW)
def test_a_fault_that_began_while_the_command_rested_may_have_begun_at_any_time_since() -> None:
    u = moves(8)
    last = int(np.flatnonzero(np.diff(u[:600]))[-1]) + 1  # the command rests from here on
    until = int(np.flatnonzero(np.diff(u[last:]))[0]) + last + 1
    acting = np.where(np.arange(SAMPLES) >= last, u[last], u)  # from its next move on, nothing of it arrives
    y = first_order(acting) + NOISE * np.random.default_rng(9).standard_normal(SAMPLES)
    (found,) = diagnose(Record(np.arange(SAMPLES) * TS, u, y, TS)).report["effects"]
    assert found["name"] == "input-off"
    start = found["parameters"]["onset"]
    spread = TS * (until - last) / np.sqrt(12.0)
    assert start["stderr"] > 0.5 * spread
    assert abs(start["value"] - TS * 0.5 * (last + until)) < 3.0 * start["stderr"]


def kicked(at: int, samples: int, by: float) -> Callable[[FloatArray], FloatArray]:
    """The rig with a short load, as of somebody who pushes against it."""
    return lambda u: first_order(u + by * after(at, at + samples))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("at", "samples", "seed"), [(310, 2, 11), pytest.param(505, 6, 12, marks=pytest.mark.exhaustive), (640, 1, 13)]
)
@searched(*FEW)
def test_a_kick_is_neither_a_command_that_is_not_applied_nor_a_change_of_the_rig(
    at: int, samples: int, seed: int
) -> None:
    report = diagnose(recorded(kicked(at, samples, 2.0), seed)).report
    likely = {one["name"] for one in report["effects"] if one["probability"] > 0.5}
    assert likely.isdisjoint({"input-off", "parameter-drift"})
    if any(one["name"] == "input-off" for one in report["effects"]):
        assert "load-step" in report["ambiguous"]


@pytest.mark.slow
@pytest.mark.parametrize("level", [0.0, 3.1], ids=["zero while the command rests", "any while it moves"])
@searched(*FEW)
def test_a_command_that_is_not_applied_is_told_from_a_kick(level: float) -> None:
    u = moves(21)
    moves_at = np.flatnonzero(np.diff(u))
    at = int(moves_at[8]) + 4
    end = at + 14 if level == 0.0 else int(moves_at[11])
    off = np.where((np.arange(SAMPLES) >= at) & (np.arange(SAMPLES) < end), level, u)
    assert (np.ptp(u[at:end]) == 0.0) == (level == 0.0)
    y = first_order(off) + NOISE * np.random.default_rng(22).standard_normal(SAMPLES)
    (found,) = diagnose(Record(np.arange(SAMPLES) * TS, u, y, TS)).report["effects"]
    assert found["name"] == "input-off"
    assert found["probability"] > 0.85
    level_found = found["parameters"]["level"]
    assert abs(level_found["value"] - level) < 4.0 * level_found["stderr"]


@pytest.mark.slow
@searched(*FEW)
def test_a_rig_that_changed_is_not_scored_on_another_run_of_before_or_after() -> None:
    """No simulation holds in both: before, the cause was "not known", and sentences spoke of the other run."""
    changed = recorded(lambda u: first_order(u * (1.0 + 0.4 * after(480))), 3)
    as_before = recorded(first_order, 4)
    report = diagnose(changed, holdout=as_before).report
    (found,) = report["effects"]
    assert (report["verdict"], found["name"]) == ("effect", "parameter-drift")
    assert found["parameters"]["onset"]["value"] == pytest.approx(960.0, abs=2.0)
    assert report["holdout_traces"] is None
    assert any("The rig changed during the record" in text for text in report["screen"])
