"""Known mistakes in the least-squares appendix, (A1) to (A6), and the values that they give."""

from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.verdict import Slip
from labsid.least_squares.solve import loss, loss_gradient, solve_least_squares, two_equations

Slips = list[Slip[FloatArray]]

DIVIDED = "divided by a number of equations"
_ROWS = "a row of Phi is an equation, a column an unknown."
_BOTH_TURNED = "has Phi and Phi' in each other's places: it returns"


def two_slips(U: FloatArray, Y: FloatArray) -> Slips:
    """Mistakes in (A2)."""
    (u11, u12), (u21, u22) = U
    y1, y2 = Y
    det, plus = u11 * u22 - u12 * u21, u11 * u22 + u12 * u21
    first, second = u22 * y1 - u12 * y2, u11 * y2 - u21 * y1
    wrong_sign = "`solve_two` has a wrong sign: compare the numerators with (A2)."
    return [
        Slip(
            "transposed",
            "`solve_two` confuses u12 with u21: row i of U is equation i, so u12 is U[0, 1].",
            lambda: two_equations(U.T, Y),
        ),
        Slip(
            "sign of the determinant",
            "`solve_two` adds the two products of the determinant; subtract them.",
            lambda: np.array([first, second]) / plus,
        ),
        Slip(
            "sign of the determinant",
            "both results of `solve_two` have the wrong sign, as they have with the other sign of the determinant, or "
            "of "
            "both numerators.",
            lambda: np.array([first, second]) / -det,
        ),
        Slip(
            "not divided by the determinant",
            "`solve_two` returns the numerators of (A2): divide them by the determinant.",
            lambda: np.array([first, second]),
        ),
        Slip("a1 and a2 swapped", "`solve_two` returns a2 before a1.", lambda: np.array([second, first]) / det),
        Slip("sign in a numerator", wrong_sign, lambda: np.array([first, -second]) / det),
        Slip("sign in a numerator", wrong_sign, lambda: np.array([-first, second]) / det),
        Slip(
            "sign in a numerator",
            wrong_sign,
            lambda: np.array([u22 * y1 + u12 * y2, u11 * y2 + u21 * y1]) / det,
        ),
    ]


