"""Blocks between the plant and the log: sensor noise, analogue-to-digital converter and noise reduction."""

from collections.abc import Callable
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal
from labsid.rig.seeds import uniform_samples

Block = Callable[[FloatArray, FloatArray], FloatArray]

AVERAGED = 5
"""Length of the rig's moving average in samples."""


def sensor_noise(sd: float, seed: np.random.SeedSequence) -> Block:
    """White Gaussian sensor noise, equal in every run with the same seed.

    Parameters
    ----------
    sd : float
        Standard deviation (V).
    seed : SeedSequence

    Returns
    -------
    callable
        A block for `Rig.sensor`.
    """

    def block(t: FloatArray, volts: FloatArray) -> FloatArray:
        return volts + sd * gaussian_samples(seed, volts.size)

    return block


def gaussian_samples(seed: np.random.SeedSequence, n: int) -> FloatArray:
    """Draw `n` independent normal numbers of standard deviation 1, equal on every platform."""
    quantile = NormalDist().inv_cdf
    return np.array([quantile(p) for p in uniform_samples(seed, n).tolist()])


def converter(bits: int, low: float, high: float) -> Block:
    """Analogue-to-digital converter: round to the nearest code and saturate at the ends of the range.

    Parameters
    ----------
    bits : int
        ``2**bits`` codes divide the range.
    low, high : float
        Range (V); the highest code lies one step below `high`.

    Returns
    -------
    callable
        A block for `Rig.sensor`.

    Raises
    ------
    ValueError
        If the range is empty.
    """
    if not low < high:
        raise ValueError(f"high must be above low; got low = {low:g} and high = {high:g}.")
    step = (high - low) / 2**bits

    def block(t: FloatArray, volts: FloatArray) -> FloatArray:
        return low + step * np.clip(np.rint((volts - low) / step), 0, 2**bits - 1)

    return block


def noise_reduced(measured: ArrayLike, before: ArrayLike) -> FloatArray:
    """Causal moving average over five samples: each sample and the four before it.

    Parameters
    ----------
    measured : array_like, shape (N,)
        The converter's output (V).
    before : array_like, shape (4,)
        The four samples before the log begins, oldest first; zeros if the rig was switched on with the log.

    Returns
    -------
    ndarray, shape (N,)

    Raises
    ------
    ValueError
        If `before` does not hold four samples.
    """
    measured = as_signal("measured", measured)
    before = as_signal("before", before)
    if before.size != AVERAGED - 1:
        raise ValueError(f"before must hold {AVERAGED - 1} samples; got {before.size}.")
    every = np.concatenate([before, measured])
    total = sum(every[lag : lag + measured.size] for lag in range(1, AVERAGED)) + every[: measured.size]
    return total / AVERAGED
