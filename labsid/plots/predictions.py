"""The figure of a prediction: a few curves in one pair of axes, the same look for every prediction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from labsid._arrays import FloatArray, freeze
from labsid.plots.style import BLACK, BLUE, GREY, SMALL_TEXT_SIZE, TEXT_SIZE, VERMILION, axes_or_new, finish

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Role = Literal["measured", "moved", "before"]

_LOOK: dict[Role, dict[str, Any]] = {
    "measured": {"color": BLACK, "linewidth": 1.0, "zorder": 3},
    "before": {"color": VERMILION, "linewidth": 1.4, "linestyle": "--", "zorder": 2},
    "moved": {"color": BLUE, "linewidth": 2.0, "zorder": 4},
}


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One curve of a view.

    Attributes
    ----------
    role : {"measured", "before", "moved"}
        What was measured, the model as it was, or what moves with the slider.
    label : str
    x, y : ndarray, shape (N,)
    """

    role: Role
    label: str
    x: FloatArray
    y: FloatArray

    def __post_init__(self) -> None:
        freeze(self, x=self.x, y=self.y)


@dataclass(frozen=True, slots=True)
class View:
    """What is seen at one position of the slider.

    Attributes
    ----------
    title : str
    curves : tuple of Curve
    ylim : tuple of float
        Limits that are the same at every position, so that the movement is seen.
    said : str
        The numbers at this position, in a sentence.
    xlabel, ylabel : str
    mark : float or None
        Place of a vertical line.
    """

    title: str
    curves: tuple[Curve, ...]
    ylim: tuple[float, float]
    said: str
    xlabel: str = "Time (s)"
    ylabel: str = "Output y (V)"
    mark: float | None = None


def plot_view(view: View, ax: Axes | None = None) -> Axes:
    """Draw a view.

    Parameters
    ----------
    view : View
    ax : Axes, optional
        Default those of a new figure.

    Returns
    -------
    Axes
    """
    ax = axes_or_new(ax)
    for curve in view.curves:
        ax.plot(curve.x, curve.y, label=curve.label, **_LOOK[curve.role])
    if view.mark is not None:
        ax.axvline(view.mark, color=GREY, linestyle=":", zorder=1)
    ax.set_ylim(view.ylim)
    ax.margins(x=0)
    finish(ax, "", view.xlabel, view.ylabel, legend_columns=0)
    ax.set_title(view.title, fontsize=TEXT_SIZE, pad=26)
    # above the axes: a curve that moves may run through every part of them
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3, fontsize=SMALL_TEXT_SIZE, frameon=False)
    return ax


def view_png(view: View) -> bytes:
    """A view as a PNG image."""
    from io import BytesIO

    from labsid.plots.figure import ShownFigure
    from labsid.plots.style import save_png

    # fixed axes: they do not move with the slider, and a layout that fits the texts would take as long as the drawing
    figure = ShownFigure(figsize=(8.0, 3.7), facecolor="white")
    plot_view(view, figure.add_axes((0.11, 0.15, 0.87, 0.68)))
    content = BytesIO()
    save_png(figure, content, dpi=90)
    return content.getvalue()
