"""Hints in stages: the next comes for another answer or after two minutes; the last offers practice and skipping."""

from typing import Any

import pytest
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output

from labsid.checks import Assignment, Question, Verdict, notebook_checks
from labsid.checks.hints import WAIT, Hints
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.question import Stages
from labsid.checks.verdict import Slip, judge

QUESTIONS = [
    pytest.param(name, question.id, id=question.id)
    for name in assignment_names()
    for question in load_assignment(name).questions
]


def gain(ask: Any) -> Verdict:
    slips = [Slip("sign", "the sign is wrong.", lambda: -3, "Turn it."), Slip("half", "it is half.", lambda: 1.5)]
    return judge(ask.value("a"), 3, lambda x, y: x == y, "right.", "not the gain.", slips)


TINY = Assignment("tiny", (Question("q", gain),), stages={"q": Stages("Look at eq. (1).", "Divide by two.")})


def test_the_next_stage_needs_another_answer_or_two_minutes() -> None:
    hints = Hints(TINY)
    assert hints.next("q", ("a = 1",), 0.0, True) == ""
    hints.failed("q", "", ("a",), ("a = 1",), 0.0)
    assert "or in 120 s" in hints.next("q", ("a = 1",), 0.0, True)
    assert "Look at" not in hints.next("q", ("a = 1",), WAIT - 1, True)
    assert hints.next("q", ("a = 1",), WAIT, True) == "Look at eq. (1)."
    assert hints.next("q", ("a = 1",), WAIT + 1, True).startswith("Look at eq. (1). The next hint comes")
    last = hints.next("q", ("a = 2",), WAIT + 2, True)
    assert last.startswith("Divide by two. Practise")
    assert 'check.practice("q")' in last
    assert 'check.skip("q")' in last
    assert hints.next("q", ("a = 2",), WAIT + 3, False).startswith("Divide by two. To go on")


def test_the_mistake_is_corrected_in_the_last_stage() -> None:
    hints = Hints(TINY)
    hints.failed("q", "Turn it.", ("a",), ("a = 1",), 0.0)
    assert "Turn it" not in hints.next("q", ("a = 2",), 0.0, True)
    assert hints.next("q", ("a = 3",), 0.0, True).startswith("Turn it. Divide by two.")


def test_a_question_without_stages_has_a_hint_all_the_same() -> None:
    hints = Hints(Assignment("tiny", (Question("q", gain),)))
    hints.failed("q", "", (), None, 0.0)
    assert "step" in hints.next("q", None, 0.0, False)


def test_in_a_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("labsid.checks.notebook.load_assignment", lambda name: TINY)
    shell = InteractiveShell()
    shell.user_ns["check"] = notebook_checks("tiny", shell.user_ns)

    def said(*cells: str) -> str:
        with capture_output() as captured:
            for cell in cells:
                shell.run_cell(cell)
        return " ".join(str(output) for output in captured.outputs) + captured.stdout

    assert "No check has failed yet" in said("check.hint()")
    assert "the sign is wrong." in said("a = -3", "check('q')")
    assert "The first hint comes" in said("check.hint()")
    said("a = -3 * 1", "check('q')")
    assert "Look at eq. (1)" in said("check.hint()")
    assert "Turn it" not in said("check.hint()")
    said("a = -6 / 2", "check('q')")
    assert "Turn it. Divide by two." in said("check.hint()")
    said("a = 3", "check('q')")
    assert "it is right" in said("check.hint()")


@pytest.mark.parametrize(("name", "question"), QUESTIONS)
def test_every_question_has_stages_that_say_more_each_time(name: str, question: str) -> None:
    stages = load_assignment(name).stages[question]
    assert 15 < len(stages.where) < 400
    assert 15 < len(stages.how) < 500
    assert stages.where[-1] in ".?:"
    assert stages.how[-1] in ".?)"


@pytest.mark.parametrize("name", assignment_names())
def test_no_stage_belongs_to_no_question(name: str) -> None:
    assignment = load_assignment(name)
    assert set(assignment.stages) == {question.id for question in assignment.questions}
