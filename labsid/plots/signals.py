"""Figures of a diagnosis of several signals, made from the JSON report alone (layout ``labsid.gap/4``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from labsid._arrays import FloatArray
from labsid._texts import cause_word
from labsid.plots.gap_curves import (
    draw_errors,
    draw_outputs,
    largest_error,
    shade_scored,
    simulation_curves,
    trace_of,
)
from labsid.plots.page_figures import page_figure
from labsid.plots.signal_names import as_text_lines, stacked, units_of
from labsid.plots.style import BLACK, BLUE, GREY, SMALL_TEXT_SIZE, TIME, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Traces = Literal["traces", "holdout_traces"]

HEIGHTS = {"output": 1.9, "error": 1.25, "input": 1.05}  # inches of a panel
MANY, FLATTER = 3, 0.8  # outputs in panels of full height; heights of more of them, relative
MARGIN = 0.9  # inches, of the legend and of the axis of time
CHARACTERS = 10.5  # of a label beside a panel, an inch
LEVELS = ("low", "high")  # parameters of an effect that are values of its signal
PLACES = {"dynamics": " in the dynamics", "disturbance": ", a disturbance"}


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel of the figure.

    Attributes
    ----------
    kind : str
        "output", "error" or "input".
    signal : str
    trace : dict
        Samples of the signal.
    """

    kind: str
    signal: str
    trace: dict[str, list[float]]


