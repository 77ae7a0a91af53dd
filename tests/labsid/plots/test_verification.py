"""Fig. 7 and 8: the right curves over the right stretch, and the errors in the corner of Fig. 8."""

import re

import numpy as np
import pytest

from labsid.lab.arx import ArxModel
from labsid.lab.simulation import simulate
from labsid.lab.verification import mse, verify
from labsid.plots import figure_7, figure_7_initial_state, figure_8, plot_simulated_on_measured

MODEL = ArxModel([1.0, -1.37746171, 0.39246554], [-0.00666983, 0.05140205], Ts=0.75)
FIRST = ArxModel([1.0, -0.9775761], [0.06811909], Ts=0.75)


@pytest.fixture(scope="module")
def run():
    """t, y and the input of a rig that is not at rest at the half."""
    u = np.repeat([0.0, -0.4, 0.2, 0.0, -0.4], [51, 200, 190, 210, 150])
    noise = 0.01 * np.random.default_rng(1).standard_normal(u.size)
    return 0.75 * np.arange(u.size), simulate(MODEL, u) + noise, u


def _legend(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def _curve(ax, label):
    (line,) = [line for line in ax.lines if line.get_label() == label]
    return line


def test_fig_7_compares_the_second_half_and_the_whole(run, covered):
    t, y, u = run
    verification = verify(MODEL, u, y)
    figure = figure_7(t, y, verification)
    upper, lower = figure.axes
    half = u.size // 2
    for ax, start, y_sim in ((upper, half, verification.y_second_half), (lower, 0, verification.y_all)):
        np.testing.assert_array_equal(_curve(ax, "Actual output").get_ydata(), y[start:])
        np.testing.assert_array_equal(_curve(ax, "Simulated output").get_ydata(), y_sim)
        np.testing.assert_array_equal(_curve(ax, "Simulated output").get_xdata(), t[start:])
        assert ax.get_xlim() == (t[start], t[-1])
        assert ax.get_xlabel() == "Time (s)"
        assert ax.get_ylabel() == "Output $y$ (V)"
    assert upper.get_title().startswith("(a) Second half")
    assert lower.get_title().startswith("(b) Entire")
    assert covered(figure) == []


def test_fig_7_a_starts_from_zero_while_the_output_does_not(run):
    t, y, u = run
    upper = figure_7(t, y, verify(MODEL, u, y)).axes[0]
    assert _curve(upper, "Simulated output").get_ydata()[0] == 0
    assert abs(_curve(upper, "Actual output").get_ydata()[0]) > 0.2


def test_fig_7_initial_state_shows_all_three_starts_and_their_errors(run, covered):
    t, y, u = run
    verification = verify(MODEL, u, y)
    figure = figure_7_initial_state(t, y, verification)
    upper, lower = figure.axes
    actual = y[u.size // 2 :]
    for label, y_sim in (
        ("From rest", verification.y_second_half),
        ("State carried over", verification.y_second_half_carried),
        ("State estimated", verification.y_second_half_estimated),
    ):
        np.testing.assert_array_equal(_curve(upper, label).get_ydata(), y_sim)
        np.testing.assert_array_equal(_curve(lower, label).get_ydata(), actual - y_sim)
    assert _legend(upper) == ["Actual output", "From rest", "State carried over", "State estimated"]
    assert "(V)" in upper.get_ylabel()
    assert "(V)" in lower.get_ylabel()
    errors = {line.get_label(): np.abs(line.get_ydata()[:20]).max() for line in lower.lines}
    assert errors["From rest"] > 0.2 > 5 * errors["State carried over"]
    assert errors["State estimated"] < 0.1
    assert covered(figure) == []


@pytest.mark.parametrize("draw", [figure_7, figure_7_initial_state])
def test_fig_7_refuses_another_record(run, draw):
    t, y, u = run
    with pytest.raises(ValueError, match=r"verified, 801 samples; got 800\. Pass the offset-free y"):
        draw(t[:-1], y[:-1], verify(MODEL, u, y))


def test_fig_8_has_the_three_curves(run):
    t, y, u = run
    first, second = simulate(FIRST, u), simulate(MODEL, u)
    (ax,) = figure_8(t, y, first, second, mse(y, first), mse(y, second)).axes
    assert _legend(ax) == ["Actual output", "First-order model", "Second-order model"]
    for label, values in zip(_legend(ax), (y, first, second), strict=True):
        np.testing.assert_array_equal(_curve(ax, label).get_ydata(), values)
    assert len({line.get_color() for line in ax.lines}) == 3
    assert ax.get_xlabel() == "Time (s)"
    assert ax.get_ylabel() == "Output $y$ (V)"


@pytest.mark.parametrize("scale", [1.0, -1.0, 1e-3])
def test_fig_8_errors_stand_in_the_top_left_corner_clear_of_everything(run, covered, scale):
    t, y, u = run
    first, second = simulate(FIRST, u), simulate(MODEL, u)
    figure = figure_8(t, scale * y, scale * first, scale * second, 9.2428e-4, 8.9450e-4)
    assert covered(figure) == []
    (ax,) = figure.axes
    (text,) = ax.texts
    box, frame = text.get_bbox_patch().get_window_extent(), ax.get_window_extent()
    assert not box.overlaps(ax.get_legend().get_window_extent())
    assert 0 < box.x0 - frame.x0 < 0.05 * frame.width
    assert 0 < frame.y1 - box.y1 < 0.05 * frame.height


@pytest.mark.parametrize("value", [9.2428e-4, 8.9450e-4, 0.0, 12.5, 1e-12])
def test_fig_8_writes_the_errors_that_it_was_given(run, value):
    t, y, _ = run
    (ax,) = figure_8(t, y, y, y, value, 2 * value).axes
    written = ax.texts[0].get_text().translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    found = re.findall(r"order: ([\d.]+)×10(-?\d+) V", written)
    numbers = [float(f"{mantissa}e{exponent}") for mantissa, exponent in found]
    assert numbers == pytest.approx([value, 2 * value], rel=1e-3)


def test_plot_simulated_on_measured_names_the_curve(run):
    t, y, u = run
    ax = plot_simulated_on_measured(t, y, simulate(FIRST, u), label="Another model")
    assert [line.get_label() for line in ax.lines] == ["Actual output", "Another model"]
    assert plot_simulated_on_measured(t, y, y, ax=ax) is ax


def test_plot_simulated_on_measured_refuses_a_length_mismatch():
    with pytest.raises(ValueError, match="t and y and y_sim must have equal length; got 3 and 3 and 2"):
        plot_simulated_on_measured([0, 1, 2], [0, 0, 0], [0, 0])
