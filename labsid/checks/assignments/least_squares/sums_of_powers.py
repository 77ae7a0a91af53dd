"""Checks of fits by sums of powers (Examples 2-1, 2-2, 2-4), and of Fig. 5."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_array, as_number, as_theta, as_vector
from labsid.checks.figures import legend_text, one_figure, plain_text, require_label, require_legend
from labsid.checks.question import Ask, returned_parts
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.least_squares.curve_fit import EXAMPLE_2_1, LINE, PARABOLA, fit_powers, power_regressors
from labsid.least_squares.solve import solve_least_squares
from labsid.plots.figure_values import AxesValue, CurveValue


@first_failure
def check_fits(ask: Ask) -> Iterator[Verdict]:
    """`fit_powers(x, y, powers)`, then its results for Example 2-1."""
    drawn = tuple(int(p) for p in ask.rng.permutation(4)[:2])
    for powers in ((3, 2, 1), (1, 0), (2, 1, 0), (0, 1, 2), drawn, (2,)):
        yield _one_fit(ask, powers)
    for name, right in right_fits(ask).items():
        if not SAME(np.ravel(as_array(name, ask.value(name))), np.ravel(as_array(name, right))):
            yield Verdict(False, f"the function is right, `{name}` is not: do not change the last lines of the cell.")
    yield Verdict(True, "it fits any sum of powers, and its line is the one of Example 2-4.")


@first_failure
def _one_fit(ask: Ask, powers: tuple[int, ...]) -> Iterator[Verdict]:
    n = int(ask.rng.integers(8, 13))
    x = ask.rng.permutation(np.linspace(-1.5, 2.5, n) + ask.rng.uniform(-0.15, 0.15, n))
    y = ask.rng.uniform(-4, 4, n)
    call = f"fit_powers(x, y, {list(powers)})"
    parts = returned_parts(ask, "fit_powers", "theta and the SSE", 2, x, y, np.array(powers))
    if _size(parts[0]) == 1 and _size(parts[1]) == len(powers) > 1:
        yield Verdict(False, "`fit_powers` returns the SSE before theta.", "theta and SSE swapped")
    fit = fit_powers(x, y, powers)
    if isinstance(parts[0], np.ndarray) and parts[0].size != len(powers):
        yield Verdict(
            False,
            f"`{call}` returns {parts[0].size} parameters; it should return one for each power: use `powers`.",
            "powers not used",
        )
    yield judge(
        as_theta(f"theta of {call}", parts[0], len(powers)),
        fit.theta,
        SAME,
        "",
        f"theta of `{call}` is not the least-squares solution.",
        [
            Slip(
                "order of theta",
                "theta of `fit_powers` is not in the order of `powers`: make one column for each power, in this order.",
                lambda: fit.theta[::-1],
            ),
            Slip(
                "powers not used",
                f"`{call}` fits other powers than requested: use `powers`.",
                lambda: fit_powers(x, y, (2, 1, 0)[-len(powers) :]).theta,
            ),
            *(
                Slip(
                    "powers not used",
                    f"`{call}` fits the powers {list(others)} of x: make the columns from `powers`, in its order.",
                    partial(_theta_of_powers, x, y, others),
                )
                for others in _other_powers(powers)
            ),
            *(
                Slip(
                    "arguments not used",
                    "`fit_powers` fits the table `u_1`, `y_1` of the lines above, whatever is handed in: use "
                    "its arguments "
                    "x and y.",
                    partial(_theta_of_powers, EXAMPLE_2_1.x, EXAMPLE_2_1.y, handed_in),
                )
                for handed_in in (powers,)
                if len(powers) < EXAMPLE_2_1.x.size
            ),
            Slip(
                "p^x for x^p",
                "`fit_powers` makes the columns p**x: a column is x to the power p, `x ** p`.",
                lambda: solve_least_squares(np.array([float(p) ** x for p in powers]).T, y).theta,
            ),
            Slip(
                "p x for x^p",
                "`fit_powers` makes the columns p * x: a column is x to the power p, `x ** p`.",
                lambda: np.asarray(np.linalg.lstsq(np.outer(x, powers), y)[0], np.float64),
            ),
            Slip(
                "x and y swapped", "`fit_powers` fits x to y; make Phi from x.", lambda: fit_powers(y, x, powers).theta
            ),
            Slip(
                "inverse forgotten",
                "theta of `fit_powers` is Phi'y: the inverse of Phi'Phi is missing.",
                lambda: power_regressors(x, powers).T @ y,
            ),
        ],
    )
    sse = 2 * fit.loss
    if _size(parts[1]) == 0:
        yield Verdict(False, "the SSE of `fit_powers` is empty: compute it from y - Phi theta.")
    if _size(parts[1]) == n:
        yield Verdict(
            False,
            "the second value of `fit_powers` holds the errors themselves: square them and add up.",
            "errors not added up",
        )
    mean = "the second value of `fit_powers` is a mean of the squared errors; return their sum."
    slips: list[Slip[float]] = [
        Slip(
            "half the sum",
            "the second value of `fit_powers` is half of the SSE; return the whole sum.",
            lambda: fit.loss,
        ),
        Slip("mean in place of the sum", mean, lambda: sse / n),
        Slip("mean in place of the sum", mean, lambda: fit.sigma2),
        Slip("root of the sum", "the second value of `fit_powers` is the root of the SSE.", lambda: float(sse**0.5)),
        Slip(
            "squares of y instead of the errors",
            "the second value of `fit_powers` is y'y: square the errors y - Phi theta instead.",
            lambda: float(y @ y),
        ),
        Slip(
            "errors not squared",
            "the second value of `fit_powers` adds the errors without squaring them, so that they cancel.",
            lambda: float(np.sum(fit.residual)),
        ),
        Slip(
            "errors not squared",
            "the second value of `fit_powers` adds absolute errors: square the errors instead.",
            lambda: float(np.sum(np.abs(fit.residual))),
        ),
    ]
    slips.append(
        Slip(
            "sum squared",
            "the second value of `fit_powers` is the square of the sum of the errors: square each error, and then add.",
            lambda: float(np.sum(fit.residual) ** 2),
        )
    )
    got = as_number(f"the SSE of {call}", parts[1])
    if 0 in powers and abs(got) < _ROUNDING * sse:
        slips.append(
            Slip(
                "errors not squared",
                f"the second value of `fit_powers` is zero but for rounding, {got:.2g}. With a constant in the model "
                "the errors themselves add up to zero: square each error, and then add.",
                lambda: got,
            )
        )
    yield judge(
        got,
        sse,
        SAME,
        "",
        "the second value of `fit_powers` is not the sum of the squared errors.",
        slips,
    )


_ROUNDING = 1e-12
"""Of the SSE: what rounding leaves of a sum that is zero."""


def _theta_of_powers(x: FloatArray, y: FloatArray, powers: tuple[int, ...]) -> FloatArray:
    return fit_powers(x, y, powers).theta


def _other_powers(powers: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Powers that are as many as those asked for, and may be fitted in their place."""
    n = len(powers)
    for other in (tuple(range(n)), tuple(range(n))[::-1], tuple(range(1, n + 1)), tuple(range(1, n + 1))[::-1]):
        if sorted(other) != sorted(powers):
            yield other


