"""What a recursive estimator is given, remembers and returns."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.model_structures.structures import Structure


@dataclass(frozen=True, slots=True, eq=False)
class RecursiveState:
    """All that a recursion remembers between two samples.

    Attributes
    ----------
    theta : ndarray, shape (p,)
        The current estimate.
    P : ndarray, shape (p, p)
        ``(Phi'Phi)^-1`` of the samples so far (with forgetting, of the weighted ones).
    trace_bound : float
        Forgetting pauses while it would push the trace of P above this.
    memory : ndarray, shape (m,)
        The past samples that the next regressor is made of; zeros at the start (the plant at rest). Empty where the
        caller gives the regressors.
    """

    theta: FloatArray
    P: FloatArray
    trace_bound: float
    memory: FloatArray

    def __post_init__(self) -> None:
        freeze(self, theta=self.theta, P=self.P, memory=self.memory)


@dataclass(frozen=True, slots=True, eq=False)
class Recursion:
    """The course of a recursive estimate. Its arrays are read-only, and not copied: they may be long.

    Attributes
    ----------
    theta : ndarray, shape (n, p)
        Row k is the estimate after sample k.
    error : ndarray, shape (n,)
        Prediction errors ``epsilon(k) = y(k) - phi'(k) theta(k-1)``.
    P_trace : ndarray, shape (n,)
        Trace of P after each sample: what winds up.
    state : RecursiveState
        Where it stopped; give it as `start` to go on.
    kept_back : int
        Recursive IV only: for how many samples the estimate was unstable and the instruments kept to the last
        stable model.
    status : {"finite", "diverged"}
        Whether the last estimate is made of finite numbers.
    """

    theta: FloatArray
    error: FloatArray
    P_trace: FloatArray
    state: RecursiveState
    kept_back: int
    status: Literal["finite", "diverged"]


def diffuse_start(p: int, large: float = 1e6, trace_bound: float | None = None) -> RecursiveState:
    """Start from knowing nothing: ``theta(0) = 0`` and ``P(0) = LN I`` with a large number LN.

    Parameters
    ----------
    p : int
        Number of parameters.
    large : float
        The lectures' LN, in units of 1 over the square of a regressor. Larger is not better: rounding errors of
        about ``1e-16 LN`` stay in P.
    trace_bound : float, optional
        Bound on the trace of P; twice the trace of P(0) unless given. ``numpy.inf`` lets P wind up.

    Returns
    -------
    RecursiveState

    Raises
    ------
    ValueError
        If a number is not positive.

    Notes
    -----
    Reading lectures, L5. While nothing excites the plant, the division by lambda alone makes P grow without
    limit (covariance wind-up), and the next disturbance throws the estimate off. Where trace(P) / lambda would pass
    the bound, the step is done with lambda = 1 instead: what was learnt is kept until there is something new to learn.
    """
    if p < 1:
        raise ValueError(f"p must be at least 1 parameter; got {p}.")
    if not (large > 0 and np.isfinite(large)):
        raise ValueError(f"large must be a positive number; got {large}.")
    trace_bound = 2 * p * large if trace_bound is None else trace_bound
    if not trace_bound > 0:
        raise ValueError(f"trace_bound must be positive; got {trace_bound}. numpy.inf sets no bound.")
    return RecursiveState(np.zeros(p), large * np.eye(p), trace_bound, np.empty(0))


def check_forgetting(forgetting: float) -> None:
    """Refuse a forgetting factor outside (0, 1]."""
    if not 0 < forgetting <= 1:
        raise ValueError(
            f"forgetting must lie in (0, 1]; got {forgetting}. 1 forgets nothing, 0.99 what is older than about 100 "
            "samples."
        )


def check_delay(structure: Structure) -> None:
    """Refuse a structure with an input that does not have a delay of 1."""
    if structure.delay != 1 and structure.nb:
        raise ValueError(
            f"structure must have a delay of 1 here; got {structure.delay}. Shift u by the difference first, with "
            "shift_back or shift_forward."
        )


def check_instrumental(structure: Structure, warm_up: int) -> None:
    """Refuse what recursive instrumental variables cannot estimate."""
    if structure.na < 1 or structure.nb < 1 or structure.nc or warm_up < 0:
        raise ValueError(
            "structure must be ARX, with past outputs and inputs, and warm_up zero or more; got "
            f"{structure} and {warm_up}."
        )
    check_delay(structure)


def resume(start: RecursiveState, p: int, memory: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Copies of theta, P and the memory to work in; an empty memory is one at rest."""
    if start.theta.shape != (p,) or start.P.shape != (p, p) or start.memory.size not in (0, memory):
        raise ValueError(
            f"start must be the state of a recursion with {p} parameters and {memory} remembered values; "
            f"got {start.theta.size} and {start.memory.size}."
        )
    return start.theta.copy(), start.P.copy(), start.memory.copy() if start.memory.size else np.zeros(memory)


def symmetric(P: FloatArray) -> FloatArray:
    """P from its lower triangle, the one that the loops of least squares write."""
    return np.tril(P) + np.tril(P, -1).T


def nothing_pending(p: int) -> FloatArray:
    """The `pending` of a P that is complete: ``P phi = 0``, ``quotient = 0`` and ``growth = 1``."""
    return np.append(np.zeros(p + 1), 1.0)


def settle(P: FloatArray, pending: FloatArray) -> FloatArray:
    """Complete P where its last update is pending: ``growth P - quotient (P phi)(P phi)'``."""
    P_phi, quotient, growth = pending[:-2], pending[-2], pending[-1]
    with np.errstate(all="ignore"):
        return symmetric(P * growth - np.outer(P_phi * quotient, P_phi))


def room(n: int, p: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Make room for the history, the errors and the traces of n samples."""
    return np.empty((n, p)), np.empty(n), np.empty(n)


def finish(
    history: FloatArray, errors: FloatArray, traces: FloatArray, state: RecursiveState, kept_back: int = 0
) -> Recursion:
    """Seal what a compiled loop filled in."""
    for array in (history, errors, traces):
        array.setflags(write=False)
    finite = bool(np.isfinite(state.theta).all())
    return Recursion(history, errors, traces, state, kept_back, "finite" if finite else "diverged")
