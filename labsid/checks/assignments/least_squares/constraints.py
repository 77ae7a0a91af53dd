"""Checks of least squares with known parameters, weights and constraints."""

from collections.abc import Iterator
from functools import partial
from itertools import product

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_theta
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.parts_of_a_solution import require_whole_solution
from labsid.checks.question import Ask, returned
from labsid.checks.regressions import WRAPS, sample_name, wrapped
from labsid.checks.trials import trial_equations
from labsid.checks.values import Value
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.least_squares.constrained import fit_with_known, least_squares_with_equations
from labsid.least_squares.linear_algebra import pseudo_inverse
from labsid.least_squares.solve import solve_least_squares
from labsid.least_squares.weighted import weighted_least_squares
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel

EXACT = 1e-9  # by which rounding may miss a constraint of size one to ten
_WRONG_LAGS = (
    (2, 1, 2), (1, 1, 3), (2, 0, 2), (2, 2, 3), (2, 0, 3), (1, 0, 2), (3, 1, 3), (2, 3, 3), (2, 1, 1), (2, 1, 4),
    (2, 2, 4), (1, 2, 3),
)  # fmt: skip
"""Wrong lags of y, of the known u and of the other u in example 1; the right ones are 2, 1 and 3."""


@first_failure
def check_known_parameter(ask: Ask) -> Iterator[Verdict]:
    """`example_1(u, y)`: SUSTech's example 1, with the known coefficient on the left side."""
    for samples in (20, 35):
        a, b = ask.rng.uniform(-0.8, 0.8), ask.rng.uniform(0.5, 2)
        u = ask.rng.uniform(-2, 2, samples)
        model = PolynomialModel(np.array([1, 0, a]), np.array([1, 0, b]), np.array([1.0]), 1, 1.0)
        y = free_run(model, u) + 0.3 * ask.rng.standard_normal(samples)
        y[:3] += ask.rng.uniform(1, 2, 3)  # not at rest before the record, so that rows before k0 are wrong
        yield _judge_known(ask, u, y)


def _judge_known(ask: Ask, u: FloatArray, y: FloatArray) -> Verdict:
    value = returned(ask, "example_1", u, y)
    if isinstance(value, np.ndarray) and value.size == 3:
        return Verdict(
            False,
            "`example_1` estimates three parameters. The coefficient 1 of u(k-1) is known.",
            "known parameter estimated",
            mend="Move this term to the left side and remove its column from Phi.",
        )
    k = np.arange(3, u.size)
    Phi, Y = np.column_stack([-y[k - 2], u[k - 1], u[k - 3]]), y[k]

    def fit(columns: FloatArray, target: FloatArray) -> FloatArray:
        return solve_least_squares(columns, target).theta

    two = Phi[:, [0, 2]]
    right = fit_with_known(Phi, Y, {1: 1.0}).fit.theta
    got = as_theta("example_1(u, y)", value, 2)
    rest = np.concatenate([np.zeros(3), u]), np.concatenate([np.zeros(3), y])
    rows = "`example_1` uses rows before k0 = 4, with zeros for missing samples: begin where all lags exist."
    early = [
        fit(
            np.column_stack([-rest[1][first + 1 : -2], rest[0][first : u.size]]),
            rest[1][first + 3 :] - rest[0][first + 2 : -1],
        )
        for first in (0, 1, 2)
    ]
    return judge(
        got,
        right,
        SAME,
        "the known coefficient is not estimated.",
        f"`example_1` does not return the least-squares [a, b]. {_rows_used(u, y, value)}",
        [
            Slip(
                "sign of a",
                "`example_1` has the wrong sign of a: G(z) has +a in its denominator, so the regressor contains "
                "-y(k-2).",
                lambda: right * [-1, 1],
            ),
            Slip("a and b swapped", "`example_1` returns b before a.", lambda: right[::-1]),
            Slip(
                "known term left out",
                "`example_1` omits u(k-1): its coefficient is known to be 1, not 0.",
                lambda: fit(two, Y),
                mend="Subtract it from y(k).",
            ),
            Slip(
                "known term left out",
                "`example_1` omits u(k-1), and has the wrong sign of a.",
                lambda: fit(two, Y) * [-1, 1],
            ),
            Slip(
                "known term with the wrong sign",
                "`example_1` adds u(k-1) on the left side.",
                lambda: fit(two, Y + Phi[:, 1]),
                mend="Subtract it there.",
            ),
            Slip(
                "known parameter estimated",
                "`example_1` estimates the coefficient of u(k-1) with the others: it is known to be 1.",
                lambda: fit(Phi, Y)[[0, 2]],
            ),
            *(
                Slip("lag off by one", _wrong_lags(lags), partial(_lagged_fit, u, y, lags, first))
                for first, lags in product((0, 3), _WRONG_LAGS)
            ),
            *_other_factor(got, fit(two, Y), fit(two, Phi[:, 1])),
            *(
                Slip(
                    WRAPS,
                    "`example_1` takes samples from the *end* of the record for those before its first, as "
                    "`np.roll` and an index below zero do: begin with the row of k = 4.",
                    partial(fit, wrapped([(-y, 2), (u, 3)])[first:], (y - np.roll(u, 1))[first:]),
                )
                for first in (0, 1, 2)
            ),
            *(Slip("rows before k0", rows, partial(np.copy, wrong)) for wrong in early),
            *(
                Slip(
                    "number of samples fixed",
                    f"`example_1` uses the first {fixed} of the {u.size} samples that it is handed: take `len(y)`.",
                    partial(_lagged_fit, u[:fixed], y[:fixed], (2, 1, 3), 3),
                )
                for fixed in (20, 21)
                if fixed < u.size
            ),
        ],
    )


