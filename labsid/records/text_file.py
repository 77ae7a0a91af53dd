"""Delimited text: any of the usual delimiters, decimal marks, headers and encodings."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice

import numpy as np

from labsid.records.column import Column, Log
from labsid.records.fields import Reader, Style, kind_note, kind_of_column, number_style, reader_of
from labsid.records.text_layout import Layout, find_layout, is_row, lines_of, text_stream, without_prefix

SAMPLE = 1000  # rows from which the kind of a column is taken; of wide tables fewer
_SAMPLED = 500_000  # fields in these rows
_BLOCK = 50_000  # rows that are held as text at a time


def open_text(content: bytes) -> Log:
    """Find the columns of a text file; they are read when they have been chosen.

    Parameters
    ----------
    content : bytes
        The content of the file.

    Returns
    -------
    Log

    Raises
    ------
    ValueError
        If there are no data. `Log.read` raises it for a field that does not fit its column, and names the line.
    """
    layout = find_layout(content)
    names = layout.header + tuple(str(k + 1) for k in range(len(layout.header), layout.width))
    sample = [layout.split(line) for _, line in islice(_rows(content, layout), min(SAMPLE, _SAMPLED // layout.width))]
    columns = [[row[k] for row in sample if k < len(row)] for k in range(layout.width)]
    kinds = [_with_counters(kind_of_column(column), column) for column in columns]
    numbers = [field for column, kind in zip(columns, kinds, strict=True) if kind == "number" for field in column]
    style = number_style([field for field in numbers if field], layout.delimiter == ",")

    def read(places: Sequence[int]) -> list[Column]:
        table = None
        if style == Style() and all(kinds[k] == "number" for k in places):
            table = _read_numbers(content, layout, places)
        readers = [reader_of(kinds[k], style, columns[k]) for k in places]
        arrays = list(table.T) if table is not None else _read_fields(content, layout, places, readers)
        return [
            Column(
                names[k],
                _whole(array, columns[k], style) if kinds[k] == "number" else array,
                "h:m:s" if kinds[k] == "clock" else layout.units[k],
                notes=kind_note(names[k], kinds[k], columns[k]),
            )
            for k, array in zip(places, arrays, strict=True)
        ]

    return Log(names, read, bool(layout.header), "column", (*layout.notes, *style.note))


def _rows(content: bytes, layout: Layout) -> Iterator[tuple[int, str]]:
    """The rows of data with their line numbers, from 0."""
    numbered = enumerate(lines_of(content, layout.encoding))
    rows = ((k, line) for k, line in islice(numbered, layout.first, None) if is_row(line))
    if layout.has_prefix:
        return ((k, without_prefix(line, layout.delimiter or " ")) for k, line in rows)
    return rows


def _read_numbers(content: bytes, layout: Layout, places: Sequence[int]) -> np.ndarray | None:
    """The chosen columns at several times the speed of `_read_fields`; None if some field is no plain number."""
    rows: Iterable[str]
    if layout.has_prefix or b"#" in content or b"%" in content:
        rows = (line for _, line in _rows(content, layout))
    else:
        rows = text_stream(content, layout.encoding)
        for _ in range(layout.first):
            rows.readline()
    try:
        return np.loadtxt(rows, delimiter=layout.delimiter, usecols=places, comments=None, ndmin=2, quotechar='"')
    except ValueError:
        return None


def _read_fields(content: bytes, layout: Layout, places: Sequence[int], readers: Sequence[Reader]) -> list[np.ndarray]:
    """The chosen columns, field by field; errors name the line."""
    rows, blocks = _rows(content, layout), []
    while block := list(islice(rows, _BLOCK)):
        split = [(k, layout.split(line), line) for k, line in block]
        blocks.append(
            [
                np.array([_field(row, place, reader) for row in split], reader.dtype)
                for place, reader in zip(places, readers, strict=True)
            ]
        )
    return [np.concatenate(parts) for parts in zip(*blocks, strict=True)]


def _field(row: tuple[int, list[str], str], place: int, reader: Reader) -> object:
    k, fields, line = row
    if place >= len(fields):
        raise ValueError(
            f"line {k + 1} has {len(fields)} fields, but column {place + 1} is needed: {line[:40]!r}. "
            "Complete or delete that line."
        )
    try:
        return reader.read(fields[place])
    except (ValueError, OverflowError):
        raise ValueError(f"line {k + 1}, column {place + 1}: {fields[place][:40]!r} is not a {reader.what}.") from None


def _with_counters(kind: str, sample: Sequence[str]) -> str:
    """Whole numbers of more digits than a float holds, such as nanoseconds since 1970, are counters."""
    long = kind == "number" and all(field.isdigit() for field in sample) and max(map(len, sample)) > 15
    return "counter" if long else kind


def _whole(array: np.ndarray, sample: Sequence[str], style: Style) -> np.ndarray:
    """Whole numbers as integers, where the file writes them so: counters differ from seconds in that."""
    if not all(field.strip().lstrip("+-").replace(style.thousands, "").isdigit() for field in sample):
        return array
    is_whole = np.isfinite(array).all() and np.abs(array).max() < 2.0**62 and (array == np.round(array)).all()
    return array.astype(np.int64) if is_whole else array
