"""The reference run of the recursive lecture, and runs with a known mistake."""

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME
from labsid.checks.verdict import Slip
from labsid.estimation.recursion import Recursion, RecursiveState
from labsid.estimation.recursive import recursive_least_squares

Answer = TypeVar("Answer")
Update = Callable[[FloatArray, FloatArray, float], tuple[FloatArray, FloatArray]]
"""The gain and the new P from the old P, phi and lambda."""


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


def run_with(update: Update, Phi: FloatArray, Y: FloatArray, lam: float, LN: float, gain_first: bool) -> FloatArray:
    """History of a run with another update; the gain is that of the update, or it is taken from the new P."""
    p = Phi.shape[1]
    theta, P = np.zeros(p), LN * np.eye(p)
    history = np.empty(Phi.shape)
    for k, (phi, y) in enumerate(zip(Phi, Y, strict=True)):
        K, P = update(P, phi, lam)
        theta = history[k] = theta + (K if gain_first else P @ phi) * (y - phi @ theta)
    return history


def slips_of_update(name: str, make: Callable[[Update], Answer], one: str = "lambda") -> Iterator[Slip[Answer]]:
    """Known mistakes in the update of P, for any function that contains it.

    Parameters
    ----------
    name : str
        The function, in back-ticks.
    make : callable
        ``make(update)`` is the result of the function with another update.
    one : str
        What is added to phi'P phi.
    """
    bare = f"the denominator of {name} has phi'phi in it, without P: it is {one} + phi'P phi."
    yield Slip("P missing in the denominator", bare, lambda: make(_with_bare_denominator))
    inside = (
        f"{name} divides only the correction by lambda. It divides the whole bracket, the old P included: "
        "(P - K (P phi)') / lambda."
    )
    yield Slip("lambda within the bracket", inside, lambda: make(_lambda_inside))
    flat = (
        f"{name} multiplies two flat arrays entry by entry (`*`) where the matrix K (P phi)' belongs, so that P loses "
        "the same in every row. The matrix of all products is `np.outer`."
    )
    yield Slip("entry by entry", flat, lambda: make(_entry_by_entry))


def _with_bare_denominator(P: FloatArray, phi: FloatArray, lam: float) -> tuple[FloatArray, FloatArray]:
    K = P @ phi / (lam + phi @ phi)
    return K, (P - np.outer(K, P @ phi)) / lam


def _lambda_inside(P: FloatArray, phi: FloatArray, lam: float) -> tuple[FloatArray, FloatArray]:
    K = P @ phi / (lam + phi @ P @ phi)
    return K, P - np.outer(K, P @ phi) / lam


def _entry_by_entry(P: FloatArray, phi: FloatArray, lam: float) -> tuple[FloatArray, FloatArray]:
    K = P @ phi / (lam + phi @ P @ phi)
    return K, (P - K * (P @ phi)) / lam


def is_one_array(history: FloatArray, estimates: Iterable[FloatArray]) -> bool:
    """Whether every row is the last estimate: the same array was stored again and again."""
    return any(SAME(history, np.broadcast_to(right[-1], right.shape)) for right in estimates)
