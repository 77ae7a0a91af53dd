"""Kept answers of the diagnosis, and their comparison with those of a changed one."""

import json
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from gap_search import FEW_IN_ONE_PROCESS

from labsid.blind import kept_answers
from labsid.blind.experiment import Case
from labsid.blind.kept_answers import (
    MEASURED,
    RECORDS,
    Answers,
    answer_of,
    case_hashes,
    changed_cases,
    compare_answers,
    compare_with_kept,
    keep_answers,
    measured_hashes,
    read_answers,
    simulated_answers,
)
from labsid.blind.limits import ROW as LIMITS
from labsid.blind.rows import DEFAULT_ROWS, ROWS
from labsid.cli.commands import main as command
from labsid.records.formats import cut_signals

KEPT_FILE = Path(__file__).with_name("answers.json")

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
    assert lines[2:] == [
        "single-clear       2    1 -> 1        0       0.0000   0.0000    1.00 -> 1.00",
        "measured           1         -        0       0.0000   0.0000    3.00 -> 3.00",
    ]


def test_other_numbers_are_shown_and_accepted() -> None:
    lines, accepted = compare_answers(KEPT, changed("single-clear", "0", effects={"input-delay": 0.91}, closed=0.97))
    assert accepted
    assert lines[2].split()[5:8] == ["0", "0.0700", "0.0300"]


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
    assert " ".join(" ".join(lines[-1:]).split()) == (
        "single-clear 0: effect [input-delay 0.98] right -> error [] wrong"
    )


def test_an_error_is_kept_as_one() -> None:
    assert answer_of({"schema": "labsid.gap/4", "verdict": "error", "message": "x"})["verdict"] == "error"


