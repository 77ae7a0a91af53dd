"""Linear responses to the further inputs of a record: part of the structure, no effects that are found."""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray, beside
from labsid.gap.dynamics import _kernels
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import section
from labsid.gap.effects.base import AdditiveEffect, InputEffect

LAST = 99  # position in the actuator's chain; definition
MOST_GAIN = 50.0  # of a further input over that of the first one, scaled; set by hand
SLOWEST_WAY = 0.998  # zero or pole, in z, of the way of a further input to the dynamics of the first one; set by hand
REACH = 5.0  # of the logarithm of a rate from its start value; set by hand


@dataclass(frozen=True, slots=True)
class FurtherInput(AdditiveEffect):
    """The response of linear dynamics to one further input, its `variant`, added ahead of the sensor.

    Attributes
    ----------
    name : str
    about : tuple of float
        Coefficients c and k of s^2 + c s + k, in samples, about which they are fitted.
    reference : float
        Operating point: the first sample of the input of the fitted record.
    shared : bool
        Whether its dynamics have the poles of those of the first input, a mode included.
    signal : ndarray, shape (N,)
        The input after its actuator, scaled.
    """

    name: ClassVar[str] = "further-input"
    about: tuple[float, float] = (0.2, 0.01)
    reference: float = 0.0
    shared: bool = False
    signal: FloatArray = field(default_factory=lambda: np.zeros(1), compare=False, repr=False)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Logarithms of both rates over their start values, of dynamics of its own."""
        if self.shared:
            return ()
        return tuple(Parameter(f"log_{rate} {self.variant}", -REACH, REACH) for rate in "ck")

    @property
    def at_load(self) -> bool:
        """Added before the sensor."""
        return True

    @property
    def uses_plant(self) -> bool:
        """Of shared poles."""
        return self.shared

    @property
    def width(self) -> int:
        """Two for the numerator and two for the initial state; of shared poles, two numerators."""
        return 4

    @property
    def lasting(self) -> bool:
        """It acts in every record."""
        return True

    @property
    def state_columns(self) -> tuple[int, ...]:
        """Those of an initial state; that of shared poles belongs to the first input."""
        return () if self.shared else (2, 3)

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The response, shape (samples, width); past its end the signal holds its last value."""
        w = np.asarray(extended(self.signal, samples) - self.reference, np.float64)
        if not self.shared:
            c, k = np.multiply(self.about, np.exp(own))
            return section(float(c), float(k), w)
        pairs = [plant.linear_rates(rates)]
        if plant.mode:
            frequency, damping = (float(np.exp(rates[plant.index(f"log_{name}")])) for name in ("frequency", "damping"))
            pairs.append((2.0 * damping * frequency, frequency**2))
        return beside([section(c, k, w)[:, :2].copy() for c, k in pairs])


@dataclass(frozen=True, slots=True)
class SameEntry(InputEffect):
    """A further input, its `variant`, that acts on the same dynamics as the first one, as two flows into one tank.

    The dynamics see the sum of both; a lead lets it act behind their first state, a lag has it arrive later.

    Attributes
    ----------
    name : str
    position : int
        In the actuator's chain: behind all effects of the first input.
    reference : float
        Operating point: the first sample of the input of the fitted record.
    signal : ndarray, shape (N,)
        The input after its actuator, scaled.
    """

    name: ClassVar[str] = "same-entry"
    position: ClassVar[int] = LAST
    reference: float = 0.0
    signal: FloatArray = field(default_factory=lambda: np.zeros(1), compare=False, repr=False)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Gain over that of the first input, zero and pole of the way to it, and samples by which it is ahead."""
        return (
            Parameter(f"gain {self.variant}", -MOST_GAIN, MOST_GAIN),
            Parameter(f"lead {self.variant}", 0.0, SLOWEST_WAY, 1e-3),
            Parameter(f"lag {self.variant}", 0.0, SLOWEST_WAY, 1e-3),
            Parameter(f"ahead {self.variant}", 0.0, 1.0, 1e-2),
        )

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Add the input."""
        gain, lead, lag, ahead = own
        signal = extended(self.signal, w.size) - self.reference
        if ahead:
            signal = (1.0 - ahead) * signal + ahead * np.append(signal[1:], signal[-1])
        if lead:
            signal = (signal - lead * np.append(0.0, signal[:-1])) / (1.0 - lead)
        if lag:
            signal = _kernels.first_order(np.append(signal, 0.0), float(lag))[1:]
        return np.asarray(w + gain * signal)


def extended(signal: FloatArray, samples: int) -> FloatArray:
    """The first samples of a signal; past its end it holds its last value."""
    if signal.size >= samples:
        return signal[:samples]
    return np.append(signal, np.full(samples - signal.size, signal[-1]))
