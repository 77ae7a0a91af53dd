"""Compiled simulation of dynamics with nonlinear states.

Time is in samples. The input is constant between samples and changes at the fraction `late` of each sample.
"""

import math

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled

SHARP = (0.0, 0.0, 1.0)  # law of friction without smoothing and without a peak; definition
NO_STOPS = (-np.inf, np.inf, 0.0)  # positions of stops that are not there, and their rebound; definition
ALL_FORCES = -1.0  # in place of the share of the drive: the transmitted force is that of all; definition
NO_JOINT = (np.inf, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, ALL_FORCES)
"""Neither limit nor gravity, and friction that neither grows nor bends; definition."""
NEGLIGIBLE = 40.0  # argument from which exp(-x) is nothing beside one, within rounding; numerics
SATURATED = 20.0  # argument from which tanh is 1, within rounding; numerics
CLOSE_RATES = 1e-4  # difference of two rates times the step, below which their mean serves for both; numerics
WEIR_STEPS = 5  # of Newton's method for the head over a weir, from above: convex, so that it converges; numerics
DIVERGED = 1e6  # a larger state has diverged: every record is smaller; numerics
CUBIC_CORRECTION = 0.109
"""Factor of h^2 times the acceleration, for the spring at the mean position of a substep of h; measured: against short
substeps."""


@compiled()
def simulate_tanks(
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
    late: float = 0.0,
    opposing: FloatArray | None = None,
    leak: FloatArray | None = None,
    pace: FloatArray | None = None,
    weir: float = 0.0,
) -> FloatArray:
    """Level of the lower of two tanks in series, each with linear or square-root outflow and a brim.

    The lower tank receives the `share` of the upper tank's overflow. It loses the flow `opposing`, and `leak` times its
    level; `pace` multiplies its rate. These three have one value per sample. Over its brim it loses `weir` times the
    head to the power 1.5, or with zero all of the inflow.
    """
    out = np.empty(w.size)
    h = 1.0 / substeps
    keep1 = math.exp(-a1 * h)
    for k in range(w.size):
        out[k] = h2
        load = 0.0 if opposing is None else opposing[k]
        leaking = 0.0 if leak is None else leak[k]
        restoring = 1.0 + leaking
        rate2 = a2 if pace is None else a2 * pace[k]
        keep2 = math.exp(-rate2 * restoring * h)
        lost = weir * rate2 * h
        for j in range(substeps):
            flow = _held_input(w, k, late * substeps - j)
            if root1:
                half1 = min(h1 + 0.5 * h * a1 * (flow - math.sqrt(max(h1, 0.0))), brim1)
                inflow = math.sqrt(max(half1, 0.0))
                h1 += h * a1 * (flow - inflow)
                if h1 > brim1:
                    inflow += share * (h1 - brim1) / (a1 * h)
                    h1 = brim1
                h1 = max(h1, 0.0)
            elif root2:
                h1, inflow = step_linear_tank(h1, flow, a1, keep1, brim1, share, h)
            else:
                h1, h2 = _step_linear_tanks(
                    (h1, h2), flow, load, (a1, rate2), (keep1, keep2), restoring, (brim1, share), h
                )
                h2 = _below_weir(h2, brim2, lost)
                continue
            if root2:
                net = inflow - math.sqrt(max(h2, 0.0)) - load - leaking * h2
                half2 = max(_below_weir(h2 + 0.5 * h * rate2 * net, brim2, 0.5 * lost), 0.0)
                h2 += h * rate2 * (inflow - math.sqrt(half2) - load - leaking * half2)
                h2 = max(h2, 0.0)
            else:
                end = (inflow - load) / restoring
                h2 = end + (h2 - end) * keep2
            h2 = _below_weir(h2, brim2, lost)
        if not (abs(h2) < DIVERGED and abs(h1) < DIVERGED):
            out[k:] = np.nan
            break
    return out


@compiled()
def _below_weir(level: float, brim: float, lost: float) -> float:
    """The level after the flow over a weir during a step, from the level without it: its head x + lost x^1.5 is known.

    Source: the weir formula of G. Poleni, "De motu aquae mixto" (1717). `lost` is zero where all of the head flows off.
    """
    if level <= brim:
        return level
    if lost == 0.0:
        return brim
    root = math.sqrt(level - brim)
    for _ in range(WEIR_STEPS):
        root -= (root**2 + lost * root**3 - (level - brim)) / (2.0 * root + 3.0 * lost * root**2)
    return brim + root**2


