"""UNSW lab, Fig. 4: verification of an identified model on another record of the rig."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.lab.arx import ArxModel
from labsid.lab.arx_system import ArxSystem
from labsid.lab.offset import Offsets, find_offsets
from labsid.lab.simulation import simulate
from labsid.lab.system_verification import mse_by_output
from labsid.lab.verification import mse
from labsid.model_structures.state_space import estimate_state, simulate_states
from labsid.records.record import Record
from labsid.records.several_signals import one_signal_each


@dataclass(frozen=True, slots=True, eq=False)
class RecordVerification:
    """Comparison of a model with another record of the process (Fig. 4).

    Attributes
    ----------
    offsets : Offsets
        Of that record.
    start : int
        First sample compared: the first at which the record is settled.
    u, y : ndarray, shape (N - start,)
        Offset-free input and output of the record from sample `start`.
    y_sim : ndarray, shape (N - start,)
        Offset-free output of the model, from rest.
    error : ndarray, shape (N - start,)
        ``y - y_sim``.
    mse : float
        Mean squared error.
    level_shift : float
        Output offset of the record minus the static output of the model at the same input, in the unit of y; not
        finite for a model with a pole at 1 if the input offsets differ.
    """

    offsets: Offsets
    start: int
    u: FloatArray
    y: FloatArray
    y_sim: FloatArray
    error: FloatArray
    mse: float
    level_shift: float

    def __post_init__(self) -> None:
        freeze(self, u=self.u, y=self.y, y_sim=self.y_sim, error=self.error)


def verify_on_record(model: ArxModel, record: Record) -> RecordVerification:
    """Apply the input of another record to the model and compare the outputs.

    Parameters
    ----------
    model : ArxModel
        Identified from one record.
    record : Record
        Another record of the same process, with the same sampling time.

    Returns
    -------
    RecordVerification

    Raises
    ------
    ValueError
        If the sampling times differ or the record's input never changes.

    Notes
    -----
    UNSW lab, "Model Verification" and Fig. 4, on data that were not used for identification. The record's own
    offsets are removed, because on this rig the level at the same input differs between runs. The comparison thus
    verifies the dynamics and the gain; `level_shift` is the change of level. The comparison starts at a sample at
    which the process is at rest, like the model.
    """
    _check_sampling_time(record, model.Ts)
    one_signal_each(record, "the comparison with another record")
    offsets = find_offsets(record.u, record.y)
    start = offsets.settled[0]
    u, y = record.u[start:] - offsets.u_offset, record.y[start:] - offsets.y_offset
    y_sim = simulate(model, u)
    step = offsets.u_offset - model.u_offset
    expected = model.y_offset + (model.static_gain * step if step else 0.0)
    return RecordVerification(
        offsets=offsets,
        start=start,
        u=u,
        y=y,
        y_sim=y_sim,
        error=y - y_sim,
        mse=mse(y, y_sim),
        level_shift=offsets.y_offset - expected,
    )


@dataclass(frozen=True, slots=True, eq=False)
class SystemRecordVerification:
    """Comparison of a model of several signals with another record.

    Attributes
    ----------
    start : int
        First sample scored; the state is estimated from the samples before it.
    y_sim : ndarray, shape (N, ny)
        Simulated outputs, in the units of the record.
    error : ndarray, shape (N, ny)
        ``y - y_sim``; NaN where an output is missing.
    mse : ndarray, shape (ny,)
        Mean squared error of each output from sample `start` on.
    """

    start: int
    y_sim: FloatArray
    error: FloatArray
    mse: FloatArray

    def __post_init__(self) -> None:
        freeze(self, y_sim=self.y_sim, error=self.error, mse=self.mse)


def verify_system_on_record(model: ArxSystem, record: Record, start: int = 50) -> SystemRecordVerification:
    """Apply the inputs of another record to a system and compare the outputs.

    Parameters
    ----------
    model : ArxSystem
        Identified from one record.
    record : Record
        Another record of the same process, with the same signals and sampling time.
    start : int
        Samples from which the initial state is estimated, and which are not scored.

    Returns
    -------
    SystemRecordVerification

    Raises
    ------
    ValueError
        If signals or sampling times differ, the record is too short, or the output of an unstable model overflows.

    Notes
    -----
    Unlike `verify_on_record`, it keeps the operating point of the model, because a record of several signals need not
    show one.
    """
    _check_sampling_time(record, model.Ts)
    if (record.inputs, record.outputs) != (model.inputs, model.outputs):
        raise ValueError(
            f"record and model must have the same signals; got {', '.join(record.signal_names)} and "
            f"{', '.join((*model.inputs, *model.outputs))}. Read the record with the inputs and outputs of the model."
        )
    if len(record) < 2 * start:
        raise ValueError(f"the record must have at least {2 * start} samples, twice start; got {len(record)}.")
    there = ~np.isnan(record.output_columns)
    u = record.input_columns - model.u_offset
    y = np.where(there, record.output_columns, model.y_offset) - model.y_offset
    states = model.state_space
    x0 = estimate_state(states, u[:start], y[:start], there[:start])
    y_sim = simulate_states(states, u, x0)
    return SystemRecordVerification(
        start=start,
        y_sim=y_sim + model.y_offset,
        error=np.where(there, y - y_sim, np.nan),
        mse=mse_by_output(y[start:], y_sim[start:], there[start:]),
    )


def _check_sampling_time(record: Record, Ts: float) -> None:
    if not np.isclose(record.Ts, Ts, rtol=1e-6, atol=0):
        raise ValueError(
            f"record and model must have one sampling time; got {record.Ts:g} s and {Ts:g} s. "
            "Identify a model at the record's sampling time."
        )
