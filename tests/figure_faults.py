"""What is wrong with how a figure looks: small texts, legends over data, and colours that have no role or merge."""

from collections.abc import Iterable, Iterator
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d.axes3d import Axes3D

from labsid.plots import style

SMALLEST = 8.0
"""Points: the smallest size of a text where a figure is shown, at 96 pixels an inch."""
NOTEBOOK, PAGE = 700.0, 950.0
"""Pixels: the column of a notebook and of a page, to which a wider figure shrinks."""
DPI = 100.0
"""Pixels of a figure, an inch."""
APART = 15.0
"""In CIE L*a*b*: curves of one panel that are closer together differ in line style or marker."""
INSIDE = 3.0
"""Pixels of a legend's frame that a curve may touch."""
# Linear RGB as seen with one cone type missing: Vienot, Brettel and Mollon (1999), eq. for protan and deutan.
PROTANOPIA = np.array([[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]])
DEUTERANOPIA = np.array([[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]])
OBSERVERS = {"full": np.eye(3), "protan": PROTANOPIA, "deutan": DEUTERANOPIA}


def lab_of(color: Any, seen_by: Any) -> Any:
    """CIE L*a*b* of a colour as an observer sees it."""
    srgb = np.array(to_rgb(color))
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    linear = np.clip(seen_by @ linear, 0, 1)
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = np.cbrt(to_xyz @ linear / (to_xyz @ np.ones(3)))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def distance(one: Any, other: Any) -> float:
    """The distance of two colours in CIE L*a*b*, for the observer to whom they are most alike."""
    return min(float(np.linalg.norm(lab_of(one, seen) - lab_of(other, seen))) for seen in OBSERVERS.values())


def faults_of(figure: Figure, column: float = NOTEBOOK) -> list[str]:
    """What is wrong with a figure in a column of so many pixels, a line each; empty if nothing is."""
    figure.draw_without_rendering()
    return [*_small_texts(figure, column), *_covered_data(figure), *_colours_without_a_role(figure), *_merging(figure)]


def _small_texts(figure: Figure, column: float) -> Iterator[str]:
    """The first text of each size that is too small."""
    small = {}
    shrunk = min(1.0, column / (DPI * figure.get_figwidth())) * DPI / 96.0
    without_axes = [axis for ax in figure.axes if not ax.axison for axis in (ax.xaxis, ax.yaxis)]
    hidden = {text for axis in without_axes for text in axis.findobj(Text)}
    for text in figure.findobj(Text):
        size = text.get_fontsize() * shrunk
        seen = text.get_visible() and text.get_text().strip() and text not in hidden
        if seen and size < SMALLEST - 0.01:
            small.setdefault(size, text.get_text())
    for size, shown in small.items():
        yield f"{shown!r} has {size:.2g} pt"


def _covered_data(figure: Figure) -> Iterator[str]:
    """Legends that lie over curves, contours, points or bars of their axes."""
    for number, ax in enumerate(figure.axes):
        legend = ax.get_legend()
        if legend is None or isinstance(ax, Axes3D):
            continue
        box = legend.get_window_extent().padded(-INSIDE)
        for artist in [*ax.lines, *ax.collections, *ax.patches]:
            if artist.get_visible() and _lies_in(artist, box):
                yield f"axes {number}: the legend lies over {artist.get_label()!r}"


def _lies_in(artist: Any, box: Bbox) -> bool:
    """Whether data lie in a box. A line of reference has two points, a shaded stretch spans the axes."""
    if isinstance(artist, PathCollection):
        at = artist.get_offset_transform().transform(np.ma.getdata(artist.get_offsets()))
        return _has_point(box, at)
    if isinstance(artist, ContourSet):
        lines = [] if artist.filled else artist.get_paths()
        return any(artist.get_transform().transform_path(one).intersects_bbox(box, filled=False) for one in lines)
    if isinstance(artist, Line2D):
        path = artist.get_transform().transform_path(artist.get_path())
        if artist.get_linestyle().lower() == "none":
            return _has_point(box, path.vertices)
        return len(path.vertices) > 2 and bool(path.intersects_bbox(box, filled=False))
    if isinstance(artist, Patch):
        path = artist.get_transform().transform_path(artist.get_path())
        extent, frame = path.get_extents(), artist.axes.bbox
        spans = extent.height > 0.99 * frame.height or extent.width > 0.99 * frame.width
        return not spans and bool(path.intersects_bbox(box, filled=True))
    return False


def _has_point(box: Bbox, at: Any) -> bool:
    x, y = np.asarray(at, float).reshape(-1, 2).T
    return bool(((x > box.x0) & (x < box.x1) & (y > box.y0) & (y < box.y1)).any())


def _colours_without_a_role(figure: Figure) -> Iterator[str]:
    for number, ax in enumerate(figure.axes):
        if ax.get_label() == "<colorbar>":
            continue
        for artist in [*ax.lines, *ax.collections, *ax.patches]:
            if artist.get_visible() and not (isinstance(artist, ScalarMappable) and artist.get_array() is not None):
                for colour in sorted({to_hex(one) for one in _colours(artist) if not has_role(one)}):
                    yield f"axes {number}: {artist.get_label()!r} has a colour without a role, {colour}"


def has_role(colour: Any) -> bool:
    """Whether a colour is one of the style's, mixed with white or not, or a grey."""
    rgb = np.array(to_rgb(colour))
    if np.ptp(rgb) < 0.02:
        return True
    for one in (*style.CYCLE, style.GREY_BLUE):
        away = 1.0 - np.array(to_rgb(one))
        share = away @ (1.0 - rgb) / (away @ away)
        if np.allclose(1.0 - share * away, rgb, atol=0.01):
            return True
    return False


def _colours(artist: Any) -> Iterable[Any]:
    if isinstance(artist, Line2D):
        return [artist.get_color()]
    found = [*np.atleast_2d(artist.get_facecolor()), *np.atleast_2d(artist.get_edgecolor())]
    return [colour for colour in found if len(colour) == 4 and colour[3] > 0.0]


def _merging(figure: Figure) -> Iterator[str]:
    """Curves of one panel that some reader cannot tell apart."""
    for number, ax in enumerate(figure.axes):
        curves = [line for line in ax.lines if line.get_visible() and not str(line.get_label()).startswith("_")]
        for one, other in combinations(curves, 2):
            same = (one.get_linestyle(), one.get_marker()) == (other.get_linestyle(), other.get_marker())
            if same and to_rgb(one.get_color()) != to_rgb(other.get_color()):
                apart = distance(one.get_color(), other.get_color())
                if apart < APART:
                    yield f"axes {number}: {one.get_label()!r} and {other.get_label()!r} merge, {apart:.0f}"
