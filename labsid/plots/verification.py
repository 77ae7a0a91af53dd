"""Fig. 7 and 8 of the lab: simulated and measured output."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signals
from labsid.plots.style import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    SMALL_TEXT_SIZE,
    TIME,
    VERMILION,
    axes_or_new,
    finish,
    make_headroom,
    new_figure,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from labsid.lab.verification import Verification

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def plot_simulated_on_measured(
    t: ArrayLike, y: ArrayLike, y_sim: ArrayLike, label: str = "Simulated output", ax: Axes | None = None
) -> Axes:
    """Draw a simulated output over the measured output.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds.
    y, y_sim : array_like, shape (N,)
        Measured and simulated offset-free output in volts.
    label : str
        Legend text of `y_sim`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    t, y, y_sim = as_signals(t=t, y=y, y_sim=y_sim)
    ax = axes_or_new(ax)
    _plot_actual(ax, t, y)
    ax.plot(t, y_sim, color=BLUE, linewidth=1.8, label=label)
    return ax


def figure_7(t: ArrayLike, y: ArrayLike, verification: Verification) -> Figure:
    """Draw Fig. 7: the simulated and the actual output, (a) over the second half, (b) over the entire record.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds.
    y : array_like, shape (N,)
        Offset-free output in volts.
    verification : Verification
        From `labsid.lab.verification.verify`. Panel (a) shows the simulation that starts from rest at the second half.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If the length of t and y differs from that of the verified record.

    Notes
    -----
    UNSW lab, step 3a. `figure_7_initial_state` shows why (a) does not start at the same point.
    """
    t, y = _of_length(verification, t, y)
    half = verification.half
    figure = new_figure(8.0, 6.6)
    upper, lower = figure.subplots(2, 1)
    plot_simulated_on_measured(t[half:], y[half:], verification.y_second_half, ax=upper)
    plot_simulated_on_measured(t, y, verification.y_all, ax=lower)
    for ax, title in ((upper, "(a) Second half of the output"), (lower, "(b) Entire output")):
        make_headroom(ax, 0.18)
        finish(ax, title, TIME, "Output $y$ (V)", legend_columns=2)
    return figure


def figure_7_initial_state(t: ArrayLike, y: ArrayLike, verification: Verification) -> Figure:
    """Draw the second half of Fig. 7 from three initial states, which shows why it does not start at the same point.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds.
    y : array_like, shape (N,)
        Offset-free output in volts.
    verification : Verification
        From `labsid.lab.verification.verify`.

    Returns
    -------
    matplotlib.figure.Figure
        (a) The second half from rest, with the state carried over from the first half, and with an estimated initial
        state; (b) the error of each. The errors differ by a decaying transient.

    Raises
    ------
    ValueError
        If the length of t and y differs from that of the verified record.

    Notes
    -----
    UNSW lab, step 3b.
    """
    t, y = _of_length(verification, t, y)
    half = verification.half
    t, y = t[half:], y[half:]
    curves = (
        ("From rest", verification.y_second_half, VERMILION, "-"),
        ("State carried over", verification.y_second_half_carried, ORANGE, "-."),
        ("State estimated", verification.y_second_half_estimated, BLUE, "--"),
    )
    figure = new_figure(8.0, 6.6)
    upper, lower = figure.subplots(2, 1)
    _plot_actual(upper, t, y)
    for label, y_sim, color, style in curves:
        upper.plot(t, y_sim, color=color, linestyle=style, linewidth=1.8, label=label)
        lower.plot(t, y - y_sim, color=color, linestyle=style, linewidth=1.6, label=label)
    lower.axhline(0.0, color=BLACK, linewidth=0.8, zorder=1)
    lower.margins(x=0)
    make_headroom(upper, 0.27)
    make_headroom(lower, 0.18)
    finish(upper, "(a) Second half, from three initial states", TIME, "Output $y$ (V)", legend_columns=2)
    finish(lower, "(b) Error of each", TIME, "Error $y - y_\\mathrm{sim}$ (V)", legend_columns=3)
    return figure


def figure_8(
    t: ArrayLike,
    y: ArrayLike,
    y_first: ArrayLike,
    y_second: ArrayLike,
    mse_first: float,
    mse_second: float,
) -> Figure:
    """Draw Fig. 8: the first-order and the second-order model and the actual output, with their errors.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds.
    y : array_like, shape (N,)
        Offset-free output in volts.
    y_first, y_second : array_like, shape (N,)
        Simulated outputs of the first-order and the second-order model in volts.
    mse_first, mse_second : float
        Their mean squared errors in square volts, written in the top-left corner.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, post-lab steps 2 and 3.
    """
    t, y, y_first, y_second = as_signals(t=t, y=y, y_first=y_first, y_second=y_second)
    figure = new_figure(8.0, 4.8)
    ax = figure.add_subplot()
    _plot_actual(ax, t, y)
    # Draw the dashed first-order curve on top; otherwise one curve would hide the other.
    ax.plot(t, y_first, color=VERMILION, linestyle="--", linewidth=1.8, zorder=3, label="First-order model")
    ax.plot(t, y_second, color=BLUE, linewidth=1.8, label="Second-order model")
    make_headroom(ax, 0.25)
    finish(ax, "Models of first and second order against the actual output", TIME, "Output $y$ (V)")
    ax.text(
        0.015,
        0.975,
        f"MSE, first order: {_scientific(mse_first)} V²\nMSE, second order: {_scientific(mse_second)} V²",
        transform=ax.transAxes,
        ha="left",
        va="top",
        fontsize=SMALL_TEXT_SIZE,
        bbox={"boxstyle": "round", "facecolor": "white", "edgecolor": GREY},
    )
    return figure


def _plot_actual(ax: Axes, t: ArrayLike, y: ArrayLike) -> None:
    ax.plot(t, y, color=BLACK, linewidth=1.0, label="Actual output")
    ax.margins(x=0)


def _of_length(verification: Verification, t: ArrayLike, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Check that `t` and `y` have the length of the verified record."""
    t, y = as_signals(t=t, y=y)
    if y.size != verification.y_all.size:
        raise ValueError(
            f"t and y must be those of the record that was verified, {verification.y_all.size} samples; "
            f"got {y.size}. Pass the offset-free y given to verify."
        )
    return t, y


def _scientific(value: float) -> str:
    """Format `value` like 8.945×10⁻⁴."""
    mantissa, exponent = f"{value:.3e}".split("e")
    return f"{mantissa}×10{str(int(exponent)).translate(_SUPERSCRIPTS)}"
