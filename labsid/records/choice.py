"""Which column of a log is the time, the input and the output: as named by the caller, or by the header."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid.records.column import Column, Log, listed, stamps_column
from labsid.records.units import is_time_name

_INPUT_NAMES, _OUTPUT_NAMES = ("u", "input"), ("y", "output")


class UnknownColumns(ValueError):
    """Which columns are time, input and output is not known: the caller has to name them."""


@dataclass(frozen=True, slots=True, eq=False)
class Chosen:
    """The columns of a record.

    Attributes
    ----------
    t : Column or None
        None if the log has no times, or each signal its own.
    u, y : Column
    others : tuple of Column
        Further signals of a lab record, named as in `labsid.records.formats.RawRecord`.
    notes : tuple of str
    """

    t: Column | None
    u: Column
    y: Column
    others: tuple[Column, ...] = ()
    notes: tuple[str, ...] = ()


def choose(log: Log, columns: str | None, Ts: float | None) -> Chosen:
    """Read the columns t,u,y or u,y of a log.

    Parameters
    ----------
    log : Log
    columns : str or None
        Names or numbers (from 1) of two or three columns; None for those that the header names.
    Ts : float or None
        Sampling time in seconds; if given, the log needs no times.

    Raises
    ------
    ValueError
        If a column is missing, or the header does not say which column is which.
    """
    notes: list[str] = []
    if columns is None:
        places, notes = _by_header(log, Ts)
    else:
        names = split_columns(columns)
        if not log.has_names and len(log.names) == len(names) and names == ["t", "u", "y"][-len(names) :]:
            places, notes = list(range(len(names))), [f"no header: columns taken as {columns}"]
        else:
            places = [_find(name, log) for name in names]
    read = log.read([*places, *log.others])
    main, others = read[: len(places)], read[len(places) :]
    t = main[0] if len(main) == 3 else None
    if t is not None:
        t = _with_fraction(t, log, notes)
    u, y = main[-2:]
    for column in (u, y):
        if column.values.dtype.kind == "M":
            raise ValueError(f"{log.what} {column.name} holds dates, not a signal. Name the columns as t,u,y.")
    said = [note for column in main for note in column.notes]
    return Chosen(t, u, y, tuple(others), (*log.notes, *notes, *said))


def _with_fraction(t: Column, log: Log, notes: list[str]) -> Column:
    """Whole seconds together with the nanoseconds that stand in a column beside them, as ROS and POSIX write them."""
    found = re.fullmatch(r"(.*?)(secs?)", t.name)
    if found is None or t.values.dtype.kind != "i":
        return t
    stem, seconds = found.groups()
    names = [f"{stem}{prefix}{seconds}" for prefix in ("nano", "n")]
    beside = [k for k, name in enumerate(log.names) if name in names]
    if len(beside) != 1:
        return t
    (fraction,) = log.read(beside)
    if fraction.values.dtype.kind != "i" or not np.all((fraction.values >= 0) & (fraction.values < 10**9)):
        return t
    notes.append(f"times are {t.name} and {fraction.name} together")
    return replace(stamps_column(t.values * 10**9 + fraction.values), name=t.name, notes=t.notes)


def split_columns(columns: str) -> list[str]:
    """Split the `columns` argument into two or three names.

    Raises
    ------
    ValueError
        If the number of names is not two or three, or a name occurs twice.
    """
    names = [name.strip() for name in columns.split(",")]
    if len(names) not in (2, 3) or not all(names):
        raise ValueError(f"columns must name three columns, t,u,y, or two, u,y; got {columns!r}.")
    if len(set(names)) < len(names):
        raise ValueError(f"columns must name different columns; got {columns!r}.")
    return names


def _by_header(log: Log, Ts: float | None) -> tuple[list[int], list[str]]:
    """Places of t,u,y or u,y as the header names them, and a note if there is no header."""
    width = len(log.names)
    if log.has_names:
        u, y = _only(log.names, _INPUT_NAMES), _only(log.names, _OUTPUT_NAMES)
        t = _time(log.names)
        if u is not None and y is not None and (t is not None or Ts is not None or _own_stamps(log, u, y)):
            return [*([] if t is None else [t]), u, y], []
    elif width == 3:
        return [0, 1, 2], ["no header: columns taken as t,u,y"]
    elif width == 2 and Ts is not None:
        return [0, 1], ["no header: columns taken as u,y"]
    raise UnknownColumns(
        f"no columns t,u,y; {_there(log)}. Choose columns by name or number with columns "
        "(--columns t,u,y, or --columns u,y and --Ts); `labsid check` describes each."
    )


def _own_stamps(log: Log, u: int, y: int) -> bool:
    return all(column.stamps is not None for column in log.read([u, y]))


def _only(names: Sequence[str], wanted: Sequence[str]) -> int | None:
    """Place of the only column with one of these names, or whose last part is one; None if it is not certain."""
    exact = [k for k, name in enumerate(names) if name == wanted[0]]
    if len(exact) == 1:
        return exact[0]
    for part in (str.lower, _last_part):
        found = [k for k, name in enumerate(names) if part(name) in wanted]
        if found:
            return found[0] if len(found) == 1 else None
    return None


def _time(names: Sequence[str]) -> int | None:
    """Place of the column that holds the times; None if there is none, or several."""
    for test in (
        lambda name: name == "t",
        lambda name: name.lower() in ("t", "time"),
        is_time_name,
        lambda name: is_time_name(_last_part(name)),
    ):
        found = [k for k, name in enumerate(names) if test(name)]
        if found:
            return found[0] if len(found) == 1 else None
    return None


def _last_part(name: str) -> str:
    """``data.input`` and ``/rig/input`` end in ``input``."""
    return name.lower().replace("/", ".").rpartition(".")[2]


def _find(name: str, log: Log) -> int:
    exact = [k for k, other in enumerate(log.names) if other == name]
    if len(exact) > 1:
        raise UnknownColumns(
            f"{len(exact)} {log.what}s are called {name!r}. Give the number of one: "
            f"{', '.join(str(k + 1) for k in exact[:20])}."
        )
    if exact:
        return exact[0]
    if name.isdecimal() and 1 <= int(name) <= len(log.names):
        return int(name) - 1
    bare = name.split("[")[0].split("(")[0].strip()
    for same in (
        [k for k, other in enumerate(log.names) if bare and other == bare],
        [k for k, other in enumerate(log.names) if other.lower() == name.lower()],
        [k for k, other in enumerate(log.names) if other.endswith((f".{name}", f"/{name}"))],
    ):
        if len(same) == 1:
            return same[0]
    parts = [other for other in log.names if other.startswith((f"{name}.", f"{name}["))]
    if parts:
        raise UnknownColumns(f"{log.what} {name} has {len(parts)} columns. Name one of them: {', '.join(parts[:20])}.")
    hint = "" if log.has_names else ". Give numbers, such as 1,2"
    inside = "" if log.what == "column" else " in it"
    raise UnknownColumns(f"there is no {log.what} {name!r}{inside}; {_there(log)}{hint}.")


def _there(log: Log) -> str:
    if not log.has_names:
        names = "" if log.names[:1] == ("1",) else f", {log.names[0]} to {log.names[-1]}"
        return f"the columns are 1 to {len(log.names)}{names} (there is no header)"
    names = listed(log.names) or "none"
    return f"the columns are {names}" if log.what == "column" else f"it holds {names}"
