"""Free numbers of a given simulation: found over decades and signs, and what a record determines of them."""

import json
from collections.abc import Callable

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.fits.fitting import Fit, Problem, covariance, finish
from labsid.gap.fits.identifiability import determined_numbers
from labsid.gap.fits.number_search import search_numbers
from labsid.gap.fits.parameter_estimates import estimate_numbers
from labsid.gap.record.data import Data, scaled
from labsid.gap.reports.sentences import number_sentences
from labsid.gap.reports.text_report import format_report
from labsid.gap.simulations.baseline import as_simulation, make_baseline
from labsid.gap.simulations.simulation_files import load_simulation
from labsid.records.record import Record, load_record

pytestmark = pytest.mark.usefixtures("without_limits")

TS = 0.1
LEVELS = np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 30), 20)
T = TS * np.arange(LEVELS.size)
FEW = ("input-delay", "input-saturation", "load-step")


def lag(t: FloatArray, u: FloatArray, gain: float, tau: float) -> FloatArray:
    pole = np.exp(-TS / tau)
    return np.asarray(gain * lfilter([0.0, 1.0 - pole], [1.0, -pole], u))


def recorded(gain: float = 1.9, tau: float = 0.7) -> Record:
    y = lag(T, LEVELS, gain, tau)
    return Record(T, LEVELS, y + 0.01 * np.std(y) * np.random.default_rng(5).standard_normal(y.size), TS)


def fitted(simulate: Callable[..., FloatArray], *free: str, record: Record | None = None) -> tuple[Data, Fit]:
    record = record or recorded()
    data = scaled(record.u, record.y, np.ones(len(record), bool), TS)
    base = make_baseline(data, record.t, as_simulation(simulate, TS, free))
    theta = search_numbers(data, base.structure)
    assert theta is not None
    return data, finish(data, base.structure, Problem(data, base.structure).start(theta))


def values(data: Data, fit: Fit) -> dict[str, float]:
    return {one["name"]: one["value"] for one in estimate_numbers(data, fit)}


# Search ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("gain", "tau"), [(0.07, 14.0), (400.0, 0.01), (-2.0, 0.6), (-0.01, 30.0), (2e3, 5e2)])
def test_numbers_are_found_over_decades_and_signs(gain, tau):
    def simulate(t, u, gain=gain, tau=tau):
        return lag(t, u, gain, tau)  # NaN or an overflow at negative time constants

    with np.errstate(all="ignore"):
        found = values(*fitted(simulate, "gain", "tau"))
    assert found["gain"] == pytest.approx(1.9, rel=0.02)
    assert found["tau"] == pytest.approx(0.7, rel=0.03)


@pytest.mark.parametrize("true", [3e-4, -0.02, 500.0])
def test_a_number_that_is_nominally_zero_has_no_scale_of_its_own(true):
    def simulate(t, u, curve=0.0):
        y = lag(t, u, 1.0, 0.7)
        return y + curve * y**2 / true  # acts at the size of the true value

    record = Record(
        T, LEVELS, simulate(T, LEVELS, 0.4 * true) + 1e-3 * np.random.default_rng(1).normal(size=T.size), TS
    )
    assert values(*fitted(simulate, "curve", record=record))["curve"] == pytest.approx(0.4 * true, rel=0.05)


def test_a_simulation_that_fails_far_from_its_nominal_values_is_searched():
    def simulate(t, u, gain=0.2, tau=5.0):
        if not 0.01 < tau < 100.0:
            raise RuntimeError("the solver does not converge")
        return lag(t, u, gain, tau) if gain < 100.0 else np.full(u.size, np.nan)

    assert values(*fitted(simulate, "gain", "tau"))["tau"] == pytest.approx(0.7, rel=0.03)


def test_a_common_scale_leaves_also_a_number_of_small_effect_undetermined():
    def simulate(t, u, m=0.03, b=1.0, k=2.0, gain=2.0):
        numerator, denominator, _ = cont2discrete(([gain], [m, b, k]), TS)
        return lfilter(numerator.ravel(), denominator, u)

    y = simulate(T, LEVELS, 0.06, 1.2, 3.0, 4.0)
    record = Record(T, LEVELS, y + 0.01 * np.std(y) * np.random.default_rng(1).standard_normal(T.size), TS)
    found = estimate_numbers(*fitted(simulate, "m", "b", "k", "gain", record=record))
    numbers = {one["name"]: one for one in found}
    assert [one["determined"] for one in numbers.values()] == [False] * 4
    assert [one["stderr"] for one in numbers.values()] == [None] * 4
    assert numbers["m"]["combination"] == "m/gain, b/gain, k/gain"


def test_a_range_of_ones_own_is_kept_and_its_end_is_said():
    def simulate(t, u, gain=0.5, tau=1.0):
        return lag(t, u, gain, tau)

    data, fit = fitted(simulate, "gain=0:1", "tau")
    gain, tau = estimate_numbers(data, fit)
    assert gain["value"] == pytest.approx(1.0)
    assert (gain["at_limit"], gain["stderr"], tau["at_limit"]) == (True, None, False)
    assert "gain ended at its limit, 1.00" in number_sentences([gain, tau])[0]


def test_the_runs_of_the_search_are_few_and_within_the_budget():
    def simulate(t, u, gain=0.07, tau=14.0):
        return lag(t, u, gain, tau)

    record = recorded()
    data = scaled(record.u, record.y, np.ones(len(record), bool), TS)
    base = make_baseline(data, record.t, as_simulation(simulate, TS, ["gain", "tau"]))
    base.meter.begin(None)
    search_numbers(data, base.structure)
    assert base.meter.runs < 500
    base.meter.begin(100)  # too few for the grids: the fit from the nominal values remains
    with base.meter.searching():
        search_numbers(data, base.structure)
    assert base.meter.runs <= 100


