"""Find poles that the input does not excite: they imitate a drift or a sinusoid."""

import numpy as np

from labsid._arrays import FloatArray, left_by
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.responses import damping_ratio, decay_rates, denominator
from labsid.gap.fits.fitting import Fit, rms
from labsid.gap.record.data import Data

EVALUATED_FROM = 1.0 / 3.0  # of the record: an actual free response has decayed by then; set by hand
MIN_FREE = 1.0  # rms of the free response over that of the residual; set by hand
MAX_DRIVEN = 3.0  # rms of the forced response over that of the residual; set by hand
LIGHT_DAMPING = 0.09  # largest damping of a mode; a mass on a spring has more; set by hand
MIN_DAMPING_RATIO = 2.0  # damping of the baseline over that of the mode; set by hand


def has_undriven_pole(data: Data, fit: Fit) -> bool:
    """Whether the free response of a pole exceeds its response to the input throughout the record.

    Such a pole imitates a drift or a sinusoid. Only linear dynamics with a numerator zero are tested.
    """
    plant = fit.hypothesis.plant
    if plant.kind != "linear" or not plant.zero:
        return False
    later = data.rows & (np.arange(data.samples) > EVALUATED_FROM * data.samples)
    residual = rms(data, fit)
    for forced, unforced in _driven_and_free(data, fit):
        free_rms, forced_rms = float(np.std(unforced[later])), float(np.std(forced[later]))
        if free_rms > max(MIN_FREE * residual, forced_rms) and forced_rms < MAX_DRIVEN * residual:
            return True
    return False


def slowest_driven_rate(data: Data, fit: Fit) -> float:
    """Rate of the slowest pole of a fit whose response to the input exceeds the residual; per sample.

    A linear fit to a rig with one pole has a second one that the input hardly moves, at any rate. A line and the free
    response, which cancel a part of the response to the input where the pole is slow, do not count.
    """
    plant, (slow, fast) = fit.hypothesis.plant, decay_rates(*fit.rates)
    c, k = fit.rates
    if plant.kind != "linear" or not plant.zero or c * c <= 4.0 * k:
        return slow
    forced, free = (one[data.rows] for one in _driven_and_free(data, fit)[0])
    lines = np.column_stack([np.ones(free.size), np.linspace(0.0, 1.0, free.size), free])
    driven, _ = left_by(lines, forced, 1e-9)
    return slow if float(np.std(driven)) > rms(data, fit) else fast


def lag_became_mode(base: Fit, fit: Fit) -> bool:
    """Whether the poles of a fit with an additional lag are a lightly damped mode, unlike those of the baseline.

    The order of the three poles is arbitrary: what the baseline lacks is then the mode, not the lag.
    """
    plant = fit.hypothesis.plant
    if plant.kind != "linear" or not plant.lag or plant.mode:
        return False
    own = damping_ratio(*fit.rates)
    return own < LIGHT_DAMPING and damping_ratio(*base.rates) > MIN_DAMPING_RATIO * own


def _driven_and_free(data: Data, fit: Fit) -> list[tuple[FloatArray, FloatArray]]:
    """Forced and free response of a complex pair, or of each of two real poles, the slow one first."""
    w = fit.hypothesis.actuator(fit.theta, data.u) - data.u[0]
    columns = fit.hypothesis.design(fit.theta, data.u).parts[0]
    gains, a = fit.gains[: columns.shape[1]], denominator(*fit.rates)
    forced, unforced = columns[:, :2] @ gains[:2], columns[:, 2:4] @ gains[2:4]
    ramp = columns[:, 4] * gains[4]
    root = a[0] ** 2 - 4.0 * a[1]
    if root <= 0.0:
        return [(forced, unforced + ramp)]
    slow, fast = 0.5 * (-a[0] + np.sqrt(root)), 0.5 * (-a[0] - np.sqrt(root))
    share = (gains[0] * slow + gains[1]) / (slow - fast)  # of the slow pole in the partial fractions
    unforced_slow = (unforced[1] - fast * unforced[0]) / (slow - fast) * slow ** np.arange(w.size)
    forced_slow = share / max(1.0 - slow, 1e-12) * _kernels.first_order(w, float(slow))
    return [(forced_slow, unforced_slow + ramp), (forced - forced_slow, unforced - unforced_slow)]
