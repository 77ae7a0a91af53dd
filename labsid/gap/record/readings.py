"""Records of a sensor that is slower than the logger: simulated at all samples, compared at its readings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.record import Record, between_outputs
from labsid.records.signal_quality import runs
from labsid.records.slow_sensor import ON_TIME, SlowReadings, differ_by_size, find_readings, read_at_ticks

ROUNDING = 1e-9  # of the range of the input; numerics
MEAN_UNKNOWN = 0.5
"""Samples by which a reading is before the sample that shows it first; statistics: mean of a uniform time."""
ONE_CLOCK = 1.0  # samples over the longest record, by which the periods of one sensor may differ; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class ComparedRecords:
    """Records with an output at the readings of their sensor alone.

    Attributes
    ----------
    records : list of Record
        Without an output elsewhere.
    is_slow : bool
        Whether the first has fewer readings than samples; others may.
    stride : int
        Samples from one reading to the next, where most are at one distance; else 1.
    notes : tuple of str
        A sentence on what is compared.
    before : ndarray, shape (M,), optional
        By how many samples each reading of the first is before its sample, negative after it, if it lies between two;
        NaN where the log does not tell.
    """

    records: list[Record]
    is_slow: bool
    stride: int
    notes: tuple[str, ...]
    before: FloatArray | None = None


def at_readings(
    records: Sequence[Record], is_given: bool = False, longest: float = np.inf, exclude: np.ndarray | None = None
) -> ComparedRecords:
    """Records of a sensor that is slower than the logger, with an output at its readings alone.

    The simulation runs at all samples, for the input may move between two readings, and is compared at the readings.
    If it moves only where the sensor is read, or if so many samples are too many, it is simulated with the mean of the
    input from one reading to the next. Readings of a sensor with a clock of its own lie between two samples: the record
    is brought to its ticks, with as many samples between them.

    Parameters
    ----------
    records : sequence of Record
        Runs of one rig; each that has a reading at most samples stays as it is.
    is_given : bool
        Whether a simulation is given, which runs at the times of the input.
    longest : float
        Most samples of all records.
    exclude : ndarray of bool, optional
        Samples of the first record that tell nothing of its sensor.

    Returns
    -------
    ComparedRecords
    """
    hidden = [np.zeros(len(record), bool) for record in records]
    if exclude is not None:
        hidden[0] = exclude
    outputs = [np.where(rows, np.nan, record.y) for record, rows in zip(records, hidden, strict=True)]
    read_at = [find_readings(record.u, y) for record, y in zip(records, outputs, strict=True)]
    slow = [at for at in read_at if at is not None]
    if not slow:
        return ComparedRecords(list(records), False, 1, ())
    which = "The output" if read_at[0] is not None else "The output of another record"
    new = f"{which} has a new value at one sample in {slow[0].every:.3g} only: "
    every, samples = slow[0].every, sum(map(len, records))
    if not is_given and read_at[0] is not None and _have_one_clock(read_at, max(map(len, records))):
        stride = int(max(min(np.ceil(every), longest * every / samples), 1))
        if slow[0].is_even and not _moves_between(records[0].u, slow[0]):
            stride = 1
        if stride != every:
            at_ticks = [_resampled(*parts, slow[0], stride) for parts in zip(records, outputs, read_at, strict=True)]
            return ComparedRecords(at_ticks, stride > 1, stride, (new + _compared(stride),))
    only = [_without_repeats(*parts) for parts in zip(records, outputs, read_at, strict=True)]
    stride = 1 if read_at[0] is None else _usual_distance(read_at[0].at)
    before = None if read_at[0] is None else _before_samples(read_at[0], outputs[0])
    return ComparedRecords(
        only, read_at[0] is not None, stride, (f"{new}the simulation is compared at these.",), before
    )


def _before_samples(readings: SlowReadings, y: FloatArray) -> FloatArray | None:
    """By how many samples each reading is before its sample, NaN if unknown; None if none is between two samples."""
    if readings.is_even:
        return None
    if readings.first is None:
        return np.full(readings.at.size, np.nan)
    ticks, held = _new_at_ticks(readings, y)
    return np.asarray(np.round(ticks) - ticks)[~np.isnan(held)]


def _new_at_ticks(readings: SlowReadings, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The ticks of a clock, and the reading of each; NaN where it is missing, and between samples where it is lost.

    A lost reading shows as one that is equal to the one before. At even distances these stay, for a logger that holds.
    """
    ticks, held = read_at_ticks(readings, y)
    there = np.flatnonzero(~np.isnan(held))
    lost = there[1:][np.diff(held[there]) == 0.0]
    if not readings.is_even and differ_by_size(held[np.setdiff1d(there, lost)]):
        held[lost] = np.nan
    return ticks, held


