"""Inertia and forces of rigid bodies on joints, compiled: the equations of motion of a tree of hinges and slides.

All bodies are described in the frame of the world, at the default position of the joints. A displacement maps a point x
to R x + p, where that of a link follows from that of its parent.
"""

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled


@compiled()
def accelerate(mass: FloatArray, force: FloatArray, a: FloatArray) -> None:
    """Solve mass a = force into `a`, by Cholesky's method, which overwrites `mass`, shape (n, n)."""
    n = force.size
    for i in range(n):
        for j in range(i + 1):
            x = mass[i, j]
            for k in range(j):
                x -= mass[i, k] * mass[j, k]
            mass[i, j] = np.sqrt(x) if i == j else x / mass[j, j]
    for i in range(n):
        x = force[i]
        for k in range(i):
            x -= mass[i, k] * a[k]
        a[i] = x / mass[i, i]
    for i in range(n - 1, -1, -1):
        x = a[i]
        for k in range(i + 1, n):
            x -= mass[k, i] * a[k]
        a[i] = x / mass[i, i]


@compiled()
def _cross(a: FloatArray, b: FloatArray) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled()
def _turned(turn: FloatArray, x: FloatArray) -> tuple[float, float, float]:
    """R x, for the nine elements of R by row."""
    return (
        turn[0] * x[0] + turn[1] * x[1] + turn[2] * x[2],
        turn[3] * x[0] + turn[4] * x[1] + turn[5] * x[2],
        turn[6] * x[0] + turn[7] * x[1] + turn[8] * x[2],
    )


