"""The record as the search sees it: scaled, counted in samples, with the rows that the fits may use."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.noise import lags_for, whole_rows

if TYPE_CHECKING:
    from labsid.gap.fitting import Fit


LONG_STEP = 2000  # samples that a step of the input is followed for


@dataclass(frozen=True, slots=True)
class Scale:
    """From the record's units to the search's: value = centre + unit * scaled.

    Attributes
    ----------
    centre, unit : float
        In the record's unit.
    """

    centre: float
    unit: float

    def of(self, values: FloatArray) -> FloatArray:
        """Into scaled units."""
        return (values - self.centre) / self.unit

    def back(self, scaled: FloatArray | float) -> FloatArray | float:
        """Into the record's unit."""
        return self.centre + self.unit * scaled


@dataclass(frozen=True, slots=True, eq=False)
class Data:
    """Scaled signals and the rows that count.

    Attributes
    ----------
    u, y : ndarray, shape (N,)
        Scaled input and output.
    rows : ndarray of bool, shape (N,)
        Samples that the cost counts.
    Ts : float
        Sampling time in seconds.
    u_scale, y_scale : Scale
        Back to the record's units.
    start : float
        Time of the first sample in seconds.
    by_free_run : bool
        Whether the score of a fit also counts its free-run error: where the innovations say too little about it.
    lattice : float
        Converter step in the scaled output; zero where there is none.
    lags : int
        The longest autoregression that the noise may have.
    sound : ndarray of bool, shape (N,)
        Rows that count together with so many before them.
    """

    u: FloatArray
    y: FloatArray
    rows: np.ndarray
    Ts: float
    u_scale: Scale
    y_scale: Scale
    start: float = 0.0
    by_free_run: bool = False
    lattice: float = 0.0
    lags: int = field(init=False, repr=False)
    sound: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lags", lags_for(self.rows))
        object.__setattr__(self, "sound", whole_rows(self.rows, self.lags))

    @property
    def samples(self) -> int:
        """N."""
        return int(self.u.size)


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """What the effects may look at to choose where their search begins.

    Attributes
    ----------
    data : Data
    parent : Fit
        To which they are added.
    swift : Fit or None
        The linear structure fitted to what changes from sample to sample.
    """

    data: Data
    parent: "Fit"
    swift: "Fit | None" = None

    @property
    def residual(self) -> FloatArray:
        """What the parent leaves, zero on the rows that do not count."""
        return np.where(self.data.rows, self.data.y - self.parent.output, 0.0)

    @property
    def actuator(self) -> FloatArray:
        """The signal that reaches the parent's dynamics."""
        return self.parent.hypothesis.actuator(self.parent.theta, self.data.u)

    @property
    def levels(self) -> FloatArray:
        """The different values of the input, ascending."""
        return np.unique(np.round(self.data.u, 9))

    @property
    def rates(self) -> tuple[float, float]:
        """c and k of the parent's linear dynamics."""
        return self.parent.rates

    @property
    def gain(self) -> float:
        """Change of the parent's output, long after a step of the input by one; zero where there is none."""
        return _rise(self._step)

    @property
    def settling(self) -> float:
        """Mean time in samples in which the parent's output follows a step of the input; zero where it does not."""
        step = self._step
        gain = _rise(step)
        return max(float(np.sum((step[-1] - step[1:]) / gain)) - 0.5, 0.0) if gain else 0.0

    @property
    def _step(self) -> FloatArray:
        fit, step = self.parent, np.repeat((0.0, 1.0), LONG_STEP)
        outputs = [fit.hypothesis.output(fit.theta, fit.gains, u) for u in (step, np.zeros_like(step))]
        return np.asarray(outputs[0] - outputs[1])[LONG_STEP - 1 :]  # without loads, drifts and waves

    @property
    def swift_rates(self) -> tuple[float, float]:
        """The same from the swift part of the record: what drifts or jumps has pulled less at them."""
        return (self.swift or self.parent).rates


def _rise(step: FloatArray) -> float:
    gain = float(step[-1] - step[0])
    return gain if np.isfinite(gain) else 0.0


def scaled(
    u: FloatArray,
    y: FloatArray,
    rows: np.ndarray,
    Ts: float,
    start: float = 0.0,
    scales: tuple[Scale, Scale] | None = None,
) -> Data:
    """Centre both signals and divide them by their spread.

    Parameters
    ----------
    u, y : ndarray, shape (N,)
        Input and output in the record's units; neither is constant.
    rows : ndarray of bool, shape (N,)
        Samples that the cost counts.
    Ts : float
        Sampling time in seconds.
    start : float
        Time of the first sample in seconds.
    scales : tuple of Scale, optional
        Those of input and output that a simulation counts in, in the place of the record's own.

    Returns
    -------
    Data
    """
    own = Scale(float(np.mean(u)), float(np.std(u))), Scale(float(np.mean(y)), float(np.std(y)))
    u_scale, y_scale = scales or own
    return Data(u_scale.of(u), y_scale.of(y), rows, Ts, u_scale, y_scale, start)
