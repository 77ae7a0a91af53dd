"""Checks of the projection onto the columns of Phi, and of all solutions for a rank-deficient Phi."""

from collections.abc import Iterator

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.compare import SAME, as_array, as_matrix, as_theta
from labsid.checks.parts_of_a_solution import require_no_ridge
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.trials import trial_equations
from labsid.checks.values import Value
from labsid.checks.verdict import Slip, Verdict, first_failure, judge, told_if_singular
from labsid.least_squares.linear_algebra import pseudo_inverse, singular_values
from labsid.least_squares.projection import projection_matrix, solution_set


@first_failure
def check_projector(ask: Ask) -> Iterator[Verdict]:
    """`projector(Phi)`."""
    for n, p in ((5, 2), (6, 3), (4, 1)):
        yield _judge_projector(ask, trial_equations(ask.rng, n, p)[0])


def _judge_projector(ask: Ask, Phi: FloatArray) -> Verdict:
    n, p = Phi.shape
    P = projection_matrix(Phi)
    value = returned(ask, "projector", Phi)
    shape = as_array("projector(Phi)", value).shape
    if shape in ((p, n), (p, p)):
        return _too_small(as_array("projector(Phi)", value), Phi)
    return judge(
        got := as_matrix("projector(Phi)", value, (n, n)),
        P,
        SAME,
        "it projects onto the columns of any Phi, and P P = P.",
        "`projector` does not return the P with Y_hat = P Y, for which P P = P, P' = P and P Phi = Phi. "
        f"{_fails(got, Phi)}",
        [
            Slip(
                "inverse left out",
                "`projector` returns Phi Phi': then P P is not P.",
                lambda: Phi @ Phi.T,
                mend="(Phi'Phi)^-1 in the middle is missing.",
            ),
            Slip(
                "projects onto the residual",
                "`projector` returns I - P, which maps Y to the residual.",
                lambda: np.eye(n) - P,
            ),
            Slip(
                "inverse forgotten",
                "`projector` has Phi'Phi in the middle instead of its inverse.",
                lambda: Phi @ Phi.T @ Phi @ Phi.T,
            ),
            Slip(
                "columns taken for orthogonal",
                "`projector` scales each regressor to length one, and takes them for orthogonal: what two of them "
                "share is then counted twice.",
                lambda: (Phi / np.sum(Phi**2, axis=0)) @ Phi.T,
                mend="(Phi'Phi)^-1, the inverse of the whole matrix, belongs in the middle.",
            ),
            Slip(
                "divided by a norm",
                "`projector` divides Phi Phi' by the square of a norm, which is right for a single column only.",
                lambda: Phi @ Phi.T / np.linalg.norm(Phi) ** 2,
                mend="(Phi'Phi)^-1 belongs in the middle.",
            ),
        ],
    )


def _fails(got: FloatArray, Phi: FloatArray) -> str:
    """Which of the properties of a projector a matrix lacks."""
    pairs = (("P P = P", got @ got, got), ("P' = P", got.T, got), ("P Phi = Phi", got @ Phi, Phi))
    lacks = [said for said, one, other in pairs if not SAME(one, other)]
    return f"Of these, yours does not have {', nor '.join(lacks)}." if lacks else ""


def _too_small(got: FloatArray, Phi: FloatArray) -> Verdict:
    """A matrix with p rows, where one with n rows maps Y to Y_hat."""
    n, p = Phi.shape
    inner = Phi.T @ Phi
    known = (
        ("pseudo-inverse instead of the projector", "the pseudo-inverse (Phi'Phi)^-1 Phi'", pseudo_inverse(Phi)),
        ("p by p matrix instead of the projector", "Phi'Phi", inner),
        ("p by p matrix instead of the projector", "the inverse of Phi'Phi", np.linalg.inv(inner)),
        ("transposed Phi", "Phi' alone", Phi.T),
    )
    size = f"`projector` returns a {got.shape[0]} by {got.shape[1]} matrix"
    needed = f"P maps Y to Y_hat, both with {n} entries, so it is {n} by {n}."
    for slip, what, value in known:
        if SAME(got, value):
            return Verdict(False, f"{size}: this is {what}. {needed}", slip, mend="Multiply by Phi from the left.")
    slip = "transposed Phi" if got.shape == (p, p) else "pseudo-inverse instead of the projector"
    return Verdict(
        False,
        f"{size}, but {needed} Phi ({n} by {p}) stands on the outside left, Phi' ({p} by {n}) on "
        f"the right, and what is inverted between them is {p} by {p}.",
        slip,
    )


_SINGULAR = (
    "`all_solutions` inverts Phi'Phi, or solves with it. The columns of Phi are dependent in this step, so that "
    "Phi'Phi has no inverse: use `np.linalg.pinv(Phi) @ Y`, or the singular values."
)


@first_failure
def check_all_solutions(ask: Ask) -> Iterator[Verdict]:
    """`all_solutions(Phi, Y)`: the shortest theta and a basis of the null space of Phi."""
    for n, p, rank in ((6, 3, 2), (8, 4, 2), (7, 4, 3)):
        Phi = np.zeros((n, p))
        while singular_values(Phi).rank < rank:
            # small integers: dependent columns without rounding
            Phi = ask.rng.integers(-3, 4, (n, rank)) @ ask.rng.integers(-2, 3, (rank, p)).astype(float)
        with told_if_singular(_SINGULAR, "inverse of a singular matrix"):
            verdict = _solutions(ask, Phi, ask.rng.uniform(-5, 5, n))
        yield verdict
    yield Verdict(True, "the shortest theta, and every direction that leaves Phi theta unchanged.")


