"""Metrics from hand-made results and labels."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from statsmodels.stats.proportion import proportion_confint

from labsid.blind.metrics import (
    CaseOutcome,
    Metric,
    all_named,
    answer_set,
    kind_recognised,
    never_confidently_wrong,
    nothing_asserted,
    path_recognised,
    right_part_named,
    wilson,
    within_answer_set,
)
from labsid.blind.score import ALONE, calibration_bins, confusion, score_cases
from labsid.blind.table import markdown, metric_cells, metric_status, print_scores
from labsid.rig.switchable.unlisted import UNLISTED_EFFECTS, UNLISTED_PATHS


def label(row: str, *labels: str, **more: Any) -> dict[str, Any]:
    return {"row": row, "labels": list(labels), "Ts": 0.1, "samples": 1000, "truth": {}, **more}


def said(*names: str, p: float = 0.99, ambiguous: tuple[str, ...] = (), **parameters: Any) -> dict[str, Any]:
    values = {name: {"value": value, "stderr": 0.0, "unit": ""} for name, value in parameters.items()}
    effects = [{"name": name, "probability": p, "parameters": values} for name in names]
    return {"verdict": "effect" if names else "none", "effects": effects, "ambiguous": list(ambiguous)}


UNKNOWN = {"verdict": "unknown", "effects": [], "ambiguous": []}


def metric(cases: list[CaseOutcome], start: str, **more: Any) -> Metric:
    found = [f for f in score_cases(cases, **more).metrics if f.name.startswith(start)]
    assert len(found) == 1
    return found[0]


def partly(*names: str, p: float = 0.99, path: str | None = None) -> dict[str, Any]:
    """A partial explanation, and the path of the rest; without names, an unknown cause."""
    return said(*names, p=p) | {"verdict": "partial" if names else "unknown", "unexplained": {"path": path}}


def test_three_runs_are_compared_with_the_first_of_them() -> None:
    """Three runs name it 3 times of 4, one alone twice, of which once where the three do not."""
    right, wrong = said("overflow"), said("end-stop")
    cases = [CaseOutcome(label("runs", "overflow"), result) for result in (right, right, right, wrong)]
    cases += [CaseOutcome(label(ALONE, "overflow"), result) for result in (wrong, right, wrong, right)]
    assert metric(cases, "three short, noisy runs").value == 0.75
    assert metric(cases, "the first of them alone").value == 0.5
    gain = metric(cases, "three runs of one rig more often")
    assert (gain.value, gain.count, metric_status(gain)) == (0.25, 4, "target")
    differences = np.array([1.0, 0.0, 1.0, -1.0])
    assert gain.high == pytest.approx(0.25 + 1.96 * differences.std() / 2.0, abs=1e-4)
    assert metric([], "three runs of one rig more often").value is None


@pytest.mark.parametrize(
    ("result", "right"),
    [
        (UNKNOWN, True),
        (partly("overflow", p=0.5), True),
        (partly("overflow", p=0.51), False),
        (partly("overflow", "resonance", p=0.2), True),
        (said("overflow", p=0.4), False),  # an effect is asserted to be the whole explanation
        (said(), False),
        (None, False),
    ],
)
def test_outside_the_table_nothing_is_asserted(result: dict[str, Any] | None, right: bool) -> None:
    case = CaseOutcome(label("unknown", truth={"kind": "relay-hysteresis"}), result)
    assert nothing_asserted(case) is right
    assert metric([case], "outside the table: unknown, or partial").value == float(right)


@pytest.mark.parametrize(
    ("kind", "path", "right"),
    [
        ("relay-hysteresis", "input", True),
        ("relay-hysteresis", "dynamics", False),
        ("slow-falling-sensor", "output", True),
        ("slow-falling-sensor", "dynamics", True),
        ("swinging-delay", "time", True),
        ("swinging-delay", None, False),
    ],
)
def test_the_path_of_the_rest_is_that_of_the_effect_outside_the_table(kind: str, path: str | None, right: bool) -> None:
    case = CaseOutcome(label("unknown", truth={"kind": kind}), partly(path=path))
    assert path_recognised(case) is right
    assert metric([case], "outside the table: path").value == float(right)
    assert not path_recognised(CaseOutcome(label("unknown", truth={"kind": kind}), None))


def test_every_effect_outside_the_table_has_a_path() -> None:
    assert set(UNLISTED_PATHS) == set(UNLISTED_EFFECTS)
    paths = {path for paths in UNLISTED_PATHS.values() for path in paths}
    assert paths <= {"input", "dynamics", "output", "time", "disturbance"}


@pytest.mark.parametrize(
    ("result", "right"),
    [
        (partly("overflow"), True),
        (said("overflow"), True),
        (partly("overflow", p=0.5), False),
        (partly("overflow", "resonance"), False),
        (partly("resonance"), False),
        (UNKNOWN, False),
        (None, False),
    ],
)
def test_the_listed_effect_alone_is_named_beside_one_outside_the_table(
    result: dict[str, Any] | None, right: bool
) -> None:
    case = CaseOutcome(label("partial", "overflow", truth={"kind": "second-valve"}), result)
    assert right_part_named(case) is right
    assert metric([case], "beside an effect outside the table").value == float(right)


def test_a_doubtful_second_name_does_not_spoil_the_right_part() -> None:
    result = partly("overflow", "resonance")
    result["effects"][1]["probability"] = 0.3
    assert right_part_named(CaseOutcome(label("partial", "overflow", truth={"kind": "second-valve"}), result))


def test_names_of_a_partial_explanation_count_as_stated() -> None:
    case = CaseOutcome(label("single-clear", "overflow"), partly("overflow"))
    assert all_named(case)
    assert metric([case], "right effect named, one effect, clear").value == 1.0
    assert not never_confidently_wrong(CaseOutcome(label("unknown"), partly("overflow", p=0.95)))
    assert calibration_bins([case])[-1][2] == 1


@pytest.mark.parametrize(("k", "n"), [(0, 10), (97, 100), (200, 200), (1, 3)])
def test_wilson_agrees_with_statsmodels(k: int, n: int) -> None:
    np.testing.assert_allclose(wilson(k, n), proportion_confint(k, n, method="wilson"), atol=1e-12)


def test_an_empty_row_has_no_score() -> None:
    assert wilson(0, 0) == (0.0, 1.0)
    empty = metric([], "right effect named, one effect, clear")
    assert empty.value is None
    assert metric_status(empty) == ""


def test_a_single_effect_scores_only_if_named_alone() -> None:
    cases = [
        CaseOutcome(label("single-clear", "overflow"), said("overflow")),
        CaseOutcome(label("single-clear", "overflow"), said("overflow", "extra-lag")),
        CaseOutcome(label("single-clear", "overflow"), said("output-saturation")),
        CaseOutcome(label("single-clear", "overflow"), None),
    ]
    found = metric(cases, "right effect named, one effect, clear")
    assert (found.value, found.count) == (0.25, 4)
    assert metric_status(found) == "missed"
    assert metric(cases, "right effect named, one effect, hard").count == 0


def test_the_families_have_their_own_rate_and_closure() -> None:
    cases = [CaseOutcome(label("families", "end-stop"), said("end-stop"), diagnosed=0.9, possible=0.95)] * 3
    cases.append(CaseOutcome(label("families", "slow-mode"), said("extra-lag"), diagnosed=0.5, possible=1.0))
    assert metric(cases, "end stop, drag, slow mode, play at the output: named").value == 0.75
    assert metric(cases, "end stop, drag, slow mode, play: the same share").value == pytest.approx(0.9 / 0.95)
    assert metric(cases, "right effect named, one effect, clear").count == 0
    assert metric(cases, "  share closed by the diagnosis").count == 0


def test_sets_hold_three_names_at_most() -> None:
    case = CaseOutcome(label("short", "overflow"), said("input-saturation", ambiguous=("overflow",)))
    assert not all_named(case)
    assert within_answer_set(case)
    assert answer_set(case) == {"overflow", "input-saturation"}
    wide = replace(case, result=said("input-saturation", ambiguous=("overflow", "sqrt-outflow", "extra-lag")))
    assert not within_answer_set(wide)
    assert metric([case, wide], "short and noisy: names in that set").value == 3.0
    assert metric([case, wide], "short and noisy: within").value == 0.5


def test_pairs_count_whole_and_half() -> None:
    cases = [
        CaseOutcome(label("pair", "overflow", "input-delay"), said("input-delay", "overflow")),
        CaseOutcome(label("pair", "overflow", "input-delay"), said("overflow")),
        CaseOutcome(label("pair", "overflow", "input-delay"), said("overflow", "extra-lag")),
        CaseOutcome(label("pair", "overflow", "input-delay"), UNKNOWN),
    ]
    assert metric(cases, "pair: exactly both").value == 0.25
    assert metric(cases, "pair: at least").value == 0.75


def test_none_and_unknown() -> None:
    unlisted = label("unknown", truth={"kind": "relay-hysteresis"})
    cases = [
        CaseOutcome(label("none"), said()),
        CaseOutcome(label("none"), UNKNOWN),
        CaseOutcome(unlisted, UNKNOWN),
        CaseOutcome(unlisted, said("overflow", p=0.95)),
        CaseOutcome(unlisted, said("overflow", p=0.6)),
        CaseOutcome(unlisted, None),
    ]
    assert metric(cases, "no effect").value == 0.5
    assert metric(cases, "outside the table: unknown").value == 0.25
    assert metric(cases, "outside the table: never").value == 0.5


def test_a_parameter_mismatch_is_scored_apart_from_none_and_from_an_effect() -> None:
    mismatch = label("with-sim", "parameter-mismatch")
    assert kind_recognised(CaseOutcome(mismatch, said("parameter-mismatch")))
    assert not kind_recognised(CaseOutcome(mismatch, said("extra-lag")))
    assert not kind_recognised(CaseOutcome(mismatch, said("parameter-mismatch", "extra-lag")))
    assert kind_recognised(CaseOutcome(label("with-sim"), said()))
    assert not kind_recognised(CaseOutcome(label("with-sim"), UNKNOWN))
    structural = label("with-sim", "extra-lag")
    assert kind_recognised(CaseOutcome(structural, said("extra-lag")))
    assert not kind_recognised(CaseOutcome(structural, said("overflow")))
    assert not kind_recognised(CaseOutcome(structural, said("parameter-mismatch")))


def test_closure_is_held_against_the_true_structure() -> None:
    cases = [
        CaseOutcome(label("single-clear", "overflow"), said("overflow"), diagnosed=d, possible=p)
        for d, p in [(0.9, 1.0), (0.8, 0.8), (-0.5, 0.9), (0.0, 0.1), (0.95, 0.95)]
    ]
    found = metric(cases, "median share of the gap closed")
    assert found.count == 4  # where the truth itself closes nothing there is nothing to hold it against
    assert found.value == pytest.approx(0.95)
    assert metric(cases, "  share closed by the true structure").value == pytest.approx(0.925)


def test_intervals_must_neither_miss_nor_always_hit() -> None:
    result = {**said("overflow"), "gap": {"ci95": [0.8, 0.9]}}
    inside = CaseOutcome(label("single-clear", "overflow"), result, fresh_closure=0.85)
    outside = replace(inside, fresh_closure=0.95)
    found = metric([], "95 % interval", replays=[inside] * 19 + [outside])
    assert found.value == pytest.approx(0.95)
    assert metric_status(found) == "target"
    assert metric_status(metric([], "95 % interval", replays=[inside] * 20)) == "missed"
    assert metric([], "95 % interval", replays=[replace(inside, fresh_closure=None)]).count == 0


def test_calibration_by_hand() -> None:
    right = CaseOutcome(label("single-clear", "overflow"), said("overflow", p=0.95))
    wrong = CaseOutcome(label("single-clear", "extra-lag"), said("overflow", p=0.95))
    unsure = CaseOutcome(label("none"), said("overflow", p=0.25))
    cases = [right] * 3 + [wrong] + [unsure] * 4
    assert calibration_bins(cases) == ((0.25, 0.0, 4), (pytest.approx(0.95), 0.75, 4))
    assert metric(cases, "probability calibration").value == pytest.approx(0.5 * 0.25 + 0.5 * 0.2)


def test_certainty_falls_into_the_last_bin() -> None:
    assert calibration_bins([CaseOutcome(label("none"), said("overflow", p=1.0))]) == ((1.0, 0.0, 1),)


def test_onsets_within_two_percent_of_the_record() -> None:
    truth = {"load-step": {"onset": 40.0, "size": 1.0}}
    cases = [
        CaseOutcome(label("single-clear", "load-step", truth=truth), said("load-step", onset=onset))
        for onset in (41.9, 38.1, 42.1)
    ]
    cases.append(CaseOutcome(label("single-clear", "load-step", truth=truth), said("output-drift")))
    cases.append(
        CaseOutcome(label("partial", "load-step", truth={"kind": "swinging-delay"}), said("load-step", onset=1.0))
    )
    found = metric(cases, "load-step onset")
    assert (found.value, found.count) == (pytest.approx(2 / 3), 3)


def test_clip_levels_within_two_percent_of_the_range() -> None:
    truth = {"output-saturation": {"low": 1.0, "high": 4.0}}
    there = label("single-hard", "output-saturation", truth=truth, y_range=10.0)
    cases = [CaseOutcome(there, said("output-saturation", low=1.1, high=4.3))]
    found = metric(cases, "clip levels")
    assert (found.value, found.count) == (0.5, 2)
    missing = [CaseOutcome(there, said("output-saturation", high=4.1))]
    assert metric(missing, "clip levels").value == 0.5


def test_the_confusion_counts_every_answer() -> None:
    cases = [
        CaseOutcome(label("pair", "b", "a"), said("a", "b")),
        CaseOutcome(label("pair", "a", "b"), said("b")),
        CaseOutcome(label("none"), None),
    ]
    assert confusion(cases) == {"pair": {"a+b": {"a+b": 1, "b": 1}}, "none": {"none": {"error": 1}}}


def test_time_is_better_below() -> None:
    assert metric_status(metric([], "time per record", seconds=1.9)) == "target"
    assert metric_status(metric([], "time per record", seconds=4.0)) == "required"
    assert metric_status(metric([], "time per record", seconds=5.1)) == "missed"


def test_the_table_reads_well(capsys) -> None:
    cases = [CaseOutcome(label("single-clear", "overflow"), said("overflow"))] * 3
    cases.append(CaseOutcome(label("single-clear", "overflow"), said("extra-lag")))
    scores = score_cases(cases, seconds=1.0)
    assert metric_cells(scores.metrics[0]) == (
        "right effect named, one effect, clear",
        "75.0 %",
        "30.1-95.4 %",
        "4",
        "98 %",
        "99.5 %",
        "missed",
    )
    text = markdown(scores)
    assert "| right effect named, one effect, clear | 75.0 % | 30.1-95.4 % | 4 | 98 % | 99.5 % | missed |" in text
    assert "| single-clear | overflow | overflow 3, extra-lag 1 |" in text
    assert "| time per record and core | 1.00 s |" in text
    print_scores(scores, "a title")
    printed = capsys.readouterr().out
    assert "a title" in printed
    assert "extra-lag 1" in printed


@pytest.mark.parametrize(
    ("right", "of", "required", "fails"),
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
def test_a_bar_is_failed_only_by_more_than_chance(right: int, of: int, required: Any, fails: bool) -> None:
    low, high = wilson(right, of)
    assert Metric("rate", right / of if of else None, of, low, high, required).fails() is fails


def test_a_figure_without_an_interval_fails_nothing_and_one_that_must_be_small_by_its_lower_end() -> None:
    assert not Metric("time", 9.0, 50, required=5.0, below=True).fails()
    assert Metric("error", 0.3, 50, low=0.2, high=0.4, required=0.1, below=True).fails()
    assert not Metric("error", 0.15, 50, low=0.05, high=0.25, required=0.1, below=True).fails()
