"""Run a simulation of several signals with the inputs of a record."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid._files import write_file
from labsid.gap.dynamics.record_start import LEAST_START, RecordStart
from labsid.gap.model_file import load_model
from labsid.gap.signals.given import as_system
from labsid.gap.signals.input_responses import linear_parts
from labsid.gap.signals.preparation import prepare
from labsid.gap.simulations.baseline import check_bounded
from labsid.gap.simulations.fmu_export import read_fmu_content
from labsid.gap.simulations.model_json import started
from labsid.gap.system_file import SYSTEM_SCHEMA, ExportedSystem, system_from_json, system_in_folder
from labsid.records.record import Record, bridge_gaps
from labsid.simulators.process import open_in_process
from labsid.simulators.sources import is_source


@dataclass(frozen=True, slots=True, eq=False)
class SignalsReplay:
    """A simulation of several signals, run with the inputs of a record.

    Attributes
    ----------
    y : ndarray, shape (N, ny)
        Simulated outputs.
    rmse : ndarray, shape (ny,)
        Root mean square errors after the first `start` samples.
    start : int
        Number of samples that determine the initial state.
    """

    y: FloatArray
    rmse: FloatArray
    start: int


def exported_system(source: Path) -> dict[str, Any] | None:
    """The content of an exported simulation of several signals; None for any other file."""
    if source.suffix.lower() == ".fmu":
        content = read_fmu_content(source)
        return content if content is not None and content.get("schema") == SYSTEM_SCHEMA else None
    if source.suffix.lower() != ".json" or not source.is_file():
        return None
    content = load_model(source)
    return system_in_folder(content, source.resolve().parent) if content.get("schema") == SYSTEM_SCHEMA else None


def names_in(content: Mapping[str, Any]) -> tuple[str, str]:
    """Names of the inputs and of the outputs of an exported simulation, as ``--inputs`` and ``--outputs`` take them."""
    try:
        inputs, outputs = (",".join(str(one["name"]) for one in content[key]) for key in ("inputs", "outputs"))
    except (KeyError, TypeError):
        raise ValueError("not an exported simulation of several signals: its names are missing.") from None
    return inputs, outputs


def replay_signals(source: Path, record: Record) -> SignalsReplay:
    """Run a simulation of several signals with the inputs of a record; first samples determine the initial state.

    Parameters
    ----------
    source : Path
        What ``--export`` wrote, ``FILE.py:FUNCTION`` or an FMU.
    record : Record

    Raises
    ------
    ValueError
        If it is no such simulation, or has other signals or another sampling time.
    """
    content = exported_system(source)
    if content is not None:
        y, start = _exported(system_from_json(content), record)
    elif is_source(str(source)):
        y, start = _played(source, record)
    else:
        raise ValueError(
            f"{source} is no simulation of several signals. Give what --export wrote, FILE.py:FUNCTION or FILE.fmu, or "
            "choose one input and one output."
        )
    return scored_replay(record, y, start)


def scored_replay(record: Record, y: FloatArray, start: RecordStart) -> SignalsReplay:
    """Simulated outputs with their errors.

    Parameters
    ----------
    record : Record
    y : ndarray, shape (N, ny)
    start : RecordStart
        Which samples determined the initial state.

    Raises
    ------
    ValueError
        If an output diverges.
    """
    measured = ~np.isnan(record.output_columns)
    for own, there, simulated in zip(record.output_columns.T, measured.T, y.T, strict=True):
        check_bounded(simulated, own[there])
    first = start.samples(len(record)) if len(record) > 2 * LEAST_START else 0
    error = np.where(measured, record.output_columns - y, 0.0)[first:]
    count = np.maximum(measured[first:].sum(axis=0), 1)
    return SignalsReplay(y, np.sqrt(np.sum(error**2, axis=0) / count), first)


def _exported(system: ExportedSystem, record: Record) -> tuple[FloatArray, RecordStart]:
    """Outputs of an exported simulation, and which samples their start is estimated from."""
    if abs(system.sampling_time - record.Ts) > 1e-6 * system.sampling_time:
        raise ValueError(
            f"the simulation runs at {system.sampling_time:g} s, the record at {record.Ts:g} s. Resample the record."
        )
    for names, own, what in (
        (system.inputs, record.inputs, "input"),
        (tuple(system.outputs), record.outputs, "output"),
    ):
        if len(names) != len(own):
            raise ValueError(
                f"the simulation has {len(names)} {what}s ({', '.join(names)}); the record has {len(own)} "
                f"({', '.join(own)}). Choose its columns with --{what}s."
            )
    only_output = next(iter(system.outputs.values()))
    return system.simulate(record.input_columns, record.output_columns), only_output.model.start


def _played(source: Path, record: Record) -> tuple[FloatArray, RecordStart]:
    """Outputs of a simulator, with responses of linear models of the rig for its initial state."""
    prepared = prepare(record).signals
    filled = replace(record, y=bridge_gaps(record.y))
    system = as_system(open_in_process(str(source)), filled, record.outputs)
    assert system is not None
    rates = []
    for j in range(len(prepared.outputs)):
        parts = linear_parts([prepared.data(i, j) for i in range(len(prepared.inputs))])
        rates.append(parts.rates[parts.strongest])
    slowest = min(rates, key=lambda one: one[1])
    start = RecordStart(slowest)
    used, simulated = start.used(len(record)), system.simulator(record.t, record.input_columns)
    of = dict(zip(prepared.outputs, rates, strict=True))
    y = [
        started(
            simulated[:, j], system.states(len(record), j, of.get(name, slowest)), filled.output_columns[:, j], used
        )
        for j, name in enumerate(record.outputs)
    ]
    return np.column_stack(y), start


def write_signals_replay(path: Path, record: Record, y: FloatArray) -> None:
    """Write t, all inputs, all outputs, and the simulated outputs with ``_sim`` after their names, as .csv."""
    lines = [",".join(["t", *record.signal_names, *(f"{name}_sim" for name in record.outputs)])]
    rows = np.column_stack([record.t, record.input_columns, record.output_columns, y])
    lines += [",".join(repr(float(x)) for x in row) for row in rows]
    write_file(path, ("\n".join(lines) + "\n").encode())
