"""Recursive identification: least squares with forgetting, its extension to ARMAX, and instrumental variables.

Every function runs over as many samples as it is given, one included, and returns the state in which it stopped.
Started from that state it goes on as if there had been no pause. For one sample a call, `labsid.estimation.online` is
faster.
"""

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, as_signals, read_only
from labsid.estimation.recursion import (
    Recursion,
    RecursiveState,
    check_delay,
    check_forgetting,
    check_instrumental,
    diffuse_start,
    finish,
    nothing_pending,
    resume,
    room,
    settle,
    symmetric,
)
from labsid.model_structures.structures import Structure


def recursive_least_squares(
    Phi: ArrayLike, Y: ArrayLike, forgetting: float = 1.0, start: RecursiveState | None = None
) -> Recursion:
    """Update a least-squares estimate row by row, forgetting old rows if asked to.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors, one row per sample.
    Y : array_like, shape (n,)
        Outputs.
    forgetting : float
        The factor lambda, above 0 and at most 1: a sample weighs ``lambda^age``. 1 forgets nothing.
    start : RecursiveState, optional
        Where to start or to go on; `diffuse_start` unless given.

    Returns
    -------
    Recursion

    Raises
    ------
    ValueError
        If the shapes do not fit, a number is not finite, or `forgetting` is outside (0, 1].

    Notes
    -----
    Reading lectures, L4, L5 and "RLS algorithm with a forgetting factor":
    ``P(n) = [P(n-1) - P phi phi' P / (lambda + phi' P phi)] / lambda``, with P kept exactly symmetric. With lambda 1
    and a diffuse start the last row is the batch estimate.
    """
    from labsid.estimation import _loops

    Phi = np.ascontiguousarray(Phi, dtype=np.float64)
    Y = np.ascontiguousarray(Y, dtype=np.float64)
    if Phi.ndim != 2 or 0 in Phi.shape or Y.shape != Phi.shape[:1]:
        raise ValueError(
            f"Phi must have one row per sample of Y; got shapes {Phi.shape} and {Y.shape}. Build both from the same "
            "samples."
        )
    p = Phi.shape[1]
    check_forgetting(forgetting)
    start = diffuse_start(p) if start is None else start
    theta, P, _ = resume(start, p, 0)
    history, errors, traces = room(Y.size, p)
    Phi, Y = read_only(Phi), read_only(Y)
    _loops.prepare(Y.size)
    pending = nothing_pending(p)
    _loops.rls(Phi, Y, theta, P, pending, forgetting, start.trace_bound, (0,) * p, history, errors, traces)
    P = settle(P, pending)
    traces[-1] = np.trace(P)
    # A NaN or an infinity never leaves theta again: only then is it worth reading the data to see whose it is.
    if not np.isfinite(theta).all():
        as_signal("Y", Y)
        as_signal("Phi", Phi.reshape(-1))
    return finish(history, errors, traces, RecursiveState(theta, P, start.trace_bound, np.empty(0)))


def recursive_armax(
    structure: Structure,
    u: ArrayLike | None,
    y: ArrayLike,
    forgetting: float = 1.0,
    start: RecursiveState | None = None,
) -> Recursion:
    """Update the parameters of an ARMAX model sample by sample (RELS); with nc = 0 those of an ARX model (RLS).

    Parameters
    ----------
    structure : Structure
        With a delay of 1.
    u : array_like, shape (n,), or None
        Offset-free input; None for AR and ARMA.
    y : array_like, shape (n,)
        Offset-free output.
    forgetting : float
        The factor lambda, above 0 and at most 1.
    start : RecursiveState, optional
        Where to start or to go on; `diffuse_start` and the plant at rest unless given.

    Returns
    -------
    Recursion
        With ``theta = [a1, ..., b1, ..., c1, ...]``.

    Raises
    ------
    ValueError
        If the delay is not 1, the input is missing, the lengths differ, a sample is not finite, or `forgetting` is
        outside (0, 1].

    Notes
    -----
    Reading lectures, L7: the unmeasured ``e(k-1)`` of the regressor is replaced by the prediction error
    ``epsilon(k-1)``. The regressors are made as the samples come, so nothing but the history grows with the record.
    """
    from labsid.estimation import _loops

    u, y = _signals(structure, u, y)
    p = structure.parameters
    check_forgetting(forgetting)
    start = diffuse_start(p) if start is None else start
    theta, P, phi = resume(start, p, p)
    history, errors, traces = room(y.size, p)
    _loops.prepare(y.size)
    _loops.extended_rls(
        u,
        y,
        structure.na,
        structure.nb,
        theta,
        P,
        phi,
        forgetting,
        start.trace_bound,
        (0,) * p,
        history,
        errors,
        traces,
    )
    return finish(history, errors, traces, RecursiveState(theta, symmetric(P), start.trace_bound, phi))


