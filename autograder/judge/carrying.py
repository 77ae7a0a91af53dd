"""Carrying values forward after a wrong answer: when the student's own count, and what shape right ones take."""

from collections.abc import Mapping
from enum import Enum, auto

import numpy as np

from labsid.checks.values import Value

COMPARABLE = 30.0
"""Largest ratio of a wrong value that later answers may be judged on to the right one. Slips in signs, means, lags and
units of samples stay below it; far larger and far smaller values make later answers right that compute nothing."""


class Shape(Enum):
    """The shape in which right vectors replace the student's."""

    OWN = auto()
    FLAT = auto()
    COLUMN = auto()


def is_usable(own: Mapping[str, Value], right: Mapping[str, Value]) -> bool:
    """Whether later answers can be judged on these wrong values: numbers of the right size that are not all the same.

    Parameters
    ----------
    own, right : mapping
        The student's and the right values, by name.
    """
    return all(name in own and _is_comparable(own[name], value) for name, value in right.items())


def _is_comparable(own: Value, right: Value) -> bool:
    if not (_is_numeric(own) and _is_numeric(right)):
        return False
    a, b = np.asarray(own, dtype=np.float64).reshape(-1), np.asarray(right, dtype=np.float64).reshape(-1)
    if not a.size or (a.size == 1) != (b.size == 1) or not np.all(np.isfinite(a)):
        return False
    if np.ptp(a) == 0 and np.ptp(b) > 0:
        return False
    largest_a, largest_b = np.max(np.abs(a)), np.max(np.abs(b))
    return bool(largest_b / COMPARABLE <= largest_a <= largest_b * COMPARABLE)


def wrong_names(own: Mapping[str, Value], right: Mapping[str, Value]) -> tuple[str, ...]:
    """The names whose value is missing or differs from the right one."""
    return tuple(name for name, value in right.items() if not _is_equal(own.get(name), value))


def _is_equal(own: Value, right: Value) -> bool:
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


def is_column(value: Value) -> bool:
    """Whether a value is a column vector."""
    return isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 1 < value.shape[0]


def _is_numeric(value: Value) -> bool:
    return isinstance(value, (bool, int, float)) or (isinstance(value, np.ndarray) and value.dtype.kind in "biuf")
