"""Every automatic question: different right answers pass, plausible wrong ones fail with the right hint."""

import re

import pytest
from variants import Right, Wrong, questions_lost, variants_of

from autograder.course.layout import Course, read_template
from labsid.checks.notebook import assignment_names, load_assignment

ASSIGNMENTS = assignment_names()

CASES = [
    pytest.param(name, variant, id=f"{name}: {variant.question}: {variant.name}")
    for name in ASSIGNMENTS
    for variant in variants_of(name)
]


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_every_question_has_enough_variants(name: str) -> None:
    by_question = {question.id: [0, 0] for question in load_assignment(name).questions}
    for variant in variants_of(name):
        by_question[variant.question][isinstance(variant, Wrong)] += 1
    short = {question: counts for question, counts in by_question.items() if counts[0] < 2 or counts[1] < 3}
    assert not short, f"questions with fewer than two right or three wrong variants (right, wrong): {short}"


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_most_wrong_variants_are_named_by_their_slip(name: str) -> None:
    wrong = [variant for variant in variants_of(name) if isinstance(variant, Wrong)]
    assert sum(variant.slip is not None for variant in wrong) >= 0.8 * len(wrong)


@pytest.mark.parametrize(("name", "variant"), CASES)
def test_variant(name: str, variant: Right | Wrong, grade_code) -> None:
    results = grade_code(name, variant.code)
    lost = questions_lost(results)
    if isinstance(variant, Right):
        assert lost == {}
        return
    assert set(lost) == {variant.question}, lost
    got = results[variant.question]
    assert got.score == 0
    assert got.slip == variant.slip, got.reason
    assert re.search(variant.says, got.reason), got.reason


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_the_solution_gets_every_automatic_point(name: str, grade_code) -> None:
    assert questions_lost(grade_code(name, {})) == {}


@pytest.mark.parametrize("name", ASSIGNMENTS)
def test_the_release_gets_none(name: str, course: Course, grade_code) -> None:
    template = read_template(course, name)
    released = {cell.id: cell.source for cell in template.cells if cell.kind in ("answer", "manual")}
    results = grade_code(name, released)
    assert {key for key, r in results.items() if r.status != "manual" and r.score != 0} == set()
    assert {r.status for r in results.values()} <= {"graded", "manual"}
