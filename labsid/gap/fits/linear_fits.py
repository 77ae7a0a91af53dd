"""Linear fits of a record: the baseline for all effects."""

from collections.abc import Iterable
from operator import attrgetter

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.responses import single_pole
from labsid.gap.effects import output
from labsid.gap.effects.dynamics import DirectFeedthrough
from labsid.gap.effects.further_inputs import FurtherInput, SameEntry
from labsid.gap.effects.output_feedback import OutputFeedback
from labsid.gap.effects.restarts import Restarts
from labsid.gap.fits.fitting import Fit, Point, Problem, descend, finish, minimize
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.fits.undriven_poles import has_undriven_pole
from labsid.gap.record.data import Data
from labsid.simulators.meter import BudgetSpentError, RunMeter

LINEAR = Hypothesis()
POPULATION = 8  # members for each parameter, of the search without derivatives; numerics
GENERATIONS = 30  # of the search without derivatives; numerics
BUDGET_SHARE = 0.2  # of the runs that are left, for that search; set by hand
SINGLE_POLE_RATES = 0.005, 0.02, 0.1, 0.4, 1.5  # per sample: start values for a rig with a single pole; numerics


def fit_baseline(data: Data, hypothesis: Hypothesis = LINEAR, start: FloatArray | None = None) -> Fit:
    """Fit a structure by output error; the default is second order and strictly proper.

    `start` is an additional start value of theta.

    Raises
    ------
    ValueError
        If no start can be simulated; `BudgetSpentError` if the budget of runs of a given simulation is spent.
    """
    poles = ((0.02, 0.3), (0.1, 0.5), (0.005, 0.05), (0.3, 1.5))
    rates = [(slow + fast, slow * fast) for slow, fast in poles] + [(0.4 * w, w**2) for w in (0.05, 0.2, 0.8)]
    starts = [_start_theta(hypothesis, c, k) for c, k in rates]
    starts = starts[:1] if hypothesis.plant.kind == "given" else starts  # a given simulation has no rates
    starts = starts if start is None else [start, *starts]
    best = _least(minimize(data, hypothesis, theta, iterations=12) for theta in starts)
    if best is None:
        raise _no_fit(hypothesis.plant.simulation.meter)
    best = descend(Problem(data, hypothesis), best, iterations=30, tolerance=1e-8)
    if hypothesis.plant.simulation.rough:
        best = _least([best, _without_derivatives(data, hypothesis, best.theta)]) or best
    return finish(data, hypothesis, best)


def _without_derivatives(data: Data, hypothesis: Hypothesis, start: FloatArray) -> Point | None:
    """Fit a given simulation by differential evolution, which uses no derivatives; None if its budget is too small."""
    from scipy.optimize import differential_evolution

    problem = Problem(data, hypothesis)

    def cost(theta: FloatArray) -> float:
        point = problem.point(theta)
        return np.inf if point is None else point.cost

    bounds = list(zip(*hypothesis.bounds, strict=True))
    affordable = BUDGET_SHARE * hypothesis.plant.simulation.meter.left / (POPULATION * len(bounds))
    generations = int(min(GENERATIONS, affordable - 1.0))
    if generations < 1:
        return None
    options = {"popsize": POPULATION, "maxiter": generations, "init": "sobol", "polish": False}
    return problem.point(differential_evolution(cost, bounds, x0=start, seed=0, **options).x)


def _no_fit(meter: RunMeter) -> ValueError:
    """Why no start can be simulated."""
    if meter.exhausted:
        return BudgetSpentError(meter.budget)
    return ValueError(meter.failure or "no second-order model can be simulated on this record.")


def fit_driven_pole(data: Data, hypothesis: Hypothesis) -> Fit | None:
    """Fit the structure with a single pole that the input excites.

    None if the input does not excite the pole of any fit.
    """
    starts = (_start_theta(hypothesis, *single_pole(rate)) for rate in SINGLE_POLE_RATES)
    points = [point for theta in starts if (point := minimize(data, hypothesis, theta, iterations=30)) is not None]
    fits = (finish(data, hypothesis, point) for point in sorted(points, key=lambda point: point.cost))
    return next((fit for fit in fits if not has_undriven_pole(data, fit)), None)


def _start_theta(hypothesis: Hypothesis, c: float, k: float) -> FloatArray:
    """Start values at given rates; an additional pole or mode is slightly faster."""
    guess = {
        "delay": 0.2,
        "log_c": np.log(c),
        "log_k": np.log(k),
        "log_lag": 0.0,
        "log_frequency": 0.5 * np.log(k) + 0.7,
        "log_damping": -1.5,
    }
    return np.array([guess.get(parameter.name, 0.0) for parameter in hypothesis.parameters])


def fit_highpass(data: Data, base: Fit) -> Fit:
    """Fit the structure to the high-pass filtered record, in which drifts and load steps are small."""
    hypothesis = linear_structure_of(base).plus(output.Drift("10"))
    ar = np.array([0.9])
    same = base.hypothesis.parameters == hypothesis.parameters
    start = base.theta if same else _start_theta(hypothesis, *base.rates)
    starts = (start, _start_theta(hypothesis, 0.3, 0.01), _start_theta(hypothesis, 1.0, 0.1))
    best = _least(minimize(data, hypothesis, theta, iterations=12, ar=ar) for theta in starts)
    return base if best is None else finish(data, hypothesis, best)


def linear_structure_of(fit: Fit) -> Hypothesis:
    """Second order, with direct term, further inputs, a feedback, and what belongs to each of several records."""
    kept = Restarts | DirectFeedthrough | FurtherInput | SameEntry | OutputFeedback
    own = tuple(effect for effect in fit.hypothesis.effects if isinstance(effect, kept))
    return Hypothesis(own, len(own))


def _least(points: Iterable[Point | None]) -> Point | None:
    """The point of least cost; None if there is none."""
    return min((point for point in points if point is not None), key=attrgetter("cost"), default=None)
