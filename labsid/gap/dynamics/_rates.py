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
    out = np.empty((2 * columns, samples))
    z, v = np.zeros(columns), np.zeros(columns)
    z[driven] = v[driven + 1] = 1.0
    step = transition(c[0], k[0], 1.0)
    for n in range(samples):
        if n > 0 and (c[n] != c[n - 1] or k[n] != k[n - 1]):
            step = transition(c[n], k[n], 1.0)
        for j in range(columns):
            out[2 * j, n], out[2 * j + 1, n] = z[j], v[j]
            new_z, new_v = _moved(z[j], v[j], w[n, j] if j < driven else 0.0, step)
            z[j], v[j] = new_z, new_v
        if not abs(z[0]) < 1e12:
            out[:, n:] = np.nan
            break
    return out.T


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
    out = np.empty((2 * columns, samples))
    last = min(int(onset), samples)  # the sample of the onset
    before, after = transition(c[0], k[0], 1.0), transition(c[1], k[1], 1.0)
    up_to, since = transition(c[0], k[0], onset - last), transition(c[1], k[1], last + 1 - onset)
    for j in range(columns):
        z, v = 1.0 if j == driven + 1 else 0.0, 1.0 if j == driven + 2 else 0.0
        z, v = _run(out, w, j, (0, last), (z, v), before, 0.0)
        if last < samples:
            z, v = _run(out, w, j, (last, last + 1), (z, v), up_to, 0.0)
            v = push if j == driven else v - kick * z
            constant = 1.0 if j == driven else 0.0
            z, v = _moved(z, v, w[last, j] if j < driven else constant, since)
            _run(out, w, j, (last + 1, samples), (z, v), after, constant)
    return out.T


@compiled()
def _run(
    out: FloatArray,
    w: FloatArray,
    j: int,
    rows: tuple[int, int],
    state: tuple[float, float],
    step: tuple[float, float, float, float, float, float],
    constant: float,
) -> tuple[float, float]:
    """Write motion j over the `rows` from first to last but one to `out`; return the state after them.

    The force is column j of `w`, or `constant` for the motions that no column drives.
    """
    driven = w.shape[1]
    z, v = state
    for n in range(rows[0], rows[1]):
        out[2 * j, n], out[2 * j + 1, n] = z, v
        z, v = _moved(z, v, w[n, j] if j < driven else constant, step)
    return z, v


@compiled()
def _moved(
    z: float, v: float, force: float, step: tuple[float, float, float, float, float, float]
) -> tuple[float, float]:
    """Position and speed after one step."""
    f11, f12, f21, f22, g1, g2 = step
    return f11 * z + f12 * v + g1 * force, f21 * z + f22 * v + g2 * force
