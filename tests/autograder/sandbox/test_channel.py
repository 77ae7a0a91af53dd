"""What crosses between judge and student: every plain value unchanged, nothing else at all."""

import base64
import json
import math
import socket
import struct
import threading
from collections.abc import Iterator
from typing import Any

import control
import hypothesis.extra.numpy as npst
import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st

from autograder.sandbox.channel import (
    MAX_MESSAGE_BYTES,
    ChannelError,
    decode,
    encode,
    receive,
    send,
)
from labsid.checks.values import StateSpaceValue, TransferFunctionValue, Unreadable, plain
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

NUMBERS = st.one_of(
    npst.boolean_dtypes(),
    npst.integer_dtypes(endianness="?"),
    npst.unsigned_integer_dtypes(endianness="?"),
    npst.floating_dtypes(endianness="?"),
    npst.complex_number_dtypes(endianness="?"),
)
ARRAYS = npst.arrays(NUMBERS, npst.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=4))
SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**63) + 1, 2**63 - 1),
    st.floats(),
    st.complex_numbers(),
    st.text(),
    st.characters(categories=["Cs"]),  # half a character, as broken text has it
)
VALUES = st.recursive(
    st.one_of(SCALARS, ARRAYS),
    lambda inner: st.lists(inner, max_size=3).map(tuple) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)


def cross(value: Any) -> Any:
    """There and back, over text as the wire carries it."""
    return decode(json.loads(json.dumps(encode(value))))


def assert_same(got: Any, sent: Any) -> None:
    assert type(got) is type(sent)
    if isinstance(sent, np.ndarray):
        assert got.dtype == sent.dtype
        assert got.shape == sent.shape
        assert got.tobytes() == sent.tobytes()
    elif isinstance(sent, tuple):
        assert len(got) == len(sent)
        for one, other in zip(got, sent, strict=True):
            assert_same(one, other)
    elif isinstance(sent, dict):
        assert list(got) == list(sent)
        for key in sent:
            assert_same(got[key], sent[key])
    elif isinstance(sent, complex):
        assert_same(got.real, sent.real)
        assert_same(got.imag, sent.imag)
    else:
        assert got == sent or (math.isnan(got) and math.isnan(sent))


@given(VALUES)
def test_plain_values_cross_unchanged(value: Any) -> None:
    assert_same(cross(value), value)


@given(ARRAYS)
def test_the_order_in_memory_does_not_matter(array: np.ndarray) -> None:
    for laid_out in (np.asfortranarray(array), array.T, array[::-1] if array.ndim else array):
        got = cross(laid_out)
        assert got.shape == laid_out.shape
        np.testing.assert_array_equal(got, laid_out)


def test_what_arrives_can_be_written_to() -> None:
    """A student's function may work in place; it must not be held against it."""
    got = cross(np.arange(3.0))
    got[0] = 5
    assert got.tolist() == [5, 1, 2]


@pytest.mark.parametrize("dt", [0.75, None])
def test_systems_of_python_control_and_scipy_cross(dt: float | None) -> None:
    num, den = [1.0, 2.0], [1.0, 0.5, 0.1]
    A, B, C, D = [[-0.5, -0.1], [1, 0]], [[1], [0]], [[1, 2]], [[0]]
    systems = [control.tf(num, den, dt or 0), control.ss(A, B, C, D, dt or 0)]
    if dt is None:
        systems += [scipy.signal.lti(num, den), scipy.signal.lti(A, B, C, D)]
    else:
        systems += [scipy.signal.dlti(num, den, dt=dt), scipy.signal.dlti(A, B, C, D, dt=dt)]
    for index, system in enumerate(systems):
        got = cross(plain(system))
        assert got.dt == dt
        if index % 2 == 0:
            assert isinstance(got, TransferFunctionValue)
            np.testing.assert_allclose(got.num, num)
            np.testing.assert_allclose(got.den, den)
        else:
            assert isinstance(got, StateSpaceValue)
            for matrix, right in zip((got.A, got.B, got.C, got.D), (A, B, C, D), strict=True):
                np.testing.assert_allclose(matrix, right)


