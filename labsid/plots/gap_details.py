"""Figures of what an effect does, and of what is left in the error."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from labsid.plots.gap_curves import noise_band, simulation_curves
from labsid.plots.page_figures import NARROW, page_figure
from labsid.plots.root_plane import DrawnRoots, draw_roots, draw_zoom, has_zoom
from labsid.plots.signal_names import as_text_lines, fitted, name_of, one_line, unit_of
from labsid.plots.style import BLACK, BLUE, GREEN, GREY, SMALL_TEXT_SIZE, VERMILION, axis_of_gain, finish, new_figure

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARGIN = 0.3  # of the range of the curves, above and below them
VISITS = 0.16  # of the height, for the histogram of the visits
CELLS = 60  # of this histogram
FEW_TICKS = 6  # most intervals between ticks: numbers of six digits do not touch
LONGEST_LABEL = 36  # characters of a line of a label
LONGEST_OF_PAIR = 14  # characters of a name above a panel of a pair


def figure_effect(shown: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw what an effect does, beside what a simulation without it assumes.

    Parameters
    ----------
    shown : dict
        As `effect_curves.effect_curve` returns it.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
        With the 95 % error of the curve and of its places, and at the bottom how often the record is at each value.
    """
    figure = new_figure(*((NARROW, 3.0) if narrow else (5.4, 3.1)))
    ax = figure.subplots()
    x, curve, band = shown["x"], shown["curve"], shown["band"]
    ax.plot(x, shown["plain"], color=VERMILION, linestyle="--", linewidth=1.4, label="Without")
    ax.fill_between(x, curve - band, curve + band, color=BLUE, alpha=0.2, linewidth=0)
    ax.plot(x, curve, color=BLUE, linewidth=2.2, label="With the effect")
    for place, error in shown["marks"]:
        ax.axvspan(place - error, place + error, color=BLUE, alpha=0.2, linewidth=0)
        ax.axvline(place, color=BLUE, linestyle=":", linewidth=1.2)
    ax.set_xlim(float(np.min(x)), float(np.max(x)))
    low, high = float(np.min([curve, shown["plain"]])), float(np.max([curve, shown["plain"]]))
    margin = MARGIN * ((high - low) or 1.0)
    ax.set_ylim(low - margin, high + margin)
    _draw_visits(ax, shown["visits"])
    across, label = (as_text_lines(wrap(text, LONGEST_LABEL)) for text in shown["labels"])
    finish(ax, "", across, label, legend_columns=0)
    figure.legend(loc="outside upper center", ncols=2 if narrow else 3, fontsize=SMALL_TEXT_SIZE)
    for axis in (ax.xaxis, ax.yaxis):
        axis.label.set_fontsize(SMALL_TEXT_SIZE)
    ax.locator_params(axis="x", nbins=FEW_TICKS)
    return figure


def _draw_visits(ax: Axes, visits: np.ndarray) -> None:
    """Draw along the bottom how often the record is at each value."""
    visits = visits[np.isfinite(visits)]
    if not visits.size:
        return
    count, edges = np.histogram(visits, CELLS, ax.get_xlim())
    height = VISITS * count / max(int(count.max()), 1)
    ax.stairs(height, edges, fill=True, color=GREY, alpha=0.8, transform=ax.get_xaxis_transform(), label="Visits")


def figure_residual(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the residual tests with their bands, and the spectra of the errors.

    Parameters
    ----------
    report : dict
        Its `residual` is what `residual_curves.find_residual_curves` returns.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
    """
    residual = report["residual"]
    figure = page_figure(narrow, 3.4, 7.9)
    panels = figure.subplots(3, 1) if narrow else figure.subplots(1, 3)
    for ax, correlation, title in (
        (panels[0], residual.autocorrelation, "Autocorrelation"),
        (panels[1], residual.with_input, _with_name(report, "Correlation with the input")),
    ):
        ax.axhspan(-correlation.band, correlation.band, color=GREEN, alpha=0.2, linewidth=0)
        ax.vlines(correlation.lags, 0.0, correlation.values, color=BLUE, linewidth=2.0)
        ax.axhline(0.0, color=BLACK, linewidth=0.8)
        finish(ax, title, "Lag (samples)", "", legend_columns=0)
    ax = panels[2]
    same = np.array_equal(residual.before, residual.after)
    if not same:
        ax.plot(residual.frequency, residual.before, color=VERMILION, linestyle="--", label="Before")
    ax.plot(residual.frequency, residual.after, color=BLUE, label="Simulated" if same else "After")
    noise, name = noise_band(report)
    density = 0.5 * noise * np.sqrt(1.0 / residual.frequency[-1])  # white up to the Nyquist frequency
    ax.axhline(density, color=GREEN, linestyle=":", linewidth=1.6, label=name)
    ax.set(xscale="log", yscale="log")
    unit = as_text_lines([unit_of(report)])
    finish(ax, "Spectrum of the error", "Frequency (Hz)", f"{unit} per root of Hz", legend_columns=0)
    figure.legend(loc="outside lower right", ncols=3, fontsize=SMALL_TEXT_SIZE)
    return figure


def figure_responses(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the frequency and the step response, measured with their 95 % errors, before and after.

    Parameters
    ----------
    report : dict
        Its `responses` are what `response_curves.find_response_curves` returns.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
    """
    frequency, step = report["responses"].frequency, report["responses"].step
    rows = 2 * (frequency is not None) + (step is not None)
    figure = page_figure(narrow, 3.3, 2.6 * rows)
    panels = list(np.ravel(figure.subplots(rows, 1) if narrow else figure.subplots(1, rows)))
    unit = as_text_lines([f"{unit_of(report)} / {unit_of(report, 'u')}"])
    if frequency is not None:
        _draw_gain(panels[0], report)
        finish(panels[0], "Gain", "Frequency (Hz)", unit, legend_columns=0)
        _draw_response(panels[1], report, frequency, _degrees, np.rad2deg(np.minimum(frequency.error, np.pi)))
        panels[1].set(xscale="log")
        _plain_ticks(panels[1])
        finish(panels[1], "Phase", "Frequency (Hz)", "Degrees", legend_columns=0)
    if step is not None:
        _draw_step(panels[-1], report)
        finish(panels[-1], "Step response", "Time after the step (s)", unit, legend_columns=0)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=SMALL_TEXT_SIZE)
    return figure


