"""Messages of robots as columns: ``/joint_states.position[elbow]`` is one number of each message of a topic."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from labsid.records.column import Column, Log

FIRST = 20  # messages of a topic whose numbers become its columns: a field may be absent from the first one
MAX_ELEMENTS = 64  # of an array in a message; longer ones are images or scans
_STAMPS = ("stamp", "timestamp")
_SECONDS, _NANOSECONDS = ("sec", "secs", "seconds"), ("nanosec", "nsec", "nsecs", "nanos")
_MAX_DEPTH = 12
_MAX_VALUES = 2**25  # numbers of the chosen columns

Part = str | int | tuple[str, str]
"""A step into a message: a field, an index, or the element of the first named field's array with the second's name."""
Messages = Callable[[Sequence[str]], Iterator[tuple[str, int, Any]]]


def message_log(first: Iterable[tuple[str, Any]], messages: Messages, notes: Sequence[str] = ()) -> Log:
    """The numbers in the messages of a log as columns.

    Parameters
    ----------
    first : iterable of (topic, message)
        The first messages of each topic, up to `FIRST`, whose numbers become the columns.
    messages : callable
        ``messages(topics)`` yields (topic, time in nanoseconds, message) in the order of time.
    notes : sequence of str

    Returns
    -------
    Log
        Each column has the stamps of its messages: that of the header or of the message if it has one, else the time
        of logging.

    Raises
    ------
    ValueError
        If no message holds numbers.
    """
    paths = list(dict.fromkeys((topic, path) for topic, message in first for path in _paths(message)))
    if not paths:
        raise ValueError("its messages hold no numbers that are read here.")

    def read(places: Sequence[int]) -> list[Column]:
        topics = sorted({paths[k][0] for k in places})
        values: dict[int, list[float]] = {k: [] for k in places}
        stamps: dict[str, list[int]] = {topic: [] for topic in topics}
        count = 0
        for topic, logged, message in messages(topics):
            stamps[topic].append(_header_stamp(message) or logged)
            for k in values:
                if paths[k][0] == topic:
                    values[k].append(_number(message, paths[k][1]))
                    count += 1
            if count > _MAX_VALUES:
                raise ValueError(f"the chosen columns hold over {_MAX_VALUES} numbers. Cut the log.")
        return [
            Column(_name(*paths[k]), np.array(values[k]), "", np.array(stamps[paths[k][0]], np.int64)) for k in places
        ]

    return Log(tuple(_name(*path) for path in paths), read, what="field", notes=tuple(notes))


def _name(topic: str, path: Sequence[Part]) -> str:
    name = topic
    for part in path:
        if isinstance(part, tuple):
            name += f"[{part[1]}]"
        else:
            name += f"[{part}]" if isinstance(part, int) else f".{part}"
    return name


def _paths(value: Any, path: tuple[Part, ...] = (), labels: Sequence[str] = ()) -> list[tuple[Part, ...]]:
    """The ways to each number in a message."""
    if len(path) > _MAX_DEPTH:
        return []
    if value is None or isinstance(value, bool | int | float | np.number | np.bool_):
        return [path]
    members = _members(value)
    if members is not None:
        labels = _labels(members)
        paths = []
        for name, inner in members.items():
            if not (name in ("header", *_STAMPS) and _members(inner) and _header_stamp(value)):
                paths += _paths(inner, (*path, name), labels)
        return paths
    if isinstance(value, list | tuple | np.ndarray) and len(value) <= MAX_ELEMENTS:
        field = path[-1] if path else ""
        named = len(labels) == len(value) and isinstance(field, str) and len(set(labels)) == len(labels)
        paths = []
        for k, inner in enumerate(value):
            step: Part = (str(field), labels[k]) if named else k
            paths += _paths(inner, (*path, step))
        return paths
    return []


def _labels(members: dict[str, Any]) -> list[str]:
    """Names of the elements of the arrays beside them, as in JointState."""
    names = members.get("name", members.get("names", []))
    return [str(one) for one in names] if isinstance(names, list | tuple | np.ndarray) else []


def _members(value: Any) -> dict[str, Any] | None:
    if isinstance(value, dict):
        return {str(key): inner for key, inner in value.items()}
    if is_dataclass(value):
        return {one.name: getattr(value, one.name) for one in fields(value) if not one.name.startswith("__")}
    return None


def _number(message: Any, path: Sequence[Part]) -> float:
    """The number at the end of a way; NaN where a message has none."""
    value: Any = message
    owner: Any = message
    try:
        for part in path:
            if isinstance(part, tuple):
                value = value[_labels(_members(owner) or {}).index(part[1])]
            elif isinstance(part, int):
                value = value[part]
            else:
                owner = value
                value = value[part] if isinstance(value, dict) else getattr(value, part)
        return float(value)
    except (KeyError, IndexError, AttributeError, TypeError, ValueError):
        return np.nan


def _header_stamp(message: Any) -> int:
    """The stamp of a message or of its header in nanoseconds; 0 without one."""
    own = _members(message) or {}
    header = _members(own.get("header")) or {}
    for stamp in (header.get("stamp"), *(own.get(name) for name in _STAMPS)):
        members = _members(stamp) or {}
        seconds = next((members[name] for name in _SECONDS if name in members), None)
        if isinstance(seconds, int | np.integer):
            rest = next((members[name] for name in _NANOSECONDS if name in members), 0)
            return int(seconds) * 10**9 + int(rest)
    return 0
