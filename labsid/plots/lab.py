"""Fig. 1, 5 and 6 of the lab, and the figure of the offsets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from labsid._arrays import as_signals
from labsid.plots.style import (
    BLACK,
    BLUE,
    GREY,
    GREY_BLUE,
    ORANGE,
    TIME,
    VERMILION,
    axes_or_new,
    finish,
    make_headroom,
    new_figure,
)
from labsid.records.several_signals import one_signal_each

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from labsid.lab.offset import Offsets
    from labsid.lab.sinusoid import Sinusoids
    from labsid.records.record import Record


def plot_input(t: ArrayLike, u: ArrayLike, ax: Axes | None = None) -> Axes:
    """Draw an input as a staircase, held from one sample to the next.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds.
    u : array_like, shape (N,)
        Input in volts.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; by default those of a new figure.

    Returns
    -------
    matplotlib.axes.Axes
    """
    t, u = as_signals(t=t, u=u)
    ax = axes_or_new(ax)
    ax.step(t, u, where="post", color=BLACK, linewidth=1.4, label="Input")
    ax.margins(x=0)
    return ax


def figure_1(sinusoids: Sinusoids) -> Figure:
    """Draw Fig. 1: two noisy sinusoids, (a) in full and (b) without the first 200 samples.

    Parameters
    ----------
    sinusoids : Sinusoids
        From `labsid.lab.sinusoid.make_sinusoids`.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, pre-lab steps 5 and 6. A curve has the same colour in both panels, so cos(0.02*pi*t) is the
    grey-blue [0.6 0.7 0.8] in both. The lab asks for `plot` and `stairs` but does not assign them: here the sine is
    drawn with `plot` and the cosine with stairs (``step(..., where="post")``).
    """
    # Imported here because student code under grading may import this module, but not the solution of the step.
    from labsid.lab.sinusoid import cut_off

    cut = cut_off(sinusoids)
    figure = new_figure(8.0, 6.4)
    panels = (
        ("(a) Original data", sinusoids.t, sinusoids.y1, sinusoids.y2),
        ("(b) Cut-off data", cut.t_new, cut.y1_new, cut.y2_new),
    )
    for ax, (title, t, y1, y2) in zip(figure.subplots(2, 1), panels, strict=True):
        ax.plot(t.ravel(), y1.ravel(), color=VERMILION, linewidth=1.0, label="sin(0.02πt)")
        ax.step(t.ravel(), y2.ravel(), where="post", color=GREY_BLUE, linewidth=1.0, label="cos(0.02πt)")
        ax.set_xlim(0, 140)
        ax.set_ylim(-1.5, 1.5)
        finish(ax, title, TIME, "Amplitude")
    return figure


def figure_5(record: Record) -> Figure:
    """Draw Fig. 5: (a) the measured and the noise-reduced output, (b) the actual input.

    Parameters
    ----------
    record : Record
        Both outputs are drawn if the record has both.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, step 1b.
    """
    one_signal_each(record, "Fig. 5")
    figure = new_figure()
    upper, lower = figure.subplots(2, 1)
    if record.y_measured is not None and record.y_noise_reduced is not None:
        upper.plot(record.t, record.y_measured, color=ORANGE, linewidth=4.0, label="Measured output")
        upper.plot(record.t, record.y_noise_reduced, color=BLACK, linewidth=1.0, label="Noise-reduced output")
        title = "(a) Noise-reduced and measured output signals"
    else:
        upper.plot(record.t, record.y, color=BLACK, linewidth=1.4, label="Output")
        title = "(a) Output signal"
    upper.margins(x=0)
    make_headroom(upper, 0.18)
    finish(upper, title, TIME, "Output (V)", legend_columns=2)
    plot_input(record.t, record.u, ax=lower)
    finish(lower, "(b) Actual input signal", TIME, "Input (V)", legend_columns=0)
    return figure


def figure_6(t: ArrayLike, y: ArrayLike, u: ArrayLike) -> Figure:
    """Draw Fig. 6: (a) the offset-free output, (b) the offset-free input.

    Parameters
    ----------
    t : array_like, shape (N,)
        Time in seconds.
    y, u : array_like, shape (N,)
        Output and input without their offsets, in volts.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, step 1c.
    """
    t, y, u = as_signals(t=t, y=y, u=u)
    figure = new_figure()
    upper, lower = figure.subplots(2, 1)
    upper.plot(t, y, color=BLACK, linewidth=1.4, label="Offset-free output")
    upper.margins(x=0)
    plot_input(t, u, ax=lower)
    for ax in (upper, lower):
        ax.axhline(0.0, color=GREY, linewidth=0.8, zorder=1)
    finish(upper, "(a) Offset-free output signal (noise-reduced)", TIME, "Output $y$ (V)", legend_columns=0)
    finish(lower, "(b) Offset-free input signal", TIME, "Input $u$ (V)", legend_columns=0)
    return figure


def figure_offsets(record: Record, offsets: Offsets) -> Figure:
    """Draw the first input period with the mean over the whole period and over its settled part.

    Parameters
    ----------
    record : Record
        The two means coincide if the record starts settled; they differ if it starts from an empty tank.
    offsets : Offsets
        From `labsid.lab.offset.find_offsets`.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, step 1c. The lab averages the whole first period, which is correct only if the rig is settled from the
    start.
    """
    n = offsets.first_period
    k0, k1 = offsets.settled
    shown = slice(0, min(2 * n, len(record)))
    t, u, y = record.t[shown], record.u[shown], record.y[shown]
    whole_mean = float(record.y[:n].mean())
    part = "Settled part" if offsets.status == "settled" else f"Averaged part ({offsets.status})"
    figure = new_figure()
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    upper.axvspan(record.t[k0], record.t[k1 - 1], color=GREY_BLUE, alpha=0.45, label=part)
    upper.plot(t, y, color=BLACK, linewidth=1.2, label="Output")
    for mean, of, color, style in (
        (whole_mean, "whole period", VERMILION, "--"),
        (offsets.y_offset, part.lower(), BLUE, "-"),
    ):
        upper.axhline(mean, color=color, linestyle=style, linewidth=1.8, label=f"Mean of {of}: {mean:.3f} V")
    make_headroom(upper, 0.27)
    plot_input(t, u, ax=lower)
    upper.set_xlim(t[0], t[-1])
    for ax in (upper, lower):
        ax.axvline(record.t[min(n, len(record) - 1)], color=BLACK, linestyle=":", linewidth=1.2)
    finish(upper, "Output over the first input period", "", "Output (V)", legend_columns=2)
    finish(lower, "", TIME, "Input (V)", legend_columns=0)
    return figure
