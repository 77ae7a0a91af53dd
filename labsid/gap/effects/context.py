"""The record and the parent fit from which effects choose their start values.

The protocols `Structure` and `ParentFit` are implemented by `labsid.gap.fits.hypothesis.Hypothesis` and
`labsid.gap.fits.fitting.Fit`, which in turn import the effects.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import comes_to_rest
from labsid.gap.record.data import Data

LOOP_GAINS = (0.15, 3.0)  # in the units of the record, of an output that follows its command under gravity; set by hand
LEAST_FOLLOWED = 0.25  # range of such an output over that of its command; set by hand
LEAST_NEAR = 0.5  # correlation of an output with its command; set by hand
LONG_STEP = 2000  # samples of a simulated step response; numerics


class Structure(Protocol):
    """Interface of a hypothesis to its effects."""

    @property
    def effects(self) -> tuple[Any, ...]:
        """In the order in which they were added."""

    @property
    def found(self) -> tuple[Any, ...]:
        """Those beyond the ones of the simulation under test."""

    @property
    def inputs(self) -> tuple[Any, ...]:
        """Input effects in the order of the actuator's chain."""

    @property
    def outputs(self) -> tuple[Any, ...]:
        """Output effects in the order of the sensor's chain."""

    @property
    def delay_is_an_effect(self) -> bool:
        """Whether the delay is an effect rather than a nuisance parameter."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters in theta."""

    @property
    def plant(self) -> Plant:
        """The dynamics with all plant effects."""

    @property
    def slices(self) -> Mapping[str, slice]:
        """Slice of theta of the "plant", and of each effect by its key."""

    @property
    def feedback(self) -> Any:
        """What stabilises the simulation of an unstable rig; None for others."""

    def actuator(self, theta: FloatArray, u: FloatArray) -> FloatArray:
        """The signal that reaches the dynamics, shape (N,)."""

    def driven(self, theta: FloatArray, u: FloatArray) -> FloatArray:
        """The same with the feedback of an unstable rig, shape (N,)."""

    def output(self, theta: FloatArray, gains: FloatArray, u: FloatArray) -> FloatArray:
        """Free-run output for the input `u`, shape (N,)."""

    def reading(self, theta: FloatArray, gains: FloatArray, level: float) -> float:
        """Sensor reading at the steady state `level`."""

    def gains_of(self, gains: FloatArray, effect: Any) -> FloatArray:
        """Gains of one additive effect."""


class ParentFit(Protocol):
    """A fit to which an effect is added."""

    @property
    def hypothesis(self) -> Structure:
        """The hypothesis without the new effect."""

    @property
    def theta(self) -> FloatArray:
        """Nonlinear parameters."""

    @property
    def plant_theta(self) -> FloatArray:
        """The plant's part of theta."""

    @property
    def gains(self) -> FloatArray:
        """Linear parameters."""

    @property
    def output(self) -> FloatArray:
        """Free-run output over the whole record, shape (N,)."""

    @property
    def rates(self) -> tuple[float, float]:
        """Coefficients c and k of the linear dynamics s^2 + c s + k, in samples."""


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """The record and the fits from which effects choose their start values.

    Attributes
    ----------
    data : Data
    parent : ParentFit
        The fit to which an effect is added.
    highpass : ParentFit or None
        A linear fit to the high-pass filtered record.
    """

    data: Data
    parent: ParentFit
    highpass: ParentFit | None = None

    @property
    def of_first_output(self) -> "Context":
        """That of the first of several outputs of one simulation; of a single one itself."""
        data = self.data.first_output
        if data is self.data:
            return self
        return Context(
            data,
            _shortened(self.parent, data.samples),
            None if self.highpass is None else _shortened(self.highpass, data.samples),
        )

    @property
    def residual(self) -> FloatArray:
        """Residual of the parent, zero on the rows that do not count."""
        return np.where(self.data.rows, self.data.y - self.parent.output, 0.0)

    @property
    def actuator(self) -> FloatArray:
        """The signal that reaches the parent's dynamics."""
        return self.parent.hypothesis.driven(self.parent.theta, self.data.u)

    @property
    def levels(self) -> FloatArray:
        """Distinct values of the input, ascending."""
        return np.unique(np.round(self.data.u, 9))

    @property
    def rates(self) -> tuple[float, float]:
        """c and k of the parent's linear dynamics."""
        return self.parent.rates

    @property
    def gain(self) -> float:
        """Static gain of the parent; zero if it is not finite."""
        return rise(self.step)

    @property
    def follows(self) -> bool:
        """Whether the output may be the quantity that the input commands, in its unit, as in a position loop."""
        if self.parent.hypothesis.plant.kind == "given":  # a simulated output answers no other input
            return False
        per_unit = self.data.y_scale.unit / self.data.u_scale.unit
        if np.ptp(self.data.y[self.data.rows]) * per_unit <= LEAST_FOLLOWED * np.ptp(self.data.u):
            return False
        if not comes_to_rest(*self.rates, self.data.longest):  # a loop at its limit seems to integrate
            return self._is_near_input
        step = self.step
        gain = float(step[LONG_STEP // 2 :].mean() - step[0]) * per_unit  # the mean, for it may not be damped
        return LOOP_GAINS[0] < gain < LOOP_GAINS[1]

    @property
    def _is_near_input(self) -> bool:
        """Whether the output is where its command is, as that of an integrator is not."""
        rows = self.data.rows
        return float(np.corrcoef(self.data.u[rows], self.data.y[rows])[0, 1]) > LEAST_NEAR

    @property
    def response_time(self) -> float:
        """Mean delay in samples of the parent's step response; zero without static gain."""
        step = self.step
        gain = rise(step)
        return max(float(np.sum((step[-1] - step[1:]) / gain)) - 0.5, 0.0) if gain else 0.0

    @property
    def step(self) -> FloatArray:
        """Response of the parent to a unit step, from one sample before it on."""
        return unit_step_response(self.parent.hypothesis, self.parent.theta, self.parent.gains, LONG_STEP)

    @property
    def highpass_rates(self) -> tuple[float, float]:
        """c and k of the high-pass fit, which drifts and jumps bias less."""
        return (self.highpass or self.parent).rates


def _shortened(fit: ParentFit, samples: int) -> ParentFit:
    """A fit with the first samples of its output."""
    shorter: ParentFit = replace(fit, output=fit.output[:samples])  # type: ignore[type-var]
    return shorter


def unit_step_response(hypothesis: Structure, theta: FloatArray, gains: FloatArray, samples: int) -> FloatArray:
    """Response to a unit step from rest, from one sample before the step on, without loads and drifts."""
    step = np.repeat((0.0, 1.0), samples)
    outputs = [hypothesis.output(theta, gains, u) for u in (step, np.zeros_like(step))]
    return np.asarray(outputs[0] - outputs[1])[samples - 1 :]  # the difference cancels loads and drifts


def rise(step: FloatArray) -> float:
    """Static gain from a step response; zero if it is not finite."""
    gain = float(step[-1] - step[0])
    return gain if np.isfinite(gain) else 0.0
