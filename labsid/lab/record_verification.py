"""UNSW lab, Fig. 4: verification of an identified model on another record of the rig."""

from dataclasses import dataclass

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.lab.arx import ArxModel
from labsid.lab.offset import Offsets, find_offsets
from labsid.lab.simulation import simulate
from labsid.lab.verification import mse
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
    if not np.isclose(record.Ts, model.Ts, rtol=1e-6, atol=0):
        raise ValueError(
            f"record and model must have one sampling time; got {record.Ts:g} s and {model.Ts:g} s. "
            "Identify a model at the record's sampling time."
        )
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