def figure_signals(
    report: dict[str, Any], narrow: bool = False, traces: Traces = "traces", zoom: bool = False
) -> Figure:
    """Draw all outputs and their errors one under the other, and the inputs below, over one axis of time.

    Parameters
    ----------
    report : dict
        `title` of an effect is its name in the figure.
    narrow : bool
        Whether to fit the width of a telephone.
    traces : str
        "traces" for the record, "holdout_traces" for the holdout record.
    zoom : bool
        Whether to draw only the tenth of the record with the largest error, and no errors.

    Returns
    -------
    matplotlib.figure.Figure
        The scored samples are shaded behind the errors, and the tenth with the largest error behind the outputs. An
        effect stands above the signal at which it acts.
    """
    drawn = _panels(report, traces, errors=not zoom)
    size = FLATTER if len(report["outputs"]) > MANY else 1.0
    heights = [size * HEIGHTS[panel.kind] for panel in drawn]
    figure = page_figure(narrow, sum(heights) + MARGIN, sum(heights) + MARGIN + (0.3 if narrow else 0.0))
    axes = figure.subplots(len(drawn), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    stretch = worst_stretch(report, traces)
    for ax, panel in zip(axes, drawn, strict=True):
        trace = {key: np.asarray(x, float) for key, x in panel.trace.items()}
        if zoom:
            inside = (trace["t"] >= stretch[0]) & (trace["t"] <= stretch[1])
            trace = {key: x[inside] for key, x in trace.items()}
        _draw(ax, panel, report, trace, traces)
        if panel.kind == "output" and report["verdict"] != "none" and not zoom:
            ax.axvspan(*stretch, color=GREY, alpha=0.35, linewidth=0, zorder=0, label="Largest error")
    axes[-1].set_xlabel(TIME, fontsize=SMALL_TEXT_SIZE)
    figure.align_ylabels(axes)
    _legend(figure, axes, columns=2 if narrow else 6)
    return figure


def worst_stretch(report: dict[str, Any], traces: Traces = "traces") -> tuple[float, float]:
    """The tenth of the record in which the output with the largest gap has its largest error, in seconds."""
    trace = trace_of(report["outputs"][report["where"]["output"]], traces == "holdout_traces")
    t = trace["t"][largest_error(trace)]
    return float(t[0]), float(t[-1])


def inputs_shown(report: dict[str, Any], traces: Traces = "traces") -> dict[str, dict[str, list[float]]]:
    """The inputs whose samples are in the report, of the holdout those through which an output is explained."""
    samples = {one["main"]: one[traces] for one in report["outputs"].values()}
    if traces == "traces":
        samples |= report.get("inputs", {})
    return {one["name"]: samples[one["name"]] for one in report["signals"]["inputs"] if one["name"] in samples}


def _panels(report: dict[str, Any], traces: Traces, errors: bool) -> list[Panel]:
    """Every output, followed by its error, then the inputs."""
    kinds = ("output", "error") if errors else ("output",)
    outputs = [one["name"] for one in report["signals"]["outputs"] if one["name"] in report["outputs"]]
    panels = [Panel(kind, name, report["outputs"][name][traces]) for name in outputs for kind in kinds]
    return panels + [Panel("input", name, trace) for name, trace in inputs_shown(report, traces).items()]


def _draw(ax: Axes, panel: Panel, report: dict[str, Any], trace: dict[str, FloatArray], traces: Traces) -> None:
    """Draw a panel with its label."""
    unit, name = units_of(report)[panel.signal], panel.signal
    if panel.kind == "error":
        own = report["outputs"][name]
        draw_errors(ax, own | {"verdict": report["verdict"]}, trace, simulation_curves(report))
        if traces == "holdout_traces" or not _has_holdout(report):
            shade_scored(ax, own["gap"]["holdout"])
        name = "Error"
    elif panel.kind == "output":
        draw_outputs(ax, trace, simulation_curves(report), slice(None))
    else:
        ax.step(trace["t"], trace["u"], where="post", color=BLACK, linewidth=1.2)
        ax.margins(x=0, y=0.12)
    finish(ax, "", "", stacked(name, unit, int(HEIGHTS[panel.kind] * FLATTER * CHARACTERS)), legend_columns=0)
    ax.set_ylabel(ax.get_ylabel(), fontsize=SMALL_TEXT_SIZE)
    ax.locator_params(axis="y", nbins=5 if panel.kind == "output" else 3)
    if panel.kind != "error":
        _mark_effects(ax, panel, report)


def _has_holdout(report: dict[str, Any]) -> bool:
    return any(one.get("holdout_traces") is not None for one in report["outputs"].values())


def _mark_effects(ax: Axes, panel: Panel, report: dict[str, Any]) -> None:
    """Name the effects at a signal above its panel, and draw their limits."""
    own = effects_at(report, panel.signal, panel.kind)
    if own:
        title = as_text_lines(["; ".join(effect_title(effect) for effect in own)])
        ax.set_title(title, loc="left", color=BLUE, fontsize=SMALL_TEXT_SIZE)
    low, high = ax.get_ylim()
    for effect in own:
        levels = [effect["parameters"][name]["value"] for name in LEVELS if name in effect["parameters"]]
        if effect["signal"] is None or not all(low <= level <= high for level in levels):
            continue
        if effect["name"].endswith("dead-zone") and len(levels) == len(LEVELS):
            ax.axhspan(*levels, color=BLUE, alpha=0.2, linewidth=0, zorder=0)
        for level in levels:
            ax.axhline(level, color=BLUE, linestyle="-.", linewidth=1.2)


def effects_at(report: dict[str, Any], signal: str, kind: str) -> list[dict[str, Any]]:
    """The effects that act at a signal; at an output also those of the dynamics that change it most."""
    return [
        effect
        for effect in report["effects"]
        if effect["signal"] == signal
        or (kind == "output" and effect["signal"] is None and effect["outputs"][:1] == [signal])
    ]


def effect_title(effect: dict[str, Any]) -> str:
    """``Cause: dead zone``, with its place if it acts at no signal."""
    word = cause_word(effect["probability"]).capitalize()
    place = f" at {effect['joint']}" if effect.get("joint") else PLACES.get(effect["path"], "")
    place = "" if effect["signal"] else place
    return f"{word}: {effect.get('title', effect['name'])}{place}"


def _legend(figure: Figure, axes: Any, columns: int) -> None:
    """One legend of all panels above them."""
    found: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    figure.legend(
        found.values(), found.keys(), loc="outside upper center", ncols=columns, fontsize=SMALL_TEXT_SIZE, frameon=False
    )


def figure_planned_inputs(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the proposed inputs one under the other.

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
    planned, units = report["next_experiment"], units_of(report)
    height = 1.5 * len(planned["u"]) + 0.4
    figure = page_figure(narrow, height, height)
    axes = figure.subplots(len(planned["u"]), 1, sharex=True, squeeze=False)[:, 0]
    for ax, (name, u) in zip(axes, planned["u"].items(), strict=True):
        ax.step(planned["t"], u, where="post", color=BLACK, linewidth=1.2)
        ax.margins(x=0)
        finish(ax, "", "", stacked(name, units[name], int(1.5 * CHARACTERS)), legend_columns=0)
        ax.locator_params(axis="y", nbins=4)
    axes[-1].set_xlabel(TIME, fontsize=SMALL_TEXT_SIZE)
    figure.align_ylabels(axes)
    return figure
