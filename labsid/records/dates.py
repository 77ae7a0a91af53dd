"""Dates and times of day as loggers and spreadsheets write them."""

import re
from collections.abc import Sequence
from datetime import date as day_of

import numpy as np

_SECONDS = r":(\d\d)(?:[.,](\d+)|:(\d{3}))?"
_HALF = r"(?:\s*([ap])\.?m\.?)?"
_CLOCK = re.compile(rf"(?:(\d{{1,5}})(?: days? |\.))?(\d{{1,2}}):(\d\d){_SECONDS}{_HALF}", re.IGNORECASE)
_DATE = re.compile(
    r"(?:(\d{4})([-/.])(\d{1,2})\2(\d{1,2})"
    r"|(\d{1,2})([-/. ])(\d{1,2}|[a-z]{3})\6(\d{4}|(?<=[/.])\d\d))"
    rf"(?:[T ,_-]\s*(\d{{1,2}}):(\d\d)(?:{_SECONDS})?{_HALF}\s*(Z|UTC|[+-]\d\d(?::?\d\d)?)?)?",
    re.IGNORECASE,
)
_MINUTES = re.compile(r"(\d{1,3}):(\d\d)[.,](\d+)")  # and seconds, as spreadsheets show short times
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_SECOND, _DAY = 10**9, 86400 * 10**9  # in nanoseconds
_EPOCH = day_of(1970, 1, 1).toordinal()
_YEARS = range(1700, 2262)  # that nanoseconds since 1970 reach


def is_date(field: str) -> bool:
    """Whether a field holds a date, with or without a time."""
    return bool(_DATE.fullmatch(field))


def is_time_of_day(field: str) -> bool:
    """Whether a field holds hours, minutes and seconds, perhaps after days, or minutes and seconds with a fraction."""
    return bool(_CLOCK.fullmatch(field) or _MINUTES.fullmatch(field))


def days_come_first(fields: Sequence[str]) -> bool | None:
    """Whether dates such as 3/1/2026 are day/month/year; None if there are none, or their order is certain."""
    found = [one for one in map(_DATE.fullmatch, fields) if one and one[5] and one[6] in "/-" and one[7].isdigit()]
    if not found:
        return None
    firsts, seconds = {int(one[5]) for one in found}, {int(one[7]) for one in found}
    if max(firsts) > 12 or max(seconds) > 12:
        return max(firsts) > 12
    if len(firsts) != len(seconds):  # midnight is passed: the day changes more often than the month
        return len(firsts) > len(seconds)
    return found[0][6] == "-" and not found[0][14]


def date(field: str, day_first: bool = True) -> np.datetime64:
    """A date with its time, in UTC if it has a zone.

    Parameters
    ----------
    field : str
        As 2026-03-01T09:00:00.1+01:00, 01.03.2026 09:00:00,1 or 01-Mar-2026 9:00:00 AM.
    day_first : bool
        Whether the day stands before the month where strokes or hyphens separate two numbers and a year.

    Raises
    ------
    ValueError
        If it is no date.
    """
    match = _DATE.fullmatch(field)
    if match is None:
        raise ValueError(field)
    if match[1]:
        year, month, day = int(match[1]), int(match[3]), int(match[4])
    else:
        year = int(match[8]) + (2000 if len(match[8]) == 2 else 0)
        word = match[7].lower()
        day, month = int(match[5]), int(word) if word.isdigit() else _MONTHS.index(word) + 1
        if word.isdigit() and match[6] in "/-" and not day_first:
            day, month = month, day
    if year not in _YEARS:
        raise ValueError(field)
    since = (day_of(year, month, day).toordinal() - _EPOCH) * _DAY
    if match[9]:
        since += _nanoseconds(*match.group(9, 10, 11, 12, 13, 14))
    zone = match[15]
    if zone and zone[0] in "+-":
        ahead = int(zone[1:3]) * 3600 + int(zone[3:].lstrip(":") or 0) * 60
        since -= (ahead if zone[0] == "+" else -ahead) * _SECOND
    return np.datetime64(since, "ns")


def time_of_day(field: str) -> float:
    """A time of day in seconds.

    Raises
    ------
    ValueError
        If it is none.
    """
    matched = _CLOCK.fullmatch(field)
    if matched is None:
        minutes = _MINUTES.fullmatch(field)
        if minutes is None:
            raise ValueError(field)
        return 60.0 * int(minutes[1]) + float(f"{minutes[2]}.{minutes[3]}")
    days, *rest = matched.groups()
    return (int(days or 0) * _DAY + _nanoseconds(*rest)) / _SECOND


def _nanoseconds(
    hours: str, minutes: str, seconds: str | None, fraction: str | None, thousandths: str | None, half: str | None
) -> int:
    """A time of day; `half` is a or p on a clock of twelve hours."""
    hour, minute, second = int(hours), int(minutes), int(seconds or 0)
    if hour > (12 if half else 24) or minute > 59 or second > 60:
        raise ValueError(f"{hours}:{minutes}")
    if half:
        hour = hour % 12 + (12 if half in "pP" else 0)
    digits = fraction or thousandths or "0"
    return (3600 * hour + 60 * minute + second) * _SECOND + int(digits.ljust(9, "0")[:9])
