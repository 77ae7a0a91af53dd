"""Validation of array arguments, and read-only arrays for frozen results."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


def frozen_array(values: ArrayLike) -> FloatArray:
    """Copy `values` to a float array that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def read_only(array: FloatArray) -> FloatArray:
    """Return a contiguous read-only view of `array`, as the compiled loops require."""
    view = np.ascontiguousarray(array).view()
    view.setflags(write=False)
    return view


def freeze(instance: object, **arrays: Any) -> None:
    """Set fields of a frozen dataclass to read-only float copies; for use in ``__post_init__``."""
    for name, values in arrays.items():
        object.__setattr__(instance, name, frozen_array(values))


def stretches_of(mask: NDArray[np.bool_]) -> list[list[int]]:
    """First index of each stretch of True, and the one after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return edges.reshape(-1, 2).tolist()


def lies_within(stretches: Iterable[Sequence[int]], at: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether each index of `at` lies in a stretch, a first index and the one after the last; all do without any."""
    marks = [(at >= start) & (at < stop) for start, stop in stretches]
    return np.any(marks, axis=0) if marks else np.ones(at.size, bool)


def up_to_next(marks: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Marks, also of the samples after each up to the next one; gaps of two usual distances or more stay gaps."""
    at = np.flatnonzero(marks)
    if at.size < 2:
        return marks
    longest = 2 * int(np.median(np.diff(at))) - 1
    last = np.maximum.accumulate(np.where(marks, np.arange(marks.size), -longest))
    return np.asarray(np.arange(marks.size) - last < longest)


def window_sums(x: FloatArray, length: int) -> FloatArray:
    """Sums of `x` over each window of so many samples, by its first one."""
    total = np.concatenate([[0.0], np.cumsum(x)])
    return np.asarray(total[length:] - total[: total.size - length])


def lagged_columns(x: FloatArray, at: NDArray[Any], lags: int, stride: int = 1) -> FloatArray:
    """The `lags` samples before each index of `at`, `stride` apart, the latest first, shape (len(at), lags)."""
    return x[at[:, None] - stride * np.arange(1, lags + 1)]


def left_by(columns: FloatArray, target: FloatArray, dependent: float) -> tuple[FloatArray, int]:
    """What a regression on columns leaves of a target, and how many of them count.

    Those with a singular value below `dependent` times the largest, after scaling to unit length, repeat others.
    """
    X = columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    basis, singular, _ = np.linalg.svd(X, full_matrices=False)
    basis = basis[:, singular > dependent * singular[0]]
    return target - basis @ (basis.T @ target), basis.shape[1]


def as_signal(name: str, values: ArrayLike, at_least: int = 1) -> FloatArray:
    """Check that `values` is one finite signal and return it with shape (N,).

    Parameters
    ----------
    name : str
        Name of the argument, for the error message.
    values : array_like, shape (N,), (N, 1) or (1, N)
        The samples.
    at_least : int
        Smallest number of samples.

    Returns
    -------
    ndarray of float, shape (N,)

    Raises
    ------
    ValueError
        If it is not one signal, too short, or holds NaN or infinity.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must hold real numbers; got {type(values).__name__}.") from None
    if array.ndim == 2 and 1 in array.shape:
        array = array.reshape(-1)
    if array.ndim != 1:
        raise ValueError(f"{name} must be one signal of shape (N,) or (N, 1); got shape {array.shape}.")
    if array.size < at_least:
        raise ValueError(f"{name} must have at least {at_least} samples; got {array.size}.")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise ValueError(
            f"{name} must be finite; got {array[bad[0]]} at sample {bad[0]} ({bad.size} such samples). "
            "Repair or cut the record there."
        )
    return array


def as_signals(at_least: int = 1, **signals: ArrayLike) -> tuple[FloatArray, ...]:
    """Check several signals that must have equal length; see `as_signal`."""
    return as_equal_signals(list(signals.items()), at_least)


def as_equal_signals(signals: Sequence[tuple[str, ArrayLike]], at_least: int = 1) -> tuple[FloatArray, ...]:
    """Check several signals, each with its name, that must have equal length; see `as_signal`."""
    arrays = tuple(as_signal(name, values, at_least) for name, values in signals)
    lengths = [array.size for array in arrays]
    if len(set(lengths)) > 1:
        raise ValueError(
            f"{' and '.join(name for name, _ in signals)} must have equal length; got "
            f"{' and '.join(map(str, lengths))}. Cut them to the same samples."
        )
    return arrays


def as_matrix(name: str, values: ArrayLike) -> FloatArray:
    """Check that `values` is one finite matrix with at least one entry.

    Parameters
    ----------
    name : str
        Name of the argument, for the error message.
    values : array_like, shape (m, n)

    Returns
    -------
    ndarray of float, shape (m, n)

    Raises
    ------
    ValueError
        If it is not a matrix, is empty, or holds NaN or infinity.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a matrix of real numbers with rows of equal length.") from None
    if array.ndim != 2 or array.size == 0:
        raise ValueError(f"{name} must be a matrix, written as a list of rows; got shape {array.shape}.")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name} must be finite; got NaN or infinity in it.")
    return array


def as_square(name: str, values: ArrayLike) -> FloatArray:
    """Check that `values` is one finite square matrix.

    Parameters
    ----------
    name : str
        Name of the argument, for the error message.
    values : array_like, shape (n, n)

    Returns
    -------
    ndarray of float, shape (n, n)

    Raises
    ------
    ValueError
        If it is not a finite square matrix.
    """
    array = as_matrix(name, values)
    if array.shape[0] != array.shape[1]:
        raise ValueError(f"{name} must be square; got shape {array.shape}.")
    return array


def beside(parts: Sequence[FloatArray]) -> FloatArray:
    """Matrices of equal height side by side, in column-major order."""
    out = np.empty((parts[0].shape[0], sum(part.shape[1] for part in parts)), order="F")
    at = 0
    for part in parts:
        out[:, at : at + part.shape[1]] = part
        at += part.shape[1]
    return out
