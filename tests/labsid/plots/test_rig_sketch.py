"""The sketch of the rig: its parts, the way of the water and of the signals, and its alternative text."""

import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch

from labsid.plots import sketch_rig
from labsid.plots.rig_sketch import ALT_TEXT, STREAM_WIDTH
from labsid.plots.style import TEXT_SIZE, new_figure

PARTS = ("Upper tank", "Lower tank", "Reservoir", "Pump", "Computer\n(controller)", "Level\nsensor")


def test_every_part_has_its_name_and_nothing_lies_on_a_name(covered) -> None:
    figure = sketch_rig()
    assert {text.get_text() for text in figure.axes[0].texts} == {*PARTS, "$u$ (V)", "$y$ (V)"}
    assert covered(figure) == []


def test_the_texts_are_readable_at_half_size() -> None:
    assert min(text.get_fontsize() for text in sketch_rig().axes[0].texts) / 2 >= TEXT_SIZE / 2


@pytest.mark.parametrize(("upper", "lower"), [("Upper tank", "Lower tank"), ("Lower tank", "Reservoir")])
def test_each_tank_drains_into_the_next(upper: str, lower: str) -> None:
    figure = sketch_rig()
    height = {text.get_text(): text.get_position()[1] for text in figure.axes[0].texts}
    falls = [
        arrow._posA_posB
        for arrow in figure.axes[0].patches
        if isinstance(arrow, FancyArrowPatch) and arrow.get_linewidth() == STREAM_WIDTH
    ]
    assert any(height[upper] > start[1] > end[1] > height[lower] for start, end in falls)


def test_water_and_signals_differ_in_width_and_in_lightness() -> None:
    arrows = [patch for patch in sketch_rig().axes[0].patches if isinstance(patch, FancyArrowPatch)]
    looks = {(arrow.get_linewidth(), to_rgb(arrow.get_edgecolor())) for arrow in arrows}
    (thin, signal), (thick, water) = sorted(looks)
    assert thick >= 2 * thin
    assert np.dot(water, [0.2126, 0.7152, 0.0722]) > 2 * np.dot(signal, [0.2126, 0.7152, 0.0722])


@pytest.mark.parametrize("inline", [False, True])
def test_a_notebook_gets_the_alternative_text(inline: bool) -> None:
    formatter = DisplayFormatter()
    if inline:  # as the inline backend registers itself
        formatter.formatters["image/png"].for_type(Figure, lambda figure: b"\x89PNG, inline")
    data, _ = formatter.format(sketch_rig())
    assert data["image/png"].startswith(b"\x89PNG")
    assert f'<img alt="{ALT_TEXT}" src="data:image/png;base64,' in data["text/html"]
    assert "text/html" not in formatter.format(new_figure())[0]


def test_the_alternative_text_names_every_part() -> None:
    for part in ("computer", "pump", "reservoir", "upper tank", "lower tank", "sensor", "voltage u", "voltage y"):
        assert part in ALT_TEXT
