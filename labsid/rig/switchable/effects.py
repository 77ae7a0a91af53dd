"""The unmodelled effects that the diagnosis names, drawn for a rig and an input and applied at any strength."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable._effect_draws import DRAWS, FAMILY_DRAWS, ApplyEffect, EffectContext
from labsid.rig.switchable._motion import LAGGED_TANK, MASS, MOTOR_POSITION, MOTOR_SPEED, TWO_TANKS
from labsid.rig.switchable.plants import time_scale
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import plant_output

__all__ = ["EFFECTS", "FAMILIES", "ApplyEffect", "EffectContext", "draw_effect", "effect_context", "supports_effect"]

EFFECTS = tuple(DRAWS)
"""Effects that most rows of the sealed check draw from; their order and number determine its cases."""

FAMILIES = tuple(FAMILY_DRAWS)
"""Further effects of the table, which have a row of their own."""

_ALL_DRAWS = DRAWS | FAMILY_DRAWS


def effect_context(setup: Setup, v: FloatArray, rounding: float = 0.0) -> EffectContext:
    """Run the rig without effects and collect the information for drawing an effect.

    Parameters
    ----------
    setup : Setup
    v : ndarray, shape (N,)
    rounding : float
        Corner radius of limits and dead zones, relative to the range.

    Returns
    -------
    EffectContext
    """
    return EffectContext(setup=setup, v=v, y=plant_output(setup, v), time=time_scale(setup), rounding=rounding)


def draw_effect(rng: np.random.Generator, name: str, context: EffectContext) -> ApplyEffect:
    """Draw an effect that the diagnosis names.

    Parameters
    ----------
    rng : Generator
    name : str
        Name of the effect.
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
    if name not in _ALL_DRAWS:
        raise ValueError(f"name must be an effect of the table; got {name!r}. There are {', '.join(_ALL_DRAWS)}.")
    if not supports_effect(context.setup, name):
        raise ValueError(f"a {context.setup.rig} cannot have {name}. Draw another rig.")
    return _ALL_DRAWS[name](rng, context)


def supports_effect(setup: Setup, name: str) -> bool:
    """Whether an effect is physically possible on a rig.

    Parameters
    ----------
    setup : Setup
    name : str

    Returns
    -------
    bool
    """
    return name not in _PLACES or setup.motion.kind in _PLACES[name]


_PLACES = {
    "sqrt-outflow": (TWO_TANKS, LAGGED_TANK),
    "overflow": (TWO_TANKS, LAGGED_TANK),
    "coulomb-friction": (MOTOR_SPEED, MOTOR_POSITION, MASS),
    "cubic-stiffness": (MASS,),
    "end-stop": (MOTOR_POSITION, MASS),
    "quadratic-drag": (MOTOR_SPEED, MOTOR_POSITION, MASS),
}
