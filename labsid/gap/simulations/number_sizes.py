"""Sizes at which numbers of a given simulation and changes inside it act, and whether its output jumps with them."""

from collections.abc import Mapping
from operator import itemgetter

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import GivenSimulation
from labsid.gap.dynamics.plant_form import FREE_STEP, ROUGH_STEP, free_number
from labsid.gap.record.data import Data

DECADES = -6, 7  # powers of ten that are tried for a number that is nominally zero; numerics
MIN_MOVED = 1e-3  # of the standard deviation of the output; set by hand
MAX_ROUGHNESS = 0.5  # difference of the derivatives over small and large steps, over the latter; set by hand


def motion_units(data: Data, torque: float, speed: float, spread: float, reads: bool) -> dict[str, float]:
    """Units of what acts at the port of a motion, and of its states, by the unit of a `Part`.

    Parameters
    ----------
    data : Data
    torque, speed, spread : float
        Sizes of the torque or force there, of the speed, and of the motion.
    reads : bool
        Whether the output is the position.
    """
    return {
        "one": 1.0,
        "torque": torque,
        "damping": torque / speed,
        "drag": torque / speed**2,
        "stiffness": torque / spread,
        "cubic": torque / spread**3,
        "speed": speed,
        "position": float(data.y_scale.unit) if reads else spread,
        "span": data.samples * data.Ts,
        "sample": data.Ts,
        "command": float(data.u_scale.unit),
        "cycle": 1.0 / (data.samples * data.Ts),
    }


def number_units(given: GivenSimulation, w: FloatArray, more: Mapping[str, float] | None = None) -> dict[str, float]:
    """The smallest powers of ten of numbers that are nominally zero which change the output.

    `more` are further numbers of the simulation, such as its initial state.
    """
    known = given.nominal | dict(more or {})
    units = {}
    for name in (name for name, nominal in given.nominal.items() if not nominal):
        nominally = given.run(w, known)
        low, high = given.ranges.get(name, (-np.inf, np.inf))
        side = 1.0 if high > 0.0 else -1.0
        sizes = (10.0**power for power in range(*DECADES) if low <= side * 10.0**power <= high)
        outputs = ((size, given.run(w, known | {name: side * size})) for size in sizes)
        moved = (size for size, y in outputs if np.std(y - nominally) > MIN_MOVED * np.std(nominally))
        units[name] = next(moved, 1.0)
    return units


def is_rough(given: GivenSimulation, w: FloatArray) -> bool:
    """Whether the derivatives by a free number over a small and a large step differ, at their nominal values.

    The size of a large step is unknown for a number that is nominally zero.
    """
    for name, nominal in filter(itemgetter(1), given.nominal.items()):
        number, steps = free_number(name, nominal, given.ranges.get(name)).number, (0.0, FREE_STEP, ROUGH_STEP)
        nominally, near, far = (given.run(w, given.nominal | {name: number(step)}) for step in steps)
        small, large = (near - nominally) / FREE_STEP, (far - nominally) / ROUGH_STEP
        if np.linalg.norm(small - large) > MAX_ROUGHNESS * np.linalg.norm(large):  # and not NaN, of a failure
            return True
    return False
