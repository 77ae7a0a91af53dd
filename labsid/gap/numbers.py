"""The found effects with their parameters in the record's units, each with its standard error."""

from collections.abc import Callable

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.context import Data
from labsid.gap.effects.base import Effect, Fitted, Value
from labsid.gap.fitting import Fit, covariance


def parameters_of(data: Data, fit: Fit, effect: Effect) -> dict[str, dict[str, object]]:
    """`{name: {value, stderr, unit}}` of one effect of a fit; the standard errors by linear propagation."""
    cov = covariance(data, fit)
    searched = fit.theta.size

    def values(theta: FloatArray, gains: FloatArray) -> dict[str, Value]:
        return effect.values(Fitted(fit.hypothesis, theta, gains, data))

    at = values(fit.theta, fit.gains)
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
            "stderr": float(np.sqrt(max(float(slopes[name] @ cov @ slopes[name]), 0.0))),
            "unit": value.unit,
        }
        for name, value in at.items()
    }


def marked(data: Data, fit: Fit, effect: Effect) -> np.ndarray:
    """Where in the record an effect acts; all False where it acts everywhere."""
    act: Callable[[Fitted], np.ndarray] = effect.acts
    return act(Fitted(fit.hypothesis, fit.theta, fit.gains, data))
