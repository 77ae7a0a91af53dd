"""Reading of zip files from untrusted sources, within a budget of work.

Whatever a parser raises is a remark on the entry. The work is charged whether or not the entry is kept: a small file
can unpack to gigabytes, and a small archive can list a million entries.
"""

import bz2
import io
import lzma
import stat
import struct
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from datetime import datetime
from typing import IO

from labsid.checks.time_limit import NOTEBOOK_BYTES

MAX_ENTRIES = 20_000
MAX_FILE_BYTES = NOTEBOOK_BYTES

LISTED_WORK, OPENED_WORK = 2_000, 8_000
"""Work of listing and of opening an entry: the time, measured, in which as many bytes are unpacked with deflate."""

SLOW_FACTOR = 30
"""Work of a byte from bzip2 or LZMA, which unpack more slowly by this factor."""

_CENTRAL_ENTRY = b"PK\x01\x02"
_MAX_DICTIONARY = 256 * 1024 * 1024


class OverBudgetError(ValueError):
    """The budget of work is used up."""


@dataclass(slots=True)
class Pool:
    """Work that is left for all students together, beyond the share of each.

    Attributes
    ----------
    left : int
        In bytes unpacked.
    """

    left: int


@dataclass(slots=True)
class Budget:
    """Work that may still be done for one student; the share comes first, then the pool.

    Attributes
    ----------
    share : int
        What is left of the student's own share, in bytes unpacked.
    most : int
        What is left of the most for one student.
    pool : Pool
        For all students.
    """

    share: int
    most: int
    pool: Pool

    @property
    def left(self) -> int:
        """Work that is left."""
        return min(self.most, self.share + self.pool.left)

    def charge(self, work: int) -> None:
        """Take work that has been done, or is about to be done.

        Raises
        ------
        OverBudgetError
            If that was more than what was left.
        """
        is_over = work > self.left
        from_share = min(work, self.share)
        self.share -= from_share
        self.most = max(self.most - work, 0)
        self.pool.left = max(self.pool.left - (work - from_share), 0)
        if is_over:
            raise OverBudgetError("its files take too much work to read")


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


def open_archive(content: IO[bytes], what: str) -> zipfile.ZipFile:
    """Open a zip file; `ValueError` if it is not one, or has too many entries.

    Parameters
    ----------
    content : binary file
    what : str
        Its name, for errors.
    """
    try:
        archive = zipfile.ZipFile(content)
        count = len(archive.infolist())
    except Exception:  # the errors of its parser have no common class
        raise ValueError(f"{what} is not a zip file, or not a complete one.") from None
    if count > MAX_ENTRIES:
        raise ValueError(f"{what} has {count} entries; at most {MAX_ENTRIES} are allowed.")
    return archive


def entry_name(info: zipfile.ZipInfo) -> str:
    """The path of an entry with forward slashes; it ends with one if the entry is a folder."""
    return info.filename.replace("\\", "/")


def read_entries(archive: zipfile.ZipFile, infos: Sequence[zipfile.ZipInfo], budget: Budget) -> Iterator[ArchiveEntry]:
    """Read files of an untrusted archive.

    Parameters
    ----------
    archive : ZipFile
    infos : sequence of ZipInfo
        Its entries to read; folders are left out.
    budget : Budget
        Charged for each of them.

    Yields
    ------
    ArchiveEntry

    Raises
    ------
    OverBudgetError
        If the budget is used up.
    """
    for info in infos:
        budget.charge(LISTED_WORK)
        name = entry_name(info)
        if not name.endswith("/"):
            yield _read(archive, info, name, budget)


def read_packed(data: bytes, what: str, budget: Budget) -> Iterator[ArchiveEntry]:
    """Read all files of an archive inside another one; see `read_entries`.

    Raises
    ------
    ValueError
        If it is not a zip file, or has too many entries.
    OverBudgetError
        If the budget is used up.
    """
    listed = data.count(_CENTRAL_ENTRY)  # before the parser makes an object of each
    if listed > MAX_ENTRIES:
        raise ValueError(f"{what} has more than {MAX_ENTRIES} entries.")
    budget.charge(listed * LISTED_WORK)
    with open_archive(io.BytesIO(data), what) as archive:
        yield from read_entries(archive, archive.infolist(), budget)


def _read(archive: zipfile.ZipFile, info: zipfile.ZipInfo, name: str, budget: Budget) -> ArchiveEntry:
    budget.charge(OPENED_WORK)
    modified = _time(info)
    if not name:
        return ArchiveEntry("a file without a name", modified, b"", "it cannot be unpacked")
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind not in (0, stat.S_IFREG):
        return ArchiveEntry(name, modified, b"", "it is a link or a device, not a file")
    factor = 1 if info.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) else SLOW_FACTOR
    limit = min(MAX_FILE_BYTES, budget.left // factor)
    try:
        data = _unpack(archive, info, limit + 1)  # the declared size can be wrong
    except Exception as error:  # the errors of its parsers have no common class
        budget.charge(min(info.file_size, limit) * factor)  # how much was unpacked before is unknown
        return ArchiveEntry(name, modified, b"", f"it cannot be unpacked ({_said(error)})")
    budget.charge(len(data) * factor)
    if len(data) > limit:
        why = f"it is too large (more than {limit // 2**20} MB)" if limit == MAX_FILE_BYTES else "it is too large"
        return ArchiveEntry(name, modified, b"", why)
    return ArchiveEntry(name, modified, data)


def _unpack(archive: zipfile.ZipFile, info: zipfile.ZipInfo, most: int) -> bytes:
    """At most that many bytes of an entry; the library unpacks bzip2 and LZMA without a limit of its own."""
    if info.compress_type not in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        with archive.open(info) as file:
            return file.read(most)
    packed = copy(info)
    packed.compress_type, packed.file_size, packed.CRC = zipfile.ZIP_STORED, info.compress_size, None  # type: ignore[assignment]
    with archive.open(packed) as file:
        content = file.read()
    if info.compress_type == zipfile.ZIP_BZIP2:
        data = bz2.BZ2Decompressor().decompress(content, most)
    else:
        # version (2 bytes), size of the properties (2), properties: lc, lp and pb in one byte, size of the dictionary
        size, digit, dictionary = struct.unpack("<2xHBL", content[:9])
        if size != 5 or dictionary > _MAX_DICTIONARY:
            raise ValueError("bad LZMA header")
        settings = {"lc": digit % 9, "lp": digit // 9 % 5, "pb": digit // 45, "dict_size": dictionary}
        unpacker = lzma.LZMADecompressor(lzma.FORMAT_RAW, filters=[{"id": lzma.FILTER_LZMA1, **settings}])
        data = unpacker.decompress(content[9:], min(most, info.file_size))
    if len(data) < most and (len(data) != info.file_size or zlib.crc32(data) != info.CRC):
        raise ValueError("its content is damaged")
    return data


def _said(error: Exception) -> str:
    """An error in one short line."""
    return " ".join(str(error).split())[:100].rstrip(".: ") or type(error).__name__


def _time(info: zipfile.ZipInfo) -> datetime | None:
    try:
        return datetime(*info.date_time)
    except (ValueError, TypeError):
        return None
