"""The linear fits, and fits with one more effect."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import cont2discrete, lfilter

from labsid._arrays import FloatArray
from labsid.gap.dynamics._kernels import delayed
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.effects import disturbance, drifts, dynamics, input, output, periodic, tanks
from labsid.gap.effects.base import Effect
from labsid.gap.effects.context import Context
from labsid.gap.effects.families import CANDIDATES
from labsid.gap.fits.fitting import Fit, Problem, evaluate, finish, minimize, rms
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.linear_fits import LINEAR, fit_baseline, fit_highpass
from labsid.gap.record.data import Data, scaled
from labsid.gap.search.candidates import (
    best_fit,
    is_compatible,
    is_plausible,
    penalized_bic,
    reranked,
    start_points,
    trial_fits,
)
from labsid.gap.search.explanation import Explanation, explain
from labsid.gap.search.forms import extended_hypotheses

INNER_PERIODIC = periodic.InnerPeriodic("inside")
PERIODIC_LOAD = periodic.Periodic("load")
PERIODIC = periodic.Periodic()

Response = Callable[..., FloatArray]


def data_of(u: FloatArray, y: FloatArray) -> Data:
    """Scaled, every row counted."""
    return scaled(u, y, np.ones(u.size, bool), 1.0)


@pytest.mark.parametrize(("c", "k"), [(0.5, 0.05), (0.1, 0.2), (1.5, 0.02), (0.04, 0.0003)])
def test_the_baseline_finds_the_poles_from_anywhere(
    levels: FloatArray, two_poles: Response, c: float, k: float
) -> None:
    y = two_poles(levels, c, k)
    y = y + 0.005 * y.std() * np.random.default_rng(1).standard_normal(y.size)
    fit = fit_baseline(data_of(levels, y))
    np.testing.assert_allclose(fit.rates, [c, k], rtol=0.25)
    assert rms(data_of(levels, y), fit) < 0.006


def test_the_baseline_fits_the_structure_that_it_is_given(levels: FloatArray, two_poles: Response) -> None:
    y = two_poles(two_poles(levels), 1.0, 0.3)
    data = data_of(levels, y)
    fourth = fit_baseline(data, Hypothesis((dynamics.Resonance(),), n_given=1))
    assert rms(data, fourth) < 0.3 * rms(data, fit_baseline(data))


def test_a_drift_hardly_biases_the_highpass_fit(levels: FloatArray, two_poles: Response) -> None:
    y = two_poles(levels) + 4.0 * np.linspace(-1.0, 1.0, levels.size) ** 2
    data = data_of(levels, y + 0.01 * np.random.default_rng(1).standard_normal(y.size))
    base = fit_baseline(data)
    highpass = fit_highpass(data, base)
    truth = np.log([0.5, 0.05])
    assert np.abs(np.log(highpass.rates) - truth).max() < 0.2
    assert np.abs(np.log(base.rates) - truth).max() > 0.5


def linear_fit(hypothesis: Hypothesis, data: Data) -> Fit:
    """A fit with zero parameters as a starting point."""
    fit = fit_baseline(data)
    theta = np.zeros(len(hypothesis.parameters))
    return Fit(hypothesis, theta, np.zeros(9), fit.output, fit.cost, fit.noise, fit.bic)


@pytest.mark.parametrize(
    ("effects", "effect", "expected"),
    [
        ((), tanks.SqrtOutflow("both"), True),
        ((tanks.SqrtOutflow("both"),), tanks.Overflow("upper"), True),
        ((tanks.SqrtOutflow("both"),), tanks.Overflow("upper-flipped"), False),
        ((tanks.SqrtOutflow("both-flipped"),), tanks.Overflow("upper"), True),
        ((tanks.SqrtOutflow("both"),), dynamics.CoulombFriction("position"), False),
        ((dynamics.CoulombFriction("position"),), dynamics.CubicStiffness(), True),
        ((dynamics.CoulombFriction("speed"),), dynamics.CubicStiffness(), False),
        ((tanks.SqrtOutflow("both"),), dynamics.ExtraLag(), True),
        ((tanks.SqrtOutflow("both"),), input.DeadZone(), True),
        ((dynamics.CubicStiffness(),), output.Saturation("low"), True),
    ],
)
def test_only_dynamics_of_one_kind_are_compatible(
    levels: FloatArray, two_poles: Response, effects: tuple[Effect, ...], effect: Effect, expected: bool
) -> None:
    parent = linear_fit(Hypothesis(effects), data_of(levels, two_poles(levels)))
    assert is_compatible(parent, effect) is expected


@pytest.mark.parametrize("takes_input", [True, False])
def test_a_given_simulation_takes_a_lag_at_its_input_and_no_other_dynamics(
    levels: FloatArray, two_poles: Response, takes_input: bool
) -> None:
    given = Plant(kind="given", simulation=GivenSimulation(lambda w, numbers: w, takes_input=takes_input))
    parent = linear_fit(Hypothesis(given=given), data_of(levels, two_poles(levels)))
    assert not is_compatible(parent, dynamics.CoulombFriction("speed"))
    assert is_compatible(parent, dynamics.ExtraLag()) is takes_input
    assert is_compatible(parent, output.Drift("1"))
    assert is_compatible(parent, input.DeadZone()) is takes_input


def test_starts_keep_the_numbers_of_the_parent(banded: Explanation) -> None:
    data, parent = banded.data, banded.best
    assert parent.hypothesis.keys == ("input-dead-zone",)
    context = Context(data, parent, parent)
    for effect in (output.Saturation("high"), dynamics.ExtraLag()):
        hypothesis = parent.hypothesis.plus(effect)
        thetas = list(start_points(context, hypothesis, effect))
        assert len(thetas) >= 3
        assert len({tuple(theta) for theta in thetas}) == len(thetas)
        for theta in thetas:
            place = hypothesis.slices["input-dead-zone"]
            np.testing.assert_array_equal(theta[place], parent.theta[parent.hypothesis.slices["input-dead-zone"]])
            assert theta[0] == parent.theta[0]
        rates = [np.exp(theta[hypothesis.slices["plant"]][:2]) for theta in thetas]
        np.testing.assert_allclose(rates[0], parent.rates)


def test_trial_fits_find_the_effect_and_nothing_in_a_two_level_input(banded: Explanation) -> None:
    data, base = banded.data, banded.path[0]
    found = best_fit(data, trial_fits(data, base, (input.DeadZone(),), base))
    assert found is not None
    own = found.theta[found.hypothesis.slices["input-dead-zone"]]
    np.testing.assert_allclose(np.asarray(data.u_scale.back(np.sort(own))), [-0.4, 0.3], atol=0.03)
    two = data_of(np.sign(data.u), data.y)
    fit = fit_baseline(two)
    assert trial_fits(two, fit, (input.DeadZone(),), fit) == []
    assert best_fit(two, []) is None


@pytest.mark.parametrize("seed", [7, 8, 9])
def test_the_simpler_variant_is_preferred_at_equal_error(levels: FloatArray, two_poles: Response, seed: int) -> None:
    """A leak has more parameters than a constant load and hence always a slightly smaller error."""
    load = two_poles((np.arange(levels.size) >= 330).astype(float))
    y = two_poles(levels) - 0.4 * load + 0.01 * np.random.default_rng(seed).standard_normal(levels.size)
    data = data_of(levels, y)
    base = fit_baseline(data)
    group = next(group for group in CANDIDATES if group[0].name == "load-step")
    assert len(group) == 4
    found = best_fit(data, trial_fits(data, base, group, fit_highpass(data, base)))
    assert found is not None
    assert found.hypothesis.keys == ("load-step",)


def test_candidates_of_a_group_share_their_name() -> None:
    assert len(CANDIDATES) == 31
    for group in CANDIDATES:
        assert len({effect.name for effect in group}) == 1
    assert LINEAR.names == ()


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_numerator_zero_does_not_mimic_a_fractional_delay(seed: int) -> None:
    """Two levels and coloured noise: with a free zero, a second minimum lies almost one sample away."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.choice([-1.0, 1.0], 120), 5)[:500]
    exact = Plant(zero=False)
    y = exact.columns(np.log([0.86, 0.19]), delayed(u, 1, 0.9), u.size)[:, 0]
    data = data_of(u, y + lfilter([0.03], [1.0, -0.85], rng.standard_normal(u.size)))
    base = fit_baseline(data)
    found = best_fit(data, trial_fits(data, base, CANDIDATES[0], fit_highpass(data, base)))
    assert found is not None
    assert found.hypothesis.keys == ("input-delay/no-zero",)
    assert found.theta[0] == pytest.approx(1.9, abs=0.15)


