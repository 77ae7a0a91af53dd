"""SVG images of students' figures, drawn from the plain data that the judge receives.

Matplotlib would take 0.1 s per figure in the student's process, longer than the judging. These images take milliseconds
and show what is judged: curves, limits, labels and legend. They contain only numbers and escaped text of the student.
"""

import base64
import html
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from textwrap import wrap

import numpy as np
from numpy.typing import NDArray

from autograder.judge.picture_view import View, figure_words, view_of
from autograder.judge.plain_labels import label_text
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

MAX_AXES = 6
MAX_CURVES = 24
MAX_POINTS = 1200
_WIDTH, _HEIGHT, _FONT = 440, 270, 14
"""Pixels. A telephone shows the image on about 330 of them, with text of 8 pt."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 84, 12, 30, 50
_ROW, _CHARACTER, _SWATCH = 20, 8, 30
"""Pixels: height of a line of the legend, width of a character, and what stands before a name."""
_DASHES = {"--": "7 4", "-.": "8 3 2 3", ":": "2 4"}


def figure_svg(figure: FigureValue) -> str:
    """Draw a figure.

    Parameters
    ----------
    figure : FigureValue

    Returns
    -------
    str
        An SVG image in base64, with the axes one below the other and what is seen in words (`words_of`). Axes without
        a curve and without text are left out; empty if all are.
    """
    axes = [drawn for drawn in figure.axes if drawn.curves or drawn.texts][:MAX_AXES]
    if not axes:
        return ""
    legends = [list(_legend_rows(panel)) for panel in axes]
    heights = [_HEIGHT + _ROW * len(rows) for rows in legends]
    views = [view_of(panel) for panel in axes]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {sum(heights)}" width="{_WIDTH}" '
        f'height="{sum(heights)}" font-family="system-ui, sans-serif" font-size="{_FONT}" fill="#1d2733">',
        f"<desc>{html.escape(_seen(figure_words(axes, views)))}</desc>",
        f'<rect width="{_WIDTH}" height="{sum(heights)}" fill="#fff"/>',
    ]
    for index, (panel, view, rows) in enumerate(zip(axes, views, legends, strict=True)):
        content = "".join((*_panel(panel, view, index), *_legend(rows)))
        parts.append(f'<g transform="translate(0 {sum(heights[:index])})">{content}</g>')
    parts.append("</svg>")
    return base64.b64encode("".join(parts).encode(errors="replace")).decode("ascii")


def words_of(picture: str) -> str:
    """What a picture of `figure_svg` shows, in words; empty if it is none."""
    try:
        content = base64.b64decode(picture).decode(errors="replace")
    except ValueError:
        return ""
    found = re.search(r"<desc>(.*?)</desc>", content, re.DOTALL)
    return html.unescape(found[1]) if found else ""


def _seen(text: str) -> str:
    return "".join(c for c in text if c.isprintable())


@dataclass(frozen=True, slots=True)
class _Scale:
    """Maps values to positions along one axis."""

    low: float
    high: float
    start: float
    end: float

    def position(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        with np.errstate(over="ignore", invalid="ignore"):
            at = self.start + (values - self.low) / (self.high - self.low) * (self.end - self.start)
        return np.where(np.isfinite(values), np.clip(at, -2 * _WIDTH, 3 * _WIDTH), np.nan)

    def ticks(self) -> list[float]:
        low, high = sorted((self.low, self.high))
        rough = (high - low) / 5
        unit = 10.0 ** math.floor(math.log10(rough))
        step = next(unit * factor for factor in (1, 2, 5, 10) if unit * factor >= rough * 0.999)
        first = math.ceil(low / step - 1e-9)
        return [step * k for k in range(first, first + 12) if step * k <= high + 1e-9 * step]


def _scale(limits: tuple[float, float], start: float, end: float) -> _Scale:
    low, high = limits
    usable = math.isfinite(low) and math.isfinite(high) and abs(high - low) > 1e-12 * max(abs(low), abs(high), 1e-200)
    if not usable or not math.isfinite(high - low):
        low, high = 0.0, 1.0
    return _Scale(low, high, start, end)


def _panel(axes: AxesValue, view: View, index: int) -> Iterator[str]:
    x, y = _scale(axes.xlim, _LEFT, _WIDTH - _RIGHT), _scale(view.ylim, _HEIGHT - _BOTTOM, _TOP)
    wide, high = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM
    frame = f'x="{_LEFT}" y="{_TOP}" width="{wide}" height="{high}"'
    yield f'<clipPath id="c{index}"><rect {frame}/></clipPath>'
    line = "#d9e0e7" if axes.grid else "none"
    for value in x.ticks():
        at = float(x.position(np.array([value]))[0])
        yield f'<path d="M{at:.1f} {_TOP}v{high}" stroke="{line}"/>'
        yield _text(f"{value:.6g}", at, _HEIGHT - _BOTTOM + 17, "middle")
    for value in y.ticks():
        at = float(y.position(np.array([value]))[0])
        yield f'<path d="M{_LEFT} {at:.1f}h{wide}" stroke="{line}"/>'
        yield _text(f"{value:.6g}", _LEFT - 5, at + 4, "end")
    yield f'<rect {frame} fill="none" stroke="#5a6b7d"/>'
    yield f'<g clip-path="url(#c{index})" fill="none" stroke-linejoin="round">'
    for curve in axes.curves[:MAX_CURVES]:
        shown = view.shown(curve)
        yield f'<path stroke="{_colour(curve.color)}"{_look(curve)} d="{_path(shown, x, y)}"/>'
    yield "</g>"
    yield _text(axes.title, _WIDTH / 2, 20, "middle", _WIDTH // _CHARACTER)
    yield _text(axes.xlabel, _LEFT + wide / 2, _HEIGHT - 10, "middle", wide // _CHARACTER)
    yield _text(axes.ylabel, 16, _TOP + high / 2, "middle", _HEIGHT // _CHARACTER - 2, turned=True)
    lines = [line for left in view.left for line in wrap(left.text(axes), wide // _CHARACTER - 2)]
    yield '<g stroke="#fff" stroke-width="4" paint-order="stroke">'  # white around the letters, which cross curves
    for row, line in enumerate(lines):
        yield _text(line, _LEFT + 8, _TOP + 18 + _ROW * row, "start", wide // _CHARACTER)
    yield "</g>"


def _are_points(curve: CurveValue) -> bool:
    return not (curve.joined or curve.steps or curve.y.size == 2)


def _look(curve: CurveValue, width: float = 1.5) -> str:
    """Line style of a curve; points are dots."""
    if _are_points(curve):
        return ' stroke-width="5" stroke-linecap="round"'
    dashes = _DASHES.get(curve.style.partition(" ")[0])
    return f' stroke-width="{width:g}"' + (f' stroke-dasharray="{dashes}"' if dashes else "")


def _legend_rows(axes: AxesValue) -> Iterator[list[tuple[float, str, CurveValue | None]]]:
    """The names of curves and other texts in lines below the panel, each with its place."""
    shown = {curve.label: curve for curve in axes.curves if curve.label in axes.legend}
    named = [(label, shown.get(label)) for label in axes.legend[:8]]
    named += [(text, None) for text in axes.texts[: 8 - len(named)]]
    row: list[tuple[float, str, CurveValue | None]] = []
    at = float(_LEFT)
    for label, curve in named:
        width = _SWATCH + _CHARACTER * len(label_text(label, 40)) + 14
        if row and at + width > _WIDTH - _RIGHT:
            yield row
            row, at = [], float(_LEFT)
        row.append((at, label, curve))
        at += width
    if row:
        yield row


def _legend(rows: Sequence[Sequence[tuple[float, str, CurveValue | None]]]) -> Iterator[str]:
    for number, row in enumerate(rows):
        y = _HEIGHT + _ROW * number + 10
        for at, label, curve in row:
            if curve is not None:
                line = f"M{at + 12:.0f} {y - 4}h0" if _are_points(curve) else f"M{at:.0f} {y - 4}h24"
                yield f'<path fill="none" stroke="{_colour(curve.color)}"{_look(curve, 2.0)} d="{line}"/>'
            yield _text(label, at + (_SWATCH if curve is not None else 0), y, "start", 40)


def _path(curve: CurveValue, x: _Scale, y: _Scale) -> str:
    n = min(curve.x.size, curve.y.size)
    rows = _decimated_rows(curve.y[:n])
    at_x, at_y = np.round(x.position(curve.x[rows]), 1), np.round(y.position(curve.y[rows]), 1)
    commands: list[str] = []
    points = _are_points(curve)
    pen = "M"
    last: tuple[float, float] | None = None
    for px, py in zip(at_x.tolist(), at_y.tolist(), strict=True):
        if math.isnan(px) or math.isnan(py):
            pen, last = "M", None
            continue
        if (px, py) == last:
            continue
        if points:
            commands.append(f"M{px:g} {py:g}h0")
        elif curve.steps and last is not None:
            commands.append(f"H{px:g}V{py:g}")
        else:
            commands.append(f"{pen}{px:g} {py:g}")
        pen, last = "L", (px, py)
    return "".join(commands)


def _decimated_rows(y: NDArray[np.float64]) -> NDArray[np.intp]:
    """Indices of all samples, or of the minimum and maximum of each short segment of a long curve."""
    if y.size <= MAX_POINTS:
        return np.arange(y.size)
    finite = np.where(np.isfinite(y), y, 0.0)
    segments = np.array_split(np.arange(y.size), MAX_POINTS // 2)
    ends = [(rows[np.argmin(finite[rows])], rows[np.argmax(finite[rows])]) for rows in segments]
    return np.unique(np.array(ends).reshape(-1))


def _colour(color: Sequence[float]) -> str:
    parts = [int(255 * min(max(part, 0.0), 1.0)) if math.isfinite(part) else 0 for part in color]
    return "#" + "".join(f"{part:02x}" for part in parts)


def _text(text: str, x: float, y: float, anchor: str, longest: int = 20, turned: bool = False) -> str:
    label = html.escape(label_text(text, longest))
    turn = f' transform="rotate(-90 {x:.0f} {y:.0f})"' if turned else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{turn}>{label}</text>' if label else ""
