"""Co-simulation FMUs (FMI 2.0 and 3.0) as simulations, played by fmpy."""

import atexit
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.simulators.simulator import Simulator

_REAL = ("Real", "Float64")


def open_fmu(path: Path) -> Simulator:
    """Open a co-simulation FMU with one input and one output, in this process.

    Its real parameters with a start value are its numbers. The input is held between samples.

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
    real = [one for one in description.modelVariables if one.type in _REAL and one.causality == "parameter"]
    nominal = {one.name: float(one.start) for one in real if one.start is not None}
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
    if description.coSimulation is None:
        raise ValueError(f"{path.name} is for model exchange only. Export it for co-simulation.")
    return fmpy, description


def _ends(path: Path, description: Any) -> tuple[str, str]:
    """Names of the input and the output."""
    ends = []
    for causality in ("input", "output"):
        names = [one.name for one in description.modelVariables if one.type in _REAL and one.causality == causality]
        if len(names) != 1:
            found = f"{len(names)} ({', '.join(names)})" if names else "none"
            raise ValueError(f"{path.name} has {found} as real {causality}, expected one.")
        ends += names
    return ends[0], ends[1]
