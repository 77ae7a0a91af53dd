"""Equations of motion of all rigs and their integration, compiled by numba.

Rig units: time in samples, input and states as deviations from the operating point, static gain one. ``x0`` and
``x1`` are the states of the plant, ``x2`` the lag of the actuator, ``x3`` the lag of the sensor, ``x4`` and ``x5``
a resonant mode, ``x6`` a slow mode, and ``x7`` the sensor's side of the play between process and sensor.
"""

from typing import NamedTuple

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled

STATE_COUNT = 8

TWO_TANKS, LAGGED_TANK, MOTOR_SPEED, MOTOR_POSITION, HEATED_FAR, HEATED_NEAR, MASS = range(7)
NO_MODE, SERIES_MODE, PARALLEL_MODE = range(3)
_FREE, _ON_THE_STOP = -1, STATE_COUNT
"""Values of `held` in `advance` besides the index of a state: nothing is held, or the plant's two states are."""

_HALVINGS = 40
"""Halvings of a step that place an impact in it: more than the digits of the step."""

_MOST_EVENTS = 8
"""Most departures and impacts within one integration step; after them the motion rests on the stop."""

_SLOWEST_REBOUND = 1e-4
"""Speed (rig units per sample) below which a motion does not rebound from the end stop."""


class Motion(NamedTuple):
    """Parameters of the equations of motion: first the plant, then the effects on its states.

    Times are in samples. ``speed_zero`` is the true speed at the operating point, ``level_zero`` the true level.
    ``spill_share`` is the share of the upper tank's overflow that reaches the lower tank. ``drag`` multiplies the
    square of the speed. ``stop_low`` and ``stop_high`` are the positions of the end stops, and ``restitution`` is the
    share of the speed that a motion keeps in the impact. ``slow_time`` and ``slow_share`` are the time constant and the
    gain of the slow mode. ``play`` is the width of the play between process and sensor, and ``play_start`` the sensor's
    position in it at the start of the record, from -1 to 1. ``friction_back`` is the share by which dry friction
    is larger against a motion backwards. With a ``friction_peak``, the friction near rest is higher by
    this share and falls within ``friction_speed``; without one, a ``friction_speed`` makes the friction smooth about
    rest.
    """

    kind: int
    T0: float
    T1: float
    damping: float
    coupling: float
    loss: float
    speed_zero: float
    level_zero: float
    actuator_lag: float
    sensor_lag: float
    sensor_fall_lag: float
    mode: int
    mode_frequency: float
    mode_damping: float
    mode_share: float
    outflow_curvature: float
    brim_upper: float
    brim_lower: float
    spill_share: float
    dry_friction: float
    cubic: float
    bilinear: float
    fall_rate: float
    switch_level: float
    switch_rate: float
    drag: float
    stop_low: float
    stop_high: float
    restitution: float
    slow_time: float
    slow_share: float
    play: float
    play_start: float
    friction_back: float
    friction_peak: float
    friction_speed: float


@compiled()
def outflow(x: float, root: float) -> float:
    """Outflow of a tank: linear in its level, or a square root with slope one at the operating point."""
    if root == 0.0:
        return x
    return 2.0 / root * (np.sqrt(max(1.0 + root * x, 0.0)) - 1.0)


@compiled()
def sensor_output(m: Motion, x: FloatArray) -> float:
    """Output of the sensor, with its lag."""
    if m.sensor_lag > 0.0:
        return x[3]
    return transmitted_output(m, x)


@compiled()
def transmitted_output(m: Motion, x: FloatArray) -> float:
    """Quantity that reaches the sensor through the play, before the sensor's lag."""
    return x[7] if m.play > 0.0 else physical_output(m, x)


@compiled()
def follow(m: Motion, x: FloatArray) -> None:
    """Move the sensor's side of the play to where the process pushes it."""
    if m.play > 0.0:
        y = physical_output(m, x)
        x[7] = min(max(x[7], y - 0.5 * m.play), y + 0.5 * m.play)


@compiled()
def physical_output(m: Motion, x: FloatArray) -> float:
    """Quantity that the sensor measures, before play and lag."""
    y = x[0] if m.kind == HEATED_NEAR or m.kind == MASS else x[1]
    if m.mode == PARALLEL_MODE:
        y += m.mode_share * x[4]
    if m.slow_share != 0.0:
        y += m.slow_share * x[6]
    return y


