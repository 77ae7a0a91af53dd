"""The compiled loop of `one_joint` and `several_joints`."""

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled
from labsid.simulators.mjcf._rigid_bodies import accelerate, inertia_and_bias

DIVERGED = 1e8  # rad or m
MOST_NEWTON, MOST_HALVINGS = 30, 8  # steps of Newton's method, and halvings of one
SOLVED = 1e-12  # of the forces: error of the accelerations


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
def _joint_forces(
    free: FloatArray, mass: FloatArray, constraints: FloatArray, a: FloatArray, e: FloatArray, work: FloatArray
) -> None:
    """Accelerations of several joints with friction and stops, into `a`.

    They are the root of mass (a - free) - force(a), whose Jacobian is positive definite: Newton's method, with shorter
    steps where the error does not shrink.

    Parameters
    ----------
    free : ndarray, shape (n,)
        Accelerations without friction and stops.
    mass : ndarray, shape (n, n)
    constraints : ndarray, shape (n, 7)
        The arguments of `_pieces` behind the acceleration.
    a, e : ndarray, shape (n,)
    work : ndarray, shape (n, n)
    """
    n = free.size
    size = 0.0
    step = np.zeros(n)
    trial = np.zeros(n)
    for i in range(n):
        a[i] = free[i]
        size += abs(constraints[i, 0]) + abs(mass[i, i] * free[i])
    before = np.inf
    for _ in range(MOST_NEWTON):
        share = 1.0
        now = 0.0
        for _ in range(MOST_HALVINGS):
            now = 0.0
            for i in range(n):
                trial[i] = a[i] + share * step[i]
            for i in range(n):
                c = constraints[i]
                force, slope = _pieces(trial[i], c[0], c[1], c[2], c[3], c[4], c[5], c[6])
                e[i] = -force
                for j in range(n):
                    e[i] += mass[i, j] * (trial[j] - free[j])
                    work[i, j] = mass[i, j]
                work[i, i] += slope
                now += abs(e[i])
            if now < before or now <= SOLVED * size:
                break
            share *= 0.5
        for i in range(n):
            a[i] = trial[i]
        if now <= SOLVED * size:
            break
        before = now
        accelerate(work, e, step)
        for i in range(n):
            step[i] = -step[i]


