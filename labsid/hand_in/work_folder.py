"""The student's work folder: the release copied into it, without overwriting work, and opened in JupyterLab."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from labsid._files import write_file
from labsid.checks.notebook_file import START_PAGE
from labsid.checks.timetable import in_course_order

DEFAULT_FOLDER = Path("labsid-work")


def default_folder() -> Path:
    """The folder that the commands use: this one, if it has a start page; otherwise one below it."""
    return Path() if Path(START_PAGE).is_file() else DEFAULT_FOLDER


def copy_release(release: Path, folder: Path) -> Iterator[str]:
    """Copy the release into a work folder; existing files are kept.

    Parameters
    ----------
    release : Path
        The released notebooks, one folder each, with the start page beside them.
    folder : Path
        The work folder; created if necessary.

    Yields
    ------
    str
        A line for each assignment.

    Raises
    ------
    ValueError
        If `folder` is a file.
    """
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"{folder} is a file; give --folder another name.")
    _copy(release / START_PAGE, folder / START_PAGE)
    names = [path.name for path in release.iterdir() if (path / f"{path.name}.ipynb").is_file()]
    for name in sorted(names, key=in_course_order):
        files = sorted((release / name).glob("[!.]*.*"))
        copied = [file.name for file in files if _copy(file, folder / name / file.name)]
        kept = [file.name for file in files if file.name not in copied]
        parts = [f"{what}: {', '.join(files)}" for what, files in (("new", copied), ("kept", kept)) if files]
        yield f"{name}: {'; '.join(parts)}"


def _copy(file: Path, target: Path) -> bool:
    """Copy a file if it exists and the target does not; returns whether it was copied."""
    if target.exists() or not file.is_file():
        return False
    target.parent.mkdir(parents=True, exist_ok=True)
    write_file(target, file.read_bytes())
    return True


def open_jupyterlab(folder: Path) -> None:
    """Open JupyterLab in the work folder, on the start page, and wait until it is closed.

    Raises
    ------
    ValueError
        If it is not installed.
    """
    from importlib.util import find_spec

    if find_spec("jupyterlab") is None:
        raise ValueError('JupyterLab is not installed. Run: pip install "labsid[notebooks]"')
    page = [START_PAGE] if (folder / START_PAGE).is_file() else []
    try:
        subprocess.run([sys.executable, "-m", "jupyterlab", *page], cwd=folder, check=False)
    except KeyboardInterrupt:
        print(f"JupyterLab closed. Your work is in {folder.resolve()}.")