@compiled()
def smooth_friction(m: Motion) -> bool:
    """Whether dry friction grows smoothly with the speed, so that nothing sticks."""
    return m.friction_speed > 0.0 and m.friction_peak == 0.0


@compiled()
def sliding_friction(m: Motion, direction: float) -> float:
    """Friction against a motion in a direction, from -1 to 1, without the peak near rest."""
    size = m.dry_friction * direction
    return size * (1.0 + m.friction_back) if direction < 0.0 else size


@compiled()
def drag_force(m: Motion, speed: float) -> float:
    """Resistance against a speed; a motor that runs at its operating point has the resistance there as its zero."""
    if m.drag == 0.0:
        return 0.0
    if m.kind != MOTOR_SPEED:
        return m.drag * speed * abs(speed)
    total = speed + m.speed_zero
    return m.drag * (total * abs(total) - m.speed_zero * abs(m.speed_zero))


@compiled()
def friction_state(kind: int) -> int:
    """Index of the state that dry friction acts on."""
    return 0 if kind == MOTOR_POSITION else 1


@compiled()
def derivative(
    m: Motion, x: FloatArray, w: float, load: float, rate: float, leak: float, friction: float, d: FloatArray
) -> None:
    """Write dx/dt into `d`; `friction` is the present friction force and `rate` scales the slower pole."""
    if m.actuator_lag > 0.0:
        d[2] = (w - x[2]) / m.actuator_lag
        w = x[2]
    if m.mode != NO_MODE:
        d[4] = x[5]
        d[5] = m.mode_frequency**2 * (w - x[4]) - 2.0 * m.mode_damping * m.mode_frequency * x[5]
        if m.mode == SERIES_MODE:
            w = x[4]
    if m.slow_share != 0.0:
        d[6] = (w - x[6]) / m.slow_time
    if m.bilinear != 0.0:
        w *= 1.0 + m.bilinear * x[0 if m.kind == MASS else 1]
    if m.friction_speed > 0.0:
        relative = (x[friction_state(m.kind)] + m.speed_zero) / m.friction_speed
        if smooth_friction(m):
            friction = sliding_friction(m, np.tanh(relative))
        else:
            friction *= 1.0 + m.friction_peak * np.exp(-(relative**2))
    drain = leak * (x[1] + m.level_zero)
    if m.kind == TWO_TANKS or m.kind == LAGGED_TANK:
        between = outflow(x[0], m.outflow_curvature) if m.kind == TWO_TANKS else x[0]
        d[0] = (w - between) / m.T0
        spill = 0.0
        if x[0] >= m.brim_upper and d[0] > 0.0:
            spill = w - between
            d[0] = 0.0
        d[1] = rate * (between + m.spill_share * spill + load - drain - outflow(x[1], m.outflow_curvature)) / m.T1
        if x[1] >= m.brim_lower and d[1] > 0.0:
            d[1] = 0.0
    elif m.kind == MOTOR_SPEED:
        d[0] = (w - x[0]) / m.T0
        d[1] = rate * (x[0] + load - drain - x[1] - friction - drag_force(m, x[1])) / m.T1
    elif m.kind == MOTOR_POSITION:
        d[1] = rate * (x[0] - drain - x[1]) / m.T1
        d[0] = (w + load - x[0] - friction - drag_force(m, d[1])) / m.T0
    elif m.kind == MASS:
        pull = rate * x[0] + m.cubic * x[0] ** 3 + leak * (x[0] + m.level_zero)
        d[0] = x[1]
        d[1] = (w + load - pull - 2.0 * m.damping * m.T0 * x[1] - friction - drag_force(m, x[1])) / m.T0**2
    else:
        flow = m.coupling * (x[0] - x[1])
        d[0] = (w - flow - m.loss * x[0]) / m.T0
        d[1] = rate * (flow + load - drain - (1.0 - m.loss) * x[1]) / m.T1
    if m.kind != MASS:
        if d[1] < 0.0:
            d[1] *= m.fall_rate
        if x[1] > m.switch_level:
            d[1] *= m.switch_rate
    if m.sensor_lag > 0.0:
        gap = transmitted_output(m, x) - x[3]
        d[3] = gap / (m.sensor_fall_lag if gap < 0.0 and m.sensor_fall_lag > 0.0 else m.sensor_lag)


