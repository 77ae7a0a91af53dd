"""Carrying values forward after a wrong answer: which ones are wrong, and what shape right ones take."""

from collections.abc import Mapping
from enum import Enum, auto

import numpy as np

from labsid.checks.values import Value


class Shape(Enum):
    """The shape in which right vectors replace the student's."""

    OWN = auto()
    FLAT = auto()
    COLUMN = auto()


def wrong_names(own: Mapping[str, Value], right: Mapping[str, Value]) -> tuple[str, ...]:
    """The names whose value is missing or differs from the right one."""
    return tuple(name for name, value in right.items() if not equal_values(own.get(name), value))


def equal_values(own: Value, right: Value) -> bool:
    """Whether two numbers or arrays are equal in shape, and in value but for rounding."""
    if not (_is_numeric(own) and _is_numeric(right)):
        return False
    a, b = np.asarray(own, dtype=np.float64), np.asarray(right, dtype=np.float64)
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=1e-9, atol=0))


def differ_in_shape(own: Mapping[str, Value], right: Mapping[str, Value]) -> bool:
    """Whether a vector has the right number of elements in another shape: a row, or flat instead of a column."""
    pairs = ((own[name], value) for name, value in right.items() if name in own)
    return any(
        isinstance(a, np.ndarray) and isinstance(b, np.ndarray) and a.size == b.size > 1 and a.shape != b.shape
        for a, b in pairs
    )


def in_shape(right: Value, own: Value, shape: Shape) -> Value:
    """A right vector or number in another shape; a matrix, and anything else, as it is.

    Parameters
    ----------
    right, own : Value
        The right value, and the student's; None if there is none.
    shape : Shape
        The shape of the student's own value, of which a vector is flat if there is none; or flat, or a column.
    """
    if not _is_numeric(right) or np.ndim(right) > 1:  # type: ignore[arg-type]
        return right
    array = np.asarray(right)
    if shape is Shape.OWN and isinstance(own, np.ndarray):
        if own.size == array.size:
            return array.reshape(own.shape)
        shape = Shape.COLUMN if is_column(own) else Shape.FLAT
    return array.reshape(-1, 1) if shape is Shape.COLUMN and array.size > 1 else right


def has_shape_of(own: Value, right: Value) -> bool:
    """Whether a value is an array of the shape of the right one."""
    return isinstance(own, np.ndarray) and np.shape(own) == np.shape(right)  # type: ignore[arg-type]


def is_signal(value: Value) -> bool:
    """Whether a value is a vector, flat or a column, of more than one number."""
    return isinstance(value, np.ndarray) and value.size > 1 and value.size == max(value.shape)


def is_column(value: Value) -> bool:
    """Whether a value is a column vector."""
    return isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 1 < value.shape[0]


def is_row(value: Value) -> bool:
    """Whether a value is a row vector, which no check reads as a signal."""
    return isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[0] == 1 < value.shape[1]


def _is_numeric(value: Value) -> bool:
    return isinstance(value, (bool, int, float)) or (isinstance(value, np.ndarray) and value.dtype.kind in "biuf")
