"""Judging `fit_order`: a fit of any order, tried on data that it has not seen."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import nothing_returned
from labsid.checks.assignments.lab_identification.lab_data import LabData
from labsid.checks.assignments.lab_identification.phi_and_theta import rounded
from labsid.checks.compare import as_vector
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask
from labsid.checks.regressions import slips_of_fit
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, judge
from labsid.lab.arx import arx_from_theta, fit_arx
from labsid.lab.regressor import build_phi
from labsid.lab.simulation import simulate
from labsid.least_squares.solve import solve_least_squares

ORDERS = (1, 2, 3)
TRIAL_SAMPLES = (60, 200, 120)
"""Samples of the trials without noise; those with noise are longer than the first half of the record."""
TRIAL_NOISE = 0.01
LATEST_START = 12
EXACT_WITHIN = 1e-5
"""Of the largest parameter, on data without noise: the normal equations square the condition number."""
SAME_FIT = 1e-6


def judge_fit_order(ask: Ask, data: LabData) -> Verdict:
    """Judge ``fit_order(u, y, n)`` on data of systems of several orders, without and with noise.

    Without noise every right fit finds the system, wherever its rows start; with noise it is the least-squares fit from
    one of the sensible first rows.
    """
    for noise in (0.0, TRIAL_NOISE):
        for n, samples in zip(ORDERS, TRIAL_SAMPLES, strict=True):
            theta, u, y = _trial(ask.rng, n, data.Ts, samples + (data.half if noise else 0))
            y = y + noise * ask.rng.standard_normal(y.size)
            got = _fitted(ask, u, y, n)
            if noise == 0 and _close(got, theta, EXACT_WITHIN):
                continue
            if noise and any(_close(got, fit, SAME_FIT) for fit in _fits(u, y, n, data.Ts)):
                continue
            otherwise = (
                f"For n = {n} it does not return the least-squares theta of eq. (8). Try it against your `theta_1`."
            )
            if noise:
                otherwise = (
                    f"For n = {n} it finds a system without noise, but with noise it is not the least-squares theta."
                )
            return judge(got, theta, _alike, "", otherwise, list(_slips(u, y, n, data)))
    return Verdict(True, "It fits models of every order that was tried, on data that you have not seen.")


def judge_second_order(theta_2: Value, data: LabData) -> Verdict:
    """Judge theta_2 itself: the second-order fit to the first half, from any sensible first row."""
    got = as_vector("theta_2", theta_2, 4)
    for half in range(data.half, -(-data.y.size // 2) + 2):
        if any(_close(got, fit, SAME_FIT) for fit in _fits(data.u[:half], data.y[:half], 2, data.Ts)):
            return Verdict(True, "")
    for fit in _fits(data.u, data.y, 2, data.Ts):
        if _close(got, fit, SAME_FIT):
            return Verdict(
                False, "`theta_2` was fitted on all the data: hand in `u[:half]` and `y[:half]`.", "fit on all the data"
            )
    return Verdict(False, "`theta_2` should be `fit_order(u[:half], y[:half], 2)`, as the cell was given.")


def _fits(u: FloatArray, y: FloatArray, n: int, Ts: float) -> Iterator[FloatArray]:
    """The fits from every sensible first row, the likeliest first; the last sample may have been left out."""
    for stop in (y.size, y.size - 1):
        for start in sorted(range(LATEST_START), key=lambda k: abs(k - n)):
            yield fit_arx(u, y, Ts, n, start, stop).model.theta


def _fitted(ask: Ask, u: FloatArray, y: FloatArray, n: int) -> FloatArray:
    value = ask.call("fit_order", u, y, n)
    if value is None:
        raise nothing_returned(ask, "fit_order", "theta", "nothing returned")
    if isinstance(value, tuple) and len(value) == 4:
        raise NoAnswer(
            "`fit_order` returns all that `lstsq` does; return the first of it, `[0]`.", "all that lstsq returns"
        )
    if isinstance(value, tuple):
        raise NoAnswer(f"`fit_order` returns {len(value)} things: return theta alone.", "more than theta returned")
    got = as_vector(f"fit_order(u, y, {n})", value)
    starts = range(n, n + 3)
    if got.size == 2 * n + 1 and any(_close(got, fit, EXACT_WITHIN) for k in starts for fit in _with_ones(u, y, n, k)):
        raise NoAnswer(
            f"`fit_order(u, y, {n})` returns {got.size} parameters, one too many: it fits a constant, with a column of "
            "ones. "
            "The model has none, because the signals are offset-free.",
            "a constant fitted along",
        )
    if got.size == n and any(_close(got, _of_past_outputs(y, n, k), EXACT_WITHIN) for k in range(n, n + 3)):
        raise NoAnswer(
            f"`fit_order(u, y, {n})` uses past outputs alone: a row holds {n} past y and {n} past u.",
            "past inputs left out",
        )
    if got.size == n and any(_close(got, fit, EXACT_WITHIN) for k in starts for fit in _of_sums(u, y, n, k)):
        raise NoAnswer(
            f"A model of order {n} has {2 * n} parameters; `fit_order(u, y, {n})` returns {n}: the columns of y and of "
            "u "
            "are added. `+` joins two lists, and adds two arrays entry by entry.",
            "columns added",
        )
    if got.size != 2 * n:
        said = f"A model of order {n} has {2 * n} parameters; `fit_order(u, y, {n})` returns {got.size}"
        theta_above = ask.call("fit_order", u, y, n + 1)
        if isinstance(theta_above, np.ndarray) and theta_above.size == got.size:
            orders = [m for m in range(1, n) if np.size(ask.call("fit_order", u, y, m)) == 2 * m]  # type: ignore[arg-type]
            if orders:
                raise NoAnswer(
                    f"{said}, and so does `fit_order(u, y, {n + 1})`. It is right in number for n = "
                    f"{' and '.join(map(str, orders))} alone: for any n the columns come from a loop over the lags.",
                    "some orders only",
                )
            raise NoAnswer(f"{said}, and so does `fit_order(u, y, {n + 1})`: it does not use n.", "order fixed")
        raise NoAnswer(f"{said}: one for each of {n} past y and {n} past u is asked for.")
    return got


def _trial(rng: np.random.Generator, n: int, Ts: float, samples: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A stable system of order n, an input that excites it, and its output from rest."""
    poles = np.linspace(0.15, 0.85, n) + rng.uniform(-0.1, 0.1, n)
    b = rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.5, n)
    theta = np.concatenate([-np.poly(poles)[1:], b])
    u = np.where(rng.random(samples) < 0.5, -1.0, 1.0) * rng.uniform(0.5, 1.0, samples)
    return theta, u, simulate(arx_from_theta(theta, Ts), u)


