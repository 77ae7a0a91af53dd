"""Extraction of a figure's content as plain data: axes, limits, labels, curves and their colours."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.collections import Collection, LineCollection, PathCollection
from matplotlib.colors import to_rgb
from matplotlib.container import BarContainer
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.spines import Spine

from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue
from labsid.plots.visible import is_collection_seen, is_line_seen, is_patch_seen


def describe_figure(figure: Any) -> FigureValue:
    """Extract the content of a matplotlib figure.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        A figure drawn with ``plot``, ``step``, ``stairs``, ``scatter``, ``stem``, ``bar`` or ``hlines``.

    Returns
    -------
    FigureValue
        All axes of the figure, from top to bottom and from left to right. What is written or explained beside the
        axes (a legend or a text of the figure) counts for each of them.
    """
    axes = sorted(figure.axes, key=lambda ax: (-round(ax.get_position().y0, 2), ax.get_position().x0))
    legends = [text for legend in figure.legends for text in _legend_texts(legend)]
    texts = [text.get_text() for text in figure.texts]
    texts += [legend.get_title().get_text() for legend in figure.legends]
    return FigureValue(tuple(_describe_axes(ax, legends, texts) for ax in axes))


def _describe_axes(ax: Any, legends: list[str], texts: list[str]) -> AxesValue:
    legend = ax.get_legend()
    titles = [ax.get_title(loc) for loc in ("center", "left", "right")]
    written = [text.get_text() for text in ax.texts]
    written += [child.txt.get_text() for child in ax.artists if hasattr(child, "txt")]
    if legend is not None:
        written.append(legend.get_title().get_text())
    return AxesValue(
        title=" ".join(title for title in titles if title),
        xlabel=ax.get_xlabel(),
        ylabel=ax.get_ylabel(),
        xlim=_pair(ax.get_xlim()),
        ylim=_pair(ax.get_ylim()),
        grid=_has_grid(ax.xaxis) or _has_grid(ax.yaxis),
        legend=(*(_legend_texts(legend) if legend is not None else ()), *legends),
        texts=tuple(text for text in [*written, *texts] if text),
        curves=tuple(_describe_curves(ax, _labels(ax))),
        is_listed=_is_listed(ax, _own_labels(ax)),
    )


def _describe_curves(ax: Any, labels: dict[int, str]) -> Iterator[CurveValue]:
    """What is drawn in axes, without what cannot be seen."""
    if not ax.get_visible():
        return
    yield from _describe_lines(ax, labels)
    yield from _describe_stairs(ax, labels)
    yield from _describe_collections(ax, labels)
    yield from _describe_bars(ax, labels)


def _labels(ax: Any) -> dict[int, str]:
    """The legend text of each artist, by its id: its label, or what ``legend(["first", "second"])`` gives to it."""
    labels = _own_labels(ax)
    if _is_listed(ax, labels):
        drawn = _drawn(ax)
        listed = [artist for artist in drawn if not any(artist in container for container in ax.containers)]
        texts = _legend_texts(ax.get_legend())
        labels |= {id(artist): text for artist, text in zip([*listed, *ax.containers], texts, strict=False)}
    return labels


def _is_listed(ax: Any, labels: dict[int, str]) -> bool:
    """Whether the texts of the legend are labels of no artist."""
    texts = [] if ax.get_legend() is None else _legend_texts(ax.get_legend())
    return bool(texts) and not set(texts) & set(labels.values())


def _drawn(ax: Any) -> list[Any]:
    drawn = []
    for child in ax.get_children():
        if isinstance(child, Spine):
            break  # the children before are those that were drawn
        if isinstance(child, (Line2D, Patch, Collection)):
            drawn.append(child)
    return drawn


def _own_labels(ax: Any) -> dict[int, str]:
    """The label of each artist, by its id."""
    labels = {id(artist): str(artist.get_label()) for artist in [*_drawn(ax), *ax.containers]}
    # `stem` and `errorbar` label their container, and not its line
    for container in ax.containers:
        for line in (getattr(container, "markerline", None), *getattr(container, "lines", ())[:1]):
            labels[id(line)] = labels[id(container)]
    return labels


def _legend_texts(legend: Any) -> list[str]:
    return [text.get_text() for text in legend.get_texts()]


def _has_grid(axis: Any) -> bool:
    """Whether the grid is on, from the tick settings: the grid lines themselves would lay out every tick."""
    return bool(axis.get_tick_params(which="major").get("gridOn")) and len(axis.get_majorticklocs()) > 0


def _pair(limits: Any) -> tuple[float, float]:
    return float(limits[0]), float(limits[1])


def _describe_lines(ax: Any, labels: dict[int, str]) -> Iterator[CurveValue]:
    bases = {id(stem.baseline) for stem in ax.containers if hasattr(stem, "markerline")}
    for line in ax.lines:
        x = np.asarray(line.get_xdata(orig=False), float).reshape(-1)
        y = np.asarray(line.get_ydata(orig=False), float).reshape(-1)
        if x.size < 2 or id(line) in bases or not is_line_seen(line):
            continue
        if line.get_transform() == ax.get_yaxis_transform(which="grid"):
            x = np.asarray(ax.get_xlim(), float)[: y.size]  # `axhline`, whose x counts in widths of the axes
        elif line.get_transform() == ax.get_xaxis_transform(which="grid"):
            continue  # `axvline`
        style = str(line.get_drawstyle())
        steps = style.startswith("steps")
        yield CurveValue(
            x=x,
            y=y,
            color=to_rgb(line.get_color()),
            steps=steps,
            label=labels[id(line)],
            where=style.removeprefix("steps").removeprefix("-") or "pre" if steps else "",
            joined=str(line.get_linestyle()).lower() not in ("none", "", " "),
            style=f"{line.get_linestyle()} {line.get_marker()} {line.get_linewidth():g}",
        )


def _describe_stairs(ax: Any, labels: dict[int, str]) -> Iterator[CurveValue]:
    for patch in ax.patches:
        if hasattr(patch, "get_data") and hasattr(patch.get_data(), "edges") and is_patch_seen(patch):
            data = patch.get_data()
            yield CurveValue(
                x=np.asarray(data.edges, float)[: len(data.values)],
                y=np.asarray(data.values, float),
                color=to_rgb(patch.get_edgecolor()),
                steps=True,
                label=labels[id(patch)],
                where="post",
            )


def _describe_collections(ax: Any, labels: dict[int, str]) -> Iterator[CurveValue]:
    """The points of ``scatter`` as one curve, and each line of ``hlines``."""
    for collection in ax.collections:
        if not is_collection_seen(collection):
            continue
        colors = [*collection.get_edgecolor(), *collection.get_facecolor()]
        color = to_rgb(colors[0]) if colors else (0.0, 0.0, 0.0)
        label = labels[id(collection)]
        if isinstance(collection, PathCollection):
            points = np.ma.getdata(collection.get_offsets())
            yield CurveValue(np.asarray(points[:, 0], float), np.asarray(points[:, 1], float), color, False, label)
        elif isinstance(collection, LineCollection):
            for segment in collection.get_segments():
                if len(segment) > 1 and np.ptp(segment[:, 1]) == 0:
                    yield CurveValue(np.array(segment[:, 0]), np.array(segment[:, 1]), color, False, label)


def _describe_bars(ax: Any, labels: dict[int, str]) -> Iterator[CurveValue]:
    for bars in ax.containers:
        if isinstance(bars, BarContainer) and len(bars.patches) > 1 and any(map(is_patch_seen, bars.patches)):
            middles = [bar.get_x() + bar.get_width() / 2 for bar in bars.patches]
            heights = [bar.get_height() for bar in bars.patches]
            color = to_rgb(bars.patches[0].get_facecolor())
            yield CurveValue(np.array(middles, float), np.array(heights, float), color, False, labels[id(bars)])
