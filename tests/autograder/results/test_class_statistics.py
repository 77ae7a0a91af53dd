"""What the questions tell: difficulty, discrimination, and wrong answers without a name, of five students or more."""

import csv
import io
from decimal import Decimal
from pathlib import Path

import pytest

from autograder.judge.outcome import QuestionResult
from autograder.results import result_files
from autograder.results.class_statistics import QuestionFigures, question_figures, statistics_csv
from autograder.results.report import write_report
from autograder.results.result_files import StoredResult

CODE = "phi = y[1:]  # by {who}"


def question(
    name: str, score: str | None, reason: str = "", slip: str | None = None, answer: str = CODE, status: str = "graded"
) -> QuestionResult:
    return QuestionResult(name, None if score is None else Decimal(score), Decimal(2), status, reason, slip, answer)


def stored(student: str, *questions: QuestionResult) -> StoredResult:
    return StoredResult(student, "tiny", "Tiny", questions, {"a": "1. Phi"}, (), "none", {})


def class_of(*scores: tuple[str, str, str]) -> list[StoredResult]:
    return [
        stored(f"s{i}", *(question(name, score) for name, score in zip("abc", three, strict=True)))
        for i, three in enumerate(scores)
    ]


def figures(results: list[StoredResult]) -> dict[str, QuestionFigures]:
    return {one.question: one for one in question_figures(results, {}, {"a": "1. Phi"})}


def test_difficulty_and_discrimination_by_hand() -> None:
    found = figures(class_of(("2", "2", "2"), ("2", "2", "1"), ("2", "0", "0"), ("0", "0", "0"), ("0", "1", "2")))
    assert found["a"].difficulty == pytest.approx(0.6)
    assert found["b"].difficulty == pytest.approx(0.5)
    # of a, the shares 1, 1, 1, 0, 0 with the rests 4, 3, 0, 0, 3: covariance 0.25, variances 0.3 and 3.5
    assert found["a"].discrimination == pytest.approx(0.25 / (0.3**0.5 * 3.5**0.5))
    assert (found["a"].heading, found["a"].answers) == ("1. Phi", 5)


def test_where_nothing_varies_there_is_no_discrimination() -> None:
    found = figures(class_of(*[("2", "2", "0")] * 5))
    assert {one.discrimination for one in found.values()} == {None}


def test_four_students_are_no_group() -> None:
    assert figures(class_of(*[("2", "1", "0")] * 4)) == {}
    five = class_of(*[("2", "1", "0")] * 5)
    waiting = [stored(one.student, *one.questions, question("d", None, status="manual")) for one in five]
    assert set(figures(waiting)) == {"a", "b", "c"}
    by_hand = {(one.student, "tiny", "d"): Decimal(1) for one in waiting}
    assert question_figures(waiting, by_hand)[3].difficulty == 0.5


def wrong(*reasons: str, slip: str | None = None, answer: str = CODE) -> list[StoredResult]:
    return [
        stored(f"s{i}", question("a", "0", reason, slip, answer.format(who=f"s{i}")))
        for i, reason in enumerate(reasons)
    ]


def test_wrong_answers_without_a_name_are_put_together_by_their_reason() -> None:
    rows = wrong(*[f"`Phi` has shape ({n}, 4), not {n - 0.5}e-3." for n in range(440, 446)], "It is Ada's.", "Odd.")
    named = [stored(f"t{i}", question("a", "0", "A sign.", "sign of a")) for i in range(3)]
    (kind,) = figures([*rows, *named])["a"].kinds
    assert (kind.count, kind.reason, kind.code) == (6, "`Phi` has shape (#, #), not #.", "phi = y[1:]")
    assert figures([*rows, *named])["a"].not_right == 11
    assert figures([*rows, *named])["a"].without_a_name == 8


def test_no_text_of_fewer_than_five_is_shown() -> None:
    rows = wrong(*["Ada was here."] * 4, *["Ben was here."] * 4)
    assert figures(rows)["a"].kinds == ()
    different = wrong(*["Wrong."] * 4, answer="phi_of_ada = 1")
    different.append(stored("x", question("a", "0", "Wrong.", None, "phi_of_ben = 1")))
    (kind,) = figures(different)["a"].kinds
    assert (kind.count, kind.code) == (5, "")


def test_answers_that_are_none_and_code_that_is_none_count_for_nothing() -> None:
    rows = wrong(*["Not answered."] * 5, answer="# Your code here\npass")
    assert figures(rows)["a"].not_right is None
    (kind,) = figures(wrong(*["No."] * 5, answer="a = (1"))["a"].kinds
    assert kind.code == ""


def test_the_table_has_no_names_and_no_formula(tmp_path: Path) -> None:
    rows = wrong(*["=cmd() is wrong."] * 5)
    table = list(csv.reader(io.StringIO(statistics_csv({"tiny": question_figures(rows, {})}))))
    assert table[1] == ["tiny", "a", "5", "0.000", "", "5", "5", "", "", "", ""]
    assert table[2] == ["tiny", "a", "", "", "", "", "", "1", "5", "'=cmd() is wrong.", "phi = y[1:]"]
    for one in rows:
        result_files.store(tmp_path, one)
    page = write_report(tmp_path).read_text(encoding="utf-8")
    text = (tmp_path / "questions.csv").read_text(encoding="utf-8")
    assert not [one.student for one in rows if one.student in text]
    assert "What the questions of tiny tell" in page
    assert "<pre>phi = y[1:]</pre>" in page
