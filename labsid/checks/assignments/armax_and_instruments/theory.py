"""Checks of what is computed on paper: the limit of least squares, covariance in coloured noise, likelihood."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.compare import SAME, as_array, as_matrix, as_number, as_theta, close
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask, returned
from labsid.checks.trials import first_order, trial_equations
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.estimation.likelihood import log_likelihood
from labsid.least_squares.intervals import parameter_covariance
from labsid.least_squares.linear_algebra import pseudo_inverse
from labsid.model_structures.prediction import free_run


@first_failure
def check_limit(ask: Ask) -> Iterator[Verdict]:
    """`limit_of_least_squares(a, b, c, var_u, var_e)`."""
    for sign_a, sign_c in ((-1, -1), (-1, 1), (1, -1)):
        a, c = sign_a * ask.rng.uniform(0.3, 0.85), sign_c * ask.rng.uniform(0.3, 0.9)
        b, var_u, var_e = ask.rng.uniform(0.5, 3, 3)
        yield _judge_limit(ask, float(a), float(b), float(c), float(var_u), float(var_e))


def _edits_of_limit(
    a: float, b: float, c: float, var_u: float, var_e: float, signal: float, noise: float
) -> tuple[Edit, ...]:
    """Single mistakes in what y(t-1) and v(t) share, in the variance of y, and in what is returned."""
    short, var_y = 1 - a**2, signal + noise
    return (
        Edit("shared", c, "var_e is left out of the correlation of y(t-1) with v(t)"),
        Edit("shared", 2 * c * var_e, "the correlation of y(t-1) with v(t) is doubled: they share only e(t-1)"),
        Edit("shared", c * var_u, "the correlation of y(t-1) with v(t) has var_u, and needs var_e"),
        Edit("sign", 1.0, "a is pulled the wrong way: the regressor holds -y(t-1)"),
        Edit("variance", var_y * short, "the variance of y is not divided by 1 - a^2"),
        Edit("variance", a**2 + var_y * short, "a^2 is added to the variance of y, and multiplies var_y itself"),
        Edit("variance", signal + (1 + c**2) * var_e / short, "the variance of y lacks -2ac"),
        Edit("variance", signal + (1 + c**2 + 2 * a * c) * var_e / short, "the variance of y has +2ac for -2ac"),
        Edit("variance", var_y * short / (1 + a**2), "the variance of y is divided by 1 + a^2"),
        Edit("variance", var_y * short / (1 - a), "the variance of y has a without its square"),
        Edit("variance", signal / b + noise, "the variance of y has b without its square"),
        Edit("variance", signal + (1 + c - 2 * a * c) * var_e / short, "the variance of y has c without its square"),
        Edit("variance", var_y**0.5, "the standard deviation of y stands for its variance"),
        Edit("variance", signal, "the variance of y lacks that of the noise"),
        Edit("variance", noise, "the variance of y lacks that of the input"),
        Edit("variance", var_u, "var_u stands for the variance of y"),
        Edit("kept", 0.0, "the bias alone is returned"),
        Edit("order", -1, "b is returned before a"),
    )


def _judge_limit(ask: Ask, a: float, b: float, c: float, var_u: float, var_e: float) -> Verdict:
    impulse = np.zeros(600)
    impulse[0] = 1.0
    model = first_order(a, b, c)
    from_u, from_e = free_run(model, impulse), free_run(model, 0 * impulse, impulse)
    signal, noise = var_u * float(from_u @ from_u), var_e * float(from_e @ from_e)
    var_y, short = signal + noise, 1 - a**2
    without_square = signal + (1 + c - 2 * a * c) * var_e / short

    def pulled(share: float) -> FloatArray:
        return np.array([a - share, b])

    def made(
        shared: float = c * var_e, variance: float = var_y, sign: float = -1.0, kept: float = 1.0, order: int = 1
    ) -> FloatArray:
        return np.array([kept * a + sign * shared / variance, kept * b])[::order]

    cross = "`limit_of_least_squares` has a wrong variance of y: y(t-1) and e(t-1) are correlated, which leaves -2ac."
    got = as_theta("limit_of_least_squares(...)", returned(ask, "limit_of_least_squares", a, b, c, var_u, var_e), 2)
    code = code_of(ask, "limit_of_least_squares")
    if code is not None and code.random_call and not SAME(got, pulled(c * var_e / var_y)):
        return Verdict(
            False,
            f"`limit_of_least_squares` draws random numbers, with `{code.random_call}`: it returns the estimate from "
            "one record, which scatters about the limit. The limit follows from the variances alone, as in the "
            "step.",
            "estimate for the limit",
        )
    return judge(
        got,
        pulled(c * var_e / var_y),
        SAME,
        "coloured noise pulls a, and leaves b.",
        "`limit_of_least_squares` returns another limit of a. Print the variance of y that it computes for System 2 "
        "(a = -0.8, b = 1, c = -0.8, var_u = 4/3, var_e = 1), where it is 4.704; then what is subtracted from a, c "
        "var_e over it.",
        [
            Slip(
                "sign of the pull",
                "`limit_of_least_squares` pulls a the wrong way: the regressor holds -y(t-1).",
                lambda: pulled(-c * var_e / var_y),
            ),
            Slip(
                "no bias",
                "`limit_of_least_squares` returns the true values: coloured noise is correlated with y(t-1).",
                lambda: pulled(0.0),
            ),
            Slip(
                "bias alone",
                "`limit_of_least_squares` returns the bias alone, the distance of the limit from [a, b].",
                lambda: np.array([-c * var_e / var_y, 0.0]),
                mend="Add it to [a, b].",
            ),
            Slip(
                "c doubled",
                "`limit_of_least_squares` pulls a twice as far as it should: y(t-1) and v(t) share only e(t-1).",
                lambda: pulled(2 * c * var_e / var_y),
            ),
            Slip("cross term", cross, lambda: pulled(c * var_e / (signal + (1 + c**2) * var_e / short))),
            Slip("cross term", cross, lambda: pulled(c * var_e / (signal + (1 + c**2 + 2 * a * c) * var_e / short))),
            Slip(
                "var_e forgotten",
                "`limit_of_least_squares` leaves the variance of e out of the correlation of y(t-1) with v(t).",
                lambda: pulled(c / var_y),
            ),
            Slip(
                "var_u for var_e",
                "`limit_of_least_squares` has var_u where the correlation of y(t-1) with v(t) needs var_e: both hold "
                "the noise e(t-1).",
                lambda: pulled(c * var_u / var_y),
            ),
            Slip(
                "var_u for var_e",
                "`limit_of_least_squares` has var_u and var_e exchanged in the variance of y: b^2 goes with var_u.",
                lambda: pulled(c * var_e / (signal * var_e / var_u + noise * var_u / var_e)),
            ),
            Slip(
                "variance of another signal",
                "`limit_of_least_squares` divides by var_u: the regressor is -y(t-1), so it is the variance of y.",
                lambda: pulled(c * var_e / var_u),
            ),
            Slip(
                "1 - a^2 forgotten",
                "`limit_of_least_squares` has a wrong variance of y: it contains a^2 times itself.",
                lambda: pulled(c * var_e / (var_y * short)),
                mend="Divide by 1 - a^2.",
            ),
            *(
                Slip(
                    "a square forgotten",
                    f"`limit_of_least_squares` has a wrong variance of y: {where} stands without its square.",
                    partial(pulled, c * var_e / wrong),
                )
                for where, wrong in (("a", var_y * short / (1 - a)), ("b", signal / b + noise), ("c", without_square))
            ),
            Slip(
                "1 - a^2 forgotten",
                "`limit_of_least_squares` adds a^2 to the variance of y. In var_y = a^2 var_y + ..., a^2 multiplies "
                "var_y itself: solve for it.",
                lambda: pulled(c * var_e / (a**2 + var_y * short)),
                mend="The rest is divided by 1 - a^2.",
            ),
            Slip(
                "1 + a^2",
                "`limit_of_least_squares` divides by 1 + a^2: solve the equation for the variance of y once more.",
                lambda: pulled(c * var_e / (var_y * short / (1 + a**2))),
            ),
            Slip(
                "variance of System 2",
                "`limit_of_least_squares` divides by 4.704, the variance of y of System 2: compute it from its "
                "arguments.",
                lambda: pulled(c * var_e / 4.704),
            ),
            Slip(
                "zero for b",
                "`limit_of_least_squares` returns 0 for b: it is the *bias* of b that is zero.",
                lambda: pulled(c * var_e / var_y) * [1, 0],
            ),
            *(
                Slip(
                    "b pulled as well",
                    "`limit_of_least_squares` changes b: u(t-1) is uncorrelated with v(t) and with y(t-1), so b has no "
                    "bias.",
                    partial(np.add, pulled(c * var_e / var_y), np.array([0, sign * c * var_e / var_u])),
                )
                for sign in (1, -1)
            ),
            Slip(
                "root of the variance",
                "`limit_of_least_squares` divides by the standard deviation of y; it is the variance.",
                lambda: pulled(c * var_e / var_y**0.5),
            ),
            Slip(
                "variance without noise",
                "`limit_of_least_squares` takes the variance of the noise-free output: the regressor is the noisy one.",
                lambda: pulled(c * var_e / signal),
            ),
            Slip(
                "a and b swapped",
                "`limit_of_least_squares` returns b before a.",
                lambda: pulled(c * var_e / var_y)[::-1],
            ),
            Slip(
                "var_u for var_e",
                "`limit_of_least_squares` has var_u and var_e exchanged throughout: b^2 goes with var_u, c with var_e.",
                lambda: pulled(c * var_u / (signal * var_e / var_u + noise * var_u / var_e)),
            ),
            *pairs_of("`limit_of_least_squares`", _edits_of_limit(a, b, c, var_u, var_e, signal, noise), made),
            Slip(
                "b pulled as well",
                f"`limit_of_least_squares` is right in a, and returns {got[1]:.4g} for b = {b:.4g}: u(t-1) is "
                "uncorrelated with v(t) and with y(t-1), so b has no bias.",
                lambda: np.array([a - c * var_e / var_y, got[1]]),
            ),
        ],
    )


@first_failure
def check_covariance(ask: Ask) -> Iterator[Verdict]:
    """`covariance(Phi, c, var_e)`."""
    for n, p, sign in ((7, 2, 1), (9, 3, -1), (6, 1, 1)):
        Phi = trial_equations(ask.rng, n, p)[0]
        yield _judge_covariance(ask, Phi, float(sign * ask.rng.uniform(0.4, 0.9)), float(ask.rng.uniform(1.5, 3)))


def _judge_covariance(ask: Ask, Phi: FloatArray, c: float, var_e: float) -> Verdict:
    n, p = Phi.shape
    value = returned(ask, "covariance", Phi, c, var_e)
    call = "covariance(Phi, c, var_e)"
    if p > 1 and as_array(call, value).shape == (p,):
        return Verdict(False, f"`{call}` returns {p} numbers; the covariance is a {p} by {p} matrix.", "variances only")
    if p > 1 and as_array(call, value).shape == (n, n):
        table = as_array(call, value)
        if abs(np.trace(table) - n * var_e * (1 + c**2)) < var_e and SAME(table, np.triu(np.tril(table, 1), -1)):
            return Verdict(
                False,
                f"`{call}` returns the covariance of the noise, n by n: asked for is that of theta, p by p.",
                "covariance of the noise",
            )
        return Verdict(
            False,
            f"`{call}` returns a matrix of n by n, {n} by {n}: that of theta is p by p, {p} by {p}. Print the shape of "
            "each product.",
        )
    inverse = pseudo_inverse(Phi)
    diagonal, beside = np.eye(n), np.eye(n, k=1) + np.eye(n, k=-1)

    def sandwich(R: FloatArray) -> FloatArray:
        return var_e * inverse @ R @ inverse.T

    of_noise = var_e * ((1 + c**2) * diagonal + c * beside)
    start = diagonal * (1 + c**2)
    start[0, 0] = 1.0
    white = parameter_covariance(Phi, var_e)
    neighbours = "here neighbouring noise is correlated, and Phi does not drop out of the middle."
    as_if_white = f"`covariance` is the one for white noise, var_e (Phi'Phi)^-1: {neighbours}"
    of_v = f"`covariance` is (1 + c^2) var_e (Phi'Phi)^-1, as if v(t), with its variance, were white: {neighbours}"
    got = as_array(call, value).reshape(1, 1) if p == 1 and as_array(call, value).size == 1 else None
    return judge(
        as_matrix(call, value, (p, p)) if got is None else got,
        sandwich((1 + c**2) * diagonal + c * beside),
        SAME,
        "the middle stays when the noise is coloured.",
        "`covariance` is not that of the estimate: write E(vv') down for three samples, and try the mean of step 4.",
        [
            *(
                Slip(
                    "correlated at all lags",
                    "`covariance` takes v to be correlated at all lags, by powers of c. v(t) = e(t) + c e(t-1) shares "
                    "an e with v(t-1) and v(t+1) alone: E v(t)v(t-2) is zero.",
                    partial(sandwich, size * base ** np.abs(np.subtract.outer(np.arange(n), np.arange(n)))),
                )
                for base in (c, -c)
                for size in (1.0, 1 + c**2, 1 / (1 - c**2))
            ),
            *(
                Slip(
                    "divided by a number of rows",
                    f"`covariance` is divided by {count}, {what}: the sums in Phi'Phi count the rows already.",
                    partial(np.divide, sandwich((1 + c**2) * diagonal + c * beside), count),
                )
                for count, what in ((n, "the number of rows"), (n - 1, "the number of rows less 1"))
            ),
            Slip(
                "weighted estimate",
                "`covariance` is that of a *weighted* estimate. Least squares without weights has R in the middle.",
                lambda: np.asarray(np.linalg.inv(Phi.T @ np.linalg.inv(of_noise) @ Phi), float),
            ),
            Slip(
                "c everywhere",
                "`covariance` has c var_e between all samples: only neighbours have an e in common.",
                lambda: sandwich((1 + c**2 - c) * diagonal + c * np.ones((n, n))),
            ),
            Slip(
                "one inverse",
                "`covariance` has the inverse of Phi'Phi on one side only: it stands on both.",
                lambda: inverse @ of_noise @ Phi,
            ),
            Slip("as if white", as_if_white, lambda: white),
            Slip("as if white", of_v, lambda: (1 + c**2) * white),
            Slip(
                "diagonal of white noise",
                "`covariance` has var_e on the diagonal of E(vv'), the variance of e(t) alone.",
                lambda: sandwich(diagonal + c * beside),
                mend="v(t) is a sum of two, with variance (1 + c^2) var_e.",
            ),
            Slip(
                "diagonal without a square",
                "`covariance` has (1 + c) var_e on the diagonal of E(vv'): v(t) is e(t) + c e(t-1), and variances take "
                "the squares.",
                lambda: sandwich((1 + c) * diagonal + c * beside),
            ),
            Slip(
                "2c beside the diagonal",
                "`covariance` has 2 c var_e beside the diagonal of E(vv'): v(t) and v(t-1) share e(t-1) alone.",
                lambda: sandwich((1 + c**2) * diagonal + 2 * c * beside),
            ),
            Slip(
                "c on one side only",
                "`covariance` has c above or below the diagonal only: E(vv') is symmetric.",
                lambda: sandwich((1 + c**2) * diagonal + c * np.eye(n, k=1)),
            ),
            Slip(
                "c on one side only",
                "`covariance` has c above or below the diagonal only: E(vv') is symmetric.",
                lambda: sandwich((1 + c**2) * diagonal + c * np.eye(n, k=-1)),
            ),
            Slip(
                "c squared beside the diagonal",
                "`covariance` has c^2 var_e beside the diagonal of E(vv').",
                lambda: sandwich((1 + c**2) * diagonal + c**2 * beside),
                mend="v(t) and v(t-1) share e(t-1), once with c and once with 1.",
            ),
            Slip(
                "first sample without a past",
                "`covariance` gives the first noise sample a smaller variance: it has e(-1) in it like every other.",
                lambda: sandwich(start + c * beside),
            ),
            Slip(
                "var_e forgotten",
                "`covariance` does not use var_e.",
                lambda: sandwich((1 + c**2) * diagonal + c * beside) / var_e,
            ),
            Slip(
                "var_e squared",
                "`covariance` squares var_e, which is a variance already.",
                lambda: sandwich((1 + c**2) * diagonal + c * beside) * var_e,
            ),
        ],
    )


@first_failure
def check_likelihood(ask: Ask) -> Iterator[Verdict]:
    """`log_likelihood(theta, var_e, Phi, Y)`."""
    for n, p in ((6, 2), (11, 3)):
        Phi, Y = trial_equations(ask.rng, n, p)
        yield _judge_likelihood(ask, ask.rng.uniform(-1, 1, p), float(ask.rng.uniform(1.6, 4)), Phi, Y)
    Phi, Y = trial_equations(ask.rng, _MANY, 2)
    yield _judge_likelihood(ask, ask.rng.uniform(-1, 1, 2), float(ask.rng.uniform(1.6, 4)), Phi, Y)


_MANY = 1200
"""Samples: the product of as many densities is smaller than any number of double precision but zero."""


def _edits_of_likelihood(n: int, p: int, var_e: float) -> tuple[Edit, ...]:
    """Single mistakes in the constant of the log likelihood and in its sum of squares."""
    return (
        Edit("count", p, "N is the number of columns of Phi, and not that of its rows"),
        Edit("count", n - p, "N - p stands for N"),
        Edit("count", 1, "the constant is counted for one sample, and not for N"),
        Edit("count", 0, "the constant is left out"),
        Edit("log", np.log10, "the logarithm is that to base 10: `np.log` is the natural one"),
        Edit("inside", 2 * np.pi, "sigma^2 is left out of the logarithm"),
        Edit("inside", var_e, "2 pi is left out of the logarithm"),
        Edit("inside", 2 * np.pi * var_e**2, "var_e is squared in the logarithm, and is a variance already"),
        Edit("inside", 2 * np.pi * var_e**0.5, "sigma stands in the logarithm for sigma^2"),
        Edit("half", 1.0, "the half before the logarithm is missing"),
        Edit("squares", 1 / n, "the squared errors are averaged, and not added up"),
        Edit("over", var_e, "the squares are divided by sigma^2, and not by twice that"),
        Edit("over", 2 * var_e**2, "the squares are divided by 2 sigma^4: var_e is sigma^2 already"),
        Edit("over", 2 * var_e**0.5, "the squares are divided by 2 sigma, and not by 2 sigma^2"),
        Edit("over", 2 / var_e, "the squares are multiplied by var_e: `/ 2 * var_e` lacks brackets"),
        Edit("sign", 1.0, "the squared errors are added, and lower the likelihood"),
    )


def _judge_likelihood(ask: Ask, theta: FloatArray, var_e: float, Phi: FloatArray, Y: FloatArray) -> Verdict:
    n, E = Y.size, Y - Phi @ theta
    right = log_likelihood(E, var_e)
    sse, constant = float(E @ E), -n / 2 * float(np.log(2 * np.pi * var_e))

    def made(
        count: float = n, log: Callable[[float], float] = np.log, inside: float = 2 * np.pi * var_e, half: float = 0.5,
        squares: float = 1.0, over: float = 2 * var_e, sign: float = -1.0,
    ) -> float:  # fmt: skip
        return float(-half * count * log(inside) + sign * squares * sse / over)

    value = returned(ask, "log_likelihood", theta, var_e, Phi, Y)
    if n == _MANY and isinstance(value, float) and not np.isfinite(value):
        return Verdict(
            False,
            f"`log_likelihood` is right for few samples, and for {n} it returns {value:g}: the product of so many "
            "densities is 0 in the computer. Add up the logarithms of the densities; the logarithm comes first.",
            "product of densities underflows",
        )
    if as_array("log_likelihood(...)", value).size == n:
        return Verdict(False, "`log_likelihood` returns one number a sample: add them up.", "not added up")
    return judge(
        as_number("log_likelihood(...)", value),
        right,
        close(1e-9),
        "with the variance fixed, it is highest where the SSE is least.",
        "`log_likelihood` is off: take the logarithm of the density of one sample by hand, and add up.",
        [
            *(
                Slip(
                    "own variance for var_e",
                    f"`log_likelihood` does not use var_e: it takes the SSE over {divisor} in its place. The variance "
                    "is handed over, and fixed.",
                    partial(log_likelihood, E, sse / count),
                )
                for divisor, count in (("N", n), ("N - p", n - theta.size))
            ),
            Slip(
                "printed density",
                "`log_likelihood` has the slip of the print, sqrt(2 pi sigma): sigma stands outside the root.",
                lambda: -n / 2 * float(np.log(2 * np.pi * np.sqrt(var_e))) - sse / (2 * var_e),
            ),
            Slip("sign", "`log_likelihood` has the other sign: it is to be maximised.", lambda: -right),
            Slip(
                "sign of the errors",
                "`log_likelihood` grows with the errors: e^2/(2 sigma^2) has a minus in the density.",
                lambda: constant + sse / (2 * var_e),
            ),
            Slip(
                "likelihood without its logarithm",
                "`log_likelihood` returns the likelihood: take the logarithm (before multiplying, or it underflows).",
                lambda: float(np.exp(right)),
            ),
            Slip(
                "var_e squared",
                "`log_likelihood` squares var_e, which is a variance already.",
                lambda: log_likelihood(E, var_e**2),
            ),
            Slip(
                "logarithm to base 10",
                "`log_likelihood` takes the logarithm to base 10: `np.log` is the natural one.",
                lambda: constant / float(np.log(10)) - sse / (2 * var_e),
            ),
            Slip(
                "logarithm to base 10",
                "`log_likelihood` takes the logarithm to base 10: `np.log` is the natural one.",
                lambda: right / float(np.log(10)),
            ),
            Slip(
                "N - p for N",
                "`log_likelihood` has N - p where every one of the N samples brings its density.",
                lambda: constant * (n - theta.size) / n - sse / (2 * var_e),
            ),
            Slip(
                "var_e squared",
                "`log_likelihood` divides the SSE by 2 sigma^4: var_e is sigma^2 already.",
                lambda: constant - sse / (2 * var_e**2),
            ),
            Slip(
                "var_e squared",
                "`log_likelihood` has sigma^4 in the logarithm: var_e is sigma^2 already.",
                lambda: -n / 2 * float(np.log(2 * np.pi * var_e**2)) - sse / (2 * var_e),
            ),
            Slip(
                "sigma for sigma^2",
                "`log_likelihood` takes the root of var_e, sigma, where sigma^2 belongs.",
                lambda: log_likelihood(E, float(np.sqrt(var_e))),
            ),
            Slip(
                "sigma for sigma^2",
                "`log_likelihood` divides the SSE by 2 sigma.",
                lambda: constant - sse / (2 * float(np.sqrt(var_e))),
                mend="It is 2 sigma^2, and var_e is sigma^2.",
            ),
            Slip(
                "half forgotten",
                "`log_likelihood` has N log(2 pi sigma^2) without the half: the root in the density makes it.",
                lambda: 2 * constant - sse / (2 * var_e),
            ),
            Slip(
                "half forgotten",
                "`log_likelihood` divides the SSE by sigma^2; it is twice that.",
                lambda: constant - sse / var_e,
            ),
            Slip(
                "constant left out",
                "`log_likelihood` leaves out N/2 log(2 pi sigma^2). Without it the best variance would be infinite.",
                lambda: -sse / (2 * var_e),
            ),
            Slip(
                "sigma left out of the logarithm",
                "`log_likelihood` has log(2 pi) alone: sigma^2 is under that root, too.",
                lambda: -n / 2 * float(np.log(2 * np.pi)) - sse / (2 * var_e),
            ),
            Slip(
                "2 pi left out",
                "`log_likelihood` leaves the 2 pi out.",
                lambda: -n / 2 * float(np.log(var_e)) - sse / (2 * var_e),
            ),
            Slip(
                "mean in place of the sum",
                "`log_likelihood` divides by N: the samples' log densities are added up.",
                lambda: right / n,
            ),
            Slip(
                "mean in place of the sum",
                "`log_likelihood` has the *mean* of the squared errors over 2 sigma^2: every sample brings its own "
                "square, so it is their sum.",
                lambda: constant - sse / n / (2 * var_e),
            ),
            Slip(
                "brackets forgotten",
                "`log_likelihood` multiplies by var_e: `/ 2 * var_e` divides by 2 alone. Put 2 var_e in brackets.",
                lambda: constant - sse / 2 * var_e,
            ),
            Slip(
                "N/2 left out",
                "`log_likelihood` counts log(2 pi sigma^2) once: it stands there N/2 times, with N the number of "
                "samples, the rows of Phi.",
                lambda: 2 * constant / n - sse / (2 * var_e),
            ),
            Slip(
                "one sample's constant",
                "`log_likelihood` counts the constant once: every sample brings one.",
                lambda: constant / n - sse / (2 * var_e),
            ),
            *pairs_of("`log_likelihood`", _edits_of_likelihood(n, theta.size, var_e), made),
        ],
    )
