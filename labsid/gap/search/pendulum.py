"""A pendulum from the softening spring that imitates it."""

import numpy as np

from labsid.gap.dynamics.responses import force_unit
from labsid.gap.effects.context import Context
from labsid.gap.effects.dynamics import SLACK_LOG_STIFFNESS
from labsid.gap.effects.gravity import Gravity
from labsid.gap.fits.fitting import Fit, finish, minimize
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import is_plausible


def pendulum_from_spring(data: Data, base: Fit, highpass: Fit, spring: Fit | None) -> Fit | None:
    """The fit of gravity on a joint that a torque drives, from that of a softening spring.

    To third order the torque of gravity, a sin(b x) = a b x - a b^3 x^3 / 6, is the force of such a spring. The linear
    model of a pendulum that swings far has other rates than its small swings, and so no start from it ends at the
    minimum.

    Parameters
    ----------
    data : Data
    base : Fit
        The linear model to which the effect is added.
    highpass : Fit
        A linear fit to the high-pass filtered record.
    spring : Fit or None
        The fit of a cubic stiffness.

    Returns
    -------
    Fit or None
        None without such a spring, or if the record is not that of a joint.
    """
    gravity = Gravity("unsprung")
    if spring is None or not spring.hypothesis.plant.cubic or not gravity.applies(Context(data, base, highpass)):
        return None
    plant = spring.hypothesis.plant
    own = {one.name: float(x) for one, x in zip(plant.parameters, spring.plant_theta, strict=True)}
    if own["cubic"] >= 0.0:
        return None
    c, k = np.exp(own["log_c"]), np.exp(own["log_k"])
    unit, new_unit = force_unit(c, k), force_unit(c, k * np.exp(SLACK_LOG_STIFFNESS))
    turn = float(np.sqrt(-6.0 * own["cubic"] * unit / k))
    start = own | {name: own[name] * new_unit / unit for name in ("z0", "v0") if name in own}
    start |= {"log_k": own["log_k"] + SLACK_LOG_STIFFNESS, "torque": k / (unit * turn), "angle": 0.0}
    start["log_turn"] = float(np.log(turn * unit / new_unit))
    hypothesis = base.hypothesis.plus(gravity)
    theta = np.array([start.get(one.name, one.start) for one in hypothesis.parameters])
    point = minimize(data, hypothesis, theta, iterations=25)
    fit = None if point is None else finish(data, hypothesis, point)
    return fit if fit is not None and is_plausible(data, fit) else None