@pytest.fixture
def few(short_cases: list[Case], monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Two short cases in the place of every row, diagnosed by a search for one effect."""
    monkeypatch.setattr("labsid.blind.runner._MAIN", FEW_IN_ONE_PROCESS)
    monkeypatch.setattr(kept_answers, "make_cases", lambda seeds, per_row, rows, jobs: short_cases[:per_row])
    return short_cases


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "answers.json"


def kept_file(file: Path, **rows: dict[str, Any]) -> Path:
    """A file of kept answers, with a wrong one to each of the given cases."""
    wrong = {"verdict": "unknown", "effects": {}, "closed": None, "right": False}
    content = {
        row: {"seconds": 1.0, "cases": cases, "answers": dict.fromkeys(cases, wrong)} for row, cases in rows.items()
    }
    file.write_text(json.dumps(content), encoding="utf-8")
    return file


def test_answers_are_kept_and_found_again(few: list[Case], file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["gap", "compare", str(file), "--keep", "--row", "none", "--per-row", "1", "--jobs", "1"]) == 0
    (row,) = json.loads(file.read_text(encoding="utf-8")).values()
    assert row["answers"] == {"0": {"verdict": "none", "effects": {}, "closed": None, "right": True}}
    assert row["cases"] == case_hashes(few[:1])
    assert command(["gap", "compare", str(file), "--jobs", "1"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[-1] == "accepted"
    assert max(map(len, printed)) <= 80


def test_a_row_that_is_kept_again_leaves_the_other_rows(few: list[Case], file: Path) -> None:
    kept_file(file, pair={"0": "abc"}, none={"0": "abc"})
    keep_answers(file, ["none"], per_row=1)
    rows = json.loads(file.read_text(encoding="utf-8"))
    assert list(rows) == ["pair", "none"]
    assert rows["pair"]["cases"] == {"0": "abc"}
    assert rows["none"]["cases"] == case_hashes(few[:1])


def test_cases_that_are_others_now_are_refused_before_anything_is_diagnosed(
    few: list[Case], file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As after a new family, which shifts the draws of its row."""
    monkeypatch.delattr(kept_answers, "run_batch")
    right = case_hashes(few)
    kept_file(file, families=right | {"1": "another"}, pair=right)
    assert command(["gap", "compare", str(file)]) == 2
    error = capsys.readouterr().err
    assert "no longer those of the kept answers: families: case 1. Keep their rows again: " in error
    assert error.endswith(f"labsid gap compare {file} --keep --row families\n")


def test_a_case_is_another_one_if_its_record_its_label_or_its_simulation_is(few: list[Case]) -> None:
    case = few[0]
    others = [
        replace(case, record=replace(case.record, y=case.record.y * (1.0 + 1e-5))),
        replace(case, record=cut_signals(case.record, slice(299))),
        replace(case, labels=("extra-lag",)),
        replace(case, truth={"kind": "another"}),
        replace(case, sim={"num": [0.0, 1.0], "den": [1.0, -0.9], "dt": case.record.Ts}),
    ]
    hashes = set(case_hashes([case, *others]).values())
    assert len(hashes) == 6
    last_digits = replace(case, record=replace(case.record, y=case.record.y * (1.0 + 1e-12)))
    assert case_hashes([case]) == case_hashes([last_digits])


def test_a_measured_record_that_is_missing_or_another_one_is_refused(file: Path, tmp_path: Path) -> None:
    rigs = tmp_path / "rigs"
    rigs.mkdir()
    (rigs / "axis.csv").write_text("t,u,y\n", encoding="utf-8")
    (rigs / "axis-2.csv").write_text("t,u,y\n", encoding="utf-8")
    hashes = measured_hashes(tmp_path, ["rigs/axis", "rigs/axis-2", "rigs/gone"])
    assert list(hashes) == ["rigs/axis", "rigs/axis-2"]
    kept_file(file, measured=hashes | {"rigs/gone": "abc"})
    (rigs / "axis.holdout.csv").write_text("t,u,y\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"answers: measured: rigs/axis, rigs/gone\. Keep"):
        compare_with_kept(file, records=tmp_path)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--row", "pears"], "--row must be one of single-clear, single-hard, "),
        (["--row", "pair"], "has no answers of the row pair, only of none. Keep them: labsid gap compare"),
        (["--row", "measured"], "has no answers of the row measured"),
        (["--keep", "--row", "measured"], "Name it with --records DIR"),
        (["--keep", "--row", "pears"], "got 'pears'. `--rows` says what each is."),
        (["--per-row", "3"], "--per-row goes with --keep"),
    ],
)
def test_what_cannot_be_compared_is_one_line(
    arguments: list[str], words: str, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept_file(file, none={"0": "abc"})
    assert command(["gap", "compare", str(file), *arguments]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("content", ["[]", "{", '{"none": {"seconds": 1.0, "answers": {}}}'])
def test_another_file_is_refused(content: str, file: Path) -> None:
    file.write_text(content, encoding="utf-8")
    with pytest.raises(ValueError, match="is no file of kept answers"):
        read_answers(file)


def test_measured_records_that_are_not_compared_are_named(few: list[Case], file: Path) -> None:
    kept_file(file, measured={"rigs/axis": "abc"})
    text, accepted = compare_with_kept(file)
    assert accepted
    assert "The measured records are not compared; name their folder with --records." in text


@pytest.mark.parametrize("group", ["blind", "compare"])
def test_rows_are_listed_with_what_they_are(group: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["gap", group, "--rows"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines if line[0] != " "] == [*ROWS, LIMITS, MEASURED]
    assert all(line[14].isupper() for line in lines if line[0] != " ")
    assert max(map(len, lines)) <= 80


def test_the_help_of_the_sealed_check_names_the_comparison(capsys: pytest.CaptureFixture[str]) -> None:
    command(["gap", "blind", "--help"])
    assert "labsid gap compare" in capsys.readouterr().out


def test_the_answers_of_this_version_are_kept_beside_this_test(
    dev_cases: Callable[[str, int], list[Case]],
) -> None:
    kept = read_answers(KEPT_FILE)
    assert set(kept) - {MEASURED} == set(DEFAULT_ROWS)
    assert all(len(row["answers"]) == RECORDS.get(name, 12) for name, row in kept.items() if name != MEASURED)
    row = simulated_answers(dev_cases("single-clear", 1), 1)
    assert row["cases"]["0"] == kept["single-clear"]["cases"]["0"]
    first = row["answers"]["0"]
    assert first["right"]
    expected = kept["single-clear"]["answers"]["0"]
    assert first == expected | {
        "effects": pytest.approx(expected["effects"], abs=0.02),
        "closed": pytest.approx(expected["closed"], abs=0.02),
    }


@pytest.mark.exhaustive
@pytest.mark.parametrize("row", DEFAULT_ROWS)
def test_the_cases_whose_answers_are_kept_are_those_of_this_version(
    row: str, dev_cases: Callable[[str, int], list[Case]]
) -> None:
    kept = read_answers(KEPT_FILE)[row]
    assert changed_cases(kept, case_hashes(dev_cases(row, len(kept["cases"])))) == []
