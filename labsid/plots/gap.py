"""Figures of the gap report, made from the JSON report alone (layout ``labsid.gap/2``)."""

from __future__ import annotations

from io import BytesIO
from textwrap import fill
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from labsid._arrays import FloatArray
from labsid.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    SMALL_TEXT_SIZE,
    TIME,
    VERMILION,
    finish,
    make_headroom,
    new_figure,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDE, NARROW = 9.5, 4.4  # inches: for a desktop and for a telephone
DPI = 144  # one and a half times the width of the page
COLOURS = 256  # of a picture
ZOOM = 0.1  # of the record, shown in the zoom
MIN_ZOOM_SAMPLES = 40  # samples in the zoom
WHOLES = {"u": "range of u", "y": "range of y", "time": "time constant", "gain": "gain"}
LIMIT_MARKS = (
    ("detect", "Visible from here on", BLUE, "o"),
    ("named", "Told from all others", VERMILION, "s"),
    ("excluded_above", "Excluded from here on (95 %)", BLACK, "|"),
)
LIMIT_TEXT_SIZE, NARROW_TEXT_SIZE = 9.5, 8.0
BREAK = 10.0  # median distances of the samples drawn, from which there is no line: between several records


def figure_simulations(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the measured and simulated outputs, a zoom, and the errors before and after.

    Parameters
    ----------
    report : dict
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
        (a) The whole record; (b) a zoom on the largest error, if there is a gap; (c) the errors, with the scored
        samples shaded; (d) the errors on the holdout record, if there is one.
    """
    trace = {name: np.asarray(values, float) for name, values in report["traces"].items()}
    curves = _curves(report)
    zoom = report["verdict"] != "none"
    other = report["holdout_traces"]
    rows = 2 + zoom + (other is not None)
    figure = _new_figure(narrow, 3.1 * rows, 2.75 * rows)
    panels = list(figure.subplots(rows, 1))
    output, error = _signals(report)["y"], f"Simulation error ({unit_of(report)})"
    _overlay(panels[0], trace, curves, slice(None))
    finish(panels[0], "The whole record", TIME, output, legend_columns=2 if narrow else len(curves) + 1)
    make_headroom(panels[0], 0.27 if narrow else 0.18)
    if zoom:
        part = largest_error(trace)
        panels[0].axvspan(trace["t"][part][0], trace["t"][part][-1], color=GREY, alpha=0.35, linewidth=0, zorder=0)
        _overlay(panels[1], trace, curves, part)
        finish(panels[1], "Zoom on the shaded part", TIME, output, legend_columns=0)
    own = panels[1 + zoom]
    _errors(own, report, trace, curves)
    if other is not None:
        finish(own, "Simulation error", TIME, error, legend_columns=0)
        _errors(panels[-1], report, {name: np.asarray(values, float) for name, values in other.items()}, curves)
    _shade_scored(panels[-1], report["gap"]["holdout"])
    title = "Simulation error" if other is None else "Simulation error on the holdout record"
    finish(panels[-1], title, TIME, error, legend_columns=2 if narrow else 4)
    make_headroom(panels[-1], 0.27 if narrow else 0.18)
    return figure


def unit_of(report: dict[str, Any], signal: str = "y") -> str:
    """Unit of "u" or "y" as the report states it."""
    return str(report.get("units", {}).get(signal, f"units of {signal}"))


def _signals(report: dict[str, Any]) -> dict[str, str]:
    """Labels of the signals, with the units that the report states."""
    u, y = unit_of(report, "u"), unit_of(report)
    rate = f"{y}/s" if "units" in report else f"{y} a second"
    return {"u": f"Input $u$ ({u})", "y": f"Output $y$ ({y})", "dy": f"Rate of $y$ ({rate})"}


def _curves(report: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """Trace, label, colour and line style of each simulation to draw."""
    if report["verdict"] == "none" or report["traces"]["before"] == report["traces"]["after"]:
        return [("before", "Simulated", BLUE, "-")]
    return [("before", "Before", VERMILION, "--"), ("after", "After", BLUE, "-")]


def largest_error(trace: dict[str, FloatArray]) -> slice:
    """The tenth of the record in which the simulation before has the largest error."""
    power = np.nan_to_num(trace["y"] - trace["before"]) ** 2
    length = min(max(int(ZOOM * power.size), MIN_ZOOM_SAMPLES), power.size)
    total = np.concatenate([[0.0], np.cumsum(power)])
    first = int(np.argmax(total[length:] - total[:-length]))
    return slice(first, first + length)


def _overlay(ax: Axes, trace: dict[str, FloatArray], curves: list[tuple[str, str, str, str]], part: slice) -> None:
    t = trace["t"][part]
    ax.plot(*_broken(t, trace["y"][part]), color=BLACK, linewidth=2.8, alpha=0.6, label="Measured")
    for name, text, colour, style in curves:
        ax.plot(*_broken(t, trace[name][part]), color=colour, linestyle=style, linewidth=1.3, label=text)
    ax.margins(x=0)


def _broken(t: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A line without a connection across times at which there are no samples."""
    steps = np.diff(t)
    after = np.flatnonzero(steps > BREAK * np.median(steps)) + 1
    return np.insert(t, after, t[after]), np.insert(x, after, np.nan)


def _errors(
    ax: Axes, report: dict[str, Any], trace: dict[str, FloatArray], curves: list[tuple[str, str, str, str]]
) -> None:
    """Draw the errors of the simulations and the noise band."""
    for name, text, colour, _ in curves:
        ax.plot(*_broken(trace["t"], trace["y"] - trace[name]), color=colour, linewidth=1.0, label=text)
    noise, name_of_noise = noise_band(report)
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


def _shade_scored(ax: Axes, stretches: list[list[float]]) -> None:
    for number, (start, stop) in enumerate(stretches):
        text = "" if number else "Scored"
        ax.axvspan(start, stop, color=GREY, alpha=0.18, linewidth=0, zorder=0, label=text)


def figure_location(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the gap over time, over frequency, over the range of each signal, and as an operating map.

    Parameters
    ----------
    report : dict
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
    """
    where, labels = report["where"], _signals(report)
    signals = list(dict.fromkeys(cell["signal"] for cell in where["operating"]))
    parts = ["frequency", *signals, "map"]
    if narrow:
        heights = [1.0, *[1.3] * (len(parts) - 1), 1.8]
        figure = _new_figure(narrow, 0.0, 2.3 * sum(heights))
        panels = figure.subplot_mosaic([["time"], *([part] for part in parts)], height_ratios=heights)
    else:
        figure = _new_figure(narrow, 5.6, 0.0)
        panels = figure.subplot_mosaic([["time"] * len(parts), parts], height_ratios=[1.0, 1.7])
    _time_strip(panels["time"], where["time"])
    _bands(panels["frequency"], where["band_hz"])
    for signal in signals:
        cells = [cell for cell in where["operating"] if cell["signal"] == signal]
        _cells(panels[signal], cells, labels.get(signal, signal), narrow)
    _operating_map(panels["map"], report, "bottom" if narrow else "right")
    return figure


def _time_strip(ax: Axes, segments: list[list[float]]) -> None:
    """Draw the error power over time, relative to its average."""
    start, stop, share = np.array(segments, float).reshape(-1, 3).T
    density = share * (stop[-1] - start[0]) / np.maximum(stop - start, 1e-300)
    ax.bar(start, density, stop - start, align="edge", color=VERMILION, edgecolor=VERMILION, linewidth=0.8)
    ax.axhline(1.0, color=BLACK, linestyle=":", linewidth=1.4)
    ax.margins(x=0)
    finish(ax, "Gap over time", TIME, "Error power /\nits average", legend_columns=0)


def _bands(ax: Axes, bands: list[list[float]]) -> None:
    """Draw shares over frequency; the lowest band, which starts at zero, is drawn one octave wide."""
    low, high, share = np.array(bands, float).reshape(-1, 3).T
    left = np.where(low > 0.0, low, high / 2.0)
    ax.bar(left, 100.0 * share, high - left, align="edge", color=BLUE, edgecolor="white", linewidth=0.8)
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter("{x:g}")
    finish(ax, "Gap over frequency", "Frequency (Hz)", "Share of the gap (%)", legend_columns=0)


def _cells(ax: Axes, cells: list[dict[str, Any]], label: str, beside: bool) -> None:
    """Draw the shares of gap and time over the range of a signal; `beside` puts the legend in one row."""
    low = np.array([cell["low"] for cell in cells])
    high = np.array([cell["high"] for cell in cells])
    share = 100.0 * np.array([cell["share"] for cell in cells])
    ax.bar(low, share, high - low, align="edge", color=BLUE, edgecolor="white", linewidth=0.8, label="Gap")
    time = 100.0 * np.array([cell["time"] for cell in cells])
    ax.stairs(time, np.append(low, high[-1]), color=BLACK, linewidth=1.6, label="Time")
    top = float(max(share.max(), time.max()))
    ax.set_ylim(0.0, max(top, 1e-9) * (1.3 if beside else 1.45))
    finish(ax, "Gap over the range", label, "Share (%)", legend_columns=2 if beside else 1)


def _operating_map(ax: Axes, report: dict[str, Any], bar_place: Literal["bottom", "right"]) -> None:
    """Draw the rms error of the simulation before in each cell of input and output that the record visits."""
    seen, labels = report["where"]["map"], _signals(report)
    rms = np.array(seen["rms"], float)  # None becomes NaN, which is not drawn
    mesh = ax.pcolormesh(seen["u"], seen["y"], rms.T, cmap="cividis", vmin=0.0)
    finish(ax, "Operating map", labels["u"], labels["y"], legend_columns=0)
    bar = ax.figure.colorbar(mesh, ax=ax, location=bar_place)
    bar.set_label(f"Rms error ({unit_of(report)})", fontsize=SMALL_TEXT_SIZE)
    bar.ax.tick_params(labelsize=SMALL_TEXT_SIZE)


def figure_experiment(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the proposed input.

    Parameters
    ----------
    report : dict
        Its ``next_experiment`` must not be None.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
    """
    planned = report["next_experiment"]
    figure = _new_figure(narrow, 2.8, 2.8)
    ax = figure.subplots()
    ax.step(planned["t"], planned["u"], where="post", color=BLUE, linewidth=1.2)
    ax.margins(x=0)
    finish(ax, "Proposed input", TIME, _signals(report)["u"], legend_columns=0)
    return figure


def figure_limits(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the smallest size of each effect that is visible, the smallest that is named, and what is excluded.

    Parameters
    ----------
    report : dict
        Its ``limits`` have a row with a visible size; `title` of a row is its label.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
        Sizes as shares of the range of a signal, of the slowest time constant or of the gain, the smallest on top.
    """
    rows = sorted(
        (row for row in report["limits"] if row["detect"] is not None), key=lambda row: row["share"]["detect"]
    )
    at = np.arange(len(rows))
    figure = _new_figure(narrow, 1.3 + 0.29 * len(rows), 1.9 + 0.36 * len(rows))
    ax = figure.subplots()
    shares = {
        which: 100.0 * np.array([np.nan if (x := row["share"][which]) is None else x for row in rows])
        for which in ("detect", "named", "excluded_above")
    }
    ax.hlines(at, shares["detect"], shares["named"], color=BLUE, linewidth=1.6, zorder=2)
    for which, text, colour, marker in LIMIT_MARKS:
        if np.isfinite(shares[which]).any():
            size, face = (10.0, "none") if which == "named" else (6.0, colour)
            (marks,) = ax.plot(shares[which], at, marker, label=text, zorder=3, color=colour, markersize=size)
            marks.set(markerfacecolor=face, markeredgewidth=1.8)
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter("{x:g}")
    labels = [f"{row.get('title', row['name'])} ({WHOLES[row['of']]})" for row in rows]
    ax.set_yticks(at, [fill(text, 24) for text in labels] if narrow else labels)
    ax.invert_yaxis()
    finish(ax, "Smallest sizes that show", "Size (% of what is in brackets)", "", legend_columns=0)
    ax.tick_params(axis="y", labelsize=NARROW_TEXT_SIZE if narrow else LIMIT_TEXT_SIZE)
    figure.legend(loc="outside lower center", ncols=1 if narrow else 3, fontsize=SMALL_TEXT_SIZE)
    return figure


def figures_as_png(report: dict[str, Any]) -> dict[str, dict[str, bytes]]:
    """All figures of a report as PNG, for a wide and for a narrow screen."""
    figures: dict[str, Callable[[dict[str, Any], bool], Figure]]
    figures = {"simulations": figure_simulations, "where": figure_location}
    if report["next_experiment"] is not None:
        figures["experiment"] = figure_experiment
    if any(row["detect"] is not None for row in report["limits"]):
        figures["limits"] = figure_limits
    return {name: {"wide": _png(f(report, False)), "narrow": _png(f(report, True))} for name, f in figures.items()}


def _png(figure: Figure) -> bytes:
    """The figure as PNG with a palette, a third of the size of one without."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    figure.set_dpi(DPI)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # once; `savefig` draws twice, and most of the time is the layout
    image = Image.frombuffer("RGBA", canvas.get_width_height(), canvas.buffer_rgba())
    reduced = BytesIO()
    image.convert("RGB").quantize(COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(reduced, "png")
    return reduced.getvalue()


def _new_figure(narrow: bool, wide_height: float, narrow_height: float) -> Figure:
    return new_figure(NARROW, narrow_height) if narrow else new_figure(WIDE, wide_height)
