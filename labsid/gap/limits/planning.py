"""A record that is not measured yet, and records with a planted effect."""

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.effects.base import AdditiveEffect
from labsid.gap.effects.restarts import Restarts
from labsid.gap.fits.fitting import Fit
from labsid.gap.limits.planting import plantations
from labsid.gap.limits.smallest_sizes import Limits
from labsid.gap.record.data import Data


def planned_record(data: Data, fit: Fit, u: FloatArray) -> tuple[Data, Fit]:
    """A simulation on another input, without the loads, drifts and waves of its own record.

    Parameters
    ----------
    data : Data
        The record of the fit.
    fit : Fit
    u : ndarray, shape (M,)
        The planned input in the record's unit.

    Returns
    -------
    data : Data
        With the simulated output.
    fit : Fit
        With the noise of the fit.
    """
    old = fit.hypothesis
    dropped = [effect for effect in old.additive if not isinstance(effect, Restarts)]
    kept = tuple(
        effect for effect in old.effects if not isinstance(effect, AdditiveEffect) or isinstance(effect, Restarts)
    )
    places = np.arange(fit.gains.size, dtype=float)
    gains = fit.gains[~np.isin(places, [at for effect in dropped for at in old.gains_of(places, effect)])]
    hypothesis = old.with_effects(kept)
    theta = np.concatenate(
        [fit.theta[: 0 if old.delay_is_an_effect else 1], *(fit.theta[old.slices[key]] for key in hypothesis.slices)]
    )
    scaled = data.u_scale.of(u)
    output = hypothesis.output(theta, gains, scaled, data.samples, float(data.u[0]))
    rows, at = data.planned_readings(u.size)
    planned = Data(scaled, output, rows, data.Ts, data.u_scale, data.y_scale, at=at, stride=data.stride)
    noise = replace(fit.noise, rows=int(rows.sum()))
    return planned, replace(fit, hypothesis=hypothesis, theta=theta, gains=gains, output=output, noise=noise)


def with_planted(data: Data, fit: Fit, limits: Limits, share: float, rng: np.random.Generator) -> FloatArray | None:
    """Simulated output with one effect planted and new noise, in the record's unit; None if it cannot be planted.

    Parameters
    ----------
    data : Data
    fit : Fit
    limits : Limits
        Of the effect.
    share : float
        Its size over the whole.
    rng : Generator
    """
    for plantation in plantations(data, fit):
        places = plantation.places(share) if plantation.effect.name == limits.name else []
        if places and places[0].parameter == limits.parameter:
            change = plantation.changes(share)[0]
            white = np.sqrt(fit.noise.sigma2) * rng.standard_normal(data.samples)
            noise = lfilter([1.0], np.concatenate([[1.0], -fit.noise.ar]), white)
            return None if change is None else np.asarray(data.y_scale.back(fit.output + change + noise))
    return None
