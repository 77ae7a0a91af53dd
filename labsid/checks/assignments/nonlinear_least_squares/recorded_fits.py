"""Checks of the last two fits: a recorded step response with its standard errors, and output error."""

from collections.abc import Iterator
from functools import cache, partial

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.assignments.nonlinear_least_squares.estimates import (
    SQUARED,
    as_estimate,
    fit_of_squares,
    within,
)
from labsid.checks.compare import as_vector, close
from labsid.checks.double_mistakes import TWO
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.regressions import WRAPS
from labsid.checks.trials import first_order
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.lab.step_response import FirstOrderDelay, first_order_response
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel, Structure, fit_structure
from labsid.nonlinear.solve import NonlinearFit, levenberg_marquardt


@first_failure
def check_step(ask: Ask) -> Iterator[Verdict]:
    """`fit_step(t, y, amplitude)`, which returns theta = [y0, K, tau] and its standard errors."""
    for amplitude, gain in ((-0.4, 2.5), (2.0, 0.8)):
        tau = ask.rng.uniform(6, 10)
        t: FloatArray = ask.rng.uniform(0.4, 0.6) * np.arange(ask.rng.integers(80, 110), dtype=np.float64)
        truth = np.array([ask.rng.uniform(1, 3), gain * ask.rng.uniform(0.8, 1.2), tau])
        y: FloatArray = _step(t, truth, amplitude) + 0.05 * ask.rng.standard_normal(t.size)
        fit = _fit_of_step(t, y, amplitude, truth)
        yield _judge_step(ask, t, y, amplitude, fit)


def _fit_of_step(t: FloatArray, y: FloatArray, amplitude: float, start: FloatArray) -> NonlinearFit:
    return levenberg_marquardt(
        lambda theta: _step(t, theta, amplitude), lambda theta: _step_jacobian(t, theta, amplitude), y, start
    )


def _fit_from_first(t: FloatArray, y: FloatArray, amplitude: float, start: FloatArray) -> FloatArray:
    """theta with y0 fixed at the first sample."""

    def whole(two: FloatArray) -> FloatArray:
        return np.concatenate([y[:1], two])

    fit = levenberg_marquardt(
        lambda two: _step(t, whole(two), amplitude),
        lambda two: _step_jacobian(t, whole(two), amplitude)[:, 1:],
        y,
        start[1:],
    )
    return whole(fit.theta)


def _step(t: FloatArray, theta: FloatArray, amplitude: float) -> FloatArray:
    y0, K, tau = (float(number) for number in theta)
    return y0 + first_order_response(FirstOrderDelay(K, tau, 0.0), t, amplitude)


def _step_jacobian(t: FloatArray, theta: FloatArray, amplitude: float) -> FloatArray:
    _, K, tau = theta
    left = np.exp(-t / tau)
    return np.column_stack([np.ones(t.size), amplitude * (1 - left), -amplitude * K * t / tau**2 * left])


