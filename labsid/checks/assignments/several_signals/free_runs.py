"""Checks of the free run of one output with several inputs."""

from collections.abc import Iterator
from functools import partial

import numpy as np
import scipy.signal

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_array, as_vector
from labsid.checks.question import Ask, returned
from labsid.checks.recursions import Factor, with_recursion
from labsid.checks.regressions import WRAPS, wrapped_filter
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.lab.arx_system import simulate_system, system_from_thetas
from labsid.records.several_signals import names_of

_POLES = ((0.6, 0.9), (-0.5, 0.3), (0.2, 0.5))
_ACROSS = "filters each row of `u`, from one input to the next: `lfilter` works along the last axis."
_EACH = "Each column `u[:, j]` has n of the b's of its own; the output is the sum of these runs."


@first_failure
def check_run(ask: Ask) -> Iterator[Verdict]:
    """`simulate_output(theta, u, n)`, for several numbers of inputs and orders."""
    for nu, n in ((2, 2), (3, 1), (2, 3)):
        poles = [ask.rng.uniform(*limits) for limits in _POLES[:n]]
        theta = np.concatenate([-np.poly(poles)[1:], ask.rng.uniform(0.5, 2, nu * n)])
        yield _judge_run(ask, theta, ask.rng.uniform(-2, 2, (int(ask.rng.integers(30, 40)), nu)), n)
    yield Verdict(True, "all inputs move the output, and only simulated outputs are fed back.")


def _run(theta: FloatArray, u: FloatArray, n: int) -> FloatArray:
    model = system_from_thetas([theta], n, 1.0, names_of("u", (), u.shape[1]), ("y",))
    return simulate_system(model, u)[:, 0]


