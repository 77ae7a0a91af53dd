"""Read an answer as a number, an array or a figure, and compare answers within a tolerance."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid.checks.values import StateSpaceValue, TransferFunctionValue, Unreadable, Value
from labsid.checks.verdict import SINGLE_PRECISION, NoAnswer
from labsid.plots.figure_values import FigureValue

FloatArray = NDArray[np.float64]
_FEW = 3
_ROUNDING = 1e-9


def kind_of(value: Value) -> str:
    """Describe a value in words for a message: "an array of shape (903, 1)", "text", "nothing (None)"."""
    if value is None:
        return "nothing (None)"
    if isinstance(value, Unreadable):
        return "still `...`" if value.kind == "ellipsis" else f"an object of type {value.kind}"
    if isinstance(value, np.ndarray):
        kind = "complex " if value.dtype.kind == "c" else ""
        return f"a{'' if kind else 'n'} {kind}array of shape {value.shape}" if value.ndim else f"a {kind}number"
    if isinstance(value, (bool, int, float)):
        return "a number"
    if isinstance(value, tuple):  # what `plain` makes of a student's list or tuple
        return f"a list or tuple of {len(value)} item{'' if len(value) == 1 else 's'}"
    names = {
        dict: "a dictionary",
        str: "text",
        complex: "a complex number",
        TransferFunctionValue: "a transfer function",
        StateSpaceValue: "a state space",
        FigureValue: "a figure",
    }
    return next((text for kind, text in names.items() if isinstance(value, kind)), f"a {type(value).__name__}")


def as_number(name: str, value: Value) -> float:
    """Read a real number or an array of one element; raise `NoAnswer` for anything else."""
    array = _real_array(name, value, "one number")
    if array.size != 1:
        more = (
            ""
            if array.size
            else " It is empty, as `x[condition]` is where no entry meets the condition. (Numbers of many digits are "
            "hardly ever equal, `==`.)"
        )
        raise NoAnswer(f"`{name}` should be one number; it is {kind_of(value)}.{more}")
    return float(array.reshape(-1)[0])


def as_array(name: str, value: Value) -> FloatArray:
    """Read a real array of any shape, for checks that test the shape themselves."""
    return _real_array(name, value, "numbers")


def as_matrix(
    name: str, value: Value, shape: tuple[int | None, int | None], right: FloatArray | None = None
) -> FloatArray:
    """Read a real matrix; None in `shape` accepts any size. Raise `NoAnswer` for another shape.

    With the `right` matrix, the message says which column is missing or too many.
    """
    array = _real_array(name, value, "a matrix")
    wanted = ", ".join("any" if size is None else str(size) for size in shape)
    if array.ndim == 2 and array.shape != shape and _fits(array.T.shape, shape) and not _fits(array.shape, shape):
        raise NoAnswer(
            f"`{name}` has shape {array.shape}; it should have shape ({wanted}): transpose it.",
            "rows instead of columns",
        )
    if (
        array.ndim == 1
        and shape[1] is not None
        and shape[1] > 1
        and array.size > shape[1]
        and array.size % shape[1] == 0
    ):
        raise NoAnswer(
            f"`{name}` should have shape ({wanted}); it is flat, with {array.size} = {shape[1]} times "
            f"{array.size // shape[1]} numbers. `np.append`, `np.hstack` and `np.concatenate` join flat "
            "arrays end to end; `np.column_stack([...])` puts them side by side, and `np.vstack([...])` one below the "
            "other, as rows.",
            "columns joined end to end",
        )
    if array.ndim != 2 or not _fits(array.shape, shape):
        if _is_joined(array, shape):
            raise NoAnswer(
                f"`{name}` should have shape ({wanted}); its shape {array.shape} is that of {shape[1]} columns one "
                "below the other, as `np.concatenate` and `np.vstack` join them. Side by side they are joined by "
                "`np.column_stack([...])` or `np.hstack([...])`.",
                "columns joined end to end",
            )
        beside = ""
        if array.ndim == 2 and shape[1] is not None and abs(array.shape[1] - shape[1]) == 1:
            much = "too many" if array.shape[1] > shape[1] else "too few"
            beside = _odd_column(array, right) or (f" One column {much}. (A `range` leaves out its end.)")
        raise NoAnswer(f"`{name}` should have shape ({wanted}); it is {kind_of(value)}.{beside}")
    return array


def _is_joined(array: FloatArray, shape: tuple[int | None, int | None]) -> bool:
    """Whether an array has one column, as long as all columns of the wanted shape together."""
    rows, columns = shape
    return rows is not None and columns is not None and columns > 1 and array.shape == (rows * columns, 1)


def _odd_column(array: FloatArray, right: FloatArray | None) -> str:
    """Which column is too many or missing, where the others are right; empty if that cannot be told."""
    if right is None or array.shape[0] != right.shape[0]:
        return ""
    longer, shorter = (array, right) if array.shape[1] > right.shape[1] else (right, array)
    found = [j for j in range(longer.shape[1]) if np.allclose(np.delete(longer, j, axis=1), shorter)]
    if not found:
        return ""
    if longer is array:
        return f" Column `[:, {found[-1]}]` is one too many: without it, the matrix is right."
    return f" One column is missing, the one that should be `[:, {found[-1]}]`: the others are right."


def as_vector(name: str, value: Value, size: int | None = None) -> FloatArray:
    """Read a signal or a parameter vector of shape (N,) or (N, 1); a row (1, N) has its own message."""
    array = _real_array(name, value, "a vector")
    if array.ndim == 2 and array.shape[0] == 1 and array.shape[1] > 1:
        way = f"`{name}.T`" if name.isidentifier() else "transpose it with `.T`"
        raise NoAnswer(
            f"`{name}` is a row, shape {array.shape}. Make it a column: {way}.",
            "a row instead of a column",
        )
    if array.ndim == 2 and array.shape[1] == 1:
        array = array.reshape(-1)
    if array.ndim == 2 and array.shape[0] <= array.shape[1] and array.shape[0] == (size or array.shape[1]):
        is_square = array.shape[0] == array.shape[1]
        broadcast = "A column (N, 1) and a flat array (N,) in one sum or difference make such a table, and so do"
        raise NoAnswer(
            f"`{name}` should be one column of numbers; it is a table of {array.shape[0]} by "
            f"{array.shape[1]}. {broadcast if is_square else 'One way to such a table are'} `*` and `/` between "
            "matrices. (Their product is `@`, and a system of equations is solved by `np.linalg.solve`.) Print the "
            "shapes of its parts.",
            "a table in place of a vector",
        )
    if array.ndim == 0 and size is not None and size > 1:
        is_index = isinstance(value, int) and not isinstance(value, bool)
        index = f", the whole number {value}." if is_index else "."
        raise NoAnswer(
            f"`{name}` should hold {size} numbers; it is one number{index}", "one number in place of a vector"
        )
    if array.ndim != 1:
        empty = " A slice took nothing: `A[first:]` cuts rows, `A[:, first:]` columns." if array.size == 0 else ""
        raise NoAnswer(f"`{name}` should be one column of numbers; it is {kind_of(value)}.{empty}")
    if size is not None and array.size != size:
        raise NoAnswer(f"`{name}` should have {size} elements; it has {array.size}.{_off(array.size, size)}")
    return array


def _off(got: int, wanted: int) -> str:
    """How many elements are too many or too few, if they are few."""
    few = abs(got - wanted)
    if 0 < few <= _FEW and wanted > _FEW:
        more = "too many" if got > wanted else "too few"
        return f" {few} {more}. (A slice leaves out its second index.)"
    return ""


def as_column(name: str, value: Value, size: int | None = None) -> FloatArray:
    """Read a column vector of shape (N, 1), for questions about the shape itself; return it with shape (N,)."""
    array = as_vector(name, value, size)
    if np.ndim(value) != 2:  # type: ignore[arg-type]
        raise NoAnswer(
            f"`{name}` has shape {np.shape(value)}: it is one-dimensional. "  # type: ignore[arg-type]
            f"A column vector has shape ({array.size}, 1): use `np.reshape({name}, (-1, 1))`.",
            "flat instead of a column",
        )
    return array


def as_theta(call: str, value: Value, size: int) -> FloatArray:
    """Read a parameter vector; the whole result of `lstsq` has its own message."""
    if isinstance(value, tuple) and len(value) == 4:
        raise NoAnswer(
            f"`{call}` returns the whole result of `lstsq`: return its first element, `[0]`.", "all of lstsq"
        )
    return as_vector(call, value, size)


def as_history(call: str, value: Value, rows: int, p: int) -> FloatArray:
    """Read the history of an estimate, shape (rows, p); common wrong shapes have their own message."""
    if isinstance(value, np.ndarray):
        if value.shape == (rows, p, 1):
            value = value[:, :, 0]
        if value.size == p and rows > 1:
            raise NoAnswer(
                f"`{call}` returns one estimate; return the whole history, one row for every sample.",
                "only the last estimate",
            )
        if value.shape == (rows + 1, p):
            raise NoAnswer(
                f"`{call}` has one row too many: leave out the start value theta(0).",
                "history begins with theta(0)",
            )
    return as_matrix(call, value, (rows, p))


def as_figure(name: str, value: Value, axes: int | None = None) -> FigureValue:
    """Read a figure, with the given number of axes."""
    if not isinstance(value, FigureValue):
        if value is None:
            said = "should be a figure; it is nothing (None), as the result of a function without `return` is"
        else:
            said = f"should be the figure itself, the first that `plt.subplots()` returns; it is {kind_of(value)}"
        raise NoAnswer(f"`{name}` {said}.", "not the figure")
    if axes is not None and len(value.axes) != axes:
        raise NoAnswer(
            f"`{name}` should have {axes} subplot{'s' if axes > 1 else ''}; it has {len(value.axes)}.",
            "number of panels",
        )
    return value


def close(relative: float, absolute: float = 0.0) -> Callable[[ArrayLike, ArrayLike], bool]:
    """Make a comparison of numbers or arrays: ``|a - b| <= absolute + relative * max|b|``, shapes equal.

    The tolerance scales with the largest element, as the rounding errors of small elements do.
    """

    def same(a: ArrayLike, b: ArrayLike) -> bool:
        x, y = np.asarray(a, float), np.asarray(b, float)
        if x.shape != y.shape or x.size == 0 or not np.isfinite(y).all():
            return False
        return bool(np.all(np.abs(x - y) <= absolute + relative * np.max(np.abs(y))))

    return same


SAME = close(1e-6)
"""For results of one computation. The normal equations square the condition number, and a large initial P magnifies
rounding; the trials are conditioned well enough for this tolerance."""


def _real_array(name: str, value: Value, wanted: str) -> FloatArray:
    """Read real numbers; complex ones without an imaginary part are real, and single precision is refused."""
    if isinstance(value, (bool, int, float, complex)):
        value = np.asarray(value)
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "biufc":
        raise NoAnswer(f"`{name}` should be {wanted}; it is {kind_of(value)}.")
    if value.dtype.kind == "c":
        if np.any(value.imag != 0):
            raise NoAnswer(
                f"`{name}` should be {wanted}; it is {kind_of(value)}. {_imaginary(value)}", "imaginary part"
            )
        value = value.real
    if value.dtype.itemsize < 8 and value.dtype.kind == "f":
        raise NoAnswer(
            f"`{name}` has the type {value.dtype}, which keeps only {np.finfo(value.dtype).precision + 1} digits, and "
            "the comparison needs more. Compute in double precision, numpy's own `float`: leave the type out.",
            SINGLE_PRECISION,
        )
    array = value.astype(np.float64)
    if not np.all(np.isfinite(array)):
        first = tuple(np.argwhere(~np.isfinite(array))[0])
        where = f" (at [{', '.join(map(str, first))}])" if first else ""
        raise NoAnswer(
            f"`{name}` holds {array[first]}{where}: check the computation before it. {_not_finite(float(array[first]))}"
        )
    return array


def _not_finite(number: float) -> str:
    """What gives a number that is none."""
    if np.isnan(number):
        return "(0/0 gives nan, and so does the root or the logarithm of a negative number.)"
    return "(A division by zero gives inf, and so does a number that grows beyond all bounds.)"


def _imaginary(value: NDArray[np.complex128]) -> str:
    """What the imaginary part of numbers is, and which part is meant."""
    largest = float(np.max(np.abs(value.imag)))
    if largest <= _ROUNDING * np.max(np.abs(value)):
        return "Its imaginary part is only rounding: take the real part with `np.real`."
    return (
        f"Its imaginary part is no rounding, it goes up to {largest:.3g}. Asked for are real numbers: `np.abs` is the "
        "size, `np.real` the real part."
    )


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(w is None or s == w for s, w in zip(shape, wanted, strict=True))
