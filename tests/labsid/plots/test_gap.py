"""The figures of the gap report: the right curves, named and with units, on both widths."""

import numpy as np
import pytest
from gap_reports import report, with_experiment, with_holdout, with_limits

from labsid.gap.reports.quantities import with_names
from labsid.plots.gap import (
    figure_experiment,
    figure_first,
    figure_limits,
    figure_location,
    figure_simulations,
    figures_as_png,
)
from labsid.plots.gap_curves import largest_error, noise_band, trace_of
from labsid.plots.page_figures import NARROW, WIDE
from labsid.plots.signal_names import axis_label, plain_label

WIDTHS = pytest.mark.parametrize("narrow", [False, True])


def _legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def _title_of(figure):
    return figure.axes[0].get_title().replace("\n", " ")


def _curve(ax, label):
    (line,) = [line for line in ax.lines if line.get_label() == label]
    return line


@WIDTHS
def test_measured_and_both_simulations_over_the_record_and_close_up(narrow, covered):
    base = report("input-delay")
    figure = figure_simulations(base, narrow)
    whole, close, errors = figure.axes
    traces = base["traces"]
    for label, name in (("Measured", "y"), ("Before", "before"), ("After", "after")):
        np.testing.assert_array_equal(_curve(whole, label).get_ydata(), traces[name])
        assert _curve(close, label).get_xdata()[0] >= 20.0
        assert _curve(close, label).get_xdata()[-1] <= 50.0
    np.testing.assert_allclose(_curve(errors, "Before").get_ydata(), np.subtract(traces["y"], traces["before"]))
    np.testing.assert_allclose(_curve(errors, "After").get_ydata(), np.subtract(traces["y"], traces["after"]))
    assert _legend(errors) == ["Before", "After", "Noise, ±2 s.d.", "Scored"]
    assert {tuple(line.get_ydata()) for line in errors.lines if len(line.get_ydata()) == 2} == {
        (0.02, 0.02),
        (-0.02, -0.02),
    }
    assert [ax.get_xlabel() for ax in figure.axes] == ["Time (s)"] * 3
    assert [ax.get_ylabel() for ax in figure.axes] == ["Output $y$ (units of y)"] * 2 + [
        "Simulation error (units of y)"
    ]
    assert figure.get_size_inches()[0] == (NARROW if narrow else WIDE)
    assert covered(figure) == []


def test_the_band_of_noise_holds_nothing_that_is_unexplained():
    base = report("input-delay", verdict="partial")
    base["gap"]["noise_floor"] = 0.04
    base["unexplained"] |= {"rms": 0.05, "colour": 10.0}
    assert noise_band(base) == (pytest.approx(0.01), "White noise")
    assert "White noise, ±2 s.d." in _legend(figure_simulations(base).axes[2])
    base["verdict"] = "effect"
    assert noise_band(base) == (0.08, "Noise")


def test_the_units_of_the_record_are_on_the_axes():
    base = report("input-delay") | {"units": {"u": "V", "y": "mm"}}
    assert {ax.get_ylabel() for ax in figure_simulations(base).axes} == {"Output $y$ (mm)", "Simulation error (mm)"}
    labels = {text for ax in figure_location(base).axes for text in (ax.get_xlabel(), ax.get_ylabel())}
    assert {"Input $u$ (V)", "Output $y$ (mm)", "Rms error (mm)"} <= labels
    assert not any("units of" in label for label in labels)


