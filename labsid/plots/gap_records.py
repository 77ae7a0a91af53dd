"""Figure of several records: each with its name, its own time, and the simulations that are scored on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from labsid.plots.gap_curves import draw_errors, draw_outputs, simulation_curves
from labsid.plots.page_figures import NARROW, WIDE
from labsid.plots.signal_names import as_text_lines, fitted, name_beside, unit_of
from labsid.plots.style import GREY, SMALL_TEXT_SIZE, TIME, finish, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROW, NARROW_ROW = 1.75, 3.0  # inches
NAME, SHORT = 36, 10  # characters of the name of a record, and of an output
AROUND = 0.9  # inches, for the legend and the axis of time


def figure_records(report: dict[str, Any], narrow: bool = False) -> Figure:
    """Draw the outputs and the errors of each of several records in a row of its own.

    Parameters
    ----------
    report : dict
        Its `record_traces` are the traces of each record.
    narrow : bool
        Whether to fit the width of a telephone.

    Returns
    -------
    matplotlib.figure.Figure
        The samples that are not scored, from which the initial state is estimated, are shaded.
    """
    curves, records = simulation_curves(report), report["record_traces"]
    size = (NARROW, NARROW_ROW * len(records) + AROUND) if narrow else (WIDE, ROW * len(records) + AROUND)
    figure = new_figure(*size)
    shape = (2 * len(records), 1) if narrow else (len(records), 2)
    panels = np.array(figure.subplots(*shape, squeeze=False)).reshape(len(records), 2)
    for row, trace, (left, right) in zip(report["records"], records, panels, strict=True):
        draw_outputs(left, trace, curves, slice(None))
        draw_errors(right, report, trace, curves)
        for ax in (left, right):
            ax.axvspan(0.0, row["unscored"] * report["record"]["Ts"], color=GREY, alpha=0.35, linewidth=0, zorder=0)
        last = trace is records[-1]
        title = as_text_lines(fitted(str(row["name"]), NAME, 1))
        finish(left, title, TIME if last and not narrow else "", name_beside(report, SHORT), 0)
        finish(right, "", TIME if last else "", "Error", 0)
    lines = {str(line.get_label()): line for ax in panels[0] for line in ax.lines if str(line.get_label())[:1] != "_"}
    lines.pop("", None)
    figure.legend(
        handles=list(lines.values()),
        title=as_text_lines([f"Outputs and errors in {unit_of(report)}", "Shaded samples are not scored"]),
        title_fontsize=SMALL_TEXT_SIZE,
        loc="outside upper center",
        ncols=2 if narrow else 4,
        fontsize=SMALL_TEXT_SIZE,
    )
    return figure
