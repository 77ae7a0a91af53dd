"""Curves of the figures of a diagnosis: measured and simulated outputs, their errors, noise and scored samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from labsid._arrays import FloatArray, lies_within, window_sums
from labsid.plots.style import BLACK, BLUE, GREEN, GREY, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ZOOM = 0.1  # of the record, shown in the zoom
MARGIN = 0.07  # of the range of y, above and below the curves
MIN_ZOOM_SAMPLES = 40  # samples in the zoom
BREAK = 10.0  # median distances of the samples drawn, from which there is no line: between several records


def simulation_curves(report: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """Trace, label, colour and line style of each simulation to draw."""
    outputs = report["outputs"].values() if "signals" in report else [report]
    same = all(one["traces"]["before"] == one["traces"]["after"] for one in outputs)
    if report["verdict"] == "none" or same:
        return [("before", "Simulated", VERMILION, "-")]
    return [("before", "Before", VERMILION, "--"), ("after", "After", BLUE, "-")]


def trace_of(report: dict[str, Any], holdout: bool = False) -> dict[str, FloatArray]:
    """Signals of the record or of the holdout, with ``counts``: 1 at the samples that are fitted or scored, else 0."""
    trace = {name: np.asarray(x, float) for name, x in report["holdout_traces" if holdout else "traces"].items()}
    replay = report.get("replay")
    part = None if replay is None else replay["holdout" if holdout else "record"]
    stretches = [] if part is None else [*part["fitted"], *part["scored"]]
    at = np.arange(trace["t"].size) if part is None else np.round((trace["t"] - part["start"]) / part["Ts"])
    return trace | {"counts": lies_within(stretches, at).astype(float)}


def largest_error(trace: dict[str, FloatArray]) -> slice:
    """The tenth of the record in which the simulation before has the largest error, where that counts."""
    power = np.nan_to_num(trace["y"] - trace["before"]) ** 2 * trace.get("counts", 1.0)
    length = min(max(int(ZOOM * power.size), MIN_ZOOM_SAMPLES), power.size)
    first = int(np.argmax(window_sums(power, length)))
    return slice(first, first + length)


def draw_outputs(
    ax: Axes, trace: dict[str, FloatArray], curves: list[tuple[str, str, str, str]], part: slice | np.ndarray
) -> None:
    """Draw the measured output and the simulations, for a part of the record."""
    t = trace["t"][part]
    ax.plot(*without_jumps(t, trace["y"][part]), color=BLACK, linewidth=2.8, alpha=0.6, label="Measured")
    for name, text, colour, style in curves:
        ax.plot(*without_jumps(t, trace[name][part]), color=colour, linestyle=style, linewidth=1.3, label=text)
    ax.margins(x=0)
    _show_counted(ax, trace, [trace[name] for name in ("y", *(curve[0] for curve in curves))], part)


def _show_counted(
    ax: Axes, trace: dict[str, FloatArray], signals: list[FloatArray], part: slice | np.ndarray = slice(None)
) -> None:
    """Limit the axis of y to the samples that count."""
    shown = np.array([signal[part][trace["counts"][part] > 0.0] for signal in signals]) if "counts" in trace else None
    if shown is None or not np.isfinite(shown).any():
        return
    low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
    margin = MARGIN * (high - low)
    if margin > 0.0:
        ax.set_ylim(low - margin, high + margin)


def without_jumps(t: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A line without a connection across times at which there are no samples."""
    steps = np.diff(t)
    after = np.flatnonzero(steps > BREAK * np.median(steps)) + 1
    return np.insert(t, after, t[after]), np.insert(x, after, np.nan)


def draw_errors(
    ax: Axes, report: dict[str, Any], trace: dict[str, FloatArray], curves: list[tuple[str, str, str, str]]
) -> None:
    """Draw the errors of the simulations and the noise band."""
    for name, text, colour, _ in curves:
        ax.plot(*without_jumps(trace["t"], trace["y"] - trace[name]), color=colour, linewidth=1.0, label=text)
    noise, name_of_noise = noise_band(report)
    ends = [np.full(trace["t"].size, side) for side in (-noise, noise)]
    _show_counted(ax, trace, [*(trace["y"] - trace[name] for name, *_ in curves), *ends])
    for side, text in ((-noise, f"{name_of_noise}, ±2 s.d."), (noise, "")):
        ax.axhline(side, color=GREEN, linestyle=":", linewidth=1.6, label=text)
    ax.margins(x=0)


def noise_band(report: dict[str, Any]) -> tuple[float, str]:
    """Two standard deviations of the noise, and its name.

    Where something is unexplained, it is the white noise of the residual: what no model predicts is no noise.
    """
    gap, left = report["gap"], report["unexplained"]
    if report["verdict"] in ("none", "effect"):
        return 2.0 * gap["noise_floor"], "Noise"
    return 2.0 * min(gap["noise_floor"], left["rms"] / max(left.get("colour", 1.0), 1.0)), "White noise"


def shade_scored(ax: Axes, stretches: list[list[float]]) -> None:
    """Shade the samples on which the gap is scored."""
    for number, (start, stop) in enumerate(stretches):
        text = "" if number else "Scored"
        ax.axvspan(start, stop, color=GREY, alpha=0.18, linewidth=0, zorder=0, label=text)
