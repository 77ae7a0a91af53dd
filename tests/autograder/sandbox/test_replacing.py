"""Right values set where statements make the wrong ones, under other names too, and functions that the judge serves."""

import types
from typing import Any

import numpy as np
import pytest
from IPython.core.interactiveshell import InteractiveShell

from autograder.sandbox.replacing import Replacement, run_replacing, set_right

WRONG, RIGHT = np.array([1.5, 2.5, 4.5]), np.array([1.0, 2.0, 4.0])
Y = Replacement({"y": RIGHT}, {"y": WRONG})


@pytest.fixture
def shell() -> Any:
    made = InteractiveShell()
    made.showtraceback = made.showsyntaxerror = lambda *args, **kwargs: None  # type: ignore[method-assign]
    made.user_ns["np"] = np
    return made


def serve(name: str) -> Any:
    return lambda *arguments: f"served {name}"


def run(shell: Any, source: str, *replacements: Replacement) -> dict[str, Any]:
    result = run_replacing(shell, source, replacements, serve)
    error = result.error_before_exec or result.error_in_exec
    return {**shell.user_ns, "error": type(error).__name__ if error is not None else None}


@pytest.mark.parametrize(
    "source",
    [
        "y = np.array([1.5, 2.5, 4.5])\nz = 2 * y",
        "y = np.array([9.0, 9.0, 8.0])\ny = np.array([1.5, 2.5, 4.5]); z = 0\nz = 2 * y",
        "y = np.ones(3)\nfor k, v in enumerate([1.5, 2.5, 4.5]):\n    y[k] = v\nz = 2 * y",
        "y = np.array([1, 2, 4.])\ny += 0.5\nz = 2 * y",
        "%matplotlib inline\ny = np.array([\n    1.5,\n    2.5, 4.5])\nz = 2 * y",
        "yd = np.array([1.5, 2.5, 4.5])\nz = 2 * yd\ny = yd",
        "yd = np.array([[1.5], [2.5], [4.5]])\nz = 2 * yd.ravel()\ny = yd.ravel()",
        "d = {}\nd['y'] = np.array([1.5, 2.5, 4.5])\nz = 2 * d['y']\ny = d['y']",
        "signals = [np.zeros(2), np.array([1.5, 2.5, 4.5])]\nz = 2 * signals[1]\ny = signals[1]",
        "z = 2 * y",
        "y = missing + 1\nz = 2 * y",
    ],
)
def test_the_rest_of_the_cell_runs_on_right_values(shell: Any, source: str) -> None:
    shell.register_magic_function(lambda line: None, magic_name="matplotlib")
    made = run(shell, source, Y)
    assert made["error"] is None
    np.testing.assert_array_equal(made["z"], 2 * RIGHT)
    np.testing.assert_array_equal(made["y"], RIGHT)


MADE = "y = np.array([1.5, 2.5, 4.5])\n"
WHOLE = {
    "a function": f"def main():\n    {MADE}    z = 2 * y\n    return y, z\ny, z = main()",
    "global names": f"def main():\n    global y, z\n    {MADE}    z = 2 * y\nmain()",
    "its locals": f"def main():\n    {MADE}    z = 2 * y\n    return locals()\nglobals().update(main())",
    "a nested function": (
        f"def main():\n    def inner():\n        {MADE}        return 2 * y, y\n    return inner()\nz, y = main()"
    ),
    "a coroutine": f"async def main():\n    {MADE}    return 2 * y, y\nz, y = await main()",
    "another name": "def main(raw):\n    s = raw + 0.5\n    return s, 2 * s\ny, z = main(np.array([1, 2, 4.]))",
    "a class": "class A:\n    def run(self):\n        self.y = np.array([1.5, 2.5, 4.5])\n        self.z = 2 * self.y\n"
    "a = A()\na.run()\ny, z = a.y, a.z",
    "a function that cannot make it": "def main():\n    y = absent + 1\n    z = 2 * y\n    return y, z\ny, z = main()",
    "the main guard": f"if __name__ == '__main__':\n    {MADE}    z = 2 * y",
    "with": f"import contextlib\nwith contextlib.nullcontext():\n    {MADE}    z = 2 * y",
    "try": f"try:\n    {MADE}    z = 2 * y\nexcept ValueError:\n    pass",
    "for": f"for _ in range(1):\n    {MADE}    z = 2 * y",
    "while": f"while True:\n    {MADE}    z = 2 * y\n    break",
    "a loop in a function": f"def main():\n    for _ in 'a':\n        {MADE}        return y, 2 * y\ny, z = main()",
    "one line": f"{MADE.strip()}; z = 2 * y",
    "%%time": f"%%time\n{MADE}z = 2 * y",
    "%%capture": f"%%capture kept\n{MADE}z = 2 * y",
}


