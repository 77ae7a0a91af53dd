"""Delimited text files, with or without a header."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from labsid._arrays import FloatArray


def read_text(content: bytes, columns: str | None, Ts: float | None) -> dict[str, Any]:
    """Read the columns t,u,y or u,y of a text file.

    Parameters
    ----------
    content : bytes
        The content of the file.
    columns : str or None
        Names or numbers (from 1) of two or three columns; None for those named t, u, y in the header.
    Ts : float or None
        Sampling time in seconds; if given, the file needs no times.

    Returns
    -------
    dict
        `t` (or None), `u`, `y` and `notes`, for `labsid.records.formats.RawRecord`; empty fields are NaN.

    Raises
    ------
    ValueError
        If there are no data, if a column is missing, or if a field is not a number.
    """
    lines = _decode(content).replace("\r\n", "\n").replace("\r", "\n").split("\n")
    numbers = [k for k, line in enumerate(lines) if line.strip() and line.lstrip()[0] not in "#%"]
    if not numbers:
        raise ValueError("there are no data in it, only comments.")
    delimiter = next((mark for mark in ";\t," if mark in lines[numbers[0]]), None)
    header = _fields(lines[numbers[0]], delimiter)
    if not _all_numbers(header, delimiter):
        numbers = numbers[1:]
        if not numbers:
            raise ValueError(f"there is a header ({', '.join(header)}) and no data under it.")
    else:
        header = _header_in_comment(lines[: numbers[0]], len(header), delimiter)
    used, notes = _choose_columns(header, len(_fields(lines[numbers[0]], delimiter)), columns, Ts)
    rows = [lines[k] for k in numbers]
    if '"' in rows[0]:
        rows = [row.replace('"', "") for row in rows]
    if delimiter in (";", "\t") and any("," in row for row in rows) and not any("." in row for row in rows):
        rows = [row.replace(",", ".") for row in rows]
        notes.append("decimal commas read as decimal points")
    try:
        # Seven times as fast as `_parse_rows`, but fails on empty fields.
        table = np.loadtxt(rows, delimiter=delimiter, usecols=used, comments=None, ndmin=2)
    except ValueError:
        table = _parse_rows(rows, numbers, delimiter, used)
    return as_found(list(table.T), notes)


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


def as_found(arrays: Sequence[FloatArray], notes: Sequence[str] = ()) -> dict[str, Any]:
    """Name two arrays u and y, or three arrays t, u and y."""
    t, u, y = arrays if len(arrays) == 3 else (None, *arrays)
    return {"t": t, "u": u, "y": y, "notes": notes}


def _decode(content: bytes) -> str:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    if b"\0" in content:
        raise ValueError("it is neither a MAT-file nor text. Give a .mat with LogData, or text with t,u,y.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def _fields(line: str, delimiter: str | None) -> list[str]:
    """Fields of a line, without the empty ones after trailing delimiters."""
    fields = [field.strip().strip("\"'").strip() for field in line.split(delimiter)]
    while fields and not fields[-1]:
        fields.pop()
    return fields


def _all_numbers(fields: Sequence[str], delimiter: str | None) -> bool:
    for field in fields:
        try:
            float((field.replace(",", ".") if delimiter in (";", "\t") else field) or "nan")
        except ValueError:
            return False
    return True


def _header_in_comment(lines: Sequence[str], width: int, delimiter: str | None) -> list[str]:
    """Column names from the comment above the data, as numpy.savetxt writes it; empty if there is none."""
    if not lines:
        return []
    names = _fields(lines[-1].lstrip(" \t#%"), delimiter)
    return names if len(names) == width and not _all_numbers(names, delimiter) else []


def _choose_columns(
    header: Sequence[str], width: int, columns: str | None, Ts: float | None
) -> tuple[list[int], list[str]]:
    """Positions of t,u,y or u,y among the columns, and a note if there is no header."""
    there = ", ".join(header) if header else f"1 to {width} (there is no header)"
    if columns is not None:
        names = split_columns(columns)
        if not header and width == len(names) and names == ["t", "u", "y"][-width:]:
            return list(range(width)), [f"no header: columns taken as {columns}"]
        return [_find_column(name, header, max(width, len(header)), there) for name in names], []
    lower = [name.lower() for name in header]
    t = next((lower.index(name) for name in ("t", "time") if name in lower), None)
    if "u" in lower and "y" in lower and (t is not None or Ts is not None):
        return [*([] if t is None else [t]), lower.index("u"), lower.index("y")], []
    if not header and width == 3:
        return [0, 1, 2], ["no header: columns taken as t,u,y"]
    if not header and width == 2 and Ts is not None:
        return [0, 1], ["no header: columns taken as u,y"]
    raise ValueError(
        f"no columns t,u,y; the columns are {there}. Choose columns by name or number with columns "
        "(--columns t,u,y, or --columns u,y and --Ts)."
    )


def _find_column(name: str, header: Sequence[str], width: int, there: str) -> int:
    if name in header:
        return header.index(name)
    if name.isdecimal() and 1 <= int(name) <= width:
        return int(name) - 1
    hint = "" if header else ". Give numbers, such as 1,2"
    raise ValueError(f"there is no column {name!r}; the columns are {there}{hint}.")


def _parse_rows(rows: Sequence[str], numbers: Sequence[int], delimiter: str | None, used: Sequence[int]) -> FloatArray:
    """Parse rows as loadtxt does, but read empty fields as NaN and name the line in errors."""
    table = np.empty((len(rows), len(used)))
    for k, row in enumerate(rows):
        fields = row.split(delimiter)
        for j, column in enumerate(used):
            line = f"line {numbers[k] + 1}"
            if column >= len(fields):
                raise ValueError(
                    f"{line} has {len(fields)} fields, but column {column + 1} is needed: {row[:40]!r}. "
                    "Complete or delete that line."
                )
            field = fields[column].strip()
            try:
                table[k, j] = float(field or "nan")
            except ValueError:
                raise ValueError(f"{line}, column {column + 1}: {field[:40]!r} is not a number.") from None
    return table
