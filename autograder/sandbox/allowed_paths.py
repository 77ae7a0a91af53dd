"""The files that a student process may read: the interpreter, its libraries and the allowed part of labsid.

The reference (the taught functions), the checks with their right values, the grader and the course are not among them,
so every isolation level that confines files hides them.
"""

import os
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from pathlib import Path

from labsid.checks.permitted import ALLOWED_FILES, ALLOWED_MODULES, ALLOWED_PACKAGES

_SYSTEM = (
    "/lib", "/lib32", "/lib64", "/usr/lib", "/usr/lib32", "/usr/lib64", "/usr/local/lib", "/nix/store",
    "/usr/share/fonts", "/usr/share/fontconfig", "/usr/share/zoneinfo", "/etc/fonts", "/etc/ld.so.cache",
    "/etc/localtime",
)  # fmt: skip
_PACKAGES = ("site-packages", "dist-packages")


def allowed_modules() -> list[str]:
    """The modules of labsid that graded code may import, as dotted names."""
    inside = [
        f"{package}.{path.stem}"
        for package in ALLOWED_PACKAGES
        for path in sorted(_labsid().joinpath(*package.split(".")).glob("[!_]*.py"))
    ]
    return ["labsid", *(f"labsid.{name}" for name in (*ALLOWED_MODULES, *ALLOWED_PACKAGES, *inside))]


def allowed_labsid_paths() -> list[Path]:
    """The files and folders of labsid that graded code may import."""
    package = _labsid()
    modules = [package.joinpath(*name.split(".")) for name in ALLOWED_MODULES]
    files = [path / "__init__.py" if path.is_dir() else path.with_suffix(".py") for path in (package, *modules)]
    files += [package / name for name in ALLOWED_FILES]
    return [*(package.joinpath(*name.split(".")) for name in ALLOWED_PACKAGES), *files]


def hidden_folders() -> list[Path]:
    """The folders below `interpreter_paths` to hide: labsid and the autograder, and packages that are not in use.

    Any copy of labsid counts, such as one that was installed for another interpreter. `allowed_labsid_paths` are shown.
    """
    own = [_labsid(), Path(__file__).resolve().parent.parent]
    used = {os.path.realpath(path) for path in sys.path}
    hidden = set(own)
    for folder in map(Path.resolve, _packages_folders()):
        if str(folder) not in used:
            hidden.add(folder)
            continue
        hidden |= {(folder / package.name).resolve() for package in own if (folder / package.name).is_dir()}
    return sorted(path for path in hidden if not any(folder in path.parents for folder in hidden))


def _packages_folders() -> Iterator[Path]:
    """The folders named ``site-packages`` or ``dist-packages`` in the interpreter's trees."""
    for tree in interpreter_paths():
        if tree.name in _PACKAGES:
            yield tree
        for pattern in ("{}", "python*/{}", "*/lib/python*/{}"):
            for name in _PACKAGES:
                yield from tree.glob(pattern.format(name))


def interpreter_paths() -> list[Path]:
    """The files and folders of the interpreter, its packages and the system's libraries, none inside another."""
    named = sysconfig.get_paths()
    found = [Path(named[key]) for key in ("stdlib", "platstdlib", "purelib", "platlib")]
    found += [Path(prefix) / "lib" for prefix in (sys.base_prefix, sys.prefix)]
    found += [Path(path) for path in sys.path if Path(path).name in _PACKAGES]
    found += map(Path, _SYSTEM)
    existing = sorted({Path(os.path.abspath(path)) for path in found if os.path.exists(path)})
    return [path for path in existing if not any(other in path.parents for other in existing)]


def exclude_paths(folder: Path, excluded: Iterable[Path]) -> Iterator[Path]:
    """The largest files and folders in a folder that contain no excluded path."""
    excluded = list(excluded)
    if folder.resolve() in excluded:
        return
    if not any(folder.resolve() in path.parents for path in excluded):
        yield folder
        return
    for inner in sorted(folder.iterdir()):
        yield from exclude_paths(inner, excluded)


def _labsid() -> Path:
    import labsid

    return Path(labsid.__file__).resolve().parent
