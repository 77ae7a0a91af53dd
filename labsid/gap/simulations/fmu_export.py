"""Corrected simulations as co-simulation FMUs (FMI 2.0), built by pythonfmu."""

import hashlib
import importlib.util
import json
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any

from labsid._files import write_file
from labsid.gap.sampled_run import CONTENT
from labsid.gap.system_file import SYSTEM_SCHEMA, exported_from_json, exported_with_sources
from labsid.simulators.fmu import input_and_output
from labsid.simulators.sources import read_source, source_file

_SLAVE = '''\
"""Corrected simulation, written by `labsid gap diagnose --export`. It runs in a Python that has labsid."""

from functools import partial
from pathlib import Path

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.default_experiment import DefaultExperiment


class {name}(Fmi2Slave):
    """Inputs are read every {Ts:g} s, the sampling time of the record, and outputs then change."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.description = "Corrected simulation, written by labsid gap diagnose --export"
        self.default_experiment = DefaultExperiment(step_size={Ts!r})
        self.driven, self.of_record = [0.0] * {nu}, False
        self.start, self.run = 0.0, None
        for i, name in enumerate({driven!r}):
            self.register_variable(
                Real(name, causality=Fmi2Causality.input, getter=partial(self.held, i), setter=partial(self.drive, i))
            )
        for j, name in enumerate({seen!r}):
            self.register_variable(Real(name, causality=Fmi2Causality.output, getter=partial(self.output, j)))
{parameters}
    def held(self, i):
        return self.driven[i]

    def drive(self, i, value):
        self.driven[i] = value

    def output(self, j):
        return 0.0 if self.run is None else self.run.outputs(*self.driven)[j]

    def setup_experiment(self, start_time, stop_time, tolerance):
        self.start = start_time

    def exit_initialization_mode(self):
        from labsid.gap.sampled_run import open_sampled_run

        self.run = open_sampled_run(Path(self.resources), self.start, self.of_record)

    def do_step(self, time, step):
        self.run.advance(time + step, *self.driven)
        return True
'''

_OF_RECORD = """\
        self.register_variable(
            Boolean(
                "of_record",
                causality=Fmi2Causality.parameter,
                variability=Fmi2Variability.fixed,
                description="Whether loads, sinusoids and drifts of the diagnosed record act, at its times",
            )
        )
"""


def check_fmu_export() -> None:
    """Check that FMUs can be written, before a long computation.

    Raises
    ------
    ValueError
        If pythonfmu or fmpy is not installed.
    """
    for package in ("pythonfmu", "fmpy"):
        if importlib.util.find_spec(package) is None:
            raise ValueError(f'writing an FMU needs {package}. Run: pip install "labsid[fmu]"')


def write_fmu(path: Path, content: dict[str, Any]) -> None:
    """Write an exported simulation as an FMU. It holds the file of a given simulation, too.

    With several signals, its variables have their names. Otherwise they are those of a given FMU, or ``u`` and ``y``.

    Parameters
    ----------
    path : Path
    content : dict
        From `ExportedModel.to_json_dict` or `ExportedSystem.to_json_dict`.

    Raises
    ------
    ValueError
        If pythonfmu is not installed or cannot build it, the given simulation does not run with its own file alone, or
        the rig is unstable.
    """
    check_fmu_export()
    several = content.get("schema") == SYSTEM_SCHEMA
    if content.get("feedback") is not None:
        raise ValueError(
            f"{path.name}: the rig is unstable, so its simulation needs the measured output beside the input, which an "
            "FMU with one input has no place for. Export it as .json or .py."
        )
    driven, seen = (_names(content, "inputs"), _names(content, "outputs")) if several else (["u"], ["y"])
    models = [one["model"] for one in content["outputs"]] if several else [content]
    given = next((one["simulator"]["source"] for one in models if "simulator" in one), None)
    with tempfile.TemporaryDirectory(prefix="labsid-") as temporary:
        folder = Path(temporary)
        files = [folder / CONTENT]
        if given is not None:
            source, data = read_source(given)
            files.append(folder / source_file(Path(source)))
            files[-1].write_bytes(data)
            if source.lower().endswith(".fmu") and not several:
                driven, seen = ([name] for name in input_and_output(files[-1]))
            content = exported_with_sources(content, lambda _: source)
        files[0].write_text(json.dumps(content), encoding="utf-8")
        name = _identifier(path.stem, files)
        script = folder / f"{name}.py"
        parameters = "" if several else _OF_RECORD
        text = _SLAVE.format(
            name=name, Ts=content["Ts"], driven=driven, nu=len(driven), seen=seen, parameters=parameters
        )
        script.write_text(text, encoding="utf-8")
        built = _build(script, files)
        _check_alone(path, built)
        write_file(path, built.read_bytes())


def _names(content: dict[str, Any], which: str) -> list[str]:
    return [one["name"] for one in content[which]]


def read_fmu_content(path: Path) -> dict[str, Any] | None:
    """The exported simulation in an FMU that `write_fmu` wrote; None for any other file."""
    try:
        with zipfile.ZipFile(path) as opened:
            content: dict[str, Any] = json.loads(opened.read(f"resources/{CONTENT}"))
    except (OSError, KeyError, ValueError, zipfile.BadZipFile):
        return None
    return exported_with_sources(content, lambda source: f"{path}:{source}")


def _identifier(stem: str, files: list[Path]) -> str:
    """Name of the model, different for each content: two models of one name cannot run in one process."""
    digest = hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()
    return re.sub(r"^(?=\d)", "m", re.sub(r"\W", "_", f"{stem}_{digest[:8]}", flags=re.ASCII))


def _build(script: Path, files: list[Path]) -> Path:
    out = script.parent / "built"
    command = [sys.executable, "-P", "-m", "pythonfmu", "build", "-f", str(script), "-d", str(out), *map(str, files)]
    done = subprocess.run(command, cwd=script.parent, capture_output=True, text=True, encoding="utf-8")
    built = list(out.glob("*.fmu"))
    if done.returncode or not built:
        reason = (done.stderr.strip() or "no reason given").splitlines()[-1]
        raise ValueError(f"pythonfmu cannot build the FMU: {reason}")
    return built[0]


def _check_alone(path: Path, built: Path) -> None:
    """Check that the simulation in an FMU can be opened from it."""
    content = read_fmu_content(built)
    assert content is not None
    try:
        exported_from_json(content)
    except ValueError as error:
        raise ValueError(
            f"{path.name} cannot hold the simulation: {error} An FMU takes along one file: put what it imports from "
            "other files beside it into that file, or export as .py."
        ) from None
