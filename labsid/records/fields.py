"""What a field of a text file means: numbers as others write them, switches, dates and times of day."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

MISSING = frozenset({"", "nan", "na", "n/a", "#n/a", "null", "none", "nil", "-", "--", "---", "?", "missing"})
SWITCHES = {
    "on": 1.0, "off": 0.0, "true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0, "high": 1.0, "low": 0.0,
    "ein": 1.0, "aus": 0.0, "open": 1.0, "closed": 0.0,
}  # fmt: skip
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+|[+-]\d{2,3})?|[+-]?inf(inity)?", re.IGNORECASE)
_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d{2,3})$")  # of Fortran: 1.0-114
_GROUPED = re.compile(r"[+-]?\d{1,3}([.,' ])\d{3}(\1\d{3})*([.,]\d+)?")
_ISO = re.compile(r"\d{4}-\d\d-\d\d([T ]\d\d:\d\d(:\d\d([.,]\d+)?)?\s*(Z|[+-]\d\d:?\d\d)?)?", re.IGNORECASE)
_CLOCK = re.compile(r"\d{1,2}:\d\d:\d\d([.,]\d+)?")


@dataclass(frozen=True, slots=True)
class Style:
    """How the numbers of a file are written.

    Attributes
    ----------
    decimal : str
        "." or ",".
    thousands : str
        Mark between groups of three digits; empty without one.
    """

    decimal: str = "."
    thousands: str = ""

    @property
    def note(self) -> tuple[str, ...]:
        """What is to be said about it."""
        said = ["decimal commas read as decimal points"] if self.decimal == "," else []
        said += [f"{self.thousands!r} read as a mark of thousands"] if self.thousands else []
        return tuple(said)


def number_style(fields: Sequence[str], commas_separate: bool) -> Style:
    """Find the decimal mark and the mark of thousands.

    Parameters
    ----------
    fields : sequence of str
        Fields that are numbers.
    commas_separate : bool
        Whether commas separate the columns, so that an unquoted one is in no number.
    """
    commas = points = False
    for field in fields:
        if "," in field and "." in field and _GROUPED.fullmatch(field):
            decimal = "," if field.rfind(",") > field.rfind(".") else "."
            return Style(decimal, "." if decimal == "," else ",")
        if field.count(".") > 1 and _GROUPED.fullmatch(field):
            return Style(",", ".")
        if field.count(",") > 1 and _GROUPED.fullmatch(field):
            return Style(".", ",")
        commas, points = commas or "," in field, points or "." in field
    return Style("," if commas and not points and not commas_separate else ".")


def kind_of(field: str) -> str:
    """What a field is: "number", "missing", "switch", "date", "clock" or "text"."""
    word = field.strip().lower()
    if word in MISSING:
        return "missing"
    if _NUMBER.fullmatch(word) or _NUMBER.fullmatch(word.replace(",", ".", 1)) or _GROUPED.fullmatch(word):
        return "number"
    if word in SWITCHES:
        return "switch"
    if _ISO.fullmatch(word):
        return "date"
    return "clock" if _CLOCK.fullmatch(word) else "text"


def kind_of_column(fields: Sequence[str]) -> str:
    """What most fields of a column are."""
    kinds = [kind for kind in map(kind_of, fields) if kind != "missing"]
    return max(set(kinds), key=lambda kind: (kinds.count(kind), kind)) if kinds else "missing"


def number(field: str, style: Style) -> float:
    """The number in a field; NaN if there is none.

    Raises
    ------
    ValueError
        If it is no number.
    """
    text = field.strip().strip("\"'").strip()
    if style.thousands:
        if not style.thousands.strip() or style.thousands not in text or _GROUPED.fullmatch(text):
            text = text.replace(style.thousands, "")
        else:
            raise ValueError(field)
    if style.decimal == ",":
        if "." in text:
            raise ValueError(field)
        text = text.replace(",", ".")
    try:
        return float(text)
    except ValueError:
        if text.lower() in MISSING:
            return np.nan
        if not _NUMBER.fullmatch(text):
            raise
        return float(_BARE_EXPONENT.sub(r"e\1", text.lower().replace("d", "e")))


def counter(field: str) -> int:
    """A whole number of up to 18 digits more than a float holds."""
    value = int(field.strip().strip("\"'"))
    if abs(value) >= 2**63:
        raise ValueError(field)
    return value


def switch(field: str) -> float:
    """1 for ON and its like, 0 for OFF; NaN if the field is empty."""
    word = field.strip().strip("\"'").lower()
    return np.nan if word in MISSING else SWITCHES[word] if word in SWITCHES else float(word)


def date(field: str) -> np.datetime64:
    """An ISO date and time, in UTC if it has a zone; not-a-time if the field is empty."""
    text = field.strip().strip("\"'").strip()
    if text.lower() in MISSING:
        return np.datetime64("NaT", "ns")
    text = text.replace(",", ".").replace(" ", "T", 1).replace(" ", "")
    main, dot, rest = text.partition(".")
    digits = re.match(r"\d*", rest)
    fraction = digits[0] if digits else ""
    when = datetime.fromisoformat(main + rest[len(fraction) :] if dot else main)
    if when.tzinfo is not None:
        when = when.astimezone(UTC).replace(tzinfo=None)
    return np.datetime64(when, "ns") + np.timedelta64(int(fraction.ljust(9, "0")[:9] or 0), "ns")


def time_of_day(field: str) -> float:
    """A time of day in seconds; NaN if the field is empty."""
    text = field.strip().strip("\"'").strip()
    if text.lower() in MISSING:
        return np.nan
    hours, minutes, seconds = text.replace(",", ".").split(":")
    return 3600.0 * int(hours) + 60.0 * int(minutes) + float(seconds)