@compiled()
def step_linear_tank(
    level: float, flow: float, rate: float, keep: float, brim: float, share: float, h: float
) -> tuple[float, float]:
    """Exact step of level' = rate (flow - level) up to a brim: the new level and the mean flow to the lower tank.

    `keep` is exp(-rate h). The lower tank receives the `share` of the overflow.
    """
    new = flow + (level - flow) * keep
    if new <= brim:
        return new, flow - (new - level) / (rate * h)
    filling = math.log((flow - level) / (flow - brim)) / rate if level < brim else 0.0
    over = (h - filling) / h
    below = (flow * filling - (brim - level) / rate) / h if level < brim else 0.0
    return brim, below + brim * over + share * max(flow - brim, 0.0) * over


@compiled()
def _step_linear_tanks(
    levels: tuple[float, float],
    flow: float,
    load: float,
    rates: tuple[float, float],
    keep: tuple[float, float],
    restoring: float,
    brim: tuple[float, float],
    h: float,
) -> tuple[float, float]:
    """Exact step of two linear tanks in series, the upper one up to a brim; the lower one loses the `load`, too.

    `keep` are exp(-rate h), that of the lower tank with its rate times `restoring`; `brim` is the level of the brim and
    the share of the overflow that the lower tank receives.
    """
    new = flow + (levels[0] - flow) * keep[0]
    if new <= brim[0]:
        return new, _lower_level(levels, flow, load, rates, keep, restoring, h)
    low = levels[1]
    rest = h
    if levels[0] < brim[0]:
        filling = math.log((flow - levels[0]) / (flow - brim[0])) / rates[0]
        rest = h - filling
        kept = (flow - brim[0]) / (flow - levels[0]), math.exp(-rates[1] * restoring * filling)
        low = _lower_level(levels, flow, load, rates, kept, restoring, filling)
    end = (brim[0] + brim[1] * max(flow - brim[0], 0.0) - load) / restoring
    return brim[0], end + (low - end) * math.exp(-rates[1] * restoring * rest)


@compiled()
def _lower_level(
    levels: tuple[float, float],
    flow: float,
    load: float,
    rates: tuple[float, float],
    keep: tuple[float, float],
    restoring: float,
    h: float,
) -> float:
    """Level of the lower tank after `h`, while the upper one approaches the `flow`."""
    own = rates[1] * restoring
    difference = own - rates[0]
    is_close = abs(difference) * h < CLOSE_RATES
    decay = h * math.sqrt(keep[0] * keep[1]) if is_close else (keep[0] - keep[1]) / difference
    end = (flow - load) / restoring
    return end + (levels[1] - end) * keep[1] + (levels[0] - flow) * rates[1] * decay


@compiled()
def _held_input(w: FloatArray, k: int, before: float) -> float:
    """Mean input over a substep, of which the share `before`, clipped to 0..1, precedes the change of the input."""
    if before <= 0.0 or k == 0:
        return w[k]
    return w[k] + min(before, 1.0) * (w[k - 1] - w[k])


@compiled()
def transition(c: float, k: float, h: float) -> tuple[float, float, float, float, float, float]:
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
def simulate_linear(w: FloatArray, c: float, k: float) -> FloatArray:
    """Position and speed of z'' = -c z' - k z + w from rest, shape (N, 2)."""
    out = np.empty((w.size, 2))
    f11, f12, f21, f22, g1, g2 = transition(c, k, 1.0)
    z = v = 0.0
    for n in range(w.size):
        out[n, 0] = z
        out[n, 1] = v
        z, v = f11 * z + f12 * v + g1 * w[n], f21 * z + f22 * v + g2 * w[n]
    return out


@compiled()
def sliding_friction(v: float, friction: float, peak: float, decay: float) -> float:
    """Friction at the speed v: it falls from `friction` + `peak` at rest to `friction`, over the speed `decay`."""
    fall = (v / decay) ** 2
    return friction if peak == 0.0 or fall > NEGLIGIBLE else friction + peak * math.exp(-fall)


@compiled()
def _tanh(x: float) -> float:
    """Hyperbolic tangent from one exponential, which is faster than that of the library; exact to 1e-16."""
    return 1.0 - 2.0 / (math.exp(2.0 * x) + 1.0)


