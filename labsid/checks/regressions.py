"""Known mistakes in regressions on past samples: what stands beside right rows, and rows that wrap around.

Rows hold samples of some steps ago; the left-hand side, Y, holds the output of the same step.
"""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.verdict import Slip
from labsid.least_squares.solve import solve_least_squares

Regressor = tuple[FloatArray, int]
"""A signal with its sign, and how many samples ago a row holds it."""
Sample = tuple[str, float, int]
"""What a column holds: the name of a signal, its sign, and how many samples ago."""
WRAPS = "index wraps around"
LEFT_SIDE = "Y is not y(k)"
_NEAR = 1e-8
_LARGEST_SHIFT = 3


def wrapped(regressors: Sequence[Regressor]) -> FloatArray:
    """The rows that `np.roll`, or an index below zero, makes of a whole record."""
    return np.column_stack([np.roll(signal, lag) for signal, lag in regressors])


def wrapped_filter(P: FloatArray, x: FloatArray) -> FloatArray:
    """A polynomial in the delay, applied to a signal that goes round."""
    return np.asarray(sum(p * np.roll(x, i) for i, p in enumerate(P)), float)


def slips_of_fit(
    name: str,
    regressors: Sequence[Regressor],
    target: FloatArray,
    u: FloatArray | None = None,
    order: str = "",
) -> Iterator[Slip[FloatArray]]:
    """The theta that rows which wrap around give, and that of right rows beside another left-hand side.

    Parameters
    ----------
    name : str
        What the messages begin with: the function or the variable, in back-ticks.
    regressors : sequence of (ndarray, int)
    target : ndarray
        The output at all samples.
    u : ndarray, optional
        The input, which may have been taken for the output.
    order : str
        What the longest lag is called where it is an argument: the first row is then told by that name, too.
    """
    longest = max(lag for _, lag in regressors)
    rows, N = wrapped(regressors), target.size
    begin = f"{order}, here {longest}" if order else f"{longest}"
    hint = (
        f"{name} takes samples from the *end* of the record for those before its first, as `np.roll` and an index "
        f"below zero do. Begin at the first row for which every sample was recorded, k = {begin}."
    )
    for first in range(longest):
        yield Slip(WRAPS, hint, partial(_fit, rows[first:], target[first:]))
    others = [(f"y(k-{i})" if i > 0 else f"y(k+{-i})", i) for i in (*range(1, longest + 1), -1)]
    for held, shift in others:
        last = N + min(shift, 0)
        left = target[longest - shift : last - shift]
        said = (
            f"{name} has {held} on the left-hand side, Y, of the row that holds the samples before y(k): it is y(k). "
            "Either Y is cut wrongly, or all columns of Phi are."
        )
        yield Slip(LEFT_SIDE, said, partial(_fit, rows[longest:last], left))
    for who, chosen in _of_one_signal(regressors, u):
        for shift, said in ((-1, "later"), (1, "earlier")):
            moved = [(signal, lag + shift if i in chosen else lag) for i, (signal, lag) in enumerate(regressors)]
            begin = " and ".join(f"{one}(k-1)" for one in who.split())
            columns = {"y": "output columns", "u": "input columns"}.get(who, "columns")
            text = f"{name} comes from rows whose {columns} are one step {said} than y(k) requires: begin with {begin}."
            for first in {longest, max(lag for _, lag in moved)}:
                yield Slip("lag off by one", text, partial(_fit_from, moved, target, first))
    yield from slips_of_formula(name, rows[longest:], target[longest:])
    if u is not None:
        said = f"{name} has the input on the left-hand side, Y: it is the output y(k) that the rows explain."
        yield Slip(LEFT_SIDE, said, partial(_fit, rows[longest:], u[longest:]))


