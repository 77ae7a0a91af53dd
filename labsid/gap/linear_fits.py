"""Linear dynamics fitted to the record: what every effect is tried on top of."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.effects import output
from labsid.gap.fitting import Fit, Point, finish, minimize
from labsid.gap.hypothesis import Hypothesis
from labsid.gap.responses import single_pole
from labsid.gap.undriven_poles import has_undriven_pole

LINEAR = Hypothesis()
SINGLE_POLE_RATES = 0.005, 0.02, 0.1, 0.4, 1.5  # rates, a sample, of a rig that has one pole


def fit_baseline(data: Data, hypothesis: Hypothesis = LINEAR, known: FloatArray | None = None) -> Fit:
    """Fit a structure, unless given the lab's (second order, strictly proper), by output error.

    A structure with its effects' numbers `known` begins from there.
    """
    best = None if known is None else minimize(data, hypothesis, known, iterations=12)
    for slow, fast in ((0.02, 0.3), (0.1, 0.5), (0.005, 0.05), (0.3, 1.5)):
        start = _start_theta(hypothesis, slow + fast, slow * fast)
        best = _better(best, minimize(data, hypothesis, start, iterations=12))
    for frequency in (0.05, 0.2, 0.8):
        start = _start_theta(hypothesis, 0.4 * frequency, frequency**2)
        best = _better(best, minimize(data, hypothesis, start, iterations=12))
    if best is None:
        raise ValueError("no second-order model can be simulated on this record.")
    best = minimize(data, hypothesis, best.theta, iterations=30, tolerance=1e-8) or best
    return finish(data, hypothesis, best)


def fit_driven_pole(data: Data, hypothesis: Hypothesis) -> Fit | None:
    """The structure with one pole left to the rig, for a record that has drawn the other one into what goes on alone.

    None where that pole is drawn there too.
    """
    points = []
    for rate in SINGLE_POLE_RATES:
        point = minimize(data, hypothesis, _start_theta(hypothesis, *single_pole(rate)), iterations=30)
        if point is not None:
            points.append(point)
    fits = (finish(data, hypothesis, point) for point in sorted(points, key=lambda point: point.cost))
    return next((fit for fit in fits if not has_undriven_pole(data, fit)), None)


def _start_theta(hypothesis: Hypothesis, c: float, k: float) -> FloatArray:
    """A start at given rates; a further pole or mode of the structure a little faster."""
    theta = np.zeros(len(hypothesis.parameters))
    names = [parameter.name for parameter in hypothesis.parameters]
    guess = {
        "delay": 0.2,
        "log_c": np.log(c),
        "log_k": np.log(k),
        "log_lag": 0.0,
        "log_frequency": 0.5 * np.log(k) + 0.7,
        "log_damping": -1.5,
    }
    for i, name in enumerate(names):
        theta[i] = guess.get(name, 0.0)
    return theta


def fit_highpass(data: Data, base: Fit) -> Fit:
    """The same structure fitted to what changes from sample to sample: drifts and load steps hardly reach it."""
    hypothesis = Hypothesis((output.Drift("10"),))
    ar = np.array([0.9])
    best: Point | None = None
    known = base.theta if base.theta.size == len(hypothesis.parameters) else _start_theta(hypothesis, *base.rates)
    for theta in (known, _start_theta(hypothesis, 0.3, 0.01), _start_theta(hypothesis, 1.0, 0.1)):
        best = _better(best, minimize(data, hypothesis, theta, iterations=12, ar=ar))
    return base if best is None else finish(data, hypothesis, best)


def _better(a: Point | None, b: Point | None) -> Point | None:
    if a is None or (b is not None and b.cost < a.cost):
        return b
    return a