def recursive_instrumental(
    structure: Structure, u: ArrayLike, y: ArrayLike, warm_up: int = 100, start: RecursiveState | None = None
) -> Recursion:
    """Update an instrumental-variable estimate of an ARX model sample by sample.

    Parameters
    ----------
    structure : Structure
        With past outputs and inputs, a delay of 1, and nc = 0.
    u, y : array_like, shape (n,)
        Offset-free input and output.
    warm_up : int
        For so many samples, from the first, the regressor is its own instrument (least squares): there is no model
        yet to make a better one with. Without effect where `start` is given.
    start : RecursiveState, optional
        Where to go on; `diffuse_start` and the plant at rest unless given.

    Returns
    -------
    Recursion
        With ``theta = [a1, ..., b1, ...]``. P is not symmetric here.

    Raises
    ------
    ValueError
        If the structure does not suit, the lengths differ, a sample is not finite, or `warm_up` is negative.

    Notes
    -----
    Reading lectures, L8. The instrument ``z = [-y_M(k-1), ..., u(k-1), ...]`` holds the noise-free output y_M of the
    current model; while that model is unstable, of the last stable one (`Recursion.kept_back` counts those samples).
    """
    from labsid.estimation import _loops

    check_instrumental(structure, warm_up)
    u, y = _signals(structure, u, y)
    p = structure.parameters
    own_instruments = warm_up if start is None else 0
    start = diffuse_start(p) if start is None else start
    theta, P, memory = resume(start, p, 3 * p)
    history, errors, traces = room(y.size, p)
    _loops.prepare(y.size)
    kept_back = _loops.recursive_iv(
        u, y, structure.na, theta, P, *memory.reshape(3, p), own_instruments, history, errors, traces
    )
    return finish(history, errors, traces, RecursiveState(theta, P, start.trace_bound, memory), kept_back)


def unsymmetrised_rls(Phi: ArrayLike, Y: ArrayLike, forgetting: float) -> FloatArray:
    """Run the variant of RLS that is *not* to be used: it diverges for lambda < 1.

    Parameters
    ----------
    Phi : array_like, shape (n, p)
        Regressors.
    Y : array_like, shape (n,)
        Outputs.
    forgetting : float
        The factor lambda.

    Returns
    -------
    theta : ndarray, shape (n, p)
        The history of the estimate; from some sample on, nonsense.

    Raises
    ------
    ValueError
        If `forgetting` is outside (0, 1].

    Notes
    -----
    ``P = (P - K (P phi)') / lambda`` equals the lectures' form on paper. In floating point its two triangles differ by
    rounding; the correction takes nothing of that difference away, and the division makes it grow as ``lambda^-n``:
    from 1e-16 to 1 in about ``36 / (1 - lambda)`` samples.
    """
    check_forgetting(forgetting)
    Phi, Y = np.asarray(Phi, dtype=np.float64), np.asarray(Y, dtype=np.float64)
    theta, P = np.zeros(Phi.shape[1]), 1e6 * np.eye(Phi.shape[1])
    history = np.empty(Phi.shape)
    with np.errstate(all="ignore"):
        for k, phi in enumerate(Phi):
            P_phi = P @ phi
            K = P_phi / (forgetting + phi @ P_phi)
            theta = theta + K * (Y[k] - phi @ theta)
            P = (P - np.outer(K, P_phi)) / forgetting
            history[k] = theta
    return history


def _signals(structure: Structure, u: ArrayLike | None, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
    check_delay(structure)
    y = as_signal("y", y)
    if u is None and structure.nb:
        raise ValueError(f"u must be given: the {structure.kind} structure has coefficients of it.")
    u = as_signals(u=np.zeros(y.size) if u is None else u, y=y)[0]
    return read_only(u), read_only(y)
