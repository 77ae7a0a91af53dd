"""Integration of the equations of motion of `Plant`, compiled by numba.

The classical fourth-order Runge-Kutta method with a fixed step. Dry friction is constant over a step: as large as it
may be against the motion, or as large as it must be to stop it within the step.
"""

import numpy as np
from numpy.typing import NDArray

from labsid._arrays import FloatArray
from labsid._compiled import compiled
from labsid.rig.switchable._motion import outflow


@compiled()
def move_coupled(
    A: FloatArray,
    flow: FloatArray,
    B: FloatArray,
    curvature: FloatArray,
    brim: FloatArray,
    cubic: FloatArray,
    friction: FloatArray,
    stop_low: FloatArray,
    stop_high: FloatArray,
    speed_of: NDArray[np.int64],
    x0: FloatArray,
    begin: FloatArray,
    end: FloatArray,
    load: FloatArray,
    load_gain: FloatArray,
    steps_per_sample: int,
) -> FloatArray:
    """States before every integration step and after the last one, shape (steps + 1, n).

    `begin` and `end`, shape (steps, nu), are the actuator outputs at the ends of each step, linear in between.
    """
    steps, n = begin.shape[0], x0.size
    h = 1.0 / steps_per_sample
    out = np.empty((steps + 1, n))
    rough = np.any(friction > 0.0)
    x, force = x0.copy(), np.zeros(n)
    for k in range(steps):
        out[k] = x
        force[:] = 0.0
        free = _stepped(x, begin[k], end[k], load[k] * load_gain, h, A, flow, B, curvature, cubic)
        if rough:
            for i in range(n):
                force[i] = min(max(-free[i] / h, -friction[i]), friction[i])
            free = _stepped(x, begin[k], end[k], load[k] * load_gain + force, h, A, flow, B, curvature, cubic)
        x = free
        for i in range(n):
            if curvature[i] > 0.0:
                x[i] = max(x[i], -1.0 / curvature[i])
            x[i] = min(x[i], brim[i])
            j = speed_of[i]
            if j >= 0:
                if x[i] > stop_high[i]:
                    x[i], x[j] = stop_high[i], min(x[j], 0.0)
                elif x[i] < stop_low[i]:
                    x[i], x[j] = stop_low[i], max(x[j], 0.0)
    out[steps] = x
    return out


@compiled()
def _stepped(
    x: FloatArray,
    begin: FloatArray,
    end: FloatArray,
    force: FloatArray,
    h: float,
    A: FloatArray,
    flow: FloatArray,
    B: FloatArray,
    curvature: FloatArray,
    cubic: FloatArray,
) -> FloatArray:
    """States one step later."""
    middle = 0.5 * (begin + end)
    d1 = _rates(x, begin, force, A, flow, B, curvature, cubic)
    d2 = _rates(x + 0.5 * h * d1, middle, force, A, flow, B, curvature, cubic)
    d3 = _rates(x + 0.5 * h * d2, middle, force, A, flow, B, curvature, cubic)
    d4 = _rates(x + h * d3, end, force, A, flow, B, curvature, cubic)
    return x + h / 6.0 * (d1 + 2.0 * d2 + 2.0 * d3 + d4)


@compiled()
def _rates(
    x: FloatArray,
    v: FloatArray,
    force: FloatArray,
    A: FloatArray,
    flow: FloatArray,
    B: FloatArray,
    curvature: FloatArray,
    cubic: FloatArray,
) -> FloatArray:
    """Derivatives of the states."""
    n = x.size
    d = force.copy()
    for j in range(n):
        leaving, cube = outflow(x[j], curvature[j]), x[j] ** 3
        for i in range(n):
            d[i] += A[i, j] * x[j] + flow[i, j] * leaving + cubic[i, j] * cube
    for j in range(v.size):
        for i in range(n):
            d[i] += B[i, j] * v[j]
    return d
