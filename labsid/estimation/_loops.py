"""The recursions as loops: interpreted for short records, compiled otherwise, because numba takes long to load.

Call `prepare` before one of them. They get the number of parameters as the length of the tuple `unroll`: a length the
compiler knows, so that it unrolls the small loops. Every array that a loop only reads comes in read-only, or it would
be compiled twice.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from labsid._arrays import FloatArray

LONGEST_INTERPRETED = 2_000
"""Samples that the slowest loop interprets in a tenth of a second; numba takes half a second to load."""


@dataclass(frozen=True, slots=True)
class Loop:
    """A loop that is not compiled yet.

    Attributes
    ----------
    function : callable
    relaxed : tuple of str
        As `compiled` takes them.
    """

    function: Callable[..., Any]
    relaxed: tuple[str, ...]

    def __call__(self, *arguments: Any) -> Any:
        """Interpret it; like the compiled one, it divides by zero without a word."""
        with np.errstate(all="ignore"):
            return self.function(*arguments)


def compiled(*relaxed: str) -> Callable[[Callable[..., Any]], Any]:
    """Mark a loop that `prepare` compiles."""
    return lambda function: Loop(function, relaxed)


def prepare(samples: int) -> None:
    """Compile the loops if the record is long, or numba is loaded already."""
    if samples <= LONGEST_INTERPRETED and "numba" not in sys.modules:
        return
    waiting = {name: one for name, one in globals().items() if isinstance(one, Loop)}
    if waiting:
        from labsid import _compiled

        globals().update({name: _compiled.compiled(*one.relaxed)(one.function) for name, one in waiting.items()})


@compiled("contract")
def rls_step(
    phi: FloatArray,
    y: float,
    theta: FloatArray,
    P: FloatArray,
    P_phi: FloatArray,
    trace: float,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
) -> tuple[float, float]:
    """Update theta and P in place by the lectures' equations; return the prediction error and the new trace of P.

    Only the lower triangle of P is read and written: computed apart, the two would drift away from each other by
    1 / lambda a step.
    """
    p = len(unroll)
    kept = forgetting if trace <= forgetting * trace_bound else 1.0
    error = y
    denominator = kept
    for i in range(p):
        error -= phi[i] * theta[i]
    for i in range(p):
        product = 0.0
        for j in range(i + 1):
            product += P[i, j] * phi[j]
        for j in range(i + 1, p):
            product += P[j, i] * phi[j]
        P_phi[i] = product
        denominator += product * phi[i]
    gain, growth = 1.0 / denominator, 1.0 / kept
    trace = 0.0
    for i in range(p):
        K = P_phi[i] * gain
        theta[i] += K * error
        for j in range(i + 1):
            P[i, j] = (P[i, j] - K * P_phi[j]) * growth
        trace += P[i, i]
    return error, trace


@compiled("contract")
def rls(
    Phi: FloatArray,
    Y: FloatArray,
    theta: FloatArray,
    P: FloatArray,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
    history: FloatArray,
    errors: FloatArray,
    traces: FloatArray,
) -> None:
    """Recursive least squares over the rows of Phi: `rls_step`, arranged for speed.

    A step waits for the P of the step before, which waits for a division. So P phi for the *next* row is taken from
    the P before the step, while the division runs, and corrected after it; and whether the next step pauses is
    decided from the trace that P is about to have, trace(P) growth - quotient |P phi|^2, times the denominator.
    """
    p, half, last = len(unroll), len(unroll) // 2, Y.size - 1
    P_phi, ahead = np.empty(p), np.empty(p)
    trace = 0.0
    for i in range(p):
        trace += P[i, i]
        P_phi[i] = 0.0
        for j in range(p):
            P_phi[i] += P[i, j] * Phi[0, j]
    shrink = 1.0 / forgetting
    limit = forgetting * trace_bound
    pause = trace > limit
    for k in range(Y.size):
        after = min(k + 1, last)
        kept, growth = (1.0, 1.0) if pause else (forgetting, shrink)
        error = Y[k]
        for i in range(p):
            error -= Phi[k, i] * theta[i]
        # left + right is lambda + phi' P phi, in two halves; cross is phi'(next) P phi.
        left, right, cross, square = kept, 0.0, 0.0, 0.0
        for i in range(half):
            left += P_phi[i] * Phi[k, i]
        for i in range(half, p):
            right += P_phi[i] * Phi[k, i]
        for i in range(p):
            cross += P_phi[i] * Phi[after, i]
            square += P_phi[i] * P_phi[i]
            product = 0.0
            for j in range(i + 1):
                product += P[i, j] * Phi[after, j]
            for j in range(i + 1, p):
                product += P[j, i] * Phi[after, j]
            ahead[i] = product * growth
        denominator = left + right
        pause = (trace - limit * kept) * denominator > square
        quotient = growth / denominator
        step = quotient * (kept * error)
        correction = quotient * cross
        trace = 0.0
        for i in range(p):
            theta[i] += P_phi[i] * step
            history[k, i] = theta[i]
            K = P_phi[i] * quotient
            for j in range(i + 1):  # one triangle, as in rls_step
                P[i, j] = P[i, j] * growth - K * P_phi[j]
            trace += P[i, i]
        for i in range(p):
            P_phi[i] = ahead[i] - P_phi[i] * correction
        errors[k], traces[k] = error, trace
    mirror(P)


@compiled("contract")
def extended_rls(
    u: FloatArray,
    y: FloatArray,
    na: int,
    nb: int,
    theta: FloatArray,
    P: FloatArray,
    phi: FloatArray,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
    history: FloatArray,
    errors: FloatArray,
    traces: FloatArray,
) -> None:
    """Recursive (extended) least squares from the signals; phi is the shift register of the regressor."""
    p = len(unroll)
    P_phi = np.empty(p)
    trace = 0.0
    for i in range(p):
        trace += P[i, i]
    for k in range(y.size):
        error, trace = rls_step(phi, y[k], theta, P, P_phi, trace, forgetting, trace_bound, unroll)
        for i in range(p):
            history[k, i] = theta[i]
        errors[k], traces[k] = error, trace
        shift(phi, 0, na, -y[k])
        shift(phi, na, na + nb, u[k])
        shift(phi, na + nb, p, error)
    mirror(P)


@compiled()
def mirror(P: FloatArray) -> None:
    """Copy the lower triangle into the upper one."""
    for i in range(len(P)):
        for j in range(i):
            P[j, i] = P[i, j]


@compiled()
def shift(register: FloatArray, first: int, last: int, newest: float) -> None:
    """Move the lags ``register[first:last]`` one place on and put the newest in front."""
    for i in range(last - 1, first, -1):
        register[i] = register[i - 1]
    if last > first:
        register[first] = newest


@compiled("contract")
def recursive_iv(
    u: FloatArray,
    y: FloatArray,
    na: int,
    theta: FloatArray,
    P: FloatArray,
    phi: FloatArray,
    z: FloatArray,
    stable: FloatArray,
    warm_up: int,
    history: FloatArray,
    errors: FloatArray,
    traces: FloatArray,
) -> int:
    """Recursive instrumental variables; return for how many samples the instruments kept to an earlier model."""
    p = theta.size
    P_z, phi_P, room = np.empty(p), np.empty(p), np.empty(na)
    kept_back = 0
    for k in range(y.size):
        instrument = phi if k < warm_up else z
        error, denominator = y[k], 1.0
        for i in range(p):
            error -= phi[i] * theta[i]
            P_z[i] = phi_P[i] = 0.0
            for j in range(p):
                P_z[i] += P[i, j] * instrument[j]
                phi_P[i] += phi[j] * P[j, i]
        for i in range(p):
            denominator += phi[i] * P_z[i]
        trace = 0.0
        for i in range(p):
            K = P_z[i] / denominator
            theta[i] += K * error
            for j in range(p):
                P[i, j] -= K * phi_P[j]
            trace += P[i, i]
        for i in range(p):
            history[k, i] = theta[i]
        errors[k], traces[k] = error, trace
        if roots_inside(theta, na, room):
            for i in range(p):
                stable[i] = theta[i]
        else:
            kept_back += 1
        y_model = 0.0
        for i in range(p):
            y_model += stable[i] * z[i]
        shift(phi, 0, na, -y[k])
        shift(phi, na, p, u[k])
        shift(z, 0, na, -y_model)
        shift(z, na, p, u[k])
    return kept_back


@compiled()
def roots_inside(coefficients: FloatArray, count: int, room: FloatArray) -> bool:
    """Whether ``1 + a1 q^-1 + ... `` has every root inside the unit circle: all reflection coefficients below 1."""
    for i in range(count):
        room[i] = coefficients[i]
    for m in range(count - 1, -1, -1):
        reflection = room[m]
        if not abs(reflection) < 1.0:
            return False
        rest = 1.0 - reflection * reflection
        for i in range((m + 1) // 2):
            low, high = room[i], room[m - 1 - i]
            room[i] = (low - reflection * high) / rest
            room[m - 1 - i] = (high - reflection * low) / rest
    return True
