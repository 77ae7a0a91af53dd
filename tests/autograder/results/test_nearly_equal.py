"""Hand-ins with nearly all answers equal are reported in a class of any size, and honest ones are not."""

import random
from decimal import Decimal

import pytest
from course_work import read_solved
from variants import Right, variants_of

from autograder.course.layout import Course
from autograder.intake.submission import NotebookCell
from autograder.judge.outcome import QuestionResult
from autograder.results.gradebook import ManualGrades
from autograder.results.nearly_equal import NearlyEqual, find_nearly_equal
from autograder.results.report import report_page
from autograder.results.result_files import StoredResult
from autograder.results.similar import code_fingerprints
from labsid.checks.notebook import assignment_names

NOTHING = ManualGrades({}, {}, frozenset())
ONES = {f"q{n}": (f"own form {n}", 14) for n in range(16)}


def stored(student: str, work: dict[str, tuple[str, int]], **answers: str) -> StoredResult:
    questions = tuple(
        QuestionResult(name, Decimal(0 if name == "q3" else 1), Decimal(1), "graded", "", answer=answers.get(name, "x"))
        for name in work
    )
    return StoredResult(student, "tiny", "Tiny", questions, {}, (), "none", {}, work=work)


def own(student: str) -> dict[str, tuple[str, int]]:
    return {name: (f"{student} {digest}", size) for name, (digest, size) in ONES.items()}


def test_15_of_16_equal_answers_are_reported_in_a_class_of_five() -> None:
    class_ = [stored(who, {**ONES, f"q{n}": (who, 12)}) for n, who in enumerate(("ann", "bob"))]
    class_ += [stored(who, own(who)) for who in ("cat", "dan", "eve")]
    assert find_nearly_equal(class_) == [
        NearlyEqual("tiny", ("ann", "bob"), 14, 14, 16, ("q0", "q1"), 14, ("q3",)),
    ]
    class_[1] = stored("bob", {**ONES, "q0": ("bob", 12)}, q5="x # mine", q6=" x\n")
    (group,) = find_nearly_equal(class_)
    assert (group.fewest, group.different, group.to_the_letter) == (15, ("q0",), 14)


def test_a_whole_small_class_that_copied_is_one_group() -> None:
    """More than three equal answers counted as what many write, and nothing was said."""
    class_ = [stored(f"s{n}", {**ONES, f"q{n}": (f"s{n}", 12)}) for n in range(6)]
    page = report_page(class_, NOTHING)
    assert page["similar"] == []
    (group,) = page["nearly"]
    assert group["equal"] == "14 of 16"
    assert [one["id"] for one in group["students"]] == [f"s{n}" for n in range(6)]
    assert group["same_mistakes"] == ()


def test_a_copy_with_blank_answers_is_found() -> None:
    half = {name: work for name, work in ONES.items() if int(name[1:]) < 13}
    (group,) = find_nearly_equal([stored("ann", ONES), stored("bob", {**half, "q0": ("bob", 12)})])
    assert (group.fewest, group.compared) == (12, 13)


@pytest.mark.parametrize(
    "work",
    [
        pytest.param(ONES, id="all equal, reported as an equal notebook"),
        pytest.param({**ONES, **{f"q{n}": ("other", 12) for n in range(4)}}, id="three quarters equal"),
        pytest.param({name: ONES[name] for name in ("q0", "q1", "q2", "q3")}, id="few answers"),
    ],
)
def test_other_hand_ins_are_not_reported(work: dict[str, tuple[str, int]]) -> None:
    assert find_nearly_equal([stored("ann", ONES), stored("bob", work)]) == []


def test_two_long_answers_that_differ_are_not_nearly_all_equal() -> None:
    class_ = [stored(who, {**ONES, "q0": (who, 300)}) for who in ("ann", "bob")]
    assert find_nearly_equal(class_) == []


def test_short_code_is_not_reported() -> None:
    short = {name: (digest, 9) for name, (digest, _) in ONES.items()}
    assert find_nearly_equal([stored("ann", short), stored("bob", {**short, "q0": ("other", 9)})]) == []


@pytest.mark.parametrize("name", assignment_names())
def test_honest_classes_are_not_reported(name: str, course: Course) -> None:
    """Each student writes the model solution or another right answer to each question, drawn by chance."""
    template, solution = read_solved(course, name)
    others: dict[str, list[str]] = {}
    for one in variants_of(name):
        if isinstance(one, Right) and len(one.code) == 1:
            ((cell, code),) = one.code.items()
            others.setdefault(cell, []).append(code)
    draw = random.Random(7)
    class_ = []
    for student in range(40):
        cells = [
            NotebookCell(
                cell.id,
                cell.kind,
                draw.choice([solution[cell.id], *others.get(cell.id, ())]) if cell.kind == "answer" else cell.source,
                cell.code,
            )
            for cell in template.cells
        ]
        work = code_fingerprints(cells, {cell.id: cell.source for cell in template.cells})
        class_.append(stored(f"s{student:02}", work))
    reported = {student for group in find_nearly_equal(class_) for student in group.students}
    assert len(reported) <= 0.01 * len(class_), (len(reported), len(class_[0].work))
