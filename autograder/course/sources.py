"""Fingerprints of source files: modules with everything they import, directly or indirectly."""

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from labsid.checks.cell_names import parse_python

PACKAGES = ("labsid", "autograder")
"""Packages whose source can change without a new version."""


@cache
def sources_hash(*modules: str) -> str:
    """Fingerprint of modules and of everything they import from labsid and the autograder.

    Parameters
    ----------
    *modules : str
        Dotted names.

    Returns
    -------
    str
        Changes if any of the files changes. Imports by a computed name are not followed, so the checks of an
        assignment must be passed explicitly.
    """
    digest = hashlib.sha256()
    for name in sorted(imported_modules(modules)):
        path = source_path(name)
        digest.update(name.encode() + b"\0" + (b"" if path is None else hashlib.sha256(path.read_bytes()).digest()))
    return digest.hexdigest()


def imported_modules(modules: tuple[str, ...]) -> set[str]:
    """The modules, and all modules of `PACKAGES` that they import, directly or indirectly."""
    found: set[str] = set()
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        if name in found or name.split(".")[0] not in PACKAGES or source_path(name) is None:
            continue
        found.add(name)
        waiting += [name.rpartition(".")[0], *_imports(name)]
    return found


@cache
def _imports(name: str) -> tuple[str, ...]:
    path = source_path(name)
    assert path is not None
    return tuple(_imported(parse_python(path.read_bytes())))


def _imported(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@cache
def source_path(name: str) -> Path | None:
    """The file of a module of `PACKAGES`; None for any other name, such as a function in a module."""
    top, _, rest = name.partition(".")
    if top not in PACKAGES:
        return None
    spec = find_spec(top)
    if spec is None or spec.origin is None:
        return None
    base = Path(spec.origin).parent.joinpath(*rest.split(".")) if rest else Path(spec.origin).parent
    return next((path for path in (base.with_suffix(".py"), base / "__init__.py") if path.is_file()), None)
