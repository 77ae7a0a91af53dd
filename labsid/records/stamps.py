"""Time stamps as loggers write them, in seconds: units, counters that wrap, dates, epochs, times of day."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.column import Column
from labsid.records.units import SECONDS, time_unit_of, unit_in_time_name

IN_SECONDS = "t"  # the name of the times in the format `t,u,y`, which is in seconds
COARSE_COUNT = 10  # steps of whole numbers from which they may be milli- or microseconds as well as seconds
_WRAP = 2**32
_EPOCH = 9.4e8, 2.2e9  # Unix seconds of the years 2000 and 2039
_DATENUM = 7.2e5, 7.5e5  # days since the year 0 of the years 1971 and 2053
_SERIAL = 3.65e4, 5.5e4  # days since 1899 of the years 1999 and 2050, as spreadsheets count them
_SHORT = 1e-3  # of the unit: of seconds a step that is rare beside an offset of half a day, of days 86 s
_HALF_DAY = 43200.0


class NoTimes(ValueError):
    """A column counts samples, not time."""


@dataclass(frozen=True, slots=True, eq=False)
class Stamps:
    """Time stamps in seconds.

    Attributes
    ----------
    t : ndarray, shape (N,)
        NaN where a stamp is missing; from the first stamp on if the stamps are dates.
    notes : tuple of str
        What was assumed and done.
    """

    t: FloatArray
    notes: tuple[str, ...] = ()


def in_seconds(column: Column, unit: str | None = None) -> Stamps:
    """Convert a column of time stamps to seconds.

    Parameters
    ----------
    column : Column
    unit : str, optional
        A key of `labsid.records.units.SECONDS`, in the place of the unit that the column names.

    Raises
    ------
    ValueError
        If the unit is not known and the numbers can be read in two ways.
    """
    values = column.values
    if values.size == 0:
        return Stamps(np.empty(0))
    if values.dtype.kind == "M":
        return _from_dates(values)
    if values.dtype.kind == "u" and values.dtype.itemsize < 8:
        values = values.astype(np.int64)
    notes: list[str] = []
    if column.unit.lower() in ("sequence", "samples") and np.all(np.diff(values) == 1):
        raise NoTimes(
            f"{column.name} counts samples ({column.unit}), not time. Give the input and the output alone, and the "
            "sampling time, which such a file names in its header (--columns u,y --Ts SECONDS)."
        )
    named = time_unit_of(column.unit) or unit_in_time_name(column.name)
    if column.unit == "h:m:s":
        days = np.concatenate([[0], np.cumsum(np.diff(values) < -_HALF_DAY)])
        if days[-1]:
            notes.append(f"times of day pass midnight {_times(int(days[-1]))}; a day added there")
        return Stamps(values + 2 * _HALF_DAY * days, tuple(notes))
    if values.dtype.kind == "i":
        wraps = np.concatenate([[0], np.cumsum(np.diff(values) < -_WRAP // 2)])
        if wraps[-1]:
            values = values + _WRAP * wraps
            notes.append(f"the 32-bit counter {column.name} wraps {_times(int(wraps[-1]))}; unwrapped")
    if values.dtype == np.float32:
        digits = int(np.floor(-np.log10(np.spacing(max(float(np.nanmax(np.abs(values))), 1e-6), dtype=np.float32))))
        values = np.round(values.astype(np.float64), digits)
    first = values[0]
    since = (values - first).astype(np.float64)
    epoch = None if unit or named else _epoch_unit(values, since)
    chosen = unit or named or epoch
    if chosen is None:
        step = _usual_step(since)
        if column.name != IN_SECONDS:
            _refuse_two_readings(column.name, values, step)
        elif step < _SHORT:
            _refuse_days(column.name, values, step)
        chosen = "s"
    scale = SECONDS[chosen]
    if chosen != "s":
        whence = "as given" if unit else "by its name" if named else "by its size"
        notes.append(f"{column.name} read as {_WORDS[chosen]} ({whence})")
    absolute = float(first) * scale
    if epoch or (_EPOCH[0] < absolute < _EPOCH[1]):
        when = datetime.fromtimestamp(round(absolute, 6), UTC)
        notes.append(f"times count from {_date_text(when)} UTC, the first stamp")
        return Stamps(_rounded(since * scale, values, absolute), tuple(notes))
    if chosen == "days" and _DATENUM[0] < float(first) < _DATENUM[1]:
        when = datetime(1, 1, 1) + timedelta(days=float(first) - 367.0)
        notes.append(f"times count from {_date_text(when)}, the first stamp")
        return Stamps(_rounded(since * scale, values, absolute), tuple(notes))
    return Stamps(values.astype(np.float64) * scale, tuple(notes))


_WORDS = {
    "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds", "min": "minutes", "h": "hours", "days": "days",
}  # fmt: skip


def _from_dates(values: np.ndarray) -> Stamps:
    known = values[~np.isnat(values)]
    if not known.size:
        return Stamps(np.full(values.size, np.nan))
    since = (values - known[0]).astype(np.int64) * 1e-9
    t = np.where(np.isnat(values), np.nan, since)
    text = str(known[0].astype("datetime64[ms]")).replace("T", " ").removesuffix(".000")
    return Stamps(t, (f"times count from {text}, the first stamp",))


def _epoch_unit(values: np.ndarray, since: FloatArray) -> str | None:
    """The unit in which the stamps are Unix times of this century, if one is."""
    for unit in ("s", "ms", "us", "ns"):
        first = float(values[0]) * SECONDS[unit]
        if _EPOCH[0] < first < _EPOCH[1]:
            coarse = unit == "s" and values.dtype.kind == "i" and _usual_step(since) >= COARSE_COUNT
            return None if coarse else unit
    return None


def _refuse_two_readings(name: str, values: np.ndarray, step: float) -> None:
    is_whole = values.dtype.kind == "i" or np.allclose(values, np.round(values), 1e-9, 1e-6)
    if is_whole and step >= COARSE_COUNT:
        raise ValueError(
            f"{name} counts in whole numbers, {step:g} apart, and does not say its unit. Say it with time_unit "
            f"(--time-unit ms if it counts milliseconds, us, or s for seconds)."
        )
    _refuse_days(name, values, step)


def _refuse_days(name: str, values: np.ndarray, step: float) -> None:
    """Refuse numbers that may be days of MATLAB or of a spreadsheet."""
    if values.dtype.kind != "f" or step <= 0.0:
        return
    is_datenum = _DATENUM[0] < values[0] < _DATENUM[1] and step < 0.5
    is_serial = _SERIAL[0] < values[0] < _SERIAL[1] and step < _SHORT
    if is_datenum or is_serial:
        of = "MATLAB's datenum" if is_datenum else "of a spreadsheet"
        raise ValueError(
            f"{name} may hold seconds or days ({of}); got {float(values[0])!r} in the first row. Say which "
            "with time_unit (--time-unit days, or s)."
        )


def _rounded(since: FloatArray, values: np.ndarray, absolute: float) -> FloatArray:
    """Differences of large floats, without the digits that those could not hold."""
    if values.dtype.kind == "i":
        return since
    return np.round(since, int(np.floor(-np.log10(2.0 * np.spacing(absolute)))))


def _usual_step(since: FloatArray) -> float:
    steps = np.abs(np.diff(since))
    steps = steps[steps > 0.0]
    return float(np.median(steps)) if steps.size else 0.0


def _date_text(when: datetime) -> str:
    return when.isoformat(" ", "milliseconds").replace("+00:00", "").removesuffix(".000")


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
