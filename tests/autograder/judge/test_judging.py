"""The judge on an assignment of its own: values, functions, death, time, errors carried forward, the reference away."""

import itertools
import os
import re
from collections.abc import Iterator, Mapping
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from autograder.intake.submission import NotebookCell, Submission
from autograder.judge.judging import Assets, judge_submission
from autograder.judge.outcome import QuestionResult
from autograder.sandbox.confine import make_syscall_filter
from autograder.sandbox.isolation import Limits, MachineError, ProcessLauncher, open_launcher
from autograder.sandbox.process_launchers import SpawningLauncher
from labsid.checks.cells import Cell, Template
from labsid.checks.compare import as_number, as_vector, close
from labsid.checks.notebook import NotebookAsk
from labsid.checks.question import Ask, Assignment, Question
from labsid.checks.values import Value
from labsid.checks.verdict import Slip, Verdict, judge


def gain(ask: Ask) -> Verdict:
    slips = [Slip("sign", "Look at the sign.", lambda: -3.0)]
    return judge(as_number("a", ask.value("a")), 3.0, close(1e-9), "Right.", "Not the gain.", slips)


NOT_THE_LINE = "Not the line. All of it is the right result with one constant added."


def line(ask: Ask) -> Verdict:
    x = ask.rng.normal(size=4)
    right = 2 * x + as_number("a", ask.known("a"))
    return judge(as_vector("f(x)", ask.call("f", x), 4), right, close(1e-9), "Right.", "Not the line.")


GAIN = Question("q-gain", gain, lambda ask: {"a": 3.0})
ASSIGNMENT = Assignment("tiny", (GAIN, Question("q-line", line, uses=("q-gain",))))
TEMPLATE = Template(
    "tiny",
    "Tiny",
    (
        Cell("q-gain-answer", "answer", "...", True, None),
        Cell("q-gain", "question", 'check("q-gain")', True, Decimal("0.1")),
        Cell("q-line-answer", "answer", "...", True, None),
        Cell("q-line", "question", 'check("q-line")', True, Decimal("0.2")),
        Cell("q-open", "manual", "*Your answer here*", False, Decimal("0.3")),
    ),
)
LINE = "def f(x):\n    return 2 * x + a"

LIMITS = Limits(cell_seconds=20, call_seconds=20)
HASTY = Limits(cell_seconds=1.5, call_seconds=1.5)


@pytest.fixture(scope="module")
def forked() -> Iterator[ProcessLauncher]:
    """The last level of the ladder, which every system that can fork has."""
    if not hasattr(os, "fork"):
        pytest.skip("this system cannot fork")
    with open_launcher("none", LIMITS) as launcher:
        yield launcher


@pytest.fixture(scope="module")
def best() -> Iterator[ProcessLauncher]:
    """The strongest level that this machine has."""
    with open_launcher("best", LIMITS) as launcher:
        yield launcher


@pytest.fixture(params=["best", "forked", "spawned"])
def either(request: pytest.FixtureRequest) -> ProcessLauncher:
    """Every way to start a student's process; systems that cannot fork have the last alone."""
    if request.param == "spawned":
        return SpawningLauncher(LIMITS)
    return request.getfixturevalue(request.param)


@pytest.fixture
def hasty(forked: ProcessLauncher, monkeypatch: pytest.MonkeyPatch) -> ProcessLauncher:
    """The forking launcher with little patience."""
    monkeypatch.setattr(forked, "limits", HASTY)
    return forked


def grade(
    launcher: ProcessLauncher,
    folder: Path,
    gain_cell: str,
    line_cell: str = LINE,
    text: str = "Because.",
    assignment: Assignment = ASSIGNMENT,
    student: str = "s",
) -> list[QuestionResult]:
    texts: Mapping[str, str] = {"q-gain-answer": gain_cell, "q-line-answer": line_cell, "q-open": text}
    steps = tuple(
        NotebookCell(cell.id, cell.kind, texts.get(cell.id, cell.source), cell.code) for cell in TEMPLATE.cells
    )
    submission = Submission(student, "tiny", "ready", steps, ())
    result = judge_submission(submission, Assets(TEMPLATE, assignment, None, b"secret"), launcher, folder)
    assert [question.question for question in result.results] == ["q-gain", "q-line", "q-open"]
    assert [question.max_score for question in result.results] == [Decimal("0.1"), Decimal("0.2"), Decimal("0.3")]
    assert result.isolation == launcher.level
    return list(result.results)