# Identifiability ------------------------------------------------------------------------------------------


def of(simulate: Callable[..., FloatArray], *free: str) -> dict[str, tuple[bool, str]]:
    data, fit = fitted(simulate, *free)
    return {name: (one.determined, one.combination) for name, one in determined_numbers(data, fit).items()}


def test_of_a_product_only_the_product_is_determined():
    found = of(lambda t, u, ka=1.0, kb=1.5, tau=0.6: lag(t, u, ka * kb, tau), "ka", "kb", "tau")
    assert found == {"ka": (False, "ka kb"), "kb": (False, "ka kb"), "tau": (True, "")}


def test_of_equal_factors_the_product_is_told_from_the_sum():
    found = of(lambda t, u, ka=1.0, kb=1.0, tau=0.6: lag(t, u, ka * kb, tau), "ka", "kb", "tau")
    assert found["ka"] == (False, "ka kb")
    found = of(lambda t, u, ka=1.0, kb=1.0, tau=0.6: lag(t, u, ka + kb, tau), "ka", "kb", "tau")
    assert found["ka"] == found["kb"] == (False, "ka + kb")


def test_ratios_powers_and_differences_are_named():
    assert of(lambda t, u, k=2.0, m=1.3: lag(t, u, k / m, 0.7), "k", "m")["m"] == (False, "k/m")
    assert of(lambda t, u, k=1.5, m=1.3: lag(t, u, k**2 / m, 0.7), "k", "m")["m"] == (False, "k^2/m")
    assert of(lambda t, u, a=2.5, b=0.9: lag(t, u, a - b, 0.7), "a", "b")["b"] == (False, "a - b")


def test_of_three_numbers_with_a_common_factor_the_ratios_are_determined():
    found = of(lambda t, u, m=1.3, c=0.8, k=2.0: lag(t, u, k / c, m / c), "m", "c", "k")
    assert {determined for determined, _ in found.values()} == {False}
    words = found["m"][1].split(", ")
    assert len(words) == 2
    assert all("/" in word for word in words)


def test_of_three_factors_the_product_is_determined():
    found = of(lambda t, u, a=1.0, b=1.2, c=1.5: lag(t, u, a * b * c, 0.7), "a", "b", "c")
    assert set(found.values()) == {(False, "a b c")}


def test_a_number_without_influence_has_no_error_and_keeps_its_value():
    data, fit = fitted(lambda t, u, gain=1.5, extra=3.0: lag(t, u, gain, 0.7), "gain", "extra")
    gain, extra = estimate_numbers(data, fit)
    assert (extra["value"], extra["stderr"], extra["determined"], extra["combination"]) == (3.0, None, False, None)
    assert gain["determined"]
    assert 0.0 < gain["stderr"] < 0.01
    assert number_sentences([gain, extra]) == ["The record does not determine extra: the output hardly depends on it."]


def test_standard_errors_are_those_of_the_covariance():
    data, fit = fitted(lambda t, u, gain=1.5, tau=1.0: lag(t, u, gain, tau), "gain", "tau")
    at = fit.hypothesis.slices["plant"]
    scales = [one.scale(x) for one, x in zip(fit.hypothesis.plant.free, fit.theta[at], strict=True)]
    errors = np.sqrt(np.diag(covariance(data, fit))[at]) * scales
    np.testing.assert_allclose([one["stderr"] for one in estimate_numbers(data, fit)], errors, rtol=0.02)


# Whole diagnoses ------------------------------------------------------------------------------------------


@searched(*FEW)
def test_what_is_determined_is_in_the_report_and_in_the_progress():
    said = []
    found = diagnose(
        recorded(),
        lambda t, u, ka=1.0, kb=1.0, tau=0.6: lag(t, u, ka * kb, max(tau, 1e-9)),
        free=["ka", "kb", "tau"],
        progress=lambda what, share: said.append(what),
    )
    assert any("does not determine ka and kb, only ka kb" in what for what in said)
    report = json.loads(json.dumps(found.report))
    assert [(one["name"], one["determined"], one["combination"]) for one in report["numbers"]] == [
        ("ka", False, "ka kb"),
        ("kb", False, "ka kb"),
        ("tau", True, None),
    ]
    text = format_report(report)
    assert "not determined by itself" in text
    assert "only ka kb" in " ".join(text.split())


@searched(*FEW)
def test_the_numbers_far_away_and_the_pair_of_the_records_found(shared_data):
    folder = shared_data / "found"
    record = load_record(folder / "free-far.csv")
    simulation = load_simulation(f"{folder / 'free-far.py'}:simulate", record)
    report = diagnose(record, simulation, free=["gain", "tau"]).report
    assert [effect["name"] for effect in report["effects"]] == ["parameter-mismatch"]
    for one, true in zip(report["numbers"], (1.9172, 0.7363), strict=True):
        assert abs(one["value"] - true) < 3.0 * one["stderr"] < 0.01
    record = load_record(folder / "free-pair.csv")
    simulation = load_simulation(f"{folder / 'free-pair.py'}:simulate", record)
    numbers = diagnose(record, simulation, free=["ka", "kb", "tau"]).report["numbers"]
    assert [one["combination"] for one in numbers] == ["ka kb", "ka kb", None]
    assert [one["stderr"] is None for one in numbers] == [True, True, False]
    assert numbers[0]["value"] * numbers[1]["value"] == pytest.approx(1.9172, rel=0.003)
