"""The channel between the judge and a student process: length-prefixed JSON of plain values, never pickle.

The student's side is not trusted. The size of a message is checked before it is read, and the declared shape and dtype
of an array against its data.
"""

import base64
import contextlib
import json
import math
import re
import socket
import struct
import time
from typing import Any

import numpy as np

from autograder.intake.untrusted_json import read_json
from labsid.checks.values import MAX_INTEGER, StateSpaceValue, TransferFunctionValue, Unreadable, Value
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

MAX_MESSAGE_BYTES = 64 * 1024 * 1024
MAX_DIMENSIONS = 8
MAX_OUTPUT_CHARACTERS = 20_000
_HEADER = struct.Struct(">Q")
_RECORDS: dict[str, type] = {
    kind.__name__: kind
    for kind in (TransferFunctionValue, StateSpaceValue, CurveValue, AxesValue, FigureValue, Unreadable)
}
_TAG = "!"
_NUMBERS = re.compile(r"[<>|][biufc]\d{1,2}")
_MAX_EMPTY = 1000
_LENGTHS = {"xlim": 2, "ylim": 2, "color": 3}


class ChannelError(Exception):
    """The other side closed the channel, or sent an invalid message."""


class ChannelClosed(ChannelError):
    """The other side closed the channel."""

    def __init__(self, reason: object = "") -> None:
        super().__init__(f"the channel is closed ({reason})" if reason else "the channel is closed")


def send(sock: socket.socket, message: dict[str, Any]) -> None:
    """Send one message, whose values were encoded with `encode`."""
    payload = json.dumps(message, separators=(",", ":")).encode()
    if len(payload) > MAX_MESSAGE_BYTES:
        raise ChannelError(f"a message of {len(payload)} bytes; at most {MAX_MESSAGE_BYTES} are allowed")
    try:
        sock.sendall(_HEADER.pack(len(payload)) + payload)
    except TimeoutError:
        raise
    except OSError as error:
        raise ChannelClosed(error) from None


def receive(sock: socket.socket) -> dict[str, Any]:
    """Receive one message; raises `ChannelError`, or `TimeoutError` if the whole message exceeds the time-out."""
    seconds = sock.gettimeout()
    deadline = math.inf if seconds is None else time.monotonic() + seconds
    try:
        return _receive(sock, deadline)
    finally:
        with contextlib.suppress(OSError):
            sock.settimeout(seconds)


def _receive(sock: socket.socket, deadline: float) -> dict[str, Any]:
    (length,) = _HEADER.unpack(_read(sock, _HEADER.size, deadline))
    if length > MAX_MESSAGE_BYTES:  # the length is the sender's, and could tell as many digits as it has
        raise ChannelError(f"a message longer than {MAX_MESSAGE_BYTES // 1024**2} MB")
    try:
        message = read_json(_read(sock, length, deadline), parts=b"[{,")
    except (ValueError, RecursionError, MemoryError) as error:
        raise ChannelError(f"not a message ({type(error).__name__})") from None
    if not isinstance(message, dict):
        raise ChannelError("not a message")
    return message


def _read(sock: socket.socket, size: int, deadline: float) -> bytes:
    data = bytearray()
    while len(data) < size:
        try:
            if deadline < math.inf:
                # a sender of a few bytes at a time must not block the reader forever
                seconds_left = deadline - time.monotonic()
                if seconds_left <= 0:
                    raise TimeoutError
                sock.settimeout(seconds_left)
            chunk = sock.recv(min(size - len(data), 1 << 20))
        except TimeoutError:
            raise
        except OSError as error:
            raise ChannelClosed(error) from None
        if not chunk:
            raise ChannelClosed
        data += chunk
    return bytes(data)


