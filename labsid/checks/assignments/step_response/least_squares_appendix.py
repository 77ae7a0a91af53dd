"""Checks of the least-squares appendix: two equations, error, loss, gradient, minimum, and when it is unique."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from itertools import product

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.assignments.step_response.slips import (
    DIVIDED,
    error_slips,
    gradient_slips,
    loss_slips,
    minimum_slips,
    two_slips,
)
from labsid.checks.compare import as_array, as_number, as_theta, as_vector, close, kind_of
from labsid.checks.descents import descent_of
from labsid.checks.double_mistakes import FACTORS, with_factors
from labsid.checks.parts_of_a_solution import require_whole_solution
from labsid.checks.question import Ask, returned
from labsid.checks.values import Value
from labsid.checks.verdict import BEYOND_RESULTS, Answer, NoAnswer, Slip, Verdict, are_named, first_failure, judge
from labsid.least_squares.solve import loss, loss_gradient, solve_least_squares, two_equations

_same = close(1e-8)

# The square one comes first: with it, a transposed Phi still multiplies and can be recognised.
_SHAPES = ((3, 3), (5, 2), (8, 3), (4, 1))


_SCALES = (0.1, 1e-2, 1e3)
"""Factors of U, as other units of the inputs give: whether there is one solution does not depend on them."""

ZEROS = "zeros"


def _zeros(name: str, because: str, wrong: Answer) -> Slip[Answer]:
    return Slip(ZEROS, f"`{name}` returns zeros: {because}.", lambda: wrong)


def check_solve_two(ask: Ask) -> Verdict:
    """(A2), and its determinant condition."""
    for is_reversed in (False, True):
        U, Y = ask.rng.uniform(0.5, 1.5, (2, 2)) + 2 * np.eye(2), ask.rng.uniform(1, 3, 2)
        if is_reversed:
            U = U[::-1].copy()
        value = ask.call("solve_two", U, Y)
        _require_a_solution(ask, value, is_reversed)
        require_whole_solution("solve_two", value, U, Y, ("U", "Y"))
        if np.size(value) == 1:  # type: ignore[arg-type]
            one_number = "`solve_two` returns one number. It should return both unknowns, by (A2)."
            raise NoAnswer(one_number, "one of two unknowns")
        verdict = judge(
            as_vector("solve_two(U, Y)", value, 2),
            two_equations(U, Y),
            _same,
            "it solves two equations, and returns `None` if the solution is not unique.",
            "`solve_two` does not give the solution of (A2): insert its result into the two equations.",
            two_slips(U, Y),
        )
        if not verdict.passed:
            return verdict
    row = ask.rng.integers(1, 5, 2).astype(float)
    try:
        value = ask.call("solve_two", np.array([row, 2 * row]), np.array([1.0, 3.0]))
        if isinstance(value, str):
            return Verdict(False, f"`solve_two` returns the text {value!r}: `None` has no quotes.", "text for None")
        solved = value is not None
    except NoAnswer:
        solved = True
    if solved:
        return Verdict(
            False,
            "`solve_two` does not return `None` for dependent equations: check the determinant before you divide by "
            "it.",
            "determinant not checked",
        )
    return _on_every_scale(ask, U, Y) or verdict


def _on_every_scale(ask: Ask, U: FloatArray, Y: FloatArray) -> Verdict | None:
    """The verdict on equations with other units, of which the determinant is small or large; None if all are solved."""
    for scale in _SCALES:
        scaled = scale * U
        value = ask.call("solve_two", scaled, Y)
        determinant = float(np.linalg.det(scaled))
        if value is None:
            return Verdict(
                False,
                f"`solve_two` returns None for equations whose determinant is {determinant:.2g}, and they have one "
                "solution. How small a determinant may be depends on the units of U: None is for zero alone.",
                "small determinant taken for zero",
            )
        if not _same(as_vector("solve_two(U, Y)", value, 2), two_equations(scaled, Y)):
            return Verdict(
                False,
                f"`solve_two` does not give the solution of (A2) where the determinant is {determinant:.2g}.",
            )
    return None


def _require_a_solution(ask: Ask, value: Value, is_reversed: bool) -> None:
    """Refuse None, and a division by zero, for equations with one solution."""
    made = "for two equations whose determinant is not zero"
    twice = "A row, or a column, of `U` that is taken twice makes it zero."
    if isinstance(value, np.ndarray) and value.dtype.kind == "f" and np.isinf(value).any():
        text = f"`solve_two` divides by zero {made}: the one that it computes is 0. {twice}"
        raise NoAnswer(text, "determinant is zero")
    if value is not None:
        return
    if is_reversed:
        text = (
            "`solve_two` returns None for two equations whose determinant is negative, and solved those with a "
            "positive one: a negative determinant gives one solution, too. None is for zero alone."
        )
        raise NoAnswer(text, "negative determinant refused")
    row = ask.rng.integers(1, 5, 2).astype(float)
    try:
        is_turned = ask.call("solve_two", np.array([row, 2 * row]), np.array([1.0, 3.0])) is not None
    except NoAnswer:
        is_turned = True
    if is_turned:
        text = f"`solve_two` returns None {made}, and not for dependent ones: its condition is the wrong way round."
        raise NoAnswer(text, "condition the wrong way round")
    said = f"`solve_two` returns nothing (None) {made}."
    if _goes_on_with_nan(ask):
        raise NoAnswer(f"{said} Print the determinant that it computes. {twice}", "determinant is zero")
    raise NoAnswer(
        f"{said} So it does for dependent ones. Print the determinant that it computes: the lines that are reached "
        "where "
        "it is not zero must end with a `return` of the result.",
        "no return",
    )


def _goes_on_with_nan(ask: Ask) -> bool:
    """Whether a function has a result for equations whose determinant is no number, and so not zero."""
    try:
        return ask.call("solve_two", np.full((2, 2), np.nan), np.ones(2)) is not None
    except NoAnswer:
        return True


def check_error_vector(ask: Ask) -> Verdict:
    """(A4)."""

    def one(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> Verdict:
        value = returned(ask, "error_vector", Phi, Y, theta)
        _require_no_table(
            "error_vector",
            value,
            (Y - Phi * theta if Phi.shape[1] == Y.size else Phi * theta, Y[:, None] - Phi * theta),
        )
        return judge(
            as_vector("error_vector(Phi, Y, theta)", value, Y.size),
            Y - Phi @ theta,
            _same,
            "one error for each equation.",
            "`error_vector` does not return Y - Phi theta: see (A4).",
            error_slips(Phi, Y, theta),
        )

    return _on_all(ask, one)


def _require_no_table(name: str, value: Value, tables: tuple[FloatArray, ...]) -> None:
    """Refuse a table that is what a product entry by entry gives."""
    if isinstance(value, np.ndarray) and value.ndim == 2 and 1 not in value.shape:
        proved = any(value.shape == table.shape and np.allclose(value, table) for table in tables)
        said = f"`{name}` returns a table of shape {value.shape}, and not one error for each equation"
        if not proved:
            raise NoAnswer(f"{said}: print the shapes of Y and of `Phi @ theta` before they are subtracted.")
        raise NoAnswer(
            f"{said}: that comes of `Phi * theta`, which multiplies entry by entry. The product of Phi and theta is "
            "`Phi @ theta`.",
            "product entry by entry",
        )


def check_loss_function(ask: Ask) -> Verdict:
    """(A5)."""

    def one(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> Verdict:
        value = returned(ask, "loss", Phi, Y, theta)
        table = np.outer(Y - Phi @ theta, Y - Phi @ theta)
        if isinstance(value, np.ndarray) and value.shape == table.shape and np.allclose(value, table / 2):
            return Verdict(
                False, "`loss` returns the table 1/2 E E': the sum of the squares is E'E, one number.", "E E' for E'E"
            )
        if as_array("loss(Phi, Y, theta)", value).size == Y.size:
            each, E = np.ravel(as_array("loss(Phi, Y, theta)", value)), Y - Phi @ theta
            what = "one number for each equation"
            if np.allclose(np.abs(each), np.abs(E)):
                return Verdict(False, f"`loss` returns {what}, the errors: it is half of E'E.", "errors for the loss")
            return Verdict(False, f"`loss` returns {what}: add them up.", "not added up")
        return judge(
            as_number("loss(Phi, Y, theta)", value),
            loss(Phi, Y, theta),
            _same,
            "half the sum of the squared errors.",
            "`loss` is not half the sum of the squared errors: see (A5).",
            [*loss_slips(Phi, Y, theta), _zeros("loss", "this theta has errors (in Python, `1//2` is 0)", 0.0)],
        )

    return _on_all(ask, one)


def check_gradient(ask: Ask) -> Verdict:
    """The derivative of (A5), by (A6)."""

    def one(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> Verdict:
        got = as_vector("gradient(Phi, Y, theta)", returned(ask, "gradient", Phi, Y, theta), theta.size)
        verdict = judge(
            got,
            loss_gradient(Phi, Y, theta),
            _same,
            "it is the derivative of the loss with respect to each parameter.",
            "`gradient` is not the derivative of V: compare it with differences of the loss, as in the hint.",
            [
                *gradient_slips(Phi, Y, theta),
                *_differences(got, Phi, Y, theta),
                _zeros("gradient", "away from the minimum the loss has a slope", np.zeros_like(theta)),
            ],
        )
        terms = {"Phi'Phi theta": Phi.T @ Phi @ theta, "Phi'Y": Phi.T @ Y}
        return with_factors(verdict, "`gradient`", got, terms, {"Phi'Phi theta": 1.0, "Phi'Y": -1.0})

    verdict = _on_all(ask, one)
    if verdict.slip == DIVIDED:  # a square Phi does not tell equations from unknowns
        verdict = _on_all(ask, one, ((8, 3),))
    if verdict.slip is None and not verdict.passed:  # two numbers do not tell the factors of two terms
        taller = _on_all(ask, one, ((8, 3),))
        verdict = taller if taller.slip == FACTORS else verdict
    return verdict


def _differences(got: FloatArray, Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> Iterator[Slip[FloatArray]]:
    """The quotient of differences with a step that is too large: V is quadratic, and the step adds half its bend."""
    right, bend = loss_gradient(Phi, Y, theta), np.sum(Phi**2, axis=0)
    step = 2 * float(np.mean((got - right) / bend))
    text = (
        f"`gradient` is the quotient of differences of the loss with a step of {abs(step):.3g}, so that the bend of V "
        "is in it. Differences are for comparing; asked for is the derivative by (A6)."
    )
    yield Slip("differences with a large step", text, lambda: right + step / 2 * bend)


def check_minimum(ask: Ask) -> Verdict:
    """Eq. (8)."""

    def one(Phi: FloatArray, Y: FloatArray, _: FloatArray) -> Verdict:
        value = returned(ask, "best_theta", Phi, Y)
        require_whole_solution("best_theta", value, Phi.T @ Phi, Phi.T @ Y, before_y=Phi.T)
        fitted = Phi @ solve_least_squares(Phi, Y).theta
        if isinstance(value, np.ndarray) and value.size == Y.size and len(Phi) > Phi.shape[1]:
            for made, what in ((fitted, "Phi theta, the model output"), (Y - fitted, "Y - Phi theta, the errors")):
                if close(1e-6)(np.ravel(value), made):
                    raise NoAnswer(f"`best_theta` returns {what}: return theta itself.", "output in place of theta")
        if isinstance(value, np.ndarray) and value.ndim == 2 and 1 not in value.shape:
            raise NoAnswer(
                f"`best_theta` returns a table of shape {value.shape}; theta has {Phi.shape[1]} numbers. "
                "{} (`*` and `/` between matrices work entry by entry; products of matrices are `@`.)".format(
                    "It comes of eq. (8) with `*` between its parts."
                    if _is_table_of_products(value, Phi, Y)
                    else "Print the shape of each of its products."
                ),
                "product entry by entry",
            )
        theta = as_theta("best_theta(Phi, Y)", value, Phi.shape[1])
        found = descent_of(code_of(ask, "best_theta"), theta, Phi.T @ Phi, Phi.T @ Y) if are_named() else None
        if found is not None and not close(1e-6)(theta, solve_least_squares(Phi, Y).theta):
            steps, factor = found
            text = (
                f"`best_theta` ends before the minimum: after its {steps} steps against the gradient, of {factor:g} "
                f"times it, the gradient is still up to {_slope(Phi, Y, theta):.2g}. Eq. (8) gives the minimum at once."
            )
            return Verdict(False, text, "descent not at its end")
        return judge(
            theta,
            solve_least_squares(Phi, Y).theta,
            close(1e-6),
            "no other theta has a smaller loss.",
            "`best_theta` does not give the theta with the smallest loss: see eq. (8). At the one that it returns the "
            f"gradient is up to {_slope(Phi, Y, theta):.2g}, and at the minimum it is zero.",
            [
                *minimum_slips(Phi, Y),
                *_entry_by_entry(Phi, Y),
                _zeros("best_theta", "another theta has a smaller loss", np.zeros(Phi.shape[1])),
            ],
        )

    verdict = _on_all(ask, one)
    if verdict.slip == ZEROS:  # with a square Phi, errors are zero
        tall = _on_all(ask, one, ((8, 3),))
        verdict = verdict if tall.slip in (None, BEYOND_RESULTS) else tall
    return verdict


def _slope(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> float:
    return float(np.max(np.abs(loss_gradient(Phi, Y, theta))))


def _products(Phi: FloatArray, Y: FloatArray) -> Iterator[FloatArray]:
    """Eq. (8) with one product or more entry by entry, from the left or from the right."""
    for products in list(product((np.matmul, np.multiply), repeat=3))[1:]:
        square, behind, last = products
        for from_left in (True, False):
            with suppress(ValueError, np.linalg.LinAlgError):
                inverse = np.linalg.inv(square(Phi.T, Phi))
                yield last(behind(inverse, Phi.T), Y) if from_left else behind(inverse, last(Phi.T, Y))


def _is_table_of_products(value: Value, Phi: FloatArray, Y: FloatArray) -> bool:
    return isinstance(value, np.ndarray) and any(
        value.shape == table.shape and np.allclose(value, table) for table in _products(Phi, Y)
    )


def _entry_by_entry(Phi: FloatArray, Y: FloatArray) -> Iterator[Slip[Answer]]:
    """What a square Phi hides: products entry by entry whose result has the size of theta."""
    text = (
        "`best_theta` has `*` between matrices in eq. (8), which multiplies entry by entry: their product is `@`. "
        "(Here Phi has as many rows as columns, and `*` does not stop; with more rows it would.)"
    )
    for made in _products(Phi, Y):
        if made.shape == (Phi.shape[1],):
            yield Slip("product entry by entry", text, partial(np.copy, made))


def check_unique(ask: Ask) -> Verdict:
    """The solution is unique if and only if Phi has full column rank."""
    trials = trial_ranks(ask.rng)
    answers = [_truth(ask, Phi) for Phi, _ in trials]
    truth = [unique for _, unique in trials]
    if answers == truth:
        return Verdict(True, "the solution is unique if Phi has full column rank.")
    for slip, reason, rule in _WRONG_RULES:
        if answers == [rule(Phi) for Phi, _ in trials]:
            return Verdict(False, f"`is_unique` {reason}", slip)
    wrong = [i for i, (answer, unique) in enumerate(zip(answers, truth, strict=True)) if answer != unique]
    if all(answers[i] and np.all(np.any(trials[i][0], axis=0)) for i in wrong):
        return Verdict(
            False,
            "`is_unique` returns True where a column is a combination of others. By rounding, the determinant of "
            "Phi'Phi is tiny there instead of zero; `matrix_rank` allows for that.",
            "zero compared exactly",
        )
    Phi, unique = trials[wrong[0]]
    return Verdict(
        False,
        f"`is_unique` says {not unique} for a Phi of {Phi.shape[0]} by {Phi.shape[1]} and rank {_rank(Phi)}: compare "
        "the rank with the number of columns.",
    )


def trial_ranks(rng: np.random.Generator) -> list[tuple[FloatArray, bool]]:
    """Matrices of full and of lower column rank, in random order and some twice, and whether the solution is unique."""

    def full(n: int, p: int) -> FloatArray:
        return np.asarray(rng.uniform(-1, 1, (n, p)) + 2 * np.eye(n, p), float)

    def dependent(n: int, p: int) -> FloatArray:
        Phi = full(n, p)
        Phi[:, -1] = Phi[:, :-1] @ rng.uniform(0.3, 1.7, p - 1) if p > 1 else 0
        return Phi

    with_zero_column = full(6, 3)
    with_zero_column[:, rng.integers(3)] = 0
    trials = [(full(n, p), True) for n, p in ((7, 3), (3, 3), (int(rng.integers(5, 9)), 2), (4, 1), (2, 2))]
    trials += [(dependent(n, p), False) for n, p in ((7, 3), (int(rng.integers(5, 9)), 4), (3, 3), (6, 2))]
    trials += [(full(2, 3), False), (full(1, 2), False), (with_zero_column, False)]
    order = rng.permutation([*range(len(trials)), *rng.integers(0, len(trials), 3)])
    return [trials[i] for i in order]


def unique_by_rank(Phi: FloatArray) -> bool:
    """Whether Phi has full column rank."""
    return _rank(Phi) == Phi.shape[1]


def _rank(Phi: FloatArray) -> int:
    return int(np.linalg.matrix_rank(Phi))


_WIDE = (
    "returns True for a Phi of full rank with fewer equations than unknowns, as a comparison of the rank with the "
    "smaller side of Phi does, or a condition number: compare the rank with the number of columns."
)
_ROWS = "compares the rank with the rows of Phi; compare it with the number of columns."

_WRONG_RULES: tuple[tuple[str, str, Callable[[FloatArray], bool]], ...] = (
    (
        "equations counted",
        "compares only the numbers of equations and unknowns: try a Phi with two equal columns.",
        lambda Phi: Phi.shape[0] >= Phi.shape[1],
    ),
    (
        "equations counted",
        "compares only the numbers of equations and unknowns: try a Phi with two equal columns.",
        lambda Phi: Phi.shape[0] > Phi.shape[1],
    ),
    ("always unique", "returns True for every Phi: try a Phi with two equal columns.", lambda Phi: True),
    ("rank of the rows", _WIDE, lambda Phi: _rank(Phi) == min(Phi.shape)),
    ("rank of the rows", _ROWS, lambda Phi: _rank(Phi) == Phi.shape[0]),
    (
        "square matrices only",
        "returns True only for a square Phi; more equations than unknowns are allowed.",
        lambda Phi: _rank(Phi) == Phi.shape[0] == Phi.shape[1],
    ),
    (
        "square matrices only",
        "returns True for every square Phi and for no other: what counts is whether a column follows from the others.",
        lambda Phi: Phi.shape[0] == Phi.shape[1],
    ),
    (
        "opposite answer",
        "returns the opposite: True means that the solution is unique.",
        lambda Phi: _rank(Phi) < Phi.shape[1],
    ),
)


def _truth(ask: Ask, Phi: FloatArray) -> bool:
    value = returned(ask, "is_unique", Phi)
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0].item()
    if isinstance(value, (bool, int, float)) and value in (0, 1):
        return bool(value)
    both = isinstance(value, np.ndarray) and value.size == Phi.ndim
    two = " (`Phi.shape` has two numbers; that of the columns is `Phi.shape[1]`.)" if both else ""
    raise NoAnswer(f"`is_unique` should return True or False; it returns {kind_of(value)}.{two}", "not True or False")


def _on_all(
    ask: Ask,
    one: Callable[[FloatArray, FloatArray, FloatArray], Verdict],
    shapes: tuple[tuple[int, int], ...] = _SHAPES,
) -> Verdict:
    """The verdict on all trials; a tall Phi, whose shapes tell more, speaks where a square one names no mistake."""
    try:
        verdict = _in_turn(ask, one, shapes)
    except NoAnswer as refused:
        verdict = Verdict(False, str(refused), refused.slip)
    if verdict.passed or verdict.slip is not None or len(shapes) == 1:
        return verdict
    try:
        tall = _in_turn(ask, one, shapes[1:])
    except NoAnswer as refused:
        return verdict if refused.slip == BEYOND_RESULTS else Verdict(False, str(refused), refused.slip)
    return verdict if tall.passed or tall.slip == BEYOND_RESULTS else tall


@first_failure
def _in_turn(
    ask: Ask,
    one: Callable[[FloatArray, FloatArray, FloatArray], Verdict],
    shapes: tuple[tuple[int, int], ...],
) -> Iterator[Verdict]:
    for n, p in shapes:
        Phi = ask.rng.uniform(-1, 1, (n, p)) + 3 * np.eye(n, p)
        theta, E = ask.rng.uniform(0.5, 2, p), ask.rng.uniform(0.5, 2, n) * np.where(np.arange(n) % 2, 1, -1)
        yield one(Phi, Phi @ theta + E, theta)  # errors of both signs: |E| is not -E
