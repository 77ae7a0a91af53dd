"""The errors of a report over its record as points of a small drawing, made from the JSON report alone."""

from typing import Any

import numpy as np

from labsid._arrays import FloatArray

PARTS = 40  # of the record, of each of which the rms error is a point
WIDTH, HEIGHT = 120.0, 28.0  # pixels
BELOW = 1.0  # pixels under zero, and above the largest error


def error_lines(report: dict[str, Any]) -> dict[str, str] | None:
    """Rms errors of the simulations before and after in each part of the record.

    Parameters
    ----------
    report : dict
        Of several signals, the errors are those of the output with the largest gap.

    Returns
    -------
    dict of str or None
        ``before`` and ``after``, points of an SVG polyline in pixels, and ``noise``, its height; on one scale from zero
        to the largest error. None without an error.
    """
    own = report if "signals" not in report else report["outputs"][report["where"]["output"]]
    trace = {name: np.array(own["traces"][name], float) for name in ("t", "y", "before", "after")}
    parts = [part for part in np.array_split(np.arange(trace["t"].size), PARTS) if part.size]
    errors = {
        name: np.array([_rms((trace["y"] - trace[name])[part]) for part in parts]) for name in ("before", "after")
    }
    highest = max(float(np.nanmax(one, initial=0.0)) for one in errors.values())
    if highest <= 0.0 or not np.isfinite(highest):
        return None
    times = np.array([trace["t"][part].mean() for part in parts])
    x = WIDTH * (times - times[0]) / (float(np.ptp(times)) or 1.0)
    noise = min(float(own["gap"]["noise_floor"]), highest)
    return {name: _points(x, _heights(one / highest)) for name, one in errors.items()} | {
        "noise": f"{float(_heights(np.array(noise / highest))):.1f}"
    }


def _heights(shares: FloatArray) -> FloatArray:
    """From the top, in pixels, for shares of the largest error."""
    return np.asarray(HEIGHT - BELOW - (HEIGHT - 2.0 * BELOW) * shares)


def _rms(e: FloatArray) -> float:
    """NaN where nothing is measured."""
    e = e[np.isfinite(e)]
    return float(np.sqrt(np.mean(e**2))) if e.size else np.nan


def _points(x: FloatArray, y: FloatArray) -> str:
    return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True) if np.isfinite(b))
