"""What a field of a text file means: numbers as others write them, switches, dates and times of day."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from labsid.records.column import Column
from labsid.records.dates import date, days_come_first, is_date, is_time_of_day, time_of_day
from labsid.records.units import is_unit

MISSING = frozenset({
    "", "nan", "na", "n/a", "#n/a", "null", "none", "nil", "-", "--", "---", "?", "missing", "-nan", "nan(ind)",
    "-nan(ind)", "1.#qnan", "-1.#ind", "ovf", "ol", "error", "#num!", "#value!", "#div/0!", "#ref!",
})  # fmt: skip
SWITCHES = {
    "on": 1.0, "off": 0.0, "true": 1.0, "false": 0.0, "yes": 1.0, "no": 0.0, "high": 1.0, "low": 0.0,
    "ein": 1.0, "aus": 0.0, "open": 1.0, "closed": 0.0,
}  # fmt: skip
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+|[+-]\d{2,3})?|[+-]?inf(inity)?", re.IGNORECASE)
_LONGEST = 100  # characters of a field that is no text
_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d{2,3})$")  # of Fortran: 1.0-114
_GAPS = frozenset("'’ \u00a0\u202f")  # marks of thousands that are no decimal mark: of Switzerland, of France
_GROUPED = re.compile(rf"[+-]?\d{{1,3}}([.,{''.join(_GAPS)}])\d{{3}}(\1\d{{3}})*([.,]\d+)?")
_WITH_UNIT = re.compile(r"([+-]?(?:\d[\d.,]*|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\W\d_]\S{0,7}|[%°]\S{0,7})")


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
        Whether commas separate the columns, so that numbers with a comma are quoted: those of three digits behind it
        are thousands.
    """
    commas = points = False
    gap, in_thousands = "", commas_separate
    for field in fields:
        if not _GAPS.isdisjoint(field) and (grouped := _GROUPED.fullmatch(field)):
            gap = grouped[1]
        if "," in field and "." in field and _GROUPED.fullmatch(field):
            decimal = "," if field.rfind(",") > field.rfind(".") else "."
            return Style(decimal, "." if decimal == "," else ",")
        if field.count(".") > 1 and _GROUPED.fullmatch(field):
            return Style(",", ".")
        if field.count(",") > 1 and _GROUPED.fullmatch(field):
            return Style(".", ",")
        commas, points = commas or "," in field, points or "." in field
        in_thousands &= "," not in field or (field.lstrip("+-")[0] != "0" and bool(_GROUPED.fullmatch(field)))
    if commas and not points:
        return Style(".", ",") if in_thousands else Style(",", gap)
    return Style(".", gap)


def kind_of(field: str) -> str:
    """What a field is: "number", "missing", "switch", "date", "clock" or "text"."""
    word = field.strip()
    if len(word) > _LONGEST:
        return "text"
    if _NUMBER.fullmatch(word):
        return "number"
    word = word.lower().replace("−", "-")
    if word in MISSING:
        return "missing"
    if _NUMBER.fullmatch(word) or _NUMBER.fullmatch(word.replace(",", ".", 1)) or _GROUPED.fullmatch(word):
        return "number"
    if word in SWITCHES:
        return "switch"
    if is_date(word):
        return "date"
    if is_time_of_day(word):
        return "clock"
    return "number" if unit_of(field) else "text"


def unit_of(field: str) -> str:
    """The unit behind a number, as in 12.5 V; empty if there is none."""
    found = _WITH_UNIT.fullmatch(field.strip().replace("−", "-"))
    return found[2] if found and is_unit(found[2]) else ""


def kind_of_column(fields: Sequence[str]) -> str:
    """What most fields of a column are."""
    kinds = [kind for kind in map(kind_of, fields) if kind != "missing"]
    return max(set(kinds), key=lambda kind: (kinds.count(kind), kind)) if kinds else "missing"


def number(field: str, style: Style, unit: str = "") -> float:
    """The number in a field, with the unit behind it if the column has one; NaN if there is none.

    Raises
    ------
    ValueError
        If it is no number.
    """
    text = field.strip().strip("\"'").strip().replace("−", "-")
    if "_" in text:  # which Python reads
        raise ValueError(field)
    if unit and text.lower() not in MISSING:
        if not text.endswith(unit):
            raise ValueError(field)
        text = text.removesuffix(unit).rstrip()
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


class Reader(NamedTuple):
    """How the fields of a column are read: a function, the type of its values, and what a field is called."""

    read: Callable[[str], object]
    dtype: str = "float64"
    what: str = "number"


def reader_of(kind: str, style: Style, sample: Sequence[str]) -> Reader:
    """How a column of this kind is read."""
    if kind == "date":
        read = partial(date, day_first=days_come_first(sample) is not False)
        return Reader(_or_missing(read, np.datetime64("NaT", "ns")), "datetime64[ns]", "date")
    if kind == "counter":
        return Reader(counter, "int64")
    if kind == "clock":
        return Reader(_or_missing(time_of_day, np.nan), what="time")
    if kind == "switch":
        return Reader(switch, what="switch")
    what = "number, date or time that is known here" if kind == "text" else "number"
    return Reader(partial(number, style=style, unit=common_unit(sample)), what=what)


def _or_missing(read: Callable[[str], object], missing: object) -> Callable[[str], object]:
    """A reader of fields without quotes, of which those without a value are missing."""

    def read_field(field: str) -> object:
        text = field.strip().strip("\"'").strip()
        return missing if text.lower() in MISSING else read(text)

    return read_field


def common_unit(sample: Sequence[str]) -> str:
    """The unit behind the numbers of a column; empty if the first of them has none."""
    return next((unit_of(field) for field in sample if kind_of(field) == "number"), "")


def column_of_texts(name: str, cells: Sequence[str], unit: str = "") -> Column | None:
    """A column of numbers, dates, times of day or switches that a table holds as text; None for words.

    Raises
    ------
    ValueError
        If a cell is none of what most are.
    """
    kind = kind_of_column(cells)
    if kind in ("text", "missing"):
        return None
    reader = reader_of(kind, number_style(cells, False), cells)
    values = np.empty(len(cells), reader.dtype)
    for k, cell in enumerate(cells):
        try:
            values[k] = reader.read(cell)
        except (ValueError, OverflowError):
            raise ValueError(f"column {name}, row {k + 1} of the data: {cell[:40]!r} is not a {reader.what}.") from None
    return Column(
        name, values, "h:m:s" if kind == "clock" else common_unit(cells) or unit, None, kind_note(name, kind, cells)
    )


def kind_note(name: str, kind: str, sample: Sequence[str]) -> tuple[str, ...]:
    """What is to be said of a column of this kind."""
    if kind == "switch":
        return (f"{name}: on read as 1, off as 0",)
    day_first = days_come_first(sample) if kind == "date" else None
    if day_first is None:
        return ()
    return (f"{name}: dates read as {'day before month' if day_first else 'month before day'}",)


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
