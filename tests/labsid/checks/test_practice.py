"""Practice: an instance of every question that has numbers, and its own check tells right from wrong."""

import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from one_answer import Solved, quietly, solve

from labsid.checks import Question
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.notebook_ask import PUBLIC_SEED
from labsid.checks.practice import Exercise, exercise_of, questions_with_practice
from labsid.checks.practice_records import gap_origin, unaided_rig
from labsid.checks.question import Ask
from labsid.checks.verdict import Verdict
from labsid.rig.switchable.withheld import withheld_rig, withheld_validation_data
from labsid.rig.switchable.withheld_effects import EFFECT_PATHS

WITHOUT = {"prelab-1-time"}  # its numbers are those of the text
NAMES = {"ri-6-figures": ("fig_9", "fig_10")}
"""Of questions that ask for more than what they ask for first."""
OF_ITS_MODEL = "lab-3b-initial-state"
"""Its model solution simulates the model of the notebook, and so has to be run again with the exercise's."""
QUESTIONS = [
    pytest.param(name, question, id=question.id)
    for name in assignment_names()
    for question in load_assignment(name).questions
    if question.id not in WITHOUT
]
NONSENSE: tuple[Any, ...] = (5, "no", True, None, np.zeros(0), np.zeros(1600), float("nan"))
CHANGES: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "zeros": np.zeros_like,
    "times 1.3": lambda x: 1.3 * x,
    "shifted by one": lambda x: np.roll(x, 1, axis=0) if x.ndim else x + 1,
    "transposed": np.transpose,
    "negated": lambda x: ~x if x.dtype == bool else -x,
    "empty": lambda x: x.reshape(-1, *x.shape[1:])[:0],
    "without numbers": lambda x: np.full(x.shape, np.nan),
}
ALSO_RIGHT = {
    ("nl-6-frequency", "negated"),  # a sine and a cosine of -w fit as well
    ("ls-6-all-solutions", "times 1.3 of part 1"), ("ls-6-all-solutions", "negated of part 1"),  # spans the same
    ("ri-10-careless", "times 1.3 of part 1"),  # rounding, which is judged by its order of magnitude
    ("gap-7-simulation", "shifted by one"),  # may still close most of the gap
}  # fmt: skip
WITHIN_A_TOLERANCE = ("step-1-read", "step-6-model")
"""Their times are accepted where the response fits."""


@pytest.mark.parametrize("number", [1, pytest.param(2, marks=pytest.mark.exhaustive)])
@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_the_right_answer_passes_and_a_wrong_one_does_not(
    name: str, question: Question, number: int, capsys: pytest.CaptureFixture[str]
) -> None:
    exercise = exercise_of(load_assignment(name), question, number)
    assert exercise is not None
    right = _right_answer(solve(name), question, exercise, number)
    _check(exercise, right)
    assert capsys.readouterr().out.startswith("✓"), exercise
    wrong = {key: value for key, value in _wrong_answers(exercise, right) if (question.id, key) not in ALSO_RIGHT}
    if question.id in WITHIN_A_TOLERANCE:
        wrong = {key: value for key, value in wrong.items() if not re.match("(tau|td)", key)}
    passed = []
    for key, answer in wrong.items():
        _check(exercise, answer)
        passed += [key] * capsys.readouterr().out.startswith("✓")
    assert passed == []
    assert len(wrong) >= 5


def _check(exercise: Exercise, answer: Any) -> None:
    exercise.check(**answer) if exercise.answers else exercise.check(answer)


