"""Checks of the two panels of Fig. 1."""

import re

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import kind_of
from labsid.checks.figures import (
    find_curve,
    plain_text,
    require_curve,
    require_grid,
    require_here,
    require_labels,
    require_legend,
    require_limits,
)
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue
from labsid.plots.style import GREY_BLUE

SAME_COLOUR = 0.02
"""Largest difference of a colour component: (153, 179, 204)/255 is the lab's (0.6, 0.7, 0.8)."""
DISTINCT_COLOURS = 0.25
"""Smallest difference of a colour component between two colours that a reader can distinguish."""


def panels(value: Value) -> tuple[AxesValue, ...]:
    """The axes of `fig_1`, from top to bottom."""
    if not isinstance(value, FigureValue):
        raise NoAnswer(
            f"`fig_1` should be the figure itself, as `plt.subplots` returns it; it is {kind_of(value)}.",
            "not the figure",
        )
    if not value.axes:
        raise NoAnswer("`fig_1` is empty: draw in its axes, `ax_a` and `ax_b`.", "empty axes")
    return value.axes


def require_panel(
    axes: AxesValue,
    where: str,
    t: FloatArray,
    signals: dict[str, FloatArray],
    title: str,
    beside: AxesValue | None = None,
) -> None:
    """Require a panel as in Fig. 1; `signals` holds the sine first, then the cosine, and `beside` is the other "
    "panel."""
    ax = "ax_a" if "(a)" in where else "ax_b"
    if not axes.curves:
        raise NoAnswer(
            f"There is no curve in {where} yet, the axes `{ax}` of `fig_1`: draw with `{ax}.plot` and `{ax}.step`. "
            "(`plt.figure` and `plt.subplots` begin another figure.)",
            "empty axes",
        )
    (sine_name, sine_data), (cosine_name, cosine_data) = signals.items()
    sine = require_curve(axes, where, f"`{sine_name}`", sine_data, t, signals)
    cosine = require_curve(axes, where, f"`{cosine_name}`", cosine_data, t, signals)
    _require_colours(where, sine, cosine)
    if not cosine.steps:
        raise NoAnswer(
            f'In {where} straight lines join the cosine. For MATLAB\'s `stairs`, use `step(..., where="post")`.',
            "plot in place of stairs",
        )
    if cosine.where != "post":
        raise NoAnswer(
            f'In {where} the cosine changes before its sample, not at it: use `step(..., where="post")`.',
            "step before the sample",
        )
    require_here(lambda panel: require_limits(panel, where, (0, 140), (-1.5, 1.5)), axes, beside, ax)
    require_here(lambda panel: _require_title(panel, where, title), axes, beside, ax)
    require_here(lambda panel: require_grid(panel, where), axes, beside, ax)
    require_here(lambda panel: require_labels(panel, where, ("s", "")), axes, beside, ax)
    require_here(lambda panel: require_legend(panel, where, 2), axes, beside, ax)
    _require_names(axes, where, sine, cosine)


def _require_title(axes: AxesValue, where: str, title: str) -> None:
    if not re.search(title, axes.title, re.IGNORECASE):
        raise NoAnswer(f"The title of {where} is {axes.title!r}; see the step for the title it should have.", "title")


def shows(axes: AxesValue, y: FloatArray, t: FloatArray | None = None) -> bool:
    """Whether a panel draws `y` (against `t`)."""
    return find_curve(axes, y, t) is not None


def _require_colours(where: str, sine: CurveValue, cosine: CurveValue) -> None:
    if _distance(cosine.color, GREY_BLUE) > SAME_COLOUR:
        if _distance(sine.color, GREY_BLUE) <= SAME_COLOUR:
            raise NoAnswer(
                f"In {where} the sine is grey-blue: give this colour to the cosine instead.", "colours swapped"
            )
        raise NoAnswer(
            f"In {where} the cosine should have the RGB code (0.6, 0.7, 0.8): use `color=(0.6, 0.7, 0.8)`.",
            "colour",
        )
    if _distance(sine.color, cosine.color) < DISTINCT_COLOURS:
        raise NoAnswer(f"In {where} the two curves are hard to distinguish: give the sine another colour.", "colour")


def _require_names(axes: AxesValue, where: str, sine: CurveValue, cosine: CurveValue) -> None:
    entries = [plain_text(text) for text in axes.legend]
    for name in ("sin", "cos"):
        named = [text for text in entries if name in text]
        if not named:
            raise NoAnswer(f"The legend of {where} has no entry {name}(0.02πt).", "legend")
        if not any("π" in text or "pi" in text for text in named):
            raise NoAnswer(
                f"The legend of {where} names a curve {named[0]!r}; the name asked for is {name}(0.02πt), in full.",
                "legend",
            )
        if not any("π" in text for text in named):
            raise NoAnswer(
                f"The legend of {where} spells the Greek letter out: write it as `$\\pi$` or copy π.",
                "Greek letter spelt out",
            )
    # curves carry no labels if `legend` itself was given the texts; matplotlib then uses the order drawn
    if "cos" in plain_text(sine.label) or "sin" in plain_text(cosine.label):
        raise NoAnswer(f"The legend of {where} labels the sine as a cosine: swap the labels.", "legend entries swapped")


def _distance(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    return float(np.max(np.abs(np.subtract(a, b))))
