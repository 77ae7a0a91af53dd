"""The figures of several signals: every signal with its name, one axis of time, and no text on a curve."""

import json
import warnings

import numpy as np
import pytest
from signals_reports import signals_report, with_planned_inputs

from labsid.gap.reports.signals_text import of_worst_output
from labsid.plots.couplings import figure_couplings
from labsid.plots.gap import figure_first, figure_location
from labsid.plots.page_figures import NARROW, WIDE, in_both_widths, palette_png
from labsid.plots.signal_names import fitted, one_line, stacked
from labsid.plots.signals import figure_planned_inputs, figure_signals, inputs_shown, worst_stretch

WIDTHS = pytest.mark.parametrize("narrow", [False, True])
FOUND = (("input-dead-zone", "valve"), ("extra-lag", None))
SEVEN = [(f"joint {k} of the arm", "N m") for k in range(7)]


def _curve(ax, label):
    (line,) = [line for line in ax.lines if line.get_label() == label]
    return line


def _texts(figure):
    return [text.get_text() for text in figure.axes[0].texts]


@WIDTHS
def test_outputs_errors_and_inputs_share_one_axis_of_time(narrow, covered):
    base = signals_report(*FOUND)
    figure = figure_signals(base, narrow)
    labels = ["level\n(cm)", "Error\n(cm)", "temperature", "Error", "valve\n(V)", "heater\n(%)"]
    assert [ax.get_ylabel() for ax in figure.axes] == labels
    assert [ax.get_xlabel() for ax in figure.axes] == [*[""] * 5, "Time (s)"]
    assert {ax.get_xlim() for ax in figure.axes} == {(0.0, 119.5)}
    level, error, temperature, *_, valve, _ = figure.axes
    own = base["outputs"]["temperature"]["traces"]
    for label, name in (("Measured", "y"), ("Before", "before"), ("After", "after")):
        np.testing.assert_array_equal(_curve(temperature, label).get_ydata(), own[name])
    traces = base["outputs"]["level"]["traces"]
    np.testing.assert_allclose(_curve(error, "Before").get_ydata(), np.subtract(traces["y"], traces["before"]))
    np.testing.assert_array_equal(valve.lines[0].get_ydata(), traces["u"])
    assert level.get_title(loc="left") == ""
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        *("Measured", "Before", "After", "Largest error", "Noise, ±2 s.d.", "Scored"),
    ]
    assert figure.get_size_inches()[0] == (NARROW if narrow else WIDE)
    assert covered(figure) == []


def test_an_effect_stands_above_its_signal_and_its_band_is_drawn():
    base = signals_report(*FOUND)
    base["effects"][0] |= {"title": "dead zone"}
    *_, temperature, _, valve, heater = figure_signals(base).axes
    assert valve.get_title(loc="left") == "Cause: dead zone"
    assert temperature.get_title(loc="left") == "Cause: extra-lag in the dynamics"
    assert heater.get_title(loc="left") == ""
    levels = {line.get_ydata()[0] for line in valve.lines[1:]}
    assert levels == {one["value"] for one in base["effects"][0]["parameters"].values()}
    (band,) = valve.patches
    assert (band.get_y(), band.get_y() + band.get_height()) == tuple(sorted(levels))
    base["effects"][0]["probability"] = 0.3
    assert figure_signals(base).axes[-2].get_title(loc="left") == "Possible cause: dead zone"


def test_a_level_outside_the_panel_does_not_compress_the_signal():
    base = signals_report(FOUND[0])
    base["effects"][0]["parameters"]["high"]["value"] = 1e9
    valve = figure_signals(base).axes[-2]
    assert valve.get_ylim()[1] < 10.0
    assert len(valve.lines) == 1


@WIDTHS
def test_the_zoom_shows_the_largest_error_of_the_worst_output(narrow, covered):
    base = signals_report(*FOUND)
    start, stop = worst_stretch(base)
    assert 25.0 <= start < stop <= 50.0
    figure = figure_signals(base, narrow, zoom=True)
    assert len(figure.axes) == 4
    assert figure.axes[0].get_xlim() == (start, stop)
    assert covered(figure) == []


def test_the_scored_samples_are_those_of_the_holdout_record_if_there_is_one():
    base = signals_report(*FOUND, holdout=True)
    assert not figure_signals(base).axes[1].patches
    error = figure_signals(base, traces="holdout_traces").axes[1]
    assert [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in error.patches] == [(525.0, 620.0)]
    assert error.get_xlim()[0] == 500.0


