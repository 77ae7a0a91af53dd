"""Profile likelihood of an instant, and of the size of an effect at zero."""

from copy import copy
from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit, Point, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data

FIRST_STEP = 0.5  # samples, at most; numerics
FIRST_LOSS = 1.0  # twice the loss of log likelihood by the first step, at most; numerics
HALVINGS = 12  # of the first step, at most; numerics
STEP_GROWTH = 1.5  # of successive steps; numerics
MAX_LOSS = 12.0  # twice the loss of log likelihood at which the profile ends; numerics
MIN_SIZE_LOSS = 13.0  # the same, of size zero; statistics: 3.6 standard errors, 1 % for the best of 35 candidates


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """Fits at fixed values of one parameter.

    Attributes
    ----------
    points : tuple of Point
        In ascending order of the parameter.
    weights : ndarray
        Their probabilities, with sum 1.
    """

    points: tuple[Point, ...]
    weights: FloatArray


def profile_likelihood(data: Data, fit: Fit, place: int) -> Profile | None:
    """Profile the likelihood of the instant `theta[place]`, a share of the record, on both sides of its estimate.

    The error hardly depends on an instant within a sample, and not at all where the input is constant: linear
    propagation of errors does not apply.

    Parameters
    ----------
    data : Data
    fit : Fit
    place : int

    Returns
    -------
    Profile or None
        None if the fit cannot be reproduced.
    """
    best = _held(data, fit, [place], float(fit.theta[place]), fit)
    if best is None:
        return None
    points = [best]
    first = _first_step(data, fit, place, best)
    for side in (-1.0, 1.0):
        step, at, last = first, float(fit.theta[place]), best
        while 0.0 < at + side * step < 1.0:
            at += side * step
            held = _held(data, fit, [place], at, last)
            if held is None:
                break
            points.append(held)
            if _loss(fit, held, best) > MAX_LOSS:
                break
            step, last = STEP_GROWTH * step, held
    points.sort(key=lambda point: float(point.theta[place]))
    loss = np.array([_loss(fit, point, best) for point in points])
    instants = np.array([point.theta[place] for point in points])
    weights = np.exp(-0.5 * (loss - loss.min())) * np.gradient(instants)
    return Profile(tuple(points), weights / weights.sum())


def _first_step(data: Data, fit: Fit, place: int, best: Point) -> float:
    """A step, as a share of the record, that loses little of the likelihood on either side."""
    step, at = FIRST_STEP / data.samples, float(fit.theta[place])
    for _ in range(HALVINGS):
        beside = (_held(data, fit, [place], at + side * step, best) for side in (-1.0, 1.0))
        if all(one is not None and _loss(fit, one, best) < FIRST_LOSS for one in beside):
            break
        step *= 0.5
    return step


def has_size(data: Data, fit: Fit) -> bool:
    """Whether the record asks for the size of every effect found: a fit with that size zero is clearly worse.

    A nonlinear form that fits better for another reason than its effect, such as another initial state, does not.

    Parameters
    ----------
    data : Data
    fit : Fit
    """
    names = [parameter.name for parameter in fit.hypothesis.parameters]
    for effect in fit.hypothesis.found:
        places = [names.index(name) for name in effect.sizes if name in names]
        if not places:
            continue
        as_found, without = (_held(data, fit, places, value, fit) for value in (fit.theta[places], 0.0))
        if as_found is not None and without is not None and _loss(fit, without, as_found) < MIN_SIZE_LOSS:
            return False
    return True


def loss_at(data: Data, fit: Fit, place: int, value: float) -> float:
    """Twice the loss of log likelihood of a refit with `theta[place]` at another value; infinite if there is none.

    Parameters
    ----------
    data : Data
    fit : Fit
    place : int
    value : float
    """
    best, other = (_held(data, fit, [place], x, fit) for x in (float(fit.theta[place]), value))
    return np.inf if best is None or other is None else _loss(fit, other, best)


def with_held(hypothesis: Hypothesis, places: list[int], value: FloatArray | float) -> Hypothesis:
    """The hypothesis with some parameters fixed.

    Parameters
    ----------
    hypothesis : Hypothesis
    places : list of int
        In theta.
    value : ndarray or float
    """
    bounds = tuple(side.copy() for side in hypothesis.bounds)
    for side in bounds:
        side[places] = value
    held: Hypothesis = copy(hypothesis)
    object.__setattr__(held, "bounds", bounds)  # of the copy
    return held


def _held(data: Data, fit: Fit, places: list[int], value: FloatArray | float, near: Fit | Point) -> Point | None:
    """Refit with some parameters fixed, starting from a neighbouring point."""
    theta = near.theta.copy()
    theta[places] = value
    held = with_held(fit.hypothesis, places, value)
    return minimize(data, held, theta, near.gains, iterations=5, ar=fit.noise.ar, tolerance=1e-4)


def _loss(fit: Fit, point: Point, best: Point) -> float:
    """Twice the loss of log likelihood."""
    return float(fit.noise.rows * (point.cost - best.cost) / fit.noise.sigma2)
