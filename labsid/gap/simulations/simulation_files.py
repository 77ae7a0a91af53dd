"""Simulations from files: read one for `--sim`, or run one with the input of a record."""

import csv
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from labsid._arrays import FloatArray
from labsid._files import write_file
from labsid.gap.dynamics.record_start import LEAST_START, RecordStart
from labsid.gap.model_file import SCHEMA, load_model, read_exported_model
from labsid.gap.record.clock import at_sampling_time, stated_sampling_time
from labsid.gap.record.data import scaled
from labsid.gap.record.record_findings import filtered_input
from labsid.gap.simulations.baseline import Simulation, check_bounded, make_baseline
from labsid.gap.simulations.fmu_export import read_fmu_content
from labsid.gap.simulations.model_json import read_transfer_function
from labsid.gap.simulations.simulated_output import SimulatedOutput, resample
from labsid.records.record import Record, between_outputs, bridge_gaps
from labsid.records.several_signals import one_signal_each
from labsid.simulators.mjcf.sources import MjcfSource, parse_mjcf
from labsid.simulators.process import open_in_process
from labsid.simulators.simulator import Simulator, one_of_each
from labsid.simulators.sources import is_source

MAX_MISSING = 0.5  # samples by which a simulated output may begin later or end earlier; set by hand


@dataclass(frozen=True, slots=True)
class Ports:
    """The signals of a model of MuJoCo that a record holds.

    Attributes
    ----------
    actuator, output : str
        Names, of several with commas between; empty for the only one.
    trusted : bool
        Whether the model may read files outside its folder and load plugins.
    """

    actuator: str = ""
    output: str = ""
    trusted: bool = False

    @property
    def several(self) -> bool:
        """Whether several are named: they are then the columns of the record, too."""
        return "," in self.actuator or "," in self.output

    def of(self, source: str | Path) -> str:
        """The source of a simulation, with these signals if it is a model of MuJoCo; others have none to choose."""
        model = parse_mjcf(str(source))
        if model is None:
            if self != NO_PORTS:
                raise ValueError(f"--inputs, --outputs and --trust are for a model of MuJoCo (FILE.xml); got {source}.")
            return str(source)
        chosen = (self.actuator or model.actuator, self.output or model.output, self.trusted or model.trusted)
        return str(MjcfSource(model.path, *chosen))


NO_PORTS = Ports()


@dataclass(frozen=True, slots=True, eq=False)
class Replay:
    """A simulation run with the input of a record.

    Attributes
    ----------
    y : ndarray, shape (N,)
        Simulated output.
    rmse : float
        Root mean square error after the first `start` samples.
    start : int
        Number of samples that determine the initial state.
    stabilised : bool
        Whether the measured output corrects it, as that of an unstable rig.
    """

    y: FloatArray
    rmse: float
    start: int
    stabilised: bool = False


def load_simulation(source: str | Path, record: Record, several: bool = False, ports: Ports = NO_PORTS) -> Simulation:
    """Read the argument of `--sim`.

    It is MODEL.json, an exported simulation, FILE.py:FUNCTION, FILE.fmu, a model of MuJoCo (FILE.xml), or a .csv with
    the header t,y. A function, an FMU and a model of MuJoCo run in a process of their own; of an FMU that ``--export``
    wrote, the simulation in it is read. `ports` are the actuator and the output of a model of MuJoCo.

    Raises
    ------
    ValueError
        If the file is none of these, a simulated output does not cover the record, or there are `several` records.
    """
    path, chosen = Path(source), ports.of(source)
    if is_source(chosen):
        return read_fmu_content(path) or open_in_process(chosen)
    if path.suffix.lower() == ".csv":
        if several:
            raise ValueError(
                f"{path}: a simulated output belongs to one record. Give a MODEL.json for several records."
            )
        return _read_output(path, between_outputs(record))  # what a diagnosis reads of it
    return load_model(path)


