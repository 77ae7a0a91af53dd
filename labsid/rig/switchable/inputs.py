"""Input signals within [-1, 1], from a single step to a multisine."""

from collections.abc import Callable

import numpy as np

from labsid._arrays import FloatArray

INPUT_KINDS = ("step", "staircase", "levels", "two-level", "multisine", "ramps", "square")
RICH_INPUTS = ("levels", "multisine", "ramps")
"""Kinds that visit many levels, each from above and from below."""


def draw_input(rng: np.random.Generator, kind: str, samples: int, time: float, from_rest: bool) -> FloatArray:
    """Draw an input signal.

    Parameters
    ----------
    rng : Generator
    kind : str
        One of `INPUT_KINDS`.
    samples : int
    time : float
        Time scale of the rig in samples; levels are held for about this long.
    from_rest : bool
        Whether to begin with a stretch at 0, the rest level.

    Returns
    -------
    ndarray, shape (samples,)

    Raises
    ------
    ValueError
        If there is no such kind.
    """
    rest = int(rng.integers(12, 13 + min(50, samples // 15))) if from_rest else 0
    n = samples - rest
    hold = float(np.clip(time * np.exp(rng.uniform(np.log(0.5), np.log(2.5))), 5, n / 10))
    if kind == "step":
        moving = np.ones(n) * rng.choice([-1.0, 1.0])
        if not from_rest:
            moving[: n // 8] = 0.0
    elif kind == "staircase":
        moving = _staircase(rng, n, time)
    elif kind == "levels":
        moving = _held(rng, n, hold, lambda m: rng.uniform(-1, 1, m))
    elif kind == "two-level":
        moving = _held(rng, n, hold, lambda m: np.resize([-1.0, 1.0], m))
    elif kind == "square":
        half = max(int(hold * 1.5), 4)
        moving = np.where((np.arange(n) // half) % 2 == 0, 1.0, -1.0)
    elif kind == "ramps":
        knots = np.cumsum(np.maximum(rng.exponential(2 * hold, size=int(n / hold) + 8), 4.0))
        moving = np.interp(np.arange(n), np.concatenate([[0.0], knots]), rng.uniform(-1, 1, knots.size + 1))
    elif kind == "multisine":
        moving = _multisine(rng, n, time)
    else:
        raise ValueError(f"kind must be one of {', '.join(INPUT_KINDS)}; got {kind!r}. Name one of these.")
    v = np.concatenate([np.zeros(rest), moving])
    return v / np.max(np.abs(v))


def _held(rng: np.random.Generator, n: int, hold: float, values: Callable[[int], FloatArray]) -> FloatArray:
    lengths = np.maximum(rng.exponential(hold, size=int(8 * n / hold) + 8), max(2.0, 0.25 * hold)).astype(int)
    lengths = lengths[: int(np.searchsorted(np.cumsum(lengths), n)) + 1]
    return np.repeat(values(lengths.size), lengths)[:n]


def _staircase(rng: np.random.Generator, n: int, time: float) -> FloatArray:
    steps = int(np.clip(n / (rng.uniform(2.5, 5) * time), 4, 9))
    up = np.linspace(-1, 1, steps) + rng.uniform(-0.3, 0.3, steps) / steps
    down = np.linspace(1, -1, steps)[1:] + rng.uniform(-0.3, 0.3, steps - 1) / steps
    levels = np.concatenate([up, down]) if rng.random() < 0.6 else up
    return np.repeat(levels, int(np.ceil(n / levels.size)))[:n]


def _multisine(rng: np.random.Generator, n: int, time: float) -> FloatArray:
    slowest, fastest = 1 / (8 * time), min(1 / (1.2 * time), 0.2)
    count = int(rng.integers(5, 12))
    frequency = np.exp(np.linspace(np.log(max(slowest, 3 / n)), np.log(fastest), count))
    phase = rng.uniform(0, 2 * np.pi, count)
    k = np.arange(n)[:, np.newaxis]
    waves = np.sin(2 * np.pi * frequency * k + phase) / (1 + np.linspace(0, 1, count))
    return np.asarray(waves.sum(axis=1))