def _judge_run(ask: Ask, theta: FloatArray, u: FloatArray, n: int) -> Verdict:
    call = f"simulate_output(theta, u, {n})"
    value = returned(ask, "simulate_output", theta, u, n)
    nu, N = u.shape[1], len(u)
    a, b = theta[:n], theta[n:]
    parts = np.column_stack([_run(theta, u * only, n) for only in np.eye(nu)])
    got = as_array(call, value)
    if got.shape in ((N, nu), (nu, N)) and SAME(got if got.shape == (N, nu) else got.T, parts):
        return Verdict(False, f"`{call}` returns a run for each input: the output is their sum.", "runs not added up")
    whole = np.r_[0.0, b], np.r_[1.0, -a]
    across, down = (np.asarray(scipy.signal.lfilter(*whole, u, axis=axis)) for axis in (1, 0))
    if got.shape in ((N, nu), (nu, N)):
        columns = got if got.shape == (N, nu) else got.T
        if SAME(columns, across):
            return Verdict(False, f"`{call}` {_ACROSS} {_EACH}", "filtered across the inputs")
        returned_runs = f"`{call}` returns a run for each of the {nu} inputs"
        if SAME(columns, down):
            return Verdict(
                False, f"{returned_runs}, each filtered by the b's of all. {_EACH}", "all of b for each input"
            )
        return Verdict(False, f"{returned_runs}. {_EACH}", "runs not added up")
    got = as_vector(call, value, N)
    right = _run(theta, u, n)
    alone = f"`{call}` has one input in it; the output is moved by all {nu}."
    flipped = np.concatenate([-a, b])
    blocks = b.reshape(nu, n)
    verdict = judge(
        got,
        right,
        SAME,
        "",
        f"`{call}` is not the free run from rest. Work out the first two samples by hand, with n = 1.",
        [
            Slip("filtered across the inputs", f"`{call}` {_ACROSS} {_EACH}", lambda: across.sum(axis=1)),
            Slip(
                "filtered across the inputs",
                f"`{call}` hands `lfilter` the whole table `u` for each input, and filters each row, from one input to "
                "the next: hand over one column, `u[:, j]`.",
                lambda: np.asarray(
                    sum(scipy.signal.lfilter(np.r_[0.0, block], whole[1], u).sum(axis=1) for block in blocks)
                ),
            ),
            Slip(
                "whole table for each input",
                f"`{call}` filters the whole table `u` by the b's of each input: a block of b belongs to one column, "
                "`u[:, j]`.",
                lambda: np.asarray(
                    sum(scipy.signal.lfilter(np.r_[0.0, block], whole[1], u, axis=0).sum(axis=1) for block in blocks)
                ),
            ),
            *(Slip("one input only", alone, partial(np.copy, part)) for part in parts.T),
            *(
                Slip(
                    "further inputs left out",
                    f"`{call}` uses {some} of its {nu} inputs: `u` has any number of columns, `u.shape[1]`.",
                    partial(np.sum, parts[:, :some], axis=1),
                )
                for some in range(2, nu)
            ),
            Slip(
                "sign of a",
                f"`{call}` has the wrong sign of a: theta holds -a, the denominator [1, a1, ...].",
                lambda: _run(flipped, u, n),
            ),
            Slip(
                WRAPS,
                f"`{call}` takes the last inputs for those before the first: an index below zero goes round. Lags "
                "before sample 0 are zero.",
                lambda: np.asarray(
                    scipy.signal.lfilter(
                        [1.0],
                        whole[1],
                        sum(wrapped_filter(np.r_[0.0, b[j * n : (j + 1) * n]], u[:, j]) for j in range(nu)),
                    )
                ),
            ),
            Slip(
                "counted from one",
                f"`{call}` begins with the second of the n numbers of a: `theta[:n]` are all of them, counted from 0.",
                lambda: np.asarray(
                    sum(
                        scipy.signal.lfilter(np.r_[0.0, b[j * n : (j + 1) * n]], np.r_[1.0, -a[1:]], u[:, j])
                        for j in range(nu)
                    )
                ),
            ),
            Slip(
                "numbers taken lag by lag",
                f"`{call}` deals the b's out lag by lag; theta has a block of n for each input.",
                lambda: _run(np.r_[a, b.reshape(n, nu).T.ravel()], u, n),
            ),
            Slip(
                "one block of b",
                f"`{call}` uses the b's of one input for all inputs: that of input j begins at n + j n.",
                lambda: _run(np.r_[a, np.tile(b[:n], nu)], u, n),
            ),
            Slip(
                "one block of b",
                f"`{call}` uses the b's of one input for all inputs: that of input j begins at n + j n.",
                lambda: _run(np.r_[a, np.tile(b[-n:], nu)], u, n),
            ),
            Slip(
                "all of b for each input",
                f"`{call}` filters each input by the b's of all: that of input j is theta[n + j n : n + (j + 1) n].",
                lambda: sum((_all_of_b(theta, column, n) for column in u.T), np.zeros(N)),
            ),
            Slip(
                "a taken for b",
                f"`{call}` begins the b's at theta[0]: the first n numbers of theta are -a.",
                lambda: _run(np.r_[a, theta[: nu * n]], u, n),
            ),
            Slip(
                "blocks that overlap",
                f"`{call}` begins the b's of input j at n + j; each has n of them, so they begin at n + j n.",
                lambda: _run(np.r_[a, np.concatenate([theta[n + j : 2 * n + j] for j in range(nu)])], u, n),
            ),
            Slip(
                "lag off by one",
                f"`{call}` lets u(k) move y(k). The first lag is 1: the numerator begins with a zero.",
                lambda: _run(theta, np.vstack([u, np.zeros(nu)]), n)[1:],
            ),
            Slip(
                "lag off by one",
                f"`{call}` lets u(k) move y(k), and takes the -a of theta for a. The first lag is 1: the numerator "
                "begins with a zero.",
                lambda: _run(flipped, np.vstack([u, np.zeros(nu)]), n)[1:],
            ),
            Slip(
                "added, not joined",
                f"`{call}` comes out like this where `[0] + b` and `[1] + a` have an array on one side: `+` then adds "
                "entry by entry, and joins nothing. `np.r_[0, b]` joins.",
                partial(_with_sums, theta, u, n, 1.0),
            ),
            Slip(
                "added, not joined",
                f"`{call}` comes out like this where `[0] + b` and `[1] + a` have an array on one side, and a has the "
                "wrong sign: `+` then adds entry by entry, and joins nothing. `np.r_[0, b]` joins.",
                partial(_with_sums, theta, u, n, -1.0),
            ),
            Slip(
                "oldest lag first",
                f"`{call}` has the lags of its b's in reverse order.",
                lambda: _run(np.r_[a, b.reshape(nu, n)[:, ::-1].ravel()], u, n),
            ),
            Slip(
                "oldest lag first",
                f"`{call}` has the oldest lag first: `y[k - n : k]` begins with y(k-n), and theta with the lag 1.",
                lambda: _from_n(np.r_[a[::-1], b.reshape(nu, n)[:, ::-1].ravel()], u, n),
            ),
            Slip(
                "first samples left at zero",
                f"`{call}` leaves the first n samples at zero: lags before sample 0 are zero, the others count.",
                lambda: _from_n(theta, u, n),
            ),
            Slip(
                "past outputs left out",
                f"`{call}` feeds nothing back: the past simulated outputs are missing.",
                lambda: _run(np.r_[np.zeros(n), b], u, n),
            ),
            Slip(
                "inputs in reverse order",
                f"`{call}` takes the inputs in reverse order.",
                lambda: _run(theta, u[:, ::-1], n),
            ),
        ],
    )
    asked = {("y", i + 1): Factor(f"theta[{i}]", factor) for i, factor in enumerate(a)}
    asked |= {
        (f"u_{j + 1}", i + 1): Factor(f"theta[{n + j * n + i}]", blocks[j, i]) for j in range(nu) for i in range(n)
    }
    return with_recursion(verdict, ("y", got), {f"u_{j + 1}": column for j, column in enumerate(u.T)}, asked)


def _all_of_b(theta: FloatArray, u: FloatArray, n: int) -> FloatArray:
    """The run of one input through all the b's, one lag after the other."""
    later = np.column_stack([np.r_[np.zeros(k), u[: u.size - k]] for k in range(0, theta.size - n, n)])
    return _run(theta, later, n)


def _with_sums(theta: FloatArray, u: FloatArray, n: int, sign: float) -> FloatArray:
    """The runs with 0 added to the b's and 1 to the a's, in place of joined to them."""
    blocks = theta[n:].reshape(-1, n)
    denominator = 1 - sign * theta[:n]
    runs = (scipy.signal.lfilter(b, denominator, column) for b, column in zip(blocks, u.T, strict=True))
    return np.asarray(sum(runs), float)


def _from_n(theta: FloatArray, u: FloatArray, n: int) -> FloatArray:
    """The run of a loop that begins at sample n."""
    y = np.zeros(len(u))
    for k in range(n, len(u)):
        y[k] = theta @ np.concatenate([y[k - n : k][::-1], *(column[k - n : k][::-1] for column in u.T)])
    return y
