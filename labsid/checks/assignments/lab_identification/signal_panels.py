"""Checks of the figures of the lab and of the post-lab: panels of signals over time."""

import re
from dataclasses import dataclass
from functools import partial
from string import ascii_lowercase

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import as_figure
from labsid.checks.figures import find_curve, legend_text, require_curve, require_here, require_label, require_legend
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.plots.figure_values import AxesValue, CurveValue


@dataclass(frozen=True, slots=True)
class Panel:
    """Required contents of one panel.

    Attributes
    ----------
    where : str
        Its name in messages: "the upper panel of Fig. 5".
    signals : dict
        Each curve's data by the name of its variable.
    t : tuple of ndarray
        Time vectors against which it may be drawn; the step asks for the first.
    calls : tuple of str
        For each of several signals, a pattern that matches only its legend entries.
    unit : str
        Unit of its signals.
    """

    where: str
    signals: dict[str, FloatArray]
    t: tuple[FloatArray, ...]
    calls: tuple[str, ...] = ()
    unit: str = "V"


def require_panels(name: str, value: Value, panels: tuple[Panel, ...]) -> tuple[AxesValue, ...]:
    """Require a figure with these panels, from top to bottom; return its axes."""
    figure = as_figure(name, value, axes=len(panels))
    if not any(axes.curves for axes in figure.axes):
        raise NoAnswer(f"`{name}` is empty: draw in its axes.", "empty axes")
    if len(panels) == 2 and _shows(figure.axes[0], panels[1]) and _shows(figure.axes[1], panels[0]):
        raise NoAnswer(f"The two panels of `{name}` are swapped.", "panels swapped")
    others = figure.axes[::-1] if len(panels) == 2 else (None,) * len(panels)
    names = [f"ax_{letter}" for letter in ascii_lowercase[: len(panels)]]
    for axes, panel, other_panel, ax in zip(figure.axes, panels, others, names, strict=True):
        curves = [_require_curve(axes, panel, signal) for signal in panel.signals]
        require_here(partial(require_label, where=panel.where, axis="y", unit=panel.unit), axes, other_panel, ax)
        if len(curves) > 1:
            _require_names(axes, panel, curves)
    # panels with a common time axis need its label only once, at the bottom
    require_time = partial(require_label, where=panels[-1].where, axis="x", unit="s")
    require_here(require_time, figure.axes[-1], others[-1], names[-1])
    return figure.axes


def _require_curve(axes: AxesValue, panel: Panel, signal: str) -> CurveValue:
    y = panel.signals[signal]
    for t in panel.t:
        curve = find_curve(axes, y, t)
        if curve is not None:
            return curve
    return require_curve(axes, panel.where, f"`{signal}`", y, panel.t[0], panel.signals)


def _shows(axes: AxesValue, panel: Panel) -> bool:
    return all(find_curve(axes, y) is not None for y in panel.signals.values())


def _require_names(axes: AxesValue, panel: Panel, curves: list[CurveValue]) -> None:
    require_legend(axes, panel.where, len(curves))
    texts = [legend_text(axes, curve) for curve in curves]
    fits = np.array([[bool(re.search(call, text, re.IGNORECASE)) for call in panel.calls] for text in texts])
    swapped = np.argwhere(fits & fits.T & ~np.eye(len(curves), dtype=bool)) if panel.calls else np.empty((0, 2), int)
    for i, j in swapped:
        if not fits[i, i] and not fits[j, j]:
            first, second = list(panel.signals)[i], list(panel.signals)[j]
            raise NoAnswer(
                f"The legend of {panel.where} swaps the names of `{first}` and `{second}`.",
                "legend entries swapped",
            )
