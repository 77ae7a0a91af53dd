"""Checks of confidence intervals, and of the Cayley-Hamilton theorem."""

from collections.abc import Iterator
from functools import partial
from itertools import product

import numpy as np
from scipy.special import ndtri, stdtr, stdtrit

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_array, as_theta, as_vector
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.trials import trial_equations
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.least_squares.intervals import confidence_intervals
from labsid.least_squares.matrix_inverse import characteristic_polynomial
from labsid.least_squares.solve import LeastSquares, solve_least_squares

_MOST_WRONG = 3
_STEP_BY_STEP = (
    "Print sigma^2, the diagonal of the inverse, the standard errors and the quantile one by one, and hold them "
    "against the example by hand."
)


@first_failure
def check_confidence(ask: Ask) -> Iterator[Verdict]:
    """`confidence(Phi, Y, level)`."""
    for n, p, level in ((8, 3, 0.9), (11, 2, 0.99)):
        Phi, Y = trial_equations(ask.rng, n, p)
        yield _judge_confidence(ask, Phi, Y, level)


def _judge_confidence(ask: Ask, Phi: FloatArray, Y: FloatArray, level: float) -> Verdict:
    n, p = Phi.shape
    fit = solve_least_squares(Phi, Y)
    parts = returned_parts(ask, "confidence", "theta, lower and upper", 3, Phi, Y, level)
    theta, lower, upper = (
        as_theta(f"{name} of confidence(Phi, Y, level)", part, p)
        for name, part in zip(("theta", "lower", "upper"), parts, strict=True)
    )
    if not SAME(theta, fit.theta):
        return Verdict(False, "theta of `confidence` is not the least-squares solution.")
    if SAME(lower, -upper) or SAME(np.abs(lower), np.abs(upper)):
        return Verdict(
            False,
            "`confidence` returns the half width: the bounds are theta minus and plus this width.",
            "half width returned",
        )
    if np.all(lower > upper):
        return Verdict(False, "`confidence` returns the upper bound before the lower one.", "bounds swapped")
    if not SAME(lower + upper, 2 * theta):
        return Verdict(False, "the bounds of `confidence` are not symmetric about theta.")
    intervals = confidence_intervals(fit, level)
    made_of = _width_made_of(upper - theta, fit, Phi, level)
    return judge(
        upper - theta,
        intervals.upper - fit.theta,
        SAME,
        "it gives the uncertainty of each parameter.",
        f"the intervals of `confidence` have the wrong width. {made_of or _STEP_BY_STEP}",
        _width_slips(fit, n, p, level),
        of=None if made_of else "`upper - theta`",
    )


def _width_made_of(width: FloatArray, fit: LeastSquares, Phi: FloatArray, level: float) -> str:
    """Which wrong parts give this half width: up to three at once, the fewest first; empty if none do."""
    n, p = Phi.shape
    inner = Phi.T @ Phi
    inverse = np.linalg.inv(inner)
    sse, both = 2 * fit.loss, (1 + level) / 2
    quantiles = (
        ("", float(stdtrit(n - p, both))),
        ("the quantile is taken at `level`", float(stdtrit(n - p, level))),
        ("the quantile is taken at 1 - level", abs(float(stdtrit(n - p, 1 - level)))),
        ("the quantile is the normal one", float(ndtri(both))),
        *((f"the quantile is {fixed:g}, whatever `level` and n - p are", fixed) for fixed in (1.96, 2.0, 3.0)),
        ("the quantile has n degrees of freedom", float(stdtrit(n, both))),
        ("the quantile has n - 1 degrees of freedom", float(stdtrit(n - 1, both))),
        ("`cdf` stands where `ppf` belongs", float(stdtr(n - p, both))),
        ("there is no quantile", 1.0),
    )
    variances = (
        ("", sse / (n - p)),
        ("the SSE is divided by n", sse / n),
        ("the SSE is divided by n - 1", sse / (n - 1)),
        ("the SSE is not divided", sse),
        ("`np.var` takes the mean off the residuals and divides by n", float(np.var(fit.residual))),
        ("`np.var` takes the mean off the residuals and divides by n - 1", float(np.var(fit.residual, ddof=1))),
        ("sigma^2 is missing", 1.0),
        ("sigma^2 stands before the root, and belongs under it", (sse / (n - p)) ** 2),
        ("sigma stands where sigma^2 belongs", float(np.sqrt(sse / (n - p)))),
    )
    diagonals = (
        ("", np.diag(inverse)),
        ("Phi'Phi is not inverted", np.diag(inner)),
        ("the diagonal of Phi'Phi is inverted by itself", 1 / np.diag(inner)),
        ("the inverse of Phi'Phi is missing, so that all parameters have one width", np.ones(p)),
    )
    powers = (("", 0.5), ("the root of the diagonal is missing", 1.0))
    shares = (
        ("", 1.0),
        ("the whole width is added to each side", 2.0),
        ("half of the half width is added", 0.5),
        ("the standard errors are divided by the root of n, as those of a mean are", float(1 / np.sqrt(n))),
    )
    made = sorted(
        product(quantiles, variances, diagonals, powers, shares), key=lambda parts: sum(bool(part[0]) for part in parts)
    )
    for parts in made:
        (_, quantile), (_, variance), (_, diagonal), (_, power), (_, share) = parts
        wrong = [str(part[0]) for part in parts if part[0]]
        if len(wrong) <= _MOST_WRONG and SAME(width, share * quantile * (variance * diagonal) ** power):
            return f"It comes out like this if {' and '.join(wrong)}."
    return ""


