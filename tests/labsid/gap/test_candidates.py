"""The linear fits, and how one effect more is put on top of a fit."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.candidates import (
    CANDIDATES,
    LINEAR,
    baseline,
    carried,
    compatible,
    finished,
    rearranged,
    sketches,
    starts,
    swift_fit,
)
from labsid.gap.context import Context, Data, scaled
from labsid.gap.effects import disturbance, dynamics, input, output
from labsid.gap.effects.base import Effect
from labsid.gap.fitting import Fit, rms
from labsid.gap.hypothesis import Hypothesis, shifted
from labsid.gap.plants import Plant
from labsid.gap.which import Explained, explain

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
    fit = baseline(data_of(levels, y))
    np.testing.assert_allclose(fit.rates, [c, k], rtol=0.25)
    assert rms(data_of(levels, y), fit) < 0.006


def test_the_baseline_fits_the_structure_that_it_is_given(levels: FloatArray, two_poles: Response) -> None:
    y = two_poles(two_poles(levels), 1.0, 0.3)
    data = data_of(levels, y)
    fourth = baseline(data, Hypothesis((dynamics.Resonance(),), known=1))
    assert rms(data, fourth) < 0.3 * rms(data, baseline(data))


def test_swift_fit_is_hardly_pulled_by_a_drift(levels: FloatArray, two_poles: Response) -> None:
    y = two_poles(levels) + 4.0 * np.linspace(-1.0, 1.0, levels.size) ** 2
    data = data_of(levels, y + 0.01 * np.random.default_rng(1).standard_normal(y.size))
    base = baseline(data)
    swift = swift_fit(data, base)
    truth = np.log([0.5, 0.05])
    assert np.abs(np.log(swift.rates) - truth).max() < 0.2
    assert np.abs(np.log(base.rates) - truth).max() > 0.5


def linear_fit(hypothesis: Hypothesis, data: Data) -> Fit:
    """A fit with numbers of its own making, to start from."""
    fit = baseline(data)
    theta = np.zeros(len(hypothesis.parameters))
    return Fit(hypothesis, theta, np.zeros(9), fit.output, fit.cost, fit.noise, fit.bic)


@pytest.mark.parametrize(
    ("effects", "effect", "expected"),
    [
        ((), dynamics.SqrtOutflow("both"), True),
        ((dynamics.SqrtOutflow("both"),), dynamics.Overflow("upper"), True),
        ((dynamics.SqrtOutflow("both"),), dynamics.Overflow("upper-flipped"), False),
        ((dynamics.SqrtOutflow("both-flipped"),), dynamics.Overflow("upper"), True),
        ((dynamics.SqrtOutflow("both"),), dynamics.CoulombFriction("position"), False),
        ((dynamics.CoulombFriction("position"),), dynamics.CubicStiffness(), True),
        ((dynamics.CoulombFriction("speed"),), dynamics.CubicStiffness(), False),
        ((dynamics.SqrtOutflow("both"),), dynamics.ExtraLag(), True),
        ((dynamics.SqrtOutflow("both"),), input.DeadZone(), True),
        ((dynamics.CubicStiffness(),), output.Saturation("low"), True),
    ],
)
def test_only_dynamics_of_one_kind_go_together(
    levels: FloatArray, two_poles: Response, effects: tuple[Effect, ...], effect: Effect, expected: bool
) -> None:
    parent = linear_fit(Hypothesis(effects), data_of(levels, two_poles(levels)))
    assert compatible(parent, effect) is expected


@pytest.mark.parametrize("takes_input", [True, False])
def test_a_given_simulation_takes_no_other_dynamics(levels: FloatArray, two_poles: Response, takes_input: bool) -> None:
    given = Plant(kind="given", run=lambda w: w, takes_input=takes_input)
    parent = linear_fit(Hypothesis(given=given), data_of(levels, two_poles(levels)))
    assert not compatible(parent, dynamics.ExtraLag())
    assert compatible(parent, output.Drift("1"))
    assert compatible(parent, input.DeadZone()) is takes_input


def test_starts_keep_the_numbers_of_the_parent(banded: Explained) -> None:
    data, parent = banded.data, banded.best
    assert parent.hypothesis.keys == ("input-dead-zone",)
    context = Context(data, parent, parent)
    for effect in (output.Saturation("high"), dynamics.ExtraLag()):
        hypothesis = parent.hypothesis.plus(effect)
        thetas = list(starts(context, hypothesis, effect))
        assert len(thetas) >= 3
        assert len({tuple(theta) for theta in thetas}) == len(thetas)
        for theta in thetas:
            place = hypothesis.slices["input-dead-zone"]
            np.testing.assert_array_equal(theta[place], parent.theta[parent.hypothesis.slices["input-dead-zone"]])
            assert theta[0] == parent.theta[0]
        rates = [np.exp(theta[hypothesis.slices["plant"]][:2]) for theta in thetas]
        np.testing.assert_allclose(rates[0], parent.rates)


def test_search_finds_the_effect_and_nothing_where_it_cannot_be_seen(banded: Explained) -> None:
    data, base = banded.data, banded.path[0]
    found = finished(data, sketches(data, base, (input.DeadZone(),), base))
    assert found is not None
    own = found.theta[found.hypothesis.slices["input-dead-zone"]]
    np.testing.assert_allclose(np.asarray(data.u_scale.back(np.sort(own))), [-0.4, 0.3], atol=0.03)
    two = data_of(np.sign(data.u), data.y)
    fit = baseline(two)
    assert sketches(two, fit, (input.DeadZone(),), fit) == []
    assert finished(two, []) is None


@pytest.mark.parametrize("seed", [7, 8, 9])
def test_the_simpler_variant_is_kept_where_it_explains_as_much(
    levels: FloatArray, two_poles: Response, seed: int
) -> None:
    """A load that grows with the state has more numbers, hence always a little less error, than one that does not."""
    load = two_poles((np.arange(levels.size) >= 330).astype(float))
    y = two_poles(levels) - 0.4 * load + 0.01 * np.random.default_rng(seed).standard_normal(levels.size)
    data = data_of(levels, y)
    base = baseline(data)
    group = next(group for group in CANDIDATES if group[0].name == "load-step")
    assert len(group) == 2
    found = finished(data, sketches(data, base, group, swift_fit(data, base)))
    assert found is not None
    assert found.hypothesis.keys == ("load-step",)


def test_candidates_of_a_group_share_their_name() -> None:
    assert len(CANDIDATES) == 18
    for group in CANDIDATES:
        assert len({effect.name for effect in group}) == 1
    assert LINEAR.names == ()


def test_a_lag_and_a_mode_are_tried_at_every_place_to_a_nonlinear_state() -> None:
    linear = Hypothesis((dynamics.ExtraLag(), dynamics.Resonance()))
    assert rearranged(linear) == []
    bent = linear.plus(dynamics.CubicStiffness())
    keys = [other.keys for other in rearranged(bent)]
    assert keys == [
        ("extra-lag/ahead", "resonance", "cubic-stiffness"),
        ("extra-lag", "resonance/ahead", "cubic-stiffness"),
        ("extra-lag", "resonance/beside", "cubic-stiffness"),
    ]
    assert all(other.parameters == bent.parameters and other.names == bent.names for other in rearranged(bent))
    given = Hypothesis(bent.effects, known=1)
    assert all(other.effects[0] == dynamics.ExtraLag() for other in rearranged(given))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_zero_does_not_hide_a_part_of_the_delay(seed: int) -> None:
    """Two levels and coloured noise: with a free zero a second minimum lies most of a sample away."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.choice([-1.0, 1.0], 120), 5)[:500]
    exact = Plant(zero=False)
    y = exact.columns(np.log([0.86, 0.19]), shifted(u, 1.9), u.size)[:, 0]
    data = data_of(u, y + lfilter([0.03], [1.0, -0.85], rng.standard_normal(u.size)))
    base = baseline(data)
    found = finished(data, sketches(data, base, CANDIDATES[0], swift_fit(data, base)))
    assert found is not None
    assert found.hypothesis.keys == ("input-delay/no-zero",)
    assert found.theta[0] == pytest.approx(1.9, abs=0.15)


def test_numbers_are_carried_to_another_form(banded: Explained) -> None:
    base = banded.path[0]
    leak = Hypothesis((input.DeadZone(), disturbance.Leak("leak")))
    theta = np.arange(1.0, len(leak.parameters) + 1.0)
    (plain,) = rearranged(leak)
    assert plain.keys == ("input-dead-zone", "load-step")
    fit = replace(base, hypothesis=leak, theta=theta)
    names = [p.name for p in leak.parameters]
    expected = [theta[names.index(p.name)] for p in plain.parameters]
    np.testing.assert_array_equal(carried(fit, plain), expected)
    assert plain.parameters[-1].name == "onset"


@pytest.mark.parametrize("seed", [1, 4])
def test_a_plain_load_is_not_taken_for_one_that_grows(levels: FloatArray, two_poles: Response, seed: int) -> None:
    load = two_poles((np.arange(levels.size) >= 200).astype(float))
    y = two_poles(levels) - 0.8 * load + 0.01 * np.random.default_rng(seed).standard_normal(levels.size)
    assert explain(data_of(levels, y), most=1).best.hypothesis.keys == ("load-step",)
