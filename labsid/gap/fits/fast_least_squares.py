"""Fast small least-squares problems: normal equations of scaled columns."""

import math

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled

RIDGE = 1e-11  # at the level of rounding: keeps the problem regular; numerics
BLOCK = 512  # rows whose products are summed at a time, so that their columns stay in the cache; numerics


def solve_least_squares(Phi: FloatArray, y: FloatArray) -> FloatArray:
    """Solve least squares by normal equations of scaled columns, with a ridge at the level of rounding."""
    gram, scale = scaled_gram(Phi)
    gram.flat[:: gram.shape[0] + 1] += RIDGE
    return solve_positive_definite(gram, (Phi.T @ y) / scale) / scale


def scaled_gram(Phi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Phi'Phi of columns scaled to unit length, and their lengths."""
    gram, scale = _scaled_gram(np.asfortranarray(Phi))
    return gram, scale


def solve_positive_definite(gram: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a positive definite system; by LU if rounding has made it indefinite."""
    x, is_definite = _solve_by_cholesky(gram, right)
    if not is_definite:
        x = np.linalg.solve(gram, right)
    solution: FloatArray = x
    return solution


@compiled("reassoc", "contract")
def _scaled_gram(Phi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """For few columns this is two to three times as fast as a general matrix product."""
    rows, size = Phi.shape
    gram = np.zeros((size, size))
    for begin in range(0, rows, BLOCK):
        end = min(begin + BLOCK, rows)
        for i in range(size):
            for j in range(i + 1):
                products = 0.0
                for k in range(begin, end):
                    products += Phi[k, i] * Phi[k, j]
                gram[i, j] += products
    scale = np.empty(size)
    for i in range(size):
        scale[i] = math.sqrt(gram[i, i]) if gram[i, i] != 0.0 else 1.0
    for i in range(size):
        for j in range(i + 1):
            gram[i, j] /= scale[i] * scale[j]
            gram[j, i] = gram[i, j]
    return gram, scale


@compiled()
def _solve_by_cholesky(gram: FloatArray, right: FloatArray) -> tuple[FloatArray, bool]:
    """The solution, and whether the system is positive definite."""
    size = right.size
    factor, x = np.zeros((size, size)), np.empty(size)
    for i in range(size):
        for j in range(i + 1):
            rest = gram[i, j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            if i > j:
                factor[i, j] = rest / factor[j, j]
            elif rest > 0.0:
                factor[i, i] = math.sqrt(rest)
            else:  # also where it is not a number
                return x, False
    for i in range(size):
        rest = right[i]
        for k in range(i):
            rest -= factor[i, k] * x[k]
        x[i] = rest / factor[i, i]
    for i in range(size - 1, -1, -1):
        rest = x[i]
        for k in range(i + 1, size):
            rest -= factor[k, i] * x[k]
        x[i] = rest / factor[i, i]
    return x, True