def test_right_answers_earn_their_points(either: ProcessLauncher, tmp_path: Path) -> None:
    first, second, third = grade(either, tmp_path, "a = 3")
    assert (first.score, second.score, third.score) == (Decimal("0.1"), Decimal("0.2"), None)
    assert (first.status, second.status, third.status) == ("graded", "graded", "manual")
    assert (first.reason, first.slip, first.answer) == ("Right.", None, "a = 3")
    assert (third.reason, third.answer) == ("not yet graded by hand", "Because.")


def test_an_error_is_carried_forward_and_said(forked: ProcessLauncher, tmp_path: Path) -> None:
    first, second, _ = grade(forked, tmp_path, "a = -3")
    assert (first.score, first.slip, first.reason) == (0, "sign", "Look at the sign.")
    assert second.score == Decimal("0.2")
    assert second.reason == "Right. (Judged on the right values of q-gain.)"


def test_an_answer_after_a_missing_one_is_judged_on_right_values(forked: ProcessLauncher, tmp_path: Path) -> None:
    first, second, _ = grade(forked, tmp_path, "pass")
    assert (first.score, second.score) == (0, Decimal("0.2"))
    assert second.reason == "Right. (Judged on the right values of q-gain.)"
    _, second, _ = grade(forked, tmp_path, "pass", "def f(x):\n    return 3 * x + a")
    assert (second.score, second.reason) == (0, "Judged on the right values of q-gain: Not the line.")


def test_the_students_own_value_is_carried_where_it_was_right(forked: ProcessLauncher, tmp_path: Path) -> None:
    """Within the tolerance of the first question, the second is judged on what the student's function will read."""
    first, second, _ = grade(forked, tmp_path, "a = 3 + 2e-9")
    assert (first.score, second.score) == (Decimal("0.1"), Decimal("0.2"))
    assert second.reason == "Right."


def test_a_wrong_function_costs_its_own_question(forked: ProcessLauncher, tmp_path: Path) -> None:
    first, second, _ = grade(forked, tmp_path, "a = 3", "def f(x):\n    return 2 * x")
    assert (first.score, second.score, second.reason) == (Decimal("0.1"), 0, NOT_THE_LINE)


@pytest.mark.parametrize(
    ("cell", "status", "said"),
    [
        (
            "1 / 0",
            "graded",
            r"^Your cell stopped in line 1 with ZeroDivisionError: division by zero\. Something .* There is no var",
        ),
        ("b = 1\n\nb.nosuch", "graded", "in line 3 with AttributeError"),
        ("b = 1\na = (", "graded", r"^Your cell stopped in line 2 with SyntaxError: [^<]*\. There is no variable `a`"),
        ("  a = 3\n b = 4", "graded", "IndentationError: unexpected indent"),
        ("raise ValueError('all wrong.')", "graded", r"ValueError: all wrong\. There"),
        ("raise ValueError", "graded", r"with ValueError\. There"),
        ("raise KeyboardInterrupt", "graded", r"with KeyboardInterrupt\. Look for a loop .* There is no variable"),
        ("raise SystemExit", "graded", r"with SystemExit\. There is no variable"),
        ("exit()", "graded", "There is no variable `a`"),
        ("def deeper():\n    deeper()\ndeeper()", "graded", "RecursionError"),
        ("input('a? ')", "graded", "EOFError"),
        ("pass", "graded", r"^There is no variable `a`"),
        ("a = 'three'", "graded", "should be one number; it is text"),
        ("a = [3, 3]", "graded", r"one number; it is an array of shape \(2,\)"),
        ("a = lambda: 3", "graded", "an object of type function"),
        ("a = float('nan')", "graded", r"^`a` holds nan: check the computation before it"),
        ("a = 10 ** 1000", "graded", "int of too many digits"),
        ("import numpy as np\na = np.zeros(10 ** 7)", "graded", "`a` cannot be read .*too large"),
        ("class A:\n    def __getattr__(self, name):\n        raise RuntimeError\na = A()", "graded", "of type A"),
        ("import numpy as np\na = np.zeros(2 ** 32)", "limit", "MemoryError"),
        ("import os\nos._exit(1)", "crashed", r"did not finish: its process ended with exit status 1\.$"),
        ("import os\nos._exit(0)", "crashed", "ended with exit status 0"),
        ("import os\nos.kill(os.getpid(), 15)", "crashed", "was ended by SIGTERM"),
        ("import os\nos.kill(os.getpid(), 9)", "crashed", "was ended by SIGKILL"),
        ("import os\nos.kill(os.getpid(), 11)", "crashed", "was ended by SIGSEGV"),
        ("import labsid.lab.offset", "graded", r"labsid\.lab is the reference: it cannot be used in an exercise"),
        ("from labsid.lab import arx", "graded", r"labsid\.lab is the reference"),
        ("from labsid.lab.arx import fit_arx", "graded", r"labsid\.lab is the reference"),
        ("import labsid\nlabsid.least_squares", "graded", "has no attribute 'least_squares'"),
        ("import autograder", "graded", "autograder is the reference"),
        ("import autograder.judge.judging", "graded", "is the reference"),
    ],
)
def test_what_goes_wrong_costs_that_question_only(
    forked: ProcessLauncher, tmp_path: Path, cell: str, status: str, said: str
) -> None:
    first, second, third = grade(forked, tmp_path, cell)
    assert (first.score, first.status) == (0, status), first.reason
    assert re.search(said, first.reason), first.reason
    assert "\n" not in first.reason
    assert second.score == Decimal("0.2"), second.reason
    assert third.status == "manual"


