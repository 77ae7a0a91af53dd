"""The verdict: probabilities, rivals, and `unknown` if the residual is no noise."""

from dataclasses import replace

import numpy as np
import pytest

from labsid.gap.fits.fitting import Fit, mean_square
from labsid.gap.fits.residual_tests import ResidualMeasures, measure_residual
from labsid.gap.search.explanation import Explanation
from labsid.gap.verdict.decision import (
    Decision,
    closed_on_fit,
    confidence_in,
    decide,
    decide_partial,
    evidence_by_name,
    evidence_in,
    mismatch_probability,
    partial_probability,
)
from labsid.gap.verdict.held_out_errors import PARTS, Reduction
from labsid.gap.verdict.held_out_search import HeldOutSearch, Step

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


def confidence_after(explained: Explanation, left: ResidualMeasures, unrepeated: float = 0.0) -> float:
    """The probability that the explanation is right if it leaves this residual."""
    return confidence_in(evidence_in(explained, left, unrepeated=unrepeated))


def decided(explained: Explanation, left: ResidualMeasures, given: Fit | None, unrepeated: float = 0.0) -> Decision:
    """The decision at the confidence that the residual gives."""
    return decide(explained, left, given, confidence_after(explained, left, unrepeated))


def check(decision: Decision) -> None:
    """Properties of every decision."""
    assert sum(decision.weights.values()) <= 1.0
    assert all(0.0 <= p <= 1.0 for p in decision.probability.values())
    assert set(decision.names) <= set(decision.probability)
    assert len(decision.ambiguous) <= 3
    assert not set(decision.names) & set(decision.ambiguous)
    assert len(set(decision.ambiguous)) == len(decision.ambiguous)
    assert 0.0 <= decision.closed <= 1.0
    assert (decision.verdict in ("effect", "partial")) == bool(decision.names)


def test_an_effect_far_ahead_is_named_alone(banded: Explanation) -> None:
    decision = decided(rivalled(banded), left_of(banded), None)
    check(decision)
    assert decision.verdict == "effect"
    assert decision.names == ("input-dead-zone",)
    assert decision.ambiguous == ()
    assert decision.probability["input-dead-zone"] == pytest.approx(confidence_after(banded, left_of(banded)))
    assert decision.closed > 0.9


def test_a_rival_of_equal_bic_halves_the_probability_and_is_ambiguous(banded: Explanation) -> None:
    explained = rivalled(banded, 0.0)
    rival = sorted(names for names in explained.levels[1] if names != ("input-dead-zone",))[0][0]
    decision = decided(explained, left_of(banded), None)
    check(decision)
    assert decision.names == ("input-dead-zone",)
    assert decision.ambiguous == (rival,)
    assert decision.probability["input-dead-zone"] == pytest.approx(0.5 * confidence_after(explained, left_of(banded)))


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
    assert confidence_after(stuck, left) < 0.5
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
    assert 1.0 - confidence_after(banded, replace(left, **worse)) > 1.3 * (1.0 - confidence_after(banded, left))
    converted = replace(banded, unsimulated=("output-quantization",))
    assert confidence_after(converted, replace(left, **worse)) == confidence_after(converted, left)


def test_a_residual_that_depends_on_past_inputs_leaves_an_explanation_incomplete(banded: Explanation) -> None:
    banded, left = rivalled(banded), left_of(banded)
    assert left.input_p > 1e-3
    assert confidence_after(banded, replace(left, input_p=1e-3)) == confidence_after(banded, left) > 0.9
    assert decided(banded, replace(left, input_p=1e-6), None).verdict == "unknown"


def test_a_slow_residual_that_repeats_with_the_input_is_not_coloured_noise(banded: Explanation) -> None:
    coloured = replace(rivalled(banded), unsimulated=("coloured-noise",))
    left = left_of(banded)
    assert decided(coloured, left, None).names == ("input-dead-zone", "coloured-noise")
    again = replace(left, repeats=0.2, repeats_z=5.0)
    assert decided(coloured, again, None).names == ("input-dead-zone",)


