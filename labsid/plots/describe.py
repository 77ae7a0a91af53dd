"""Extraction of a figure's content as plain data: axes, limits, labels, curves and their colours."""

from typing import Any

import numpy as np
from matplotlib.colors import to_rgb

from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue


def describe_figure(figure: Any) -> FigureValue:
    """Extract the content of a matplotlib figure.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        A figure drawn with ``plot``, ``step`` or ``stairs``.

    Returns
    -------
    FigureValue
        All axes of the figure, from top to bottom and from left to right.
    """
    axes = sorted(figure.axes, key=lambda ax: (-round(ax.get_position().y0, 2), ax.get_position().x0))
    return FigureValue(tuple(_describe_axes(ax) for ax in axes))


def _describe_axes(ax: Any) -> AxesValue:
    legend = ax.get_legend()
    titles = [ax.get_title(loc) for loc in ("center", "left", "right")]
    boxes = [child.txt.get_text() for child in ax.artists if hasattr(child, "txt")]
    return AxesValue(
        title=" ".join(title for title in titles if title),
        xlabel=ax.get_xlabel(),
        ylabel=ax.get_ylabel(),
        xlim=_pair(ax.get_xlim()),
        ylim=_pair(ax.get_ylim()),
        grid=_has_grid(ax.xaxis) or _has_grid(ax.yaxis),
        legend=tuple(text.get_text() for text in legend.get_texts()) if legend is not None else (),
        texts=tuple([text.get_text() for text in ax.texts] + boxes),
        curves=tuple(_describe_lines(ax) + _describe_stairs(ax)),
    )


def _has_grid(axis: Any) -> bool:
    """Whether the grid is on, from the tick settings: the grid lines themselves would lay out every tick."""
    return bool(axis.get_tick_params(which="major").get("gridOn")) and len(axis.get_majorticklocs()) > 0


def _pair(limits: Any) -> tuple[float, float]:
    return float(limits[0]), float(limits[1])


def _describe_lines(ax: Any) -> list[CurveValue]:
    return [
        CurveValue(
            x=np.asarray(line.get_xdata(orig=False), float).reshape(-1),
            y=np.asarray(line.get_ydata(orig=False), float).reshape(-1),
            color=to_rgb(line.get_color()),
            steps=str(line.get_drawstyle()).startswith("steps"),
            label=str(line.get_label()),
        )
        for line in ax.lines
        if len(line.get_xdata(orig=False)) > 2
    ]


def _describe_stairs(ax: Any) -> list[CurveValue]:
    described = []
    for patch in ax.patches:
        if hasattr(patch, "get_data") and hasattr(patch.get_data(), "edges"):
            data = patch.get_data()
            described.append(
                CurveValue(
                    x=np.asarray(data.edges, float)[: len(data.values)],
                    y=np.asarray(data.values, float),
                    color=to_rgb(patch.get_edgecolor()),
                    steps=True,
                    label=str(patch.get_label()),
                )
            )
    return described
