"""The rig's log and its `.mat` file in the lab's layout."""

from dataclasses import dataclass
from io import BytesIO
from os import PathLike
from pathlib import Path

import numpy as np

from labsid._arrays import FloatArray, as_signals, freeze
from labsid.records.record import Record

# MATLAB and scipy write the current time here; a fixed text makes equal logs equal bytes.
_HEADER = b"MATLAB 5.0 MAT-file, written by labsid.rig: a simulated record in the layout of the lab's rig"
_HEADER_LENGTH = 116


@dataclass(frozen=True, slots=True, eq=False)
class LabLog:
    """Log of the lab's rig: time, input and both outputs.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Time in seconds, from 0.
    u : ndarray, shape (N,)
        Actual input: pump voltage (V).
    y_measured : ndarray, shape (N,)
        Measured output: level-sensor voltage, quantised by the converter (V).
    y_noise_reduced : ndarray, shape (N,)
        Noise-reduced output: causal moving average over five samples of `y_measured` (V).
    Ts : float
        Sampling time in seconds.
    name : str
        Name of the record: the file name without its extension.
    units : tuple of str
        Units of input and output where these are not the volts of the tanks; else empty.

    Raises
    ------
    ValueError
        If the signals are not finite and of equal length.
    """

    t: FloatArray
    u: FloatArray
    y_measured: FloatArray
    y_noise_reduced: FloatArray
    Ts: float
    name: str
    units: tuple[str, str] = ("", "")

    def __post_init__(self) -> None:
        t, u, measured, reduced = as_signals(
            t=self.t, u=self.u, y_measured=self.y_measured, y_noise_reduced=self.y_noise_reduced
        )
        freeze(self, t=t, u=u, y_measured=measured, y_noise_reduced=reduced)


def log_to_record(log: LabLog) -> Record:
    """Convert a log to the record that `load_record` reads from its file.

    Parameters
    ----------
    log : LabLog

    Returns
    -------
    Record
        The output `y` is the noise-reduced one.
    """
    return Record(
        t=log.t,
        u=log.u,
        y=log.y_noise_reduced,
        Ts=log.Ts,
        y_measured=log.y_measured,
        y_noise_reduced=log.y_noise_reduced,
        name=log.name,
        units=log.units,
    )


def lab_record_bytes(log: LabLog) -> bytes:
    """Encode a log as a version 5 `.mat` file.

    Parameters
    ----------
    log : LabLog

    Returns
    -------
    bytes
        Equal logs give equal bytes: the file holds no time of writing and is not compressed.

    Notes
    -----
    UNSW lab, step 1a. ``LogData.time`` is (N, 1); ``LogData.signals(1).values`` is (N, 2), measured and
    noise-reduced output; ``LogData.signals(2).values`` is (N, 1), the input. The other fields are those
    of a Simulink scope, and in records with `LabLog.units` ``unit``,
    the numbers of its characters.
    """
    from scipy.io import savemat

    own = any(log.units)
    fields = ("values", "dimensions", "label", "title", "plotStyle", *(["unit"] if own else []))
    signals = np.empty((1, 2), dtype=[(field, object) for field in fields])
    outputs = np.column_stack([log.y_measured, log.y_noise_reduced])
    untitled = np.empty((1, 0))
    u_unit, y_unit = ([np.array([*map(ord, unit)], np.float64)] if own else [] for unit in log.units)
    signals[0, 0] = (outputs, 2.0, "", untitled, np.array([[1.0, 1.0]]), *y_unit)
    signals[0, 1] = (log.u[:, np.newaxis], 1.0, "Actual Input", untitled, 0.0, *u_unit)
    content = {
        "LogData": {
            "time": log.t[:, np.newaxis],
            "signals": signals,
            "blockName": log.name if own else "labsid_rig_simulated/Scope\nTANK#1",
        }
    }
    buffer = BytesIO()
    savemat(buffer, content, format="5", do_compression=False)
    return _HEADER.ljust(_HEADER_LENGTH) + buffer.getvalue()[_HEADER_LENGTH:]


def write_lab_record(path: str | PathLike[str], log: LabLog) -> None:
    """Write a log as a `.mat` file in the lab's layout, replacing an existing file.

    Parameters
    ----------
    path : path
        Must end in ``.mat``, because the extension determines a record's format.
    log : LabLog

    Raises
    ------
    ValueError
        If `path` does not end in ``.mat``.
    OSError
        If the file cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() != ".mat":
        raise ValueError(f"path must end in .mat; got {path.name!r}. Call it {path.stem}.mat.")
    path.write_bytes(lab_record_bytes(log))