@searched("load-step", "output-drift", "periodic-disturbance", "parameter-drift")
def test_a_constant_load_is_not_identified_as_a_leak(levels: FloatArray, two_poles: Response) -> None:
    load = two_poles((np.arange(levels.size) >= 200).astype(float))
    y = two_poles(levels) - 0.8 * load + 0.01 * np.random.default_rng(4).standard_normal(levels.size)
    assert explain(data_of(levels, y), most=1).best.hypothesis.keys == ("load-step",)


def parent_of(data: Data, hypothesis: Hypothesis, **numbers: float) -> Fit:
    """A fit of a hypothesis with the named parameters; the others are zero."""
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    point = minimize(data, hypothesis, theta, iterations=0)
    assert point is not None
    return finish(data, hypothesis, point)


def rates_of(hypothesis: Hypothesis, thetas: Iterable[FloatArray]) -> list[tuple[float, float]]:
    """The distinct start values of the rates."""
    pairs = [np.exp(theta[hypothesis.slices["plant"]][:2]) for theta in thetas]
    return list(dict.fromkeys((round(float(c), 9), round(float(k), 9)) for c, k in pairs))


@pytest.mark.parametrize(("fast", "found"), [(5.0, [(5.1, 0.5), (0.6, 0.05)]), (1.5, [(1.6, 0.15)])])
def test_a_lost_fast_pole_is_also_started_at_a_slower_rate(
    levels: FloatArray, two_poles: Response, fast: float, found: list[tuple[float, float]]
) -> None:
    parent = parent_of(data_of(levels, two_poles(levels)), LINEAR, log_c=np.log(0.1 + fast), log_k=np.log(0.1 * fast))
    context = Context(data_of(levels, two_poles(levels)), parent, parent)
    for effect in (output.Saturation("high"), dynamics.Resonance()):
        hypothesis = LINEAR.plus(effect)
        rates = rates_of(hypothesis, start_points(context, hypothesis, effect))
        np.testing.assert_allclose(rates, found, rtol=1e-6)


