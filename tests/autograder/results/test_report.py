"""The class report: what an instructor may give marks for."""

import re
from dataclasses import replace
from decimal import Decimal

from autograder.judge.outcome import QuestionResult
from autograder.results.feedback import load_template
from autograder.results.gradebook import ManualGrades
from autograder.results.late import LATE_WITHOUT_TIME, TIME_UNKNOWN
from autograder.results.report import report_page
from autograder.results.result_files import StoredResult

NOTHING = ManualGrades({}, {}, frozenset())


def test_what_follows_from_own_wrong_values_is_listed_with_its_marks() -> None:
    questions = (
        QuestionResult("q-1", Decimal(0), Decimal("0.5"), "graded", "Wrong."),
        QuestionResult("q-2", Decimal(0), Decimal("0.1"), "graded", "Wrong.", consistent=True),
        QuestionResult("q-3", Decimal(0), Decimal("0.15"), "graded", "Wrong.", consistent=True),
        QuestionResult("q-4", Decimal(1), Decimal(1), "graded", "Right."),
    )
    stored = StoredResult("ada", "tiny", "Tiny", questions, {}, (), "none", {})
    (review,) = report_page([stored], NOTHING)["reviews"]
    assert review["reasons"] == [
        "consistent with the student's own wrong values, 0.25 marks that you may give: q-2 (0.1), q-3 (0.15)"
    ]


def graded(student: str, *scores: str | None, status: str = "graded") -> StoredResult:
    """A hand-in with one question of one mark for each score; None waits to be marked by hand."""
    questions = tuple(
        QuestionResult(f"q-{n}", None if score is None else Decimal(score), Decimal(1), status, "As judged.")
        for n, score in enumerate(scores, 1)
    )
    return StoredResult(student, "tiny", "Tiny", questions, {}, (), "none", {})


def test_the_map_of_the_class_shades_the_marks_that_are_lost_and_begins_with_the_lowest() -> None:
    class_ = [graded("ada", "1", "1"), graded("ben", "0.5", None), graded("cat", "0", "0", status="missing")]
    page = report_page([*class_, graded("dan", "0", "0.5")], NOTHING)
    cells = {row["id"]: row["cells"][0] for row in page["class"]}
    assert list(cells) == ["cat", "dan", "ben", "ada"]
    assert {student: cell["lost"] for student, cell in cells.items()} == {"cat": None, "dan": 75, "ben": 25, "ada": 0}
    assert page["statuses"] == ["not handed in", "waiting"]
    (tiny,) = page["assignments"]
    assert tiny["lost"] == 33  # of the three that handed in
    html = load_template("report.html.j2").render(page=page)
    assert 'style="--lost: 75%"' in html
    assert 'aria-label="0, not handed in">–</a>' in html


def test_only_questions_that_cost_marks_are_listed() -> None:
    (tiny,) = report_page([graded("ada", "1", "0.5", None), graded("ben", "1", "0", "1")], NOTHING)["assignments"]
    assert [(row["id"], row["lost"]) for row in tiny["questions"]] == [("q-2", "1.5")]
    assert tiny["without_loss"] == 2


def test_the_report_begins_with_the_students_and_ends_with_the_isolation() -> None:
    sent = replace(graded("ada", "1", "0"), isolation="namespaces")
    html = load_template("report.html.j2").render(page=report_page([sent, graded("ben", "1", "0")], NOTHING))
    places = re.findall(r'<section[^>]*id="(.*?)"', html)
    assert places == ["class", "review", "tiny", "similar", "isolation"]
    assert '<a href="#isolation">1 ran without isolation.</a>' in html


def test_hand_ins_without_a_time_are_counted_and_those_that_are_called_late_are_to_review() -> None:
    class_ = [replace(graded(student, "1"), late=TIME_UNKNOWN) for student in ("ada", "ben", "cat")]
    page = report_page([*class_, replace(graded("dan", "1"), late=LATE_WITHOUT_TIME)], NOTHING)
    assert [(review["student"], review["reasons"]) for review in page["reviews"]] == [("dan", [LATE_WITHOUT_TIME])]
    assert page["assignments"][0]["untimed"] == 3
    html = load_template("report.html.j2").render(page=page)
    assert "The time of the hand-in is not known of 3; nothing was deducted there." in html
    timed = load_template("report.html.j2").render(page=report_page([graded("ada", "1")], NOTHING))
    assert "is not known of" not in timed
