"""Derivatives with respect to a vector: Ax, x'Ax, (x'x) x, along a direction, and by finite differences."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_matrix, as_signal, as_square

# The error of central differences, h^2 f'''/6 + eps f/h, is smallest near the cube root of the rounding unit.
STEP = float(np.finfo(float).eps ** (1 / 3))

VectorFunction = Callable[[FloatArray], ArrayLike]


def jacobian_linear(A: ArrayLike) -> FloatArray:
    """Differentiate ``f(x) = A x``: the Jacobian is A for every x.

    Parameters
    ----------
    A : array_like, shape (m, n)

    Returns
    -------
    ndarray, shape (m, n)
        ``df_i/dx_j``.

    Notes
    -----
    SUSTech lecture, calculus examples.
    """
    return as_matrix("A", A).copy()


def gradient_quadratic(A: ArrayLike, x: ArrayLike) -> FloatArray:
    """Differentiate ``f(x) = x'A x``: the gradient is ``A'x + A x``, and ``2 A x`` for symmetric A.

    Parameters
    ----------
    A : array_like, shape (n, n)
    x : array_like, shape (n,)

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    ValueError
        If A is not square or the size of x differs.

    Notes
    -----
    SUSTech lecture, calculus examples.
    """
    A, x = as_square("A", A), as_signal("x", x)
    if x.size != A.shape[0]:
        raise ValueError(f"x must have as many entries as A has rows ({A.shape[0]}); got {x.size}.")
    gradient: FloatArray = A.T @ x + A @ x
    return gradient


def jacobian_cubic(x: ArrayLike) -> FloatArray:
    """Differentiate ``f(x) = (x'x) x``: the Jacobian is ``(x'x) I + 2 x x'``.

    Parameters
    ----------
    x : array_like, shape (n,)

    Returns
    -------
    ndarray, shape (n, n)

    Notes
    -----
    SUSTech lecture, the exercise after the calculus examples. The product rule: the scalar x'x times the
    identity, plus the column x times the row 2 x'.
    """
    x = as_signal("x", x)
    jacobian: FloatArray = (x @ x) * np.eye(x.size) + 2 * np.outer(x, x)
    return jacobian


def gradient_of_sse(H: ArrayLike, y: ArrayLike, theta: ArrayLike) -> FloatArray:
    """Differentiate ``J(theta) = |y - H theta|^2``: the gradient is ``2 H'H theta - 2 H'y``.

    Parameters
    ----------
    H : array_like, shape (m, n)
    y : array_like, shape (m,)
    theta : array_like, shape (n,)

    Returns
    -------
    ndarray, shape (n,)
        Zero if and only if the normal equations hold.

    Raises
    ------
    ValueError
        If the shapes do not match.

    Notes
    -----
    SUSTech lecture, "Derivation of linear least square solutions"; Reading notes, "An alternative proof". Twice
    `labsid.least_squares.solve.loss_gradient`, because the lab's loss is half the sum of squares.
    """
    H, y, theta = as_matrix("H", H), as_signal("y", y), as_signal("theta", theta)
    if H.shape != (y.size, theta.size):
        raise ValueError(
            f"H must have a row for each of y ({y.size}) and a column for each of theta ({theta.size}); got "
            f"shape {H.shape}."
        )
    gradient: FloatArray = -2 * H.T @ (y - H @ theta)
    return gradient


def directional_derivative(f: VectorFunction, x: ArrayLike, d: ArrayLike) -> FloatArray:
    """Differentiate f at x along d numerically: the slope of ``g(alpha) = f(x + alpha d)`` at zero.

    Parameters
    ----------
    f : callable
        Takes x, returns a number or a vector of m numbers.
    x : array_like, shape (n,)
    d : array_like, shape (n,)
        The direction; it is not normalized.

    Returns
    -------
    ndarray, shape () or (m,)
        ``Df(x; d)``; for a scalar f, the gradient times d.

    Raises
    ------
    ValueError
        If x and d differ in length or d is zero.

    Notes
    -----
    SUSTech lecture, "Directional derivative". Central differences.
    """
    x, d = as_signal("x", x), as_signal("d", d)
    if d.size != x.size or not np.any(d):
        raise ValueError(f"d must be a direction with {x.size} entries, not all zero; got {d.tolist()}.")
    h = STEP * max(1.0, float(np.max(np.abs(x)))) / float(np.max(np.abs(d)))
    slope: FloatArray = (np.asarray(f(x + h * d), float) - np.asarray(f(x - h * d), float)) / (2 * h)
    return slope


def numerical_jacobian(f: VectorFunction, x: ArrayLike) -> FloatArray:
    """Compute the Jacobian of f at x numerically, to check a derivative found by hand.

    Parameters
    ----------
    f : callable
        Takes x, returns a number or a vector of m numbers.
    x : array_like, shape (n,)

    Returns
    -------
    ndarray, shape (n,) or (m, n)
        ``df_i/dx_j``; for a scalar f its gradient.

    Notes
    -----
    SUSTech lecture: the partial derivative is the directional derivative along an axis. Central differences,
    accurate to about 1e-10 for f and x of order one.
    """
    x = as_signal("x", x)
    return np.stack([directional_derivative(f, x, axis) for axis in np.eye(x.size)], axis=-1)