def _wrong_lags(lags: tuple[int, int, int]) -> str:
    """Which terms are taken at another step than the equation has."""
    of_y, of_known, of_u = lags
    wrong = [
        text
        for text, is_wrong in (
            (f"the column of a holds {sample_name('y', of_y)} in place of y(k-2)", of_y != 2),
            (f"{sample_name('u', of_known)} is taken off y(k) in place of the known term u(k-1)", of_known != 1),
            (f"the column of b holds {sample_name('u', of_u)} in place of u(k-3)", of_u != 3),
        )
        if is_wrong
    ]
    return (
        f"`example_1` has a wrong lag: {', and '.join(wrong)}. Compare your row for k = 4 with y(4) + a y(2) = "
        "u(3) + b u(1)."
    )


def _other_factor(got: FloatArray, without: FloatArray, of_known: FloatArray) -> Iterator[Slip[FloatArray]]:
    """The known term, taken off with another factor than 1: the theta of the rest less that factor times its own."""
    if got.shape == without.shape:
        factor = float((without - got) @ of_known / (of_known @ of_known))
        text = f"`example_1` takes {factor:.3g} u(k-1) off y(k): the known coefficient is 1."
        yield Slip("known term with another factor", text, lambda: without - factor * of_known)


def _rows_used(u: FloatArray, y: FloatArray, value: Value) -> str:
    """Which lags and rows give the student's result, in words; else which row to write down."""
    got = np.ravel(value) if isinstance(value, np.ndarray) else np.empty(0)
    for drop, first, lags in product((0, 1, 2), (3, 4, 0), product(range(4), repeat=3)):
        k = np.arange(max(first, *lags), u.size - drop)
        of_y, of_known, of_u = lags
        for is_taken_off in (True, False):
            target = y[k] - u[k - of_known] if is_taken_off else y[k]
            theta_of_rows = solve_least_squares(np.column_stack([-y[k - of_y], u[k - of_u]]), target).theta
            if SAME(got, theta_of_rows):
                side = f"y(k) - {sample_name('u', of_known)}" if is_taken_off else "y(k)"
                return (
                    f"It is that of the rows [-{sample_name('y', of_y)}, {sample_name('u', of_u)}] with {side} "
                    "on the left, "
                    f"k = {k[0] + 1} to {k[-1] + 1}. The equation is y(k) + a y(k-2) = u(k-1) + b u(k-3), k = "
                    f"4 to {u.size}."
                )
    return "Write down the row for k = 4, [-y(2), u(1)], with y(4) - u(3) on its left, and print your first row."


def _lagged_fit(u: FloatArray, y: FloatArray, lags: tuple[int, int, int], first: int) -> FloatArray:
    """[a, b] with these lags of y, of the known u and of the other u; rows from `first`, or where all lags exist."""
    of_y, of_known, of_u = lags
    k = np.arange(max(first, *lags), u.size)
    return solve_least_squares(np.column_stack([-y[k - of_y], u[k - of_u]]), y[k] - u[k - of_known]).theta


@first_failure
def check_weighted(ask: Ask) -> Iterator[Verdict]:
    """`weighted_fit(Phi, Y, sigma)`."""
    for n, p in ((9, 2), (12, 3)):
        Phi, Y = trial_equations(ask.rng, n, p)
        sigma = ask.rng.uniform(0.2, 3, n)
        yield _judge_weighted(ask, Phi, Y, sigma)


