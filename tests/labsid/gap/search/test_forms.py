"""Alternative forms of effects: other positions, more general ones, and removal of an effect."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects import disturbance, drifts, dynamics, input, output, periodic, tanks
from labsid.gap.effects.base import Effect, Fitted, PlantEffect
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.fitting import Fit, finish, minimize, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import LINEAR, fit_baseline, fit_highpass
from labsid.gap.model_file import export_model
from labsid.gap.record.data import Data, scaled
from labsid.gap.search.beam_search import plausible_forms
from labsid.gap.search.candidates import best_fit, best_form, trial_fits
from labsid.gap.search.explanation import Explanation, explain
from labsid.gap.search.forms import alternative_forms, extended_hypotheses, plain_forms, remove_effect, transfer_theta
from labsid.gap.search.refinement import converge

INNER_LOAD = disturbance.InnerLoad("inside")
UPSTREAM_LOAD = disturbance.InnerLoad("ahead")
INNER_PERIODIC = periodic.InnerPeriodic("inside")
UPSTREAM_PERIODIC = periodic.InnerPeriodic("ahead")
PERIODIC_LOAD = periodic.Periodic("load")
PERIODIC = periodic.Periodic()
LOAD = disturbance.LoadStep()
LEAK = disturbance.Leak("leak")

Response = Callable[..., FloatArray]


def data_of(u: FloatArray, y: FloatArray) -> Data:
    """Scaled, every row counted."""
    return scaled(u, y, np.ones(u.size, bool), 1.0)


def test_a_lag_and_a_mode_are_tried_at_every_place_to_a_nonlinear_state() -> None:
    linear = Hypothesis((dynamics.ExtraLag(), dynamics.Resonance()))
    assert alternative_forms(linear) == []
    bent = linear.plus(dynamics.CubicStiffness())
    keys = [other.keys for other in alternative_forms(bent)]
    assert keys == [
        ("extra-lag/ahead", "resonance", "cubic-stiffness"),
        ("extra-lag", "resonance/ahead", "cubic-stiffness"),
        ("extra-lag", "resonance/beside", "cubic-stiffness"),
    ]
    assert all(other.parameters == bent.parameters and other.names == bent.names for other in alternative_forms(bent))
    given = Hypothesis(bent.effects, n_given=1)
    assert all(other.effects[0] == dynamics.ExtraLag() for other in alternative_forms(given))


def test_actuator_effects_are_tried_in_either_order_beside_another_one() -> None:
    curve, rate = input.Nonlinearity(), input.RateLimit()
    orders = {input.Nonlinearity("first"), input.RateLimit("behind")}
    for alone in ((curve,), (rate,), (curve, input.Delay())):
        assert not any(orders & set(other.effects) for other in alternative_forms(Hypothesis(alone)))
    assert [other.keys for other in alternative_forms(Hypothesis((curve, rate))) if orders & set(other.effects)] == [
        ("input-nonlinearity/first", "input-rate-limit"),
        ("input-nonlinearity", "input-rate-limit/behind"),
    ]


GENERAL: dict[Effect, tuple[Effect, ...]] = {
    input.Delay(): (input.Delay("switched"), input.Delay("no-zero switched")),
    input.Delay("no-zero"): (input.Delay("no-zero switched"),),
    input.RateLimit(): tuple(map(input.RateLimit, ("switched", "timed", "uneven", "uneven-timed"))),
    input.Nonlinearity(): (input.Nonlinearity("rich"),),
    output.Nonlinearity(): (output.Nonlinearity("rich"),),
}


@pytest.mark.parametrize("effect", list(GENERAL))
def test_effects_have_more_general_forms(effect: Effect) -> None:
    beside = dynamics.ExtraLag()
    others = alternative_forms(Hypothesis((effect, beside)))
    assert [other.effects for other in others] == [(form, beside) for form in GENERAL[effect]]
    assert all(other.names == (effect.name, "extra-lag") and alternative_forms(other) == [] for other in others)
    assert alternative_forms(Hypothesis((effect, beside), n_given=1)) == []


@pytest.mark.parametrize("effect", list(GENERAL))
def test_a_general_form_starts_equal_to_the_special_one(
    levels: FloatArray, two_poles: Response, banded: Explanation, effect: Effect
) -> None:
    numbers = {"delay": 3.4, "log_rate": -1.0, "c2": 0.1, "c3": -0.05, "log_c": np.log(0.5), "log_k": np.log(0.05)}
    old = Hypothesis((effect,))
    theta = np.array([numbers[p.name] for p in old.parameters])
    gains = np.linspace(0.02, 0.05, old.design(theta, levels).columns.shape[1])
    other = alternative_forms(old)[0]  # a zero of the dynamics is left out in the second form of a delay
    found = transfer_theta(replace(banded.path[0], hypothesis=old, theta=theta), other)
    assert found.size > theta.size
    error = 0.05 if "nonlinearity" in effect.name else 1e-12  # of a spline next to a cubic, and straight at the ends
    np.testing.assert_allclose(other.output(found, gains, levels), old.output(theta, gains, levels), atol=error)


def test_an_overflow_is_tried_at_both_tanks() -> None:
    for side in ("", "-flipped"):
        for which in ("upper", "lower"):
            others = {"upper": ("both", "lower", "weir"), "lower": ("both", "weir", "upper")}[which]
            forms = alternative_forms(Hypothesis((tanks.Overflow(which + side),)))
            assert [form.effects for form in forms] == [(tanks.Overflow(other + side),) for other in others]
            assert {form.plant.flipped for form in forms} == {side != ""}
        assert alternative_forms(forms[0]) == []


def test_a_tank_with_a_brim_keeps_its_rate_before_and_behind_the_other_one(
    levels: FloatArray, two_poles: Response
) -> None:
    """Where the other one is quick, it makes little difference."""
    data = data_of(levels, two_poles(levels))
    old = Hypothesis((tanks.Overflow("lower"),))
    numbers = {"log_a": np.log(5.0), "log_b": np.log(0.1), "brim": 0.7, "h1": 0.2, "h2": -0.3}
    theta = np.array([numbers.get(p.name, 0.0) for p in old.parameters])
    point = minimize(data, old, theta, iterations=0)
    assert point is not None
    fit = finish(data, old, point)
    (turned,) = (other for other in alternative_forms(old) if other.plant.brims == ("upper",))
    found = transfer_theta(fit, turned)
    own = dict(zip([p.name for p in turned.parameters], found, strict=True))
    expected = {"log_a": np.log(0.1), "log_b": np.log(5.0), "brim": 0.7, "h1": -0.3, "h2": 0.2, "share": 0.0}
    assert own == pytest.approx(expected | {"delay": 0.0})
    again = turned.output(found, fit.gains, levels)
    assert np.sqrt(np.mean((again - fit.output)[60:] ** 2)) < 0.2 * np.std(fit.output)
    rooted = Hypothesis((tanks.SqrtOutflow("both"), tanks.Overflow("lower")))
    assert not any(other.plant.brims == ("upper",) for other in alternative_forms(rooted))


@pytest.mark.parametrize("bends", ["1", "4"])
def test_a_drift_beside_a_nonlinear_state_may_be_of_a_gain_or_a_pole(bends: str) -> None:
    gain, pole, brim = drifts.GainDrift(bends), drifts.InnerPoleDrift(bends), tanks.Overflow("lower")
    for one, other in ((gain, pole), (pole, gain)):
        assert any(form.effects == (brim, other) for form in alternative_forms(Hypothesis((brim, one))))
    assert alternative_forms(Hypothesis((gain,))) == []


@pytest.mark.parametrize("root", [(), (tanks.SqrtOutflow("both"),), (tanks.SqrtOutflow("lower"),)])
@pytest.mark.parametrize("which", ["upper", "lower"])
def test_the_other_brim_begins_a_little_below_the_highest_level(
    levels: FloatArray, two_poles: Response, which: str, root: tuple[Effect, ...]
) -> None:
    """Of the upper tank at the level from which as much flows out; the brim that is known stays where it is."""
    data = data_of(levels, two_poles(levels))
    old = Hypothesis((*root, tanks.Overflow(which)))
    numbers = {"log_a": 0.0, "log_b": -0.5, "zero": -3.0, "brim": 40.0, "share": 0.3}
    theta = np.array([numbers.get(p.name, 0.0) for p in old.parameters])
    point = minimize(data, old, theta, iterations=0)
    assert point is not None
    fit = finish(data, old, point)
    (both,) = (other for other in alternative_forms(old) if len(other.plant.brims) == 2)
    found = dict(
        zip([p.name for p in both.plant.parameters], transfer_theta(fit, both)[both.slices["plant"]], strict=True)
    )
    known, new = ("brim", "brim2") if which == "upper" else ("brim2", "brim")
    assert found[known] == numbers["brim"]
    unit, offset = fit.gains[:2]
    level = (fit.output - offset) / unit
    flow = np.sqrt(np.maximum(level, 0.0)) if "lower" in old.plant.roots else level
    expected = level if which == "upper" else flow**2 if "upper" in old.plant.roots else flow
    assert 0.02 < np.mean(expected > found[new]) < 0.04
    np.testing.assert_allclose(both.plant.linear_rates(transfer_theta(fit, both)[both.slices["plant"]]), fit.rates)


@pytest.mark.parametrize(
    "group",
    [
        (dynamics.ExtraLag(), dynamics.ExtraLag("ahead")),
        (dynamics.Resonance(), dynamics.Resonance("ahead"), dynamics.Resonance("beside")),
        (dynamics.CoulombFriction("speed"), dynamics.CoulombFriction("speed-lag")),
        (input.RateLimit(), input.RateLimit("behind")),
        (input.Nonlinearity(), input.Nonlinearity("first")),
    ],
)
def test_forms_of_one_effect_share_its_name_and_numbers(group: tuple[Effect, ...]) -> None:
    first, *others = (Hypothesis((effect, tanks.SqrtOutflow("both"))) for effect in group)
    if group[0].name == "coulomb-friction":
        first, *others = (Hypothesis((effect,)) for effect in group)
    for other in others:
        assert other.names == first.names
        assert other.keys != first.keys
        assert other.parameters == first.parameters


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        (None, LEAK),
        (dynamics.ExtraLag(), LEAK),
        (tanks.SqrtOutflow("both"), INNER_LOAD),
        (dynamics.CubicStiffness(), INNER_LOAD),
        (dynamics.CoulombFriction("speed"), INNER_LOAD),
        (drifts.PoleDrift("1"), None),
    ],
)
def test_a_load_grows_with_the_state_as_its_dynamics_hold_it(effect: Effect | None, expected: Effect | None) -> None:
    hypothesis = LINEAR if effect is None else LINEAR.plus(effect)
    found = [other.effects[-1] for other in alternative_forms(hypothesis.plus(LOAD)) if other.effects[-1] != LOAD]
    assert found == [effect for effect in (expected,) if effect is not None]


def test_a_given_simulation_has_no_leak_form() -> None:
    given = Plant(kind="given", simulation=GivenSimulation(lambda w, numbers: w))
    assert LOAD.alternatives(Hypothesis((LOAD,), given=given)) == []


def test_a_load_that_grows_on_linear_dynamics_is_also_tried_as_one_that_does_not() -> None:
    (plain,) = alternative_forms(Hypothesis((input.Backlash(), LEAK)))
    assert plain.effects == (input.Backlash(), LOAD)
    assert alternative_forms(Hypothesis((input.Backlash(), LEAK), n_given=2)) == []


def test_numbers_are_carried_to_another_form(banded: Explanation) -> None:
    base = banded.path[0]
    leak = Hypothesis((input.DeadZone(), disturbance.Leak("leak")))
    theta = np.arange(1.0, len(leak.parameters) + 1.0)
    (plain,) = (form for form in alternative_forms(leak) if LOAD in form.effects)
    assert plain.keys == ("input-dead-zone", "load-step")
    fit = replace(base, hypothesis=leak, theta=theta)
    names = [p.name for p in leak.parameters]
    expected = [theta[names.index(p.name)] for p in plain.parameters]
    np.testing.assert_array_equal(transfer_theta(fit, plain), expected)
    assert plain.parameters[-1].name == "onset"


def test_an_inner_load_has_the_onset_of_the_plain_one(banded: Explanation) -> None:
    old = Hypothesis((tanks.SqrtOutflow("both"), LOAD))
    fit = replace(banded.path[0], hypothesis=old, theta=np.arange(1.0, len(old.parameters) + 1.0))
    (grown,) = (other for other in alternative_forms(old) if other.effects[0] == old.effects[0])
    assert grown.effects[-1] == INNER_LOAD
    by_name = dict(zip([p.name for p in old.parameters], fit.theta, strict=True))
    expected = [by_name.get(p.name, 0.0) for p in grown.parameters]
    np.testing.assert_array_equal(transfer_theta(fit, grown), expected)
    assert {"load", "leak", "onset"} <= {p.name for p in grown.parameters}


@pytest.fixture(scope="module")
def limited(levels: FloatArray, two_poles: Response) -> tuple[Data, Fit]:
    """A limited input, and a fit that also lets the gain drift."""
    u = levels[:400]
    y = two_poles(np.minimum(u, 0.8))
    data = data_of(u, y + 0.01 * np.std(y) * np.random.default_rng(4).standard_normal(u.size))
    hypothesis = Hypothesis((input.Saturation("high"), drifts.GainDrift("1")))
    theta = np.array([0.0, (0.8 - data.u_scale.centre) / data.u_scale.unit, 0.02, 0.0, np.log(0.5), np.log(0.05)])
    point = minimize(data, hypothesis, theta, iterations=0)
    assert point is not None
    return data, finish(data, hypothesis, point)


def test_removing_an_effect_keeps_the_other_parameters(limited: tuple[Data, Fit]) -> None:
    data, fit = limited
    fewer = remove_effect(data, fit, 1)
    assert fewer is not None
    assert fewer.hypothesis.keys == ("input-saturation/high",)
    assert data.u_scale.back(fewer.theta[1]) == pytest.approx(0.8, abs=0.01)
    np.testing.assert_allclose(fewer.rates, [0.5, 0.05], rtol=0.1)
    other = remove_effect(data, fit, 0)
    assert other is not None
    assert other.hypothesis.keys == ("parameter-drift/gain-1",)
    for found in (fewer, other):  # no worse than the same numbers as they are
        still = minimize(data, found.hypothesis, transfer_theta(fit, found.hypothesis), iterations=0)
        assert still is not None
        assert found.cost <= still.cost
    assert fewer.cost < 0.01 * other.cost


def test_without_its_roots_a_tank_is_a_linear_plant_again(limited: tuple[Data, Fit]) -> None:
    data, _ = limited
    hypothesis = Hypothesis((input.Saturation("high"), tanks.SqrtOutflow("both")))
    theta = np.zeros(len(hypothesis.parameters))
    theta[1] = (0.8 - data.u_scale.centre) / data.u_scale.unit
    theta[hypothesis.slices["plant"]][:3] = np.log(6.0), np.log(2.0), -8.0
    point = minimize(data, hypothesis, theta, iterations=0)
    assert point is not None
    fewer = remove_effect(data, finish(data, hypothesis, point), 1)
    assert fewer is not None
    assert fewer.hypothesis.plant == Plant()
    assert fewer.cost < 1e-3


def leaking_mass(w: FloatArray, onset: int, held: Response) -> FloatArray:
    """A hardening spring, another spring beside it from the onset on."""

    def spring(x: FloatArray, k: float) -> list[float]:
        more = 0.15 if k >= onset else 0.0
        return [x[1], 0.06 * (w[int(k)] - x[0] * (1.0 + more) - 0.4 * x[0] ** 3) - 0.3 * x[1]]

    return held(np.arange(w.size, dtype=float), np.array([-0.8, 0.0]), spring)[:, 0]


def test_a_load_step_on_a_nonlinear_state_becomes_a_leak_if_that_fits_better(
    levels: FloatArray, held: Response
) -> None:
    u = levels[:400]
    y = leaking_mass(u, 240, held)
    data = data_of(u, y + 0.01 * np.std(y) * np.random.default_rng(2).standard_normal(u.size))
    base = fit_baseline(data)
    highpass = fit_highpass(data, base)
    spring = best_fit(data, trial_fits(data, base, (dynamics.CubicStiffness(),), highpass))
    assert spring is not None
    found = best_fit(data, trial_fits(data, spring, (disturbance.LoadStep(),), highpass))
    assert found is not None
    found = converge(data, found)
    assert found.hypothesis.keys == ("cubic-stiffness", "load-step/inside")
    assert rms(data, found) < 0.0105
    numbers = dict(zip([p.name for p in found.hypothesis.plant.parameters], found.plant_theta, strict=True))
    assert numbers["onset"] * u.size == pytest.approx(240.0, abs=1.5)
    assert numbers["leak"] == pytest.approx(0.15, abs=0.03)


def test_a_constant_load_on_linear_dynamics_stays_constant(levels: FloatArray, two_poles: Response) -> None:
    load = two_poles((np.arange(levels.size) >= 330).astype(float))
    y = two_poles(levels) - 0.4 * load + 0.01 * np.random.default_rng(7).standard_normal(levels.size)
    data = data_of(levels, y)
    base = fit_baseline(data)
    found = best_fit(data, trial_fits(data, base, (disturbance.LoadStep(),), fit_highpass(data, base)))
    assert found is not None
    assert found.hypothesis.keys == ("load-step",)


@pytest.mark.parametrize("side", ["", "-flipped"])
@pytest.mark.parametrize("which", ["both", "upper", "lower"])
@pytest.mark.parametrize("brims", [{}, {"lower": "brim"}, {"upper": "brim"}, {"upper": "brim", "lower": "brim2"}])
def test_roots_are_tried_at_the_other_outflows_at_the_rates_of_before(
    banded: Explanation, which: str, side: str, brims: dict[str, str]
) -> None:
    over = [tanks.Overflow("both" if len(brims) == 2 else brim) for brim in list(brims)[:1]]
    hypothesis = Hypothesis((tanks.SqrtOutflow(which + side), *over))
    numbers = {"log_a": np.log(0.6), "log_b": np.log(0.2), "zero": -3.0, "h1": 0.3, "h2": 0.2}
    numbers |= {"brim": 2.0, "brim2": 2.0, "share": 0.4}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    fit = replace(banded.path[0], hypothesis=hypothesis, theta=theta)
    others = [other for other in alternative_forms(hypothesis) if other.effects[0] != hypothesis.effects[0]]
    assert {other.effects[0].variant for other in others} == {"both" + side, "upper" + side, "lower" + side} - {
        which + side
    }
    for other in others:
        own = transfer_theta(fit, other)[other.slices["plant"]]
        np.testing.assert_allclose(other.plant.linear_rates(own), fit.rates)
        found = dict(zip([p.name for p in other.plant.parameters], own, strict=True))
        assert (found["zero"], found["h1"], found["h2"], found.get("share", 0.4)) == (-3.0, 0.0, 0.0, 0.4)
        for brim, name in brims.items():  # the level of the same flow
            before, now = (brim in one.plant.roots for one in (hypothesis, other))
            assert found[name] == pytest.approx(2.0 ** (1.0 + now - before if before <= now else 0.5))


@pytest.mark.parametrize(("which", "stop"), [("high", 0.4), ("low", -0.3)])
def test_one_stop_of_a_sensor_is_also_tried_as_two(banded: Explanation, which: str, stop: float) -> None:
    """The other limit starts where the output seldom is."""
    hypothesis = Hypothesis((output.Saturation(which), input.Saturation("low")))
    (both,) = alternative_forms(hypothesis)
    assert both.effects == (output.Saturation("both"), input.Saturation("low"))
    assert alternative_forms(both) == []
    numbers = {"log_c": -1.0, "log_k": -3.0}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    theta[hypothesis.slices[f"output-saturation/{which}"]] = stop
    theta[hypothesis.slices["input-saturation/low"]] = -0.7
    fit = replace(banded.path[0], hypothesis=hypothesis, theta=theta)
    found = transfer_theta(fit, both)
    low, high = found[both.slices["output-saturation/both"]]
    assert (high if which == "high" else low) == stop
    beyond = fit.output < low if which == "high" else fit.output > high
    assert 0.02 < beyond.mean() < 0.04
    assert found[both.slices["input-saturation/low"]] == -0.7


@pytest.mark.parametrize(
    ("effects", "expected"),
    [
        ((), ()),
        ((input.DeadZone(), output.Saturation("both")), ()),
        ((output.Nonlinearity(),), (PERIODIC_LOAD,)),
        ((dynamics.CubicStiffness(),), (INNER_PERIODIC,)),
        ((tanks.SqrtOutflow("both"), output.Nonlinearity()), (PERIODIC_LOAD, INNER_PERIODIC, UPSTREAM_PERIODIC)),
        ((dynamics.CoulombFriction("speed"),), (INNER_PERIODIC, UPSTREAM_PERIODIC)),
        ((dynamics.CoulombFriction("speed-lag"),), (INNER_PERIODIC,)),
    ],
)
def test_a_periodic_disturbance_is_tried_at_every_distinct_position(
    effects: tuple[Effect, ...], expected: tuple[Effect, ...]
) -> None:
    found = [other.effects[-1] for other in alternative_forms(Hypothesis((*effects, PERIODIC)))]
    assert [wave for wave in found if wave.name == PERIODIC.name and wave != PERIODIC] == list(expected)
    for other in expected:  # and from each of them back
        found = [form.effects[-1] for form in alternative_forms(Hypothesis((*effects, other)))]
        assert {PERIODIC, *expected} - {other} <= set(found)


@pytest.mark.parametrize(
    ("effect", "in_a_row"),
    [
        (tanks.SqrtOutflow("both"), True),
        (tanks.Overflow("upper"), True),
        (dynamics.CoulombFriction("speed"), True),
        (dynamics.CoulombFriction("speed-lag"), False),
        (dynamics.CoulombFriction("position"), False),
    ],
)
def test_a_load_may_enter_ahead_of_either_of_two_states_in_a_row(effect: Effect, in_a_row: bool) -> None:
    for load, other in ((INNER_LOAD, UPSTREAM_LOAD), (UPSTREAM_LOAD, INNER_LOAD)):
        found = [form.effects[-1] for form in alternative_forms(Hypothesis((effect, load)))]
        assert (other in found) == in_a_row


@pytest.mark.parametrize(
    ("inner", "outer", "name"),
    [
        (INNER_LOAD, LOAD, "onset"),
        (INNER_PERIODIC, PERIODIC, "cycles"),
        (UPSTREAM_PERIODIC, PERIODIC, "cycles"),
        (UPSTREAM_LOAD, LOAD, "onset"),
        (drifts.InnerPoleDrift("1"), drifts.PoleDrift("1"), "drift"),
    ],
)
def test_disturbances_on_states_become_linear_forms_on_linear_dynamics(
    limited: tuple[Data, Fit], inner: Effect, outer: Effect, name: str
) -> None:
    data, _ = limited
    hypothesis = Hypothesis((dynamics.CubicStiffness(), dynamics.CoulombFriction("position"), inner))
    numbers = {
        "log_c": np.log(0.5),
        "log_k": np.log(0.05),
        "onset": 0.4,
        "cycles": 31.0,
        "shake_cos": 0.1,
        "drift": 0.3,
    }
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    data = replace(data, y=hypothesis.output(theta, np.array([2.0, -1.0]), data.u))
    point = minimize(data, hypothesis, theta, iterations=0)
    assert point is not None
    fit = finish(data, hypothesis, point)
    still = remove_effect(data, fit, 1)
    assert still is not None
    assert still.hypothesis.effects == (dynamics.CubicStiffness(), inner)
    linear = remove_effect(data, still, 0)
    assert linear is not None
    assert linear.hypothesis.effects == (outer,)
    (at,) = (i for i, parameter in enumerate(linear.hypothesis.parameters) if parameter.name == name)
    assert linear.theta[at] == pytest.approx(numbers[name], rel=0.2)


def noisy(y: FloatArray, seed: int = 1) -> FloatArray:
    """With one per cent of noise."""
    return y + 0.01 * np.std(y) * np.random.default_rng(seed).standard_normal(y.size)


@searched("input-delay", "input-saturation", "extra-lag", "resonance", "output-drift", "load-step")
@pytest.mark.parametrize("late", [3, 6])
def test_an_input_step_at_sample_0_is_delayed_like_later_steps(
    levels: FloatArray, two_poles: Response, late: int
) -> None:
    """Until the first step arrives the rig is at another level; a numerator zero can mimic half a sample of delay."""
    u = levels[:400]
    y = two_poles(np.concatenate([np.full(late, u[0] + 2.0), u[:-late]]))
    found = explain(data_of(u, noisy(y)), most=1)
    assert found.names == ("input-delay",)
    (key,) = found.best.hypothesis.keys
    assert key.endswith("switched")
    delay, away = found.best.theta[found.best.hypothesis.slices[key]]
    assert delay == pytest.approx(late, abs=0.6)
    assert away * found.data.u_scale.unit == pytest.approx(2.0, abs=0.1)


@searched("input-delay", "input-saturation", "extra-lag", "resonance", "output-drift", "load-step")
def test_a_record_at_steady_state_has_no_input_step_at_sample_0(levels: FloatArray, two_poles: Response) -> None:
    u = levels[:400]
    y = two_poles(np.concatenate([np.full(6, u[0]), u[:-6]]))
    found = explain(data_of(u, noisy(y)), most=1)
    assert found.names == ("input-delay",)
    assert not found.best.hypothesis.keys[0].endswith("switched")


@searched("input-nonlinearity", "output-saturation", "output-nonlinearity", "parameter-drift")
def test_a_tanh_sensor_is_an_output_nonlinearity(levels: FloatArray, two_poles: Response) -> None:
    z = two_poles(levels[:400])
    found = explain(data_of(levels[:400], noisy(np.tanh(1.2 * z / z.std()))), most=1)
    assert found.best.hypothesis.keys == ("output-nonlinearity/rich",)
    assert rms(found.data, found.best) < 0.02


@searched("input-nonlinearity", "output-saturation", "output-nonlinearity", "parameter-drift")
def test_a_cubic_curve_is_not_replaced_by_a_spline(levels: FloatArray, two_poles: Response) -> None:
    z = two_poles(levels[:400])
    z = z / z.std()
    found = explain(data_of(levels[:400], noisy(z + 0.15 * z**2 - 0.03 * z**3)), most=1)
    assert found.best.hypothesis.keys == ("output-nonlinearity",)


def lagged(w: FloatArray) -> FloatArray:
    """Two real lags, from rest."""
    return np.asarray(lfilter([0.0, 0.05, 0.04], [1.0, -1.5, 0.59], w))


def sliding_motor(w: FloatArray, force: Callable[[float], float], static: float) -> FloatArray:
    """Speed of a motor of rate 0.08 with the friction `force` of the speed, by Euler's method in short steps.

    It sticks at rest up to the friction `static`.
    """
    speed, steps = 0.0, 60
    out = np.empty(w.size)
    for k, drive in enumerate(w):
        out[k] = speed
        for _ in range(steps):
            if speed == 0.0 and abs(drive) <= static:
                break
            sign = np.sign(speed) if speed else np.sign(drive)
            new = speed + 0.08 / steps * (drive - speed - sign * force(abs(speed)))
            speed = 0.0 if new * speed < 0.0 and static else new
    return out


def best_with(u: FloatArray, y: FloatArray, group: tuple[Effect, ...]) -> tuple[Data, Fit]:
    """The best form of one effect, with noise of one per cent."""
    y = y + 0.01 * y.std() * np.random.default_rng(4).standard_normal(y.size)
    data = scaled(u, y, np.ones(u.size, bool), 0.1)
    base = fit_baseline(data)
    found = best_fit(data, trial_fits(data, base, group, base))
    assert found is not None
    return data, best_form([converge(data, form) for form in plausible_forms(data, found)])


def values_of(data: Data, fit: Fit) -> dict[str, float]:
    """What the effect reports."""
    reported = fit.hypothesis.effects[0].values(Fitted(fit.hypothesis, fit.theta, fit.gains, data))
    return {name: value.value for name, value in reported.items()}


@pytest.mark.parametrize(
    ("jumps", "ratio", "variant", "expected"),
    [
        ((0.0, 0.0), 1.0, "", {}),
        ((0.2, 0.7), 1.0, "jump", {"jump_low": 0.2, "jump_high": 0.7}),
        ((0.0, 0.0), 0.6, "gain", {"ratio": 0.6}),
    ],
)
def test_a_dead_zone_that_differs_by_direction(
    levels: FloatArray, jumps: tuple[float, float], ratio: float, variant: str, expected: dict[str, float]
) -> None:
    u = 1.3 * levels
    below, above = ratio * (u + 0.5) - jumps[0], u - 0.8 + jumps[1]
    data, fit = best_with(u, lagged(np.where(u > 0.8, above, np.where(u < -0.5, below, 0.0))), (input.DeadZone(),))
    assert fit.hypothesis.effects[0].variant == variant
    found = values_of(data, fit)
    if variant != "jump":  # between two levels of the command, the ends of a band with jumps are arbitrary
        assert (found["low"], found["high"]) == (pytest.approx(-0.5, abs=0.03), pytest.approx(0.8, abs=0.03))
    steps = {name: found[name] for name in expected}
    assert steps == pytest.approx(expected, abs=0.1 if variant == "jump" else 0.03)


def test_an_end_of_a_dead_zone_that_the_record_does_not_reach_mirrors_the_other() -> None:
    """A record of one direction, from rest, says how the rig answers to the other one."""
    u = np.repeat([0.0, 0.5, 1.0, 1.5, 2.0, 1.2, 0.7, 0.3, 1.7], 70)
    y = lagged(np.maximum(u - 0.8, 0.0))
    data, fit = best_with(u, y, (input.DeadZone(),))
    assert values_of(data, fit) == {"high": pytest.approx(0.8, abs=0.02)}
    model = export_model(data, fit)
    np.testing.assert_allclose(model.simulate(-u), -y, atol=0.03 * y.max())
    limit = best_fit(data, trial_fits(data, fit_baseline(data), (input.Saturation("low"),), fit))
    assert limit is None


def test_a_slightly_curved_outflow_is_found_from_a_strongly_curved_one() -> None:
    """The empty tank is ten ranges below the record, which begins far from rest."""
    u = np.repeat(np.random.default_rng(5).uniform(0.0, 2.0, 60), 20)
    level, y = 19.0**2, np.empty(u.size)
    for k in range(u.size):
        y[k] = level
        for _ in range(20):
            level += 0.05 * 2.0 * (u[k] + 20.0 - np.sqrt(level))
    y += 0.002 * y.std() * np.random.default_rng(6).standard_normal(u.size)
    data = scaled(u, y, np.ones(u.size, bool), 0.1)
    base = fit_baseline(data)
    group = tuple(tanks.SqrtOutflow(variant) for variant in tanks.SqrtOutflow.variants)
    fit = best_fit(data, trial_fits(data, base, group, base))
    assert fit is not None
    assert fit.bic < base.bic - 50.0
    assert values_of(data, fit)["zero"] == pytest.approx(-20.0, rel=0.15)


def test_a_dead_zone_with_one_edge_fits_as_a_limit_does() -> None:
    """Of commands that never reach the other edge; a limit that commands beyond the mirrored edge show is none."""
    levels = np.random.default_rng(8).uniform(0.0, 1.0, 90)
    for least, ties in ((0.0, True), (-2.0, False)):
        u = np.repeat(least + (2.5 - least) * levels, 10)
        y = lagged(np.maximum(u, 0.8))
        data, limit = best_with(u, y, (input.Saturation("low"),))
        zone = best_fit(data, trial_fits(data, fit_baseline(data), (input.DeadZone(),), limit))
        assert (zone is not None and abs(zone.bic - limit.bic) < np.log(u.size)) == ties


def test_an_overflow_over_a_weir_is_no_friction() -> None:
    """The level rises a little over the brim: smooth friction on a level that does not turn fits better than a brim."""
    u = np.repeat(np.random.default_rng(4).uniform(-1.0, 2.0, 40), 25)
    level, fine, y = u[0], 20, np.empty(u.size)
    for k in range(u.size):
        y[k] = level
        for _ in range(fine):
            level += 0.06 * (u[k] - level - 15.0 * max(level - 0.7, 0.0) ** 1.5) / fine
    y += 0.01 * y.std() * np.random.default_rng(5).standard_normal(u.size)
    data, fit = best_with(u, y, tuple(tanks.Overflow(variant) for variant in ("lower", "upper")))
    assert fit.hypothesis.effects[0].variant == "weir"
    assert values_of(data, fit)["level"] == pytest.approx(0.7, abs=0.02)
    base = fit_baseline(data)
    frictions = tuple(dynamics.CoulombFriction(place) for place in ("speed", "speed-lag"))
    friction = best_fit(data, trial_fits(data, base, frictions, base))
    assert friction is None or min(one.bic for one in plausible_forms(data, friction)) > fit.bic + 30.0


@pytest.mark.parametrize("down", [1.5, 0.9])
def test_an_actuator_may_be_faster_in_one_direction(down: float) -> None:
    """A valve with a spring closes faster than it opens; with equal rates the plain form is kept."""
    u = np.repeat(np.random.default_rng(7).uniform(0.0, 40.0, 24), 25)
    fine, now, y, level = 20, u[0], np.empty(u.size), 0.0
    for k in range(u.size):
        y[k] = level
        for _ in range(fine):
            now += float(np.clip(u[k] - now, -down / fine, 0.9 / fine))
            level += 0.1 * (now - level) / fine
    data, fit = best_with(u, y, (input.RateLimit(),))
    found = values_of(data, fit)
    assert found["rate"] == pytest.approx(9.0, rel=0.03)
    assert (found["rate_down"] == pytest.approx(15.0, rel=0.03)) if down == 1.5 else ("rate_down" not in found)


def test_a_shaking_that_acts_as_another_law_is_no_oscillation(levels: FloatArray) -> None:
    """Near half the sampling rate, strong, and hardly seen in the output, whose mean it changes."""
    u = 1.5 * levels
    data = scaled(u, u, np.ones(u.size, bool), 0.1)
    friction = Hypothesis((dynamics.CoulombFriction("position"),))
    for cycles, strength, seen in ((0.48 * u.size, 9.0, False), (6.0, 0.5, True)):
        shaken = friction.plus(INNER_PERIODIC)
        theta = np.array([parameter.start for parameter in shaken.parameters])
        own = {"log_c": -0.5, "log_k": -2.5, "friction": 0.5, "cycles": cycles, "shake_cos": strength}
        at = shaken.slices["plant"].start
        for name, value in own.items():
            theta[at + shaken.plant.index(name)] = value
        fitted = Fitted(shaken, theta, np.array([1.0, 0.0]), data)
        assert shaken.effects[-1].is_plausible(fitted) == seen


def test_smooth_friction_reaches_its_level_in_either_direction(levels: FloatArray) -> None:
    """Of a motor that turns, and of one that only creeps back, where the law is any curve through rest."""

    def force(speed: float) -> float:
        return 0.5 * float(np.tanh(speed / 0.3))

    plausible = []
    for middle in (0.0, 1.5):
        u = 1.6 * levels
        data = scaled(u, sliding_motor(u + middle, force, 0.0), np.ones(u.size, bool), 0.1)
        base, smooth = fit_baseline(data), dynamics.CoulombFriction("speed-smooth")
        trial = trial_fits(data, base, (smooth,), base)[0].continued(25)
        plausible.append(smooth.is_plausible(Fitted.of(finish(data, trial.hypothesis, trial.point), data)))
    assert plausible == [True, False]


@pytest.mark.parametrize(
    ("variant", "force", "static"),
    [
        ("speed", lambda speed: 0.5, 0.5),
        ("speed-smooth", lambda speed: 0.5 * float(np.tanh(speed / 0.3)), 0.0),
        ("speed-peak", lambda speed: 0.5 + 0.3 * float(np.exp(-((speed / 0.2) ** 2))), 0.8),
    ],
)
def test_friction_at_small_speeds(
    levels: FloatArray, variant: str, force: Callable[[float], float], static: float
) -> None:
    u = 1.6 * levels + 0.2
    y = sliding_motor(u - 0.2, force, static)
    data, fit = best_with(u, y, (dynamics.CoulombFriction("speed"),))
    assert fit.hypothesis.effects[0].variant == variant
    found = values_of(data, fit)
    assert found["friction"] == pytest.approx(0.5, abs=0.03)
    assert found.get("break_away", 0.8) == pytest.approx(0.8, abs=0.06)
    assert rms(data, fit) < 0.013


@pytest.mark.parametrize("beside", [None, dynamics.CubicStiffness(), tanks.SqrtOutflow("both"), input.DeadZone()])
def test_every_form_that_the_search_can_reach_can_be_exported(beside: Effect | None) -> None:
    host = LINEAR if beside is None else LINEAR.plus(beside)
    for effect in EFFECTS_BY_KEY.values():
        if effect.name in host.names or (isinstance(effect, PlantEffect) and effect.only_given):
            continue
        hypotheses = extended_hypotheses(host, effect)
        for other in [form for one in hypotheses for form in (one, *alternative_forms(one))]:
            assert all(EFFECTS_BY_KEY[form.key] == form for form in other.effects)
            assert set(other.names) == {*host.names, effect.name}


def test_a_richer_form_has_the_plain_one_that_it_makes_richer() -> None:
    richer = LINEAR.plus(dynamics.CoulombFriction("unsprung-peak"))
    (plain,) = plain_forms(richer)
    assert plain.effects == (dynamics.CoulombFriction("unsprung"),)
    assert plain_forms(plain) == []
    assert richer.effects[0] in plain.effects[0].alternatives(plain)
