"""Work folders of submissions and of their processes, and the cleaning up after a grader that was killed."""

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

_NAME = "labsid-workdir-"


def make_workdir() -> Path:
    """An empty work folder; its name says whose it is."""
    return Path(tempfile.mkdtemp(prefix=f"{_NAME}{os.getpid()}-"))


@contextlib.contextmanager
def temporary_workdir() -> Iterator[Path]:
    """An empty work folder, gone afterwards."""
    folder = make_workdir()
    try:
        yield folder
    finally:
        remove(folder)


def remove_stale_workdirs() -> None:
    """Remove the work folders that graders left behind which are no more."""
    for folder in Path(tempfile.gettempdir()).glob(f"{_NAME}*"):
        owner = re.match(rf"{_NAME}(\d+)-", folder.name)
        if owner is not None and not _is_running(int(owner[1])):
            remove(folder)


def size_of(folder: Path) -> int:
    """The bytes of all files in a folder; without end where it is nested deeper than a path can tell."""
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


def remove(folder: Path) -> None:
    """Remove a folder, whatever rights student code took from it, however deep it is, or what was put in its place."""
    if folder.is_symlink() or folder.is_file():
        folder.unlink()
        return
    names = itertools.count()
    found = True
    while found:
        found = False
        for inner in _folders_in(folder):
            for deeper in _folders_in(inner):  # to the top, where its path is short
                with contextlib.suppress(OSError):
                    os.rename(deeper, folder / f"{_NAME}{next(names)}")
                    found = True
            shutil.rmtree(inner, ignore_errors=True)
    shutil.rmtree(folder, ignore_errors=True)


def _folders_in(folder: "str | Path") -> list[str]:
    """The folders in a folder, opened up."""
    found = []
    with contextlib.suppress(OSError):
        os.chmod(folder, 0o700)
        with os.scandir(folder) as entries:
            found = [entry.path for entry in entries if entry.is_dir(follow_symlinks=False)]
    for path in found:
        with contextlib.suppress(OSError):
            os.chmod(path, 0o700)
    return found


def _is_running(process: int) -> bool:
    if os.name != "posix":
        return True  # there, a signal of 0 would end it
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
