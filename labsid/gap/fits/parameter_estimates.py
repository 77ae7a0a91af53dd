"""Parameters of the effects found, in the record's units, with standard errors."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.base import Effect, Fitted, Value
from labsid.gap.fits.fitting import Fit, covariance
from labsid.gap.fits.profile import profile_likelihood
from labsid.gap.record.data import Data


def estimate_parameters(data: Data, fit: Fit, effect: Effect) -> dict[str, dict[str, object]]:
    """Return `{name: {value, stderr, unit}}` of one effect of a fit.

    Values that are not finite are left out; a standard error is zero where it is unknown. The standard errors come from
    linear propagation. For a load step, the scatter of each value over the profile likelihood of the onset is added.
    """
    cov = covariance(data, fit)

    def values(theta: FloatArray, gains: FloatArray) -> dict[str, Value]:
        return effect.values(Fitted(fit.hypothesis, theta, gains, data))

    at = {name: value for name, value in values(fit.theta, fit.gains).items() if np.isfinite(value.value)}
    scatter = dict.fromkeys(at, 0.0)
    instant = [i for i, p in enumerate(fit.hypothesis.parameters) if p.name == "onset" and effect.name == "load-step"]
    for place in instant:
        likelihood = profile_likelihood(data, fit, place)
        if likelihood is not None and np.isfinite(cov).all():
            cov = _conditional(cov, place)
            estimates = [values(point.theta, point.gains) for point in likelihood.points]
            for name, best in at.items():
                scatter[name] = float(likelihood.weights @ [(one[name].value - best.value) ** 2 for one in estimates])
    slopes = value_slopes(data, fit, effect)
    return {
        name: {
            "value": value.value,
            "stderr": _root(max(float(slopes[name] @ cov @ slopes[name]), 0.0) + scatter[name]),
            "unit": value.unit,
        }
        for name, value in at.items()
    }


def value_slopes(data: Data, fit: Fit, effect: Effect) -> dict[str, FloatArray]:
    """Derivatives of the parameters of an effect by theta and the gains, in this order."""
    at = effect.values(Fitted.of(fit, data))
    searched = fit.theta.size
    slopes = {name: np.zeros(searched + fit.gains.size) for name in at}
    for i in range(searched + fit.gains.size):
        theta, gains = fit.theta.copy(), fit.gains.copy()
        part, j = (theta, i) if i < searched else (gains, i - searched)
        step = 1e-5 * max(abs(part[j]), 1e-2)
        part[j] += step
        for name, perturbed in effect.values(Fitted(fit.hypothesis, theta, gains, data)).items():
            slopes[name][i] = (perturbed.value - at[name].value) / step
    return slopes


def estimate_numbers(data: Data, fit: Fit) -> dict[str, dict[str, object]]:
    """Return `{name: {value, stderr, unit, nominal}}` of the fitted numbers of a given simulation."""
    free = fit.hypothesis.plant.free
    if not free:
        return {}
    at = fit.hypothesis.slices["plant"].start + np.arange(len(free))
    errors = [_root(variance) for variance in np.diag(covariance(data, fit))[at].tolist()]
    return {
        one.given_name: {
            "value": one.number(value),
            "stderr": one.scale(value) * error,
            "unit": "",
            "nominal": one.nominal,
        }
        for one, value, error in zip(free, fit.theta[at].tolist(), errors, strict=True)
    }


def _root(variance: float) -> float:
    """Standard error of a variance; zero if it is unknown or, by rounding, negative."""
    return float(np.sqrt(variance)) if np.isfinite(variance) and variance > 0.0 else 0.0


def _conditional(cov: FloatArray, place: int) -> FloatArray:
    """Conditional covariance of the other parameters, given the one at `place`."""
    own = cov[place, place]
    return cov - np.outer(cov[:, place], cov[place]) / own if own > 0.0 else cov
