"""The matrix appendix: rank, condition, eigenvalues, singular values, pseudo-inverse, matrix types."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_matrix, as_signal, as_square, freeze


@dataclass(frozen=True, slots=True, eq=False)
class SingularValues:
    """The decomposition ``A = U diag(s) V'``, with the rank and condition number of A.

    Attributes
    ----------
    U : ndarray, shape (m, k)
        Orthonormal columns, k = min(m, n).
    s : ndarray, shape (k,)
        Singular values, largest first.
    V : ndarray, shape (n, k)
        Orthonormal columns.
    rank : int
        Number of singular values above ``max(m, n) * eps`` times the largest.
    condition_number : float
        Largest over smallest singular value; infinite if the smallest is zero.
    """

    U: FloatArray
    s: FloatArray
    V: FloatArray
    rank: int
    condition_number: float

    def __post_init__(self) -> None:
        freeze(self, U=self.U, s=self.s, V=self.V)


def singular_values(A: ArrayLike) -> SingularValues:
    """Compute the singular value decomposition, rank and condition number of A.

    Parameters
    ----------
    A : array_like, shape (m, n)

    Returns
    -------
    SingularValues

    Raises
    ------
    ValueError
        If A is not a finite matrix.

    Notes
    -----
    Reading notes, appendix, "Singular value decomposition" and "Note on numerical computation". The condition
    number kappa bounds the relative error of the solution of ``A x = b``: a relative error of b is amplified by at
    most kappa if A is square, and in least squares by at most ``kappa / cos(alpha)``, where alpha is the angle between
    b and the column space of A.
    """
    A = as_matrix("A", A)
    U, s, Vt = np.linalg.svd(A, full_matrices=False)
    rank = int(np.sum(s > max(A.shape) * np.finfo(float).eps * s[0]))
    condition_number = float(s[0] / s[-1]) if s[-1] > 0 else np.inf
    return SingularValues(U, s, Vt.T, rank, condition_number)


def singular_values_by_eigenvalues(A: ArrayLike) -> FloatArray:
    """Compute the singular values by their definition in the notes, ``s_i = sqrt(lambda_i(A'A))``.

    Parameters
    ----------
    A : array_like, shape (m, n)

    Returns
    -------
    s : ndarray, shape (n,)
        Largest first.

    Raises
    ------
    ValueError
        If A is not a finite matrix.

    Notes
    -----
    Reading notes, appendix, "Singular value decomposition". For teaching: forming A'A loses the singular values
    below about 1e-8 of the largest, which `singular_values` preserves.
    """
    A = as_matrix("A", A)
    eigenvalues = np.linalg.eigvalsh(A.T @ A)[::-1]
    return np.sqrt(np.maximum(eigenvalues, 0))  # rounding can make a zero slightly negative


def pseudo_inverse(A: ArrayLike) -> FloatArray:
    """Compute the Moore-Penrose inverse ``A+ = V diag(1/s) U'`` from the nonzero singular values.

    Parameters
    ----------
    A : array_like, shape (m, n)

    Returns
    -------
    ndarray, shape (n, m)
        ``A+ y`` is the least-squares solution of ``A x = y`` of minimum norm.

    Raises
    ------
    ValueError
        If A is not a finite matrix.

    Notes
    -----
    Reading notes, function table. Errata: printed as ``(A A')^-1 A'``; correct is ``(A'A)^-1 A'`` for full column
    rank (and ``A' (A A')^-1`` for full row rank).
    """
    parts = singular_values(A)
    k = parts.rank
    inverse: FloatArray = (parts.V[:, :k] / parts.s[:k]) @ parts.U[:, :k].T
    return inverse


def eigenvalues_2x2(A: ArrayLike) -> NDArray[np.complex128]:
    """Compute the eigenvalues of a 2 by 2 matrix in closed form.

    Parameters
    ----------
    A : array_like, shape (2, 2)
        ``[[a, b], [c, d]]``.

    Returns
    -------
    ndarray of complex, shape (2,)
        ``(a + d)/2 +- sqrt(a^2 - 2 a d + d^2 + 4 b c)/2``, the plus sign first.

    Raises
    ------
    ValueError
        If A is not a finite 2 by 2 matrix.

    Notes
    -----
    Reading notes, appendix, "Things to do with 2x2 matrices". Errata: the printed root ends after ``2 a d``;
    it covers all four terms. The eigenvalues are real if and only if ``(a - d)^2 + 4 b c >= 0``.
    """
    A = as_square("A", A)
    if A.shape != (2, 2):
        raise ValueError(f"A must have shape (2, 2); got {A.shape}. For larger matrices use numpy.linalg.eigvals.")
    (a, b), (c, d) = A
    root = np.sqrt(complex((a - d) ** 2 + 4 * b * c))
    return np.array([(a + d + root) / 2, (a + d - root) / 2])


def partitioned_product(D: ArrayLike, f: ArrayLike, G: ArrayLike, h: ArrayLike) -> FloatArray:
    """Multiply ``A = [D | f]`` by ``B = [G; h']`` block by block: ``A B = D G + f h'``.

    Parameters
    ----------
    D : array_like, shape (m, k)
    f : array_like, shape (m,)
        The last column of A.
    G : array_like, shape (k, n)
    h : array_like, shape (n,)
        The last row of B.

    Returns
    -------
    ndarray, shape (m, n)

    Raises
    ------
    ValueError
        If the shapes do not match.

    Notes
    -----
    Reading notes, appendix, "Multiplication of partitioned matrices". Errata: printed as the stack
    ``[D G; f h']``; the two products are added. With ``A = Phi'`` and ``B = Phi`` it is eq. (8): one more
    sample adds the outer product of its regressor to ``Phi'Phi``.
    """
    D, G = as_matrix("D", D), as_matrix("G", G)
    f, h = as_signal("f", f), as_signal("h", h)
    if D.shape[1] != G.shape[0] or D.shape[0] != f.size or G.shape[1] != h.size:
        raise ValueError(
            "[D | f] and [G; h'] must fit: D (m, k), f (m,), G (k, n), h (n,); got "
            f"{D.shape}, {f.shape}, {G.shape}, {h.shape}."
        )
    product: FloatArray = D @ G + np.outer(f, h)
    return product


def is_symmetric(A: ArrayLike, tolerance: float = 1e-12) -> bool:
    """Test whether ``A = A'``.

    Parameters
    ----------
    A : array_like, shape (n, n)
    tolerance : float
        Difference allowed, relative to the largest entry.

    Returns
    -------
    bool

    Notes
    -----
    Reading notes, appendix, "Matrix types".
    """
    A = as_square("A", A)
    return bool(np.max(np.abs(A - A.T)) <= tolerance * np.max(np.abs(A)))


def is_skew_symmetric(A: ArrayLike, tolerance: float = 1e-12) -> bool:
    """Test whether ``A = -A'``; then ``x'A x = 0`` for every x.

    Parameters
    ----------
    A : array_like, shape (n, n)
    tolerance : float
        Difference allowed, relative to the largest entry.

    Returns
    -------
    bool

    Notes
    -----
    Reading notes, appendix, "Matrix types".
    """
    A = as_square("A", A)
    return bool(np.max(np.abs(A + A.T)) <= tolerance * np.max(np.abs(A)))


def is_orthogonal(A: ArrayLike, tolerance: float = 1e-12) -> bool:
    """Test whether ``A'A = I``; then ``|A x| = |x|`` for every x.

    Parameters
    ----------
    A : array_like, shape (n, n)
    tolerance : float
        Largest entry allowed in ``|A'A - I|``.

    Returns
    -------
    bool

    Notes
    -----
    Reading notes, appendix, "Orthogonal matrices".
    """
    A = as_square("A", A)
    return bool(np.max(np.abs(A.T @ A - np.eye(A.shape[0]))) <= tolerance)


def symmetric_and_skew(A: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Split a square matrix into its symmetric and its skew-symmetric part.

    Parameters
    ----------
    A : array_like, shape (n, n)

    Returns
    -------
    symmetric, skew : ndarray, shape (n, n)
        ``(A + A')/2`` and ``(A - A')/2``; they add up to A.

    Notes
    -----
    Reading notes, appendix, "Matrix types". A quadratic form depends on the symmetric part only.
    """
    A = as_square("A", A)
    return (A + A.T) / 2, (A - A.T) / 2