def test_a_signal_to_the_parent_costs_its_question_only(either: ProcessLauncher, tmp_path: Path) -> None:
    if isinstance(either, SpawningLauncher) and make_syscall_filter(()) is None:
        pytest.skip("the parent is this test, and nothing here keeps signals from it")
    first, second, _ = grade(either, tmp_path, "import os\nos.kill(os.getppid() or 1, 9)\nos._exit(1)")
    assert first.score == 0
    assert second.score == Decimal("0.2"), second.reason


def test_what_a_check_asks_of_labsid_is_there_for_students(forked: ProcessLauncher, tmp_path: Path) -> None:
    cell = "from labsid import plots, rig\nfrom labsid.records.record import load_record\na = 3"
    assert grade(forked, tmp_path, cell)[0].score == Decimal("0.1")


def test_an_endless_loop_costs_its_question_only(hasty: ProcessLauncher, tmp_path: Path) -> None:
    first, second, _ = grade(hasty, tmp_path, "while True:\n    pass")
    assert (first.score, first.status) == (0, "timeout")
    assert "took longer than 1.5 s" in first.reason
    assert second.score == Decimal("0.2"), second.reason


def test_an_endless_function_costs_its_question_only(hasty: ProcessLauncher, tmp_path: Path) -> None:
    first, second, third = grade(hasty, tmp_path, "a = 3", "def f(x):\n    while True:\n        pass")
    assert (first.score, second.score, second.status) == (Decimal("0.1"), 0, "timeout")
    assert third.status == "manual"


def test_processor_time_is_limited(forked: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forked, "limits", Limits(cell_seconds=60, cpu_seconds=1))
    first, second, _ = grade(forked, tmp_path, "while True:\n    pass")
    assert (first.score, first.status) == (0, "limit")
    assert "more than 1 s of processor time" in first.reason
    assert second.score == Decimal("0.2"), second.reason


def test_the_size_of_files_is_limited(forked: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forked, "limits", Limits(cell_seconds=20, file_bytes=1000))
    then = f"import os\nassert os.path.getsize('full') <= 1000\n{LINE}"
    first, second, _ = grade(forked, tmp_path, "with open('full', 'wb') as file:\n    file.write(bytes(2000))", then)
    assert "OSError" in first.reason
    assert second.score == Decimal("0.2")


def test_a_function_that_ends_its_process_costs_its_own_question(either: ProcessLauncher, tmp_path: Path) -> None:
    first, second, _ = grade(either, tmp_path, "a = 3", "import os\ndef f(x):\n    os._exit(3)")
    assert first.score == Decimal("0.1")
    assert (second.score, second.status) == (0, "crashed")
    assert "ended with exit status 3" in second.reason


@pytest.mark.parametrize(
    ("function", "said"),
    [
        ("f = 3", "There is no function `f`"),
        ("", "There is no function `f`"),
        ("def f(x):\n    return x / nosuch", "`f` stopped with NameError: name 'nosuch' is not defined"),
        ("def f(x):\n    raise SystemExit", r"`f` stopped with SystemExit\.$"),
        ("def f():\n    return 1", "`f` stopped with TypeError"),
        ("def f(x):\n    print(x)", "it is nothing"),
        ("def f(x):\n    return x.reshape(1, -1)", "is a row"),
    ],
)
def test_what_a_function_does_instead_is_said(
    forked: ProcessLauncher, tmp_path: Path, function: str, said: str
) -> None:
    second = grade(forked, tmp_path, "a = 3", function)[1]
    assert (second.score, second.status) == (0, "graded")
    assert re.search(said, second.reason), second.reason


