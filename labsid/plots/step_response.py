"""Fig. A1 and A2 of the lab's appendix: a first-order model read off a step response, and its accuracy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signals
from labsid.plots.diagrams import FORMULA_FONT, arrow, block, branch, label, show_as_diagram
from labsid.plots.style import (
    BLACK,
    BLUE,
    GREY,
    TEXT_SIZE,
    TIME,
    VERMILION,
    Corner,
    finish,
    new_figure,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Transform

    from labsid.lab.step_comparison import StepComparison
    from labsid.lab.step_response import StepResponseFit

SHARE_283, SHARE_632 = 1 - np.exp(-1 / 3), 1 - np.exp(-1)


def figure_a1(t: ArrayLike, y: ArrayLike, fit: StepResponseFit) -> Figure:
    """Draw Fig. A1: the graphical construction of gain, time constant and delay from a step response.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds, zero at the instant of the step.
    y : array_like, shape (N,)
        Recorded response in volts.
    fit : StepResponseFit
        From `labsid.lab.step_response.fit_step_response` on the same samples; its `reading` is drawn.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If the length of t and y differs from that of the fit.

    Notes
    -----
    UNSW lab, appendix, Fig. A1. With the step at t = 0, a first-order response with delay reaches 63.2 % of its final
    change at td + tau and 28.3 % at td + tau/3.
    """
    # Imported here because it loads scipy's optimiser, which the other figures do not need.
    from labsid.lab.step_response import first_order_response

    t, y = as_signals(t=t, y=y)
    if y.size != fit.y_fit.size:
        raise ValueError(
            f"t and y must be the samples that were fitted, {fit.y_fit.size} of them; got {y.size}. "
            "Pass the t and y given to fit_step_response."
        )
    low, change = fit.y_initial, fit.y_final - fit.y_initial
    figure = new_figure(8.0, 5.2)
    ax = figure.add_subplot()
    ax.plot(t, y, color=BLACK, linewidth=1.2, label="Response")
    y_read = low + first_order_response(fit.reading, t, fit.amplitude)
    ax.plot(t, y_read, color=BLUE, linestyle="--", linewidth=1.8, label="First-order model, as read")
    ax.set_xlim(t[0], t[-1])
    # Leave room below the initial level for the arrows, and above all curves for the legend.
    way = (y - low) / change
    ax.set_ylim(*sorted((low + min(-0.25, way.min()) * change, low + (way.max() + 0.2) * change)))

    _draw_construction(ax, fit, t[0], t[-1])
    _write_values(ax, fit)
    title = f"Response to a step of $a$ = {_number(fit.amplitude)} V at $t$ = 0"
    place: Corner = "upper right" if change > 0 else "lower right"
    finish(ax, title, TIME, "Output (V)", legend_columns=2, legend_place=place)
    return figure


def figure_a2(comparison: StepComparison) -> Figure:
    """Draw Fig. A2: (a) the block diagram of the simulation, (b) the original and the approximate response.

    Parameters
    ----------
    comparison : StepComparison
        From `labsid.lab.step_comparison.compare_with_approximation`.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, appendix, Fig. A2. The lab does not state the coefficients of its original system.
    """
    fit = comparison.fit
    figure = new_figure(8.0, 7.0)
    upper, lower = figure.subplots(2, 1, height_ratios=(1, 1.25))
    show_as_diagram(upper, 11.0, 4.4)
    original, approximate, middle = 3.3, 0.9, 2.1
    step = block(upper, (1.2, middle), f"Step\n$a$ = {_number(fit.amplitude)} V", width=2.0, height=1.4)
    plant_tf = rf"$\dfrac{{{_polynomial(comparison.plant.num)}}}{{{_polynomial(comparison.plant.den)}}}$"
    plant = block(upper, (5.4, original), plant_tf, width=3.6, height=1.6)
    model = fit.model
    denominator = _polynomial(np.array([model.tau, 1.0]))
    model_tf = rf"$\dfrac{{{model.K:.3g}}}{{{denominator}}}\,e^{{-{model.td:.3g}s}}$"
    first_order = block(upper, (5.4, approximate), model_tf, width=3.6, height=1.6)
    scope = block(upper, (9.9, middle), "Scope", width=1.6, height=1.4)
    arrow(upper, step.right, (2.9, middle), (2.9, original), plant.left)
    arrow(upper, (2.9, middle), (2.9, approximate), first_order.left)
    branch(upper, (2.9, middle))
    arrow(upper, plant.right, (8.2, original), (8.2, middle + 0.35), (scope.left[0], middle + 0.35))
    arrow(upper, first_order.right, (8.2, approximate), (8.2, middle - 0.35), (scope.left[0], middle - 0.35))
    label(upper, (7.7, original + 0.35), "$y$")
    label(upper, (7.7, approximate + 0.4), r"$\hat{y}$")
    upper.set_title("(a) Simulation: original system above, approximate model below", fontsize=TEXT_SIZE)

    lower.plot(comparison.t, comparison.y_original, color=BLACK, linewidth=1.4, label="Original system, $y$")
    lower.plot(
        comparison.t,
        comparison.y_approximate,
        color=BLUE,
        linestyle="--",
        linewidth=1.8,
        label=r"Approximate first-order model, $\hat{y}$",
    )
    lower.margins(x=0)
    title = f"(b) Step responses, at most {100 * comparison.largest_error:.1f} % of the final level apart"
    place: Corner = "lower right" if model.K * fit.amplitude > 0 else "upper right"
    finish(lower, title, TIME, "Output (V)", legend_place=place)
    return figure


def _draw_construction(ax: Axes, fit: StepResponseFit, t_first: float, t_last: float) -> None:
    """Mark the levels of 0, 28.3, 63.2 and 100 %, and draw arrows for delay, time constant and change."""
    low, change, td = fit.y_initial, fit.y_final - fit.y_initial, fit.reading.td
    arrows_at, names_at = low - 0.08 * change, low - 0.11 * change
    beyond = "top" if change > 0 else "bottom"
    for share, time in ((0.0, None), (SHARE_283, fit.t_283), (SHARE_632, fit.t_632), (1.0, None)):
        level = low + share * change
        ax.axhline(level, color=VERMILION, linewidth=1.0, linestyle=":", zorder=1)
        _note(ax, 1.01, level, f"{100 * share:.3g} %", "left", "center", transform=ax.get_yaxis_transform())
        if time is not None:
            ax.plot([time, time], [level, arrows_at], color=VERMILION, linewidth=1.0, linestyle=":")
            ax.plot(time, level, marker="o", markersize=6, color=VERMILION)
    _span(ax, (td, arrows_at), (fit.t_632, arrows_at))
    _note(ax, (td + fit.t_632) / 2, names_at, r"$\tau$", "center", beyond)
    # A delay too short for a double-headed arrow is stated only in the box.
    if td > 0.025 * (t_last - t_first):
        _span(ax, (0.0, arrows_at), (td, arrows_at))
        _note(ax, td / 2, names_at, "$t_d$", "center", beyond)
    beside = fit.t_632 + 0.4 * (t_last - fit.t_632)
    _span(ax, (beside, low), (beside, low + change))
    name_at = beside + 0.015 * (t_last - t_first)
    _note(ax, name_at, low + 0.46 * change, f"$K a$ = {_number(change)} V", "left", "center")


def _write_values(ax: Axes, fit: StepResponseFit) -> None:
    """Write gain, time constant and delay in a box between the first two levels."""
    K, tau, td = (_number(value) for value in (fit.reading.K, fit.reading.tau, fit.reading.td))
    ax.text(
        0.98,
        fit.y_initial + SHARE_283 / 2 * (fit.y_final - fit.y_initial),
        f"$K$ = {K} V/V\n$\\tau$ = {tau} s\n$t_d$ = {td} s",
        transform=ax.get_yaxis_transform(),
        ha="right",
        va="center",
        fontsize=TEXT_SIZE,
        math_fontfamily=FORMULA_FONT,
        multialignment="left",
        linespacing=1.25,
        bbox={"boxstyle": "round", "facecolor": "white", "edgecolor": GREY},
    )


def _span(ax: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Draw a double-headed dimension arrow."""
    from matplotlib.patches import FancyArrowPatch

    ax.add_patch(
        FancyArrowPatch(
            start,
            end,
            arrowstyle="<|-|>",
            mutation_scale=9,
            shrinkA=0,
            shrinkB=0,
            color=VERMILION,
            linewidth=1.2,
        )
    )


def _note(ax: Axes, x: float, y: float, text: str, ha: str, va: str, transform: Transform | None = None) -> None:
    ax.text(
        x,
        y,
        text,
        ha=ha,
        va=va,
        transform=transform or ax.transData,
        fontsize=TEXT_SIZE + 1,
        color=VERMILION,
        math_fontfamily=FORMULA_FONT,
    )


def _number(value: float) -> str:
    return f"{value:.3g}".replace("-", "−")


def _polynomial(coefficients: FloatArray) -> str:
    """Format descending powers of s as mathtext, omitting coefficients of one."""
    order = len(coefficients) - 1
    terms = []
    for power, coefficient in zip(range(order, -1, -1), coefficients, strict=True):
        factor = "" if coefficient == 1 and power else f"{coefficient:.3g}"
        terms.append(factor + {0: "", 1: "s"}.get(power, f"s^{power}"))
    return " + ".join(terms)
