"""Refine a fit: escape local minima, and maximize the likelihood under coloured noise."""

from operator import attrgetter

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fast_least_squares import scaled_gram
from labsid.gap.fits.fitting import Fit, Point, Problem, descend, finish, minimize, rms
from labsid.gap.record.data import Data
from labsid.gap.search.candidates import best_form
from labsid.gap.search.forms import remove_effect

LEAP_FACTORS = 1.0, -1.0, 3.0, -3.0, 8.0, -8.0  # of `Parameter.leap`; numerics
MAX_START_COST = 1.3  # largest cost after a leap that is minimized, over the present cost; numerics
VALLEY_RIDGE = 1e-9  # relative ridge for parameters without influence; numerics


def converge(data: Data, fit: Fit) -> Fit:
    """Minimize to convergence, with leaps out of local minima."""
    hypothesis = fit.hypothesis
    problem = Problem(data, hypothesis)
    lower, upper = problem.bounds
    start = problem.start(fit.theta, fit.gains)
    if start is None:
        return fit
    at = descend(problem, start, iterations=25)
    leaping = [(i, parameter.leap) for i, parameter in enumerate(hypothesis.parameters) if parameter.leap]
    for _ in range(3 if leaping else 0):
        before = at.cost
        valleys = valley_directions(problem, at)
        for i, distance in leaping:
            direction = np.eye(lower.size)[i]
            for factor in LEAP_FACTORS:
                far = np.clip(at.theta[i] + factor * distance, lower[i], upper[i]) - at.theta[i]
                leaps = [_leap(problem, at, far * along) for along in (valleys[i], direction)] if far else []
                leap = min((one for one in leaps if one is not None), key=attrgetter("cost"), default=at)
                if leap is not at and leap.cost < MAX_START_COST * at.cost:
                    other = descend(problem, leap, iterations=4, tolerance=1e-3)
                    if other.cost < (1.0 - 1e-4) * at.cost:
                        at = other
                        break
        if at.cost > (1.0 - 1e-3) * before:
            break
    new = finish(data, hypothesis, descend(problem, at, iterations=25, tolerance=1e-6))
    return best_form([fit, new])


def retried_without_one(data: Data, fit: Fit) -> list[Fit]:
    """Fits without each of the effects found, from the parameters of the fit with all of them.

    One effect alone may stand in a local minimum that it leaves only together with another one, however small.
    """
    found = range(fit.hypothesis.n_given, len(fit.hypothesis.effects))
    fewer = (remove_effect(data, fit, which) for which in found)
    return [converge(data, one) for one in fewer if one is not None]


def _leap(problem: Problem, at: Point, step: FloatArray) -> Point | None:
    return problem.point(np.clip(at.theta + step, *problem.bounds), at.gains if problem.has_sensor else None)


def valley_directions(problem: Problem, at: Point) -> FloatArray:
    """By parameter, the change of theta along the valley of the cost per unit of that parameter; shape (p, p)."""
    J = problem.jacobian(at)
    if J is None:
        return np.eye(at.theta.size)
    gram, scale = scaled_gram(J)
    gram[np.diag_indices_from(gram)] += VALLEY_RIDGE
    inverse = (np.linalg.inv(gram) / np.outer(scale, scale))[: at.theta.size, : at.theta.size]
    return np.asarray(inverse / np.diag(inverse)[:, None], np.float64)


def polish(data: Data, fit: Fit, rounds: int = 2, iterations: int = 6) -> Fit:
    """Refit the residual whitened by its noise model, an approximate maximum-likelihood fit, while the BIC improves."""
    best = fit
    for _ in range(rounds):
        point = minimize(data, best.hypothesis, best.theta, best.gains, iterations, best.noise.ar)
        if point is None:
            break
        new = finish(data, best.hypothesis, point)
        # Whitening with a slow pole discards the level: reject a fit with a larger free-run error.
        if new.bic >= best.bic - 0.1 or rms(data, new) > 1.05 * rms(data, best):
            break
        best = new
    return best