def _width_slips(fit: LeastSquares, n: int, p: int, level: float) -> list[Slip[FloatArray]]:
    t = float(stdtrit(n - p, (1 + level) / 2))
    spread = fit.stderr
    wrong_n = float(np.sqrt((n - p) / n))
    return [
        Slip(
            "one-sided quantile",
            "`confidence` uses the quantile at `level`. The remaining probability is split between *two* sides.",
            lambda: float(stdtrit(n - p, level)) * spread,
            mend="Use (1 + level)/2.",
        ),
        Slip(
            "normal quantile",
            "`confidence` uses the quantile of the normal distribution. sigma^2 is an estimate.",
            lambda: float(ndtri((1 + level) / 2)) * spread,
            mend="Use Student's t with n - p degrees of freedom.",
        ),
        Slip(
            "divided by n",
            "`confidence` divides the SSE by n.",
            lambda: t * wrong_n * spread,
            mend="With p fitted parameters, divide by n - p.",
        ),
        Slip(
            "level not used",
            "`confidence` always returns intervals of 95 %: use `level`.",
            lambda: float(stdtrit(n - p, 0.975)) * spread,
        ),
        Slip(
            "quantile forgotten",
            "`confidence` returns intervals of one standard error.",
            lambda: spread,
            mend="Multiply by the quantile.",
        ),
        Slip(
            "variance for standard error",
            "`confidence` multiplies the quantile by the variances.",
            lambda: t * spread**2,
            mend="Use their square roots.",
        ),
        Slip(
            "degrees of freedom",
            "the quantile of `confidence` has n degrees of freedom.",
            lambda: float(stdtrit(n, (1 + level) / 2)) * spread,
            mend="Use n - p.",
        ),
        Slip(
            "degrees of freedom",
            "the quantile of `confidence` has n - 1 degrees of freedom.",
            lambda: float(stdtrit(n - 1, (1 + level) / 2)) * spread,
            mend="Use n - p.",
        ),
        Slip(
            "sigma^2 forgotten",
            "`confidence` omits sigma^2.",
            lambda: t * spread / np.sqrt(fit.sigma2),
            mend="The covariance is sigma^2 times the inverse of Phi'Phi.",
        ),
        Slip(
            "sigma for sigma^2",
            "`confidence` multiplies the inverse of Phi'Phi by sigma.",
            lambda: t * spread / fit.sigma2**0.25,
            mend="Multiply by sigma^2.",
        ),
    ]


def _is_of_one_size(ask: Ask, n: int) -> bool:
    """Whether a larger matrix gives as few weights as one of n rows did, n - 1."""
    try:
        return as_array("inverse_weights(A)", returned(ask, "inverse_weights", 2 * np.eye(n + 1))).shape == (n - 1,)
    except NoAnswer:
        return False


