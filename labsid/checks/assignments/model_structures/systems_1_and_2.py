"""Checks around Systems 1 and 2: Example 3-1, one-step prediction beside simulation, Fig. 8."""

from collections.abc import Iterator
from functools import lru_cache, partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_theta, as_vector, close
from labsid.checks.figures import legend_text, no_curve, one_figure, plain_text, require_label, require_legend
from labsid.checks.question import Ask, returned, with_lists
from labsid.checks.regressions import WRAPS, slips_of_fit, wrapped_filter
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.polynomials import apply
from labsid.model_structures.prediction import free_run, one_step_prediction
from labsid.model_structures.structures import PolynomialModel, Structure, fit_structure
from labsid.plots.figure_values import AxesValue, CurveValue

_EXACT = close(1e-8)
_FIRST_ORDER = Structure(1, 1)


@lru_cache(maxsize=1)
def _records() -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    """(u, y) of System 1 and of System 2, as the notebook's cell `ms-5-records` makes them."""
    rng = np.random.default_rng(31)
    u = 2 - 4 * rng.random(1000)
    e = rng.standard_normal(1000)
    e[0] = 0
    models = (_model([1, -0.8], [0, 1]), PolynomialModel(np.array([1, -0.8]), np.ones(1), np.array([1, -0.8])))
    first, second = ((u, free_run(model, u, e)) for model in models)
    return first, second


def _model(A: list[float] | FloatArray, B: list[float] | FloatArray) -> PolynomialModel:
    return PolynomialModel(np.array(A, float), np.array(B, float), np.ones(1), 0)


def _fit(u: FloatArray, y: FloatArray, start: int = 1) -> FloatArray:
    return fit_structure(_FIRST_ORDER, u, y, start=start).fit.theta


@first_failure
def check_example_3_1(ask: Ask) -> Iterator[Verdict]:
    """`example_3_1(u, y)` on systems of the same form, then what it gives for Systems 1 and 2."""
    for samples in (60, int(ask.rng.integers(40, 90))):
        a, b = ask.rng.uniform(-0.9, -0.5), ask.rng.uniform(1.5, 2.5)
        u, e = ask.rng.uniform(-2, 2, samples), ask.rng.standard_normal(samples)
        u[0] = e[0] = 0
        yield _judge_table(ask, u, free_run(_model([1, a], [0, b]), u, e))
    for system, record in zip((1, 2), _records(), strict=True):
        name = f"theta_{system}"
        got = as_theta(name, ask.value(name), 2)
        if not any(SAME(got, _fit(*record, start)) for start in (1, 0, 2, 3)):
            yield Verdict(
                False, f"the function is right, `{name}` is not: it is `example_3_1(u_{system}, y_{system})`."
            )
    yield Verdict(True, "System 1 is found; System 2 is not of this structure, and a goes astray.")


