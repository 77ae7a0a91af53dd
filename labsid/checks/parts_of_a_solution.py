"""Answers that are a part of the solution of M x = v, combine its parts entry by entry, or solve with another M."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import close
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer

_same = close(1e-6)
_PARALLEL = 1e-5
"""Relative: a residual along the answer, to rounding."""


def require_whole_solution(
    name: str,
    value: Value,
    M: FloatArray,
    v: FloatArray,
    terms: tuple[str, str] = ("Phi'Phi", "Phi'Y"),
    before_y: FloatArray | None = None,
) -> None:
    """Refuse a matrix in the place of the solution, and say which part of it this is; or a solution with M + mu I.

    Parameters
    ----------
    name : str
        The answer, as its messages call it.
    value : object
    M, v : ndarray
        Of the equations ``M x = v``, in which no student's value stands.
    terms : tuple of str
        What M and v are called in the question.
    before_y : ndarray, optional
        The matrix whose product with Y is v.
    """
    if not isinstance(value, np.ndarray) or value.size == 1 or value.dtype.kind not in "iuf":
        return
    if value.size == v.size:
        require_no_ridge(name, np.ravel(value).astype(float), M, v, terms)
    if value.shape != M.shape and (before_y is None or value.shape != before_y.shape):
        return
    try:
        inverse = np.linalg.inv(M)
    except np.linalg.LinAlgError:
        return
    M_name, v_name = terms
    if before_y is not None and value.shape == before_y.shape and _same(value, inverse @ before_y):
        left = v_name.removesuffix("Y").rstrip()
        raise NoAnswer(
            f"`{name}` is the inverse of {M_name} times {left} alone: the product with Y is missing.", "Y left out"
        )
    if value.shape != M.shape:
        return
    if _same(value, inverse):
        raise NoAnswer(
            f"`{name}` is the inverse of {M_name} alone: the product with {v_name} is missing.", "only the inverse"
        )
    if _same(value, M):
        raise NoAnswer(f"`{name}` is {M_name} alone: its inverse is multiplied by {v_name}.", "only the matrix")
    if any(_same(value, inverse * side) for side in (v, v[:, np.newaxis])):
        raise NoAnswer(
            f"`{name}` multiplies the inverse of {M_name} and {v_name} entry by entry (`*`): the product of a "
            "matrix and a vector is `@`.",
            "inverse times the right side entry by entry",
        )


def require_no_ridge(
    name: str, x: FloatArray, M: FloatArray, v: FloatArray, terms: tuple[str, str] = ("Phi'Phi", "Phi'Y")
) -> None:
    """Refuse a solution of (M + mu I) x = v, unless it is right to six digits; M may be singular.

    The parameters are those of `require_whole_solution`.
    """
    rest, size = v - M @ x, float(x @ x)
    if not np.isfinite(rest).all() or size == 0:
        return
    mu = float(rest @ x) / size
    if np.linalg.norm(rest - mu * x) > _PARALLEL * np.linalg.norm(rest):
        return
    if not _same(x, np.linalg.lstsq(M, v, rcond=None)[0]):
        M_name, v_name = terms
        raise NoAnswer(
            f"`{name}` is the solution with {M_name} {'+' if mu > 0 else '-'} {abs(mu):.3g} I in the place of "
            f"{M_name}: what is added to the diagonal moves it away from that of {M_name} x = {v_name}.",
            "diagonal changed",
        )
