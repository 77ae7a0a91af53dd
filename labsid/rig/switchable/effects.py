"""The unmodelled effects of the table: drawn for a rig and an input, then entered at any strength."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.switchable._effect_draws import DRAWS, Enter, Situation
from labsid.rig.switchable._motion import LAGGED_TANK, MASS, MOTOR_POSITION, MOTOR_SPEED, TWO_TANKS
from labsid.rig.switchable.plants import time_scale
from labsid.rig.switchable.setup import Setup
from labsid.rig.switchable.simulation import respond

__all__ = ["EFFECTS", "Enter", "Situation", "can_have", "draw_effect", "look_at"]

EFFECTS = tuple(DRAWS)


def look_at(setup: Setup, v: FloatArray, rounding: float = 0.0) -> Situation:
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
    return Situation(setup=setup, v=v, y=respond(setup, v), time=time_scale(setup), rounding=rounding)


def draw_effect(rng: np.random.Generator, name: str, situation: Situation) -> Enter:
    """Draw one effect of the table.

    Parameters
    ----------
    rng : Generator
    name : str
        Its name in the table.
    situation : Situation

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
    if not can_have(situation.setup, name):
        raise ValueError(f"a {situation.setup.rig} cannot have {name}. Draw another rig.")
    return DRAWS[name](rng, situation)


def can_have(setup: Setup, name: str) -> bool:
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
