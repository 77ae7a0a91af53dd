"""Parameters of the effects found, in the record's units, with standard errors."""

from collections.abc import Collection

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.effects.base import Effect, Fitted, OutputEffect, Value
from labsid.gap.fits.fitting import Fit, covariance
from labsid.gap.fits.identifiability import Determined, determined_numbers
from labsid.gap.fits.profile import profile_likelihood
from labsid.gap.record.data import Data

AT_LIMIT = 1e-6  # distance in theta; numerics
CLEAR_ERRORS = 2.0  # standard errors: a size within them is not told from none; definition


def is_told_from_nothing(data: Data, fit: Fit, effect: Effect, magnitudes: Collection[str]) -> bool:
    """Whether a magnitude of an effect is larger than `CLEAR_ERRORS` of its standard errors, by linear propagation.

    Parameters
    ----------
    data : Data
    fit : Fit
    effect : Effect
        Of the fit.
    magnitudes : collection of str
        Those of its values that are zero where it does nothing; without one, or without errors, it is told.
    """
    values, errors = effect.values(Fitted.of(fit, data)), _errors(data, fit, effect, magnitudes)
    if not errors or not all(np.isfinite(error) and error > 0.0 for error in errors.values()):
        return True
    return any(abs(values[name].value) > CLEAR_ERRORS * error for name, error in errors.items())


def has_place(data: Data, fit: Fit, effect: Effect, places: Collection[str]) -> bool:
    """Whether a place of an effect on the axis of a signal is known to the range of that signal.

    Parameters
    ----------
    data : Data
    fit : Fit
    effect : Effect
        Of the fit.
    places : collection of str
        Those of its values that are places; without one on a signal, it has its place.
    """
    values, errors = effect.values(Fitted.of(fit, data)), _errors(data, fit, effect, places)
    ranges = {"u": np.ptp(data.u) * data.u_scale.unit, "y": np.ptp(data.y) * data.y_scale.unit}
    shares = [error / ranges[values[name].unit] for name, error in errors.items() if values[name].unit in ranges]
    return not shares or bool(min(shares) < 1.0)


def _errors(data: Data, fit: Fit, effect: Effect, names: Collection[str]) -> dict[str, float]:
    """Standard errors of some values of an effect, of those that it has, by linear propagation."""
    cov, slopes = covariance(data, fit), value_slopes(data, fit, effect)
    return {name: _root(float(slopes[name] @ cov @ slopes[name])) for name in names if name in slopes}


def estimate_parameters(data: Data, fit: Fit, effect: Effect) -> dict[str, dict[str, object]]:
    """Return `{name: {value, stderr, unit}}` of one effect of a fit.

    Values that are not finite are left out; a standard error is zero where it is unknown. The standard errors come from
    linear propagation. The scatter of each value over the profile likelihood of each of the effect's `instants` is
    added, and for a change of the reading, which is seen at the next sample, that of an instant between two samples.
    """
    cov = covariance(data, fit)

    def values(theta: FloatArray, gains: FloatArray) -> dict[str, Value]:
        return effect.values(Fitted(fit.hypothesis, theta, gains, data))

    at = {name: value for name, value in values(fit.theta, fit.gains).items() if np.isfinite(value.value)}
    scatter = dict.fromkeys(at, 0.0)
    for name in effect.instants:
        place = _place_of(fit, effect, name)
        likelihood = profile_likelihood(data, fit, place)
        if likelihood is not None and np.isfinite(cov).all():
            cov = _conditional(cov, place)
            estimates = [values(point.theta, point.gains) for point in likelihood.points]
            for own, best in at.items():  # a value may be finite at the fit only
                scatter[own] += sum(
                    float(weight) * (one[own].value - best.value) ** 2
                    for weight, one in zip(likelihood.weights, estimates, strict=True)
                    if own in one
                )
        if isinstance(effect, OutputEffect):
            scatter[name] += data.Ts**2 / 12.0
    slopes = value_slopes(data, fit, effect)
    return {
        name: {
            "value": value.value,
            "stderr": _root(max(float(slopes[name] @ cov @ slopes[name]), 0.0) + scatter[name]),
            "unit": value.unit,
        }
        for name, value in at.items()
    }


def parameters_at_limit(data: Data, fit: Fit, effect: Effect) -> list[str]:
    """Names of the values of an effect at which the search ends: the single parameter behind them is at its bound."""
    lower, upper = fit.hypothesis.bounds
    at_end = {int(i) for i in np.flatnonzero(np.minimum(fit.theta - lower, upper - fit.theta) < AT_LIMIT)}
    slopes = value_slopes(data, fit, effect)
    behind = {name: np.flatnonzero(slope) for name, slope in slopes.items()}
    return [name for name, places in behind.items() if places.size == 1 and int(places[0]) in at_end]


def _place_of(fit: Fit, effect: Effect, name: str) -> int:
    """Place in theta of a parameter of an effect, or of the plant that it changes."""
    key = effect.key if effect.key in fit.hypothesis.slices else "plant"
    own = fit.hypothesis.slices[key]
    return own.start + [one.name for one in fit.hypothesis.parameters[own]].index(name)


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


def estimate_numbers(data: Data, fit: Fit) -> list[dict[str, object]]:
    """Return the fitted numbers of a given simulation: `{name, value, stderr, determined, at_limit, combination}`.

    `stderr` is None for a number that the record does not determine, or that ends at its limit; `combination` is what
    is determined of it and others, None if nothing is. Also `limit`, `group` and `nominal`.
    """
    free = fit.hypothesis.plant.free
    if not free:
        return []
    at = fit.hypothesis.slices["plant"].start + np.arange(len(free))
    known = determined_numbers(data, fit)
    numbers: list[dict[str, object]] = []
    for one, value in zip(free, fit.theta[at].tolist(), strict=True):
        own = known.get(one.given_name, Determined(False))
        limit = next((end for end in (one.lower, one.upper) if abs(value - end) < AT_LIMIT), None)
        usable = own.determined and limit is None and np.isfinite(own.stderr)
        numbers.append(
            {
                "name": one.given_name,
                "value": one.number(value),
                "stderr": own.stderr if usable else None,
                "determined": own.determined,
                "at_limit": limit is not None,
                "limit": None if limit is None else one.number(limit),
                "combination": own.combination or None,
                "group": list(own.group),
                "nominal": one.nominal,
            }
        )
    return numbers


def _root(variance: float) -> float:
    """Standard error of a variance; zero if it is unknown or, by rounding, negative."""
    return float(np.sqrt(variance)) if np.isfinite(variance) and variance > 0.0 else 0.0


def _conditional(cov: FloatArray, place: int) -> FloatArray:
    """Conditional covariance of the other parameters, given the one at `place`."""
    own = cov[place, place]
    return cov - np.outer(cov[:, place], cov[place]) / own if own > 0.0 else cov