def _judge_table(ask: Ask, u: FloatArray, y: FloatArray) -> Verdict:
    right = _fit(u, y)
    got = as_theta("example_3_1(u, y)", returned(ask, "example_3_1", u, y), 2)
    if any(SAME(got, _fit(u, y, start)) for start in (0, 2, 3)):
        return Verdict(True, "")
    lag = "`example_3_1` has a lag wrong: the row of y(t) holds y(t-1) and u(t-1)."
    constant = np.column_stack([-y[:-1], u[:-1], np.ones(y.size - 1)])
    return judge(
        got,
        right,
        SAME,
        "",
        "`example_3_1` does not return the least-squares [a, b]. The row beside y(t) is [-y(t-1), u(t-1)], from t = 1 "
        "on: print the shape and the first two rows of your Phi, beside those of Y.",
        [
            Slip(
                "sign of a",
                "`example_3_1` returns -a first, as the lab's theta does. Table 1 lists a itself: with -y(t-1) in Phi, "
                "the first number of theta is a as it stands.",
                lambda: right * [-1, 1],
            ),
            Slip("order of theta", "`example_3_1` returns b before a.", lambda: right[::-1]),
            Slip("order of theta", "`example_3_1` returns b before a, and -a at that.", lambda: right[::-1] * [1, -1]),
            Slip("u and y swapped", "`example_3_1` has u and y swapped: the input comes first.", lambda: _fit(y, u)),
            Slip(
                "lag off by one",
                "`example_3_1` explains y(t) by itself: the row of y(t) holds y(t-1) and u(t-1).",
                lambda: solve_least_squares(np.column_stack([-y, u]), y).theta,
            ),
            *(
                Slip("lag off by one", lag, lambda columns=columns, Y=Y: solve_least_squares(columns, Y).theta)  # type: ignore[misc]
                for columns, Y in (
                    (np.column_stack([-y[:-1], u[1:]]), y[1:]),
                    (np.column_stack([-y[:-2], u[:-2]]), y[2:]),
                    (np.column_stack([-y[1:-1], u[:-2]]), y[2:]),
                    (np.column_stack([-y[:-2], u[1:-1]]), y[2:]),
                )
            ),
            Slip(
                "a constant fitted along",
                "`example_3_1` fits a constant besides a and b; the model has none.",
                lambda: solve_least_squares(constant, y[1:]).theta[:2],
            ),
            *(
                Slip(
                    "another structure",
                    f"`example_3_1` fits two {what} and no {other}: na = 1 and nb = 1 are asked for, one of each.",
                    partial(np.multiply, solve_least_squares(columns, y[2:]).theta, sign),
                )
                for what, other, columns, sign in (
                    ("past outputs", "input", np.column_stack([-y[1:-1], -y[:-2]]), 1),
                    ("past outputs", "input", np.column_stack([-y[1:-1], -y[:-2]]), -1),
                    ("past inputs", "output", np.column_stack([u[1:-1], u[:-2]]), 1),
                )
            ),
            Slip(
                "arguments not used",
                "`example_3_1` fits the same record whatever is handed in: use its arguments u and y.",
                lambda: _fit(*_records()[0]),
            ),
            Slip(
                "inverse forgotten",
                "`example_3_1` returns Phi'y: the inverse of Phi'Phi is missing.",
                lambda: np.array([-y[:-1] @ y[1:], u[:-1] @ y[1:]]),
            ),
            *slips_of_fit("`example_3_1`", [(-y, 1), (u, 1)], y, u),
        ],
    )


def right_tables(_: Ask) -> dict[str, Value]:
    """What the last lines of that step compute."""
    (u_1, y_1), (u_2, y_2) = _records()
    return {"theta_1": _fit(u_1, y_1), "theta_2": _fit(u_2, y_2)}


@first_failure
def check_predict(ask: Ask) -> Iterator[Verdict]:
    """`predict(A, B, u, y)` and `free_run(A, B, u)`, then `y_hat` and `y_sim`."""
    rng = ask.rng
    for na, nb, delay in ((1, 1, 1), (2, 2, 1), (2, 2, 0), (1, 1, 3)):
        # the sum of |a| stays below one: stable, also with the other sign
        A = np.r_[1, rng.choice([-1.0, 1.0], na) * rng.uniform(0.2, 0.45, na)]
        B = np.r_[np.zeros(delay), rng.uniform(0.5, 2, nb)]
        samples = int(rng.integers(18, 24))
        u, y = rng.uniform(1, 2, samples), rng.uniform(2, 5, samples)
        yield _judge_prediction(ask, A, B, u, y)
        yield _judge_run(ask, A, B, u)
    yield with_lists(ask, lambda given: _judge_prediction(given, A, B, u, y), 0, 1)
    yield with_lists(ask, lambda given: _judge_run(given, A, B, u), 0, 1)
    right = _outputs(as_vector("theta_1", ask.known("theta_1"), 2))
    got = {name: as_vector(name, ask.value(name), 1000) for name in right}
    if _EXACT(got["y_hat"], right["y_sim"]) or _EXACT(got["y_sim"], right["y_hat"]):
        yield Verdict(
            False,
            "the functions are right, but `y_hat` and `y_sim` are not: y_hat is the prediction, y_sim the free run.",
            "prediction passed off as simulation",
        )
    for name in right:
        if not _EXACT(got[name], right[name]):
            yield Verdict(False, f"the functions are right, `{name}` is not: leave the last lines as they were given.")
    yield Verdict(True, "one is told the truth after every sample, the other never.")


