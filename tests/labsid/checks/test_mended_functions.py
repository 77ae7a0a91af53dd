"""Repairs are tried in copies of a student's functions: the notebook stays as it is."""

import linecache
from typing import Any

import numpy as np
import pytest

from labsid.checks.function_reads import numbers_beside, reads_beside
from labsid.checks.mended_functions import Mend, assigned_by, mended, mended_value
from labsid.checks.module_names import module_of
from labsid.checks.relations import relation
from labsid.checks.verdict import judge

CELL = """\
calls = []

def twice(x):
    calls.append(x)
    return x + x

def fit(Phi, Y):
    n = twice(2)
    G = Phi.T @ Phi
    return np.linalg.inv(G) @ Phi @ Y
"""
PHI, Y = np.arange(10.0).reshape(5, 2) ** 2, np.arange(5.0)
LINE = "return np.linalg.inv(G) @ Phi @ Y"


def notebook(source: str = CELL) -> dict[str, Any]:
    variables: dict[str, Any] = {"np": np}
    linecache.cache["<mended test>"] = (len(source), None, source.splitlines(keepends=True), "<mended test>")
    exec(compile(source, "<mended test>", "exec"), variables)
    return variables


def test_a_line_is_mended_in_a_copy() -> None:
    variables = notebook()
    function = mended("fit", Mend(LINE, "Phi", "Phi.T"), variables)
    assert function is not None
    np.testing.assert_allclose(function(PHI, Y), np.linalg.lstsq(PHI, Y)[0])
    with pytest.raises(ValueError, match="core dimension"):
        variables["fit"](PHI, Y)


def test_a_function_that_is_called_is_mended_too() -> None:
    function = mended("fit", Mend("return x + x", "x + x", "1 / 0"), notebook())
    assert function is not None
    with pytest.raises(ZeroDivisionError):
        function(PHI, Y)


@pytest.mark.parametrize(
    ("name", "mend", "source"),
    [
        ("fit", Mend(LINE, "W", "Phi.T"), CELL),  # the part is not in the line
        ("fit", Mend("return 0", "0", "1"), CELL),  # no such line
        ("nothing", Mend(LINE, "Phi", "Phi.T"), CELL),
        ("fit", Mend("x = 2", "2", "3"), "def fit(y):\n    x = 2\n    x = 2\n    return x * y\n"),  # in two places
        ("fit", Mend("return y + 1", "1", "2"), "@(lambda f: f)\ndef fit(y):\n    return y + 1\n"),  # may be more
        ("fit", Mend("return y + 1", "1", "2 +"), "def fit(y):\n    return y + 1\n"),
    ],
)
def test_what_cannot_be_told_apart_is_not_mended(name: str, mend: Mend, source: str) -> None:
    assert mended(name, mend, notebook(source)) is None


def test_an_assignment_is_computed_and_not_carried_out() -> None:
    variables = {"np": np, "Phi": PHI, "Y": Y}
    mend = Mend("theta = np.linalg.solve(Phi.T @ Phi, Y)", "Y", "Phi.T @ Y")
    assert assigned_by(mend) == "theta"
    np.testing.assert_allclose(mended_value(mend, variables), np.linalg.lstsq(PHI, Y)[0])
    assert set(variables) == {"np", "Phi", "Y"}


@pytest.mark.parametrize("line", ["a, b = Y", "a = b = Y", "print(Y)", "a[0] = Y", "a = (b := Y)", "a = ("])
def test_only_an_assignment_to_one_variable_is_computed(line: str) -> None:
    assert assigned_by(Mend(line, "Y", "Phi")) == ""
    with pytest.raises(ValueError, match="assigns no variable"):
        mended_value(Mend(line, "Y", "Phi"), {"Y": Y})


def test_a_name_of_scipy_is_said_where_arrays_have_no_such_part() -> None:
    assert module_of("t", "q = t.ppf(0.95, 5)", False) == "It is a distribution of scipy: `scipy.stats.t.ppf`."
    assert module_of("t", "q = t.mean()", False) == ""
    assert module_of("w", "q = w.ppf(0.95, 5)", False) == ""
    assert module_of("la", "x = la.solve(A, b)", False) == "It is a part of numpy: `np.linalg.solve`."
    assert module_of("la", "x = la.ppf(A, b)", False) == ""


def test_numbers_and_arguments_that_a_function_does_not_take_are_named() -> None:
    names: dict[str, Any] = {"y_end": 3.3, "n": 4}
    source = "def own(y):\n return y * y_end\ndef count(y):\n return y * n\ndef anew(y, v):\n v = 2\n return y * v\n"
    source += "def branch(y, v):\n if y:\n  v = 2\n return y * v\n"
    exec(source, names)
    assert "reads `y_end`, which is no argument" in numbers_beside("own", names["own"], names)
    assert numbers_beside("count", names["count"], names) == ""
    assert "sets its argument `v` before it reads it" in reads_beside("anew", names["anew"], names)
    assert reads_beside("branch", names["branch"], names) == ""


def test_how_a_part_is_related_to_the_right_one_is_said_of_the_part() -> None:
    right = np.array([1.0, 2.0, 4.0])

    def same(a: Any, b: Any) -> bool:
        return bool(np.allclose(a, b))

    assert relation(1.7 * right, right, same) == "All of it is the right result times one factor."
    of_part = relation(1.7 * right, right, same, "`upper - theta`")
    assert of_part == "Of `upper - theta` holds: all of it is the right result times one factor."
    assert judge(1.7 * right, right, same, "", "Wrong.", of=None).reason == "Wrong."