def test_a_figure_crosses() -> None:
    curve = CurveValue(np.arange(3.0), np.arange(3.0) ** 2, (0.1, 0.2, 0.3), True, "y")
    axes = AxesValue("title", "t (s)", "y (V)", (0.0, 2.0), (0.0, 4.0), True, ("y",), ("MSE",), (curve,))
    got = cross(FigureValue((axes, axes)))
    assert isinstance(got, FigureValue)
    assert len(got.axes) == 2
    for name in ("title", "xlabel", "ylabel", "xlim", "ylim", "grid", "legend", "texts"):
        assert getattr(got.axes[1], name) == getattr(axes, name)
    (drawn,) = got.axes[0].curves
    assert (drawn.color, drawn.steps, drawn.label) == (curve.color, True, "y")
    np.testing.assert_array_equal(drawn.x, curve.x)
    np.testing.assert_array_equal(drawn.y, curve.y)


def test_an_integer_of_a_thousand_digits_is_unreadable_on_both_sides() -> None:
    got = cross(10**1000)
    assert isinstance(got, Unreadable)
    assert got.kind == "int of too many digits"
    read = plain(-(10**1000))
    assert isinstance(read, Unreadable)
    assert read.kind == got.kind
    with pytest.raises(ChannelError):
        decode(10**1000)


def array(**changes: Any) -> dict[str, Any]:
    """An honest encoding of two numbers, with some fields changed; None takes a field out."""
    honest = {"!": "array", "dtype": "<f8", "shape": [2], "data": base64.b64encode(b"\0" * 16).decode()}
    return {key: value for key, value in (honest | changes).items() if value is not None}


VECTOR, MATRIX = array(), array(shape=[1, 2])
CURVE = {"!": "CurveValue", "x": VECTOR, "y": VECTOR, "color": [0.0, 0.0, 0.0], "steps": False, "label": ""}
AXES = {
    "!": "AxesValue", "title": "", "xlabel": "", "ylabel": "", "xlim": [0, 1], "ylim": [0, 1], "grid": False,
    "legend": [], "texts": [], "curves": [CURVE],
}  # fmt: skip
SYSTEM = {"!": "TransferFunctionValue", "num": VECTOR, "den": VECTOR, "dt": None}


def test_the_hostile_cases_start_from_honest_ones() -> None:
    assert decode(array()).tolist() == [0, 0]
    assert isinstance(decode({"!": "FigureValue", "axes": [AXES]}), FigureValue)
    assert isinstance(decode(SYSTEM), TransferFunctionValue)


