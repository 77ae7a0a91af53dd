"""Checks of the exponential: through the logarithm, its Jacobian, and the fit itself with its picture."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.nonlinear_least_squares.estimates import (
    SQUARED,
    SUMMED,
    as_estimate,
    fit_of_squares,
    fits_of_sum,
    within,
)
from labsid.checks.compare import SAME, as_array, as_matrix, as_number, as_vector
from labsid.checks.double_mistakes import TWO, Edit, pairs_of
from labsid.checks.figures import legend_text, one_figure, require_label, require_legend
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.least_squares.curve_fit import LINE, SUSTECH_POINTS, fit_powers
from labsid.nonlinear.exponential import evaluate_exponential, fit_exponential, fit_exponential_by_logarithm
from labsid.nonlinear.solve import NonlinearFit
from labsid.plots.figure_values import AxesValue, CurveValue

_STARTS = ((0.0, 1.0), (1.0, 1.0), (0.5, 1.0))
_IN_THE_VALLEY = 1.5
"""Of the smallest SSE: a larger one has another cause than a search that stopped early."""
_LEVEL = 1e-2
"""The largest cosine between the errors and a column of J where a search gives up because the SSE is level."""


@first_failure
def check_logarithm(ask: Ask) -> Iterator[Verdict]:
    """`fit_logarithm(x, y)`, which returns a and b."""
    for a, b in ((0.7, 0.4), (-0.5, 3.0)):
        n = int(ask.rng.integers(6, 11))
        x = np.sort(ask.rng.uniform(-2, 3, n))
        yield _judge_logarithm(ask, x, evaluate_exponential(x, a, b) * ask.rng.uniform(0.6, 1.6, n))


def _judge_logarithm(ask: Ask, x: FloatArray, y: FloatArray) -> Verdict:
    parts = returned_parts(ask, "fit_logarithm", "two numbers, a and b", 2, x, y)
    got = np.array([as_number(f"{name} of fit_logarithm(x, y)", part) for name, part in zip("ab", parts, strict=True)])
    fit = fit_exponential_by_logarithm(x, y)
    right = np.array([fit.a, fit.b])
    curve = fit_exponential(x, y)
    if within(curve.stderr, 1e-3)(got, curve.theta):
        return Verdict(
            False,
            "`fit_logarithm` fits the curve itself. That is the other method: here, fit a line to the logarithms.",
            "the other method",
        )
    return judge(
        got,
        right,
        SAME,
        "a line through the logarithms.",
        "`fit_logarithm` does not return the a and b of the line ln y = a x + c with b = e^c.",
        [
            Slip("a and b swapped", "`fit_logarithm` returns b before a.", lambda: right[::-1]),
            Slip(
                "slope and constant swapped",
                "`fit_logarithm` takes the constant of the line for its slope: `np.polyfit` returns the slope first, "
                "`lstsq` in the order of the columns.",
                lambda: np.array([np.log(fit.b), np.exp(fit.a)]),
            ),
            Slip(
                "e^a for a",
                "a of `fit_logarithm` is e^a: the line's slope is a itself; only its constant is a logarithm.",
                lambda: np.array([np.exp(fit.a), fit.b]),
            ),
            Slip(
                "x and y swapped",
                "`fit_logarithm` fits x to ln y: the line gives ln y for each x.",
                lambda: (
                    fit_powers(np.log(y), x, LINE).theta * [1, 0] + [0, np.exp(fit_powers(np.log(y), x, LINE).theta[1])]
                ),
            ),
            Slip(
                "b left as a logarithm",
                "b of `fit_logarithm` is still a logarithm.",
                lambda: np.array([fit.a, np.log(fit.b)]),
                mend="The line gives c = ln b, so b = e^c.",
            ),
            Slip(
                "logarithm to base 10",
                "`fit_logarithm` mixes bases: `log10` undoes powers of ten, and the model has powers of e. `np.log` is "
                "the natural logarithm.",
                lambda: np.array([fit.a, np.log(fit.b)]) / np.log(10),
            ),
            Slip(
                "logarithm to base 10",
                "`fit_logarithm` mixes bases: `log10` undoes powers of ten, and the model has powers of e. `np.log` is "
                "the natural logarithm.",
                lambda: np.array([fit.a / np.log(10), fit.b ** (1 / np.log(10))]),
            ),
            Slip(
                "logarithm to base 10",
                "a of `fit_logarithm` belongs to a power of ten: ln 10^(a x) is not a x. Use `np.log` throughout.",
                lambda: np.array([fit.a / np.log(10), fit.b]),
            ),
            Slip(
                "logarithm to base 10",
                "`fit_logarithm` returns [b, a] in place of [a, b], and its a is the right one over ln 10: use "
                "`np.log` throughout.",
                lambda: np.array([fit.b, fit.a / np.log(10)]),
            ),
            Slip(
                "no logarithm taken",
                "`fit_logarithm` fits a line to y itself: take the logarithm of y first.",
                lambda: fit_powers(x, y, LINE).theta,
            ),
            Slip(
                "no logarithm taken",
                "`fit_logarithm` fits a line to y itself: take the logarithm of y first.",
                lambda: fit_powers(x, y, LINE).theta * [1, 0] + [0, np.exp(fit_powers(x, y, LINE).theta[1])],
            ),
            *(
                Slip(
                    "parabola for the line",
                    "`fit_logarithm` fits a parabola to the logarithms, of which a line is asked: degree 1.",
                    partial(_of_parabola, x, y, first, last),
                )
                for first, last in ((0, 1), (0, 2), (1, 2))
            ),
            Slip(
                "line through the origin",
                "`fit_logarithm` has no column of ones: the line needs its constant, ln b.",
                lambda: np.array([fit_powers(x, np.log(y), (1,)).theta[0], 1.0]),
            ),
            Slip(
                "logarithm of x",
                "`fit_logarithm` takes the logarithm of x as well, which is for y = b x^a. Here ln y = a x + ln b: x "
                "stays as it is.",
                partial(_line, x, y, x_=np.log(np.abs(x))),
            ),
            *pairs_of("`fit_logarithm`", _edits_of_line(x, y), partial(_line, x, y)),
            Slip(
                TWO,
                "`fit_logarithm` returns ln b and a, in this order, as theta of the columns [1, x] is. Asked for are "
                "a, the slope, and then b = e^(ln b).",
                lambda: np.array([np.log(fit.b), fit.a]),
            ),
        ],
    )


def _edits_of_line(x: FloatArray, y: FloatArray) -> tuple[Edit, ...]:
    """Single mistakes in the line through the logarithms, and in what is made of it."""
    return (
        Edit("x_", np.log(np.abs(x)), "the logarithm of x is taken, too"),
        Edit("target", y, "the logarithm of y is not taken"),
        Edit("target", np.log10(y), "`log10` is taken, and not `log`"),
        Edit("taken", -1, "the constant of the line is taken for its slope: theta is in the order of the columns"),
        Edit("is_power", False, "b is left as a logarithm: b = e^c"),
        Edit("order", -1, "b is returned before a"),
    )


def _line(
    x: FloatArray,
    y: FloatArray,
    x_: FloatArray | None = None,
    target: FloatArray | None = None,
    taken: int = 1,
    is_power: bool = True,
    order: int = 1,
) -> FloatArray:
    """a and b of a line that is fitted to other things, or read in another way."""
    line = fit_powers(x if x_ is None else x_, np.log(y) if target is None else target, LINE).theta
    a, c = line[::taken]
    return np.array([a, float(np.exp(c)) if is_power else c])[::order]


def _of_parabola(x: FloatArray, y: FloatArray, first: int, last: int) -> FloatArray:
    theta = fit_powers(x, np.log(y), (2, 1, 0)).theta
    return np.array([theta[first], np.exp(theta[last])])


@first_failure
def check_jacobian(ask: Ask) -> Iterator[Verdict]:
    """`exp_jacobian(x, theta)` and `sse_gradient(x, y, theta)`."""
    for n in (5, 8):
        x, theta = ask.rng.uniform(0.3, 2, n), np.array([ask.rng.uniform(0.4, 0.9), ask.rng.uniform(1.5, 3)])
        y = evaluate_exponential(x, *theta) + ask.rng.uniform(-2, 2, n)
        yield _jacobian(ask, x, theta)
        yield _gradient(ask, x, y, theta)
    yield Verdict(True, "both derivatives are right.")


def jacobian_exponential(x: FloatArray, theta: FloatArray) -> FloatArray:
    """Differentiate ``b e^(a x)`` with respect to a and b."""
    growth = evaluate_exponential(x, theta[0], 1.0)
    return np.column_stack([theta[1] * x * growth, growth])


def _jacobian(ask: Ask, x: FloatArray, theta: FloatArray) -> Verdict:
    J = jacobian_exponential(x, theta)
    curve = evaluate_exponential(x, theta[0], theta[1])
    product = "the first column of `exp_jacobian` lacks the factor x: the derivative of e^(a x) for a brings x down."
    return judge(
        as_matrix("exp_jacobian(x, theta)", returned(ask, "exp_jacobian", x, theta), (x.size, 2)),
        J,
        SAME,
        "",
        "`exp_jacobian` is not the derivative of b e^(a x): hold each column against differences.",
        [
            Slip(
                "a and b swapped",
                "`exp_jacobian` takes the parameters in the order b, a: theta = [a, b].",
                lambda: jacobian_exponential(x, theta[::-1]),
            ),
            Slip("columns swapped", "`exp_jacobian` has b's column first; theta = [a, b].", lambda: J[:, ::-1]),
            Slip("factor x missing", product, lambda: np.column_stack([curve, J[:, 1]])),
            Slip("factor x missing", product, lambda: np.column_stack([J[:, 1], J[:, 1]])),
            Slip(
                "factor b missing",
                "the first column of `exp_jacobian` lacks the factor b, which stays when a changes.",
                lambda: np.column_stack([x * J[:, 1], J[:, 1]]),
            ),
            Slip(
                "differentiated with respect to x",
                "`exp_jacobian` holds a b e^(a x), the slope along x. Here a and b change, and x stays.",
                lambda: np.column_stack([theta[0] * curve, J[:, 1]]),
            ),
            Slip(
                "b left in its own column",
                "the second column of `exp_jacobian` still holds b: b e^(a x) is linear in b, with slope e^(a x).",
                lambda: np.column_stack([J[:, 0], curve]),
            ),
            Slip(
                "Jacobian of the error",
                "`exp_jacobian` has the other sign: it is that of the error y - g. Asked for is the one of g.",
                lambda: -J,
            ),
        ],
    )


def _gradient(ask: Ask, x: FloatArray, y: FloatArray, theta: FloatArray) -> Verdict:
    J = jacobian_exponential(x, theta)
    e = y - evaluate_exponential(x, theta[0], theta[1])
    value = returned(ask, "sse_gradient", x, y, theta)
    if as_array("sse_gradient(x, y, theta)", value).size == 1 and SAME(np.ravel(value), [e @ e]):  # type: ignore[arg-type]
        return Verdict(
            False, "`sse_gradient` returns the SSE itself: asked for are its two derivatives.", "SSE for its gradient"
        )
    return judge(
        as_vector("sse_gradient(x, y, theta)", value, 2),
        -2 * J.T @ e,
        SAME,
        "",
        "`sse_gradient` is not the gradient of the SSE: it is -2 J'e, with e = y - g(theta).",
        [
            Slip(
                "uphill and downhill swapped",
                "`sse_gradient` has the other sign. The gradient points uphill; e holds g with a minus.",
                lambda: 2 * J.T @ e,
            ),
            Slip("factor 2 missing", "`sse_gradient` is half the gradient: e squared brings a 2.", lambda: -J.T @ e),
            Slip(
                "uphill and downhill swapped",
                "`sse_gradient` has the other sign, and the 2 is missing.",
                lambda: J.T @ e,
            ),
            Slip(
                "a mean in place of the sum",
                "`sse_gradient` is divided by the number of points: the SSE is a sum.",
                lambda: -2 * J.T @ e / e.size,
            ),
            Slip(
                "y in place of the error",
                "`sse_gradient` multiplies J' by y; it takes the error y - g(theta).",
                lambda: -2 * J.T @ y,
            ),
        ],
    )


@first_failure
def check_exponential_fit(ask: Ask) -> Iterator[Verdict]:
    """`fit_exponential(x, y)`, `theta_exp` on the printed data, and the picture of both methods."""
    for a, b in ((0.8, 0.6), (-0.6, 0.8), (0.6, 1.2)):
        x = np.linspace(-2, 3, 9) + ask.rng.uniform(-0.2, 0.2, 9)
        y = evaluate_exponential(x, a, b) + 0.5 * ask.rng.standard_normal(9)
        y[np.argmin(evaluate_exponential(x, a, b))] = -ask.rng.uniform(0.5, 1.0)
        yield _judge_exponential(as_estimate("fit_exponential(x, y)", _fitted(ask, x, y), 2), x, y)
    x = np.linspace(1, 4, 9) + ask.rng.uniform(-0.1, 0.1, 9)  # a long valley: a search that ends early ends far away
    y = evaluate_exponential(x, 0.6, 0.6) + 0.3 * ask.rng.standard_normal(9)
    yield _judge_exponential(as_estimate("fit_exponential(x, y)", _fitted(ask, x, y), 2), x, y)
    points = SUSTECH_POINTS
    got = as_estimate("theta_exp", ask.value("theta_exp"), 2)
    printed = _judge_exponential(got, points.x, points.y)
    if not printed.passed:
        yield Verdict(False, "the function is right, `theta_exp` is not: leave that line as it was given.")
    yield _picture(one_figure("fig_exp", ask.value("fig_exp")), got)


def _fitted(ask: Ask, x: FloatArray, y: FloatArray) -> FloatArray:
    value = returned(ask, "fit_exponential", x, y)
    if isinstance(value, np.ndarray) and not np.all(np.isfinite(value)):
        if np.min(y) < 0 and _is_finite(ask, x, np.maximum(y, 0.1)):
            raise NoAnswer(
                "`fit_exponential` returns nan where one y is negative, and numbers where that y is 0.1: it takes a "
                "logarithm, or a root, of y.",
                "logarithm of a negative number",
            )
        raise NoAnswer("`fit_exponential` returns nan. Print a, b and the SSE in each of its iterations.")
    return value  # type: ignore[return-value]


def _is_finite(ask: Ask, x: FloatArray, y: FloatArray) -> bool:
    try:
        return bool(np.all(np.isfinite(as_vector("fit_exponential(x, y)", ask.call("fit_exponential", x, y)))))
    except NoAnswer:
        return False


def _judge_exponential(got: FloatArray, x: FloatArray, y: FloatArray) -> Verdict:
    fit = fit_exponential(x, y)
    k = y > 0
    verdict = judge(
        got,
        fit.theta,
        within(fit.stderr),
        "",
        f"`fit_exponential` does not return the [a, b] with the smallest sum of squared errors, {fit.sse:.4g}.",
        [
            Slip("a and b swapped", "`fit_exponential` returns b before a.", lambda: fit.theta[::-1]),
            Slip(
                "negative points left out",
                "`fit_exponential` leaves out the points with a negative y. Only the logarithm needs y > 0.",
                lambda: fit_exponential(x[k], y[k]).theta,
            ),
            Slip(
                "the logarithm once more",
                "`fit_exponential` is the line through the logarithms of the positive points: it may start from there, "
                "but then the curve itself is to be fitted.",
                lambda: _by_logarithm(x[k], y[k]),
            ),
            Slip(
                "the logarithm once more",
                "`fit_exponential` is the line through the logarithms of |y|: the absolute value turns the negative "
                "points round, and a logarithm weights errors by 1/y. Fit the curve itself, which needs no logarithm.",
                lambda: _by_logarithm(x, np.abs(y)),
            ),
            Slip(
                "squares handed over",
                f"`fit_exponential` {SQUARED}",
                lambda: fit_of_squares(
                    lambda th: evaluate_exponential(x, th[0], th[1]),
                    lambda th: jacobian_exponential(x, th),
                    y,
                    fit.theta,
                ),
            ),
            *(
                Slip("sum of squares handed over", f"`fit_exponential` {SUMMED}", wrong)
                for wrong in fits_of_sum(lambda th: evaluate_exponential(x, th[0], th[1]), y, _STARTS)
            ),
            Slip(
                "absolute values",
                "`fit_exponential` takes the absolute value of y: that changes the data.",
                lambda: fit_exponential(x, np.abs(y)).theta,
            ),
        ],
    )
    if verdict.passed or verdict.slip or abs(got[0]) > 100:
        return verdict
    with np.errstate(over="ignore"):
        e = y - evaluate_exponential(x, got[0], got[1])
        if e @ e < fit.sse * _IN_THE_VALLEY:
            return Verdict(
                False,
                f"`fit_exponential` stops at an SSE of {e @ e:.4g}, where {fit.sse:.4g} is possible: in the right "
                "valley, "
                "before its lowest point. (What is handed to `least_squares` is one error for each point, which it "
                "squares and adds up itself.)",
                "stopped in the valley",
            )
        J = jacobian_exponential(x, got)
        slopes, sizes = np.abs(J.T @ e), np.linalg.norm(J, axis=0) * np.linalg.norm(e)
    if not np.all(slopes <= _LEVEL * sizes):
        return Verdict(
            False,
            f"`fit_exponential` ends at an SSE of {e @ e:.4g}, and {fit.sse:.4g} is possible. It is no minimum either: "
            "J'e, "
            "which is zero there, is not.",
        )
    return Verdict(
        False,
        "`fit_exponential` ends where the SSE is far larger than it could be: from some starts the curve passes by all "
        "points but one, the surface is level there, and the iteration gives up. Start elsewhere, say at a = 0.",
        "stuck on a plateau",
    )


def _by_logarithm(x: FloatArray, y: FloatArray) -> FloatArray:
    fit = fit_exponential_by_logarithm(x, y)
    return np.array([fit.a, fit.b])


def sustech_fits() -> tuple[NonlinearFit, FloatArray]:
    """Both methods on SUSTech's table: the curve on all points, the logarithm on the positive ones."""
    x, y = SUSTECH_POINTS.x, SUSTECH_POINTS.y
    return fit_exponential(x, y), _by_logarithm(x[y > 0], y[y > 0])


