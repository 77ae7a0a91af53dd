"""What a student's process may see of this machine: the interpreter, its libraries, the allowed part of labsid.

The reference (the taught functions), the checks with their right values, the grader, the course and everything else
are not in the list, so a level that confines files leaves them out.
"""

import os
import site
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from pathlib import Path

ALLOWED_ROOMS = ("records", "plots", "rig", "checks")
"""The rooms of labsid that student code may import while it is graded, without the answers in `checks/assignments`."""

ALLOWED_MODULES = ("__init__", "_arrays", "_compiled", "_files")
"""And the modules that stand beside them; none of them is taught."""

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
        allowed = len(parts) == 1 or parts[1] in (*ALLOWED_ROOMS, *ALLOWED_MODULES)
        return not allowed or parts[1:3] == ["checks", "assignments"]
    return parts[0] == "autograder"


def own_packages() -> list[Path]:
    """The folders of labsid and of the autograder: shut, but for `allowed_of_labsid`."""
    autograder = Path(__file__).resolve().parent.parent
    return [_labsid(), autograder]


def allowed_of_labsid() -> list[Path]:
    """The files and folders of labsid that student code may import."""
    package = _labsid()
    rooms = [package / room for room in ALLOWED_ROOMS if room != "checks"]
    checks = [path for path in (package / "checks").iterdir() if path.suffix == ".py"]
    return [*rooms, *sorted(checks), *(package / f"{module}.py" for module in ALLOWED_MODULES)]


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
