"""Tests of the residual of an explanation: whether it is noise or still depends on the input."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import chdtrc

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.noise_model import Noise
from labsid.gap.record.data import Data

FOLDS = 5  # of the cross-validated prediction of the residual from past inputs; set by hand
RIDGE = 0.01  # relative to the mean square of a column; numerics
NEIGHBOURS = 60  # samples of similar input history with which a sample is compared; set by hand
MAX_POINTS = 3000  # samples that are compared; numerics
MIN_UNLIMITED_SHARE = 0.3  # smallest share of rows within the sensor's limits; set by hand
MAX_LAG = 25  # samples: largest lag of the autocorrelation; set by hand
MIN_PAIRS = 100  # samples per lag; set by hand
INPUT_LAGS = 20  # samples: past inputs on which a residual may depend; set by hand
SLOW_LAG = 6  # samples after which sensor noise is uncorrelated; set by hand
BURSTS = 6.0  # standard errors of the kurtosis of Gaussian noise, above which a residual comes and goes; set by hand
SLOW_CORRELATION = 0.3  # autocorrelation after `SLOW_LAG` samples of a slow residual; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class ResidualMeasures:
    """Measures of a residual.

    Attributes
    ----------
    rms : float
        In scaled units.
    colour : float
        rms over the standard deviation of the innovations; one for white noise.
    slow : float
        Largest absolute autocorrelation at lags of `SLOW_LAG` samples or more.
    explained : float
        Cross-validated share of the power that nonlinear features of the input explain; zero or less if none.
    repeats : float
        Correlation of the residual at different times with similar input history; zero for noise.
    repeats_z : float
        `repeats` as a z-score; the null distribution comes from time shifts of the residual.
    activity, activity_z : float
        The same two of the absolute residual: the size of noise does not depend on the input.
    tails : float
        Kurtosis of the innovations, or of a residual that comes and goes; 3 for a normal distribution.
    input_p : float
        P-value of `input_correlation`.
    """

    rms: float
    colour: float
    slow: float
    explained: float
    repeats: float
    repeats_z: float
    activity: float
    activity_z: float
    tails: float
    input_p: float = 1.0


def is_noise(measures: ResidualMeasures, converted: bool) -> bool:
    """Whether a residual is noise, white or coloured: neither its value nor its size depends on past inputs.

    Parameters
    ----------
    measures : ResidualMeasures
    converted : bool
        Whether it is the rounding error of a coarse converter.
    """
    if converted:
        return True  # rounding errors do depend on the input; their size is checked elsewhere
    return not (
        (measures.repeats > 0.1 and measures.repeats_z > 2.5)
        or (measures.activity > 0.08 and measures.activity_z > 4.0)
        or measures.explained > 0.25
        or measures.tails > 4.5
    )


def measure_residual(data: Data, fit: Fit) -> ResidualMeasures:
    """Measure the residual of `fit` on the rows of `data` at which the sensor is not at a limit."""
    e = data.y - fit.output
    data = _within_limits(data, fit)
    rows = data.rows
    power = float(np.mean(e[rows] ** 2))
    white = _kernels.whiten(e[:, None], fit.noise.ar)[:, 0][data.complete]
    innovation = float(np.mean(white**2))
    white = white / np.std(white)
    repeats, repeats_z = repeatability(data, fit, e)
    activity, activity_z = repeatability(data, fit, np.abs(e))
    return ResidualMeasures(
        rms=float(np.sqrt(power)),
        colour=float(np.sqrt(power / innovation)),
        slow=slow_autocorrelation(data.readings(e), data.readings(rows)),
        explained=explained_share(data, fit, e),
        repeats=repeats,
        repeats_z=repeats_z,
        activity=activity,
        activity_z=activity_z,
        tails=max(float(np.mean(white**4)), _kurtosis(e[rows]) if comes_and_goes(e[rows], fit.noise) else 0.0),
        input_p=input_correlation(data, fit, e),
    )


def _within_limits(data: Data, fit: Fit) -> Data:
    """Exclude the rows with the simulated sensor at a limit, if enough others remain."""
    if not any(effect.is_limit for effect in fit.hypothesis.outputs):
        return data
    design = fit.hypothesis.design(fit.theta, data.u)
    rows = data.rows & fit.hypothesis.within_limits(fit.theta, fit.gains, design)
    return replace(data, rows=rows) if rows.sum() > MIN_UNLIMITED_SHARE * data.rows.sum() else data


def comes_and_goes(e: FloatArray, noise: Noise) -> bool:
    """Whether a residual is large in a few stretches and small elsewhere, as noise from one source is not.

    The kurtosis of N samples of Gaussian noise with the pole p has the variance 24 (1 + p^4)/(1 - p^4)/N (Lomnicki,
    Z. angew. Math. Mech. 41 (1961) 37-62).

    Parameters
    ----------
    e : ndarray, shape (N,)
    noise : Noise
    """
    fourth = min(noise.pole**4, 1.0 - 1e-9)
    stderr = float(np.sqrt(24.0 * (1.0 + fourth) / (1.0 - fourth) / e.size))
    return _kurtosis(e) > 3.0 + BURSTS * stderr


def _kurtosis(e: FloatArray) -> float:
    x = e - e.mean()
    return float(np.mean(x**4) / max(float(np.mean(x**2)) ** 2, 1e-300))


def slow_autocorrelation(e: FloatArray, rows: np.ndarray) -> float:
    """Largest absolute autocorrelation at lags of `SLOW_LAG` samples or more, on the rows that count."""
    power = float(np.mean(e[rows] ** 2))
    found = 0.0
    if power == 0.0:
        return found
    for lag in range(SLOW_LAG, MAX_LAG):
        both = rows[lag:] & rows[:-lag]
        if both.sum() > MIN_PAIRS:
            found = max(found, abs(float(np.mean((e[lag:] * e[:-lag])[both]))) / power)
    return found


def input_correlation(data: Data, fit: Fit, e: FloatArray) -> float:
    """P-value of a test that a whitened residual is uncorrelated with past values of the equally filtered input.

    1 if the input does not move, as it may in a holdout.
    """
    if np.ptp(data.u) == 0.0:
        return 1.0
    white = _kernels.whiten(np.column_stack([e, data.u - data.u.mean()]), fit.noise.ar)
    x, u = white[:, 0], white[:, 1]
    past = np.column_stack([np.concatenate([np.zeros(lag), u[:-lag]]) for lag in range(1, INPUT_LAGS + 1)])
    past = past[data.complete] - past[data.complete].mean(axis=0)
    target = x[data.complete] - x[data.complete].mean()
    q, r = np.linalg.qr(past)
    independent = np.abs(np.diag(r)) > 1e-6 * np.abs(np.diag(r)).max()
    predicted = float(((q.T @ target)[independent] ** 2).sum())
    return float(chdtrc(int(independent.sum()), predicted / (float(target @ target) / target.size)))


def explained_share(data: Data, fit: Fit, e: FloatArray) -> float:
    """Share of the power of `e` that nonlinear features of the input explain, by cross-validation over blocks."""
    at = np.flatnonzero(data.complete)
    X = standardized(nonlinear_features(data, fit)[at])
    target = e[at] - e[at].mean()
    remaining, total = 0.0, float(target @ target)
    parts = np.array_split(np.arange(at.size), FOLDS * 2)
    grams, crosses = (np.array([X[part].T @ one[part] for part in parts]) for one in (X, target))
    for fold in range(FOLDS):
        out = [fold, fold + FOLDS]
        gram, cross = (np.delete(one, out, axis=0).sum(axis=0) for one in (grams, crosses))
        gains = np.linalg.solve(gram + RIDGE * at.size * np.eye(X.shape[1]), cross)
        for part in (parts[i] for i in out):
            rest = target[part] - X[part] @ gains
            remaining += float(rest @ rest)
    return 1.0 - remaining / total if total > 0.0 else 0.0


def standardized(X: FloatArray) -> FloatArray:
    """Columns less their mean, over their standard deviation."""
    spread = X.std(axis=0)
    return np.asarray((X - X.mean(axis=0)) / np.where(spread > 0.0, spread, 1.0))


def repeatability(data: Data, fit: Fit, e: FloatArray) -> tuple[float, float]:
    """Correlation of the residual at times with similar input history, and its z-score."""
    at = np.flatnonzero(data.rows)
    if at.size > MAX_POINTS:
        at = at[:: -(-at.size // MAX_POINTS)]
    past = input_history(data, fit)[at]
    scale = past.std(axis=0)
    past = past / np.where(scale > 0, scale, 1.0)
    x = e[at] - e[at].mean()
    apart = max(at.size // 20, 10)
    _, near = cKDTree(past).query(past, k=min(NEIGHBOURS, at.size // 3))
    far = np.abs(near - np.arange(at.size)[:, None]) > apart
    # The three nearest neighbours that are not close in time.
    order = np.cumsum(far, axis=1)
    chosen = far & (order <= 3)
    some = chosen.any(axis=1)
    if some.sum() < 30:
        return 0.0, 0.0
    count = chosen.sum(axis=1)[some]

    def similarity(x: FloatArray) -> float:
        mean = np.where(chosen, x[near], 0.0).sum(axis=1)[some] / count
        return float(np.mean(x[some] * mean) / np.mean(x**2))

    value = similarity(x)
    shifts = np.linspace(0.15, 0.85, 24) * x.size
    chance = np.array([similarity(np.roll(x, int(shift))) for shift in shifts])
    # A shifted residual is paired with unrelated input histories: the null distribution.
    return value, float((value - chance.mean()) / (chance.std() or 1.0))


def input_history(data: Data, fit: Fit) -> FloatArray:
    """Features of past inputs: filtered inputs at several rates, and the direction of the last change."""
    change = np.diff(previous_input(data), prepend=data.u[0])
    last = np.sign(change)
    index = np.maximum.accumulate(np.where(last != 0.0, np.arange(last.size), 0))
    return np.column_stack([*_filtered_input(data, fit), 0.5 * last[index]])


def _filtered_input(data: Data, fit: Fit) -> list[FloatArray]:
    """The input after lags whose rates cover the linear dynamics, slowest first, and the previous input."""
    c, k = fit.rates
    slow = 0.5 * c - np.sqrt(0.25 * c * c - k) if 0.25 * c * c > k else 0.5 * c
    slow = float(np.clip(slow, 1e-3, 1.0))
    fast = float(np.clip(max(c, np.sqrt(k)), 2.0 * slow, 2.0))
    return [*lagged(data.u, np.geomspace(slow, fast, 4)), previous_input(data) - data.u[0]]


def lagged(signal: FloatArray, rates: FloatArray) -> list[FloatArray]:
    """The deviation of a signal from its first sample after first-order lags of these rates per sample."""
    return [_kernels.first_order(signal - signal[0], float(np.exp(-rate))) for rate in rates]


def previous_input(data: Data) -> FloatArray:
    """The previous input: the present one cannot act yet, and under feedback it depends on the output."""
    return np.concatenate([data.u[:1], data.u[:-1]])


def nonlinear_features(data: Data, fit: Fit) -> FloatArray:
    """Regressors of a black box: filtered inputs and their products, powers of the output and of its slope."""
    states = _filtered_input(data, fit)
    deviation = states[-1]
    z = fit.output
    slope = np.gradient(z)
    slope = slope / (np.std(slope) or 1.0)
    columns = [*states, *(a * b for i, a in enumerate(states) for b in states[i:])]
    columns += [z, z**2, np.clip(z, -4, 4) ** 3]
    columns += [slope, np.abs(slope), np.tanh(3.0 * slope), slope * z, np.abs(slope) * z]
    columns += [np.abs(states[1] - states[0]), np.abs(deviation - states[0]), states[0] ** 3]
    return np.column_stack([np.clip(column, -1e3, 1e3) for column in columns])
