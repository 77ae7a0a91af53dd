"""The verdict: probabilities, rivals, and `unknown` if the residual is no noise."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.candidates import CANDIDATES
from labsid.gap.decision import (
    Decision,
    closed_on_fit,
    confidence_in,
    decide,
    leading_effect,
    mismatch_probability,
)
from labsid.gap.effects import output
from labsid.gap.explanation import Explanation
from labsid.gap.fitting import Fit, mean_square
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.residual_tests import ResidualMeasures, measure_residual

STRUCTURE = {"repeats": 0.6, "repeats_z": 9.0, "explained": 0.6}


def left_of(explained: Explanation) -> ResidualMeasures:
    """Measures of the residual of the accepted hypothesis."""
    return measure_residual(explained.data, explained.best)


def rivalled(explained: Explanation, *gaps: float) -> Explanation:
    """The BIC of the first rivals exceeds that of the accepted hypothesis by `gaps`; the others are far behind."""
    level, best = {}, explained.best
    others = iter(gaps)
    for names, fit in sorted(explained.levels[1].items()):
        level[names] = fit if fit is best else replace(fit, bic=best.bic + next(others, 1e4))
    return replace(explained, levels=(explained.levels[0], level))


def crowded(explained: Explanation) -> Explanation:
    """Every rival leaves twice the error of the best first effect."""
    level, data = explained.levels[1], explained.data
    first = min(level.values(), key=lambda fit: mean_square(data, fit))
    near = data.y + 2.0 * (first.output - data.y)
    others = {names: fit if fit is first else replace(fit, output=near) for names, fit in level.items()}
    return replace(explained, levels=(explained.levels[0], others, *explained.levels[2:]))


def decided(
    explained: Explanation, left: ResidualMeasures, given: Fit | None, unrepeated: float = 0.0, at_stop: bool = False
) -> Decision:
    """The decision at the confidence that the residual gives."""
    return decide(explained, left, given, confidence_in(explained, left, unrepeated=unrepeated), at_stop)


def check(decision: Decision) -> None:
    """Properties of every decision."""
    assert sum(decision.weights.values()) <= 1.0
    assert all(0.0 <= p <= 1.0 for p in decision.probability.values())
    assert set(decision.names) <= set(decision.probability)
    assert len(decision.ambiguous) <= 3
    assert not set(decision.names) & set(decision.ambiguous)
    assert len(set(decision.ambiguous)) == len(decision.ambiguous)
    assert 0.0 <= decision.closed <= 1.0
    assert (decision.verdict == "effect") == bool(decision.names)


def test_an_effect_far_ahead_is_named_alone(banded: Explanation) -> None:
    decision = decided(rivalled(banded), left_of(banded), None)
    check(decision)
    assert decision.verdict == "effect"
    assert decision.names == ("input-dead-zone",)
    assert decision.ambiguous == ()
    assert decision.probability["input-dead-zone"] == pytest.approx(confidence_in(banded, left_of(banded)))
    assert decision.closed > 0.9


def test_a_rival_of_equal_bic_halves_the_probability_and_is_ambiguous(banded: Explanation) -> None:
    explained = rivalled(banded, 0.0)
    rival = sorted(names for names in explained.levels[1] if names != ("input-dead-zone",))[0][0]
    decision = decided(explained, left_of(banded), None)
    check(decision)
    assert decision.names == ("input-dead-zone",)
    assert decision.ambiguous == (rival,)
    assert decision.probability["input-dead-zone"] == pytest.approx(0.5 * confidence_in(explained, left_of(banded)))


def test_probability_falls_with_the_bic_of_the_nearest_rival(banded: Explanation) -> None:
    sure = []
    for gap in (0.0, 5.0, 15.0, 60.0):
        decision = decided(rivalled(banded, gap), left_of(banded), None)
        check(decision)
        sure.append(decision.probability["input-dead-zone"])
    assert sure == sorted(sure)
    assert sure[-1] > 0.9


def test_at_most_three_rivals_are_reported(banded: Explanation) -> None:
    decision = decided(rivalled(banded, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5), left_of(banded), None)
    check(decision)
    assert len(decision.ambiguous) == 3


def test_noise_alone_is_no_effect(plain: Explanation) -> None:
    decision = decided(plain, left_of(plain), None)
    check(decision)
    assert decision.verdict == "none"
    assert decision.names == decision.ambiguous == ()
    assert decision.closed == pytest.approx(1.0)


def test_an_unexplained_gap_is_unknown(banded: Explanation) -> None:
    """The baseline is accepted although its residual depends on the input."""
    stuck = replace(banded, path=banded.path[:1], levels=banded.levels[:1])
    left = left_of(stuck)
    decision = decided(stuck, left, None)
    check(decision)
    assert decision.verdict == "unknown"
    assert decision.names == ()
    assert confidence_in(stuck, left) < 0.5
    assert closed_on_fit(stuck, left, ()) == decision.closed < 0.5


def test_an_explanation_that_leaves_most_of_the_gap_is_unknown(banded: Explanation) -> None:
    slow = {"colour": 4.0, "slow": 0.8}
    large = replace(
        left_of(banded), rms=0.9 * float(np.std(banded.data.y - banded.path[0].output)), **STRUCTURE, **slow
    )
    decision = decided(rivalled(banded), large, None)
    check(decision)
    assert decision.verdict == "unknown"
    assert decision.ambiguous[0] == "input-dead-zone"
    assert decision.probability["input-dead-zone"] < 0.5


def test_sample_faults_are_named_last(banded: Explanation) -> None:
    decision = decided(replace(rivalled(banded), unsimulated=("output-outliers",)), left_of(banded), None)
    check(decision)
    assert decision.names == ("input-dead-zone", "output-outliers")
    assert decision.probability["output-outliers"] > 0.9


def test_a_parameter_mismatch_requires_a_given_simulation(plain: Explanation) -> None:
    base = plain.path[0]
    off = replace(base, bic=base.bic + 300.0, output=1.3 * base.output)
    decision = decided(plain, left_of(plain), off)
    check(decision)
    assert decision.names == ("parameter-mismatch",)
    assert decision.probability["parameter-mismatch"] > 0.9
    assert decided(plain, left_of(plain), base).verdict == "none"


def test_mismatch_weight_grows_with_the_gain(plain: Explanation) -> None:
    base = plain.path[0]
    weights = [mismatch_probability(replace(base, bic=base.bic + gain), base) for gain in (-5.0, 0.0, 10.0, 100.0)]
    assert weights[:2] == [0.5, 0.5]
    assert weights == sorted(weights)
    assert weights[-1] > 0.99


@pytest.mark.parametrize(
    "worse",
    [
        {"colour": 2.0},
        {"repeats": 0.5, "repeats_z": 8.0},
        {"activity": 0.4, "activity_z": 8.0},
        {"tails": 12.0},
        {"explained": 0.4},
    ],
)
def test_structure_in_the_residual_reduces_confidence(banded: Explanation, worse: dict[str, float]) -> None:
    left = left_of(banded)
    assert 1.0 - confidence_in(banded, replace(left, **worse)) > 1.3 * (1.0 - confidence_in(banded, left))
    converted = replace(banded, unsimulated=("output-quantization",))
    assert confidence_in(converted, replace(left, **worse)) == confidence_in(converted, left)


def test_a_slow_residual_that_repeats_with_the_input_is_not_coloured_noise(banded: Explanation) -> None:
    coloured = replace(rivalled(banded), unsimulated=("coloured-noise",))
    left = left_of(banded)
    assert decided(coloured, left, None).names == ("input-dead-zone", "coloured-noise")
    again = replace(left, repeats=0.2, repeats_z=5.0)
    assert decided(coloured, again, None).names == ("input-dead-zone",)


def test_fast_coloured_noise_does_not_reduce_confidence(plain: Explanation) -> None:
    left = replace(left_of(plain), colour=1.4, slow=0.02)
    assert confidence_in(plain, left) == pytest.approx(confidence_in(plain, replace(left, colour=1.0)), abs=0.01)
    assert confidence_in(plain, replace(left, colour=5.0, slow=0.9)) < 0.5


def test_chance_correlation_of_coloured_noise_does_not_reduce_confidence(banded: Explanation) -> None:
    """The share of strongly coloured noise that the past input predicts is never exactly zero."""
    left = replace(left_of(banded), colour=3.0, slow=0.8, explained=0.0)
    assert confidence_in(banded, replace(left, explained=0.05)) == confidence_in(banded, left) > 0.5
    assert confidence_in(banded, replace(left, explained=0.2)) < 0.5
    again = replace(left, repeats=0.15, repeats_z=5.0)  # with the input in it, that counts
    assert confidence_in(banded, replace(again, explained=0.05)) < 0.5


def test_unrepeated_levels_make_a_drift_unknown(banded: Explanation) -> None:
    left = left_of(banded)
    assert decided(rivalled(banded), left, None, unrepeated=0.05).verdict == "effect"
    decision = decided(crowded(rivalled(banded)), left, None, unrepeated=0.6)
    check(decision)
    assert decision.verdict == "unknown"
    rounded = replace(rivalled(banded), unsimulated=("output-quantization",))
    assert decided(rounded, left, None, unrepeated=0.6).verdict == "effect"


@pytest.mark.parametrize(
    ("name", "named"), [("overflow", True), ("output-saturation", True), ("input-saturation", False)]
)
def test_a_limit_visible_in_the_record_is_named_despite_other_effects(
    banded: Explanation, name: str, named: bool
) -> None:
    fit = banded.best
    effect = next(e for group in CANDIDATES for e in group if e.name == name)
    hypothesis = replace(fit.hypothesis, effects=(*fit.hypothesis.effects, effect))
    both = replace(fit, hypothesis=hypothesis)
    pair = tuple(sorted(("input-dead-zone", name)))
    explained = crowded(replace(banded, path=(*banded.path, both), levels=(*banded.levels[:2], {pair: both})))
    left = replace(left_of(banded), **STRUCTURE)
    unseen = decided(explained, left, None)
    check(unseen)
    assert unseen.verdict == "unknown"
    assert unseen.beside == ()
    seen = decided(explained, left, None, at_stop=True)
    check(seen)
    assert seen.names == ((name,) if named else ())
    assert seen.beside == (("input-dead-zone",) if named else ())
    assert set(seen.ambiguous) >= {"input-dead-zone"}
    sure = decided(explained, left_of(banded), None, at_stop=True)
    assert sure.names == ("input-dead-zone", name)
    assert sure.beside == ()


def test_a_limit_with_a_rival_is_not_named(banded: Explanation) -> None:
    explained = rivalled(banded, 0.0)
    fit = replace(explained.best, hypothesis=Hypothesis((output.Saturation("high"),)))
    rival = next(iter(explained.levels[1].values()))
    level = {("output-saturation",): fit, ("coulomb-friction",): replace(rival, bic=fit.bic)}
    explained = replace(explained, path=(explained.path[0], fit), levels=(explained.levels[0], level))
    decision = decided(explained, replace(left_of(banded), **STRUCTURE), None, at_stop=True)
    assert decision.verdict == "unknown"
    assert {"output-saturation", "coulomb-friction"} <= set(decision.ambiguous)


@pytest.mark.parametrize(("shrinks", "ahead", "named"), [(20.0, 10.0, True), (20.0, 2.0, False), (4.0, 10.0, False)])
def test_a_leading_effect_is_named_despite_other_effects(
    banded: Explanation, shrinks: float, ahead: float, named: bool
) -> None:
    data, best = banded.data, banded.best
    assert best.hypothesis.names == ("input-dead-zone",)
    wave = np.sin(0.1 * np.arange(data.samples)) * np.sqrt(2.0)
    small = 1e-3

    def leaving(fit: Fit, rms: float) -> Fit:
        return replace(fit, output=data.y + rms * wave)

    level = {names: leaving(fit, small if fit is best else ahead * small) for names, fit in banded.levels[1].items()}
    path = (leaving(banded.path[0], shrinks * small), level["input-dead-zone",])
    explained = replace(banded, levels=({(): path[0]}, level), path=path)
    assert leading_effect(explained) == ("input-dead-zone" if named else None)
    left = replace(left_of(banded), rms=small, **STRUCTURE)
    decision = decide(explained, left, None, confidence=0.1)
    check(decision)
    assert decision.verdict == ("effect" if named else "unknown")
    assert decide(explained, replace(left, rms=0.5 * shrinks * small), None, confidence=0.1).verdict == "unknown"
    if named:
        assert decision.names == ("input-dead-zone",)
        assert 0.5 < decision.probability["input-dead-zone"] <= 0.8


def test_no_effect_leads_without_rivals(banded: Explanation) -> None:
    alone = {("input-dead-zone",): banded.best}
    assert leading_effect(replace(banded, levels=(banded.levels[0], alone))) is None
    assert leading_effect(replace(banded, levels=banded.levels[:1])) is None
