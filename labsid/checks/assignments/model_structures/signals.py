"""Checks of what works on signals: a polynomial in q^-1, and the simulation of the whole family of structures."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.checks.compare import as_array, as_vector, close
from labsid.checks.double_mistakes import Edit, pairs_of, with_pairs
from labsid.checks.question import Ask, returned, with_lists
from labsid.checks.recursions import Factor, with_recursion
from labsid.checks.regressions import wrapped_filter
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.model_structures.polynomials import apply
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel

EXACT = close(1e-8)


@first_failure
def check_shift(ask: Ask) -> Iterator[Verdict]:
    """`apply(P, x)`: a polynomial in q^-1 works on a signal."""
    for n in (3, 2, 5, 1):
        P, x = ask.rng.uniform(0.5, 2, n), ask.rng.uniform(-3, 3, ask.rng.integers(10, 15))
        x[0] += 5
        yield _judge_shift(ask, P, x)


def _judge_shift(ask: Ask, P: FloatArray, x: FloatArray) -> Verdict:
    n = P.size
    value = returned(ask, "apply", P, x)
    size = as_array("apply(P, x)", value).size
    if n > 1 and size == x.size + n - 1:
        return Verdict(
            False,
            "`apply` returns more samples than `x` has: what comes after the last sample of x is the answer to a "
            "signal that has ended. Keep the first len(x).",
            "tail not cut off",
        )
    if n > 1 and size == x.size - n + 1 and EXACT(np.ravel(as_array("apply(P, x)", value)), apply(P, x)[n - 1 :]):
        return Verdict(
            False,
            "`apply` leaves out the first samples. They are there, with zero for what lies before the signal.",
            "first samples left out",
        )
    forward = np.concatenate([x, np.zeros(n)])
    x_before = np.concatenate([np.full(n, x[0]), x])
    return judge(
        as_vector("apply(P, x)", value, x.size),
        apply(P, x),
        EXACT,
        "the polynomial works on the signal, from rest.",
        "`apply` is not p0 x(k) + p1 x(k-1) + ...: go through the table above, sample by sample.",
        [
            Slip(
                "shifted the wrong way",
                "`apply` takes samples that are yet to come: q^-1 is the value *before*, x(k-1).",
                lambda: np.array([P @ forward[k : k + n] for k in range(x.size)]),
            ),
            Slip(
                "first coefficient only",
                "`apply` uses P[0] alone: each coefficient multiplies a sample of its own.",
                lambda: P[0] * x,
            ),
            Slip(
                "index wraps around",
                "`apply` takes the last samples for those before the first: `np.roll` and negative indices go round. "
                "Before the first sample the signal is zero.",
                lambda: np.asarray(sum(p * np.roll(x, i) for i, p in enumerate(P)), float),
            ),
            Slip(
                "first sample repeated",
                "`apply` repeats the first sample to the left; before it, the signal is zero.",
                lambda: np.asarray(sum(P[i] * x_before[n - i : n - i + x.size] for i in range(n)), float),
            ),
            Slip(
                "coefficients in reverse order",
                "`apply` has the coefficients in reverse order: P[0] stands with x(k), the lowest delay.",
                lambda: apply(P[::-1], x),
            ),
            Slip(
                "lag off by one",
                "`apply` begins with x(k-1): P[0] stands with x(k) itself.",
                lambda: apply(np.concatenate([[0.0], P]), x),
            ),
            Slip(
                "output fed back",
                "`apply` divides by P, as `lfilter([1], P, x)` does: P belongs in the numerator.",
                lambda: free_run(PolynomialModel(P / P[0], 1 / P[:1], np.ones(1), 0), x),
            ),
            *(
                Slip(
                    "first samples left at zero",
                    "`apply` leaves the first samples at zero. Only what lies *before* the signal is zero.",
                    partial(np.where, np.arange(x.size) < start, 0, apply(P, x)),
                )
                for start in (n - 1, n)
            ),
            Slip(
                "polynomial of a number",
                "`apply` puts each x(k) into a polynomial, as `np.polyval` does: P[i] multiplies the *earlier* sample "
                "x(k-i), not a power of x(k).",
                lambda: np.polyval(P, x),
            ),
            Slip(
                "a coefficient left out",
                "`apply` leaves out the last coefficient of P: `range(n)` ends with n - 1, and so counts all n.",
                lambda: apply(P[:-1], x),
            ),
            Slip(
                "a coefficient left out",
                "`apply` leaves out P[0], the coefficient of x(k).",
                lambda: apply(np.r_[0.0, P[1:]], x),
            ),
            Slip(
                "middle of the convolution",
                "`apply` takes the middle of the convolution (`mode='same'`): take its first len(x) samples.",
                lambda: np.convolve(P, x, mode="same"),
            ),
            *pairs_of("`apply`", _EDITS_OF_SHIFT, partial(_shifted, P, x)),
        ],
    )


_EDITS_OF_SHIFT = (
    Edit("coefficients", "cut", "the last coefficient of P is left out"),
    Edit("coefficients", "first", "P[0] is left out"),
    Edit("coefficients", "turned", "the coefficients are in reverse order"),
    Edit("coefficients", "late", "P[0] stands with x(k-1), and not with x(k)"),
    Edit("way", "roll", "the last samples are taken for those before the first, as `np.roll` does"),
    Edit("way", "ahead", "samples that are yet to come are taken for those before"),
    Edit("way", "held", "the first sample is repeated before the signal, which is zero there"),
)


def _shifted(P: FloatArray, x: FloatArray, coefficients: str = "", way: str = "") -> FloatArray:
    """A polynomial applied to a signal, with other coefficients and in other ways."""
    p = {
        "cut": np.r_[P[:-1], 0.0], "first": np.r_[0.0, P[1:]], "turned": P[::-1], "late": np.r_[0.0, P], "": P,
    }[coefficients]  # fmt: skip
    n = p.size
    if way == "roll":
        return wrapped_filter(p, x)
    if way == "ahead":
        ahead = np.r_[x, np.zeros(n)]
        return np.array([p @ ahead[k : k + n] for k in range(x.size)])
    before = np.r_[np.full(n, x[0] if way == "held" else 0.0), x]
    return np.asarray(sum(p[i] * before[n - i : n - i + x.size] for i in range(n)), float)


def check_simulate(ask: Ask) -> Verdict:
    """`simulate(A, B, C, u, e)`, for ARMAX, ARX with a direct path, FIR and ARMA."""
    verdict = Verdict(False, "")
    rng = ask.rng
    for na, nb, nc, delay in ((2, 2, 2, 1), (1, 2, 0, 0), (0, 3, 0, 1), (2, 1, 1, 2), (3, 1, 1, 1)):
        # the sum of |a| stays below one, so that the model is stable with the other sign, too
        a = rng.choice([-1.0, 1.0], na) * rng.uniform(0.15, 0.3, na)
        b = np.concatenate([np.zeros(delay), rng.uniform(0.5, 2, nb)])
        c = rng.choice([-1.0, 1.0], nc) * rng.uniform(0.3, 0.6, nc)
        samples = int(rng.integers(20, 30))
        u = rng.uniform(1, 2, samples) * rng.choice([-1.0, 1.0], samples)
        e = rng.uniform(0.5, 1.5, samples)
        verdict = _judge_simulate(ask, np.r_[1, a], b, np.r_[1, c], u, e)
        if not verdict.passed:
            return verdict
    return with_lists(ask, lambda given: _judge_simulate(given, np.r_[1, a], b, np.r_[1, c], u, e), 0, 1, 2)


def _judge_simulate(ask: Ask, A: FloatArray, B: FloatArray, C: FloatArray, u: FloatArray, e: FloatArray) -> Verdict:
    def run(a: FloatArray = A, b: FloatArray = B, c: FloatArray = C, noise: FloatArray = e) -> FloatArray:
        return free_run(PolynomialModel(a, b, c, 0), u, noise)

    def behind() -> FloatArray:
        return run(noise=0 * e)

    opposite = np.r_[1, -A[1:]]
    right = run()
    output = (
        "`simulate` adds the noise behind the plant, as in System 2. In A y = B u + C e it goes through 1/A, as the "
        "input does."
    )
    got = as_vector("simulate(A, B, C, u, e)", returned(ask, "simulate", A, B, C, u, e), u.size)
    verdict = judge(
        got,
        right,
        EXACT,
        "one function for ARX, ARMAX, FIR, AR and ARMA.",
        "`simulate` does not solve A y = B u + C e from rest: compute its first three samples by hand.",
        [
            Slip(
                "sign of a",
                "`simulate` adds the past outputs. On the right-hand side they have a minus: y(k) = ... - a1 y(k-1).",
                lambda: run(a=opposite),
            ),
            Slip("noise added at the output", output, lambda: behind() + e),
            Slip("noise added at the output", output, lambda: behind() + apply(C, e)),
            Slip(
                "C not used",
                "`simulate` takes e for C e: the noise is coloured by C before it goes in.",
                lambda: run(c=np.ones(1)),
            ),
            Slip(
                "divided by C",
                "`simulate` divides the noise by C: C multiplies e, and 1/A filters both.",
                lambda: behind() + free_run(PolynomialModel(C, np.ones(1), np.ones(1), 0), e),
            ),
            Slip(
                "divided by C",
                "`simulate` divides the noise by A and by C: C multiplies e, and 1/A filters both.",
                lambda: behind() + lfilter([1.0], np.convolve(A, C), e),
            ),
            Slip("noise left out", "`simulate` leaves the noise out.", behind),
            *(
                Slip(
                    "first order only",
                    f"`simulate` uses only A[1] and B[1] of its {A.size} and {B.size} coefficients: go through all of "
                    "them.",
                    partial(run, A[:2], np.array([0.0, *B[1:2]]), c, noise),
                )
                for c in (C, C[:2], np.ones(1))
                for noise in (e, np.r_[0.0, e[1:]])
            ),
            Slip("input left out", "`simulate` leaves the input out.", lambda: run(b=np.zeros(1))),
            Slip(
                "A not used",
                "`simulate` lets nothing run through 1/A: past outputs are missing.",
                lambda: run(a=np.ones(1)),
            ),
            Slip(
                "noise added to the input",
                "`simulate` sends e through B, as if it were added to the input: only C multiplies it.",
                lambda: free_run(PolynomialModel(A, B, np.ones(1), 0), u + e),
            ),
            Slip(
                "C for both",
                "`simulate` sends the input through C as well: C multiplies e alone.",
                lambda: free_run(PolynomialModel(A, C, np.ones(1), 0), apply(B, u) + e),
            ),
            Slip(
                "multiplied by A",
                "`simulate` multiplies B u + C e by A. In A y = B u + C e, y is what A multiplies: divide by A.",
                lambda: apply(A, apply(B, u) + apply(C, e)),
            ),
            Slip(
                "only the noise through 1/A",
                "`simulate` lets the noise alone run through 1/A: the input goes through it, too.",
                lambda: apply(B, u) + run(b=np.zeros(1)),
            ),
            Slip(
                "direct path lost",
                "`simulate` begins with u(k-1), whatever B says: B[0] stands with u(k), and the delay is in B already.",
                lambda: run(b=np.r_[0, B]),
            ),
            Slip(
                "direct path lost",
                "`simulate` leaves B[0] out: it stands with u(k), and is not always zero.",
                lambda: run(b=np.r_[0, B[1:]]),
            ),
            Slip(
                "C without its 1",
                "`simulate` leaves out e(k) itself: C begins with 1.",
                lambda: run() - run(b=np.zeros(1), c=np.ones(1)),
            ),
            Slip(
                "first samples left at zero",
                "`simulate` leaves the first samples at zero, as a loop does that starts at the longest lag. Only what "
                "lies before the record is zero: u(0) and e(0) act at once.",
                lambda: _late_start(A, B, C, u, e),
            ),
            Slip(
                "index wraps around",
                "`simulate` takes u and e from the end of the record for those before its first sample: `u[k - i]` "
                "with k < i.",
                lambda: free_run(
                    PolynomialModel(A, np.ones(1), np.ones(1), 0), wrapped_filter(B, u) + wrapped_filter(C, e)
                ),
            ),
        ],
    )
    asked = {
        **{("y", i): Factor(f"-A[{i}]", -a) for i, a in enumerate(A) if i},
        **{("u", i): Factor(f"B[{i}]", b) for i, b in enumerate(B) if b},
        **{("e", i): Factor(f"C[{i}]", c) for i, c in enumerate(C)},
    }
    verdict = with_recursion(verdict, ("y", got), {"u": u, "e": e}, asked)
    pairs = pairs_of("`simulate`", _edits_of_simulation(A, B, C), partial(_simulated, A, B, C, u, e))
    return with_pairs(verdict, got, EXACT, pairs)


def _edits_of_simulation(A: FloatArray, B: FloatArray, C: FloatArray) -> tuple[Edit, ...]:
    """Single mistakes in the past outputs, in the input and in the way of the noise."""
    one = np.ones(1)
    return (
        Edit("a", np.r_[1, -A[1:]], "the past outputs are added, and have a minus on the right-hand side"),
        Edit("b", np.r_[0, B], "the input begins with u(k-1), whatever B says"),
        Edit("b", np.r_[0, B[1:]], "B[0] is left out"),
        Edit("noise", (one, C, True), "the noise is divided by C, which multiplies it"),
        Edit("noise", (one, one, True), "C is not used"),
        Edit("noise", (C, one, False), "the noise does not go through 1/A"),
        Edit("noise", (one, one, False), "e is added at the output as it is"),
        Edit("noise", (0 * one, one, False), "the noise is left out"),
    )


def _simulated(
    A: FloatArray,
    B: FloatArray,
    C: FloatArray,
    u: FloatArray,
    e: FloatArray,
    a: FloatArray | None = None,
    b: FloatArray | None = None,
    noise: tuple[FloatArray, FloatArray, bool] | None = None,
) -> FloatArray:
    """The output with other polynomials; of the noise: numerator, denominator, and whether it goes through 1/A."""
    a, b = A if a is None else a, B if b is None else b
    numerator, denominator, is_filtered = (C, np.ones(1), True) if noise is None else noise
    of_noise = np.convolve(denominator, a) if is_filtered else denominator
    return np.asarray(lfilter(b, a, u) + lfilter(numerator, of_noise, e), float)


def _late_start(A: FloatArray, B: FloatArray, C: FloatArray, u: FloatArray, e: FloatArray) -> FloatArray:
    """The output of a loop that starts where all lags were recorded."""
    first = max(A.size, B.size, C.size) - 1
    driving = apply(B, u) + apply(C, e)
    driving[:first] = 0
    return free_run(PolynomialModel(A, np.ones(1), np.ones(1), 0), driving)
