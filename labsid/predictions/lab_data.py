"""The record of the lab without its offsets, models fitted to it and simulated, and the view that shows them."""

from dataclasses import dataclass

import numpy as np
import scipy.signal

from labsid._arrays import FloatArray, freeze
from labsid.lab.offset import find_offsets, remove_offsets
from labsid.plots.predictions import Curve, View
from labsid.predictions.prediction import Sources

_FIRST_ROW = 5
"""First row of every fit, so that all shifts of the rows use the same equations."""


@dataclass(frozen=True, slots=True, eq=False)
class LabData:
    """A record of the lab without its offsets.

    Attributes
    ----------
    Ts : float
        Sampling time, in s.
    t, u, y : ndarray, shape (N,)
    y_offset : float
    unit : str
        Of the output.
    """

    Ts: float
    t: FloatArray
    u: FloatArray
    y: FloatArray
    y_offset: float
    unit: str = "V"

    def __post_init__(self) -> None:
        freeze(self, t=self.t, u=self.u, y=self.y)

    @property
    def half(self) -> int:
        """Number of samples in the first half, to which models are fitted."""
        return len(self.y) // 2

    @property
    def limits(self) -> tuple[float, float]:
        """Limits of the output in every figure: its range and half of it below and above."""
        low, high = float(self.y.min()), float(self.y.max())
        return low - 0.5 * (high - low), high + 0.5 * (high - low)

    @property
    def ylabel(self) -> str:
        """Label of the output in every figure."""
        return f"Output y ({self.unit})"

    def say(self, value: float) -> str:
        """A size of the output in words, however large."""
        most = 1000 * 10 ** max(0, int(np.log10(np.ptp(self.y))))
        return f"more than {most} {self.unit}" if value > most else f"{value:.2g} {self.unit}"


def read_lab_data(sources: Sources) -> LabData:
    """The record of the lab without its offsets; `ValueError` without a record."""
    record = sources.record
    if record is None:
        raise ValueError("this notebook has no record")
    offsets = find_offsets(record.u, record.y)
    u, y = remove_offsets(record.u, record.y, offsets)
    return LabData(record.Ts, record.t, u, y, offsets.y_offset, record.units[-1] or "V")


def fit(u: FloatArray, y: FloatArray, n: int, shift: int = 0) -> tuple[FloatArray, float]:
    """Least-squares theta = [-a1, ..., -an, b1, ..., bn], and the mean squared error of the fit.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
    n : int
        Order.
    shift : int
        Samples by which the rows of Phi are late against Y.
    """
    k = np.arange(n + _FIRST_ROW, len(y))
    lags = [k - i - shift for i in range(1, n + 1)]
    Phi = np.column_stack([signal[lag] for signal in (y, u) for lag in lags])
    theta = np.asarray(np.linalg.lstsq(Phi, y[k], rcond=None)[0], dtype=np.float64)
    return theta, float(np.mean((y[k] - Phi @ theta) ** 2))


def simulate(theta: FloatArray, u: FloatArray) -> FloatArray:
    """The output of a model from its input alone, from rest."""
    n = len(theta) // 2
    return scipy.signal.lfilter(np.r_[0.0, theta[n:]], np.r_[1.0, -theta[:n]], u)


def rms(error: FloatArray) -> float:
    """Root-mean-square value; infinite where the simulation of an unstable model overflows."""
    with np.errstate(over="ignore", invalid="ignore"):
        found = float(np.sqrt(np.mean(error**2)))
    return found if np.isfinite(found) else np.inf


def output_view(data: LabData, title: str, moved: FloatArray, label: str, said: str, before: FloatArray | None) -> View:
    """The measured output, the model as it was, and what moves with the slider."""
    low, high = data.limits
    shown = np.clip(np.nan_to_num(moved, nan=high, posinf=9 * high, neginf=9 * low), 9 * low, 9 * high)
    curves = [Curve("measured", "Record", data.t, data.y)]
    curves += [] if before is None else [Curve("before", "As fitted", data.t, before)]
    moved_curve = Curve("moved", label, data.t, shown)
    return View(title, (*curves, moved_curve), (low, high), said, ylabel=data.ylabel)