@pytest.mark.parametrize(
    "encoded",
    [
        pytest.param(array(shape=[3]), id="more shape than data"),
        pytest.param(array(shape=[1]), id="more data than shape"),
        pytest.param(array(shape=[2**40, 2**40]), id="a shape that no memory holds"),
        pytest.param(array(shape=[0, 10**40], data=""), id="an empty array with a side of 41 digits"),
        pytest.param(array(shape=[-2]), id="a negative shape"),
        pytest.param(array(shape=[-1, -2]), id="two negatives that multiply to the right size"),
        pytest.param(array(shape=[2.0]), id="a shape that is no integer"),
        pytest.param(array(shape=[True, 2]), id="a shape of booleans"),
        pytest.param(array(shape="2"), id="a shape of text"),
        pytest.param(array(shape=2), id="a shape that is no list"),
        pytest.param(array(shape=[1] * 8 + [2]), id="nine dimensions"),
        pytest.param(array(dtype="|O"), id="objects"),
        pytest.param(array(dtype="O"), id="objects by another name"),
        pytest.param(array(dtype="|V8"), id="raw memory"),
        pytest.param(array(dtype="<i4,<f4"), id="a structured dtype"),
        pytest.param(array(dtype="(2,)<f8"), id="a subarray dtype"),
        pytest.param(array(dtype=["<f8"]), id="a dtype that is a list"),
        pytest.param(array(dtype=","), id="a dtype on which numpy's parser fails"),
        pytest.param(array(dtype="<f9"), id="a dtype that is none"),
        pytest.param(array(dtype="<M8[s]"), id="dates"),
        pytest.param(array(dtype="<U2"), id="text in an array"),
        pytest.param(array(data="????"), id="no base64"),
        pytest.param(array(data="AAA"), id="base64 of a wrong length"),
        pytest.param(array(data="é"), id="base64 that is not ASCII"),
        pytest.param(array(data=16), id="data that is a number"),
        pytest.param(array(data=None), id="no data"),
        pytest.param(array(shape=None), id="no shape"),
        pytest.param(array(dtype=None), id="no dtype"),
        pytest.param({}, id="no tag"),
        pytest.param({"!": "Popen", "args": "ls"}, id="an unknown tag"),
        pytest.param({"!": []}, id="a tag that is a list"),
        pytest.param({"!": None}, id="a tag that is null"),
        pytest.param({"!": "complex", "re": 1}, id="half a complex number"),
        pytest.param({"!": "complex", "re": [], "im": 1}, id="a complex number of a list"),
        pytest.param({"!": "dict"}, id="a dict without items"),
        pytest.param({"!": "dict", "items": [1]}, id="a dict whose items are a list"),
        pytest.param({"!": "dict", "items": {"a": {"!": "?"}}}, id="something hostile in a dict"),
        pytest.param([1, [2, {"!": "?"}]], id="something hostile in a list"),
        pytest.param({"!": "Unreadable"}, id="an unreadable without a kind"),
        pytest.param({"!": "TransferFunctionValue"}, id="a system without coefficients"),
        pytest.param(SYSTEM | {"num": 3}, id="a coefficient instead of coefficients"),
        pytest.param(SYSTEM | {"num": MATRIX}, id="coefficients in a matrix"),
        pytest.param(SYSTEM | {"num": array(dtype="<c8")}, id="complex coefficients"),
        pytest.param(SYSTEM | {"dt": "fast"}, id="a sampling time of text"),
        pytest.param(SYSTEM | {"dt": [1]}, id="a sampling time that is a list"),
        pytest.param({"!": "StateSpaceValue", **dict.fromkeys("ABC", MATRIX), "dt": 1}, id="a state space without D"),
        pytest.param({"!": "StateSpaceValue", **dict.fromkeys("ABCD", VECTOR), "dt": 1}, id="vectors for matrices"),
        pytest.param({"!": "FigureValue", "axes": 3}, id="a figure whose axes are a number"),
        pytest.param({"!": "FigureValue", "axes": [CURVE]}, id="a figure whose axes are curves"),
        pytest.param({"!": "FigureValue", "axes": [AXES | {"curves": [AXES]}]}, id="axes whose curves are axes"),
        pytest.param({"!": "FigureValue", "axes": [AXES | {"xlim": [0]}]}, id="one limit"),
        pytest.param({"!": "FigureValue", "axes": [AXES | {"ylim": ["a", "b"]}]}, id="limits of text"),
        pytest.param({"!": "FigureValue", "axes": [AXES | {"legend": 3}]}, id="a legend that is a number"),
        pytest.param(CURVE | {"color": [1.0]}, id="a colour of one number"),
        pytest.param(CURVE | {"x": "0 1"}, id="a curve of text"),
    ],
)
def test_hostile_encodings_are_refused(encoded: Any) -> None:
    with pytest.raises(ChannelError):
        decode(encoded)


def test_texts_of_a_hostile_figure_are_cut() -> None:
    got = decode(CURVE | {"label": "x" * 10**6})
    assert isinstance(got, CurveValue)
    assert len(got.label) == 1000


def test_nesting_without_end_is_refused() -> None:
    nested: Any = 0
    for _ in range(100_000):
        nested = [nested]
    with pytest.raises(ChannelError):
        decode(nested)
    while isinstance(nested, list):  # taken down by hand, as it would be too deep for the interpreter
        (nested,) = nested


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    one, other = socket.socketpair()
    one.settimeout(10)
    with one, other:
        yield one, other


def test_messages_arrive_whole_and_in_order(ends: tuple[socket.socket, socket.socket]) -> None:
    mine, theirs = ends
    large = {"op": "set", "values": {"u": encode(np.arange(300_000.0))}}
    sender = threading.Thread(target=lambda: [send(theirs, large), send(theirs, {"op": "é\ud800"})])
    sender.start()
    first, second = receive(mine), receive(mine)
    sender.join()
    np.testing.assert_array_equal(decode(first["values"]["u"]), np.arange(300_000.0))
    assert second == {"op": "é\ud800"}


