"""Offsets and initial states of further records that are joined to the first one."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import AdditiveEffect, Effect
from labsid.gap.effects.context import Context
from labsid.gap.effects.input import Backlash
from labsid.gap.effects.play import Play


@dataclass(frozen=True, slots=True)
class Restarts(AdditiveEffect):
    """A constant and the free responses of the dynamics for each record after the first; zero outside that record.

    It belongs to the structure of a simulation of several records, and is not an effect that is found.

    Attributes
    ----------
    name : str
    records : tuple of (int, int)
        First sample of each of these records and the one after its last.
    n_poles : int
        Number of free responses.
    """

    name: ClassVar[str] = "restarts"
    records: tuple[tuple[int, int], ...] = ()
    n_poles: int = 2

    @property
    def at_load(self) -> bool:
        """Added before the sensor."""
        return True

    @property
    def width(self) -> int:
        """An offset and the free responses for each record."""
        return self.per_record * len(self.records)

    @property
    def per_record(self) -> int:
        """Number of columns of each record, its offset first."""
        return 1 + self.n_poles

    def beside(self, plant: Plant) -> "Restarts":
        """With the free responses of these dynamics."""
        return replace(self, n_poles=plant.n_poles)

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The signals, shape (samples, width); `rates` are the parameters of the plant."""
        found = np.zeros((samples, self.width), order="F")
        longest = max((stop - start for start, stop in self.records), default=0)
        free = plant.free_responses(rates, longest, span)
        for number, (start, stop) in enumerate(self.records):
            count = max(min(stop, samples) - start, 0)
            at = self.per_record * number
            found[start : start + count, at] = 1.0
            found[start : start + count, at + 1 : at + self.per_record] = free[:count]
        return found


class _PlayByRecord(Effect):
    """Play whose position at the start of each record is a parameter: `one` is that of a single record."""

    one: ClassVar[Backlash | Play]
    starts_at: tuple[int, ...]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Width of the play, and initial position within it in each record."""
        further = (Parameter(f"position{n}", 0.0, 1.0, 0.02) for n in range(2, len(self.starts_at) + 2))
        return (*self.one.parameters, *further)

    def starts(self, context: Context) -> list[FloatArray]:
        """Those of one record, with further positions in the middle."""
        return [np.append(own, np.full(len(self.starts_at), 0.5)) for own in self.one.starts(context)]

    def _parts(self, own: FloatArray, signal: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
        """A signal up to the start of each further record, and the parameters that hold there."""
        for part, position in zip(np.split(signal, self.starts_at), own[1:], strict=True):
            if len(part):
                yield part, np.array([own[0], position])


@dataclass(frozen=True, slots=True)
class BacklashByRecord(_PlayByRecord, Backlash):
    """Backlash in several records.

    Attributes
    ----------
    starts_at : tuple of int
        First sample of each record after the first.
    """

    one: ClassVar[Backlash] = Backlash()
    starts_at: tuple[int, ...] = ()

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Follow the command once the backlash is taken up."""
        return np.concatenate([self.one.apply(part, of_record, span) for part, of_record in self._parts(own, w)])


@dataclass(frozen=True, slots=True)
class PlayByRecord(_PlayByRecord, Play):
    """Play at the output in several records.

    Attributes
    ----------
    starts_at : tuple of int
        First sample of each record after the first.
    """

    one: ClassVar[Play] = Play()
    starts_at: tuple[int, ...] = ()

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Follow the process once the play is taken up."""
        return np.concatenate([self.one.apply(part, of_record) for part, of_record in self._parts(own, z)])

    def passed(self, columns: FloatArray, z: FloatArray, own: FloatArray) -> FloatArray:
        """Hold each column while the process crosses the play."""
        pairs = zip(np.split(columns, self.starts_at), self._parts(own, z), strict=False)
        return np.concatenate([self.one.passed(part, signal, of_record) for part, (signal, of_record) in pairs])


_BY_RECORD: dict[type[Effect], type[BacklashByRecord | PlayByRecord]] = {
    Backlash: BacklashByRecord,
    Play: PlayByRecord,
}


def in_records(effect: Effect, records: Sequence[tuple[int, int]]) -> Effect:
    """An effect with an initial state of its own in each of several records, if it has one; else the effect.

    Parameters
    ----------
    effect : Effect
    records : sequence of (int, int)
        First sample of each record after the first, and the one after its last.
    """
    form = _BY_RECORD.get(type(effect))
    return effect if form is None else form(starts_at=tuple(start for start, _ in records))


def in_one_record(effect: Effect) -> Effect:
    """The same effect in a single record."""
    return effect.one if isinstance(effect, BacklashByRecord | PlayByRecord) else effect
