"""The loops of the simulation that numba compiles. Time is counted in samples; inputs are held between samples."""

import math

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled

FAR = 1e6  # a state beyond this has left every record behind: the simulation has diverged


@compiled()
def second_order(w: FloatArray, a1: float, a2: float) -> FloatArray:
    """Response x(k) = w(k-1) - a1 x(k-1) - a2 x(k-2), from zero."""
    x = np.empty(w.size)
    last, before = 0.0, 0.0
    x[0] = 0.0
    for k in range(1, w.size):
        new = w[k - 1] - a1 * last - a2 * before
        before, last = last, new
        x[k] = new
    return x


@compiled()
def section(w: FloatArray, a1: float, a2: float) -> FloatArray:
    """Columns of one second-order section: two numerator terms of x(k) = w(k-1) - ..., two of its initial state."""
    out = np.zeros((4, w.size))
    x1, x2, h1, h2 = 0.0, 0.0, 1.0, 0.0
    out[2, 0] = 1.0
    for k in range(1, w.size):
        x = w[k - 1] - a1 * x1 - a2 * x2
        h = -a1 * h1 - a2 * h2
        out[0, k], out[1, k], out[2, k], out[3, k] = x, x1, h, h1
        x1, x2, h1, h2 = x, x1, h, h1
    return out.T


@compiled()
def delayed(w: FloatArray, whole: int, part: float) -> FloatArray:
    """`w` later by `whole` samples and a part of one, between samples by interpolation; before the record it stood."""
    out = np.empty(w.size)
    for k in range(w.size):
        now, before = w[max(k - whole, 0)], w[max(k - whole - 1, 0)]
        out[k] = (1.0 - part) * now + part * before
    return out


@compiled()
def first_order(w: FloatArray, pole: float) -> FloatArray:
    """Response x(k) = pole x(k-1) + (1 - pole) w(k-1), from zero."""
    x = np.empty(w.size)
    x[0] = 0.0
    for k in range(1, w.size):
        x[k] = pole * x[k - 1] + (1.0 - pole) * w[k - 1]
    return x


@compiled()
def backlash(w: FloatArray, width: float, position: float) -> FloatArray:
    """Follow `w` through a play of `width`; `position` in 0..1 is where in the play the record begins."""
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
def rate_limit(w: FloatArray, rate: float, start: float) -> FloatArray:
    """Mean over each sample of an actuator that slews to `w` at no more than `rate` a sample."""
    out = np.empty(w.size)
    now = start
    for k in range(w.size):
        way = w[k] - now
        if abs(way) <= rate:
            used = abs(way) / rate
            out[k] = w[k] - 0.5 * used * way
            now = w[k]
        else:
            step = rate if way > 0 else -rate
            out[k] = now + 0.5 * step
            now += step
    return out


@compiled()
def tanks(
    w: FloatArray,
    a1: float,
    a2: float,
    root1: bool,
    root2: bool,
    brim1: float,
    brim2: float,
    share: float,
    h1: float,
    h2: float,
    substeps: int,
) -> FloatArray:
    """Lower level of two tanks in a row; outflow by the root of the level or by the level, brims, overflow caught."""
    out = np.empty(w.size)
    h = 1.0 / substeps
    for k in range(w.size):
        out[k] = h2
        flow = w[k]
        for _ in range(substeps):
            f1 = math.sqrt(max(h1, 0.0)) if root1 else h1
            half1 = min(h1 + 0.5 * h * a1 * (flow - f1), brim1)
            into = math.sqrt(max(half1, 0.0)) if root1 else half1
            h1 += h * a1 * (flow - into)
            if h1 > brim1:
                into += share * (h1 - brim1) / (a1 * h)
                h1 = brim1
            f2 = math.sqrt(max(h2, 0.0)) if root2 else h2
            half2 = min(h2 + 0.5 * h * a2 * (into - f2), brim2)
            f2 = math.sqrt(max(half2, 0.0)) if root2 else half2
            h2 = min(h2 + h * a2 * (into - f2), brim2)
            if root1 and h1 < 0.0:
                h1 = 0.0
            if root2 and h2 < 0.0:
                h2 = 0.0
        if not (abs(h2) < FAR and abs(h1) < FAR):
            out[k:] = np.nan
            break
    return out


@compiled()
def _transition(c: float, k: float, h: float) -> tuple[float, float, float, float, float, float]:
    """Exact step of z'' = -c z' - k z + force over `h`: entries of Phi and Gamma."""
    s = 0.25 * c * c - k
    half = 0.5 * c
    if s > 1e-12:
        root = math.sqrt(s)
        up, down = math.exp((root - half) * h), math.exp((-root - half) * h)
        ch, sh = 0.5 * (up + down), 0.5 * (up - down) / root
    elif s < -1e-12:
        root = math.sqrt(-s)
        e = math.exp(-half * h)
        ch, sh = e * math.cos(root * h), e * math.sin(root * h) / root
    else:
        e = math.exp(-half * h)
        ch, sh = e, e * h
    f11, f12, f21, f22 = ch + half * sh, sh, -k * sh, ch - half * sh
    if k * h * h > 1e-6:
        g1 = (1.0 - f11) / k
    elif c * h > 1e-6:
        g1 = (h - f12) / c
    else:
        g1 = 0.5 * h * h
    return f11, f12, f21, f22, g1, f12


