"""Checks of instrumental variables: iterated over a whole record, and recursively."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_history, as_theta, close
from labsid.checks.double_mistakes import TWO, Edit, pairs_of
from labsid.checks.question import Ask, returned
from labsid.checks.regressions import WRAPS, slips_of_fit, wrapped
from labsid.checks.trials import ARX, STARTS, first_order, trial_record
from labsid.checks.verdict import RUNS_AWAY, Slip, Verdict, first_failure, judge
from labsid.estimation.instrumental import instrumental_variables
from labsid.estimation.recursive import recursive_instrumental
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.prediction import free_run, one_step_prediction
from labsid.model_structures.structures import build_equations

_SAME_HISTORY = close(1e-5)


@dataclass(frozen=True, slots=True, eq=False)
class _Way:
    """How a round is made; the defaults are right."""

    start: int = 1
    predicted: bool = False
    renewed: bool = True
    regressed_on_z: bool = False
    transposed: bool = False
    exchanged: bool = False
    from_zero: bool = False
    delayed: bool = False
    other_sign: bool = False
    ahead: bool = False


_RIGHT = _Way()


@first_failure
def check_iterated(ask: Ask) -> Iterator[Verdict]:
    """`iterated_iv(u, y, rounds)`."""
    for rounds, c in ((0, -0.7), (3, -0.7), (1, 0.7)):  # of one round, none and least squares are the same
        yield _judge_iterated(ask, *trial_record(ask.rng, int(ask.rng.integers(140, 160)), c, noise=0.8), rounds)


def _rounds(u: FloatArray, y: FloatArray, rounds: int, way: _Way = _RIGHT) -> FloatArray:
    equations = build_equations(ARX, u, y, start=way.start)
    Phi, Y = equations.Phi, equations.Y
    first = theta = np.zeros(2) if way.from_zero else solve_least_squares(Phi, Y).theta
    for _ in range(rounds):
        a, b = theta if way.renewed else first
        model = first_order(float(-a if way.other_sign else a), float(b))
        y_model = one_step_prediction(model, u, y) if way.predicted else free_run(model, u)
        Z = build_equations(ARX, u, y_model, start=way.start).Phi
        if way.ahead:
            Z = np.column_stack([-y_model, u])[way.start :]
        if way.delayed:
            Z = np.column_stack([-np.concatenate([[0.0], y[way.start - 1 : -2]]), Phi[:, 1]])
        if way.exchanged:
            theta = np.asarray(np.linalg.solve(Phi.T @ Z, Phi.T @ Y), float)
        elif way.regressed_on_z:
            theta = solve_least_squares(Z, Y).theta
        elif way.transposed:
            theta = np.asarray(np.linalg.solve(Phi.T @ Z, Z.T @ Y), float)
        else:
            theta = instrumental_variables(Z, Phi, Y).theta
    return theta


def _rounds_wrapped(u: FloatArray, y: FloatArray, rounds: int) -> FloatArray:
    """The rounds with rows that wrap around."""
    Phi = wrapped([(-y, 1), (u, 1)])
    theta = solve_least_squares(Phi, y).theta
    for _ in range(rounds):
        y_model = free_run(first_order(float(theta[0]), float(theta[1])), u)
        theta = instrumental_variables(wrapped([(-y_model, 1), (u, 1)]), Phi, y).theta
    return theta


def _judge_iterated(ask: Ask, u: FloatArray, y: FloatArray, rounds: int) -> Verdict:
    call = f"iterated_iv(u, y, {rounds})"
    got = as_theta(call, returned(ask, "iterated_iv", u, y, rounds), 2)
    rights = [_rounds(u, y, rounds, _Way(start)) for start in STARTS]
    right = next((right for right in rights if SAME(got, right)), rights[0])
    noisy = f"`{call}` makes its instrument with the measured output: that holds the noise. "
    goes_round = (
        f"`{call}` takes samples from the *end* of the record for those before its first, as `np.roll` does: "
        "begin with the row of y(1)."
    )
    counts = [count for count in range(rounds + 3) if count not in (0, rounds)]
    return judge(
        got,
        right,
        SAME,
        "an instrument made of the input alone.",
        f"`{call}` is off. A round simulates y_M by the latest [a, b] and solves with z(t) = [-y_M(t-1), u(t-1)]: "
        "print "
        "y_M, and then z(2), of one round.",
        [
            Slip(
                "least squares",
                noisy + "With Z = Phi it is least squares again.",
                partial(_rounds, u, y, 0),
            ),
            Slip(
                "predicted, not simulated",
                noisy + "Simulate: y_M(t-1) on the right-hand side is the model's own last output.",
                partial(_rounds, u, y, rounds, _Way(predicted=True)),
            ),
            Slip(
                "sign of a in the simulation",
                f"`{call}` simulates y_M with the other sign of a: y_M(t) + a y_M(t-1) = b u(t-1).",
                partial(_rounds, u, y, rounds, _Way(other_sign=True)),
            ),
            Slip(
                "instrument not renewed",
                f"`{call}` simulates the first model in every round.",
                partial(_rounds, u, y, rounds, _Way(renewed=False)),
                mend="Use the latest [a, b].",
            ),
            Slip(
                "regressed on the instrument",
                f"`{call}` uses Z instead of Phi throughout, (Z'Z)^-1 Z'Y.",
                partial(_rounds, u, y, rounds, _Way(regressed_on_z=True)),
                mend="Asked for is (Z'Phi)^-1 Z'Y.",
            ),
            Slip(
                "Phi'Z for Z'Phi",
                f"`{call}` solves with Phi'Z; asked for is its transpose, Z'Phi.",
                partial(_rounds, u, y, rounds, _Way(transposed=True)),
            ),
            Slip(
                "Phi and Z exchanged",
                f"`{call}` has Phi and Z exchanged: yours is (Phi'Z)^-1 Phi'Y.",
                partial(_rounds, u, y, rounds, _Way(exchanged=True)),
                mend="It is (Z'Phi)^-1 Z'Y.",
            ),
            Slip(
                "instrument not delayed",
                f"`{call}` takes z(t) = [-y_M(t), u(t)]: the row of y(t) goes with y_M(t-1) and u(t-1).",
                partial(_rounds, u, y, rounds, _Way(ahead=True)),
            ),
            *(
                Slip(
                    "instrument of old outputs",
                    f"`{call}` takes an older measured output for its instrument, y(t-2): that holds"
                    " noise of which v(t) is not free.",
                    partial(_rounds, u, y, max(rounds, 1), _Way(start=start, delayed=True)),
                    mend="Simulate y_M from u alone.",
                )
                for start in (1, 2)
            ),
            Slip(
                "start from zero",
                f"`{call}` begins with theta = 0: the first model is that of least squares.",
                partial(_rounds, u, y, rounds, _Way(from_zero=True)),
            ),
            *(
                Slip(
                    TWO,
                    f"`{call}` has two mistakes: {said}; it simulates the first model in every round.",
                    partial(_rounds, u, y, rounds, replace(way, renewed=False)),
                )
                for said, way in (
                    ("it simulates y_M with the other sign of a", _Way(other_sign=True)),
                    ("it predicts y_M with the measured output", _Way(predicted=True)),
                    ("it uses Z instead of Phi throughout", _Way(regressed_on_z=True)),
                    ("it solves with Phi'Z, not with Z'Phi", _Way(transposed=True)),
                )
            ),
            Slip("sign of a", f"`{call}` has the other sign of a.", lambda: right * [-1, 1]),
            Slip(WRAPS, goes_round, partial(_rounds_wrapped, u, y, rounds)),
            *slips_of_fit(f"the least-squares estimate of `{call}`", [(-y, 1), (u, 1)], y, u),
            Slip("a and b swapped", f"`{call}` returns b before a.", lambda: right[::-1]),
            *(
                Slip(
                    "rounds miscounted",
                    f"`{call}` goes {count} round{'s' * (count != 1)} in place of {rounds}: a round is simulate, then "
                    "solve.",
                    partial(_rounds, u, y, count),
                )
                for count in counts
            ),
        ],
    )


@first_failure
def check_recursive(ask: Ask) -> Iterator[Verdict]:
    """`recursive_iv(u, y, warm_up)`, with several warm-ups."""
    for warm_up in (int(ask.rng.integers(12, 18)), int(ask.rng.integers(22, 32))):
        u, y = trial_record(ask.rng, int(ask.rng.integers(55, 65)), -0.7)
        yield _judge_recursive(ask, u, y, warm_up)


def _judge_recursive(ask: Ask, u: FloatArray, y: FloatArray, warm_up: int) -> Verdict:
    call = f"recursive_iv(u, y, {warm_up})"
    value = returned(ask, "recursive_iv", u, y, warm_up)
    is_history = isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.shape == (y.size, 2)
    undefined = np.isnan(np.asarray(value, float)).any(axis=1) if is_history else np.zeros(1, bool)
    if undefined.all():
        return Verdict(
            False,
            f"the estimate of `{call}` is nan from sample 0 on. There phi and z are zero, and 0/0 is nan: the "
            "denominator "
            "is zero, and with its 1 it is not.",
            "1 forgotten",
        )
    if undefined[0]:
        last = int(np.argmin(undefined))
        rows = "row 0 of" if last == 1 else f"rows 0 to {last - 1} of"
        return Verdict(False, f"{rows} `{call}` are nan, and later rows are numbers: the first estimate is zero.")
    if is_history and not np.all(np.isfinite(np.asarray(value, float))):
        return _runaway(np.asarray(value, float), u, y, warm_up)
    got = as_history(call, value, y.size, 2)
    if not np.any(got):
        return Verdict(False, f"In `{call}` the estimate never moves: update theta in the loop.", "theta not updated")
    right = recursive_instrumental(ARX, u, y, warm_up).theta
    return judge(
        got,
        right,
        _SAME_HISTORY,
        "recursive, and consistent in coloured noise.",
        f"`{call}` is off: hold your four lines against those of step 8, term by term.",
        [
            Slip(
                "phi phi' for z phi'",
                "`recursive_iv` updates P with phi in both places, as least squares does.",
                partial(_loop, u, y, warm_up, update="phi phi"),
                mend="It is P z phi' P / (1 + phi' P z).",
            ),
            Slip(
                "denominator transposed",
                "`recursive_iv` has z' P phi in its denominator. P is not symmetric here.",
                partial(_loop, u, y, warm_up, below="z phi"),
                mend="It is 1 + phi' P z.",
            ),
            *(
                Slip(
                    slip.split(" above")[0],
                    f"`recursive_iv` {what}",
                    partial(_loop, u, y, warm_up, **_PARTS[slip]),
                    mend,
                )
                for slip, (what, mend) in _HINTS.items()
            ),
            *(
                Slip(
                    "warm-up not used",
                    "`recursive_iv` changes from phi to z at a fixed sample: use the argument `warm_up`.",
                    partial(_loop, u, y, other_warm_up),
                )
                for other_warm_up in range(y.size)
                if other_warm_up != warm_up
            ),
            *pairs_of("`recursive_iv`", _EDITS, partial(_loop, u, y, warm_up)),
        ],
    )


def _runaway(got: FloatArray, u: FloatArray, y: FloatArray, warm_up: int) -> Verdict:
    """An estimate that grew beyond all numbers, told by the samples before."""
    last = int(np.argmax(~np.all(np.isfinite(got), axis=1)))
    for slip, (what, mend) in _HINTS.items():
        wrong = _loop(u, y, warm_up, **_PARTS[slip])[:last]
        if last > 2 and np.allclose(got[:last], wrong, rtol=1e-3):
            return Verdict(False, f"`recursive_iv` {what} The estimate then grows without limit.", slip, mend)
    return Verdict(
        False,
        f"the estimate of `recursive_iv` grows without limit, and is nan from sample {last} on: hold your four lines "
        "against those of step 8.",
        RUNS_AWAY,
    )


_EXCHANGED = ("has z and phi exchanged in the update of P, which is not symmetric.", "P z left, phi' P right.")
_HINTS = {
    "z z' for z phi'": ("updates P with z twice.", "It is P z phi' P / (1 + phi' P z)."),
    "z z' above alone": ("has P z z'P above, where P z phi'P belongs.", "It is P z phi' P / (1 + phi' P z)."),
    "P symmetric, in the gain too": (
        "has P phi for phi' P in the update, and for P z in the gain. P is not symmetric here.",
        "It is `phi @ P`, or `P.T @ phi`, and K = P z.",
    ),
    "phi for z in the gain": ("multiplies P by phi for the gain. With phi it is least squares again.", "K = P z."),
    "phi throughout": ("never uses z: with phi in its place it is least squares.", ""),
    "z for phi in the error": ("predicts with z.", "The error is y - phi'theta, with the measured past."),
    "transposed": _EXCHANGED,
    "transposed above only": _EXCHANGED,
    "transposed throughout": ("has z and phi exchanged, in P and in the gain.", "P z left, phi' P right; K = P z."),
    "P taken for symmetric": (
        "has P phi in the update where phi' P belongs. P is not symmetric here, so these differ.",
        "It is `phi @ P`, or `P.T @ phi`.",
    ),
    "gain from the P before": ("takes the gain from the P before its update.", "P(n) first, then K(n) = P(n) z(n)."),
    "sign of the update": ("takes K epsilon off theta.", "Add it."),
}


_PARTS: dict[str, dict[str, Any]] = {
    "z z' for z phi'": {"update": "z z"},
    "z z' above alone": {"update": "z z", "below": "phi z", "symmetric": True},
    "P symmetric, in the gain too": {"symmetric": True, "gain": "phi"},
    "phi for z in the gain": {"gain": "phi"},
    "phi throughout": {"throughout": True},
    "z for phi in the error": {"error": "z"},
    "transposed": {"update": "phi z"},
    "transposed above only": {"update": "phi z", "below": "phi z"},
    "transposed throughout": {"update": "phi z", "gain": "phi"},
    "P taken for symmetric": {"symmetric": True},
    "gain from the P before": {"before": True},
    "sign of the update": {"sign": -1.0},
}
"""By mistake: the parts of `_loop` in which it is."""


_EDITS = (
    Edit("update", "phi phi", "P is updated with phi in both places, and not with P z phi' P"),
    Edit("update", "z z", "P is updated with z in both places, and not with P z phi' P"),
    Edit("update", "phi z", "z and phi are exchanged in the update of P"),
    Edit("below", "z phi", "the denominator has z' P phi, and not phi' P z"),
    Edit("gain", "phi", "the gain has phi, and not z"),
    Edit("before", True, "the gain is taken from the P before its update"),
    Edit("error", "z", "z stands in the error, and not phi"),
    Edit("sign", -1.0, "K epsilon is subtracted"),
)


@np.errstate(all="ignore")  # some of them run away
def _loop(
    u: FloatArray,
    y: FloatArray,
    warm_up: int,
    update: str = "z phi",
    below: str = "",
    gain: str = "z",
    before: bool = False,
    error: str = "phi",
    sign: float = 1.0,
    symmetric: bool = False,
    throughout: bool = False,
) -> FloatArray:
    """The notebook's loop with these vectors in its terms; the denominator goes with the update where it is empty.

    P is taken for `symmetric` in the update, or phi for z `throughout`.
    """
    theta, P, stable = np.zeros(2), 1e6 * np.eye(2), np.zeros(2)
    phi, z_model, history = np.zeros(2), np.zeros(2), np.zeros((y.size, 2))
    left, right = update.split()
    first, last = below.split() if below else (right, left)
    for n in range(y.size):
        of = {"phi": phi, "z": phi if n < warm_up or throughout else z_model}
        P_before, row = P, P @ of[right] if symmetric else of[right] @ P
        P = P - np.outer(P @ of[left], row) / (1 + of[first] @ P @ of[last])
        theta = theta + sign * (P_before if before else P) @ of[gain] * (y[n] - of[error] @ theta)
        history[n] = theta
        stable = theta.copy() if abs(theta[0]) < 1 else stable
        phi, z_model = np.array([-y[n], u[n]]), np.array([-z_model @ stable, u[n]])
    return history
