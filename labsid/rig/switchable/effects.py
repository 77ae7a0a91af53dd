"""The unmodelled effects of the table: drawn for a rig and an input, then entered at any strength."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable._effect_draws import DRAWS, ApplyEffect, EffectContext
from labsid.rig.switchable._motion import LAGGED_TANK, MASS, MOTOR_POSITION, MOTOR_SPEED, TWO_TANKS
from labsid.rig.switchable.plants import time_scale
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import plant_output

__all__ = ["EFFECTS", "ApplyEffect", "EffectContext", "draw_effect", "effect_context", "supports_effect"]

EFFECTS = tuple(DRAWS)


def effect_context(setup: Setup, v: FloatArray, rounding: float = 0.0) -> EffectContext:
    """Play the command on the rig without effects and say what a draw may know.

    Parameters
    ----------
    setup : Setup
    v : ndarray, shape (N,)
    rounding : float
        Radius of the corners of limits and dead bands, as a share of the range.

    Returns
    -------
    Situation
    """
    return EffectContext(setup=setup, v=v, y=plant_output(setup, v), time=time_scale(setup), rounding=rounding)


def draw_effect(rng: np.random.Generator, name: str, context: EffectContext) -> ApplyEffect:
    """Draw one effect of the table.

    Parameters
    ----------
    rng : Generator
    name : str
        Its name in the table.
    context : Situation

    Returns
    -------
    callable
        ``enter(setup, strength) -> setup`` with strength from 0 to 1.

    Raises
    ------
    ValueError
        If there is no such effect, or this rig cannot have it.
    """
    if name not in DRAWS:
        raise ValueError(f"name must be an effect of the table; got {name!r}. There are {', '.join(DRAWS)}.")
    if not supports_effect(context.setup, name):
        raise ValueError(f"a {context.setup.rig} cannot have {name}. Draw another rig.")
    return DRAWS[name](rng, context)


def supports_effect(setup: Setup, name: str) -> bool:
    """Whether the physics of a rig has a place for an effect.

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
}
