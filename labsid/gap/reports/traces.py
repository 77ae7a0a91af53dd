"""Signals for the figures of a report, reduced to local extremes if the record is long."""

import base64
from typing import Any

import numpy as np

from labsid._arrays import FloatArray

MAX_POINTS = 2400  # samples of a figure


def extreme_samples(signals: list[FloatArray], most: int = MAX_POINTS) -> np.ndarray:
    """Select the samples at which a signal has its minimum or maximum within each part of the record.

    Parameters
    ----------
    signals : list of ndarray, shape (N,)
    most : int
        Largest number of samples.

    Returns
    -------
    ndarray of int
        Increasing; all samples if there are at most `most`.
    """
    samples = signals[0].size
    if samples <= most:
        return np.arange(samples)
    parts = np.array_split(np.arange(samples), max(most // (2 * len(signals)), 1))
    picked = [own[[x[own].argmin(), x[own].argmax()]] for own in parts for x in signals]
    return np.unique(np.concatenate(picked))


def figure_traces(
    t: FloatArray,
    u: FloatArray,
    y: FloatArray,
    before: FloatArray,
    after: FloatArray,
    measured: np.ndarray | None = None,
) -> dict[str, list[Any]]:
    """Reduce the signals to the samples that preserve the output and both errors in a figure.

    Parameters
    ----------
    t, u, y : ndarray, shape (N,)
    before, after : ndarray, shape (N,)
        Outputs of the simulations.
    measured : ndarray of bool, shape (N,), optional
        Samples with an output; by default all.

    Returns
    -------
    dict of list
        The five signals at the same samples; the output is None where there is none.
    """
    pick = extreme_samples([y, y - before, y - after])
    named = {"t": t, "u": u, "y": y, "before": before, "after": after}
    signals = {name: x[pick].tolist() for name, x in named.items()}
    if measured is None:
        return signals
    return signals | {
        "y": [value if there else None for value, there in zip(signals["y"], measured[pick], strict=True)]
    }


def packed(signal: FloatArray, kind: str = "<f4") -> str:
    """A signal in base64, as numbers of 32 bits (``"<f4"``) or 64 (``"<f8"``)."""
    return base64.b64encode(np.asarray(signal, kind).tobytes()).decode("ascii")
