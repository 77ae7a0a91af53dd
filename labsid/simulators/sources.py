"""Open simulations that are files: a function or a class in a Python file, an FMU, or one of these within an FMU."""

import atexit
import importlib.util
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from labsid.simulators.mjcf.sources import is_mjcf, parse_mjcf
from labsid.simulators.simulator import Simulator
from labsid.simulators.stepper import callable_simulator

FUNCTION = "simulate"  # of a Python file, where none is named


def is_source(text: str) -> bool:
    """Whether `text` names a function in a Python file, as ``rig.py:simulate``, an FMU, or a model of MuJoCo."""
    return _split(text) is not None or text.lower().endswith(".fmu") or is_mjcf(text)


def source_file(source: Path) -> Path:
    """The file that `source` names: that of ``rig.py:simulate`` is ``rig.py``."""
    packed = _packed(str(source))
    if packed is not None:
        return packed[0]
    split, model = _split(str(source)), parse_mjcf(str(source))
    if model is not None:
        return model.path
    return source if split is None else split[0]


def read_source(source: str) -> tuple[str, bytes]:
    """The source without its folder, as ``rig.py:simulate``, and the content of its file.

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    packed = _packed(source)
    if packed is None:
        file = source_file(Path(source))
        return source.replace(str(file), file.name, 1), file.read_bytes()
    archive, inner = packed
    with zipfile.ZipFile(archive) as opened:
        return inner, opened.read(f"resources/{source_file(Path(inner))}")


def open_source(text: str) -> Simulator:
    """Open a simulation in this process.

    Parameters
    ----------
    text : str
        ``FILE.py:FUNCTION`` or ``FILE.py:CLASS``, ``FILE.py`` for its function ``simulate``, ``FILE.fmu``, or
        ``FILE.xml:ACTUATOR:OUTPUT`` of MuJoCo; in the resources of an FMU ``OTHER.fmu:FILE.py:FUNCTION`` or
        ``OTHER.fmu:FILE.fmu``.

    Raises
    ------
    ValueError
        If the file or the function does not exist, or cannot be used.
    """
    if _packed(text) is not None:
        return open_source(_unpacked(text))
    split, model = _split(text), parse_mjcf(text)
    if model is not None:
        from labsid.simulators.mjcf.simulation import open_mjcf

        return open_mjcf(model)
    if split is None:
        from labsid.simulators.fmu import open_fmu

        return open_fmu(Path(text))
    path, name = split
    return callable_simulator(_load_function(path, name), f"{path.name}:{name}")


def _packed(text: str) -> tuple[Path, str] | None:
    """The FMU, and the source in its resources, that ``OTHER.fmu:FILE.py:FUNCTION`` names."""
    at = text.lower().find(".fmu:")
    return (Path(text[: at + 4]), text[at + 5 :]) if at >= 0 else None


def _unpacked(text: str) -> str:
    """Write a source in the resources of an FMU to a file that is removed with this process."""
    try:
        name, content = read_source(text)
    except (OSError, KeyError, zipfile.BadZipFile) as error:
        raise ValueError(f"{text} cannot be read: {error}") from None
    folder = tempfile.mkdtemp(prefix="labsid-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (Path(folder) / source_file(Path(name))).write_bytes(content)
    return str(Path(folder) / name)


def _split(text: str) -> tuple[Path, str] | None:
    if text.lower().endswith(".py"):
        return Path(text), FUNCTION
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
    loaded: Callable[..., Any] = function
    return loaded
