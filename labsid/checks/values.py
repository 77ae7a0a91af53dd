"""Plain values: the only data that a check receives from a student's work.

Lists, arrays, transfer functions of python-control or scipy, and figures become numbers, text, arrays and the records
below. Anything else becomes `Unreadable`, with the name of its type.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from labsid._arrays import freeze
from labsid.plots.figure_values import FigureValue

MAX_ITEMS = 10_000
MAX_DEPTH = 6
MAX_INTEGER = 2**63


@dataclass(frozen=True, slots=True, eq=False)
class TransferFunctionValue:
    """A transfer function as coefficients in descending powers; `dt` is None in continuous time."""

    num: NDArray[np.float64]
    den: NDArray[np.float64]
    dt: float | None

    def __post_init__(self) -> None:
        freeze(self, num=self.num, den=self.den)


@dataclass(frozen=True, slots=True, eq=False)
class StateSpaceValue:
    """A state space as its four matrices; `dt` is None in continuous time."""

    A: NDArray[np.float64]
    B: NDArray[np.float64]
    C: NDArray[np.float64]
    D: NDArray[np.float64]
    dt: float | None

    def __post_init__(self) -> None:
        freeze(self, A=self.A, B=self.B, C=self.C, D=self.D)


@dataclass(frozen=True, slots=True, eq=False)
class Unreadable:
    """Something that is not plain data; `kind` is the name of its type."""

    kind: str


Value = (
    None
    | bool
    | int
    | float
    | complex
    | str
    | NDArray[Any]
    | TransferFunctionValue
    | StateSpaceValue
    | FigureValue
    | Unreadable
    | Sequence["Value"]
    | Mapping[str, "Value"]
)
"""Every type that a check may receive."""


# A system is recognised by these attributes, without importing python-control or scipy.
_TRANSFER_FUNCTION = ("num", "den")
_STATE_SPACE = ("A", "B", "C", "D")


def plain(value: object, depth: int = 0) -> Value:
    """Turn a variable of a student's program into plain data.

    Parameters
    ----------
    value : object
        Any object.
    depth : int
        Nesting reached so far; deeper than `MAX_DEPTH` is `Unreadable`.

    Returns
    -------
    Value
        `Unreadable` also if reading the object raises an error.
    """
    try:
        return _plain(value, depth)
    except MemoryError:
        raise
    except Exception:
        return Unreadable(type(value).__name__)


def as_student_object(value: Value) -> Any:
    """The object that a student would use for a value: systems become python-control's, arrays are copied."""
    if isinstance(value, np.ndarray):
        return np.array(value)
    if not isinstance(value, TransferFunctionValue | StateSpaceValue):
        return value
    import control

    if isinstance(value, TransferFunctionValue):
        return control.tf(value.num, value.den, value.dt)
    return control.ss(value.A, value.B, value.C, value.D, value.dt)


def unchanged(now: Iterable[Any], before: Iterable[Any]) -> bool:
    """Whether arrays among these are what they were."""
    pairs = zip(now, before, strict=True)
    return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs if isinstance(b, np.ndarray))


def in_double_precision(value: Value) -> Value:
    """A value with its numbers of single or half precision in double precision."""
    if isinstance(value, np.ndarray):
        wider = {"f": np.float64, "c": np.complex128}.get(value.dtype.kind)
        return value if wider is None or value.dtype.itemsize >= np.dtype(wider).itemsize else value.astype(wider)
    if isinstance(value, tuple | list):
        return tuple(map(in_double_precision, value))
    if isinstance(value, Mapping):
        return {name: in_double_precision(one) for name, one in value.items()}
    return value


def _plain(value: object, depth: int) -> Value:
    if type(value) is int and abs(value) >= MAX_INTEGER:
        return Unreadable("int of too many digits")
    if value is None or type(value) in (bool, int, float, complex, str):
        return value  # type: ignore[return-value]
    if isinstance(value, np.generic):
        if value.dtype.kind not in "biufcU":
            return Unreadable(type(value).__name__)
        item = value.item()
        is_single = value.dtype in (np.float16, np.float32, np.complex64)  # the checks refuse it
        # longdouble has no other item
        return np.array(value) if is_single or isinstance(item, np.generic) else plain(item, depth)
    if isinstance(value, np.ndarray):
        array = np.array(value)
        return array if array.dtype.kind in "biufc" else Unreadable(f"array of {array.dtype}")
    if depth >= MAX_DEPTH:
        return Unreadable("deeply nested data")
    if isinstance(value, (list, tuple, range)):
        return _plain_sequence(value, depth)
    if isinstance(value, dict):
        if len(value) > MAX_ITEMS or not all(isinstance(key, str) for key in value):
            return Unreadable("dict")
        return {key: plain(item, depth + 1) for key, item in value.items()}
    if hasattr(value, "savefig") and hasattr(value, "axes"):
        from labsid.plots.describe import describe_figure

        return describe_figure(value)
    if hasattr(value, "__array__"):  # a column of a pandas table, for example
        return _plain(np.asarray(value), depth)
    return _plain_system(value)


def _plain_sequence(value: Sequence[object], depth: int) -> Value:
    try:
        array = np.asarray(value)
    except ValueError:
        array = np.empty(0, dtype=object)
    if array.dtype.kind in "biufc":
        return array
    if len(value) > MAX_ITEMS:
        return Unreadable(f"{type(value).__name__} of {len(value)} items")
    return tuple(plain(item, depth + 1) for item in value)


def _plain_system(value: object) -> Value:
    if all(hasattr(value, name) for name in _TRANSFER_FUNCTION):
        num, den = (_single_polynomial(getattr(value, name)) for name in _TRANSFER_FUNCTION)
        return TransferFunctionValue(num, den, _sampling_time(value))
    if all(hasattr(value, name) for name in _STATE_SPACE):
        A, B, C, D = (np.atleast_2d(np.asarray(getattr(value, n), float)) for n in _STATE_SPACE)
        return StateSpaceValue(A, B, C, D, _sampling_time(value))
    return Unreadable(type(value).__name__)


def _sampling_time(system: object) -> float | None:
    """python-control writes 0 or None for continuous time, True for discrete time without a sampling time."""
    dt: Any = getattr(system, "dt", None)
    return None if dt is None or dt is True or dt == 0 else float(dt)


def _single_polynomial(coefficients: Any) -> NDArray[np.float64]:
    """Coefficients of a single-input single-output system: python-control nests them as ``num[0][0]``."""
    array = coefficients
    while isinstance(array, (list, tuple)) or (isinstance(array, np.ndarray) and array.dtype == object):
        if len(array) != 1:
            break
        array = array[0]
    polynomial = np.asarray(array, dtype=np.float64)
    if polynomial.ndim > 2 or (polynomial.ndim == 2 and polynomial.shape[0] != 1):
        raise ValueError(f"one input and one output expected; got coefficients of shape {polynomial.shape}")
    return polynomial.reshape(-1)
