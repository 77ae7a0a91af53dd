"""The rules of grading in the process that runs a notebook: the same code for `labsid submit` and for grading.

While grading, the sandbox also keeps programs, other processes and the network away, limits the process, and blocks the
reference for all code. `labsid submit` runs on the student's machine, where `labsid.hand_in.limited_process` does.
"""

import builtins
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from labsid.checks.permitted import SKIPPED_MAGICS, is_reference, is_taught, is_taught_import


def follow_rules(shell: Any) -> None:
    """Make the cells of an IPython shell follow the rules of imports, and skip what starts a program.

    Parameters
    ----------
    shell : InteractiveShell
    """
    builtins.__import__ = _import_for_cells(shell.user_ns, builtins.__import__)
    shell.system = lambda command: _skip(f"!{command}")
    shell.getoutput = _no_output
    shell.kernel = NoFrontEnd()
    shell.ask_exit = lambda: None
    shell.enable_gui = lambda gui=None: None
    shell.user_ns["_dh"] = [Path.cwd()]  # `%dhist`
    shell.db = {}  # of `%cd` and other magics, which would write it to the home folder
    if not hasattr(shell, "get_parent"):
        shell.parent_header = {}
        shell.get_parent = lambda: shell.parent_header
    sys.breakpointhook = lambda *_, **__: _skip("breakpoint()")
    for name in SKIPPED_MAGICS:
        shell.register_magic_function(
            lambda line, cell=None, name=name: _skip(f"%{name} {line}"), magic_kind="line_cell", magic_name=name
        )


class NoFrontEnd:
    """Takes the place of ``get_ipython().kernel``: whatever a cell does with it has no effect."""

    def __getattr__(self, name: str) -> "NoFrontEnd":
        if name.startswith("_"):
            raise AttributeError(name)
        return self

    def __call__(self, *_: object, **__: object) -> "NoFrontEnd":
        return self


def _no_output(command: str, *_: Any, **__: Any) -> list[str]:
    _skip(f"!{command}")
    return []


def _skip(line: str) -> None:
    print(f"Skipped: {line.strip()} (nothing is installed and no program started while a notebook is graded)")


def _import_for_cells(variables: Mapping[str, object], usual: Callable[..., Any]) -> Callable[..., Any]:
    """`__import__` with a rule for cells: without the reference; of labsid, a star stands for what may be used."""

    def import_(
        name: str,
        global_names: Mapping[str, object] | None = None,
        local_names: Mapping[str, object] | None = None,
        fromlist: Sequence[str] | None = (),
        level: int = 0,
    ) -> Any:
        wanted = fromlist or ()
        if global_names is not variables or level or name.partition(".")[0] not in ("labsid", "autograder"):
            return usual(name, global_names, local_names, fromlist, level)
        named = [f"{name}.{part}" for part in wanted if is_taught_import(name, part)]
        taught = [name] if is_reference(name) else named
        if taught:
            raise ImportError(
                f"{_first_reference(taught[0])} is the reference: it cannot be used in an exercise that is being "
                "graded. Write the step yourself."
            )
        if "*" not in wanted:
            return usual(name, global_names, local_names, fromlist, level)
        module = usual(name, global_names, local_names, ("__name__",), level)  # a star would load all of its names
        names = dict(_permitted_names(module))
        return SimpleNamespace(**names, __all__=list(names))

    return import_


def _first_reference(name: str) -> str:
    """The part of a dotted name that belongs to the reference, as Python's own import would meet it."""
    parts = name.split(".")
    return next(before for n in range(len(parts)) if is_reference(before := ".".join(parts[: n + 1])))


def _permitted_names(module: ModuleType) -> Iterator[tuple[str, object]]:
    for name in getattr(module, "__all__", [one for one in vars(module) if not one.startswith("_")]):
        try:
            value = getattr(module, name)
        except ImportError:  # of the reference, while grading
            continue
        if not is_taught(value):
            yield name, value
