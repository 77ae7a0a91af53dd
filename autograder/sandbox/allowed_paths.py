"""The files that a student process may read: the interpreter, its libraries and the allowed part of labsid.

The reference (the taught functions), the checks with their right values, the grader and the course are not among them,
so every isolation level that confines files hides them.
"""

import os
import site
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from pathlib import Path

ALLOWED_SUBPACKAGES = ("records", "plots", "rig", "checks")
"""The subpackages of labsid that graded code may import, except `checks/assignments` with the right values."""

ALLOWED_MODULES = ("__init__", "_arrays", "_compiled", "_files")
"""The top-level modules of labsid that graded code may import; none of them is taught."""

_SYSTEM = (
    "/lib", "/lib32", "/lib64", "/usr/lib", "/usr/lib32", "/usr/lib64", "/usr/local/lib", "/nix/store",
    "/usr/share/fonts", "/usr/share/fontconfig", "/usr/share/zoneinfo", "/etc/fonts", "/etc/ld.so.cache",
    "/etc/localtime",
)  # fmt: skip
_PACKAGES = ("site-packages", "dist-packages")


def is_reference(module: str) -> bool:
    """Whether a dotted module name belongs to the reference or the grader."""
    parts = module.split(".")
    if parts[0] == "labsid":
        allowed = len(parts) == 1 or parts[1] in (*ALLOWED_SUBPACKAGES, *ALLOWED_MODULES)
        return not allowed or parts[1:3] == ["checks", "assignments"]
    return parts[0] == "autograder"


def package_folders() -> list[Path]:
    """The folders of labsid and of the autograder, hidden except for `allowed_labsid_paths`."""
    autograder = Path(__file__).resolve().parent.parent
    return [_labsid(), autograder]


def allowed_labsid_paths() -> list[Path]:
    """The files and folders of labsid that graded code may import."""
    package = _labsid()
    subpackages = [package / name for name in ALLOWED_SUBPACKAGES if name != "checks"]
    checks = [path for path in (package / "checks").iterdir() if path.suffix == ".py"]
    return [*subpackages, *sorted(checks), *(package / f"{module}.py" for module in ALLOWED_MODULES)]


def interpreter_paths() -> list[Path]:
    """The files and folders of the interpreter, its packages and the system's libraries, none inside another."""
    named = sysconfig.get_paths()
    found = [Path(named[key]) for key in ("stdlib", "platstdlib", "purelib", "platlib")]
    found += [Path(prefix) / "lib" for prefix in (sys.base_prefix, sys.prefix)]
    found += [Path(path) for path in (*sys.path, site.getusersitepackages()) if Path(path).name in _PACKAGES]
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
