"""What of a figure is shown, and what is seen in words: ranges of the curves, and those that leave their panel."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from string import ascii_lowercase

import numpy as np
from numpy.typing import NDArray

from autograder.judge.plain_labels import label_text
from labsid.plots.figure_values import AxesValue, CurveValue

GROWTH = 10.0
"""A curve grows if its last tenth is that many times as large as its first half."""
BEYOND = 20.0
"""A curve that grows leaves the panel if it is that many times as large as the others."""
MARGIN = 0.3
"""Share of the range of the other curves that is shown above and below them."""
MOST_NAMED = 4
"""Curves of a panel whose values are said."""


@dataclass(frozen=True, slots=True)
class Leaving:
    """A curve that grows without bound and leaves its panel.

    Attributes
    ----------
    curve : CurveValue
    sample : int
        The first outside of the panel.
    """

    curve: CurveValue
    sample: int

    def text(self, axes: AxesValue) -> str:
        """What is written in the panel: ``Simulated output is unstable: it leaves the panel at 12 s``."""
        x = f"{self.curve.x[self.sample]:.4g}"
        unit = re.search(r"\(\s*(\w+)\s*\)\s*$", axes.xlabel)
        at = f"{x} {unit[1]}" if unit else f"{label_text(axes.xlabel.strip(), 40) or 'x'} = {x}"
        return f"{_name(self.curve) or 'A curve'} is unstable: it leaves the panel at {at}"


@dataclass(frozen=True, slots=True)
class View:
    """What of a panel is shown.

    Attributes
    ----------
    ylim : tuple of float
    left : tuple of Leaving
        The curves that leave it.
    """

    ylim: tuple[float, float]
    left: tuple[Leaving, ...]

    def shown(self, curve: CurveValue) -> CurveValue:
        """A curve up to where it leaves the panel."""
        stop = next((left.sample + 1 for left in self.left if left.curve is curve), None)
        return curve if stop is None else replace(curve, x=curve.x[:stop], y=curve.y[:stop])


def view_of(axes: AxesValue) -> View:
    """Limit the vertical axis to the range of the other curves, where some grow without bound.

    Parameters
    ----------
    axes : AxesValue

    Returns
    -------
    View
        With the limits of the figure where no curve grows, or the figure shows less.
    """
    growing = [curve for curve in axes.curves if _grows(curve.y)]
    rest = [curve.y[np.isfinite(curve.y)] for curve in axes.curves if not any(curve is one for one in growing)]
    known = np.concatenate([*rest, np.empty(0)])
    if not growing or not known.size or not np.ptp(known) > 0.0:
        return View(axes.ylim, ())
    low, high = float(known.min()), float(known.max())
    far = [curve for curve in growing if not _size(curve.y) <= BEYOND * max(abs(low), abs(high))]
    shown = (low - MARGIN * (high - low), high + MARGIN * (high - low))
    if not far or not np.isfinite(shown).all():
        return View(axes.ylim, ())
    if 0.0 < axes.ylim[1] - axes.ylim[0] < shown[1] - shown[0]:
        shown = axes.ylim
    return View(shown, tuple(found for curve in far if (found := _leaving(curve, shown)) is not None))


def _size(y: NDArray[np.float64]) -> float:
    return float(np.max(np.abs(y), initial=0.0)) if np.isfinite(y).all() else np.inf


def _grows(y: NDArray[np.float64]) -> bool:
    """Whether the end of a signal is far larger than its first half, or is no number any more."""
    if y.size < 20:
        return False
    first, last = y[: y.size // 2], y[-(y.size // 10) :]
    if not np.isfinite(first[:2]).all():
        return False
    with np.errstate(over="ignore"):
        return not _size(last) <= GROWTH * float(np.max(np.abs(first[np.isfinite(first)])))


def _leaving(curve: CurveValue, ylim: tuple[float, float]) -> Leaving | None:
    y = curve.y[: curve.x.size]
    outside = np.flatnonzero(~((y >= ylim[0]) & (y <= ylim[1])))
    return Leaving(curve, int(outside[0])) if outside.size else None


def figure_words(panels: Sequence[AxesValue], views: Sequence[View]) -> str:
    """What a figure shows, in a sentence or two for each panel.

    Parameters
    ----------
    panels : sequence of AxesValue
    views : sequence of View
        What is shown of each.

    Returns
    -------
    str
        Axes, ranges of the first curves, how far each is from the first, and which leave the panel.
    """
    said = (" ".join(_panel_words(axes, view)) for axes, view in zip(panels, views, strict=True))
    if len(panels) == 1:
        return next(said)
    return " ".join(f"({ascii_lowercase[number]}) {words}" for number, words in enumerate(said))


def _panel_words(axes: AxesValue, view: View) -> Iterator[str]:
    named = [curve for curve in axes.curves if curve.y.size and np.isfinite(curve.y).any()][:MOST_NAMED]
    bounded = [curve for curve in named if not any(curve is left.curve for left in view.left)]
    over = " over ".join(label_text(label, 40) for label in (axes.ylabel, axes.xlabel) if label.strip())
    over = over or "Axes without labels"
    parts = [_range_words(curve, bounded[0]) for curve in bounded]
    yield f"{over}: {'; '.join(parts)}." if parts else f"{over}."
    for left in view.left:
        yield f"{left.text(axes)}."


def _name(curve: CurveValue) -> str:
    return "" if curve.label.startswith("_") else label_text(curve.label.strip(), 40)


def _range_words(curve: CurveValue, first: CurveValue) -> str:
    known = curve.y[np.isfinite(curve.y)]
    words = f"{_name(curve) or 'a curve'} from {known.min():.3g} to {known.max():.3g}"
    if curve is first or curve.y.shape != first.y.shape or not np.array_equal(curve.x, first.x):
        return words
    with np.errstate(over="ignore", invalid="ignore"):
        apart = float(np.sqrt(np.mean((curve.y - first.y) ** 2)))
    return f"{words}, {apart:.2g} rms from the first" if np.isfinite(apart) else words
