"""Figures of the gap report, made from the JSON report alone."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from labsid.plots.gap_curves import (
    draw_errors,
    draw_outputs,
    largest_error,
    noise_band,
    shade_scored,
    simulation_curves,
    trace_of,
)
from labsid.plots.gap_details import figure_poles, figure_residual, figure_responses
from labsid.plots.gap_records import figure_records
from labsid.plots.page_figures import DPI_ON_PAPER, in_both_widths, page_figure, page_style, palette_png
from labsid.plots.signal_names import as_text_lines, axis_label, name_beside, name_of, one_line, unit_of
from labsid.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    SMALL_TEXT_SIZE,
    TIME,
    VERMILION,
    error_colours,
    finish,
    make_headroom,
    new_figure,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from labsid.plots.page_figures import PageFigure

WHOLES = {"u": "range of {u}", "y": "range of {y}", "time": "time constant", "gain": "gain"}
LIMIT_MARKS = (
    ("detect", "Visible from here on", ORANGE, "o"),
    ("named", "Told from all others", BLUE, "s"),
    ("excluded_above", "Excluded from here on (95 %)", BLACK, "|"),
)
NAME_WIDTH = 16  # characters of a line of the name beside the panel of the first figure
LIMIT_TEXT_SIZE, NARROW_TEXT_SIZE = 9.5, 8.0


def figure_first(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the worst stretch, measured, before and after, with the errors; without a gap the whole record.

    Parameters
    ----------
    report : dict
        Its `stretch` holds all samples of the worst stretch, and `stretch_of` the name of its record, if there are
        several; without them, the samples of the traces are drawn.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
    """
    holdout, curves = report["holdout_traces"], simulation_curves(report)
    figure = new_figure(*((4.4, 3.9) if narrow else (6.2, 4.1)))
    trace = trace_of(report, holdout is not None)
    name = report.get("stretch_of")
    of = " of the holdout" if holdout is not None else f" of {name}" if name else ""
    title = f"The whole record{of}"
    if report["verdict"] != "none":
        part = largest_error(trace)
        trace = report.get("stretch") or {name: signal[part] for name, signal in trace.items()}
        title = f"Where the gap{of} is largest"
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[1.7, 1.0])
    draw_outputs(upper, trace, curves, slice(None))
    longest, unit = 36 if narrow else 60, "" if "names" in report else f"({unit_of(report)})"
    whole = f"{title} {unit}".strip()
    title = as_text_lines([whole] if len(whole) <= longest else [*fill(title, longest).splitlines(), unit])
    finish(upper, title, "", name_beside(report, NAME_WIDTH), legend_columns=0)
    draw_errors(lower, report, trace, curves)
    finish(lower, "", TIME, "Error", legend_columns=0)
    lower.locator_params(axis="x", nbins=4 if narrow else 7)
    figure.align_ylabels([upper, lower])
    handles = [*upper.lines, next(line for line in lower.lines if str(line.get_label()).endswith("s.d."))]
    figure.legend(handles=handles, loc="outside lower center", ncols=2 if narrow else 4, fontsize=SMALL_TEXT_SIZE)
    return figure


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
    trace = trace_of(report)
    curves = simulation_curves(report)
    zoom = report["verdict"] != "none"
    holdout = report["holdout_traces"]
    rows = 2 + zoom + (holdout is not None)
    figure = page_figure(narrow, 3.1 * rows, 2.75 * rows)
    panels = list(figure.subplots(rows, 1))
    output, error = axis_label(report, "y"), as_text_lines([f"Simulation error ({unit_of(report)})"])
    draw_outputs(panels[0], trace, curves, slice(None))
    finish(panels[0], "The whole record", TIME, output, legend_columns=2 if narrow else len(curves) + 1)
    make_headroom(panels[0], 0.27 if narrow else 0.18)
    if zoom:
        part = largest_error(trace)
        panels[0].axvspan(trace["t"][part][0], trace["t"][part][-1], color=GREY, alpha=0.35, linewidth=0, zorder=0)
        draw_outputs(panels[1], trace, curves, part)
        finish(panels[1], "Zoom on the shaded part", TIME, output, legend_columns=0)
    own = panels[1 + zoom]
    draw_errors(own, report, trace, curves)
    if holdout is not None:
        finish(own, "Simulation error", TIME, error, legend_columns=0)
        draw_errors(panels[-1], report, trace_of(report, holdout=True), curves)
    shade_scored(panels[-1], report["gap"]["holdout"])
    title = "Simulation error" if holdout is None else "Simulation error on the holdout record"
    finish(panels[-1], title, TIME, error, legend_columns=2 if narrow else 4)
    make_headroom(panels[-1], 0.27 if narrow else 0.18)
    return figure


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
    where = report["where"]
    labels = {"u": axis_label(report, "u"), "y": axis_label(report, "y"), "dy": axis_label(report, "y", rate=True)}
    signals = list(dict.fromkeys(cell["signal"] for cell in where["operating"]))
    parts = ["frequency", *signals, "map"]
    if narrow:
        heights = [1.0, *[1.3] * (len(parts) - 1), 1.8]
        figure = page_figure(narrow, 0.0, 2.3 * sum(heights))
        panels = figure.subplot_mosaic([["time"], *([part] for part in parts)], height_ratios=heights)
    else:
        figure = page_figure(narrow, 5.6, 0.0)
        panels = figure.subplot_mosaic([["time"] * len(parts), parts], height_ratios=[1.0, 1.7])
    if report.get("by_record"):
        _by_record(panels["time"], report["by_record"])
    else:
        _time_strip(panels["time"], where["time"])
    _bands(panels["frequency"], where["band_hz"])
    for signal in signals:
        cells = [cell for cell in where["operating"] if cell["signal"] == signal]
        _cells(panels[signal], cells, labels[signal], narrow)
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


