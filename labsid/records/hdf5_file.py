"""MATLAB files of version 7.3, and HDF5, with h5py."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log, is_numeric, matrix_columns
from labsid.records.mat_objects import open_log as open_objects
from labsid.records.matlab_values import OBJECT, holds_objects, log_of_variables

MAX_BYTES = 2**29  # of one data set
_MAX_ITEMS = 100_000
_MAX_DEPTH = 30


def open_log(path: Path) -> Log:
    """Open a MATLAB 7.3 file as one of version 7, or any other HDF5 file by the paths of its data sets.

    Raises
    ------
    ValueError
        If it holds no arrays of numbers.
    """
    import h5py

    file = h5py.File(path, "r")
    with path.open("rb") as raw:
        is_matlab = raw.read(10) == b"MATLAB 7.3" or any("MATLAB_class" in member.attrs for member in file.values())
    if is_matlab or path.suffix.lower() == ".mat":
        budget = [_MAX_ITEMS]
        variables = {name: _value(file, file[name], budget, 0) for name in file if not name.startswith("#")}
        if holds_objects(variables):
            return open_objects(path)
        return log_of_variables(variables, "noise-reduced", True)
    data_sets: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and len(data_sets) < _MAX_ITEMS:
            for field in item.dtype.names or (None,):
                kind = item.dtype[field] if field else item.dtype
                if kind.kind in "biuf" and item.size > 1 and item.ndim <= 2:
                    data_sets[f"{name}.{field}" if field else name] = (item, field)

    file.visititems(visit)
    names: list[tuple[str, Any, str | None, int | None]] = []
    for name, (item, field) in data_sets.items():
        narrow = item.ndim == 2 and 1 not in item.shape and min(item.shape) <= 64
        count = min(item.shape) if narrow else None
        names += [(f"{name}.{k + 1}", item, field, k) for k in range(count)] if count else [(name, item, field, None)]
    if not names:
        raise ValueError("it holds no arrays of numbers.")

    def read(places: Sequence[int]) -> list[Column]:
        return [_column(*names[k]) for k in places]

    return Log(tuple(name for name, *_ in names), read, what="data set")


def _column(name: str, item: Any, field: str | None, place: int | None) -> Column:
    values = np.asarray(_checked(item)[field] if field else _checked(item)[()])
    unit = item.attrs.get("units", item.attrs.get("unit", ""))
    unit = unit.decode(errors="replace") if isinstance(unit, bytes) else str(unit)
    columns = matrix_columns(name, values, unit)
    if not columns:
        raise ValueError(f"data set {name} must be one column; got shape {values.shape}.")
    one = columns[place or 0]
    return Column(name, one.values, unit[:16])


def _checked(item: Any) -> Any:
    if item.size * item.dtype.itemsize > MAX_BYTES:
        raise ValueError(f"data set {item.name} is over {MAX_BYTES // 2**20} MB. Cut the log to what is needed.")
    return item


def _value(file: Any, item: Any, budget: list[int], depth: int) -> Any:
    """A variable as `labsid.records.mat5` returns it: arrays, dicts for structures, lists for cells and arrays."""
    import h5py

    budget[0] -= 1
    if budget[0] < 0 or depth > _MAX_DEPTH:
        raise ValueError("it is nested too deeply, or holds too many parts.")
    if isinstance(item, h5py.Group):
        if "MATLAB_class" in item.attrs and b"struct" not in np.bytes_(item.attrs["MATLAB_class"]):
            return OBJECT
        fields = {name: _value(file, item[name], budget, depth + 1) for name in item}
        return _as_elements(fields)
    kind = np.bytes_(item.attrs.get("MATLAB_class", b"double"))
    if item.attrs.get("MATLAB_empty", 0):
        return np.empty((0, 0))
    if "MATLAB_object_decode" in item.attrs:
        return OBJECT
    if item.dtype.kind == "O" and h5py.check_ref_dtype(item.dtype) is h5py.Reference:
        references = _checked(item)[()].T.reshape(-1, order="F")
        return [_value(file, file[reference], budget, depth + 1) for reference in references if reference]
    if kind == b"char":
        return "text"
    array = np.asarray(_checked(item)[()])
    return array.T if is_numeric(array) else "complex numbers"


def _as_elements(fields: dict[str, Any]) -> Any:
    """A structure array keeps one list for each field; `mat5` returns one dict for each element."""
    sizes = {len(value) for value in fields.values() if isinstance(value, list)}
    if fields and len(sizes) == 1 and all(isinstance(value, list) for value in fields.values()):
        (size,) = sizes
        return [{name: value[k] for name, value in fields.items()} for k in range(size)]
    return fields
