"""Objects in MATLAB files, with mat-io: ``timeseries``, ``timetable``, ``table`` and ``Simulink.SimulationData``."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log, is_numeric, listed, log_of, matrix_columns

_MAX_DEPTH = 20
_MAX_COLUMNS = 10_000


def open_log(path: Path) -> Log:
    """Read the signals in the objects, structures and arrays of a MATLAB file.

    Returns
    -------
    Log
        A ``timeseries`` is one column with its own times, named by its variable and its name: ``logsout.speed``.

    Raises
    ------
    ValueError
        If there are no signals in it.
    """
    from matio import load_from_mat

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of classes that it does not convert
        variables = load_from_mat(path)
    columns: list[Column] = []
    for name, value in variables.items():
        if not name.startswith("__"):
            _collect(name, value, columns, 0)
    if not columns:
        raise ValueError(f"there are no signals in it; it holds {listed(list(variables)) or 'nothing'}.")
    return log_of(_with_distinct_names(columns), "variable")


def _collect(name: str, value: Any, columns: list[Column], depth: int) -> None:
    if depth > _MAX_DEPTH or len(columns) > _MAX_COLUMNS:
        return
    properties = getattr(value, "properties", None)
    if isinstance(properties, dict):
        series = _time_series(name, properties)
        if series:
            columns += series
            return
        own = _text(properties.get("Name"))
        for key, inner in properties.items():
            _collect((own and f"{name.partition('.')[0]}.{own}") or f"{name}.{key}", inner, columns, depth + 1)
    elif hasattr(value, "columns") and hasattr(value, "index"):  # a table of pandas
        _collect_table(name, value, columns)
    elif isinstance(value, dict):
        for key, inner in value.items():
            _collect(f"{name}.{key}", inner, columns, depth + 1)
    elif isinstance(value, np.ndarray) and value.dtype.names:
        for k, element in enumerate(value.reshape(-1)[:1000]):
            prefix = name if value.size == 1 else f"{name}.{k + 1}"
            for key in value.dtype.names:
                _collect(f"{prefix}.{key}", element[key], columns, depth + 1)
    elif isinstance(value, np.ndarray) and value.dtype == object:
        for k, element in enumerate(value.reshape(-1)[:1000]):
            _collect(name if value.size == 1 else f"{name}.{k + 1}", element, columns, depth + 1)
    elif isinstance(value, np.ndarray) and value.size > 1 and is_numeric(value):
        columns += matrix_columns(name, value)


def _time_series(name: str, properties: dict[str, Any]) -> list[Column]:
    """The columns of a ``timeseries``; its properties end in an underscore in newer versions."""
    known = {key.rstrip("_").lower(): value for key, value in properties.items()}
    data = known.get("data")
    if not isinstance(data, np.ndarray) or data.size < 2 or not is_numeric(data):
        return []
    stamps, unit = _times(known), ""
    if stamps is None:
        return []
    info = getattr(known.get("datainfo"), "properties", None)
    if isinstance(info, dict):
        unit = _text(info.get("Units", info.get("Units_")))
    own = _text(known.get("name"))
    stem = name if not own or name == own else f"{name.partition('.')[0]}.{own}"
    columns = matrix_columns(stem, data)
    return [Column(column.name, column.values, unit, stamps) for column in columns if column.values.size == stamps.size]


def _times(known: dict[str, Any]) -> np.ndarray | None:
    """The times of a ``timeseries``: stored, or given by a start and an increment."""
    time = known.get("time")
    if isinstance(time, np.ndarray) and time.size > 1 and is_numeric(time):
        return np.asarray(time, np.float64).reshape(-1)
    info = getattr(known.get("timeinfo"), "properties", None)
    if not isinstance(info, dict):
        return None
    numbers = {}
    for key, value in info.items():
        if isinstance(value, np.ndarray) and value.size == 1 and is_numeric(value):
            numbers[key.rstrip("_").lower()] = float(value.reshape(-1)[0])
    length, step = numbers.get("length", 0.0), numbers.get("increment", 0.0)
    if not (2.0 <= length <= 1e8 and step > 0.0):
        return None
    return numbers.get("start", 0.0) + step * np.arange(int(length), dtype=np.float64)


def _collect_table(name: str, table: Any, columns: list[Column]) -> None:
    index = table.index.to_numpy()
    stamps = None
    if index.dtype.kind == "m":
        stamps = index.astype("timedelta64[ns]").astype(np.int64) * 1e-9
    elif index.dtype.kind == "M":
        stamps = index.astype("datetime64[ns]").astype(np.int64)
    for key in table.columns:
        values = table[key].to_numpy()
        if is_numeric(values):
            (one,) = matrix_columns(f"{name}.{key}", values)
            columns.append(Column(one.name, one.values, "", stamps))


def _with_distinct_names(columns: list[Column]) -> list[Column]:
    seen: dict[str, int] = {}
    distinct = []
    for one in columns:
        seen[one.name] = seen.get(one.name, 0) + 1
        name = one.name if seen[one.name] == 1 else f"{one.name}@{seen[one.name]}"
        distinct.append(Column(name, one.values, one.unit, one.stamps))
    return distinct


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0]
    return value.strip() if isinstance(value, str) else ""
