"""Linear responses to the further inputs of a record: part of the structure, no effects that are found."""

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import section
from labsid.gap.effects.base import AdditiveEffect

REACH = 5.0  # of the logarithm of a rate from its start value


@dataclass(frozen=True, slots=True)
class FurtherInput(AdditiveEffect):
    """The response of second-order linear dynamics to one further input, added ahead of the sensor.

    Attributes
    ----------
    name : str
    variant : str
        Name of the input.
    rates : tuple of float
        Coefficients c and k of s^2 + c s + k, in samples, about which they are fitted.
    reference : float
        Operating point: the first sample of the input of the fitted record.
    signal : ndarray, shape (N,)
        The input after its actuator, scaled.
    """

    name: ClassVar[str] = "further-input"
    rates: tuple[float, float] = (0.2, 0.01)
    reference: float = 0.0
    signal: FloatArray = field(default_factory=lambda: np.zeros(1), compare=False, repr=False)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Logarithms of both rates over their start values."""
        return tuple(Parameter(f"log_{rate} {self.variant}", -REACH, REACH) for rate in "ck")

    @property
    def at_load(self) -> bool:
        """Added before the sensor."""
        return True

    @property
    def uses_plant(self) -> bool:
        """It has dynamics of its own."""
        return False

    @property
    def width(self) -> int:
        """Two for the numerator, two for the initial state."""
        return 4

    @property
    def lasting(self) -> bool:
        """It acts in every record."""
        return True

    @property
    def state_columns(self) -> tuple[int, ...]:
        """Those of the initial state."""
        return (2, 3)

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The response, shape (samples, 4); past its end the signal holds its last value."""
        c, k = np.multiply(self.rates, np.exp(own))
        signal = self.signal[:samples]
        if signal.size < samples:
            signal = np.append(signal, np.full(samples - signal.size, signal[-1]))
        return section(float(c), float(k), np.asarray(signal - self.reference, np.float64))


def with_signals(hypothesis: Any, signals: dict[str, FloatArray]) -> Any:
    """A hypothesis whose further inputs have other scaled signals, by their names."""
    changed = tuple(
        replace(effect, signal=signals[effect.variant]) if isinstance(effect, FurtherInput) else effect
        for effect in hypothesis.effects
    )
    return hypothesis.with_effects(changed)