def slips_of_formula(name: str, Phi: FloatArray, Y: FloatArray, why: str = "") -> Iterator[Slip[FloatArray]]:
    """What other formulas than least squares make of right equations.

    Parameters
    ----------
    name : str
        What the messages begin with.
    Phi, Y : ndarray, shapes (n, p) and (n,)
    why : str
        Why the model has no constant, as the end of a sentence.
    """
    mean, spread = Phi.mean(axis=0), Phi.std(axis=0)
    yield Slip(
        "each column fitted alone",
        f"{name} divides each entry of Phi'Y by the one on the diagonal of Phi'Phi, which fits each column of Phi "
        "alone. The columns are correlated: all are fitted together, with the inverse of the whole matrix, "
        "`np.linalg.inv`, or use `np.linalg.solve`.",
        lambda: (Phi.T @ Y) / np.diag(Phi.T @ Phi),
    )
    yield Slip(
        "a constant fitted along",
        f"{name} comes of a fit with a column of ones beside Phi, or with means taken off. The model has no "
        f"constant{why}.",
        lambda: _fit(np.column_stack([Phi, np.ones(len(Y))]), Y)[:-1],
    )
    for what, columns, target in (
        ("by the standard deviations", (Phi - mean) / spread, Y - Y.mean()),
        ("by the standard deviations, and so was Y", (Phi - mean) / spread, (Y - Y.mean()) / Y.std()),
        ("by the standard deviations", Phi / spread, Y),
        ("by the norms", Phi / np.linalg.norm(Phi, axis=0), Y),
        ("by the largest values", Phi / np.abs(Phi).max(axis=0), Y),
    ):
        yield Slip(
            "columns scaled",
            f"{name} comes of a fit to columns of Phi that were divided {what}, and belongs to those: entry j must be "
            "divided by what column j was divided by. Least squares needs no such scaling.",
            partial(_fit, columns, target),
        )


def _of_one_signal(regressors: Sequence[Regressor], u: FloatArray | None) -> Iterator[tuple[str, set[int]]]:
    """The numbers of the regressors that are outputs, inputs, or any; without a `u` they cannot be told apart."""
    inputs = {i for i, (signal, _) in enumerate(regressors) if signal is u}
    if inputs:
        yield "u", inputs
        yield "y", set(range(len(regressors))) - inputs
        yield "y u", set(range(len(regressors)))


def _fit_from(regressors: Sequence[Regressor], target: FloatArray, first: int) -> FloatArray:
    return _fit(wrapped(regressors)[first:], target[first:])


def _fit(Phi: FloatArray, Y: FloatArray) -> FloatArray:
    return solve_least_squares(Phi, Y).theta


def beside_right_rows(names: tuple[str, str], Y: FloatArray, y: FloatArray, u: FloatArray, rows: range) -> str:
    """What the left-hand side holds beside a right Phi.

    Parameters
    ----------
    names : (str, str)
        What messages call Phi and Y.
    Y : ndarray
    y, u : ndarray
        Output and input.
    rows : range
        The samples k of the rows of Phi.
    """
    phi, target = names
    first, last = rows[0], rows[-1]
    said = f"{phi} is right, with the rows of k = {first} to {last}. What is wrong is {target}:"
    should = f"it should hold y[{first}] to y[{last}]"
    if Y.size != len(rows):
        start = _place(Y, y)
        held = "" if start is None else f", and holds y[{start}] to y[{start + Y.size - 1}]"
        return f"{said} {should}{held}."
    for shift in range(-_LARGEST_SHIFT, _LARGEST_SHIFT + 1):
        if shift and first + shift >= 0 and last + shift < y.size and _same(Y, y[first + shift : last + shift + 1]):
            samples = f"{abs(shift)} sample{'s' * (abs(shift) > 1)}"
            return f"{said} it is {samples} {'late' if shift > 0 else 'early'}; {should}."
    right = y[first : last + 1]
    if _same(Y, -right):
        return f"{said} all of it has the wrong sign."
    if _same(Y, u[first : last + 1]):
        return f"{said} it holds the input; {should}."
    if np.ptp(right) > 0 and _same(Y - np.mean(Y - right), right):
        return f"{said} a constant is added to it, such as an offset; {should}."
    return f"{said} {should}."