def _solutions(ask: Ask, Phi: FloatArray, Y: FloatArray) -> Verdict:
    p = Phi.shape[1]
    right = solution_set(Phi, Y)
    free = p - right.rank
    parts = returned_parts(ask, "all_solutions", "theta and the matrix N", 2, Phi, Y)
    if _swapped(parts[0], parts[1], Phi, Y):
        return Verdict(False, "`all_solutions` returns N before theta.", "theta and N swapped")
    theta = as_theta("theta of all_solutions(Phi, Y)", parts[0], p)
    scale = 1e-6 * float(np.max(np.abs(Phi.T @ Y)))
    if np.max(np.abs(Phi.T @ (Y - Phi @ theta))) > scale:
        require_no_ridge("theta of all_solutions", theta, Phi.T @ Phi, Phi.T @ Y)
        code = code_of(ask, "all_solutions")
        inverts = code is None or not {"inv", "solve"}.isdisjoint(code.calls)
        of_inverse = " (`inv` of a singular Phi'Phi fails or, by rounding, gives wrong values.)" if inverts else ""
        return judge(
            theta,
            right.theta,
            SAME,
            "",
            f"theta of `all_solutions` does not solve the normal equations.{of_inverse}",
            [
                Slip("inverse left out", "theta of `all_solutions` is Phi'Y.", lambda: Phi.T @ Y),
            ],
        )
    if not SAME(theta, right.theta):
        return Verdict(
            False,
            "theta of `all_solutions` solves the normal equations, but it is not the shortest: it has a component "
            "in the null space of Phi. (MATLAB's backslash does this too.)",
            "not the shortest",
        )
    N = as_array("N of all_solutions(Phi, Y)", parts[1])
    N = N.reshape(-1, 1) if N.ndim == 1 else N
    if N.ndim == 2 and N.shape[0] == Phi.shape[0] != p and SAME(Phi.T @ N + 1, np.ones((p, N.shape[1]))):
        return Verdict(
            False,
            f"N of `all_solutions` has columns of U, with {N.shape[0]} entries, as many as Y. Directions of theta have "
            f"{p}: they are columns of V.",
            "U in place of V",
        )
    if N.ndim == 2 and N.shape == (free, p) and free != p and SAME(Phi @ N.T + 1, np.ones((Phi.shape[0], free))):
        return Verdict(
            False,
            "N of `all_solutions` has the directions as rows; they should be its columns: `.T`.",
            "rows instead of columns",
        )
    if N.shape == (p, right.rank) and free != right.rank:
        return Verdict(
            False,
            f"N of `all_solutions` has rank(Phi) columns. The null space has p - rank = {free} directions.",
            "directions outside the null space",
            mend="They are the other columns of V.",
        )
    return _directions(as_matrix("N of all_solutions(Phi, Y)", N, (p, None)), Phi, free)


def _swapped(first: Value, second: Value, Phi: FloatArray, Y: FloatArray) -> bool:
    """Whether the second result solves the normal equations, and Phi takes the first one to zero."""
    if not isinstance(first, np.ndarray) or not isinstance(second, np.ndarray) or second.size != Phi.shape[1]:
        return False
    if first.ndim == 0 or first.shape[0] != Phi.shape[1] or first.dtype.kind != "f" or second.dtype.kind != "f":
        return False
    scale = 1e-6 * float(np.max(np.abs(Phi.T @ Y)))
    solves = np.max(np.abs(Phi.T @ (Y - Phi @ second.reshape(-1)))) <= scale
    return bool(solves and np.max(np.abs(Phi @ first)) <= scale)


def _directions(N: FloatArray, Phi: FloatArray, free: int) -> Verdict:
    parts = singular_values(Phi)
    if np.max(np.abs(Phi @ N), initial=0) > 1e-8 * parts.s[0] * max(np.max(np.abs(N), initial=0), 1e-300):
        Vt = np.linalg.svd(Phi)[2]
        if SAME(N, Vt[:, Vt.shape[0] - free :]):
            return Verdict(
                False,
                "N of `all_solutions` has columns of V', and columns of V are asked for. What numpy's `svd` returns is "
                "V'.",
                "V and V transposed confused",
                mend="Take its last *rows*.",
            )
        if N.shape[1] == free and np.linalg.matrix_rank(np.hstack([N, parts.V[:, :free]]), tol=1e-6) == free:
            return Verdict(
                False,
                "N of `all_solutions` contains the directions of the largest singular values.",
                "directions outside the null space",
                mend="Those of the null space belong to the zero ones, the last.",
            )
        return Verdict(
            False, "N of `all_solutions` changes Phi theta: Phi N should be zero. Check which columns of V it needs."
        )
    rank = int(np.linalg.matrix_rank(N)) if N.size else 0
    if N.size == 0:
        return Verdict(
            False,
            "N of `all_solutions` is empty. Where singular values are compared with zero: one that should be zero is "
            "computed as about 1e-16, so compare with a small tolerance, or take `np.linalg.matrix_rank`. Where "
            f"columns are counted: V has {Phi.shape[1]}, and the null space the last p - rank of them, here {free}.",
            "zero compared exactly",
        )
    if rank < free:
        return Verdict(
            False,
            f"N of `all_solutions` has {rank} independent column{'s' * (rank != 1)}; the null space of this Phi has "
            f"dimension p - rank = {free}.",
            "directions missing",
        )
    return Verdict(True, "")