def _judge_prediction(ask: Ask, A: FloatArray, B: FloatArray, u: FloatArray, y: FloatArray) -> Verdict:
    right = one_step_prediction(_model(A, B), u, y)
    opposite = np.r_[1, -A[1:]]
    longest = max(A.size, B.size) - 1
    return judge(
        as_vector("predict(A, B, u, y)", returned(ask, "predict", A, B, u, y), u.size),
        right,
        _EXACT,
        "",
        "`predict` is not the one-step prediction: work through the numbers of the example by hand.",
        [
            Slip(
                "simulation passed off as prediction",
                "`predict` feeds on its own outputs: that is the free run. The prediction takes the *measured* y(k-1).",
                lambda: free_run(_model(A, B), u),
            ),
            Slip(
                "sign of a",
                "`predict` adds the past outputs. In the predictor they have a minus: -a1 y(k-1).",
                lambda: one_step_prediction(_model(opposite, B), u, y),
            ),
            Slip(
                "simulation passed off as prediction",
                "`predict` adds the measured y(k) to the simulation. The prediction puts the past measured outputs "
                "into the equation, -a1 y(k-1) and so on.",
                lambda: free_run(_model(A, B), u) + y,
            ),
            *(
                Slip(
                    "first order only",
                    f"`predict` uses {which}: they may have more coefficients, here {A.size} and {B.size}.",
                    partial(lambda a, b: one_step_prediction(_model(a, b), u, y), a, b),
                )
                for which, a, b in _first_order_only(A, B)
            ),
            Slip(
                "the prediction error",
                "`predict` returns the prediction error: it should return the prediction, y less this error.",
                lambda: y - right,
            ),
            Slip(
                "the prediction error",
                "`predict` returns the prediction error with a minus, -A y + B u: it is (1 - A) y + B u, without y(k).",
                lambda: right - y,
            ),
            Slip(
                "output to be predicted used",
                "`predict` uses y(k) to predict y(k): A - 1 begins with q^-1, the 1 is taken off.",
                lambda: right - 2 * y,
            ),
            Slip(
                "lag off by one",
                "`predict` takes y(k) for y(k-1): the sample that is to be predicted is not known yet.",
                lambda: one_step_prediction(_model(A, B), u, np.r_[y[1:], 0]),
            ),
            Slip(
                "lag off by one",
                "`predict` takes y(k) for y(k-1): the sample that is to be predicted is not known yet.",
                lambda: apply(B, u) - apply(A[1:], y),
            ),
            Slip(
                "lag off by one",
                "`predict` takes y(k-2) for y(k-1): A[1] stands with y(k-1).",
                lambda: one_step_prediction(_model(np.r_[1, 0, A[1:]], B), u, y),
            ),
            Slip(
                "lag off by one",
                "`predict` lets u act one sample early: the leading zeros of B are the delay, keep them.",
                lambda: one_step_prediction(_model(A, B[1:]), u, y),
            ),
            Slip(
                "lag off by one",
                "`predict` has an extra delay: B holds the delay of u already.",
                lambda: one_step_prediction(_model(A, np.r_[0, B]), u, y),
            ),
            Slip(
                WRAPS,
                "`predict` takes the last samples for those before the first: `np.roll` and negative indices go round.",
                lambda: wrapped_filter(B, u) - wrapped_filter(np.r_[0, A[1:]], y),
            ),
            Slip(
                "first samples left at zero",
                "`predict` leaves the first samples at zero. Only what lies before the record is zero.",
                lambda: np.where(np.arange(u.size) < longest, 0, right),
            ),
            Slip(
                "first samples left at zero",
                "`predict` starts with the measured samples. Before the record all is zero: predict them, too.",
                lambda: np.where(np.arange(u.size) < longest, y, right),
            ),
        ],
    )


def _judge_run(ask: Ask, A: FloatArray, B: FloatArray, u: FloatArray) -> Verdict:
    opposite = np.r_[1, -A[1:]]
    return judge(
        as_vector("free_run(A, B, u)", returned(ask, "free_run", A, B, u), u.size),
        free_run(_model(A, B), u),
        _EXACT,
        "",
        "`free_run` is not the output of B/A from rest: work through the numbers of the example by hand.",
        [
            Slip(
                "sign of a",
                "`free_run` has the other sign of a: y(k) = -a1 y(k-1) - ... + B u.",
                lambda: free_run(_model(opposite, B), u),
            ),
            *(
                Slip(
                    "first order only",
                    f"`free_run` uses {which}: they may have more coefficients, here {A.size} and {B.size}.",
                    partial(lambda a, b: free_run(_model(a, b), u), a, b),
                )
                for which, a, b in _first_order_only(A, B)
            ),
            Slip(
                "past outputs left out",
                "`free_run` leaves its own past outputs out: the model has a memory.",
                lambda: free_run(_model([1], B), u),
            ),
            Slip(
                "lag off by one",
                "`free_run` has an extra delay: B holds it already.",
                lambda: free_run(_model(A, np.r_[0, B]), u),
            ),
            Slip(
                WRAPS,
                "`free_run` takes the last inputs for those before the first: u[k - i] with k < i goes round.",
                lambda: free_run(_model(A, [1]), wrapped_filter(B, u)),
            ),
            Slip(
                "first samples left at zero",
                "`free_run` starts at the longest lag: u(0) acts as soon as B lets it.",
                lambda: _late_run(A, B, u),
            ),
        ],
    )