def figure_steps(shown: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the step response of each pair of an input and an output, with the 95 % error of the measured one.

    Parameters
    ----------
    shown : dict
        `pairs` are reports of one input and one output, each with `responses`.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
    """
    return _figure_pairs(shown["pairs"], narrow, _draw_step, "Time after the step (s)")


def figure_gains(shown: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the gain over frequency of each pair; see `figure_steps`."""
    return _figure_pairs(shown["pairs"], narrow, _draw_gain, "Frequency (Hz)")


def _figure_pairs(
    pairs: list[dict[str, Any]], narrow: bool, draw: Callable[[Axes, dict[str, Any]], None], across: str
) -> Figure:
    """A panel for each pair, those of one output in a row if they fit."""
    inputs = len({pair["names"]["u"] for pair in pairs})
    columns = min(inputs, 2 if narrow else 3)
    rows = -(-len(pairs) // columns)
    figure = page_figure(narrow, 0.7 + 2.1 * rows, 0.9 + 1.9 * rows)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True).ravel()
    for ax, pair in zip(panels, pairs, strict=False):
        draw(ax, pair)
        title = " → ".join(fitted(name_of(pair, signal), LONGEST_OF_PAIR, 1)[0] for signal in ("u", "y"))
        finish(ax, as_text_lines([title]), "", "", legend_columns=0)
        ax.title.set_fontsize(SMALL_TEXT_SIZE)
        ax.locator_params(axis="x", nbins=FEW_TICKS) if ax.get_xscale() == "linear" else None
    for ax in panels[len(pairs) :]:
        ax.set_visible(False)
    figure.supxlabel(across, fontsize=SMALL_TEXT_SIZE)
    handles = panels[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside upper center", ncols=2 if narrow else 4, fontsize=SMALL_TEXT_SIZE)
    return figure


def _with_name(report: dict[str, Any], text: str) -> str:
    """The text with the name of the input, where it has one."""
    return text.replace("the input", one_line(name_of(report, "u"))) if "names" in report else text


def _draw_gain(ax: Axes, report: dict[str, Any]) -> None:
    response = report["responses"].frequency
    _draw_response(ax, report, response, np.abs, response.error * np.abs(response.measured))
    axis_of_gain(ax)
    _plain_ticks(ax)


def _draw_step(ax: Axes, report: dict[str, Any]) -> None:
    response = report["responses"].step
    _draw_response(ax, report, response, np.real, response.error)


def _plain_ticks(ax: Axes) -> None:
    """Frequencies without exponents, and none within a decade, which matplotlib would label, too."""
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("")


def _degrees(response: np.ndarray) -> np.ndarray:
    return np.asarray(np.rad2deg(np.unwrap(np.angle(response))))


def _draw_response(
    ax: Axes, report: dict[str, Any], response: Any, height: Callable[[np.ndarray], np.ndarray], error: np.ndarray
) -> None:
    """Draw the measured response with its error, and those of the simulations."""
    middle = height(response.measured)
    ax.fill_between(response.x, middle - error, middle + error, color=BLACK, alpha=0.18, linewidth=0)
    ax.plot(response.x, middle, color=BLACK, alpha=0.6, linewidth=2.8, label="Measured")
    for name, label, colour, style in simulation_curves(report):
        ax.plot(response.x, height(getattr(response, name)), color=colour, linestyle=style, linewidth=1.5, label=label)


def figure_poles(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the poles and zeros of the linear dynamics before and after, with their 95 % regions.

    Parameters
    ----------
    report : dict
        Its `poles` are what `pole_rows.drawn_dynamics` returns.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
        The plane of z with the unit circle, and the surroundings of the poles if they lie close together.
    """
    labels = {name: (label, name) for name, label, *_ in simulation_curves(report)}
    models = [DrawnRoots(*labels[name], *roots) for name, roots in report["poles"].items() if name in labels]
    panels = 1 + has_zoom(models)
    figure = page_figure(narrow, 4.0, 4.2 * panels)
    axes = np.ravel(figure.subplots(panels, 1) if narrow else figure.subplots(1, panels))
    draw_roots(axes[0], models)
    if panels > 1:
        draw_zoom(axes[1], models)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=SMALL_TEXT_SIZE)
    return figure
