"""Poles and zeros in the plane of z, with their 95 % regions: of a diagnosis, and of an identified model."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from labsid.plots.style import BLACK, BLUE, GREY, SMALL_TEXT_SIZE, VERMILION, finish

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from labsid.model_structures.roots import Root

FARTHEST = 1.6  # from the origin: roots beyond are named, not drawn
AROUND = 1.25  # of the unit circle, shown at least
LEAST_ZOOM = 0.02  # half of the width of the zoom
BESIDE = 1.6  # of the distances of the poles from their middle
NEAR = 0.35  # of the plane: poles that lie closer together are shown in a zoom
STYLES = {"before": (VERMILION, 13.0, 1.6), "after": (BLUE, 7.5, 2.2), "model": (BLUE, 9.0, 2.2)}
"""Colour, size and line width of the markers: those of before stand around those of after."""


class DrawnRoots(NamedTuple):
    """Poles and zeros of a model, with its label and the key of its style."""

    label: str
    style: str
    poles: Sequence[Root]
    zeros: Sequence[Root]


def draw_roots(ax: Axes, models: Sequence[DrawnRoots]) -> None:
    """Draw poles as crosses and zeros as rings, with their 95 % regions and the unit circle.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
    models : sequence of DrawnRoots
        Roots farther from the origin than `FARTHEST` are named below the axes.
    """
    _draw(ax, models)
    seen = [abs(root.value) for one in models for root in (*one.poles, *one.zeros) if abs(root.value) <= FARTHEST]
    side = max([AROUND, *(1.08 * size for size in seen)])
    ax.set(xlim=(-side, side), ylim=(-side, side))
    finish(ax, "Poles × and zeros ○", f"Real part{_far_away(models)}", "Imaginary part", legend_columns=0)


def draw_zoom(ax: Axes, models: Sequence[DrawnRoots]) -> None:
    """Draw the surroundings of the poles in the upper half of the plane."""
    _draw(ax, models)
    at = np.array(_upper_poles(models))
    middle = 0.5 * (at.real.min() + at.real.max()) + 0.5j * (at.imag.min() + at.imag.max())
    spreads = [np.sqrt(np.nanmax(np.diag(root.covariance))) for one in models for root in one.poles if _is_known(root)]
    reach = max(float(np.abs(at - middle).max()), *(3.0 * min(spread, NEAR) for spread in spreads), LEAST_ZOOM / BESIDE)
    side = BESIDE * reach
    ax.set(xlim=(middle.real - side, middle.real + side), ylim=(middle.imag - side, middle.imag + side))
    finish(ax, "The poles, closer", "Real part", "", legend_columns=0)


def has_zoom(models: Sequence[DrawnRoots]) -> bool:
    """Whether the poles lie so close together that a zoom tells more."""
    at = np.array(_upper_poles(models))
    return bool(at.size) and float(np.abs(at - at.mean()).max()) < NEAR


def _upper_poles(models: Sequence[DrawnRoots]) -> list[complex]:
    return [root.value for one in models for root in one.poles if root.value.imag > -1e-9]


def _draw(ax: Axes, models: Sequence[DrawnRoots]) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    ax.plot(np.cos(angle), np.sin(angle), color=GREY, linewidth=1.2)
    for line in (ax.axhline, ax.axvline):
        line(0.0, color=BLACK, linewidth=0.6, zorder=1)
    for one in models:
        colour, size, width = STYLES[one.style]
        for marker, roots in (("x", one.poles), ("o", one.zeros)):
            drawn = [root for root in roots if abs(root.value) <= FARTHEST]
            at = [[root.value.real for root in drawn], [root.value.imag for root in drawn]]
            (marks,) = ax.plot(*at, marker, label=one.label if marker == "x" else "", zorder=3, color=colour)
            marks.set(markersize=size, markeredgewidth=width, markerfacecolor="none")
            for root in drawn:
                if (ellipse := root.ellipse()) is not None:
                    flat = root.covariance[1, 1] == 0.0
                    ax.fill(*ellipse, facecolor=colour, alpha=0.2, linewidth=0)
                    ax.plot(*ellipse, color=colour, linewidth=6.0 if flat else 0.8, alpha=0.2 if flat else 1.0)
    ax.set_aspect("equal", adjustable="box")
    ax.tick_params(labelsize=SMALL_TEXT_SIZE)


def _is_known(root: Root) -> bool:
    return bool(np.isfinite(root.covariance).all())


def _far_away(models: Sequence[DrawnRoots]) -> str:
    """Names the roots that lie outside of the axes."""
    names = [
        f"{kind} {root.value.real:.3g}" + ("" if abs(root.value.imag) < 1e-9 else f"{root.value.imag:+.2g}j")
        for one in models
        for kind, roots in (("pole", one.poles), ("zero", one.zeros))
        for root in roots
        if abs(root.value) > FARTHEST
    ]
    return f"\nnot shown: {', '.join(dict.fromkeys(names))}" if names else ""
