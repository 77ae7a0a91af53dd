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
from unicodedata import lookup

import numpy as np
from numpy.typing import NDArray

from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

MAX_AXES = 6
MAX_CURVES = 24
MAX_POINTS = 1200
_WIDTH, _HEIGHT = 640, 250
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 12, 26, 42
_SYMBOLS = {
    "lambda": "λ",  # its name in Unicode is LAMDA
    "Lambda": "Λ",
    "varphi": "φ",
    "varepsilon": "ε",
    "vartheta": "ϑ",
    "cdot": "·",
    "times": "×",
    "pm": "±",
    "le": "≤",
    "leq": "≤",
    "ge": "≥",
    "geq": "≥",
    "ne": "≠",
    "neq": "≠",
    "approx": "≈",
    "infty": "∞",
    "circ": "°",
    "prime": "′",
    "sum": "Σ",
    "partial": "∂",
    "sqrt": "√",
    "rightarrow": "→",
    "to": "→",
}
"""Signs of TeX commands that are not Greek letters by their name in Unicode."""
_STYLE = re.compile(
    "(wide)?(hat|tilde)|bar|overline|d?dot|vec|left|right|math(rm|bf|it|sf|tt|cal|bb|regular)|operatorname|"
    "text(rm|bf|it)?|rm|bf|it|q?quad|displaystyle"
)
"""TeX commands that set how the text after them looks."""


def figure_svg(figure: FigureValue) -> str:
    """Draw a figure.

    Parameters
    ----------
    figure : FigureValue

    Returns
    -------
    str
        An SVG image in base64, with the axes one below the other. Axes without a curve and without text are left out;
        empty if all are.
    """
    axes = [drawn for drawn in figure.axes if drawn.curves or drawn.texts][:MAX_AXES]
    if not axes:
        return ""
    height = len(axes) * _HEIGHT
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" width="{_WIDTH}" height="{height}" '
        'font-family="system-ui, sans-serif" font-size="12" fill="#1d2733">',
        f'<rect width="{_WIDTH}" height="{height}" fill="#fff"/>',
    ]
    for index, panel in enumerate(axes):
        parts.append(f'<g transform="translate(0 {index * _HEIGHT})">{"".join(_panel(panel, index))}</g>')
    parts.append("</svg>")
    return base64.b64encode("".join(parts).encode(errors="replace")).decode("ascii")


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


def _panel(axes: AxesValue, index: int) -> Iterator[str]:
    x, y = _scale(axes.xlim, _LEFT, _WIDTH - _RIGHT), _scale(axes.ylim, _HEIGHT - _BOTTOM, _TOP)
    wide, high = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM
    frame = f'x="{_LEFT}" y="{_TOP}" width="{wide}" height="{high}"'
    yield f'<clipPath id="c{index}"><rect {frame}/></clipPath>'
    line = "#d9e0e7" if axes.grid else "none"
    for value in x.ticks():
        at = float(x.position(np.array([value]))[0])
        yield f'<path d="M{at:.1f} {_TOP}v{high}" stroke="{line}"/>'
        yield _text(f"{value:.6g}", at, _HEIGHT - _BOTTOM + 15, "middle")
    for value in y.ticks():
        at = float(y.position(np.array([value]))[0])
        yield f'<path d="M{_LEFT} {at:.1f}h{wide}" stroke="{line}"/>'
        yield _text(f"{value:.6g}", _LEFT - 5, at + 4, "end")
    yield f'<rect {frame} fill="none" stroke="#5a6b7d"/>'
    yield f'<g clip-path="url(#c{index})" fill="none" stroke-width="1.5" stroke-linejoin="round">'
    for curve in axes.curves[:MAX_CURVES]:
        yield f'<path stroke="{_colour(curve.color)}" d="{_path(curve, x, y)}"/>'
    yield "</g>"
    yield _text(axes.title, _WIDTH / 2, 17, "middle", 70)
    yield _text(axes.xlabel, _LEFT + wide / 2, _HEIGHT - 8, "middle", 70)
    yield _text(axes.ylabel, 14, _TOP + high / 2, "middle", 34, turned=True)
    yield from _legend(axes)


def _legend(axes: AxesValue) -> Iterator[str]:
    shown = {curve.label: curve.color for curve in axes.curves if curve.label in axes.legend}
    lines = [(label, shown.get(label)) for label in axes.legend[:8]]
    lines += [(text, None) for text in axes.texts[: 8 - len(lines)]]
    longest = max((len(_label_text(label, 40)) for label, _ in lines), default=0)
    x_left = _WIDTH - _RIGHT - 40 - 7 * longest
    if lines:
        yield (
            f'<rect x="{x_left:.0f}" y="{_TOP + 5}" width="{34 + 7 * longest:.0f}" height="{16 * len(lines) + 5}" '
            'fill="#fff" fill-opacity=".85" stroke="#d9e0e7"/>'
        )
    for row, (label, colour) in enumerate(lines):
        at = _TOP + 20 + 16 * row
        if colour is not None:
            yield f'<path d="M{x_left + 5:.0f} {at - 4}h18" stroke="{_colour(colour)}" stroke-width="2"/>'
        yield _text(label, x_left + 28, at, "start", 40)


def _path(curve: CurveValue, x: _Scale, y: _Scale) -> str:
    n = min(curve.x.size, curve.y.size)
    rows = _decimated_rows(curve.y[:n])
    at_x, at_y = np.round(x.position(curve.x[rows]), 1), np.round(y.position(curve.y[rows]), 1)
    commands: list[str] = []
    pen = "M"
    last: tuple[float, float] | None = None
    for px, py in zip(at_x.tolist(), at_y.tolist(), strict=True):
        if math.isnan(px) or math.isnan(py):
            pen, last = "M", None
            continue
        if (px, py) == last:
            continue
        if curve.steps and last is not None:
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
    label = html.escape(_label_text(text, longest))
    turn = f' transform="rotate(-90 {x:.0f} {y:.0f})"' if turned else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{turn}>{label}</text>' if label else ""


def _label_text(text: str, longest: int) -> str:
    """Text without TeX markup and control characters, shortened to `longest` characters."""
    text = re.sub(r"\\(?:([A-Za-z]+)|(.))", _sign, text) if "$" in text else text
    text = text.replace("$", "")
    text = "".join(c for c in re.sub(r"[{}]", "", text) if c.isprintable())
    return text if len(text) <= longest else text[: longest - 1] + "…"


def _sign(command: re.Match[str]) -> str:
    """What a TeX command stands for in plain text; its name where that is not known, as for ``\\sin``."""
    name, mark = command.groups()
    if name is None:
        return " " if mark in ",;: " else "" if mark == "!" else mark
    if _STYLE.fullmatch(name):
        return ""
    if name in _SYMBOLS:
        return _SYMBOLS[name]
    try:
        return lookup(f"GREEK {'CAPITAL' if name[0].isupper() else 'SMALL'} LETTER {name}")
    except KeyError:
        return name
