"""The curve of each effect: of the numbers that the report states, and as the simulation applies the effect."""

import numpy as np
import pytest
from gap_reports import PARAMETERS, report, seen_effect
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.effects.input import Backlash, DeadZone, Nonlinearity, Saturation
from labsid.gap.effects.sketch import ends_of
from labsid.gap.reports.effect_curves import effect_curve
from labsid.records.record import Record

DRAWN = [name for name in PARAMETERS if DESCRIPTIONS[name].sketch is not None]


def curve_of(name, **values):
    """The curve of an effect in a report with these values of its parameters, without errors."""
    shown = report(name)
    (effect,) = shown["effects"]
    effect["parameters"] |= {key: {"value": value, "stderr": 0.0, "unit": "u"} for key, value in values.items()}
    return effect_curve(shown, effect)


@pytest.mark.parametrize("name", DRAWN)
def test_every_curve_is_drawn_and_differs_from_what_a_simulation_without_it_assumes(name):
    curve = effect_curve(*seen_effect(name))
    assert curve is not None
    assert np.abs(curve["curve"] - curve["plain"]).max() > 0.0
    assert all(curve["labels"])


def test_an_effect_without_a_curve_has_no_picture():
    for name in ("output-outliers", "output-drift", "parameter-mismatch"):
        shown = report(name)
        assert effect_curve(shown, shown["effects"][0]) is None


@pytest.mark.parametrize(
    ("effect", "own", "values"),
    [
        (Saturation("both"), [0.4, 2.1], {"low": 0.4, "high": 2.1}),
        (DeadZone("jump"), [0.4, 2.1, 0.2, 0.3], {"low": 0.4, "high": 2.1, "jump_low": 0.2, "jump_high": 0.3}),
        (DeadZone("gain"), [0.4, 2.1, np.log(0.5)], {"low": 0.4, "high": 2.1, "ratio": 0.5}),
        (Backlash(), [0.6, 0.5], {"width": 0.6}),
        (Nonlinearity(), [0.1, -0.02], {"c2": 0.1, "c3": -0.02, "centre": 0.0}),
    ],
    ids=lambda one: getattr(one, "key", ""),
)
def test_the_curve_is_what_the_simulation_applies(effect, own, values):
    curve = curve_of(effect.name, **values)
    np.testing.assert_allclose(curve["curve"], effect.apply(curve["x"], np.array(own), curve["x"].size), atol=1e-12)


def test_the_band_is_the_error_of_the_parameters():
    shown = report("extra-lag")
    (effect,) = shown["effects"]
    effect["parameters"]["tau"] = {"value": 2.0, "stderr": 0.5, "unit": "s"}
    curve = effect_curve(shown, effect)
    at = int(np.argmin(np.abs(curve["x"] - 2.0)))
    t = curve["x"][at]
    assert curve["curve"][at] == pytest.approx(1.0 - np.exp(-t / 2.0))
    assert curve["band"][at] == pytest.approx(np.exp(-t / 2.98) - np.exp(-t / 2.0))
    assert curve["band"][curve["x"] < 0.0].max() == 0.0


def test_places_have_their_error_and_the_record_its_visits():
    shown = report("input-saturation") | {"units": {"u": "$V$", "y": "mm"}}
    curve = effect_curve(shown, shown["effects"][0])
    assert curve["marks"] == [(-0.5115, pytest.approx(1.96 * 0.0007)), (0.0897, pytest.approx(1.96 * 0.0005))]
    np.testing.assert_array_equal(curve["visits"], shown["traces"]["u"])
    assert curve["labels"] == ("Command ($V$)", "Command that acts ($V$)")


def test_a_place_far_from_the_record_does_not_set_its_axis():
    signal = np.array([1.0, 2.0])
    assert ends_of(signal, 0.0, (0.5, 40.0)) == (0.5, 2.0)
    assert ends_of(signal, 0.1) == (0.9, 2.1)


def test_a_drift_is_drawn_over_time_with_the_error_of_its_amplitude():
    shown = report("output-drift") | {"units": {"u": "V", "y": "mm"}}
    (drift,) = shown["effects"]
    drift |= {"course": {"t": [0.0, 50.0, 100.0], "y": [-0.02, 0.0, 0.08]}}
    curve = effect_curve(shown, drift)
    np.testing.assert_array_equal(curve["curve"], [-0.02, 0.0, 0.08])
    error = 1.96 * 0.00057 / 0.07595
    np.testing.assert_allclose(curve["band"], [0.02 * error, 0.0, 0.08 * error])
    assert curve["labels"] == ("Time (s)", "Change of the reading (mm)")
    assert effect_curve(shown, report("output-drift")["effects"][0]) is None


@searched("output-drift")
def test_the_course_of_a_drift_is_that_of_the_record():
    rng = np.random.default_rng(1)
    u = np.repeat(rng.uniform(1.0, 4.0, 32), 20)
    x = np.linspace(-1.0, 1.0, u.size)
    added = 0.1 * x + 0.06 * x**2
    y = u[0] + lfilter([0.0, 0.01], np.poly([0.95, 0.8]), u - u[0]) + added
    t = 10.0 + 0.5 * np.arange(u.size)
    found = diagnose(Record(t, u, y + 0.005 * rng.standard_normal(u.size), 0.5)).report
    course = found["effects"][0]["course"]
    true = np.interp(course["t"], t, added)
    assert (course["t"][0], course["t"][-1]) == (t[0], t[-1])
    np.testing.assert_allclose(np.subtract(course["y"], np.mean(course["y"])), true - true.mean(), atol=0.005)