def test_a_function_may_change_its_arguments(forked: ProcessLauncher, tmp_path: Path) -> None:
    cell = "def f(x):\n    x *= 2\n    x += a\n    return x"
    assert grade(forked, tmp_path, "a = 3", cell)[1].score == Decimal("0.2")


def test_a_message_that_the_student_forges_costs_that_question_only(forked: ProcessLauncher, tmp_path: Path) -> None:
    cell = (
        "import gc, socket\n"
        "for it in gc.get_objects():\n"
        "    if isinstance(it, socket.socket) and it.fileno() >= 0:\n"
        "        it.sendall({payload})\n"
    )
    garbage = cell.format(payload="b'\\xff' * 8")
    first, second, _ = grade(forked, tmp_path, garbage)
    assert (first.score, first.status) == (0, "crashed")
    assert second.score == Decimal("0.2"), second.reason
    forged = cell.format(payload=r"b'\0' * 7 + b'\x29' + b'{\"ok\":true,\"figures\":5,\"error\":{\"line\":[]}}'")
    first, _, third = grade(forked, tmp_path, forged)
    assert first.score == 0
    assert third.status == "manual"


def test_a_cell_that_survives_only_once_does_not_take_the_others_with_it(
    forked: ProcessLauncher, tmp_path: Path
) -> None:
    """After a death the cells so far are run again; one that dies then is left out, the rest stands."""
    once = "import os\nif os.path.exists('mark'):\n    os._exit(1)\nopen('mark', 'w').close()"
    cells = TEMPLATE.cells
    steps = (
        NotebookCell(None, "extra", "b = 3", True),
        NotebookCell(None, "extra", once, True),
        NotebookCell(cells[0].id, "answer", "a = b", True),
        NotebookCell(cells[1].id, "question", "", True),
        NotebookCell(None, "extra", "import os\nos._exit(1)", True),
        NotebookCell(cells[3].id, "question", "", True),
        NotebookCell(None, "extra", "def f(x):\n    return 2 * x + b", True),
        NotebookCell(cells[3].id, "question", "", True),
    )
    submission = Submission("s", "tiny", "ready", steps, ())
    results = judge_submission(submission, Assets(TEMPLATE, ASSIGNMENT, None, b"s"), forked, tmp_path).results
    assert [result.status for result in results] == ["graded", "crashed", "graded"]
    assert results[2].score == Decimal("0.2"), results[2].reason


def test_an_untouched_open_question_is_said_to_be(forked: ProcessLauncher, tmp_path: Path) -> None:
    for text in ("*Your answer here*", "  \n"):
        third = grade(forked, tmp_path, "a = 3", text=text)[2]
        assert (third.score, third.status, third.reason) == (0, "manual", "no answer")


@pytest.mark.parametrize("either", ["best", "forked"], indirect=True)
def test_checks_in_the_notebook_do_nothing_while_grading(either: ProcessLauncher, tmp_path: Path) -> None:
    cell = (
        "from labsid.checks import notebook_checks\n"
        "check = notebook_checks('lab-identification', globals())\n"
        "check('q-gain')\n"
        "a = 3"
    )
    first, second, _ = grade(either, tmp_path, cell, "import labsid.lab.regressor")
    assert first.score == Decimal("0.1"), first.reason
    assert "labsid.lab is the reference" in second.reason


def test_output_comes_back_and_a_figure_nobody_asks_for_does_not(forked: ProcessLauncher, tmp_path: Path) -> None:
    cell = "%matplotlib inline\nimport matplotlib.pyplot as plt\nplt.plot([1, 2])\nplt.show()\nprint('drawn')\na = 3"
    first, *_ = grade(forked, tmp_path, cell)
    assert first.score == Decimal("0.1")
    assert first.output == "drawn\n"
    assert first.figures == ()


def test_what_was_printed_before_an_error_comes_back(forked: ProcessLauncher, tmp_path: Path) -> None:
    assert grade(forked, tmp_path, "print('so far')\n1 / 0")[0].output == "so far\n"


def test_output_without_end_is_cut(forked: ProcessLauncher, tmp_path: Path) -> None:
    assert len(grade(forked, tmp_path, "print('x' * 10 ** 7)\na = 3")[0].output) == 20_000


