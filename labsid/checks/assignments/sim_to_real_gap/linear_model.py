"""Steps 2 and 3 of the gap: the linear model whose free run is nearest, and how far off that is."""

from collections.abc import Iterator
from functools import lru_cache, partial

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.checks.assignments.lab_identification.lab_data import known_vector
from labsid.checks.compare import SAME, as_number, as_vector, close
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask
from labsid.checks.regressions import LEFT_SIDE, slips_of_fit
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.lab.arx import arx_from_theta, fit_arx
from labsid.lab.regressor import build_phi
from labsid.lab.simulation import predict_one_step, simulate
from labsid.least_squares.solve import solve_least_squares
from labsid.records.record import Record

LATEST_START = 60
"""Latest first row of the equations, in samples: the lab's notebook allows rows from "a little later" than k = 2."""
_EXPLAINED = 0.95
"""Largest share of the sum of squares that is left by a run which explains something."""
NEAREST = 1.002
"""How much larger than the smallest a sum of squares may be: where iterations stop differs."""


def right_linear(ask: Ask) -> dict[str, Value]:
    """Step 2."""
    u, y, half = _signals(ask)
    theta = nearest_free_run(u[:half], y[:half], ask.record.Ts)
    theta_arx = fit_arx(u, y, ask.record.Ts, stop=half).model.theta
    return {"theta_arx": theta_arx, "theta_hat": theta, "y_lin": simulate(arx_from_theta(theta, ask.record.Ts), u)}


def nearest_free_run(u: FloatArray, y: FloatArray, Ts: float) -> FloatArray:
    """The theta whose free run from rest is nearest to y, searched from the lab's least squares."""
    return np.array(_search_nearest(np.asarray(u, float).tobytes(), np.asarray(y, float).tobytes(), Ts))


@lru_cache(maxsize=16)  # a record is asked about at each attempt and each later step
def _search_nearest(u_bytes: bytes, y_bytes: bytes, Ts: float) -> tuple[float, ...]:
    u, y = np.frombuffer(u_bytes), np.frombuffer(y_bytes)
    return tuple(_search_from(fit_arx(u, y, Ts).model.theta, u, y)[0].tolist())


def _search_from(start: FloatArray, u: FloatArray, y: FloatArray) -> tuple[FloatArray, float]:
    """Where a search for the nearest free run ends, and which part of the sum of squares at its start is left."""

    def errors(theta: FloatArray) -> FloatArray:
        return np.asarray(np.nan_to_num(free_run(theta, u) - y, nan=1e3, posinf=1e3, neginf=-1e3).clip(-1e3, 1e3))

    found = least_squares(errors, start, x_scale=np.maximum(np.abs(start), 0.02), xtol=1e-12)
    return found.x, 2 * found.cost / max(float(np.sum(errors(start) ** 2)), np.finfo(float).tiny)


def _is_nearest(theta: FloatArray, u: FloatArray, y: FloatArray) -> bool:
    """Whether a free run explains some of y, and none beside it is nearer."""
    with np.errstate(all="ignore"):
        explains = bool(np.sum((free_run(theta, u) - y) ** 2) < _EXPLAINED * np.sum(y**2))
    return explains and _search_from(theta, u, y)[1] > 1 / NEAREST


def free_run(theta: FloatArray, u: FloatArray) -> FloatArray:
    """A free run from rest of whatever theta, one that runs away included."""
    with np.errstate(all="ignore"):
        return np.asarray(lfilter([0.0, theta[2], theta[3]], [1.0, -theta[0], -theta[1]], u))


