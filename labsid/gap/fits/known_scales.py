"""Parameters that are known: of a joint by the units of the record, of a simulation of first order by its order.

Where the command is the angle that the output follows, both have one unit, and the gain between them is one. Gravity
depends on the angle in radians. A gain and a unit of the angle that are free would let a sine imitate any spring.
"""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import NO_SPRING
from labsid.gap.dynamics.responses import ABSENT_POLE_RATE
from labsid.gap.effects.gravity import angle_unit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data


def known_gains(data: Data, hypothesis: Hypothesis) -> FloatArray:
    """The gains, in scaled units, that are not estimated; the first ones, mostly none.

    Parameters
    ----------
    data : Data
    hypothesis : Hypothesis

    Returns
    -------
    ndarray, shape (0,) or (1,)
    """
    plant = hypothesis.plant
    if not plant.has_fixed_gain:
        return np.zeros(0)
    follows = plant.follows and not plant.stabilised
    return np.array([data.u_scale.unit / data.y_scale.unit if follows else 1.0])


def known_values(data: Data, hypothesis: Hypothesis) -> dict[int, float]:
    """The nonlinear parameters that are not estimated, by their place in theta."""
    plant = hypothesis.plant
    if plant.single:
        name = "log_b" if plant.kind in ("tanks", "speed") else "log_c"
        return {_place(hypothesis, name): float(np.log(ABSENT_POLE_RATE))}
    if plant.gravity and plant.unsprung and not plant.follows:
        return {_place(hypothesis, "log_k"): NO_SPRING}
    if not (plant.follows and plant.gravity):
        return {}
    return {_place(hypothesis, "log_turn"): float(np.log(data.u_scale.unit / (angle_unit(data) or 1.0)))}


def implied_count(hypothesis: Hypothesis) -> int:
    """The number of parameters that follow from others, for the BIC.

    Where a torque drives the joint, the gain is the angle per position in the unit of the record (which
    `Gravity.is_plausible` requires); and without a spring, the angle of rest is where the reading of zero is.

    Parameters
    ----------
    hypothesis : Hypothesis

    Returns
    -------
    int
    """
    plant = hypothesis.plant
    if not plant.gravity or plant.follows:
        return 0
    return 2 if plant.unsprung else 1


def known_bounds(data: Data, hypothesis: Hypothesis) -> tuple[FloatArray, FloatArray]:
    """Bounds of theta, equal where a parameter is known."""
    known = known_values(data, hypothesis)
    if not known:
        return hypothesis.bounds
    lower, upper = (end.copy() for end in hypothesis.bounds)
    for place, value in known.items():
        lower[place] = upper[place] = value
    return lower, upper


def _place(hypothesis: Hypothesis, name: str) -> int:
    """Place in theta of a parameter of the dynamics."""
    return hypothesis.slices["plant"].start + hypothesis.plant.index(name)
