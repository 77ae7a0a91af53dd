"""The row `joints`: what is drawn, and which answers are right."""

from typing import Any

import numpy as np
import pytest

from labsid.blind.joints import KINDS, draw_joint, invents, joint_metrics, names_the_cause
from labsid.blind.metrics import CaseOutcome
from labsid.blind.suite import label_dict, make_cases


@pytest.mark.parametrize("kinds", [KINDS[:4], pytest.param(KINDS, marks=pytest.mark.exhaustive)], ids=len)
def test_every_kind_is_drawn_with_its_effects_and_one_of_them_as_the_cause(kinds: tuple[str, ...]) -> None:
    cases = list(make_cases("dev", len(kinds), ["joints"], 1))
    words = {"friction": "coulomb-friction", "gravity": "gravity", "limit": "force-limit"}
    for kind, case in zip(kinds, cases, strict=True):
        label = label_dict(case)
        assert label["truth"]["kind"] == kind
        assert set(label["labels"]) == {name for word, name in words.items() if word in kind}
        assert label["truth"]["cause"] in (label["labels"] or ["none"])


def test_a_draw_is_repeated_by_its_seed_and_has_a_signal_at_every_sample() -> None:
    one, two = (draw_joint(np.random.default_rng(3), 0, "x") for _ in range(2))
    assert one is not None
    assert two is not None
    assert one.made.files == two.made.files
    table = np.array([line.split(",") for line in one.made.files[".csv"].splitlines()[1:]], float)
    assert np.isfinite(table).all()
    assert np.allclose(np.diff(table[:, 0]), table[1, 0])
    assert np.std(table[:, 1]) > 0.0


def outcome(said: dict[str, float], labels: list[str], cause: str) -> CaseOutcome:
    """The outcome of a record with an answer of these names and probabilities."""
    label: dict[str, Any] = {"row": "joints", "labels": labels, "truth": {"cause": cause}}
    effects = [{"name": name, "probability": p} for name, p in said.items()]
    return CaseOutcome(label, {"verdict": "partial" if said else "none", "effects": effects})


@pytest.mark.parametrize(
    ("said", "right", "wrong"),
    [
        ({"gravity": 0.9}, True, False),
        ({"gravity": 0.9, "coulomb-friction": 0.8}, True, False),
        ({"gravity": 0.9, "resonance": 0.3}, True, False),
        ({"coulomb-friction": 0.9}, False, False),
        ({"gravity": 0.4}, False, False),
        ({"gravity": 0.9, "resonance": 0.7}, False, True),
        ({}, False, False),
    ],
)
def test_the_largest_cause_has_to_be_named_and_nothing_wrong(said: dict[str, float], right: bool, wrong: bool) -> None:
    case = outcome(said, ["gravity", "coulomb-friction"], "gravity")
    assert names_the_cause(case) == right
    assert invents(case) == wrong


def test_nothing_is_named_where_nothing_acts() -> None:
    cases = [outcome({}, [], "none"), outcome({"gravity": 0.6}, [], "none")]
    assert [names_the_cause(case) for case in cases] == [True, False]
    named, invented = joint_metrics(cases)
    assert (named.value, invented.value) == (0.5, 0.5)
