"""Whether a command or a fitted actuator only switches, as a relay does."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit
from labsid.gap.record.data import Data

SWITCH_EDGE = 0.05  # of the range of a signal, that counts as its end; set by hand
MOST_BETWEEN = 0.05
"""Of the samples, between the ends; measured: 0 to 2 % of relays, 10 % and more of limited actuators."""
SWITCH_RATIO = 3.0
"""Share of the command between its ends over `MOST_BETWEEN`, from which a switch is seen; set by hand."""


def only_switches(data: Data, fit: Fit) -> bool:
    """Whether the fitted actuator only switches between two values, as a relay does, where the command takes others."""
    actuator = _share_between(data, fit.hypothesis.actuator(fit.theta, data.u))
    return actuator < MOST_BETWEEN < _share_between(data, data.u) / SWITCH_RATIO


def has_equal_steps(data: Data) -> bool:
    """Whether the command switches between two values: each of its steps has the size of all others."""
    return _share_between(data, data.u) < MOST_BETWEEN


def _share_between(data: Data, signal: FloatArray) -> float:
    """Share of the samples at which a signal is not at one of its ends."""
    low, span = float(signal.min()), float(np.ptp(signal))
    inside = np.abs(signal - low - 0.5 * span) < (0.5 - SWITCH_EDGE) * span
    return float(np.mean(inside[data.rows]))