@pytest.mark.parametrize(
    ("k", "swings"), [(1e-4, [(0.1, 0.01), (0.4, 0.16)]), (0.03, [(0.4, 0.16)]), (0.06, [])], ids=str
)
def test_friction_starts_also_at_higher_frequencies(
    levels: FloatArray, two_poles: Response, k: float, swings: list[tuple[float, float]]
) -> None:
    parent = parent_of(data_of(levels, two_poles(levels)), LINEAR, log_c=np.log(0.5), log_k=np.log(k))
    context = Context(data_of(levels, two_poles(levels)), parent, parent)
    for effect, found in ((dynamics.CoulombFriction("position"), swings), (dynamics.CubicStiffness(), [])):
        hypothesis = LINEAR.plus(effect)
        rates = rates_of(hypothesis, start_points(context, hypothesis, effect))
        np.testing.assert_allclose(rates, [(0.5, k), *found], rtol=1e-6)


@pytest.mark.parametrize("variant", ["both", "upper", "lower"])
@pytest.mark.parametrize("brim", ["lower", "upper"])
def test_the_overflow_level_is_converted_for_torricelli_tanks(
    levels: FloatArray, two_poles: Response, brim: str, variant: str
) -> None:
    """At equilibrium the level of a linear tank equals its inflow, that of a Torricelli tank its square."""
    data = data_of(levels, two_poles(levels))
    old = LINEAR.plus(tanks.Overflow(brim))
    parent = parent_of(data, old, log_a=np.log(0.3), log_b=np.log(0.2), brim=0.7, share=0.25)
    effect = tanks.SqrtOutflow(variant)
    hypothesis = old.plus(effect)
    rooted = variant in ("both", brim)
    found = set()
    for theta in start_points(Context(data, parent, parent), hypothesis, effect):
        own = dict(zip([p.name for p in hypothesis.plant.parameters], theta[hypothesis.slices["plant"]], strict=True))
        flow = 0.7 - own["zero"]
        assert own["brim"] == pytest.approx(flow**2 if rooted else flow)
        assert own.get("share", 0.25) == 0.25
        found.add(own["zero"])
    assert len(found) == 2