def _size(value: Value) -> int:
    return value.size if isinstance(value, np.ndarray) else 1


def right_fits(_: Ask) -> dict[str, Value]:
    """Results of the last lines of the step."""
    line, parabola = (fit_powers(EXAMPLE_2_1.x, EXAMPLE_2_1.y, powers) for powers in (LINE, PARABOLA))
    return {
        "theta_line": line.theta,
        "sse_line": 2 * line.loss,
        "theta_parabola": parabola.theta,
        "sse_parabola": 2 * parabola.loss,
    }


def new_models(ask: Ask) -> dict[str, Value]:
    """A line and a parabola near the points of the table, to practise with."""
    line = np.array([ask.rng.uniform(0.8, 1.4), ask.rng.uniform(-0.5, 0.5)])
    parabola = np.array([-ask.rng.uniform(0.02, 0.1), ask.rng.uniform(1.2, 2.0), ask.rng.uniform(-0.5, 0.5)])
    return {"u_1": EXAMPLE_2_1.x, "y_1": EXAMPLE_2_1.y, "theta_line": line, "theta_parabola": parabola}


def check_figure_5(ask: Ask) -> Verdict:
    """Fig. 5: the points, the line and the parabola."""
    axes = one_figure("fig_5", ask.value("fig_5"))
    line, parabola = (
        as_vector(name, ask.known(name), size) for name, size in (("theta_line", 2), ("theta_parabola", 3))
    )
    points = _find(axes, lambda x: np.interp(x, EXAMPLE_2_1.x, EXAMPLE_2_1.y), sizes=(5, 5))
    if points is not None and points.joined:
        raise NoAnswer(
            "In Fig. 5 lines join the points of the table; they are measurements, to be drawn as circles alone: "
            "`plot(u_1, y_1, 'o')`.",
            "points joined by lines",
        )
    if points is None:
        raise NoAnswer("In Fig. 5 the points of the table are missing: use `plot(u_1, y_1, 'o')`.", "points missing")
    curves = []
    for name, theta in (("line", line), ("parabola", parabola)):
        curve = _find(axes, _polynomial(theta), sizes=(20, None))
        if curve is None and _find(axes, _polynomial(theta), sizes=(3, 19)):
            raise NoAnswer(
                f"In Fig. 5 the {name} is drawn through too few points: evaluate it at `grid`.",
                "drawn at the data points only",
            )
        if curve is None and _find(axes, _polynomial(theta[::-1]), sizes=(3, None)):
            raise NoAnswer(
                f"In Fig. 5 the {name} has its parameters in reverse order: theta begins with the highest power.",
                "order of theta",
            )
        if curve is None:
            raise NoAnswer(f"In Fig. 5 no curve shows the {name}: evaluate `theta_{name}` at `grid`.", "no curve")
        if curve.x.min() > 1 or curve.x.max() < 7:
            raise NoAnswer(f"In Fig. 5 the {name} does not cover all points, u = 1 to 7.", "drawn too short")
        curves.append(curve)
    for axis in "xy":
        require_label(axes, "Fig. 5", axis, "")
    of_x, of_y = (plain_text(label).lower() for label in (axes.xlabel, axes.ylabel))
    if of_x.startswith(("y", "output")) and of_y.startswith(("u", "input")):
        raise NoAnswer("In Fig. 5 the labels of the two axes are swapped.", "axis labels swapped")
    require_legend(axes, "Fig. 5", 3)
    of_line, of_parabola = (legend_text(axes, curve).lower() for curve in curves)
    if "parab" in of_line or "quadr" in of_line or "line" in of_parabola.split():
        return Verdict(False, "The legend of Fig. 5 has line and parabola swapped.", "legend entries swapped")
    return Verdict(True, "both models and the points.")


def _polynomial(theta: FloatArray) -> Callable[[FloatArray], FloatArray]:
    def f(x: FloatArray) -> FloatArray:
        return np.asarray(np.polyval(theta, x), float)

    return f


def _find(axes: AxesValue, f: Callable[[FloatArray], FloatArray], sizes: tuple[int, int | None]) -> CurveValue | None:
    least, most = sizes
    for curve in axes.curves:
        if curve.x.size >= least and (most is None or curve.x.size <= most) and curve.x.size == curve.y.size:
            if least == 5 == most and not np.array_equal(np.sort(curve.x), EXAMPLE_2_1.x):
                continue
            if np.allclose(curve.y, f(curve.x), rtol=1e-6, atol=1e-6):
                return curve
    return None