@first_failure
def check_linear(ask: Ask) -> Iterator[Verdict]:
    """Step 2: theta_arx, theta_hat and the free run of the latter."""
    u, y, half = _signals(ask)
    Ts = ask.record.Ts
    yield _lab_estimate(ask, u, y, half)
    theta = as_vector("theta_hat", ask.value("theta_hat"), 4)

    def sse(one: FloatArray) -> float:
        with np.errstate(all="ignore"):
            return float(np.sum((free_run(one, u[:half]) - y[:half]) ** 2))

    if not sse(theta) <= NEAREST * sse(nearest_free_run(u[:half], y[:half], Ts)):
        yield _not_nearest(theta, u, y, half, ask.record)
    model = arx_from_theta(theta, Ts)
    run = simulate(model, u)
    value = ask.value("y_lin")
    if isinstance(value, np.ndarray) and value.ndim == 2 and np.ndim(ask.known("y")) == 1:  # type: ignore[arg-type]
        raise NoAnswer(
            f"`y_lin` has shape {value.shape} and `y` is flat: numpy makes a whole table of their difference. Flatten "
            "it with `ravel()`.",
            "a column beside a flat array",
        )
    got = _output("y_lin", value, u.size)
    if SAME(got[model.order :], predict_one_step(model, u, y)[model.order :]):  # how it begins is nobody's concern
        yield Verdict(
            False,
            "`y_lin` uses measured outputs: it is the one-step prediction. A free run uses u alone.",
            "one-step prediction passed off as simulation",
        )
    yield judge(
        got,
        run,
        SAME,
        "no second-order model comes nearer on the first half: what is left is not the fit's fault.",
        "`y_lin` is not the free run of `theta_hat` on the whole of `u`, from rest.",
        [
            Slip(
                "run of the lab's estimate",
                "`y_lin` is the free run of `theta_arx`; run `theta_hat`.",
                lambda: simulate(arx_from_theta(as_vector("theta_arx", ask.value("theta_arx"), 4), Ts), u),
            ),
            Slip("input with its offset", "`y_lin` is run on `u_act`: use `u`.", lambda: simulate(model, ask.record.u)),
            Slip("not a run at all", "`y_lin` is the measured output itself.", lambda: y),
            Slip(
                "offset put back",
                "`y_lin` has the offset in it. It is compared with `y`, which has none.",
                lambda: run + as_number("y_offset", ask.known("y_offset")),
            ),
        ],
    )


def _with_constant(u: FloatArray, y: FloatArray, half: int) -> FloatArray:
    rows = build_phi(u, y, stop=half)
    return solve_least_squares(np.column_stack([rows.Phi, np.ones(rows.Y.size)]), rows.Y).theta[:-1]


