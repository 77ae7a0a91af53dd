"""Shorten very long records, because the search runs thousands of simulations."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linprog

from labsid.gap.simulations.baseline import Simulation
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.records.record import Record, between_outputs
from labsid.records.signal_quality import refreshes, runs
from labsid.simulators.simulator import Simulator

MAX_SAMPLES = 20_000  # samples: one to three minutes of search on one core
MAX_OF_SEVERAL = 8_000  # samples of several records, whose offsets and initial states add to the fits: about a minute
MIN_PRESENT = 0.5  # of the readings of a slow sensor: the others are missing
ROUNDING = 1e-9  # of the range of the input
ON_TIME = 1e-6  # samples: rounding of a tick
MIN_SAMPLES_PER_STEP = 40  # samples that downsampling leaves between two changes of the input


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
    record: Record, simulation: Simulation | None, longest: int = MAX_SAMPLES, stride: int = 1
) -> ShortenedRecord:
    """Shorten a long record to `longest` samples.

    The record is downsampled as far as the steps of its input allow. If it is still too long, the part with the
    largest variance of the input is selected. With a given simulation, which has its own sampling time, the record is
    not downsampled; with a simulator, the selected part is the beginning.

    Parameters
    ----------
    record : Record
    simulation : dict, SimulatedOutput, Simulator or None
    longest : int
    stride : int
        Samples from one reading of the output to the next; the part begins with a reading.

    Returns
    -------
    ShortenedRecord
    """
    if len(record) <= longest:
        return ShortenedRecord(record, simulation, 1, ())
    every = 1
    if simulation is None:
        step = int(np.median(runs(record.u)[1]))
        every = max(1, min(-(-len(record) // longest), step // MIN_SAMPLES_PER_STEP))
    slow = downsample(record, every)
    start = 0 if isinstance(simulation, Simulator) else _most_excited(slow.u, longest)
    start -= start % stride
    rows = slice(start, start + longest)
    part = _cut(slow, rows)
    if isinstance(simulation, SimulatedOutput) and simulation.y.shape == record.u.shape:
        simulation = replace(simulation, y=simulation.y[rows])
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


def at_readings(
    records: Sequence[Record], is_given: bool = False, longest: int = MAX_SAMPLES
) -> tuple[list[Record], int, tuple[str, ...]]:
    """Records of a sensor that is slower than the logger, with their readings at every so many samples.

    The simulation runs at all samples, for the input may move between two readings, and is compared at the readings.
    If it moves only where the sensor is read, or if so many samples are too many, it is simulated with the mean of the
    input from one reading to the next.

    Parameters
    ----------
    records : sequence of Record
        Runs of one rig; they stay as they are where the first has a reading at every sample, or at most.
    is_given : bool
        Whether a simulation is given, which runs at the times of the input: the sensor may have no clock of its own.
    longest : int
        Most samples of all records; fewer than two for each reading leave those at the readings alone.

    Returns
    -------
    list of Record, int and tuple of str
        The records, without an output between the readings; the samples from one reading to the next; and a sentence on
        what is compared.
    """
    found = [_readings(record) for record in records]
    if found[0] is None:
        return list(records), 1, ()
    every, has_clock = _clock(found[0])
    known = [at for at in found if at is not None]
    is_even = len(known) == len(found) and all(at.size > 1 and np.all(np.diff(at) == every) for at in known)
    if is_given and not is_even:
        return list(records), 1, ()
    most = int(longest * every / sum(map(len, records)))
    stride = max(min(int(np.ceil(every)), most), 1) if has_clock or is_even else 1
    new = f"The output has a new value at one sample in {every:.3g} only: "
    if is_given or (is_even and stride == every and _moves_between(records[0].u, found[0])):
        slow = [_without_repeats(one, at) for one, at in zip(records, known, strict=True)]
        return slow, int(every), (f"{new}the simulation is compared at these.",)
    if is_even and not _moves_between(records[0].u, found[0]):
        stride = 1
    if has_clock or is_even:
        slow = [_at_ticks(one, at, every, stride, is_even) for one, at in zip(records, found, strict=True)]
    else:
        slow = [_at_readings(one, at, every) for one, at in zip(records, found, strict=True)]
    if stride > 1:
        return (
            slow,
            stride,
            (f"{new}the simulation is compared at these, and has {stride} samples from each to the next.",),
        )
    return slow, 1, (f"{new}the diagnosis uses these, and the mean of the input between them.",)


def _moves_between(u: np.ndarray, at: np.ndarray) -> bool:
    """Whether the input changes elsewhere than where the sensor is read."""
    return bool(np.any((runs(u)[0][1:] - at[0]) % (at[1] - at[0])))


def _without_repeats(record: Record, at: np.ndarray) -> Record:
    """A record with an output at its readings only."""
    y = np.full(len(record), np.nan)
    y[at] = record.y[at]
    return between_outputs(replace(record, y=y))


def _clock(at: np.ndarray) -> tuple[float, bool]:
    """The period of a sensor in samples, and whether a clock with a period of its own explains its readings.

    `at` are the samples at which readings appear, up to a sample after their ticks; none is left out.
    """
    mean = float(np.diff(at).mean())
    if np.ptp(np.diff(at)) == 0:
        return mean, False
    ticks = np.arange(at.size)
    line = np.column_stack([ticks, np.ones(at.size)])  # its period, and half a sample more than its first tick
    rows = np.column_stack([np.vstack([line, -line]), -np.ones(2 * at.size)])  # and the largest deviation from it
    found = linprog([0.0, 0.0, 1.0], rows, np.concatenate([at, -at]), bounds=[(None, None)] * 3)
    has_clock = bool(found.success and found.x[2] <= 0.5 + ON_TIME)
    return (float(found.x[0]) if has_clock else mean), has_clock


def _at_ticks(record: Record, at: np.ndarray | None, every: float, stride: int, is_even: bool) -> Record:
    """A record with `stride` samples from each tick of a sensor's clock to the next, `every` samples of the log.

    A reading is seen at the sample that follows its tick, or, of an even clock, at its own sample.
    """
    seen = np.arange(len(record)) if at is None else at
    late = seen - every * np.arange(seen.size) if at is not None else np.array([0.0])
    first = float(seen[0]) if is_even else float(np.clip(0.5 * (late.max() - 1.0 + late.min()), 0.0, None))
    ticks = first + every * np.arange(int((len(record) - first) / every) + 1)
    ticks = ticks[ticks <= len(record)]
    held = record.y[seen[np.clip(np.searchsorted(seen, ticks[:-1] - ON_TIME), 0, seen.size - 1)]]
    count = (ticks.size - 2) * stride + 1  # up to the last reading
    y = np.full(count, np.nan)
    y[::stride] = held
    return _resampled(record, first + every / stride * np.arange(count + 1), every / stride, y)


def _readings(record: Record) -> np.ndarray | None:
    """The samples with a reading of their own, of a slow sensor; None of one that has them at most samples."""
    if not record.missing.any():
        return refreshes(record.u, record.y)
    at = np.flatnonzero(~record.missing)
    apart = np.diff(at)
    if at.size < 2 or np.median(apart) == 1.0:
        return None
    if (every := int(np.gcd.reduce(apart))) > 1 and at.size * every > MIN_PRESENT * (at[-1] - at[0]):
        return np.arange(at[0], at[-1] + 1, every)
    return at if np.ptp(apart) <= 1 else None


def _at_readings(record: Record, at: np.ndarray | None, every: float) -> Record:
    """A record at even distances of `every` samples, by straight lines between its readings."""
    first = 0 if at is None else int(at[0])
    grid = first + every * np.arange(int((len(record) - first) / every) + 1)
    grid = grid[grid <= len(record)]
    at = np.arange(len(record)) if at is None else at
    return _resampled(record, grid, every, np.interp(grid[:-1], at, record.y[at]))


def _resampled(record: Record, grid: np.ndarray, every: float, y: np.ndarray) -> Record:
    """A record with the output `y` at the places of `grid` but the last, and the mean of the input up to the next."""
    total = np.interp(grid, np.arange(len(record) + 1), np.concatenate([[0.0], np.cumsum(record.u)]))
    mean, own = np.diff(total) / every, record.u[np.ceil(grid[:-1]).astype(int)]
    u = np.where(np.abs(mean - own) < ROUNDING * np.ptp(record.u), own, mean)  # one that is held stays so
    t = record.t[0] + record.Ts * grid[:-1]
    return Record(t, u, y, every * record.Ts, name=record.name)


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


def _cut(record: Record, rows: slice) -> Record:
    sensor = None if record.y_measured is None else record.y_measured[rows]
    return Record(record.t[rows], record.u[rows], record.y[rows], record.Ts, sensor, name=record.name)


def _most_excited(u: np.ndarray, length: int) -> int:
    """Start of the `length` samples with the largest variance of the input, in steps of half that length."""
    last = max(u.size - length, 0)
    return max([*range(0, last, length // 2), last], key=lambda start: float(np.std(u[start : start + length])))
