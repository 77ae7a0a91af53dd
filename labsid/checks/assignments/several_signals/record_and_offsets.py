"""Checks of the arrays of several signals as they are read, and of their offsets."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.compare import SAME, as_array, as_matrix, as_number
from labsid.checks.question import Ask, returned_parts
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.lab.offset import find_signal_offsets
from labsid.rig.lab.heaters import SAMPLES, TS, heater_signals


@first_failure
def check_read(ask: Ask) -> Iterator[Verdict]:
    """`u`, `y` and `Ts` of the log."""
    u, y = heater_signals()
    for name, right, other_signal, symbols in (("u", u, y, ("Q", "T")), ("y", y, u, ("T", "Q"))):
        yield _judge_signals(name, ask.value(name), right, other_signal, symbols)
    value = ask.value("Ts")
    if np.size(value) == SAMPLES and np.allclose(np.diff(np.ravel(value)), TS):  # type: ignore[arg-type]
        yield Verdict(
            False, "`Ts` holds all times: it is the step from one to the next.", "times for the sampling time"
        )
    Ts = as_number("Ts", value)
    yield judge(
        np.array(Ts),
        np.array(TS),
        SAME,
        "one row for each sample, one column for each signal.",
        "`Ts` is not the time in seconds from one row of the log to the next: `record.Ts` has it.",
        [Slip("samples for seconds", "`Ts` counts samples; it is a time in seconds.", lambda: np.array(1.0))],
    )


def right_read(_: Ask) -> dict[str, Value]:
    """Step 1."""
    u, y = heater_signals()
    return {"u": u, "y": y, "Ts": TS}


def _judge_signals(
    name: str, value: Value, right: FloatArray, other_signal: FloatArray, symbols: tuple[str, str]
) -> Verdict:
    got = as_array(name, value)
    own, others = symbols
    if got.ndim == 1 and any(SAME(got, column) for column in (*right.T, *other_signal.T)):
        return Verdict(
            False,
            f"`{name}` holds one signal, flat; it should hold two, side by side, shape ({SAMPLES}, 2). `record.{name}` "
            "holds both of them, if both columns were named when the record was read.",
            "one signal only",
        )
    if got.shape == (2, SAMPLES) and SAME(got.T, right):
        return Verdict(
            False,
            f"`{name}` has a row for each signal; samples go down and signals go across, shape ({SAMPLES}, 2).",
            "signals in rows",
        )
    got = as_matrix(name, value, (None, 2))
    mixed = f"`{name}` holds a power and a temperature. The columns of the log alternate: choose them by their names."
    return judge(
        got,
        right,
        SAME,
        "",
        f"`{name}` does not hold {own}1 and {own}2 of the log, as they are recorded.",
        [
            Slip(
                "u and y swapped", f"`{name}` holds {others}1 and {others}2: powers are inputs.", lambda: other_signal
            ),
            Slip(
                "columns swapped",
                f"the columns of `{name}` are in the wrong order: {own}1, then {own}2.",
                lambda: right[:, ::-1],
            ),
            *(
                Slip("columns by number", mixed, partial(np.column_stack, pair))
                for i in range(2)
                for j in range(2)
                for pair in ([right[:, i], other_signal[:, j]], [other_signal[:, j], right[:, i]])
            ),
            Slip(
                "offset taken off",
                f"`{name}` is without its offset; step 1 asks for the log as it is.",
                lambda: right - right[0],
            ),
            Slip("one signal twice", f"both columns of `{name}` are the same signal.", lambda: right[:, [0, 0]]),
            Slip("one signal twice", f"both columns of `{name}` are the same signal.", lambda: right[:, [1, 1]]),
        ],
    )


@first_failure
def check_offsets(ask: Ask) -> Iterator[Verdict]:
    """`without_offsets(u, y)`, with each of the inputs moving first in turn."""
    for nu, ny, first in ((2, 2, 0), (3, 2, 1), (2, 2, 1), (3, 2, 2), (2, 3, 1)):
        yield _judge_offsets(ask, *_trial(ask.rng, nu, ny, first))
    yield Verdict(True, "the rest ends when the first input moves, for all outputs.")


def _trial(rng: np.random.Generator, nu: int, ny: int, first: int) -> tuple[FloatArray, FloatArray]:
    """Held inputs, of which `first` moves before the others, and outputs that all rise from then on."""
    starts = int(rng.integers(8, 14)) + np.arange(nu) * int(rng.integers(7, 11))
    starts[first], starts[0] = starts[0], starts[first]
    k = np.arange(70)
    u = rng.uniform(1, 3, nu) + rng.uniform(0.5, 1.5, nu) * (k[:, np.newaxis] >= starts)
    rise = 1 - np.exp(-np.maximum(k - starts[first], 0) / 6)
    y = rng.uniform(3, 9, ny) + np.outer(rise, rng.uniform(1, 2, ny)) + 0.05 * rng.standard_normal((k.size, ny))
    return u, y


def _judge_offsets(ask: Ask, u: FloatArray, y: FloatArray) -> Verdict:
    parts = returned_parts(ask, "without_offsets", "two arrays, u and y", 2, u, y)
    _require_a_rest(ask, parts[1])
    got_u, got_y = (
        as_matrix(f"{name} of without_offsets(u, y)", part, array.shape)
        for name, part, array in zip("uy", parts, (u, y), strict=True)
    )
    offsets = find_signal_offsets(u, y)
    n = offsets.outputs[0].first_period
    starts = [int(np.argmax(column != column[0])) for column in u.T]
    verdict = judge(
        got_u,
        u - offsets.u_offset,
        SAME,
        "",
        "u of `without_offsets` should be u without its first row: the offset of an input is its first value.",
        [
            Slip(
                "mean taken off",
                "`without_offsets` takes the mean off the inputs; their offset is the first value.",
                lambda: u - u.mean(axis=0),
            ),
            Slip("offset left in", "`without_offsets` returns u as it is: take its first row off.", lambda: u),
            Slip(
                "one offset for all",
                "`without_offsets` takes one offset off all inputs: each has its own.",
                lambda: u - u[0, 0],
            ),
            Slip(
                "one offset for all",
                "`without_offsets` takes one offset off all inputs: each has its own.",
                lambda: u - u[0].mean(),
            ),
        ],
    )
    rests = [y - y[:stop].mean(axis=0) for stop in (n, n + 1)]  # y(n) does not know of the step at n yet
    if not verdict.passed or any(SAME(got_y, rest) for rest in rests):
        return verdict
    own = [starts[min(i, len(starts) - 1)] for i in range(y.shape[1])]
    entry = int(np.argmax(u != u[0]))
    last = (
        "`without_offsets` ends the rest when the last input moves, or one certain input: it ends when the *first* of "
        "them does, `np.any(..., axis=1)`."
    )
    late = "takes the mean of each output until its own input moves. By then another input has moved it."
    of_all = (
        "`without_offsets` takes one offset off all outputs. `mean` without `axis=0` is one number for the whole table."
    )
    return judge(
        got_y,
        rests[0],
        SAME,
        "",
        "y of `without_offsets` is off: for each column the mean over the samples before any input has changed.",
        [
            Slip("rest until its own input moves", f"`without_offsets` {late}", lambda: _means_off(y, own)),
            *(
                Slip("rest of one input", last, partial(_means_off, y, [stop] * y.shape[1]))
                for stop in (max(starts), max(starts) + 1)
            ),
            Slip(
                "entries for samples",
                "`without_offsets` counts entries of the table, and not samples: `np.argmax` of a table goes through "
                "all its entries, row by row. Make one True or False of each row first, `np.any(..., axis=1)`.",
                lambda: _means_off(y, [entry] * y.shape[1]),
            ),
            *(
                Slip(
                    "rest of one input",
                    "`without_offsets` ends the rest when one certain input moves. Another one may have moved before.",
                    partial(_means_off, y, [stop] * y.shape[1]),
                )
                for start in starts
                for stop in (start, start + 1)
                if start != n
            ),
            Slip("one offset for all", of_all, lambda: y - y[:n].mean()),
            Slip("one offset for all", of_all, lambda: y - y[:n, 0].mean()),
            Slip(
                "mean of the whole record",
                "`without_offsets` takes off the means of the whole record, not those of the rest.",
                lambda: y - y.mean(axis=0),
            ),
            Slip(
                "first sample",
                "`without_offsets` takes the first sample of y for the rest. It has noise: take the mean.",
                lambda: y - y[0],
            ),
            Slip("offset left in", "`without_offsets` returns y as it is.", lambda: y),
            Slip(
                "mean of each row",
                "`without_offsets` takes means over the signals: `axis=0` goes over the samples.",
                lambda: y - y.mean(axis=1, keepdims=True),
            ),
            *(
                Slip(
                    "rest of a fixed length",
                    f"`without_offsets` takes the means of the first {stop} samples. The inputs tell how long the rest "
                    f"is: here one of them moves at sample {n}.",
                    partial(_means_off, y, [stop] * y.shape[1]),
                )
                for stop in range(2, len(y))
            ),
        ],
    )


def _require_a_rest(ask: Ask, y: Value) -> None:
    """Refuse outputs that are nan throughout: the mean over no sample was taken off."""
    if not (isinstance(y, np.ndarray) and y.dtype.kind == "f" and y.size and np.isnan(y).all()):
        return
    code = code_of(ask, "without_offsets")
    whole = next((name for name in ("any", "all") if code is not None and code.calls_without(name, "axis")), "")
    cause = (
        f"`np.{whole}` of the whole table is one True or False, and the index of the first True is then 0: "
        f"`np.{whole}(..., axis=1)` gives one for each sample."
        if whole
        else "Print the number of samples over which the mean goes."
    )
    raise NoAnswer(
        f"y of `without_offsets(u, y)` is nan throughout, as where the mean of *no* sample is taken off. {cause}",
        "mean of no sample",
    )


def _means_off(y: FloatArray, stops: list[int]) -> FloatArray:
    return y - [y[:stop, i].mean() for i, stop in enumerate(stops)]
