"""The block diagrams of the Reading notes: their parts, connected and signed as the text says."""

import numpy as np
import pytest
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle

from labsid.plots.lecture_diagrams import (
    FIVE_STEPS,
    figure_computer_control,
    figure_dynamical_system,
    figure_five_steps,
    figure_systems_1_and_2,
)

ALL = [figure_dynamical_system, figure_five_steps, figure_computer_control, figure_systems_1_and_2]


def _texts(ax):
    return [text.get_text() for text in ax.texts]


def _arrows(ax):
    """Tails and heads of the arrows' last stretches."""
    arrows = [patch for patch in ax.patches if isinstance(patch, FancyArrowPatch)]
    return [tuple(np.array(end) for end in arrow._posA_posB) for arrow in arrows]


def _blocks(ax):
    rectangles = [patch for patch in ax.patches if isinstance(patch, Rectangle)]
    return {
        text.get_text(): rectangle
        for rectangle in rectangles
        for text in ax.texts
        if np.allclose(text.get_position(), rectangle.get_center())
    }


def _entering(ax, rectangle):
    x0, y0 = rectangle.get_xy()
    x1, y1 = x0 + rectangle.get_width(), y0 + rectangle.get_height()
    return sum(x0 - 1e-9 <= x <= x1 + 1e-9 and y0 - 1e-9 <= y <= y1 + 1e-9 for _, (x, y) in _arrows(ax))


@pytest.mark.parametrize("draw", ALL)
def test_nothing_lies_on_anything_else(draw, covered):
    assert covered(draw()) == []


@pytest.mark.parametrize("draw", ALL)
def test_text_fits_its_block(draw):
    figure = draw()
    figure.draw_without_rendering()
    for ax in figure.axes:
        for words, rectangle in _blocks(ax).items():
            (text,) = [text for text in ax.texts if text.get_text() == words]
            inner, outer = text.get_window_extent(), rectangle.get_window_extent()
            assert outer.x0 < inner.x0 < inner.x1 < outer.x1, words
            assert outer.y0 < inner.y0 < inner.y1 < outer.y1, words


def test_figure_1_has_two_inputs_and_an_output():
    (ax,) = figure_dynamical_system().axes
    assert set(_texts(ax)) == {"System", "$u(t)$", "$y(t)$", "$v(t)$"}
    system = _blocks(ax)["System"]
    assert _entering(ax, system) == 2
    assert len(_arrows(ax)) == 3


def test_the_five_steps_are_in_order_and_go_back():
    (ax,) = figure_five_steps().axes
    blocks = _blocks(ax)
    centres = [blocks[step].get_center()[0] for step in FIVE_STEPS]
    assert centres == sorted(centres)
    # from the step before, and from the validation: to a new experiment or to a new structure
    assert [_entering(ax, blocks[step]) for step in FIVE_STEPS] == [1, 1, 2, 1, 1]


def test_figure_2_identifies_from_what_it_controls_with():
    (ax,) = figure_computer_control().axes
    blocks = _blocks(ax)
    # control: set point, measurement and parameters; identification: input and output
    entering = {name: _entering(ax, rectangle) for name, rectangle in blocks.items()}
    assert entering == {"Control": 3, "Identification": 2, "D/A": 1, "Process": 1, "A/D": 1}
    (computer,) = [patch for patch in ax.patches if isinstance(patch, Rectangle) and patch not in blocks.values()]
    inside = {name for name, block in blocks.items() if computer.get_bbox().contains(*block.get_center())}
    assert inside == {"Control", "Identification"}


def test_figure_6_has_the_noise_inside_the_loop_and_behind_it():
    for ax, title, junctions in zip(figure_systems_1_and_2().axes, ("System 1", "System 2"), (1, 2), strict=True):
        assert ax.get_title() == title
        circles = [patch for patch in ax.patches if isinstance(patch, Circle)]
        assert len(circles) == junctions
        assert ("$x(t)$" in _texts(ax)) == (title == "System 2")
        (back,) = [block for words, block in _blocks(ax).items() if "0.8" in words]
        noise = [x for (x, y), (_, end) in _arrows(ax) if y > end > back.get_center()[1] and x == circles[-1].center[0]]
        assert len(noise) == 1
        loop = back.get_x() + back.get_width()
        assert (noise[0] < loop) == (title == "System 1")
        assert _texts(ax).count("$+$") == junctions + 1 - (title == "System 2")
