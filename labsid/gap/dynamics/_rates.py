"""Compiled simulation of linear dynamics with time-varying coefficients. Time is in samples."""

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled
from labsid.gap.dynamics._states import transition


@compiled()
def simulate_varying(w: FloatArray, c: FloatArray, k: FloatArray) -> FloatArray:
    """Position and speed of z'' = -c(t) z' - k(t) z + w from rest, for each of the m columns of `w`.

    The last four of the 2 m + 4 columns are the free responses from z = 1 and from z' = 1.
    """
    samples, driven = w.shape
    columns = driven + 2
    out = np.empty((samples, 2 * columns))
    z, v = np.zeros(columns), np.zeros(columns)
    z[driven] = v[driven + 1] = 1.0
    step = transition(c[0], k[0], 1.0)
    for n in range(samples):
        if n > 0 and (c[n] != c[n - 1] or k[n] != k[n - 1]):
            step = transition(c[n], k[n], 1.0)
        for j in range(columns):
            out[n, 2 * j] = z[j]
            out[n, 2 * j + 1] = v[j]
        _advance(z, v, w, n, 0.0, step)
        if not abs(z[0]) < 1e12:
            out[n:] = np.nan
            break
    return out


@compiled()
def simulate_stepped(
    w: FloatArray, c: tuple[float, float], k: tuple[float, float], onset: float, kick: float, push: float
) -> FloatArray:
    """Position and speed of z'' = -c z' - k z + w from rest, with c and k stepping at `onset`.

    At the onset the speed drops by `kick` times the position. The 2 m + 6 columns are the responses to the m columns
    of `w`, the response to a unit force that starts at the onset together with a speed step of `push`, and the free
    responses from z = 1 and from z' = 1.
    """
    samples, driven = w.shape
    columns = driven + 3
    out = np.empty((samples, 2 * columns))
    z, v = np.zeros(columns), np.zeros(columns)
    z[driven + 1] = v[driven + 2] = 1.0
    started = 0.0  # the unit force
    before, after = transition(c[0], k[0], 1.0), transition(c[1], k[1], 1.0)
    for n in range(samples):
        for j in range(columns):
            out[n, 2 * j] = z[j]
            out[n, 2 * j + 1] = v[j]
        if onset > n:
            remaining = min(onset - n, 1.0)
            _advance(z, v, w, n, started, before if remaining == 1.0 else transition(c[0], k[0], remaining))
        if n <= onset < n + 1:
            v -= kick * z
            v[driven] = push
            started = 1.0
        if onset < n + 1:
            remaining = min(n + 1 - onset, 1.0)
            _advance(z, v, w, n, started, after if remaining == 1.0 else transition(c[1], k[1], remaining))
        if not abs(z[0]) < 1e12:
            out[n + 1 :] = np.nan
            break
    return out


@compiled()
def _advance(
    z: FloatArray,
    v: FloatArray,
    w: FloatArray,
    n: int,
    started: float,
    step: tuple[float, float, float, float, float, float],
) -> None:
    """Advance all states by one step, in place: the inputs of sample n drive the first ones, `started` the next one."""
    f11, f12, f21, f22, g1, g2 = step
    driven = w.shape[1]
    for j in range(z.size):
        force = w[n, j] if j < driven else started if j == driven else 0.0
        z[j], v[j] = f11 * z[j] + f12 * v[j] + g1 * force, f21 * z[j] + f22 * v[j] + g2 * force
