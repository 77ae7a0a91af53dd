"""The row of ordinary records: its cases, what is right there, and what counts as invented."""

import json
from pathlib import Path
from typing import Any

import pytest
from statsmodels.stats.proportion import proportion_confint

from labsid.blind.experiment import OrdinaryCase
from labsid.blind.honest import count_kinds, has_no_report, has_right_numbers, is_accepted, wrong_names
from labsid.blind.metrics import CaseOutcome, KindCounts, Metric
from labsid.blind.right_answers import is_right
from labsid.blind.runner import diagnose_words
from labsid.blind.score import score_cases
from labsid.blind.suite import label_dict, make_cases, write_suite
from labsid.blind.table import markdown, print_scores
from labsid.rig.ordinary.kinds import KINDS

NONE: list[list[str]] = [[]]
PAIR = {"determined": {"tau": 0.5}, "undetermined": ["a", "b"], "combination": "a*b", "value": 6.0}


@pytest.fixture(scope="module")
def cases() -> list[OrdinaryCase]:
    return [case for case in make_cases("dev", len(KINDS), ["honest"]) if isinstance(case, OrdinaryCase)]


def label(answers: list[list[str]], row: str = "honest", kind: str = "plain", **more: Any) -> dict[str, Any]:
    return {"row": row, "labels": answers[0], "answers": answers, "truth": {"kind": kind}, "numbers": None, **more}


def said(verdict: str, **effects: float) -> dict[str, Any]:
    named = [{"name": name.replace("_", "-"), "probability": p, "parameters": {}} for name, p in effects.items()]
    return {"verdict": verdict, "effects": named, "ambiguous": []}


def metric(outcomes: list[CaseOutcome], name: str) -> Metric:
    (found,) = [one for one in score_cases(outcomes).metrics if one.name.strip() == name]
    return found


def test_the_kinds_take_turns(cases: list[OrdinaryCase]) -> None:
    assert [case.kind for case in cases] == list(KINDS)
    assert len({case.name for case in cases}) == len(KINDS)


def test_the_files_do_not_reveal_the_answers(cases: list[OrdinaryCase], tmp_path: Path) -> None:
    path = write_suite(tmp_path / "records", "dev", len(KINDS), ["honest"])
    labels = json.loads(path.read_text(encoding="utf-8"))
    assert labels == json.loads(json.dumps({case.name: label_dict(case) for case in cases}))
    names = {file.name for file in (tmp_path / "records").iterdir()}
    assert names == {f"{case.name}{ending}" for case in cases for ending in case.made.files}
    for case in cases:
        assert case.kind not in "".join(case.made.files.values())


def test_the_command_line_has_the_simulation_and_the_free_numbers(cases: list[OrdinaryCase]) -> None:
    words = {case.kind: " ".join(diagnose_words(case)).replace(case.name, "X") for case in cases}
    assert words["plain"] == "gap diagnose X.csv"
    assert words["itself-json"] == "gap diagnose X.csv --sim X.sim.json"
    assert words["simulated-output-limit"] == "gap diagnose X.csv --sim X.sim.csv"
    assert words["itself-function"] == "gap diagnose X.csv --sim X.py:simulate"
    assert words["free-idle"] == "gap diagnose X.csv --sim X.py:simulate --free gain,tau,limit"


@pytest.mark.parametrize(
    ("answers", "result", "right"),
    [
        (NONE, said("none"), True),
        (NONE, said("unknown"), False),
        (NONE, said("effect", resonance=0.6), False),
        (NONE, said("partial", resonance=0.2), False),  # a gap is asserted
        (NONE, said("effect"), False),
        (NONE, None, False),
        (NONE, {"verdict": "error", "message": "x"}, False),
        ([[], ["unknown"]], said("unknown"), True),
        ([[], ["unknown"]], said("partial", resonance=0.5), True),
        ([[], ["unknown"]], said("partial", resonance=0.51), False),
        ([["input-off"]], said("effect", input_off=0.9), True),
        ([["input-off"]], said("partial", input_off=0.9, resonance=0.2), True),
        ([["input-off"]], said("effect", input_off=0.9, resonance=0.2), False),
        ([["output-saturation"]], said("effect", output_saturation=0.9, output_outliers=0.9), False),
    ],
)
def test_accepted_answers(answers: list[list[str]], result: dict[str, Any] | None, right: bool) -> None:
    case = CaseOutcome(label(answers), result)
    assert is_accepted(case) is right
    assert is_right(case) is right


def test_a_wrong_name_is_in_no_right_answer() -> None:
    result = said("partial", input_delay=0.95, resonance=0.7, extra_lag=0.3)
    case = CaseOutcome(label([[], ["input-delay"]]), result)
    assert wrong_names(case, 0.5) == ["resonance"]
    assert wrong_names(case, 0.9) == []
    assert wrong_names(CaseOutcome(label(NONE), result), 0.9) == ["input-delay"]
    assert wrong_names(CaseOutcome(label(NONE), None), 0.5) == []
    assert has_no_report(CaseOutcome(label(NONE), None))


