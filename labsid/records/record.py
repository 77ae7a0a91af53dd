"""The record of an experiment: loading and validation."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from labsid._arrays import FloatArray, as_equal_signals, as_signal, freeze, frozen_array
from labsid.records.direction import look_swapped
from labsid.records.formats import RawRecord, cut_signals, read_raw
from labsid.records.reading import Reading
from labsid.records.several_signals import (
    SeveralSignals,
    check_names,
    joined,
    labels_of,
    names_of,
    signal_columns,
    units_of,
)
from labsid.records.signal_quality import digits_of, runs
from labsid.records.signals import jitter_note, missing_note, span_of_outputs
from labsid.records.steps import REGULAR_WITHIN

LARGEST = 1e100  # larger values are damage; their squares could overflow

_REMEDIES = {
    True: "If the log holds several runs, read one (--select 1); if only the clock started again, read it without "
    "times (columns u,y and Ts).",
    False: "Say which of the rows counts (--repeated first, or last), or read it without times (columns u,y and Ts).",
}
_OPTIONAL = ("y_measured", "y_noise_reduced", "reference")
OUTPUTS = ("y", "y_measured", "y_noise_reduced")  # NaN where a sample is missing


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Record(SeveralSignals):
    """Inputs and outputs of one experiment, sampled at regular times.

    The constructor validates the signals and stores read-only copies.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Time of each sample in seconds, N >= 2.
    u : ndarray, shape (N,), or (N, nu) with nu > 1 inputs
        Input (V in the lab).
    y : ndarray, shape (N,), or (N, ny) with ny > 1 outputs
        Output; NaN where it is missing, see `missing`.
    Ts : float
        Sampling time in seconds; it must agree with `t`.
    y_measured, y_noise_reduced : ndarray, shape (N,), optional
        Both outputs of a lab record, as logged and after the rig's noise reduction; `y` is one of them. Only with one
        input and one output.
    reference : ndarray, shape (N,), optional
        The set point of a closed-loop record.
    name : str
        Name for messages and titles.
    jitter : float
        Root-mean-square deviation of the file's time stamps from `t`, in sampling times; 0 if `t` holds the stamps.
    notes : tuple of str
        What was assumed and done in reading the file.
    units : tuple of str
        Units of the inputs, then of the outputs, as the file names them; empty where it does not.
    inputs, outputs : tuple of str
        Names of the inputs and outputs; by default ``u`` and ``y``, of several ``u1, u2, ...`` and ``y1, y2, ...``.
    labels : tuple of str
        Names of the inputs, then of the outputs, on the axes of figures: those of the columns of the file, by default
        `inputs` and `outputs`.

    Raises
    ------
    ValueError
        If a signal has another shape or is not finite (an output may be NaN), if the lengths differ, if there are
        fewer than two samples, if the times do not increase in regular steps of `Ts`, or if the names or units do not
        fit the signals.
    """

    t: FloatArray
    u: FloatArray
    y: FloatArray
    Ts: float
    y_measured: FloatArray | None = None
    y_noise_reduced: FloatArray | None = None
    reference: FloatArray | None = None
    name: str = ""
    jitter: float = 0.0
    notes: tuple[str, ...] = ()
    units: tuple[str, ...] = ("", "")
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        u, y = signal_columns(self.u), signal_columns(self.y)
        extra = [name for name in _OPTIONAL if getattr(self, name) is not None]
        if len(u) + len(y) > 2:
            _check_several(self, extra)
        inputs, outputs = names_of("u", self.inputs, len(u)), names_of("y", self.outputs, len(y))
        check_names(inputs, outputs)
        given = [
            ("t", self.t, False),
            *((name, x, False) for name, x in zip(inputs, u, strict=True)),
            *((name, x, True) for name, x in zip(outputs, y, strict=True)),
            *((name, getattr(self, name), name in OUTPUTS) for name in extra),
        ]
        t, *signals = checked = _checked(given)
        Ts = float(self.Ts)
        sizes = [fault for (name, *_), x in zip(given, checked, strict=True) for fault in _size_faults(name, x)]
        faults = sizes or _time_faults(t) or _disagreement(sampling_time(t), Ts, t.size)
        if faults:
            raise ValueError(faults[0].text)
        nu, ny = len(u), len(y)
        freeze(self, t=t, u=joined(signals[:nu]), y=joined(signals[nu : nu + ny]))
        freeze(self, **dict(zip(extra, signals[nu + ny :], strict=True)))
        object.__setattr__(self, "Ts", Ts)
        object.__setattr__(self, "inputs", inputs)
        object.__setattr__(self, "outputs", outputs)
        object.__setattr__(self, "units", units_of(self.units, (*inputs, *outputs)))
        object.__setattr__(self, "labels", labels_of(self.labels, (*inputs, *outputs)))

    @property
    def missing(self) -> NDArray[np.bool_]:
        """Samples without an output, shape of `y`: to be simulated through, but neither fitted nor scored."""
        return np.isnan(self.y)

    def __len__(self) -> int:
        return int(self.t.size)

    def __repr__(self) -> str:
        columns = [*self.input_columns.T, *(y[~np.isnan(y)] for y in self.output_columns.T)]
        ranges = [
            f"{name} {digits_of(x.min(), np.ptp(x))}..{digits_of(x.max(), np.ptp(x))}"
            for name, x in zip(self.signal_names, columns, strict=True)
        ]
        missing = zip(np.isnan(self.output_columns).sum(axis=0), self.outputs, strict=True)
        without = [f"{count} without {name}" for count, name in missing if count]
        return f"Record({self.name!r}: {len(self)} samples, Ts = {self.Ts:g} s, {', '.join([*ranges, *without])})"


class Fault(NamedTuple):
    """A reason to refuse a record: its topic, and a sentence with place and remedy."""

    topic: str
    text: str


def load_record(
    path: str | PathLike[str],
    output: str = "noise-reduced",
    columns: str | None = None,
    Ts: float | None = None,
    *,
    time_unit: str | None = None,
    repeated: str | None = None,
    select: int | None = None,
    since: float | None = None,
    until: float | None = None,
    resample: float | None = None,
    decimate: int | None = None,
    inputs: str | None = None,
    outputs: str | None = None,
    reference: str | None = None,
) -> Record:
    """Read a record from a log of any format in the table of ``labsid/records/README.md``.

    Parameters
    ----------
    path : path
        Text, ``.mat``, ``.xlsx``, ``.parquet``, ``.npz``, ``.npy``, HDF5, ``.mf4``, ``.tdms``, MCAP, a ROS bag, or the
        folder of a LeRobot data set.
    output : {"noise-reduced", "measured"}
        Which output of the lab's ``LogData`` becomes `y`: column 2 or column 1 of ``LogData.signals(1).values``.
    columns : str, optional
        Names or numbers (from 1) of the columns to use: ``"t,u,y"``, or two for ``"u,y"`` with `Ts`. With `inputs` or
        `outputs` the column of the times, where its name does not say it.
    Ts : float, optional
        Sampling time in seconds of a log without times. With times: the samples are even, and stamps that deviate
        from even times by up to 0.4 of the sampling time are noise.
    time_unit : {"s", "ms", "us", "ns", "min", "h", "days"}, optional
        Unit of the times, where the log does not say it.
    repeated : {"first", "last"}, optional
        Which of several rows with the same time is kept.
    select : int, optional
        Which run, from 1, of a log whose time starts again.
    since, until : float, optional
        Keep only the samples between these times in seconds.
    resample : float, optional
        Bring samples taken at uneven times, or signals of different rates, to this sampling time in seconds: the
        output band-limited, an input that is held between its changes held.
    decimate : int, optional
        Keep every n-th sample, after a low-pass filter on all signals.
    inputs, outputs : str, optional
        Names or numbers of the columns of several signals: ``"Q1,Q2"``; by default those that the header calls u or u1,
        u2, ... and y or y1, y2, ... The name of a matrix stands for its columns.
    reference : str, optional
        The column of the set point of a closed loop.

    Returns
    -------
    Record
        With what was done to it in `Record.notes`; y is NaN where a sample is missing.

    Raises
    ------
    OSError
        If the file does not exist or cannot be opened.
    ValueError
        If the file is not a valid record; the message names the fault and its place, or the option that decides
        between two readings.

    Notes
    -----
    Step 1a of the UNSW lab: ``t = LogData.time`` and so on. `labsid check` describes a refused file.
    """
    how = Reading(
        columns, Ts, output, time_unit, repeated, select, since, until, resample, decimate, inputs, outputs, reference
    )
    return read_record(path, how)


def read_record(path: str | PathLike[str], how: Reading) -> Record:
    """Read a record as `load_record` does, with its options in one object."""
    raw = read_raw(path, how)
    faults = find_faults(raw)
    if faults:
        raise ValueError(refusal(path, faults))
    t = raw.t
    if t is None:
        assert raw.Ts is not None  # find_faults refuses a record that has neither
        t = frozen_array(np.arange(len(raw.u)) * raw.Ts)
    return Record(
        t=t,
        u=raw.u,
        y=raw.y,
        Ts=sampling_time(t) if raw.Ts is None else raw.Ts,
        y_measured=raw.y_measured,
        y_noise_reduced=raw.y_noise_reduced,
        reference=raw.reference,
        name=raw.name,
        jitter=raw.jitter,
        notes=raw.notes,
        units=raw.units,
        inputs=raw.inputs,
        outputs=raw.outputs,
        labels=raw.labels,
    )


def refusal(path: str | PathLike[str], faults: Sequence[Fault]) -> str:
    """One-line message for a refused file: its first fault, and the number of further ones."""
    more = f" ({len(faults) - 1} more: see `labsid check`)" if len(faults) > 1 else ""
    return f"{Path(path).name}: {faults[0].text}{more}"


def sampling_time(t: ArrayLike) -> float:
    """Sampling time of regular times: the mean interval, free of the rounding errors of the times.

    Parameters
    ----------
    t : array_like, shape (N,)
        Times in seconds, N >= 2.

    Returns
    -------
    float
        In seconds; 0.75 for the lab's records, 0.1 for ``np.arange(n) * 0.1``.

    Raises
    ------
    ValueError
        If the times go backwards or are not regular.
    """
    t = as_signal("t", t, at_least=2)
    faults = _time_faults(t)
    if faults:
        raise ValueError(faults[0].text)
    mean = float(t[-1] - t[0]) / (t.size - 1)
    short = float(f"{mean:.9g}")
    rounding = 2 * np.spacing(np.abs(t).max()) / (t.size - 1) + 4 * np.spacing(mean)
    return short if abs(short - mean) <= rounding else mean


def find_faults(raw: RawRecord) -> tuple[Fault, ...]:
    """Find all faults for which `load_record` refuses a file.

    Parameters
    ----------
    raw : RawRecord
        From `labsid.records.formats.read_raw`.

    Returns
    -------
    tuple of Fault
        Empty for a valid record.
    """
    faults = []
    for name, column in raw.columns.items():
        try:
            as_signal(name, _filled(column) if name in (*raw.outputs, *OUTPUTS[1:]) else column, at_least=2)
        except ValueError as error:
            faults.append(Fault("values", str(error)))
        else:
            faults += _size_faults(name, column)
    lengths = {name: column.size for name, column in raw.columns.items()}
    if len(set(lengths.values())) > 1:
        got = ", ".join(f"{name} has {size}" for name, size in lengths.items())
        text = f"columns must have equal length; {got}. Cut them to the same samples."
        faults.append(Fault("lengths", text))
    faults += _sampling_faults(raw)
    if not faults and not raw.several and look_swapped(*_complete(raw)):
        levels = np.unique(raw.y[np.isfinite(raw.y)]).size
        (u,), (y,) = raw.inputs, raw.outputs
        text = (
            f"{u} and {y} look swapped: {y} holds {levels} exact levels, while {u} moves after each change of {y} as "
            "an output does. Name the columns the other way round."
        )
        faults.append(Fault("signals", text))
    return tuple(faults)


def reading_notes(record: Record) -> tuple[str, ...]:
    """All that is to be said of how a record was read: what was done, missing outputs, jitter of its stamps."""
    return (*record.notes, *missing_notes(record), *jitter_note(record.jitter, record.Ts))


def missing_notes(record: Record) -> list[str]:
    """Which samples of each output are missing."""
    outputs = zip(record.outputs, record.output_columns.T, strict=True)
    return [note for name, y in outputs for note in missing_note(y, record.t, name)]


def between_outputs(record: Record) -> Record:
    """A record from its first output to its last one: an output before is not known, nor the state from which it began.

    Of several outputs, each may be missing at either end.

    Parameters
    ----------
    record : Record

    Returns
    -------
    Record
        With what was left out in its notes; the record itself if nothing is.
    """
    rows = span_of_outputs(record.y)
    if rows.start == 0 and rows.stop == len(record):
        return record
    what = "y is" if len(record.outputs) == 1 else "all outputs are"
    ends = {"first": rows.start, "last": len(record) - rows.stop}
    where = " and ".join(f"the {end} {count}" for end, count in ends.items() if count)
    note = f"{what} missing in {where} samples; these are left out"
    if sum(ends.values()) == 1:
        note = f"{what} missing in the {'first' if rows.start else 'last'} sample; it is left out"
    return replace(cut_signals(record, rows), notes=(*record.notes, note))


def bridge_gaps(y: FloatArray) -> FloatArray:
    """An output with straight lines in place of missing samples: for what needs a value everywhere but uses none there.

    Parameters
    ----------
    y : ndarray, shape (N,) or (N, ny)
        At least one sample of each output is there.
    """
    missing = np.isnan(y)
    if not missing.any():
        return y
    if y.ndim > 1:
        return np.column_stack([bridge_gaps(column) for column in y.T])
    k = np.arange(y.size)
    return np.interp(k, k[~missing], y[~missing])


def is_sound(values: FloatArray) -> bool:
    """Whether all values are finite and at most `LARGEST` in magnitude."""
    return bool(np.all(np.abs(values) <= LARGEST))


def _size_faults(name: str, column: FloatArray) -> list[Fault]:
    k = int(np.argmax(np.abs(np.nan_to_num(column, nan=0.0, posinf=np.inf))))
    if abs(column[k]) <= LARGEST:
        return []
    text = f"{name} must be below {LARGEST:g} in size; got {column[k]:g} at sample {k}. The file is damaged there."
    return [Fault("values", text)]


def _sampling_faults(raw: RawRecord) -> list[Fault]:
    if raw.t is None:
        if raw.Ts is None:
            return [Fault("sampling", "there is no time column. Give the sampling time with Ts (--Ts).")]
        return []
    if raw.t.size < 2 or not is_sound(raw.t):
        return []
    faults = _time_faults(raw.t)
    if not faults and raw.Ts is not None:
        faults = _disagreement(sampling_time(raw.t), raw.Ts, raw.t.size)
    return faults


def _checked(given: Sequence[tuple[str, ArrayLike, bool]]) -> list[FloatArray]:
    """Finite signals of equal length; the third entry of each says whether it is an output, which may be NaN."""
    finite = as_equal_signals([(name, _filled(x) if is_output else x) for name, x, is_output in given], at_least=2)
    return [
        np.where(np.isnan(np.reshape(np.asarray(raw, np.float64), -1)), np.nan, x) if is_output else x
        for (_, raw, is_output), x in zip(given, finite, strict=True)
    ]


def _check_several(record: Record, extra: Sequence[str]) -> None:
    """Refuse what a record of several signals cannot have: signals in rows, and the two outputs of a lab record."""
    samples = np.size(record.t)
    for symbol, x in (("u", record.u), ("y", record.y)):
        shape = np.shape(x)
        if len(shape) == 2 and shape[0] != samples == shape[1] and shape[0] > 1:
            raise ValueError(
                f"{symbol} must have a row for each sample and a column for each signal, shape {shape[::-1]}; got "
                f"{shape}. Transpose it."
            )
    for name in extra:
        if name in OUTPUTS:
            raise ValueError(f"{name} belongs to a record of one input and one output; got several. Leave it out.")


def _filled(values: ArrayLike) -> ArrayLike:
    """An output with 0 in place of missing samples, if at least two are there; anything else as it is."""
    array = np.asarray(values)
    if array.dtype.kind != "f" or np.sum(~np.isnan(array)) < 2:
        return values
    return np.where(np.isnan(array), 0.0, array)


def _complete(raw: RawRecord) -> tuple[FloatArray, FloatArray]:
    """The longest stretch of samples that all have an output."""
    starts, lengths = runs(np.isnan(raw.y).astype(np.float64))
    there = np.flatnonzero(~np.isnan(raw.y[starts]))
    longest = there[np.argmax(lengths[there])]
    part = slice(starts[longest], starts[longest] + lengths[longest])
    return raw.u[part], raw.y[part]


def _time_faults(t: FloatArray) -> list[Fault]:
    """The fault of times that do not increase in regular steps, if any."""
    steps = np.diff(t)
    back = np.flatnonzero(steps <= 0)
    if back.size:
        k = back[0]
        what = "goes backwards" if steps[k] < 0 else "stands still"
        many = f" ({back.size} such places)" if back.size > 1 else ""
        text = (
            f"time {what} from sample {k} (t = {t[k]:g} s) to sample {k + 1} (t = {t[k + 1]:g} s){many}. "
            f"{_REMEDIES[bool(steps[k] < 0)]}"
        )
        return [Fault("sampling", text)]
    usual = float(np.median(steps))
    odd = np.flatnonzero(np.abs(steps - usual) > REGULAR_WITHIN * usual)
    if odd.size:
        k = odd[0]
        many = f", {odd.size} such intervals in all" if odd.size > 1 else ""
        even = float(steps.mean()) if steps.max() < 2.0 * usual else usual  # no sample is missing: stamps with jitter
        text = (
            f"sampling is irregular: {usual:g} s as a rule, but {steps[k]:g} s from sample {k} (t = {t[k]:g} s) "
            f"to the next{many}. If the samples are even and only their stamps are not, say so with Ts (--Ts "
            f"{even:.4g}), or read it without times (columns u,y and Ts); if the samples are uneven, resample "
            f"(--resample {even:.4g}) or cut the record (--from, --to)."
        )
        return [Fault("sampling", text)]
    return []


def _disagreement(found: float, given: float, samples: int) -> list[Fault]:
    # Rounding of Ts is accepted: less than half a sample over the whole record.
    if abs(found - given) * (samples - 1) <= 0.5 * found and abs(found - given) <= REGULAR_WITHIN * found:
        return []
    text = f"Ts = {given:g} s disagrees with the times, which step by {found:g} s. Leave one of them out."
    return [Fault("sampling", text)]
