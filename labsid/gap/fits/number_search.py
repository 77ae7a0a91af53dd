"""Search of the free numbers of a given simulation over decades and signs, before the search of effects."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Point, Problem, descend
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data

SCANNED = 1e4  # times the nominal value, either sign: range of the grid; the descent goes on beyond; numerics
GRID = 15  # values of a number over that range, about one for each decade of either sign; numerics
JOINT = 32  # points for each number that are spread over all, with at least one more number; numerics
STARTS = 3  # best points that are descended from; numerics
ITERATIONS = 8, 25  # from each start, and from the best of them; numerics
BUDGET_SHARE = 0.2  # of the runs that are left, for the grids; set by hand
MIN_GAIN = 0.5
"""Mean square error over that of the fit from the nominal values, from which another fit is taken; set by hand."""
DISTINCT = 1.0  # distance in theta of two starts; numerics


@dataclass(frozen=True, slots=True, eq=False)
class _Box:
    """The numbers of a structure that are searched.

    Attributes
    ----------
    problem : Problem
    at : ndarray
        Their indices in theta.
    low, high : ndarray
        Ends of the grids, in theta.
    """

    problem: Problem
    at: np.ndarray
    low: FloatArray
    high: FloatArray

    def grid(self, i: int) -> FloatArray:
        """Values of one number."""
        return np.linspace(self.low[i], self.high[i], GRID)

    def moved(self, theta: FloatArray, i: int) -> Iterator[FloatArray]:
        """Theta with every value of one number."""
        for value in self.grid(i):
            changed = theta.copy()
            changed[self.at[i]] = value
            yield changed

    def spread(self, count: int, at_nominal: FloatArray) -> Iterator[FloatArray]:
        """Points that are spread evenly over all numbers."""
        theta = at_nominal.copy()
        sequence = qmc.Sobol(self.at.size, seed=0).random(count)
        for point in qmc.scale(sequence, self.low, self.high):
            theta[self.at] = point
            yield theta.copy()


def search_numbers(data: Data, structure: Hypothesis, start: FloatArray | None = None) -> FloatArray | None:
    """Parameters of a structure at the free numbers that fit the record best; None if nothing can be simulated.

    A descent from the nominal values is kept unless the best of several others, from the best points of grids of each
    number and of points spread over all of them, halves its mean square error. The grids take at most
    ``15 n + 32 n`` runs of n numbers (15 of a single one), and another ``15 n`` about the point whose output has the
    best shape.

    Parameters
    ----------
    data : Data
    structure : Hypothesis
        With a given simulation that has free numbers.
    start : ndarray, optional
        Parameters at the nominal values; by default all are zero.
    """
    problem = Problem(data, structure)
    box = _box(problem)
    at_nominal = np.zeros(len(structure.parameters)) if start is None else start
    nominal = problem.start(at_nominal)
    kept = None if nominal is None else descend(problem, nominal, sum(ITERATIONS))
    meter = structure.plant.simulation.meter
    count = box.at.size
    spread = JOINT * count if count > 1 else 0
    if GRID * 2 * count + spread > BUDGET_SHARE * meter.left:
        return None if kept is None else kept.theta
    about = at_nominal if kept is None else kept.theta
    points = _simulated(problem, [theta for i in range(count) for theta in box.moved(about, i)])
    points += _simulated(problem, list(box.spread(1 << (spread - 1).bit_length(), at_nominal))) if spread else []
    if not points:
        return None if kept is None else kept.theta
    shaped = max(points, key=lambda point: _shape(problem, point))
    for i in range(count):
        shaped = min([shaped, *_simulated(problem, list(box.moved(shaped.theta, i)))], key=_cost)
    ends = [descend(problem, start, ITERATIONS[0]) for start in _distinct(box, [shaped, *sorted(points, key=_cost)])]
    best = descend(problem, min(ends, key=_cost), ITERATIONS[1])
    return best.theta if kept is None or best.cost < MIN_GAIN * kept.cost else kept.theta


def _box(problem: Problem) -> _Box:
    hypothesis = problem.hypothesis
    free = hypothesis.plant.free
    at = hypothesis.slices["plant"].start + np.arange(len(free))
    reach = [SCANNED * max(abs(one.nominal), one.unit) for one in free]
    low = np.array([max(one.lower, one.theta(-most)) for one, most in zip(free, reach, strict=True)])
    high = np.array([min(one.upper, one.theta(most)) for one, most in zip(free, reach, strict=True)])
    return _Box(problem, at, low, high)


def _simulated(problem: Problem, thetas: list[FloatArray]) -> list[Point]:
    """The points at which the simulation works."""
    return [point for theta in thetas if (point := problem.start(theta)) is not None]


def _shape(problem: Problem, point: Point) -> float:
    """Correlation of the output with the record, whatever its size, offset and sign."""
    output = problem.seen(point.design.columns[:, :1])[:, 0]
    spread = float(np.std(output) * np.std(problem.y))
    return abs(float(np.mean((output - output.mean()) * (problem.y - problem.y.mean())))) / spread if spread else 0.0


def _cost(point: Point) -> float:
    return point.cost


def _distinct(box: _Box, ranked: list[Point]) -> list[Point]:
    """The first points that are apart from each other."""
    chosen: list[Point] = []
    for point in ranked:
        if all(np.abs(point.theta[box.at] - other.theta[box.at]).max() > DISTINCT for other in chosen):
            chosen.append(point)
        if len(chosen) == STARTS:
            break
    return chosen
