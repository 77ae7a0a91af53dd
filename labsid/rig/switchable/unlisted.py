"""Effects that the diagnosis has no name for, to which the correct verdict is "unknown".

Each of them depends on the input. An unmeasured additive input is not among them: in a single record it is
indistinguishable from coloured noise or a periodic disturbance, which are in the table.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from labsid.rig.switchable._effect_draws import ApplyEffect, EffectContext
from labsid.rig.switchable._motion import MASS
from labsid.rig.switchable.setup import Setup


def draw_unlisted_effect(rng: np.random.Generator, name: str, context: EffectContext) -> ApplyEffect:
    """Draw an effect outside the table.

    Parameters
    ----------
    rng : Generator
    name : str
        One of `UNLISTED_EFFECTS`.
    context : EffectContext

    Returns
    -------
    callable
        ``apply(setup, strength) -> setup`` with strength from 0 to 1.

    Raises
    ------
    ValueError
        If there is no such effect, or the rig does not support it.
    """
    if name not in _DRAWS:
        raise ValueError(f"name must be an effect outside the table; got {name!r}. There are {', '.join(_DRAWS)}.")
    if not supports_unlisted_effect(context.setup, name):
        raise ValueError(f"a {context.setup.rig} cannot have {name}. Draw another rig.")
    return _DRAWS[name](rng, context)


def supports_unlisted_effect(setup: Setup, name: str) -> bool:
    """Whether an effect outside the table is physically possible on a rig.

    Parameters
    ----------
    setup : Setup
    name : str

    Returns
    -------
    bool
    """
    return setup.motion.kind != MASS or name not in ("slower-down-than-up", "switching-pole")


def _motion(setup: Setup, s: float, **fields: Any) -> Setup:
    return setup if s == 0.0 else replace(setup, motion=setup.motion._replace(**fields))


def _slower_down(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    sign = rng.choice([-1.0, 1.0])
    return lambda setup, s: _motion(setup, s, fall_rate=float(5.0 ** (sign * s)))


def _switching_pole(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    level = float(np.quantile(at.y, rng.uniform(0.35, 0.65)))
    sign = rng.choice([-1.0, 1.0])
    return lambda setup, s: _motion(setup, s, switch_level=level, switch_rate=float(5.0 ** (sign * s)))


def _bilinear(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    most = 0.85 * float(rng.choice([-1.0, 1.0])) / float(np.max(np.abs(at.y)))
    return lambda setup, s: _motion(setup, s, bilinear=s * most)


def _slow_falling_sensor(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    up = float(rng.uniform(0.2, 0.4))
    fall = float(min(1.5 * at.time, 40.0))
    return lambda setup, s: _motion(setup, s, sensor_lag=up, sensor_fall_lag=up + s * fall)


def _relays(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    count = int(rng.integers(3, 6))
    middles = rng.uniform(-0.5, 0.5, count)
    widths = rng.uniform(0.3, 0.9, count)
    heights = rng.uniform(0.5, 1.0, count) / count

    def apply(setup: Setup, s: float) -> Setup:
        if s == 0.0:
            return setup
        relays = tuple(
            (float(m - 0.5 * w), float(m + 0.5 * w), float(1.6 * s * h))
            for m, w, h in zip(middles, widths, heights, strict=True)
        )
        return replace(setup, actuator=replace(setup.actuator, relays=relays))

    return apply


def _swinging_delay(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    period = float(rng.uniform(3.0, 12.0) * at.time)
    most = min(0.9 * at.time, 20.0)

    def apply(setup: Setup, s: float) -> Setup:
        delay = setup.actuator.delay + s * most
        return replace(
            setup,
            actuator=replace(setup.actuator, delay=delay, delay_swing=s * most, delay_period=period),
        )

    return apply


def _failures(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    n = at.v.size
    length = int(rng.uniform(1.0, 3.0) * at.time) + 4
    count = int(np.clip(n // (6 * length), 2, 12))
    starts = (np.arange(count) + rng.uniform(0.1, 0.6, count)) * n / count

    def apply(setup: Setup, s: float) -> Setup:
        if s == 0.0:
            return setup
        stretches = tuple((int(start), int(start + max(2, s * length))) for start in starts)
        return replace(setup, actuator=replace(setup.actuator, failures=stretches))

    return apply


def _second_valve(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    hold = float(rng.uniform(0.8, 3.0) * at.time)
    seed = int(rng.integers(2**31))

    def apply(setup: Setup, s: float) -> Setup:
        return replace(setup, actuator=replace(setup.actuator, valve_spread=0.9 * s, valve_hold=hold, seed=seed))

    return apply


def _sticking_valve(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    most = 0.35 * float(np.ptp(at.v))
    return lambda setup, s: replace(setup, actuator=replace(setup.actuator, stick_band=s * most))


_DRAWS: dict[str, Callable[[np.random.Generator, EffectContext], ApplyEffect]] = {
    "slower-down-than-up": _slower_down,
    "switching-pole": _switching_pole,
    "bilinear-gain": _bilinear,
    "slow-falling-sensor": _slow_falling_sensor,
    "relay-hysteresis": _relays,
    "swinging-delay": _swinging_delay,
    "failing-actuator": _failures,
    "second-valve": _second_valve,
    "sticking-valve": _sticking_valve,
}

UNLISTED_EFFECTS = tuple(_DRAWS)

UNLISTED_PATHS: dict[str, tuple[str, ...]] = {
    "slower-down-than-up": ("dynamics",),
    "switching-pole": ("dynamics",),
    "bilinear-gain": ("dynamics",),
    "slow-falling-sensor": ("output", "dynamics"),
    "relay-hysteresis": ("input",),
    "swinging-delay": ("time",),
    "failing-actuator": ("time", "disturbance"),
    "second-valve": ("time", "disturbance"),
    "sticking-valve": ("input",),
}
"""Where each of them acts; the first path that is given counts, or any where the record cannot tell them apart."""