def told_columns(
    names: tuple[str, str], Phi: FloatArray, Y: FloatArray, y: FloatArray, u: FloatArray, order: int
) -> str:
    """Which samples the columns of Phi hold beside y(k), where all are samples of y or u and not those asked for.

    Parameters
    ----------
    names : (str, str)
        What messages call Phi and Y.
    Phi, Y : ndarray, shapes (n, 2 order) and (n,)
    y, u : ndarray
        Output and input.
    order : int
        The first rows, as many as this, may hold zeros for samples before the record.

    Returns
    -------
    str
        Empty where Y or a column is no part of these signals.
    """
    phi, target = names
    start = _place(Y[order:], y)
    if start is None:
        return ""
    held: list[Sample] = []
    for column in Phi[order:].T:
        places = (
            (signal, sign, _place(sign * column, samples))
            for signal, samples in (("y", y), ("u", u))
            for sign in (1.0, -1.0)
        )
        found = next(((signal, sign, start - place) for signal, sign, place in places if place is not None), None)
        if found is None:
            return ""
        held.append(found)
    asked = [(signal, 1.0, lag) for signal in "yu" for lag in range(1, order + 1)]
    if held == asked:
        return ""
    written, wanted = (
        ", ".join(sample_name(signal, lag, sign) for signal, sign, lag in columns) for columns in (held, asked)
    )
    return (
        f"Beside y(k) in `{target}`, the columns of `{phi}` are {written}; asked for are {wanted}. "
        f"{_causes(held, asked, phi, target)}"
    ).rstrip()


def _causes(held: list[Sample], asked: list[Sample], phi: str, target: str) -> str:
    """The mistakes that make these columns of those."""
    causes = []
    if any(sign < 0 for _, sign, _ in held):
        causes.append("the minus signs belong to theta")
    lags = [lag for _, _, lag in held]
    shift = min(lags) - 1
    if shift and sorted(lags) == sorted(lag + shift for _, _, lag in asked):
        late = "late" if shift > 0 else "early"
        samples = "one sample" if abs(shift) == 1 else f"{abs(shift)} samples"
        causes.append(f"`{target}` is {samples} too {late} for these rows of `{phi}`")
    moved = [(signal, 1.0, lag - shift) for signal, _, lag in held]
    if moved != asked and sorted(moved) == sorted(asked):
        causes.append("the columns are in another order")
    if shift and sorted(moved) != sorted(asked):
        moved = held  # columns of one signal alone are shifted: Y is not
    missing = [
        sample_name(signal, lag) for signal, _, lag in asked if (signal, lag) not in {(x, n) for x, _, n in moved}
    ]
    if missing:
        causes.append(f"{' and '.join(missing)} {'are' if len(missing) > 1 else 'is'} missing")
    said = "; ".join(causes)
    return f"{said.replace('the ', 'The ', 1) if said.startswith('the ') else said}." if said else ""


def sample_name(signal: str, lag: int, sign: float = 1.0) -> str:
    """A sample as it is written: ``u(k-1)``, ``-y(k)``, ``u(k+1)`` for a lag of -1."""
    when = f"k-{lag}" if lag > 0 else f"k+{-lag}" if lag else "k"
    return f"{'-' * (sign < 0)}{signal}({when})"


def zero_rows(Phi: FloatArray, right: FloatArray) -> list[int]:
    """The rows that are zero and should not be, if all others are right; empty otherwise."""
    if Phi.shape != right.shape:
        return []
    wrong = ~np.isclose(Phi, right, rtol=_NEAR, atol=_NEAR).all(axis=1)
    return list(map(int, np.flatnonzero(wrong))) if wrong.any() and not Phi[wrong].any() else []


def _place(part: FloatArray, whole: FloatArray) -> int | None:
    """Where a run of samples begins in a signal."""
    if not 0 < part.size <= whole.size:
        return None
    starts = np.flatnonzero(np.isclose(whole[: whole.size - part.size + 1], part[0]))
    return next((int(start) for start in starts if _same(part, whole[start : start + part.size])), None)


def _same(a: FloatArray, b: FloatArray) -> bool:
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=_NEAR, atol=_NEAR))
