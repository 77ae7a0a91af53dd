"""The row `several`: what is drawn, and how its answers are counted."""

from typing import Any

import pytest

from labsid.blind.metrics import CaseOutcome
from labsid.blind.several import names_only_true, several_metrics
from labsid.blind.suite import make_cases
from labsid.rig.switchable.unlisted import UNLISTED_EFFECTS


def test_two_and_three_effects_are_drawn_beside_one_outside_the_table() -> None:
    cases = list(make_cases("dev", 4, ["several"], 1))
    assert [len(set(case.labels)) for case in cases] == [2, 3, 2, 3]
    assert all(case.truth["kind"] in UNLISTED_EFFECTS for case in cases)
    assert [case.holdout is not None for case in cases[:2]] == [False, False]
    assert all(case.ratio > 3.0 for case in cases)


def outcome(said: dict[str, float], labels: tuple[str, ...]) -> CaseOutcome:
    """The outcome of a record with an answer of these names and probabilities."""
    label: dict[str, Any] = {"row": "several", "labels": list(labels)}
    effects = [{"name": name, "probability": p} for name, p in said.items()]
    return CaseOutcome(label, {"verdict": "partial", "effects": effects})


@pytest.mark.parametrize(
    ("said", "right"),
    [
        ({"overflow": 0.9, "resonance": 0.6}, True),
        ({"overflow": 0.9, "extra-lag": 0.4}, True),
        ({"overflow": 0.9, "extra-lag": 0.6}, False),
        ({}, True),
    ],
)
def test_every_name_above_one_half_has_to_be_an_effect_of_the_rig(said: dict[str, float], right: bool) -> None:
    assert names_only_true(outcome(said, ("overflow", "resonance"))) == right


def test_without_a_result_nothing_is_right() -> None:
    assert not names_only_true(CaseOutcome({"row": "several", "labels": ["overflow"]}, None))


def test_the_share_of_the_effects_and_the_calibration_of_each_place_are_counted() -> None:
    cases = [
        outcome({"overflow": 0.9, "resonance": 0.6}, ("overflow", "resonance")),
        outcome({"overflow": 0.9, "extra-lag": 0.1}, ("overflow", "resonance")),
    ]
    right, share, first, second, third = several_metrics(cases, [])
    assert right.value == 1.0
    assert (share.value, share.count) == (0.75, 4)
    assert first.value == pytest.approx(0.1)
    assert second.value == pytest.approx(0.25)  # 0.6 is right and 0.1 is wrong, each in a bin of its own
    assert third.value is None
