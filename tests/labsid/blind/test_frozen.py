"""Kept answers of the diagnosis, and their comparison with those of a changed one."""

import json
from copy import deepcopy
from pathlib import Path

import pytest
from gap_search import FEW_IN_ONE_PROCESS

from labsid.blind import frozen
from labsid.blind.experiment import Case
from labsid.blind.frozen import MEASURED, RECORDS, Answers, answer_of, compare_answers, main, simulated_answers
from labsid.blind.rows import DEFAULT_ROWS

KEPT: Answers = {
    "single-clear": {
        "seconds": 1.0,
        "answers": {
            "0": {"verdict": "effect", "effects": {"input-delay": 0.98}, "closed": 1.0, "right": True},
            "1": {"verdict": "unknown", "effects": {}, "closed": None, "right": False},
        },
    },
    "measured": {
        "seconds": 3.0,
        "answers": {
            "rigs/axis": {"verdict": "partial", "effects": {"coulomb-friction": 0.9}, "closed": 0.5, "right": None}
        },
    },
}


def changed(row: str, name: str, **entries: object) -> Answers:
    found = deepcopy(KEPT)
    found[row]["answers"][name].update(entries)
    return found


def test_the_same_answers_are_accepted() -> None:
    lines, accepted = compare_answers(KEPT, KEPT)
    assert accepted
    assert len(lines) == 2
    assert "right   1 ->   1   other effects   0   probability within 0.0000" in lines[0]


def test_other_numbers_are_shown_and_accepted() -> None:
    lines, accepted = compare_answers(KEPT, changed("single-clear", "0", effects={"input-delay": 0.91}, closed=0.97))
    assert accepted
    assert "probability within 0.0700   closed within 0.0300" in lines[0]


def test_an_answer_that_becomes_right_is_accepted() -> None:
    better = changed("single-clear", "1", verdict="effect", effects={"extra-lag": 0.8}, right=True)
    lines, accepted = compare_answers(KEPT, better)
    assert accepted
    assert lines[-1] == "  single-clear 1: unknown [] wrong -> effect [extra-lag 0.80] right"


@pytest.mark.parametrize(
    "found",
    [
        changed("single-clear", "0", verdict="partial", effects={"resonance": 0.6}, right=False),
        changed("measured", "rigs/axis", effects={"coulomb-friction": 0.4}),
    ],
    ids=["one right answer less", "nothing asserted on a measured record"],
)
def test_worse_answers_are_not_accepted(found: Answers) -> None:
    lines, accepted = compare_answers(KEPT, found)
    assert not accepted
    assert "->" in lines[-1]


def test_a_missing_answer_counts_as_wrong() -> None:
    found = deepcopy(KEPT)
    del found["single-clear"]["answers"]["0"]
    lines, accepted = compare_answers(KEPT, found)
    assert not accepted
    assert lines[-1] == "  single-clear 0: effect [input-delay 0.98] right -> error [] wrong"


def test_an_error_is_kept_as_one() -> None:
    assert answer_of({"schema": "labsid.gap/4", "verdict": "error", "message": "x"})["verdict"] == "error"


def test_answers_are_kept_and_found_again(
    short_cases: list[Case], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("labsid.blind.runner._MAIN", FEW_IN_ONE_PROCESS)
    monkeypatch.setattr(frozen, "make_cases", lambda seeds, per_row, rows, jobs: short_cases[:per_row])
    file = tmp_path / "answers.json"
    only = ["--row", "none", "--jobs", "1"]
    assert main(["keep", str(file), "--per-row", "1", *only]) == 0
    (row,) = json.loads(file.read_text(encoding="utf-8")).values()
    assert row["answers"]["0"] == {"verdict": "none", "effects": {}, "closed": None, "right": True}
    assert main(["compare", str(file), *only]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "accepted"


def test_the_answers_of_this_version_are_kept_beside_this_test() -> None:
    kept = json.loads(Path(__file__).with_name("answers.json").read_text(encoding="utf-8"))
    assert set(kept) - {MEASURED} == set(DEFAULT_ROWS)
    assert all(len(row["answers"]) == RECORDS.get(name, 12) for name, row in kept.items() if name != MEASURED)
    first = simulated_answers("single-clear", 1, 1)["answers"]["0"]
    assert first["right"]
    expected = kept["single-clear"]["answers"]["0"]
    assert first == expected | {
        "effects": pytest.approx(expected["effects"], abs=0.02),
        "closed": pytest.approx(expected["closed"], abs=0.02),
    }
