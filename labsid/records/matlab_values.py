"""Values of MATLAB as columns: the lab's `LogData`, structures with time, matrices and nested structures."""

from typing import Any

import numpy as np

from labsid._arrays import FloatArray
from labsid.records.column import Column, Log, listed, log_of, matrix_columns

OBJECT = "an object"  # what stands for one in the values
_MAX_COLUMNS = 10_000
_LOGS = ("LogData", "SFLogData")
_OTHERS = ("y_measured", "y_noise_reduced", "reference")


def log_of_variables(variables: dict[str, Any], output: str, by_layout: bool) -> Log:
    """The variables of a MAT-file as columns.

    Parameters
    ----------
    variables : dict
        As `labsid.records.mat5.read_variables` returns them.
    output : {"noise-reduced", "measured"}
        The output of ``LogData`` to use as `y`.
    by_layout : bool
        Whether ``LogData`` is read by its layout.

    Returns
    -------
    Log
        ``run.data.1`` is the first column of the matrix ``data`` in the structure ``run``; fields of a scope's
        "Structure With Time" are ``ScopeData.time`` and ``ScopeData.signals.1.values``.

    Raises
    ------
    ValueError
        If there are no arrays of numbers, or ``LogData`` is not in its layout.
    """
    name = next((name for name in _LOGS if name in variables), None)
    if name is not None and by_layout:
        logged = _read_lab_log(name, _unwrap(variables[name]), output)
        notes, u_unit, y_unit = (logged.pop(key) for key in ("notes", "u_unit", "y_unit"))
        units = {"t": "s" if u_unit or y_unit else "", "u": u_unit}
        columns = [Column(key, values, units.get(key, y_unit)) for key, values in logged.items() if values is not None]
        others = tuple(k for k, column in enumerate(columns) if column.name in _OTHERS)
        log = log_of(columns, "variable", notes)
        return Log(log.names, log.read, True, "variable", log.notes, others)
    columns = []
    for key, value in variables.items():
        _collect(key, _unwrap(value), columns)
    if not columns:
        holds = listed([f"{key} ({value})" if isinstance(value, str) else key for key, value in variables.items()])
        raise ValueError(
            f"there are no arrays of numbers in it; it holds {holds or 'nothing'}. Save t, u and y, or the scope's "
            "structure with time."
        )
    stem = columns[0].name.rpartition(".")[0]
    of_one_matrix = all(column.name == f"{stem}.{k + 1}" for k, column in enumerate(columns))
    return log_of(columns, "variable", (), not of_one_matrix)


def holds_objects(value: Any) -> bool:
    """Whether there is an object, such as a ``timeseries``, among these values."""
    if isinstance(value, dict):
        return any(map(holds_objects, value.values()))
    return (
        any(map(holds_objects, value)) if isinstance(value, list) else bool(isinstance(value, str) and value == OBJECT)
    )


def _collect(name: str, value: Any, columns: list[Column]) -> None:
    """Add the columns of a value; constants of one number are none."""
    if len(columns) > _MAX_COLUMNS:
        return
    if isinstance(value, dict):
        for key, inner in value.items():
            _collect(f"{name}.{key}", _unwrap(inner), columns)
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            _collect(f"{name}.{k + 1}", _unwrap(inner), columns)
    elif isinstance(value, np.ndarray) and value.size > 1:
        columns += matrix_columns(name, value)


def _read_lab_log(name: str, log: Any, output: str) -> dict[str, Any]:
    """Read the lab's layout.

    ``.time``; ``.signals(1).values`` with the columns [reference,] measured, noise-reduced;
    ``.signals(2).values``, the input. A signal may have a ``unit``, as the numbers of its characters
    (``double('rpm')``): the records of another rig than the tanks have it.
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
    y_unit, u_unit = (_unit(signal.get("unit")) for signal in signals[:2])
    logged: dict[str, Any] = {"t": t if t.size else None, "u": u[:, 0]}
    logged |= {"notes": notes, "u_unit": u_unit, "y_unit": y_unit}
    if outputs.shape[1] == 1:
        if output == "noise-reduced":
            raise ValueError(
                f"{name}.signals(1).values has one column, the measured output, and no noise-reduced one. "
                "Read it with output measured (--LogData measured)."
            )
        return logged | {"y": outputs[:, 0], "y_measured": outputs[:, 0]}
    measured, noise_reduced = outputs[:, -2], outputs[:, -1]
    if outputs.shape[1] == 3:
        logged["reference"] = outputs[:, 0]
    y = measured if output == "measured" else noise_reduced
    return logged | {"y": y, "y_measured": measured, "y_noise_reduced": noise_reduced}


def _unit(value: Any) -> str:
    """A unit, given as the numbers of its characters; empty if it is not."""
    if not isinstance(value, np.ndarray) or not np.all((value >= 32) & (value < 0x3000)):
        return ""
    return "".join(chr(int(number)) for number in value.ravel())


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
