"""Offsets and initial states of further records that are joined to the first one."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.given_simulation import Pieces, is_joined
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import AdditiveEffect, Effect
from labsid.gap.effects.context import Context
from labsid.gap.effects.input import Backlash
from labsid.gap.effects.play import Play


@dataclass(frozen=True, slots=True)
class Restarts(AdditiveEffect):
    """A constant and the free responses of the dynamics for each record after the first; zero outside that record.

    Nonlinear dynamics are simulated anew in each record, with initial states as parameters, unless a load, a sinusoid
    or a drift acts on their states. It belongs to the structure of a simulation of several records, and is not an
    effect that is found.

    Attributes
    ----------
    name : str
    records : tuple of (int, int)
        First sample of each of these records and the one after its last.
    n_poles : int
        Number of free responses.
    states : tuple of Parameter
        Initial states of nonlinear dynamics in a record.
    """

    name: ClassVar[str] = "restarts"
    records: Pieces = ()
    n_poles: int = 2
    states: tuple[Parameter, ...] = ()

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The initial states in each record."""
        numbers = range(2, len(self.records) + 2)
        return tuple(replace(state, name=f"{state.name} {number}") for number in numbers for state in self.states)

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
        """With the free responses of these dynamics, or their initial states."""
        states = () if plant.changes_in_time else plant.states
        return replace(self, n_poles=plant.n_poles - len(states), states=states)

    def columns(self, own: FloatArray, samples: int, span: int, plant: Plant, rates: FloatArray) -> FloatArray:
        """The signals, shape (samples, width); `rates` are the parameters of the plant."""
        found = np.zeros((samples, self.width), order="F")
        longest = max((stop - start for start, stop in self.records), default=0)
        free = plant.free_responses(rates, longest, span)[:, plant.n_poles - self.n_poles :]
        for number, (start, stop) in enumerate(self.records):
            count = max(min(stop, samples) - start, 0)
            at = self.per_record * number
            found[start : start + count, at] = 1.0
            found[start : start + count, at + 1 : at + self.per_record] = free[:count]
        return found

    def dynamics(
        self,
        plant: Plant,
        theta: FloatArray,
        own: FloatArray,
        w: FloatArray,
        span: int,
        reference: float,
        late: float,
        near: tuple[FloatArray, FloatArray] | None = None,
    ) -> FloatArray:
        """Columns of nonlinear dynamics that start in each record anew, as of `Plant.columns`.

        `theta` are the parameters of the plant, with the initial states in the first record; `own` are those in the
        other records. `near` holds the columns for other initial states there, and these. The last row is NaN where
        any of them diverges.
        """
        at = [plant.index(state.name) for state in self.states]
        first = theta[at]
        states, states_before = (
            [first, *np.split(x, len(self.records))] for x in (own, own if near is None else near[1])
        )
        bounds = [0, *_starts(self.records, w.size), w.size]
        runs, inner = [], theta.copy()
        for number, (start, stop) in enumerate(pairwise(bounds)):
            if near is not None and np.array_equal(states[number], states_before[number]):
                runs.append(near[0][start:stop])
                continue
            inner[at] = states[number]
            runs.append(plant.columns(inner, w[start:stop], span, reference, late))
            if number:  # of an additional lag or mode: among the free responses
                runs[-1][:, list(plant.state_columns)] = 0.0
        columns = np.concatenate(runs)
        if not all(np.isfinite(run[-1]).all() for run in runs):
            columns[-1] = np.nan
        return columns


class _PlayByRecord(Effect):
    """Play whose position at the start of each record is a parameter: `one` is that of a single record."""

    one: ClassVar[Backlash | Play]
    records: Pieces

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Width of the play, and initial position within it in each record."""
        further = (Parameter(f"position{n}", 0.0, 1.0, 0.02) for n in range(2, len(self.records) + 2))
        return (*self.one.parameters, *further)

    def starts(self, context: Context) -> list[FloatArray]:
        """Those of one record, with further positions in the middle."""
        return [np.append(own, np.full(len(self.records), 0.5)) for own in self.one.starts(context)]

    def _parts(self, own: FloatArray, signal: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
        """A signal up to the start of each further record, and the parameters that hold there."""
        for part, position in zip(np.split(signal, _starts(self.records, len(signal))), own[1:], strict=False):
            yield part, np.array([own[0], position])

    def apply(self, signal: FloatArray, own: FloatArray, *span: int) -> FloatArray:
        """Follow the signal once the play is taken up."""
        return np.concatenate([self.one.apply(part, of_record, *span) for part, of_record in self._parts(own, signal)])


@dataclass(frozen=True, slots=True)
class BacklashByRecord(_PlayByRecord, Backlash):
    """Backlash in several records.

    Attributes
    ----------
    one : Backlash
        In a single record.
    records : tuple of (int, int)
        First sample of each record after the first, and the one after its last.
    """

    one: ClassVar[Backlash] = Backlash()
    records: Pieces = ()


@dataclass(frozen=True, slots=True)
class PlayByRecord(_PlayByRecord, Play):
    """Play at the output in several records.

    Attributes
    ----------
    one : Play
        In a single record.
    records : tuple of (int, int)
        First sample of each record after the first, and the one after its last.
    """

    one: ClassVar[Play] = Play()
    records: Pieces = ()

    def passed(self, columns: FloatArray, z: FloatArray, own: FloatArray) -> FloatArray:
        """Hold each column while the process crosses the play."""
        pairs = zip(np.split(columns, _starts(self.records, len(z))), self._parts(own, z), strict=True)
        return np.concatenate([self.one.passed(part, signal, of_record) for part, (signal, of_record) in pairs])


def _starts(records: Pieces, samples: int) -> list[int]:
    """Where the records start in the joined one; nowhere in another signal, such as a step."""
    return [start for start, _ in records] if is_joined(samples, records) else []


_BY_RECORD: dict[type[Effect], type[BacklashByRecord | PlayByRecord]] = {
    Backlash: BacklashByRecord,
    Play: PlayByRecord,
}


def in_records(effect: Effect, records: Pieces) -> Effect:
    """An effect with an initial state of its own in each of several records, if it has one; else the effect.

    Parameters
    ----------
    effect : Effect
    records : sequence of (int, int)
        First sample of each record after the first, and the one after its last.
    """
    form = _BY_RECORD.get(type(effect))
    return effect if form is None else form(records=tuple(records))


def in_one_record(effect: Effect) -> Effect:
    """The same effect in a single record."""
    return effect.one if isinstance(effect, BacklashByRecord | PlayByRecord) else effect