def _by_record(ax: Axes, shares: list[dict[str, Any]]) -> None:
    """Draw the shares of gap and time in each of several records, the first one on top."""
    at = np.arange(len(shares))
    ax.barh(at, [100.0 * one["share"] for one in shares], 0.7, color=VERMILION, label="Gap")
    time = np.array([100.0 * one["time"] for one in shares])
    ax.vlines(time, at - 0.42, at + 0.42, color=BLACK, linewidth=1.8, label="Time")
    ax.set_yticks(at, [one_line(one["name"]) for one in shares])
    ax.invert_yaxis()
    finish(ax, "Gap by record", "Share (%)", "")
    ax.tick_params(axis="y", labelsize=LIMIT_TEXT_SIZE)


def _bands(ax: Axes, bands: list[list[float]]) -> None:
    """Draw shares over frequency; the lowest band, which starts at zero, is drawn one octave wide."""
    low, high, share = np.array(bands, float).reshape(-1, 3).T
    left = np.where(low > 0.0, low, high / 2.0)
    ax.bar(left, 100.0 * share, high - left, align="edge", color=VERMILION, edgecolor="white", linewidth=0.8)
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("")  # within a decade, matplotlib labels the minor ticks too
    finish(ax, "Gap over frequency", "Frequency (Hz)", "Share of the gap (%)", legend_columns=0)


def _cells(ax: Axes, cells: list[dict[str, Any]], label: str, beside: bool) -> None:
    """Draw the shares of gap and time over the range of a signal; `beside` puts the legend in one row."""
    low = np.array([cell["low"] for cell in cells])
    high = np.array([cell["high"] for cell in cells])
    share = 100.0 * np.array([cell["share"] for cell in cells])
    ax.bar(low, share, high - low, align="edge", color=VERMILION, edgecolor="white", linewidth=0.8, label="Gap")
    time = 100.0 * np.array([cell["time"] for cell in cells])
    ax.stairs(time, np.append(low, high[-1]), color=BLACK, linewidth=1.6, label="Time")
    top = float(max(share.max(), time.max()))
    ax.set_ylim(0.0, max(top, 1e-9) * (1.3 if beside else 1.45))
    finish(ax, "Gap over the range", label, "Share (%)", legend_columns=2 if beside else 1)


def _operating_map(ax: Axes, report: dict[str, Any], bar_place: Literal["bottom", "right"]) -> None:
    """Draw the rms error of the simulation before in each cell of input and output that the record visits."""
    seen = report["where"]["map"]
    rms = np.array(seen["rms"], float)  # None becomes NaN, which is not drawn
    mesh = ax.pcolormesh(seen["u"], seen["y"], rms.T, cmap=error_colours(), vmin=0.0)
    finish(ax, "Operating map", axis_label(report, "u"), axis_label(report, "y"), legend_columns=0)
    bar = ax.figure.colorbar(mesh, ax=ax, location=bar_place)
    bar.set_label(as_text_lines([f"Rms error ({unit_of(report)})"]), fontsize=SMALL_TEXT_SIZE)
    bar.ax.tick_params(labelsize=SMALL_TEXT_SIZE)


