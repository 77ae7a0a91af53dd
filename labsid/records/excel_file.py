"""Excel workbooks, with openpyxl: the first sheet that holds a table."""

from datetime import date, datetime, time
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log, log_of
from labsid.records.fields import kind_of, switch
from labsid.records.units import is_unit, split_unit

MAX_ROWS = 1_048_576  # of a sheet of Excel
MAX_COLUMNS = 1000


def open_log(path: Path) -> Log:
    """Read the table of a workbook.

    Raises
    ------
    ValueError
        If no sheet holds a table of numbers.
    """
    from openpyxl import load_workbook

    book = load_workbook(path, read_only=True, data_only=True)
    for sheet in book.worksheets:
        rows = [list(row[:MAX_COLUMNS]) for row in islice(sheet.iter_rows(values_only=True), MAX_ROWS)]
        first = next((k for k, row in enumerate(rows) if _is_data(row)), None)
        if first is None:
            continue
        notes = [f"sheet {sheet.title} read"] if len(book.worksheets) > 1 else []
        header = [str(cell).strip() if cell is not None else "" for cell in rows[first - 1]] if first else []
        units: list[str] = []
        if first > 1 and all(is_unit(name) for name in header if name):
            units, header = header, [str(cell or "").strip() for cell in rows[first - 2]]
            notes.append(f"the row under the header read as units: {', '.join(filter(None, units))}")
        return log_of(_columns(header, units, rows[first:]), "column", notes, bool(header))
    raise ValueError("no sheet of the workbook holds a table of numbers. Export the table of the log alone.")


def _columns(header: list[str], units: list[str], rows: list[list[Any]]) -> list[Column]:
    columns = []
    for k in range(max(len(header), len(rows[0]))):
        name, unit = split_unit(header[k]) if k < len(header) and header[k] else (str(k + 1), "")
        values = _values(name, [row[k] if k < len(row) else None for row in rows])
        if values is not None:
            columns.append(Column(name, values, units[k] if k < len(units) else unit))
    return columns


def _values(name: str, cells: list[Any]) -> np.ndarray | None:
    """Numbers, dates or switches; None for a column of text."""
    kinds = [type(cell) for cell in cells if cell is not None]
    if kinds and sum(issubclass(kind, datetime | date) for kind in kinds) * 2 > len(kinds):
        return np.array([_date(cell) for cell in cells], "datetime64[ns]")
    if kinds and sum(issubclass(kind, time) for kind in kinds) * 2 > len(kinds):
        return None
    if sum(isinstance(cell, str) and kind_of(cell) == "text" for cell in cells) * 2 > max(len(kinds), 1):
        return None
    if kinds and all(issubclass(kind, int) and kind is not bool for kind in kinds) and len(kinds) == len(cells):
        return np.array(cells, np.int64)
    return np.array([_number(name, k, cell) for k, cell in enumerate(cells)])


def _number(name: str, k: int, cell: Any) -> float:
    if cell is None:
        return np.nan
    if isinstance(cell, int | float):
        return float(cell)
    try:
        return switch(str(cell))
    except ValueError:
        raise ValueError(f"column {name}, row {k + 1} of the data: {str(cell)[:40]!r} is not a number.") from None


def _date(cell: Any) -> np.datetime64:
    if isinstance(cell, datetime):
        return np.datetime64(cell.replace(tzinfo=None), "ns")
    return np.datetime64(cell, "ns") if isinstance(cell, date) else np.datetime64("NaT", "ns")


def _is_data(row: list[Any]) -> bool:
    there = [cell for cell in row if cell is not None]
    numbers = [cell for cell in there if isinstance(cell, int | float | datetime)]
    return len(there) >= 2 and len(numbers) * 2 >= len(there)
