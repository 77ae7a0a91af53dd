"""Checks of the projection onto the columns of Phi, and of all solutions for a rank-deficient Phi."""

from collections.abc import Iterator

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_array, as_matrix, as_theta
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.trials import trial_equations
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.least_squares.linear_algebra import singular_values
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
        what = "pseudo-inverse" if shape == (p, n) else "p by p matrix Phi'Phi or its inverse"
        return Verdict(
            False,
            f"`projector` returns a {shape[0]} by {shape[1]} matrix: this is the shape of "
            f"the {what}. P maps Y to Y_hat = Phi theta, both with {n} entries.",
            "pseudo-inverse instead of the projector" if shape == (p, n) else "p by p matrix instead of the projector",
            mend="Multiply by Phi from the left.",
        )
    return judge(
        as_matrix("projector(Phi)", value, (n, n)),
        P,
        SAME,
        "it projects onto the columns of any Phi, and P P = P.",
        "`projector` does not return the P with Y_hat = P Y. Check whether P P = P and P Phi = Phi.",
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
                "divided by a norm",
                "`projector` divides Phi Phi' by the square of a norm, which is right for a single column only.",
                lambda: Phi @ Phi.T / np.linalg.norm(Phi) ** 2,
                mend="(Phi'Phi)^-1 belongs in the middle.",
            ),
            Slip(
                "identity",
                "`projector` returns the identity, which has rank n; P has the rank of Phi.",
                lambda: np.eye(n),
            ),
        ],
    )


@first_failure
def check_all_solutions(ask: Ask) -> Iterator[Verdict]:
    """`all_solutions(Phi, Y)`: the shortest theta and a basis of the null space of Phi."""
    for n, p, rank in ((6, 3, 2), (8, 4, 2), (7, 4, 3)):
        Phi = np.zeros((n, p))
        while singular_values(Phi).rank < rank:
            # small integers: dependent columns without rounding
            Phi = ask.rng.integers(-3, 4, (n, rank)) @ ask.rng.integers(-2, 3, (rank, p)).astype(float)
        yield _solutions(ask, Phi, ask.rng.uniform(-5, 5, n))
    yield Verdict(True, "the shortest theta, and every direction that leaves Phi theta unchanged.")


def _solutions(ask: Ask, Phi: FloatArray, Y: FloatArray) -> Verdict:
    p = Phi.shape[1]
    right = solution_set(Phi, Y)
    free = p - right.rank
    parts = returned_parts(ask, "all_solutions", "theta and the matrix N", 2, Phi, Y)
    theta = as_theta("theta of all_solutions(Phi, Y)", parts[0], p)
    scale = 1e-6 * float(np.max(np.abs(Phi.T @ Y)))
    if np.max(np.abs(Phi.T @ (Y - Phi @ theta))) > scale:
        return judge(
            theta,
            right.theta,
            SAME,
            "",
            "theta of `all_solutions` does not solve the normal equations. (`inv` of a singular Phi'Phi fails or, "
            "by rounding, gives wrong values.)",
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
    if N.shape == (p, right.rank) and free != right.rank:
        return Verdict(
            False,
            f"N of `all_solutions` has rank(Phi) columns. The null space has p - rank = {free} directions.",
            "directions outside the null space",
            mend="They are the other columns of V.",
        )
    return _directions(as_matrix("N of all_solutions(Phi, Y)", N, (p, None)), Phi, free)


def _directions(N: FloatArray, Phi: FloatArray, free: int) -> Verdict:
    parts = singular_values(Phi)
    if np.max(np.abs(Phi @ N), initial=0) > 1e-8 * parts.s[0] * max(np.max(np.abs(N), initial=0), 1e-300):
        Vt = np.linalg.svd(Phi)[2]
        if SAME(N, Vt[:, Vt.shape[0] - free :]):
            return Verdict(
                False,
                "N of `all_solutions` has columns of V'. numpy's `svd` returns V transposed.",
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
    found = int(np.linalg.matrix_rank(N)) if N.size else 0
    if found < free:
        return Verdict(
            False,
            f"N of `all_solutions` has {found} independent columns; the null space of this Phi has dimension p - "
            f"rank = {free}.",
            "directions missing",
        )
    return Verdict(True, "")