def test_fast_coloured_noise_does_not_reduce_confidence(plain: Explanation) -> None:
    left = replace(left_of(plain), colour=1.4, slow=0.02)
    assert confidence_after(plain, left) == pytest.approx(confidence_after(plain, replace(left, colour=1.0)), abs=0.01)
    slow = replace(left, colour=5.0, slow=0.9)
    assert confidence_in(evidence_in(plain, slow, predictable=0.3)) < 0.5


def test_slow_noise_that_past_inputs_do_not_foretell_is_no_gap(plain: Explanation) -> None:
    slow = replace(left_of(plain), colour=2.5, slow=0.8)
    assert confidence_in(evidence_in(plain, slow, predictable=0.05)) > 0.7


def test_coloured_noise_beside_an_effect_makes_an_explanation_less_likely(banded: Explanation) -> None:
    """An effect outside the table often leaves an effect of the table and a residual like coloured noise."""
    coloured = replace(banded, unsimulated=("coloured-noise",))
    left = left_of(banded)
    alone, beside = confidence_after(banded, left), confidence_after(coloured, left)
    assert 0.5 < beside < alone
    assert 1.0 - beside > 3.0 * (1.0 - alone)
    again = replace(left, repeats=0.2, repeats_z=5.0)  # no noise, and then not one cause more
    assert confidence_after(coloured, again) == confidence_after(banded, again)


def test_chance_correlation_of_coloured_noise_does_not_reduce_confidence(banded: Explanation) -> None:
    """The share of strongly coloured noise that the past input predicts is never exactly zero."""
    left = replace(left_of(banded), colour=3.0, slow=0.8, explained=0.0)
    assert confidence_after(banded, replace(left, explained=0.05)) == confidence_after(banded, left) > 0.5
    assert confidence_after(banded, replace(left, explained=0.2)) < 0.5
    again = replace(left, repeats=0.15, repeats_z=5.0)  # with the input in it, that counts
    assert confidence_after(banded, replace(again, explained=0.05)) < 0.5


def test_a_residual_that_black_boxes_predict_is_not_coloured_noise(banded: Explanation) -> None:
    coloured, left = replace(banded, unsimulated=("coloured-noise",)), left_of(banded)
    by_share = [confidence_in(evidence_in(coloured, left, predictable=share)) for share in (0.0, 0.1, 0.3, 0.8)]
    assert by_share[0] == by_share[1] > 0.5 > by_share[2] > by_share[3]


def test_unrepeated_levels_make_a_drift_unknown(banded: Explanation) -> None:
    left = left_of(banded)
    assert decided(rivalled(banded), left, None, unrepeated=0.05).verdict == "effect"
    decision = decided(crowded(rivalled(banded)), left, None, unrepeated=0.6)
    check(decision)
    assert decision.verdict == "unknown"
    rounded = replace(rivalled(banded), unsimulated=("output-quantization",))
    assert decided(rounded, left, None, unrepeated=0.6).verdict == "effect"


def chance_of(one: Step, *others: Step) -> float:
    return partial_probability(evidence_by_name(search(one, *others))[one.name])


def search(*steps: Step, mismatch: Reduction | None = None) -> HeldOutSearch:
    return HeldOutSearch(steps, {}, None, mismatch)


def step(
    fit: Fit,
    name: str,
    factor: float = 0.4,
    rivals: dict[str, float] | None = None,
    lead: float = 1.6,
    agreement: int = 1,
) -> Step:
    """An effect that leaves `factor` of the error; in its place, each rival leaves so many times its error."""
    others = tuple((rivals or {}).items())
    return Step(name, fit, np.ones(PARTS), Reduction(factor, 5.0), lead, agreement, others)


@pytest.fixture
def nothing(banded: Explanation) -> Decision:
    """The decision if nothing is named."""
    return decide(banded, left_of(banded), None, confidence=0.2)