@compiled()
def _slide(
    z: float, v: float, force: float, c: float, k: float, friction: float, smooth: float, h: float
) -> tuple[float, float]:
    """Step of z'' = -c z' - k z - friction tanh(z' / smooth) + force, with the friction linearized about v.

    At a change of direction the step is split, so that the friction turns within it.
    """
    shape = _tanh(v / smooth)
    slope = friction * (1.0 - shape * shape) / smooth
    held = force - friction * shape + slope * v
    f11, f12, f21, f22, g1, g2 = transition(c + slope, k, h)
    new_z, new_v = f11 * z + f12 * v + g1 * held, f21 * z + f22 * v + g2 * held
    if new_v * v >= 0.0:
        return new_z, new_v
    moving = h * v / (v - new_v)
    z += 0.5 * moving * v
    f11, f12, f21, f22, g1, g2 = transition(c + friction / smooth, k, h - moving)
    return f11 * z + g1 * force, f21 * z + g2 * force


@compiled()
def _bend(
    z: float, v: float, force: float, c: float, k: float, dry: float, stiff: float, held: float, h: float
) -> tuple[float, float, float]:
    """Step of z'' = -c z' - k z - held + force with Dahl's friction, held' = stiff z' (1 - held sign(z') / dry)."""
    sign = math.copysign(1.0, v if v != 0.0 else force - k * z - held)
    tangent = stiff * max(1.0 - sign * held / dry, 0.0)
    f11, f12, f21, f22, g1, g2 = transition(c, k + tangent, h)
    force += tangent * z - held
    new_z, new_v = f11 * z + f12 * v + g1 * force, f21 * z + f22 * v + g2 * force
    end = math.copysign(dry, new_z - z)
    return new_z, new_v, end + (held - end) * math.exp(-stiff * abs(new_z - z) / dry)


@compiled()
def _slide_motor(v: float, drive: float, a: float, friction: float, smooth: float, h: float, keep: float) -> float:
    """Step of v' = a (drive - friction tanh(v / smooth) - v), with the friction linearized about v.

    `keep` is exp(-a h).
    """
    if abs(v) > SATURATED * smooth:
        rest = drive - math.copysign(friction, v)
        new = rest + (v - rest) * keep
        if new * v >= 0.0:
            return new
    sharpness = 1.0 / smooth
    shape = _tanh(v * sharpness)
    slope = 1.0 + friction * (1.0 - shape * shape) * sharpness
    way = (drive - friction * shape - v) / slope  # to the rest of the linearized motion
    new = v + way * (1.0 - math.exp(-a * slope * h))
    if new * v >= 0.0:
        return new
    remaining = h + math.log1p(v / way) / (a * slope)  # after the change of direction
    slope = 1.0 + friction * sharpness
    return drive / slope * (1.0 - math.exp(-a * slope * remaining))


@compiled()
def _rebound(
    z: float, v: float, before: float, stop: float, outwards: float, share: float, h: float
) -> tuple[float, float]:
    """Position and speed after a step of `h` that ended beyond a stop, from the speed `before`.

    `outwards` is the sign of a speed into the stop. The acceleration is constant within the step. The mass rests at
    the stop if it would be back within a step.
    """
    if v * outwards <= 0.0:
        return stop, v
    acceleration = (v - before) / h
    since = (z - stop) / v
    since = (z - stop) / (v - 0.5 * acceleration * since)
    back = -share * (v - acceleration * since)
    if abs(back) <= acceleration * outwards * h:
        return stop, 0.0
    return stop + (back + 0.5 * acceleration * since) * since, back + acceleration * since