def _slips(u: FloatArray, y: FloatArray, n: int, data: LabData) -> Iterator[Slip[FloatArray]]:
    for k in range(n + 2):
        yield from _slips_from(u, y, n, k, data)
    past = [(signal, lag) for signal in (y, u) for lag in range(1, n + 1)]
    yield from slips_of_fit("`fit_order`", past, y, u, "n")


def _slips_from(u: FloatArray, y: FloatArray, n: int, k: int, data: LabData) -> Iterator[Slip[FloatArray]]:
    """The slips of a fit whose rows start at k."""

    def order(wrong: FloatArray) -> Slip[FloatArray]:
        hint = "theta is in the wrong order: first all of y's parameters, lag 1 first, then all of u's."
        return Slip("order of theta", hint, lambda: wrong)

    def lag(hint: str, past_y: FloatArray, past_u: FloatArray) -> Slip[FloatArray]:
        return Slip("lag off by one", hint, lambda: solve_least_squares(np.hstack([past_y, past_u]), y[k:]).theta)

    def own(stop: int) -> Slip[FloatArray]:
        hint = "It fits the record whatever is handed in: use the arguments u and y, not the variables outside."
        return Slip("arguments not used", hint, lambda: fit_arx(data.u, data.y, data.Ts, n, k, stop).model.theta)

    if data.half < y.size:
        hint = "It fits only the first `half` samples of what it is given: use all samples of its arguments."
        yield Slip(
            "arguments not used", hint, lambda: fit_arx(u[: data.half], y[: data.half], data.Ts, n, k).model.theta
        )
    for half in {y.size // 2, -(-y.size // 2)}:
        hint = "It fits only the first half of what it is given: `u` and `y` are the half already, so use all of them."
        yield Slip("only half of the arguments", hint, partial(_first_part, u, y, data.Ts, n, k, half))
    right = fit_arx(u, y, data.Ts, n, k).model.theta
    yield from rounded(right, "It rounds theta: keep all digits.")
    itself = "The row for y(k) holds y(k) itself, which explains it perfectly: theta is [1, 0, ...]. Lag 1 comes first."
    yield Slip("lag off by one", itself, lambda: np.eye(2 * n)[0])
    sign = np.repeat([-1.0, 1.0], n)
    yield Slip("sign of a", "It returns [a, b]; theta is [-a, b], as eq. (8) gives it.", lambda: sign * right)
    by_signal = right.reshape(2, n)
    yield order(np.roll(right, n))
    yield order(right[::-1])
    yield order(by_signal[:, ::-1].reshape(-1))
    yield order(by_signal.T.reshape(-1))
    swapped = "The roles of u and y are swapped: the arguments come as fit_order(u, y, n), input first."
    yield Slip("u and y swapped", swapped, lambda: fit_arx(y, u, data.Ts, n, k).model.theta)
    yield own(data.half)
    yield own(data.y.size)
    Phi = build_phi(u, y, n, k).Phi
    yield Slip(
        "a constant fitted along",
        "It fits a constant with the parameters, through a column of ones. The model has none.",
        lambda: solve_least_squares(np.column_stack([Phi, np.ones(len(Phi))]), y[k:]).theta[: 2 * n],
    )
    past_y, past_u = np.hsplit(Phi, 2)
    early_u = np.column_stack([u[k:], past_u[:, :-1]])
    yield lag("The row for y(k) holds u(k); the model is strictly proper, so u(k-1) comes first.", past_y, early_u)
    if k >= 1:
        late_y, late_u = np.hsplit(build_phi(u, y, n, k - 1, y.size - 1).Phi, 2)
        yield lag("The lags of y are off by one: the row for y(k) begins with y(k-1).", late_y, past_u)
        yield lag("The lags of u are off by one: after y's, the row for y(k) has u(k-1) first.", past_y, late_u)
        yield lag("All lags are off by one: the row for y(k) begins with y(k-1).", late_y, late_u)
    yield from _pairs(u, y, n, k)


def _pairs(u: FloatArray, y: FloatArray, n: int, k: int) -> Iterator[Slip[FloatArray]]:
    """Two mistakes in a fit whose rows start at k: in its columns, and in the order and signs of what is returned."""
    past_y, past_u = np.hsplit(build_phi(u, y, n, k).Phi, 2)
    eye, ones = np.eye(2 * n), np.ones(2 * n)

    def made(
        past_y: FloatArray = past_y,
        past_u: FloatArray = past_u,
        out: FloatArray = eye,
        sign: FloatArray = ones,
    ) -> FloatArray:
        return np.asarray(out @ (sign * solve_least_squares(np.hstack([past_y, past_u]), y[k:]).theta), float)

    edits = [
        Edit(
            "past_u",
            np.column_stack([u[k:], past_u[:, :-1]]),
            "the row for y(k) begins its inputs with u(k), not u(k-1)",
        ),
        Edit("past_y", np.column_stack([y[k:], past_y[:, :-1]]), "the row for y(k) holds y(k) itself"),
        Edit("sign", np.repeat([-1.0, 1.0], n), "[a, b] is returned in place of theta, [-a, b]"),
        Edit("sign", -ones, "the signs of all parameters are turned"),
        Edit("out", np.roll(eye, n, axis=0), "b is returned before a"),
        Edit("out", eye[::-1], "theta is returned in reverse order"),
    ]
    if k >= 1:
        late_y, late_u = np.hsplit(build_phi(u, y, n, k - 1, y.size - 1).Phi, 2)
        edits += [
            Edit("past_y", late_y, "the row for y(k) begins its outputs with y(k-2), not y(k-1)"),
            Edit("past_u", late_u, "the row for y(k) begins its inputs with u(k-2), not u(k-1)"),
        ]
    yield from pairs_of("`fit_order`", edits, made)


def _with_ones(u: FloatArray, y: FloatArray, n: int, k: int) -> Iterator[FloatArray]:
    """The fits with a constant, last or first."""
    Phi = build_phi(u, y, n, k).Phi
    ones = np.ones((len(Phi), 1))
    for columns in ((Phi, ones), (ones, Phi)):
        theta = solve_least_squares(np.hstack(columns), y[k:]).theta
        yield theta
        yield theta * np.r_[[1.0] * (columns[1] is Phi), [-1.0] * n, [1.0] * n, [1.0] * (columns[0] is Phi)]


def _of_sums(u: FloatArray, y: FloatArray, n: int, k: int) -> Iterator[FloatArray]:
    """The fits with each column of y added to one of u."""
    Phi = build_phi(u, y, n, k).Phi
    for sign in (1, -1):
        yield solve_least_squares(sign * Phi[:, :n] + Phi[:, n:], y[k:]).theta


def _of_past_outputs(y: FloatArray, n: int, k: int) -> FloatArray:
    """The fit without inputs."""
    return solve_least_squares(build_phi(np.zeros_like(y), y, n, k).Phi[:, :n], y[k:]).theta


def _first_part(u: FloatArray, y: FloatArray, Ts: float, n: int, k: int, stop: int) -> FloatArray:
    return fit_arx(u, y, Ts, n, k, stop).model.theta


def _alike(a: FloatArray, b: FloatArray) -> bool:
    return _close(a, b, SAME_FIT)


def _close(a: FloatArray, b: FloatArray, within: float) -> bool:
    return a.shape == b.shape and bool(np.max(np.abs(a - b)) <= within * np.max(np.abs(b)))
