"""Fig. A1 and A2: the construction stands where the numbers say, for steps up and down, clean and noisy."""

import numpy as np
import pytest
from matplotlib.patches import FancyArrowPatch

from labsid.lab.step_comparison import compare_with_approximation, second_order_example
from labsid.lab.step_response import (
    FirstOrderDelay,
    cut_held_step,
    first_order_response,
    fit_step_response,
)
from labsid.plots import figure_a1, figure_a2
from labsid.records.record import load_record


def _response(model, amplitude, span, level=0.0, noise=0.0):
    t = np.arange(-2.0, span, 0.1).round(10)
    rng = np.random.default_rng(5)
    y = level + first_order_response(model, t, amplitude) + noise * rng.standard_normal(t.size)
    return t, y, fit_step_response(t, y, amplitude)


def _spans(ax):
    return [arrow._posA_posB for arrow in ax.patches if isinstance(arrow, FancyArrowPatch)]


@pytest.fixture(scope="module")
def comparison():
    return compare_with_approximation(second_order_example(), np.linspace(0, 30, 301), 2.0)


@pytest.mark.parametrize("amplitude", [2.0, -2.0])
def test_fig_a1_marks_gain_time_constant_and_delay_where_they_are(amplitude):
    t, y, fit = _response(FirstOrderDelay(K=3.0, tau=5.0, td=1.5), amplitude, 35.0, level=2.0)
    (ax,) = figure_a1(t, y, fit).axes
    horizontal = sorted(
        (sorted((start[0], end[0])) for start, end in _spans(ax) if start[1] == end[1]), key=lambda xs: xs[0]
    )
    np.testing.assert_allclose(horizontal, [[0.0, 1.5], [1.5, 6.5]], atol=0.02)  # td, then tau
    (vertical,) = [(start[1], end[1]) for start, end in _spans(ax) if start[0] == end[0]]
    np.testing.assert_allclose(vertical, [2.0, 2.0 + 3.0 * amplitude], atol=0.02)
    points = [line for line in ax.lines if line.get_marker() == "o"]
    marked = [(line.get_xdata()[0], line.get_ydata()[0]) for line in points]
    expected = [(1.5 + 5 / 3, 2 + 0.283 * 3 * amplitude), (6.5, 2 + 0.632 * 3 * amplitude)]
    np.testing.assert_allclose(marked, expected, atol=0.03)
    texts = [text.get_text() for text in ax.texts]
    assert {"28.3 %", "63.2 %", r"$\tau$", "$t_d$"} <= set(texts)
    (values,) = [text for text in texts if "V/V" in text]
    K, tau, td = (float(line.split(" = ")[1].split()[0]) for line in values.splitlines())
    assert (K, tau, td) == pytest.approx((3.0, 5.0, 1.5), abs=0.02)


def test_fig_a1_draws_the_response_and_the_model_as_read():
    t, y, fit = _response(FirstOrderDelay(K=3.0, tau=5.0, td=1.5), 2.0, 35.0, level=1.0, noise=0.02)
    (ax,) = figure_a1(t, y, fit).axes
    response, model = ax.lines[:2]
    np.testing.assert_array_equal(response.get_ydata(), y)
    expected = fit.y_initial + first_order_response(fit.reading, t, 2.0)
    np.testing.assert_array_equal(model.get_ydata(), expected)
    assert ax.get_title() == "Response to a step of $a$ = 2 V at $t$ = 0"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("Time (s)", "Output (V)")


def test_fig_a1_writes_a_negative_step_with_a_minus_sign():
    t, y, fit = _response(FirstOrderDelay(K=3.0, tau=5.0, td=1.5), -2.0, 35.0)
    assert figure_a1(t, y, fit).axes[0].get_title() == "Response to a step of $a$ = −2 V at $t$ = 0"


def test_fig_a1_leaves_out_the_arrow_of_a_delay_that_is_too_short_for_it():
    t, y, fit = _response(FirstOrderDelay(K=3.0, tau=5.0, td=0.0), 2.0, 35.0)
    (ax,) = figure_a1(t, y, fit).axes
    assert len(_spans(ax)) == 2
    assert "$t_d$" not in [text.get_text() for text in ax.texts]


@pytest.mark.parametrize("amplitude", [2.0, -0.4])
@pytest.mark.parametrize("td", [0.0, 0.6, 4.0])
@pytest.mark.parametrize("span", [15.0, 35.0, 60.0])
def test_fig_a1_texts_and_legend_cover_nothing(covered, amplitude, td, span):
    t, y, fit = _response(FirstOrderDelay(K=3.0, tau=5.0, td=td), amplitude, span, noise=0.005)
    assert covered(figure_a1(t, y, fit)) == []


def test_fig_a2_shows_both_systems_and_both_responses(comparison, covered):
    figure = figure_a2(comparison)
    diagram, responses = figure.axes
    texts = [text.get_text() for text in diagram.texts]
    assert r"$\dfrac{3}{5s^2 + 6s + 1}$" in texts
    model = comparison.fit.model
    assert any(f"{model.K:.3g}" in text and f"e^{{-{model.td:.3g}s}}" in text for text in texts)
    assert "Step\n$a$ = 2 V" in texts
    original, approximate = responses.lines
    np.testing.assert_array_equal(original.get_ydata(), comparison.y_original)
    np.testing.assert_array_equal(approximate.get_ydata(), comparison.y_approximate)
    assert f"{100 * comparison.largest_error:.1f} %" in responses.get_title()
    assert (responses.get_xlabel(), responses.get_ylabel()) == ("Time (s)", "Output (V)")
    assert covered(figure) == []


def test_fig_a2_of_a_step_down_moves_its_legend_out_of_the_way(covered):
    down = compare_with_approximation(second_order_example(), np.linspace(0, 30, 301), -2.0)
    assert covered(figure_a2(down)) == []


@pytest.mark.parametrize("change", [0, 1, 2])
def test_fig_a1_of_the_real_rig(shared_data, covered, change):
    record = load_record(shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat")
    t, y, amplitude = cut_held_step(record.u, record.y, record.Ts, change)
    assert covered(figure_a1(t, y, fit_step_response(t, y, amplitude))) == []


def test_fig_a1_refuses_other_samples_than_were_fitted():
    t, y, fit = _response(FirstOrderDelay(K=3.0, tau=5.0, td=1.5), 2.0, 35.0)
    with pytest.raises(ValueError, match=r"fitted, 370 of them; got 369\. Pass the t and y given to"):
        figure_a1(t[:-1], y[:-1], fit)