def brought_to_samples(record: Record, at: np.ndarray, before: FloatArray, simulated: FloatArray) -> Record:
    """A record whose readings between samples are brought to these, along the slope of a given simulation.

    Where the log does not tell when they were read, at the sample or at any time from the one before: the mean, half a
    sample before, if the simulation is nearer to the readings there.

    Parameters
    ----------
    record : Record
    at : ndarray of int, shape (M,)
        Samples with a reading.
    before : ndarray, shape (M,)
        By how many samples each reading is before its sample; NaN where the log does not tell.
    simulated : ndarray, shape (N,)
        Output of the simulation.
    """
    samples = np.arange(len(record))

    def moved(early: FloatArray) -> FloatArray:
        return np.asarray(record.y[at] + simulated[at] - np.interp(at - early, samples, simulated))

    brought = [moved(np.where(np.isnan(before), unknown, before)) for unknown in (0.0, MEAN_UNKNOWN)]
    y = record.y.copy()
    y[at] = min(brought, key=lambda one: float(np.var(one - simulated[at])))
    return replace(record, y=y)


def _usual_distance(at: np.ndarray) -> int:
    """The distance of most readings; 1 if there is none."""
    apart, count = np.unique(np.diff(at), return_counts=True)
    most = int(count.argmax())
    return int(apart[most]) if 2 * count[most] > count.sum() else 1


def _compared(stride: int) -> str:
    if stride == 1:
        return "the diagnosis uses these, and the mean of the input between them."
    return f"the simulation is compared at these, and has {stride} samples from each to the next."


def _have_one_clock(found: list[SlowReadings | None], samples: int) -> bool:
    """Whether the readings of all records are those of a clock of one period; an even one also reads all samples."""
    slow = [one for one in found if one is not None]
    if len(slow) < len(found) and not slow[0].is_even:
        return False
    drift = max(abs(one.every / slow[0].every - 1.0) for one in slow) * samples
    return all(one.first is not None for one in slow) and drift < ONE_CLOCK


def _moves_between(u: FloatArray, readings: SlowReadings) -> bool:
    """Whether the input changes elsewhere than where an even sensor is read."""
    return bool(np.any((runs(u)[0][1:] - readings.at[0]) % int(readings.every)))


def _without_repeats(record: Record, y: FloatArray, readings: SlowReadings | None) -> Record:
    """A record with an output at its readings only; those of a clock at the samples nearest to its ticks."""
    if readings is None:
        return record
    at, held = readings.at, y[readings.at]
    if readings.first is not None:
        ticks, held = _new_at_ticks(readings, y)
        at = np.round(ticks).astype(int)
    only = np.full(len(record), np.nan)
    only[at] = held
    return between_outputs(replace(record, y=only))


def _resampled(
    record: Record, y: FloatArray, readings: SlowReadings | None, clock: SlowReadings, stride: int
) -> Record:
    """A record with `stride` samples from each tick of a clock to the next, and the mean of the input in each.

    Of a record with a reading at each sample, those at the ticks are taken.
    """
    every = clock.every
    ticks, held = read_at_ticks(readings or SlowReadings(np.arange(y.size), every, 0.0), y)
    count = (ticks.size - 1) * stride + 1  # up to the last reading
    at_ticks = np.full(count, np.nan)
    at_ticks[::stride] = held
    grid = np.minimum(ticks[0] + every / stride * np.arange(count + 1), len(record))
    total = np.interp(grid, np.arange(len(record) + 1), np.concatenate([[0.0], np.cumsum(record.u)]))
    mean, own = np.diff(total) / np.diff(grid), record.u[np.ceil(grid[:-1] - ON_TIME).astype(int)]
    u = np.where(np.abs(mean - own) < ROUNDING * np.ptp(record.u), own, mean)  # one that is held stays so
    t = record.t[0] + record.Ts * grid[:-1]
    return between_outputs(Record(t, u, at_ticks, every / stride * record.Ts, name=record.name))


def along(simulated: FloatArray, y: FloatArray, at: np.ndarray | None = None) -> FloatArray:
    """An output with values between its readings, for figures: straight lines of the error of a simulation.

    Straight lines of the output itself would show errors of the simulation where nothing is measured.

    Parameters
    ----------
    simulated, y : ndarray, shape (N,)
    at : ndarray of int, optional
        Samples with a reading; by default those where `y` is not missing (NaN).
    """
    at = np.flatnonzero(~np.isnan(y)) if at is None else at
    return np.asarray(simulated + np.interp(np.arange(y.size), at, (y - simulated)[at]))


def readings_alone(record: Record, at: np.ndarray) -> Record:
    """The record at the readings `at` of a slow sensor, as if all were at their mean distance."""
    Ts = record.Ts * float(at[-1] - at[0]) / (at.size - 1)
    t = record.t[at[0]] + Ts * np.arange(at.size)
    return Record(t, record.u[at], record.y[at], Ts, name=record.name)
