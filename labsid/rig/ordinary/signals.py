"""Inputs that people apply to rigs: multisine, chirp, a few steps, ramps, binary and random levels."""

from collections.abc import Callable

import numpy as np
from scipy.signal import chirp, max_len_seq

from labsid._arrays import FloatArray

MOVING = ("multisine", "chirp", "ramps")
"""Signals that differ from sample to sample."""

MANY_LEVELS = (*MOVING, "levels")
"""Signals that visit many levels."""

SIGNALS = (*MANY_LEVELS, "steps", "prbs")


def draw_signal(rng: np.random.Generator, kind: str, samples: int, time: float) -> FloatArray:
    """Draw a signal within [-1, 1].

    Parameters
    ----------
    rng : Generator
    kind : str
        One of `SIGNALS`.
    samples : int
    time : float
        Slowest time constant of the rig in samples.

    Returns
    -------
    ndarray, shape (samples,)
    """
    signal = _DRAWS[kind](rng, samples, time)
    return signal / np.max(np.abs(signal))


def _multisine(rng: np.random.Generator, samples: int, time: float) -> FloatArray:
    fastest = min(0.4, rng.uniform(0.3, 1.5) / time)
    frequencies = np.linspace(2.0 / samples, fastest, int(rng.integers(6, 25)))
    phases = rng.uniform(0.0, 2.0 * np.pi, frequencies.size)
    k = np.arange(samples)[:, np.newaxis]
    return np.asarray(np.cos(2.0 * np.pi * frequencies * k + phases).sum(axis=1))


def _chirp(rng: np.random.Generator, samples: int, time: float) -> FloatArray:
    first = rng.uniform(0.5, 3.0) / samples
    last = min(0.35, rng.uniform(0.3, 2.0) / time)
    method = str(rng.choice(["linear", "logarithmic"]))
    return np.asarray(chirp(np.arange(samples), first, samples, last, method, phi=float(rng.uniform(0.0, 360.0))))


def _ramps(rng: np.random.Generator, samples: int, time: float) -> FloatArray:
    knots = np.concatenate([[0.0], np.cumsum(rng.uniform(1.0, 4.0, samples) * max(time, 4.0))])
    levels = rng.uniform(-1.0, 1.0, knots.size)
    return np.interp(np.arange(samples), knots, levels)


def _held(rng: np.random.Generator, samples: int, hold: float, levels: FloatArray) -> FloatArray:
    """Levels that are held for 0.4 to 1.6 times `hold` samples each, in order and again from the first."""
    lengths = np.maximum(rng.uniform(0.4, 1.6, samples) * hold, 1.0).astype(int)
    count = int(np.searchsorted(np.cumsum(lengths), samples)) + 1
    return np.repeat(np.resize(levels, count), lengths[:count])[:samples]


def _levels(rng: np.random.Generator, samples: int, time: float) -> FloatArray:
    hold = float(np.clip(rng.uniform(0.7, 3.0) * time, 3.0, samples / 15))
    return _held(rng, samples, hold, rng.uniform(-1.0, 1.0, samples))


def _steps(rng: np.random.Generator, samples: int, time: float) -> FloatArray:
    count = int(rng.integers(3, 9))
    levels = rng.uniform(0.3, 1.0, count) * np.resize([1.0, -1.0], count) * rng.choice([-1.0, 1.0])
    return np.repeat(levels, -(-samples // count))[:samples]


def _prbs(rng: np.random.Generator, samples: int, time: float) -> FloatArray:
    hold = max(1, round(rng.uniform(0.15, 1.0) * time))
    bits = int(rng.integers(6, 11))
    start = np.array([1, *rng.integers(0, 2, bits - 1)])
    sequence = max_len_seq(bits, state=start, length=-(-samples // hold))[0]
    return np.repeat(2.0 * sequence - 1.0, hold)[:samples]


_DRAWS: dict[str, Callable[[np.random.Generator, int, float], FloatArray]] = {
    "multisine": _multisine,
    "chirp": _chirp,
    "ramps": _ramps,
    "levels": _levels,
    "steps": _steps,
    "prbs": _prbs,
}
