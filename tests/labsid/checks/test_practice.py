"""Practice: an instance of every question that has numbers, and its right answer passes its own check."""

import re
from typing import Any

import numpy as np
import pytest
from one_answer import Solved, quietly, solve

from labsid.checks import Question
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.practice import Exercise, exercise_of, questions_with_practice
from labsid.checks.practice_records import unaided_rig

WITHOUT = {
    "prelab-1-time",  # its numbers are those of the text
    "gap-8-effect", "gap-8-path", "gap-8-parameters",  # what is right, grading alone can tell
}  # fmt: skip
NAMES = {"ri-6-figures": ("fig_9", "fig_10")}
"""Of questions that ask for more than what they ask for first."""
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
        if exercise.answers and exercise.has_solution:
            exercise.check(**exercise.solution())
        elif exercise.answers:
            made = _made_by_the_model_solution(solved, question.id, exercise)
            exercise.check(**{name: made[name] for name in NAMES.get(question.id, exercise.answers)})
        else:
            with quietly():
                call = re.search(r"`(\w+)\(([\w., ]*)\)`", str(exercise))
                assert call is not None
                handed = [getattr(exercise, one.strip().removeprefix("p.")) for one in call[2].split(",")]
                result = variables[call[1]](*handed)
            exercise.check(result)
        assert capsys.readouterr().out.startswith("✓"), exercise


def _made_by_the_model_solution(solved: Solved, question: str, exercise: Exercise) -> dict[str, Any]:
    """The variables after the question's own cells were run on what the exercise gives."""
    cells = solved.answer_cells(question)
    variables = solved.run_before(cells[0]) | {name: getattr(exercise, name) for name in exercise.given}
    with quietly(), solved.in_folder():
        for cell in cells:
            exec(solved.cells[cell], variables)
    return variables


@pytest.mark.parametrize("name", assignment_names())
def test_no_right_value_of_the_notebook_is_given(name: str) -> None:
    """Of what earlier questions ask for, an exercise gives only what is right for its own data."""
    solved = solve(name)
    for question in questions_with_practice(load_assignment(name)):
        exercise = exercise_of(load_assignment(name), question, 1)
        assert exercise is not None
        known = solved.known[question.id]
        signals = [one for one in exercise.given if np.size(known.get(one, 0)) > 1 and not isinstance(known[one], str)]
        same = [one for one in signals if np.array_equal(np.asarray(known[one]), np.asarray(getattr(exercise, one)))]
        assert set(same) <= {"t", "t_new"}, (question.id, same)


def test_which_questions_cannot_be_practised() -> None:
    """What the text gives whole, and what grading alone can tell."""
    without = {
        question.id
        for name in assignment_names()
        for question in set(load_assignment(name).questions) - set(questions_with_practice(load_assignment(name)))
    }
    assert without == WITHOUT


def test_a_rig_without_steps_tells_its_effect_and_the_error_of_a_simulation() -> None:
    rigs = [unaided_rig(number) for number in (1, 2)]
    assert [rig.solution()["effect"] for rig in rigs] == ["output-saturation", "sqrt-outflow"]
    for rig in rigs:
        rest = rig.record.y[:100].mean()
        gain = np.sum((rig.record.u - rig.record.u[0]) * (rig.record.y - rest)) / np.sum(
            (rig.record.u - rig.record.u[0]) ** 2
        )
        static = rig.error(lambda u, first=rig.record.u[0], rest=rest, gain=gain: rest + gain * (u - first))
        assert 0.02 < static < rig.error(lambda u, rest=rest: np.full(u.size, rest))
        assert rig.solution()["effect"] not in repr(rig)
