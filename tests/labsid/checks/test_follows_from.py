"""What the answer to each question follows from: the table of the design, question by question."""

import pytest

from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.question import FollowsFrom

BY_EYE = {"step-1-read", "gap-8-effect", "gap-8-path", "gap-8-parameters"}
OWN_RIG = {"gap-7-simulation", "gap-9-closed"}
TEXT = {
    "sev-1-read",
    "lab-1a-sampling-time",
    "prelab-1-time", "prelab-2-noise", "prelab-3-cut", "prelab-4-matrix", "prelab-5-original", "prelab-6-cut-off",
    "step-3-mse", "step-3-figure",
    "ls-4-fits", "ls-4-figure-5",
    "ms-5-example-3-1", "ms-6-predict", "ms-6-figure-8",
    "ri-4-regressors", "ri-5-forgetting", "ri-6-figures",
    "ai-1-tables", "ai-6-rels", "ai-6-figure-14",
    "nl-5-exponential",
}  # fmt: skip


@pytest.mark.parametrize("name", assignment_names())
def test_each_question_says_what_its_answer_follows_from(name: str) -> None:
    expected = {
        **dict.fromkeys(BY_EYE, FollowsFrom.EYE),
        **dict.fromkeys(OWN_RIG, FollowsFrom.OWN_RIG),
        **dict.fromkeys(TEXT, FollowsFrom.TEXT),
    }
    found = {question.id: question.follows_from for question in load_assignment(name).questions}
    assert found == {one: expected.get(one, FollowsFrom.DATA) for one in found}


def test_all_of_the_table_are_questions() -> None:
    there = {question.id for name in assignment_names() for question in load_assignment(name).questions}
    assert there >= BY_EYE | OWN_RIG | TEXT
