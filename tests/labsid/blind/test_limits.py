"""Planted effects have the size that the report states, and the counts are right."""

import numpy as np
import pytest

from labsid.blind import limits
from labsid.blind.limits import _PLANTED, Planting, draw_rig, is_larger, is_same_place, judge, planted_setup, size_at
from labsid.rig.switchable.truth import true_parameters

AT = {"low": 3.0, "high": 3.4, "onset": 40.0, "frequency": 0.02, "tau": 30.0, "middle": 3.2}


@pytest.mark.parametrize(("name", "parameter"), sorted(_PLANTED))
def test_a_planted_effect_has_the_size_that_was_asked_for(name, parameter):
    experiment = draw_rig(np.random.default_rng(3))
    scales = experiment.scales
    row = {"name": name, "parameter": parameter, "at": dict(AT)}
    value = 0.2 * abs(scales.ys) if name.startswith("output") else 0.2 * scales.us
    setup = planted_setup(experiment.plain, scales, row, value, gain=2.0)
    truth = true_parameters(name, setup, scales, experiment.samples)
    if name == "input-dead-zone":
        assert truth["high"] - truth["low"] == pytest.approx(value)
    elif name == "output-drift":  # the whole change; the report states half of it
        assert truth["amplitude"] == pytest.approx(2.0 * value)
    elif name == "load-step":
        assert (truth["onset"], truth["size"]) == pytest.approx((AT["onset"], value / (2.0 * scales.ys) * scales.us))
    elif name == "periodic-disturbance":
        assert truth["frequency"] == pytest.approx(AT["frequency"])
        assert setup.sensor.amplitude == pytest.approx(value / abs(scales.ys))
    else:
        assert truth[parameter] == pytest.approx(value)


def test_sizes_are_proportional_inverse_or_distances_from_an_end():
    share = {"named": 0.1}
    assert size_at({"parameter": "width", "named": 3.0, "share": share}, 0.05) == pytest.approx(1.5)
    assert size_at({"parameter": "rate", "named": 3.0, "share": share}, 0.05) == pytest.approx(6.0)
    assert size_at({"parameter": "high", "named": 3.0, "share": share, "end": 4.0}, 0.05) == pytest.approx(3.5)


def test_the_counts():
    one, two = (Planting(name, "input-backlash", "width", name, 0.01, 2.0, {"tau": 1.0}) for name in ("named", "half"))
    row = {"name": "input-backlash", "parameter": "width", "excluded_above": 1.0, "at": {}}
    stated = [row | {"share": {"excluded_above": 0.005}}]
    found = {
        "named": {"verdict": "effect", "effects": [{"name": "input-backlash", "probability": 0.9}], "limits": stated},
        "half": {"verdict": "none", "effects": [], "limits": stated},
    }
    assert judge([one, two], found) == {"named": (1, 1), "half": (0, 1), "wrong": (0, 2), "excluded": (1, 1)}
    found["half"] |= {"verdict": "effect", "effects": [{"name": "extra-lag", "probability": 0.6}]}
    assert judge([one, two], found)["wrong"] == (1, 2)
    assert judge([one], {}) == {"named": (0, 1), "half": (0, 0), "wrong": (0, 0), "excluded": (0, 0)}


def test_a_limit_of_another_place_says_nothing_and_a_lower_limit_is_a_larger_effect():
    assert is_same_place({"frequency": 1.0, "low": 3.0}, {"frequency": 1.005, "low": 4.0})
    assert not is_same_place({"frequency": 1.0}, {"frequency": 1.1})
    assert is_larger("high", 3.0, 4.0)
    assert is_larger("low", 4.0, 3.0)
    assert is_larger("rate", 3.0, 4.0)
    assert is_larger("width", 4.0, 3.0)


def test_metrics_hold_the_counts_of_the_row(monkeypatch):
    sizes = ("named",) * 10 + ("half",) * 4
    plantings = [Planting(f"r{i}", "input-delay", "delay", times, 0.1, 2.0, {}) for i, times in enumerate(sizes)]
    named = {"verdict": "effect", "effects": [{"name": "input-delay", "probability": 0.9}], "limits": []}
    silent = {"verdict": "none", "effects": [], "limits": []}
    results = {p.name: named if i < 9 else silent for i, p in enumerate(plantings)}
    monkeypatch.setattr(limits, "plant_and_diagnose", lambda rigs, seed, jobs: (plantings, results))
    at_named, at_half, wrong, excluded = limits.limit_metrics(4, 0, 1)
    assert (at_named.value, at_named.count, at_named.reaches(at_named.required)) == (0.9, 10, True)
    assert (at_half.value, at_half.reaches(at_half.required)) == (0.0, True)
    assert wrong.value == 0.0
    assert excluded.value is None
