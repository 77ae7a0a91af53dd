"""What linear dynamics do by themselves, from their initial state, beside what the input makes them do."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap import _kernels
from labsid.gap.data import Data
from labsid.gap.fitting import Fit
from labsid.gap.responses import damping_ratio, denominator

EVALUATED_FROM = 1.0 / 3.0  # of the record: what still goes on from there on was not brought along from before it
MIN_FREE, MAX_DRIVEN = 1.0, 3.0  # of what the fit leaves, rms: what goes on alone, and what the input surely moves
LIGHT_DAMPING = 0.09  # damping of a mode; masses on springs have more
MIN_DAMPING_RATIO = 2.0  # times the damping


def has_undriven_pole(data: Data, fit: Fit) -> bool:
    """Whether one of the two poles goes on through the record by itself, and the input hardly moves it.

    Such a pole is none of the rig's: it stands for a drift, or for a wave from outside. Only linear dynamics with a
    zero are looked at, in which it could be either.
    """
    plant = fit.hypothesis.plant
    if plant.kind != "linear" or not plant.zero:
        return False
    w = fit.hypothesis.actuator(fit.theta, data.u) - data.u[0]
    columns = fit.hypothesis.design(fit.theta, data.u).parts[0]
    gains = fit.gains[: columns.shape[1]]
    later = data.rows & (np.arange(data.samples) > EVALUATED_FROM * data.samples)
    left = float(np.sqrt(np.mean((data.y - fit.output)[data.rows] ** 2)))
    for moved, alone in _driven_and_free(w, columns, gains, denominator(*fit.rates)):
        own, driven = float(np.std(alone[later])), float(np.std(moved[later]))
        if own > max(MIN_FREE * left, driven) and driven < MAX_DRIVEN * left:
            return True
    return False


def lag_became_mode(base: Fit, fit: Fit) -> bool:
    """Whether the two poles of a fit with a further lag are a lightly damped mode, which those of the baseline are not.

    Three poles are the same to the data whichever of them is called new. What the baseline lacks is the mode, then, and
    not the lag.
    """
    plant = fit.hypothesis.plant
    if plant.kind != "linear" or not plant.lag or plant.mode:
        return False
    own = damping_ratio(*fit.rates)
    return own < LIGHT_DAMPING and damping_ratio(*base.rates) > MIN_DAMPING_RATIO * own


def _driven_and_free(
    w: FloatArray, columns: FloatArray, gains: FloatArray, a: tuple[float, float]
) -> list[tuple[FloatArray, FloatArray]]:
    """Of a pair, or of each of two real poles: what the input makes of it, and its free motion."""
    moved, alone = columns[:, :2] @ gains[:2], columns[:, 2:4] @ gains[2:4]
    ramp = columns[:, 4] * gains[4]
    root = a[0] ** 2 - 4.0 * a[1]
    if root <= 0.0:
        return [(moved, alone + ramp)]
    slow, fast = 0.5 * (-a[0] + np.sqrt(root)), 0.5 * (-a[0] - np.sqrt(root))
    share = (gains[0] * slow + gains[1]) / (slow - fast)  # of the slow pole in the partial fractions
    free = (alone[1] - fast * alone[0]) / (slow - fast) * slow ** np.arange(w.size)
    by_slow = share / max(1.0 - slow, 1e-12) * _kernels.first_order(w, float(slow))
    return [(by_slow, free + ramp), (moved - by_slow, alone - free)]
