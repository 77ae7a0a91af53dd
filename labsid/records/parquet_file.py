"""Parquet tables, with pyarrow; only the chosen columns are read."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log
from labsid.records.fields import column_of_texts
from labsid.records.units import split_units

MAX_ROWS = 50_000_000


def open_log(path: Path) -> Log:
    """Open a Parquet table.

    Raises
    ------
    ValueError
        If it has no columns of numbers.
    """
    import pyarrow.parquet as pq

    table = pq.ParquetFile(path)
    if table.metadata.num_rows > MAX_ROWS:
        raise ValueError(f"it has {table.metadata.num_rows} rows; at most {MAX_ROWS} are read. Cut it.")
    fields = [field for field in table.schema_arrow if _is_readable(field.type)]
    if not fields:
        raise ValueError("it has no columns of numbers.")

    names, units = split_units([field.name for field in fields])

    def read(places: Sequence[int]) -> list[Column]:
        return [_column(names[k], table.read(columns=[fields[k].name]).column(0), units[k]) for k in places]

    return Log(tuple(names), read)


def _is_readable(kind: object) -> bool:
    import pyarrow.types as types

    return any(
        test(kind)
        for test in (
            types.is_integer, types.is_floating, types.is_boolean, types.is_timestamp, types.is_decimal,
            types.is_duration, types.is_string, types.is_large_string, types.is_dictionary,
        )
    )  # fmt: skip


def _column(name: str, data: Any, unit: str) -> Column:
    import pyarrow as pa
    import pyarrow.types as types

    if types.is_duration(data.type):
        nanoseconds = arrow_values(data.cast(pa.duration("ns")).cast(pa.int64()))
        return Column(name, nanoseconds * 1e-9, "s")
    if types.is_dictionary(data.type) or types.is_string(data.type) or types.is_large_string(data.type):
        column = column_of_texts(name, ["" if text is None else str(text) for text in data.to_pylist()], unit)
        if column is None:
            raise ValueError(f"column {name} holds words.")
        return column
    return Column(name, arrow_values(data), unit)


def arrow_values(data: object) -> np.ndarray:
    """The values of a column of Arrow, NaN where they are null."""
    import pyarrow as pa
    import pyarrow.types as types

    if types.is_timestamp(data.type):  # type: ignore[attr-defined]
        return np.asarray(data.cast(pa.timestamp("ns")).to_numpy()).astype("datetime64[ns]")  # type: ignore[attr-defined]
    whole = types.is_integer(data.type) and not data.null_count  # type: ignore[attr-defined]
    kept = pa.float32() if types.is_float32(data.type) else pa.int64() if whole else pa.float64()  # type: ignore[attr-defined]
    return np.asarray(data.cast(kept).to_numpy(zero_copy_only=False))  # type: ignore[attr-defined]