def _judge_weighted(ask: Ask, Phi: FloatArray, Y: FloatArray, sigma: FloatArray) -> Verdict:
    def fit(weights: FloatArray) -> FloatArray:
        return weighted_least_squares(Phi, Y, weights).theta

    value = returned(ask, "weighted_fit", Phi, Y, sigma)
    PhiW = Phi.T / sigma**2
    require_whole_solution("weighted_fit", value, PhiW @ Phi, PhiW @ Y, ("Phi'W Phi", "Phi'W Y"), PhiW)
    inverted = "`weighted_fit` gives the worst measurements the largest weights: a large sigma needs a small weight."
    return judge(
        as_theta("weighted_fit(Phi, Y, sigma)", value, Phi.shape[1]),
        fit(1 / sigma**2),
        SAME,
        "each measurement has the weight 1/variance.",
        "`weighted_fit` does not minimise the sum of (Y - Phi theta)^2 / sigma^2.",
        [
            Slip(
                "weights not used",
                "`weighted_fit` does not use sigma.",
                lambda: solve_least_squares(Phi, Y).theta,
                mend="Divide each row by it.",
            ),
            Slip(
                "standard deviation for variance",
                "`weighted_fit` weights the squared errors by 1/sigma.",
                lambda: fit(1 / sigma),
                mend="Use 1/sigma^2. (Divide rows by sigma, their squares by sigma^2.)",
            ),
            Slip(
                "weights squared",
                "`weighted_fit` applies the weights twice.",
                lambda: fit(1 / sigma**4),
                mend="Divide each row by sigma, not by sigma^2.",
            ),
            Slip("weights inverted", inverted, lambda: fit(sigma**2)),
            Slip("weights inverted", inverted, lambda: fit(sigma)),
            Slip(
                "only one side weighted",
                "`weighted_fit` divides Phi by sigma but not Y.",
                lambda: solve_least_squares(Phi / sigma[:, np.newaxis], Y).theta,
                mend="Divide both sides of each equation.",
            ),
            Slip(
                "only one side weighted",
                "`weighted_fit` divides Y by sigma but not Phi.",
                lambda: solve_least_squares(Phi, Y / sigma).theta,
                mend="Divide both sides of each equation.",
            ),
            Slip(
                "only one side weighted",
                "`weighted_fit` uses W once, before Y: yours is (Phi'Phi)^-1 Phi'W Y.",
                lambda: pseudo_inverse(Phi.T @ Phi) @ Phi.T @ (Y / sigma**2),
                mend="(Phi'W Phi)^-1 Phi'W Y contains it twice.",
            ),
            Slip(
                "only one side weighted",
                "`weighted_fit` uses W once, in the inverse: yours is (Phi'W Phi)^-1 Phi'Y.",
                lambda: np.asarray(np.linalg.solve(Phi.T @ (Phi / sigma[:, np.newaxis] ** 2), Phi.T @ Y), float),
                mend="(Phi'W Phi)^-1 Phi'W Y contains it twice.",
            ),
            *pairs_of("`weighted_fit`", _edits_of_weights(sigma), partial(_with_weights, Phi, Y, sigma)),
        ],
    )


def _edits_of_weights(sigma: FloatArray) -> tuple[Edit, ...]:
    """Wrong weights on either side of Phi'W Phi theta = Phi'W Y."""
    sides = (("left", "before Phi, in Phi'W Phi,"), ("right", "before Y, in Phi'W Y,"))
    weights = (
        (np.ones(sigma.size), "W is missing"),
        (1 / sigma, "the weight is 1/sigma, and not 1/sigma^2"),
        (1 / sigma**4, "the weight is 1/sigma^4, and not 1/sigma^2"),
        (sigma, "the weight is sigma, and not 1/sigma^2"),
        (sigma**2, "the weight is sigma^2, and not 1/sigma^2"),
    )
    return tuple(Edit(part, weight, f"{where} {said}") for part, where in sides for weight, said in weights)


def _with_weights(
    Phi: FloatArray, Y: FloatArray, sigma: FloatArray, left: FloatArray | None = None, right: FloatArray | None = None
) -> FloatArray:
    left, right = (1 / sigma**2 if one is None else one for one in (left, right))
    return np.asarray(np.linalg.solve((Phi.T * left) @ Phi, (Phi.T * right) @ Y), float)


def _with_multipliers(Phi: FloatArray, Y: FloatArray, A: FloatArray, b: FloatArray) -> FloatArray:
    left = np.block([[Phi.T @ Phi, A.T], [A, np.zeros((b.size, b.size))]])
    return np.asarray(np.linalg.solve(left, np.concatenate([Phi.T @ Y, b])), float)


