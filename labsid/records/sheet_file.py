"""Workbooks of Excel and LibreOffice, with python-calamine: the first sheet that holds a table."""

from collections import Counter
from datetime import date, datetime, time, timedelta
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log, log_of
from labsid.records.fields import column_of_texts, kind_of, switch
from labsid.records.units import is_unit, split_units

MAX_ROWS = 1_048_576  # of a sheet of Excel
MAX_COLUMNS = 1000
_DAY_0 = date(1899, 12, 31)  # from which a workbook counts days


def open_log(path: Path) -> Log:
    """Read the table of a workbook.

    Raises
    ------
    ValueError
        If no sheet holds a table of numbers.
    """
    from python_calamine import CalamineWorkbook, SheetTypeEnum

    book = CalamineWorkbook.from_path(path)
    sheets = [sheet.name for sheet in book.sheets_metadata if sheet.typ == SheetTypeEnum.WorkSheet]
    for sheet in sheets:
        rows = [row[:MAX_COLUMNS] for row in islice(book.get_sheet_by_name(sheet).iter_rows(), MAX_ROWS)]
        first = _first_of_table(rows)
        if first is None:
            continue
        notes = [f"sheet {sheet} read"] if len(sheets) > 1 else []
        header = [str(cell).strip() for cell in rows[first - 1]] if first else []
        units: list[str] = []
        if first > 1 and all(is_unit(name) for name in header if name):
            units, header = header, [str(cell).strip() for cell in rows[first - 2]]
            notes.append(f"the row under the header read as units: {', '.join(filter(None, units))}")
        return log_of(_columns(header, units, rows[first:]), "column", notes, bool(header))
    raise ValueError("no sheet of the workbook holds a table of numbers. Export the table of the log alone.")


def _columns(header: list[str], units: list[str], rows: list[list[Any]]) -> list[Column]:
    columns = []
    names, in_names = split_units(header)
    for k in range(max(len(header), len(rows[0]))):
        name, unit = (names[k], in_names[k]) if k < len(header) and names[k] else (str(k + 1), "")
        column = _column(name, units[k] if k < len(units) else unit, [row[k] if k < len(row) else "" for row in rows])
        if column is not None:
            columns.append(column)
    return columns


def _column(name: str, unit: str, cells: list[Any]) -> Column | None:
    """Numbers, dates, times of day or switches; None for a column of text. An empty cell is an empty string."""
    kinds = [type(cell) for cell in cells if cell != ""]
    is_clock = any(issubclass(kind, time) for kind in kinds) and not any(_is_day(cell) for cell in cells)
    if is_clock:
        kinds = [time if issubclass(kind, date) else kind for kind in kinds]
    if kinds and sum(issubclass(kind, date) for kind in kinds) * 2 > len(kinds):
        return Column(name, np.array([_date(cell) for cell in cells], "datetime64[ns]"), unit)
    if kinds and sum(issubclass(kind, time | timedelta) for kind in kinds) * 2 > len(kinds):
        return Column(name, np.array([_time_of_day(cell) for cell in cells]), "h:m:s")
    texts = [cell for cell in cells if isinstance(cell, str)]
    if sum(map(bool, texts)) * 2 > len(kinds):
        return column_of_texts(name, [str(cell) for cell in cells], unit)
    numbers = np.array([_number(name, k, cell) for k, cell in enumerate(cells)])
    is_whole = float not in kinds or all(cell.is_integer() for cell in cells if isinstance(cell, float))
    if is_whole and kinds and bool not in kinds and np.isfinite(numbers).all() and np.abs(numbers).max() < 2.0**53:
        return Column(name, numbers.astype(np.int64), unit)
    return Column(name, numbers, unit)


def _number(name: str, k: int, cell: Any) -> float:
    try:
        return float(cell) if isinstance(cell, int | float) else switch(str(cell))
    except ValueError:
        raise ValueError(f"column {name}, row {k + 1} of the data: {str(cell)[:40]!r} is not a number.") from None


def _date(cell: Any) -> np.datetime64:
    if isinstance(cell, datetime):
        return np.datetime64(cell.replace(tzinfo=None), "ns")
    return np.datetime64(cell, "ns") if isinstance(cell, date) else np.datetime64("NaT", "ns")


def _time_of_day(cell: Any) -> float:
    if isinstance(cell, timedelta):
        return cell.total_seconds()
    if isinstance(cell, time):
        return _of_day(cell)
    if isinstance(cell, datetime):  # of a day or more
        return _of_day(cell) + 86400.0 * (cell.date() - _DAY_0).days
    return 86400.0 * (cell - _DAY_0).days if isinstance(cell, date) else np.nan


def _is_day(cell: Any) -> bool:
    """Whether this is a date, and not a time that a workbook shows as one of its first days."""
    return isinstance(cell, date) and cell.year > 1900


def _of_day(cell: time | datetime) -> float:
    return 3600.0 * cell.hour + 60.0 * cell.minute + cell.second + 1e-6 * cell.microsecond


def _first_of_table(rows: list[list[Any]]) -> int | None:
    """The first row of data; rows above that begin with a word or are shorter, as "Ts 0.1", describe the rig."""
    data = {k: None for k, row in enumerate(rows) if _is_data(row)}
    widths = Counter(_width(rows[k]) for k in [*data][len(data) // 2 :])
    width = widths.most_common(1)[0][0] if data else 0
    with_word = sum(_begins_with_word(rows[k]) for k in data) * 2 > len(data)
    fits = (k for k in data if _width(rows[k]) >= width and (with_word or not _begins_with_word(rows[k])))
    first = next(fits, None)
    while first and first - 1 in data and not _begins_with_word(rows[first - 1]):  # without its last cells
        first -= 1
    return first


def _width(row: list[Any]) -> int:
    return max(k + 1 for k, cell in enumerate(row) if cell != "")


def _begins_with_word(row: list[Any]) -> bool:
    return isinstance(row[0], str) and kind_of(row[0]) == "text"


def _is_data(row: list[Any]) -> bool:
    there = [cell for cell in row if cell != ""]
    data = [
        kind_of(cell) not in ("text", "missing")
        if isinstance(cell, str)
        else isinstance(cell, int | float | date | time | timedelta)
        for cell in there
    ]
    return len(there) >= 2 and sum(data) * 2 >= len(there)