def _right_answer(solved: Solved, question: Question, exercise: Exercise, number: int) -> Any:
    """The values by name, or what the function returns."""
    if exercise.answers and exercise.has_solution:
        return exercise.solution()
    if exercise.answers:
        made = _made_by_the_model_solution(solved, question.id, exercise)
        return {name: made[name] for name in NAMES.get(question.id, exercise.answers)}
    if question.id == "gap-7-simulation":
        origin = gap_origin(np.random.default_rng([PUBLIC_SEED, number, *question.id.encode()]))
        return withheld_validation_data(withheld_rig(origin.student, origin.secret))[1]
    with quietly():
        remade = _made_by_the_model_solution(solved, question.id, exercise) if question.id == OF_ITS_MODEL else None
        variables = remade or solved.run(question.id, {})
        call = re.search(r"`(\w+)\(([\w., ]*)\)`", str(exercise))
        assert call is not None
        return variables[call[1]](*[getattr(exercise, one.strip().removeprefix("p.")) for one in call[2].split(",")])


def _wrong_answers(exercise: Exercise, right: Any) -> Iterator[tuple[str, Any]]:
    """Nonsense in place of each value that is asked for, and the right one changed."""
    if not exercise.answers:
        yield from _wrong_results(right)
        parts = right if isinstance(right, tuple) else ()
        for i, part in enumerate(parts):
            for key, wrong in _wrong_results(part):
                yield f"{key} of part {i}", (*parts[:i], wrong, *parts[i + 1 :])
        return
    for name in exercise.answers:
        for key, wrong in _wrong_results(right[name]):
            yield f"{name}: {key}", {**right, name: wrong}


def _wrong_results(right: Any) -> Iterator[tuple[str, Any]]:
    for wrong in NONSENSE:
        if not _same(wrong, right):
            yield f"{wrong!r:.20}", wrong
    for key, change in CHANGES.items():
        changed = _changed(right, change)
        if not _same(changed, right):
            yield key, changed


def _changed(value: Any, change: Callable[[NDArray[Any]], NDArray[Any]]) -> Any:
    if isinstance(value, tuple | list):
        return type(value)(_changed(part, change) for part in value)
    return change(np.asarray(value)) if isinstance(value, int | float | np.number | np.ndarray) else value


def _same(one: Any, other: Any) -> bool:
    """Whether two answers are alike but for their shape, which some checks leave open."""
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(map(_same, one, other))
    numbers = (int, float, np.number, np.ndarray)
    if isinstance(one, numbers) and isinstance(other, numbers):
        return bool(np.size(one) == np.size(other) and np.allclose(np.ravel(one), np.ravel(other)))
    return one is other


def _made_by_the_model_solution(solved: Solved, question: str, exercise: Exercise) -> dict[str, Any]:
    """The variables after the question's own cells were run on what the exercise gives."""
    cells = solved.answer_cells(question)
    variables = solved.run_before(cells[0]) | {name: getattr(exercise, name) for name in exercise.given}
    with quietly(), solved.in_folder():
        for cell in cells:
            exec(solved.cells[cell], variables)
    return variables


def test_a_result_that_the_check_never_judged_gets_no_tick(capsys: pytest.CaptureFixture[str]) -> None:
    """A check that compares two results says nothing about the first alone."""

    def judge(ask: Ask) -> Verdict:
        return Verdict(ask.call("f", 1.0) == ask.call("f", 1.0), "")

    exercise = exercise_of(load_assignment("model-structures"), Question("q", judge), 1)
    assert exercise is not None
    for result in (5, "no", np.zeros(3)):
        exercise.check(result)
        assert capsys.readouterr().out.startswith("✗ this cannot be judged from one result")


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
    """What the text gives whole."""
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


@pytest.mark.parametrize("number", range(1, 5))
def test_the_effect_of_another_rig_can_be_named(number: int, capsys: pytest.CaptureFixture[str]) -> None:
    """Judged as at grading, on the rig that was made for the exercise."""
    assignment = load_assignment("sim-to-real-gap")
    exercise = exercise_of(assignment, assignment.question("gap-8-effect"), number)
    assert exercise is not None
    right = exercise.solution()["effect"]
    assert right not in str(exercise)
    passed = []
    for effect in EFFECT_PATHS:
        exercise.check(effect=effect)
        passed += [effect] * capsys.readouterr().out.startswith("✓")
    assert passed == [right]
