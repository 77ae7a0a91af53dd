"""Names and columns of several signals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsid.records.record import Record
from labsid.records.several_signals import check_names, joined, names_of, one_signal_each, place_of, signal_columns


@given(st.integers(2, 5), st.integers(1, 4))
def test_columns_that_are_joined_are_what_was_split(samples, count):
    values = np.arange(samples * count, dtype=float).reshape(samples, count)
    np.testing.assert_array_equal(np.reshape(joined(signal_columns(values)), (samples, count)), values)


@pytest.mark.parametrize("values", [[1.0, 2.0], [[1.0], [2.0]], [[1.0, 2.0]], ["a", "b"], np.zeros((2, 2, 2))])
def test_what_is_not_several_signals_stays_as_it_is(values):
    (column,) = signal_columns(values)
    assert column is values


def test_names():
    assert names_of("u", (), 1) == ("u",)
    assert names_of("y", (), 3) == ("y1", "y2", "y3")
    assert names_of("y", ["T1"], 1) == ("T1",)


@pytest.mark.parametrize(
    ("symbol", "given", "count", "message"),
    [
        ("u", ("a", "b"), 1, r"inputs must hold one name for each of the 1 column of u; got 2: a, b\. Give a tuple"),
        ("y", ("a",), 2, r"outputs must hold one name for each of the 2 columns of y; got 1: a\."),
        ("y", "ab", 2, r"got 'ab'\. Give a tuple"),
    ],
)
def test_as_many_names_as_columns(symbol, given, count, message):
    with pytest.raises(ValueError, match=message):
        names_of(symbol, given, count)


@pytest.mark.parametrize(
    ("inputs", "outputs", "message"),
    [
        (("a", "b", "a"), ("c",), r"inputs must name different columns; got 'a' twice\. Leave one of them out"),
        (("a",), ("c", "c"), r"outputs must name different columns; got 'c' twice"),
        (("a", "b"), ("c", "b"), r"'b' is named as an input and as an output\. Leave it out of one of them"),
        (("a", " "), ("c",), r"inputs must name every column; got 'a', ' '\. Name the empty one"),
    ],
)
def test_names_that_do_not_tell_signals_apart(inputs, outputs, message):
    with pytest.raises(ValueError, match=message):
        check_names(inputs, outputs)


def test_a_signal_by_name_or_place():
    assert place_of("T2", ("T1", "T2"), "output") == place_of(1, ("T1", "T2"), "output") == 1
    for wrong in ("T3", 2, -1):
        with pytest.raises(ValueError, match=rf"there is no output {wrong!r}; the outputs are T1, T2\. Name one"):
            place_of(wrong, ("T1", "T2"), "output")


def test_what_takes_one_signal_each_says_how_to_choose():
    k = np.arange(4.0)
    plain = Record(k, k, k, 1.0)
    assert one_signal_each(plain, "the lab") is plain
    several = Record(k, np.column_stack([k, -k]), k, 1.0, name="rig", inputs=("heater", "fan"), outputs=("T",))
    with pytest.raises(
        ValueError,
        match=r"the lab takes one input and one output; rig has the inputs heater, fan and the outputs T\. Choose one "
        r"of each, such as --columns t,heater,T, in Python record\.pair\('heater', 'T'\)",
    ):
        one_signal_each(several, "the lab")
