"""Take a fit to its end: over local minima, and to the most likely one."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.fast_least_squares import scaled_gram
from labsid.gap.fitting import UNFILTERED, Fit, Point, Problem, finish, minimize, rms

LEAP_FACTORS = 1.0, -1.0, 3.0, -3.0, 8.0, -8.0  # times the distance over which a parameter may have several minima
MAX_START_COST = 1.3  # times the error, from where a leap is followed
VALLEY_RIDGE = 1e-9  # of its scaled square: what keeps a parameter that does nothing in its place


def converge(data: Data, fit: Fit) -> Fit:
    """Go on with the search until it stands still, leaping over what may be only a local minimum."""
    hypothesis = fit.hypothesis
    lower, upper = hypothesis.bounds
    at = minimize(data, hypothesis, fit.theta, fit.gains, iterations=25, tolerance=1e-5)
    if at is None:
        return fit
    problem = Problem(data, hypothesis, UNFILTERED)
    leaping = [(i, parameter.leap) for i, parameter in enumerate(hypothesis.parameters) if parameter.leap]
    for _ in range(3 if leaping else 0):
        before = at.cost
        valleys = _valleys(problem, at)
        for i, distance in leaping:
            alone = np.eye(lower.size)[i]
            for leap in LEAP_FACTORS:
                far = np.clip(at.theta[i] + leap * distance, lower[i], upper[i]) - at.theta[i]
                tried = [_leap(problem, at, far * along) for along in (valleys[i], alone)] if far else []
                start = min((one for one in tried if one is not None), key=_cost, default=at)
                if start is not at and start.cost < MAX_START_COST * at.cost:
                    other = minimize(data, hypothesis, start.theta, start.gains, iterations=4, tolerance=1e-3)
                    if other is not None and other.cost < (1.0 - 1e-4) * at.cost:
                        at = other
                        break
        if at.cost > (1.0 - 1e-3) * before:
            break
    at = minimize(data, hypothesis, at.theta, at.gains, iterations=25, tolerance=1e-6) or at
    new = finish(data, hypothesis, at)
    return new if new.bic < fit.bic else fit


def _leap(problem: Problem, at: Point, step: FloatArray) -> Point | None:
    return problem.point(np.clip(at.theta + step, *problem.hypothesis.bounds), at.gains if problem.has_sensor else None)


def _cost(point: Point) -> float:
    return point.cost


def _valleys(problem: Problem, at: Point) -> FloatArray:
    """By parameter, how theta goes on when that one is moved by one and all others follow it; shape (p, p)."""
    J = problem.jacobian(at)
    if J is None:
        return np.eye(at.theta.size)
    gram, scale = scaled_gram(J)
    gram[np.diag_indices_from(gram)] += VALLEY_RIDGE
    inverse = (np.linalg.inv(gram) / np.outer(scale, scale))[: at.theta.size, : at.theta.size]
    return np.asarray(inverse / np.diag(inverse)[:, None], np.float64)


def polish(data: Data, fit: Fit, rounds: int = 2, iterations: int = 6) -> Fit:
    """Refit with the residual whitened by its own noise model, as maximum likelihood asks, as long as it helps."""
    best = fit
    for _ in range(rounds):
        point = minimize(data, best.hypothesis, best.theta, best.gains, iterations, best.noise.ar)
        if point is None:
            break
        new = finish(data, best.hypothesis, point)
        # Whitening by a slow pole forgets the level: a fit that no longer runs freely is not taken.
        if new.bic >= best.bic - 0.1 or rms(data, new) > 1.05 * rms(data, best):
            break
        best = new
    return best
