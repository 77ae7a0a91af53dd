"""Figures without pyplot: nothing global is touched, a notebook shows them, and they save."""

import re
import subprocess
import sys
from io import BytesIO
from itertools import combinations
from xml.etree import ElementTree

import matplotlib.style
import numpy as np
import pytest
from figure_faults import OBSERVERS, lab_of

from labsid.plots import figure_4, save_png, save_svg, style
from labsid.plots.page_figures import in_both_widths, page_figure


def _run(program: str) -> str:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_importing_the_figures_does_not_load_matplotlib():
    program = "import labsid.plots, sys; print('matplotlib' in sys.modules)"
    assert _run(program) == "False"


def test_drawing_and_saving_never_loads_pyplot():
    program = (
        "import io, sys; from labsid.plots import figure_4, save_png, save_svg;"
        "save_png(figure_4(), io.BytesIO()); save_svg(figure_4(), io.BytesIO());"
        "print('matplotlib' in sys.modules, 'matplotlib.pyplot' in sys.modules)"
    )
    assert _run(program) == "True False"


def test_png_has_the_size_asked_for(tmp_path):
    path = tmp_path / "figure.png"
    figure = figure_4()
    save_png(figure, path, dpi=50)
    header = path.read_bytes()
    assert header.startswith(b"\x89PNG")
    width, height = (int.from_bytes(header[i : i + 4], "big") for i in (16, 20))
    assert (width, height) == tuple((50 * figure.get_size_inches()).astype(int))


def test_svg_is_a_picture_without_a_date(tmp_path):
    path = tmp_path / "figure.svg"
    save_svg(figure_4(), path)
    root = ElementTree.parse(path).getroot()
    assert root.tag.endswith("svg")
    assert not [element for element in root.iter() if element.tag.endswith("date")]


def test_a_notebook_shows_a_figure_although_no_inline_backend_is_set_up():
    formatters = pytest.importorskip("IPython.core.formatters")
    data, _ = formatters.DisplayFormatter().format(style.new_figure())
    assert data["image/png"].startswith(b"\x89PNG")


def test_a_figure_with_a_description_is_shown_with_it():
    formatters = pytest.importorskip("IPython.core.formatters")
    data, _ = formatters.DisplayFormatter().format(figure_4())
    assert '<img alt="The input u(k) goes to the process' in data["text/html"]


def test_the_same_figure_gives_the_same_png_twice():
    pictures = []
    for _ in range(2):
        buffer = BytesIO()
        save_png(figure_4(), buffer)
        pictures.append(buffer.getvalue())
    assert pictures[0] == pictures[1]


def test_headroom_is_the_share_asked_for():
    ax = style.new_figure().add_subplot()
    ax.plot([0, 1], [-1, 3])
    before = ax.get_ylim()
    style.make_headroom(ax, 0.25)
    lower, upper = ax.get_ylim()
    assert lower == before[0]
    assert (upper - before[1]) / (upper - lower) == pytest.approx(0.25)


@pytest.mark.parametrize("seen_by", OBSERVERS.values(), ids=OBSERVERS)
def test_colours_of_one_panel_stay_apart_for_colour_blind_readers(seen_by):
    panels = [
        (style.VERMILION, style.GREY_BLUE),
        (style.ORANGE, style.BLUE),
        (style.BLACK, style.VERMILION, style.BLUE, style.GREEN),
    ]
    for panel in panels:
        for one, other in combinations(panel, 2):
            assert np.linalg.norm(lab_of(one, seen_by) - lab_of(other, seen_by)) > 20, (one, other)


def test_pages_and_figures_have_the_same_colours() -> None:
    light = re.findall(r"--(before|after): (#\w+)", (style.STYLE_SHEETS / "page.css").read_text(encoding="utf-8"))[:2]
    assert {name: colour.upper() for name, colour in light} == {"before": style.VERMILION, "after": style.BLUE}


def test_the_figures_of_a_page_are_the_same_in_any_style():
    def drawn(report, narrow):
        figure = page_figure(narrow, 3.0, 3.0)
        figure.add_subplot(title="Output (V)").plot([1.0, 2.0])
        return figure

    before = in_both_widths({"output": drawn}, {})
    with matplotlib.style.context([style.NOTEBOOK_STYLE, {"font.size": 20.0}]):
        assert in_both_widths({"output": drawn}, {}) == before
