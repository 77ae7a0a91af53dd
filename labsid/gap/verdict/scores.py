"""Score an explanation: the share of the gap that its free run closes on held-out samples, with an interval."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.residual_tests import explained_share
from labsid.gap.record.data import Data
from labsid.gap.verdict.held_out_errors import PARTS, HeldOut

DRAWS = 400  # resamplings of the blocks; numerics
PERCENTILES = (2.5, 97.5)  # of the resampled closed shares; statistics: ends of a 95 % interval
RESAMPLED_BLOCKS = 20  # of the scored samples; set by hand
SPREAD_FACTOR = 1.2  # widens the interval: few blocks underestimate the spread; set by hand
NO_GAP_MEAN_SQUARE = 1.02  # mean square error over that of the noise, up to which there is no gap to close; set by hand
NO_GAP_RMS = 1.1  # rms error over that of the noise, up to which an error is said to be noise; set by hand
CERTAIN = 4.0  # standard errors of the mean square of the noise, by which the error there must exceed it; set by hand
CORRELATION_TIMES = 4.0  # of the noise, in a block whose mean square is taken for independent; set by hand
LEAST_BLOCKS = 4  # whose mean squares give the spread of the noise, and samples in each; set by hand
MIN_HALF_WIDTH = 0.005  # of the interval of the closed share; set by hand


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
    scored : ndarray of bool, shape (N,)
        The samples on which the gap is scored.
    outputs : tuple of ndarray
        Outputs before and after on the record with these samples.
    after_fit : Fit
        The scored fit of the explanation.
    """

    before: float
    after: float
    floor: float
    closed: float | None
    ci95: tuple[float, float] | None
    scored: np.ndarray
    outputs: tuple[FloatArray, FloatArray]
    after_fit: Fit


def score_fits(held_out: HeldOut, before: FloatArray, after: Fit, rng: np.random.Generator) -> GapScore:
    """Score two simulations on the held-out samples, which neither was fitted to.

    Parameters
    ----------
    held_out : HeldOut
    before : ndarray
        Output of the simulation before on the record with these samples, in scaled units.
    after : Fit
        The explanation.
    rng : Generator
        For the resampling.
    """
    data, scored = held_out.data, held_out.scored
    last = held_out.output(after)
    e0, e1 = held_out.measured - before, held_out.measured - last
    fitted = (data.y - after.output)[data.rows]
    floor = noise_power(data, after)
    m0, m1 = float(np.mean(e0[scored] ** 2)), float(np.mean(e1[scored] ** 2))
    closed = None if m0 <= NO_GAP_MEAN_SQUARE * floor else closed_share(m0, m1, floor)
    return GapScore(
        before=float(np.sqrt(m0)),
        after=float(np.sqrt(m1)),
        floor=float(np.sqrt(floor)),
        closed=closed,
        ci95=None if closed is None else _closure_interval(e0[scored], e1[scored], fitted, floor, after, rng),
        scored=scored,
        outputs=(before, last),
        after_fit=after,
    )


@dataclass(frozen=True, slots=True)
class ErrorElsewhere:
    """Error of a simulation on another record, where the record that it was fitted to shows no gap.

    Attributes
    ----------
    error, noise : float
        Mean squares, scaled.
    limit : float
        The largest mean square that is no gap: `NO_GAP_RMS` of the noise, or `CERTAIN` standard errors above it.
    """

    error: float
    noise: float
    limit: float

    @property
    def is_gap(self) -> bool:
        """Whether the error is more than noise."""
        return self.error > self.limit


def error_elsewhere(held_out: HeldOut, before: FloatArray, fit: Fit) -> ErrorElsewhere:
    """Compare the error of a simulation on another record with noise, where the record shows no gap.

    The mean squares of the noise in blocks of the record say how far that of another record may differ by chance.

    Parameters
    ----------
    held_out : HeldOut
    before : ndarray
        Output of the simulation on the other record, in scaled units.
    fit : Fit
        To the record, of which it leaves nothing but noise.
    """
    data, scored = held_out.data, int(held_out.scored.sum())
    e = (data.y - fit.output)[data.rows]
    length = max(min(scored, e.size) // PARTS, CORRELATION_TIMES * fit.noise.correlation_time, LEAST_BLOCKS)
    blocks = np.array_split(e**2, max(int(e.size / length), LEAST_BLOCKS))
    power = np.array([block.mean() for block in blocks])
    noise = max(held_out.expected(fit) or 0.0, noise_power(data, fit))
    error = float(np.mean((held_out.measured - before)[held_out.scored] ** 2))
    spread = float(np.std(power, ddof=1)) * np.sqrt(1.0 / power.size + e.size / power.size / scored)
    return ErrorElsewhere(error, noise, float(max(NO_GAP_RMS**2 * noise, noise + CERTAIN * spread)))


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


def _closure_interval(
    e0: FloatArray, e1: FloatArray, fitted: FloatArray, floor: float, after: Fit, rng: np.random.Generator
) -> tuple[float, float]:
    """Percentiles of the closed share over resampled blocks of the scored samples; for the floor, of the fitted ones.

    The lower end includes the error of the estimated parameters, which few samples hide in their noise.
    """
    power = np.array([_block_means(e0**2), _block_means(e1**2)])
    noise_blocks = _block_means(fitted**2)
    correct = floor / max(float(np.mean(fitted**2)), 1e-300)
    inexact = floor * (floor / after.noise.sigma2) * after.n_free / max(fitted.size, 1)  # larger with coloured noise
    low, high = [], []
    for _ in range(DRAWS):
        m0, m1 = resampled_means(power, _drawn(power, rng))
        (noise,) = resampled_means(noise_blocks[None], _drawn(noise_blocks[None], rng)) * correct
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


def resampled_means(blocks: FloatArray, drawn: np.ndarray) -> FloatArray:
    """Mean of each row over the same drawn blocks, with the spread that few blocks underestimate.

    Parameters
    ----------
    blocks : ndarray, shape (r, n)
    drawn : ndarray of int, shape (n,) or (m, n)
        Columns, drawn with replacement; once or m times.

    Returns
    -------
    ndarray, shape (r,) or (r, m)
    """
    mean, again = blocks.mean(axis=1), blocks[:, drawn].mean(axis=-1).T
    return np.asarray((mean + SPREAD_FACTOR * (again - mean)).T)


def _drawn(blocks: FloatArray, rng: np.random.Generator) -> np.ndarray:
    return np.asarray(rng.integers(0, blocks.shape[1], blocks.shape[1]))


def _block_means(values: FloatArray) -> FloatArray:
    length = max(values.size // RESAMPLED_BLOCKS, 5)
    return np.array([block.mean() for block in np.array_split(values, max(values.size // length, 2))])