@compiled()
def advance(
    m: Motion,
    x: FloatArray,
    h: float,
    w: tuple[float, float],
    load: float,
    rate: float,
    leak: float,
    friction: float,
    held: int,
    k: FloatArray,
    trial: FloatArray,
) -> None:
    """One classical Runge-Kutta step of `x` in place; the state `held` does not move.

    The input runs from ``w[0]`` to ``w[1]`` along a straight line.
    """
    for stage in range(4):
        part = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
        for i in range(STATE_COUNT):
            trial[i] = x[i] + (part * h * k[stage - 1, i] if stage > 0 else 0.0)
        derivative(m, trial, w[0] + part * (w[1] - w[0]), load, rate, leak, friction, k[stage])
        if held == _ON_THE_STOP:
            k[stage, 0] = k[stage, 1] = 0.0
        elif held >= 0:
            k[stage, held] = 0.0
    for i in range(STATE_COUNT):
        x[i] += h / 6.0 * (k[0, i] + 2.0 * k[1, i] + 2.0 * k[2, i] + k[3, i])
    if m.kind == TWO_TANKS or m.kind == LAGGED_TANK:
        x[0] = min(x[0], m.brim_upper)
        x[1] = min(x[1], m.brim_lower)
        if m.outflow_curvature > 0.0:
            x[0] = max(x[0], -1.0 / m.outflow_curvature) if m.kind == TWO_TANKS else x[0]
            x[1] = max(x[1], -1.0 / m.outflow_curvature)


@compiled()
def position(m: Motion, x: FloatArray) -> float:
    """Position of a mass or of a position axis."""
    return x[0] if m.kind == MASS else x[1]


@compiled()
def velocity(m: Motion, x: FloatArray, rate: float, leak: float) -> float:
    """Speed of a mass or of a position axis."""
    if m.kind == MASS:
        return x[1]
    return rate * (x[0] - leak * (x[1] + m.level_zero) - x[1]) / m.T1


@compiled()
def place_on_stop(m: Motion, x: FloatArray, stop: float, speed: float, rate: float, leak: float) -> None:
    """Put a mass or a position axis on its stop, with a speed away from it or none."""
    if m.kind == MASS:
        x[0] = stop
        x[1] = speed
    else:
        x[1] = stop
        x[0] = stop + leak * (stop + m.level_zero) + speed * m.T1 / rate


@compiled()
def push(
    m: Motion, x: FloatArray, w: float, load: float, rate: float, leak: float, side: float, trial: FloatArray
) -> float:
    """Acceleration against the stop of a motion that rests on it; negative if the motion leaves the stop."""
    derivative(m, x, w, load, rate, leak, 0.0, trial)
    return side * (trial[1] if m.kind == MASS else trial[0])


@compiled()
def contact_side(m: Motion, x: FloatArray, rate: float, leak: float) -> float:
    """1 or -1 if a motion rests on its high or its low stop, otherwise 0."""
    speed = velocity(m, x, rate, leak)
    if position(m, x) >= m.stop_high and speed > -_SLOWEST_REBOUND:
        return 1.0
    if position(m, x) <= m.stop_low and speed < _SLOWEST_REBOUND:
        return -1.0
    return 0.0


@compiled()
def input_at(w: tuple[float, float], part: float) -> float:
    """Input at a share of a step."""
    return w[0] + part * (w[1] - w[0])


