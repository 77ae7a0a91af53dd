"""Random data on which students' functions are tried."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel, Structure

ARX, ARMAX = Structure(1, 1), Structure(1, 1, 1)

STARTS = (1, 2, 3)
"""First rows that are accepted: the record starts at rest, so each of them is right."""


def trial_equations(rng: np.random.Generator, n: int, p: int) -> tuple[FloatArray, FloatArray]:
    """A well-conditioned Phi of n rows and p columns, and a Y far from the span of its columns."""
    Phi = rng.uniform(-1, 1, (n, p)) + 2 * np.vstack([np.eye(p), np.zeros((n - p, p))])
    return Phi, rng.uniform(-3, 3, n)


def trial_definite(rng: np.random.Generator, p: int) -> FloatArray:
    """A positive definite p by p matrix, such as Phi'Phi or P during a recursion."""
    A = rng.uniform(-1, 1, (p, p))
    return A @ A.T + np.eye(p)


def first_order(a: float, b: float, c: float = 0.0, delay: int = 1) -> PolynomialModel:
    """``y(t) + a y(t-1) = b u(t-delay) + e(t) + c e(t-1)``."""
    return PolynomialModel(np.array([1.0, a]), np.array([b]), np.array([1.0, c]), delay)


def trial_record(
    rng: np.random.Generator, samples: int, c: float, noise: float = 1.0, largest: float = 0.8
) -> tuple[FloatArray, FloatArray]:
    """A record from rest, y(0) = 0, of a system with the lecture's sign of `a`."""
    a, b = -rng.uniform(0.4, largest), rng.uniform(0.7, 2.0)
    u, e = rng.uniform(-2, 2, samples), noise * rng.standard_normal(samples)
    e[0] = 0.0
    return u, free_run(first_order(a, b, c), u, e)
