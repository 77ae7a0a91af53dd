"""Co-simulation FMUs (FMI 2.0 and 3.0) as simulations, played by fmpy."""

import atexit
import shutil
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.simulator import Simulator

_REAL = ("Real", "Float32", "Float64")


def open_fmu(path: Path) -> Simulator:
    """Open a co-simulation FMU with one input and one output, in this process.

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
    driven, seen = _ends(path, description)
    _check_platform(path, fmpy, description)
    real = [one for one in description.modelVariables if one.type in _REAL and one.causality == "parameter"]
    nominal = {one.name: float(one.start) for one in real if one.start is not None and not one.dimensions}
    folder = fmpy.extract(str(path))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)

    def run(t: FloatArray, u: FloatArray, numbers: Mapping[str, float]) -> Any:
        step = float(t[-1] - t[0]) / max(t.size - 1, 1)
        signal = np.array(list(zip(t, u, strict=True)), dtype=[("time", float), (driven, float)])
        result = fmpy.simulate_fmu(
            folder,
            start_time=float(t[0]),
            stop_time=float(t[-1]),
            output_interval=step,
            step_size=step,
            input=signal,
            output=[seen],
            start_values={name: value for name, value in numbers.items() if value != nominal[name]},
            fmi_type="CoSimulation",
            model_description=description,
        )
        return result[seen]

    return Simulator(run, path.name, nominal)


def input_and_output(path: Path) -> tuple[str, str]:
    """Names of the input and the output of an FMU; for the errors see `open_fmu`."""
    return _ends(path, _read(path)[1])


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


def _ends(path: Path, description: Any) -> tuple[str, str]:
    """Names of the input and the output."""
    ends = []
    for causality in ("input", "output"):
        found = [one for one in description.modelVariables if one.type in _REAL and one.causality == causality]
        if len(found) != 1:
            named = f"{len(found)} ({', '.join(one.name for one in found)})" if found else "none"
            raise ValueError(f"{path.name} has {named} as real {causality}, expected one.")
        if found[0].dimensions:
            raise ValueError(f"the {causality} {found[0].name} of {path.name} is an array, expected one number.")
        ends.append(found[0].name)
    return ends[0], ends[1]
