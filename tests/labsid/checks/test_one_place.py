"""The one place of a student's function where another expression makes the answer right."""

import linecache
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np
import pytest

from labsid.checks import one_place as module
from labsid.checks.notebook_ask import NotebookAsk
from labsid.checks.one_place import Functions, Place, find_place

DOUBLED = np.array([2.0, 4.0, 6.0])


def defined(source: str, **variables: Any) -> dict[str, Any]:
    """The variables of a notebook after a cell."""
    name = f"<cell {hash(source)}>"
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    names: dict[str, Any] = {"np": np, **variables}
    exec(compile(source, name, "exec"), names)
    return names


def doubles(functions: Functions) -> bool:
    """Whether `f(3)` is 2, 4, 6, in any function that does not stop."""
    try:
        return np.array_equal(functions["f"](3), DOUBLED)
    except Exception:
        return False


@pytest.mark.parametrize(
    ("source", "line", "part", "repair"),
    [
        (
            "def f(n):\n    return np.array([2.0 * (k - 1) for k in range(n)])\n",
            "return np.array([2.0 * (k - 1) for k in range(n)])",
            "k - 1",
            "k + 1",
        ),
        (
            "def f(n):\n    y = np.sqrt(2.0 * np.arange(1, n + 1))\n    return y\n",
            "y = np.sqrt(2.0 * np.arange(1, n + 1))",
            "np.sqrt(2.0 * np.arange(1, n + 1))",
            "2.0 * np.arange(1, n + 1)",
        ),
        (
            "def f(n):\n    y = np.zeros(n)\n    for k in range(1, n):\n        y[k] = 2 * k + 2\n    return y\n",
            "for k in range(1, n):",
            "range(1, n)",
            "range(0, n)",
        ),
    ],
)
def test_the_place_is_found_and_the_repair_is_right(source: str, line: str, part: str, repair: str) -> None:
    place = find_place(["f"], defined(source), doubles)
    assert place == Place(line, part, repair)
    assert doubles({"f": repaired(source, place)})
    assert f"`{part}`, in `{line}`" in place.said
    assert f"`{repair}`" not in place.said
    assert f"`{repair}`" in place.mend


def repaired(source: str, place: Place) -> Callable[..., Any]:
    """The function of a source in which the repair stands."""
    assert source.count(place.part) == 1
    function = defined(source.replace(place.part, place.repair))["f"]
    assert isinstance(function, FunctionType)
    return function


def test_of_two_mistakes_none_is_named() -> None:
    source = "def f(n):\n    return np.sqrt(3.0 * np.arange(1, n + 1))\n"
    assert find_place(["f"], defined(source), doubles) is None


def test_the_functions_of_the_notebook_stay_as_they_are() -> None:
    variables = defined("def f(n):\n    return np.sqrt(2.0 * np.arange(1, n + 1))\n")
    before = variables["f"](3)
    assert find_place(["f"], variables, doubles) is not None
    np.testing.assert_array_equal(variables["f"](3), before)
    assert set(variables) == {"np", "f", "__builtins__"}


def test_a_function_of_the_same_cell_that_is_called_is_looked_at() -> None:
    step = "def step(k):\n    return np.sqrt(2.0 * k)\n\n\n"
    source = f"{step}def f(n):\n    return np.array([step(k) for k in range(1, n + 1)])\n"
    place = find_place(["f"], defined(source), doubles)
    assert place is not None
    assert place.line == "return np.sqrt(2.0 * k)"


def test_no_more_changes_are_tried_than_there_is_time_for(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[Functions] = []
    monkeypatch.setattr(module, "MOST_CHANGES", 3)
    source = "def f(n):\n    return np.sqrt(3.0 * np.arange(1, n + 1) + 1 + 2 + 3)\n"
    assert find_place(["f"], defined(source), lambda functions: bool(calls.append(functions))) is None
    assert len(calls) == 3


@pytest.mark.parametrize("source", ["f = len\n", "f = lambda n: n\n", "@staticmethod\ndef f(n):\n    return n\n"])
def test_what_is_no_plain_function_is_left_alone(source: str) -> None:
    assert find_place(["f"], defined(source), doubles) is None


@pytest.mark.parametrize(
    ("source", "part", "why"),
    [
        (
            "def f(n):\n    return np.array([4 * (i + 1) // 3 * 1.5 for i in range(n)])\n",
            "//",
            "`//` cuts off",
        ),
        (
            "def f(n):\n    y = np.zeros(1)\n    out = []\n"
            "    for k in range(n):\n        y += 2.0\n        out.append(y)\n"
            "    return np.ravel(out)\n",
            "y += 2.0",
            "`y +=` changes the array itself",
        ),
        (
            "def f(n):\n    y = np.zeros(n, dtype=bool)\n    y[:] = 2.0 * np.arange(1, n + 1)\n    return y\n",
            "dtype=bool",
            "The argument `dtype` is not asked for",
        ),
    ],
)
def test_what_the_expression_does_is_said_where_it_is_known(source: str, part: str, why: str) -> None:
    place = find_place(["f"], defined(source), doubles)
    assert place is not None
    assert part in place.part
    assert place.why.startswith(why)
    assert place.said.endswith(place.why)


def test_a_variable_that_the_cell_makes_with_its_function_is_made_anew() -> None:
    source = "def f(n):\n    return n + 1\n\n\nmade = f(3)\nby_hand = 4\n"
    ask = NotebookAsk(defined(source), None, {}, "any", source)
    changed = {"f": lambda n: 10 * n}
    assert ask.value_with(changed, "made") == 30
    assert ask.value_with(changed, "by_hand") == 4
    assert ask.value_with({}, "made") == 4
