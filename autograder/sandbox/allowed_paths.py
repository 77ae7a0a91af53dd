"""What a student's process may see of this machine: the interpreter, its libraries, the allowed part of labsid.

The reference (the taught functions), the checks with their right values, the grader, the course and everything else
are not in the list, so a rung that confines files leaves them out.
"""

import os
import site
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from pathlib import Path

ALLOWED_OF_LABSID = {"records", "plots", "rig", "checks", "_arrays"}
"""What an exercise may import of labsid."""

_SYSTEM = (
    "/lib", "/lib32", "/lib64", "/usr/lib", "/usr/lib32", "/usr/lib64", "/usr/local/lib", "/nix/store",
    "/usr/share/fonts", "/usr/share/fontconfig", "/usr/share/zoneinfo", "/etc/fonts", "/etc/ld.so.cache",
    "/etc/localtime",
)  # fmt: skip
_PACKAGES = ("site-packages", "dist-packages")


def is_reference(module: str) -> bool:
    """Whether a module, by its dotted name, is the reference or the grader."""
    parts = module.split(".")
    if parts[0] == "labsid":
        return len(parts) > 1 and (parts[1] not in ALLOWED_OF_LABSID or parts[1:3] == ["checks", "assignments"])
    return parts[0] == "autograder"


def own_packages() -> list[Path]:
    """The folders of labsid and of the autograder: shut, but for `allowed_of_labsid`."""
    autograder = Path(__file__).resolve().parent.parent
    return [_labsid(), autograder]


def allowed_of_labsid() -> list[Path]:
    """The files and folders of labsid that exercises use: all of the drawing and of the rig, and what is loaded.

    Asked in the pre-imported parent, which loads what exercises use and nothing of the reference.
    """
    package = _labsid()
    folders = [package / "plots", package / "rig"]
    loaded = [module for name, module in list(sys.modules.items()) if name.split(".")[0] == "labsid"]
    files = {Path(module.__file__).resolve() for module in loaded if module.__file__ is not None}
    return folders + sorted(file for file in files if not any(folder in file.parents for folder in folders))


def trees() -> list[Path]:
    """The folders and files of the interpreter, its packages and the system's libraries, none inside another."""
    named = sysconfig.get_paths()
    found = [Path(named[key]) for key in ("stdlib", "platstdlib", "purelib", "platlib")]
    found += [Path(prefix) / "lib" for prefix in (sys.base_prefix, sys.prefix)]
    found += [Path(path) for path in (*sys.path, site.getusersitepackages()) if Path(path).name in _PACKAGES]
    found += map(Path, _SYSTEM)
    there = sorted({Path(os.path.abspath(path)) for path in found if os.path.exists(path)})
    return [path for path in there if not any(other in path.parents for other in there)]


def without(tree: Path, shut: Iterable[Path]) -> Iterator[Path]:
    """The parts of a tree that hold nothing of what is shut."""
    shut = list(shut)
    if tree.resolve() in shut:
        return
    if not any(tree.resolve() in path.parents for path in shut):
        yield tree
        return
    for inner in sorted(tree.iterdir()):
        yield from without(inner, shut)


def _labsid() -> Path:
    import labsid

    return Path(labsid.__file__).resolve().parent
