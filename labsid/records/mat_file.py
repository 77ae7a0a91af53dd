"""MATLAB files: the lab's `LogData` structure, or variables by name."""

from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.mat5 import read_variables
from labsid.records.text_file import as_found, split_columns

_HDF5 = b"\x89HDF\r\n\x1a\n"


def is_mat_file(content: bytes) -> bool:
    """Whether the content begins with a MAT-file header."""
    return content.startswith((b"MATLAB ", _HDF5))


def read_mat(content: bytes, output: str, columns: str | None) -> dict[str, Any]:
    """Read the signals of a ``.mat`` file of version 5 or 7.

    Parameters
    ----------
    content : bytes
        The content of the file.
    output : {"noise-reduced", "measured"}
        The output to use as `y`.
    columns : str or None
        Names of two or three variables to use instead of ``LogData``.

    Returns
    -------
    dict
        `t` (or None), `u`, `y`, `notes` and, from ``LogData``, the outputs and the reference, for
        `labsid.records.formats.RawRecord`.

    Raises
    ------
    ValueError
        If the file is damaged, of version 7.3, or lacks the requested signals.
    """
    if content.startswith((b"MATLAB 7.3", _HDF5)):
        raise ValueError(
            "it is a MATLAB 7.3 (HDF5) file, which is not read here. In MATLAB, load it and save it again: "
            "save('file.mat', 'LogData', '-v7')."
        )
    try:
        variables = read_variables(content)
    except ValueError as error:
        raise ValueError(
            f"it is no MAT-file of version 5 or 7, or it is cut off or damaged ({error}). Copy or download it "
            "again, or save it again with save('file.mat', 'LogData', '-v7')."
        ) from None
    variables.pop("", None)  # MATLAB's internal data
    if columns is not None:
        return _pick_variables(variables, columns)
    log_name = next((name for name in ("LogData", "SFLogData") if name in variables), None)
    if log_name is None:
        holds = ", ".join(sorted(variables)) or "nothing"
        raise ValueError(
            f"there is no LogData (nor SFLogData) in it; it holds {holds}. Save the scope's structure under "
            "that name, or name the variables of t,u,y with columns (--columns)."
        )
    return _read_log(log_name, _unwrap(variables[log_name]), output)


def _read_log(name: str, log: Any, output: str) -> dict[str, Any]:
    """Read the lab's layout.

    ``.time``; ``.signals(1).values`` with the columns [reference,] measured, noise-reduced;
    ``.signals(2).values``, the input.
    """
    for field in ("time", "signals"):
        if not isinstance(log, dict) or field not in log:
            raise ValueError(
                f"{name} is not a structure with time and signals (there is no {name}.{field}). "
                "Log the scope as 'Structure With Time'."
            )
    notes = []
    t = _numbers(f"{name}.time", log["time"]).reshape(-1)
    signals = log["signals"] if isinstance(log["signals"], list) else []
    signals = [_unwrap(signal) for signal in signals]
    if len(signals) < 2 or not all(isinstance(signal, dict) and "values" in signal for signal in signals[:2]):
        raise ValueError(
            f"{name}.signals must have two elements with values, the outputs and the input; "
            f"got {len(signals)}. Log both in one scope."
        )
    outputs = _as_columns(f"{name}.signals(1).values", signals[0]["values"], t.size)
    u = _as_columns(f"{name}.signals(2).values", signals[1]["values"], t.size)
    if outputs.shape[1] == 1 and u.shape[1] > 1:
        raise ValueError(
            f"input and output are swapped: {name}.signals(1).values has one column and {name}.signals(2)."
            f"values {u.shape[1]}. The outputs belong in signals(1), the input in signals(2)."
        )
    if u.shape[1] != 1 or outputs.shape[1] not in (1, 2, 3):
        raise ValueError(
            f"{name}.signals(1).values must have 2 columns (3 with a reference) and {name}.signals(2).values "
            f"1; got {outputs.shape[1]} and {u.shape[1]}."
        )
    if len(signals) > 2:
        notes.append(f"{name}.signals has {len(signals)} elements; those after the second are not used")
    if t.size == 0:
        notes.append(f"{name}.time is empty")
    found: dict[str, Any] = {"t": t if t.size else None, "u": u[:, 0], "notes": notes}
    if outputs.shape[1] == 1:
        if output == "noise-reduced":
            raise ValueError(
                f"{name}.signals(1).values has one column, the measured output, and no noise-reduced one. "
                "Read it with output measured (--output measured)."
            )
        return found | {"y": outputs[:, 0], "y_measured": outputs[:, 0]}
    measured, noise_reduced = outputs[:, -2], outputs[:, -1]
    if outputs.shape[1] == 3:
        found["reference"] = outputs[:, 0]
    y = measured if output == "measured" else noise_reduced
    return found | {"y": y, "y_measured": measured, "y_noise_reduced": noise_reduced}


def _pick_variables(variables: dict[str, Any], columns: str) -> dict[str, Any]:
    names = split_columns(columns)
    missing = [name for name in names if name not in variables]
    if missing:
        holds = ", ".join(sorted(variables)) or "nothing"
        raise ValueError(f"there is no variable {missing[0]!r} in it; it holds {holds}.")
    arrays = []
    for name in names:
        array = np.squeeze(_numbers(name, variables[name]))
        if array.ndim > 1:
            raise ValueError(f"variable {name} must be one column; got shape {array.shape}.")
        arrays.append(np.atleast_1d(array))
    return as_found(arrays)


def _unwrap(value: Any) -> Any:
    """The element of a 1x1 structure or cell array."""
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    return value


def _numbers(name: str, value: Any) -> FloatArray:
    value = _unwrap(value)
    if not isinstance(value, np.ndarray):
        got = value if isinstance(value, str) else "a structure" if isinstance(value, dict) else "cells"
        raise ValueError(f"{name} must hold real numbers; got {got}.")
    return value


def _as_columns(name: str, value: Any, samples: int) -> FloatArray:
    """Signals as columns; scopes also log them as rows, or with a singleton dimension."""
    array = _numbers(name, value)
    if array.ndim > 2:
        array = array.reshape([size for size in array.shape if size > 1] or [1])
    if array.ndim < 2:
        array = array.reshape(-1, 1)
    if array.ndim > 2:
        raise ValueError(f"{name} must be a matrix with one signal per column; got shape {array.shape}.")
    rows, cols = array.shape
    return array.T if rows != samples and cols == samples else array