def test_without_an_effect_that_pays_the_cause_is_unknown(nothing: Decision) -> None:
    decision = decide_partial(search(), nothing)
    check(decision)
    assert decision.verdict == "unknown"
    assert decision is nothing


def test_the_effects_that_pay_are_named_in_their_order(banded: Explanation, nothing: Decision) -> None:
    steps = (step(banded.best, "coulomb-friction", 0.3), step(banded.best, "resonance", 0.8, {"extra-lag": 1.3}))
    decision = decide_partial(search(*steps), nothing)
    check(decision)
    assert decision.verdict == "partial"
    assert decision.names == ("coulomb-friction", "resonance")
    assert decision.ambiguous == ()
    assert decision.probability == {one.name: chance_of(one, *(set(steps) - {one})) for one in steps}
    assert decision.weights == {("coulomb-friction", "resonance"): min(decision.probability.values())}


def test_rivals_that_reduce_the_error_nearly_as_much_are_ambiguous(banded: Explanation, nothing: Decision) -> None:
    near = {"extra-lag": 1.02, "input-delay": 1.09, "resonance": 1.05, "input-backlash": 1.5}
    steps = (step(banded.best, "coulomb-friction", 0.3, near), step(banded.best, "resonance", 0.7, {"extra-lag": 1.01}))
    decision = decide_partial(search(*steps), nothing)
    check(decision)
    assert decision.ambiguous == ("extra-lag", "input-delay")  # each once, and none that is named
    many = {f"rival-{k}": 1.01 for k in range(5)}
    decision = decide_partial(search(step(banded.best, "coulomb-friction", 0.3, many)), nothing)
    check(decision)
    assert len(decision.ambiguous) == 3


def test_an_effect_is_more_probable_the_farther_its_rivals_are_and_the_more_it_reduces(banded: Explanation) -> None:
    by_rival = [chance_of(step(banded.best, "a", 0.4, {"b": times})) for times in (1.0, 1.1, 1.3, 1.7, 3.0)]
    assert by_rival == sorted(by_rival)
    assert by_rival[-1] == chance_of(step(banded.best, "a", 0.4))  # as without any rival
    by_factor = [chance_of(step(banded.best, "a", factor, {"b": 1.2})) for factor in (0.9, 0.6, 0.3, 0.1)]
    assert by_factor == sorted(by_factor)
    assert all(0.0 < p < 1.0 for p in (*by_rival, *by_factor))
    assert chance_of(step(banded.best, "a", 0.9, {"b": 1.0})) < 0.5
    by_lead = [chance_of(step(banded.best, "a", 0.4, lead=lead)) for lead in (0.1, 0.7, 1.0, 1.4, 3.0)]
    assert by_lead == sorted(by_lead)
    by_agreement = [chance_of(step(banded.best, "a", 0.4, agreement=agreement)) for agreement in (-1, 0, 1)]
    assert by_agreement == sorted(by_agreement)
    nearest = step(banded.best, "a", 0.4, {"b": 1.5, "c": 1.05})
    assert chance_of(nearest) == chance_of(step(banded.best, "a", 0.4, {"c": 1.05}))


def test_other_parameters_of_a_given_simulation_that_pay_are_named_first(
    banded: Explanation, nothing: Decision
) -> None:
    one = step(banded.best, "coulomb-friction", 0.5)
    decision = decide_partial(search(one, mismatch=Reduction(0.2, 9.0)), nothing)
    check(decision)
    assert decision.names == ("parameter-mismatch", "coulomb-friction")
    assert decision.probability["parameter-mismatch"] > 0.5
    assert decision.probability["coulomb-friction"] < chance_of(one)  # one more effect beside it
    alone = decide_partial(search(mismatch=Reduction(0.9, 3.0)), nothing)
    assert alone.verdict == "partial"
    assert 0.0 < alone.probability["parameter-mismatch"] < 0.2
