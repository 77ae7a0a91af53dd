"""FMUs that tests build: of FMI 2.0 with pythonfmu, of FMI 3.0 with a C compiler."""

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

_SLAVE = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

class Tank(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.inflow = 0.0
        self.level = 0.0
        self.gain = 2.0
        self.pole = 0.9
        self.register_variable(Real("inflow", causality=Fmi2Causality.input))
        self.register_variable(Real("level", causality=Fmi2Causality.output))
        for name in ("gain", "pole"):
            tunable = Fmi2Variability.tunable
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=tunable))
{more}
    def do_step(self, time, step):
        self.level = self.pole * self.level + self.gain * (1.0 - self.pole) * self.inflow
        return True
"""


def build_tank(folder: Path, more: str = "") -> Path:
    """``Tank.fmu`` in a new folder: a sampled first-order lag from `inflow` to `level`; `more` ends its constructor."""
    return build_slave(folder, "Tank", _SLAVE.format(more=more))


def build_slave(folder: Path, name: str, source: str) -> Path:
    """``NAME.fmu`` in a new folder, of the class `name` of pythonfmu in `source`."""
    folder.mkdir(parents=True)
    (folder / "slave.py").write_text(source, encoding="utf-8")
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", "slave.py"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return folder / f"{name}.fmu"


_OSCILLATOR = """
/* y'' + 2 z w y' + w^2 y = gain w^2 u, by Runge-Kutta steps of at most 1 ms; FMI 3.0, co-simulation. */
#include <math.h>
#include <stdlib.h>
#include "fmi3Functions.h"

enum { TIME, FORCE, POSITION, GAIN, FREQUENCY, DAMPING, COUNT };
typedef struct { double value[COUNT], speed; } Rig;

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean log, fmi3Boolean events,
    fmi3Boolean early, const fmi3ValueReference wanted[], size_t n, fmi3InstanceEnvironment environment,
    fmi3LogMessageCallback message, fmi3IntermediateUpdateCallback update)
{
    Rig *rig = calloc(1, sizeof(Rig));
    rig->value[GAIN] = 2.0;
    rig->value[FREQUENCY] = 3.0;
    rig->value[DAMPING] = 0.4;
    return rig;
}

void fmi3FreeInstance(fmi3Instance rig) { free(rig); }

fmi3Status fmi3EnterInitializationMode(
    fmi3Instance rig, fmi3Boolean toleranceDefined, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stopDefined,
    fmi3Float64 stop) { return fmi3OK; }

fmi3Status fmi3ExitInitializationMode(fmi3Instance rig) { return fmi3OK; }

fmi3Status fmi3Terminate(fmi3Instance rig) { return fmi3OK; }

fmi3Status fmi3SetFloat64(
    fmi3Instance rig, const fmi3ValueReference at[], size_t n, const fmi3Float64 values[], size_t nValues)
{
    for (size_t i = 0; i < n; i++) {
        if (at[i] >= COUNT || !isfinite(values[i])) return fmi3Error;
        ((Rig *)rig)->value[at[i]] = values[i];
    }
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(
    fmi3Instance rig, const fmi3ValueReference at[], size_t n, fmi3Float64 values[], size_t nValues)
{
    for (size_t i = 0; i < n; i++) {
        if (at[i] >= COUNT) return fmi3Error;
        values[i] = ((Rig *)rig)->value[at[i]];
    }
    return fmi3OK;
}

static double acceleration(const Rig *rig, double x, double v)
{
    double w = rig->value[FREQUENCY];
    return w * w * (rig->value[GAIN] * rig->value[FORCE] - x) - 2.0 * rig->value[DAMPING] * w * v;
}

fmi3Status fmi3DoStep(
    fmi3Instance instance, fmi3Float64 time, fmi3Float64 size, fmi3Boolean noSetState, fmi3Boolean *event,
    fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
    Rig *rig = instance;
    int steps = (int)ceil(size / 1e-3);
    double h = size / steps, x = rig->value[POSITION], v = rig->speed;
    for (int i = 0; i < steps; i++) {
        double a1 = acceleration(rig, x, v);
        double v2 = v + 0.5 * h * a1, a2 = acceleration(rig, x + 0.5 * h * v, v2);
        double v3 = v + 0.5 * h * a2, a3 = acceleration(rig, x + 0.5 * h * v2, v3);
        double v4 = v + h * a3, a4 = acceleration(rig, x + h * v3, v4);
        x += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
        v += h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
    }
    rig->value[POSITION] = x;
    rig->speed = v;
    *event = *terminate = *early = fmi3False;
    *reached = time + size;
    return fmi3OK;
}
"""

_CO_SIMULATION = '<CoSimulation modelIdentifier="oscillator"/>'
_DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="oscillator" instantiationToken="{{6f9d}}">
  {kind}
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="force" valueReference="1" causality="input" start="0"{force}
    <Float64 name="position" valueReference="2" causality="output"/>
    <Float64 name="gain" valueReference="3" causality="parameter" variability="fixed" start="2"/>
    <Float64 name="frequency" valueReference="4" causality="parameter" variability="tunable" start="3"/>
    <Float64 name="damping" valueReference="5" causality="parameter" variability="fixed" start="0.4"/>
    {more}
  </ModelVariables>
  <ModelStructure><Output valueReference="2"/></ModelStructure>
</fmiModelDescription>
"""


def compiler() -> str | None:
    """The C compiler of this machine; None if it has none."""
    return shutil.which("cc") or shutil.which("gcc")


def build_oscillator(
    path: Path, kind: str = _CO_SIMULATION, force: str = "/>", more: str = "", folder: str | None = None
) -> Path:
    """An FMU of FMI 3.0 with a second-order rig from `force` to `position`, compiled from C.

    `kind` is its interface; `force` ends the element of its input; `more` are further variables; `folder` is that of
    its binary, by default the one of this platform.
    """
    import fmpy

    command = compiler()
    assert command is not None
    library = path.with_suffix(fmpy.sharedLibraryExtension)
    if not library.exists():
        headers = Path(fmpy.__file__).parent / "c-code"
        source, others = path.with_suffix(".c"), path.with_name("others.c")
        source.write_text(_OSCILLATOR, encoding="utf-8")
        others.write_text(_unused_functions(headers / "fmi3Functions.h"), encoding="utf-8")
        flags = ["-shared", "-fPIC", "-O2", f"-I{headers}", "-o", str(library)]
        subprocess.run([command, *flags, str(source), str(others), "-lm"], check=True, capture_output=True)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", _DESCRIPTION.format(kind=kind, force=force, more=more))
        archive.write(library, f"binaries/{folder or fmpy.platform_tuple}/oscillator{fmpy.sharedLibraryExtension}")
    return path


def _unused_functions(header: Path) -> str:
    """C source of all other functions of FMI 3.0, which fmpy looks up and never calls here."""
    names = re.findall(r"^FMI3_Export +\w+ +(\w+);", header.read_text(encoding="utf-8"), re.MULTILINE)
    return "\n".join(f"int {name}(void) {{ return 3; }}" for name in names if f"{name}(" not in _OSCILLATOR)
