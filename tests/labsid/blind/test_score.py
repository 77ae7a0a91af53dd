"""Figures from hand-made results and labels."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from statsmodels.stats.proportion import proportion_confint

from labsid.blind.metrics import Figure, Judged, answer_set, exactly_named, inside_set, told_apart, wilson
from labsid.blind.score import calibration_bins, confusion, score
from labsid.blind.table import figure_cells, markdown, print_scores, standing


def label(row: str, *labels: str, **more: Any) -> dict[str, Any]:
    return {"row": row, "labels": list(labels), "Ts": 0.1, "samples": 1000, "truth": {}, **more}


def said(*names: str, p: float = 0.99, ambiguous: tuple[str, ...] = (), **parameters: Any) -> dict[str, Any]:
    values = {name: {"value": value, "stderr": 0.0, "unit": ""} for name, value in parameters.items()}
    effects = [{"name": name, "probability": p, "parameters": values} for name in names]
    return {"verdict": "effect" if names else "none", "effects": effects, "ambiguous": list(ambiguous)}


UNKNOWN = {"verdict": "unknown", "effects": [], "ambiguous": []}


def figure(cases: list[Judged], start: str, **more: Any) -> Figure:
    found = [f for f in score(cases, **more).figures if f.name.startswith(start)]
    assert len(found) == 1
    return found[0]


@pytest.mark.parametrize(("k", "n"), [(0, 10), (97, 100), (200, 200), (1, 3)])
def test_wilson_agrees_with_statsmodels(k: int, n: int) -> None:
    np.testing.assert_allclose(wilson(k, n), proportion_confint(k, n, method="wilson"), atol=1e-12)


def test_nothing_counted_is_no_figure() -> None:
    assert wilson(0, 0) == (0.0, 1.0)
    empty = figure([], "right effect named, one effect, clear")
    assert empty.value is None
    assert standing(empty) == ""


def test_one_effect_must_be_named_and_nothing_else() -> None:
    cases = [
        Judged(label("single-clear", "overflow"), said("overflow")),
        Judged(label("single-clear", "overflow"), said("overflow", "extra-lag")),
        Judged(label("single-clear", "overflow"), said("output-saturation")),
        Judged(label("single-clear", "overflow"), None),
    ]
    found = figure(cases, "right effect named, one effect, clear")
    assert (found.value, found.count) == (0.25, 4)
    assert standing(found) == "missed"
    assert figure(cases, "right effect named, one effect, hard").count == 0


def test_sets_hold_three_names_at_most() -> None:
    case = Judged(label("short", "overflow"), said("input-saturation", ambiguous=("overflow",)))
    assert not exactly_named(case)
    assert inside_set(case)
    assert answer_set(case) == {"overflow", "input-saturation"}
    wide = replace(case, result=said("input-saturation", ambiguous=("overflow", "sqrt-outflow", "extra-lag")))
    assert not inside_set(wide)
    assert figure([case, wide], "short and noisy: names in that set").value == 3.0
    assert figure([case, wide], "short and noisy: inside").value == 0.5


def test_pairs_count_whole_and_half() -> None:
    cases = [
        Judged(label("pair", "overflow", "input-delay"), said("input-delay", "overflow")),
        Judged(label("pair", "overflow", "input-delay"), said("overflow")),
        Judged(label("pair", "overflow", "input-delay"), said("overflow", "extra-lag")),
        Judged(label("pair", "overflow", "input-delay"), UNKNOWN),
    ]
    assert figure(cases, "pair: both").value == 0.25
    assert figure(cases, "pair: at least").value == 0.75


def test_none_and_unknown() -> None:
    cases = [
        Judged(label("none"), said()),
        Judged(label("none"), UNKNOWN),
        Judged(label("unknown", "unknown"), UNKNOWN),
        Judged(label("unknown", "unknown"), said("overflow", p=0.95)),
        Judged(label("unknown", "unknown"), said("overflow", p=0.6)),
        Judged(label("unknown", "unknown"), None),
    ]
    assert figure(cases, "no effect").value == 0.5
    assert figure(cases, "outside the table: unknown").value == 0.25
    assert figure(cases, "outside the table: never").value == 0.5


def test_a_mismatch_is_told_from_none_and_from_structure() -> None:
    mismatch = label("with-sim", "parameter-mismatch")
    assert told_apart(Judged(mismatch, said("parameter-mismatch")))
    assert not told_apart(Judged(mismatch, said("extra-lag")))
    assert not told_apart(Judged(mismatch, said("parameter-mismatch", "extra-lag")))
    assert told_apart(Judged(label("with-sim"), said()))
    assert not told_apart(Judged(label("with-sim"), UNKNOWN))
    structural = label("with-sim", "extra-lag")
    assert told_apart(Judged(structural, said("extra-lag")))
    assert not told_apart(Judged(structural, said("overflow")))
    assert not told_apart(Judged(structural, said("parameter-mismatch")))


def test_closure_is_held_against_the_true_structure() -> None:
    cases = [
        Judged(label("single-clear", "overflow"), said("overflow"), diagnosed=d, possible=p)
        for d, p in [(0.9, 1.0), (0.8, 0.8), (-0.5, 0.9), (0.0, 0.1), (0.95, 0.95)]
    ]
    found = figure(cases, "median share of the gap closed")
    assert found.count == 4  # where the truth itself closes nothing there is nothing to hold it against
    assert found.value == pytest.approx(0.95)
    assert figure(cases, "  that of the true structure").value == pytest.approx(0.925)


def test_intervals_must_neither_miss_nor_always_hit() -> None:
    result = {**said("overflow"), "gap": {"ci95": [0.8, 0.9]}}
    inside = Judged(label("single-clear", "overflow"), result, fresh=0.85)
    outside = replace(inside, fresh=0.95)
    found = figure([], "95 % interval", replays=[inside] * 19 + [outside])
    assert found.value == pytest.approx(0.95)
    assert standing(found) == "aim"
    assert standing(figure([], "95 % interval", replays=[inside] * 20)) == "missed"
    assert figure([], "95 % interval", replays=[replace(inside, fresh=None)]).count == 0


def test_calibration_by_hand() -> None:
    right = Judged(label("single-clear", "overflow"), said("overflow", p=0.95))
    wrong = Judged(label("single-clear", "extra-lag"), said("overflow", p=0.95))
    unsure = Judged(label("none"), said("overflow", p=0.25))
    cases = [right] * 3 + [wrong] + [unsure] * 4
    assert calibration_bins(cases) == ((0.25, 0.0, 4), (pytest.approx(0.95), 0.75, 4))
    assert figure(cases, "probability calibration").value == pytest.approx(0.5 * 0.25 + 0.5 * 0.2)


def test_certainty_falls_into_the_last_bin() -> None:
    assert calibration_bins([Judged(label("none"), said("overflow", p=1.0))]) == ((1.0, 0.0, 1),)


def test_onsets_within_two_percent_of_the_record() -> None:
    truth = {"load-step": {"onset": 40.0, "size": 1.0}}
    cases = [
        Judged(label("single-clear", "load-step", truth=truth), said("load-step", onset=onset))
        for onset in (41.9, 38.1, 42.1)
    ]
    cases.append(Judged(label("single-clear", "load-step", truth=truth), said("output-drift")))
    found = figure(cases, "load-step onset")
    assert (found.value, found.count) == (pytest.approx(2 / 3), 3)


def test_clip_levels_within_two_percent_of_the_range() -> None:
    truth = {"output-saturation": {"low": 1.0, "high": 4.0}}
    there = label("single-hard", "output-saturation", truth=truth, y_range=10.0)
    cases = [Judged(there, said("output-saturation", low=1.1, high=4.3))]
    found = figure(cases, "clip levels")
    assert (found.value, found.count) == (0.5, 2)
    missing = [Judged(there, said("output-saturation", high=4.1))]
    assert figure(missing, "clip levels").value == 0.5


def test_the_confusion_counts_every_answer() -> None:
    cases = [
        Judged(label("pair", "b", "a"), said("a", "b")),
        Judged(label("pair", "a", "b"), said("b")),
        Judged(label("none"), None),
    ]
    assert confusion(cases) == {"pair": {"a+b": {"a+b": 1, "b": 1}}, "none": {"none": {"error": 1}}}


def test_time_is_better_below() -> None:
    assert standing(figure([], "time a record", seconds=1.9)) == "aim"
    assert standing(figure([], "time a record", seconds=4.0)) == "must"
    assert standing(figure([], "time a record", seconds=5.1)) == "missed"


def test_the_table_reads_well(capsys) -> None:
    cases = [Judged(label("single-clear", "overflow"), said("overflow"))] * 3
    cases.append(Judged(label("single-clear", "overflow"), said("extra-lag")))
    scores = score(cases, seconds=1.0)
    assert figure_cells(scores.figures[0]) == (
        "right effect named, one effect, clear",
        "75.0 %",
        "30.1-95.4 %",
        "4",
        "97 %",
        "99.5 %",
        "missed",
    )
    text = markdown(scores)
    assert "| right effect named, one effect, clear | 75.0 % | 30.1-95.4 % | 4 | 97 % | 99.5 % | missed |" in text
    assert "| single-clear | overflow | overflow 3, extra-lag 1 |" in text
    assert "| time a record and core | 1.00 s |" in text
    print_scores(scores, "a title")
    printed = capsys.readouterr().out
    assert "a title" in printed
    assert "extra-lag 1" in printed


@pytest.mark.parametrize(
    ("right", "of", "must", "fails"),
    [
        (97, 100, 0.97, False),
        (95, 100, 0.97, False),
        (80, 100, 0.97, True),
        (8, 9, 0.97, False),
        (0, 3, 0.97, True),
        (100, 100, (0.92, 0.98), False),
        (1000, 1000, (0.92, 0.98), True),
        (50, 100, (0.92, 0.98), True),
        (0, 0, 0.97, False),
    ],
)
def test_a_bar_is_failed_only_by_more_than_chance(right: int, of: int, must: Any, fails: bool) -> None:
    low, high = wilson(right, of)
    assert Figure("rate", right / of if of else None, of, low, high, must).fails() is fails


def test_a_figure_without_an_interval_fails_nothing_and_one_that_must_be_small_by_its_lower_end() -> None:
    assert not Figure("time", 9.0, 50, must=5.0, below=True).fails()
    assert Figure("error", 0.3, 50, low=0.2, high=0.4, must=0.1, below=True).fails()
    assert not Figure("error", 0.15, 50, low=0.05, high=0.25, must=0.1, below=True).fails()
