"""Hand-ins of typed-in values, made from the model solution: no marks for what follows from the data."""

from collections.abc import Iterator
from decimal import Decimal

import pytest
from course_work import GradeCode
from one_answer import Solved, solve
from representatives import mostly_exhaustive
from typed_in import typed_in, values_of

from autograder.course.layout import Course
from autograder.judge.hidden_records import TYPED_IN
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.question import FollowsFrom

FEWEST = {
    "lab-identification": 13,
    "postlab-model-order": 7,
    "sim-to-real-gap": 5,
    "step-response": 2,
}
"""Questions whose answers are values that follow from the data."""


def solved_on_the_shared_record(course: Course, name: str) -> Solved:
    record = load_assignment(name).record_file
    return solve(name, "s", None if record is None else (course.data / record).read_bytes())


def judged_by_values(solved: Solved, typed: dict[str, str]) -> Iterator[str]:
    """The questions that follow from the data and whose check reads a typed-in value."""
    ids = list(solved.cells)
    for question in solved.assignment.questions:
        cells = [cell for cell in solved.answer_cells(question.id) if cell in typed]
        values = {name for cell in cells for name in values_of(solved, cell, ids[ids.index(cell) + 1])}
        if question.follows_from is FollowsFrom.DATA and values & solved.names_read(question.id):
            yield question.id


QUICK = [name for name in assignment_names() if name not in ("lab-identification", "sim-to-real-gap")]
"""Everywhere; the demonstration has a hand-in of values typed into the lab."""


@pytest.mark.parametrize("name", mostly_exhaustive(assignment_names(), QUICK))
def test_typed_in_values_earn_nothing_that_follows_from_the_data(
    name: str, course: Course, grade_code: GradeCode
) -> None:
    solved = solved_on_the_shared_record(course, name)
    typed = typed_in(solved)
    asked = list(judged_by_values(solved, typed))
    assert len(asked) == FEWEST.get(name, 0), asked
    if not asked:  # nothing is at stake, and a figure typed in does not have the axes that later cells draw into
        return
    results = grade_code(name, typed)
    assert {one: results[one].score for one in asked if results[one].score} == {}
    assert {results[one].reason for one in asked} <= {TYPED_IN}
    others = [one for one in solved.assignment.questions if one.id not in asked]
    lost = {one.id: results[one.id].reason for one in others if results[one.id].score != results[one.id].max_score}
    assert lost == {}


def test_a_literal_that_is_wrong_costs_its_own_question_alone(course: Course, grade_code: GradeCode) -> None:
    name = "lab-identification"
    solved = solved_on_the_shared_record(course, name)
    typed = {cell: source for cell, source in typed_in(solved).items() if cell.startswith("lab-2b-theta")}
    results = grade_code(name, typed)
    assert [one for one, r in results.items() if r.status != "manual" and r.score != r.max_score] == ["lab-2b-theta"]


def test_with_the_second_record_switched_off_they_count_as_before(course: Course, launcher) -> None:
    name = "postlab-model-order"
    results = GradeCode(course, launcher, second_record=False)(
        name, typed_in(solved_on_the_shared_record(course, name))
    )
    assert all(one.score == one.max_score for one in results.values() if one.status != "manual")
    assert sum((one.score or Decimal(0) for one in results.values()), Decimal(0)) == Decimal("0.9")