@first_failure
def _judge_step(ask: Ask, t: FloatArray, y: FloatArray, amplitude: float, fit: NonlinearFit) -> Iterator[Verdict]:
    parts = returned_parts(ask, "fit_step", "theta and its standard errors", 2, t, y, amplitude)
    right, n, p = fit.theta, y.size, 3
    gain = "`fit_step` leaves the amplitude out: K is the change of y over the size of the step."
    got = as_estimate("theta of fit_step(t, y, amplitude)", parts[0], 3)
    with np.errstate(all="ignore"):
        e = y - (got[0] + amplitude * got[1] * (1 - np.exp(-t / got[2])))
    yield judge(
        got,
        right,
        within(fit.stderr),
        "",
        f"theta of `fit_step` is not the [y0, K, tau] with the smallest SSE: with yours it is {e @ e:.4g}, and "
        f"{fit.sse:.4g} is possible.",
        [
            Slip("amplitude not used", gain, lambda: right * [1, amplitude, 1]),
            Slip(
                "rate for time constant",
                "the third parameter of `fit_step` is a rate: tau is its inverse, in seconds.",
                lambda: np.array([right[0], right[1], 1 / right[2]]),
            ),
            Slip("amplitude not used", gain, lambda: np.array([right[0], right[1] * amplitude, 1 / right[2]])),
            Slip(
                "order of theta",
                "theta of `fit_step` is in another order than [y0, K, tau].",
                lambda: right[[1, 2, 0]],
            ),
            Slip("order of theta", "theta of `fit_step` is in another order than [y0, K, tau].", lambda: right[::-1]),
            Slip(
                "y0 fixed",
                "`fit_step` keeps y0 at the first sample, with its noise: y0 is the first of the three parameters.",
                lambda: _fit_from_first(t, y, amplitude, right),
            ),
            Slip(
                "squares handed over",
                f"`fit_step` {SQUARED}",
                lambda: fit_of_squares(
                    lambda theta: _step(t, theta, amplitude),
                    lambda theta: _step_jacobian(t, theta, amplitude),
                    y,
                    right,
                ),
            ),
            Slip(
                "final level for the gain",
                "K of `fit_step` is the final level: the gain is the *change* of y over the size of the step.",
                lambda: np.array([right[0], right[0] + amplitude * right[1], right[2]]),
            ),
        ],
    )
    spread = fit.stderr
    J = _step_jacobian(t, right, amplitude)
    if np.shape(parts[1]) == (p, p) and close(3e-3)(np.diag(np.asarray(parts[1])), spread**2):  # type: ignore[arg-type]
        yield Verdict(
            False,
            "`fit_step` returns the covariance: the standard errors are the roots of its diagonal.",
            "variance for standard error",
        )
    yield judge(
        as_vector("standard errors of fit_step(t, y, amplitude)", parts[1], 3),
        spread,
        close(3e-3),
        "each parameter, and how far it is to be trusted.",
        "the standard errors of `fit_step` are wrong: go through s^2, (J'J)^-1, the diagonal and the roots one by one.",
        [
            Slip(
                "half the SSE",
                "the standard errors of `fit_step` are too small by the root of two: `cost` of scipy is *half* the "
                "SSE (or J'J, which has no factor, is taken twice).",
                lambda: spread / np.sqrt(2),
            ),
            *(
                Slip(
                    "divided by n",
                    f"`fit_step` divides the SSE by n - {fewer} for s^2{as_var}.",
                    partial(np.multiply, spread, np.sqrt((n - p) / (n - fewer))),
                    mend="Three parameters have been fitted to it: divide by n - 3.",
                )
                for fewer, as_var in ((1, ", as `np.var` does with `ddof=1`"), (2, ""))
            ),
            Slip(
                "divided by n",
                "`fit_step` divides the SSE by n for s^2.",
                lambda: spread * np.sqrt((n - p) / n),
                mend="Three parameters have been fitted to it: divide by n - 3.",
            ),
            Slip(
                "half the SSE",
                "`fit_step` takes half the SSE (scipy's `cost`), and divides it by n in place of n - 3.",
                lambda: spread * np.sqrt((n - p) / n / 2),
            ),
            Slip(
                "variance for standard error",
                "`fit_step` returns the variances: take their roots.",
                lambda: spread**2,
            ),
            Slip(
                "s^2 forgotten",
                "`fit_step` leaves s^2 out: the covariance is s^2 times the inverse of J'J.",
                lambda: spread / np.sqrt(fit.sse / (n - p)),
            ),
            Slip(
                "s for s^2",
                "`fit_step` multiplies the inverse of J'J by s; it takes s^2.",
                lambda: spread / (fit.sse / (n - p)) ** 0.25,
            ),
            Slip(
                "diagonal inverted alone",
                "`fit_step` inverts the diagonal of J'J: invert the matrix first, then take its diagonal. What the "
                "parameters have in common is lost otherwise.",
                lambda: np.sqrt(fit.sse / (n - p) / np.diag(J.T @ J)),
            ),
            *(
                Slip(
                    "interval",
                    "`fit_step` returns half widths of intervals: return the errors.",
                    partial(np.multiply, spread, wide),
                )
                for wide in (1.96, 2.0)
            ),
            Slip("relative", "`fit_step` returns relative errors: do not divide by theta.", lambda: spread / right),
            Slip(
                "relative", "`fit_step` returns relative errors: do not divide by theta.", lambda: spread / abs(right)
            ),
        ],
    )


