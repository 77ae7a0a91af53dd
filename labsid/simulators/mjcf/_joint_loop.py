"""The compiled loop of `one_joint`."""

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled

DIVERGED = 1e8  # rad or m


@compiled()
def _impedance(d0: float, d1: float, width: float, mid: float, power: float, x: float) -> float:
    """Impedance of a constraint at a violation x."""
    if d0 == d1 or width <= 1e-15:
        return 0.5 * (d0 + d1)
    x = abs(x) / width
    if x >= 1.0:
        return d1
    if power <= 1.0 or x == 0.0:
        y = x
    elif x <= mid:
        y = x**power / mid ** (power - 1.0)
    else:
        y = 1.0 - (1.0 - x) ** power / (1.0 - mid) ** (power - 1.0)
    return d0 + y * (d1 - d0)


@compiled()
def _pieces(
    a: float,
    friction: float,
    friction_at: float,
    friction_d: float,
    low_at: float,
    low_d: float,
    high_at: float,
    high_d: float,
) -> tuple[float, float]:
    """Force of friction and stops at an acceleration, and its negative slope there."""
    force = min(max(friction_d * (friction_at - a), -friction), friction)
    slope = friction_d if abs(friction_d * (friction_at - a)) < friction else 0.0
    if low_d > 0.0 and a < low_at:
        force += low_d * (low_at - a)
        slope += low_d
    if high_d > 0.0 and a > high_at:
        force += high_d * (high_at - a)
        slope += high_d
    return force, slope


@compiled()
def _constraint_force(
    free: float,
    inertia: float,
    friction: float,
    friction_at: float,
    friction_d: float,
    low_at: float,
    low_d: float,
    high_at: float,
    high_d: float,
) -> float:
    """Force of friction and stops on a joint with the acceleration `free` without them.

    Each is a piecewise linear function of the acceleration a: friction -D (a - at) between its bounds, a lower stop
    D (at - a) and an upper one -D (a - at) where it pushes. D of an inactive one is zero.
    """
    if low_d == 0.0 and high_d == 0.0:
        held = friction_d * (friction_at - (inertia * free + friction_d * friction_at) / (inertia + friction_d))
        return min(max(held, -friction), friction)
    # The acceleration is the root of the increasing, piecewise linear inertia (a - free) - force(a): find its piece.
    reach = friction / friction_d if friction_d > 0.0 else 0.0
    below, above = -np.inf, np.inf
    for corner in (friction_at - reach, friction_at + reach, low_at, high_at):
        force, _ = _pieces(corner, friction, friction_at, friction_d, low_at, low_d, high_at, high_d)
        if inertia * (corner - free) <= force:
            below = max(below, corner)
        else:
            above = min(above, corner)
    if below == -np.inf:
        a = above - 1.0
    elif above == np.inf:
        a = below + 1.0
    else:
        a = 0.5 * (below + above)
    force, slope = _pieces(a, friction, friction_at, friction_d, low_at, low_d, high_at, high_d)
    root = a - (inertia * (a - free) - force) / (inertia + slope)
    return force - slope * (root - a)


@compiled()
def play_compiled(u: FloatArray, steps: int, h: float, q: float, v: float, act: float, c: FloatArray) -> FloatArray:
    """Position, speed and force of the actuator at each sample, shape (N, 3)."""
    inertia, damping, drag, stiffness, springref, cubic = c[0], c[1], c[2], c[3], c[4], c[5]
    weight_sin, weight_cos, weight = c[6], c[7], c[8]
    friction, transmitted, peak, stribeck, friction_b, friction_impedance = c[9], c[10], c[11], c[12], c[13], c[14]
    low, high, margin, limit_b, limit_k = c[15], c[16], c[17], c[18], c[19]
    gear, time_constant = c[25], c[33]
    kind, implicit = int(c[32]), int(c[47])
    load, onset, wave_cos, wave_sin, omega = c[42], c[43], c[44], c[45], c[46]
    friction_d = friction_impedance * inertia / max(1.0 - friction_impedance, 1e-15)
    heavy = weight_sin != 0.0 or weight_cos != 0.0
    waves = wave_cos != 0.0 or wave_sin != 0.0
    out = np.empty((u.size, 3))
    drive = 0.0
    for k in range(u.size):
        command = min(max(u[k], c[34]), c[35])
        for s in range(steps):
            # The actuator.
            level = command if kind == 0 else act
            length, rate = gear * q, gear * v
            slope = c[28] * level + c[31]
            force = (c[26] + c[27] * length + c[28] * rate) * level + c[29] + c[30] * length + c[31] * rate
            if force < c[36] or force > c[37]:
                force = min(max(force, c[36]), c[37])
                slope = 0.0
            if s == 0:
                out[k, 0], out[k, 1], out[k, 2] = q, v, force
            # Friction over the torque of the actuator takes that of the last step.
            held = friction + transmitted * abs(drive)
            if peak != 0.0:
                held += peak * np.exp(-((v / stribeck) ** 2))
            drive = gear * force
            if drive < c[40] or drive > c[41]:
                drive = min(max(drive, c[40]), c[41])
            # All forces but friction and stops.
            speed = abs(v)
            smooth = drive + weight - v * (damping + drag * speed)
            x = q - springref
            smooth -= x * (stiffness + cubic * x * x)
            if heavy:
                smooth += weight_sin * np.sin(q) + weight_cos * np.cos(q)
            time = (k * steps + s) * h
            if load != 0.0 and time > onset - h:
                smooth += load * min((time - onset) / h + 1.0, 1.0)
            if waves:
                smooth += wave_cos * np.cos(omega * time) + wave_sin * np.sin(omega * time)
            # Friction and stops.
            constraint = 0.0
            low_d, high_d, low_at, high_at = 0.0, 0.0, 0.0, 0.0
            if q - low < margin:
                impedance = _impedance(c[20], c[21], c[22], c[23], c[24], q - low - margin)
                low_d = impedance * inertia / max(1.0 - impedance, 1e-15)
                low_at = -limit_b * v - limit_k * impedance * (q - low - margin)
            if high - q < margin:
                impedance = _impedance(c[20], c[21], c[22], c[23], c[24], high - q - margin)
                high_d = impedance * inertia / max(1.0 - impedance, 1e-15)
                high_at = -limit_b * v + limit_k * impedance * (high - q - margin)
            if held > 0.0 or low_d > 0.0 or high_d > 0.0:
                constraint = _constraint_force(
                    smooth / inertia, inertia, held, -friction_b * v, friction_d, low_at, low_d, high_at, high_d
                )
            # The step.
            mass = inertia
            if implicit == 2:
                mass += h * (damping + 2.0 * drag * speed - gear * gear * slope)
            elif implicit == 1:
                mass += h * (damping + 2.0 * drag * speed)
            v += h * (smooth + constraint) / mass
            q += h * v
            if kind == 1:
                act += h * (command - act) / time_constant
            elif kind == 2:
                act += (command - act) * (1.0 - np.exp(-h / time_constant))
            elif kind == 3:
                act += h * command
            if kind > 0:
                act = min(max(act, c[38]), c[39])
            if not abs(q) < DIVERGED:
                out[k:] = np.nan
                return out
    return out
