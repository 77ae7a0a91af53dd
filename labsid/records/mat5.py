"""Reader of MAT-files of versions 5 and 7: matrices, structures and cell arrays.

It replaces `scipy.io.loadmat`, which can crash the process on a damaged file (scipy 1.17: one in a hundred
single-byte changes of a small uncompressed file). Here a damaged file raises `ValueError`.
"""

import math
import struct
import zlib
from typing import Any

import numpy as np

_MATRIX, _COMPRESSED, _INT32, _UINT32 = 14, 15, 5, 6
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_CELL, _STRUCT, _OPAQUE = 1, 2, 17
_NUMERIC_CLASSES, _INTEGER_CLASSES = range(6, 16), range(8, 16)
_OTHER_CLASSES = {3: "an object", 4: "text", 5: "a sparse matrix", 16: "a function", 17: "an object"}
_COMPLEX = 0x800
_MAX_BYTES = 2**27  # of all compressed variables of a file: four signals of four million samples


def read_variables(content: bytes) -> dict[str, Any]:
    """Read all variables of a MAT-file.

    Parameters
    ----------
    content : bytes
        The content of the file.

    Returns
    -------
    dict
        Values by name. A matrix of real numbers is an array of the same shape, of int64 if its class is one of
        integers, else of floats; a structure array is a list of dicts and a cell array a list, both in MATLAB's order;
        any other value is represented by a str naming its type.

    Raises
    ------
    ValueError
        If it is not a MAT-file of these versions, or is truncated or damaged.
    """
    order = {b"\x00\x01IM": "<", b"\x01\x00MI": ">"}.get(content[124:128])
    if order is None:
        raise ValueError("its header is not that of version 5 or 7")
    variables = {}
    position, bytes_left = 128, _MAX_BYTES
    try:
        while position < len(content):
            kind, payload, position = _element(content, position, order)
            if kind == _COMPRESSED:
                inflated = _inflate(payload, bytes_left)
                bytes_left -= len(inflated)
                kind, payload, _ = _element(inflated, 0, order)
            if kind != _MATRIX:
                raise ValueError("there is something else where a variable should be")
            name, value = _matrix(payload, order)
            variables[name] = value
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    return variables


def _element(data: bytes, position: int, order: str) -> tuple[int, bytes, int]:
    """Type and payload of the data element at `position`, and the position of the next one."""
    if position + 8 > len(data):
        raise ValueError("it ends too early")
    kind, size = struct.unpack_from(f"{order}II", data, position)
    start = position + 8
    if kind >> 16:  # small data element: up to four bytes, stored in the tag
        kind, size, start = kind & 0xFFFF, kind >> 16, position + 4
        if size > 4:
            raise ValueError("a part has an impossible size")
    if start + size > len(data):
        raise ValueError("it ends too early")
    filling = 0 if kind == _COMPRESSED else -(start + size - position) % 8
    return kind, data[start : start + size], start + size + filling


def _inflate(payload: bytes, max_bytes: int) -> bytes:
    inflater = zlib.decompressobj()
    try:
        inflated = inflater.decompress(payload, max(max_bytes, 1))
    except zlib.error:
        raise ValueError("a compressed part does not unpack") from None
    if not inflater.eof:
        raise ValueError(f"a compressed part is incomplete, or all parts are over {_MAX_BYTES // 2**20} MB")
    return inflated


def _matrix(data: bytes, order: str) -> tuple[str, Any]:
    """Name and value of a matrix, structure or cell array."""
    if not data:  # an empty field
        return "", np.empty((0, 0))
    flags, position = _expect(data, 0, order, _UINT32)
    if flags.size != 2:
        raise ValueError("a variable has no type")
    kind = int(flags[0]) & 0xFF
    if kind == _OPAQUE:  # the only class without dimensions
        return _text(_element(data, position, order)[1]), _OTHER_CLASSES[kind]
    shape, position = _expect(data, position, order, _INT32)
    if shape.size < 2 or shape.min() < 0:
        raise ValueError("a variable has impossible dimensions")
    size = math.prod(shape.tolist())
    _, name, position = _element(data, position, order)
    if kind in _NUMERIC_CLASSES and flags[0] & _COMPLEX:
        return _text(name), "complex numbers"
    if kind in _NUMERIC_CLASSES:
        return _text(name), _numbers(data, position, order, size, kind).reshape(shape, order="F")
    if kind == _CELL:
        return _text(name), _matrices(data, position, order, size)
    if kind == _STRUCT:
        return _text(name), _structures(data, position, order, size)
    if kind in _OTHER_CLASSES:
        return _text(name), _OTHER_CLASSES[kind]
    raise ValueError("a variable is of no known type")


def _expect(data: bytes, position: int, order: str, kind: int) -> tuple[np.ndarray, int]:
    """Integers of the given type, and the position of the next element."""
    found, payload, position = _element(data, position, order)
    if found != kind or len(payload) % 4:
        raise ValueError("a part is of the wrong type")
    return np.frombuffer(payload, f"{order}{_NUMBERS[kind]}"), position


def _numbers(data: bytes, position: int, order: str, size: int, of_class: int) -> np.ndarray:
    """Numbers of any type; MATLAB stores doubles in the smallest sufficient type: only the class tells."""
    kind, payload, _ = _element(data, position, order)
    if kind not in _NUMBERS:
        raise ValueError("numbers are of no known type")
    dtype = np.dtype(f"{order}{_NUMBERS[kind]}")
    if len(payload) != size * dtype.itemsize:
        raise ValueError("there are more or fewer numbers than the dimensions say")
    numbers = np.frombuffer(payload, dtype)
    is_whole = of_class in _INTEGER_CLASSES and dtype.kind in "iu" and (size == 0 or int(numbers.max()) < 2**63)
    return numbers.astype(np.int64 if is_whole else np.float64)


def _matrices(data: bytes, position: int, order: str, count: int) -> list[Any]:
    """Values of `count` consecutive matrices."""
    values = []
    for _ in range(count):
        kind, payload, position = _element(data, position, order)
        if kind != _MATRIX:
            raise ValueError("there is something else where a field or a cell should be")
        values.append(_matrix(payload, order)[1])
    return values


def _structures(data: bytes, position: int, order: str, size: int) -> list[dict[str, Any]]:
    length, position = _expect(data, position, order, _INT32)
    _, names, position = _element(data, position, order)
    if length.size != 1 or length[0] < 1 or len(names) % length[0]:
        raise ValueError("a structure has impossible field names")
    step = int(length[0])
    fields = [_text(names[k : k + step]) for k in range(0, len(names), step)]
    if not fields:
        return []
    values = _matrices(data, position, order, size * len(fields))
    return [dict(zip(fields, values[k : k + len(fields)], strict=True)) for k in range(0, len(values), len(fields))]


def _text(name: bytes) -> str:
    return name.split(b"\0")[0].decode("utf-8", errors="replace")
