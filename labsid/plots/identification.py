"""Figure of an identification: measured and simulated output, frequency and step response, poles and zeros."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from labsid.lab.model_responses import responses_of_model
from labsid.plots.root_plane import DrawnRoots, draw_roots, draw_zoom, has_zoom
from labsid.plots.signal_names import one_line
from labsid.plots.style import BLUE, TIME, axis_of_gain, finish, make_headroom, new_figure
from labsid.plots.verification import plot_simulated_on_measured

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from labsid.lab.identification import Identification

ALT = (
    "Measured output and free run of the model over the record; gain, phase and step response of the model with their "
    "95 % errors; its poles and zeros with their 95 % regions."
)


def figure_identification(identification: Identification) -> Figure:
    """Draw the free run on the measured output, the responses of the model, and its poles and zeros.

    Parameters
    ----------
    identification : Identification
        From `labsid.lab.identification.identify`.

    Returns
    -------
    matplotlib.figure.Figure
        Shaded areas are 95 % errors, from the covariance of theta.
    """
    record, model = identification.record, identification.model
    found = responses_of_model(model, identification.fit.covariance)
    models = [DrawnRoots("Model", "model", found.poles, found.zeros)]
    figure = new_figure(9.5, 9.6, ALT)
    last = ["poles", "zoom"] if has_zoom(models) else ["poles", "poles"]
    layout: list[Any] = [["output", "output"], ["gain", "phase"], ["step", "step"], last]
    axes = figure.subplot_mosaic(layout, height_ratios=[1.0, 0.9, 0.8, 1.4])
    u, y = record.units
    _draw_output(axes["output"], identification, y)
    _draw_band(axes["gain"], found.frequency, np.abs(found.gain), found.gain_error * np.abs(found.gain))
    axis_of_gain(axes["gain"])
    finish(axes["gain"], "Gain", "Frequency (Hz)", one_line("Gain", f"{y}/{u}" if y and u else ""), legend_columns=0)
    phase = np.unwrap(np.angle(found.gain))
    _draw_band(axes["phase"], found.frequency, np.rad2deg(phase), np.rad2deg(np.minimum(found.phase_error, np.pi)))
    axes["phase"].set_xscale("log")
    finish(axes["phase"], "Phase", "Frequency (Hz)", "Degrees", legend_columns=0)
    _draw_band(axes["step"], found.time, found.step, found.step_error)
    finish(axes["step"], "Response to a unit step", "Time after the step (s)", one_line("Output", y), legend_columns=0)
    draw_roots(axes["poles"], models)
    if "zoom" in axes:
        draw_zoom(axes["zoom"], models)
    return figure


def _draw_output(ax: Axes, identification: Identification, unit: str) -> None:
    """Draw the free run over the record; the model was fitted to the first half of it."""
    record, runs = identification.record, identification.verification
    plot_simulated_on_measured(record.t, identification.y, runs.y_all, "Free run of the model", ax)
    ax.axvspan(record.t[0], record.t[runs.half], color=BLUE, alpha=0.07, linewidth=0, label="Fitted")
    make_headroom(ax, 0.2)
    finish(ax, f"Order {identification.model.order}, about the operating point", TIME, one_line("Output", unit), 3)


def _draw_band(ax: Axes, x: np.ndarray, middle: np.ndarray, error: np.ndarray) -> None:
    ax.fill_between(x, middle - error, middle + error, color=BLUE, alpha=0.25, linewidth=0)
    ax.plot(x, middle, color=BLUE, linewidth=1.8)
    ax.margins(x=0)
