"""A sketch of the rig: computer, pump, two tanks, level sensor and reservoir."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labsid.plots.diagrams import LINE_WIDTH, Point, arrow, block, label, show_as_diagram, wire
from labsid.plots.style import BLACK, BLUE, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ALT_TEXT = (
    "Sketch of the rig. A computer with the controller sends the voltage u to a pump, which lifts water from a "
    "reservoir at the bottom into the upper tank. The upper tank drains into the lower tank, and the lower tank into "
    "the reservoir. A level sensor at the lower tank sends the voltage y to the computer."
)

WATER = "#BAD9EA"  # BLUE, mixed with white
STREAM_WIDTH = 3.0  # points; a signal has LINE_WIDTH


def sketch_rig() -> Figure:
    """Draw the rig of the lab: a pump fills the upper of two tanks, and a sensor measures the level of the lower one.

    Returns
    -------
    matplotlib.figure.Figure
        Water is drawn in thick blue lines, signals in thin black ones. A notebook shows it with `ALT_TEXT` as its
        alternative text.
    """
    from matplotlib.patches import Circle

    figure = new_figure(7.0, 4.7, alt=ALT_TEXT)
    ax = figure.add_subplot()
    show_as_diagram(ax, 11.4, 7.7)
    for corner, width, height, level, name in (
        ((5.6, 4.5), 2.4, 1.7, 0.9, "Upper tank"),
        ((5.6, 2.1), 2.4, 1.7, 1.1, "Lower tank"),
        ((3.4, 0.15), 5.2, 1.2, 0.8, "Reservoir"),
    ):
        _tank(ax, corner, width, height, level)
        label(ax, (6.8, corner[1] + level / 2), name)
    middle = 6.8
    _stream(ax, (4.2, 0.5), (4.2, 1.88))
    _stream(ax, (4.2, 3.1), (4.2, 6.7), (middle, 6.7), (middle, 5.6))
    _stream(ax, (middle, 4.5), (middle, 3.4))
    _stream(ax, (middle, 2.1), (middle, 1.15))
    ax.add_patch(Circle((4.2, 2.5), 0.6, facecolor="white", edgecolor=BLACK, linewidth=LINE_WIDTH, zorder=3))
    label(ax, (4.2, 2.5), "Pump")
    computer = block(ax, (1.6, 4.7), "Computer\n(controller)", width=2.6, height=1.4)
    sensor = block(ax, (9.9, 2.6), "Level\nsensor", width=1.8, height=1.3)
    wire(ax, (8.0, 2.6), sensor.left)
    arrow(ax, computer.bottom, (computer.bottom[0], 2.5), (3.6, 2.5))
    arrow(ax, sensor.top, (sensor.top[0], 7.4), (computer.top[0], 7.4), computer.top)
    label(ax, (2.6, 2.95), "$u$ (V)")
    label(ax, (10.5, 4.7), "$y$ (V)")
    return figure


def _tank(ax: Axes, corner: Point, width: float, height: float, level: float) -> None:
    """Draw an open tank with its lower left at `corner`, filled up to `level`."""
    from matplotlib.patches import Rectangle

    x, y = corner
    ax.add_patch(Rectangle(corner, width, level, facecolor=WATER, edgecolor="none", zorder=1))
    wire(ax, (x, y + height), (x, y), (x + width, y), (x + width, y + height))


def _stream(ax: Axes, *points: Point) -> None:
    """Draw water that flows through `points`, with an arrow head at the last one."""
    arrow(ax, *points, color=BLUE, width=STREAM_WIDTH)
