"""The zeros of the sensors of several outputs, beside that of the first one."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import AdditiveEffect


@dataclass(frozen=True, slots=True)
class SensorZeros(AdditiveEffect):
    """A constant for each output after the first, where outputs are joined end to end.

    It belongs to the structure of a simulation of several outputs, and is not an effect that is found.

    Attributes
    ----------
    name : str
    outputs : tuple of (int, int)
        First sample of each of these outputs and the one after its last.
    """

    name: ClassVar[str] = "sensor-zeros"
    outputs: tuple[tuple[int, int], ...] = ()

    @property
    def at_load(self) -> bool:
        """Added before the sensor."""
        return True

    @property
    def width(self) -> int:
        """A constant for each output."""
        return len(self.outputs)

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The constants, shape (samples, width)."""
        found = np.zeros((samples, self.width), order="F")
        for number, (start, stop) in enumerate(self.outputs):
            found[start:stop, number] = 1.0
        return found
