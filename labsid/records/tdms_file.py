"""TDMS files of LabVIEW, with nptdms."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log, is_numeric, matrix_columns

_UNITS = ("unit_string", "NI_UnitDescription", "unit")


def open_log(path: Path) -> Log:
    """Open a TDMS file; a channel with waveform properties has their times.

    Raises
    ------
    ValueError
        If it has no channels with numbers.
    """
    from nptdms import TdmsFile

    file = TdmsFile.open(path)
    if getattr(file.file_status, "incomplete_final_segment", False):
        raise ValueError("it is cut off: its last segment is not complete. Copy it again from where it was recorded.")
    channels = [
        channel
        for group in file.groups()
        for channel in group.channels()
        if len(channel) and channel.dtype.kind in "biufM"
    ]
    if not channels:
        raise ValueError("it has no channels with numbers.")
    names = [channel.name for channel in channels]
    names = [
        channel.name if names.count(channel.name) == 1 else f"{channel.group_name}/{channel.name}"
        for channel in channels
    ]

    dated = all(_start(channel) for channel in channels if channel.properties.get("wf_increment"))

    def read(places: Sequence[int]) -> list[Column]:
        return [_column(names[k], channels[k], dated) for k in places]

    return Log(tuple(names), read, what="channel")


def _start(channel: Any) -> int:
    """The time of the first sample in nanoseconds since 1970; 0 if it is not known."""
    start = channel.properties.get("wf_start_time")
    since = int(start.astype("datetime64[ns]").astype(np.int64)) if isinstance(start, np.datetime64) else 0
    return max(since, 0)


def _column(name: str, channel: Any, dated: bool) -> Column:
    values = np.asarray(channel[:])
    if not is_numeric(values):
        raise ValueError(f"channel {name} holds no numbers.")
    properties = channel.properties
    unit = next((str(properties[key]) for key in _UNITS if properties.get(key)), "")
    step = properties.get("wf_increment")
    stamps: np.ndarray | None = None
    if isinstance(step, float) and step > 0.0:
        stamps = float(properties.get("wf_start_offset", 0.0)) + step * np.arange(values.size)
        if dated:  # channels may begin at different times
            stamps = _start(channel) + np.round(stamps * 1e9).astype(np.int64)
    (column,) = matrix_columns(name, values, unit)
    return Column(column.name, column.values, column.unit, stamps)
