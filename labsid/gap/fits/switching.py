"""Whether a fitted actuator only switches, as a relay does."""

import numpy as np

from labsid.gap.fits.fitting import Fit
from labsid.gap.record.data import Data

SWITCH_EDGE = 0.05  # of the range of a signal, that counts as its end
MOST_BETWEEN = 0.05  # of the samples, between the ends: of relays 0 to 2 %, of limited actuators 10 % and more
SWITCH_RATIO = 3.0  # share of the command between its ends over `MOST_BETWEEN`, from which a switch is told from it


def only_switches(data: Data, fit: Fit) -> bool:
    """Whether the fitted actuator only switches between two values, as a relay does, where the command takes others."""
    signals = (fit.hypothesis.actuator(fit.theta, data.u), data.u)
    between = []
    for signal in signals:
        low, span = float(signal.min()), float(np.ptp(signal))
        inside = np.abs(signal - low - 0.5 * span) < (0.5 - SWITCH_EDGE) * span
        between.append(float(np.mean(inside[data.rows])))
    return between[0] < MOST_BETWEEN < between[1] / SWITCH_RATIO
