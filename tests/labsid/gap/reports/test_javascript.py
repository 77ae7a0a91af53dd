"""Translation of Python to JavaScript: what it takes, and what it refuses."""

import ast
import math

import numpy as np
import pytest

from labsid._compiled import compiled
from labsid.gap.effects.dynamics import CoulombFriction
from labsid.gap.effects.families import CANDIDATES
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports.javascript.library import Library
from labsid.gap.reports.javascript.models import script, structure
from labsid.gap.reports.javascript.names import UnsupportedSourceError, literal
from labsid.gap.reports.javascript.statements import Statements

STEP = 0.25


def translated(source: str, of_numbers: bool = True) -> str:
    """The JavaScript of one function."""
    (node,) = ast.parse(source).body
    assert isinstance(node, ast.FunctionDef)
    known = {"np": np, "math": math, "STEP": STEP}
    return Statements(node, known, lambda value, member: value.__name__ + member, None, of_numbers).function("f")


@compiled()
def doubled(x: float) -> float:
    """Twice x."""
    return 2.0 * x


def wave(x: float) -> float:
    """A function that calls a compiled one."""
    return doubled(math.sin(x)) + STEP


def test_a_function_brings_what_it_calls_and_constants_by_value() -> None:
    library = Library([])
    assert library.name(wave) == "test_javascript_wave"
    text = str(library)
    assert text.count("function ") == 2
    assert "test_javascript_doubled(Math.sin(x))" in text
    assert "0.25" in text


def test_numbers_get_operators_and_arrays_get_functions() -> None:
    source = "def f(w: FloatArray, c: float):\n    out = np.zeros(w.size)\n    out[1] = c * w[0]\n    return out * c"
    text = translated(source.replace("FloatArray", "'FloatArray'"))
    assert "out[1] = (c * w[0]);" in text
    assert "return np.mul(out, c);" in text
    assert "np.put(out, [1], np.mul(c, np.take(w, [0])));" in translated(
        source.replace("FloatArray", "'FloatArray'"), of_numbers=False
    )


def test_values_are_exchanged_as_in_python() -> None:
    text = translated("def f(a: float, b: float):\n    a, b = b, a\n    return a - b")
    assert text.index("t$0 = b, t$1 = a") < text.index("a = t$0;") < text.index("b = t$1;")


def test_the_end_of_a_loop_is_evaluated_once() -> None:
    text = translated("def f(n: int):\n    for k in range(1, n):\n        n = n - 1\n    return n")
    assert "let i$ = 1, end$ = n; i$ < end$; i$++" in text


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("x = x // 2", "the operator FloorDiv"),
        ("x = x[::2]", "a slice with a step"),
        ("x = lambda: 1", "Lambda"),
        ("x = unknown(x)", "this name"),
        ("x = x.real", "this attribute"),
        ("x.real = 1.0", "this target of an assignment"),
        ("with x: pass", "With"),
        ("x = x not in (1, 2)", "the comparison NotIn"),
        ("x = math", "a class or module as a value"),
        ("x = f'{x:.2f}'", "this format"),
        ("x = x.unknown(1)", "this call"),
    ],
)
def test_what_has_no_translation_is_named_with_its_line(line: str, what: str) -> None:
    with pytest.raises(UnsupportedSourceError, match=f"line 2 of f: {what} has no translation"):
        translated(f"def f(x):\n    {line}", of_numbers=False)


def test_constants() -> None:
    assert [literal(one) for one in (None, True, 2, 0.5, math.inf, -math.inf, 'a"b', (1, None))] == [
        "null",
        "true",
        "2",
        "0.5",
        "Infinity",
        "(-Infinity)",
        '"a\\"b"',
        "[1, null]",
    ]
    assert literal(np.array([[1.0, 2.5]])) == "np.array([1,2.5], [1, 2])"
    with pytest.raises(UnsupportedSourceError, match="a constant"):
        literal(object())


def test_a_script_has_only_the_dynamics_of_its_simulations() -> None:
    linear, mass = (script([Hypothesis(effects)]) for effects in ((), (CoulombFriction("position"),)))
    assert "_states_simulate_mass" in mass
    assert "simulate_tanks" not in linear + mass
    assert "responses__mechanics" not in linear
    assert len(script([Hypothesis((effect,)) for group in CANDIDATES for effect in group])) < 64_000


def test_the_structure_names_places_in_theta() -> None:
    hypothesis = Hypothesis((CoulombFriction("position"),))
    found = structure(hypothesis, 600, 0.5)
    start, stop = found["plant"]["at"]
    assert [one["name"] for one in found["plant"]["self"]["parameters"]] == [
        one.name for one in hypothesis.parameters[start:stop]
    ]
    assert found["delay"] == [0, 1]