@compiled()
def simulate_mass(
    w: FloatArray,
    c: float,
    k: float,
    friction: float,
    cubic: float,
    z: float,
    v: float,
    substeps: int,
    late: float = 0.0,
    opposing: FloatArray | None = None,
    leak: FloatArray | None = None,
    pace: FloatArray | None = None,
    law: tuple[float, float, float] = SHARP,
    drag: float = 0.0,
    stops: tuple[float, float, float] = NO_STOPS,
    joint: tuple[float, float, float, float, float, float, float, float, float] = NO_JOINT,
) -> FloatArray:
    """Position and speed of z'' = -c z' - k z - friction sign(z') - drag z' |z'| - cubic z^3 + w, including sticking.

    The force `opposing` and a spring of stiffness `leak` times k oppose the input; `pace` multiplies k. These three
    have one value per sample. `law` holds the speed over which friction is smooth about rest (zero for none), and the
    `peak` and `decay` of `sliding_friction`. `stops` holds two positions, and the share of its speed that the mass
    keeps when it hits one of them. `joint` holds the limit of the force of a drive, w - of_position k z - of_speed
    c z', with the shares of both that the drive gives; the torque of gravity, its `turn` and `angle` in
    torque sin(turn z - angle), the share of the transmitted force that is added to friction, the stiffness of Dahl's
    bristles, which bend before they slide, zero for rigid ones, and the share of the stiffness that is the drive's, if
    the transmitted force is that of the drive, or `ALL_FORCES`.
    """
    smooth, peak, decay = law
    limit, of_position, of_speed, torque, turn, angle, share, stiff, own = joint
    out = np.empty((2, w.size))
    h = 1.0 / substeps
    free = transition(c, k, h)
    limited = transition((1.0 - of_speed) * c, (1.0 - of_position) * k, h) if limit < np.inf else free
    bends = (cubic != 0.0 or torque != 0.0) and friction == 0.0
    far = DIVERGED / max(k, 1e-6)
    constant = k
    held = 0.0  # force of the bristles
    if stiff > 0.0 and v == 0.0:
        held = w[0] - k * z - torque * math.sin(turn * z - angle)
        held = math.copysign(min(abs(held), friction + peak), held)
    for n in range(w.size):
        if pace is not None:
            k = constant * pace[n]
            free = transition(c, k, h)
            limited = transition((1.0 - of_speed) * c, (1.0 - of_position) * k, h) if limit < np.inf else free
        out[0, n], out[1, n] = z, v
        load = 0.0 if opposing is None else opposing[n]
        spring = 0.0 if leak is None else leak[n] * k
        for j in range(substeps):
            drive = _held_input(w, n, late * substeps - j)
            v_before = v
            middle = z + 0.5 * h * v
            damping, stiffness = c, k
            f11, f12, f21, f22, g1, g2 = free
            of_drive = drive - of_position * k * middle - of_speed * c * v
            transmitted = drive - own * k * middle
            if abs(of_drive) > limit:
                drive = math.copysign(limit, of_drive)
                transmitted = drive
                damping, stiffness = (1.0 - of_speed) * c, (1.0 - of_position) * k
                f11, f12, f21, f22, g1, g2 = limited
            net_drive = drive - load
            if bends:
                weight = torque * math.sin(turn * z - angle) if torque != 0.0 else 0.0
                pull = net_drive - damping * v - (stiffness + cubic * z * z) * z - weight
                middle += CUBIC_CORRECTION * h * h * pull
            force = net_drive - cubic * middle * middle * middle - spring * middle
            if torque != 0.0:
                force -= torque * math.sin(turn * middle - angle)
            dry = friction
            if share > 0.0:
                dry += share * abs(transmitted if own >= 0.0 else force - stiffness * middle)
            if drag > 0.0:
                rest = force - damping * v - stiffness * z
                middle_speed = (v + 0.5 * h * rest) / (1.0 + 0.5 * h * drag * abs(v))
                force -= drag * middle_speed * abs(middle_speed)
            if dry > 0.0 and smooth > 0.0:
                z, v = _slide(z, v, force, damping, stiffness, dry, smooth, h)
            elif dry > 0.0 and stiff > 0.0:
                level = sliding_friction(v, dry, peak, decay)
                z, v, held = _bend(z, v, force, damping, stiffness, level, stiff, held, h)
            elif dry > 0.0:
                if v > 0.0:
                    sign = 1.0
                elif v < 0.0:
                    sign = -1.0
                else:
                    net = force - stiffness * z
                    if abs(net) <= dry + peak:
                        continue
                    sign = 1.0 if net > 0.0 else -1.0
                force -= sign * sliding_friction(v, dry, peak, decay)
                new_z = f11 * z + f12 * v + g1 * force
                new_v = f21 * z + f22 * v + g2 * force
                if new_v * sign < 0.0:  # the motion ends within this step: stick or reverse
                    moving = h * v / (v - new_v)
                    z += 0.5 * moving * v
                    v = 0.0
                    net = net_drive - cubic * z * z * z - (stiffness + spring) * z
                    if torque != 0.0:
                        net -= torque * math.sin(turn * z - angle)
                    if abs(net) > dry + peak:
                        remaining = h - moving
                        net -= (dry + peak) * (1.0 if net > 0.0 else -1.0)
                        v = net * remaining
                        z += 0.5 * v * remaining
                else:
                    z, v = new_z, new_v
            else:
                z, v = f11 * z + f12 * v + g1 * force, f21 * z + f22 * v + g2 * force
            if z > stops[1]:
                z, v = _rebound(z, v, v_before, stops[1], 1.0, stops[2], h)
            elif z < stops[0]:
                z, v = _rebound(z, v, v_before, stops[0], -1.0, stops[2], h)
        if not abs(z) < far:
            out[:, n:] = np.nan
            break
    return out.T


