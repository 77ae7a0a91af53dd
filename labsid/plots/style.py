"""Colours, sizes and saving of all figures.

Figures are created without pyplot, so no global state or setting changes. matplotlib is imported with the first figure.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

Corner = Literal["upper right", "lower right"]

GREY_BLUE = (0.6, 0.7, 0.8)
"""The lab's colour code for cos(0.02*pi*t)."""

# The palette of Okabe and Ito (2008), distinguishable by colour-blind readers. A colour means the same in all figures.
BLACK = "#222222"
"""What was measured, an input, a true value."""
GREY = "#B0B0B0"
"""What lies behind or beside: samples, stretches, references."""
BLUE = "#0072B2"
"""The answer: an estimate, a fitted model, the simulation after a correction."""
VERMILION = "#D55E00"
"""What the answer is held against: the simulation before, its error, a wrong or simpler method, a rival."""
GREEN = "#009E73"
"""Noise and uncertainty; of several things of one kind the third."""
ORANGE = "#E69F00"
"""One more signal or model beside the others."""

CYCLE = (BLUE, VERMILION, GREEN, ORANGE, "#CC79A7", "#56B4E9", BLACK)
"""``C0`` to ``C6`` in the notebooks, as in `NOTEBOOK_STYLE`."""
NOTEBOOK_STYLE = "labsid.plots.notebook"
"""Style sheet of the notebooks, for ``plt.style.use``."""

STYLE_SHEETS = Path(__file__).parent
"""Folder of page.css, the style sheet of all pages, in the same colours."""

TIME = "Time (s)"
TEXT_SIZE = 12
SMALL_TEXT_SIZE = 11


def new_figure(width: float = 8.0, height: float = 6.0, alt: str = "") -> Figure:
    """Create an empty white figure of `width` by `height` inches with constrained layout and the description `alt`."""
    from labsid.plots.figure import ShownFigure

    figure = ShownFigure(figsize=(width, height), layout="constrained", facecolor="white")
    figure.alt = alt
    return figure


def axes_or_new(ax: Axes | None) -> Axes:
    """Return `ax`, or the axes of a new figure."""
    return new_figure(height=3.6).add_subplot() if ax is None else ax


def finish(
    ax: Axes,
    title: str,
    xlabel: str,
    ylabel: str,
    legend_columns: int = 1,
    legend_place: Corner = "upper right",
) -> None:
    """Set title, axis labels and grid of `ax`, and add a legend with `legend_columns` columns (0: no legend)."""
    ax.set_title(title, fontsize=TEXT_SIZE)
    ax.set_xlabel(xlabel, fontsize=TEXT_SIZE)
    ax.set_ylabel(ylabel, fontsize=TEXT_SIZE)
    ax.tick_params(labelsize=SMALL_TEXT_SIZE)
    ax.grid(True, color="#DDDDDD", linewidth=0.8)
    ax.set_axisbelow(True)
    if legend_columns:
        ax.legend(loc=legend_place, ncols=legend_columns, fontsize=SMALL_TEXT_SIZE, framealpha=0.9)


def make_headroom(ax: Axes, share: float) -> None:
    """Raise the upper y limit so that the top `share` of `ax` is free for a legend or a box."""
    lower, upper = ax.get_ylim()
    ax.set_ylim(lower, lower + (upper - lower) / (1.0 - share))


def axis_of_gain(ax: Axes) -> None:
    """Logarithmic axes of frequency and gain, with 1, 2 and 5 written within a decade if there are few decades."""
    from matplotlib.ticker import FuncFormatter

    ax.set(xscale="log", yscale="log")
    low, high = ax.get_ylim()
    leading = ("1", "2", "5") if high < 100.0 * low else ("1",)
    for formatted in (ax.yaxis.set_major_formatter, ax.yaxis.set_minor_formatter):
        formatted(FuncFormatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in leading else ""))


def error_colours() -> Colormap:
    """Colours of errors, pale to dark vermilion: the largest stand out, also where a dark page inverts the figure."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("errors", ["#F8E6DA", VERMILION, "#5E2600"])


def save_png(figure: Figure, path: str | PathLike[str] | BinaryIO, dpi: int = 150) -> None:
    """Write `figure` as PNG to `path`, a file name or an open binary file, at `dpi` dots per inch."""
    figure.savefig(path, format="png", dpi=dpi)


def save_figure(figure: Figure, path: Path) -> None:
    """Write `figure` in the format that the suffix of `path` states, `.png` or `.svg`.

    Raises
    ------
    ValueError
        If it states another one; `check_figure_file` says so before the work.
    """
    check_figure_file(path)
    save = save_svg if path.suffix.lower() == ".svg" else save_png
    save(figure, path)


def check_figure_file(path: Path) -> None:
    """Refuse a file of a figure whose suffix is neither `.png` nor `.svg`.

    Raises
    ------
    ValueError
    """
    if path.suffix.lower() not in (".png", ".svg"):
        raise ValueError(f"--plot must end in .png or .svg; got {path.name!r}. Name it {path.stem}.png.")


def save_svg(figure: Figure, path: str | PathLike[str] | BinaryIO) -> None:
    """Write `figure` as SVG without a date to `path`, a file name or an open binary file."""
    figure.savefig(path, format="svg", metadata={"Date": None})
