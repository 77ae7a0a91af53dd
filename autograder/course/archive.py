"""Reading of zip files from untrusted sources."""

import stat
import zipfile
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import IO

MAX_ENTRIES = 20_000
MAX_FILE_BYTES = 50 * 1024 * 1024


@dataclass(frozen=True, slots=True)
class ArchiveEntry:
    """One file of an archive.

    Attributes
    ----------
    name : str
        Its path in the archive, with forward slashes; untrusted.
    modified : datetime or None
        Its time in the archive, in an unknown time zone.
    data : bytes
        Empty if there is a problem.
    problem : str
        Why it was not read; otherwise empty.
    """

    name: str
    modified: datetime | None
    data: bytes
    problem: str = ""


def read_entries(content: IO[bytes], what: str, max_bytes: Callable[[str], int]) -> Iterator[ArchiveEntry]:
    """Read the files of an untrusted zip file, within limits.

    Parameters
    ----------
    content : binary file
    what : str
        Its name, for errors.
    max_bytes : callable
        ``max_bytes(name)`` is the largest unpacked size of the file; called before each file is read.

    Yields
    ------
    Entry

    Raises
    ------
    ValueError
        If it is not a zip file, or has too many entries.
    """
    try:
        archive = zipfile.ZipFile(content)
    except (zipfile.BadZipFile, ValueError, OSError, EOFError, NotImplementedError, OverflowError) as error:
        raise ValueError(f"{what} is not a readable zip file: {error}.") from None
    with archive:
        infos = archive.infolist()
        if len(infos) > MAX_ENTRIES:
            raise ValueError(f"{what} has {len(infos)} entries; at most {MAX_ENTRIES} are allowed.")
        for info in infos:
            if not info.is_dir():
                name = info.filename.replace("\\", "/")
                yield _read(archive, info, name, min(MAX_FILE_BYTES, max_bytes(name)))


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo, name: str, max_bytes: int) -> ArchiveEntry:
    modified = _time(info)
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind not in (0, stat.S_IFREG):
        return ArchiveEntry(name, modified, b"", "it is a link or a device, not a file")
    try:
        with archive.open(info) as file:
            data = file.read(max_bytes + 1)  # the declared size can be wrong
    except (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, OSError, EOFError, ValueError) as error:
        return ArchiveEntry(name, modified, b"", f"it cannot be unpacked ({str(error)[:100]})")
    if len(data) > max_bytes:
        return ArchiveEntry(name, modified, b"", "it is too large")
    return ArchiveEntry(name, modified, data)


def _time(info: zipfile.ZipInfo) -> datetime | None:
    try:
        return datetime(*info.date_time)
    except ValueError:
        return None
