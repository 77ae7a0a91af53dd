"""Offsets and initial states of further records that are joined to the first one."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plants import Plant
from labsid.gap.dynamics.responses import free_responses
from labsid.gap.effects.base import AdditiveEffect

COLUMNS = 3  # of each record: its offset, and the two free responses of the linear dynamics


@dataclass(frozen=True, slots=True)
class Restarts(AdditiveEffect):
    """A constant and the free responses of the dynamics for each record after the first; zero outside that record.

    It belongs to the structure of a simulation of several records, and is not an effect that is found.

    Attributes
    ----------
    name : str
    records : tuple of (int, int)
        First sample of each of these records and the one after its last.
    """

    name: ClassVar[str] = "restarts"
    records: tuple[tuple[int, int], ...] = ()

    @property
    def at_load(self) -> bool:
        """Added before the sensor."""
        return True

    @property
    def width(self) -> int:
        """Three columns for each record."""
        return COLUMNS * len(self.records)

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The signals, shape (samples, 3 R), for nonlinear dynamics with the linearized rates."""
        found = np.zeros((samples, self.width), order="F")
        longest = max((stop - start for start, stop in self.records), default=0)
        free = free_responses(longest, *plant.linear_rates(rates))
        for number, (start, stop) in enumerate(self.records):
            count = max(min(stop, samples) - start, 0)
            at = COLUMNS * number
            found[start : start + count, at] = 1.0
            found[start : start + count, at + 1 : at + COLUMNS] = free[:count]
        return found
