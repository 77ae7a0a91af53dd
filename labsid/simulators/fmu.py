"""Co-simulation FMUs (FMI 2.0 and 3.0) as simulations, played by fmpy."""

import atexit
import shutil
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.simulator import Simulator, one_of_each

_REAL = ("Real", "Float32", "Float64")


def open_fmu(path: Path) -> Simulator:
    """Open a co-simulation FMU, in this process.

    Its real parameters with a start value are its numbers, arrays excepted. The input is held between samples.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ValueError
        If fmpy is not installed, or the file is no such FMU.
    """
    fmpy, description = _read(path)
    driven, seen = (_reals(path, description, causality) for causality in ("input", "output"))
    _check_platform(path, fmpy, description)
    real = [
        variable
        for variable in description.modelVariables
        if variable.type in _REAL and variable.causality == "parameter"
    ]
    nominal = {
        variable.name: float(variable.start)
        for variable in real
        if variable.start is not None and not variable.dimensions
    }
    folder = fmpy.extract(str(path))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> Any:
        step = float(t[-1] - t[0]) / max(t.size - 1, 1)
        columns = np.atleast_2d(u.T)
        types = [("time", float), *((name, float) for name in driven)]
        signal = np.array(list(zip(t, *columns, strict=True)), dtype=types)
        result = fmpy.simulate_fmu(
            folder,
            start_time=float(t[0]),
            stop_time=float(t[-1]),
            output_interval=step,
            step_size=step,
            input=signal,
            output=list(seen),
            start_values={name: value for name, value in numbers.items() if value != nominal[name]},
            fmi_type="CoSimulation",
            model_description=description,
        )
        return np.column_stack([result[name] for name in seen]) if u.ndim > 1 else result[seen[0]]

    return Simulator(run, path.name, nominal, inputs=driven, outputs=seen)


def input_and_output(path: Path) -> tuple[str, str]:
    """Names of the input and the output of an FMU that has one of each; for the other errors see `open_fmu`."""
    description = _read(path)[1]
    ends = {what: _reals(path, description, what) for what in ("input", "output")}
    one_of_each(Simulator(lambda t, u, numbers: u, path.name, inputs=ends["input"], outputs=ends["output"]))
    return ends["input"][0], ends["output"][0]


def _read(path: Path) -> tuple[Any, Any]:
    """The module fmpy, and the model description of an FMU."""
    try:
        import fmpy
    except ImportError:
        raise ValueError('an FMU needs fmpy. Run: pip install "labsid[fmu]"') from None
    if not path.is_file():
        raise ValueError(f"{path} does not exist. Give --sim as FILE.fmu.")
    try:
        description = fmpy.read_model_description(str(path))
    except Exception as error:
        raise ValueError(f"{path.name} is not an FMU that can be read: {error}") from None
    if description.fmiVersion.split(".")[0] not in ("2", "3"):
        raise ValueError(f"{path.name} is an FMU of FMI {description.fmiVersion}. Export it as FMI 2.0 or 3.0.")
    if description.coSimulation is None:
        kind = "model exchange" if description.modelExchange is not None else "scheduled execution"
        raise ValueError(f"{path.name} is for {kind} only. Export it for co-simulation.")
    return fmpy, description


def _check_platform(path: Path, fmpy: Any, description: Any) -> None:
    """Reject an FMU without a binary for this machine."""
    here = fmpy.platform if description.fmiVersion == "2.0" else fmpy.platform_tuple
    with zipfile.ZipFile(path) as archive:
        folders = [Path(name).parts[:2] for name in archive.namelist() if name.startswith("binaries/")]
        library = f"binaries/{here}/{description.coSimulation.modelIdentifier}{fmpy.sharedLibraryExtension}"
        found = library in archive.namelist()
    if not found:
        others = ", ".join(sorted({parts[1] for parts in folders if len(parts) > 1})) or "none"
        raise ValueError(f"{path.name} has no binary for {here}, only for {others}. Export it for this platform.")


def _reals(path: Path, description: Any, causality: str) -> tuple[str, ...]:
    """Names of the real inputs or outputs, in the order of the model."""
    found = [one for one in description.modelVariables if one.type in _REAL and one.causality == causality]
    if not found:
        raise ValueError(f"{path.name} has none as real {causality}, expected one.")
    for one in found:
        if one.dimensions:
            raise ValueError(f"the {causality} {one.name} of {path.name} is an array, expected one number.")
    return tuple(one.name for one in found)
