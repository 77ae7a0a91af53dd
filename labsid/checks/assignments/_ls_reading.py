"""Reading what the functions of the least-squares lecture return, and the equations on which they are tried."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import as_vector, close, kind_of
from labsid.checks.question import Ask, returned
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer

SAME = close(1e-6)
"""The normal equations square the condition number; the trials are conditioned well enough for these digits."""


def returned_parts(ask: Ask, name: str, wanted: str, count: int, *arguments: Value) -> list[Value]:
    """What a student's function returns, as its `count` parts; equal shapes may have been stacked to one array."""
    value = returned(ask, name, *arguments)
    parts = tuple(value) if isinstance(value, np.ndarray) and value.ndim else value
    if isinstance(parts, (tuple, list)) and len(parts) == count:
        return list(parts)
    raise NoAnswer(f"`{name}` should return {wanted}; it returns {kind_of(value)}.", "not all that was asked for")


def as_theta(call: str, value: Value, size: int) -> FloatArray:
    """A parameter vector; what `lstsq` returns as a whole is named as such."""
    if isinstance(value, tuple) and len(value) == 4:
        raise NoAnswer(f"`{call}` hands back all that `lstsq` returns: take the first of it, `[0]`.", "all of lstsq")
    return as_vector(call, value, size)


def trial_equations(rng: np.random.Generator, n: int, p: int) -> tuple[FloatArray, FloatArray]:
    """A well-conditioned Phi of n rows and p columns, and a Y that lies far from its columns."""
    Phi = rng.uniform(-1, 1, (n, p)) + 2 * np.vstack([np.eye(p), np.zeros((n - p, p))])
    return Phi, rng.uniform(-3, 3, n)