@first_failure
def check_cayley_hamilton(ask: Ask) -> Iterator[Verdict]:
    """`inverse_weights(A)`: the inverse as a sum of powers of A."""
    for n in (2, 3, 4):
        A = ask.rng.uniform(-1, 1, (n, n)) + np.diag(ask.rng.uniform(1.5, 3, n))
        yield _judge_weights(ask, A)


def _weights_of_entries(A: FloatArray, first: int) -> FloatArray:
    """Weights of n powers, taken entry by entry from the first on, with which they come nearest to the inverse."""
    powers = np.column_stack([np.ravel(A ** float(k)) for k in range(first, first + len(A))])
    return np.asarray(np.linalg.lstsq(powers, np.ravel(np.linalg.inv(A)), rcond=None)[0], float)


def _judge_weights(ask: Ask, A: FloatArray) -> Verdict:
    n = A.shape[0]
    value = returned(ask, "inverse_weights", A)
    shape = as_array("inverse_weights(A)", value).shape
    if shape == (n, n):
        return Verdict(
            False, "`inverse_weights` returns a matrix: return the n weights of the powers of A.", "matrix returned"
        )
    if shape == (n - 1,) and _is_of_one_size(ask, n):
        return Verdict(
            False,
            f"`inverse_weights` returns {n - 1} number{'s' * (n > 2)} of a matrix of any size, and of this {n} by {n}: "
            "there is one weight for each of the powers I to A^(n-1), from all n + 1 coefficients.",
            "one size only",
        )
    if shape == (n - 1,):
        return Verdict(
            False,
            f"`inverse_weights` returns {n - 1} number{'s' * (n > 2)} for {n} powers, I to A^(n-1): the coefficient 1 "
            "of A^n makes a weight, too.",
            "a weight left out",
        )
    if shape == (n + 1,):
        return Verdict(
            False,
            "`inverse_weights` returns n + 1 numbers, the coefficients of the polynomial: after multiplying by the "
            "inverse of A, n powers remain, I to A^(n-1).",
            "coefficients of the polynomial",
        )
    *upper, last = characteristic_polynomial(A)
    c = np.array(upper)
    return judge(
        as_vector("inverse_weights(A)", value, n),
        -c[::-1] / last,
        SAME,
        "the inverse of a matrix is a sum of its own powers.",
        "the sum of the powers of A weighted by `inverse_weights` is not its inverse: multiply the theorem by the "
        "inverse.",
        [
            Slip(
                "highest power first",
                "`inverse_weights` begins with the highest power; w[0] belongs to I.",
                lambda: -c / last,
            ),
            Slip(
                "sign of the weights",
                "`inverse_weights` has the wrong sign."
                if n == 2  # the first size that is tried
                else f"`inverse_weights` is right for 2 by 2, and for {n} by {n} its sign is wrong. c_n is "
                "(-1)^n times the determinant of A, and not the determinant.",
                lambda: c[::-1] / last,
                mend="Move c_n I to the other side.",
            ),
            Slip("not divided by c_n", "`inverse_weights` lacks the division by c_n.", lambda: -c[::-1]),
            Slip(
                "powers off by one",
                "`inverse_weights` has c_n as the weight of I: multiplying by the inverse of A lowers each power by "
                "one.",
                lambda: -np.concatenate([[last], c[:0:-1]]) / last,
            ),
            Slip(
                "powers off by one",
                "`inverse_weights` begins with c_1, and its last is c_n over itself: c_n I is the term that is divided "
                "by, and the coefficient 1 of A^n is left out.",
                lambda: -np.concatenate([c[1:], [last]]) / last,
            ),
            Slip(
                "eigenvalues of the inverse",
                "`inverse_weights` returns the eigenvalues of the inverse: asked for are the weights of I, A, A^2, ...",
                lambda: np.real(1 / np.linalg.eigvals(A)),
            ),
            *(
                Slip(
                    "powers entry by entry",
                    "`inverse_weights` takes `A**k`, which raises each *entry* to a power: powers of a matrix are "
                    "`np.linalg.matrix_power(A, k)`.",
                    partial(_weights_of_entries, A, first),
                )
                for first in (0, 1)
            ),
            Slip(
                "divided by the first coefficient",
                "`inverse_weights` divides by the first coefficient, which is 1.",
                lambda: -np.concatenate([c[1:], [last]])[::-1],
                mend="Divide by c_n, the last.",
            ),
        ],
    )
