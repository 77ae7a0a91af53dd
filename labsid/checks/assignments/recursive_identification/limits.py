"""Checks of the lecture's end: covariance wind-up and how to stop it, and a form of RLS that loses its symmetry."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.recursive_identification.reference_runs import (
    is_one_array,
    reference_run,
    run_with,
    slips_of_update,
)
from labsid.checks.compare import SAME, as_history, as_vector
from labsid.checks.double_mistakes import TWO
from labsid.checks.question import Ask, returned_parts
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.estimation.recursion import RecursiveState
from labsid.estimation.recursive import recursive_least_squares
from labsid.model_structures.structures import Structure, build_equations

Run = tuple[FloatArray, FloatArray]

_FIR = Structure(0, 2)

_LEAST_ROUNDING = 1e-20
"""Relative to P, rounding is about 1e-16; relative to 1, in the trials, another 1e-9 smaller."""

_LARGEST_SCATTER = 0.02
"""Of ln(max|P - P'| lambda^n) in the trials. Over 300 draws the right form has less than 2e-4, division by the trace
or by a norm of P at least 0.07, by the smallest entry 0.8."""


@first_failure
def check_windup(ask: Ask) -> Iterator[Verdict]:
    """`rls_bounded(Phi, Y, lam, LN, bound)`: forgetting pauses at a bound on the trace of P."""
    for lam, LN, bound in ((0.8, 5.0, 30.0), (0.9, 10.0, 4.0), (0.95, 10.0, 0.5)):
        drawn = float(np.round(lam + ask.rng.uniform(-0.02, 0.02), 3)), float(np.round(LN * ask.rng.uniform(0.8, 1.2)))
        yield _one_bounded(ask, *drawn, float(np.round(bound * ask.rng.uniform(0.9, 1.1), 2)))


def _one_bounded(ask: Ask, lam: float, LN: float, bound: float) -> Verdict:
    busy, quiet, p = 25, 45, 2
    u = np.concatenate(
        [ask.rng.uniform(-2, 2, busy), np.full(quiet, ask.rng.uniform(0.5, 1.5)), ask.rng.uniform(-2, 2, busy)]
    )
    Phi = build_equations(_FIR, u, np.zeros(u.size), start=0).Phi
    Y = Phi @ ask.rng.uniform(1, 3, p) + ask.rng.uniform(-1, 1, Phi.shape[0])
    call = f"rls_bounded(Phi, Y, {lam:g}, {LN:g}, {bound:g})"
    parts = returned_parts(ask, "rls_bounded", "the history of theta and that of the trace", 2, Phi, Y, lam, LN, bound)
    theta = as_history(f"theta of {call}", parts[0], *Phi.shape)
    trace = as_vector(f"trace of {call}", parts[1], Phi.shape[0])
    start = RecursiveState(np.zeros(p), LN * np.eye(p), bound, np.empty(0))
    run = recursive_least_squares(Phi, Y, lam, start)
    right: Run = (run.theta, run.P_trace)
    if is_one_array(theta, [right[0]]):
        return Verdict(
            False,
            "every row of `rls_bounded` is the last estimate: store a copy of theta.",
            "one array stored again and again",
        )
    after = bounded_run(Phi, Y, lam, LN, bound, "look after")
    slips: list[Slip[Run]] = [
        Slip(name, hint, partial(bounded_run, Phi, Y, lam, LN, bound, rule)) for name, rule, hint in _WRONG_RULES
    ]
    verdict = judge(
        (theta, trace),
        right,
        _both_same,
        "forgetting waits until there is something new to learn, and P stays bounded.",
        "`rls_bounded` does not follow the rule: where trace(P)/lambda exceeds the bound, the sample is used with "
        "lambda = 1; otherwise as ever.",
        [
            Slip(
                "trace of the old P",
                "the traces of `rls_bounded` are one sample late: store the trace of the P after the update.",
                lambda: (right[0], np.concatenate([[p * LN], right[1][:-1]])),
            ),
            Slip(
                "trace over lambda stored",
                "the traces of `rls_bounded` are divided by lambda: store trace(P) itself. Only the comparison with "
                "the bound divides it.",
                lambda: (right[0], right[1] / lam),
            ),
            *slips,
            *(
                Slip(TWO, f"{hint} And {other}", partial(_with_trace, Phi, Y, (lam, LN, bound), rule, is_old))
                for _, rule, hint in _WRONG_RULES
                if rule in _WITH_TRACES
                for is_old, other in (
                    (True, "the traces are one sample late: store that of the P after the update."),
                    (False, "the traces are divided by lambda: store trace(P) itself."),
                )
            ),
        ],
    )
    if not verdict.passed and _both_same((theta, trace), after):
        # the other way to read the rule: try the step with lambda, and do it again where P came out too large
        return Verdict(True, "forgetting waits until there is something new to learn, and P stays bounded.")
    return verdict


_WITH_TRACES = ("none", "late", "times", "for good", "never")
"""Rules that are tried together with another mistake in the traces."""


def _with_trace(Phi: FloatArray, Y: FloatArray, numbers: tuple[float, float, float], rule: str, is_old: bool) -> Run:
    """A run with another rule, and with the traces of the P before each sample, or with those over lambda."""
    lam, LN, bound = numbers
    theta, trace = bounded_run(Phi, Y, lam, LN, bound, rule)
    return theta, np.concatenate([[Phi.shape[1] * LN], trace[:-1]]) if is_old else trace / lam


_WRONG_RULES = (
    (
        "first sample not compared",
        "from the second",
        "`rls_bounded` uses the first sample with lambda whatever the bound is: P(0) = LN I is compared as every other "
        "P is, before the sample is used.",
    ),
    (
        "no bound",
        "none",
        "`rls_bounded` never pauses: P grows past the bound while nothing excites the plant.",
    ),
    (
        "lambda = 1 for good",
        "for good",
        "`rls_bounded` stops forgetting for good once it has paused: decide anew for every sample.",
    ),
    (
        "forgetting never",
        "never",
        "`rls_bounded` runs with lambda = 1 throughout: pause only where the bound would be passed, that is where "
        "trace(P)/lambda is larger than it.",
    ),
    (
        "sample skipped",
        "skip",
        "`rls_bounded` skips the sample at the bound: use it, with lambda = 1. Skipped, it teaches nothing any more.",
    ),
    (
        "looks too late",
        "late",
        "`rls_bounded` compares trace(P) with the bound; after the division by lambda it may be above. Compare "
        "trace(P)/lambda.",
    ),
    *(
        (
            "P scaled down",
            when,
            "`rls_bounded` scales P down to the bound. That limits P, too, but it forgets as fast as before; "
            "asked for is a pause.",
        )
        for when in ("scale", "scale first")
    ),
    *(
        (
            "P reset",
            when,
            "`rls_bounded` starts P afresh at the bound: what was learnt is thrown away. Asked for is a pause: P is "
            "kept, and this one sample is used with lambda = 1.",
        )
        for when in ("reset", "reset first", "reset late", "reset and pause", "even")
    ),
    *(
        (
            "another measure of P",
            measure,
            f"`rls_bounded` compares {words} of P with the bound: it is the trace, over lambda, that is compared.",
        )
        for measure, words in (("norm", "the norm"), ("max", "the largest entry"), ("det", "the determinant"))
    ),
    (
        "trace times lambda",
        "times",
        "`rls_bounded` compares lambda times the trace with the bound: the update divides P by lambda. Compare "
        "trace(P)/lambda.",
    ),
)
_MEASURES: dict[str, Callable[[FloatArray], Any]] = {"norm": np.linalg.norm, "max": np.max, "det": np.linalg.det}


def bounded_run(Phi: FloatArray, Y: FloatArray, lam: float, LN: float, bound: float, rule: str) -> Run:
    """RLS with another rule at the bound than the one asked for."""
    p = Phi.shape[1]
    theta, P, paused = np.zeros(p), LN * np.eye(p), False
    history, traces = np.empty(Phi.shape), np.empty(Y.size)

    def updated(kept: float) -> FloatArray:
        return np.asarray((P - np.outer(P @ phi, P @ phi) / (kept + phi @ P @ phi)) / kept, float)

    for k, (phi, y) in enumerate(zip(Phi, Y, strict=True)):
        trace = float(np.trace(P))
        over = float(_MEASURES.get(rule, np.trace)(P)) / (1 / lam if rule == "times" else lam) > bound
        over = over and not (rule == "from the second" and k == 0)
        paused = paused or over
        if rule == "skip" and over:
            history[k], traces[k] = theta, trace
            continue
        if rule == "look after":
            over = bool(np.trace(updated(lam)) > bound)
        if (over and rule in ("reset first", "reset and pause")) or (trace > bound and rule == "reset late"):
            P = LN * np.eye(p)
        if over and rule == "even":
            P = bound / p * np.eye(p)
        pauses = {"for good": paused, "never": True, "late": trace > bound, "look after": over}
        pauses |= dict.fromkeys(("reset and pause", "times", "from the second", *_MEASURES), over)
        P = updated(1.0 if pauses.get(rule, False) else lam)
        if rule == "scale first" and np.trace(P) > bound:
            P = P * bound / np.trace(P)
        theta = theta + P @ phi * (y - phi @ theta)
        if rule == "scale" and np.trace(P) > bound:
            P = P * bound / np.trace(P)
        if rule == "reset" and np.trace(P) > bound:
            P = LN * np.eye(p)
        history[k], traces[k] = theta, np.trace(P)
    return history, traces


def _both_same(a: Run, b: Run) -> bool:
    return SAME(a[0], b[0]) and SAME(a[1], b[1])


@first_failure
def check_careless(ask: Ask) -> Iterator[Verdict]:
    """`rls_careless(Phi, Y, lam, LN)`: on paper the same RLS; its P loses its symmetry as lambda^-n."""
    for p in (3, 4):  # with two parameters P has one pair of entries, which may stay equal for long by chance
        yield _one_careless(ask, p)


def _one_careless(ask: Ask, p: int) -> Verdict:
    n, lam, size = 220, float(ask.rng.uniform(0.89, 0.92)), 1e4
    LN = 1 / size**2
    Phi = size * ask.rng.standard_normal((n, p))
    Y = size * ask.rng.uniform(-3, 3, n)
    parts = returned_parts(ask, "rls_careless", "the history of theta and that of the asymmetry", 2, Phi, Y, lam, LN)
    if np.shape(parts[0]) == (n, p) and SAME(np.asarray(parts[0], float)[0], LN * Phi[0] * Y[0]):  # type: ignore[arg-type]
        return Verdict(
            False,
            "the gain of `rls_careless` is P phi, undivided: K = P phi / (lambda + phi'P phi), with the P before the "
            "sample.",
            "gain not divided",
        )
    theta = as_history("theta of rls_careless", parts[0], n, p)
    asymmetry = as_vector("asymmetry of rls_careless", parts[1], n)
    right = reference_run(Phi, Y, lam, LN).theta
    if is_one_array(theta[:60], [right[:60], theta[-1:]]):
        return Verdict(
            False,
            "every row of `rls_careless` is the last estimate: store a copy of theta.",
            "one array stored again and again",
        )
    verdict = judge(
        theta[:60],
        right[:60],
        SAME,
        "",
        "over the first samples, before rounding has grown, `rls_careless` should be RLS, and is not: "
        "K = P phi / (lambda + phi'P phi), theta + K error, then P = (P - K (P phi)') / lambda.",
        [
            Slip(
                "P not divided by lambda",
                "P of `rls_careless` is not divided by lambda: the brackets close before the division.",
                lambda: _careless_wrong(Phi, Y, lam, LN, divided=False)[:60],
            ),
            Slip(
                "gain from the new P",
                "`rls_careless` divides a gain that it takes from the new P: K is computed first, from the old P.",
                lambda: _careless_wrong(Phi, Y, lam, LN, divided=True)[:60],
            ),
            Slip(
                "number for outer product",
                "`rls_careless` takes the number K'P phi from every entry of P: for flat arrays `K @ P_phi.T` is a "
                "number. The matrix is `np.outer(K, P_phi)`.",
                lambda: _careless_wrong(Phi, Y, lam, LN, divided=True, number=True)[:60],
            ),
            Slip(
                "1 in the denominator",
                "`rls_careless` has 1 + phi'P phi under its gain: with forgetting it is lambda + phi'P phi.",
                lambda: _careless_wrong(Phi, Y, lam, LN, divided=True, one=True)[:60],
            ),
            Slip(
                "lambda not used",
                "`rls_careless` runs with lambda = 1.",
                lambda: reference_run(Phi, Y, 1.0, LN).theta[:60],
            ),
            *slips_of_update(
                "`rls_careless`", lambda update: run_with(update, Phi[:60], Y[:60], lam, LN, gain_first=True)
            ),
        ],
    )
    return verdict if not verdict.passed else _judge_growth(asymmetry, Phi, lam, LN)


def _careless_wrong(
    Phi: FloatArray, Y: FloatArray, lam: float, LN: float, divided: bool, number: bool = False, one: bool = False
) -> FloatArray:
    p = Phi.shape[1]
    theta, P = np.zeros(p), LN * np.eye(p)
    history = np.empty(Phi.shape)
    for k, (phi, y) in enumerate(zip(Phi, Y, strict=True)):
        P_phi = P @ phi
        denominator = (1 if one else lam) + phi @ P_phi
        taken = P_phi @ P_phi if number else np.outer(P_phi, P_phi)
        P = (P - taken / denominator) / (lam if divided else 1)
        K = P @ phi / denominator if divided and not number and not one else P_phi / denominator
        theta = theta + K * (y - phi @ theta)
        history[k] = theta
    return history


_LARGEST_ASYMMETRY = 2.0
"""Of |P - P'| over the largest |P|: two entries of opposite signs."""


def _whole_or_not(asymmetry: FloatArray) -> str:
    """What numbers larger than a share are, if they can be told."""
    if np.array_equal(asymmetry, np.round(asymmetry)):
        return "Yours are whole numbers, indices as `np.argmax` gives them; the largest entry itself is `np.max`."
    return "It is max|P - P'| divided by max|P|, both of the same P."


def _judge_growth(asymmetry: FloatArray, Phi: FloatArray, lam: float, LN: float) -> Verdict:
    """Rounding is of no known size, but its growth is: a factor 1/lambda a sample, to far below a per cent."""
    if np.min(asymmetry) < 0:
        return Verdict(
            False, "the asymmetry of `rls_careless` is negative somewhere: take absolute values.", "sign kept"
        )
    if np.max(asymmetry) > _LARGEST_ASYMMETRY:
        return Verdict(
            False,
            f"the asymmetry of `rls_careless` goes up to {np.max(asymmetry):.3g}. A share of the largest entry of "
            f"P is at most {_LARGEST_ASYMMETRY:g}. {_whole_or_not(asymmetry)}",
            "no share of the largest entry",
        )
    window = np.arange(100, 200)
    symmetric = bool(np.any(asymmetry[window] == 0))
    growth = 0.0 if symmetric else np.polyfit(window, np.log(asymmetry[window]), 1)[0] / -np.log(lam)
    if growth < 0.5:
        return Verdict(
            False,
            "P of `rls_careless` stays symmetric: that is the sound form. Asked for is the careless one, with "
            "K (P phi)' as the product of two vectors, P phi computed once, and nothing made symmetric.",
            "the sound form",
        )
    if growth > 1.5:
        return Verdict(
            False,
            f"the asymmetry of `rls_careless` grows by a factor of {lam**-growth:.4g} in each sample, where that of "
            f"rounding grows by 1/lambda = {1 / lam:.4g}. It is max|P - P'| / max|P|, both of the same P.",
        )
    if asymmetry[100] < _LEAST_ROUNDING * lam**-100:
        return Verdict(
            False,
            "the asymmetry of `rls_careless` is not relative: divide the largest of |P - P'| by the largest of |P|.",
            "not divided by the size of P",
        )
    scaled = np.log(asymmetry[window] * _largest_entries(Phi, lam, LN)[window]) + window * np.log(lam)
    if np.std(scaled) > _LARGEST_SCATTER:
        return Verdict(
            False,
            "the asymmetry of `rls_careless` is divided by another measure of P than its largest entry, max|P|.",
            "divided by another measure of P",
        )
    return Verdict(True, "the same on paper, but a rounding error of 1e-16 grows by 1/lambda with every sample.")


def _largest_entries(Phi: FloatArray, lam: float, LN: float) -> FloatArray:
    """max|P| after each sample, with P kept symmetric."""
    P = LN * np.eye(Phi.shape[1])
    largest = np.empty(len(Phi))
    for k, phi in enumerate(Phi):
        P_phi = P @ phi
        P = (P - np.outer(P_phi, P_phi) / (lam + phi @ P_phi)) / lam
        P = (P + P.T) / 2
        largest[k] = np.max(np.abs(P))
    return largest
