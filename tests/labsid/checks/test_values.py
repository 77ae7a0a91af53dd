"""Whatever a student's variable is becomes plain data, or says what it is not."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import control
import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from labsid.checks.values import MAX_ITEMS, StateSpaceValue, TransferFunctionValue, Unreadable, plain
from labsid.plots.figure_values import FigureValue

TS = 0.75


@pytest.mark.parametrize("value", [None, True, 3, -1.5, 2j, "text", float("inf")])
def test_plain_values_stay_as_they_are(value: Any) -> None:
    assert plain(value) is value


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (np.float64(1.5), 1.5), (np.int8(3), 3), (np.uint64(2**63 - 1), 2**63 - 1),
        (np.bool_(True), True), (np.complex128(1j), 1j), (np.str_("a"), "a"),
    ],
)  # fmt: skip
def test_numpy_scalars_become_pythons_own(value: Any, expected: Any) -> None:
    got = plain(value)
    assert got == expected
    assert type(got) is type(expected)


@pytest.mark.parametrize("value", [np.float32(0.1), np.float16(0.1), np.complex64(0.1)])
def test_numbers_of_single_precision_keep_their_type(value: Any) -> None:
    got = plain(value)
    assert got.dtype == value.dtype
    assert got.shape == ()


def test_a_column_of_a_table_is_an_array() -> None:
    """Whatever offers itself as an array, such as what pandas reads."""

    class Column:
        def __init__(self, *numbers: object) -> None:
            self.numbers = np.array(numbers)

        def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
            return self.numbers

    np.testing.assert_array_equal(plain(Column(1.0, 2.0)), [1, 2])
    np.testing.assert_array_equal(plain((Column(1, 2), Column(3, 4))), [[1, 2], [3, 4]])
    assert plain(Column("a", None)).kind == "array of object"


@pytest.mark.parametrize("value", [np.longdouble("1.5"), np.clongdouble(1.5)])
def test_scalars_that_python_does_not_have_become_arrays(value: Any) -> None:
    got = plain(value)
    assert isinstance(got, np.ndarray)
    assert got.shape == ()
    assert got == value


@pytest.mark.parametrize(
    "value",
    [np.arange(3), np.zeros((0, 2)), np.array(2.0), np.array([[1j]]), np.array([True]), np.asfortranarray(np.eye(2))],
)
def test_arrays_of_numbers_are_copied(value: np.ndarray) -> None:
    got = plain(value)
    assert isinstance(got, np.ndarray)
    assert got is not value
    assert got.dtype == value.dtype
    np.testing.assert_array_equal(got, value)


def test_subclasses_of_arrays_become_arrays() -> None:
    for value in (np.ma.masked_array([1.0, 2.0], [0, 1]), np.array([1.0, 2.0]).view(np.recarray)):
        assert type(plain(value)) is np.ndarray


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (np.array(["a"]), "array of <U1"),
        (np.array([object()]), "array of object"),
        (np.array(["2020-01-01"], dtype="M8[D]"), "array of datetime64[D]"),
        (np.datetime64("2020-01-01T00:00:00.000000001"), "datetime64"),
        (np.void(b"abc"), "void"),
        (10**1000, "int of too many digits"),
        (-(2**63), "int of too many digits"),
        ({1: 2}, "dict"),
        ({str(i): i for i in range(MAX_ITEMS + 1)}, "dict"),
        (b"bytes", "bytes"),
        ({1, 2}, "set"),
        (Fraction(1, 2), "Fraction"),
        ((i for i in range(3)), "generator"),
        (iter([1]), "list_iterator"),
        (map(abs, [1]), "map"),
        (print, "builtin_function_or_method"),
        (object(), "object"),
        (int, "type"),
    ],
)
def test_what_is_no_plain_data_is_unreadable_and_says_its_kind(value: Any, kind: str) -> None:
    got = plain(value)
    assert isinstance(got, Unreadable)
    assert got.kind == kind


def test_a_generator_is_left_as_it_is() -> None:
    """The student may want to use it in the next cell."""
    generator = (i for i in range(3))
    plain(generator)
    assert list(generator) == [0, 1, 2]


@pytest.mark.parametrize(
    "value",
    [
        [1, 2, 3],
        (1.0, 2.0),
        range(3),
        [[1, 2], [3, 4]],
        [np.array([1.0]), np.array([2.0])],
        [np.float64(1), 2],
        [],
        [[]],
    ],
)
def test_sequences_of_numbers_become_arrays(value: Any) -> None:
    got = plain(value)
    assert isinstance(got, np.ndarray)
    np.testing.assert_array_equal(got, np.array(value))


def test_ragged_and_mixed_lists_stay_sequences() -> None:
    ragged = plain([[1, 2], [3]])
    assert isinstance(ragged, tuple)
    assert [part.tolist() for part in ragged] == [[1, 2], [3]]
    assert plain(["a", 1, None]) == ("a", 1, None)
    mixed = plain([np.zeros(2), np.zeros((2, 2))])
    assert [part.shape for part in mixed] == [(2,), (2, 2)]
    with_object = plain([1, object()])
    assert with_object[0] == 1
    assert isinstance(with_object[1], Unreadable)


def test_dictionaries_keep_their_keys() -> None:
    got = plain({"u": [1, 2], "inner": {"Ts": TS}})
    assert list(got) == ["u", "inner"]
    np.testing.assert_array_equal(got["u"], [1, 2])
    assert got["inner"] == {"Ts": TS}


def test_depth_and_length_have_an_end() -> None:
    endless: list[Any] = []
    endless.append(endless)
    got = plain(endless)
    for _ in range(6):
        (got,) = got
    assert isinstance(got, Unreadable)
    assert got.kind == "deeply nested data"
    deep: Any = {"a": 1}
    for _ in range(10):
        deep = {"a": deep}
    assert isinstance(plain(deep)["a"]["a"]["a"]["a"]["a"]["a"], Unreadable)
    long = plain(["a"] * (MAX_ITEMS + 1))
    assert isinstance(long, Unreadable)
    assert long.kind == f"list of {MAX_ITEMS + 1} items"


class RaisesOnAnyAttribute:
    def __getattr__(self, name: str) -> Any:
        raise RuntimeError("no")


class ClaimsToBeAnArray:
    __class__ = np.ndarray  # type: ignore[assignment]


class LongerThanItSays(list):
    def __len__(self) -> int:
        raise RuntimeError("no")


class BreaksAsAnArray:
    def __array__(self, *arguments: Any, **named: Any) -> Any:
        raise RuntimeError("no")


class ClaimsToBeAFigure:
    savefig = 1
    axes = 5


class SystemWithAStrangeClock:
    num = den = (1.0,)
    dt = "fast"


class SystemOfWords:
    num = den = "words"
    dt = 1


class StateSpaceOfWords:
    A = B = C = D = "words"
    dt = 1


class LiesAboutItsKind(np.ndarray):
    @property
    def dtype(self) -> Any:
        return np.dtype(float)


class EqualToEverything:
    def __eq__(self, other: object) -> bool:
        return True

    def __hash__(self) -> int:
        return 0

    def __array_function__(self, *arguments: Any) -> Any:
        return True


@pytest.mark.parametrize(
    "value",
    [
        RaisesOnAnyAttribute(), ClaimsToBeAnArray(), LongerThanItSays([1, "a"]), [BreaksAsAnArray()],
        ClaimsToBeAFigure(), SystemWithAStrangeClock(), SystemOfWords(), StateSpaceOfWords(),
        np.array([object()], dtype=object).view(LiesAboutItsKind), EqualToEverything(),
    ],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_objects_that_lie_are_unreadable(value: Any) -> None:
    assert isinstance(plain(value), Unreadable)


def test_subclasses_that_lie_about_equality_are_read_as_data() -> None:
    class Liar(np.ndarray):
        def __eq__(self, other: object) -> bool:  # type: ignore[override]
            return True

        def __array_function__(self, *arguments: Any, **named: Any) -> Any:
            return True

    got = plain(np.array([1.0, 2.0]).view(Liar))
    assert type(got) is np.ndarray
    assert not np.array_equal(got, [1.0, 3.0])


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary() | st.complex_numbers(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text() | st.integers(), inner) | st.tuples(inner, inner),
        max_leaves=20,
    )
)
def test_plain_takes_anything(value: Any) -> None:
    def check(got: Any) -> None:
        if isinstance(got, tuple):
            for item in got:
                check(item)
        elif isinstance(got, dict):
            for key, item in got.items():
                assert isinstance(key, str)
                check(item)
        elif isinstance(got, np.ndarray):
            assert got.dtype.kind in "biufc"
        else:
            assert got is None or isinstance(got, (bool, int, float, complex, str, Unreadable))

    check(plain(value))


# ---- systems


def systems(dt: float) -> Iterator[Any]:
    num, den = [0.0, 2.0, 1.0], [1.0, -1.2, 0.4]
    A, B, C, D = [[1.2, -0.4], [1.0, 0.0]], [[1.0], [0.0]], [[2.0, 1.0]], [[0.0]]
    yield control.tf(num, den, dt)
    yield control.ss(A, B, C, D, dt)
    if dt:
        yield scipy.signal.dlti(num[1:], den, dt=dt)
        yield scipy.signal.dlti(A, B, C, D, dt=dt)
        yield scipy.signal.TransferFunction(num[1:], den, dt=dt)
    else:
        yield scipy.signal.lti(num[1:], den)
        yield scipy.signal.StateSpace(A, B, C, D)


@pytest.mark.parametrize("dt", [TS, 0.0])
def test_systems_become_coefficients(dt: float) -> None:
    for system in systems(dt):
        got = plain(system)
        assert got.dt == (dt or None)
        if isinstance(got, TransferFunctionValue):
            np.testing.assert_allclose(np.trim_zeros(got.num, "f"), [2, 1])
            np.testing.assert_allclose(got.den, [1, -1.2, 0.4])
            assert not got.num.flags.writeable
        else:
            assert isinstance(got, StateSpaceValue)
            np.testing.assert_allclose(got.A, [[1.2, -0.4], [1, 0]])
            np.testing.assert_allclose(got.C, [[2, 1]])
            assert (got.B.shape, got.D.shape) == ((2, 1), (1, 1))


@pytest.mark.parametrize(("dt", "expected"), [(True, None), (None, None), (0, None), (1, 1.0)])
def test_the_sampling_time_as_python_control_writes_it(dt: Any, expected: float | None) -> None:
    assert plain(control.tf([1], [1, 0.5], dt)).dt == expected


@pytest.mark.parametrize(
    "system",
    [
        control.tf([[[1.0, 2.0]], [[2.0, 3.0]]], [[[1.0, 1.0]], [[1.0, 1.0]]], TS),
        control.tf([[[1.0], [2.0]]], [[[1.0], [1.0]]], TS),
        control.tf([[[1.0]], [[2.0]]], [[[1.0]], [[1.0]]], TS),
        control.tf([[[1.0], [2.0]], [[3.0], [4.0]]], [[[1.0], [1.0]], [[1.0], [1.0]]], TS),
        scipy.signal.dlti([[1.0], [2.0]], [1.0, 0.5], dt=TS),
    ],
    ids=["two outputs", "two gains", "two gains below each other", "four gains", "scipy, two outputs"],
)
def test_transfer_functions_of_several_signals_are_unreadable(system: Any) -> None:
    assert isinstance(plain(system), Unreadable)


def test_zeros_and_poles_are_unreadable() -> None:
    got = plain(scipy.signal.dlti([], [0.5], 1.0, dt=TS))
    assert isinstance(got, Unreadable)


def test_a_figure_is_described() -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    figure.subplots(2, 1)[1].plot([0, 1, 2], [3, 4, 5])
    got = plain(figure)
    assert isinstance(got, FigureValue)
    assert [len(axes.curves) for axes in got.axes] == [0, 1]
