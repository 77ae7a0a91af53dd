"""The fit of the probabilities of explanations."""

from typing import Any

import numpy as np
import pytest
import statsmodels.api as sm

from labsid.blind.calibration import complete_observations, fit_weights, partial_observations
from labsid.blind.metrics import CaseOutcome

EVIDENCE = {"colour": 0.1}


def outcome(row: str, labels: list[str], names: list[str], ambiguous: tuple[str, ...] = ()) -> CaseOutcome:
    """A record of a row, and the explanation of the beam search."""
    result = {"verdict": "effect", "ambiguous": list(ambiguous), "explanation": {"names": names, "evidence": EVIDENCE}}
    return CaseOutcome({"row": row, "labels": labels}, result)


@pytest.mark.parametrize(
    ("case", "right"),
    [
        (outcome("single-clear", ["overflow"], ["overflow"]), True),
        (outcome("single-clear", ["overflow"], ["end-stop"]), False),
        (outcome("single-clear", ["overflow"], ["end-stop"], ("overflow",)), True),
        (outcome("pair", ["overflow", "extra-lag"], ["overflow"]), False),
        (outcome("none", [], []), True),
        (outcome("none", [], ["overflow"]), False),
        (outcome("unknown", ["unknown"], ["overflow"]), False),
        (outcome("partial", ["overflow"], ["overflow"]), False),
    ],
)
def test_an_explanation_is_right_if_nothing_else_acts(case: CaseOutcome, right: bool) -> None:
    assert complete_observations([case]) == [(EVIDENCE, right)]


def test_records_without_an_answer_are_no_observations() -> None:
    cases = [CaseOutcome({"row": "none", "labels": []}, result) for result in (None, {"verdict": "error"})]
    assert complete_observations(cases) == partial_observations(cases) == []


def test_each_effect_of_a_partial_explanation_is_an_observation() -> None:
    effects: list[dict[str, Any]] = [{"name": name, "evidence": {"alone": 0.3}} for name in ("overflow", "extra-lag")]
    case = CaseOutcome({"row": "partial", "labels": ["overflow"]}, {"verdict": "partial", "effects": effects})
    assert partial_observations([case]) == [({"alone": 0.3}, True), ({"alone": 0.3}, False)]


def test_weights_are_those_of_statsmodels() -> None:
    rng = np.random.default_rng(5)
    x = rng.normal(size=(4000, 2))
    right = rng.random(4000) < 1.0 / (1.0 + np.exp(-(0.5 + x @ [2.0, -1.0])))
    constant, weights = fit_weights([({"a": a, "b": b}, bool(one)) for (a, b), one in zip(x, right, strict=True)])
    expected = sm.Logit(right.astype(float), sm.add_constant(x)).fit(disp=False).params
    np.testing.assert_allclose([constant, *weights.values()], expected, rtol=0.01)


def test_answers_of_one_kind_cannot_be_fitted() -> None:
    with pytest.raises(ValueError, match=r"got 3 of one kind"):
        fit_weights([({"a": 1.0}, True)] * 3)