@compiled()
def mechanics(
    w: FloatArray, c: float, k: float, friction: float, cubic: float, z: float, v: float, substeps: int
) -> FloatArray:
    """Position and speed of z'' = -c z' - k z - friction sign(z') - cubic z^3 + w, sticking included."""
    out = np.empty((w.size, 2))
    h = 1.0 / substeps
    f11, f12, f21, f22, g1, g2 = _transition(c, k, h)
    far = FAR / max(k, 1e-6)
    for n in range(w.size):
        out[n, 0] = z
        out[n, 1] = v
        for _ in range(substeps):
            middle = z + 0.5 * h * v
            force = w[n] - cubic * middle * middle * middle
            if friction > 0.0:
                if v > 0.0:
                    sign = 1.0
                elif v < 0.0:
                    sign = -1.0
                else:
                    net = force - k * z
                    if abs(net) <= friction:
                        continue
                    sign = 1.0 if net > 0.0 else -1.0
                force -= friction * sign
                new_z = f11 * z + f12 * v + g1 * force
                new_v = f21 * z + f22 * v + g2 * force
                if new_v * sign < 0.0:  # the motion ends within this step: rest there, or go on the other way
                    moving = h * v / (v - new_v)
                    z += 0.5 * moving * v
                    v = 0.0
                    net = w[n] - cubic * z * z * z - k * z
                    if abs(net) > friction:
                        left = h - moving
                        net -= friction * (1.0 if net > 0.0 else -1.0)
                        v = net * left
                        z += 0.5 * v * left
                else:
                    z, v = new_z, new_v
            else:
                z, v = f11 * z + f12 * v + g1 * force, f21 * z + f22 * v + g2 * force
        if not abs(z) < far:
            out[n:] = np.nan
            break
    return out


@compiled()
def speed(
    w: FloatArray, a: float, b: float, friction: float, lag_first: bool, v: float, i: float, substeps: int
) -> FloatArray:
    """Output and speed under dry friction with a lag of rate `b` before or behind it; gain one apart from friction.

    The lag before it is i' = b (w - i), the motion
    v' = a (drive - friction sign(v) - v), where the drive is the lagged input or the input itself.
    """
    out = np.empty((w.size, 2))
    h = 1.0 / substeps
    keep_a, keep_b = math.exp(-a * h), math.exp(-b * h)
    for n in range(w.size):
        out[n, 0] = v if lag_first else i
        out[n, 1] = v
        for _ in range(substeps):
            if lag_first:
                new_i = w[n] + (i - w[n]) * keep_b
                drive = 0.5 * (i + new_i)
                i = new_i
            else:
                drive = w[n]
            before = v
            if v > 0.0:
                sign = 1.0
            elif v < 0.0:
                sign = -1.0
            elif abs(drive) <= friction:
                sign = 0.0
            else:
                sign = 1.0 if drive > 0.0 else -1.0
            if sign != 0.0:
                rest = drive - friction * sign
                v = rest + (v - rest) * keep_a
                if v * sign < 0.0:  # the motion ends within this step: rest, or go on the other way
                    left = h - math.log((before - rest) / -rest) / a
                    v = 0.0
                    if abs(drive) > friction:
                        onward = drive - friction * (1.0 if drive > 0.0 else -1.0)
                        v = onward * (1.0 - math.exp(-a * left))
            if not lag_first:
                middle = 0.5 * (before + v)
                i = middle + (i - middle) * keep_b
    return out


@compiled()
def varying(w: FloatArray, c: FloatArray, k: FloatArray) -> FloatArray:
    """Position and speed of z'' = -c(t) z' - k(t) z + w from zero, for each column of `w`; shape (N, 2 m)."""
    samples, columns = w.shape
    out = np.empty((samples, 2 * columns))
    state = np.zeros(2 * columns)
    f11, f12, f21, f22, g1, g2 = _transition(c[0], k[0], 1.0)
    for n in range(samples):
        if n > 0 and (c[n] != c[n - 1] or k[n] != k[n - 1]):
            f11, f12, f21, f22, g1, g2 = _transition(c[n], k[n], 1.0)
        for j in range(columns):
            z, v = state[2 * j], state[2 * j + 1]
            out[n, 2 * j] = z
            out[n, 2 * j + 1] = v
            state[2 * j] = f11 * z + f12 * v + g1 * w[n, j]
            state[2 * j + 1] = f21 * z + f22 * v + g2 * w[n, j]
        if not abs(state[0]) < 1e12:
            out[n:] = np.nan
            break
    return out


@compiled()
def whiten(X: FloatArray, ar: FloatArray) -> FloatArray:
    """Every column through 1 - ar[0] q^-1 - ar[1] q^-2 - ...; the first samples see zeros before them."""
    samples, columns = X.shape
    out = np.empty((columns, samples))
    for j in range(columns):
        for k in range(samples):
            value = X[k, j]
            for i in range(min(k, ar.size)):
                value -= ar[i] * X[k - 1 - i, j]
            out[j, k] = value
    return out.T