@first_failure
def check_output_error(ask: Ask) -> Iterator[Verdict]:
    """`fit_output_error(u, y)`, which returns [a, b] of ``x(t) + a x(t-1) = b u(t-1)``, ``y = x + e``."""
    for samples in (150, int(ask.rng.integers(120, 180))):
        truth = np.array([-ask.rng.uniform(0.6, 0.9), ask.rng.uniform(0.7, 1.5)])
        u = ask.rng.uniform(-2, 2, samples)
        y = _run(truth, u) + 0.7 * ask.rng.standard_normal(samples)
        y[0] = ask.rng.uniform(1, 2)  # so that a run that begins from the measured y(0) is told from one from rest
        fit = _fit_of_run(u, y, truth)
        yield _judge_output_error(ask, u, y, fit)


def _fit_of_run(u: FloatArray, y: FloatArray, start: ArrayLike, delay: int = 1) -> NonlinearFit:
    return levenberg_marquardt(
        lambda theta: _run(theta, u, delay), lambda theta: _run_jacobian(theta, u, delay), y, start
    )


def _run(theta: FloatArray, u: FloatArray, delay: int = 1) -> FloatArray:
    a, b = theta
    return free_run(first_order(a, b, delay=delay), u)


def _run_jacobian(theta: FloatArray, u: FloatArray, delay: int = 1) -> FloatArray:
    a, _ = theta
    x = _run(theta, u, delay)
    # x(t) + a x(t-1) = b u(t-1), differentiated with respect to a: the same filter runs on -x(t-1)
    return np.column_stack([_run(np.array([a, -1.0]), x), _run(np.array([a, 1.0]), u, delay)])


