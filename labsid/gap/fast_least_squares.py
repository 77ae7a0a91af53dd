"""Small least-squares problems, many thousand of them a record: normal equations of scaled columns."""

import numpy as np
from scipy.linalg.lapack import dposv

from labsid._arrays import FloatArray

RIDGE = 1e-11  # of rounding's size: the problem is never singular


def solve_least_squares(Phi: FloatArray, y: FloatArray) -> FloatArray:
    """Least squares by normal equations of scaled columns with a ridge at rounding size: fast, and never singular."""
    gram, scale = scaled_gram(Phi)
    gram.flat[:: gram.shape[0] + 1] += RIDGE
    return solve_positive_definite(gram, (Phi.T @ y) / scale) / scale


def scaled_gram(Phi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Phi'Phi of columns scaled to length one, and those lengths."""
    gram = Phi.T @ Phi
    scale = np.sqrt(gram.diagonal())
    scale[scale == 0.0] = 1.0
    gram /= scale
    gram /= scale[:, None]
    return gram, scale


def solve_positive_definite(gram: FloatArray, right: FloatArray) -> FloatArray:
    """Solution of a positive definite system; by elimination where rounding has spoilt the definiteness."""
    _, x, failed = dposv(gram, right)
    if failed:
        x = np.linalg.solve(gram, right)
    solution: FloatArray = x
    return solution
