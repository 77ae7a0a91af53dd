"""The layout of a text file: encoding, delimiter, lines before the table, header, row of units."""

import codecs
import io
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count

from labsid.records.column import listed
from labsid.records.fields import kind_of
from labsid.records.units import is_unit, split_units

HEAD = 300  # lines from which the layout is taken
MAX_LINE = 2**17 - 1  # characters; the module csv takes no longer fields
MAX_COLUMNS = 10_000
_PREFIX = re.compile(r"^\s*(\d{1,2}:\d\d:\d\d(?:[.,]\d+)?) ->\s*")  # of the serial monitor of the Arduino IDE
_PACKED = (b"\x1f\x8b", b"PK\3\4", b"7z\xbc\xaf\x27\x1c", b"Rar!", b"BZh", b"\xfd7zXZ", b"\x28\xb5\x2f\xfd")
_RULER = re.compile(r"[\s|+:=-]*---[\s|+:=-]*")  # under the header, as Markdown and terminals draw it
_LABELLED = re.compile(r"([A-Za-z_]\w{0,40})\s*[:=]\s*(\S.*)?")  # u:1.5, of a serial plotter
_FACTOR = re.compile(r"\s*1\.0e[+-]\d+ \*\s*")
_DATA = ("number", "switch", "date", "clock")


@dataclass(frozen=True, slots=True)
class Layout:
    """How a text file is laid out.

    Attributes
    ----------
    encoding : str
    delimiter : str or None
        None for blanks.
    first : int
        Line of the first row of data, from 0.
    header, units : tuple of str
        Names without units, and the units; empty if there is no header. As many as there are columns.
    width : int
        Number of columns.
    has_prefix : bool
        Whether each line begins with the time that a serial monitor has put there.
    notes : tuple of str
    labels : tuple of str
        Names that each line repeats before its values, as in ``u:1.5,y:2``; empty for a value without one.
    header_line : str
        A device that starts again writes it again.
    """

    encoding: str
    delimiter: str | None
    first: int
    header: tuple[str, ...]
    units: tuple[str, ...]
    width: int
    has_prefix: bool = False
    notes: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    header_line: str = ""

    def split(self, line: str) -> list[str]:
        """The fields of a line of data."""
        return _values(line, self.delimiter, self.labels) if self.labels else split_line(line, self.delimiter)


def encoding_of(content: bytes) -> str:
    """The encoding of a text.

    Raises
    ------
    ValueError
        If it is no text.
    """
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if content.lstrip()[:1] == b"<":
        raise ValueError("it is a page of HTML or XML. Save the table in it as text, or as .xlsx.")
    if content.startswith(_PACKED):
        raise ValueError("it is a packed archive. Unpack it, and give the log in it.")
    if b"\0" in content.rstrip(b"\0"):  # at the end: of a file that was made longer than what was written
        raise ValueError(
            "it is neither a MAT-file nor text, nor another format that is read here. Give text with t,u,y, or one of "
            ".mat, .xlsx, .parquet, .npz, .npy, .h5, .mf4, .tdms, .mcap, .bag."
        )
    decoder = codecs.getincrementaldecoder("utf-8")()
    try:
        for start in range(0, len(content), 2**20):
            decoder.decode(content[start : start + 2**20])
        decoder.decode(b"", final=True)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def lines_of(content: bytes, encoding: str) -> Iterator[str]:
    """The lines of a text, whatever ends them, without holding all of them.

    Raises
    ------
    ValueError
        If a line is too long for a sample.
    """
    stream = text_stream(content, encoding)
    for k in count():
        line = stream.readline(MAX_LINE + 1)
        if len(line) > MAX_LINE:
            raise ValueError(
                f"line {k + 1} has over {MAX_LINE} characters: {line[:40]!r}. Write each sample on a line of its own."
            )
        if not line:
            return
        yield line.rstrip("\n")


def text_stream(content: bytes, encoding: str) -> io.TextIOWrapper:
    """The content as a text file, in which every line ends in a line feed."""
    return io.TextIOWrapper(io.BytesIO(content), encoding, errors="replace", newline=None)


def is_cut(content: bytes) -> bool:
    """Whether the last line has no end."""
    return not any(end in content.rstrip(b"\0")[-2:] for end in b"\r\n")


def is_row(line: str) -> bool:
    """Whether a line is neither blank nor a comment."""
    return bool(line.strip("\0 \t\r\f\v\ufeff")) and line.lstrip()[0] not in "#%"