def _picture(axes: AxesValue, theta_exp: FloatArray) -> Verdict:
    _, line = sustech_fits()
    points = [c for c in axes.curves if c.x.size == 5 and np.array_equal(np.sort(c.x), np.sort(SUSTECH_POINTS.x))]
    right_y = SUSTECH_POINTS.y[np.argsort(SUSTECH_POINTS.x)]
    points = [c for c in points if np.allclose(c.y[np.argsort(c.x)], right_y)]
    if not points:
        raise NoAnswer("In the figure the five points are missing: `plot(x_s, y_s, 'o')`.", "points missing")
    if any(curve.joined for curve in points):
        raise NoAnswer(
            "In the figure lines join the five points; they are measurements, to be drawn as circles alone: "
            "`plot(x_s, y_s, 'o')`.",
            "points joined by lines",
        )
    drawn = []
    for name, theta in (("theta_exp", theta_exp), ("theta_log", line)):
        fitted = _find(axes, theta, 20)
        if fitted is None and _find(axes, theta, 3) is not None:
            raise NoAnswer(f"In the figure the curve of `{name}` has corners: use `grid`.", "drawn at few points")
        if fitted is None and _find(axes, theta[::-1], 3) is not None:
            raise NoAnswer(f"In the figure `{name}` has a and b swapped.", "a and b swapped in the figure")
        if fitted is None:
            raise NoAnswer(f"In the figure no curve shows b e^(a x) of `{name}` over `grid`.", "no curve")
        drawn.append(fitted)
    for axis in "xy":
        require_label(axes, "the figure", axis, "")
    require_legend(axes, "the figure", 3)
    of_curve, of_line = (legend_text(axes, artist).lower() for artist in drawn)
    if "log" in of_curve and "log" not in of_line:
        return Verdict(False, "The legend of the figure has the two methods swapped.", "legend entries swapped")
    return Verdict(True, "the curve through all five points, and the other method's beside it.")


def _find(axes: AxesValue, theta: FloatArray, least: int) -> CurveValue | None:
    for curve in axes.curves:
        if curve.x.size >= least and curve.x.size == curve.y.size and np.all(np.abs(curve.x) < 50):
            right = as_array("curve", evaluate_exponential(curve.x, theta[0], theta[1]))
            if np.allclose(curve.y, right, rtol=1e-2, atol=1e-2):
                return curve
    return None
