"""Panels of the gap report that can be zoomed, for a page with scripts: made by bokeh from the JSON report alone.

The panels have no samples and no colours of their own: the script of the page sets both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from labsid.plots.gap_curves import noise_band
from labsid.plots.signal_names import plain_label, unit_of
from labsid.plots.style import TIME

if TYPE_CHECKING:
    from bokeh.models import ColumnDataSource, Range1d
    from bokeh.plotting import figure

COLUMNS = ("t", "u", "y", "before", "after", "e_before", "e_after")
HEIGHTS = {"output": 270, "error": 220, "input": 170, "strip": 90}  # pixels
LEFT, RIGHT = 74, 12  # pixels: the panels share one axis of time
FONT = "system-ui, Segoe UI, Roboto, DejaVu Sans, sans-serif"
_TEXT_COLOURS = {"axis_label_text_color": "--ink", "major_label_text_color": "--ink", "axis_line_color": "--soft"}
_TICK_COLOURS = {"major_tick_line_color": "--soft", "minor_tick_line_color": "--soft"}


def curves_of(report: dict[str, Any]) -> tuple[str, ...]:
    """The simulations to draw: "before" alone if nothing was corrected."""
    unchanged = report["verdict"] == "none" or report["traces"]["before"] == report["traces"]["after"]
    return ("before",) if unchanged else ("before", "after")


def panels(report: dict[str, Any], name: str, strip: bool = False) -> dict[str, Any]:
    """Panels of output, error and input with one axis of time.

    Parameters
    ----------
    report : dict
    name : str
        "record" or "holdout".
    strip : bool
        Whether a strip above the panels shows all of it.

    Returns
    -------
    dict
        What ``Bokeh.embed.embed_item`` shows. Its source of data has the `COLUMNS`, which are empty. The tags of a
        model are pairs of a property and a colour of the page.
    """
    from bokeh.embed import json_item
    from bokeh.layouts import column, gridplot
    from bokeh.models import ColumnDataSource, Range1d

    on_holdout = name == "holdout"
    t = report["holdout_traces" if on_holdout else "traces"]["t"]
    times = Range1d(t[0], t[-1], bounds="auto")
    source = ColumnDataSource({column: [] for column in COLUMNS}, name=name)
    output = _panel("output", "Measured and simulated output", plain_label(report, "y"), times)
    error = _panel("error", "Simulation error", f"Error ({unit_of(report)})", times)
    command = _panel("input", "Input", plain_label(report, "u"), times)
    _line(output, source, "y", "--ink", line_width=2.8, line_alpha=0.55)
    for curve, dash in (("before", "dashed"), ("after", "solid")):
        _line(output, source, curve, f"--{curve}", line_width=1.5, line_dash=dash)
        _line(error, source, f"e_{curve}", f"--{curve}", line_width=1.2)
    held = command.step("t", "u", source=source, name="u", mode="after", line_width=1.4)
    held.glyph.tags = [["line_color", "--ink"]]
    if not report.get("records") and (on_holdout or report["holdout_traces"] is None):
        _shade(error, report["gap"]["holdout"])
    _noise(error, noise_band(report)[0])
    _cursor([output, error, command])
    _hover(output, {"Measured": "@y", "Before": "@before", "After": "@after"})
    _hover(error, {"Error before": "@e_before", "Error after": "@e_after"})
    _hover(command, {"Input": "@u"})
    command.xaxis.axis_label = TIME
    grid = gridplot([[output], [error], [command]], sizing_mode="stretch_width", toolbar_location="above")
    grid.toolbar.logo = None
    return dict(json_item(column([_strip(source, times, t), grid], sizing_mode="stretch_width") if strip else grid))


def _strip(source: ColumnDataSource, times: Range1d, t: list[float]) -> figure:
    """The whole record, on which the part that the panels show can be moved."""
    from bokeh.models import Range1d, RangeTool

    strip = _panel("strip", "", "", Range1d(start=t[0], end=t[-1]))
    strip.update(tools=[RangeTool(x_range=times)], toolbar_location=None, sizing_mode="stretch_width")
    strip.yaxis.visible = False
    _line(strip, source, "y", "--ink", line_width=1.0)
    return strip


def _cursor(drawn: list[figure]) -> None:
    """One line in all panels, at the time of the pointer."""
    from bokeh.models import CrosshairTool
    from bokeh.models.annotations import Span

    line = Span(dimension="height", line_width=1, tags=[["line_color", "--soft"]])
    for panel in drawn:
        panel.add_tools(CrosshairTool(overlay=line, visible=False))


def _panel(name: str, title: str, label: str, times: Range1d) -> figure:
    """An empty panel: drag zooms in time, and the wheel scrolls the page. The script of the page sets its heights."""
    from bokeh.models import BoxZoomTool, PlainText, Range1d
    from bokeh.plotting import figure

    zoom = BoxZoomTool(dimensions="width")

    panel = figure(
        name=name,
        title=title,
        y_axis_label=PlainText(text=label),  # a name may look like mathematics
        x_range=times,
        y_range=Range1d(start=0.0, end=1.0),
        height=HEIGHTS[name],
        min_border_left=LEFT,
        min_border_right=RIGHT,
        tools=[zoom, "xpan,xzoom_in,xzoom_out,reset"],
        active_drag=zoom,
        active_scroll=None,
        background_fill_color=None,
        border_fill_color=None,
        outline_line_color=None,
        output_backend="canvas",
        lod_threshold=None,
    )
    heading: Any = panel.title
    heading.update(tags=[["text_color", "--ink"]], text_font=FONT, text_font_size="15px", text_font_style="normal")
    for axis in panel.axis:
        axis.update(tags=[list(pair) for pair in (_TEXT_COLOURS | _TICK_COLOURS).items()])
        axis.update(axis_label_text_font=FONT, axis_label_text_font_size="14px", axis_label_text_font_style="normal")
        axis.update(major_label_text_font=FONT, major_label_text_font_size="13px")
    for grid in panel.grid:
        grid.tags = [["grid_line_color", "--line"]]
    return panel


def _line(panel: figure, source: ColumnDataSource, column: str, colour: str, **style: Any) -> None:
    drawn = panel.line("t", column, source=source, name=column, **style)
    drawn.glyph.tags = [["line_color", colour]]


def _shade(panel: figure, stretches: list[list[float]]) -> None:
    """Shade the samples that are scored."""
    from bokeh.models.annotations import BoxAnnotation

    for left, right in stretches:
        panel.add_layout(
            BoxAnnotation(left=left, right=right, fill_alpha=0.16, line_color=None, tags=[["fill_color", "--soft"]])
        )


def _noise(panel: figure, size: float) -> None:
    from bokeh.models.annotations import Span

    for side in (-size, size):
        panel.add_layout(
            Span(location=side, dimension="width", line_dash="dotted", line_width=1.8, tags=[["line_color", "--floor"]])
        )


def _hover(panel: figure, shown: dict[str, str]) -> None:
    """Give the values at the time of the pointer."""
    from bokeh.models import HoverTool

    rows = {"Time": "@t{%.6g} s"} | {label: f"{column}{{%.5g}}" for label, column in shown.items()}
    cells = "".join(f'<span style="color: #566779">{label}</span><span>{value}</span>' for label, value in rows.items())
    text = (
        f'<div style="display: grid; grid-template-columns: auto auto; gap: 0 0.7em; font: 13px {FONT}">{cells}</div>'
    )
    formatters: Any = dict.fromkeys(("@t", *shown.values()), "printf")
    drawn: Any = panel.renderers[:1]
    panel.add_tools(HoverTool(renderers=drawn, mode="vline", tooltips=text, formatters=formatters, visible=False))


def panel_script() -> str:
    """The library that draws the panels, for a page that loads nothing."""
    from bokeh.resources import Resources

    return Resources(mode="inline", components=["bokeh"]).js_raw[0]
