"""Answers that are a part of the solution of M x = v, or combine its parts entry by entry."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import close
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer

_same = close(1e-6)


def require_whole_solution(
    name: str, value: Value, M: FloatArray, v: FloatArray, terms: tuple[str, str] = ("Phi'Phi", "Phi'Y")
) -> None:
    """Refuse a matrix in the place of the solution, and say which part of it this is.

    Parameters
    ----------
    name : str
        The answer, as its messages call it.
    value : object
    M, v : ndarray
        Of the equations ``M x = v``, in which no student's value stands.
    terms : tuple of str
        What M and v are called in the question.
    """
    if not isinstance(value, np.ndarray) or value.shape != M.shape or value.size == 1 or value.dtype.kind not in "iuf":
        return
    try:
        inverse = np.linalg.inv(M)
    except np.linalg.LinAlgError:
        return
    left, right = terms
    if _same(value, inverse):
        raise NoAnswer(
            f"`{name}` is the inverse of {left} alone: the product with {right} is missing.", "only the inverse"
        )
    if _same(value, M):
        raise NoAnswer(f"`{name}` is {left} alone: its inverse is multiplied by {right}.", "only the matrix")
    if any(_same(value, inverse * side) for side in (v, v[:, np.newaxis])):
        raise NoAnswer(
            f"`{name}` multiplies the inverse of {left} and {right} entry by entry (`*`): the product of a matrix and "
            "a vector is `@`.",
            "inverse times the right side entry by entry",
        )