@pytest.mark.parametrize(
    ("sent", "said"),
    [
        (struct.pack(">Q", MAX_MESSAGE_BYTES + 1), "a message longer than"),
        (b"\xff" * 8, "a message longer than"),
        (struct.pack(">Q", 3) + b"{}}", "not a message"),
        (struct.pack(">Q", 4) + b"\xff\xfe\xfd\xfc", "not a message"),
        (struct.pack(">Q", 2) + b"[]", "not a message"),
        (struct.pack(">Q", 4) + b"null", "not a message"),
        (struct.pack(">Q", 0), "not a message"),
        (struct.pack(">Q", 200_000) + b"[" * 200_000, "not a message"),
        (struct.pack(">Q", 9999) + b"9" * 9999, "not a message"),
        (b"\0\0\0", "closed"),
        (struct.pack(">Q", 100) + b"{", "closed"),
        (b"", "closed"),
    ],
    ids=[
        "a length over the limit", "a length of all ones", "broken JSON", "no text", "a list", "null", "empty",
        "nesting without end", "a number of 9999 digits", "half a header", "half a message", "nothing",
    ],
)  # fmt: skip
def test_what_is_no_message_is_refused(ends: tuple[socket.socket, socket.socket], sent: bytes, said: str) -> None:
    mine, theirs = ends
    writer = threading.Thread(target=lambda: (theirs.sendall(sent), theirs.close()))
    writer.start()
    with pytest.raises(ChannelError, match=said):
        receive(mine)
    writer.join()


def test_silence_is_a_time_out(ends: tuple[socket.socket, socket.socket]) -> None:
    mine, _ = ends
    mine.settimeout(0.05)
    with pytest.raises(TimeoutError):
        receive(mine)
    assert mine.gettimeout() == 0.05


def test_a_trickle_is_a_time_out_too(ends: tuple[socket.socket, socket.socket]) -> None:
    """A sender of one byte now and then must not hold the judge for as long as it likes."""
    mine, theirs = ends
    mine.settimeout(0.3)
    over = threading.Event()

    def trickle() -> None:
        theirs.sendall(struct.pack(">Q", 10_000))
        while not over.wait(0.02):
            theirs.sendall(b" ")

    sender = threading.Thread(target=trickle)
    sender.start()
    try:
        with pytest.raises(TimeoutError):
            receive(mine)
    finally:
        over.set()
        sender.join()


def test_sending_to_nobody_is_said(ends: tuple[socket.socket, socket.socket]) -> None:
    mine, theirs = ends
    theirs.close()
    with pytest.raises(ChannelError, match="closed"):
        send(mine, {"op": "x" * 10**6})


def test_a_message_over_the_limit_is_not_sent(
    ends: tuple[socket.socket, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("autograder.sandbox.channel.MAX_MESSAGE_BYTES", 100)
    mine, theirs = ends
    with pytest.raises(ChannelError, match="at most 100"):
        send(theirs, {"value": "x" * 100})
    theirs.close()
    with pytest.raises(ChannelError, match="closed"):
        receive(mine)


@pytest.mark.parametrize("drawn", [True, False])
def test_no_field_of_a_record_is_lost(drawn: bool) -> None:
    curve = CurveValue(np.arange(3.0), np.ones(3), (0.1, 0.2, 0.3), drawn, "y", "post" if drawn else "", drawn)
    axes = AxesValue("a", "b", "c", (0.0, 1.0), (2.0, 3.0), drawn, ("d",), ("e",), (curve,))
    for one in (curve, axes, FigureValue((axes,))):
        assert encode(decode(encode(one))) == encode(one)


def test_an_unknown_field_is_refused() -> None:
    encoded = encode(CurveValue(np.arange(3.0), np.ones(3), (0.1, 0.2, 0.3), False, "y"))
    with pytest.raises(ChannelError):
        decode(encoded | {"colour": "red"})
