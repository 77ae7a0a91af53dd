"""The reference run of the recursive lecture, and runs with a known mistake."""

from collections.abc import Iterable

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME
from labsid.estimation.recursion import Recursion, RecursiveState
from labsid.estimation.recursive import recursive_least_squares


def reference_run(Phi: FloatArray, Y: FloatArray, lam: float, LN: float) -> Recursion:
    """RLS from theta = 0 and P = LN I."""
    p = Phi.shape[1]
    start = RecursiveState(np.zeros(p), LN * np.eye(p), np.inf, np.empty(0))
    return recursive_least_squares(Phi, Y, lam, start)


def reference_step(
    theta: FloatArray, P: FloatArray, phi: FloatArray, y: float, lam: float = 1.0
) -> tuple[FloatArray, FloatArray]:
    """One sample of RLS: theta and P after it."""
    run = recursive_least_squares(phi[np.newaxis], [y], lam, RecursiveState(theta, P, np.inf, np.empty(0)))
    return run.theta[0], run.state.P


def faulty_run(
    Phi: FloatArray,
    Y: FloatArray,
    lam: float,
    LN: float,
    denominator: float | None = None,
    factor: float | None = None,
    old_gain: bool = False,
    sign: float = 1.0,
    full: bool = False,
) -> FloatArray:
    """History of a run with a mistake: another number than lambda, another factor than 1/lambda, or the old gain.

    Or a P that is `full` of LN at first.
    """
    p = Phi.shape[1]
    theta, P = np.zeros(p), LN * (np.ones((p, p)) if full else np.eye(p))
    history = np.empty(Phi.shape)
    for k, (phi, y) in enumerate(zip(Phi, Y, strict=True)):
        P_phi = P @ phi
        P = (P - np.outer(P_phi, P_phi) / ((lam if denominator is None else denominator) + phi @ P_phi)) * (
            1 / lam if factor is None else factor
        )
        theta = theta + sign * (P_phi if old_gain else P @ phi) * (y - phi @ theta)
        history[k] = theta
    return history


def is_one_array(history: FloatArray, estimates: Iterable[FloatArray]) -> bool:
    """Whether every row is the last estimate: the same array was stored again and again."""
    return any(SAME(history, np.broadcast_to(right[-1], right.shape)) for right in estimates)
