"""Checks of pseudo-linear regression: the prediction errors of ARMAX, and the rounds of regression."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_array, as_theta, as_vector
from labsid.checks.question import Ask, returned
from labsid.checks.regressions import WRAPS
from labsid.checks.trials import ARMAX, ARX, STARTS, first_order, trial_record
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.prediction import free_run, prediction_errors
from labsid.model_structures.structures import PolynomialModel, build_equations, fit_structure, model_from_theta


@first_failure
def check_armax(ask: Ask) -> Iterator[Verdict]:
    """`prediction_errors(theta, u, y)` and `pseudo_linear(u, y, share, rounds)`."""
    for c in (0.5, -0.6):
        theta = np.array([-ask.rng.uniform(0.3, 0.9), ask.rng.uniform(0.5, 2), c * ask.rng.uniform(0.8, 1.2)])
        yield _judge_errors(ask, theta, *trial_record(ask.rng, 25, 0.3))
    for c, share, rounds in ((0.4, 1.0, 0), (0.4, 1.0, 3), (-0.6, 0.5, 6)):
        yield _judge_rounds(ask, *trial_record(ask.rng, 200, c), share, rounds)
    yield Verdict(True, "the errors are filtered, the rounds go the share that they are told.")


def _judge_errors(ask: Ask, theta: FloatArray, u: FloatArray, y: FloatArray) -> Verdict:
    call = "prediction_errors(theta, u, y)"
    value = returned(ask, "prediction_errors", theta, u, y)
    a, b, c = (float(x) for x in theta)

    def errors(a: float = a, b: float = b, c: float = c, delay: int = 1) -> FloatArray:
        return prediction_errors(first_order(a, b, c, delay), u, y)

    if as_array(call, value).size == y.size - 1:
        less = f"`{call}` returns one sample less than y has"
        if SAME(np.ravel(as_array(call, value)), errors()[:-1]):
            return Verdict(False, f"{less}: the last is missing. Count up to len(y) - 1.", "last sample left out")
        if SAME(np.ravel(as_array(call, value)), errors()[1:]):
            return Verdict(False, f"{less}: begin with epsilon(0) = 0.", "first sample left out")
        return Verdict(False, f"{less}: there is one error for each sample, and epsilon(0) is 0.")

    return judge(
        as_vector(call, value, y.size),
        errors(),
        SAME,
        "",
        "`prediction_errors` is off: work the three samples of step 5 out by hand and compare.",
        [
            Slip(
                "noise term left out",
                "`prediction_errors` leaves c epsilon(t-1) out: those are the residuals of the ARX model.",
                lambda: errors(c=0.0),
            ),
            Slip(
                "sign of c",
                "`prediction_errors` has the other sign of c.",
                lambda: errors(c=-c),
                mend="The prediction holds +c epsilon(t-1), so the error -c.",
            ),
            Slip(
                "sign of a",
                "`prediction_errors` has the other sign of a.",
                lambda: errors(a=-a),
                mend="The prediction holds -a y(t-1), so the error +a.",
            ),
            Slip(
                "sign of b", "`prediction_errors` adds b u(t-1).", lambda: errors(b=-b), mend="It is to be taken off."
            ),
            Slip(
                "lag off by one",
                "`prediction_errors` takes u(t) where the equation has u(t-1).",
                lambda: errors(delay=0),
            ),
            Slip(
                "lag off by one",
                "`prediction_errors` takes u(t) where the equation has u(t-1).",
                lambda: prediction_errors(first_order(a, b, c, 0), np.append(0.0, u[1:]), y),
            ),
            Slip(
                "simulation for prediction",
                "`prediction_errors` takes a simulated output off: the prediction uses the measured y(t-1).",
                lambda: y - free_run(first_order(a, b), u),
            ),
            Slip(
                "simulation for prediction",
                "`prediction_errors` takes a simulated output off, and divides by C: the prediction uses the measured "
                "y(t-1), so that a multiplies y(t-1) and not the simulated output.",
                lambda: _filtered(c, y - free_run(first_order(a, b), u)),
            ),
            Slip(
                "simulation for prediction",
                "`prediction_errors` feeds back the model's own output: the prediction has the *measured* y(t-1).",
                lambda: y - lfilter([0.0, b], [1.0, a + c], u) - lfilter([0.0, c], [1.0, a + c], y),
            ),
            Slip(
                "C for 1/C",
                "`prediction_errors` multiplies w by 1 + c q^-1: epsilon(t) + c epsilon(t-1) = w(t) is to be *solved*.",
                lambda: errors(c=0.0) + c * np.append(0.0, errors(c=0.0)[:-1]),
            ),
            Slip(
                "prediction for its error",
                "`prediction_errors` returns the prediction itself.",
                lambda: y - errors(),
                mend="Take it off y.",
            ),
            Slip(
                WRAPS,
                "`prediction_errors` takes y(-1) and u(-1) from the *end* of the record, as `np.roll` and an index of "
                "-1 do: begin with t = 1, epsilon(0) = 0.",
                lambda: _filtered(c, y + a * np.roll(y, 1) - b * np.roll(u, 1)),
            ),
            Slip(
                "first samples left at zero",
                "`prediction_errors` leaves epsilon(1) at zero, and y(1), y(0) and u(0) are there: begin with t = 1.",
                lambda: _filtered(c, np.where(np.arange(y.size) < 2, 0.0, errors(c=0.0))),
            ),
            Slip("sign of the errors", "`prediction_errors` has prediction less measurement.", lambda: -errors()),
        ],
    )


def _filtered(c: float, w: FloatArray) -> FloatArray:
    """The errors of epsilon(t) + c epsilon(t-1) = w(t)."""
    return free_run(PolynomialModel(np.array([1.0, c]), np.ones(1), np.ones(1), 0), w)


def rounds_of(
    u: FloatArray,
    y: FloatArray,
    share: float,
    rounds: int,
    start: int = 1,
    renew: bool = True,
    from_zero: bool = False,
    keep: float = 1.0,
    whole: bool = False,
) -> FloatArray:
    """Pseudo-linear regression as in the notebook; with `renew` off the first errors are kept.

    `keep` is what stays of the old theta where a share of the step is taken: all of it is right. With `whole` a share
    of the new theta is added, and not one of the step.
    """
    first = np.append(np.zeros(2) if from_zero else fit_structure(ARX, u, y, start=start).model.theta, 0.0)
    theta = first
    for _ in range(rounds):
        e = prediction_errors(model_from_theta(ARMAX, theta if renew else first), u, y)
        equations = build_equations(ARMAX, u, y, e, start=start)
        new = solve_least_squares(equations.Phi, equations.Y).theta
        theta = keep * theta + share * (new - (0 if whole else keep) * theta)
    return theta


def _judge_rounds(ask: Ask, u: FloatArray, y: FloatArray, share: float, rounds: int) -> Verdict:
    call = f"pseudo_linear(u, y, {share}, {rounds})"
    value = returned(ask, "pseudo_linear", u, y, share, rounds)
    if rounds == 0 and as_array(call, value).size == 2:
        return Verdict(
            False, f"`{call}` returns two numbers: the start has c = 0 as its third.", "start without a third"
        )
    got = as_theta(call, value, 3)
    rights = [rounds_of(u, y, share, rounds, start) for start in STARTS]
    right = next((right for right in rights if SAME(got, right)), rights[0])
    count = f"`{call}` goes another number of rounds: a round is errors, regression, step."
    return judge(
        got,
        right,
        SAME,
        "",
        f"`{call}` is off. A round regresses y(t) on [-y(t-1), u(t-1), epsilon(t-1)], with theta = [a, b, c]: print "
        "the "
        "row of t = 2 in the first round, where epsilon is known.",
        [
            Slip(
                "share not used",
                f"`{call}` goes the whole way: a share of 0.5 goes half of it.",
                partial(rounds_of, u, y, 1.0, rounds),
            ),
            Slip(
                "share not used",
                f"`{call}` goes the rest of the way: share 1 is the whole step.",
                partial(rounds_of, u, y, 1 - share, rounds),
            ),
            Slip(
                "share of the result",
                f"`{call}` takes a share of the new theta: a share of the *step* is added to the old one.",
                partial(rounds_of, u, y, share, rounds, keep=0.0),
            ),
            Slip(
                "share of the result",
                f"`{call}` adds a share of the new theta to the old one: what is added is a share of the step, "
                "theta_new - theta.",
                partial(rounds_of, u, y, share, rounds, whole=True),
            ),
            Slip(
                "errors not renewed",
                f"`{call}` works with the first errors in every round: compute them with the latest theta.",
                partial(rounds_of, u, y, share, rounds, renew=False),
            ),
            Slip(
                "start from zero",
                f"`{call}` begins with theta = 0.",
                partial(rounds_of, u, y, share, rounds, from_zero=True),
                mend="The start is the least-squares [a, b], with c = 0.",
            ),
            Slip("rounds miscounted", count, partial(rounds_of, u, y, share, rounds + 1)),
            Slip("rounds miscounted", count, partial(rounds_of, u, y, share, max(rounds - 1, 0))),
            Slip(
                "sign of a",
                f"`{call}` has the other sign of a: the regressor holds -y(t-1).",
                lambda: right * [-1, 1, 1],
            ),
            Slip("order of theta", f"`{call}` has theta in another order than [a, b, c].", lambda: right[[0, 2, 1]]),
            Slip("order of theta", f"`{call}` has theta in another order than [a, b, c].", lambda: right[[1, 0, 2]]),
            *(
                Slip(
                    "lag off by one",
                    f"`{call}` pairs the error with its own sample.",
                    partial(_same_time, u, y, share, rounds, renew),
                    mend="The regressor of y(t) holds epsilon(t-1).",
                )
                for renew in (True, False)
            ),
        ],
    )


def _same_time(u: FloatArray, y: FloatArray, share: float, rounds: int, renew: bool) -> FloatArray:
    first = np.append(fit_structure(ARX, u, y).model.theta, 0.0)
    theta = first
    for _ in range(rounds):
        e = prediction_errors(model_from_theta(ARMAX, theta if renew else first), u, y)
        Phi = np.column_stack([-y[:-1], u[:-1], e[1:]])
        theta = theta + share * (solve_least_squares(Phi, y[1:]).theta - theta)
    return theta
