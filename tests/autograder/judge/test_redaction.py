"""What a student is told of what their process said."""

from collections.abc import Callable

import numpy as np
import pytest

from autograder.judge.redaction import numbers_in, redact, redact_error, redact_reason
from labsid.checks.values import Unreadable
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

SOURCE = "def simulate(u):\n    raise ValueError('u is too short')\nclass Answer: pass\ntitle = '(a) Original data'"
WITH = {"x": np.zeros((3, 2)), "y": np.zeros(5)}


def message(code: str) -> dict[str, str]:
    with pytest.raises(Exception) as caught:  # noqa: PT011
        eval(code, {"np": np, **WITH})
    return redact_error({"kind": type(caught.value).__name__, "text": str(caught.value)}, SOURCE)


@pytest.mark.parametrize(
    ("code", "kind", "text"),
    [
        ("x + y", "ValueError", "operands could not be broadcast together"),
        ("x @ y", "ValueError", "mismatch in its core dimension"),
        ("y[12345]", "IndexError", "out of bounds"),
        ("np.linalg.solve(np.zeros((2, 2)), [1, 2])", "LinAlgError", "Singular matrix"),
        ("simulate", "NameError", "name 'simulate' is not defined"),
        ("abcdefgh", "NameError", "…"),
        ("y.simulate", "AttributeError", "no attribute 'simulate'"),
        ("y.abcdefgh", "AttributeError", "…"),
        ("(lambda u: 0)()", "TypeError", "missing 1 required positional argument"),
        ("1 / 0", "ZeroDivisionError", "division by zero"),
        ("int('2.71828')", "ValueError", "…"),
    ],
)
def test_messages_of_python_and_numpy_are_passed_on_without_what_varies(code: str, kind: str, text: str) -> None:
    assert message(code) == {"kind": kind, "text": text}


@pytest.mark.parametrize(
    ("error", "told"),
    [
        ({"kind": "ValueError", "text": "u is too short"}, ("ValueError", "u is too short")),
        ({"kind": "ValueError", "text": "u is too short: 2.71828"}, ("ValueError", "…")),
        ({"kind": "Answer", "text": ""}, ("Answer", "")),
        ({"kind": "TwoSevenOne", "text": "two seven one"}, ("an error", "…")),
        ({"kind": "ValueError"}, ("ValueError", "")),
    ],
)
def test_an_error_is_told_in_the_students_own_words_or_not(error: dict[str, str], told: tuple[str, str]) -> None:
    found = redact_error(error, SOURCE)
    assert (found["kind"], found["text"]) == told


@pytest.mark.parametrize(
    "kind", ["Answer", "function", "range", "TransferFunctionDiscrete", "list of 20000 items", "array of object"]
)
def test_types_that_are_known_are_named(kind: str) -> None:
    value = redact((Unreadable(kind), 1.0), SOURCE)
    assert isinstance(value, tuple)
    assert isinstance(value[0], Unreadable)
    assert value[0].kind == kind


@pytest.mark.parametrize("kind", ["TwoSevenOne", "2.71828", "list of 271828182845 items", "TransferFunctionxyz"])
def test_types_that_are_not_are_not(kind: str) -> None:
    value = redact({"a": Unreadable(kind)}, SOURCE)
    assert isinstance(value, dict)
    assert value["a"].kind == "…"


def test_a_text_can_be_compared_and_not_quoted() -> None:
    told = redact("two seven one", SOURCE)
    assert told == "two seven one"
    assert isinstance(told, str)
    assert f"{told!r} {told[:3]!r} {told[4:]!r}" == "'…' '…' '…'"
    assert repr(redact("(a) Original data", SOURCE)) == "'(a) Original data'"


@pytest.mark.parametrize(
    "made",
    [
        lambda text: text.strip(),
        lambda text: text.strip().lower(),
        lambda text: text.replace("a", "b"),
        lambda text: text + "!",
        lambda text: str(text),
        lambda text: text.split()[0],
        lambda text: text.partition(".")[2],
        lambda text: next(iter(text)),
        lambda text: text[1:].title(),
    ],
)
def test_what_is_made_of_a_redacted_text_cannot_be_quoted(made: Callable[[str], str]) -> None:
    text = redact(" 0.271828 A", SOURCE)
    assert isinstance(text, str)
    assert (f"{made(text)!r}", f"{made(text)}") == ("'…'", "…")


def test_keys_are_redacted_and_still_found() -> None:
    value = redact({"simulate": 1, "2.71828": 2}, SOURCE)
    assert isinstance(value, dict)
    assert value["2.71828"] == 2
    assert [repr(key) for key in value] == ["'simulate'", "'…'"]


@pytest.mark.parametrize(
    ("reason", "told"),
    [
        ("has shape (903, 1); it should have shape (1, 903)", None),
        ("has shape (302, 3) and 303 rows", None),
        ("has shape (302, 3, 303, 304)", "has shape (302, 3, 303, …)"),
        ("has shape (123456789, 271828182)", "has shape (…, …)"),
        ("lab-1c-offsets starts from `y_1`: step 12 of Fig. 14, eq. (7) at 40 %", None),
        ("offset -0.271828 V, at step-3-mse", "offset -… V, at step-3-mse"),
        ("the sampling time is 0.271828 s", "the sampling time is … s"),
        ("the axis runs from 0 to 0.25; `rls(u, y, 0.95, 1e+06)`", None),
        ("it holds nan (at [271828, 3])", "it holds nan (at […, 3])"),
        ("x" * 2000, "x" * 999 + "…"),
    ],
)
def test_numbers_that_could_tell_something_are_not_told(reason: str, told: str | None) -> None:
    assert redact_reason(reason, numbers_in("N = 903", "forgetting 0.95")) == (told or reason)


def test_a_figure_keeps_what_it_shows() -> None:
    curve = CurveValue(np.arange(3.0), np.ones(3), (0.0, 0.0, 1.0), False, "two")
    axes = AxesValue("(a) Original data", "seven", "y", (0.0, 1.0), (0.0, 1.0), True, ("two",), (), (curve,))
    figure = redact(FigureValue((axes,)), SOURCE)
    assert isinstance(figure, FigureValue)
    (seen,) = figure.axes
    assert repr((seen.title, seen.xlabel, seen.legend)) == "('(a) Original data', '…', ('…',))"
    assert (seen.xlabel, seen.legend, seen.curves[0].label) == ("seven", ("two",), "two")
    assert (seen.xlim, seen.grid) == ((0.0, 1.0), True)
    np.testing.assert_array_equal(seen.curves[0].x, curve.x)


def test_numbers_are_passed_on_as_they_are() -> None:
    array = np.arange(3.0)
    assert redact(array, SOURCE) is array
    assert redact(None, "") is None
    assert redact(2.5, "") == 2.5
