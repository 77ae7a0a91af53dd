"""Shorten very long records, because the search runs thousands of simulations."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid.gap.simulations.baseline import Simulation
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.records.record import Record
from labsid.records.signal_quality import runs
from labsid.simulators.simulator import Simulator

MAX_SAMPLES = 20_000  # samples; measured: one to three minutes of search on one core
MAX_OF_SEVERAL = 8_000  # samples of records with offsets and initial states of their own; measured: about a minute
MIN_SAMPLES_PER_STEP = 40  # samples that downsampling leaves between two changes of the input; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class ShortenedRecord:
    """The part of a record that is diagnosed.

    Attributes
    ----------
    record : Record
    simulation : dict, SimulatedOutput, Simulator or None
        The given simulation; of a simulated output, the same part.
    every : int
        Downsampling factor.
    notes : tuple of str
        Sentences on what was left out; empty if nothing was.
    """

    record: Record
    simulation: Simulation | None
    every: int
    notes: tuple[str, ...]


def shorten_record(
    record: Record, simulation: Simulation | None, longest: int = MAX_SAMPLES, is_slow: bool = False
) -> ShortenedRecord:
    """Shorten a long record to `longest` samples.

    The record is downsampled as far as the steps of its input allow. If it is still too long, the part with the
    largest variance of the input is selected. With a given simulation, which has its own sampling time, the record is
    not downsampled, nor is one of a slow sensor; with a simulator, the selected part is the beginning.

    Parameters
    ----------
    record : Record
    simulation : dict, SimulatedOutput, Simulator or None
    longest : int
    is_slow : bool
        Whether the sensor has fewer readings than samples.

    Returns
    -------
    ShortenedRecord
    """
    if len(record) <= longest:
        return ShortenedRecord(record, simulation, 1, ())
    every = 1
    if simulation is None and not is_slow:
        step = int(np.median(runs(record.u)[1]))
        every = max(1, min(-(-len(record) // longest), step // MIN_SAMPLES_PER_STEP))
    slow = downsample(record, every)
    start = 0 if isinstance(simulation, Simulator) else _most_excited(slow.u, longest)
    part = _cut(slow, slice(start, start + longest))
    simulation = cut_alike(simulation, slow, part)
    which = "" if every == 1 else f", one in {every} (the input averaged over each interval)"
    note = (
        f"The diagnosis uses {len(part)} of the {len(record)} samples of the record, from t = {part.t[0]:g} s to "
        f"{part.t[-1]:g} s{which}."
    )
    return ShortenedRecord(part, simulation, every, (note,))


def shorten_records(records: Sequence[Record], longest: int = MAX_OF_SEVERAL) -> tuple[list[Record], tuple[str, ...]]:
    """Shorten several records to `longest` samples in all: each to the part with the largest variance of the input.

    Parameters
    ----------
    records : sequence of Record
    longest : int

    Returns
    -------
    list of Record and tuple of str
        The records, and a sentence on what was left out.
    """
    total = sum(map(len, records))
    if total <= longest:
        return list(records), ()
    most = longest // len(records)
    starts = [_most_excited(record.u, most) if len(record) > most else 0 for record in records]
    parts = [_cut(record, slice(start, start + most)) for record, start in zip(records, starts, strict=True)]
    return parts, (f"The diagnosis uses {sum(map(len, parts))} of the {total} samples, at most {most} of each record.",)


def shorten_holdout(holdout: Record, every: int, longest: int = MAX_SAMPLES) -> tuple[Record, tuple[str, ...]]:
    """Shorten the holdout like the diagnosed record: the same downsampling, and then its beginning.

    Parameters
    ----------
    holdout : Record
    every : int
        Downsampling factor of the `ShortenedRecord`.
    longest : int

    Returns
    -------
    tuple of Record and tuple of str
        The shortened holdout, and sentences on what was left out.
    """
    part = _cut(downsample(holdout, every), slice(0, longest))
    if len(part) == len(holdout):
        return holdout, ()
    return part, (
        f"The diagnosis uses {len(part)} of the {len(holdout)} samples of the holdout, up to t = {part.t[-1]:g} s.",
    )


def downsample(record: Record, every: int) -> Record:
    """Keep every `every`-th sample of the output, and the mean of the input until the next one.

    Parameters
    ----------
    record : Record
    every : int
        1 returns the record unchanged.

    Returns
    -------
    Record
    """
    if every == 1:
        return record
    count = len(record) // every
    u = record.u[: count * every].reshape(count, every).mean(axis=1)
    y, t = record.y[: count * every : every], record.t[: count * every : every]
    return Record(t, u, y, every * record.Ts, name=record.name)


def cut_alike(simulation: Simulation | None, whole: Record, part: Record) -> Simulation | None:
    """A simulation of a part of a record: of a simulated output the same samples, anything else as it is."""
    if not isinstance(simulation, SimulatedOutput) or simulation.y.shape != whole.u.shape:
        return simulation
    start = round((part.t[0] - whole.t[0]) / whole.Ts)
    return replace(simulation, y=simulation.y[start : start + len(part)])


def _cut(record: Record, rows: slice) -> Record:
    sensor = None if record.y_measured is None else record.y_measured[rows]
    return Record(record.t[rows], record.u[rows], record.y[rows], record.Ts, sensor, name=record.name)


def _most_excited(u: np.ndarray, length: int) -> int:
    """Start of the `length` samples with the largest variance of the input, in steps of half that length."""
    last = max(u.size - length, 0)
    return max([*range(0, last, length // 2), last], key=lambda start: float(np.std(u[start : start + length])))
