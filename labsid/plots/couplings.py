"""Figure of the couplings: which input moves which output, and at which signals effects act."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labsid.plots.page_figures import NARROW, WIDE, page_figure
from labsid.plots.signal_names import as_text_lines, fitted
from labsid.plots.signals import effect_title, effects_at
from labsid.plots.style import BLACK, BLUE, GREY, SMALL_TEXT_SIZE, TEXT_SIZE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LINE = 0.19  # inches of a line of text
CHARACTERS = 11.0  # an inch
LINES = (2, 5)  # of a name, and of the effects below it
MIN_SHARE = 0.005  # drawn as coupling
WIDEST = 2.1  # inches of a cell
UPRIGHT = 0.9  # inches of a cell, below which the names of the inputs stand upright
TALL = 2.6  # inches of an upright name
DARKEST = 0.6  # opacity of a cell with a share of one: its text is readable on it, and in inverted colours


def figure_couplings(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the shares of each output's response to every input, with the effects under the names of their signals.

    Parameters
    ----------
    report : dict
        `title` of an effect is its name in the figure.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
        A row is an output, a column an input; the shares of a row add up to 100 %.
    """
    inputs, outputs = ([one["name"] for one in report["signals"][kind]] for kind in ("inputs", "outputs"))
    width, left = (NARROW - 0.1, 1.3) if narrow else (WIDE - 0.1, 2.6)
    cell = min((width - left) / len(inputs), WIDEST)
    upright = cell < UPRIGHT
    above = [_named(report, name, "input", *((TALL, (1, 1)) if upright else (cell, LINES))) for name in inputs]
    beside = [_named(report, name, "output", left, LINES) for name in outputs]
    lines = [text["s"].split("\n") for text in above]
    longest = max(len(line) for own in lines for line in own)
    top = (longest / CHARACTERS if upright else LINE * max(len(own) for own in lines)) + 0.25
    rows = [max(LINE * (text["s"].count("\n") + 1) + 0.2, 0.55) for text in beside]
    height = top + sum(rows)
    figure = page_figure(narrow, height + 0.12, height + 0.12)
    ax = figure.subplots()
    spare = (width - left - cell * len(inputs)) / 2.0
    ax.set(xlim=(-spare, width - spare), ylim=(height + 0.02, 0.0))
    ax.set_axis_off()
    for i, text in enumerate(above):
        ax.text(left + (i + 0.5) * cell, top - 0.1, **text, ha="center", va="bottom", rotation=90.0 if upright else 0.0)
    shares = {(one["from"], one["to"]): one["share"] for one in report["couplings"]}
    at = top
    for output, text, row in zip(outputs, beside, rows, strict=True):
        ax.text(left - 0.12, at + row / 2.0, **text, ha="right", va="center")
        for i, name in enumerate(inputs):
            _draw_share(ax, (left + i * cell, at), (cell, row), shares.get((name, output), 0.0))
        at += row
    return figure


def _named(report: dict[str, Any], name: str, kind: str, width: float, most: tuple[int, int]) -> dict[str, Any]:
    """Text and colour of a signal with the effects that act there: blue if there are any."""
    characters = max(int(width * CHARACTERS), 4)
    effects = "; ".join(effect_title(effect) for effect in effects_at(report, name, kind))
    lines = [*fitted(name, characters, most[0]), *(fitted(effects, characters, most[1]) if effects else [])]
    return {"s": as_text_lines(lines), "color": BLUE if effects else BLACK, "fontsize": SMALL_TEXT_SIZE}


def _draw_share(ax: Axes, corner: tuple[float, float], size: tuple[float, float], share: float) -> None:
    """Draw a cell with its share, the darker the larger."""
    from matplotlib.patches import Rectangle

    alpha = DARKEST * share if share >= MIN_SHARE else 0.0
    ax.add_patch(Rectangle(corner, *size, facecolor=(BLUE, alpha), edgecolor=GREY, linewidth=0.8))
    x, y = (start + 0.5 * along for start, along in zip(corner, size, strict=True))
    text = f"{100.0 * share:.0f} %" if share >= MIN_SHARE else "–"
    ax.text(x, y, text, ha="center", va="center", color=BLACK, fontsize=TEXT_SIZE)
