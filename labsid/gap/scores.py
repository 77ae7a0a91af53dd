"""Score an explanation: the share of the gap that its free run closes on held-out samples, with an interval."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.explanation import Explanation
from labsid.gap.fitting import Fit, refit
from labsid.gap.holdout import held_out_samples
from labsid.gap.model_file import START_SAMPLES, export_model
from labsid.gap.residual_tests import explained_share, nonlinear_features

DRAWS = 400
PERCENTILES = (2.5, 97.5)
RESAMPLED_BLOCKS = 20
SPREAD_FACTOR = 1.2  # widens the interval: few blocks underestimate the spread
MIN_HALF_WIDTH = 0.005  # of the interval of the closed share


@dataclass(frozen=True, slots=True, eq=False)
class GapScore:
    """The gap on held-out samples, in scaled units.

    Attributes
    ----------
    before, after, floor : float
        Rms errors before and after, and rms of the noise.
    closed : float or None
        1 - sqrt(after^2 - floor^2) / sqrt(before^2 - floor^2); None if there is no gap before.
    ci95 : tuple of float or None
        95 % interval of `closed`, from resampled blocks.
    black_box : float or None
        Share closed by a nonlinear regression on past inputs instead of the effects.
    scored : ndarray of bool, shape (N,)
        The samples on which the gap is scored.
    before_fit, after_fit : Fit
        The scored fits of the baseline and of the explanation.
    """

    before: float
    after: float
    floor: float
    closed: float | None
    ci95: tuple[float, float] | None
    black_box: float | None
    scored: np.ndarray
    before_fit: Fit
    after_fit: Fit


def score_explanation(
    explanation: Explanation,
    given: Fit | None,
    holdout: tuple[FloatArray, FloatArray] | None,
    rng: np.random.Generator,
    given_output: FloatArray | None = None,
) -> GapScore:
    """Refit the baseline and the explanation without the held-out samples, and score them there.

    Parameters
    ----------
    explanation : Explanation
    given : Fit or None
        The given simulation, scored without refitting.
    holdout : tuple of ndarray or None
        Input and output of another record, in scaled units; then the whole of this record is fitted.
    rng : Generator
    given_output : ndarray, optional
        Output of the given simulation on the other record, in scaled units.
    """
    data = explanation.data
    if holdout is not None:
        return _score_on_holdout(explanation, given, holdout, rng, given_output)
    blocks = held_out_samples(data.samples, explanation.best.onset)
    fitted = replace(data, rows=data.rows & ~blocks)
    before = refit(fitted, explanation.path[0]) if given is None else given
    after = before if given is None and len(explanation.path) == 1 else refit(fitted, explanation.best)
    return score_fits(fitted, before, after, data.rows & blocks, rng)


def _score_on_holdout(
    explanation: Explanation,
    given: Fit | None,
    holdout: tuple[FloatArray, FloatArray],
    rng: np.random.Generator,
    before_output: FloatArray | None,
) -> GapScore:
    data = explanation.data
    before, after = given or explanation.path[0], explanation.best
    u, y = holdout
    record_u, record_y = np.asarray(data.u_scale.back(u)), np.asarray(data.y_scale.back(y))

    def on_holdout(fit: Fit) -> Fit:
        return replace(fit, output=data.y_scale.of(export_model(data, fit).simulate(record_u, record_y)))

    first = on_holdout(before) if before_output is None else replace(before, output=before_output)
    scored = np.arange(u.size) >= START_SAMPLES
    other = replace(data, u=u, y=y, rows=scored)
    return replace(
        score_fits(other, first, on_holdout(after), scored, rng, floor=noise_power(data, after)),
        before_fit=before,
        after_fit=after,
    )


def closed_share(before: float, after: float, floor: float) -> float | None:
    """Share of the gap that is closed, from mean square errors; None if there is no gap."""
    gap = before - floor
    if gap <= 0.0:
        return None
    return 1.0 - float(np.sqrt(max(after - floor, 0.0) / gap))


def noise_power(data: Data, fit: Fit) -> float:
    """Variance of the noise: that of the residual on the fitted rows, less the part that past inputs predict."""
    e = data.y - fit.output
    count = int(data.rows.sum())
    power = float(e[data.rows] @ e[data.rows]) / max(count - fit.n_free, 1)
    return power * (1.0 - min(max(explained_share(data, fit, e), 0.0), 0.9))


def score_fits(
    data: Data, before: Fit, after: Fit, scored: np.ndarray, rng: np.random.Generator, floor: float | None = None
) -> GapScore:
    """Score two fits on the rows `scored`, which neither was fitted to.

    Parameters
    ----------
    data : Data
        Its rows are those of both fits.
    before, after : Fit
        The baseline and the explanation.
    scored : ndarray of bool, shape (N,)
    rng : Generator
        For the resampling.
    floor : float, optional
        Variance of the noise, if known from other samples.
    """
    e0, e1 = data.y - before.output, data.y - after.output
    floor = noise_power(data, after) if floor is None else floor
    m0, m1 = float(np.mean(e0[scored] ** 2)), float(np.mean(e1[scored] ** 2))
    closed = closed_share(m0, m1, floor)
    if m0 <= floor * 1.02:
        closed = None
    box = black_box_residual(data, before, e0)
    return GapScore(
        before=float(np.sqrt(m0)),
        after=float(np.sqrt(m1)),
        floor=float(np.sqrt(floor)),
        closed=closed,
        ci95=None if closed is None else closure_interval(e0, e1, data.rows, scored, floor, after, rng),
        black_box=None if closed is None else closed_share(m0, float(np.mean(box[scored] ** 2)), floor),
        scored=scored,
        before_fit=before,
        after_fit=after,
    )


def closure_interval(
    e0: FloatArray,
    e1: FloatArray,
    rows: np.ndarray,
    scored: np.ndarray,
    floor: float,
    after: Fit,
    rng: np.random.Generator,
) -> tuple[float, float]:
    """Percentiles of the closed share over resampled blocks of the scored samples; for the floor, of the fitted ones.

    The lower end includes the error of the estimated parameters, which few samples hide in their noise.
    """
    power = np.array([_block_means(e0**2, scored), _block_means(e1**2, scored)])
    fitted = _block_means(e1**2, rows)
    correct = floor / max(float(np.mean(e1[rows] ** 2)), 1e-300)
    inexact = (
        floor * (floor / after.noise.sigma2) * after.n_free / max(int(rows.sum()), 1)
    )  # larger with coloured noise
    low, high = [], []
    for _ in range(DRAWS):
        m0, m1 = _resampled_means(power, rng)
        (noise,) = _resampled_means(fitted[None], rng) * correct
        if m0 > noise:
            wrong = inexact * rng.chisquare(after.n_free) / after.n_free
            high.append(1.0 - np.sqrt(max(m1 - noise, 0.0) / (m0 - noise)))
            low.append(1.0 - np.sqrt(max(m1 - noise, wrong) / (m0 - noise)))
    if not low:
        return (0.0, 1.0)
    ends = (
        float(np.percentile(low, PERCENTILES[0])) - MIN_HALF_WIDTH,
        float(np.percentile(high, PERCENTILES[1])) + MIN_HALF_WIDTH,
    )
    return ends[0], min(ends[1], 1.0)


def _resampled_means(blocks: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Mean of each row over the same blocks, drawn with replacement."""
    mean = blocks.mean(axis=1)
    drawn = blocks[:, rng.integers(0, blocks.shape[1], blocks.shape[1])].mean(axis=1)
    return np.asarray(mean + SPREAD_FACTOR * (drawn - mean))


def _block_means(power: FloatArray, rows: np.ndarray) -> FloatArray:
    values = power[rows]
    length = max(values.size // RESAMPLED_BLOCKS, 5)
    return np.array([block.mean() for block in np.array_split(values, max(values.size // length, 2))])


def black_box_residual(data: Data, before: Fit, e: FloatArray) -> FloatArray:
    """Residual of a nonlinear regression of the baseline's error on past inputs."""
    X = nonlinear_features(data, before)
    X = np.column_stack([np.ones(e.size), (X - X.mean(axis=0)) / np.where(X.std(axis=0) > 0, X.std(axis=0), 1.0)])
    rows = data.rows
    gram = X[rows].T @ X[rows] + 1e-3 * rows.sum() * np.eye(X.shape[1])
    return e - X @ np.linalg.solve(gram, X[rows].T @ e[rows])