@pytest.mark.parametrize("style", WHOLE)
def test_all_code_in_one_block_runs_on_right_values(shell: Any, style: str) -> None:
    shell.user_ns["__name__"] = "__main__"
    made = run(shell, WHOLE[style], Y)
    assert made["error"] is None
    np.testing.assert_array_equal(made["z"], 2 * RIGHT)
    np.testing.assert_array_equal(made["y"], RIGHT)


@pytest.mark.parametrize("place", ["{}", "def main():\n    {}\n    return n, passes\nn, passes = main()"])
def test_a_loop_of_several_passes_makes_as_many_of_them(shell: Any, place: str) -> None:
    """A right value in the place of a wrong one, in each pass, would never let it end."""
    indent = "\n" + "    " * ("main" in place)
    loop = "n = passes = 0|while n < 40:|    n = n + 1.0|    passes += 1".replace("|", indent)
    made = run(shell, place.format(loop), Replacement({"n": 5.0}, {"n": 40.0}))
    assert (made["n"], made["passes"]) == (5.0, 40)


def test_a_function_that_the_judge_calls_is_as_written(shell: Any) -> None:
    made = run(shell, f"def double(k):\n    {MADE}    return k * y\nz = double(2)", Y)
    np.testing.assert_array_equal(made["z"], 2 * RIGHT)
    np.testing.assert_array_equal(shell.user_ns["double"](2), 2 * WRONG)
    asked = Replacement({"y": RIGHT}, {"y": WRONG}, kept=frozenset({"double"}))
    made = run(shell, f"def double(k):\n    {MADE}    return k * y\nz = double(2)", asked)
    np.testing.assert_array_equal(made["z"], 2 * WRONG)


def test_an_error_within_a_function_is_the_students_own(shell: Any) -> None:
    run(shell, "def main():\n    y = absent + 1\n    return y", Y)
    with pytest.raises(NameError, match="absent"):
        shell.user_ns["main"]()
    assert (
        run(shell, "def main():\n    k = 1 / 0\n    return k\ny = main()\nk = main()", Y)["error"]
        == "ZeroDivisionError"
    )


def test_other_values_stay(shell: Any) -> None:
    kept = Replacement({"y": RIGHT}, {"y": WRONG}, kept=frozenset({"y_act"}))
    made = run(shell, "y_act = np.array([1.5, 2.5, 4.5])\nraw = y_act\ny = raw\nlevel = 3.0", kept)
    np.testing.assert_array_equal(made["y_act"], WRONG)
    np.testing.assert_array_equal(made["raw"], WRONG)
    np.testing.assert_array_equal(made["y"], RIGHT)
    constant = Replacement({"y": RIGHT, "n": 5.0}, {"y": np.zeros(3), "n": 3.0})
    made = run(shell, "buffer, count = np.zeros(3), 3.0", constant)
    assert (made["buffer"].tolist(), made["count"]) == ([0, 0, 0], 3.0)


@pytest.mark.parametrize(
    ("source", "error"),
    [("x = 1\nx / 0\nz = 3", "ZeroDivisionError"), ("x = (", "SyntaxError"), ("q\nz = 3", "NameError")],
)
def test_what_stops_a_cell_stops_it(shell: Any, source: str, error: str) -> None:
    made = run(shell, source, Y)
    assert made["error"] == error
    assert "z" not in made


def test_a_function_is_served_in_its_place(shell: Any) -> None:
    one = Replacement({}, {}, ("f",))
    made = run(shell, "def f(x):\n    return x\ng = f\nfirst = f(1)\ndef f(x):\n    return -x\nlast = f(1)", one)
    assert (made["first"], made["last"], made["g"](1)) == ("served f", "served f", "served f")
    space = {"f": len, "other": len, "module": types}
    set_right(space, Replacement({"pair": (RIGHT, 2.0)}, {}, ("f",)), serve)
    assert (space["other"]([]), space["pair"][1]) == ("served f", 2.0)  # type: ignore[operator,index]
