"""Which columns of a log are time, inputs and outputs: as named by the caller, or by the header."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid.records.column import Column, Log, listed, stamps_column
from labsid.records.reading import Reading
from labsid.records.units import is_time_name

_INPUT_NAMES, _OUTPUT_NAMES = ("u", "input"), ("y", "output")
_OPTIONS = {"inputs": "--inputs a,b", "outputs": "--outputs c,d"}


class UnknownColumns(ValueError):
    """Which columns are time, input and output is not known: the caller has to name them."""


@dataclass(frozen=True, slots=True, eq=False)
class Chosen:
    """The columns of a record.

    Attributes
    ----------
    t : Column or None
        None if the log has no times, or each signal its own.
    inputs, outputs : tuple of Column
    others : tuple of Column
        Further signals, named as in `labsid.records.formats.RawRecord`: the reference, the outputs of a lab record.
    named : bool
        Whether inputs and outputs keep the names of their columns; else they are called u and y.
    notes : tuple of str
    """

    t: Column | None
    inputs: tuple[Column, ...]
    outputs: tuple[Column, ...]
    others: tuple[Column, ...] = ()
    named: bool = False
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Places:
    """Places of the columns of a record in a log."""

    t: int | None
    inputs: Sequence[int]
    outputs: Sequence[int]
    named: bool = False
    notes: Sequence[str] = ()


def choose(log: Log, how: Reading) -> Chosen:
    """Read the columns of a log that make a record.

    Parameters
    ----------
    log : Log
    how : Reading
        Its `columns`, `inputs`, `outputs` and `reference`: names or numbers (from 1); by default those that the header
        names. With a `Ts` the log needs no times.

    Raises
    ------
    ValueError
        If a column is missing, or the header does not say which column is which.
    """
    places = _places(log, how)
    main = [*([] if places.t is None else [places.t]), *places.inputs, *places.outputs]
    reference = [] if how.reference is None else [_find(how.reference, log)]
    if reference and reference[0] in main:
        raise ValueError(
            f"{how.reference!r} is named as the reference and as another signal. Leave it out of one of them."
        )
    read = log.read([*main, *reference, *log.others])
    notes = [*log.notes, *places.notes]
    t = None if places.t is None else _with_fraction(read[0], log, notes)
    signals, others = read[len(main) - len(places.inputs) - len(places.outputs) : len(main)], read[len(main) :]
    if reference:
        others = [
            replace(others[0], name="reference"),
            *(column for column in others[1:] if column.name != "reference"),
        ]
    for column in signals:
        if column.values.dtype.kind == "M":
            raise ValueError(f"{log.what} {column.name} holds dates, not a signal. Name the columns as t,u,y.")
    notes += [note for column in read[: len(main) + len(reference)] for note in column.notes]
    if places.named:
        signals = _told_apart(signals, [*places.inputs, *places.outputs])
    count = len(places.inputs)
    return Chosen(t, tuple(signals[:count]), tuple(signals[count:]), tuple(others), places.named, tuple(notes))


def _places(log: Log, how: Reading) -> _Places:
    if how.inputs is not None or how.outputs is not None:
        return _by_lists(log, how)
    if how.columns is None:
        return _by_header(log, how.Ts)
    names = split_columns(how.columns)
    if not log.has_names and len(log.names) == len(names) and names == ["t", "u", "y"][-len(names) :]:
        return _in_order(range(len(names)), f"no header: columns taken as {how.columns}")
    return _in_order([_find(name, log) for name in names])


def _in_order(places: Sequence[int], *notes: str) -> _Places:
    """Columns t,u,y or u,y."""
    return _Places(places[0] if len(places) == 3 else None, places[-2:-1], places[-1:], notes=notes)


def _by_lists(log: Log, how: Reading) -> _Places:
    """Columns that the caller names as inputs and outputs; of only one of these lists, the header names the other."""
    places_of: dict[str, Sequence[int]] = {}
    for field, given, wanted in (
        ("inputs", how.inputs, _INPUT_NAMES),
        ("outputs", how.outputs, _OUTPUT_NAMES),
    ):
        places = _family(log.names, wanted) if given is None else _listed_places(field, given, log)
        if not places:
            raise UnknownColumns(f"no {field}; {_there(log)}. Name them, by name or number ({_OPTIONS[field]}).")
        places_of[field] = places
    inputs, outputs = places_of["inputs"], places_of["outputs"]
    both = [log.names[place] for place in inputs if place in outputs]
    if both:
        raise ValueError(f"{both[0]!r} is named as an input and as an output. Leave it out of one of them.")
    notes = []
    t = _time(log.names) if how.columns is None else _find(how.columns, log)
    if t is None and not log.has_names and how.Ts is None and 0 not in (*inputs, *outputs):
        t, notes = 0, ["no header: column 1 taken as t"]
    if t in (*inputs, *outputs):
        t = None
    return _Places(t, inputs, outputs, True, notes)


def _listed_places(field: str, given: str, log: Log) -> list[int]:
    """Places of the columns in a list of names; a name that has columns of its own stands for all of them."""
    names = [name.strip() for name in given.split(",")]
    if not all(names):
        raise ValueError(f"{field} must name columns, with commas between them; got {given!r}. Write a,b.")
    places: list[int] = []
    for name in names:
        more = [_find(name, log)] if not _parts(name, log) else [log.names.index(part) for part in _parts(name, log)]
        twice = [place for place in more if place in places]
        if twice:
            raise ValueError(f"{field} must name different columns; got {log.names[twice[0]]!r} twice. Leave out one.")
        places += more
    return places


def _told_apart(columns: Sequence[Column], places: Sequence[int]) -> list[Column]:
    """Columns of which those with one name get their numbers beside it."""
    often = Counter(column.name for column in columns)
    return [
        replace(column, name=f"{column.name} ({place + 1})") if often[column.name] > 1 else column
        for column, place in zip(columns, places, strict=True)
    ]


def _with_fraction(t: Column, log: Log, notes: list[str]) -> Column:
    """Whole seconds together with the nanoseconds that stand in a column beside them, as ROS and POSIX write them."""
    matched = re.fullmatch(r"(.*?)(secs?)", t.name)
    if matched is None or t.values.dtype.kind != "i":
        return t
    stem, seconds = matched.groups()
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


def _by_header(log: Log, Ts: float | None) -> _Places:
    """Places of the columns as the header names them: t,u,y or u,y, or with several signals t,u1,u2,y1."""
    width = len(log.names)
    if log.has_names:
        inputs, outputs = _family(log.names, _INPUT_NAMES), _family(log.names, _OUTPUT_NAMES)
        t = _time(log.names)
        if inputs and outputs and (t is not None or Ts is not None or _own_stamps(log, *inputs, *outputs)):
            numbered = _only(log.names, _INPUT_NAMES) is None or _only(log.names, _OUTPUT_NAMES) is None
            return _Places(t, inputs, outputs, numbered)
    elif width == 3:
        return _in_order([0, 1, 2], "no header: columns taken as t,u,y")
    elif width == 2 and Ts is not None:
        return _in_order([0, 1], "no header: columns taken as u,y")
    raise UnknownColumns(
        f"no columns t,u,y; {_there(log)}. Choose columns by name or number with columns "
        "(--columns t,u,y, or --columns u,y and --Ts); `labsid check` describes each."
    )


def _family(names: Sequence[str], wanted: Sequence[str]) -> list[int]:
    """Places of the only input, or of the numbered ones (u1, u_2, u.3, u[4]) in their order; likewise of outputs."""
    only = _only(names, wanted)
    if only is not None:
        return [only]
    pattern = re.compile(rf"(?:.*[./])?(?:{'|'.join(wanted)})[_.]?\[?(\d+)\]?", re.IGNORECASE)
    found = {k: int(match[1]) for k, name in enumerate(names) if (match := pattern.fullmatch(name))}
    return sorted(found, key=found.__getitem__) if len(set(found.values())) == len(found) else []


def _own_stamps(log: Log, *places: int) -> bool:
    return all(column.stamps is not None for column in log.read(places))


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
    exact = [k for k, known in enumerate(log.names) if known == name]
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
        [k for k, known in enumerate(log.names) if bare and known == bare],
        [k for k, known in enumerate(log.names) if known.lower() == name.lower()],
        [k for k, known in enumerate(log.names) if known.endswith((f".{name}", f"/{name}"))],
    ):
        if len(same) == 1:
            return same[0]
    parts = _parts(name, log)
    if parts:
        raise UnknownColumns(f"{log.what} {name} has {len(parts)} columns. Name one of them: {', '.join(parts[:20])}.")
    hint = "" if log.has_names else ". Give numbers, such as 1,2"
    inside = "" if log.what == "column" else " in it"
    raise UnknownColumns(f"there is no {log.what} {name!r}{inside}; {_there(log)}{hint}.")


def _parts(name: str, log: Log) -> list[str]:
    """The columns of an array or structure of this name, if there is no column of this name itself."""
    return [] if name in log.names else [other for other in log.names if other.startswith((f"{name}.", f"{name}["))]


def _there(log: Log) -> str:
    if not log.has_names:
        names = "" if log.names[:1] == ("1",) else f", {log.names[0]} to {log.names[-1]}"
        return f"the columns are 1 to {len(log.names)}{names} (there is no header)"
    names = listed(log.names) or "none"
    return f"the columns are {names}" if log.what == "column" else f"it holds {names}"
