"""Zip files: written so that the same content is the same bytes, and read without trusting anything in them."""

import io
import stat
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import IO

MAX_ENTRIES = 20_000
MAX_FILE_BYTES = 50 * 1024 * 1024
_TIME = (1980, 1, 1, 0, 0, 0)


def zip_bytes(files: Mapping[str, bytes]) -> bytes:
    """Zip files, in the order of their names and without times."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            info = zipfile.ZipInfo(name, _TIME)
            info.external_attr = 0o644 << 16
            archive.writestr(info, files[name], zipfile.ZIP_DEFLATED)
    return packed.getvalue()


@dataclass(frozen=True, slots=True)
class ArchiveEntry:
    """One file of an archive, or why it could not be had.

    Attributes
    ----------
    name : str
        Its path in the archive, with forward slashes; only to be read, never to be written to.
    changed : datetime or None
        What the archive says of its time, in nobody knows which zone.
    data : bytes
        Empty where it was refused.
    refused : str
        Why; empty where it was read.
    """

    name: str
    changed: datetime | None
    data: bytes
    refused: str = ""


def read_entries(content: IO[bytes], what: str, allowed: Callable[[str], int]) -> Iterator[ArchiveEntry]:
    """Read every file of a zip, each as far as the limits allow.

    Parameters
    ----------
    content : binary file
    what : str
        Its name, for errors.
    allowed : callable
        ``allowed(name)`` is how many bytes a file of that name may have, unpacked; it is asked before each is read.

    Yields
    ------
    Entry

    Raises
    ------
    ValueError
        If it is no zip, or has too many entries.
    """
    try:
        archive = zipfile.ZipFile(content)
    except (zipfile.BadZipFile, ValueError, OSError, EOFError, NotImplementedError, OverflowError) as error:
        raise ValueError(f"{what} is not a zip file that can be read: {error}.") from None
    with archive:
        infos = archive.infolist()
        if len(infos) > MAX_ENTRIES:
            raise ValueError(f"{what} has {len(infos)} entries; at most {MAX_ENTRIES} are read.")
        for info in infos:
            if not info.is_dir():
                name = info.filename.replace("\\", "/")
                yield _read(archive, info, name, min(MAX_FILE_BYTES, allowed(name)))


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo, name: str, most: int) -> ArchiveEntry:
    changed = _time(info)
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind not in (0, stat.S_IFREG):
        return ArchiveEntry(name, changed, b"", "it is a link or a device, not a file")
    try:
        with archive.open(info) as file:
            data = file.read(most + 1)  # what is declared may be a lie: a bomb is read no further than this
    except (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, OSError, EOFError, ValueError) as error:
        return ArchiveEntry(name, changed, b"", f"it cannot be unpacked ({str(error)[:100]})")
    if len(data) > most:
        return ArchiveEntry(name, changed, b"", "it is too large")
    return ArchiveEntry(name, changed, data)


def _time(info: zipfile.ZipInfo) -> datetime | None:
    try:
        return datetime(*info.date_time)
    except ValueError:
        return None
