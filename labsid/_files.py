"""Atomic writing of files, and reproducible zip files."""

import errno
import io
import json
import os
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

_ZIP_TIME = (1980, 1, 1, 0, 0, 0)


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write a JSON object to a file; see `write_file`."""
    write_file(path, (json.dumps(content, indent=2, allow_nan=False) + "\n").encode())


def write_file(path: Path, content: bytes) -> None:
    """Write a file atomically: if writing fails, an existing file remains unchanged.

    Parameters
    ----------
    path : Path
        An existing file is replaced; the folder must exist. Devices and pipes are written to directly.
    content : bytes

    Raises
    ------
    OSError
        If the folder does not exist, or writing fails.
    """
    check_writable(path)
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return
    path = path.resolve()
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        partial.write_bytes(content)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Check that `write_file` can write to a path, before a long computation.

    Parameters
    ----------
    path : Path

    Raises
    ------
    OSError
        If the path is a folder, or its folder does not exist or is not writable.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "it is a folder; name a file to write to", str(path))
    folder = path.resolve().parent
    if not folder.is_dir():
        raise FileNotFoundError(errno.ENOENT, "there is no such folder to write to", str(folder))
    if not path.exists() and not os.access(folder, os.W_OK):
        raise PermissionError(errno.EACCES, "nothing can be written into this folder", str(folder))


def as_argument(path: Path) -> str:
    """A relative path as an argument of a command, which would take a name that begins with a dash for an option."""
    text = path.as_posix()
    return f"./{text}" if text.startswith("-") else text


def write_text(path: Path, text: str) -> None:
    """Write a text file with `write_file`, creating its folder if necessary.

    Lone surrogates, which cannot be encoded, are written as escapes.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file(path, text.encode(errors="backslashreplace"))


def csv_text(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table as CSV; text that a spreadsheet would evaluate as a formula gets an apostrophe.

    Parameters
    ----------
    columns : iterable of str
        The line of headings.
    rows : iterable of iterable of str
    """
    import csv  # not at the top: every command imports this module

    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([as_text_cell(value) for value in row] for row in rows)
    return text.getvalue()


def as_text_cell(text: str) -> str:
    """A value of a table; text that a spreadsheet would evaluate as a formula gets an apostrophe."""
    return f"'{text}" if _is_formula(text) else text


def without_apostrophe(text: str) -> str:
    """A value of a table of `csv_text` as it was before it was written."""
    return text[1:] if text.startswith("'") and _is_formula(text[1:]) else text


def _is_formula(text: str) -> bool:
    return text.lstrip()[:1] in ("=", "@", "+", "-") and not re.fullmatch(r"-?\d+(\.\d+)?", text)


def zip_bytes(files: Mapping[str, bytes], programs: Collection[str] = ()) -> bytes:
    """Zip files in the order of their names, with a fixed time; the same content gives the same bytes.

    Parameters
    ----------
    files : mapping
        Content by path.
    programs : collection of str
        Those that can be executed.
    """
    import zipfile  # not at the top: every command imports this module

    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            info = zipfile.ZipInfo(name, _ZIP_TIME)
            info.external_attr = (0o755 if name in programs else 0o644) << 16
            archive.writestr(info, files[name], zipfile.ZIP_DEFLATED)
    return packed.getvalue()
