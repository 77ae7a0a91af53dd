"""Replace a pole that the input does not excite by the drift or sinusoid it imitates."""

from operator import attrgetter

import numpy as np

from labsid.gap.dynamics.responses import real_rates, single_pole
from labsid.gap.effects.base import Effect
from labsid.gap.effects.drifts import GainDrift
from labsid.gap.effects.output import Drift
from labsid.gap.effects.periodic import Periodic
from labsid.gap.fits.fitting import Fit, fit_from
from labsid.gap.fits.linear_fits import SINGLE_POLE_RATES
from labsid.gap.fits.undriven_poles import has_undriven_pole
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import is_plausible
from labsid.gap.search.forms import transfer_theta
from labsid.gap.search.refinement import converge, polish

NEUTRAL_ANGLES = -1.2, -0.6, 0.0, 0.6, 1.2
"""Of the neutral input of a drift of the gain, from which it is fitted again; numerics."""


def replace_undriven_pole(data: Data, fit: Fit, most_bic: float) -> tuple[Fit, ...] | None:
    """Refit with the excited pole only: by itself, or without and with a drift or a sinusoid in place of the other one.

    By itself, if its BIC is below `most_bic`: the pole may have replaced the neutral input of a drift of the gain. None
    if the minimization returns to an unexcited pole, or the fit already has such an effect.
    """
    c, k = fit.rates
    alone = _with_one_pole(data, fit)
    if alone is not None and alone.bic < most_bic:
        return (alone,)
    complex_pair = c**2 < 4.0 * k
    cycles = float(np.sqrt(max(k - 0.25 * c**2, 0.0))) * data.samples / (2.0 * np.pi)
    effects: tuple[Effect, ...] = Periodic.searched() if complex_pair else Drift.searched()
    best: Fit | None = None
    for effect in effects:
        if effect.name in fit.hypothesis.names:
            continue
        other = fit.hypothesis.plus(effect)
        for rate in SINGLE_POLE_RATES if complex_pair else real_rates(c, k)[1:]:
            theta = transfer_theta(fit, other)
            theta[other.slices["plant"]][:2] = np.log(single_pole(rate))
            if complex_pair:
                theta[other.slices[effect.key]] = cycles
            one = fit_from(data, other, theta, iterations=25)
            if one is not None and (best is None or one.bic < best.bic) and not has_undriven_pole(data, one):
                best = one
    if best is None:
        return None
    end = polish(data, converge(data, best))
    best = best if has_undriven_pole(data, end) else end
    without = fit_from(data, fit.hypothesis, transfer_theta(best, fit.hypothesis), iterations=0)
    return None if without is None else (without, best)


def _with_one_pole(data: Data, fit: Fit) -> Fit | None:
    """The fit with a drift of the gain and one excited pole; None without such a drift or such a fit."""
    drift = next((one for one in fit.hypothesis.found if isinstance(one, GainDrift)), None)
    if drift is None:
        return None
    found = []
    for rate in real_rates(*fit.rates)[1:]:
        for angle in NEUTRAL_ANGLES:
            theta = fit.theta.copy()
            theta[fit.hypothesis.slices["plant"]][:2] = np.log(single_pole(rate))
            theta[fit.hypothesis.slices[drift.key]][-1] = angle
            one = fit_from(data, fit.hypothesis, theta, iterations=25)
            if one is not None and is_plausible(data, one) and not has_undriven_pole(data, one):
                found.append(one)
    return min(found, key=attrgetter("bic"), default=None)
