"""Checks of Phi and theta of one output with several inputs."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_array, as_matrix, as_vector, close
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.regressions import LEFT_SIDE, WRAPS, beside_right_rows
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.lab.arx_system import fit_arx_system
from labsid.lab.regressor import build_phi
from labsid.least_squares.solve import solve_least_squares

_EXACT = close(1e-9)


@first_failure
def check_phi(ask: Ask) -> Iterator[Verdict]:
    """`regressor(u, y, i, n)`, for several numbers of signals and orders."""
    for nu, ny, i, n in ((2, 2, 0, 2), (2, 2, 1, 3), (3, 2, 1, 1), (1, 3, 2, 2)):
        N = int(ask.rng.integers(14, 20))
        yield _judge_phi(ask, ask.rng.uniform(1, 3, (N, nu)), ask.rng.uniform(4, 6, (N, ny)), i, n)
    yield Verdict(True, "a block of lags for each signal.")


def _judge_phi(ask: Ask, u: FloatArray, y: FloatArray, i: int, n: int) -> Verdict:
    call = f"regressor(u, y, {i}, {n})"
    parts = returned_parts(ask, "regressor", "two things, Phi and Y", 2, u, y, i, n)
    nu, ny, N = u.shape[1], y.shape[1], len(y)
    columns = n + nu * n
    Phi = as_array(f"Phi of {call}", parts[0])
    if Phi.ndim == 2 and ny > 1 and Phi.shape[1] == ny * n + nu * n:
        return Verdict(
            False,
            f"Phi of `{call}` has a block for every output. The equation of step 3 has the past of output i alone, and "
            "that of all inputs.",
            "past of all outputs",
        )
    right = build_phi(u, y[:, i], n).Phi
    first = [build_phi(u[:, :k], y[:, i], n).Phi for k in range(1, nu)]
    if any(
        Phi.shape == right[:, : 2 * n].shape and SAME(Phi, _phi(u[:, [j]], y[:, i], n)) for j in range(nu) if nu > 1
    ):
        return Verdict(
            False, f"Phi of `{call}` has the past of one input: all {nu} of them move the output.", "one input only"
        )
    some = next((k for k, made in enumerate(first, 1) if k > 1 and Phi.shape == made.shape and SAME(Phi, made)), 0)
    if some:
        return Verdict(
            False,
            f"Phi of `{call}` has the past of {some} of the {nu} inputs: `u` has any number of columns, `u.shape[1]`.",
            "inputs left out",
        )
    lags = next((k for k in range(1, n + 3) if k != n and Phi.ndim == 2 and Phi.shape[1] == k * (1 + nu)), 0)
    if lags:
        return Verdict(
            False, f"Phi of `{call}` has {Phi.shape[1]} columns, {lags} for each signal: n is {n}.", "n not used"
        )
    Phi = as_matrix(f"Phi of {call}", parts[0], (None, columns))
    if ny > 1 and np.shape(as_array(f"Y of {call}", parts[1])) == (len(Phi), ny):
        return Verdict(False, f"Y of `{call}` holds all {ny} outputs: take column i of y.", "all outputs in Y")
    Y = as_vector(f"Y of {call}", parts[1])
    quoted = f"Phi of `{call}`", "Y"
    if Phi.shape[0] != Y.size:
        unequal = f"`{call}` has {Phi.shape[0]} rows in Phi and {Y.size} in Y: one y(k) for each row."
        if SAME(Phi, right):
            unequal += f" {beside_right_rows(quoted, Y, y[:, i], u[:, 0], range(n, N))}"
        return Verdict(False, unequal, "unequal rows")
    if Y.size == N and SAME(Phi, np.column_stack([np.roll(x, k) for x in (y[:, i], *u.T) for k in range(1, n + 1)])):
        return Verdict(
            False,
            f"Phi of `{call}` goes round: `np.roll` brings the last samples before the first. Leave these rows "
            "out, and begin with k = n.",
            WRAPS,
        )
    if Y.size != N - n:
        return Verdict(
            False,
            f"`{call}` has {Y.size} rows for {N} samples; k = n, ..., N-1 are {N - n}.",
            "rows left out" if Y.size < N - n else "rows before k = n",
        )
    for j in range(ny):
        if j != i and SAME(Y, y[n:, j]):
            return Verdict(
                False, f"Y of `{call}` is that of another output: use the argument `i`, from zero.", "wrong output"
            )
    if not SAME(Y, y[n:, i]):
        reason = f"Y of `{call}` should be y_i(k) of its rows, k = n to the end."
        if SAME(Phi, right):
            reason = beside_right_rows(quoted, Y, y[:, i], u[:, 0], range(n, N))
        return Verdict(False, reason, LEFT_SIDE)
    blocks = right.reshape(N - n, 1 + nu, n)
    ahead = build_phi(np.roll(u, -1, axis=0), y[:, i], n).Phi
    both_ahead = build_phi(np.roll(u, -1, axis=0), np.roll(y[:, i], -1), n).Phi
    return judge(
        Phi,
        right,
        _EXACT,
        "",
        f"Phi of `{call}` is not right: write its first row, k = n, by hand for n = 1.",
        [
            Slip(
                "signals interleaved",
                f"Phi of `{call}` goes lag by lag. It goes signal by signal: all lags of y_i, then all of u_1, and "
                "so on.",
                lambda: blocks.transpose(0, 2, 1).reshape(N - n, columns),
            ),
            Slip(
                "signals interleaved",
                f"Phi of `{call}` has the inputs lag by lag: after the past of y_i come all lags of u_1, then those of "
                "u_2.",
                lambda: np.column_stack([right[:, :n], blocks[:, 1:].transpose(0, 2, 1).reshape(N - n, nu * n)]),
            ),
            Slip(
                "inputs before outputs",
                f"Phi of `{call}` has the inputs first; the past of y_i comes first.",
                lambda: np.roll(right, -n, axis=1),
            ),
            Slip(
                "oldest lag first",
                f"Phi of `{call}` has the oldest lag of each block first; the newest comes first.",
                lambda: blocks[:, :, ::-1].reshape(N - n, columns),
            ),
            Slip(
                "sign of a",
                f"Phi of `{call}` holds -y. As in the lab it holds y, and theta holds -a.",
                lambda: np.where(np.arange(columns) < n, -right, right),
            ),
            Slip(
                "inputs in reverse order",
                f"Phi of `{call}` has the last input first.",
                lambda: np.concatenate([blocks[:, :1], blocks[:, :0:-1]], axis=1).reshape(N - n, columns),
            ),
            Slip(
                "lag off by one",
                f"Phi of `{call}` begins with u(k) and ends with u(k-n+1): the lags are 1 to n.",
                lambda: ahead,
            ),
            Slip(
                "lag off by one",
                f"Phi of `{call}` begins with y(k), which it is to explain: the lags are 1 to n.",
                lambda: both_ahead,
            ),
            Slip(
                "lag off by one",
                f"Phi of `{call}` begins with y(k), which it is to explain: the lags are 1 to n.",
                lambda: np.column_stack([both_ahead[:, :n], right[:, n:]]),
            ),
            *(
                Slip(
                    "wrong output",
                    f"Phi of `{call}` has the past of another output than Y: use the argument `i`.",
                    partial(_phi, u, y[:, j], n),
                )
                for j in range(ny)
                if j != i
            ),
            Slip(
                "one input only",
                f"Phi of `{call}` has the same input in every block: use the index of the loop.",
                lambda: _phi(u[:, [0] * nu], y[:, i], n),
            ),
            Slip(
                "one input only",
                f"Phi of `{call}` has the same input in every block: use the index of the loop.",
                lambda: _phi(u[:, [-1] * nu], y[:, i], n),
            ),
        ],
    )


def _phi(u: FloatArray, y: FloatArray, n: int) -> FloatArray:
    return build_phi(u, y, n).Phi


@first_failure
def check_theta(ask: Ask) -> Iterator[Verdict]:
    """`fit_outputs(u, y, n)`, for several numbers of signals and orders."""
    for nu, ny, n in ((2, 2, 2), (2, 3, 1), (3, 2, 2)):
        N = int(ask.rng.integers(50, 70))
        yield _judge_theta(ask, ask.rng.uniform(-2, 2, (N, nu)), ask.rng.uniform(-2, 2, (N, ny)), n)
    yield Verdict(True, "an equation for each output, and a row for each equation.")


def _judge_theta(ask: Ask, u: FloatArray, y: FloatArray, n: int) -> Verdict:
    call = f"fit_outputs(u, y, {n})"
    nu, ny = u.shape[1], y.shape[1]
    rows, columns = ny, n + nu * n
    got = _table(call, returned(ask, "fit_outputs", u, y, n))
    if got.ndim == 1 and got.size == columns:
        return Verdict(False, f"`{call}` returns theta of one output: return a row for each.", "one output only")
    got = as_matrix(call, got, (rows, columns) if got.shape[:1] == (columns,) else (None, columns))
    if got.shape[0] != rows:
        return Verdict(
            False,
            f"`{call}` has {got.shape[0]} rows; there are {rows} outputs, one row for each."
            + (
                " Yours is that of output 0: the loop goes on to the others, and all are returned after it."
                if got.shape[0] == 1 and SAME(got[0], fit_arx_system(u, y, 1.0, n).equations[0].fit.theta)
                else ""
            ),
            "rows are not outputs",
        )
    fits = fit_arx_system(u, y, 1.0, n).equations
    right = np.array([equation.fit.theta for equation in fits])
    phis = [(equation.regression.Phi, equation.regression.Y) for equation in fits]
    return judge(
        got,
        right,
        SAME,
        "",
        f"`{call}` does not hold the least-squares theta of each output. Compare its first row with `lstsq` of "
        "`regressor(u, y, 0, n)`.",
        [
            Slip(
                "one output in every row",
                f"all rows of `{call}` are theta of one output: use the index of the loop.",
                lambda: right[[0] * ny],
            ),
            Slip(
                "one output in every row",
                f"all rows of `{call}` are theta of one output: use the index of the loop.",
                lambda: right[[-1] * ny],
            ),
            Slip(
                "sign of a",
                f"`{call}` returns [a, b]; the rows of Theta are [-a, b], as least squares gives them.",
                lambda: np.where(np.arange(columns) < n, -right, right),
            ),
            Slip(
                "inverse forgotten",
                f"`{call}` returns Phi'Y: the inverse of Phi'Phi is missing.",
                lambda: np.array([Phi.T @ Y for Phi, Y in phis]),
            ),
            Slip(
                "one Phi for all outputs",
                f"`{call}` uses one Phi for all outputs. Each output has its own past in its Phi.",
                lambda: np.array([solve_least_squares(phis[0][0], Y).theta for _, Y in phis]),
            ),
            Slip(
                "outputs in reverse order",
                f"`{call}` has its rows in the wrong order: row i is output i.",
                lambda: right[::-1],
            ),
            Slip(
                "first half only",
                f"`{call}` fits the first half of what it is given; use all of it.",
                lambda: np.array(
                    [equation.fit.theta for equation in fit_arx_system(u, y, 1.0, n, stop=len(y) // 2).equations]
                ),
            ),
        ],
    )


def _table(call: str, value: Value) -> FloatArray:
    """An array, or a list with an array for each output; the whole results of `lstsq` have their own message."""
    parts = value if isinstance(value, tuple) else ()
    if parts and all(isinstance(part, tuple) and len(part) == 4 for part in parts):
        raise NoAnswer(
            f"`{call}` collects the whole results of `lstsq`: take the first element, `[0]`, of each.", "all of lstsq"
        )
    if parts:
        rows = [as_vector(f"an entry of {call}", part) for part in parts]
        if len({row.size for row in rows}) > 1:
            raise NoAnswer(f"the entries of `{call}` have different lengths: each is theta of one output.")
        return np.array(rows)
    array = as_array(call, value)
    if array.ndim == 3 and array.shape[2] == 1:
        return array[:, :, 0]
    return array
