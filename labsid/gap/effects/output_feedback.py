"""Feedback of the measured output beside which an unstable rig is simulated: part of the structure, no effect."""

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import InputEffect
from labsid.gap.effects.further_inputs import LAST, MOST_GAIN, extended

GAIN = "actuator gain"
NEAR = 2.0  # largest factor between the fitted poles with the feedback and those it was made for; set by hand


@dataclass(frozen=True, slots=True)
class OutputFeedback(InputEffect):
    """What stabilises a free run: u + C(y - y_sim) drives the dynamics, with C fixed before the search.

    C y_sim turns unstable poles into stable ones, so that the fitted dynamics are those with the feedback, of unit
    gain; `signal` adds C y of the measured output behind the actuator, whose gain is the only parameter. With the gain
    of the dynamics free, an output that follows its measured values alone would need no input.

    Attributes
    ----------
    name : str
    position : int
        In the actuator's chain: behind all effects of the input.
    gains : tuple of float
        Of the output and of its speed per sample, scaled: what they add to the output at rest.
    closed : tuple of float
        c and k of s^2 + c s + k, in samples: the dynamics with the feedback, from which the fitted ones stay near.
        Faster ones would follow the measured output whatever drives them.
    about : float
        Operating point: the first output of the fitted record, scaled.
    signal : ndarray, shape (N,)
        C y of the record.
    """

    name: ClassVar[str] = "output-feedback"
    position: ClassVar[int] = LAST
    gains: tuple[float, float] = (0.0, 0.0)
    closed: tuple[float, float] = (1.0, 1.0)
    about: float = 0.0
    signal: FloatArray = field(default_factory=lambda: np.zeros(1), compare=False, repr=False)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The gain of the actuator, to the output at rest."""
        return (Parameter(GAIN, -MOST_GAIN, MOST_GAIN),)

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """The signal in units of the output."""
        return np.asarray(own[0] * w)

    def extend(self, plant: Plant) -> Plant:
        """Dynamics whose gain is known."""
        return plant.modified(zero=False, stabilised=True)

    def of(self, y: FloatArray) -> FloatArray:
        """C y of a scaled output, shape (N,): its mean over each sample."""
        following = np.append(y[1:], y[-1])
        return np.asarray(self.gains[0] * (0.5 * (y + following) - self.about) + self.gains[1] * (following - y))

    def on(self, y: FloatArray) -> "OutputFeedback":
        """The feedback of another scaled output."""
        return replace(self, signal=self.of(y))

    def added(self, samples: int) -> FloatArray:
        """What is added to the signal of the actuator, shape (samples,); past its end it holds its last value."""
        return extended(self.signal, samples)

    def limited(self, names: list[str], lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Bounds of parameters by name, those of the rates near the dynamics with the feedback."""
        width = np.zeros(len(names)) + np.inf
        about = np.zeros(len(names))
        for name, rate, factor in zip(("log_c", "log_k"), self.closed, (NEAR, NEAR**2), strict=True):
            if name in names:
                at = names.index(name)
                about[at], width[at] = np.log(rate), np.log(factor)
        return np.clip(about - width, lower, upper), np.clip(about + width, lower, upper)
