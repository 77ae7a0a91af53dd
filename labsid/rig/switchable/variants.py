"""Other forms of the effects that the diagnosis names, with a behaviour that the usual draw does not have."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from labsid.rig.switchable._effect_draws import ApplyEffect, EffectContext
from labsid.rig.switchable._motion import MASS, MOTOR_POSITION
from labsid.rig.switchable.setup import Setup


def draw_variant(rng: np.random.Generator, name: str, context: EffectContext) -> ApplyEffect:
    """Draw another form of an effect.

    Parameters
    ----------
    rng : Generator
    name : str
        One of `VARIANTS`.
    context : EffectContext
        Of a rig that supports the effect.

    Returns
    -------
    callable
        ``apply(setup, strength) -> setup`` with strength from 0 to 1.

    Raises
    ------
    ValueError
        If there is no such form.
    """
    if name not in _DRAWS:
        raise ValueError(f"name must be a form of an effect; got {name!r}. There are {', '.join(_DRAWS)}.")
    return _DRAWS[name](rng, context)


def _friction(at: EffectContext, back: float = 0.0, peak: float = 0.0, speed: float = 0.0) -> ApplyEffect:
    most = 0.6 * float(np.std(at.v)) + 0.2

    def apply(setup: Setup, s: float) -> Setup:
        if s == 0.0:
            return setup
        motion = setup.motion._replace(
            dry_friction=s * most, friction_back=back, friction_peak=peak, friction_speed=speed
        )
        return replace(setup, motion=motion)

    return apply


def _highest_speed(at: EffectContext) -> float:
    """Highest speed of the state that friction acts on, without the effect."""
    motion = at.setup.motion
    if motion.kind == MASS:
        return float(np.max(np.abs(np.diff(at.y))))
    if motion.kind == MOTOR_POSITION:
        return float(np.max(np.abs(at.y[1:] + motion.T1 * np.diff(at.y))))
    return float(np.max(np.abs(at.y + motion.speed_zero)))


def _each_way(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    ratio = float(rng.uniform(0.3, 0.6))
    return _friction(at, back=float(rng.choice([ratio, 1.0 / ratio])) - 1.0)


def _break_away(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    speed = float(rng.uniform(0.02, 0.1)) * _highest_speed(at)
    return _friction(at, peak=float(rng.uniform(0.3, 1.0)), speed=speed)


def _smooth(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    return _friction(at, speed=float(rng.uniform(0.03, 0.15)) * _highest_speed(at))


def _dead_zone_with_jump(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    low, high = rng.uniform(0.35, 0.75, 2).tolist()
    jump = float(rng.uniform(0.4, 1.0))

    def apply(setup: Setup, s: float) -> Setup:
        if s == 0.0:
            return setup
        actuator = replace(setup.actuator, dead_low=-s * low, dead_high=s * high, dead_jump=jump)
        return replace(setup, actuator=actuator)

    return apply


def _absolute_value(rng: np.random.Generator, at: EffectContext) -> ApplyEffect:
    """The zero of the sensor moves from the end of the range to a place about the rest position."""
    lowest, zero = float(at.y.min()), float(rng.uniform(-0.2, 0.2) * np.max(np.abs(at.y)))

    def apply(setup: Setup, s: float) -> Setup:
        if s == 0.0:
            return setup
        return replace(setup, sensor=replace(setup.sensor, fold=lowest + s * (zero - lowest)))

    return apply


_DRAWS: dict[str, Callable[[np.random.Generator, EffectContext], ApplyEffect]] = {
    "friction, another value each way": _each_way,
    "friction, break-away peak": _break_away,
    "friction, smooth about rest": _smooth,
    "dead zone, with a jump": _dead_zone_with_jump,
    "sensor, absolute value": _absolute_value,
}

VARIANTS: dict[str, str] = {
    "friction, another value each way": "coulomb-friction",
    "friction, break-away peak": "coulomb-friction",
    "friction, smooth about rest": "coulomb-friction",
    "dead zone, with a jump": "input-dead-zone",
    "sensor, absolute value": "output-nonlinearity",
}
"""Effect of the table that each form is."""
