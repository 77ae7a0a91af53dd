"""Compiled filters and static nonlinearities. Time is in samples; inputs are constant between samples."""

import math

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled


@compiled()
def section(w: FloatArray, a1: float, a2: float) -> FloatArray:
    """Columns of a second-order section: two for its numerator, two for its initial state; shape (N, 4)."""
    out = np.zeros((4, w.size))
    _fill_section(out, w, 0.0, a1, a2)
    return out.T


@compiled()
def linear_columns(w: FloatArray, reference: float, a1: float, a2: float, has_ramp: bool) -> FloatArray:
    """The four columns of `section` for w - `reference`, and the response to a unit step or zero; shape (N, 5)."""
    out = np.zeros((5, w.size))
    _fill_section(out, w, reference, a1, a2)
    if has_ramp:
        out[4] = section(np.ones(w.size), a1, a2)[:, 0]
    return out.T


@compiled()
def _fill_section(out: FloatArray, w: FloatArray, reference: float, a1: float, a2: float) -> None:
    """Fill the first four rows of `out`, which is zero, for w - `reference`."""
    x1, x2, h1, h2 = 0.0, 0.0, 1.0, 0.0
    out[2, 0] = 1.0
    for k in range(1, w.size):
        x = w[k - 1] - reference - a1 * x1 - a2 * x2
        h = -a1 * h1 - a2 * h2
        out[0, k], out[1, k], out[2, k], out[3, k] = x, x1, h, h1
        x1, x2, h1, h2 = x, x1, h, h1


@compiled()
def delayed(w: FloatArray, whole: int, part: float, offset: float = 0.0) -> FloatArray:
    """Delay `w` by `whole` samples and the fraction `part`, with linear interpolation.

    Before the record the signal is w[0] + `offset`; after it, its last value.
    """
    out = np.empty(w.size)
    for k in range(w.size):
        now = w[min(k - whole, w.size - 1)] if k >= whole else w[0] + offset
        before = w[min(k - whole - 1, w.size - 1)] if k > whole else w[0] + offset
        out[k] = (1.0 - part) * now + part * before
    return out


@compiled()
def first_order(w: FloatArray, pole: float) -> FloatArray:
    """Response x(k) = pole x(k-1) + (1 - pole) w(k-1) with zero initial state."""
    x = np.empty(w.size)
    x[0] = 0.0
    for k in range(1, w.size):
        x[k] = pole * x[k - 1] + (1.0 - pole) * w[k - 1]
    return x


@compiled()
def switched_off(w: FloatArray, start: float, stop: float, level: float) -> FloatArray:
    """Replace `w` by `level` from the time `start` to `stop`, in samples, and mix the samples at either end."""
    out = np.empty(w.size)
    for k in range(w.size):
        share = min(max(min(stop, k + 1.0) - max(start, k + 0.0), 0.0), 1.0)
        out[k] = (1.0 - share) * w[k] + share * level
    return out


@compiled()
def in_steps(w: FloatArray, step: float, phase: float) -> FloatArray:
    """Round `w` to multiples of `step`, which are shifted by the share `phase` of a step."""
    out = np.empty(w.size)
    for k in range(w.size):
        out[k] = step * (math.floor(w[k] / step - phase + 0.5) + phase)
    return out


@compiled()
def backlash(w: FloatArray, width: float, position: float) -> FloatArray:
    """Follow `w` through backlash of `width`; `position`, 0 to 1, is the initial position within it."""
    half = 0.5 * width
    out = np.empty(w.size)
    now = w[0] + (position - 0.5) * width
    for k in range(w.size):
        if w[k] - half > now:
            now = w[k] - half
        elif w[k] + half < now:
            now = w[k] + half
        out[k] = now
    return out


@compiled()
def rate_limit(w: FloatArray, up: float, down: float, start: float) -> tuple[FloatArray, FloatArray]:
    """Mean and first moment about the middle of each sample, of an actuator slewing to `w`.

    It moves by at most `up` per sample towards larger values, and by at most `down` towards smaller ones.
    """
    mean, moment = np.empty(w.size), np.empty(w.size)
    now = start
    for k in range(w.size):
        distance = w[k] - now
        rate = up if distance > 0.0 else down
        share = min(abs(distance) / rate, 1.0)  # share of the sample spent slewing
        moved = distance if abs(distance) <= rate else math.copysign(rate, distance)
        now += moved
        mean[k] = now - 0.5 * share * moved
        moment[k] = moved * share * (3.0 - 2.0 * share) / 12.0
    return mean, moment


@compiled()
def whiten(X: FloatArray, ar: FloatArray) -> FloatArray:
    """Filter every column by 1 - ar[0] q^-1 - ar[1] q^-2 - ..., with zeros before the record."""
    samples, columns = X.shape
    out = np.empty((columns, samples))
    for j in range(columns):
        for k in range(samples):
            value = X[k, j]
            for i in range(min(k, ar.size)):
                value -= ar[i] * X[k - 1 - i, j]
            out[j, k] = value
    return out.T


@compiled()
def piecewise(x: FloatArray, knots: FloatArray, powers: FloatArray) -> FloatArray:
    """Piecewise cubic of x: row j of `powers`, lowest power first, applies above j of the `knots`."""
    out = np.empty(x.size)
    for k in range(x.size):
        at, j = x[k], 0
        while j < knots.size and at > knots[j]:
            j += 1
        out[k] = powers[j, 0] + at * (powers[j, 1] + at * (powers[j, 2] + at * powers[j, 3]))
    return out


@compiled()
def stick(u: FloatArray, band: float) -> FloatArray:
    """A valve that rests until the command has moved by `band`, and then goes where it points."""
    out = np.empty(u.size)
    at = u[0]
    for i in range(u.size):
        if abs(u[i] - at) > band:
            at = u[i]
        out[i] = at
    return out


@compiled()
def relay(u: FloatArray, low: float, high: float) -> FloatArray:
    """A switch that turns on above `high` and off below `low`."""
    out = np.empty(u.size)
    on = 1.0 if u[0] > 0.5 * (low + high) else 0.0
    for i in range(u.size):
        if u[i] > high:
            on = 1.0
        elif u[i] < low:
            on = 0.0
        out[i] = on
    return out