def _read_output(path: Path, record: Record) -> SimulatedOutput:
    """The simulated output in a file at the record's times; at other times, interpolated there."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.DictReader(file))
        t = np.array([float(row["t"]) for row in rows])
        y = np.array([float(row["y"]) for row in rows])
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"{path}: a simulated output must be a .csv with the header t,y and numbers below.") from None
    if not t.size:
        raise ValueError(f"{path}: holds no rows below the header t,y.")
    for name, values in (("t", t), ("y", y)):
        missing = np.flatnonzero(~np.isfinite(values))
        if missing.size:
            raise ValueError(
                f"{path}: must hold finite numbers; got {name} = {values[missing[0]]:g} in row {missing[0] + 1}."
            )
    near = 0.5 if record.jitter else 0.01  # with jitter, accept both time stamps and even times
    if t.size == len(record) and np.all(np.abs(t - record.t) <= near * record.Ts):
        return SimulatedOutput(y)
    back = np.flatnonzero(np.diff(t) <= 0.0)
    if back.size:
        k = back[0] + 1
        raise ValueError(f"{path}: its times must increase; got t = {t[k]:g} s in row {k + 1} after {t[k - 1]:g} s.")
    if max(t[0] - record.t[0], record.t[-1] - t[-1]) > MAX_MISSING * record.Ts:
        raise ValueError(
            f"{path}: must hold the output at all times of the record, {record.t[0]:g} to {record.t[-1]:g} s; got "
            f"{t[0]:g} to {t[-1]:g} s. Simulate the whole record, or cut the record."
        )
    return resample(t, y, record.t)


def replay(source: Path, record: Record, ports: Ports = NO_PORTS) -> Replay:
    """Run a simulation with the input of a record; the first output samples determine the initial state.

    Raises
    ------
    ValueError
        If the source is no simulation that can be run, or one with another sampling time.
    """
    one_signal_each(record, "this simulation")
    measured, record = ~record.missing, replace(record, y=bridge_gaps(record.y))
    stabilised = False
    chosen, content = ports.of(source), read_fmu_content(source)
    if content is None and is_source(chosen):
        y, start = _play(one_of_each(open_in_process(chosen)), record)
    else:
        content = content or load_model(source)
        record = at_sampling_time(record, stated_sampling_time(content))
        if content.get("schema") == SCHEMA:
            model = read_exported_model(content, record.Ts)
            y, start = model.simulate(filtered_input(record), record.y), model.start
            stabilised = model.hypothesis.feedback is not None
        else:
            function = read_transfer_function(content, record.Ts)
            y, start = function.simulate(record.u, record.y), function.start
    check_bounded(y, record.y)
    first = start.samples(len(record)) if len(record) > 2 * LEAST_START else 0
    rmse = float(np.sqrt(np.mean((record.y - y)[first:][measured[first:]] ** 2)))
    return Replay(y, rmse, first, stabilised)


def _play(simulate: Simulator, record: Record) -> tuple[FloatArray, RecordStart]:
    """Output of a simulator, and which samples its start is estimated from.

    Responses of a linear model of the rig stand for its initial state.
    """
    record = Record(record.t, filtered_input(record), record.y, record.Ts)
    data = scaled(record.u, record.y, np.ones(len(record), bool), record.Ts, float(record.t[0]))
    baseline = make_baseline(data, record.t, simulate)
    assert baseline.simulate_record is not None
    start = RecordStart(baseline.structure.plant.simulation.rates)
    return baseline.simulate_record(record, start), start


def write_replay(path: Path, record: Record, y: FloatArray) -> None:
    """Write t, u, y and y_sim as .csv."""
    lines = ["t,u,y,y_sim"]
    lines += [",".join(repr(float(x)) for x in row) for row in zip(record.t, record.u, record.y, y, strict=True)]
    write_file(path, ("\n".join(lines) + "\n").encode())
