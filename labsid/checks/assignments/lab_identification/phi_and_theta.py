"""Checks of Phi, Y and theta, for any order and any valid first row."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.lab_identification.lab_data import LabData
from labsid.checks.compare import as_array, as_matrix, as_vector, close
from labsid.checks.parts_of_a_solution import require_whole_solution
from labsid.checks.question import Ask
from labsid.checks.regressions import LEFT_SIDE, beside_right_rows, slips_of_formula, told_columns, zero_rows
from labsid.checks.relations import relation
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, judge
from labsid.lab.arx import fit_arx
from labsid.lab.regressor import build_phi
from labsid.least_squares.solve import solve_least_squares

SAME = 1e-8
LATEST_START = 0.5
"""Latest first row, as a share of the first half."""

Equations = tuple[FloatArray, FloatArray]


def judge_equations(ask: Ask, names: tuple[str, str], data: LabData, order: int) -> Verdict:
    """Judge ``(Phi, Y)`` made from the first half of the data: rows [y(k-1).., u(k-1)..] and y(k) for consecutive k.

    The first half may end a sample earlier or later, the first row may be any up to `LATEST_START`, and samples before
    the record may be zero or equal to the first sample.
    """
    Phi = _read_phi(names[0], ask.value(names[0]), order)
    Y = as_vector(names[1], ask.value(names[1]))
    rows = Y.size
    if rows != Phi.shape[0]:
        beside = _beside(Phi, Y, names, data, order, _ends_of_first_half(data.y.size))
        raise NoAnswer(
            f"`{names[0]}` has {Phi.shape[0]} rows and `{names[1]}` {rows} elements; each equation needs one row and "
            f"one element. {beside}".rstrip(),
            "Phi and Y of different lengths",
        )
    if rows < 2 * order:
        raise NoAnswer(
            f"{rows} equations are fewer than the {2 * order} unknowns: use the whole first half.", "too few equations"
        )
    got = Phi, Y
    N = data.y.size
    for stop in _ends_of_first_half(N):
        start = stop - rows
        if start >= 0 and _is_built_from(got, data.u, data.y, order, start, stop):
            if start > LATEST_START * data.half:
                hint = f"The rows are right, but begin only at k = {start}, which omits most of the first half."
                return Verdict(False, hint, "late start")
            rest = " Samples before the record are at rest." if start < order else ""
            return Verdict(True, f"{rows} equations for {2 * order} unknowns, from k = {start} to {stop - 1}.{rest}")
    beside = _beside(Phi, Y, names, data, order, range(data.half, data.half + 1))
    if beside:
        return Verdict(False, beside, LEFT_SIDE)
    named = _known_mistake(got, names, data, order)
    if named is not None:
        return named
    beside = _beside(Phi, Y, names, data, order, _ends_of_first_half(N))
    if beside:
        return Verdict(False, beside, LEFT_SIDE)
    row = "[y[k-1], u[k-1]]" if order == 1 else "[y[k-1], y[k-2], u[k-1], u[k-2]]"
    otherwise = (
        f"`{names[0]}` and `{names[1]}` are not the equations of the first half. Take one row, k = 10 say: it should "
        f"be {row}, with y[k] in `{names[1]}`. It is row 10 minus your first k. Compare it with yours."
    )
    zeros = _zero_rows(got, names[0], data, order)
    if zeros:
        return Verdict(False, zeros, "rows of zeros")
    columns = told_columns(names, Phi, Y, data.y, data.u, order)
    if columns:
        return Verdict(False, columns, "other columns")
    return Verdict(False, _wrong_columns(got, names[0], data, order) or otherwise)


def _beside(Phi: FloatArray, Y: FloatArray, names: tuple[str, str], data: LabData, order: int, stops: range) -> str:
    """What Y holds, where Phi is right up to one of these ends; empty where it is not."""
    for stop in stops:
        start = stop - Phi.shape[0]
        if start >= 0 and _is_built_from((Phi, data.y[start:stop]), data.u, data.y, order, start, stop):
            quoted = f"`{names[0]}`", f"`{names[1]}`"
            return beside_right_rows(quoted, Y, data.y, data.u, range(start, stop))
    return ""


def _zero_rows(got: Equations, name: str, data: LabData, order: int) -> str:
    """That rows of Phi are zero whose samples were recorded; empty if something else is wrong."""
    for stop in _ends_of_first_half(data.y.size):
        start = stop - got[1].size
        if not 0 <= start < order:
            continue
        zeros = zero_rows(got[0], build_phi(data.u, data.y, order, start, stop).Phi)
        if zeros:
            which = f"Row {zeros[0]}" if len(zeros) == 1 else f"Rows {zeros[0]} to {zeros[-1]}"
            return (
                f"{which} of `{name}` should not be all zeros: only samples before the record are zero, and y[0] and "
                f"u[0] are in it. Begin with the row of k = {order}, or put in the samples that there are."
            )
    return ""


def _wrong_columns(got: Equations, name: str, data: LabData, order: int) -> str:
    """Which columns of Phi are wrong, where the others and Y are those of the first half; empty otherwise."""
    for stop in _ends_of_first_half(data.y.size):
        start = stop - got[1].size
        if start < order:
            continue
        right = build_phi(data.u, data.y, order, start, stop)
        related = relation(got[0], right.Phi, close(SAME, SAME))
        if np.allclose(got[1], right.Y, rtol=SAME, atol=SAME) and related.startswith("Column"):
            asked = ", ".join([f"y[k-{i}]" for i in range(1, order + 1)] + [f"u[k-{i}]" for i in range(1, order + 1)])
            return f"The rows of `{name}` for y[k] should be [{asked}]. {related}"
    return ""


def right_equations(names: tuple[str, str], data: LabData, order: int) -> dict[str, Value]:
    """Phi and Y from the first row for which all samples were recorded."""
    made = build_phi(data.u, data.y, order, stop=data.half)
    return {names[0]: made.Phi, names[1]: made.Y}


def judge_theta(ask: Ask, name: str, Phi: FloatArray, Y: FloatArray, data: LabData, order: int) -> Verdict:
    """Judge the least-squares solution of the equations of the step before."""
    value = ask.value(name)
    if isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 4:
        raise NoAnswer(
            f"`{name}` is the whole result of `lstsq`: solution, residual, rank, singular values. Take the first, "
            "`[0]`.",
            "all that lstsq returns",
        )
    swapped = np.asarray(Y @ Phi / (Y @ Y), float)
    if isinstance(value, np.ndarray) and value.size == swapped.size and close(1e-6)(np.ravel(value), swapped):
        raise NoAnswer(
            f"`{name}` fits each column of Phi to Y: the arguments of `lstsq` are swapped. Phi comes first, then Y.",
            "arguments of lstsq swapped",
        )
    right = solve_least_squares(Phi, Y).theta
    require_whole_solution(name, value, Phi.T @ Phi, Phi.T @ Y, before_y=Phi.T)
    got = as_vector(name, value, right.size if np.ndim(value) == 2 else None)  # type: ignore[arg-type]
    if got.size == right.size + 1 and _has_a_constant(got, Phi, Y):
        raise NoAnswer(
            f"`{name}` has one element too many: it was fitted with a column of ones beside Phi. The model has no "
            "constant, because the signals are offset-free.",
            "a constant fitted along",
        )
    if got.size != right.size:
        sse = float(np.sum((Y - Phi @ right) ** 2))
        if got.size == 1 and abs(got[0] - sse) <= 1e-6 * sse:
            raise NoAnswer(
                f"`{name}` is the sum of the squared errors, {got[0]:.4g}, which `lstsq` returns as `[1]`: theta is "
                "`[0]`.",
                "another entry of lstsq",
            )
        raise NoAnswer(f"`{name}` should have {right.size} elements, one for each column of Phi; it has {got.size}.")
    sign = np.repeat([-1.0, 1.0], order)
    slips = [
        Slip(
            "sign of a",
            f"`{name}` is [-a, b]. Keep its signs as eq. (8) gives them.",
            lambda: sign * right,
        ),
        Slip("sign of theta", f"All signs of `{name}` are wrong: the error is E = Y - Phi theta.", lambda: -right),
        Slip(
            "order of theta",
            f"`{name}` has the wrong order: use that of the columns of Phi.",
            lambda: np.roll(right, order),
        ),
        Slip("order of theta", f"`{name}` has the wrong order: use that of the columns of Phi.", lambda: right[::-1]),
        Slip(
            "inverse left out",
            f"`{name}` is Phi'Y: multiply it by the inverse of Phi'Phi, as in eq. (8).",
            lambda: Phi.T @ Y,
        ),
        Slip(
            "inverse left out",
            "Phi'Phi is used where its inverse should be in eq. (8).",
            lambda: Phi.T @ Phi @ (Phi.T @ Y),
        ),
        Slip(
            "divided element by element",
            "`** -1` inverts the entries of Phi'Phi one by one. The inverse of a matrix is `np.linalg.inv`, or use "
            "`np.linalg.solve`.",
            lambda: (Phi.T @ Phi) ** -1.0 @ Phi.T @ Y,
        ),
        *slips_of_formula(f"`{name}`", Phi, Y, ", because the signals are offset-free"),
        *rounded(right, f"`{name}` is rounded: keep all its digits."),
        *_wrong_fits(name, data, order),
    ]
    left_side, side = Phi.T @ Phi @ got, Phi.T @ Y
    otherwise = (
        f"`{name}` does not solve eq. (8) for your Phi and Y, (Phi'Phi) theta = Phi'Y: with yours the first entry on "
        "the "
        f"left is {left_side[0]:.4g}, and on the right {side[0]:.4g}."
    )
    praise = "The least-squares solution for your equations."
    return judge(got, right, close(1e-6), praise, otherwise, slips)


def rounded(theta: FloatArray, hint: str) -> Iterator[Slip[FloatArray]]:
    """Parameters that were rounded to a few digits after the decimal point."""

    def to(digits: int) -> FloatArray:
        return np.asarray(np.round(theta, digits), float)

    for digits in range(1, 6):
        yield Slip("rounded", hint, partial(to, digits))


def _wrong_fits(name: str, data: LabData, order: int) -> Iterator[Slip[FloatArray]]:
    def slip(short: str, hint: str, u: FloatArray, y: FloatArray, start: int, stop: int) -> Slip[FloatArray]:
        return Slip(short, hint, lambda: fit_arx(u, y, data.Ts, order, start, stop).model.theta)

    for larger in (order + 1, order + 2):
        theta = fit_arx(data.u, data.y, data.Ts, larger, larger, data.half).model.theta
        text = (
            f"`{name}` holds entries of the theta of order {larger}. They were fitted together with those that are "
            f"left out: the model of order {order} is fitted by itself, with a Phi of {2 * order} columns."
        )
        for kept in ([*range(order), *range(larger, larger + order)], [*range(2 * order)]):
            yield Slip("part of a larger model", text, partial(np.take, theta, kept))
    hint = f"`{name}` was fitted on all the data. Fit on the first half; the second is for verification."
    for start in range(order + 1):
        yield slip("fit on all the data", hint, data.u, data.y, start, data.y.size)
        for short, text, u, y in data.wrong_signals():
            yield slip(short, f"{text} Build Phi from them again.", u, y, start, data.half)


def _read_phi(name: str, value: Value, order: int) -> FloatArray:
    array = as_array(name, value)
    if array.ndim == 1 and array.size > 4 * order and array.size % (2 * order) == 0:
        rows = array.size // (2 * order)
        raise NoAnswer(
            f"`{name}` is flat, with {array.size} = {2 * order} times {rows} numbers: the columns are "
            "joined end to end. `np.hstack` and `np.concatenate` do that with flat arrays; `np.column_stack([...])` "
            "puts them side by side.",
            "columns joined end to end",
        )
    if array.ndim == 3 and 1 in array.shape:
        array = array.squeeze()
    if array.ndim == 2 and array.shape[0] == 2 * order and array.shape[1] > 2 * order:
        raise NoAnswer(
            f"`{name}` has shape {array.shape}: transpose it. An equation is a row, a regressor is a column.",
            "transposed Phi",
        )
    constant = array.ndim == 2 and array.shape[1] == 2 * order + 1 and np.any(np.ptp(array, axis=0) == 0)
    if constant:
        raise NoAnswer(
            f"`{name}` has a column of ones. The model has no constant, because the signals are offset-free: leave "
            "this column out.",
            "a constant fitted along",
        )
    if array.ndim == 2 and array.shape[1] in (2, 4, 6) and array.shape[1] != 2 * order:
        raise NoAnswer(
            f"`{name}` has {array.shape[1]} columns, as many as a model of order {array.shape[1] // 2} has. This one "
            "is of "
            f"order {order}: a row holds {order} past y and {order} past u.",
            "another order",
        )
    return as_matrix(name, array, (None, 2 * order))


def _has_a_constant(theta: FloatArray, Phi: FloatArray, Y: FloatArray) -> bool:
    """Whether it is the fit with a column of ones beside Phi, on either side."""
    ones = np.ones((len(Phi), 1))
    fits = (solve_least_squares(np.hstack(columns), Y).theta for columns in ((Phi, ones), (ones, Phi)))
    return any(close(1e-6)(theta, fit) for fit in fits)


def _ends_of_first_half(N: int) -> range:
    """Ends (exclusive) of the first half: half the samples, rounded up or down, plus or minus one."""
    return range(N // 2 - 1, -(-N // 2) + 2)


def _is_built_from(got: Equations, u: FloatArray, y: FloatArray, order: int, start: int, stop: int) -> bool:
    try:
        at_rest = build_phi(u, y, order, start, stop)
    except ValueError:
        return False
    if not np.allclose(got[1], at_rest.Y, rtol=SAME, atol=SAME):
        return False
    held_u, held_y = (np.concatenate([np.full(order, x[0]), x]) for x in (u, y))
    held = build_phi(held_u, held_y, order, start + order, stop + order)
    near = np.isclose(got[0], at_rest.Phi, rtol=SAME, atol=SAME) | np.isclose(got[0], held.Phi, rtol=SAME, atol=SAME)
    return bool(np.all(near))


def _known_mistake(got: Equations, names: tuple[str, str], data: LabData, order: int) -> Verdict | None:
    rows = got[1].size
    N = data.y.size
    for stop in (N - 1, N):
        if _is_built_from(got, data.u, data.y, order, max(stop - rows, 0), stop):
            if stop - rows <= N // 4:
                hint = (
                    "These are the equations of the entire record. Use the first half; the second is for verification."
                )
                return Verdict(False, hint, "fit on all the data")
            return Verdict(
                False, "These are the equations of the second half. Use the first half for the fit.", "wrong half"
            )
    for stop in _ends_of_first_half(N):
        for slip, hint, Phi, Y in _wrong_equations(names, data, order, stop - rows, stop):
            if Phi.shape == got[0].shape and np.allclose(got[0], Phi, atol=SAME) and np.allclose(got[1], Y, atol=SAME):
                return Verdict(False, hint, slip)
    return None


def _wrong_equations(
    names: tuple[str, str], data: LabData, order: int, start: int, stop: int
) -> Iterator[tuple[str, str, FloatArray, FloatArray]]:
    """Each known mistake with its hint, and the equations that it gives for rows start..stop-1."""
    if not 0 <= start < stop - 2 * order:
        return
    u, y = data.u, data.y
    right = build_phi(u, y, order, start, stop)
    past_y, past_u = np.hsplit(right.Phi, 2)
    phi, target = names
    swapped = np.hstack([past_u, past_y])
    yield (
        "y and u columns swapped",
        f"The columns of u come before those of y in `{phi}`; y comes first.",
        swapped,
        right.Y,
    )
    if order > 1:
        reversed_lags = np.hstack([past_y[:, ::-1], past_u[:, ::-1]])
        yield "lags swapped", f"The lags in `{phi}` are swapped: k-1 comes before k-2.", reversed_lags, right.Y
        for signal, columns in (
            ("y", np.hstack([past_y[:, ::-1], past_u])),
            ("u", np.hstack([past_y, past_u[:, ::-1]])),
        ):
            hint = f"The columns of {signal} are swapped in `{phi}`: {signal}(k-1) comes before {signal}(k-2)."
            yield "lags swapped", hint, columns, right.Y
        paired = np.stack([past_y, past_u], axis=2).reshape(right.Phi.shape)
        yield (
            "columns interleaved",
            f"The columns of y and u alternate in `{phi}`; all of y comes first.",
            paired,
            right.Y,
        )
    minus = np.hstack([-past_y, past_u])
    yield (
        "sign of a",
        f"`{phi}` contains -y(k-1). It should contain +y(k-1); the minus sign is in theta, which contains -a.",
        minus,
        right.Y,
    )
    late, early = "one step later", "one step earlier"
    for shift, what in ((1, late), (-1, early)):
        if start + shift < 0 or stop + shift > y.size:
            continue
        moved = build_phi(u, y, order, start + shift, stop + shift)
        moved_y, moved_u = np.hsplit(moved.Phi, 2)
        hint = f"The rows of `{phi}` are {what} than y(k) in `{target}` requires. The row for y(k) begins with y(k-1)."
        yield "lag off by one", hint, moved.Phi, right.Y
        hint = f"The input columns of `{phi}` are {what} than y(k) in `{target}` requires: begin with u(k-1)."
        yield "lag off by one", hint, np.hstack([past_y, moved_u]), right.Y
        hint = f"The output columns of `{phi}` are {what} than y(k) in `{target}` requires: begin with y(k-1)."
        yield "lag off by one", hint, np.hstack([moved_y, past_u]), right.Y
        hint = f"`{target}` does not match the rows of `{phi}`: the row that begins with y(k-1) belongs to y(k)."
        yield "lag off by one", hint, right.Phi, moved.Y
    if stop + order <= y.size:
        ahead_y, ahead_u = (np.column_stack([x[start + i : stop + i] for i in range(1, order + 1)]) for x in (y, u))
        for signals, parts in (
            ("y(k+1) and u(k+1)", [ahead_y, ahead_u]),
            ("y(k+1)", [ahead_y, past_u]),
            ("u(k+1)", [past_y, ahead_u]),
        ):
            hint = (
                f"The row for y(k) in `{phi}` has {signals}, which come later than y(k): it holds earlier samples, "
                "from y(k-1) and u(k-1) on."
            )
            yield "samples to come", hint, np.hstack(parts), right.Y
    for slip, hint, wrong_u, wrong_y in data.wrong_signals():
        made = build_phi(wrong_u, wrong_y, order, start, stop)
        yield slip, hint, made.Phi, made.Y
    if start < order:
        begins = "The first row contains" if start == order - 1 else "The first rows contain"
        hint = f"{begins} samples from the *end*: `y[-1]` is the last sample. Use zeros there, or start later."
        for end in (stop, y.size):
            round_u, round_y = (np.concatenate([x[end - order : end], x]) for x in (u, y))
            yield (
                "index wraps around",
                hint,
                build_phi(round_u, round_y, order, start + order, stop + order).Phi,
                right.Y,
            )
