"""Checks of the choice of an order: losses on the same rows, and what a parameter costs."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_vector
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.regressions import LEFT_SIDE, WRAPS, wrapped
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel, Structure, build_equations, fit_structure

_NOTHING = 1e-15
"""Of the mean square of y: what rounding leaves of errors that are zero."""


@first_failure
def check_order(ask: Ask) -> Iterator[Verdict]:
    """`losses(u, y, orders)` and `criteria(V, N, p)`."""
    a, b = np.array([1, -1.2, 0.5]), np.array([1, 0.5])
    model = PolynomialModel(a * [1, *ask.rng.uniform(0.9, 1.1, 2)], b * ask.rng.uniform(0.8, 1.2, 2), np.ones(1))
    for orders in ((1, 2, 3, 4), (2, 5)):
        samples = int(ask.rng.integers(50, 80))
        u, e = ask.rng.uniform(-2, 2, samples), ask.rng.standard_normal(samples)
        yield _judge_losses(ask, u, free_run(model, u, e), orders)
    for N in (int(ask.rng.integers(30, 60)), int(ask.rng.integers(200, 400))):
        p = np.sort(ask.rng.permutation(np.arange(2.0, 12))[:4])
        yield _judge_criteria(ask, np.sort(ask.rng.uniform(0.3, 2.5, 4))[::-1], N, p)
    yield Verdict(True, "the same rows for all, and a price on every parameter.")


def _losses(u: FloatArray, y: FloatArray, orders: Sequence[int], starts: Sequence[int]) -> FloatArray:
    fits = [fit_structure(Structure(n, n), u, y, start=k).fit for n, k in zip(orders, starts, strict=True)]
    return np.array([np.mean(fit.residual**2) for fit in fits])


def _loss_with_constant(u: FloatArray, y: FloatArray, order: int, start: int) -> float:
    rows = build_equations(Structure(order, order), u, y, start=start)
    fit = solve_least_squares(np.column_stack([rows.Phi, np.ones(rows.Y.size)]), rows.Y)
    return float(np.mean(fit.residual**2))


def _loss(Phi: FloatArray, Y: FloatArray) -> float:
    return float(np.mean(solve_least_squares(Phi, Y).residual ** 2))


def _wrapped(u: FloatArray, y: FloatArray, n: int) -> FloatArray:
    return wrapped([(signal, lag) for signal in (-y, u) for lag in range(1, n + 1)])


def _losses_from(u: FloatArray, y: FloatArray, orders: Sequence[int], of_y: int, of_u: int) -> FloatArray:
    """The losses of rows whose lags begin with these."""
    start = max(orders) + max(of_y, of_u, 1) - 1
    made = ([(-y, of_y + i) for i in range(n)] + [(u, of_u + i) for i in range(n)] for n in orders)
    return np.array([_loss(wrapped(lags)[start:], y[start:]) for lags in made])


def _losses_beside(u: FloatArray, y: FloatArray, orders: Sequence[int], lag: int) -> FloatArray:
    """The losses of right rows with an older output beside them."""
    start = max(orders)
    return np.array([_loss(_wrapped(u, y, n)[start:], y[start - lag : y.size - lag]) for n in orders])


def _judge_losses(ask: Ask, u: FloatArray, y: FloatArray, orders: tuple[int, ...]) -> Verdict:
    call = f"losses(u, y, {list(orders)})"
    got = as_vector(call, returned(ask, "losses", u, y, np.array(orders)), len(orders))
    start, m = max(orders), len(orders)

    def common(first: int) -> FloatArray:
        return _losses(u, y, orders, [first] * m)

    right, rows = common(start), u.size - start
    if any(SAME(got, common(first)) for first in (0, start + 1, start + 2)):
        return Verdict(True, "")
    if np.max(np.abs(got)) < _NOTHING * np.mean(y**2):
        return Verdict(
            False,
            "`losses` leaves no error at all: its rows hold y(k) itself, which explains all of it. The lags of both "
            "signals are 1 to n.",
            "y(k) in its own row",
        )
    parameters = 2 * np.array(orders)
    unequal = (
        "`losses` gives each order rows of its own. Then the models explain different outputs: let all of them start "
        "at max(orders)."
    )
    return judge(
        got,
        right,
        SAME,
        "",
        f"`losses` does not return the mean squared errors of the ARX models.{_right_orders(got, right, orders)}",
        [
            Slip("rows of its own for each order", unequal, lambda: _losses(u, y, orders, orders)),
            Slip(
                "max(orders) rows left out",
                "`losses` leaves out the first max(orders) rows of each Phi, which begins at sample n already: leave "
                "out max(orders) - n.",
                lambda: _losses(u, y, orders, [n + start for n in orders]),
            ),
            Slip(
                "sum in place of the mean",
                "`losses` returns sums, each over all rows that its order has: the loss has 1/N, and all models start "
                "at max(orders).",
                lambda: _losses(u, y, orders, orders) * (u.size - np.array(orders)),
            ),
            Slip("sum in place of the mean", "`losses` returns sums: the loss has 1/N.", lambda: right * rows),
            Slip(
                "sum in place of the mean", "`losses` returns (half) sums: the loss has 1/N.", lambda: right * rows / 2
            ),
            Slip("half the loss", "`losses` has a half; the loss here has none.", lambda: right / 2),
            Slip(
                "divided by all samples",
                "`losses` divides by the number of samples; divide by the number of rows.",
                lambda: right * rows / u.size,
            ),
            Slip(
                "divided by the degrees of freedom",
                "`losses` divides by N - p. That estimates the variance of the noise; the loss has 1/N.",
                lambda: right * rows / (rows - parameters),
            ),
            Slip("root of the loss", "`losses` returns the roots of the losses.", lambda: np.sqrt(right)),
            Slip(
                "one order for all",
                "`losses` fits the same order each time: use the n of the loop.",
                lambda: np.full(m, right[-1]),
            ),
            Slip(
                "variance of y",
                "`losses` returns the mean square of y: square the errors y - Phi theta.",
                lambda: np.full(m, np.mean(y[start:] ** 2)),
            ),
            Slip(
                "a constant fitted along",
                "`losses` fits a constant with each model, through a column of ones; the ARX model has none.",
                lambda: np.array([_loss_with_constant(u, y, n, start) for n in orders]),
            ),
            Slip(
                WRAPS,
                "`losses` takes samples from the *end* of the record for those before its first, as `np.roll` does: "
                "begin all rows at max(orders).",
                lambda: np.array([_loss(_wrapped(u, y, n), y) for n in orders]),
            ),
            *(
                Slip(
                    "lag off by one",
                    f"`losses` begins {what}: the lags of both signals are 1 to n.",
                    partial(_losses_from, u, y, orders, *lags),
                )
                for what, *lags in (
                    ("the inputs with u(k)", 1, 0),
                    ("the inputs with u(k-2)", 1, 2),
                    ("the outputs with y(k-2)", 2, 1),
                )
            ),
            *(
                Slip(
                    LEFT_SIDE,
                    f"`losses` has y(k-{lag}) on the left-hand side of the row of y(k): Y is `y[start:]`, with start = "
                    "max(orders).",
                    partial(_losses_beside, u, y, orders, lag),
                )
                for lag in dict.fromkeys((1, start))
            ),
            Slip(
                "rows cut at the wrong end",
                "`losses` leaves out rows at the *end*: the model of order n begins at sample n, and explains other "
                "outputs. Leave out the first max(orders) - n rows of each.",
                lambda: np.array([_loss(_wrapped(u, y, n)[n : n + rows], y[n : n + rows]) for n in orders]),
            ),
            *(
                Slip(
                    "orders not used",
                    f"`losses` fits the orders {', '.join(map(str, others))}, and asked for are "
                    f"{', '.join(map(str, orders))}: take n from `orders`.",
                    partial(_losses, u, y, others, [first] * m),
                )
                for others in (tuple(range(1, m + 1)), tuple(range(m, 0, -1)))
                if others != orders
                for first in (start, m)
            ),
            Slip(
                "u and y swapped",
                "`losses` has u and y swapped: the output is what is explained.",
                lambda: _losses(y, u, orders, [start] * m),
            ),
        ],
    )


def _right_orders(got: FloatArray, right: FloatArray, orders: tuple[int, ...]) -> str:
    """For which orders the losses are right, where some are; else that one order is to be tried."""
    are_right = np.abs(got - right) <= _SAME_LOSS * right
    if not are_right.any():
        return f" Try one order, `losses(u, y, [{orders[0]}])`."
    good, bad = (
        ", ".join(str(n) for n, it in zip(orders, are_right, strict=True) if it == wanted) for wanted in (True, False)
    )
    return f" It is right for n = {good}, and not for n = {bad}, with the orders {list(orders)}: print start and rows."


_SAME_LOSS = 1e-6


def _prices(N: int, p: FloatArray) -> list[tuple[str, FloatArray]]:
    """Prices of p parameters that may be taken for the right ones, with their formulas."""
    ln_N = np.log(N)
    return [
        ("p", p),
        ("2p", 2 * p),
        ("4p", 4 * p),
        ("p ln N", p * ln_N),
        ("2p ln N", 2 * p * ln_N),
        ("p/2 ln N", p / 2 * ln_N),
        ("ln N", np.full(p.size, ln_N)),
        ("N ln p", N * np.log(p)),
        ("ln p", np.log(p)),
    ]


@first_failure
def _judge_criteria(ask: Ask, V: FloatArray, N: int, p: FloatArray) -> Iterator[Verdict]:
    parts = returned_parts(ask, "criteria", "three things, AIC, BIC and FPE", 3, V, N, p)
    log_loss, fpe = N * np.log(V), V * (1 + p / N) / (1 - p / N)
    right = {"AIC": log_loss + 2 * p, "BIC": log_loss + p * np.log(N), "FPE": fpe}
    got = {name: as_vector(f"{name} of criteria(V, N, p)", part, 4) for name, part in zip(right, parts, strict=True)}
    if SAME(got["AIC"], right["BIC"]) and SAME(got["BIC"], right["AIC"]):
        yield Verdict(False, "`criteria` returns BIC before AIC.", "AIC and BIC swapped")
    ten = "`criteria` takes the logarithm to base 10: ln is `np.log`."
    prices = {"AIC": 2 * p, "BIC": p * np.log(N)}
    for name, price in prices.items():
        scale = partial(np.add, log_loss / N)
        slips: list[Slip[FloatArray]] = [
            Slip("logarithm to base 10", ten, partial(np.add, N * np.log10(V), price)),
            Slip("logarithm to base 10", ten, partial(np.add, N * np.log10(V), p * np.log10(N))),
            Slip("logarithm to base 10", ten, partial(np.add, log_loss, p * np.log10(N))),
            Slip("N forgotten", f"{name} of `criteria` has N ln V, not ln V, before its price.", partial(scale, price)),
            Slip("no logarithm", f"{name} of `criteria` takes V itself: it is N ln V.", partial(np.add, N * V, price)),
            Slip(
                "price with the wrong sign",
                f"{name} of `criteria` rewards parameters: the price is *added*.",
                partial(np.subtract, log_loss, price),
            ),
            Slip(
                "price for small samples",
                f"{name} adds 2p(p + 1)/(N - p - 1), the correction for small samples (AICc): the formula of step 8 "
                "does without it.",
                partial(np.add, log_loss, price + 2 * p * (p + 1) / (N - p - 1)),
            ),
            Slip("price of a parameter", f"{name} has no price on parameters.", partial(np.copy, log_loss)),
            *(
                Slip(
                    "price of a parameter",
                    f"the price in {name} is {words}: hold it against the formula of step 8.",
                    partial(np.add, log_loss, wrong),
                )
                for words, wrong in _prices(N, p)
            ),
        ]
        yield judge(got[name], right[name], SAME, "", f"{name} of `criteria` is not right: work the example.", slips)
    yield judge(
        got["FPE"],
        fpe,
        SAME,
        "",
        "FPE of `criteria` is not right: work the example by hand.",
        [
            Slip("FPE upside down", "FPE has (1 + p/N) above and (1 - p/N) below.", lambda: V**2 / fpe),
            *(
                Slip(
                    "brackets forgotten",
                    "FPE lacks brackets: 1 + p/N and 1 - p/N each need a pair of their own, as `*` and `/` come first.",
                    partial(np.copy, wrong),
                )
                for wrong in (V, V * (1 + p / N) - p / N, V + p / N / (1 - p / N), V * (1 + p / N) / 1 - p / N)
            ),
            Slip("half of FPE", "FPE has two factors, one above and one below.", lambda: V * (1 + p / N)),
            Slip("half of FPE", "FPE has two factors, one above and one below.", lambda: V / (1 - p / N)),
            Slip("half of FPE", "FPE multiplies the loss V itself.", lambda: fpe / V),
        ],
    )