@compiled()
def play_compiled(
    u: FloatArray,
    steps: int,
    h: float,
    q0: FloatArray,
    v0: FloatArray,
    act0: FloatArray,
    c: FloatArray,
    links: FloatArray,
    gravity: FloatArray,
) -> FloatArray:
    """Position, speed and force of the actuator of each joint at each sample, shape (N, n, 3).

    Parameters
    ----------
    u : ndarray, shape (N, n)
        Command of the actuator of each joint.
    steps : int
        Of each sample.
    h : float
    q0, v0, act0 : ndarray, shape (n,)
    c : ndarray, shape (n, 48)
        Constants of each joint. Of a single joint the inertia is that of everything that moves; of several that of the
        armature, beside which the links act.
    links : ndarray, shape (n, 19)
        As of `inertia_and_bias`; of a single joint it is not read.
    gravity : ndarray, shape (3,)
    """
    n = c.shape[0]
    q, v, act = q0.copy(), v0.copy(), act0.copy()
    smooth, held, slopes = np.zeros(n), np.zeros(n), np.zeros(n)
    drive = np.zeros(n)
    bias, a, e, resting = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    mass, work = np.zeros((n, n)), np.zeros((n, n))
    scratch, room, constraints = np.zeros((n, 27)), np.zeros((10, 9)), np.zeros((n, 7))
    alone = np.empty(n)  # inertia of a joint that constraints are scaled by: at the model's default position
    for i in range(n):
        alone[i] = c[i, 0]
    if n > 1:
        for i in range(n):
            resting[i] = links[i, 18]
        inertia_and_bias(resting, np.zeros(n), links, gravity, scratch, room, mass, bias)
        for i in range(n):
            mass[i, i] += c[i, 0]
        for i in range(n):
            e[:] = 0.0
            e[i] = 1.0
            work[:, :] = mass
            accelerate(work, e, a)
            alone[i] = 1.0 / a[i]
    out = np.empty((u.shape[0], n, 3))
    for k in range(u.shape[0]):
        for s in range(steps):
            touched = False
            for i in range(n):
                # The actuator.
                command = min(max(u[k, i], c[i, 34]), c[i, 35])
                kind = int(c[i, 32])
                gear = c[i, 25]
                level = command if kind == 0 else act[i]
                length, rate = gear * q[i], gear * v[i]
                slope = c[i, 28] * level + c[i, 31]
                force = (c[i, 26] + c[i, 27] * length + c[i, 28] * rate) * level
                force += c[i, 29] + c[i, 30] * length + c[i, 31] * rate
                if force < c[i, 36] or force > c[i, 37]:
                    force = min(max(force, c[i, 36]), c[i, 37])
                    slope = 0.0
                if s == 0:
                    out[k, i, 0], out[k, i, 1], out[k, i, 2] = q[i], v[i], force
                slopes[i] = gear * gear * slope
                # Friction over the torque of the actuator takes that of the last step.
                held[i] = c[i, 9] + c[i, 10] * abs(drive[i])
                if c[i, 11] != 0.0:
                    held[i] += c[i, 11] * np.exp(-((v[i] / c[i, 12]) ** 2))
                drive[i] = gear * force
                if drive[i] < c[i, 40] or drive[i] > c[i, 41]:
                    drive[i] = min(max(drive[i], c[i, 40]), c[i, 41])
                # All forces but friction and stops.
                speed = abs(v[i])
                smooth[i] = drive[i] + c[i, 8] - v[i] * (c[i, 1] + c[i, 2] * speed)
                x = q[i] - c[i, 4]
                smooth[i] -= x * (c[i, 3] + c[i, 5] * x * x)
                if c[i, 6] != 0.0 or c[i, 7] != 0.0:
                    smooth[i] += c[i, 6] * np.sin(q[i]) + c[i, 7] * np.cos(q[i])
                time = (k * steps + s) * h
                if c[i, 42] != 0.0 and time > c[i, 43] - h:
                    smooth[i] += c[i, 42] * min((time - c[i, 43]) / h + 1.0, 1.0)
                if c[i, 44] != 0.0 or c[i, 45] != 0.0:
                    smooth[i] += c[i, 44] * np.cos(c[i, 46] * time) + c[i, 45] * np.sin(c[i, 46] * time)
                # Friction and stops.
                constraints[i, 0] = held[i]
                constraints[i, 1] = -c[i, 13] * v[i]
                constraints[i, 2] = c[i, 14] * alone[i] / max(1.0 - c[i, 14], 1e-15)
                low_d, high_d, low_at, high_at = 0.0, 0.0, 0.0, 0.0
                low, high, margin = c[i, 15], c[i, 16], c[i, 17]
                if q[i] - low < margin:
                    impedance = _impedance(c[i, 20], c[i, 21], c[i, 22], c[i, 23], c[i, 24], q[i] - low - margin)
                    low_d = impedance * alone[i] / max(1.0 - impedance, 1e-15)
                    low_at = -c[i, 18] * v[i] - c[i, 19] * impedance * (q[i] - low - margin)
                if high - q[i] < margin:
                    impedance = _impedance(c[i, 20], c[i, 21], c[i, 22], c[i, 23], c[i, 24], high - q[i] - margin)
                    high_d = impedance * alone[i] / max(1.0 - impedance, 1e-15)
                    high_at = -c[i, 18] * v[i] + c[i, 19] * impedance * (high - q[i] - margin)
                constraints[i, 3], constraints[i, 4] = low_at, low_d
                constraints[i, 5], constraints[i, 6] = high_at, high_d
                touched = touched or held[i] > 0.0 or low_d > 0.0 or high_d > 0.0
            # The step.
            if n == 1:
                w = constraints[0]
                push = 0.0
                if touched:
                    push = _constraint_force(smooth[0] / c[0, 0], c[0, 0], w[0], w[1], w[2], w[3], w[4], w[5], w[6])
                whole = c[0, 0]
                if c[0, 47] == 2.0:
                    whole += h * (c[0, 1] + 2.0 * c[0, 2] * abs(v[0]) - slopes[0])
                elif c[0, 47] == 1.0:
                    whole += h * (c[0, 1] + 2.0 * c[0, 2] * abs(v[0]))
                v[0] += h * (smooth[0] + push) / whole
            else:
                inertia_and_bias(q, v, links, gravity, scratch, room, mass, bias)
                for i in range(n):
                    mass[i, i] += c[i, 0]
                    smooth[i] -= bias[i]
                if touched:
                    work[:, :] = mass
                    accelerate(work, smooth, bias)
                    _joint_forces(bias, mass, constraints, a, e, work)
                    for i in range(n):
                        smooth[i] = 0.0
                        for j in range(n):
                            smooth[i] += mass[i, j] * a[j]
                for i in range(n):
                    if c[i, 47] == 2.0:
                        mass[i, i] += h * (c[i, 1] + 2.0 * c[i, 2] * abs(v[i]) - slopes[i])
                    elif c[i, 47] == 1.0:
                        mass[i, i] += h * (c[i, 1] + 2.0 * c[i, 2] * abs(v[i]))
                accelerate(mass, smooth, a)
                for i in range(n):
                    v[i] += h * a[i]
            for i in range(n):
                q[i] += h * v[i]
                kind = int(c[i, 32])
                command = min(max(u[k, i], c[i, 34]), c[i, 35])
                if kind == 1:
                    act[i] += h * (command - act[i]) / c[i, 33]
                elif kind == 2:
                    act[i] += (command - act[i]) * (1.0 - np.exp(-h / c[i, 33]))
                elif kind == 3:
                    act[i] += h * command
                if kind > 0:
                    act[i] = min(max(act[i], c[i, 38]), c[i, 39])
                if not abs(q[i]) < DIVERGED:
                    out[k:] = np.nan
                    return out
    return out