def figure_experiment(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the proposed input, and the difference of the responses of the two explanations to it.

    Parameters
    ----------
    report : dict
        Its ``next_experiment`` must not be None. `rivals` holds the responses by their titles.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
    """
    planned = report["next_experiment"]
    rivals = report.get("rivals") or {}
    rows = 1 + bool(rivals)
    figure = page_figure(narrow, 2.4 + 2.6 * bool(rivals), 2.4 + 2.9 * bool(rivals))
    panels = list(figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0])
    panels[0].step(planned["t"], planned["u"], where="post", color=BLACK, linewidth=1.2)
    panels[0].margins(x=0)
    finish(panels[0], "Proposed input", "" if rivals else TIME, axis_label(report, "u"), legend_columns=0)
    if rivals:
        panels[1].margins(x=0)
        ours, rival = rivals.values()
        noise, name = noise_band(report)
        panels[1].plot(planned["t"], ours - rival, color=BLUE, linewidth=1.4, label="Difference")
        for side, text in ((-noise, f"{name}, ±2 s.d."), (noise, "")):
            panels[1].axhline(side, color=GREEN, linestyle=":", linewidth=1.6, label=text)
        label = fill("Response with {} less that with {}, as fitted".format(*rivals), 44 if narrow else 90)
        finish(
            panels[1], as_text_lines(label.splitlines()), TIME, as_text_lines([f"Difference ({unit_of(report)})"]), 0
        )
        figure.legend(loc="outside lower center", ncols=2, fontsize=SMALL_TEXT_SIZE)
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
    figure = page_figure(narrow, 1.3 + 0.29 * len(rows), 1.9 + 0.36 * len(rows))
    ax = figure.subplots()
    shares = {
        which: 100.0 * np.array([np.nan if (x := row["share"][which]) is None else x for row in rows])
        for which in ("detect", "named", "excluded_above")
    }
    ax.hlines(at, shares["detect"], shares["named"], color=GREY, linewidth=1.6, zorder=2)
    for which, text, colour, marker in LIMIT_MARKS:
        if np.isfinite(shares[which]).any():
            size, face = (10.0, "none") if which == "named" else (6.0, colour)
            (marks,) = ax.plot(shares[which], at, marker, label=text, zorder=3, color=colour, markersize=size)
            marks.set(markerfacecolor=face, markeredgewidth=1.8)
    ax.set_xscale("log")
    ax.xaxis.set_major_formatter("{x:g}")
    names = {signal: one_line(name_of(report, signal)) for signal in ("u", "y")}
    labels = [f"{row.get('title', row['name'])} ({WHOLES[row['of']].format(**names)})" for row in rows]
    ax.set_yticks(at, [fill(text, 24) for text in labels] if narrow else labels)
    ax.invert_yaxis()
    finish(ax, "Smallest sizes that show", "Size (% of what is in brackets)", "", legend_columns=0)
    ax.tick_params(axis="y", labelsize=NARROW_TEXT_SIZE if narrow else LIMIT_TEXT_SIZE)
    figure.legend(loc="outside lower center", ncols=1 if narrow else 3, fontsize=SMALL_TEXT_SIZE)
    return figure


def figures_as_png(report: dict[str, Any]) -> dict[str, dict[str, bytes]]:
    """All figures of a report as PNG, for a wide and for a narrow screen."""
    figures: dict[str, PageFigure] = {"first": figure_first}
    several = bool(report.get("record_traces"))
    if several:
        figures["records"] = figure_records
    if report["verdict"] != "none":
        figures["where"] = figure_location
    if report["next_experiment"] is not None:
        figures["experiment"] = figure_experiment
    if report.get("responses") is not None:
        figures["responses"] = figure_responses
    if report.get("poles"):
        figures["poles"] = figure_poles
    if report.get("residual") is not None:
        figures["residual"] = figure_residual
    if any(row["detect"] is not None for row in report["limits"]):
        figures["limits"] = figure_limits
    # The script replaces the figure of one record; without it a telephone shows the wide one.
    with page_style():
        one = {} if several else {"simulations": {"wide": palette_png(figure_simulations(report), DPI_ON_PAPER)}}
    return one | in_both_widths(figures, report)