def test_overflow_levels_of_torricelli_tanks_are_kept(levels: FloatArray, two_poles: Response) -> None:
    data = data_of(levels, two_poles(levels))
    old = LINEAR.plus(tanks.SqrtOutflow("both")).plus(tanks.Overflow("lower"))
    parent = parent_of(data, old, log_a=1.0, log_b=1.0, zero=-3.0, brim=9.5)
    effect = tanks.SqrtOutflow("upper")
    (start, *_) = start_points(Context(data, parent, parent), old.plus(effect), effect)
    assert start[old.plus(effect).slices["plant"]][old.plant.index("brim")] == 9.5


@pytest.mark.parametrize("variant", ["speed", "speed-lag"])
def test_motor_friction_starts_at_several_centres_within_the_input_range(
    levels: FloatArray, two_poles: Response, variant: str
) -> None:
    data = data_of(levels + 3.0, two_poles(levels))
    parent = fit_baseline(data)
    effect = dynamics.CoulombFriction(variant)
    hypothesis = LINEAR.plus(effect)
    centres = {
        float(theta[hypothesis.slices["plant"]][hypothesis.plant.index("centre")])
        for theta in start_points(Context(data, parent, parent), hypothesis, effect)
    }
    share = (np.array(sorted(centres)) - data.u.min()) / np.ptp(data.u)
    assert share.size == 4
    assert np.all((share >= -1e-3) & (share <= 1.001))
    assert ((share > 0.2) & (share < 0.8)).sum() >= 3
    assert np.isclose(share, float((data.u[0] - data.u.min()) / np.ptp(data.u)), atol=1e-3).any()


def test_friction_with_an_off_centre_reversal_is_found(levels: FloatArray) -> None:
    """A servo driven mostly one way: neither the median of the input nor its first value is its rest position."""
    plant = Plant(kind="speed", friction="sharp")
    u = np.concatenate([np.full(8, 1.4), levels[8:400]])
    u = np.where(u < 0.0, 0.4 * u, u)
    numbers = {"log_a": np.log(0.15), "log_b": np.log(0.8), "friction": 0.2, "centre": -0.25}
    y = plant.columns(np.array([numbers.get(p.name, 0.0) for p in plant.parameters]), u, u.size)[:, 0]
    data = data_of(u, y + 0.01 * np.std(y) * np.random.default_rng(3).standard_normal(u.size))
    base = fit_baseline(data)
    found = best_fit(data, trial_fits(data, base, (dynamics.CoulombFriction("speed"),), fit_highpass(data, base)))
    assert found is not None
    own = dict(zip([p.name for p in found.hypothesis.plant.parameters], found.plant_theta, strict=True))
    assert data.u_scale.back(own["centre"]) == pytest.approx(-0.25, abs=0.1)
    assert data.u_scale.unit * own["friction"] == pytest.approx(0.2, abs=0.04)


def test_brief_trials_start_with_the_best_start_of_each_variant(levels: FloatArray, two_poles: Response) -> None:
    """Every start of the upper limit is better than any of the lower one."""
    y = two_poles(levels)
    data = data_of(levels, np.minimum(y, np.quantile(y, 0.7)))
    base = fit_baseline(data)
    group = next(group for group in CANDIDATES if group[0].name == "output-saturation")
    looked = trial_fits(data, base, group, base, brief=True)
    assert {trial.hypothesis.keys[0] for trial in looked} == {effect.key for effect in group}
    assert [trial.score for trial in looked] == sorted(trial.score for trial in looked)
    assert (
        len(trial_fits(data, base, group[1:2], base, brief=True)) == 3
    )  # without another variant, the next best starts


