"""The recursions as loops: interpreted for short records, compiled otherwise, because numba takes long to load.

Call `prepare` before one of them. They get the number of parameters as the length of the tuple `unroll`: a length the
compiler knows, so that it unrolls the small loops. Every array that a loop only reads comes in read-only, or it would
be compiled twice.

The loops and the updates of one sample share their steps, which the compiler may neither reorder nor fuse: interpreted,
compiled, over a record or sample by sample, they give the same numbers bit for bit.
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
    inline : bool
        As `compiled` takes it.
    """

    function: Callable[..., Any]
    inline: bool

    def __call__(self, *arguments: Any) -> Any:
        """Interpret it; like the compiled one, it divides by zero without a word."""
        with np.errstate(all="ignore"):
            return self.function(*arguments)


def compiled(inline: bool = False) -> Callable[[Callable[..., Any]], Any]:
    """Mark a loop that `prepare` compiles, into its callers where `inline` is set."""
    return lambda function: Loop(function, inline)


def prepare(samples: float) -> None:
    """Compile the loops if the record is long, or numba is loaded already."""
    if samples <= LONGEST_INTERPRETED and "numba" not in sys.modules:
        return
    waiting = {name: one for name, one in globals().items() if isinstance(one, Loop)}
    if waiting:
        from labsid import _compiled

        globals().update({name: _compiled.compiled(inline=one.inline)(one.function) for name, one in waiting.items()})


@compiled(inline=True)
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


@compiled(inline=True)
def deferred_step(
    phi: FloatArray,
    y: float,
    theta: FloatArray,
    P: FloatArray,
    P_phi: FloatArray,
    ahead: FloatArray,
    quotient: float,
    growth: float,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
) -> tuple[float, float, float, float]:
    """Do the same as `rls_step` for P of the sample before; leave P of this sample to the next call, or to `settle`.

    P_phi, quotient and growth are those of the sample before and become those of this one; P_phi, quotient = 0 and
    growth = 1 leave P as it is. P phi waits for the P of the sample before, which waits for a division. So P phi is
    taken from the P that is there, while the division runs, and corrected after it. Return the prediction error,
    quotient, growth, and the trace of the P of the sample before.
    """
    p, half = len(unroll), len(unroll) // 2
    cross = 0.0
    for i in range(p):
        cross += P_phi[i] * phi[i]
        product = 0.0
        for j in range(i + 1):
            product += P[i, j] * phi[j]
        for j in range(i + 1, p):
            product += P[j, i] * phi[j]
        ahead[i] = product * growth
    correction = quotient * cross
    trace = 0.0
    for i in range(p):
        K = P_phi[i] * quotient
        for j in range(i + 1):  # one triangle, as in rls_step
            P[i, j] = P[i, j] * growth - K * P_phi[j]
        trace += P[i, i]
    kept = forgetting if trace <= forgetting * trace_bound else 1.0
    # left + right is lambda + phi' P phi, in two halves.
    left, right = kept, 0.0
    for i in range(p):
        P_phi[i] = ahead[i] - P_phi[i] * correction
    for i in range(half):
        left += P_phi[i] * phi[i]
    for i in range(half, p):
        right += P_phi[i] * phi[i]
    error = y
    for i in range(p):
        error -= phi[i] * theta[i]
    growth = 1.0 / kept
    quotient = growth / (left + right)
    step = quotient * (kept * error)
    for i in range(p):
        theta[i] += P_phi[i] * step
    return error, quotient, growth, trace


@compiled()
def rls(
    Phi: FloatArray,
    Y: FloatArray,
    theta: FloatArray,
    P: FloatArray,
    pending: FloatArray,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
    history: FloatArray,
    errors: FloatArray,
    traces: FloatArray,
) -> None:
    """Recursive least squares over the rows of Phi; `pending` is what `settle` needs to complete P."""
    p = len(unroll)
    P_phi, ahead = pending[:p], np.empty(p)
    quotient, growth, trace = pending[p], pending[p + 1], 0.0
    for k in range(Y.size):
        errors[k], quotient, growth, trace = deferred_step(
            Phi[k], Y[k], theta, P, P_phi, ahead, quotient, growth, forgetting, trace_bound, unroll
        )
        for i in range(p):
            history[k, i] = theta[i]
        if k > 0:
            traces[k - 1] = trace
    pending[p], pending[p + 1] = quotient, growth


@compiled()
def rls_update(
    phi: FloatArray,
    y: float,
    theta: FloatArray,
    P: FloatArray,
    pending: FloatArray,
    ahead: FloatArray,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
) -> float:
    """`rls` over one sample; return its error, or NaN and change nothing where the sample is not finite."""
    p = len(unroll)
    zero = 0.0 * y
    for i in range(p):
        zero += 0.0 * phi[i]
    if zero != 0.0:
        return np.nan
    error, pending[p], pending[p + 1], _ = deferred_step(
        phi, y, theta, P, pending[:p], ahead, pending[p], pending[p + 1], forgetting, trace_bound, unroll
    )
    return error


@compiled(inline=True)
def extended_step(
    u: float,
    y: float,
    na: int,
    nb: int,
    theta: FloatArray,
    P: FloatArray,
    phi: FloatArray,
    P_phi: FloatArray,
    trace: float,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
) -> tuple[float, float]:
    """Update theta, P and the register phi; return the prediction error and the new trace of P."""
    error, trace = rls_step(phi, y, theta, P, P_phi, trace, forgetting, trace_bound, unroll)
    shift(phi, 0, na, -y)
    shift(phi, na, na + nb, u)
    shift(phi, na + nb, len(unroll), error)
    return error, trace


@compiled()
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
        errors[k], trace = extended_step(
            u[k], y[k], na, nb, theta, P, phi, P_phi, trace, forgetting, trace_bound, unroll
        )
        for i in range(p):
            history[k, i] = theta[i]
        traces[k] = trace


@compiled()
def extended_update(
    u: float,
    y: float,
    na: int,
    nb: int,
    theta: FloatArray,
    P: FloatArray,
    phi: FloatArray,
    P_phi: FloatArray,
    forgetting: float,
    trace_bound: float,
    unroll: tuple[int, ...],
) -> float:
    """`extended_rls` over one sample; return its error, or NaN and change nothing where the sample is not finite."""
    if 0.0 * u + 0.0 * y != 0.0:
        return np.nan
    trace = 0.0
    for i in range(len(unroll)):
        trace += P[i, i]
    return extended_step(u, y, na, nb, theta, P, phi, P_phi, trace, forgetting, trace_bound, unroll)[0]


@compiled(inline=True)
def shift(register: FloatArray, first: int, last: int, newest: float) -> None:
    """Move the lags ``register[first:last]`` one place on and put the newest in front."""
    for i in range(last - 1, first, -1):
        register[i] = register[i - 1]
    if last > first:
        register[first] = newest


@compiled()
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
def iv_update(
    u: float,
    y: float,
    na: int,
    theta: FloatArray,
    P: FloatArray,
    memory: FloatArray,
    warm_up: int,
    history: FloatArray,
    signals: FloatArray,
) -> tuple[float, int]:
    """`recursive_iv` over one sample; return its error, or NaN and change nothing where the sample is not finite."""
    if 0.0 * u + 0.0 * y != 0.0:
        return np.nan, 0
    signals[0], signals[1] = u, y
    kept_back = recursive_iv(
        signals[0:1],
        signals[1:2],
        na,
        theta,
        P,
        memory[0],
        memory[1],
        memory[2],
        warm_up,
        history,
        signals[2:3],
        signals[3:4],
    )
    return signals[2], kept_back


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
