"""Records to read, made here: a small tank-like plant, and files in the lab's layout."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.signal import lfilter


@pytest.fixture
def staircase() -> dict[str, np.ndarray]:
    """Columns t, u, y, measured of a plant at rest at (2.0, 2.3) and then driven, 0.75 s, 600 samples."""
    rng = np.random.default_rng(5)
    u = np.repeat([2.0, 1.6, 2.2, 2.0, 1.6, 2.2], 100)
    y = 2.3 + lfilter([0.0, 0.15], [1.0, -0.95], u - 2.0)
    measured = np.round((y + 0.01 * rng.standard_normal(u.size)) / 0.0048828125) * 0.0048828125
    reduced = lfilter(np.ones(5) / 5, 1, measured - 2.3) + 2.3
    return {"t": np.arange(u.size) * 0.75, "u": u, "y": reduced, "measured": measured}


@pytest.fixture
def write_log(tmp_path: Path) -> Callable[..., Path]:
    """Write arrays as `LogData` (or under another name) as the lab's rig does; any shapes go in as they are."""

    def write(time: Any, outputs: Any, u: Any, name: str = "LogData", file: str = "record.mat", **options: Any) -> Path:
        signals = np.empty((1, 2), dtype=[("values", object), ("label", object)])
        signals[0, 0] = (outputs, "")
        signals[0, 1] = (u, "Actual Input")
        path = tmp_path / file
        savemat(path, {name: {"time": time, "signals": signals, "blockName": "Scope"}}, **options)
        return path

    return write


@pytest.fixture
def write_text(tmp_path: Path) -> Callable[..., Path]:
    """Write a text file of any name."""

    def write(text: str, file: str = "record.csv", encoding: str = "utf-8") -> Path:
        path = tmp_path / file
        path.write_bytes(text.encode(encoding))
        return path

    return write
