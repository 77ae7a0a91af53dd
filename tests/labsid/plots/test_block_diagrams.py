"""Fig. 2, 3 and 4: the parts that the lab names, connected and signed as its text says."""

import numpy as np
import pytest
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle

from labsid.plots import figure_2, figure_3, figure_4


def _texts(figure):
    return {text.get_text(): np.array(text.get_position()) for text in figure.axes[0].texts}


def _arrow_ends(figure):
    """Tails and heads of all arrows, in the units of the diagram."""
    arrows = [patch for patch in figure.axes[0].patches if isinstance(patch, FancyArrowPatch)]
    return [tuple(np.array(end) for end in arrow._posA_posB) for arrow in arrows]


def _blocks(figure):
    """The text of each block, with its rectangle."""
    rectangles = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    texts = figure.axes[0].texts
    return {
        text.get_text(): rectangle
        for rectangle in rectangles
        for text in texts
        if np.allclose(text.get_position(), rectangle.get_center())
    }


def _enters(figure, rectangle):
    """How many arrows end on the border of a block."""
    x0, y0 = rectangle.get_xy()
    x1, y1 = x0 + rectangle.get_width(), y0 + rectangle.get_height()
    heads = [head for _, head in _arrow_ends(figure)]
    inside = [x0 - 1e-9 <= x <= x1 + 1e-9 and y0 - 1e-9 <= y <= y1 + 1e-9 for x, y in heads]
    return sum(inside)


@pytest.mark.parametrize("draw", [figure_2, figure_3, figure_4])
def test_nothing_lies_on_anything_else(draw, covered):
    assert covered(draw()) == []


@pytest.mark.parametrize("draw", [figure_2, figure_3, figure_4])
def test_text_fits_its_block(draw):
    figure = draw()
    figure.draw_without_rendering()
    for words, rectangle in _blocks(figure).items():
        (text,) = [text for text in figure.axes[0].texts if text.get_text() == words]
        inner, outer = text.get_window_extent(), rectangle.get_window_extent()
        assert outer.x0 < inner.x0, words
        assert inner.x1 < outer.x1, words
        assert outer.y0 < inner.y0, words
        assert inner.y1 < outer.y1, words


@pytest.mark.parametrize("draw", [figure_2, figure_3, figure_4])
def test_circles_are_round_and_axes_hidden(draw):
    (ax,) = draw().axes
    assert ax.get_aspect() == 1.0
    assert not ax.axison


def test_fig_2_takes_u_and_y_into_the_regression_of_n_equations():
    figure = figure_2()
    blocks = _blocks(figure)
    (regression,) = [words for words in blocks if "Regression" in words]
    assert {"Process"} < set(blocks)
    assert any("Computer" in words for words in blocks)
    assert r"$y(k) = \varphi^T(k)\,\theta" in regression
    assert "$N$ equations" in regression
    assert r"Y = \Phi\,\theta" in regression
    assert _enters(figure, blocks[regression]) == 2
    assert _enters(figure, blocks["Process"]) == 1
    taken = {name: position[0] for name, position in _texts(figure).items() if name in ("$u(k)$", "$y(k)$")}
    into_regression = sorted(tail[0] for tail, head in _arrow_ends(figure) if tail[0] == head[0])
    assert into_regression == sorted(taken.values())
    assert taken["$u(k)$"] < blocks["Process"].get_x() < taken["$y(k)$"]


def test_fig_3_adds_the_input_offset_and_subtracts_the_output_offset():
    figure = figure_3()
    texts = figure.axes[0].texts
    junctions = sorted(tuple(patch.get_center()) for patch in figure.axes[0].patches if isinstance(patch, Circle))
    signs = [(t.get_text(), np.array(t.get_position())) for t in texts if t.get_text() in ("$+$", "$-$")]
    # The signs at each junction, from the top down.
    at = [
        [sign for sign, place in sorted(signs, key=lambda s: -s[1][1]) if np.hypot(*(place - centre)) < 1.0]
        for centre in junctions
    ]
    assert at == [["$+$", "$+$"], ["$-$", "$+$"]]
    names = _texts(figure)
    assert names[r"$u_{\mathrm{offset}}$"][0] == junctions[0][0]
    assert names[r"$y_{\mathrm{offset}}$"][0] == junctions[1][0]
    order = ["$u(k)$", r"$u_{\mathrm{in}}(k)$", "$y_m(k)$", "$y(k)$"]
    places = [names[name][0] for name in order]
    assert places == sorted(places)
    blocks = _blocks(figure)
    assert set(blocks) == {"Controller", "Process"}
    assert _enters(figure, blocks["Controller"]) == 2
    process = blocks["Process"].get_center()[0]
    assert places[0] < junctions[0][0] < places[1] < process < places[2] < junctions[1][0] < places[3]


def test_fig_4_compares_process_and_model_on_the_same_input():
    figure = figure_4()
    blocks = _blocks(figure)
    assert set(blocks) == {"Process", "Identified model"}
    assert all(_enters(figure, rectangle) == 1 for rectangle in blocks.values())
    names = _texts(figure)
    assert r"$e(k) = y(k) - \hat{y}(k)$" in names
    assert names["$y(k)$"][1] > names["$+$"][1] > names["$-$"][1] > names[r"$\hat{y}(k)$"][1]
    tails_into_blocks = [tail for tail, head in _arrow_ends(figure) if head[0] == blocks["Process"].get_x()]
    assert len({tail[0] for tail in tails_into_blocks}) == 1  # both branches leave the same wire