def _first_order_only(A: FloatArray, B: FloatArray) -> list[tuple[str, FloatArray, FloatArray]]:
    """What a program for a first-order model uses of longer polynomials."""
    only_b1 = np.array([0.0, *B[1:2]])
    return [
        ("only the first two coefficients of A and of B", A[:2], B[:2]),
        ("only A[1] and B[1]", A[:2], only_b1),
        ("only the first two coefficients of A", A[:2], B),
        ("only the first two coefficients of B", A, B[:2]),
    ]


def _late_run(A: FloatArray, B: FloatArray, u: FloatArray) -> FloatArray:
    driving = free_run(_model([1], B), u)
    driving[: max(A.size, B.size) - 1] = 0
    return free_run(_model(A, [1]), driving)


def _outputs(theta: FloatArray) -> dict[str, FloatArray]:
    u, y = _records()[0]
    model = _model([1, theta[0]], [0, theta[1]])
    return {"y_hat": one_step_prediction(model, u, y), "y_sim": free_run(model, u)}


def right_outputs(ask: Ask) -> dict[str, Value]:
    """What the last lines of that step compute, with the parameters of the step before."""
    return {**_outputs(as_vector("theta_1", ask.known("theta_1"), 2))}


def new_outputs(ask: Ask) -> dict[str, Value]:
    """Prediction and simulation of another model, to practise with."""
    theta = np.array([-ask.rng.uniform(0.5, 0.9), ask.rng.uniform(0.6, 1.4)])
    return {"y_1": _records()[0][1], **_outputs(theta)}


def check_figure_8(ask: Ask) -> Verdict:
    """Fig. 8: measurement, one-step prediction and simulation."""
    axes = one_figure("fig_8", ask.value("fig_8"))
    signals = {
        "the measured output": _records()[0][1],
        "the one-step prediction": as_vector("y_hat", ask.known("y_hat"), 1000),
        "the simulation": as_vector("y_sim", ask.known("y_sim"), 1000),
    }
    curves = [_curve(axes, what, signal) for what, signal in signals.items()]
    require_label(axes, "Fig. 8", "x", "")
    require_label(axes, "Fig. 8", "y", "")
    require_legend(axes, "Fig. 8", 3)
    _, of_prediction, of_simulation = (plain_text(legend_text(axes, curve)).lower() for curve in curves)
    if "simul" in of_prediction or "free" in of_prediction or "predict" in of_simulation:
        return Verdict(False, "The legend of Fig. 8 has prediction and simulation swapped.", "legend entries swapped")
    return Verdict(True, "one follows the measurement, the other goes its own way.")


def _curve(axes: AxesValue, what: str, signal: FloatArray) -> CurveValue:
    """The curve that shows the beginning of a signal."""
    for curve in axes.curves:
        n = curve.y.size
        if 50 <= n <= signal.size and np.allclose(curve.y, signal[:n], rtol=1e-6, atol=1e-6):
            if n > 300:
                raise NoAnswer(
                    "Fig. 8 shows so many samples that the curves cover each other: draw the first 100.",
                    "too many samples",
                )
            return curve
    (u_1, _), (u_2, y_2) = _records()
    for name, other, of in (("y_2", y_2, "System 2"), ("u_1", u_1, "the input"), ("u_2", u_2, "the input of System 2")):
        if any(50 <= curve.y.size <= other.size and _EXACT(curve.y, other[: curve.y.size]) for curve in axes.curves):
            raise NoAnswer(
                f"In Fig. 8 no curve shows {what}, and one shows `{name}`, {of}: the figure is of the output of "
                "System 1.",
                "another record drawn",
            )
    raise no_curve(axes, "Fig. 8", what, signal[:100], "Draw its first 100 samples.")