def test_what_a_function_prints_and_draws_of_hidden_inputs_stays_hidden(
    forked: ProcessLauncher, tmp_path: Path
) -> None:
    function = "import matplotlib.pyplot as plt\ndef f(x):\n    print(x)\n    plt.plot(x)\n    return 2 * x + a"
    cells = TEMPLATE.cells
    steps = (
        NotebookCell(cells[0].id, "answer", "a = 3\n" + function, True),
        NotebookCell(cells[3].id, "question", "", True),
        NotebookCell(cells[2].id, "answer", "pass", True),
        NotebookCell(cells[1].id, "question", "", True),
    )
    assignment = Assignment(
        "tiny", (GAIN, Question("q-line", lambda ask: Verdict(bool(np.size(ask.call("f", 1))), "")))
    )
    assets = Assets(TEMPLATE, assignment, None, b"s")
    results = judge_submission(Submission("s", "tiny", "ready", steps, ()), assets, forked, tmp_path).results
    assert all(result.score for result in results)
    assert [(result.output, result.figures) for result in results] == [("", ()), ("", ())]


def test_a_check_that_breaks_takes_nothing_with_it(forked: ProcessLauncher, tmp_path: Path) -> None:
    def broken(ask: Ask) -> Verdict:
        raise RuntimeError("a bug in a check")

    assignment = Assignment("tiny", (Question("q-gain", broken, GAIN.gives), ASSIGNMENT.questions[1]))
    first, second, _ = grade(forked, tmp_path, "a = 3", assignment=assignment)
    assert first.reason == "This answer could not be judged (RuntimeError). Tell your instructor."
    assert second.score == Decimal("0.2")


@pytest.mark.parametrize("cell", ["a = 3", "a = 4"])
def test_right_values_that_cannot_be_made_cost_no_more_than_what_needs_them(
    forked: ProcessLauncher, tmp_path: Path, cell: str
) -> None:
    def broken(ask: Ask) -> dict:
        raise RuntimeError("a bug in the right values")

    assignment = Assignment("tiny", (Question("q-gain", gain, broken), ASSIGNMENT.questions[1]))
    first, second, third = grade(forked, tmp_path, cell, assignment=assignment)
    assert first.reason == ("Right." if cell == "a = 3" else "Not the gain.")
    assert second.reason == "This answer could not be judged (KeyError). Tell your instructor."
    assert third.status == "manual"


def test_the_judge_tries_functions_on_other_inputs_than_the_notebook(forked: ProcessLauncher, tmp_path: Path) -> None:
    seen: list[np.ndarray] = []

    def remember(ask: Ask) -> Verdict:
        seen.append(ask.rng.normal(size=3))
        return Verdict(True, "seen")

    question = Question("q-gain", remember)
    question.verdict(NotebookAsk({}, None, {}, "q-gain"))
    assignment = Assignment("tiny", (question, Question("q-line", remember)))
    for student in ("s", "s", "t"):
        grade(forked, tmp_path, "a = 3", assignment=assignment, student=student)
    assert len(seen) == 7
    notebook, first, other_question, again, _, other_student, _ = seen
    np.testing.assert_array_equal(first, again)
    for other in (notebook, other_question, other_student):
        assert not np.array_equal(first, other)


def test_students_start_from_nothing_but_their_folder(forked: ProcessLauncher, tmp_path: Path) -> None:
    """What one submission leaves in its process is not there for the next."""
    grade(forked, tmp_path, "a = 3\nimport numpy\nnumpy.left_behind = True\nimport builtins\nbuiltins.left = True")
    first, _, _ = grade(forked, tmp_path, "import numpy, os\nassert not hasattr(numpy, 'left_behind')\nleft")
    assert "NameError: name 'left' is not defined" in first.reason
    (tmp_path / "beside.txt").write_text("3", encoding="utf-8")
    assert grade(forked, tmp_path, "a = int(open('beside.txt').read())")[0].score == Decimal("0.1")


def test_a_submission_that_is_not_ready_is_not_run(tmp_path: Path) -> None:
    class Nothing:
        level = "none"

    submission = Submission("s", "tiny", "quarantined", (), ("tiny.ipynb cannot be read", "really"))
    result = judge_submission(submission, Assets(TEMPLATE, ASSIGNMENT, None, b"s"), Nothing(), tmp_path)
    assert [(one.score, one.status) for one in result.results] == [(Decimal(0), "quarantined")] * 3
    assert {one.reason for one in result.results} == {"tiny.ipynb cannot be read; really"}
    assert result.cells == ()


