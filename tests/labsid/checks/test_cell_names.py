"""The names that a cell assigns and uses."""

import pytest

from labsid.checks.cell_names import assigned_names, parse_python, read_names, used_names


@pytest.mark.parametrize(
    ("source", "assigned"),
    [
        ("a = b = 1", {"a", "b"}),
        ("a, (b, *c) = x", {"a", "b", "c"}),
        ("a += 1", {"a"}),
        ("a[3] = 0\nb.c = 1\nd[0].e[1] = 2", {"a", "b", "d"}),
        ("for i in range(3):\n    total = i", {"i", "total"}),
        ("with open(f) as file:\n    text = file.read()", {"file", "text"}),
        ("import numpy as np, os.path\nfrom math import sin as s", {"np", "os", "s"}),
        ("def f(x):\n    inner = x\n    return inner", {"f"}),
        ("class C:\n    inner = 1", {"C"}),
        ("squares = [k**2 for k in range(3)]\ng = lambda x: x", {"squares", "g"}),
        ("!ls\n%time\na = 1", {"a"}),
        ("a[i] + b", set()),
        ("a = = 1", set()),
    ],
)
def test_assigned(source: str, assigned: set[str]) -> None:
    assert assigned_names(source) == assigned


@pytest.mark.parametrize(
    ("source", "used"),
    [
        ("a = b + c", {"b", "c"}),
        ("a = 1\nprint(a, b)", {"b"}),
        ("def f(x):\n    y = x + offset\n    return len(y)", {"offset"}),
        ("h = [k * gain for k in data]", {"gain", "data"}),
        ("import numpy as np\nnp.sin(t)", {"t"}),
        ("t = = 1", set()),
    ],
)
def test_used(source: str, used: set[str]) -> None:
    assert used_names(source) == used


@pytest.mark.parametrize("source", ["x = " + "-" * 50_000 + "1", "x = " + "(" * 5_000 + ")" * 5_000])
def test_code_that_is_nested_too_deeply_is_no_python(source: str) -> None:
    with pytest.raises(SyntaxError):
        parse_python(source)
    assert assigned_names(source) == used_names(source) == read_names(source) == frozenset()
