"""Figures of pages: their two widths, and small files."""

from __future__ import annotations

import warnings
from contextlib import contextmanager
from io import BytesIO
from typing import TYPE_CHECKING, Any

from labsid.plots.style import new_figure

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from matplotlib.figure import Figure

    PageFigure = Callable[[dict[str, Any], bool], Figure]
    """A figure of a report, for a wide screen or for a narrow one."""

WIDE, NARROW = 9.5, 4.4  # inches: for a desktop and for a telephone
DPI = 144  # one and a half times the width of the page
DPI_ON_PAPER = 108  # of a figure that a screen shows without a script only: half of the size
COLOURS = 32  # of a picture


def page_figure(narrow: bool, wide_height: float, narrow_height: float) -> Figure:
    """Create an empty figure of the width of a desktop or of a telephone, with its height in inches for each."""
    return new_figure(NARROW, narrow_height) if narrow else new_figure(WIDE, wide_height)


@contextmanager
def page_style() -> Iterator[None]:
    """The defaults of matplotlib, whatever style a notebook or a file of settings has set."""
    from matplotlib import style

    with style.context("default"):
        yield


def palette_png(figure: Figure, dpi: int = DPI) -> bytes:
    """The figure as PNG with a palette, a third of the size of one without, at `dpi` dots per inch."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # names of signals in any script
        canvas.draw()  # once; `savefig` draws twice, and most of the time is the layout
    image = Image.frombuffer("RGBA", canvas.get_width_height(), canvas.buffer_rgba())
    reduced = BytesIO()
    image.convert("RGB").quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(
        reduced, "png", optimize=True
    )
    return reduced.getvalue()


def in_both_widths(figures: Mapping[str, PageFigure], report: dict[str, Any]) -> dict[str, dict[str, bytes]]:
    """The figures of a report as PNG, for a wide and for a narrow screen."""
    with page_style():
        return {
            name: {"wide": palette_png(draw(report, False)), "narrow": palette_png(draw(report, True))}
            for name, draw in figures.items()
        }
