"""Writing files: whole or not at all."""

import errno
import json
import os
from pathlib import Path
from typing import Any


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write a JSON object to a file; see `write_file`."""
    write_file(path, (json.dumps(content, indent=2, allow_nan=False) + "\n").encode())


def write_file(path: Path, content: bytes) -> None:
    """Write a file so that it is there whole or, if anything fails, as it was before.

    Parameters
    ----------
    path : Path
        A file of that name is replaced; its folder must exist. A device or a pipe is simply written to.
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
    """Refuse a path to which `write_file` could not write, ahead of the work whose result shall go there.

    Parameters
    ----------
    path : Path

    Raises
    ------
    OSError
        If it is a folder, or its folder does not exist or takes no files.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "it is a folder; name a file to write to", str(path))
    folder = path.resolve().parent
    if not folder.is_dir():
        raise FileNotFoundError(errno.ENOENT, "there is no such folder to write to", str(folder))
    if not path.exists() and not os.access(folder, os.W_OK):
        raise PermissionError(errno.EACCES, "nothing can be written into this folder", str(folder))


def write_text(path: Path, text: str) -> None:
    """Write a text file with `write_file`, in a folder that is made where it is not there.

    Lone surrogates, which text from students can hold and no file can, are written as their escapes.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file(path, text.encode(errors="backslashreplace"))