def test_a_process_that_cannot_come_up_is_said(tmp_path: Path) -> None:
    launcher = SpawningLauncher(Limits(start_seconds=0.01))
    with pytest.raises(MachineError, match="did not start"):
        launcher.start(tmp_path)


def walk(
    launcher: ProcessLauncher, folder: Path, *sources: str, assignment: Assignment = ASSIGNMENT
) -> list[QuestionResult]:
    """Grade a notebook in which a cell follows the second question too."""
    first, second, after = sources
    cells = TEMPLATE.cells
    steps = (
        NotebookCell(cells[0].id, "answer", first, True),
        NotebookCell(cells[1].id, "question", "", True),
        NotebookCell(cells[2].id, "answer", second, True),
        NotebookCell(cells[3].id, "question", "", True),
        NotebookCell(None, "extra", after, True),
        NotebookCell(cells[1].id, "question", "", True),
    )
    submission = Submission("s", "tiny", "ready", steps, ())
    return list(judge_submission(submission, Assets(TEMPLATE, assignment, None, b"s"), launcher, folder).results)


WAYS = ("a list", "a file", "shared memory", "the channel's own code")
GIVES = {"waits": None, "is judged at once": lambda ask: {"b": 5.0}}


@pytest.mark.parametrize(
    ("either", "way", "when"),
    # Spawned processes take seconds to start: one way that leaves the process, in two processes.
    [*itertools.product(("best", "forked"), WAYS, GIVES), ("spawned", "a file", "is judged at once")],
    indirect=["either"],
)
def test_no_later_cell_tells_of_hidden_inputs(either: ProcessLauncher, tmp_path: Path, way: str, when: str) -> None:
    """However a function keeps what it is called on: it is called after the cells that print, or in another process."""
    function = """
import mmap, os, sys
kept, shared = [], mmap.mmap(-1, 100)
answers = type(sys.meta_path[0]).find_spec.__globals__["_HANDLERS"]
original = answers["call"]
def spy(shell, request):
    shared[50:54] = b"seen"
    return original(shell, request)
answers["call"] = spy
def f(x):
    kept.append(x)
    shared[:4] = b"seen"
    open("kept", "w").write(repr(x))
    return 2 * x + a
"""
    after = """
import time
time.sleep(0.3)
found = {"a list": bool(kept), "a file": os.path.exists("kept"), "shared memory": shared[0] != 0,
         "the channel's own code": shared[50] != 0}
print("SEEN" if found[%r] else "nothing")
"""
    assignment = Assignment("tiny", (GAIN, Question("q-line", line, GIVES[when], uses=("q-gain",))))
    _, second, last = walk(either, tmp_path, "a = 3", function, after % way, assignment=assignment)
    assert second.score == Decimal("0.2"), second.reason
    assert last.output == "nothing\n"


IN_LETTERS = "def f(x):\n    told = ''.join('abcdefghijk'['.0123456789'.find(c)] for c in f'{abs(x[0]):.9f}')\n    "


@pytest.mark.parametrize(
    ("tell", "said"),
    [
        ("raise ValueError(told)", "`f` stopped with ValueError: …."),
        ("raise ValueError('index out of range ' + told)", "`f` stopped with ValueError: index out of range."),
        ("raise type(told, (Exception,), {})", "`f` stopped with an error."),
        ("return type(told, (), {})()", "`f(x)` should be a vector; it is an object of type …."),
        ("raise ValueError('x is too short')", "`f` stopped with ValueError: x is too short."),
        ("raise type('NotFound', (Exception,), {})", "`f` stopped with NotFound."),
        ("return type('Answer', (), {})()", "`f(x)` should be a vector; it is an object of type Answer."),
    ],
)
def test_errors_and_types_tell_nothing_of_hidden_inputs(
    forked: ProcessLauncher, tmp_path: Path, tell: str, said: str
) -> None:
    assert grade(forked, tmp_path, "a = 3", IN_LETTERS + tell)[1].reason == said


