"""Fig. 1, 5, 6 and the offsets: what is drawn is what the lab describes."""

import numpy as np
import pytest

from labsid.lab.offset import find_offsets, mean_of_first_period, remove_offsets
from labsid.lab.sinusoid import cut_off, make_sinusoids
from labsid.plots import figure_1, figure_5, figure_6, figure_offsets, plot_input
from labsid.records.record import Record, load_record


def _legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def _record(start=0.0, columns=True):
    """A first-order rig that starts `start` volts below its rest level."""
    Ts, rng = 0.75, np.random.default_rng(3)
    u = np.repeat([2.0, 1.6, 2.2, 2.0], 200)
    deviation = np.empty(u.size)
    deviation[0] = -start
    for k in range(1, u.size):
        deviation[k] = 0.97 * deviation[k - 1] + 0.09 * (u[k - 1] - 2.0)
    measured = 2.3 + deviation + 0.01 * rng.standard_normal(u.size)
    reduced = np.convolve(np.r_[np.full(4, measured[0]), measured], np.full(5, 0.2), "valid")
    both = {"y_measured": measured, "y_noise_reduced": reduced} if columns else {}
    return Record(Ts * np.arange(u.size), u, reduced, Ts, **both)


@pytest.fixture(scope="module")
def sinusoids():
    return make_sinusoids(np.random.default_rng(0))


def test_fig_1_limits_titles_labels_grid_and_legend(sinusoids):
    upper, lower = figure_1(sinusoids).axes
    assert upper.get_title() == "(a) Original data"
    assert lower.get_title() == "(b) Cut-off data"
    for ax in (upper, lower):
        assert ax.get_xlim() == (0, 140)
        assert ax.get_ylim() == (-1.5, 1.5)
        assert ax.get_xlabel() == "Time (s)"
        assert ax.get_ylabel() == "Amplitude"
        assert all(line.get_visible() for line in ax.get_xgridlines() + ax.get_ygridlines())
        assert _legend(ax) == ["sin(0.02πt)", "cos(0.02πt)"]
    assert upper.get_position().y0 > lower.get_position().y1


def test_fig_1_draws_the_original_and_the_cut_off_data(sinusoids):
    cut = cut_off(sinusoids)
    upper, lower = figure_1(sinusoids).axes
    for ax, t, y1, y2 in (
        (upper, sinusoids.t, sinusoids.y1, sinusoids.y2),
        (lower, cut.t_new, cut.y1_new, cut.y2_new),
    ):
        for line, y in zip(ax.lines, (y1, y2), strict=True):
            np.testing.assert_array_equal(line.get_xdata(), t[:, 0])
            np.testing.assert_array_equal(line.get_ydata(), y[:, 0])


def test_fig_1_cosine_is_the_grey_blue_in_both_panels_and_a_stair(sinusoids):
    for ax in figure_1(sinusoids).axes:
        sine, cosine = ax.lines
        assert cosine.get_color() == (0.6, 0.7, 0.8)
        assert cosine.get_drawstyle() == "steps-post"
        assert sine.get_drawstyle() == "default"
        assert sine.get_color() != cosine.get_color()
    upper, lower = figure_1(sinusoids).axes
    assert [line.get_color() for line in upper.lines] == [line.get_color() for line in lower.lines]


def test_fig_1_legend_stands_where_there_are_no_data(sinusoids, covered):
    assert covered(figure_1(sinusoids)) == []


def test_fig_5_shows_both_outputs_and_the_input_as_stairs(covered):
    record = _record()
    figure = figure_5(record)
    upper, lower = figure.axes
    measured, reduced = upper.lines
    np.testing.assert_array_equal(measured.get_ydata(), record.y_measured)
    np.testing.assert_array_equal(reduced.get_ydata(), record.y_noise_reduced)
    assert _legend(upper) == ["Measured output", "Noise-reduced output"]
    (line,) = lower.lines
    np.testing.assert_array_equal(line.get_xdata(), record.t)
    np.testing.assert_array_equal(line.get_ydata(), record.u)
    assert line.get_drawstyle() == "steps-post"
    assert [ax.get_xlabel() for ax in figure.axes] == ["Time (s)"] * 2
    assert [ax.get_ylabel() for ax in figure.axes] == ["Output (V)", "Input (V)"]
    assert upper.get_title() == "(a) Noise-reduced and measured output signals"
    assert lower.get_title() == "(b) Actual input signal"
    assert covered(figure) == []


