"""What the columns of a log look like: for the table of ``labsid check`` and the line to type."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labsid.records.column import Column, Log, stamps_column
from labsid.records.resampling import is_held
from labsid.records.stamps import NoTimes, in_seconds
from labsid.records.units import is_time_name

MAX_COLUMNS = 200  # that are described
MAX_VALUES = 2**24  # of the columns that are described
_TOGETHER = 8  # columns that are read at once
_INPUT_WORDS = (
    "u",
    "input",
    "cmd",
    "command",
    "pwm",
    "heater",
    "pump",
    "goal",
    "action",
    "effort",
    "volt",
    "duty",
    "q1",
    "q2",
)
_OUTPUT_WORDS = (
    "y",
    "output",
    "speed",
    "position",
    "temp",
    "level",
    "angle",
    "pressure",
    "velocity",
    "state",
    "t1",
    "t2",
)


@dataclass(frozen=True, slots=True)
class ColumnSummary:
    """A column of a log in one row of a table.

    Attributes
    ----------
    name, unit : str
    samples : int
    interval : float or None
        Median interval of its own stamps, or of its values if it looks like the time; in seconds.
    low, high : float or None
        Range; None without any number.
    missing : float
        Share of the samples that are missing.
    role : {"time", "input", "output", "constant", "text"}
    why : str
        The reason for the role.
    """

    name: str
    unit: str
    samples: int
    interval: float | None
    low: float | None
    high: float | None
    missing: float
    role: str
    why: str


def summarize(log: Log) -> list[ColumnSummary]:
    """Describe the columns of a log, the first `MAX_COLUMNS` of them."""
    summaries: list[ColumnSummary] = []
    total = 0
    places = range(min(len(log.names), MAX_COLUMNS))
    for first in range(0, len(places), _TOGETHER):
        for column in _read(log, places[first : first + _TOGETHER]):
            summaries.append(column if isinstance(column, ColumnSummary) else _summary(column))
            total += 0 if isinstance(column, ColumnSummary) else column.values.size
        if total > MAX_VALUES:
            break
    return summaries


def _read(log: Log, places: Sequence[int]) -> list[Column | ColumnSummary]:
    """Columns, or the summary of one that cannot be read."""
    try:
        return [*log.read(places)]
    except ValueError as error:
        if len(places) == 1:
            return [ColumnSummary(log.names[places[0]], "", 0, None, None, None, 0.0, "text", str(error))]
        return [column for place in places for column in _read(log, [place])]


def suggested_options(summaries: Sequence[ColumnSummary]) -> list[str]:
    """What to type: the only time, input and output; capitals where there are several or none."""
    times, roles = _roles(summaries)
    if not roles["INPUT"] and len(roles["OUTPUT"]) == 2:
        roles = {"INPUT": [], "OUTPUT": []}
    own = any(one.interval for one in summaries)
    named = [names[0] if len(names) == 1 else word for word, names in roles.items()]
    if not times:
        return ["--columns", ",".join(named), *([] if own else ["--Ts", "SECONDS"])]
    return ["--columns", ",".join([times[0] if len(times) == 1 else "TIME", *named])]


def options_of_several(summaries: Sequence[ColumnSummary]) -> list[str]:
    """What to type to read all inputs and outputs; nothing if there is only one of each, or none of one."""
    times, roles = _roles(summaries)
    inputs, outputs = roles["INPUT"], roles["OUTPUT"]
    if not (inputs and outputs) or len(inputs) + len(outputs) == 2:
        return []
    own = any(one.interval for one in summaries)
    more = [] if times or own else ["--Ts", "SECONDS"]
    return ["--inputs", ",".join(inputs), "--outputs", ",".join(outputs), *more]


def _roles(summaries: Sequence[ColumnSummary]) -> tuple[list[str], dict[str, list[str]]]:
    """Names of the times, and of inputs and outputs; numbers where a name does not tell a column from the others."""
    often = Counter(one.name for one in summaries)
    names = [
        one.name if often[one.name] == 1 and "," not in one.name else str(k + 1) for k, one in enumerate(summaries)
    ]
    times = [name for name, one in zip(names, summaries, strict=True) if one.role == "time"]
    roles: dict[str, list[str]] = {"INPUT": [], "OUTPUT": []}
    for name, one in zip(names, summaries, strict=True):
        if one.role in ("input", "output"):
            roles[one.role.upper()].append(name)
    return times, roles


def _summary(column: Column) -> ColumnSummary:
    values, interval = column.values, None
    if column.stamps is not None and column.stamps.size > 1:
        interval = _interval(in_seconds(stamps_column(column.stamps)).t)
    if values.dtype.kind == "M" or column.unit == "h:m:s":
        return ColumnSummary(
            column.name, "", values.size, _interval(in_seconds(column).t), None, None, 0.0, "time", "dates or times"
        )
    numbers = column.numbers
    known = numbers[np.isfinite(numbers)]
    if not known.size:
        return ColumnSummary(column.name, column.unit, values.size, interval, None, None, 1.0, "text", "no numbers")
    role, why = _role(column.name, known)
    if role == "time":
        try:
            interval = _interval(in_seconds(column).t)
        except NoTimes:
            role, why = "constant", "it counts samples"
        except ValueError:
            why = f"{why}; its unit is not said (--time-unit)"
    missing = 1.0 - known.size / numbers.size
    return ColumnSummary(
        column.name, column.unit, values.size, interval, float(known.min()), float(known.max()), missing, role, why
    )


def _interval(t: np.ndarray) -> float | None:
    steps = np.diff(t)
    steps = steps[steps > 0.0]
    return float(np.median(steps)) if steps.size else None


def _role(name: str, known: np.ndarray) -> tuple[str, str]:
    word = name.lower()
    rises = known.size > 2 and float(np.mean(np.diff(known) > 0.0)) > 0.99
    if np.all(known == known[0]):
        return "constant", "one value"
    if is_time_name(name) and float(np.mean(np.diff(known) >= 0.0)) > 0.9:
        return "time", "by its name, and it rises"
    if rises:
        return "time", "it rises at every sample"
    parts = {
        part.strip("[]()0123456789") for part in word.replace("/", " ").replace("_", " ").replace(".", " ").split()
    }
    parts |= {word.strip(), *word.split("[")}
    if parts & set(_INPUT_WORDS):
        return "input", "by its name"
    if parts & set(_OUTPUT_WORDS):
        return "output", "by its name"
    levels = np.unique(known).size
    if levels <= 20 or is_held(known):
        return "input", f"held: {levels} different values"
    return "output", "moves at nearly every sample"
