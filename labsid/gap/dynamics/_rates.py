"""Compiled simulation of linear dynamics with time-varying coefficients. Time is in samples."""

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled
from labsid.gap.dynamics._states import transition

DAMPING_BOUNDS = 1e-6, 50.0  # of c, per sample; numerics
STIFFNESS_BOUNDS = 1e-11, 90.0  # of k, per sample squared; numerics


@compiled()
def changed_rates(c: float, k: float, share: float, change: float) -> tuple[float, float]:
    """The rates c and k after a relative `change` of k and the `share` of it of c, within their bounds."""
    return _within(c * (1.0 + share * change), DAMPING_BOUNDS), _within(k * (1.0 + change), STIFFNESS_BOUNDS)


@compiled()
def _within(value: float, bounds: tuple[float, float]) -> float:
    return min(max(value, bounds[0]), bounds[1])


@compiled()
def simulate_varying(
    w: FloatArray, course: FloatArray, change: FloatArray, c: float, k: float, share: float, turn: float
) -> FloatArray:
    """Columns of z'' = -c(t) z' - k(t) z + force, shape (N, 8).

    The rates change as in `changed_rates`, by one `change` per sample; the share `turn` of c acts inside the derivative
    of the balance equation. The columns are position and speed for the force w and for w times the `course`, both from
    rest; position for a force of one and for the course as force; and position from z = 1 and from z' = 1.
    """
    last = w.size - 1
    out = np.empty((8, w.size))
    z, v, force = np.zeros(6), np.zeros(6), np.zeros(6)
    z[4] = v[5] = force[2] = 1.0
    for n in range(w.size):
        out[0, n], out[1, n], out[2, n], out[3, n] = z[0], v[0], z[1], v[1]
        out[4, n], out[5, n], out[6, n], out[7, n] = z[2], z[3], z[4], z[5]
        earlier, later = max(n - 1, 0), min(n + 1, last)
        slope = (change[later] - change[earlier]) / max(later - earlier, 1)
        now_c, now_k = changed_rates(c, k, share, change[n])
        step = transition(now_c, _within(now_k + c * turn * slope, STIFFNESS_BOUNDS), 1.0)
        force[0], force[1], force[3] = w[n], w[n] * course[n], course[n]
        for j in range(6):
            new_z, new_v = _moved(z[j], v[j], force[j], step)
            z[j], v[j] = new_z, new_v
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
