"""Check of the fit in a closed loop, with the reference as instrument."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_theta
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.parts_of_a_solution import require_whole_solution
from labsid.checks.question import Ask, returned
from labsid.checks.regressions import LEFT_SIDE, WRAPS, wrapped
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.estimation.instrumental import instrumental_variables
from labsid.lab.regressor import build_phi
from labsid.least_squares.solve import solve_least_squares

_START = 2
_CALL = "fit_with_reference(u, y, r)"


@first_failure
def check_reference(ask: Ask) -> Iterator[Verdict]:
    """`fit_with_reference(u, y, r)`, in two loops with slow disturbances."""
    for gain in (1.0, 2.0):
        yield _judge_fit(ask, *_loop(ask.rng, gain))
    yield Verdict(True, "instruments that nobody made from the disturbance.")


def _loop(rng: np.random.Generator, gain: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Input, output and reference of a first-order rig in a proportional loop."""
    samples, a, b = int(rng.integers(150, 170)), -rng.uniform(0.7, 0.9), rng.uniform(0.2, 0.3)
    r, e = rng.uniform(-2, 2, samples), 0.5 * rng.standard_normal(samples)
    u, y, v = np.zeros(samples), np.zeros(samples), 0.0
    for k in range(samples):
        v = 0.8 * v + e[k]
        y[k] = (b * u[k - 1] - a * y[k - 1] if k else 0.0) + v
        u[k] = gain * (r[k] - y[k])
    return u, y, r


def _past(x: FloatArray, lags: tuple[int, ...]) -> FloatArray:
    """The columns x(k - lag) of the rows k = 2, ..., N - 1."""
    return np.column_stack([x[_START - lag : len(x) - lag] for lag in lags])


def _reference(lag: int) -> str:
    return f"r(k-{lag})" if lag else "r(k)"


def _by_lags(r: FloatArray, Phi: FloatArray, Y: FloatArray, lags: tuple[int, int]) -> FloatArray:
    """The estimate with references of these lags, from the first row that has them."""
    more = max(0, max(lags) - _START)
    Z = np.column_stack([r[_START + more - lag : len(r) - lag] for lag in lags])
    return instrumental_variables(Z, Phi[more:], Y[more:]).theta


def _judge_fit(ask: Ask, u: FloatArray, y: FloatArray, r: FloatArray) -> Verdict:
    value = returned(ask, "fit_with_reference", u, y, r)
    rows = build_phi(u, y, 1, _START)
    Phi, Y = rows.Phi, rows.Y
    Z = _past(r, (1, 2))
    require_whole_solution(_CALL, value, Z.T @ Phi, Z.T @ Y, ("Z'Phi", "Z'Y"), Z.T)
    got = as_theta(_CALL, value, 2)

    def by(Z: FloatArray, Phi: FloatArray = Phi) -> FloatArray:
        return instrumental_variables(Z, Phi, Y).theta

    right = by(Z)
    loop = "Both are in the loop and hold past disturbances; the reference does not."
    return judge(
        got,
        right,
        SAME,
        "",
        f"`{_CALL}` does not solve Z'Phi theta = Z'Y. Write z(2), phi(2) and y(2) down by hand.",
        [
            *(
                Slip(
                    "least squares",
                    f"`{_CALL}` is least squares, biased by the disturbance. Multiply by Z', not by Phi'.",
                    partial(_least_squares, u, y, start),
                )
                for start in (1, _START)
            ),
            Slip(
                "past inputs as instruments",
                f"`{_CALL}` takes past inputs for instruments. In a loop they hold the controller's answer to past "
                "disturbances.",
                lambda: by(_past(u, (1, 2))),
            ),
            Slip(
                "past outputs as instruments",
                f"`{_CALL}` takes past outputs or inputs for instruments. {loop}",
                lambda: by(_past(y, (1, 2))),
            ),
            Slip(
                "past outputs as instruments",
                f"`{_CALL}` takes past outputs or inputs for instruments. {loop}",
                lambda: by(np.column_stack([_past(y, (2,)), _past(u, (2,))])),
            ),
            Slip(
                "past outputs as instruments",
                f"`{_CALL}` keeps the past output or input beside the reference. {loop}",
                lambda: by(np.column_stack([_past(y, (1,)), _past(r, (1,))])),
            ),
            Slip(
                "past outputs as instruments",
                f"`{_CALL}` keeps the past output or input beside the reference. {loop}",
                lambda: by(np.column_stack([_past(r, (1,)), _past(u, (1,))])),
            ),
            Slip(
                "row before the second lag",
                f"`{_CALL}` begins with k = 1, for which r(-1) is not in the record: begin with k = 2.",
                lambda: (
                    instrumental_variables(
                        np.column_stack([r[:-1], np.r_[0.0, r[:-2]]]), np.column_stack([y[:-1], u[:-1]]), y[1:]
                    ).theta
                ),
            ),
            Slip(
                WRAPS,
                f"`{_CALL}` takes samples from the *end* of the record for those before its first, as `np.roll` does: "
                "leave these rows out.",
                lambda: instrumental_variables(wrapped([(r, 1), (r, 2)]), wrapped([(y, 1), (u, 1)]), y).theta,
            ),
            *(
                Slip(
                    LEFT_SIDE,
                    f"Phi and Z of `{_CALL}` are right, Y is not: it holds y(k-{lag}), and should hold y(k).",
                    partial(_with_left_side, Z, Phi, y, lag),
                )
                for lag in (1, 2)
            ),
            *(
                Slip(
                    "lag off by one",
                    f"the instruments of `{_CALL}` hold {' and '.join(map(_reference, lags))} beside the row of y(k); "
                    "they should hold r(k-1) and r(k-2).",
                    partial(_by_lags, r, Phi, Y, lags),
                )
                for lags in ((0, 1), (0, 2), (2, 3), (1, 3))
            ),
            Slip(
                "regressed on the instruments",
                f"`{_CALL}` regresses on Z, (Z'Z)^-1 Z'Y; the estimate is (Z'Phi)^-1 Z'Y.",
                lambda: solve_least_squares(Z, Y).theta,
            ),
            Slip(
                "regressed on the instruments",
                f"`{_CALL}` regresses on Z, (Z'Z)^-1 Z'Y; the estimate is (Z'Phi)^-1 Z'Y.",
                lambda: solve_least_squares(Z[:, ::-1], Y).theta,
            ),
            Slip(
                "Phi'Z for Z'Phi",
                f"`{_CALL}` solves with Phi'Z; asked for is its transpose, Z'Phi.",
                lambda: np.asarray(np.linalg.solve(Phi.T @ Z, Z.T @ Y), np.float64),
            ),
            Slip(
                "Phi and Z exchanged",
                f"`{_CALL}` has Phi and Z exchanged: yours is (Phi'Z)^-1 Phi'Y, and asked for is (Z'Phi)^-1 Z'Y.",
                lambda: np.asarray(np.linalg.solve(Phi.T @ Z, Phi.T @ Y), np.float64),
            ),
            Slip("sign of a", f"`{_CALL}` returns [a, b]; theta is [-a, b].", lambda: right * [-1, 1]),
            Slip("a and b swapped", f"`{_CALL}` returns b first.", lambda: right[::-1]),
            Slip("inverse forgotten", f"`{_CALL}` returns Z'Y: the inverse of Z'Phi is missing.", lambda: Z.T @ Y),
            *(
                Slip(
                    "reference in place of the input",
                    f"Phi of `{_CALL}` holds {_reference(lag)} where u(k-1) belongs: the reference stands in Z alone.",
                    partial(by, Z, np.column_stack([_past(y, (1,)), _past(r, (lag,))])),
                )
                for lag in (1, 0)
            ),
            Slip(
                "u(k) for u(k-1)",
                f"Phi of `{_CALL}` holds u(k); the equation has u(k-1).",
                lambda: by(Z, np.column_stack([_past(y, (1,)), _past(u, (0,))])),
            ),
            *pairs_of(f"`{_CALL}`", _edits_of_fit(u, y, r), partial(_fitted, u, y, r)),
        ],
    )


