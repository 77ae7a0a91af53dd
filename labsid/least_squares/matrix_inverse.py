"""Matrix inverses: adjoint, Cayley-Hamilton, eigenvectors, the matrix inversion lemma, A (I + A)^-1."""

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_matrix, as_square
from labsid.least_squares.linear_algebra import is_symmetric, singular_values


def cofactors(A: ArrayLike) -> FloatArray:
    """Compute the cofactors: ``(-1)^(i+j)`` times the determinant of A without row i and column j.

    Parameters
    ----------
    A : array_like, shape (n, n)

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    ValueError
        If A is not a finite square matrix.

    Notes
    -----
    Reading notes, appendix, "Matrix inverse". For n = 1 the cofactor is 1.
    """
    A = as_square("A", A)
    n = A.shape[0]
    minors = [[np.linalg.det(np.delete(np.delete(A, i, 0), j, 1)) for j in range(n)] for i in range(n)]
    signs = (-1.0) ** np.add.outer(np.arange(n), np.arange(n))
    table: FloatArray = signs * np.array(minors)
    return table


def adjoint(A: ArrayLike) -> FloatArray:
    """Compute the adjoint (adjugate) X, the transposed cofactors: ``X A = A X = |A| I``.

    Parameters
    ----------
    A : array_like, shape (n, n)

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    ValueError
        If A is not a finite square matrix.

    Notes
    -----
    Reading notes, appendix, "Matrix inverse". It exists for singular matrices, too.
    """
    return cofactors(A).T


def inverse_by_adjoint(A: ArrayLike) -> FloatArray:
    """Invert A as adjoint over determinant; ``[[d, -b], [-c, a]] / (a d - b c)`` for 2 by 2.

    Parameters
    ----------
    A : array_like, shape (n, n)

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    ValueError
        If A is singular.

    Notes
    -----
    Reading notes, appendix, "Matrix inverse". For hand calculation; the n^2 determinants cost far more than
    ``numpy.linalg.inv``.
    """
    A = _nonsingular("A", A)
    X = adjoint(A)
    # A X = |A| I: the first row of A times the first column of X is the determinant.
    return X / (A[0] @ X[:, 0])


def characteristic_polynomial(A: ArrayLike) -> FloatArray:
    """Compute the coefficients of the characteristic polynomial ``|sI - A|``.

    Parameters
    ----------
    A : array_like, shape (n, n)

    Returns
    -------
    ndarray, shape (n + 1,)
        ``[1, c1, ..., cn]`` of ``s^n + c1 s^(n-1) + ... + cn``; its roots are the eigenvalues.

    Raises
    ------
    ValueError
        If A is not a finite square matrix.

    Notes
    -----
    Reading notes, appendix, "Note on Cayley-Hamilton Theorem". Leverrier's recursion: M1 = I,
    c_k = -trace(A M_k) / k, M_(k+1) = A M_k + c_k I; by the theorem, M_(n+1) = 0.
    """
    A = as_square("A", A)
    coefficients = [1.0]
    M = np.eye(A.shape[0])
    for k in range(1, A.shape[0] + 1):
        coefficients.append(-float(np.trace(A @ M)) / k)
        M = A @ M + coefficients[-1] * np.eye(A.shape[0])
    return np.array(coefficients)


def inverse_by_cayley_hamilton(A: ArrayLike) -> FloatArray:
    """Invert A as a polynomial in A: ``A^-1 = -(A^(n-1) + c1 A^(n-2) + ... + c(n-1) I) / cn``.

    Parameters
    ----------
    A : array_like, shape (n, n)

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    ValueError
        If A is singular.

    Notes
    -----
    Reading notes, appendix, "Note on Cayley-Hamilton Theorem": A satisfies its characteristic equation
    ``A^n + c1 A^(n-1) + ... + cn I = 0``; multiply by ``A^-1`` and solve for it.
    """
    A = _nonsingular("A", A)
    *upper, last = characteristic_polynomial(A)
    powers = np.zeros_like(A)
    for c in upper:  # Horner's scheme
        powers = A @ powers + c * np.eye(A.shape[0])
    return -powers / last


def inverse_by_eigenvectors(A: ArrayLike) -> FloatArray:
    """Invert a symmetric matrix through its eigenvectors: ``A^-1 = V D^-1 V'``.

    Parameters
    ----------
    A : array_like, shape (n, n)
        Symmetric.

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    ValueError
        If A is not symmetric or is singular.

    Notes
    -----
    Reading notes, appendix, "Eigenvalues and eigenvectors". Errata: printed as ``V' D^-1 V``; A V = V D and
    V^-1 = V' give A = V D V'.
    """
    A = _nonsingular("A", A)
    if not is_symmetric(A):
        raise ValueError(f"A must be symmetric; got entries of A - A' up to {np.max(np.abs(A - A.T)):.3g}.")
    eigenvalues, V = np.linalg.eigh(A)
    inverse: FloatArray = (V / eigenvalues) @ V.T
    return inverse


def inversion_lemma(A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> FloatArray:
    """Invert a sum by the matrix inversion lemma.

    Parameters
    ----------
    A : array_like, shape (n, n)
    B : array_like, shape (n, k)
    C : array_like, shape (k, k)
    D : array_like, shape (k, n)

    Returns
    -------
    ndarray, shape (n, n)
        ``(A + B C D)^-1 = A^-1 - A^-1 B (C^-1 + D A^-1 B)^-1 D A^-1``.

    Raises
    ------
    ValueError
        If the shapes do not match, or A, C or ``A + B C D`` is singular.

    Notes
    -----
    Reading notes, lecture 5. Errata: printed for nonsingular A, C and BCD; required are A, C and A + BCD (in RLS
    ``B C D = phi phi'`` has rank one). If ``A^-1`` is known, only a k by k matrix must be inverted: a scalar in RLS.
    """
    A, C = _nonsingular("A", A), _nonsingular("C", C)
    B, D = as_matrix("B", B), as_matrix("D", D)
    n, k = A.shape[0], C.shape[0]
    if B.shape != (n, k) or D.shape != (k, n):
        raise ValueError(
            f"B and D must have shapes {(n, k)} and {(k, n)} to go with A and C; got {B.shape} and {D.shape}."
        )
    _nonsingular("A + B C D", A + B @ C @ D)
    A_inverse = np.linalg.inv(A)
    small = np.linalg.inv(C) + D @ A_inverse @ B
    return (A_inverse - A_inverse @ B @ np.linalg.solve(small, D @ A_inverse)).astype(np.float64)


def closed_loop_gain(A: ArrayLike) -> FloatArray:
    """Compute ``A (I + A)^-1 = (I + A)^-1 A``, the gain of the closed loop.

    Parameters
    ----------
    A : array_like, shape (n, n)
        Gain of the open loop, under negative feedback.

    Returns
    -------
    ndarray, shape (n, n)

    Raises
    ------
    ValueError
        If ``I + A`` is singular.

    Notes
    -----
    Reading notes, appendix, "Interesting identity": multiplied by ``I + A`` from the left and from the right, both
    sides equal ``A + A^2``.
    """
    A = as_square("A", A)
    loop = _nonsingular("I + A", np.eye(A.shape[0]) + A)
    return np.linalg.solve(loop, A).astype(np.float64)


def _nonsingular(name: str, values: ArrayLike) -> FloatArray:
    A = as_square(name, values)
    rank = singular_values(A).rank
    if rank < A.shape[0]:
        raise ValueError(
            f"{name} must be nonsingular; got rank {rank} of {A.shape[0]}. A singular matrix has no inverse; "
            "for least squares use pseudo_inverse."
        )
    return A