@compiled()
def _carried(
    own: FloatArray, way: FloatArray, swing: FloatArray
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Centripetal and tangential acceleration of a point at `way` from one of a link, whose state is `own`."""
    inner = _cross(own[18:21], way)
    for m in range(3):
        swing[m] = inner[m]
    return _cross(own[18:21], swing), _cross(own[21:24], way)


@compiled()
def _led(link: FloatArray, own: FloatArray, point: FloatArray, way: FloatArray, found: FloatArray) -> None:
    """Put the motion of a point per unit of a joint, whose link and state these are, into `found`."""
    if link[1] > 0.0:
        for m in range(3):
            found[m] = own[12 + m]
    else:
        for m in range(3):
            way[m] = point[m] - own[15 + m]
        turned = _cross(own[12:15], way)
        for m in range(3):
            found[m] = turned[m]


@compiled()
def inertia_and_bias(
    q: FloatArray,
    v: FloatArray,
    links: FloatArray,
    gravity: FloatArray,
    state: FloatArray,
    room: FloatArray,
    mass: FloatArray,
    bias: FloatArray,
) -> None:
    """Inertia of the joints, and the forces that hold their speeds against gravity and rotation.

    Parameters
    ----------
    q, v : ndarray, shape (n,)
    links : ndarray, shape (n, 19)
        By joint, parents first; see `several_joints.COLUMNS`. A joint without a body between it and the next one has no
        mass.
    gravity : ndarray, shape (3,)
    state : ndarray, shape (n, 27)
        For each link: R (9), p (3), axis (3), anchor (3), angular speed (3) and acceleration (3), and the acceleration
        of the anchor (3).
    room : ndarray, shape (10, 9)
        For intermediate vectors: allocating them takes as long as the rest.
    mass : ndarray, shape (n, n)
    bias : ndarray, shape (n,)
        Both are overwritten.
    """
    n = q.size
    mass[:, :] = 0.0
    bias[:] = 0.0
    offset, swing, arm, centre = room[0], room[1], room[2], room[3]
    force, torque, ahead, behind = room[4], room[5], room[6], room[7]
    turn, spread = room[8], room[9]
    for i in range(n):
        parent = int(links[i, 0])
        own = state[i]
        if parent < 0:
            own[:] = 0.0
            own[0], own[4], own[8] = 1.0, 1.0, 1.0
        else:
            own[:] = state[parent]
        x, y, z = links[i, 2], links[i, 3], links[i, 4]
        axis = _turned(own, links[i, 2:5])
        anchor = _turned(own, links[i, 5:8])
        for m in range(3):
            offset[m] = anchor[m] + own[9 + m] - own[15 + m]  # from the anchor of the parent
            own[12 + m] = axis[m]
        # The acceleration of the anchor, as a point of the parent.
        outer, tangential = _carried(own, offset, swing)
        for m in range(3):
            own[24 + m] += outer[m] + tangential[m]
            own[15 + m] += offset[m]
        moved = q[i] - links[i, 18]
        if links[i, 1] > 0.0:
            coriolis = _cross(own[18:21], own[12:15])
            for m in range(3):
                own[9 + m] += axis[m] * moved
                own[24 + m] += 2.0 * coriolis[m] * v[i]
            # The anchor moves along: its acceleration is that of the point of the parent where it now is.
            for m in range(3):
                offset[m] = axis[m] * moved
            outer, tangential = _carried(own, offset, swing)
            for m in range(3):
                own[24 + m] += outer[m] + tangential[m]
                own[15 + m] += offset[m]
        else:
            sine, cosine = np.sin(moved), np.cos(moved)
            rest = 1.0 - cosine
            spread[0], spread[1], spread[2] = cosine + x * x * rest, x * y * rest - z * sine, x * z * rest + y * sine
            spread[3], spread[4], spread[5] = y * x * rest + z * sine, cosine + y * y * rest, y * z * rest - x * sine
            spread[6], spread[7], spread[8] = z * x * rest - y * sine, z * y * rest + x * sine, cosine + z * z * rest
            kept = _turned(spread, links[i, 5:8])
            for m in range(3):
                offset[m] = links[i, 5 + m] - kept[m]
            shift = _turned(own, offset)
            for m in range(3):
                own[9 + m] += shift[m]
                for j in range(3):
                    turn[3 * m + j] = (
                        own[3 * m] * spread[j] + own[3 * m + 1] * spread[3 + j] + own[3 * m + 2] * spread[6 + j]
                    )
            own[:9] = turn
            turning = _cross(own[18:21], own[12:15])
            for m in range(3):
                own[21 + m] += turning[m] * v[i]
                own[18 + m] += axis[m] * v[i]
        weight = links[i, 8]
        at = _turned(own, links[i, 9:12])
        for m in range(3):
            centre[m] = at[m] + own[9 + m]
            arm[m] = centre[m] - own[15 + m]
        outer, tangential = _carried(own, arm, swing)
        for m in range(3):
            force[m] = weight * (own[24 + m] + outer[m] + tangential[m] - gravity[m])
        # Inertia about the centre of mass, turned: R J R'.
        j0, j1, j2 = links[i, 12], links[i, 13], links[i, 14]
        j3, j4, j5 = links[i, 15], links[i, 16], links[i, 17]
        for m in range(3):
            turn[3 * m] = own[3 * m] * j0 + own[3 * m + 1] * j3 + own[3 * m + 2] * j4
            turn[3 * m + 1] = own[3 * m] * j3 + own[3 * m + 1] * j1 + own[3 * m + 2] * j5
            turn[3 * m + 2] = own[3 * m] * j4 + own[3 * m + 1] * j5 + own[3 * m + 2] * j2
        for m in range(3):
            for j in range(3):
                spread[3 * m + j] = (
                    turn[3 * m] * own[3 * j] + turn[3 * m + 1] * own[3 * j + 1] + turn[3 * m + 2] * own[3 * j + 2]
                )
        spin = _turned(spread, own[18:21])
        for m in range(3):
            swing[m] = spin[m]
        gyration, growth = _cross(own[18:21], swing), _turned(spread, own[21:24])
        for m in range(3):
            torque[m] = gyration[m] + growth[m]
        # Onto this joint and those before it.
        j = i
        while j >= 0:
            slides = links[j, 1] > 0.0
            line = state[j, 12:15]
            _led(links[j], state[j], centre, offset, ahead)
            for m in range(3):
                bias[j] += ahead[m] * force[m]
                if not slides:
                    bias[j] += line[m] * torque[m]
            moment = _turned(spread, line)
            k = j
            while k >= 0:
                slides_too = links[k, 1] > 0.0
                other = state[k, 12:15]
                _led(links[k], state[k], centre, offset, behind)
                total = 0.0
                for m in range(3):
                    total += weight * ahead[m] * behind[m]
                    if not slides and not slides_too:
                        total += moment[m] * other[m]
                mass[j, k] += total
                if j != k:
                    mass[k, j] += total
                k = int(links[k, 0])
            j = int(links[j, 0])
