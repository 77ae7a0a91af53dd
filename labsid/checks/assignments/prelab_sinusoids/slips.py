"""Known mistakes in the pre-lab with time, cutting and stacking, and the values that they give."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray
from labsid.checks.verdict import Slip

CUT = 200
Slips = list[Slip[FloatArray]]


def time_slips() -> Slips:
    """Mistakes of step 1, the time vector."""

    def slip(name: str, hint: str, wrong: ArrayLike) -> Slip[FloatArray]:
        return Slip(name, f"`t` {hint}", lambda: np.asarray(wrong, np.float64))

    return [
        slip(
            "end left out",
            "stops before 100 s: `np.arange` excludes its end; `np.linspace` includes it.",
            np.arange(1000) * 0.1,
        ),
        slip(
            "1000 points",
            "has 1000 points, a little more than 0.1 s apart. It includes both 0 s and 100 s: count again.",
            np.linspace(0, 100, 1000),
        ),
        slip("does not start at zero", "starts at 0.1 s; it should start at 0.", np.arange(1, 1001) * 0.1),
        slip("spacing of 1 s", "has steps of 1 s; they should be 0.1 s.", np.arange(101.0)),
        slip("spacing of 0.01 s", "has steps of 0.01 s; they should be 0.1 s.", np.arange(10001) * 0.01),
        slip("100 points", "has 100 points; see step 1 for the right number.", np.linspace(0, 100, 100)),
        slip(
            "sample number in place of time",
            "counts the samples; in seconds they are 0.1 apart.",
            np.arange(1001.0),
        ),
    ]


def new_time_slips(t: FloatArray) -> Slips:
    """Mistakes of step 3, the remaining time."""
    return [
        Slip(
            "time not set back to zero",
            "`t_new` starts at 20 s: subtract its first time from it, so that it starts from zero.",
            lambda: t[CUT:],
        ),
        *(
            Slip(
                "20 samples cut off",
                "`t_new` lacks 20 samples: 20 s are 200 samples, as they are 0.1 s apart.",
                partial(np.subtract, t[CUT // 10 :], start),
            )
            for start in (0.0, t[CUT // 10], t[CUT])
        ),
        Slip("not cut", "`t_new` is still the whole of `t`.", lambda: t),
        *(
            Slip(
                "set to zero",
                "the first 200 samples of `t_new` are set to zero: they should be cut off, so that 801 are left.",
                partial(np.where, np.arange(t.size) < CUT, 0.0, t - start),
            )
            for start in (0.0, t[CUT])
        ),
        Slip(
            "rolled",
            "`t_new` has the first 200 samples at its end: `np.roll` goes round. Cut them off, `t[200:]`.",
            lambda: np.roll(t, -CUT),
        ),
        Slip(
            "the last samples cut off",
            "`t_new` lacks the last 200 samples; the first 200 should go, and then the start be set to zero.",
            lambda: t[:-CUT],
        ),
        Slip("the wrong part kept", "`t_new` holds the 200 samples that should be removed.", lambda: t[:CUT]),
        *_off_by_one("t_new", lambda first: t[first:] - t[first]),
        *_off_by_one("t_new", lambda first: t[first:]),
        *_off_by_one("t_new", lambda first: t[first:] - t[CUT]),
        Slip(
            "time set back by the wrong amount",
            "`t_new` does not start from zero: subtract the time of its own first sample.",
            lambda: t[CUT:] - t[CUT - 1],
        ),
        Slip(
            "samples taken for seconds",
            "`t_new` was shifted by 200 s; 200 is the number of samples, not the time.",
            lambda: t[CUT:] - CUT,
        ),
    ]


def new_signal_slips(name: str, y: FloatArray, other: FloatArray) -> Slips:
    """Mistakes of step 3 in `name`, the remaining samples of `y`; `other` is the second sinusoid."""
    return [
        Slip("not cut", f"`{name}` is still the whole of `{name[:2]}`: cut it like `t`.", lambda: y),
        Slip(
            "the last samples cut off",
            f"`{name}` lacks the last 200 samples; the first 200 should go.",
            lambda: y[:-CUT],
        ),
        Slip(
            "set to zero",
            f"the first 200 samples of `{name}` are set to zero: they should be cut off, `{name[:2]}[200:]`.",
            lambda: np.where(np.arange(y.size) < CUT, 0.0, y),
        ),
        Slip(
            "rolled",
            f"`{name}` has the first 200 samples at its end: `np.roll` goes round. Cut them off, `{name[:2]}[200:]`.",
            lambda: np.roll(y, -CUT),
        ),
        Slip("the wrong part kept", f"`{name}` holds the 200 samples that should be removed.", lambda: y[:CUT]),
        *_off_by_one(name, lambda first: y[first:]),
        Slip("y1 and y2 swapped", f"`{name}` was cut from the other signal.", lambda: other[CUT:]),
        Slip(
            "values set back to zero",
            f"`{name}` starts from zero: only the time should; the signal keeps its values.",
            lambda: y[CUT:] - y[CUT],
        ),
    ]


def matrix_slips(parts: Sequence[FloatArray], uncut: Sequence[FloatArray], shape: tuple[int, ...]) -> Slips:
    """Mistakes of step 4, the matrix of `parts`; `shape` is the shape of the answer."""
    t, y1, y2 = parts
    orders = ([t, y2, y1], [y1, y2, t], [y1, t, y2], [y2, t, y1], [y2, y1, t])
    return [
        Slip(
            "rows instead of columns",
            "`data_new` has three rows. Put the vectors side by side, as columns: `np.hstack`.",
            lambda: np.array(parts),
        ),
        Slip(
            "stacked end to end",
            "`data_new` has the vectors one below the other. Put them side by side: `np.hstack`.",
            lambda: np.concatenate(parts).reshape(shape) if max(shape) == shape[0] else np.empty(0),
        ),
        Slip(
            "stacked along a new axis",
            f"`data_new` has {len(shape)} dimensions: `np.array([...])` stacks along a new one. Use `np.hstack`.",
            lambda: np.array([part[:, None] for part in parts]),
        ),
        Slip(
            "stacked along a new axis",
            "`data_new` has 3 dimensions: `np.array([...])` of columns stacks along a new one, and `.T` turns all "
            "three. Use `np.hstack`.",
            lambda: np.array([part[:, None] for part in parts]).T,
        ),
        Slip(
            "not cut",
            "`data_new` holds the original data; put the cut-off vectors into it.",
            lambda: np.column_stack(uncut),
        ),
        Slip(
            "time not set back to zero",
            "`data_new` holds the old time: its first column starts at 20 s. Use `t_new`.",
            lambda: np.column_stack([uncut[0][CUT:], y1, y2]),
        ),
        *(_swapped_columns(order) for order in orders),
    ]


def cut_off_slips(data: FloatArray, n: int) -> Slips:
    """Mistakes in the function cut_off(data, n)."""

    def slip(name: str, hint: str, wrong: Callable[[], FloatArray]) -> Slip[FloatArray]:
        return Slip(name, f"`cut_off` {hint}", wrong)

    def rest(first: int, last: int | None = None) -> FloatArray:
        part = data[first:last].copy()
        part[:, 0] -= part[0, 0]
        return part

    last_off = ("the last samples cut off", "removes the last n rows; it should remove the first n.")
    kept = ("the wrong part kept", "returns the n rows that it should remove.")
    one_more = (
        "off by one",
        "removes one row too many: rows are counted from 0, so row n is the first to keep.",
    )
    return [
        slip(
            "time not set back to zero",
            "leaves the time unchanged: let it start from zero.",
            lambda: data[n:],
        ),
        slip(
            "time subtracted from every column",
            "subtracts the first time from every column: only the time, the first column, starts from zero.",
            lambda: data[n:] - data[n, 0],
        ),
        slip(*last_off, lambda: rest(0, -n)),
        slip(*last_off, lambda: data[:-n]),
        *(
            slip(
                "set to zero", "sets the first n rows to zero: they should be cut off.", partial(_zeros_on_top, made, n)
            )
            for made in (data, data - data[n, 0] * np.eye(1, data.shape[1]))
        ),
        *(
            slip(
                "rolled",
                "brings the first n rows to the end: `np.roll` goes round. Cut them off.",
                partial(np.copy, made),
            )
            for made in _rolled(data, n)
        ),
        *(
            slip(
                "every second row deleted",
                "deletes rows in a loop whose index grows: after row 0 is gone, row 1 is what was row 2, so every "
                "second row stays. `data[n:]` is all rows from n on.",
                partial(_deleted_in_a_loop, data, n, back),
            )
            for back in (True, False)
        ),
        slip(*kept, lambda: data[:n]),
        slip(*kept, lambda: rest(0, n)),
        slip(*one_more, lambda: rest(n + 1)),
        slip(*one_more, lambda: data[n + 1 :]),
        slip("off by one", "removes one row too few: remove rows 0 to n - 1.", lambda: rest(n - 1)),
        slip("always 200 samples", "always removes 200 rows: use the argument n.", lambda: rest(CUT)),
        slip(
            "time set back by a fixed 20 s",
            "always subtracts 20 s from the time. Subtract the time of the first row that remains.",
            lambda: data[n:] - 20 * np.eye(1, data.shape[1]),
        ),
        slip(
            "sampling time of 0.1 s assumed",
            "subtracts n times 0.1 s from the time; other data have another sampling time or start. Subtract the time "
            "of the first row that remains.",
            lambda: data[n:] - 0.1 * n * np.eye(1, data.shape[1]),
        ),
        slip(
            "samples taken for seconds",
            "subtracts n, a number of samples, from the time. Subtract the time of the first row that remains.",
            lambda: data[n:] - n * np.eye(1, data.shape[1]),
        ),
        slip(
            "time set back by its first value",
            "subtracts the first time of `data` itself. Subtract the time of the first row that remains.",
            lambda: data[n:] - data[0, 0] * np.eye(1, data.shape[1]),
        ),
        slip(
            "time replaced by the sample number",
            "numbers the rows in place of their time: keep the times, less the first that remains.",
            lambda: np.column_stack([np.arange(len(data) - n), data[n:, 1:]]),
        ),
        slip(
            "time left out",
            "sets the whole first column to zero. Subtract from it its own first value.",
            lambda: np.column_stack([np.zeros(len(data) - n), data[n:, 1:]]),
        ),
        slip(
            "a variable from above used",
            "returns the time of `t_new`, not that of its argument: use only `data` and `n`.",
            lambda: np.column_stack([0.1 * np.arange(len(data) - n), data[n:, 1:]]),
        ),
        slip(
            "all columns set back",
            "starts every column from zero; only the time should.",
            lambda: data[n:] - data[n],
        ),
    ]


def _deleted_in_a_loop(data: FloatArray, n: int, back: bool) -> FloatArray:
    """The rows that stay when row i is deleted for i = 0 to n - 1, with the time set back to zero or not."""
    rest = data
    for i in range(n):
        rest = np.delete(rest, i, axis=0)
    return rest - back * rest[0, 0] * np.eye(1, data.shape[1])


def _zeros_on_top(data: FloatArray, n: int) -> FloatArray:
    return np.concatenate([np.zeros_like(data[:n]), data[n:]])


def _rolled(data: FloatArray, n: int) -> tuple[FloatArray, FloatArray]:
    """The data with their beginning at the end, and with the time of its new first row taken off."""
    round_ = np.roll(data, -n, axis=0)
    return round_, round_ - round_[0, 0] * np.eye(1, data.shape[1])


def _off_by_one(name: str, cut_from: Callable[[int], FloatArray]) -> Slips:
    return [
        Slip(
            "off by one",
            f"`{name}` has one sample too few: counted from 0, the first sample to keep is number 200, and a slice "
            "leaves out its last index.",
            lambda: cut_from(CUT + 1),
        ),
        Slip(
            "off by one",
            f"`{name}` has one sample too many: the first 200 samples are the rows 0 to 199.",
            lambda: cut_from(CUT - 1),
        ),
    ]


def _swapped_columns(order: Sequence[FloatArray]) -> Slip[FloatArray]:
    return Slip(
        "columns in another order",
        "`data_new` has its columns in the wrong order; it should be t_new, y1_new, y2_new.",
        lambda: np.column_stack(order),
    )
