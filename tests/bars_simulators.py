"""The true linear model of a rig as a function, a system of python-control and an FMU: what is named with each."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import control as ct
import numpy as np
from bars_grading_figures import Metric, every
from fmu_rigs import build_slave
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.blind.experiment import Case
from labsid.blind.rows import EFFECTS
from labsid.blind.suite import make_cases
from labsid.gap.diagnosis import diagnose
from labsid.gap.simulations.baseline import AnySimulation
from labsid.records.record import Record
from labsid.simulators.fmu import open_fmu

INSIDE = {"sqrt-outflow", "overflow", "coulomb-friction", "cubic-stiffness"}  # within the simulation
IN_SAMPLES = {
    "output-quantization",
    "output-outliers",
    "output-dropout",
    "coloured-noise",
}  # found without one
SAMPLES = 1000
NO_EFFECT, FIRST_EFFECT, EVERY = 1, 2, 3  # cases of the row "with-sim": its kinds take turns
GAIN = 1.25  # of a simulation with a wrong number

_SLAVE = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

class Rig(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.y, self.gain, self.x1, self.x2 = <u0>, <y0>, <gain>, 0.0, 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        self.register_variable(Real("gain", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))

    def do_step(self, time, step):
        self.x1, self.x2 = -<a1> * self.x1 - <a2> * self.x2 + self.u - <u0>, self.x1
        self.y = self.gain * (<b1> * self.x1 + <b2> * self.x2) + <y0>
        return True
"""
Model = dict[str, Any]


def as_function(sim: Model, gain: float, folder: Path) -> AnySimulation:
    """A Python function."""
    wrong = gain

    def simulate(t: FloatArray, u: FloatArray, gain: float = wrong) -> FloatArray:
        return gain * np.asarray(lfilter(sim["num"], sim["den"], u - sim["u0"])) + sim["y0"]

    return simulate


def as_control_system(sim: Model, gain: float, folder: Path) -> AnySimulation:
    """A nonlinear system of python-control: a linear one has no offsets."""
    A = np.array([[-sim["den"][1], -sim["den"][2]], [1.0, 0.0]])

    def update(t: float, x: FloatArray, u: FloatArray, params: dict[str, float]) -> FloatArray:
        return np.asarray(A @ x + [u[0] - sim["u0"], 0.0])

    def output(t: float, x: FloatArray, u: FloatArray, params: dict[str, float]) -> float:
        return float(params["gain"] * (np.array(sim["num"][1:]) @ x) + sim["y0"])

    return ct.nlsys(update, output, inputs=1, outputs=1, states=2, dt=sim["dt"], params={"gain": gain})


def as_fmu(sim: Model, gain: float, folder: Path) -> AnySimulation:
    """An FMU of FMI 2.0 for co-simulation."""
    (_, b1, b2), (_, a1, a2) = sim["num"], sim["den"]
    numbers = {"u0": sim["u0"], "y0": sim["y0"], "gain": gain, "a1": a1, "a2": a2, "b1": b1, "b2": b2}
    text = _SLAVE
    for name, value in numbers.items():
        text = text.replace(f"<{name}>", repr(float(value)))
    return open_fmu(build_slave(folder, "Rig", text))


KINDS: dict[str, Callable[[Model, float, Path], AnySimulation]] = {
    "a function": as_function,
    "a system of python-control": as_control_system,
    "an FMU": as_fmu,
}


def measure(folder: Path, say: Callable[[str], None]) -> Iterator[Metric]:
    """Diagnose a record of each effect outside the simulation, one without an effect, and one with a wrong number."""
    cases = list(make_cases("dev", FIRST_EFFECT + EVERY * len(EFFECTS), ["with-sim"]))
    plain = cases[NO_EFFECT]
    outside = [case for case in cases[FIRST_EFFECT::EVERY] if not (INSIDE | IN_SAMPLES) & set(case.labels)]
    # A process for each: pythonfmu imports the class of an FMU once, also where another FMU has the same name for it.
    with ProcessPoolExecutor(mp_context=get_context("spawn"), max_tasks_per_child=1) as pool:
        with_model = list(pool.map(partial(_names, "MODEL.json", folder), outside))
        for what in KINDS:
            named = []
            for case, found in zip(outside, pool.map(partial(_names, what, folder), outside), strict=True):
                say(f"  {what}, {'+'.join(case.labels)}: {'+'.join(found) or 'nothing'}")
                named.append(found)
            right = sum(found == case.labels for found, case in zip(named, outside, strict=True))
            yield every(f"simulation as {what}: the effect named, and nothing else", right, len(outside))
            same = sum(one == other for one, other in zip(named, with_model, strict=True))
            yield every("the same: named as with MODEL.json", same, len(outside))
            none = pool.submit(_names, what, folder, plain)
            wrong = pool.submit(_names, what, folder, plain, GAIN, ["gain"])
            right = (none.result() == ()) + (wrong.result() == ("parameter-mismatch",))
            yield every(
                "the same: none without an effect, and parameter-mismatch with a wrong gain that is free", right, 2
            )


def _model(case: Case) -> Model:
    assert case.sim is not None
    return case.sim


def _names(what: str, folder: Path, case: Case, gain: float = 1.0, free: Sequence[str] = ()) -> tuple[str, ...]:
    """The effects named with one kind of simulation; MODEL.json is taken as it is."""
    own = folder / f"{case.name}-{gain}"
    simulation = KINDS[what](_model(case), gain, own) if what in KINDS else _model(case)
    at = slice(SAMPLES)
    record = Record(case.record.t[at], case.record.u[at], case.record.y[at], case.record.Ts)
    effects = diagnose(record, simulation, free=free).report["effects"]
    return tuple(effect["name"] for effect in effects)
