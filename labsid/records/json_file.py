"""JSON: one object a line, a list of objects, or an object of lists."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log, listed, log_of, matrix_columns
from labsid.records.fields import column_of_texts

MAX_BYTES = 2**26  # of a file: as objects of Python it takes some fifteen times as much
_FIRST = 20  # objects whose members become the columns: a member may be absent from the first one
_MAX_ELEMENTS = 64  # of a list within an object; a longer one is an image or a scan


def open_log(path: Path) -> Log:
    """Read the numbers, dates and switches in a file of JSON.

    Returns
    -------
    Log
        Members of members are ``rig.u``, elements of lists ``q[0]``.

    Raises
    ------
    ValueError
        If it is no JSON, or holds no numbers.
    """
    if path.stat().st_size > MAX_BYTES:
        raise ValueError(f"it is over {MAX_BYTES // 2**20} MB of JSON. Write the log as text with t,u,y, or cut it.")
    content = path.read_bytes()
    notes: list[str] = []
    try:
        text = content.decode("utf-8-sig")
        try:
            value = json.loads(text)
        except ValueError:
            lines = [(k, line) for k, line in enumerate(text.split("\n")) if line.strip()]
            if len(lines) > 1 and not text.endswith("\n") and not _is_whole(lines[-1][1]):
                lines.pop()
                notes.append("the last line is cut off; left out")
            value = [_object(k, line) for k, line in lines]
        named_values = list(_columns("", value))
    except UnicodeDecodeError as error:
        raise ValueError(f"byte {error.start} of it is no UTF-8; JSON must be. Save it as text again.") from None
    except RecursionError:
        raise ValueError("it is nested too deeply. Write the log as text with t,u,y.") from None
    columns = [column for name, values in named_values for column in _column(name, values)]
    if not columns:
        raise ValueError(
            f"there are no lists of numbers in it; it holds {listed([name for name, _ in named_values]) or 'nothing'}."
        )
    return log_of(columns, "member", notes, has_names=not isinstance(value, list) or isinstance(value[0], dict))


def _is_whole(line: str) -> bool:
    try:
        json.loads(line)
    except ValueError:
        return False
    return True


def _object(k: int, line: str) -> Any:
    try:
        return json.loads(line)
    except ValueError as error:
        where = "" if k else " (nor is the whole file)"
        raise ValueError(f"line {k + 1} is no JSON{where}: {error}. Repair or delete that line.") from None


def _columns(name: str, value: Any) -> Iterator[tuple[str, list[Any] | np.ndarray]]:
    """Names and values of the lists in a value."""
    if isinstance(value, dict) and len(value) > 1 and all(map(str.isdecimal, value)):
        value = list(value.values())  # rows by number, as pandas writes them
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _columns(f"{name}.{key}" if name else key, inner)
    elif isinstance(value, list) and len(value) > 1:
        if isinstance(value[0], dict):
            rows = [dict(_members("", row)) for row in value]
            for key in dict.fromkeys(key for row in rows[:_FIRST] for key in row):
                yield f"{name}.{key}" if name else key, [row.get(key) for row in rows]
        elif isinstance(value[0], list):
            widths = {len(row) if isinstance(row, list) else -1 for row in value}
            if len(widths) == 1 and all(_is_number(element) for row in value for element in row):
                yield name, np.array([list(map(_float, row)) for row in value])
        else:
            yield name or "1", value


def _members(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _members(f"{name}.{key}" if name else key, inner)
    elif isinstance(value, list):
        for k, inner in enumerate(value[:_MAX_ELEMENTS]):
            yield from _members(f"{name}[{k}]", inner)
    else:
        yield name, value


def _column(name: str, values: list[Any] | np.ndarray) -> list[Column]:
    """A column of numbers, dates or switches; none for text."""
    if isinstance(values, np.ndarray):
        return matrix_columns(name, values)
    texts = [one for one in values if isinstance(one, str)]
    if len(texts) * 2 > sum(one is not None for one in values):
        column = column_of_texts(name, ["" if one is None else str(one) for one in values])
        return [] if column is None else [column]
    if all(type(one) is int and abs(one) < 2**63 for one in values):
        return [Column(name, np.array(values, np.int64))]
    numbers = np.array([_float(one) for one in values])
    return [] if np.isnan(numbers).all() else [Column(name, numbers)]


def _is_number(value: Any) -> bool:
    return value is None or isinstance(value, int | float)


def _float(value: Any) -> float:
    """A number; NaN for null and what is none."""
    try:
        return float(value) if isinstance(value, int | float) else np.nan
    except OverflowError:
        return np.inf
