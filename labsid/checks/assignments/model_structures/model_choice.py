"""Checks of what speaks for or against a model: excitation, cancelling roots, whiteness."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.compare import SAME, as_array, as_number, as_vector, close
from labsid.checks.double_mistakes import TWO
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.regressions import WRAPS, wrapped
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.lab.excitation import excitation_order, square_wave
from labsid.model_structures.input_signals import sinusoids
from labsid.model_structures.residuals import autocorrelation as reference_autocorrelation

_EXACT = close(1e-8)
_LARGEST = 8


def check_excitation(ask: Ask) -> Verdict:
    """`excitation(u, largest)` on inputs of every order from 0 to `largest`, in random order and some twice."""
    made = [*_inputs(ask.rng), *_inputs(ask.rng)]
    first, second = np.arange(len(made)).reshape(2, -1)
    trials = [made[i] for i in ask.rng.permutation([*first, *ask.rng.permutation(second)[:3]])]
    truth = [excitation_order(u, _LARGEST) for _, u in trials]
    raw = [returned(ask, "excitation", u, _LARGEST) for _, u in trials]
    answers = [as_number("excitation(u, 8)", answer) for answer in raw]
    if all(isinstance(answer, bool) for answer in raw):
        return Verdict(False, "`excitation` returns True or False: the order is a number.", "no number")
    if answers == truth:
        for largest in ask.rng.permutation([1, 3, 5]):
            few = as_number(f"excitation(u, {largest})", returned(ask, "excitation", made[second[-1]][1], int(largest)))
            if few != largest:
                return Verdict(False, "`excitation` does not stop at `largest`.", "largest not used")
        return Verdict(True, "it counts what an input can teach.")
    if [min(answer, _LARGEST) for answer in answers] == truth:
        return Verdict(False, "`excitation` goes on beyond `largest`: stop there.", "largest not used")
    for least, also in ((0, ""), (1, " And for an input that is zero throughout the order is 0, not 1.")):
        if answers == [max(least, min(right, _LARGEST - 1)) for right in truth]:
            return Verdict(
                False,
                "`excitation` stops one order too early: it never tries n = largest. (`range(1, largest)` leaves out "
                f"its end.){also}",
                TWO if also else "largest left out",
            )
    for slip, hint, rule in _WRONG_ORDERS:
        if answers == [rule(u) for _, u in trials]:
            return Verdict(False, f"`excitation` {hint}", slip)
    if answers == [max(1, right) for right in truth]:
        return Verdict(
            False,
            "`excitation` returns 1 for an input that is zero throughout: not even one column has full rank, so the "
            "order is 0.",
            "zero input",
        )
    if all(answer == _LARGEST for answer, right in zip(answers, truth, strict=True) if right):
        return Verdict(
            False,
            f"`excitation` finds full rank where there is none: {_why_full(ask)}",
            "full rank where there is none",
        )
    wrong = next(i for i, (answer, right) in enumerate(zip(answers, truth, strict=True)) if answer != right)
    if all(right <= answer <= _LARGEST for answer, right in zip(answers, truth, strict=True)):
        return Verdict(
            False,
            f"`excitation` finds too high an order, {answers[wrong]:g} for {trials[wrong][0]}: write the first rows of "
            "its matrix down, and count the independent columns. Rounding errors of about 1e-16 count "
            "for rank, too, where the comparison has no tolerance.",
            "full rank where there is none",
        )
    return Verdict(
        False,
        f"`excitation(u, {_LARGEST})` returns {answers[wrong]:g} for {trials[wrong][0]}, another order than its own. "
        "Print each n that is tried, the shape and the rank of its matrix, and its first rows.",
    )


def _why_full(ask: Ask) -> str:
    """Why an answer finds full rank everywhere.

    With an input that is 1 in the first sample and 0 after it no product is rounded: the rows that were recorded have
    rank 1 exactly, and rows with zeros before the first sample have full rank.
    """
    first = np.zeros(40)
    first[0] = 1.0
    if as_number("excitation(u, 8)", returned(ask, "excitation", first, _LARGEST)) == _LARGEST:
        return (
            "it fills zeros in before the first sample, so that every input seems to start with a jump. Use the rows "
            "only for which all samples were recorded."
        )
    return "it takes rounding errors of about 1e-16 for rank. Compare with a small tolerance."


def _inputs(rng: np.random.Generator) -> list[tuple[str, FloatArray]]:
    """Inputs with their names; the frequencies lie well apart."""
    samples = int(rng.integers(70, 90))
    phases = rng.uniform(0, 2 * np.pi, 3)
    low, middle, high = rng.uniform([0.4, 1.2, 2.1], [0.7, 1.6, 2.6])
    level = rng.uniform(1, 2)

    def waves(*omegas: float) -> FloatArray:
        m = len(omegas)
        return sinusoids(samples, np.linspace(1, 2, m), omegas, phases[:m])

    return [
        ("an input that is zero throughout", np.zeros(samples)),
        ("a constant", np.full(samples, level)),
        ("a sinusoid", waves(middle)),
        ("a sinusoid with a constant added", waves(low) + level),
        ("a signal that alternates between two values", level * (-1.0) ** np.arange(samples)),
        ("two sinusoids", waves(low, middle)),
        ("a square wave", square_wave(samples, 6)),
        ("three sinusoids", waves(low, middle, high)),
        ("random numbers", rng.uniform(-2, 2, samples)),
    ]


def _order_of(u: FloatArray) -> int:
    return excitation_order(u, _LARGEST)


def _next_order(u: FloatArray) -> int:
    return min(_order_of(u) + 1, _LARGEST)


def _distinct(u: FloatArray) -> int:
    return min(np.unique(np.round(u, 9)).size, _LARGEST)


def _frequencies(each: int, share: float, u: FloatArray) -> int:
    size = np.abs(np.fft.rfft(u))
    return min(each * int(np.sum(size > share * np.max(size))), _LARGEST)


def _going_round(u: FloatArray) -> int:
    """The order of columns that wrap around."""
    ranks = (np.linalg.matrix_rank(wrapped([(u, i) for i in range(n)])) for n in range(1, _LARGEST + 1))
    return next((n for n, rank in enumerate(ranks) if rank <= n), _LARGEST)


_WRONG_ORDERS: tuple[tuple[str, str, Callable[[FloatArray], int]], ...] = (
    (
        "order one too high",
        "is one too high: the order is the *last* n with full column rank, not the first without.",
        _next_order,
    ),
    (
        "order one too high",
        "is one too high: the order is the *last* n with full column rank, not the first without.",
        lambda u: _order_of(u) + 1,
    ),
    (
        "order one too low",
        "is one too low: a matrix with n columns of full rank means order n.",
        lambda u: max(_order_of(u) - 1, 0),
    ),
    (
        "mean taken off",
        "takes the mean off the input. A constant is an input, too, and counts 1.",
        lambda u: _order_of(u - u.mean()),
    ),
    (
        "rank of the signal",
        "is 1 for every input that is not zero, as the rank of a flat array is: make a matrix of its delayed samples.",
        lambda u: int(np.linalg.matrix_rank(u)),
    ),
    (
        WRAPS,
        "takes the input as if it went round, as `np.roll` does, and the Fourier transform if its frequencies "
        "are counted: where the end meets the beginning there is then a jump, which has every order. Use only the "
        "rows for which all samples were recorded, "
        "and count independent *columns*.",
        _going_round,
    ),
    *(
        (
            "frequencies counted",
            "counts the frequencies in the Fourier transform. A sinusoid whose periods do not fit into the record "
            "spreads over all of them, and a constant counts 1: count independent *columns*.",
            partial(_frequencies, each, share),
        )
        for each in (1, 2)
        for share in (1e-3, 1e-6, 1e-9)
    ),
    ("values counted", "counts the different values of the input; count independent *columns*.", _distinct),
)


def check_cancel(ask: Ask) -> Verdict:
    """`cancel(P, Q, within)`: nothing, one root, a pair of complex roots, one of a double root of either."""
    verdict = Verdict(False, "")
    rng = ask.rng
    s, t = rng.uniform(0.3, 0.5), rng.uniform(0.6, 0.8)
    pair = [t * np.exp(0.9j), t * np.exp(-0.9j)]
    near, apart = rng.uniform(0.002, 0.004, 2) * rng.choice([-1.0, 1.0], 2)
    # left of P, left of Q, in common, the distance between the roots in common, and `within`
    trials: tuple[tuple[list[complex], list[complex], list[complex], float, float], ...] = (
        ([0.9], [-s], [s], near, 0.01),
        ([0.9, s], [-t, s + 2 * apart], [], 0.0, 0.003),
        ([0.9, -0.7], [], [s], near / 3, 0.003),
        ([0.85], [-s, 0.1], pair, near, 0.01),
        ([s, -t], [-0.1], [s], near, 0.01),
        ([-t], [s + near, -0.1], [s], near, 0.01),
        ([0.9, -s], [t - 0.3, -0.9], [], 0.0, 0.01),
        ([0.9], [-s], [s], 6 * near, 0.05),
        ([*pair, 0.9], [t * np.cos(0.9), -s], [], 0.0, 0.02),
        ([*pair, -0.8], [t * np.cos(0.9) + near], [0.1], near, 0.02),
    )
    for of_P, of_Q, common, off, within in trials:
        P, Q = _poly([*of_P, *common]), _poly([*of_Q, *(root + off for root in common)])
        verdict = _judge_cancel(ask, P, Q, of_P, of_Q, within)
        if not verdict.passed:
            break
    return verdict


def _poly(roots: ArrayLike) -> FloatArray:
    return np.atleast_1d(np.asarray(np.poly(np.asarray(roots, complex)).real, float))


def _judge_cancel(
    ask: Ask, P: FloatArray, Q: FloatArray, of_P: list[complex], of_Q: list[complex], within: float
) -> Verdict:
    parts = returned_parts(ask, "cancel", "two polynomials", 2, P, Q, within)
    arrays = [_real(part) for part in parts]
    right = [_poly(of_P), _poly(of_Q)]
    sizes = [array.size for array in arrays]
    if all(SAME(array, wanted) for array, wanted in zip(arrays, right, strict=True)):
        return Verdict(True, "what both have in common is gone, one for one.")

    def are(*wanted: FloatArray) -> bool:
        return all(SAME(array, other) for array, other in zip(arrays, wanted, strict=True))

    roots_P, roots_Q = np.roots(P), np.roots(Q)
    monic = all(array.size and SAME(array[0], 1.0) for array in arrays)
    near = np.abs(roots_P[:, np.newaxis] - roots_Q) < within
    greedy = _poly(roots_P[~near.any(axis=1)]), _poly(roots_Q[~near.any(axis=0)])
    real = np.abs(roots_P.real[:, np.newaxis] - roots_Q.real) < within
    by_real_part = _poly(roots_P[~real.any(axis=1)]), _poly(roots_Q[~real.any(axis=0)])
    both_ways = ((roots_P, roots_Q), (roots_P[::-1], roots_Q[::-1]))
    one_by_one = _cancelled(roots_P, roots_Q, lambda p, q: abs(p.real - q.real) < within)
    fixed = [_cancelled(roots_P, roots_Q, partial(_nearer_than, limit)) for limit in _OTHER_LIMITS]
    rounded = [(digits, made) for digits in range(1, 5) for made in _of_rounded(roots_P, roots_Q, digits)]
    for slip, hint, matches in (
        ("P and Q swapped", "returns what is left of Q first.", are(right[1], right[0])),
        (
            "one polynomial twice",
            "returns what is left of Q twice: the first is what is left of P.",
            are(right[1], right[1]),
        ),
        (
            "one polynomial twice",
            "returns what is left of P twice: the second is what is left of Q.",
            are(right[0], right[0]),
        ),
        (
            "all of a multiple root cancelled",
            "cancels both of a double root against a single one: a pair is one root of either.",
            are(*greedy),
        ),
        (
            "nothing cancelled",
            f"leaves roots in place that lie nearer than `within`.{_why_nothing(ask, P, Q) if are(P, Q) else ''}",
            are(P, Q),
        ),
        (
            "the common factor returned",
            "returns what they have in common; asked for is what is left.",
            are(_poly(roots_P[near.any(axis=1)]), _poly(roots_Q[near.any(axis=0)])),
        ),
        (
            "real parts compared",
            "compares only the real parts of roots: the distance of complex roots is `abs(p - q)`.",
            are(*by_real_part) or are(*one_by_one),
        ),
        (
            "within not used",
            "does not use `within`: it cancels roots with another limit.",
            any(are(*pair) for pair in fixed),
        ),
        *(
            (
                "rounded roots compared",
                f"rounds the roots to {digits} digits and cancels those that are then equal; `within` is not used, and "
                "what is left is rounded, too: compare `abs(p - q) < within`.",
                are(*pair),
            )
            for digits, pair in rounded
        ),
        ("only one of them divided", "takes the common roots out of one polynomial only.", are(right[0], Q)),
        ("only one of them divided", "takes the common roots out of one polynomial only.", are(P, right[1])),
        (
            "one root of a pair left",
            f"cancels one of two roots: {_half(ask)}",
            P.size - 1 == sizes[0] == right[0].size + 1 and Q.size - 1 == sizes[1] == right[1].size + 1,
        ),
        (
            "list turned round",
            "takes the roots of the list turned round, which are 1/z: pass it to `np.roots` as it is.",
            are(*_cancelled(np.roots(P[::-1]), np.roots(Q[::-1]), partial(_nearer_than, within))),
        ),
        (
            "highest delay first",
            "returns its polynomials backwards: they begin with 1, the lowest delay.",
            are(right[0][::-1], right[1][::-1]),
        ),
        (
            "roots for polynomials",
            "returns roots; make polynomials of them with `np.poly`.",
            sizes == [len(of_P), len(of_Q)] and not monic,
        ),
        (
            "distance not used",
            "cancels roots that lie farther apart than `within`.",
            monic and sizes[0] < right[0].size and sizes[1] < right[1].size,
        ),
        (
            "distance with its sign",
            "compares p - q with its sign: a distance is `abs(p - q)`.",
            any(
                are(*_cancelled(roots_1, roots_2, lambda p, q: (p - q).real < within)) for roots_1, roots_2 in both_ways
            )
            or any(
                are(*_cancelled(roots_1, roots_2, lambda p, q: (q - p).real < within)) for roots_1, roots_2 in both_ways
            ),
        ),
    ):
        if matches:
            return Verdict(False, f"`cancel` {hint}", slip)
    return Verdict(False, "`cancel` does not leave the right polynomials: try the example above it.")


def _half(ask: Ask) -> str:
    """Why one root of a pair is left, as far as the code tells."""
    code, left = code_of(ask, "cancel"), "of two complex roots that belong together, one is left."
    skips = "A loop over a list from which it removes skips the next entry: loop over a copy, `list(roots)`."
    if code is None:
        return f"{left} ({skips} And a `return` in the loop ends it.)"
    if code.shrinks_its_loop:
        return f"{left} {skips}"
    if code.returns_in_loop:
        return f"{left} A `return` stands in a loop, and ends it with the first pair: put it behind the loop."
    return left


def _why_nothing(ask: Ask, P: FloatArray, Q: FloatArray) -> str:
    """Why no root is cancelled: whether it is the distance of other roots, or none at all, that is compared."""

    def cancels(within: float) -> bool:
        parts = returned_parts(ask, "cancel", "two polynomials", 2, P, Q, within)
        return not all(SAME(_real(part), whole) for part, whole in zip(parts, (P, Q), strict=True))

    roots_P, roots_Q = np.roots(P), np.roots(Q)
    distances = np.abs(roots_P[:, np.newaxis] - roots_Q)
    i, j = np.unravel_index(np.argmin(distances), distances.shape)
    inverse = float(abs(1 / roots_P[i] - 1 / roots_Q[j]))
    try:
        if not cancels(_FAR):
            return " (Equal to the last digit they never are.)"
        if not cancels(0.95 * inverse) and cancels(1.05 * inverse):
            return (
                f" These are {distances[i, j]:.2g} apart, and it cancels them from {inverse:.2g} on, the distance of "
                "1/z: the roots are those of the list turned round. Pass it to `np.roots` as it is."
            )
    except NoAnswer:
        return ""
    return f" Print the two roots that are {distances[i, j]:.2g} apart, and what is compared with `within`."


_FAR = 100.0
"""Farther than any two roots of a trial lie apart."""
_OTHER_LIMITS = (0.01, 1e-3, 0.1, 0.05, 1e-6)
"""Distances that a student may write into `cancel` instead of `within`."""


def _nearer_than(limit: float, p: complex, q: complex) -> bool:
    return abs(p - q) < limit


def _cancelled(
    roots_P: ArrayLike, roots_Q: ArrayLike, equal: Callable[[complex, complex], bool]
) -> tuple[FloatArray, FloatArray]:
    """The polynomials that remain when each root of P cancels at most one root of Q that is equal to it."""
    left_P: list[complex] = []
    left_Q = np.asarray(roots_Q, complex).tolist()
    for p in np.asarray(roots_P, complex).tolist():
        partner = next((i for i, q in enumerate(left_Q) if equal(p, q)), None)
        if partner is None:
            left_P.append(p)
        else:
            left_Q.pop(partner)
    return _poly(left_P), _poly(left_Q)


def _of_rounded(roots_P: ArrayLike, roots_Q: ArrayLike, digits: int) -> Iterator[tuple[FloatArray, FloatArray]]:
    """What is left of rounded roots, one for one and, as sets have it, all that are equal."""
    p, q = (np.round(np.asarray(roots, complex), digits) for roots in (roots_P, roots_Q))
    yield _cancelled(p, q, lambda one, other: one == other)
    yield _poly(np.setdiff1d(p, q)), _poly(np.setdiff1d(q, p))


def _real(value: Value) -> FloatArray:
    """A polynomial, from which no root is left as a number, or with imaginary parts of rounding."""
    array = np.asarray(value) if isinstance(value, (int, float, complex, np.ndarray)) else None
    if array is not None and array.dtype.kind == "c":
        if np.any(np.abs(array.imag) > 1e-6):
            raise NoAnswer(
                "`cancel` returns coefficients with large imaginary parts: of two complex roots that belong together, "
                "one is left.",
                "one root of a pair left",
            )
        array = array.real
    if array is None:
        raise NoAnswer("`cancel` should return two polynomials: arrays of their coefficients.")
    return np.atleast_1d(as_array("what cancel(P, Q, within) returns", array).squeeze())


@first_failure
def check_autocorrelation(ask: Ask) -> Iterator[Verdict]:
    """`autocorrelation(e, lags)`, of a sequence whose mean is not zero."""
    for N, lags in ((30, 6), (50, 10)):
        yield _judge_autocorrelation(ask, ask.rng.uniform(0.5, 1, 1) + ask.rng.standard_normal(N), lags)


def _judge_autocorrelation(ask: Ask, e: FloatArray, lags: int) -> Verdict:
    N, k = e.size, np.arange(lags + 1)
    value = returned(ask, "autocorrelation", e, lags)
    size = as_array("autocorrelation(e, lags)", value).size
    if size == lags:
        return Verdict(
            False, "`autocorrelation` returns one value too few: r(0) to r(lags) are lags + 1.", "one lag too few"
        )
    if size in (2 * lags + 1, 2 * N - 1, N):
        return Verdict(
            False, "`autocorrelation` returns other lags than 0 to `lags`: cut them out.", "lags not cut out"
        )
    right = reference_autocorrelation(e, lags).values
    centred = e - e.mean()
    return judge(
        as_vector("autocorrelation(e, lags)", value, lags + 1),
        right,
        _EXACT,
        "the mean is off, and r(0) is one.",
        "`autocorrelation` is not right: work the example with four numbers by hand.",
        [
            Slip(
                "mean left in",
                "`autocorrelation` leaves the mean in, so that every lag seems correlated.",
                lambda: np.array([e[i:] @ e[: N - i] for i in k]) / (e @ e),
            ),
            Slip(
                "mean of each lag",
                "`autocorrelation` takes the mean of the N - k products of each lag, and leaves the mean of e in: the "
                "sums of all lags are divided by the same number, that of lag 0, and e has its mean taken off.",
                lambda: np.array([np.mean(e[i:] * e[: N - i]) for i in k]) / np.mean(e**2),
            ),
            Slip(
                "not divided by the sum of squares",
                "`autocorrelation` returns covariances: divide by the sum of squares, so that r(0) = 1.",
                lambda: right * (centred @ centred),
            ),
            Slip(
                "not divided by the sum of squares",
                "`autocorrelation` returns covariances: divide by the sum of squares, so that r(0) = 1.",
                lambda: right * np.mean(centred**2),
            ),
            *(
                Slip(
                    "divided twice",
                    "`autocorrelation` divides once too often. Divided by the sum of squares alone, r(0) is 1.",
                    partial(np.divide, right, once_more),
                )
                for once_more in (N, np.var(e), centred @ centred)
            ),
            Slip(
                "divided by the standard deviation",
                "`autocorrelation` divides by the standard deviation: r(0) = 1 with the variance, its square.",
                lambda: right * np.std(e),
            ),
            *(
                Slip(
                    "begins with lag 1",
                    "`autocorrelation` begins with lag 1: lag 0 is at index N - 1 of `np.correlate(e, e, 'full')`, "
                    "counted from 0.",
                    partial(np.copy, made),
                )
                for kept in (centred, e)
                for later in [_from_lag_1(kept, lags)]
                for made in (later / (kept @ kept), later / later[0])
            ),
            *(
                Slip(
                    "first lags of correlate",
                    "`autocorrelation` takes the first values of `np.correlate(e, e, 'full')`: lag 0 is in its middle"
                    f"{beside}.",
                    partial(_first_of_correlate, kept, lags, by_first),
                )
                for kept, of_mean in ((centred, ""), (e, "; and the mean is left in"))
                for by_first, beside in ((False, of_mean), (True, f"{of_mean}; and they are divided by the first"))
            ),
            Slip(
                "index wraps around",
                "`autocorrelation` lets the record go round: `np.roll` brings its end to its beginning.",
                lambda: np.array([centred @ np.roll(centred, i) for i in k]) / (centred @ centred),
            ),
            Slip(
                "divided by the number of products",
                "`autocorrelation` takes means of N - k products. The formula has the same denominator for all k.",
                lambda: right * N / (N - k),
            ),
            *(
                Slip(
                    "fewer products than there are",
                    "`autocorrelation` sums the same N - lags products for each lag. The sum for lag k has all N - k.",
                    partial(_of_fewer_products, centred, lags, at_end, whole),
                )
                for at_end in (False, True)
                for whole in (False, True)
            ),
            Slip(
                "one product left out",
                "`autocorrelation` leaves out the last product of each sum: there are N - k of them, and "
                "`range(N - k)` counts from 0 to N - k - 1.",
                lambda: np.array([centred[i : N - 1] @ centred[: N - 1 - i] for i in k]) / (centred @ centred),
            ),
            Slip(
                "each part divided by its own squares",
                "`autocorrelation` divides each sum by the squares of its own N - k samples. The formula has the same "
                "denominator for all k.",
                lambda: np.array(
                    [a @ b / np.sqrt((a @ a) * (b @ b)) for a, b in ((centred[i:], centred[: N - i]) for i in k)]
                ),
            ),
            *(
                Slip(
                    "N and N - 1 mixed",
                    "`autocorrelation` divides once by N - 1 and once by N, so r(0) is not 1. (`np.var` divides by N, "
                    "and with `ddof=1` by N - 1.)",
                    partial(np.multiply, right, factor),
                )
                for factor in (N / (N - 1), (N - 1) / N)
            ),
            Slip(
                "a mean for each part",
                "`autocorrelation` takes each part's own mean and spread, as `np.corrcoef` does. There is one mean.",
                lambda: np.array([1.0, *(np.corrcoef(e[i:], e[: N - i])[0, 1] for i in k[1:])]),
            ),
        ],
    )


def _from_lag_1(e: FloatArray, lags: int) -> FloatArray:
    return np.asarray(np.correlate(e, e, "full")[e.size : e.size + lags + 1], float)


def _first_of_correlate(e: FloatArray, lags: int, by_first: bool) -> FloatArray:
    values = np.correlate(e, e, "full")[: lags + 1]
    return np.asarray(values / (values[0] if by_first else e @ e), float)


def _of_fewer_products(e: FloatArray, lags: int, at_end: bool, whole: bool) -> FloatArray:
    """Sums of N - lags products for every lag, of the first or the last samples, over their squares or all."""
    n = e.size - lags
    sums = [e[lags:] @ e[lags - k : e.size - k] if at_end else e[k : n + k] @ e[:n] for k in range(lags + 1)]
    kept = e[lags:] if at_end else e[:n]
    return np.array(sums) / (e @ e if whole else kept @ kept)