@compiled()
def advance_with_stops(
    m: Motion,
    x: FloatArray,
    before: FloatArray,
    h: float,
    w: tuple[float, float],
    load: float,
    rate: float,
    leak: float,
    k: FloatArray,
    trial: FloatArray,
) -> None:
    """Advance a motion with end stops by one step, which is split at every departure and at every impact."""
    for _ in range(_MOST_EVENTS):
        side = contact_side(m, x, rate, leak)
        if side != 0.0:
            place_on_stop(m, x, m.stop_high if side > 0.0 else m.stop_low, 0.0, rate, leak)
            first = push(m, x, w[0], load, rate, leak, side, trial)
            if first >= 0.0:
                before[:] = x
                advance(m, x, h, w, load, rate, leak, 0.0, _ON_THE_STOP, k, trial)
                last = push(m, x, w[1], load, rate, leak, side, trial)
                if last >= 0.0:
                    return
                part = first / (first - last)
                x[:] = before
                advance(m, x, part * h, (w[0], input_at(w, part)), load, rate, leak, 0.0, _ON_THE_STOP, k, trial)
                w, h = (input_at(w, part), w[1]), (1.0 - part) * h
        before[:] = x
        advance(m, x, h, w, load, rate, leak, 0.0, _FREE, k, trial)
        if m.stop_low <= position(m, x) <= m.stop_high:
            return
        stop = m.stop_high if position(m, x) > m.stop_high else m.stop_low
        inside, outside = 0.0, 1.0
        for _ in range(_HALVINGS):
            part = 0.5 * (inside + outside)
            x[:] = before
            advance(m, x, part * h, (w[0], input_at(w, part)), load, rate, leak, 0.0, _FREE, k, trial)
            if m.stop_low <= position(m, x) <= m.stop_high:
                inside = part
            else:
                outside = part
        speed = -m.restitution * velocity(m, x, rate, leak)
        place_on_stop(m, x, stop, speed if abs(speed) > _SLOWEST_REBOUND else 0.0, rate, leak)
        w, h = (input_at(w, part), w[1]), (1.0 - part) * h
    place_on_stop(m, x, stop, 0.0, rate, leak)
    advance(m, x, h, w, load, rate, leak, 0.0, _ON_THE_STOP, k, trial)


@compiled()
def move(
    m: Motion,
    x0: FloatArray,
    begin: FloatArray,
    end: FloatArray,
    load: FloatArray,
    rate: FloatArray,
    leak: FloatArray,
    per_sample: int,
) -> FloatArray:
    """Integrate over all steps and return the sensor output at the start of each sample.

    The arrays hold one value per integration step, `per_sample` steps per sample. With dry friction, a step in which
    the speed changes sign is split at the sign change; the rig then sticks while friction balances the other forces.
    With end stops, a step is split at every impact and every departure.
    """
    h = 1.0 / per_sample
    x = x0.copy()
    x_before = x0.copy()
    k = np.zeros((4, STATE_COUNT))
    trial = np.zeros(STATE_COUNT)
    y = np.empty(begin.size // per_sample)
    sliding = friction_state(m.kind)
    shift = m.speed_zero
    direction = 0.0
    stopped = m.stop_low > -np.inf or m.stop_high < np.inf
    if stopped and not m.stop_low < position(m, x) < m.stop_high:
        at = min(max(position(m, x), m.stop_low), m.stop_high)
        place_on_stop(m, x, at, 0.0, rate[0], leak[0])
    x[7] = physical_output(m, x) + 0.5 * m.play * m.play_start
    for j in range(begin.size):
        follow(m, x)
        if j % per_sample == 0:
            y[j // per_sample] = sensor_output(m, x)
        w = (begin[j], end[j])
        if stopped:
            advance_with_stops(m, x, x_before, h, w, load[j], rate[j], leak[j], k, trial)
            continue
        if m.dry_friction == 0.0 or smooth_friction(m):
            advance(m, x, h, w, load[j], rate[j], leak[j], 0.0, -1, k, trial)
            continue
        time_left = h
        for _ in range(3):
            speed = x[sliding] + shift
            if speed == 0.0:
                derivative(m, x, w[0], load[j], rate[j], leak[j], 0.0, trial)
                direction = np.sign(trial[sliding])
                derivative(m, x, w[0], load[j], rate[j], leak[j], sliding_friction(m, direction), trial)
                if trial[sliding] * direction <= 0.0:
                    advance(m, x, time_left, w, load[j], rate[j], leak[j], 0.0, sliding, k, trial)
                    break
            else:
                direction = np.sign(speed)
            x_before[:] = x
            friction = sliding_friction(m, direction)
            advance(m, x, time_left, w, load[j], rate[j], leak[j], friction, -1, k, trial)
            after = x[sliding] + shift
            if after * direction >= 0.0:
                break
            part = speed / (speed - after)
            x[:] = x_before
            advance(m, x, part * time_left, w, load[j], rate[j], leak[j], friction, -1, k, trial)
            x[sliding] = -shift
            time_left *= 1.0 - part
            if time_left <= 0.0:
                break
    return y
