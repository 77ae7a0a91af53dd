"""Practice: an instance of every question that has numbers, and its right answer passes its own check."""

import re

import pytest
from one_answer import quietly, solve

from labsid.checks import Question
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.practice import exercise_of, questions_with_practice

WITHOUT = {
    "prelab-1-time", "prelab-3-cut", "prelab-4-matrix",  # their numbers are those of the text
    "prelab-5-original", "prelab-6-cut-off", "step-3-figure", "lab-1b-figure-5", "lab-1c-figure-6",
    "lab-3a-figure-7", "postlab-3-figure-8", "ls-4-figure-5", "ms-6-figure-8", "ri-6-figures", "ai-6-figure-14",
    "gap-8-effect", "gap-8-path", "gap-8-parameters",  # what is right, grading alone can tell
}  # fmt: skip
OF_ANOTHER_RIG = ("gap-7-simulation", "lab-3b-initial-state")
"""Their model solutions hold a model of the notebook's own record."""
QUESTIONS = [
    pytest.param(name, question, id=question.id)
    for name in assignment_names()
    for question in load_assignment(name).questions
    if question.id not in WITHOUT.union(OF_ANOTHER_RIG)
]


@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_the_right_answer_passes(name: str, question: Question, capsys: pytest.CaptureFixture[str]) -> None:
    solved = solve(name)
    with quietly():
        variables = solved.run(question.id, {})
    for number in (1, 2):
        exercise = exercise_of(load_assignment(name), question, number)
        assert exercise is not None
        if exercise.answers:
            exercise.check(**exercise.solution())
        else:
            with quietly():
                call = re.search(r"`(\w+)\(([\w., ]*)\)`", str(exercise))
                assert call is not None
                handed = [getattr(exercise, one.strip().removeprefix("p.")) for one in call[2].split(",")]
                result = variables[call[1]](*handed)
            exercise.check(result)
        assert capsys.readouterr().out.startswith("✓"), exercise


def test_which_questions_cannot_be_practised() -> None:
    """Figures, texts about the notebook's own, and what grading alone can tell."""
    without = {
        question.id
        for name in assignment_names()
        for question in set(load_assignment(name).questions) - set(questions_with_practice(load_assignment(name)))
    }
    assert without == WITHOUT