def test_without_a_gap_there_is_one_simulation():
    figure = figure_signals(signals_report(verdict="none"))
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        *("Measured", "Simulated", "Noise, ±2 s.d.", "Scored"),
    ]


def test_missing_samples_are_gaps():
    base = signals_report(*FOUND)
    base["outputs"]["level"]["traces"]["y"][10:20] = [None] * 10
    level, error, *_ = figure_signals(json.loads(json.dumps(base))).axes
    assert np.isnan(_curve(level, "Measured").get_ydata()[10:20]).all()
    assert np.isnan(_curve(error, "After").get_ydata()[10:20]).all()


def test_only_inputs_with_samples_are_drawn():
    base = signals_report(verdict="unknown", inputs=[("a", ""), ("b", ""), ("c", "")], outputs=[("y", "")])
    assert list(inputs_shown(base)) == ["a"]
    assert [ax.get_ylabel() for ax in figure_signals(base).axes] == ["y", "Error", "a"]
    base["inputs"] = {name: {"t": [0.0, 1.0, 2.0], "u": [0.0, 1.0, 0.5]} for name in "abc"}
    *_, b, c = figure_signals(base).axes
    assert [ax.get_ylabel() for ax in (b, c)] == ["b", "c"]
    assert c.lines[0].get_ydata().tolist() == [0.0, 1.0, 0.5]


@WIDTHS
@pytest.mark.parametrize("inputs", [SEVEN[:2], SEVEN])
def test_the_couplings_are_a_table_with_effects_under_the_names(narrow, inputs, covered):
    outputs = [("level", "cm"), ("temperature", "")]
    base = signals_report(("input-dead-zone", inputs[1][0]), ("extra-lag", None), inputs=inputs, outputs=outputs)
    base["effects"][0] |= {"title": "dead zone"}
    base["effects"][1] |= {"title": "extra lag"}
    figure = figure_couplings(base, narrow)
    texts = [text.replace("\n", " ") for text in _texts(figure)]
    shares = texts[len(inputs) :]
    assert shares.count("86 %") == shares.count("14 %") == 2
    assert shares.count("–") == 2 * len(inputs) - 4
    assert texts[1].endswith("Cause: dead zone")
    assert any(text.startswith("temperature Cause: extra lag") for text in texts)
    assert covered(figure) == []


def test_the_location_names_the_signals_and_their_units():
    labels = {
        text
        for ax in figure_location(of_worst_output(signals_report(*FOUND))).axes
        for text in (ax.get_xlabel(), ax.get_ylabel())
    }
    assert {"heater (%)", "temperature", "Rms error (units of temperature)"} <= labels


@WIDTHS
def test_every_planned_input_has_a_panel(narrow, covered):
    base = with_planned_inputs(signals_report(*FOUND))
    figure = figure_planned_inputs(base, narrow)
    assert [ax.get_ylabel() for ax in figure.axes] == ["valve\n(V)", "heater\n(%)"]
    for ax, u in zip(figure.axes, base["next_experiment"]["u"].values(), strict=True):
        np.testing.assert_array_equal(ax.lines[0].get_ydata(), u)
    assert covered(figure) == []


def test_names_are_no_mathematics_and_any_script_is_drawn_without_a_warning():
    names = [("$a^{$", "$"), ("阀门", "度"), ("tab\tline\nend", "")]
    base = signals_report(("input-delay", "$a^{$"), inputs=names[:2], outputs=names[2:])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        drawn = in_both_widths({"a": figure_signals, "b": figure_couplings}, base)
        drawn |= in_both_widths({"c": figure_location, "d": figure_first}, of_worst_output(base))
        assert palette_png(figure_signals(base)).startswith(b"\x89PNG")
    assert set(drawn) == {"a", "b", "c", "d"}


def test_long_names_keep_their_ends():
    assert fitted("torque of the motor of joint 4", 12, 2) == ["torque of", "…of joint 4"]
    assert one_line("temperature", "°C") == "temperature (°C)"
    assert one_line("torque of the motor of joint 4") == "…of the motor of joint 4"
    assert stacked("level of the tank", "cm", 10) == "level of\nthe tank\n(cm)"
    assert stacked("y", "x" * 40, 10) == f"y\n(…{'x' * 9})"
