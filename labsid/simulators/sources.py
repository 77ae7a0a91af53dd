"""Open simulations that are files: a function in a Python file, or an FMU."""

import importlib.util
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from labsid.simulators.simulator import Simulator, function_simulator


def is_source(text: str) -> bool:
    """Whether `text` names a function in a Python file, as ``rig.py:simulate``, or an FMU."""
    return _split(text) is not None or text.lower().endswith(".fmu")


def source_file(source: Path) -> Path:
    """The file that `source` names: that of ``rig.py:simulate`` is ``rig.py``."""
    split = _split(str(source))
    return source if split is None else split[0]


def open_source(text: str) -> Simulator:
    """Open a simulation in this process.

    Parameters
    ----------
    text : str
        ``FILE.py:FUNCTION`` or ``FILE.fmu``.

    Raises
    ------
    ValueError
        If the file or the function does not exist, or cannot be used.
    """
    split = _split(text)
    if split is None:
        from labsid.simulators.fmu import open_fmu

        return open_fmu(Path(text))
    path, name = split
    return function_simulator(_load_function(path, name), f"{path.name}:{name}")


def _split(text: str) -> tuple[Path, str] | None:
    head, colon, name = text.rpartition(":")
    return (Path(head), name) if colon and head.lower().endswith(".py") else None


def _load_function(path: Path, name: str) -> Callable[..., Any]:
    if not path.is_file():
        raise ValueError(f"{path} does not exist. Give --sim as FILE.py:FUNCTION.")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(path.resolve().parent))  # for modules beside it
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise ValueError(f"{path} stopped with {type(error).__name__} when it was imported: {error}") from error
    function = getattr(module, name, None)
    if not callable(function):
        own = {key: value for key, value in vars(module).items() if getattr(value, "__module__", "") == module.__name__}
        names = [key for key, value in own.items() if callable(value) and not key.startswith("_")]
        raise ValueError(f"{path} has no function {name!r}; it has {', '.join(names) or 'none'}.")
    found: Callable[..., Any] = function
    return found
