"""Temporary work folders of student processes, and their removal after a grader was killed."""

import contextlib
import errno
import itertools
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

_PREFIX = "labsid-workdir-"
_MIN_FREE_BYTES = 1024 * 1024


def make_workdir() -> Path:
    """Create an empty work folder, named after this process."""
    return Path(tempfile.mkdtemp(prefix=f"{_PREFIX}{os.getpid()}-"))


@contextlib.contextmanager
def temporary_workdir() -> Iterator[Path]:
    """Create an empty work folder and remove it on exit."""
    folder = make_workdir()
    try:
        yield folder
    finally:
        remove_folder(folder)


def remove_stale_workdirs() -> None:
    """Remove the work folders of graders that no longer run."""
    for folder in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        owner = re.match(rf"{_PREFIX}(\d+)-", folder.name)
        if owner is not None and not _is_running(int(owner[1])):
            remove_folder(folder)


def disk_is_full() -> bool:
    """Whether the disk of the work folders has no space left."""
    try:
        return shutil.disk_usage(tempfile.gettempdir()).free < _MIN_FREE_BYTES
    except OSError:
        return True


def folder_bytes(folder: Path) -> int:
    """Total size of the files in a folder; `sys.maxsize` if it is nested too deeply for a path."""
    size, folders = 0, [os.fspath(folder)]
    while folders:
        try:
            with os.scandir(folders.pop()) as entries:
                for entry in entries:
                    if entry.is_dir(follow_symlinks=False):
                        folders.append(entry.path)
                        continue
                    with contextlib.suppress(OSError):
                        size += entry.stat(follow_symlinks=False).st_size
        except OSError as error:
            if error.errno == errno.ENAMETOOLONG:
                return sys.maxsize
    return size


def remove_folder(folder: Path) -> None:
    """Remove a folder, whatever its permissions and depth; remove a link or file in its place."""
    if folder.is_symlink() or folder.is_file():
        folder.unlink()
        return
    names = itertools.count()
    moved = True
    while moved:
        moved = False
        for inner in _folders_in(folder):
            for deeper in _folders_in(inner):  # move it up, to keep its path short
                with contextlib.suppress(OSError):
                    os.rename(deeper, folder / f"{_PREFIX}{next(names)}")
                    moved = True
            shutil.rmtree(inner, ignore_errors=True)
    shutil.rmtree(folder, ignore_errors=True)


def _folders_in(folder: "str | Path") -> list[str]:
    """Make the folders in a folder accessible, and list them."""
    found = []
    with contextlib.suppress(OSError):
        os.chmod(folder, 0o700)
        with os.scandir(folder) as entries:
            found = [entry.path for entry in entries if entry.is_dir(follow_symlinks=False)]
    for path in found:
        with contextlib.suppress(OSError):
            os.chmod(path, 0o700)
    return found


def _is_running(pid: int) -> bool:
    if os.name != "posix":
        return True  # on Windows, signal 0 would end the process
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
