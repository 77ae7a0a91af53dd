"""Units in the headers of logs, and the units of time."""

import re
from collections import Counter
from collections.abc import Sequence

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "days": 86400.0}

_SAME = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "sek": "s", "sekunden": "s",
    "msec": "ms", "millis": "ms", "milliseconds": "ms", "millisecond": "ms", "msek": "ms",
    "µs": "us", "μs": "us", "usec": "us", "micros": "us", "microseconds": "us", "microsecond": "us",
    "nsec": "ns", "nanos": "ns", "nanoseconds": "ns", "minutes": "min", "mins": "min",
    "hr": "h", "hours": "h", "hour": "h", "d": "days", "day": "days", "datenum": "days",
}  # fmt: skip
_TIME_NAMES = {
    "t", "time", "timestamp", "timestamps", "stamp", "zeit", "zeitstempel", "temps", "tiempo", "tempo", "clock",
    "elapsed", "datetime", "date", "datenum", "epoch", "unixtime", "uptime", "tick", "ticks", "us", "ms", "millis",
    "micros", "sec", "secs", "seconds", "milliseconds", "microseconds", "nanoseconds", "timestep", "tout", "x_value",
}  # fmt: skip
_UNITS = {
    "V", "mV", "kV", "A", "mA", "W", "kW", "m", "mm", "cm", "km", "rad", "deg", "°", "°C", "degC", "C", "K", "F", "%",
    "Hz", "rpm", "1/min", "N", "kN", "Nm", "N m", "Pa", "kPa", "hPa", "bar", "mbar", "g", "kg", "l", "L", "l/min",
    "L/min", "m/s", "mm/s", "cm/s", "rad/s", "deg/s", "°/s", "m/s^2", "m/s²", "-", "1", "lx", "ppm", "pu",
    "Volt", "Volts", "Ampere", "Amps", "Sequence",  # of oscilloscopes
}  # fmt: skip
_WORDS = re.compile(r"[^\W\d_]+")
_HUMP = re.compile(r"(?<=[a-zµμ])(?=[A-Z])")  # of timeMs
_IN_BRACKETS = re.compile(r"^(.*?)[\s_]*[\[(]([^\[\]()]{0,16})[\])]\s*$")


def split_unit(name: str) -> tuple[str, str]:
    """Split ``Level [cm]`` or ``Time (s)`` into the name and the unit; the unit is empty if there is none."""
    found = _IN_BRACKETS.match(name.strip())
    if found is None or not found[1] or re.fullmatch(r"\d+|[^\W\d]\w{4,}", found[2]):  # position[2], position[elbow]
        return name.strip(), ""
    return found[1].strip(), found[2].strip()


def split_units(names: Sequence[str]) -> tuple[list[str], list[str]]:
    """Names and units of a header; V(in) and V(out), which differ in the brackets only, keep them in their names."""
    parts = [split_unit(name) for name in names]
    often = Counter(name for name, _ in parts)
    bare = [short if often[short] == 1 else name.strip() for name, (short, _) in zip(names, parts, strict=True)]
    return bare, [unit if often[short] == 1 or is_unit(unit) else "" for short, unit in parts]


def is_unit(text: str) -> bool:
    """Whether a field of a second header row is a unit, in brackets or among the usual ones."""
    bare = text.strip().strip("[]()").strip()
    return bare in _UNITS or time_unit_of(bare) is not None


def time_unit_of(text: str) -> str | None:
    """The unit of time that a text names, as a key of `SECONDS`."""
    word = text.strip().strip("[]()").removeprefix("in ").strip().rstrip(".")
    word = word if word in SECONDS else word.lower()
    return _SAME.get(word, word if word in SECONDS else None)


def is_time_name(name: str) -> bool:
    """Whether a column of this name, without its unit, holds times."""
    if name.strip().lower() in _TIME_NAMES:
        return True
    *stem, last = _words(name) or [""]
    return "_".join(stem) in _TIME_NAMES and time_unit_of(last) is not None


def unit_in_time_name(name: str) -> str | None:
    """The unit of ``time_ms``, ``t/ms``, ``timeMs``, ``ms since start`` or ``us``; None if the name says none."""
    words = _words(name)
    if not words or words in (["t"], ["d"]) or words[-2:] == ["of", "day"]:
        return None
    said = {unit for word in words if len(word) > 1 and (unit := time_unit_of(word))}
    return time_unit_of(words[-1]) or (said.pop() if len(said) == 1 else None)


def _words(name: str) -> list[str]:
    """The words of a name in lower case, whatever stands between them."""
    return [word.lower() for word in _WORDS.findall(_HUMP.sub(" ", name))]
