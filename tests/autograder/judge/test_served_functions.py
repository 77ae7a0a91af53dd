"""Functions of the model solution in a process of their own: plain values, only what is served, a limit of calls."""

import contextlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from autograder.judge import served_functions
from autograder.judge.served_functions import RightFunctions
from autograder.sandbox.isolation import Limits, ProcessLauncher, StudentProcess, StudentProcessError, open_launcher
from autograder.sandbox.replacing import Replacement
from labsid.checks.cells import Cell, Template

LIMITS = Limits(cell_seconds=20, call_seconds=2)
TEMPLATE = Template("tiny", "Tiny", (Cell("given", "given", "import numpy as np\nfactor = 2", True, None),))
FUNCTIONS = {
    "q-double": "def double(x, plus=0):\n    return factor * x + plus",
    "q-solve": "def solve(g, start):\n    theta = np.array(start, float)\n    return theta - g(theta), 'solved'",
    "q-bad": "def endless(x):\n    while True:\n        pass\n\n\ndef ends(x):\n    import os\n    os._exit(1)\n\n\n"
    "def opaque(x):\n    return lambda: x",
}


@pytest.fixture(scope="module")
def launcher() -> Iterator[ProcessLauncher]:
    with open_launcher("none", LIMITS) as opened:
        yield opened


@pytest.fixture
def student(launcher: ProcessLauncher, tmp_path: Path) -> Iterator[StudentProcess]:
    """A process in which all functions but `opaque_2` are served."""
    functions = RightFunctions(TEMPLATE, FUNCTIONS, launcher, tmp_path)
    names = ("double", "solve", "endless", "ends", "opaque")
    with contextlib.closing(functions), contextlib.closing(launcher.start(tmp_path)) as process:
        process.server = partial(functions.reply, student=process, served=set(names))
        assert process.replace(Replacement({"a": 1.0}, {}, (*names, "hidden"))).ok
        yield process


def value(student: StudentProcess, source: str) -> object:
    reply = student.run(f"found = {source}")
    assert reply.ok, reply.error
    return student.value("found").value


def test_values_come_from_the_other_process(student: StudentProcess) -> None:
    assert value(student, "double(3)") == 6
    assert value(student, "double(x=3, plus=1)") == 7
    np.testing.assert_array_equal(value(student, "double(__import__('numpy').ones((2, 1)))"), [[2], [2]])  # type: ignore[arg-type]
    assert value(student, "[double(n) for n in range(3)][2]") == 4
    assert value(student, "'factor' in globals()") is False


def test_a_list_is_handed_over_as_a_list(student: StudentProcess) -> None:
    assert student.run("def kind(x):\n    return type(x).__name__").ok
    assert student.call("kind", [1.0, 2.0]).value == "list"


def test_a_function_among_the_arguments_is_called_back(student: StudentProcess) -> None:
    assert value(student, "solve(lambda theta: theta - 3, [1.0])[0].tolist()[0]") == 3
    assert value(student, "solve(double, [1.0])[1]") == "solved"  # a served one, called back


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("hidden(1)", "no such function is served here"),
        ("double(1, 2, 3)", "takes from 1 to 2 positional arguments"),
        ("double(open('x', 'w'))", "unsupported operand"),
        ("ends(1)", "`ends` did not finish"),
        ("endless(1)", "`endless` did not finish"),
        ("opaque(1)", "cannot be passed on"),
        ("solve(lambda theta: 1 / 0, [1.0])", "division by zero"),
    ],
)
def test_what_fails_is_an_error_in_the_cell(student: StudentProcess, call: str, said: str) -> None:
    reply = student.run(call)
    assert not reply.ok
    assert said in (reply.error or {})["text"]
    assert value(student, "double(3)") == 6


def test_calls_are_limited(student: StudentProcess, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(served_functions, "MAX_CALLS", 5)
    reply = student.run("for n in range(6):\n    last = double(n)")
    assert "serves 5 calls" in (reply.error or {})["text"]
    assert student.value("last").value == 8


def test_a_student_who_ends_while_called_back_is_lost(student: StudentProcess) -> None:
    with pytest.raises(StudentProcessError, match="exit status 3"):
        student.run("import os\nsolve(lambda theta: os._exit(3), [1.0])")


@pytest.mark.parametrize("asks", ["5", "{}", "{'name': 'double', 'arguments': 3, 'keywords': {}}", "{'name': ['x']}"])
def test_a_forged_call_is_refused(student: StudentProcess, asks: str) -> None:
    forged = f"import os, json, struct\npayload = json.dumps({{'asks': {asks}}}).encode()\n"
    forged += "os.write(3, struct.pack('>Q', len(payload)) + payload)\nsize, = struct.unpack('>Q', os.read(3, 8))\n"
    assert student.run(forged + "got = os.read(3, size).decode()").ok
    assert "no such function is served here" in str(student.value("got").value)
