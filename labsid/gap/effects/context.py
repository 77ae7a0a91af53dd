"""What an effect may ask of the record, of the fit it is added to, and of the hypothesis it belongs to.

`Structure` and `ParentFit` are protocols: `labsid.gap.hypothesis.Hypothesis` and `labsid.gap.fitting.Fit` fulfil them,
and are built from effects themselves.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.data import Data
from labsid.gap.plants import Plant

LONG_STEP = 2000  # samples that a step of the input is followed for


class Structure(Protocol):
    """A hypothesis as its effects see it."""

    @property
    def effects(self) -> tuple[Any, ...]:
        """In the order in which they were added."""

    @property
    def delay_is_an_effect(self) -> bool:
        """Whether the delay is one of them, and no nuisance."""

    @property
    def plant(self) -> Plant:
        """The dynamics with everything that the effects put into them."""

    @property
    def slices(self) -> Mapping[str, slice]:
        """Where in theta each part lies: "plant", and each effect by its key."""

    def actuator(self, theta: FloatArray, u: FloatArray) -> FloatArray:
        """The signal that reaches the dynamics, shape (N,)."""

    def output(self, theta: FloatArray, gains: FloatArray, u: FloatArray) -> FloatArray:
        """Free-run output for the input `u`, shape (N,)."""

    def reading(self, theta: FloatArray, gains: FloatArray, level: float) -> float:
        """What the sensor shows where the dynamics stand still at `level`."""

    def gains_of(self, gains: FloatArray, effect: Any) -> FloatArray:
        """The gains of one additive effect among all."""


class ParentFit(Protocol):
    """A fit to which an effect is added."""

    @property
    def hypothesis(self) -> Structure:
        """The effects that it has already."""

    @property
    def theta(self) -> FloatArray:
        """The searched numbers."""

    @property
    def plant_theta(self) -> FloatArray:
        """The plant's part of theta."""

    @property
    def gains(self) -> FloatArray:
        """The projected numbers."""

    @property
    def output(self) -> FloatArray:
        """Free-run output over the whole record, shape (N,)."""

    @property
    def rates(self) -> tuple[float, float]:
        """c and k of the linear dynamics s^2 + c s + k, in samples."""


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """What the effects may look at to choose where their search begins.

    Attributes
    ----------
    data : Data
    parent : ParentFit
        To which they are added.
    highpass : ParentFit or None
        The linear structure fitted to what changes from sample to sample.
    """

    data: Data
    parent: ParentFit
    highpass: ParentFit | None = None

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
    def response_time(self) -> float:
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
    def highpass_rates(self) -> tuple[float, float]:
        """The same from the highpass part of the record: what drifts or jumps has pulled less at them."""
        return (self.highpass or self.parent).rates


def _rise(step: FloatArray) -> float:
    gain = float(step[-1] - step[0])
    return gain if np.isfinite(gain) else 0.0
