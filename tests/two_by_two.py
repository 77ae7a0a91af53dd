"""Two inputs and two outputs, each output moved by both inputs through two lags."""

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from labsid.records.record import Record

TS = 0.5  # s
NOISE = 0.01  # of the standard deviation of each output
LAGS = (((9.0, 4.0, 1.0), (25.0, 10.0, 0.5)), ((30.0, 12.0, 0.4), (12.0, 3.0, 1.3)))  # samples, samples, gain


def random_steps(rng: np.random.Generator, samples: int) -> np.ndarray:
    """Steps of random size and length."""
    lengths = rng.integers(8, 60, samples // 8)
    return np.repeat(rng.uniform(-1.0, 1.0, lengths.size), lengths)[:samples]


def lagged(u: np.ndarray, first: float, second: float, gain: float) -> np.ndarray:
    """Response of two lags in series to a held input."""
    for tau in (first, second):
        pole = np.exp(-1.0 / tau)
        u = lfilter([0.0, 1.0 - pole], [1.0, -pole], u)
    return gain * u


def two_by_two(
    seed: int = 0,
    samples: int = 700,
    at_inputs: Callable[[np.ndarray], np.ndarray] = lambda u: u,
    at_outputs: Callable[[np.ndarray], np.ndarray] = lambda y: y,
) -> Record:
    """A record with effects at the inputs, shape (N, 2), or the outputs, shape (N, 2)."""
    rng = np.random.default_rng(seed)
    u = np.column_stack([random_steps(rng, samples) for _ in range(2)])
    w = at_inputs(u.copy())
    y = at_outputs(np.column_stack([sum(lagged(w[:, i], *LAGS[j][i]) for i in range(2)) for j in range(2)]))
    y = y + NOISE * y.std(axis=0) * rng.standard_normal(y.shape)
    return Record(TS * np.arange(samples), u, y, TS, name="pair", units=("V", "%", "cm", "°C"))


def dead_zone_at_second(u: np.ndarray) -> np.ndarray:
    """The second actuator does not move within 0.25."""
    u[:, 1] = np.sign(u[:, 1]) * np.maximum(np.abs(u[:, 1]) - 0.25, 0.0)
    return u
