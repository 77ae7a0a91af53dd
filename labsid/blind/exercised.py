"""Whether a record of several signals, or of a closed loop, exercises an effect."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.blind.distinct import FEWEST_CROSSINGS, LEAST_TIME_MOVING, LEAST_TIME_ON_STOPS
from labsid.rig.switchable.coupled.setup import CoupledSetup
from labsid.rig.switchable.setup import Actuator

LEAST_TIME_BEYOND = 0.08
"""Share of the samples on each side of a dead zone from which it is more than a limit."""

FEWEST_OFF, LEAST_MOTION_OFF = 20, 0.3
"""Samples without the command, and its standard deviation there over that in the record, from which it is missed."""


def is_exercised(effect: str, setup: CoupledSetup, u: FloatArray, states: FloatArray, outputs: FloatArray) -> bool:
    """Whether the record exercises an effect.

    A delay has at least one sample. The input leaves a dead zone on both sides, and moves while it does not act, for at
    least 20 samples. A motion rests on its end stops, and a tank is full, in at least 3 % of the samples. A sensor
    behind a backlash moves in at least 40 % of the samples and crosses the backlash at least six times.

    Parameters
    ----------
    effect : str
    setup : CoupledSetup
        The rig with the effect.
    u : ndarray, shape (N, nu)
        Commands in rig units.
    states : ndarray, shape (N, n)
        With the effect.
    outputs : ndarray, shape (N, ny)
        With the effect and without noise.

    Returns
    -------
    bool
    """
    p = setup.plant
    match effect:
        case "input-delay":
            return max(a.delay for a in setup.actuators) >= 1.0
        case "input-dead-zone":
            beyond = [
                min(np.mean(u[:, i] > a.dead_high), np.mean(u[:, i] < a.dead_low))
                for i, a in enumerate(setup.actuators)
                if a.dead_high > a.dead_low
            ]
            return bool(beyond and beyond[0] > LEAST_TIME_BEYOND)
        case "input-off":
            return any(_is_missed(u[:, i], a) for i, a in enumerate(setup.actuators) if np.isfinite(a.off_start))
        case "end-stop":
            return bool(np.mean((states <= p.stop_low) | (states >= p.stop_high), axis=0).max() >= LEAST_TIME_ON_STOPS)
        case "overflow":
            return bool(np.mean(states >= p.brim, axis=0).max() >= LEAST_TIME_ON_STOPS)
        case "output-backlash":
            return all(_is_crossed(outputs[:, j]) for j, play in enumerate(setup.plays) if play)
    return True


def _is_missed(u: FloatArray, actuator: Actuator) -> bool:
    k = np.arange(u.size)
    off = (k >= actuator.off_start) & (k < actuator.off_stop)
    return bool(np.sum(off) >= FEWEST_OFF and np.std(u[off]) >= LEAST_MOTION_OFF * np.std(u))


def _is_crossed(y: FloatArray) -> bool:
    moves = np.sign(np.diff(y))
    turns = np.count_nonzero(np.diff(moves[moves != 0]))
    return bool(turns >= FEWEST_CROSSINGS and np.mean(moves != 0) >= LEAST_TIME_MOVING)
