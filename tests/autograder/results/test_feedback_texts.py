"""The text of the questions and the model answers in feedback pages."""

from datetime import UTC, datetime
from decimal import Decimal
from pathlib import Path

from autograder.batch.right_values import find_right_values
from autograder.course.layout import Course
from autograder.course.questions import Criterion, QuestionText, read_questions
from autograder.judge.outcome import QuestionResult
from autograder.results import result_files
from autograder.results.feedback import (
    FeedbackTexts,
    as_sentence,
    feedback_page,
    load_template,
    values_of,
    write_feedback,
)
from autograder.results.gradebook import ManualGrades, Mark
from autograder.results.result_files import StoredResult

LAB, PRELAB = "lab-identification", "prelab-sinusoids"
SECRET = b"0123456789abcdef0123456789abcdef"


def test_questions_are_read_from_the_notebook_with_solutions(course: Course, tmp_path: Path) -> None:
    found = read_questions(course, LAB)
    sampling = found["lab-1a-sampling-time"]
    assert sampling.task.startswith("Now find the **sampling time**")
    assert sampling.model == "# Ts\nTs = t[1] - t[0]"
    start = found["lab-3b-start"]
    assert "why does the simulated output not start from the same point" in start.task
    assert "from rest" in start.model
    assert not any("### BEGIN" in one.model or "<details>" in one.task for one in found.values())
    assert read_questions(Course(tmp_path), LAB) == {}
    assert read_questions(None, LAB) == {}


def test_right_values_are_those_of_the_students_own_record(course: Course, tmp_path: Path) -> None:
    one, other = (find_right_values(course, tmp_path, SECRET, student, LAB) for student in ("z1", "z2"))
    assert one["lab-1a-sampling-time"] == {"Ts": "0.75"}
    assert one["lab-3a-mse"].keys() == {"mse_half", "mse_all"}
    assert one["lab-3a-mse"] != other["lab-3a-mse"]
    assert "Phi" not in one["lab-2a-phi"]
    assert find_right_values(course, tmp_path, None, "z1", PRELAB) == {}
    (tmp_path / ".secret").write_text("x", encoding="ascii")
    assert find_right_values(course, tmp_path, None, "z1", LAB) == {}  # graded on records that are not known here


def test_values_of_other_questions_are_named_in_the_metadata() -> None:
    known = {"q-1": {"a": "1", "b": "2"}, "q-2": {"c": "3"}}
    assert values_of("q-2", QuestionText("", "x"), known) == {"c": "3"}
    assert values_of("q-3", QuestionText("", "x"), known) == {}
    assert values_of("q-3", QuestionText("", "x", values=("c", "a", "nosuch")), known) == {"c": "3", "a": "1"}


def test_pages_have_the_question_and_the_model_answer_when_it_is_due(tmp_path: Path) -> None:
    asked = (
        QuestionResult("q-1", Decimal(0), Decimal(1), "graded", "Wrong.", answer="a = 2"),
        QuestionResult("q-2", None, Decimal(1), "manual", "", answer="Because."),
        QuestionResult("q-3", Decimal(0), Decimal(1), "graded", "Wrong."),
    )
    for student in ("ann", "bob"):
        result_files.store(tmp_path, StoredResult(student, "tiny", "Tiny", asked, {}, (), "none", {}))
    questions = {
        "tiny": {"q-1": QuestionText("Find *a*.", "a = 1 < 2"), "q-2": QuestionText("Why?", "As $x$ is **so**.")}
    }

    def values(student: str, assignment: str) -> dict[str, dict[str, str]]:
        return {"q-1": {"a": f"1 of {student} in {assignment}"}}

    def pages(with_models: frozenset[str]) -> dict[str, str]:
        texts = FeedbackTexts("Course", questions, with_models, values)
        return {path.parent.name: path.read_text(encoding="utf-8") for path in write_feedback(tmp_path, texts)}

    before = pages(frozenset({"other"}))["ann"]
    assert "<p>Find <em>a</em>.</p>" in before
    assert before.count("<summary>The question</summary>") == 2
    assert "Model answer" not in before
    assert "a = 1 &lt; 2" not in before
    after = pages(frozenset({"tiny"}))
    assert after["ann"].count("<summary>Model answer</summary>") == 2
    assert "a = 1 &lt; 2</pre>" in after["ann"]
    assert "is <strong>so</strong>" in after["ann"]
    assert "On your record: <code>a</code> = 1 of ann in tiny." in after["ann"]
    assert "of bob" not in after["ann"]
    assert "of bob in tiny" in after["bob"]


def test_a_page_says_what_of_the_rubric_was_found() -> None:
    asked = QuestionResult("q", None, Decimal("0.1"), "manual", "", answer="Because.")
    stored = StoredResult("ann", "tiny", "Tiny", (asked,), {}, (), "none", {})
    rubric = (Criterion("Says *why*.", Decimal("0.06")), Criterion("Says when.", Decimal("0.04")))
    key, text = ("ann", "tiny", "q"), QuestionText("Why?", "As it is.", rubric)

    def shown(ticked: tuple[int, ...], with_models: bool = True) -> list[tuple[str, bool]]:
        mark = Mark(Decimal("0.06"), "Eva", datetime(2026, 12, 1, tzinfo=UTC), ticked)
        manual = ManualGrades({key: mark.score}, {}, frozenset(), {key: mark})
        texts = FeedbackTexts("", {"tiny": {"q": text}}, frozenset({"tiny"} if with_models else ()))
        (block,) = feedback_page(stored, manual, "", texts)["questions"]
        page = load_template("feedback.html.j2").render(page=feedback_page(stored, manual, "", texts))
        assert ("Says <em>why</em>." in page) == bool(block["rubric"])
        return [(one["points"], one["ticked"]) for one in block["rubric"]]

    assert shown((0,)) == [("0.06", True), ("0.04", False)]
    assert shown((0,), with_models=False) == []  # it would tell the answer
    assert shown(()) == []  # other points were given


def test_a_reason_begins_with_a_capital_unless_it_may_be_a_name_in_code() -> None:
    reasons = (
        "a column of 801 rows.",
        "three columns.",
        "`t_new` starts at 20 s.",
        "low, high noted.",
        "y (V) is missing.",
    )
    assert [as_sentence(one)[:3] for one in reasons] == ["A c", "Thr", "`t_", "low", "y ("]
