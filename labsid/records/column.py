"""The columns of a log, as every reader of a format returns them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

_RECENT = 10**17  # nanoseconds from 1970 to 1973: what is above is no simulated time


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """One column of a log.

    Attributes
    ----------
    name : str
        As in the file, without the unit.
    values : ndarray, shape (N,)
        Floats with NaN where there is no value, of 32 bits where the file has these; whole numbers (int64) where they
        are written so; or datetime64[ns].
    unit : str
        As in the file; empty if it says none. ``h:m:s`` for times of day in seconds.
    stamps : ndarray, shape (N,), or None
        Times of these samples, where a format keeps them with each signal: seconds, or nanoseconds as int64.
    notes : tuple of str
        What is to be said of the values.
    """

    name: str
    values: np.ndarray
    unit: str = ""
    stamps: np.ndarray | None = None
    notes: tuple[str, ...] = ()

    @property
    def numbers(self) -> np.ndarray:
        """The values as floats."""
        return np.asarray(self.values, np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """What a file holds, before any column is read.

    Attributes
    ----------
    names : tuple of str
        Of all columns, in the file's order; numbers from 1 if there is no header.
    read : callable
        ``read(places)`` returns the columns at these places, from 0.
    has_names : bool
        False if the columns only have numbers.
    what : str
        What the format calls a column: "column", "variable", "channel" or "field".
    notes : tuple of str
        Assumptions made in reading the file.
    others : tuple of int
        Places of further signals that a record keeps: the two outputs and the reference of a lab record.
    """

    names: tuple[str, ...]
    read: Callable[[Sequence[int]], list[Column]]
    has_names: bool = True
    what: str = "column"
    notes: tuple[str, ...] = ()
    others: tuple[int, ...] = ()


def log_of(columns: Sequence[Column], what: str = "column", notes: Sequence[str] = (), has_names: bool = True) -> Log:
    """A log whose columns have been read already."""
    names = tuple(column.name for column in columns)
    return Log(names, lambda places: [columns[k] for k in places], has_names, what, tuple(notes))


def matrix_columns(name: str, values: np.ndarray, unit: str = "") -> list[Column]:
    """The columns of an array: ``name`` for a vector, ``name.1``, ``name.2`` ... for a matrix with one signal a column.

    A matrix with more columns than rows, of at most 32 rows, holds one signal a row.
    """
    array = np.squeeze(np.asarray(values))
    if array.ndim < 2:
        return [Column(name, _as_numbers(np.atleast_1d(array)), unit)]
    if array.ndim > 2:
        return []
    if array.shape[0] < array.shape[1] and array.shape[0] <= 32:
        array = array.T
    if array.shape[1] > 1000:
        return []
    prefix = f"{name}." if name else ""
    return [Column(f"{prefix}{k + 1}", _as_numbers(array[:, k]), unit) for k in range(array.shape[1])]


def listed(names: Sequence[str]) -> str:
    """The names in a message, of which the first 40 are given and long ones cut."""
    more = [f"{len(names) - 40} more"] if len(names) > 40 else []
    return ", ".join([*(name if len(name) <= 60 else f"{name[:60]}..." for name in names[:40]), *more])


def stamps_column(stamps: np.ndarray) -> Column:
    """The stamps that a format keeps with its signals, as a column of times."""
    if stamps.dtype.kind == "i" and stamps.size and stamps.max() > _RECENT:
        return Column("time", stamps.astype("datetime64[ns]"))
    return Column("time", stamps * 1e-9 if stamps.dtype.kind == "i" else stamps, "s")


def is_numeric(array: np.ndarray) -> bool:
    """Whether these are real numbers, truth values, dates or durations: never objects, text or complex numbers."""
    return array.dtype.kind in "biufMm"


def _as_numbers(values: np.ndarray) -> np.ndarray:
    """Whole numbers as int64, dates as datetime64[ns], floats of 32 bits as they are, all else as float."""
    if values.dtype.kind == "M":
        return values.astype("datetime64[ns]")
    if values.dtype.kind == "m":
        return values.astype("timedelta64[ns]") / np.timedelta64(1, "s")
    if values.dtype.kind == "i" or (values.dtype.kind == "u" and (values.size == 0 or values.max() < 2**63)):
        return values.astype(np.int64)
    return values if values.dtype == np.float32 else values.astype(np.float64)
