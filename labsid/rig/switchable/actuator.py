"""The actuator chain: from the command to the plant input at every integration step."""

import numpy as np

from labsid._arrays import FloatArray
from labsid._compiled import compiled
from labsid.rig.switchable.setup import STEPS_PER_SAMPLE, Actuator, profile_values


def actuator_output(actuator: Actuator, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute the actuator output.

    Parameters
    ----------
    actuator : Actuator
    v : ndarray, shape (N,)
        Command, held over each sample.

    Returns
    -------
    tuple of ndarray, each of shape (N * STEPS,)
        Output at the beginning and at the end of each integration step; it is linear in between.
    """
    command = _delayed(actuator, acting_command(actuator, _skip_failures(actuator, v)))
    begin, end, _ = moved_actuator(actuator, command)
    return _gain(actuator, begin), _gain(actuator, end)


def moved_actuator(
    actuator: Actuator, command: FloatArray, last: tuple[float, float] | None = None
) -> tuple[FloatArray, FloatArray, tuple[float, float]]:
    """Output of the actuator for a command that has passed the delay, without changes of the gain.

    Parameters
    ----------
    actuator : Actuator
    command : ndarray, shape (steps,)
        One value per integration step.
    last : tuple of float, optional
        Where the backlash and the rate limit stood before; by default they follow the first value of the command.

    Returns
    -------
    tuple of ndarray, ndarray and tuple of float
        Output at the beginning and at the end of each step, and `last` for what follows.
    """
    shaped = _dead_band(command, actuator.dead_low, actuator.dead_high, actuator.rounding)
    if actuator.dead_jump:
        shaped = shaped + _jump(command, actuator)
    shaped = limited(shaped, actuator.low, actuator.high, actuator.rounding)
    if actuator.stick_band > 0:
        shaped = _sticking(shaped, actuator.stick_band)
    if actuator.backlash > 0:
        shaped = backlash_output(shaped, 0.5 * actuator.backlash, shaped[0] if last is None else last[0])
    played = float(shaped[-1])
    if actuator.relays:
        shaped = shaped + sum(_relay(shaped, *relay) for relay in actuator.relays)
    begin, end = shaped, shaped
    if np.isfinite(actuator.slew):
        begin, end = _slew(shaped, actuator.slew / STEPS_PER_SAMPLE, shaped[0] if last is None else last[1])
    return _curve(actuator, begin), _curve(actuator, end), (played, float(end[-1]))


def limited(v: FloatArray, low: float, high: float, rounding: float) -> FloatArray:
    """Limit `v` to [low, high], with rounded corners.

    Parameters
    ----------
    v : ndarray
    low, high : float
        Infinite if there is no limit.
    rounding : float
        Corner radius; 0 for sharp corners.

    Returns
    -------
    ndarray
    """
    if rounding == 0.0:
        return np.clip(v, low, high)
    if np.isfinite(high):
        v = high - _soft_plus(high - v, rounding)
    if np.isfinite(low):
        v = low + _soft_plus(v - low, rounding)
    return v


def _soft_plus(x: FloatArray, radius: float) -> FloatArray:
    """max(x, 0) with its corner rounded to a hyperbola."""
    return 0.5 * (x + np.sqrt(x**2 + radius**2)) if radius > 0 else np.maximum(x, 0.0)


def _dead_band(v: FloatArray, low: float, high: float, rounding: float) -> FloatArray:
    if low == high == 0.0:
        return v
    return _soft_plus(v - high, rounding) - _soft_plus(low - v, rounding)


def _jump(v: FloatArray, actuator: Actuator) -> FloatArray:
    edge = np.where(v > actuator.dead_high, actuator.dead_high, np.where(v < actuator.dead_low, actuator.dead_low, 0.0))
    return actuator.dead_jump * edge


def _skip_failures(actuator: Actuator, v: FloatArray) -> FloatArray:
    if not actuator.failures:
        return v
    v = v.copy()
    for start, stop in actuator.failures:
        v[start:stop] = v[max(start - 1, 0)]
    return v


def acting_command(actuator: Actuator, v: FloatArray, first: int = 0) -> FloatArray:
    """The command in the steps in which it acts, or the level that replaces it while the actuator is off.

    Parameters
    ----------
    actuator : Actuator
    v : ndarray, shape (N,)
    first : int
        Index of its first sample in the record.

    Returns
    -------
    ndarray, shape (N,)
    """
    if actuator.step:
        v = actuator.step * np.rint(v / actuator.step)
    if np.isfinite(actuator.off_start):
        k = first + np.arange(v.size)
        v = np.where((k >= actuator.off_start) & (k < actuator.off_stop), actuator.off_level, v)
    return v


def _delayed(actuator: Actuator, v: FloatArray) -> FloatArray:
    """The delayed command, held over each sample; before the record it equals its first value."""
    steps = np.arange(v.size * STEPS_PER_SAMPLE)
    lag = actuator.delay * STEPS_PER_SAMPLE
    if actuator.delay_swing:
        swing = np.sin(2 * np.pi * steps / (STEPS_PER_SAMPLE * actuator.delay_period))
        lag = lag + STEPS_PER_SAMPLE * actuator.delay_swing * swing
    source = np.floor((steps - np.rint(lag)) / STEPS_PER_SAMPLE).astype(int)
    return v[np.clip(source, 0, v.size - 1)]


def _curve(actuator: Actuator, v: FloatArray) -> FloatArray:
    if actuator.c2 == actuator.c3 == 0.0:
        return v
    return v + actuator.c2 * v**2 + actuator.c3 * v**3


def _gain(actuator: Actuator, v: FloatArray) -> FloatArray:
    if actuator.gain_change == actuator.valve_spread == 0.0:
        return v
    factor = 1 + actuator.gain_change * profile_values(actuator.gain_profile, np.linspace(0, 1, v.size))
    if actuator.valve_spread:
        factor = factor * _random_factors(actuator, v.size)
    return factor * (v - actuator.zero) + actuator.zero


def _random_factors(actuator: Actuator, steps: int) -> FloatArray:
    rng = np.random.default_rng(actuator.seed)
    samples = steps / STEPS_PER_SAMPLE
    holds = np.maximum(rng.exponential(actuator.valve_hold, size=int(4 * samples / actuator.valve_hold) + 20), 1.0)
    factors = 1 + actuator.valve_spread * rng.uniform(-1, 1, holds.size)
    return factors[
        np.searchsorted(np.cumsum(holds), np.arange(steps) / STEPS_PER_SAMPLE, side="right").clip(0, holds.size - 1)
    ]


@compiled()
def _sticking(v: FloatArray, band: float) -> FloatArray:
    out = np.empty_like(v)
    z = v[0]
    for j in range(v.size):
        if abs(v[j] - z) > band:
            z = v[j]
        out[j] = z
    return out


@compiled()
def backlash_output(v: FloatArray, half: float, z: float) -> FloatArray:
    """Signal after backlash of half width `half`, from its last value `z`."""
    out = np.empty_like(v)
    for j in range(v.size):
        z = min(max(z, v[j] - half), v[j] + half)
        out[j] = z
    return out


@compiled()
def _relay(v: FloatArray, low: float, high: float, height: float) -> FloatArray:
    out = np.empty_like(v)
    on = v[0] > high
    rest = height if on else 0.0
    for j in range(v.size):
        if v[j] > high:
            on = True
        elif v[j] < low:
            on = False
        out[j] = (height if on else 0.0) - rest
    return out


@compiled()
def _slew(v: FloatArray, most: float, z: float) -> tuple[FloatArray, FloatArray]:
    begin, end = np.empty_like(v), np.empty_like(v)
    for j in range(v.size):
        begin[j] = z
        z += min(max(v[j] - z, -most), most)
        end[j] = z
    return begin, end
