"""Formats that are read by libraries of their own: how each is known, and which module reads it."""

import re
import struct
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from labsid.records.column import Log


@dataclass(frozen=True, slots=True)
class LibraryFormat:
    """A format, and the module with its ``open_log(path)``.

    Attributes
    ----------
    title : str
    module : str
        In `labsid.records`.
    package : str
        The package that reads it, as in the extra ``labsid[logs]``.
    suffixes : tuple of str
    magic : tuple of bytes
        What the file begins with.
    """

    title: str
    module: str
    package: str
    suffixes: tuple[str, ...]
    magic: tuple[bytes, ...] = ()


OLE_MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"  # of .xls
HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"
FORMATS = (
    LibraryFormat(
        "workbook", "sheet_file", "python-calamine", (".xlsx", ".xlsm", ".xlsb", ".ods", ".xls"), (OLE_MAGIC,)
    ),
    LibraryFormat("Parquet table", "parquet_file", "pyarrow", (".parquet",), (b"PAR1",)),
    LibraryFormat("MATLAB 7.3 or HDF5", "hdf5_file", "h5py", (".h5", ".hdf5", ".hdf"), (HDF5_MAGIC, b"MATLAB 7.3")),
    LibraryFormat("MDF", "mdf_file", "asammdf", (".mf4", ".mdf", ".dat3"), (b"MDF     ", b"UnFinMF ")),
    LibraryFormat("TDMS", "tdms_file", "nptdms", (".tdms",), (b"TDSm",)),
    LibraryFormat("MCAP", "mcap_file", "mcap", (".mcap",), (b"\x89MCAP0\r\n",)),
    LibraryFormat("ROS bag", "ros_bag", "rosbags", (".bag", ".db3"), (b"#ROSBAG V2.0", b"SQLite format 3\0")),
    LibraryFormat("LeRobot data set", "lerobot_folder", "pyarrow", ()),
)
_ROS, _LEROBOT = FORMATS[-2], FORMATS[-1]
OBJECTS = LibraryFormat("MATLAB file with objects", "mat_objects", "mat-io", ())
_MAT4_KINDS = {1000 * m + 10 * p + t for m in (0, 1) for p in range(6) for t in range(3)}
MAT4 = LibraryFormat("MATLAB 4", "mat4_file", "scipy", ())
JSON = LibraryFormat("JSON", "json_file", "", ())  # of no library, but one file may take a gigabyte
_JSON = re.compile(rb'(\xef\xbb\xbf)?\s*(\{\s*["}]|\[\s*([\[{"]|[-\d.eE]+\s*,))')


def library_format(path: Path) -> LibraryFormat | None:
    """The format of a file or folder, by its first bytes or its suffix; None for text, numpy and older MATLAB files.

    Raises
    ------
    OSError
        If it cannot be opened, or is a folder of no known kind.
    """
    if path.is_dir():
        if (path / "meta" / "info.json").is_file():
            return _LEROBOT
        if (path / "metadata.yaml").is_file():
            return _ROS
    with path.open("rb") as file:
        start = file.read(520)
    for log_format in FORMATS:
        if log_format.magic and start.startswith(log_format.magic):
            return log_format
    if start[512:].startswith(HDF5_MAGIC):
        return FORMATS[2]
    if _JSON.match(start):
        return JSON
    suffix = path.suffix.lower()
    if suffix == ".mat" and _is_mat4(start):
        return MAT4
    is_binary = b"\0" in start or start.startswith(b"PK\3\4")
    if not is_binary or start.startswith((b"\xff\xfe", b"\xfe\xff")):
        return None  # text, whatever its suffix: many loggers name it .xls
    return next((log_format for log_format in FORMATS if suffix in log_format.suffixes), None)


def _is_mat4(start: bytes) -> bool:
    """Whether a file begins with a matrix of MATLAB 4, which has no magic: type, size and a short name."""
    if len(start) < 20:
        return False
    for order in "<>":
        kind, rows, columns, imaginary, name = struct.unpack_from(f"{order}5i", start)
        if kind in _MAT4_KINDS and min(rows, columns) >= 0 and imaginary in (0, 1) and 0 < name < 256:
            return True
    return False


def open_library_log(path: Path, module: str) -> Log:
    """Open a log with the library of its format, which a module reads; for the process of `labsid.records.apart`.

    Raises
    ------
    ValueError
        If the file is damaged, or holds something else.
    """
    log: Log = import_module(f"labsid.records.{module}").open_log(path)
    return log