@pytest.mark.parametrize("cell", ["raise ValueError('x' * a)", "exec(compile('\\n' * a + '0 / 0', '<cell>', 'exec'))"])
def test_errors_tell_nothing_of_right_values(forked: ProcessLauncher, tmp_path: Path, cell: str) -> None:
    """After a missing step, in which a = 300 is the right value that is put in its place."""
    slips = Question("q-line", lambda ask: Verdict(False, "Not the line.", "a slip" if ask.value("a") else None))
    other = Assignment("tiny", (Question("q-gain", gain, lambda ask: {"a": 300}), slips))
    wrong = grade(forked, tmp_path, "pass", cell, assignment=other)[1].reason
    assert re.match(r"Judged on the right values of q-gain: Your cell stopped (in line 1 )?with \w+Error\. ", wrong), (
        wrong
    )


def test_the_reason_says_how_to_correct_a_mistake(forked: ProcessLauncher, tmp_path: Path) -> None:
    """In the notebook only a second wrong answer is told; after the hand-in there is no second one."""
    line = Question("q-line", lambda ask: Verdict(False, "Not the line.", "a slip", "Turn it."))
    other = Assignment("tiny", (Question("q-gain", gain, lambda ask: {"a": 3}), line))
    assert grade(forked, tmp_path, "a = 3", "f = 2", assignment=other)[1].reason == "Not the line. Turn it."


def test_calls_do_not_tell_on_what_follows(forked: ProcessLauncher, tmp_path: Path) -> None:
    """A function that counts its calls has not been called when the next cell runs."""
    function = "calls = 0\ndef f(x):\n    global calls\n    calls += 1\n    return 2 * x + a"
    assert walk(forked, tmp_path, "a = 3", function, "print(calls)")[2].output == "0\n"


@pytest.mark.parametrize("either", ["best", "forked"], indirect=True)
def test_a_function_is_judged_though_a_later_cell_dies(either: ProcessLauncher, tmp_path: Path) -> None:
    first, second, last = walk(either, tmp_path, "a = 3", LINE, "import os\nos._exit(1)")
    assert (first.score, second.score) == (Decimal("0.1"), Decimal("0.2"))
    assert (last.score, last.status) == (0, "crashed")


LATER_CELLS = (
    "def f(x):\n    return -x",
    "c = [5]",
    "del c, f",
    "c[0] = 5",
    "d[:] = 5",
    "import os\nc[0] = 5\nos._exit(1)",
    "import numpy\nnumpy.zeros(2 ** 40)",
)


@pytest.mark.parametrize(
    ("either", "after"),
    [*(("forked", later) for later in LATER_CELLS), ("best", "c[0] = 5"), ("spawned", "c[0] = 5")],
    indirect=["either"],
)
def test_a_function_is_judged_as_it_was_at_its_question(either: ProcessLauncher, tmp_path: Path, after: str) -> None:
    """Whatever later cells make of its name, and of what it reads, in place too."""
    function = "import numpy as np\nc, d = [2], np.array([3.0])\ndef f(x):\n    return c[0] * x + d[0]"
    _, second, _ = walk(either, tmp_path, "a = 3", function, after)
    assert second.score == Decimal("0.2"), second.reason


def test_a_function_is_judged_with_the_arrays_that_it_read(forked: ProcessLauncher, tmp_path: Path) -> None:
    """Whatever a later cell does to one number of them."""
    function = "import numpy as np\nread = {'log': [{'values': np.full(3000, 2.0)}], 'offset': 3}\n"
    function += "def f(x):\n    return read['log'][0]['values'][1500] * x + read['offset']"
    for after in ("read['log'][0]['values'][1500] = 5", "read['offset'] = 4"):
        _, second, _ = walk(forked, tmp_path, "a = 3", function, after)
        assert second.score == Decimal("0.2"), second.reason


def test_two_functions_of_one_name_are_judged_each_at_its_question(forked: ProcessLauncher, tmp_path: Path) -> None:
    assignment = Assignment("tiny", (Question("q-gain", line_of_3), Question("q-line", line_of_3)))
    for first, second in (("+ 3", "+ 4"), ("+ 4", "+ 3")):
        cells = [f"def f(x):\n    return 2 * x {end}" for end in (first, second)]
        results = grade(forked, tmp_path, *cells, assignment=assignment)
        assert [bool(result.score) for result in results[:2]] == [first == "+ 3", second == "+ 3"]


def line_of_3(ask: Ask) -> Verdict:
    x = ask.rng.normal(size=4)
    return judge(as_vector("f(x)", ask.call("f", x), 4), 2 * x + 3, close(1e-9), "Right.", "Not the line.")