def _fit_with_rows(Phi: FloatArray, Y: FloatArray, A: FloatArray, b: FloatArray) -> FloatArray:
    return least_squares_with_equations(Phi, Y, A, b).theta


def _constraint_met(value: Value, A: FloatArray, b: FloatArray) -> str:
    theta = np.ravel(value) if isinstance(value, np.ndarray) else np.empty(0)
    if theta.size != A.shape[1]:
        return ""
    if np.allclose(A @ theta, b, rtol=1e-6, atol=1e-8):
        return (
            "Yours satisfies A theta = b, but its SSE is not the smallest of those that do. With multipliers, the "
            "equations "
            "for that are Phi'Phi theta + A' multipliers = Phi'Y: put yours in."
        )
    off = np.abs(A @ theta - b)
    met = [i for i, one in enumerate(off) if one <= 1e-6 * float(np.max(np.abs(b)))]
    rows = f" (row {' and '.join(map(str, met))} of A, counted from 0, is met)" if met else ""
    return f"Yours does not satisfy it: A theta differs from b by up to {np.max(off):.2g}{rows}."


@first_failure
def check_constrained(ask: Ask) -> Iterator[Verdict]:
    """`constrained_fit(Phi, Y, A, b)`."""
    for n, p, r in ((8, 3, 1), (9, 4, 2), (6, 2, 1)):
        Phi, Y = trial_equations(ask.rng, n, p)
        A, b = ask.rng.uniform(0.5, 2, (r, p)) + np.eye(r, p), ask.rng.uniform(2, 4, r)
        yield _judge_constrained(ask, Phi, Y, A, b)


def _judge_constrained(ask: Ask, Phi: FloatArray, Y: FloatArray, A: FloatArray, b: FloatArray) -> Verdict:
    p, r = Phi.shape[1], b.size
    value = returned(ask, "constrained_fit", Phi, Y, A, b)
    if isinstance(value, np.ndarray) and value.size == p + r and r > 0:
        return Verdict(
            False,
            "`constrained_fit` returns the multipliers together with theta.",
            "multipliers returned too",
            mend="Return only the first p entries.",
        )
    free, right = solve_least_squares(Phi, Y).theta, least_squares_with_equations(Phi, Y, A, b).theta
    got = as_theta("constrained_fit(Phi, Y, A, b)", value, p)
    if SAME(got, right) and (off := float(np.max(np.abs(A @ np.ravel(got) - b)))) > EXACT:
        return Verdict(
            False,
            f"`constrained_fit` meets the constraint only nearly, to {off:.1g}. It must be met exactly.",
            "constraint as additional data",
            mend="Rows of a large weight are never met exactly: write the equations with multipliers.",
        )
    return judge(
        got,
        right,
        SAME,
        "the best theta among those that satisfy A theta = b.",
        f"`constrained_fit` does not return the best theta with A theta = b. {_constraint_met(value, A, b)}",
        [
            Slip("constraint not used", "`constrained_fit` ignores the constraint.", lambda: free),
            *(
                Slip(
                    "one constraint alone",
                    f"`constrained_fit` meets row {i} of A theta = b alone (counted from 0), and A has {r} rows: all "
                    f"of them, and all of b, stand in the equations, with {r} multipliers.",
                    partial(_fit_with_rows, Phi, Y, A[i : i + 1], b[i : i + 1]),
                )
                for i in range(r if r > 1 else 0)
            ),
            Slip(
                "constraint as additional data",
                "`constrained_fit` adds the constraint as further rows, which are met only approximately. It must "
                "be met exactly.",
                lambda: solve_least_squares(np.vstack([Phi, A]), np.concatenate([Y, b])).theta,
            ),
            Slip(
                "free solution projected onto the constraint",
                "`constrained_fit` projects the free solution onto the constraint. This theta is nearest to the "
                "free one, but does not have the smallest error: the direction depends on Phi'Phi.",
                lambda: free + pseudo_inverse(A) @ (b - A @ free),
            ),
            Slip(
                "multipliers in place of theta",
                "`constrained_fit` returns the *last* p numbers of the solution, with the multipliers at "
                "their end: theta is the first p.",
                lambda: _with_multipliers(Phi, Y, A, b)[-p:],
            ),
            Slip(
                "sign of b",
                "`constrained_fit` satisfies A theta = -b: the sign of b is turned round in your equations.",
                lambda: least_squares_with_equations(Phi, Y, A, -b).theta,
            ),
            Slip(
                "data not used",
                "`constrained_fit` satisfies the constraint but ignores the data.",
                lambda: pseudo_inverse(A) @ b,
            ),
        ],
    )
