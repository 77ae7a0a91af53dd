"""What an effect does, and what is left in the error, as figures."""

from itertools import pairwise

import numpy as np
import pytest
from gap_reports import PARAMETERS, report, seen_effect

from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.effect_curves import effect_curve
from labsid.gap.reports.residual_curves import ResidualCurves
from labsid.gap.reports.response_curves import Response, ResponseCurves
from labsid.model_structures.residuals import autocorrelation, cross_correlation
from labsid.plots.gap_details import figure_effect, figure_residual, figure_responses


@pytest.mark.parametrize("name", [name for name in PARAMETERS if DESCRIPTIONS[name].sketch is not None])
def test_an_effect_is_drawn_beside_a_simulation_without_it(name, covered):
    curve = effect_curve(*seen_effect(name))
    figure = figure_effect(curve)
    (ax,) = figure.axes
    drawn = {line.get_label(): line.get_ydata() for line in ax.lines}
    np.testing.assert_array_equal(drawn["With the effect"], curve["curve"])
    np.testing.assert_array_equal(drawn["Without"], curve["plain"])
    assert covered(figure) == []


def test_a_unit_is_no_mathematics():
    shown = report("input-saturation") | {"units": {"u": "$V$", "y": "mm"}}
    (ax,) = figure_effect(effect_curve(shown, shown["effects"][0])).axes
    assert ax.get_xlabel() == r"Command (\$V\$)"


@pytest.mark.parametrize("narrow", [False, True])
def test_long_numbers_along_a_curve_do_not_touch(narrow):
    """Eight ticks from -80000 to 80000 ran into each other."""
    shown = effect_curve(*seen_effect("input-saturation"))
    shown |= {"x": np.linspace(-81000.0, 81000.0, len(shown["x"])), "marks": []}
    figure = figure_effect(shown, narrow)
    figure.canvas.draw()
    (ax,) = figure.axes
    ends = sorted((box.x0, box.x1) for box in (text.get_window_extent() for text in ax.get_xticklabels()))
    assert len(ends) > 2
    assert all(right < left for (_, right), (left, _) in pairwise(ends))


@pytest.mark.parametrize("narrow", [False, True])
def test_the_residual_has_its_bands_and_the_noise(narrow, covered):
    e, u = np.random.default_rng(0).standard_normal((2, 500))
    f = np.linspace(0.01, 1.0, 50)
    found = ResidualCurves(autocorrelation(e), cross_correlation(u, e), f, 2.0 / f, 1.0 / f)
    figure = figure_residual(report("input-delay") | {"residual": found}, narrow)
    titles = ["Autocorrelation", "Correlation with the input", "Spectrum of the error"]
    assert [ax.get_title() for ax in figure.axes] == titles
    assert [line.get_label() for line in figure.axes[2].lines] == ["Before", "After", "Noise"]
    bands = [sorted(set(ax.patches[0].get_path().vertices[:, 1])) for ax in figure.axes[:2]]
    for (low, high), one in zip(bands, (found.autocorrelation, found.with_input), strict=True):
        scaled = [low, high] if abs(high) != 1.0 else [-one.band, one.band]
        assert scaled == pytest.approx([-one.band, one.band])
    assert covered(figure) == []


@pytest.mark.parametrize("narrow", [False, True])
def test_the_responses_are_drawn_with_the_error_of_the_measured_one(narrow, covered):
    x = np.geomspace(0.01, 1.0, 20)
    gain = 1.0 / (1.0 + 10j * x)
    frequency = Response(x, gain, 0.8 * gain, 0.99 * gain, np.full(x.size, 0.1))
    step = Response(10.0 * x, 1.0 - np.exp(-x), 0.8 * x, x, np.full(x.size, 0.05))
    shown = report("input-delay") | {"units": {"u": "$V$", "y": "mm"}}
    figure = figure_responses(shown | {"responses": ResponseCurves(frequency, step)}, narrow)
    assert [ax.get_title() for ax in figure.axes] == ["Gain", "Phase", "Step response"]
    for ax in figure.axes:
        assert [line.get_label() for line in ax.lines] == ["Measured", "Before", "After"]
        band = ax.collections[0].get_paths()[0].vertices[:, 1]
        measured = ax.lines[0].get_ydata()
        assert band.max() > measured.max()
        assert band.min() < measured.min()
    np.testing.assert_allclose(figure.axes[0].lines[1].get_ydata(), 0.8 * np.abs(gain))
    assert figure.axes[2].get_ylabel() == r"mm / \$V\$"
    assert covered(figure) == []
    (alone,) = figure_responses(shown | {"responses": ResponseCurves(None, step)}, narrow).axes
    assert alone.get_title() == "Step response"