@compiled()
def simulate_motor(
    w: FloatArray,
    a: float,
    b: float,
    friction: float,
    lag_first: bool,
    v: float,
    i: float,
    substeps: int,
    late: float = 0.0,
    opposing: FloatArray | None = None,
    leak: FloatArray | None = None,
    pace: FloatArray | None = None,
    law: tuple[float, float, float] = SHARP,
    drag: float = 0.0,
    bristles: tuple[float, float] = (0.0, 0.0),
) -> FloatArray:
    """Output and speed of a motor with dry friction, and a lag of rate `b` before or after it; unit gain.

    The motion is v' = a (drive - friction sign(v) - v - drag v |v|). With `lag_first` the drive is the lagged input,
    i' = b (w - i); otherwise it is the input, and the lag follows the speed. The load `opposing` plus `leak` times the
    speed oppose the drive; `pace` multiplies the rate of the last of the two. These three have one value per sample.
    `law` holds the speed over which friction is smooth about rest (zero for none), and the `peak` and `decay` of
    `sliding_friction`; `bristles` the share of the force drive - v that is added to friction, and the stiffness of
    Dahl's bristles, zero for rigid ones.
    """
    smooth, peak, decay = law
    share, stiff = bristles
    held = 0.0  # force of the bristles
    out = np.empty((2, w.size))
    h = 1.0 / substeps
    keep_a, keep_b = math.exp(-a * h), math.exp(-b * h)
    constant = a
    for n in range(w.size):
        if pace is not None and lag_first:
            a = constant * pace[n]
            keep_a = math.exp(-a * h)
        elif pace is not None:
            keep_b = math.exp(-b * pace[n] * h)
        out[0, n], out[1, n] = v if lag_first else i, v
        load = 0.0 if opposing is None else opposing[n]
        leaking = 0.0 if leak is None else leak[n]
        for j in range(substeps):
            drive = _held_input(w, n, late * substeps - j)
            if lag_first:
                new_i = drive + (i - drive) * keep_b
                drive -= (new_i - i) / (b * h)  # its mean over the step
                i = new_i
            drive -= load + leaking * v
            v_before = v
            rate, keep, dry, top = a, keep_a, friction + share * abs(drive - v), peak
            if drag > 0.0:  # at the middle speed, drag divides all forces and multiplies the rate
                factor = 1.0 + drag * abs(v)
                half = 0.5 * h * a
                factor = 1.0 + drag * abs((v + half * drive) / (1.0 + half * factor))
                rate, drive, dry, top = a * factor, drive / factor, dry / factor, peak / factor
                keep = math.exp(-rate * h)
            if v > 0.0:
                sign = 1.0
            elif v < 0.0:
                sign = -1.0
            elif abs(drive) <= dry + top:
                sign = 0.0
            else:
                sign = 1.0 if drive > 0.0 else -1.0
            if smooth > 0.0:
                v = _slide_motor(v, drive, rate, dry, smooth, h, keep)
            elif stiff > 0.0 and dry > 0.0:
                level = a * sliding_friction(v, dry, top, decay)
                _, v, held = _bend(0.0, v, a * drive, rate, 0.0, level, a * stiff, held, h)
            elif sign != 0.0:
                rest = drive - sign * sliding_friction(v, dry, top, decay)
                v = rest + (v - rest) * keep
                if v * sign < 0.0:  # the motion ends within this step: stick or reverse
                    remaining = h - math.log((v_before - rest) / -rest) / rate
                    v = 0.0
                    if abs(drive) > dry + top:
                        onward = drive - (dry + top) * (1.0 if drive > 0.0 else -1.0)
                        v = onward * (1.0 - math.exp(-rate * remaining))
            if not lag_first:
                middle = 0.5 * (v_before + v)
                i = middle + (i - middle) * keep_b
    return out.T