def error_slips(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> Slips:
    """Mistakes in (A4)."""
    return [
        Slip(
            "product entry by entry",
            "`error_vector` multiplies Phi and theta entry by entry (`*`): their product is `Phi @ theta`.",
            lambda: Y - (Phi * theta)[:, 0],
        ),
        Slip(
            "sign of the error",
            "`error_vector` has the wrong sign: E is Y - Phi theta.",
            lambda: Phi @ theta - Y,
        ),
        Slip(
            "model output in place of the error",
            "`error_vector` returns the model output Phi theta: subtract it from Y.",
            lambda: Phi @ theta,
        ),
        Slip(
            "squared errors",
            "`error_vector` returns the squared errors: do not square them.",
            lambda: (Y - Phi @ theta) ** 2,
        ),
        Slip(
            "absolute errors",
            "`error_vector` returns absolute errors: keep their signs.",
            lambda: np.abs(Y - Phi @ theta),
        ),
        Slip(
            "transposed Phi",
            f"`error_vector` multiplies theta by the transpose, Phi'; (A4) has Phi theta, not transposed: {_ROWS}",
            lambda: Y - Phi.T @ theta,
        ),
        *(
            Slip(
                "an unknown left out",
                f"`error_vector` leaves out column {j} of Phi (counted from 0) and its unknown: Phi theta has a term "
                "for each.",
                partial(_without_column, Phi, Y, theta, j),
            )
            for j in range(theta.size)
        ),
    ]


def _without_column(Phi: FloatArray, Y: FloatArray, theta: FloatArray, j: int) -> FloatArray:
    return np.asarray(Y - Phi @ np.where(np.arange(theta.size) == j, 0.0, theta), np.float64)


def loss_slips(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> list[Slip[float]]:
    """Mistakes in (A5)."""
    V = loss(Phi, Y, theta)
    mean = "`loss` is a mean of the squared errors; (A5) is half their sum."
    root = "`loss` contains a root; (A5) is half the square of the norm."
    return [
        Slip(
            "the half forgotten",
            "`loss` is twice as large as (A5), which has a factor 1/2.",
            lambda: 2 * V,
        ),
        Slip("mean in place of the sum", mean, lambda: 2 * V / Y.size),
        Slip("mean in place of the sum", mean, lambda: V / Y.size),
        Slip("norm not squared", root, lambda: float(np.sqrt(2 * V))),
        Slip("norm not squared", root, lambda: float(np.sqrt(2 * V)) / 2),
        Slip(
            "errors not squared",
            "`loss` adds the errors without squaring them, so that they cancel.",
            lambda: float(np.sum(Y - Phi @ theta)) / 2,
        ),
        *(
            Slip(
                "errors not squared",
                "`loss` adds absolute errors; (A5) has their squares.",
                partial(float, factor * float(np.sum(np.abs(Y - Phi @ theta)))),
            )
            for factor in (0.5, 1.0)
        ),
        *(
            Slip(
                "sum before the square",
                "`loss` squares the *sum* of the errors, in which they cancel: square each of them, then add up.",
                partial(float, factor * float(np.sum(Y - Phi @ theta)) ** 2),
            )
            for factor in (0.5, 1.0, 1 / Y.size, 0.5 / Y.size)
        ),
        Slip(
            "transposed Phi",
            f"`loss` multiplies theta by the transpose, Phi'; (A5) has Phi theta, not transposed: {_ROWS}",
            lambda: loss(Phi.T, Y, theta),
        ),
    ]


def gradient_slips(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> Slips:
    """Mistakes in the derivative of (A5), by (A6)."""
    right = loss_gradient(Phi, Y, theta)
    of_y, of_theta = Phi.T @ Y, Phi.T @ Phi @ theta
    uneven = (
        "one of the two terms of `gradient` has a wrong factor: differentiate each by (A6), then multiply both by 1/2."
    )
    return [
        Slip(
            "sign of the gradient",
            "`gradient` has the wrong sign: it points downhill. See the hint of step 8.",
            lambda: -right,
        ),
        Slip(
            "the half forgotten",
            "`gradient` is twice too large: the 1/2 of V cancels the 2 of (A6).",
            lambda: 2 * right,
        ),
        Slip(
            "the half kept",
            "`gradient` is half the right value: the 1/2 of V cancels the 2 of (A6).",
            lambda: right / 2,
        ),
        *(
            Slip(
                DIVIDED,
                f"`gradient` is {what} divided by {count}, as many as there are {of_what}: V is half the *sum* of the "
                "squared errors and no mean, so nothing is divided.",
                partial(np.multiply, right, factor / count),
            )
            for count, of_what in ((Y.size, "equations"), (theta.size, "unknowns"))
            for what, factor in (("the right one", 1), ("twice the right one", 2), ("half the right one", 0.5))
        ),
        Slip(
            "gradient of the norm",
            "`gradient` is divided by the norm of the errors: that is the derivative of the norm, and V is half its "
            "square.",
            lambda: right / float(np.linalg.norm(Y - Phi @ theta)),
        ),
        Slip(
            "sign of the gradient",
            "`gradient` adds its two terms, Phi'Phi theta and Phi'Y: in the derivative their signs differ.",
            lambda: of_y + of_theta,
        ),
        Slip("the 2 of (A6) forgotten", uneven, lambda: of_theta - of_y / 2),
        Slip("the 2 of (A6) forgotten", uneven, lambda: of_theta / 2 - of_y),
        Slip("the 2 of (A6) forgotten", uneven, lambda: of_theta - 2 * of_y),
        Slip(
            "Phi' before Y forgotten",
            "`gradient` subtracts entries of Y where (A6) has Phi'Y: Y has one entry for each equation, Phi'Y one for "
            "each unknown.",
            lambda: of_theta - Y[: theta.size],
        ),
        Slip("a term forgotten", "`gradient` lacks the term with Phi'Phi.", lambda: -of_y),
        Slip("a term forgotten", "`gradient` lacks the term with Y.", lambda: of_theta),
        Slip(
            "second factor not transposed",
            "`gradient` multiplies Y by Phi; the derivative of theta'Phi'Y is Phi'Y.",
            lambda: of_theta - Phi @ Y,
        ),
        Slip(
            "Phi Phi' for Phi'Phi",
            "`gradient` has Phi Phi', N by N, where Phi'Phi, p by p, belongs.",
            lambda: Phi @ Phi.T @ theta - of_y,
        ),
        Slip(
            "transposed Phi",
            f"`gradient` {_BOTH_TURNED} Phi (Phi' theta - Y). The errors hold Phi theta, and Phi' stands before them.",
            lambda: loss_gradient(Phi.T, Y, theta),
        ),
        Slip(
            "Phi' before the errors forgotten",
            "`gradient` multiplies the errors by Phi itself; they should be multiplied by its transpose, Phi'. Entry j "
            "of the gradient takes column j of Phi, which is unknown j in every equation.",
            lambda: Phi @ (Phi @ theta - Y),
        ),
    ]


def minimum_slips(Phi: FloatArray, Y: FloatArray) -> Slips:
    """Mistakes in eq. (8)."""
    p = Phi.shape[1]
    return [
        Slip(
            "inverse forgotten",
            "`best_theta` multiplies by Phi'Phi; eq. (8) multiplies by its inverse.",
            lambda: Phi.T @ Phi @ Phi.T @ Y,
        ),
        Slip("only Phi'Y", "`best_theta` returns Phi'Y: multiply it by (Phi'Phi)^-1.", lambda: Phi.T @ Y),
        Slip("sign of theta", "`best_theta` has the wrong sign.", lambda: -solve_least_squares(Phi, Y).theta),
        *(
            Slip(
                "transposed Phi",
                f"`best_theta` {_BOTH_TURNED} (Phi Phi')^-1 Phi Y. Eq. (8) is (Phi'Phi)^-1 Phi'Y.",
                wrong,
            )
            for wrong in (
                lambda: solve_least_squares(Phi.T, Y).theta,
                lambda: np.linalg.inv(Phi @ Phi.T) @ Phi @ Y,
            )
        ),
        Slip(
            "Phi Phi' for Phi'Phi",
            "`best_theta` inverts Phi Phi', N by N; eq. (8) inverts Phi'Phi, p by p.",
            lambda: np.linalg.inv(Phi @ Phi.T) @ Phi.T @ Y,
        ),
        Slip(
            "Phi Phi' for Phi'Phi",
            "`best_theta` inverts Phi Phi', N by N; eq. (8) inverts Phi'Phi, p by p.",
            lambda: Phi.T @ np.linalg.inv(Phi @ Phi.T) @ Y,
        ),
        Slip(
            "second factor not transposed",
            "`best_theta` multiplies Y by Phi; eq. (8) multiplies it by Phi'.",
            lambda: np.linalg.inv(Phi.T @ Phi) @ Phi @ Y,
        ),
        Slip(
            "Phi' before Y forgotten",
            "`best_theta` multiplies the inverse of Phi'Phi by Y itself; eq. (8) has Phi'Y there.",
            lambda: np.linalg.inv(Phi.T @ Phi) @ Y,
        ),
        Slip(
            "product entry by entry",
            "`best_theta` multiplies Phi' and Phi entry by entry (`*`): products of matrices are `@`.",
            lambda: np.linalg.inv(Phi.T * Phi) @ Phi.T @ Y,
        ),
        Slip(
            "only as many equations as unknowns",
            "`best_theta` solves only the first equations; eq. (8) uses all of them.",
            lambda: solve_least_squares(Phi[:p], Y[:p]).theta,
        ),
        Slip(
            "powers element by element",
            "`best_theta` inverts the elements of Phi'Phi one by one (`** -1`): use `np.linalg.inv`.",
            lambda: (Phi.T @ Phi) ** -1.0 @ Phi.T @ Y,
        ),
    ]
