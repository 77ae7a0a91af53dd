"""Figure of a record as `labsid check` sees it: its signals, and below them where each finding lies."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING

import numpy as np

from labsid.plots.signal_names import as_text_lines, fitted, one_line
from labsid.plots.style import BLACK, BLUE, GREEN, GREY, ORANGE, SMALL_TEXT_SIZE, TIME, VERMILION, finish, new_figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from labsid.lab.findings import Finding, Marks
    from labsid.lab.record_check import RecordCheck
    from labsid.records.formats import RawRecord

COLOURS = {"ok": GREEN, "note": BLUE, "warning": ORANGE, "refused": VERMILION}
LEAST_WIDTH = 0.003  # of the record: a shorter stretch is drawn so wide
PANEL, LANE, AROUND = 1.9, 0.27, 1.0  # inches: of a signal, of a finding, and for titles and the axis
NAME, TITLE = 34, 100  # characters beside a lane, and of a line of the verdict


def figure_check(raw: RawRecord, check: RecordCheck) -> Figure:
    """Draw the signals of a record, with the places of the findings of its check.

    Parameters
    ----------
    raw : RawRecord
    check : RecordCheck
        Its findings with places have a lane each below the signals, and are shaded in the signals that they are about.

    Returns
    -------
    matplotlib.figure.Figure
    """
    marked = [(finding, finding.marks) for finding in check.findings if finding.marks is not None]
    outputs, inputs = _columns(raw.y, raw.outputs), _columns(raw.u, raw.inputs)
    units = dict(zip((*raw.inputs, *raw.outputs), raw.units, strict=True))
    panels = len(outputs) + len(inputs)
    heights = [*[PANEL] * panels, LANE * max(len(marked), 1)]
    figure = new_figure(9.5, sum(heights) + AROUND, _alt(check, marked))
    axes = figure.subplots(panels + 1, 1, sharex=True, height_ratios=heights, squeeze=False)[:, 0]
    roles = dict.fromkeys(outputs, "output") | dict.fromkeys(inputs, "input")
    longest = max(x.size for x in (*outputs.values(), *inputs.values()))
    t, label = _times(raw, check.Ts, longest)
    for ax, (name, x) in zip(axes[:-1], (outputs | inputs).items(), strict=True):
        if name in outputs:
            ax.plot(t[: x.size], x, color=BLACK, linewidth=1.0)
        else:
            ax.step(t[: x.size], x, where="post", color=BLACK, linewidth=1.0)
        for finding, marks in marked:
            if marks.signal in ("", name, roles[name]):
                for start, stop in _ends(marks, t):
                    ax.axvspan(start, stop, color=COLOURS[finding.level], alpha=0.3, linewidth=0, zorder=0)
        ax.margins(x=0)
        finish(ax, "", "", one_line(name, units.get(name, "")), legend_columns=0)
    axes[0].set_title(as_text_lines(wrap(check.verdict, TITLE, max_lines=3)), fontsize=SMALL_TEXT_SIZE, loc="left")
    _draw_lanes(axes[-1], marked, t, label)
    figure.align_ylabels(axes[:-1])
    return figure


def _draw_lanes(ax: Axes, marked: Sequence[tuple[Finding, Marks]], t: np.ndarray, label: str) -> None:
    """Draw a lane for each finding, with its places."""
    for lane, (finding, marks) in enumerate(marked):
        ends = _ends(marks, t)
        ax.broken_barh(
            [(start, stop - start) for start, stop in ends], (lane - 0.38, 0.76), color=COLOURS[finding.level]
        )
    names = [as_text_lines(fitted(_name(marks), NAME, 1)) for _, marks in marked]
    ax.set(yticks=range(len(names)), yticklabels=names, ylim=(max(len(names), 1) - 0.5, -0.5))
    finish(ax, "" if marked else "No finding has a place in the record", label, "", legend_columns=0)
    ax.grid(False)
    ax.set_xlim(t[0], t[-1] if t[-1] > t[0] else t[0] + 1.0)
    for lane in range(1, len(names)):
        ax.axhline(lane - 0.5, color=GREY, linewidth=0.5)


def _name(marks: Marks) -> str:
    return marks.text if marks.signal in ("", "input", "output") else f"{marks.signal}: {marks.text}"


def _ends(marks: Marks, t: np.ndarray) -> list[tuple[float, float]]:
    """Times of the stretches, each at least so wide that it is seen."""
    last, least = t.size - 1, LEAST_WIDTH * float(t[-1] - t[0])
    found = []
    for start, stop in marks.stretches:
        if start > last:
            continue
        low, high = float(t[start]), float(t[min(stop - 1, last)])
        wider = max(0.5 * (least - (high - low)), 0.0)
        found.append((low - wider, high + wider))
    return found


def _columns(x: np.ndarray, names: Sequence[str]) -> dict[str, np.ndarray]:
    columns = x.T if x.ndim == 2 else [x]
    return dict(zip(names, columns, strict=True))


def _times(raw: RawRecord, Ts: float | None, samples: int) -> tuple[np.ndarray, str]:
    """Times of the samples, or their numbers where the times do not increase."""
    if raw.t is not None and raw.t.size >= samples and bool(np.all(np.diff(raw.t) > 0.0)):
        return raw.t, TIME
    if raw.t is None and Ts is not None:
        return Ts * np.arange(samples), TIME
    return np.arange(samples, dtype=float), "Sample"


def _alt(check: RecordCheck, marked: Sequence[tuple[Finding, Marks]]) -> str:
    named = ", ".join(dict.fromkeys(_name(marks) for _, marks in marked)) or "none"
    return f"Outputs and inputs of the record, with the places of the findings: {named}. {check.verdict}."
