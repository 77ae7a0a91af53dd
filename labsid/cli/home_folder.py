"""A home folder for the libraries that keep settings and caches there, where that of the user cannot be written.

In a container, or for the user of a service, the home folder may be missing or read-only. IPython, Jupyter and
Matplotlib then stop, or print warnings and begin without a cache each time.
"""

import os
import stat
from pathlib import Path

_OWN_FOLDERS = (
    "XDG_CONFIG_HOME",
    "XDG_CACHE_HOME",
    "XDG_DATA_HOME",
    "MPLCONFIGDIR",
    "IPYTHONDIR",
    "JUPYTER_CONFIG_DIR",
    "JUPYTER_DATA_DIR",
    "JUPYTER_RUNTIME_DIR",
)
"""Variables that name a folder for settings or caches; without them it is below the home folder."""


def provide_home() -> None:
    """Set ``HOME`` to a folder of this user below that of temporary files, unless the home folder can be written.

    Variables that name folders for settings or caches are removed where these cannot be written. Processes that are
    started later inherit both.

    Raises
    ------
    ValueError
        If no folder for temporary files can be written either.
    """
    if os.name != "posix":
        return  # Windows has its folders of users elsewhere
    for name in _OWN_FOLDERS:
        if os.environ.get(name) and not _can_be_made(Path(os.environ[name])):
            del os.environ[name]
    try:
        home = Path.home()
    except RuntimeError:  # this user has no home folder
        home = None
    if home is None or not (home.is_dir() and os.access(home, os.W_OK | os.X_OK)):
        os.environ["HOME"] = str(_temporary_home())


def _can_be_made(folder: Path) -> bool:
    existing = next((one for one in (folder, *folder.absolute().parents) if one.exists()), folder)
    return existing.is_dir() and os.access(existing, os.W_OK | os.X_OK)


def _temporary_home() -> Path:
    """The same folder in each run, so that caches are kept; a new one if somebody else has made that."""
    import tempfile  # not at the top: only needed where there is no home folder

    try:
        folder = Path(tempfile.gettempdir(), f"labsid-home-{os.getuid()}")
        try:
            folder.mkdir(mode=0o700)
        except FileExistsError:
            found = folder.lstat()
            if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or stat.S_IMODE(found.st_mode) != 0o700:
                return Path(tempfile.mkdtemp(prefix="labsid-home-"))
        return folder
    except OSError as error:
        raise ValueError(
            f"neither the home folder nor a folder for temporary files can be written ({error.strerror or error}). "
            "Set HOME or TMPDIR to a folder that can."
        ) from None
