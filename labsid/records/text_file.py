"""Delimited text: any of the usual delimiters, decimal marks, headers and encodings."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice

import numpy as np

from labsid.records.column import Column, Log
from labsid.records.fields import (
    Reader,
    Style,
    common_unit,
    kind_note,
    kind_of,
    kind_of_column,
    number_style,
    reader_of,
)
from labsid.records.text_layout import Layout, find_layout, is_cut, is_row, lines_of, text_stream, without_prefix

SAMPLE = 1000  # rows from which the kind of a column is taken; of wide tables fewer
_SAMPLED = 500_000  # fields in these rows
_LAST = 10  # rows that may be words after the table
_Row = tuple[int, list[str], str]  # number of the line from 0, fields, line
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
    rows = [
        (k, layout.split(line), line)
        for k, line in islice(_rows(content, layout), min(SAMPLE, _SAMPLED // layout.width))
        if line != layout.header_line
    ]
    sample = [fields for _, fields, _ in rows[: len(rows) - _after_the_table(rows, layout.width, is_cut(content))]]
    columns = [[row[k] for row in sample if k < len(row)] for k in range(layout.width)]
    kinds = [_with_counters(kind_of_column(column), column) for column in columns]
    numbers = [field for column, kind in zip(columns, kinds, strict=True) if kind == "number" for field in column]
    style = number_style([field for field in numbers if field], layout.delimiter == ",")

    def read(places: Sequence[int]) -> list[Column]:
        table = None
        if style == Style() and all(kinds[k] == "number" for k in places):
            table = _read_numbers(content, layout, places)
        readers = [reader_of(kinds[k], style, columns[k]) for k in places]
        arrays, notes = (list(table.T), []) if table is not None else _read_fields(content, layout, places, readers)
        return [
            Column(
                names[k],
                _whole(array, columns[k], style) if kinds[k] == "number" else array,
                "h:m:s" if kinds[k] == "clock" else common_unit(columns[k]) or layout.units[k],
                notes=(*kind_note(names[k], kinds[k], columns[k]), *(notes if k == places[0] else ())),
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
    mark, marks = layout.delimiter, 0  # delimiters of all rows; 0 if the rows are looked at one by one
    is_plain = not layout.has_prefix and layout.encoding != "utf-16" and b"#" not in content and b"%" not in content
    if mark is not None and is_plain:
        rows = text_stream(content, layout.encoding)
        marks = content.count(mark.encode()) - sum(rows.readline().count(mark) for _ in range(layout.first))
    else:
        rows = _of_one_width((line for _, line in _rows(content, layout)), mark)
    try:
        table = np.loadtxt(rows, delimiter=mark, usecols=places, comments=None, ndmin=2, quotechar='"')
    except ValueError:
        return None
    return None if marks % max(len(table), 1) else table


def _of_one_width(lines: Iterable[str], mark: str | None) -> Iterator[str]:
    """The lines, as long as they have as many fields as the first."""
    width = None
    for line in lines:
        fields = len(line.split()) if mark is None else line.count(mark)
        width = fields if width is None else width
        if fields != width:
            raise ValueError(line)
        yield line


def _read_fields(
    content: bytes, layout: Layout, places: Sequence[int], readers: Sequence[Reader]
) -> tuple[list[np.ndarray], list[str]]:
    """The chosen columns, field by field, and what was left out; errors name the line."""
    rows, blocks, notes, again = _rows(content, layout), [], [], 0
    while block := list(islice(rows, _BLOCK)):
        kept = [row for row in block if row[1] != layout.header_line]
        again += len(block) - len(kept)
        split = [(k, layout.split(line), line) for k, line in kept]
        if len(block) < _BLOCK:
            over = _after_the_table(split, max(places) + 1, is_cut(content))
            if over:
                notes.append(
                    f"the last {'line is no sample' if over == 1 else f'{over} lines are no samples'}; left out"
                )
                split = split[:-over]
        for k, fields, line in split:
            _check_width(k, fields, line, layout)
        blocks.append(
            [
                np.array([_field(row, place, reader) for row in split], reader.dtype)
                for place, reader in zip(places, readers, strict=True)
            ]
        )
    if again:
        notes.append(f"the header stands {again} more {'time' if again == 1 else 'times'} between the rows")
    return [np.concatenate(parts) for parts in zip(*blocks, strict=True)], notes


def _after_the_table(rows: Sequence[_Row], places: int, is_cut: bool) -> int:
    """How many of the last rows are no samples: words such as "end of log", and a row that was cut off."""
    if rows and is_cut and len(rows[-1][1]) < places:
        return 1
    if not rows or kind_of(rows[0][1][0]) == "text":
        return 0
    words = [fields[0][:1].isalpha() and kind_of(fields[0]) == "text" for _, fields, _ in rows[-_LAST:]]
    return next((k for k, is_word in enumerate(reversed(words)) if not is_word), 0)


def _check_width(k: int, fields: Sequence[str], line: str, layout: Layout) -> None:
    """Refuse a row whose fields may stand in other columns than those of the other rows."""
    width = layout.width
    over = fields[width:]  # words there are a remark at the end of the line
    if over and over[0][:1] not in ("#", "%") and any(kind_of(field) not in ("text", "missing") for field in over):
        why = "A mark of thousands or a text with a delimiter needs quotes; two rows in one line have to be separated."
    elif layout.delimiter is None and len(fields) < width:
        why = "Blanks do not show which is missing. Write nan there, or delete that line."
    else:
        return
    raise ValueError(f"line {k + 1} has {len(fields)} fields, but the table has {width} columns: {line[:40]!r}. {why}")


def _field(row: _Row, place: int, reader: Reader) -> object:
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
