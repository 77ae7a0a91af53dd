"""Very long records: the search runs the simulation thousands of times, so it works on a part, and says on which."""

from dataclasses import dataclass

import numpy as np

from labsid.gap.baseline import Simulation
from labsid.records.record import Record
from labsid.records.signal_quality import runs

MAX_SAMPLES = 20_000  # samples: one to three minutes of search on one core
MIN_SAMPLES_PER_STEP = 40  # samples that stay between two changes of the input when a record is thinned out


@dataclass(frozen=True, slots=True, eq=False)
class ShortenedRecord:
    """The part of a record that is diagnosed.

    Attributes
    ----------
    record : Record
    simulation : dict, ndarray, callable or None
        The given one; of an output series, the same part.
    every : int
        Every so many samples one was kept.
    notes : tuple of str
        Sentences that say what was left out; none where nothing was.
    """

    record: Record
    simulation: Simulation | None
    every: int
    notes: tuple[str, ...]


def shorten_record(record: Record, simulation: Simulation | None, longest: int = MAX_SAMPLES) -> ShortenedRecord:
    """Shorten a long record to `longest` samples.

    It is thinned out as far as its input allows, which changes little from one sample to the next where it rests for
    long; if that is not enough, the stretch counts in which the input moves most. A given simulation keeps its
    sampling time: then nothing is thinned out; and one that is a function begins where the record begins.

    Parameters
    ----------
    record : Record
    simulation : dict, ndarray, callable or None
    longest : int

    Returns
    -------
    Part
    """
    if len(record) <= longest:
        return ShortenedRecord(record, simulation, 1, ())
    every = 1
    if simulation is None:
        usual = int(np.median(runs(record.u)[1]))
        every = max(1, min(-(-len(record) // longest), usual // MIN_SAMPLES_PER_STEP))
    thin = downsample(record, every)
    start = 0 if callable(simulation) else _most_excited(thin.u, longest)
    rows = slice(start, start + longest)
    part = _cut(thin, rows)
    if isinstance(simulation, np.ndarray) and simulation.shape == record.u.shape:
        simulation = simulation[rows]
    which = "" if every == 1 else f", one in {every} (the input averaged in between),"
    said = f"The record has {len(record)} samples: from t = {part.t[0]:g} s to {part.t[-1]:g} s"
    return ShortenedRecord(
        part, simulation, every, (f"{said} {len(part)} of them{which} are diagnosed, the rest is not looked at.",)
    )


def shorten_holdout(holdout: Record, every: int, longest: int = MAX_SAMPLES) -> tuple[Record, tuple[str, ...]]:
    """Another record as the diagnosed one was shortened: equally thinned out, and its beginning.

    Parameters
    ----------
    holdout : Record
    every : int
        From `Part`.
    longest : int

    Returns
    -------
    tuple of Record and tuple of str
        And what was left out.
    """
    part = _cut(downsample(holdout, every), slice(0, longest))
    if len(part) == len(holdout):
        return holdout, ()
    return part, (f"Of the {len(holdout)} samples of the holdout {len(part)} count, up to t = {part.t[-1]:g} s.",)


def downsample(record: Record, every: int) -> Record:
    """Every so many samples one: the output as it was then, the input averaged until the next.

    Parameters
    ----------
    record : Record
    every : int
        1 leaves the record as it is.

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


def _cut(record: Record, rows: slice) -> Record:
    sensor = None if record.y_measured is None else record.y_measured[rows]
    return Record(record.t[rows], record.u[rows], record.y[rows], record.Ts, sensor, name=record.name)


def _most_excited(u: np.ndarray, length: int) -> int:
    """Where the stretch of `length` samples begins over which the input spreads most; steps of half a stretch."""
    last = max(u.size - length, 0)
    return max([*range(0, last, length // 2), last], key=lambda start: float(np.std(u[start : start + length])))
