"""The record of an experiment: loading and validation."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, as_signals, freeze, frozen_array
from labsid.records.direction import look_swapped
from labsid.records.even_times import fit_even_times
from labsid.records.formats import RawRecord, read_raw

REGULAR_WITHIN = 0.01  # largest deviation of an interval from the median one, as a share of it
LARGEST = 1e100  # larger values are damage; their squares could overflow

_OPTIONAL = ("y_measured", "y_noise_reduced", "reference")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Record:
    """Input and output of one experiment, sampled at regular times.

    The constructor validates the signals and stores read-only copies.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Time of each sample in seconds, N >= 2.
    u, y : ndarray, shape (N,)
        Input and output (V in the lab).
    Ts : float
        Sampling time in seconds; it must agree with `t`.
    y_measured, y_noise_reduced : ndarray, shape (N,), optional
        Both outputs of a lab record, as logged and after the rig's noise reduction; `y` is one of them.
    reference : ndarray, shape (N,), optional
        The set point of a closed-loop record.
    name : str
        Name for messages and titles.
    jitter : float
        Root-mean-square deviation of the file's time stamps from `t`, in sampling times; 0 if `t` holds the stamps.

    Raises
    ------
    ValueError
        If a signal is not one-dimensional or not finite, if the lengths differ, if there are fewer than two
        samples, or if the times do not increase in regular steps of `Ts`.
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

    def __post_init__(self) -> None:
        present = {name: getattr(self, name) for name in _OPTIONAL if getattr(self, name) is not None}
        names = ("t", "u", "y", *present)
        signals = as_signals(at_least=2, t=self.t, u=self.u, y=self.y, **present)
        Ts = float(self.Ts)
        sizes = [fault for name, x in zip(names, signals, strict=True) for fault in _size_faults(name, x)]
        faults = sizes or _time_faults(signals[0]) or _disagreement(sampling_time(signals[0]), Ts, signals[0].size)
        if faults:
            raise ValueError(faults[0].text)
        freeze(self, **dict(zip(names, signals, strict=True)))
        object.__setattr__(self, "Ts", Ts)

    def __len__(self) -> int:
        return int(self.t.size)

    def __repr__(self) -> str:
        return (
            f"Record({self.name!r}: {len(self)} samples, Ts = {self.Ts:g} s, "
            f"u {self.u.min():.4g}..{self.u.max():.4g}, y {self.y.min():.4g}..{self.y.max():.4g})"
        )


class Fault(NamedTuple):
    """A reason to refuse a record: its topic, and a sentence with place and remedy."""

    topic: str
    text: str


def load_record(
    path: str | PathLike[str],
    output: str = "noise-reduced",
    columns: str | None = None,
    Ts: float | None = None,
    allow_jitter: bool = False,
) -> Record:
    """Read a record from a MATLAB `.mat` file in the lab's layout, or from delimited text.

    Parameters
    ----------
    path : path
        ``.mat`` of version 5 or 7 that holds ``LogData`` (or ``SFLogData``, closed loop), or text with the
        columns ``t,u,y``.
    output : {"noise-reduced", "measured"}
        Which output of a ``.mat`` becomes `y`: column 2 or column 1 of ``LogData.signals(1).values``.
    columns : str, optional
        Names or numbers (from 1) of the columns to use: ``"t,u,y"``, or two for ``"u,y"`` with `Ts`.
    Ts : float, optional
        Sampling time in seconds of a file without times; if there are times, they must agree with it.
    allow_jitter : bool
        Replace stamps that jitter by up to 0.3 of the sampling time by even times, instead of refusing them.

    Returns
    -------
    Record

    Raises
    ------
    OSError
        If the file does not exist or cannot be opened.
    ValueError
        If the file is not a valid record; the message names the fault and its place.

    Notes
    -----
    Step 1a of the UNSW lab: ``t = LogData.time`` and so on. Faults are not repaired; `labsid check`
    describes a refused file.
    """
    raw = read_raw(path, output=output, columns=columns, Ts=Ts)
    raw, jitter = _evened(raw) if allow_jitter else (raw, 0.0)
    faults = find_faults(raw)
    if faults:
        raise ValueError(refusal(path, faults))
    t = raw.t
    if t is None:
        assert raw.Ts is not None  # find_faults refuses a record that has neither
        t = frozen_array(np.arange(raw.u.size) * raw.Ts)
    return Record(
        t=t,
        u=raw.u,
        y=raw.y,
        Ts=sampling_time(t) if raw.Ts is None else raw.Ts,
        y_measured=raw.y_measured,
        y_noise_reduced=raw.y_noise_reduced,
        reference=raw.reference,
        name=raw.name,
        jitter=jitter,
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
            as_signal(name, column, at_least=2)
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
    if not faults and look_swapped(raw.u, raw.y):
        levels = np.unique(raw.y).size
        text = (
            f"u and y look swapped: y holds {levels} exact levels, while u moves after each change of y as an "
            "output does. Name the columns the other way round."
        )
        faults.append(Fault("signals", text))
    return tuple(faults)


def is_sound(values: FloatArray) -> bool:
    """Whether all values are finite and at most `LARGEST` in magnitude."""
    return bool(np.all(np.abs(values) <= LARGEST))


def _size_faults(name: str, column: FloatArray) -> list[Fault]:
    k = int(np.argmax(np.abs(column)))
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


def _evened(raw: RawRecord) -> tuple[RawRecord, float]:
    """The record with even times in place of jittering stamps, and the jitter; regular stamps are kept."""
    if raw.t is None or raw.t.size < 2 or not is_sound(raw.t):
        return raw, 0.0
    even = fit_even_times(raw.t)
    if even is None or (even.jitter <= REGULAR_WITHIN and not _time_faults(raw.t)):
        return raw, 0.0
    return replace(raw, t=even.t), even.jitter


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
            "Cut the record there, or sort it if its lines are out of order."
        )
        return [Fault("sampling", text)]
    usual = float(np.median(steps))
    odd = np.flatnonzero(np.abs(steps - usual) > REGULAR_WITHIN * usual)
    if odd.size:
        k = odd[0]
        many = f", {odd.size} such intervals in all" if odd.size > 1 else ""
        text = (
            f"sampling is irregular: {usual:g} s as a rule, but {steps[k]:g} s from sample {k} (t = {t[k]:g} s) "
            f"to the next{many}. Resample or cut the record; where the times are merely rounded, read it "
            "without them (columns u,y and Ts)."
        )
        return [Fault("sampling", text)]
    return []


def _disagreement(found: float, given: float, samples: int) -> list[Fault]:
    # Rounding of Ts is accepted: less than half a sample over the whole record.
    if abs(found - given) * (samples - 1) <= 0.5 * found and abs(found - given) <= REGULAR_WITHIN * found:
        return []
    text = f"Ts = {given:g} s disagrees with the times, which step by {found:g} s. Leave one of them out."
    return [Fault("sampling", text)]