def tank(u: FloatArray, rate: float, held: Response) -> FloatArray:
    """Level of a single tank with Torricelli outflow, from rest."""
    return held(u, np.array([u[0] ** 2]), lambda h, flow: [rate * (flow - np.sqrt(max(h[0], 0.0)))])[:, 0]


@searched("input-nonlinearity", "sqrt-outflow", "overflow", "cubic-stiffness", "slow-mode", "output-nonlinearity")
def test_a_single_torricelli_tank_is_identified(levels: FloatArray, held: Response) -> None:
    """Two tanks, one of them fast; not a spring and a mass."""
    u = 1.7 + levels[:320]
    y = tank(u, 0.1, held)
    data = data_of(u, y + 0.01 * y.std() * np.random.default_rng(1).standard_normal(u.size))
    found = explain(data, most=1)
    assert found.names == ("sqrt-outflow",)
    assert rms(data, found.best) < 0.0115
    others = [fit.bic for names, fit in found.levels[1].items() if names != ("sqrt-outflow",)]
    assert found.best.bic < min(others) - 50.0


def test_tank_starts_include_a_single_dominant_state(levels: FloatArray, two_poles: Response) -> None:
    """One state with time constant c / k (area above the step response), and each single pole unlike it."""
    data = data_of(levels, two_poles(levels))
    parent = parent_of(data, LINEAR, log_c=np.log(0.62), log_k=np.log(0.012))
    effect = tanks.SqrtOutflow("both")
    hypothesis = LINEAR.plus(effect)
    thetas = start_points(Context(data, parent), hypothesis, effect)
    rates = [real_rates(*hypothesis.plant.linear_rates(theta[hypothesis.slices["plant"]])) for theta in thetas]
    single = sorted({round(float(min(pair)), 3) for pair in rates if max(pair) > 5.0})
    np.testing.assert_allclose(single, [0.02, 0.6], rtol=0.15)
    assert any(max(pair) < 1.0 for pair in rates)


def test_reranking_continues_the_first_trials_and_sorts_them_again(banded: Explanation) -> None:
    data, base = banded.data, banded.path[0]
    tried = trial_fits(data, base, (input.DeadZone(), input.Backlash()), base)
    assert len(tried) > 6
    raced = reranked(tried, 6)
    assert len(raced) == 6
    assert [trial.score for trial in raced] == sorted(trial.score for trial in raced)
    assert raced[0].score < min(trial.score for trial in tried)
    assert reranked(tried[:3], 6) == tried[:3]


def test_the_right_effect_is_found_although_its_start_ranks_fourth(banded: Explanation) -> None:
    """The start of the dead zone ranks after three starts of limits and is kept."""
    data, base = banded.data, banded.path[0]
    dead, *_ = trial_fits(data, base, (input.DeadZone(),), base)
    wrong = [trial_fits(data, base, (input.Saturation(side),), base)[0] for side in ("high", "low", "both")]
    found = best_fit(data, [*wrong, dead], kept=3)
    assert found is not None
    assert found.hypothesis.names == ("input-dead-zone",)


@pytest.mark.parametrize(
    ("effect", "moves"),
    [
        (dynamics.CubicStiffness(), True),
        (tanks.SqrtOutflow("both"), True),
        (dynamics.CoulombFriction("speed"), True),
        (dynamics.ExtraLag(), False),
        (input.DeadZone(), False),
    ],
)
def test_a_load_moves_to_the_state_with_a_nonlinear_effect(effect: Effect, moves: bool) -> None:
    plain, inner = disturbance.LoadStep(), disturbance.InnerLoad("inside")
    old = Hypothesis((output.Drift("1"), plain), n_given=1)
    (new,) = extended_hypotheses(old, effect)
    assert new.effects == (output.Drift("1"), inner if moves else plain, effect)
    assert new.n_given == 1
    assert extended_hypotheses(LINEAR, effect) == [LINEAR.plus(effect)]