def test_lines_do_not_connect_two_records():
    base = report("input-delay")
    t = np.asarray(base["traces"]["t"])
    later = np.where(np.arange(t.size) < t.size // 2, t, t + 300.0)
    whole = figure_simulations(base | {"traces": base["traces"] | {"t": later.tolist()}}).axes[0]
    y = _curve(whole, "Measured").get_ydata()
    assert np.flatnonzero(np.isnan(y)).tolist() == [t.size // 2]
    np.testing.assert_array_equal(y[~np.isnan(y)], base["traces"]["y"])


def test_the_samples_held_back_are_shaded():
    errors = figure_simulations(report("input-delay")).axes[-1]
    spans = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in errors.patches]
    assert spans == [(20.0, 40.0), (80.0, 100.0)]


@WIDTHS
def test_another_record_has_a_panel_of_its_own_and_the_shades_are_there(narrow, covered):
    base = with_holdout(report("input-delay"))
    *_, errors, other = figure_simulations(base, narrow).axes
    assert not errors.patches
    assert [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in other.patches] == [(525.0, 620.0)]
    trace = base["holdout_traces"]
    np.testing.assert_allclose(_curve(other, "After").get_ydata(), np.subtract(trace["y"], trace["after"]))
    assert _curve(other, "After").get_xdata()[0] == 500.0
    assert other.get_title() == "Simulation error on the holdout record"
    assert covered(other.figure) == []
    for ax in other.figure.axes:
        inside = ax.title.get_window_extent().x1 <= other.figure.bbox.x1
        assert inside, ax.get_title()


@WIDTHS
def test_without_a_gap_there_is_one_simulation_and_no_close_look(narrow, covered):
    figure = figure_simulations(report(verdict="none"), narrow)
    whole, errors = figure.axes
    assert _legend(whole) == ["Measured", "Simulated"]
    assert _legend(errors)[0] == "Simulated"
    assert covered(figure) == []


def test_the_close_look_is_where_the_simulation_is_largest_error():
    trace = {name: np.asarray(values) for name, values in report("input-delay")["traces"].items()}
    part = largest_error(trace)
    assert (part.start, part.stop) == (min(max(part.start, 50), 60), part.start + 40)
    short = {name: values[:25] for name, values in trace.items()}
    assert largest_error(short) == slice(0, 25)


@WIDTHS
def test_where_has_time_frequency_range_and_map_with_their_units(narrow, covered):
    base = report("input-delay")
    figure = figure_location(base, narrow)
    time, frequency, cells, chart, bar = figure.axes
    np.testing.assert_allclose([patch.get_height() for patch in time.patches], [0.4, 6.4, 0.16], atol=1e-12)
    np.testing.assert_allclose([patch.get_width() for patch in time.patches], [30.0, 15.0, 75.0])
    np.testing.assert_allclose([patch.get_height() for patch in frequency.patches], [10.0, 70.0, 20.0])
    assert frequency.get_xscale() == "log"
    assert frequency.patches[0].get_x() > 0
    np.testing.assert_allclose([patch.get_height() for patch in cells.patches[:3]], [5.0, 5.0, 90.0])
    np.testing.assert_allclose(cells.patches[3].get_data().values, [25.0, 25.0, 50.0])
    assert _legend(cells) == ["Time", "Gap"] or _legend(cells) == ["Gap", "Time"]
    assert [ax.get_xlabel() for ax in (time, frequency, cells, chart)] == [
        "Time (s)",
        "Frequency (Hz)",
        "Input $u$ (units of u)",
        "Input $u$ (units of u)",
    ]
    assert chart.get_ylabel() == "Output $y$ (units of y)"
    assert "Rms error (units of y)" in (bar.get_ylabel(), bar.get_xlabel())
    assert all(ax.get_title() for ax in (time, frequency, cells, chart))
    assert covered(figure) == []


def test_the_map_shows_the_rms_error_of_each_pair_that_the_record_visits():
    chart = figure_location(report("input-delay")).axes[3]
    (mesh,) = chart.collections
    shown = np.ma.masked_invalid(mesh.get_array())
    np.testing.assert_array_equal(shown.reshape(2, 3).filled(-1.0), [[0.1, 0.2, 0.4], [-1.0, 0.3, 0.2]])
    assert mesh.get_cmap().name == "errors"


def test_the_rate_of_the_output_has_its_own_axis():
    base = report("input-delay")
    base["where"]["operating"] = [
        {"signal": "dy", "low": -1.0, "high": 0.0, "share": 0.2, "time": 0.7},
        {"signal": "dy", "low": 0.0, "high": 1.0, "share": 0.8, "time": 0.3},
    ]
    cells = figure_location(base).axes[2]
    assert cells.get_xlabel() == "Rate of $y$ (units of y a second)"
    assert _legend(cells) == ["Time", "Gap"]


@WIDTHS
def test_the_proposed_input_is_drawn_as_it_would_be_held(narrow):
    base = with_experiment(report("input-delay"))
    (ax,) = figure_experiment(base, narrow).axes
    (line,) = ax.lines
    np.testing.assert_array_equal(line.get_ydata(), base["next_experiment"]["u"])
    assert line.get_drawstyle() == "steps-post"
    assert ax.get_xlabel() == "Time (s)"
    assert ax.get_ylabel() == "Input $u$ (units of u)"


@pytest.mark.parametrize("narrow", [False, True])
def test_the_limits_are_sorted_by_the_smallest_visible_size(narrow):
    figure = figure_limits(with_limits(report(verdict="none")), narrow)
    (ax,) = figure.axes
    assert ax.get_xscale() == "log"
    labels = [" ".join(label.get_text().split()) for label in ax.get_yticklabels()]
    assert labels == [
        "input-backlash (range of u)",
        "input-saturation (range of u)",
        "slow-mode (gain)",
        "input-saturation (range of u)",
        "input-delay (time constant)",
    ]
    marks = {line.get_label(): line.get_xdata() for line in ax.lines}
    assert marks["Visible from here on"] == pytest.approx([0.4, 0.4, 0.4, 30.0, 30.0])
    assert marks["Told from all others"][:3] == pytest.approx([1.0, 1.0, 1.0])
    assert np.isnan(marks["Told from all others"][3:]).all()
    assert marks["Excluded from here on (95 %)"][4] == pytest.approx(20.0)


def test_without_a_visible_effect_there_is_no_figure_of_limits():
    assert "limits" not in figures_as_png(report(verdict="none"))


@WIDTHS
def test_the_first_figure_is_the_worst_stretch_with_its_errors(narrow, covered):
    base = report("input-delay")
    figure = figure_first(base, narrow)
    output, error = figure.axes
    part = largest_error(trace_of(base))
    for label, name in (("Measured", "y"), ("Before", "before"), ("After", "after")):
        np.testing.assert_array_equal(_curve(output, label).get_ydata(), base["traces"][name][part])
    np.testing.assert_allclose(
        _curve(error, "Before").get_ydata(), np.subtract(base["traces"]["y"], base["traces"]["before"])[part]
    )
    assert _title_of(figure) == "Where the gap is largest (units of y)"
    assert _title_of(figure_first(report(verdict="none"), narrow)) == "The whole record (units of y)"
    assert _title_of(figure_first(with_holdout(base), narrow)) == "Where the gap of the holdout is largest (units of y)"
    assert covered(figure) == []


def test_samples_that_do_not_count_set_no_axis_and_no_worst_stretch():
    base = report("input-delay")
    base["traces"]["before"][200] = 900.0
    base["replay"] = {"record": {"start": 0.0, "Ts": 0.5, "fitted": [[0, 200]], "scored": [[201, 240]]}}
    stretch = largest_error(trace_of(base))
    assert not stretch.start <= 200 < stretch.stop
    assert all(ax.get_ylim()[1] < 10.0 for ax in figure_simulations(base).axes)


@WIDTHS
def test_the_rivals_differ_by_so_much_on_the_proposed_input(narrow, covered):
    base = with_experiment(report("input-delay", probability=0.6))
    count = len(base["next_experiment"]["t"])
    base["rivals"] = {"a delay": np.arange(count) / count, "an extra lag": np.zeros(count)}
    figure = figure_experiment(base, narrow)
    np.testing.assert_allclose(_curve(figure.axes[1], "Difference").get_ydata(), np.arange(count) / count)
    assert "a delay less that with an extra lag" in figure.axes[1].get_title().replace("\n", " ")
    assert covered(figure) == []


def test_axes_say_the_names_of_the_columns():
    plain, named = report("input-delay"), with_names(report("input-delay"), "goal", "position $x$")
    assert axis_label(plain, "y") == "Output $y$ (units of y)"
    assert (axis_label(named, "u"), axis_label(named, "y")) == ("goal", r"position \$x\$")
    assert axis_label(named | {"units": {"u": "V", "y": "mm"}}, "y", rate=True) == r"rate of position \$x\$ (mm/s)"
    assert plain_label(named, "y") == "position $x$"
    assert figure_first(named).axes[0].get_ylabel() == r"position \$x\$"
    assert figure_first(plain).axes[0].get_ylabel() == "Output $y$"