def _lab_estimate(ask: Ask, u: FloatArray, y: FloatArray, half: int) -> Verdict:
    Ts = ask.record.Ts
    got = as_vector("theta_arx", ask.value("theta_arx"), 4)
    # as in the lab, the first row may be any of the first ones
    for start in range(min(LATEST_START, half // 2)):
        for stop in (half, half + 1):
            right = fit_arx(u, y, Ts, start=start, stop=stop).model.theta
            if close(1e-5)(got, right):
                return Verdict(True, "")
    right = fit_arx(u, y, Ts, stop=half).model.theta

    def others() -> Iterator[Slip[FloatArray]]:
        yield Slip(
            "fit on all the data",
            "`theta_arx` is fitted on the whole record. Its second half is held out: fit on the first.",
            lambda: fit_arx(u, y, Ts).model.theta,
        )
        yield Slip(
            "wrong half",
            "`theta_arx` is fitted on the second half, which is held out. Fit on the first.",
            lambda: fit_arx(u, y, Ts, start=half).model.theta,
        )
        yield Slip(
            "sign of a", "`theta_arx` has the other sign of a.", lambda: right * SIGNS, mend="It is [-a1, -a2, b1, b2]."
        )
        yield Slip(
            "y and u columns swapped",
            "`theta_arx` has b before a: in Phi the outputs come first.",
            lambda: right[[2, 3, 0, 1]],
        )
        yield Slip(
            "offset left in",
            "`theta_arx` is fitted on signals with their offsets. Use `u` and `y`.",
            lambda: fit_arx(ask.record.u, ask.record.y, Ts, start=2, stop=half).model.theta,
        )
        for signals, one, other in (
            ((ask.record.u, y), "u_act", "u"),
            ((u, ask.record.y), "y_act", "y"),
        ):
            for start in (2, 3):
                yield Slip(
                    "offset left in",
                    f"`theta_arx` is fitted with `{one}`, which contains the offset: use `{other}`.",
                    partial(_fit_from, *signals, Ts, start, half),
                )
        yield Slip(
            "a constant fitted along",
            "`theta_arx` was fitted with a column of ones beside Phi. The model has no constant, because the signals "
            "are offset-free.",
            lambda: _with_constant(u, y, half),
        )
        for signals in ((y[:half], u[:half]), (y, u)):
            past = [(signal, lag) for signal in signals for lag in (1, 2)]
            yield from slips_of_fit("`theta_arx`", past, *signals)
        rows = build_phi(u, y, stop=half)
        yield Slip(
            LEFT_SIDE,
            "`theta_arx` has the output with its offset on the left-hand side, Y: the rows hold `y`, without it.",
            lambda: solve_least_squares(rows.Phi, ask.record.y[2:half]).theta,
        )

    return judge(
        got,
        right,
        close(1e-5),
        "",
        "`theta_arx` is not the lab's least-squares estimate of order two on the first half: check Phi by columns.",
        list(others()),
    )


def _fit_from(u: FloatArray, y: FloatArray, Ts: float, start: int, stop: int) -> FloatArray:
    return fit_arx(u, y, Ts, start=start, stop=stop).model.theta


SIGNS = np.array([-1.0, -1.0, 1.0, 1.0])


def _not_nearest(theta: FloatArray, u: FloatArray, y: FloatArray, half: int, record: Record) -> Verdict:
    u_act, y_act, Ts = record.u, record.y, record.Ts
    span = 0.002 * float(np.std(y))

    def same(one: FloatArray, other: FloatArray) -> bool:
        with np.errstate(all="ignore"):
            return bool(np.sqrt(np.mean((free_run(one, u) - free_run(other, u)) ** 2)) < span)

    if _is_nearest(theta, y[:half], u[:half]) or _is_nearest(theta, y, u):
        return Verdict(
            False,
            "`theta_hat` makes of `y` the nearest run to `u`: they are handed to `fit` in the wrong order. It takes "
            "the input before the output, `fit(model, q0, u, y)`.",
            "u and y swapped",
        )
    slips = [
        Slip(
            "the one-step fit",
            "`theta_hat` is still the lab's estimate: let `fit` move it until the *free run* is nearest.",
            lambda: fit_arx(u, y, Ts, stop=half).model.theta,
        ),
        Slip(
            "fit on all the data",
            "`theta_hat` is fitted on the whole record: hand `fit` the first half of both signals.",
            lambda: nearest_free_run(u, y, Ts),
        ),
        Slip(
            "sign of a",
            "`theta_hat` has the other sign of a.",
            lambda: nearest_free_run(u[:half], y[:half], Ts) * SIGNS,
            mend="It is [-a1, -a2, b1, b2], as `free_run` takes it.",
        ),
        Slip(
            "wrong half",
            "`theta_hat` is fitted on the second half, which is held out.",
            lambda: nearest_free_run(u[half:], y[half:], Ts),
        ),
        Slip(
            "offset left in",
            "`theta_hat` is fitted on signals with their offsets: hand `fit` the first halves of `u` and `y`.",
            lambda: nearest_free_run(u_act[:half], y_act[:half], Ts),
        ),
    ]
    nearest = nearest_free_run(u[:half], y[:half], Ts)
    with np.errstate(all="ignore"):
        mse, least = (float(np.mean((y - free_run(candidate, u))[:half] ** 2)) for candidate in (theta, nearest))
    return judge(
        theta,
        nearest,
        same,
        "",
        "The free run of `theta_hat` is not the nearest one to the first half: its mean squared error there is "
        f"{mse:.4g}, and {least:.4g} is possible.",
        slips,
    )


def right_size(ask: Ask) -> dict[str, Value]:
    """Step 3."""
    e, half = known_error(ask)
    return {"gap_before": float(np.sqrt(np.mean(e[half:] ** 2)))}


def check_size(ask: Ask) -> Verdict:
    """Step 3: the root-mean-square error of the linear model on the held-out half."""
    e, half = known_error(ask)
    held_out = e[half:]
    right = float(np.sqrt(np.mean(held_out**2)))
    return judge(
        as_number("gap_before", ask.value("gap_before")),
        right,
        close(1e-4),
        "the gap of the linear model, on samples that no fit has seen.",
        "`gap_before` is not the root-mean-square error of `y_lin` on the held-out half.",
        [
            Slip(
                "error over the whole record",
                "`gap_before` is taken over the whole record. Only the held-out half counts, `e[half:]`.",
                lambda: float(np.sqrt(np.mean(e**2))),
            ),
            Slip(
                "error on the fitted half",
                "`gap_before` is taken over the half that was fitted. Use the other one, `e[half:]`.",
                lambda: float(np.sqrt(np.mean(e[:half] ** 2))),
            ),
            Slip(
                "offset left in",
                "`gap_before` compares `y_act`, with its offset, and `y_lin`, without: use `e`.",
                lambda: float(np.sqrt(np.mean((held_out + as_number("y_offset", ask.known("y_offset"))) ** 2))),
            ),
            Slip(
                "divided by all samples",
                "`gap_before` divides by N; the held-out half has N - N/2 samples.",
                lambda: right * float(np.sqrt(held_out.size / e.size)),
            ),
            Slip("no root", "`gap_before` is the mean squared error: take its root.", lambda: right**2),
            *(
                Slip(
                    "noise taken off",
                    "`gap_before` has the noise subtracted. Here the whole error counts; the noise is taken "
                    "off in step 9.",
                    partial(_without_noise, right, ask, squared),
                )
                for squared in (True, False)
            ),
            Slip(
                "largest error",
                "`gap_before` is the largest error: take the root of the mean square.",
                lambda: float(np.max(np.abs(held_out))),
            ),
            Slip(
                "mean of the errors",
                "`gap_before` is the mean of the errors, which cancel: square them first.",
                lambda: float(np.mean(held_out)),
            ),
            Slip(
                "sum for mean",
                "`gap_before` is a root of the *sum*: it would grow with the length. Take the mean.",
                lambda: float(np.sqrt(np.sum(held_out**2))),
            ),
            Slip(
                "absolute error",
                "`gap_before` is the mean absolute error; square, average, then take the root.",
                lambda: float(np.mean(np.abs(held_out))),
            ),
            Slip(
                "mean taken out",
                "`gap_before` is a standard deviation: it leaves out the mean error, which is an error too.",
                lambda: float(np.std(held_out)),
            ),
            *pairs_of("`gap_before`", _edits_of_size(e, half), partial(_size_of, held_out)),
        ],
    )


def _edits_of_size(e: FloatArray, half: int) -> tuple[Edit, ...]:
    """Single mistakes in what is averaged, and in what is made of it."""
    return (
        Edit("errors", e, "the whole record is taken, and not the held-out half"),
        Edit("errors", e[:half], "the half that was fitted is taken, and not the held-out one"),
        Edit("of", "square", "the root is missing"),
        Edit("of", "sum", "the squares are summed, and not averaged"),
        Edit("of", "root of the sum", "the root is that of the sum, and not of the mean"),
        Edit("of", "size", "absolute errors are averaged, and not squares"),
        Edit("of", "mean", "the errors are averaged, in which they cancel"),
        Edit("of", "spread", "the mean error is taken off, as a standard deviation does"),
        Edit("of", "largest", "the largest error is taken"),
    )


def _size_of(held_out: FloatArray, errors: FloatArray | None = None, of: str = "") -> float:
    """The size of errors, or what may be taken for it."""
    e = held_out if errors is None else errors
    sizes = {
        "": np.sqrt(np.mean(e**2)),
        "square": np.mean(e**2),
        "sum": np.sum(e**2),
        "root of the sum": np.sqrt(np.sum(e**2)),
        "size": np.mean(np.abs(e)),
        "mean": np.mean(e),
        "spread": np.std(e),
        "largest": np.max(np.abs(e)),
    }
    return float(sizes[of])


def _without_noise(gap: float, ask: Ask, squared: bool) -> float:
    noise = as_number("noise_sd", ask.known("noise_sd"))
    return float(np.sqrt(gap**2 - noise**2)) if squared else gap - noise


def known_error(ask: Ask) -> tuple[FloatArray, int]:
    """The error of the linear model, and the first held-out sample."""
    y = known_vector(ask, "y")
    return y - known_vector(ask, "y_lin"), y.size // 2


def _signals(ask: Ask) -> tuple[FloatArray, FloatArray, int]:
    u, y = known_vector(ask, "u"), known_vector(ask, "y")
    return u, y, y.size // 2


def _output(name: str, value: Value, samples: int) -> FloatArray:
    got = as_vector(name, value)
    if got.size in (samples // 2, samples - samples // 2):
        raise NoAnswer(f"`{name}` covers half the record. Run the model over the whole input.", "half the record")
    return as_vector(name, value, samples)
