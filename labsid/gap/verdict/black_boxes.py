"""Which kind of model could reduce the remaining error: nested black boxes on held-out samples."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.responses import normalized_time, real_rates, section
from labsid.gap.fits.fast_least_squares import solve_least_squares
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.residual_tests import input_history, lagged, previous_input, standardized
from labsid.gap.record.data import Data

FOLDS = 10  # contiguous parts of the record, each predicted from the others; set by hand
RIDGES = (1e-3, 1e-2, 1e-1, 1.0)  # relative to the mean square of a column; numerics
RATES = 8  # of the filters of the linear box; set by hand
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)  # of a signal, at which a piecewise linear curve bends; set by hand
HYSTERESIS = (0.1, 0.25, 0.5)  # widths of the plays of the input, as shares of its range; numerics
STICKING = np.geomspace(0.02, 0.6, 24)
"""Bands of a sticking valve, as shares of that range; measured: 5 of 8 `dev` rigs with one get its path,
3 with three bands."""
RELAYS = (0.15, 0.35, 0.5, 0.65, 0.85)  # quantiles of the input between which a relay switches; numerics
MIN_CYCLES = 3  # in the record, of a modulation; set by hand
SLOW_DEGREE = 4  # of the polynomials in time; set by hand
PREDICTABLE = 0.4  # share of the error beyond noise below which it counts as a disturbance; set by hand
NEARLY_ALL = 0.92  # of what all boxes close; measured: 23 of 30 `dev` rigs get the right path with it
RANDOM_FEATURES = 60  # cosines of random combinations of past inputs; set by hand
RANDOM_SCALE = 0.5  # of these combinations, for signals of unit variance; set by hand
MAX_VALUE = 1e3  # scaled: features are clipped there; numerics

KINDS = ("linear", "input", "output", "nonlinear", "time", "disturbance")
PATHS = {"linear": "dynamics", "nonlinear": "dynamics"} | {
    name: name for name in ("input", "output", "time", "disturbance")
}


@dataclass(frozen=True, slots=True)
class RemainingError:
    """What could reduce the error that an explanation leaves.

    Attributes
    ----------
    kinds : dict
        By name in `KINDS`: share of the error beyond white noise that the black box of this kind closes beyond the ones
        before it; "disturbance" is the rest. They add up to 1.
    path : str
        Path of the simplest kind that closes nearly all that the boxes close together.
    """

    kinds: dict[str, float]
    path: str


def kinds_of_error(data: Data, fit: Fit) -> RemainingError | None:
    """Attribute the error of a fit to kinds of models by ridge regression on past inputs and the simulated output.

    Static curves imitate nonlinear dynamics, and each other. A curve ahead or behind counts only if it alone closes
    nearly all that any function of the past does; otherwise what it closes belongs to the nonlinear dynamics.

    Parameters
    ----------
    data : Data
    fit : Fit

    Returns
    -------
    RemainingError or None
        None if the error is white noise.
    """
    boxes = _features(data, fit)
    regression = _Regression(data, data.y - fit.output, boxes)
    power, noise = regression.power, min(fit.noise.sigma2, regression.power)
    if power - noise <= 0.0:
        return None
    left = {"linear": min(regression.left(("linear",)), power)}
    left["input"] = min(regression.left(("linear", "input")), left["linear"])
    left["output"] = min(regression.left(("linear", "output")), left["linear"])
    curves = ("linear", "input", "output", "nonlinear")
    left["nonlinear"] = min(regression.left(curves), left["input"], left["output"])
    left["time"] = max(min(regression.left((*curves, "time")), left["nonlinear"]), noise)
    kind = _simplest(power - noise, {name: power - rest for name, rest in left.items()})
    nested = [name for name in KINDS[:-1] if name not in ("input", "output") or name == kind]
    gains, before = dict.fromkeys(KINDS, 0.0), power
    for name in nested:
        gains[name] = max(before - max(left[name], noise), 0.0)
        before = min(before, max(left[name], noise))
    gains["disturbance"] = before - noise
    total = sum(gains.values())
    return RemainingError({name: gains[name] / total for name in KINDS}, PATHS[kind]) if total > 0.0 else None


def predictable_share(data: Data, fit: Fit) -> float:
    """Share of the error of a fit, beyond white noise, that functions of the past input close; 0 of white noise.

    A slow disturbance is a slow function of time, too: what only the box "time" closes does not count.
    """
    remaining = kinds_of_error(data, fit)
    return 0.0 if remaining is None else sum(remaining.kinds[name] for name in KINDS[:4])


def _simplest(error: float, closed: dict[str, float]) -> str:
    """The simplest kind of model that closes nearly all that any of them closes; a disturbance if that is little."""
    most = max(closed.values())
    if most < PREDICTABLE * error:
        return "disturbance"
    return next(name for name in closed if closed[name] >= NEARLY_ALL * most)


class _Regression:
    """Cross-validated ridge regression on groups of columns, from the Gram matrices of the folds."""

    def __init__(self, data: Data, e: FloatArray, boxes: dict[str, FloatArray]) -> None:
        at = np.flatnonzero(data.complete)
        target = e[at] - np.mean(e[at])
        self.power = float(np.mean(target**2))
        ends = np.cumsum([box.shape[1] for box in boxes.values()])
        self.places = dict(zip(boxes, np.split(np.arange(ends[-1]), ends[:-1]), strict=True))
        X = standardized(np.clip(np.column_stack(list(boxes.values())), -MAX_VALUE, MAX_VALUE)[at])
        folds = np.array_split(np.arange(at.size), FOLDS)
        self.grams, self.crosses = (np.array([X[fold].T @ one[fold] for fold in folds]) for one in (X, target))
        self.squares = np.array([target[fold] @ target[fold] for fold in folds])
        self.count = at.size

    def left(self, names: Sequence[str]) -> float:
        """Mean square of the error that the boxes leave in the folds that they were not fitted to."""
        at = np.concatenate([self.places[name] for name in names])
        grams, crosses = self.grams[:, at[:, None], at], self.crosses[:, at]
        gram, cross = grams.sum(axis=0), crosses.sum(axis=0)
        best = np.inf
        for ridge in RIDGES:
            added = ridge * self.count * np.eye(at.size)
            gains = np.linalg.solve(gram - grams + added, (cross - crosses)[..., None])[..., 0]
            rest = self.squares - 2.0 * np.sum(gains * crosses, axis=1)
            rest = rest + np.einsum("fi,fij,fj->f", gains, grams, gains)
            best = min(best, float(rest.sum()) / self.count)
        return best


def _features(data: Data, fit: Fit) -> dict[str, FloatArray]:
    """Columns of each box, beyond those of the boxes before it; the present input cannot act yet."""
    u = previous_input(data)
    z = fit.output
    c, k = fit.rates
    slow = real_rates(c, k)[0] if 0.25 * c * c > k else 0.5 * c
    slow = float(np.clip(slow, 3.0 / data.samples, 1.0))
    rates = np.geomspace(max(0.3 * slow, 2.0 / data.samples), 2.0, RATES)
    filtered = lagged(u, rates)
    linear = [*filtered, *_delayed(u, (0, 1, 2, 4, 8, 16)), *_through(c, k, u)]
    span = float(np.ptp(u))
    curves = [*_bends(u), u**2, u**3]
    curves += [_kernels.backlash(u, width * span, 0.5) for width in HYSTERESIS]
    curves.append(_sticking(data, fit, u))
    levels = np.quantile(u, RELAYS)
    curves += [_kernels.relay(u, low, high) for i, low in enumerate(levels) for high in levels[i + 1 :]]
    ahead = [column for curve in curves for column in (curve, *_through(c, k, curve))]
    behind = [z, *_bends(z), z**2, np.clip(z, -4.0, 4.0) ** 3, *lagged(z, rates[-2:])]
    slope = np.gradient(z)
    slope = slope / (np.std(slope) or 1.0)
    states = list(input_history(data, fit).T)
    products = [a * b for i, a in enumerate(states) for b in states[i:]]
    sign = np.tanh(3.0 * slope)
    moving = [slope, np.abs(slope), sign, slope * z, np.abs(slope) * z, slope**2, sign * z]
    time = chebvander(normalized_time(data.samples, data.samples), SLOW_DEGREE)[:, 1:]
    varying = [*time.T, *(course * signal for course in time.T[:2] for signal in (u, z, slope, *filtered[::2]))]
    e = data.y - z
    varying += [column for signal in (z, slope) for column in _modulated(e * data.rows, signal)]
    return {
        "linear": np.column_stack(linear),
        "input": np.column_stack(ahead),
        "output": np.column_stack(behind),
        "nonlinear": np.column_stack([*products, *moving, *_random([*states, z, slope])]),
        "time": np.column_stack(varying),
    }


def _sticking(data: Data, fit: Fit, u: FloatArray) -> FloatArray:
    """The input behind a valve that sticks, with the band that explains most of the error."""
    e = (data.y - fit.output)[data.complete]
    e = e - e.mean()

    def closed(moved: FloatArray) -> float:
        X = np.column_stack(_through(*fit.rates, moved - u))[data.complete]
        return float(e @ X @ solve_least_squares(X - X.mean(axis=0), e))

    return max((_kernels.stick(u, float(band)) for band in STICKING * np.ptp(u)), key=closed)


def _through(c: float, k: float, signal: FloatArray) -> list[FloatArray]:
    """The signal after the linear dynamics s^2 + c s + k, with either numerator term."""
    return list(section(c, k, signal - signal[0])[:, :2].T)


def _random(signals: Sequence[FloatArray]) -> FloatArray:
    """Cosines of random combinations of signals: a basis for any smooth function of them."""
    rng = np.random.default_rng(0)
    X = standardized(np.column_stack(signals))
    weights = RANDOM_SCALE * rng.standard_normal((X.shape[1], RANDOM_FEATURES))
    return np.cos(X @ weights + rng.uniform(0.0, 2.0 * np.pi, RANDOM_FEATURES)).T


def _modulated(e: FloatArray, signal: FloatArray) -> list[FloatArray]:
    """The signal times the cosine and sine that its product with the error contains most of."""
    spectrum = np.abs(np.fft.rfft(e * (signal - signal.mean())))
    spectrum[:MIN_CYCLES] = 0.0
    phase = 2.0 * np.pi * np.argmax(spectrum) * np.arange(e.size) / e.size
    return [signal * np.cos(phase), signal * np.sin(phase)]


def _delayed(signal: FloatArray, lags: Sequence[int]) -> list[FloatArray]:
    return [np.concatenate([np.full(lag, signal[0]), signal[: signal.size - lag]]) for lag in lags]


def _bends(signal: FloatArray) -> list[FloatArray]:
    """Piecewise linear functions that bend at quantiles of the signal, and its absolute value."""
    return [*(np.maximum(signal - np.quantile(signal, q), 0.0) for q in QUANTILES), np.abs(signal)]
