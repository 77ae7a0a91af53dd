"""Answers on records of several signals and of closed loops: right names, right signals, right outputs."""

import json
from pathlib import Path
from typing import Any

import pytest

from labsid.blind.metrics import CaseOutcome
from labsid.blind.placed_effects import (
    names_effect,
    names_effect_and_signal,
    names_outputs,
    signal_metrics,
    wrong_claims,
)
from labsid.blind.right_answers import is_right
from labsid.blind.runner import run_batch
from labsid.blind.score import score_cases
from labsid.blind.suite import label_dict
from labsid.blind.wrong_answers import answer_text, true_text

LAG = {"name": "extra-lag", "signal": None, "signals": [None, "u1"], "outputs": ["y1", "y2"], "visible": ["y1"]}
LIMIT = {"name": "input-saturation", "signal": "u2", "signals": ["u2"], "outputs": ["y1", "y2"], "visible": ["y2"]}


def said(name: str, signal: str | None, p: float = 0.95, outputs: tuple[str, ...] = ("y1", "y2")) -> dict[str, Any]:
    return {"name": name, "signal": signal, "probability": p, "outputs": list(outputs)}


def outcome(
    true: list[dict[str, Any]], *effects: dict[str, Any], verdict: str = "effect", row: str = "signals", **gap: Any
) -> CaseOutcome:
    label = {"row": row, "labels": [one["name"] for one in true], "truth": {"effects": true, "mode": "stabilised"}}
    return CaseOutcome(label, {"verdict": verdict, "effects": list(effects), "gap": gap, "ambiguous": []})


@pytest.mark.parametrize(
    ("true", "effects", "name", "signal"),
    [
        ([LIMIT], [said("input-saturation", "u2")], True, True),
        ([LIMIT], [said("input-saturation", "u1")], True, False),
        ([LIMIT], [said("input-saturation", None)], True, False),
        ([LIMIT], [said("input-dead-zone", "u2")], False, False),
        ([LIMIT], [said("input-saturation", "u2"), said("extra-lag", None)], False, False),
        ([LIMIT], [said("input-saturation", "u2"), said("input-saturation", "u1")], False, False),
        ([LAG], [said("extra-lag", None)], True, True),
        ([LAG], [said("extra-lag", "u1")], True, True),
        ([LAG], [said("extra-lag", "u2")], True, False),
    ],
)
def test_the_name_and_the_signal_have_to_be_right(
    true: list[dict[str, Any]], effects: list[dict[str, Any]], name: bool, signal: bool
) -> None:
    case = outcome(true, *effects)
    assert names_effect(case) == name
    assert names_effect_and_signal(case) == signal == is_right(case)


@pytest.mark.parametrize(("verdict", "right"), [("none", True), ("unknown", False), ("error", False)])
def test_without_an_effect_only_none_is_right(verdict: str, right: bool) -> None:
    case = outcome([], verdict=verdict, row="signals-none")
    assert names_effect(case) == names_effect_and_signal(case) == is_right(case) == right
    assert not is_right(CaseOutcome(case.label, None))
    assert not is_right(outcome([LIMIT], verdict="none"))


def test_a_wrong_name_and_a_wrong_signal_count_above_a_probability() -> None:
    case = outcome([LIMIT], said("input-saturation", "u1", 0.7), said("resonance", None, 0.95))
    assert [one["name"] for one in wrong_claims(case, 0.5)] == ["input-saturation", "resonance"]
    assert [one["name"] for one in wrong_claims(case, 0.9)] == ["resonance"]
    assert [one["name"] for one in wrong_claims(case, 0.5, with_signal=False)] == ["resonance"]
    assert wrong_claims(CaseOutcome(case.label, None), 0.5) == []


@pytest.mark.parametrize(("outputs", "right"), [(("y2",), True), (("y1", "y2"), True), (("y1",), False), ((), False)])
def test_the_outputs_are_those_that_change_visibly_and_none_that_cannot(outputs: tuple[str, ...], right: bool) -> None:
    assert names_outputs(outcome([LIMIT], said("input-saturation", "u2", outputs=outputs))) == right
    assert not names_outputs(outcome([LIMIT], said("input-saturation", "u2", outputs=("y2", "y3"))))


def test_the_metrics_of_the_four_rows() -> None:
    clear = [outcome([LIMIT], said("input-saturation", "u2")), outcome([LIMIT], said("input-saturation", "u1", 0.6))]
    hard = [outcome([LAG], said("resonance", None, 0.95))]
    none = [outcome([], verdict="none"), outcome([], verdict="unknown")]
    loop = [
        outcome([LAG], said("extra-lag", "u2"), row="loop", mode="stabilised"),
        outcome([LAG], said("resonance", None, 0.6), row="loop", mode="free"),
    ]
    values = {metric.name.strip(): metric.value for metric in signal_metrics(clear, hard, none, loop)}
    assert values == {
        "several signals: name and signal right, clear": 0.5,
        "several signals: name and signal right, hard": 0.0,
        "several signals, no effect: none reported": 0.5,
        "several signals: name right at whatever signal, clear and hard": pytest.approx(2 / 3),
        "several signals: outputs of the effects that are named rightly": 1.0,
        "several signals: a wrong name or signal above 0.5": 0.4,
        "several signals: a wrong name or signal above 0.9": 0.2,
        "closed loop: right effect named, or none": 0.5,
        "closed loop: free or stabilised as the rig needs it": 0.5,
        "closed loop: a wrong name above 0.5": 0.5,
        "closed loop: a wrong name above 0.9": 0.0,
    }


def test_the_scorer_reads_kept_reports(dev_cases, tmp_path: Path) -> None:
    """Reports as a diagnosis of several signals writes them, one right, one at the wrong signal, and one of a loop."""
    cases = [case for case in dev_cases("signals", 4) if case.options][:2] + dev_cases("loop", 1)
    labels = [label_dict(case) for case in cases]
    for number, (case, label) in enumerate(zip(cases, labels, strict=True)):
        (true,) = label["truth"]["effects"]
        wrong = number == 1
        effect = said(true["name"], "elsewhere" if wrong else true["signal"], 0.97, tuple(true["outputs"]))
        report = {
            "verdict": "effect",
            "effects": [effect],
            "ambiguous": [],
            "gap": {"mode": "stabilised", "closed": 1.0},
        }
        (tmp_path / f"{case.name}.json").write_text(json.dumps(report), encoding="utf-8")
    results, _ = run_batch(cases, 1, keep=tmp_path)
    outcomes = [CaseOutcome(label, results[case.name]) for case, label in zip(cases, labels, strict=True)]
    assert [is_right(one) for one in outcomes] == [True, False, True]
    scores = score_cases(outcomes)
    values = {metric.name.strip(): metric.value for metric in scores.metrics}
    assert values["several signals: name and signal right, clear"] == 0.5
    assert values["several signals: a wrong name or signal above 0.9"] == 0.5
    assert values["closed loop: right effect named, or none"] == 1.0
    assert scores.calibration == ()


def test_a_wrong_answer_is_told_with_its_signals() -> None:
    case = outcome([LIMIT], said("input-saturation", "u1", 0.7), said("resonance", None, 0.2))
    assert case.result is not None
    case.result["ambiguous"] = [{"name": "input-dead-zone", "signal": "u2"}, "overflow"]
    assert true_text(case.label) == "input-saturation at u2"
    assert answer_text(case) == ("effect input-saturation at u1 0.70 resonance 0.20 or input-dead-zone at u2, overflow")
    assert true_text(outcome([]).label) == "none"