@pytest.mark.parametrize(
    ("numbers", "right"),
    [
        ({"tau": (0.52, 0.01), "a": (2.0, None), "b": (3.0, None)}, True),
        ({"tau": (0.53, 0.01), "a": (2.0, None), "b": (3.0, None)}, False),
        ({"tau": (0.5, 0.01), "a": (2.0, 0.0), "b": (3.0, None)}, False),
        ({"tau": (0.5, 0.01), "a": (2.0, None), "b": (4.0, None)}, False),
        ({"tau": (0.5, 0.01), "a": (2.0, None)}, False),
        ({}, False),
    ],
)
def test_numbers_are_near_and_undetermined_ones_have_no_error(numbers: dict[str, Any], right: bool) -> None:
    listed = [{"name": name, "value": value, "stderr": stderr} for name, (value, stderr) in numbers.items()]
    earlier = {one["name"]: {"value": one["value"], "stderr": one["stderr"]} for one in listed}
    for result in (said("effect") | {"numbers": listed}, said("effect") | {"simulation": {"numbers": earlier}}):
        assert has_right_numbers(CaseOutcome(label(NONE, numbers=PAIR), result)) is right
    ratio = PAIR | {"combination": "a/b", "value": 2.0 / 3.0}
    assert has_right_numbers(CaseOutcome(label(NONE, numbers=ratio), result)) is right
    assert has_right_numbers(CaseOutcome(label(NONE), None))


def outcomes() -> list[CaseOutcome]:
    """Three of five right, one sure of a wrong name, one without a report."""
    return [
        CaseOutcome(label(NONE), said("none")),
        CaseOutcome(label(NONE), said("effect", resonance=0.95)),
        CaseOutcome(label([["parameter-mismatch"]], kind="pair", numbers=PAIR), None),
        CaseOutcome(label([["input-off"]], kind="off"), said("effect", input_off=0.97)),
        CaseOutcome(label([["input-off"]], kind="off"), said("effect", input_off=0.6)),
    ]


def test_the_rates_of_the_row() -> None:
    some = outcomes()
    assert metric(some, "ordinary records: right answer").value == 0.6
    likely = metric(some, "ordinary records: a wrong name above 0.5")
    assert (likely.value, likely.below) == (0.2, True)
    assert (likely.low, likely.high) == pytest.approx(proportion_confint(1, 5, method="wilson"))
    assert metric(some, "ordinary records: a wrong name above 0.9").fails()
    assert metric(some, "ordinary records: wrong among the names above 0.9").value == 0.5
    assert metric(some, "ordinary records: no report").value == 0.2
    numbers = metric(some, "free numbers: within 5 % of the truth, undetermined ones without an error")
    assert (numbers.value, numbers.count) == (0.0, 1)
    assert metric([], "ordinary records: right answer").value is None


def test_silence_on_a_faint_effect_is_right_and_only_wrong_names_count() -> None:
    faint = {"row": "faint", "labels": ["input-dead-zone"], "truth": {}}
    some = [
        CaseOutcome(faint, said("none")),
        CaseOutcome(faint, said("effect", input_dead_zone=0.95)),
        CaseOutcome(faint, said("effect", coulomb_friction=0.95)),
        CaseOutcome(faint, said("partial", coulomb_friction=0.3)),
        CaseOutcome(faint, None),
    ]
    assert [is_right(case) for case in some] == [True, True, False, True, False]
    assert metric(some, "faint effect: a wrong name above 0.5").value == 0.2
    assert metric(some, "faint effect: a wrong name above 0.9").value == 0.2
    assert metric(some, "faint effect: wrong among the names above 0.9").value == 0.5


def test_the_older_figures_do_not_count_the_new_rows() -> None:
    faint = {"row": "faint", "labels": ["load-step"], "truth": {"load-step": {"onset": 5.0}}, "Ts": 0.1, "samples": 100}
    some = [*outcomes(), CaseOutcome(faint, said("effect", load_step=0.9))]
    assert score_cases(some).calibration == ()
    assert metric(some, "load-step onset within 2 % of the record").count == 0


def test_the_kinds_are_counted_and_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    counts = count_kinds(outcomes())
    assert counts[0] == KindCounts("plain", 2, 1, 1, 1, 0)
    assert counts[1] == KindCounts("pair", 1, 0, 0, 0, 1)
    assert counts[-1] == KindCounts("all", 5, 3, 1, 1, 1)
    assert count_kinds([]) == ()
    scores = score_cases(outcomes())
    assert "| plain | 2 | 1 (9-91 %) |" in markdown(scores)
    print_scores(scores, "title")
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["kind", "records", "right"] in [line[:3] for line in lines]
    assert ["all", "5", "3", "(23-88"] in [line[:4] for line in lines]