def test_a_function_that_hangs_costs_its_question_only(hasty: ProcessLauncher, tmp_path: Path) -> None:
    endless = "import time\ndef f(x):\n    while True:\n        time.sleep(9)"
    first, second, last = walk(hasty, tmp_path, "a = 3", endless, "a = 3")
    assert (second.score, second.status) == (0, "timeout")
    assert (first.score, last.score) == (Decimal("0.1"), Decimal("0.1"))


def test_the_whole_submission_has_a_time_limit(
    forked: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(forked, "limits", Limits(cell_seconds=20, submission_seconds=1.5))
    first, second, last = walk(forked, tmp_path, "a = 3", LINE, "import time\ntime.sleep(15)")
    assert (first.score, second.score) == (Decimal("0.1"), Decimal("0.2"))
    assert (last.score, last.status) == (0, "timeout")
    assert "the whole notebook took longer than 1.5 s" in last.reason


def test_the_number_of_cells_is_limited(
    forked: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(forked, "limits", Limits(cells=2))
    first, second, last = walk(forked, tmp_path, "a = 3", LINE, "a = 3")
    assert (first.score, second.score) == (Decimal("0.1"), Decimal("0.2"))
    assert (last.score, last.status) == (0, "limit")
    assert "the notebook has more than 2 cells" in last.reason


def test_all_output_together_is_limited(
    forked: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(forked, "limits", Limits(output_characters=5))
    first, _, last = walk(forked, tmp_path, "a = 3\nprint('one')", LINE, "print('two and more')")
    assert (first.output, last.output) == ("one\n", "t")


@pytest.mark.parametrize("cell", ["print('a is', a)", "raise ValueError(a)", "raise type(f'E{a}', (Exception,), {})"])
def test_a_right_value_that_was_carried_forward_is_not_told(forked: ProcessLauncher, tmp_path: Path, cell: str) -> None:
    """What is shown is of the notebook as it was handed in, in whose process there never is a right value."""
    for answer, shown in (("pass", "a"), ("a = -5", "-5"), ("a = 3", "3")):
        _, second, _ = grade(forked, tmp_path, answer, f"{cell}\ndef f(x):\n    return 0 * x")
        assert second.score == 0
        told = second.output + second.reason.replace("line 1", "")
        assert shown in told
        assert ("3" in told) == (answer == "a = 3")


def _later(ask: Ask, name: str, right: float) -> Verdict:
    return judge(as_number(name, ask.value(name)), right, close(1e-9), "Right.", "Not right.")


def _doubled(ask: Ask) -> dict[str, Value]:
    a = as_number("a", ask.known("a"))
    if a > 100:
        raise ValueError("nothing follows from such a value")
    return {"b": 2 * a}


CHAIN = (
    Question("q-fit", lambda ask: _later_call(ask), lambda ask: {"a": 3.0}),
    Question("q-double", lambda ask: _later(ask, "b", 2 * as_number("a", ask.known("a"))), _doubled, uses=("q-fit",)),
    Question("q-next", lambda ask: _later(ask, "c", as_number("b", ask.known("b")) + 1), uses=("q-double",)),
)


def _later_call(ask: Ask) -> Verdict:
    return judge(as_number("fit()", ask.call("fit")), 3.0, close(1e-9), "Right.", "Not the fit.")


@pytest.mark.parametrize(
    ("second", "score"), [("b = 6.0", "0.1"), ("b = 2 * a", "0.1"), ("b = 'x'", "0"), ("pass", "0")]
)
def test_values_from_which_nothing_follows_leave_no_later_question_without_right_ones(
    forked: ProcessLauncher, tmp_path: Path, second: str, score: str
) -> None:
    """The function of the first is judged after the last cell; until then its wrong value stands for the right one."""
    texts = {"q-fit": "def fit():\n    return 300.0\na = fit()", "q-double": second, "q-next": "c = 7.0"}
    cells = [
        cell
        for name in texts
        for cell in (
            Cell(f"{name}-answer", "answer", "...", True, None),
            Cell(name, "question", f'check("{name}")', True, Decimal("0.1")),
        )
    ]
    template = Template("tiny", "Tiny", tuple(cells))
    steps = tuple(NotebookCell(one.id, one.kind, texts.get(one.id[:-7], one.source), one.code) for one in cells)
    assets = Assets(template, Assignment("tiny", CHAIN), None, b"secret")
    results = judge_submission(Submission("s", "tiny", "ready", steps, ()), assets, forked, tmp_path).results
    assert not [one.reason for one in results if "could not be judged" in one.reason]
    assert [one.score for one in results] == [0, Decimal(score), Decimal("0.1")]