@pytest.mark.parametrize("wave", [PERIODIC, PERIODIC_LOAD])
def test_a_periodic_disturbance_may_move_to_the_state_with_a_nonlinear_effect(wave: Effect) -> None:
    old = Hypothesis((disturbance.LoadStep(), wave))
    spring = dynamics.CubicStiffness()
    found = [home.effects for home in extended_hypotheses(old, spring)]
    assert found == [(disturbance.InnerLoad("inside"), one, spring) for one in (wave, INNER_PERIODIC)]
    assert [home.effects for home in extended_hypotheses(old, input.DeadZone())] == [(*old.effects, input.DeadZone())]


@pytest.mark.parametrize("effect", [dynamics.CubicStiffness(), tanks.SqrtOutflow("both"), INNER_PERIODIC], ids=str)
def test_a_periodic_disturbance_on_a_state_starts_at_the_linear_amplitude_and_phase(
    levels: FloatArray, two_poles: Response, effect: Effect
) -> None:
    """From a parent with a periodic disturbance or from a periodic residual, at a seventh of the input's range."""
    wave = 0.3 * np.cos(2.0 * np.pi * 23.0 / levels.size * np.arange(levels.size) + 1.0)
    data = data_of(levels, two_poles(levels + wave))
    numbers = {"log_c": np.log(0.5), "log_k": np.log(0.05), "cycles": 23.0}
    parent = parent_of(
        data, Hypothesis((dynamics.CubicStiffness() if effect == INNER_PERIODIC else PERIODIC,)), **numbers
    )
    context = Context(data, parent, parent)
    hypothesis = extended_hypotheses(parent.hypothesis, effect)[-1]
    assert INNER_PERIODIC in hypothesis.effects
    place = hypothesis.slices["plant"].start
    swings = [place + hypothesis.plant.index(name) for name in ("shake_cos", "shake_sin")]
    thetas = list(start_points(context, hypothesis, effect))
    shaken = min(point.cost for point in evaluate(Problem(data, hypothesis), thetas))
    for theta in thetas:
        theta[swings] = 0.0
    still = min(point.cost for point in evaluate(Problem(data, hypothesis), thetas))
    assert shaken < 0.2 * still


@pytest.mark.parametrize("bends", ["1", "4"])
def test_a_pole_drift_moves_to_the_state_with_its_course(levels: FloatArray, two_poles: Response, bends: str) -> None:
    """The course found on linear dynamics is the start value."""
    data = data_of(levels, two_poles(levels))
    drift, inner, brim = drifts.PoleDrift(bends), drifts.InnerPoleDrift(bends), tanks.Overflow("lower")
    parent = parent_of(data, Hypothesis((drift,)), log_c=-0.7, log_k=-3.0, drift=0.3, bend1=-0.1)
    assert is_compatible(parent, brim)
    (hypothesis,) = extended_hypotheses(parent.hypothesis, brim)
    assert hypothesis.effects == (inner, brim)
    names = [p.name for p in hypothesis.plant.parameters]
    for theta in start_points(Context(data, parent, parent), hypothesis, brim):
        own = dict(zip(names, theta[hypothesis.slices["plant"]], strict=True))
        assert own["drift"] == 0.3
        assert own.get("bend1", -0.1) == -0.1
    assert not inner.applies(Context(data, parent))
    assert inner.applies(Context(data, parent_of(data, Hypothesis((brim,)), log_a=-2.0, log_b=-1.0)))


def test_a_load_on_the_state_requires_a_nonlinear_state(levels: FloatArray, two_poles: Response) -> None:
    data = data_of(levels, two_poles(levels))
    inner = disturbance.InnerLoad("inside")
    for effects, expected in (((), False), ((input.DeadZone(),), False), ((dynamics.CubicStiffness(),), True)):
        parent = parent_of(data, Hypothesis(effects), log_c=-0.7, log_k=-3.0)
        assert inner.applies(Context(data, parent)) is expected


