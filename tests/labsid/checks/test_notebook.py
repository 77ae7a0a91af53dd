"""The checks as a student runs them, on variables and a real record."""

import contextlib
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labsid.checks import CheckFailed, notebook_checks
from labsid.checks.compare import as_figure
from labsid.checks.notebook import NotebookAsk, assignment_names, load_assignment
from labsid.checks.question import Assignment, Question, given_values
from labsid.checks.verdict import NoAnswer, Slip, Verdict, judge
from labsid.records.record import Record, load_record

RED = "\x1b[1;31m✗\x1b[0m"


@pytest.fixture
def tiny(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """An assignment of two questions in the place of the course's; returns the notebook's variables."""

    def gain(ask: Any) -> Verdict:
        if callable(ask.value("a")) or str(ask.value("a")).startswith("Unreadable"):
            return Verdict(False, "judged as a function.", "a function")
        slips = [Slip("sign", "look at the sign.", lambda: -3)]
        return judge(ask.value("a"), 3, lambda x, y: x == y, "the gain is right.", "not the gain.", slips)

    def line(ask: Any) -> Verdict:
        x = ask.rng.normal(size=3)
        right = 2 * x + ask.known("a")
        return Verdict(bool(np.allclose(ask.call("f", x), right)), "judged on a line.")

    assignment = Assignment(
        "tiny", (Question("q-gain", gain, lambda ask: {"a": 3}), Question("q-line", line, uses=("q-gain",)))
    )
    monkeypatch.setattr("labsid.checks.notebook.load_assignment", lambda name: assignment)
    return {}


def stops_at_length(x: np.ndarray) -> np.ndarray:
    raise ValueError("first line\n  second line")


def failure(check: notebook_checks, question: str) -> str:
    """What a failed check shows: the reason, and after it how to go on."""
    with pytest.raises(CheckFailed) as failed:
        check(question)
    lines = failed.value._render_traceback_()
    assert not any("\n" in shown or len(shown) > 110 for shown in lines)
    shown = " ".join("\n".join(lines).replace(RED, "✗").split())
    assert shown == " ".join(f"✗ {failed.value} {failed.value.advice}".split())
    return f"✗ {' '.join(str(failed.value).split())}"


def test_a_right_answer_is_praised(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    tiny["a"] = 3
    check = notebook_checks("tiny", tiny)
    assert check("q-gain") is None
    assert capsys.readouterr().out == "✓ q-gain: the gain is right.\n"


def test_a_wrong_answer_fails_in_one_line(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    check = notebook_checks("tiny", tiny)
    tiny["a"] = 4
    assert failure(check, "q-gain") == "✗ q-gain: not the gain."
    tiny["a"] = -3
    assert failure(check, "q-gain") == "✗ q-gain: look at the sign."
    assert capsys.readouterr().out == ""


def test_a_function_of_the_notebook_without_return_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    from IPython.core.interactiveshell import InteractiveShell

    def figure(ask: Any) -> Verdict:
        as_figure("fig_1", ask.value("fig_1"))
        return Verdict(True, "a figure.")

    monkeypatch.setattr(
        "labsid.checks.notebook.load_assignment", lambda name: Assignment("tiny", (Question("q-figure", figure),))
    )
    shell = InteractiveShell()
    check = notebook_checks("tiny", shell.user_ns)
    shell.run_cell("def draw(y):\n    fig = plt.figure()")
    shell.run_cell("import matplotlib.pyplot as plt\nfig_1 = draw(1)")
    nothing = "✗ q-figure: `fig_1` should be a figure; it is nothing (None), as the result of a function without"
    named = "`draw`, which makes it, returns nothing: end it with `return fig`."
    assert failure(check, "q-figure") == f"{nothing} `return` is. {named}"
    shell.run_cell("fig_1 = None")
    assert named not in failure(check, "q-figure")


def test_jupyter_shows_that_line_and_no_traceback(tiny: dict) -> None:
    """By the way that IPython itself asks an exception how it wants to be shown."""
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import capture_output

    shell = InteractiveShell()
    shell.user_ns["check"] = notebook_checks("tiny", shell.user_ns)
    with capture_output() as captured:
        result = shell.run_cell("check('q-gain')", store_history=False)
    assert isinstance(result.error_in_exec, CheckFailed)
    shown = (captured.stdout + captured.stderr).strip()
    assert shown.splitlines() == [
        f"{RED} q-gain: there is no variable `a` yet. Define it with exactly this name.",
        "  For a hint, run check.hint() in a new cell below.",
    ]


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        pytest.param(["def a():\n    pass\nmissing"], "judged as a function", id="a named mistake in a function"),
        pytest.param(["a = -3\nmissing"], "NameError", id="a value, which may not be finished"),
        pytest.param(["a = 4\nmissing"], "NameError", id="a mistake without a name"),
        pytest.param(["a = -3", "missing\na = 3"], "NameError", id="the cell has not made its answer anew"),
    ],
)
def test_of_a_cell_that_stopped_a_mistake_in_its_answer_is_told_first(tiny: dict, cells: list[str], said: str) -> None:
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import capture_output

    shell = InteractiveShell()
    shell.user_ns["check"] = notebook_checks("tiny", shell.user_ns)
    with capture_output():
        for cell in cells:
            shell.run_cell(cell)
        result = shell.run_cell("check('q-gain')")
    assert said in str(result.error_in_exec)


def test_jupyter_shows_a_right_answer_in_colour(tiny: dict) -> None:
    from IPython.core.displaypub import CapturingDisplayPublisher
    from IPython.core.interactiveshell import InteractiveShell

    shell = InteractiveShell()
    shell.display_pub = CapturingDisplayPublisher()
    shell.user_ns.update(a=3)
    shell.user_ns["check"] = notebook_checks("tiny", shell.user_ns)
    shell.run_cell("check('q-gain')", store_history=False)
    (shown,) = shell.display_pub.outputs
    assert shown["data"]["text/plain"] == "✓ q-gain: the gain is right."
    assert shown["data"]["text/html"].startswith('<span style="color:#1a7f37;font-weight:bold">✓</span> <b>q-gain</b>')
    assert shown["metadata"] == {"labsid": {"question": "q-gain", "state": "right"}}


def test_the_variables_are_read_when_the_check_runs(tiny: dict) -> None:
    check = notebook_checks("tiny", tiny)
    assert "there is no variable `a` yet" in failure(check, "q-gain")
    tiny["a"] = 3
    check("q-gain")


def test_the_order_of_the_questions_is_kept(tiny: dict) -> None:
    tiny.update(a=3, f=lambda x: 2 * x + 3)
    check = notebook_checks("tiny", tiny)
    assert failure(check, "q-line") == "✗ q-line: it starts from q-gain, which is not right yet."
    check("q-gain")
    check("q-line")
    tiny["a"] = 4
    failure(check, "q-gain")
    assert "starts from q-gain" in failure(check, "q-line")


def test_a_skipped_question_goes_on_from_the_references_value(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    tiny.update(a=5, f=lambda x: 2 * x + 3)
    check = notebook_checks("tiny", tiny)
    failure(check, "q-gain")
    with pytest.raises(CheckFailed) as failed:
        check("q-line")
    assert 'check.skip("q-gain")' in failed.value.advice
    check.skip("q-gain")
    assert tiny["a"] == 3
    check("q-gain")
    check("q-line")
    said = capsys.readouterr().out.splitlines()
    assert said == [
        "– q-gain: skipped. It earns no marks. The notebook now has the reference's `a`.",
        "– q-gain: you went on from the reference's value. It earns no marks.",
        "✓ q-line: judged on a line.",
    ]
    tiny["a"] = 4
    assert failure(check, "q-gain") == "✗ q-gain: not the gain."
    check("q-line")


def test_an_answer_after_a_skip_earns_its_marks(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    check = notebook_checks("tiny", tiny)
    check.skip("q-gain")
    tiny["a"] = 3.0
    check("q-gain")
    check.skip("q-gain")
    assert capsys.readouterr().out.splitlines()[1:] == [
        "✓ q-gain: the gain is right.",
        "✓ q-gain: it is right; nothing is skipped.",
    ]


def test_what_a_skipped_question_starts_from_is_skipped_with_it(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    check = notebook_checks("tiny", tiny)
    check.skip("q-line")
    assert capsys.readouterr().out.splitlines() == [
        "– q-gain: skipped. It earns no marks. The notebook now has the reference's `a`.",
        "– q-line: skipped. It earns no marks. It sets no variable for later steps.",
    ]


def test_a_function_without_end_is_stopped(tiny: dict, monkeypatch: pytest.MonkeyPatch) -> None:
    def f(x: np.ndarray) -> np.ndarray:
        while True:
            with contextlib.suppress(Exception):
                x = x + 0

    monkeypatch.setattr("labsid.checks.notebook_ask.CALL_SECONDS", 0.2)
    tiny.update(a=3, f=f)
    check = notebook_checks("tiny", tiny)
    check("q-gain")
    assert "`f` did not come to an end within 0.2 s" in failure(check, "q-line")


def test_the_summary_without_a_notebook_names_every_question(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    tiny["a"] = 3
    check = notebook_checks("tiny", tiny)
    check("q-gain")
    check.summary()
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines[2][:2] == ["✓", "q-gain"]
    assert lines[3][:2] == ["·", "q-line"]


def test_a_later_step_starts_from_the_value_that_passed(tiny: dict) -> None:
    tiny.update(a=3, f=lambda x: 2 * x + 3)
    check = notebook_checks("tiny", tiny)
    check("q-gain")
    del tiny["a"]
    check("q-line")


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (None, "there is no function `f` yet. Define it with `def f(...):`."),
        (3, "there is no function `f` yet"),
        (lambda: 1, "`f` stopped with TypeError"),
        (lambda x: x / nosuch, "`f` stopped with NameError: name 'nosuch' is not defined"),  # type: ignore[name-defined]  # noqa: F821
        (stops_at_length, "`f` stopped with ValueError: first line second line"),
        (lambda x: 2 * x, "judged on a line."),
    ],
)
def test_what_is_wrong_with_a_function_is_said(tiny: dict, function: Any, said: str) -> None:
    tiny.update(a=3, f=function)
    check = notebook_checks("tiny", tiny)
    check("q-gain")
    assert said in failure(check, "q-line")


def test_a_name_that_is_nearly_there_is_asked_about() -> None:
    def cut_of() -> None: ...

    ask = NotebookAsk({"T": 1.0, "thetahat": 2.0, "y": 3.0, "mse_1": 4.0, "cut_of": cut_of}, None, {"y": 3.0}, "q")
    for name, near in (("t", "T"), ("theta_hat", "thetahat"), ("Y", ""), ("mse_2", ""), ("cut_off", "")):
        with pytest.raises(NoAnswer) as missing:
            ask.value(name)
        assert str(missing.value).endswith(
            f"There is `{near}`: is that meant? Capital and small letters differ." if near else "this name."
        )
    for name, near in (("cut_off", "cut_of"), ("fit", "")):
        with pytest.raises(NoAnswer) as missing:
            ask.call(name)
        assert str(missing.value).endswith(f"There is `{near}`: is that meant?" if near else "`def fit(...):`.")


def test_a_function_cannot_change_the_inputs_of_the_check(tiny: dict) -> None:
    def f(x: np.ndarray) -> np.ndarray:
        x *= 2
        x += 3
        return x

    tiny.update(a=3, f=f)
    check = notebook_checks("tiny", tiny)
    check("q-gain")
    check("q-line")


def test_functions_are_tried_on_the_same_inputs_each_time() -> None:
    first, again, other = (NotebookAsk({}, None, {}, name).rng.normal() for name in ("q", "q", "p"))
    assert first == again != other


def test_what_is_not_there_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tiny: dict) -> None:
    check = notebook_checks("tiny", tiny)
    with pytest.raises(ValueError, match=r"tiny has no question 'q-gian'; it has q-gain, q-line\."):
        check("q-gian")
    with pytest.raises(ValueError, match="no data file"):
        _ = NotebookAsk({}, None, {}, "q").record
    monkeypatch.undo()
    with pytest.raises(ValueError, match=r"no assignment 'lab-1'; there are .*lab-identification.*prelab-sinusoids"):
        notebook_checks("lab-1", {})
    monkeypatch.chdir(tmp_path)
    missing = r"SysIdenData_StudentVersion\.mat is not in .*\. Copy your data file into the folder of this notebook\."
    with pytest.raises(ValueError, match=missing):
        notebook_checks("lab-identification", {})
    Path("SysIdenData_StudentVersion.mat").write_bytes(b"not a record")
    with pytest.raises(ValueError, match=r"SysIdenData_StudentVersion\.mat"):
        notebook_checks("lab-identification", {})


def test_given_values_are_the_students_own_where_the_answer_passed() -> None:
    question = Question("q", lambda ask: Verdict(True, ""), lambda ask: {"a": 3, "b": 4})
    ask = NotebookAsk({"a": 3.0001}, None, {}, "q")
    assert given_values(question, ask, passed=True) == {"a": 3.0001, "b": 4}
    assert given_values(question, ask, passed=False) == {"a": 3, "b": 4}
    assert given_values(Question("q", question.judge), ask, passed=True) == {}


def test_no_answer_is_a_failed_verdict() -> None:
    def nothing(ask: Any) -> Verdict:
        raise NoAnswer("`a` is a row.", "a row instead of a column")

    verdict = Question("q", nothing).verdict(NotebookAsk({}, None, {}, "q"))
    assert verdict == Verdict(False, "`a` is a row.", "a row instead of a column")


# ---- verdicts


def verdict_of(got: float, slips: list[Slip]) -> Verdict:
    return judge(got, 3.0, lambda x, y: abs(x - y) < 1e-6, "Right.", "Wrong.", slips)


def test_a_slip_is_named_only_where_it_explains_the_answer() -> None:
    slips = [Slip("sign", "Look at the sign.", lambda: -3.0), Slip("half", "Look at the half.", lambda: 1.5)]
    assert verdict_of(3.0, slips) == Verdict(True, "Right.")
    assert verdict_of(-3.0, slips) == Verdict(False, "Look at the sign.", "sign")
    assert verdict_of(1.5, slips) == Verdict(False, "Look at the half.", "half")
    assert verdict_of(2.0, slips) == Verdict(False, "Wrong.", None)


def test_a_slip_that_cannot_be_made_on_this_record_is_passed_over() -> None:
    def unmakeable(error: Exception) -> Any:
        def wrong() -> float:
            raise error

        return wrong

    last = Slip("half", "Look at the half.", lambda: 1.5)
    for error in (ValueError(), IndexError(), ZeroDivisionError(), np.linalg.LinAlgError()):
        assert verdict_of(1.5, [Slip("x", "", unmakeable(error)), last]).slip == "half"


def test_a_slip_that_gives_the_right_value_is_none() -> None:
    close_by = Slip("close by", "It is no slip here.", lambda: 3.0 + 0.8e-6)
    assert verdict_of(3.0 + 1.5e-6, [close_by]) == Verdict(False, "Wrong.", None)


# ---- the course's own


def test_every_assignment_of_the_course_has_a_name_of_its_module() -> None:
    names = assignment_names()
    assert {"prelab-sinusoids", "lab-identification"} <= set(names)
    for name in names:
        assert load_assignment(name).name == name


@pytest.fixture
def record(shipped_record_path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Record:
    shutil.copy(shipped_record_path, tmp_path)
    monkeypatch.chdir(tmp_path)
    return load_record(shipped_record_path)


def test_the_labs_first_check_on_its_record(record: Record, capsys: pytest.CaptureFixture[str]) -> None:
    variables: dict[str, Any] = {}
    check = notebook_checks("lab-identification", variables)
    assert "there is no variable `t` yet" in failure(check, "lab-1a-extract")
    variables.update(t=record.t, u_act=record.u, y_act=record.y_noise_reduced, y_actm=record.y_measured)
    check("lab-1a-extract")
    assert capsys.readouterr().out.startswith("✓ lab-1a-extract")
    variables["y_act"], variables["u_act"] = variables["u_act"], variables["y_act"]
    failure(check, "lab-1a-extract")


def test_a_record_of_ones_own_takes_the_place_of_the_courses(record: Record, shipped_record_path: Path) -> None:
    Path("SysIdenData_StudentVersion.mat").rename("mine.mat")
    for path in ("mine.mat", Path("mine.mat"), shipped_record_path):
        variables: dict[str, Any] = {}
        check = notebook_checks("lab-identification", variables, record=path)
        variables.update(t=record.t, u_act=record.u, y_act=record.y_noise_reduced, y_actm=record.y_measured)
        check("lab-1a-extract")
