"""Fast small least-squares problems: normal equations of scaled columns."""

import numpy as np
from scipy.linalg.lapack import dposv

from labsid._arrays import FloatArray

RIDGE = 1e-11  # at the level of rounding: keeps the problem regular; numerics


def solve_least_squares(Phi: FloatArray, y: FloatArray) -> FloatArray:
    """Solve least squares by normal equations of scaled columns, with a ridge at the level of rounding."""
    gram, scale = scaled_gram(Phi)
    gram.flat[:: gram.shape[0] + 1] += RIDGE
    return solve_positive_definite(gram, (Phi.T @ y) / scale) / scale


def scaled_gram(Phi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Phi'Phi of columns scaled to unit length, and their lengths."""
    gram = Phi.T @ Phi
    scale = np.sqrt(gram.diagonal())
    scale[scale == 0.0] = 1.0
    gram /= scale
    gram /= scale[:, None]
    return gram, scale


def solve_positive_definite(gram: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a positive definite system; by LU if rounding has made it indefinite."""
    _, x, failed = dposv(gram, right)
    if failed:
        x = np.linalg.solve(gram, right)
    solution: FloatArray = x
    return solution