def loaded(size: float, drift: float, data: Data) -> Fit:
    """Two poles with a load of so much input from 0.6 of the record on, and a drift of the sensor."""
    hypothesis = Hypothesis((disturbance.LoadStep(), output.Drift("1")))
    numbers = {"log_c": np.log(0.5), "log_k": np.log(0.05), "onset": 0.6}
    theta = np.array([numbers.get(p.name, 0.0) for p in hypothesis.parameters])
    fit = parent_of(data, hypothesis, **numbers)
    gains = np.zeros(fit.gains.size)
    gains[:2] = section_gains(2.0)
    ordered = hypothesis.gains_of(np.arange(gains.size), hypothesis.additive[0]).astype(int)
    gains[ordered] = -size * gains[: ordered.size]
    gains[hypothesis.gains_of(np.arange(gains.size), hypothesis.additive[1]).astype(int)] = drift
    return replace(fit, gains=gains, output=hypothesis.output(theta, gains, data.u))


def section_gains(gain: float) -> FloatArray:
    """Numerator of two poles at c = 0.5 and k = 0.05, the input held."""
    numerator, _, _ = cont2discrete(([gain * 0.05], [1.0, 0.5, 0.05]), 1.0)
    return np.asarray(numerator[0][1:])


@pytest.mark.parametrize(("size", "drift"), [(0.0, 0.0), (0.4, 0.0), (0.9, 0.0), (0.0, 0.7)])
def test_the_gain_of_a_parent_is_that_from_its_input(
    levels: FloatArray, two_poles: Response, size: float, drift: float
) -> None:
    """Loads and drifts of the parent do not count: they change its output without the input."""
    data = data_of(levels, two_poles(levels))
    context = Context(data, loaded(size, drift, data))
    assert context.gain == pytest.approx(2.0, rel=1e-3)
    assert context.response_time == pytest.approx(10.0, abs=0.2)


@pytest.mark.parametrize("size", [0.3, 0.9])
def test_a_load_moved_to_the_state_keeps_its_equivalent_input(
    levels: FloatArray, two_poles: Response, size: float
) -> None:
    data = data_of(levels, two_poles(levels))
    parent = loaded(size, 0.0, data)
    effect = dynamics.CubicStiffness()
    (hypothesis,) = extended_hypotheses(parent.hypothesis, effect)
    names = [p.name for p in hypothesis.plant.parameters]
    for theta in start_points(Context(data, parent), hypothesis, effect):
        own = dict(zip(names, theta[hypothesis.slices["plant"]], strict=True))
        assert own["onset"] == 0.6
        assert own["load"] == pytest.approx(size, rel=1e-3)


def test_plausibility_is_required_of_the_given_number_of_last_effects(levels: FloatArray, two_poles: Response) -> None:
    """A load from the first sample on is implausible; effects of the given simulation are not checked."""
    data = data_of(levels, two_poles(levels))
    numbers = {"log_c": -0.7, "log_k": -3.0, "low": -0.4, "high": 0.3}
    hypothesis = Hypothesis((disturbance.Leak("leak"), input.DeadZone()))
    for onset, expected in ((0.4, True), (0.0, False)):
        fit = parent_of(data, hypothesis, onset=onset, **numbers)
        assert is_plausible(data, fit)
        assert is_plausible(data, fit, 2) is expected


@pytest.mark.parametrize(
    ("simple", "rich"),
    [
        (input.Nonlinearity(), input.Nonlinearity("rich")),
        (output.Nonlinearity(), output.Nonlinearity("rich")),
        (disturbance.LoadStep(), disturbance.Leak("leak")),
    ],
)
def test_a_form_with_more_parameters_pays_a_bic_penalty(banded: Explanation, simple: Effect, rich: Effect) -> None:
    plain = replace(banded.best, hypothesis=Hypothesis((simple,)))
    richer = replace(banded.best, hypothesis=Hypothesis((rich,)))
    assert penalized_bic(plain) == plain.bic
    assert (
        penalized_bic(replace(richer, bic=plain.bic - 5.0))
        > penalized_bic(plain)
        > penalized_bic(replace(richer, bic=plain.bic - 20.0))
    )
