"""Design the next experiment: the input, within the range used so far, that best distinguishes two explanations."""

from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit, minimize
from labsid.gap.record.data import Data

MAX_SAMPLES = 2000
MIN_MARGIN = 6.0  # BIC below which the decision would be random, so that no input is proposed


@dataclass(frozen=True, slots=True, eq=False)
class Experiment:
    """An input to apply to the rig.

    Attributes
    ----------
    separates : tuple of str
        The explanations.
    why : str
    u : ndarray, shape (N,)
        In the record's unit, at its sampling time.
    margin : float
        Expected BIC difference between the two explanations.
    """

    separates: tuple[str, ...]
    why: str
    u: FloatArray
    margin: float


def next_experiment(data: Data, first: Fit, second: Fit, rng: np.random.Generator) -> Experiment | None:
    """Choose the input on which the refitted second explanation differs most from the first.

    Parameters
    ----------
    data : Data
    first, second : Fit
        The two explanations, fitted to the record.
    rng : Generator
        For the random inputs.

    Returns
    -------
    Experiment or None
        None if no candidate input distinguishes the two.
    """
    samples = min(data.samples, MAX_SAMPLES)
    noise = first.noise.sigma2
    best: Experiment | None = None
    for why, u in _inputs(data, samples, first.rates, rng):
        y = first.hypothesis.output(first.theta, first.gains, u)
        if not np.isfinite(y).all() or np.abs(y).max() > 6.0:  # outside the range of the record
            continue
        rows, at = data.planned_readings(samples)
        applied = replace(data, u=u, y=y, rows=rows, at=at)
        point = minimize(applied, second.hypothesis, second.theta, second.gains, iterations=10)
        if point is None:
            continue
        margin = int(applied.rows.sum()) * float(np.log1p(point.cost / noise))
        if best is None or margin > best.margin:
            names = ("+".join(first.hypothesis.names), "+".join(second.hypothesis.names))
            best = Experiment(names, why, np.asarray(data.u_scale.back(u)), margin)
    return best if best is not None and best.margin >= MIN_MARGIN else None


def _inputs(
    data: Data, samples: int, rates: tuple[float, float], rng: np.random.Generator
) -> list[tuple[str, FloatArray]]:
    """Candidate inputs over the range of the record: random levels, two levels, a sweep, a staircase, ramps."""
    low, high = float(data.u.min()), float(data.u.max())
    c, k = rates
    hold = int(np.clip(c / max(k, 1e-9), 3, samples / 12))
    k_axis = np.arange(samples)
    blocks = samples // hold + 1
    levels = np.repeat(rng.uniform(low, high, blocks), hold)[:samples]
    quick = max(hold // 3, 2)
    swift = np.repeat(rng.uniform(low, high, samples // quick + 1), quick)[:samples]
    two = np.where(np.repeat(rng.integers(0, 2, blocks), hold)[:samples] == 1, high, low)
    sweep = np.cumsum(np.geomspace(0.3, 30.0, samples) / (6.0 * hold))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    stairs = np.concatenate([np.linspace(low, high, 8), np.linspace(high, low, 8)])
    staircase = stairs[(k_axis * stairs.size // samples) % stairs.size]
    ramps = middle + half * (2.0 * np.abs(2.0 * ((k_axis / (6.0 * hold)) % 1.0) - 1.0) - 1.0)
    return [
        ("random levels over the whole range, each held for about one time constant", levels),
        ("random levels over the whole range, each held for a third of a time constant", swift),
        ("random switching between the ends of the range", two),
        ("a sine sweep over the whole range", middle + half * np.sin(2.0 * np.pi * sweep)),
        ("a staircase up and down over the whole range", staircase),
        ("ramps up and down over the whole range", ramps),
    ]
