"""Practice: an instance of every question that has numbers, and its right answer passes its own check."""

import re

import pytest
from one_answer import quietly, solve

from labsid.checks import Question
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.practice import exercise_of, questions_with_practice

QUESTIONS = [
    pytest.param(name, question, id=question.id)
    for name in assignment_names()
    for question in questions_with_practice(load_assignment(name))
]
WITHOUT = {
    "prelab-1-time",  # the numbers are those of the text
    "prelab-2-noise",
    "gap-8-effect", "gap-8-path", "gap-8-parameters",  # what is right, grading alone knows
}  # fmt: skip


OF_ANOTHER_RIG = ("gap-7-simulation", "lab-3b-initial-state")
"""Their model solutions hold a model of the notebook's own record."""


@pytest.mark.parametrize(("name", "question"), [one for one in QUESTIONS if one.id not in OF_ANOTHER_RIG])
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