def _judge_output_error(ask: Ask, u: FloatArray, y: FloatArray, fit: NonlinearFit) -> Verdict:
    right = fit.theta
    one_step = (
        "`fit_output_error` is the one-step fit: its regressor holds measured, noisy outputs, and a comes out too near "
        "to zero. Let the model run on u alone and compare *that* with y."
    )

    def from_first() -> FloatArray:
        impulse = np.zeros(u.size)
        impulse[0] = y[0]

        def run(theta: FloatArray) -> FloatArray:
            return _run(theta, u) + free_run(
                PolynomialModel(np.array([1.0, theta[0]]), np.array([1.0]), np.array([1.0]), 0), impulse
            )

        def slope(theta: FloatArray) -> FloatArray:
            x = run(theta)
            return np.column_stack([_run(np.array([theta[0], -1.0]), x), _run(np.array([theta[0], 1.0]), u)])

        return levenberg_marquardt(run, slope, y, right).theta

    def arx(start: int) -> FloatArray:
        return fit_structure(Structure(1, 1), u, y, start=start).model.theta[:2]

    @cache
    def fit_with(start: float, delay: int) -> FloatArray:
        return _fit_of_run(u, y, [start, 0.1], delay).theta

    def times(start: float, delay: int, sign: float, order: int) -> FloatArray:
        return (fit_with(start, delay) * [sign, 1.0])[::order]

    def of_part(samples: int, sign: float) -> FloatArray:
        return _fit_of_run(u[:samples], y[:samples], right).theta * [sign, 1.0]

    code = code_of(ask, "fit_output_error")
    written = {int(number) for number in (code.numbers if code else (50, 100)) if number == int(number)}
    parts = [number for number in sorted(written | {u.size // 2}) if _SHORTEST <= number < u.size]
    slips: list[Slip[FloatArray]] = [
        *(
            Slip(
                TWO if sign < 0 else "a part of the record",
                f"`fit_output_error` fits the first {samples} of {u.size} samples: all of them count."
                f"{' And a has the other sign: it stands on the left side, x(t) + a x(t-1).' if sign < 0 else ''}",
                partial(of_part, samples, sign),
            )
            for samples in parts
            for sign in (1.0, -1.0)
        ),
        Slip("one-step fit", one_step, lambda: arx(1)),
        Slip("one-step fit", one_step, lambda: arx(1) * [-1, 1]),
        Slip("one-step fit", one_step, lambda: arx(2)),
        Slip("one-step fit", one_step, lambda: arx(0)),
        Slip(
            "sign of a",
            "`fit_output_error` has the other sign of a: it stands on the left side, x(t) + a x(t-1) = b u(t-1).",
            lambda: right * [-1, 1],
        ),
        Slip("a and b swapped", "`fit_output_error` returns b before a.", lambda: right[::-1]),
        Slip(
            "lag off by one",
            "`fit_output_error` lets u(t) act at once; in this model x(t) answers u(t-1).",
            lambda: fit_with(right[0], 0),
        ),
        Slip(
            "lag off by one",
            "`fit_output_error` lets u act one sample too late: x(t) answers u(t-1).",
            lambda: fit_with(right[0], 2),
        ),
        *(
            Slip(
                TWO,
                f"`fit_output_error` has two mistakes: u acts {when}, and x(t) answers u(t-1); {other}.",
                partial(times, start, delay, sign, order),
            )
            for delay, start, when in (
                (0, right[0], "at once"),
                (0, -right[0], "at once"),  # without the delay the SSE has two valleys
                (2, right[0], "one sample too late"),
            )
            for sign, order, other in (
                (-1.0, 1, "a has the other sign: it stands on the left side, x(t) + a x(t-1)"),
                (1.0, -1, "b is returned before a"),
            )
        ),
        Slip(
            TWO,
            "`fit_output_error` has two mistakes: a has the other sign; b is returned before a.",
            lambda: (right * [-1, 1])[::-1],
        ),
        Slip(
            WRAPS,
            "the run of `fit_output_error` takes the last input for the one before the first: with k = 0, u[k-1] is "
            "u[-1]. Begin with k = 1, x(0) = 0.",
            lambda: _fit_of_run(np.roll(u, 1), y, right, 0).theta,
        ),
        Slip(
            "squares handed over",
            f"`fit_output_error` {SQUARED}",
            lambda: fit_of_squares(lambda theta: _run(theta, u), lambda theta: _run_jacobian(theta, u), y, right),
        ),
        Slip(
            "run begins at the measured output",
            "the run of `fit_output_error` begins at y(0), which is noisy. The system begins at rest: x(0) = 0.",
            from_first,
        ),
    ]
    got = as_estimate("fit_output_error(u, y)", returned(ask, "fit_output_error", u, y), 2)
    return judge(
        got,
        right,
        within(fit.stderr),
        "the model whose own run is nearest to the record.",
        "`fit_output_error` does not return the [a, b] whose run on u alone is nearest to y. The SSE of the run with "
        f"yours is {_sse_of_run(got, u, y):.4g}, and {fit.sse:.4g} is possible.",
        slips,
    )


_SHORTEST = 10
"""Samples of a part of a record to which two parameters may have been fitted."""


@np.errstate(all="ignore")
def _sse_of_run(theta: FloatArray, u: FloatArray, y: FloatArray) -> float:
    """The SSE of a run, which may leave the range of numbers."""
    try:
        return float(np.sum((y - _run(theta, u)) ** 2))
    except ValueError:
        return np.inf