def test_fig_5_of_a_record_with_one_output_shows_that_one(covered):
    record = _record(columns=False)
    figure = figure_5(record)
    (line,) = figure.axes[0].lines
    np.testing.assert_array_equal(line.get_ydata(), record.y)
    assert figure.axes[0].get_title() == "(a) Output signal"
    assert covered(figure) == []


def test_fig_6_begins_from_zero():
    record = _record()
    u, y = remove_offsets(record.u, record.y, find_offsets(record.u, record.y))
    upper, lower = figure_6(record.t, y, u).axes
    output, inputs = upper.lines[0], lower.lines[0]
    np.testing.assert_array_equal(output.get_ydata(), y)
    np.testing.assert_array_equal(inputs.get_ydata(), u)
    assert inputs.get_drawstyle() == "steps-post"
    assert abs(output.get_ydata()[0]) < 0.02
    assert inputs.get_ydata()[0] == 0
    assert upper.get_title() == "(a) Offset-free output signal (noise-reduced)"
    assert lower.get_title() == "(b) Offset-free input signal"
    assert [ax.get_ylabel() for ax in (upper, lower)] == ["Output $y$ (V)", "Input $u$ (V)"]
    assert all(ax.get_xlim() == (record.t[0], record.t[-1]) for ax in (upper, lower))


def test_fig_6_refuses_signals_of_different_length():
    with pytest.raises(ValueError, match="t and y and u must have equal length; got 3 and 3 and 2"):
        figure_6([0, 1, 2], [0, 0, 0], [0, 0])


def test_offsets_of_an_empty_tank_show_how_far_the_whole_mean_is_off(covered):
    record = _record(start=2.3)
    offsets = find_offsets(record.u, record.y)
    figure = figure_offsets(record, offsets)
    upper, lower = figure.axes
    levels = {line.get_label(): line.get_ydata()[0] for line in upper.lines if "Mean" in line.get_label()}
    whole = mean_of_first_period(record.u, record.y)
    assert levels == {
        f"Mean of whole period: {whole:.3f} V": whole,
        f"Mean of settled part: {offsets.y_offset:.3f} V": offsets.y_offset,
    }
    assert offsets.y_offset - whole > 0.2
    (shaded,) = upper.patches
    k0, k1 = offsets.settled
    assert shaded.get_x() == record.t[k0]
    assert shaded.get_x() + shaded.get_width() == pytest.approx(record.t[k1 - 1])
    assert upper.get_xlim() == lower.get_xlim() == (0.0, record.t[2 * offsets.first_period - 1])
    assert upper.get_ylabel() == "Output (V)"
    assert lower.get_xlabel() == "Time (s)"


def test_offsets_say_so_where_nothing_has_settled():
    record = _record(start=2.3)
    # Fifteen samples before the change: the tank is still filling.
    early = Record(record.t[: 15 + 200], np.r_[record.u[:15], record.u[200:400]], record.y[: 15 + 200], record.Ts)
    offsets = find_offsets(early.u, early.y)
    assert offsets.status == "not settled"
    labels = _legend(figure_offsets(early, offsets).axes[0])
    assert "Averaged part (not settled)" in labels
    assert not any("Settled" in label for label in labels)


def test_plot_input_draws_into_given_axes_or_its_own():
    own = plot_input([0, 1, 2], [1, 2, 2])
    assert own.lines[0].get_color() == plot_input([0, 1], [0, 1], ax=own).lines[1].get_color()
    assert len(own.figure.axes) == 1


@pytest.mark.parametrize("name", ["SysIdenData_StudentVersion", "SysIdenData_4", "SysIdenData_8"])
def test_real_records_are_drawn_with_nothing_on_the_data(shared_data, covered, name):
    record = load_record(shared_data / "unsw-water-tank" / f"{name}.mat")
    assert covered(figure_5(record)) == []
    figure_offsets(record, find_offsets(record.u, record.y)).draw_without_rendering()
