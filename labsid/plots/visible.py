"""Whether an artist of a figure can be seen: it is shown, has a width or a size, and differs from its background."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.colors import to_rgba

from labsid._arrays import FloatArray

LEAST_CONTRAST = 0.03
"""Difference of red, green or blue, of 1, between a curve and its background."""

_LEAST_WIDTH = 0.05  # points


def is_line_seen(line: Any) -> bool:
    """Whether the line or the markers of a `Line2D` can be seen."""
    has_line = _is_set(line.get_linestyle()) and line.get_linewidth() > _LEAST_WIDTH
    has_marker = _is_set(line.get_marker()) and line.get_markersize() > _LEAST_WIDTH
    marker = [line.get_markerfacecolor()]
    marker += [line.get_markeredgecolor()] if line.get_markeredgewidth() > _LEAST_WIDTH else []
    return line.get_visible() and (
        (has_line and _differs(line, [line.get_color()])) or (has_marker and _differs(line, marker))
    )


def is_patch_seen(patch: Any) -> bool:
    """Whether the area or the edge of a patch, such as a bar or ``stairs``, can be seen."""
    colors = [patch.get_facecolor()] if patch.get_fill() else []
    colors += [patch.get_edgecolor()] if patch.get_linewidth() > _LEAST_WIDTH else []
    return patch.get_visible() and _differs(patch, colors)


def is_collection_seen(collection: Any) -> bool:
    """Whether the points of ``scatter``, or the lines of ``hlines``, can be seen."""
    sizes = np.atleast_1d(getattr(collection, "get_sizes", tuple)())
    if not collection.get_visible() or (sizes.size > 0 and np.max(sizes) <= _LEAST_WIDTH):
        return False
    widths = np.atleast_1d(collection.get_linewidth())
    edges = list(collection.get_edgecolor()) if widths.size and np.max(widths) > _LEAST_WIDTH else []
    return _differs(collection, [*collection.get_facecolor(), *edges])


def _is_set(style: object) -> bool:
    return str(style).strip().lower() not in ("none", "")


def _differs(artist: Any, colors: Iterable[Any]) -> bool:
    """Whether any of the colours differs from what is behind the artist."""
    background = np.ones(3)
    for behind in (artist.figure.get_facecolor(), artist.axes.get_facecolor()):
        background = _over(to_rgba(behind), background)
    alpha = artist.get_alpha()
    single = None if alpha is None else float(np.max(alpha))
    drawn = (to_rgba(color) if single is None else (*to_rgba(color)[:3], single) for color in colors if _is_set(color))
    return any(bool(np.max(np.abs(_over(color, background) - background)) > LEAST_CONTRAST) for color in drawn)


def _over(color: tuple[float, ...], background: FloatArray) -> FloatArray:
    return color[3] * np.array(color[:3]) + (1 - color[3]) * background
