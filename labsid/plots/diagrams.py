"""Elements of block diagrams: blocks, summing junctions with signs, wires, arrows and labels.

Coordinates are in diagram units with y upwards; `show_as_diagram` sets the size of the diagram in these units. Text may
contain formulas in mathtext, ``$...$``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from labsid.plots.style import BLACK, TEXT_SIZE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Point = tuple[float, float]

LINE_WIDTH = 1.4
FORMULA_FONT = "stix"
JUNCTION_RADIUS = 0.22


@dataclass(frozen=True, slots=True)
class Part:
    """Connection points of a block or a junction."""

    left: Point
    right: Point
    top: Point
    bottom: Point


def show_as_diagram(ax: Axes, width: float, height: float) -> None:
    """Set up `ax` as a diagram of `width` by `height` units, without axes, with the origin at the lower left."""
    ax.set_xlim(0.0, width)
    ax.set_ylim(0.0, height)
    ax.set_aspect("equal")
    ax.set_axis_off()


def block(ax: Axes, centre: Point, text: str, width: float = 2.2, height: float = 1.0) -> Part:
    """Draw a block with centred `text`."""
    from matplotlib.patches import Rectangle

    x, y = centre
    corner = (x - width / 2, y - height / 2)
    ax.add_patch(Rectangle(corner, width, height, facecolor="white", edgecolor=BLACK, linewidth=LINE_WIDTH, zorder=3))
    label(ax, centre, text)
    return _part(centre, width / 2, height / 2)


def junction(ax: Axes, centre: Point, *, left: str = "", top: str = "", bottom: str = "") -> Part:
    """Draw a summing junction; `left`, `top` and `bottom` are the signs of the signals that enter on these sides."""
    from matplotlib.patches import Circle

    x, y = centre
    r = JUNCTION_RADIUS
    ax.add_patch(Circle(centre, r, facecolor="white", edgecolor=BLACK, linewidth=LINE_WIDTH, zorder=3))
    for sign, place in (
        (left, (x - 1.9 * r, y - 1.5 * r)),
        (top, (x - 1.2 * r, y + 1.9 * r)),
        (bottom, (x - 1.2 * r, y - 1.9 * r)),
    ):
        if sign:
            label(ax, place, sign)
    return _part(centre, r, r)


def wire(ax: Axes, *points: Point, color: str = BLACK, width: float = LINE_WIDTH) -> None:
    """Draw a line through `points`, `width` points wide."""
    xs, ys = zip(*points, strict=True)
    ax.plot(xs, ys, color=color, linewidth=width, solid_joinstyle="miter", solid_capstyle="butt")


def arrow(ax: Axes, *points: Point, color: str = BLACK, width: float = LINE_WIDTH) -> None:
    """Draw a line through `points`, `width` points wide, with an arrow head at the last one."""
    from matplotlib.patches import FancyArrowPatch

    if len(points) > 2:
        wire(ax, *points[:-1], color=color, width=width)
    head = FancyArrowPatch(
        points[-2],
        points[-1],
        arrowstyle="-|>",
        mutation_scale=14,
        shrinkA=0,
        shrinkB=0,
        color=color,
        linewidth=width,
        joinstyle="miter",
        zorder=2,
    )
    ax.add_patch(head)


def branch(ax: Axes, point: Point) -> None:
    """Draw the dot of a branch point."""
    ax.plot(*point, marker="o", markersize=5, color=BLACK)


def label(ax: Axes, point: Point, text: str, ha: str = "center", va: str = "center") -> None:
    """Write `text` at `point`."""
    ax.text(
        *point,
        text,
        ha=ha,
        va=va,
        fontsize=TEXT_SIZE + 2,
        linespacing=1.5,
        color=BLACK,
        math_fontfamily=FORMULA_FONT,
        zorder=4,
    )


def _part(centre: Point, half_width: float, half_height: float) -> Part:
    x, y = centre
    return Part((x - half_width, y), (x + half_width, y), (x, y + half_height), (x, y - half_height))
