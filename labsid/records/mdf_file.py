"""Measurement data format (``.mf4``, ``.mdf``), with asammdf."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from labsid.records.column import Column, Log, is_numeric, matrix_columns


def open_log(path: Path) -> Log:
    """Open a measurement; each channel has the stamps of its group.

    Raises
    ------
    ValueError
        If it has no channels.
    """
    from asammdf import MDF

    measurement: Any = MDF(path)
    masters = measurement.masters_db
    channels = [
        (channel.name, group, index)
        for group, channel_group in enumerate(measurement.groups)
        for index, channel in enumerate(channel_group.channels)
        if masters.get(group) != index
    ]
    if not channels:
        raise ValueError("it has no channels.")
    often = Counter(name for name, *_ in channels)
    names = tuple(name if often[name] == 1 else f"{name}@{group}" for name, group, _ in channels)

    def read(places: Sequence[int]) -> list[Column]:
        columns = []
        for k in places:
            _, group, index = channels[k]
            signal = measurement.get(group=group, index=index)
            if not is_numeric(signal.samples) or signal.samples.ndim != 1:
                raise ValueError(f"channel {names[k]} holds no single numbers.")
            (column,) = matrix_columns(names[k], signal.samples, signal.unit or "")
            columns.append(Column(column.name, column.values, column.unit, np.asarray(signal.timestamps, np.float64)))
        return columns

    return Log(names, read, what="channel")
