"""Data sets of LeRobot (versions 2 and 3), with pyarrow: a folder with ``meta/info.json`` and Parquet tables."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log
from labsid.records.parquet_file import arrow_values

_MAX_FILES = 10_000


def open_log(path: Path) -> Log:
    """Open a data set; the columns are the numbers of its features, as ``action[elbow]``, with its time stamps.

    Raises
    ------
    ValueError
        If it has no tables, or no features of numbers.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    info = json.loads((path / "meta" / "info.json").read_text(encoding="utf-8"))
    features = info.get("features") if isinstance(info, dict) else None
    if not isinstance(features, dict):
        raise ValueError("meta/info.json lists no features.")
    files = sorted(path.glob("data/**/*.parquet"))[:_MAX_FILES]
    if not files:
        raise ValueError("it has no tables: there is no .parquet file in data/.")
    schema = pq.read_schema(files[0])
    columns: list[tuple[str, str, int | None]] = []
    for field in schema:
        size = _size(features.get(field.name))
        if pa.types.is_list(field.type) or pa.types.is_fixed_size_list(field.type):
            labels = _labels(features.get(field.name), size)
            columns += [(f"{field.name}[{label}]", field.name, k) for k, label in enumerate(labels)]
        elif pa.types.is_floating(field.type) or pa.types.is_integer(field.type):
            columns.append((field.name, field.name, None))
    if not columns:
        raise ValueError("it has no features of numbers.")

    def read(places: Sequence[int]) -> list[Column]:
        wanted = sorted({columns[k][1] for k in places} | ({"timestamp"} & set(schema.names)))
        table = pa.concat_tables([pq.read_table(file, columns=wanted) for file in files])
        stamps = arrow_values(table.column("timestamp")) if "timestamp" in wanted else None
        return [_column(columns[k], table, stamps) for k in places]

    return Log(tuple(name for name, *_ in columns), read, what="feature")


def _column(column: tuple[str, str, int | None], table: Any, stamps: np.ndarray | None) -> Column:
    import pyarrow.compute as pc

    name, source, place = column
    data = table.column(source)
    values = arrow_values(data if place is None else pc.list_element(data, place))
    return Column(name, values, "s" if name == "timestamp" else "", stamps)


def _size(feature: Any) -> int:
    shape = feature.get("shape") if isinstance(feature, dict) else None
    known = isinstance(shape, list) and len(shape) == 1 and isinstance(shape[0], int) and 0 < shape[0] <= 1000
    return int(shape[0]) if known else 1  # type: ignore[index]


def _labels(feature: Any, size: int) -> list[str]:
    """Names of the elements of a feature, which the versions keep as a list or in a dict of lists."""
    names = feature.get("names") if isinstance(feature, dict) else None
    if isinstance(names, dict) and len(names) == 1:
        names = next(iter(names.values()))
    if isinstance(names, list) and len(names) == size and all(isinstance(name, str) for name in names):
        return list(names)
    return [str(k) for k in range(size)]