def encode(value: Value) -> Any:
    """Encode a plain value as JSON."""
    if isinstance(value, np.ndarray):
        array = np.ascontiguousarray(value)
        data = base64.b64encode(array.tobytes()).decode("ascii")
        return {_TAG: "array", "dtype": array.dtype.str, "shape": list(value.shape), "data": data}
    if isinstance(value, bool) or value is None or isinstance(value, (str, float)):
        return value
    if isinstance(value, int):
        return value if abs(value) < MAX_INTEGER else {_TAG: "Unreadable", "kind": "int of too many digits"}
    if isinstance(value, complex):
        return {_TAG: "complex", "re": value.real, "im": value.imag}
    if isinstance(value, dict):
        return {_TAG: "dict", "items": {key: encode(item) for key, item in value.items()}}
    if isinstance(value, (list, tuple)):
        return [encode(item) for item in value]
    name = type(value).__name__
    fields = getattr(type(value), "__slots__", ())
    return {_TAG: name, **{field: encode(getattr(value, field)) for field in fields}}


def decode(encoded: Any) -> Value:
    """Decode a plain value; raises `ChannelError` if it is invalid."""
    try:
        return _decode(encoded)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError, RecursionError, MemoryError) as error:
        raise ChannelError(f"not a plain value ({type(error).__name__})") from None


def _decode(encoded: Any) -> Value:
    if isinstance(encoded, list):
        return tuple(_decode(item) for item in encoded)
    if isinstance(encoded, int) and abs(encoded) >= MAX_INTEGER:
        raise ValueError("integer")
    if not isinstance(encoded, dict):
        return encoded
    tag = encoded[_TAG]
    if tag == "array":
        return _decode_array(encoded)
    if tag == "complex":
        return complex(float(encoded["re"]), float(encoded["im"]))
    if tag == "dict":
        return {str(key): _decode(item) for key, item in encoded["items"].items()}
    return _decode_record(_RECORDS[tag], {k: _decode(v) for k, v in encoded.items() if k != _TAG})


def _decode_record(kind: type, fields: dict[str, Any]) -> Value:
    """Build a record after checking the type of every field."""
    checked: dict[str, Any] = {}
    for name, value in fields.items():
        if name == "dt":
            checked[name] = None if value is None else float(value)
        elif name in ("title", "xlabel", "ylabel", "label", "where", "style", "kind"):
            checked[name] = str(value)[:1000]
        elif name in ("grid", "steps", "joined", "is_listed"):
            checked[name] = value is True
        elif name in ("xlim", "ylim", "color"):
            if len(value) != _LENGTHS[name]:
                raise ValueError(name)
            checked[name] = tuple(map(float, value))
        elif name in ("legend", "texts"):
            checked[name] = tuple(str(text)[:1000] for text in value)
        elif name in ("curves", "axes"):
            inner = CurveValue if name == "curves" else AxesValue
            if not all(isinstance(item, inner) for item in value):
                raise ValueError(name)
            checked[name] = tuple(value)
        elif name in ("num", "den", "x", "y"):
            checked[name] = _numbers(value, 1)
        elif name in ("A", "B", "C", "D"):
            checked[name] = _numbers(value, 2)
        else:
            raise ValueError(name)
    return kind(**checked)


def _numbers(value: Any, dimensions: int) -> np.ndarray:
    if not isinstance(value, np.ndarray) or value.ndim != dimensions or value.dtype.kind == "c":
        raise ValueError("array of real numbers expected")
    return value.astype(np.float64)


def _decode_array(encoded: dict[str, Any]) -> np.ndarray:
    if not _NUMBERS.fullmatch(encoded["dtype"]):
        raise ValueError("array kind")
    dtype = np.dtype(encoded["dtype"])
    shape = tuple(encoded["shape"])
    if len(shape) > MAX_DIMENSIONS or any(type(size) is not int or not 0 <= size < MAX_INTEGER for size in shape):
        raise ValueError("array shape")
    data = base64.b64decode(encoded["data"], validate=True)
    if math.prod(shape) * dtype.itemsize != len(data):
        raise ValueError("array size")
    if not data:  # its other dimensions may be larger than those of any array of a wider type
        shape = tuple(min(size, _MAX_EMPTY) for size in shape)
    return np.frombuffer(data, dtype=dtype).reshape(shape).copy()