def _edits_of_fit(u: FloatArray, y: FloatArray, r: FloatArray) -> tuple[Edit, ...]:
    """Single mistakes in the columns of Phi and in the instruments."""
    return (
        Edit("of_y", -_past(y, (1,)), "Phi holds -y(k-1), and theta is [-a, b]"),
        Edit("of_y", _past(y, (2,)), "Phi holds y(k-2) where y(k-1) belongs"),
        Edit("of_u", _past(r, (1,)), "the reference stands in Phi where u(k-1) belongs"),
        Edit("of_u", _past(u, (0,)), "Phi holds u(k) where u(k-1) belongs"),
        Edit("Z", "Phi", "Phi' stands where Z' belongs, which is least squares"),
        Edit("Z", _past(u, (1, 2)), "past inputs are the instruments, and in the loop they hold past disturbances"),
        Edit("Z", _past(y, (1, 2)), "past outputs are the instruments, and they hold past disturbances"),
        *(
            Edit(
                "Z", _past(r, lags), f"the instruments are {' and '.join(map(_reference, lags))}, not r(k-1) and r(k-2)"
            )
            for lags in ((0, 1), (0, 2))
        ),
    )


def _fitted(
    u: FloatArray,
    y: FloatArray,
    r: FloatArray,
    of_y: FloatArray | None = None,
    of_u: FloatArray | None = None,
    Z: FloatArray | str | None = None,
) -> FloatArray:
    """The estimate from these columns of Phi and these instruments; "Phi" are the regressors themselves."""
    Phi = np.hstack([_past(y, (1,)) if of_y is None else of_y, _past(u, (1,)) if of_u is None else of_u])
    instruments = _past(r, (1, 2)) if Z is None else Phi if isinstance(Z, str) else Z
    return instrumental_variables(instruments, Phi, y[_START:]).theta


def _with_left_side(Z: FloatArray, Phi: FloatArray, y: FloatArray, lag: int) -> FloatArray:
    return instrumental_variables(Z, Phi, y[_START - lag : y.size - lag]).theta


def _least_squares(u: FloatArray, y: FloatArray, start: int) -> FloatArray:
    rows = build_phi(u, y, 1, start)
    return solve_least_squares(rows.Phi, rows.Y).theta
