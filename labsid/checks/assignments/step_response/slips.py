"""The slips that students make in the least-squares appendix, (A1) to (A6), and what each would give."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.verdict import Slip
from labsid.least_squares.solve import loss, loss_gradient, solve_least_squares, two_equations

Slips = list[Slip[FloatArray]]

_TRANSPOSED = "takes Phi on its side: a row of Phi is an equation, a column an unknown."


def two_slips(U: FloatArray, Y: FloatArray) -> Slips:
    """Of (A2)."""
    (u11, u12), (u21, u22) = U
    y1, y2 = Y
    det, plus = u11 * u22 - u12 * u21, u11 * u22 + u12 * u21
    first, second = u22 * y1 - u12 * y2, u11 * y2 - u21 * y1
    wrong_sign = "`solve_two` has a sign wrong: compare the numerators with (A2)."
    return [
        Slip(
            "transposed",
            "`solve_two` takes u12 for u21: row i of U is equation i, so u12 is U[0, 1].",
            lambda: two_equations(U.T, Y),
        ),
        Slip(
            "sign of the determinant",
            "`solve_two` adds the two products of the determinant; subtract them.",
            lambda: np.array([first, second]) / plus,
        ),
        Slip(
            "sign of the determinant",
            "`solve_two` has the determinant with the other sign.",
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
    """Of (A4)."""
    return [
        Slip(
            "sign of the error",
            "`error_vector` has the other sign: E is what the model leaves of Y, Y - Phi theta.",
            lambda: Phi @ theta - Y,
        ),
        Slip(
            "the model's output in place of the error",
            "`error_vector` returns Phi theta, which is Y as the model has it: subtract it from Y.",
            lambda: Phi @ theta,
        ),
        Slip("squared errors", "`error_vector` returns the squared errors.", lambda: (Y - Phi @ theta) ** 2),
        Slip(
            "absolute errors",
            "`error_vector` drops the signs of the errors.",
            lambda: np.abs(Y - Phi @ theta),
        ),
        Slip("transposed Phi", f"`error_vector` {_TRANSPOSED}", lambda: Y - Phi.T @ theta),
    ]


def loss_slips(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> list[Slip[float]]:
    """Of (A5)."""
    V = loss(Phi, Y, theta)
    mean = "`loss` takes a mean of the squared errors; (A5) takes half their sum."
    root = "`loss` has a root in it: (A5) has the square of the norm."
    return [
        Slip(
            "the half forgotten",
            "`loss` is twice as large as (A5), which has a half in front.",
            lambda: 2 * V,
        ),
        Slip("mean in place of the sum", mean, lambda: 2 * V / Y.size),
        Slip("mean in place of the sum", mean, lambda: V / Y.size),
        Slip("norm not squared", root, lambda: float(np.sqrt(2 * V))),
        Slip("norm not squared", root, lambda: float(np.sqrt(2 * V)) / 2),
        Slip(
            "errors not squared",
            "`loss` adds up the errors without squaring them, so that they cancel.",
            lambda: float(np.sum(Y - Phi @ theta)) / 2,
        ),
        Slip("transposed Phi", f"`loss` {_TRANSPOSED}", lambda: loss(Phi.T, Y, theta)),
    ]


def gradient_slips(Phi: FloatArray, Y: FloatArray, theta: FloatArray) -> Slips:
    """Of the derivative of (A5), by (A6)."""
    right = loss_gradient(Phi, Y, theta)
    of_y, of_theta = Phi.T @ Y, Phi.T @ Phi @ theta
    uneven = (
        "`gradient` has one of its two terms too small or too large: differentiate each by (A6), then multiply "
        "both by the half."
    )
    return [
        Slip(
            "sign of the gradient",
            "`gradient` points downhill: it has the other sign. See the hint of step 8.",
            lambda: -right,
        ),
        Slip(
            "the half forgotten",
            "`gradient` is twice as large: the half of V cancels the 2 of (A6).",
            lambda: 2 * right,
        ),
        Slip(
            "the half kept",
            "`gradient` is half as large: the half of V cancels the 2 of (A6).",
            lambda: right / 2,
        ),
        Slip(
            "sign of the gradient",
            "`gradient` adds its two terms: look at their signs in V multiplied out.",
            lambda: of_y + of_theta,
        ),
        Slip("the 2 of (A6) forgotten", uneven, lambda: of_theta - of_y / 2),
        Slip("the 2 of (A6) forgotten", uneven, lambda: of_theta / 2 - of_y),
        Slip("the 2 of (A6) forgotten", uneven, lambda: of_theta - 2 * of_y),
        Slip("a term forgotten", "`gradient` lacks the term with Phi'Phi.", lambda: -of_y),
        Slip("a term forgotten", "`gradient` lacks the term with Y.", lambda: of_theta),
        Slip("transposed Phi", f"`gradient` {_TRANSPOSED}", lambda: loss_gradient(Phi.T, Y, theta)),
        Slip("transposed Phi", f"`gradient` {_TRANSPOSED}", lambda: Phi @ (Phi @ theta - Y)),
    ]


def minimum_slips(Phi: FloatArray, Y: FloatArray) -> Slips:
    """Of eq. (8)."""
    p = Phi.shape[1]
    return [
        Slip(
            "inverse forgotten",
            "`best_theta` multiplies by Phi'Phi; eq. (8) by its inverse.",
            lambda: Phi.T @ Phi @ Phi.T @ Y,
        ),
        Slip("only Phi'Y", "`best_theta` returns Phi'Y: multiply it by (Phi'Phi)^-1.", lambda: Phi.T @ Y),
        Slip("sign of theta", "`best_theta` has the other sign.", lambda: -solve_least_squares(Phi, Y).theta),
        Slip("transposed Phi", f"`best_theta` {_TRANSPOSED}", lambda: solve_least_squares(Phi.T, Y).theta),
        Slip("transposed Phi", f"`best_theta` {_TRANSPOSED}", lambda: np.linalg.inv(Phi @ Phi.T) @ Phi @ Y),
        Slip(
            "only as many equations as unknowns",
            "`best_theta` solves the first equations and leaves the others out; eq. (8) takes them all.",
            lambda: solve_least_squares(Phi[:p], Y[:p]).theta,
        ),
        Slip(
            "powers element by element",
            "`best_theta` inverts the elements of Phi'Phi one by one (`** -1`): take `np.linalg.inv`.",
            lambda: (Phi.T @ Phi) ** -1.0 @ Phi.T @ Y,
        ),
    ]
