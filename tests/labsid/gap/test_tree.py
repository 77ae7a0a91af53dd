"""The search among combinations: order in the chain, exchange, leaving out, integrators, a start from an export."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.candidates import without
from labsid.gap.context import Data, scaled
from labsid.gap.diagnosis import diagnose
from labsid.gap.effects import drifting, input
from labsid.gap.fitting import finish, rms, search
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.tree import best_path, keep
from labsid.gap.which import Explained, explain
from labsid.record import Record

Response = Callable[..., FloatArray]
RATE = 0.15  # of the input, a sample


def data_of(u: FloatArray, y: FloatArray, noise: float = 0.01, seed: int = 4) -> Data:
    y = y + noise * np.std(y) * np.random.default_rng(seed).standard_normal(y.size)
    return scaled(u, y, np.ones(u.size, bool), 1.0)


def curve(w: FloatArray) -> FloatArray:
    return w + 0.2 * w**2 - 0.1 * w**3


def slewing(w: FloatArray) -> FloatArray:
    """What a limited rate makes of levels: sample by sample, the mean of each."""
    now, out = w[0], np.empty_like(w)
    for i, goal in enumerate(w):
        step = np.clip(goal - now, -RATE, RATE)
        reached = abs(goal - now) / RATE  # of the sample
        out[i] = now + 0.5 * step if reached >= 1.0 else goal - 0.5 * reached * step
        now += step
    return out


@pytest.mark.parametrize("first", ["curve", "rate"])
def test_a_pair_is_found_whatever_its_order_in_the_actuator(
    levels: FloatArray, two_poles: Response, first: str
) -> None:
    w = slewing(curve(levels)) if first == "curve" else curve(slewing(levels))
    found = explain(data_of(levels, two_poles(w)))
    assert set(found.names) == {"input-rate-limit", "input-nonlinearity"}
    assert rms(found.data, found.best) < 0.012


def test_the_curve_stands_at_the_end_of_the_actuator_unless_told() -> None:
    assert [e.name for e in Hypothesis((input.Nonlinearity(), input.RateLimit())).inputs] == [
        "input-rate-limit",
        "input-nonlinearity",
    ]
    assert [e.name for e in Hypothesis((input.RateLimit(), input.Nonlinearity("first"))).inputs] == [
        "input-nonlinearity",
        "input-rate-limit",
    ]
    behind = Hypothesis((input.RateLimit("behind"), input.DeadZone()))
    assert [e.name for e in behind.inputs] == ["input-dead-zone", "input-rate-limit"]


def test_without_takes_one_effect_out_and_keeps_the_other_numbers(levels: FloatArray, two_poles: Response) -> None:
    u = levels[:400]
    data = data_of(u, two_poles(np.minimum(u, 0.8)))
    hypothesis = Hypothesis((input.Saturation("high"), drifting.GainDrift("1")))
    theta = np.array([0.0, 0.8 / np.std(u), 0.02, 0.0, np.log(0.5), np.log(0.05)])
    point = search(data, hypothesis, theta, iterations=0)
    assert point is not None
    fit = finish(data, hypothesis, point)
    fewer = without(data, fit, 1)
    assert fewer is not None
    assert fewer.hypothesis.keys == ("input-saturation/high",)
    np.testing.assert_array_equal(fewer.theta, np.delete(fit.theta, [2, 3]))
    other = without(data, fit, 0)
    assert other is not None
    assert other.hypothesis.keys == ("parameter-drift/gain-1",)
    np.testing.assert_array_equal(other.theta, np.delete(fit.theta, 1))


def test_a_level_keeps_the_better_of_two_fits_of_the_same_names(banded: Explained) -> None:
    fit = banded.best
    level = {("input-dead-zone",): fit}
    keep(level, [None, replace(fit, bic=fit.bic + 1.0)])
    assert level == {("input-dead-zone",): fit}
    better = replace(fit, bic=fit.bic - 1.0)
    keep(level, [better])
    assert level == {("input-dead-zone",): better}


def test_the_best_path_goes_as_far_as_effects_are_worth_it(banded: Explained) -> None:
    assert best_path(banded.data, banded.levels)[:2] == banded.path[:2]
    (base,) = banded.levels[0].values()
    assert best_path(banded.data, (banded.levels[0], {("nothing",): replace(base, bic=base.bic - 1.0)})) == (base,)


def bent_gain(samples: int) -> FloatArray:
    """A gain that rises to the middle of the record and falls back: what a straight line cannot follow."""
    return 1.0 + 0.5 * (1.0 - np.linspace(-1.0, 1.0, samples) ** 2)


def test_a_gain_that_comes_back_is_a_drift_of_the_gain(levels: FloatArray, two_poles: Response) -> None:
    found = explain(data_of(levels, two_poles(levels * bent_gain(levels.size))))
    assert found.names == ("parameter-drift",)
    assert found.best.hypothesis.keys == ("parameter-drift/gain-4",)


@pytest.mark.parametrize("poles", [[1.0, 0.7], [1.0, 1.0]], ids=["integrator", "double integrator"])
def test_an_integrating_rig_with_an_offset_has_no_effect(levels: FloatArray, poles: list[float]) -> None:
    """Behind an integrator an offset of the input is a ramp, and a parabola behind two; neither is a load."""
    swing = np.repeat(np.random.default_rng(5).choice([-1.0, 1.0], 150), 4) + 0.05
    if poles == [1.0, 1.0]:  # held in place by its own feedback
        swing = _steered(swing)
    y = lfilter([0.0, 0.05], np.poly(poles), swing)
    assert explain(data_of(swing, y)).names == ()


def _steered(goal: FloatArray) -> FloatArray:
    """The command with which a lead controller leads a double integrator of gain 0.05 after a goal."""
    place, speed, command = 0.0, 0.0, np.empty(goal.size)
    for i, wanted in enumerate(goal):
        command[i] = 0.5 * (wanted - place) - 2.5 * speed
        place, speed = place + speed, speed + 0.05 * command[i]
    return command


@pytest.mark.parametrize("effect", ["input-saturation", "input-delay", "load-step", "output-saturation"])
def test_a_simulation_that_already_has_the_effect_in_it_leaves_none(
    rig_record: Callable[..., Record], effect: str
) -> None:
    record = rig_record(effect)
    first = diagnose(record)
    assert [one["name"] for one in first.report["effects"]] == [effect]
    again = diagnose(record, first.model.to_json_dict())
    assert again.report["verdict"] == "none"
    assert again.report["effects"] == []


def test_an_export_counts_in_its_own_units_on_another_record(rig_record: Callable[..., Record]) -> None:
    """Another input has another mean and spread; the exported numbers stay what they are."""
    model = diagnose(rig_record("input-saturation")).model
    other = rig_record("input-saturation", samples=800, seed=9)
    report = diagnose(other, model.to_json_dict()).report
    assert report["verdict"] == "none"
    assert report["gap"]["before"] < 1.2 * report["gap"]["noise_floor"]