def split_line(line: str, delimiter: str | None) -> list[str]:
    """The fields of a line; a delimiter within quotes separates nothing."""
    if delimiter is None:
        return re.sub(r"(?<=\w) +(?=[\[(][^\])]{0,32}[\])])", "", line).split()
    if '"' in line:
        import csv

        return [
            part.strip().strip('"').strip()
            for part in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
        ]
    return [field.strip().strip("'").strip() for field in line.split(delimiter)]


def find_layout(content: bytes) -> Layout:
    """Find out how a text is laid out, from its first lines.

    Raises
    ------
    ValueError
        If it is no text, or holds no data.
    """
    encoding = encoding_of(content)
    head = [line for line, _ in zip(lines_of(content, encoding), range(HEAD), strict=False)]
    rows = [k for k, line in enumerate(head) if is_row(line) and not _RULER.fullmatch(line)]
    if not rows:
        raise ValueError("there are no data in it, only comments.")
    if any(map(_FACTOR.fullmatch, head)):
        raise ValueError(
            "it is what MATLAB shows, with a factor for all columns (1.0e+03 *) and few digits. Save the variables "
            "with save FILE.mat, or writematrix."
        )
    has_prefix = bool(_PREFIX.match(head[rows[-1]]))
    plain = [without_prefix(line, "\t") if has_prefix else line for line in head]
    delimiter = _delimiter([plain[k] for k in rows], has_prefix)
    if has_prefix:
        plain = [without_prefix(line, delimiter or " ") for line in head]
    labels = _labels([plain[k] for k in rows], delimiter)
    split = {k: _values(plain[k], delimiter, labels) if labels else split_line(plain[k], delimiter) for k in rows}
    fields = {k: _stripped(list(split[k])) for k in rows}
    widest = max(rows, key=lambda k: len(fields[k]))
    if len(fields[widest]) > MAX_COLUMNS:
        raise ValueError(
            f"line {widest + 1} has {len(fields[widest])} fields; at most {MAX_COLUMNS} columns are read. Write each "
            "sample on a line of its own, or only the signals that are needed."
        )
    tail = rows[len(rows) // 2 :]
    width = Counter(len(fields[k]) for k in tail).most_common(1)[0][0]
    begins = Counter(kind_of(fields[k][0]) for k in tail if fields[k]).most_common(1)
    words = -1  # the last row of words in the first half, under numbers that describe the channels
    if begins and begins[0][0] == "missing":
        words = max((k for k in rows[: len(rows) // 2] if len(fields[k]) >= width and _is_words(fields[k])), default=-1)
    under = (k for k in rows if k > words)
    first = next(
        (k for k in under if len(split[k]) >= width and _is_data(fields[k]) and _fits(fields[k], begins)), None
    )
    if first is None:
        odd = f", but line {rows[1] + 1} is no sample: {plain[rows[1]][:40]!r}. Write plain numbers" if rows[1:] else ""
        raise ValueError(f"there is a header ({listed(fields[rows[0]])}) and no data under it{odd}.")
    above = [k for k in rows if k < first and len(fields[k]) >= width]
    header: list[str] = []
    units: list[str] = []
    notes = []
    header_line = ""
    if labels:
        header = list(labels)
    elif above:
        header, header_line = fields[above[-1]], plain[above[-1]]
        if _is_data(header) and not _are_units(header):
            raise ValueError(
                f"line {above[-1] + 1} begins with {header[0][:40]!r} and holds numbers: it is neither a header nor a "
                "sample. Complete or delete that line."
            )
        over = fields[above[-2]] if len(above) > 1 and above[-2] == above[-1] - 1 else []
        if over and (_are_units(header) or _look_like_units(header, over)):
            units, header = [field.strip("[]() ") for field in header], over
            notes.append(f"the row under the header read as units: {', '.join(filter(None, units))}")
        skipped = sum(k < above[-1] and k not in above[-2:] for k in rows)
        if skipped:
            notes.append(f"{skipped} {'line' if skipped == 1 else 'lines'} before the table skipped")
    elif not has_prefix:
        header = _header_in_comment(head[:first], len(fields[first]), delimiter)
    width = max(width, len(fields[first]))
    if delimiter is None and len(header) > width and not labels:  # words of names, or a name without a column
        notes.append(f"the header has {len(header)} words for {width} columns: they are called by numbers")
        header = [str(k + 1) for k in range(width)]
    width = max(width, len(header))
    names, in_names = split_units(header)
    units = units or in_names
    return Layout(
        encoding,
        delimiter,
        first,
        tuple(name or str(k + 1) for k, name in enumerate(names)),
        tuple(units + [""] * (width - len(units))),
        width,
        has_prefix,
        tuple(notes),
        labels,
        header_line,
    )


def without_prefix(line: str, delimiter: str) -> str:
    """A line of the serial monitor, with the delimiter in place of its arrow."""
    return _PREFIX.sub(rf"\1{delimiter}", line)


def _delimiter(rows: Sequence[str], has_prefix: bool) -> str | None:
    """The first of the usual delimiters that separates the last rows into fields that hold data."""
    tail = rows[len(rows) // 2 :]
    if has_prefix:
        tail = [row.partition("\t")[2] for row in tail]
    for mark in ";\t,|":
        if sum(mark in row for row in tail) <= len(tail) // 2:
            continue
        split = [_stripped(split_line(row, mark)) for row in tail]
        if mark != "," or not any(re.fullmatch(r"[+-]?\d+\s+[+-]?\d+", field) for row in split for field in row):
            return mark
    return None


def _stripped(fields: list[str]) -> list[str]:
    """Fields without the empty ones after trailing delimiters."""
    while fields and not fields[-1]:
        fields.pop()
    return fields


def _is_data(fields: Sequence[str]) -> bool:
    """Whether at least half of the fields that are there hold data."""
    there = [kind_of(field) for field in fields if field]
    return bool(there) and sum(kind in _DATA or kind == "missing" for kind in there) * 2 >= len(there)


def _is_words(fields: Sequence[str]) -> bool:
    """Whether a row names columns: no field of it holds a value."""
    kinds = [kind_of(field) for field in fields if field]
    return len(kinds) >= 2 and set(kinds) == {"text"}


def _fits(fields: Sequence[str], begins: Sequence[tuple[str, int]]) -> bool:
    """Whether a row begins as most rows do: a line before the table may hold numbers, but after a word."""
    kind = kind_of(fields[0])
    return kind != "text" or not begins or begins[0][0] in ("text", "missing")


def _are_units(fields: Sequence[str]) -> bool:
    """Whether a row holds units; a scope writes numbers beside them."""
    there = [field for field in fields if field]
    return any(map(is_unit, there)) and all(is_unit(field) or kind_of(field) == "number" for field in there)


def _look_like_units(fields: Sequence[str], names: Sequence[str]) -> bool:
    """Whether most of a row are units, and it names columns alike that the row above it tells apart."""
    is_alike = len(set(fields)) < len(fields) == len(names) == len(set(names)) and not _is_data(names)
    return is_alike and sum(map(is_unit, fields)) * 2 > len(fields)


def _labels(rows: Sequence[str], delimiter: str | None) -> tuple[str, ...]:
    """The names that most of the last rows repeat before their values; empty for a value without one."""
    if not any(mark in rows[-1] for mark in ":="):
        return ()
    found = Counter(tuple(name for name, _ in _pairs(row, delimiter)) for row in rows[len(rows) // 2 :])
    labels, often = found.most_common(1)[0]
    is_labelled = sum(map(bool, labels)) * 2 > len(labels) and len(set(filter(None, labels))) == sum(map(bool, labels))
    return labels if is_labelled and often * 2 > sum(found.values()) else ()


def _pairs(line: str, delimiter: str | None) -> list[tuple[str, str]]:
    """The fields of a line as pairs of a name, which may be empty, and a value."""
    matches = [
        (_LABELLED.fullmatch(field), field) for field in split_line(re.sub(r"(?<=\w[:=]) +", "", line), delimiter)
    ]
    return [(found[1], found[2] or "") if found else ("", field) for found, field in matches]


def _values(line: str, delimiter: str | None, labels: Sequence[str]) -> list[str]:
    """The values of a line in the order of the labels; the fields as they are if it has none of them."""
    pairs = _pairs(line, delimiter)
    named = {name: value for name, value in pairs if name}
    if not any(label in named for label in labels if label):
        return [value for _, value in pairs]
    bare = iter([value for name, value in pairs if not name])
    return [named.get(label, "") if label else next(bare, "") for label in labels]


def _header_in_comment(lines: Sequence[str], width: int, delimiter: str | None) -> list[str]:
    """Column names from the comment above the data, as numpy.savetxt writes it; empty if there is none."""
    if not lines:
        return []
    names = _stripped(split_line(lines[-1].lstrip(" \t#%"), delimiter))
    return names if len(names) == width and not _is_data(names) else []
