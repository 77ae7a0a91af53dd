"""Two heaters beside each other, each with a thermometer, and their log for the assignment ``several-signals``."""

from os import PathLike
from pathlib import Path

import numpy as np
import scipy.signal

from labsid._arrays import FloatArray

TS = 8.0
"""Sampling time in seconds."""
SAMPLES = 600
CHANGES = (
    ((0, 40), (40, 60), (150, 30), (180, 46), (240, 20), (340, 52), (430, 24), (510, 60)),
    ((0, 40), (100, 60), (130, 36), (210, 20), (270, 56), (300, 48), (380, 28), (470, 60), (555, 36)),
)
"""For each heater the samples at which its power changes, and the power from then on in per cent."""
TEMPERATURES = (45.0, 42.0)
"""At the powers of sample 0, in degrees Celsius."""
GAINS = (0.7, 0.55)
"""Rise of each heater alone, if it exchanged no heat with the other one, in degrees Celsius per per cent."""
EXCHANGE = 0.6
"""Heat exchanged between the heaters over the heat that one loses, at equal differences of temperature."""
HEATERS, THERMOMETERS = (160.0, 130.0), (16.0, 12.0)
"""Time constants in seconds, of the size of a temperature control lab on a desk."""
NOISE = 0.004
"""Standard deviation of the noise in degrees Celsius."""
DIGITS = 3
"""Decimals of the temperatures in the log."""
HEADER = "time,Q1,T1,Q2,T2"


def write_heater_log(path: str | PathLike[str]) -> None:
    """Write the log: times in seconds, and for each heater its power Q (%) and its temperature T (degrees Celsius).

    Parameters
    ----------
    path : path
        A text file with the header ``time,Q1,T1,Q2,T2``.
    """
    u, y = heater_signals()
    rows = zip(TS * np.arange(SAMPLES), u[:, 0], y[:, 0], u[:, 1], y[:, 1], strict=True)
    lines = [f"{t:g},{Q1:g},{T1:.{DIGITS}f},{Q2:g},{T2:.{DIGITS}f}" for t, Q1, T1, Q2, T2 in rows]
    Path(path).write_text("\n".join([HEADER, *lines, ""]), encoding="utf-8")


def heater_signals() -> tuple[FloatArray, FloatArray]:
    """Powers and temperatures as the log has them; equal for everybody.

    Returns
    -------
    u : ndarray, shape (N, 2)
        Powers in per cent.
    y : ndarray, shape (N, 2)
        Temperatures in degrees Celsius.
    """
    u = np.column_stack([_held(changes) for changes in CHANGES])
    # States: deviations of both heaters and both thermometers from the rest.
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    for i, j in ((0, 1), (1, 0)):
        A[i, i], A[i, j] = -(1 + EXCHANGE) / HEATERS[i], EXCHANGE / HEATERS[i]
        A[2 + i, i], A[2 + i, 2 + i] = 1 / THERMOMETERS[i], -1 / THERMOMETERS[i]
        B[i, i] = GAINS[i] / HEATERS[i]
    rig = scipy.signal.StateSpace(A, B, np.eye(4)[2:], np.zeros((2, 2))).to_discrete(TS)
    _, rise, _ = scipy.signal.dlsim(rig, u - u[0])
    noise = NOISE * np.random.default_rng(1).standard_normal(rise.shape)
    return u, np.round(TEMPERATURES + rise + noise, DIGITS)


def _held(changes: tuple[tuple[int, int], ...]) -> FloatArray:
    starts, levels = np.array(changes, np.float64).T
    return levels[np.searchsorted(starts, np.arange(SAMPLES), side="right") - 1]
