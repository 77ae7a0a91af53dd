"""The found effects with their parameters in the record's units, each with its standard error."""

from collections.abc import Callable

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects.base import Effect, Fitted, Value
from labsid.gap.fitting import Fit, covariance
from labsid.gap.profile import profile_likelihood


def estimate_parameters(data: Data, fit: Fit, effect: Effect) -> dict[str, dict[str, object]]:
    """`{name: {value, stderr, unit}}` of one effect of a fit.

    The standard errors are those of linear propagation; where the effect begins at some instant, the scatter of every
    value over the instants that are possible comes on top.
    """
    cov = covariance(data, fit)
    searched = fit.theta.size

    def values(theta: FloatArray, gains: FloatArray) -> dict[str, Value]:
        return effect.values(Fitted(fit.hypothesis, theta, gains, data))

    at = values(fit.theta, fit.gains)
    scatter = dict.fromkeys(at, 0.0)
    instant = [i for i, p in enumerate(fit.hypothesis.parameters) if p.name == "onset" and effect.name == "load-step"]
    for place in instant:
        seen = profile_likelihood(data, fit, place)
        if seen is not None and np.isfinite(cov).all():
            cov = _conditional(cov, place)
            held = [values(point.theta, point.gains) for point in seen.points]
            scatter = {
                name: float(seen.weights @ np.array([(one[name].value - at[name].value) ** 2 for one in held]))
                for name in at
            }
    slopes = {name: np.zeros(searched + fit.gains.size) for name in at}
    for i in range(searched + fit.gains.size):
        theta, gains = fit.theta.copy(), fit.gains.copy()
        part, j = (theta, i) if i < searched else (gains, i - searched)
        step = 1e-5 * max(abs(part[j]), 1e-2)
        part[j] += step
        for name, moved in values(theta, gains).items():
            slopes[name][i] = (moved.value - at[name].value) / step
    return {
        name: {
            "value": value.value,
            "stderr": float(np.sqrt(max(float(slopes[name] @ cov @ slopes[name]), 0.0) + scatter[name])),
            "unit": value.unit,
        }
        for name, value in at.items()
    }


def _conditional(cov: FloatArray, place: int) -> FloatArray:
    """The covariance of all the other numbers where that at `place` is known."""
    own = cov[place, place]
    return cov - np.outer(cov[:, place], cov[place]) / own if own > 0.0 else cov


def active_samples(data: Data, fit: Fit, effect: Effect) -> np.ndarray:
    """Where in the record an effect acts; all False where it acts everywhere."""
    act: Callable[[Fitted], np.ndarray] = effect.active_samples
    return act(Fitted(fit.hypothesis, fit.theta, fit.gains, data))
