"""FMUs that tests build with pythonfmu."""

import subprocess
import sys
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
    folder.mkdir()
    (folder / "tank.py").write_text(_SLAVE.format(more=more), encoding="utf-8")
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", "tank.py"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return folder / "Tank.fmu"
