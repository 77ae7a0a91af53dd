"""Figures in one style: what is found in planted ones, and that nothing is found in those of the project."""

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jupytext
import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from figure_faults import PAGE, distance, faults_of
from gap_reports import report, with_experiment, with_holdout, with_limits
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from one_answer import work_folder
from representatives import mostly_exhaustive

from autograder.course.layout import Course
from autograder.demonstration import draw_figures
from labsid.checks.notebook import assignment_names
from labsid.plots import gap, style

ROOT = Path(__file__).resolve().parent.parent
NOTEBOOKS = ROOT / "notebooks"
DESCRIBED = re.compile(r"\*\*(Expected figure|Interpretation)|\*Fig\.")
DRAWS = re.compile(r"plt\.(subplots|figure)\(|\bfigure_\w+\(|^enlarge\(", re.MULTILINE)


@pytest.fixture(autouse=True)
def own_settings() -> Iterator[None]:
    with mpl.rc_context():
        mpl.use("Agg")
        yield
    plt.close("all")


def good(ax: Axes) -> None:
    t = np.linspace(0, 1, 50)
    ax.plot(t, np.sin(9 * t), color=style.BLACK, label="Measured")
    ax.plot(t, 0.9 * np.sin(9 * t), color=style.BLUE, label="Simulated")
    ax.axhline(0, color="0.5")
    ax.set_ylim(-1, 2)
    ax.legend(loc="upper right", fontsize=10)


def small_text(ax: Axes) -> None:
    good(ax)
    ax.set_title("Too small", fontsize=7)


def small_text_where_it_is_shown(ax: Axes) -> None:
    good(ax)
    ax.figure.set_size_inches(12.0, 4.0)
    ax.set_title("Small in a column", fontsize=12)


def legend_over_contours(ax: Axes) -> None:
    x = np.linspace(-1, 1, 21)
    ax.contour(x, x, x**2 + x[:, np.newaxis] ** 2, colors="0.6")
    ax.plot(0, 0, "o", color=style.BLUE, label="Minimum")
    ax.legend(loc="upper right", fontsize=10)


def legend_over_a_curve(ax: Axes) -> None:
    good(ax)
    ax.set_ylim(-1, 1)
    ax.legend(loc="upper left", fontsize=10)


def legend_over_points(ax: Axes) -> None:
    ax.scatter(np.linspace(0, 1, 20), np.linspace(0, 1, 20), color=style.BLUE, label="Points")
    ax.legend(loc="center", fontsize=10)


def legend_over_markers(ax: Axes) -> None:
    ax.plot(np.linspace(0, 1, 20), np.linspace(0, 1, 20), "o", color=style.BLUE, label="Points")
    ax.legend(loc="center", fontsize=10)


def legend_over_bars(ax: Axes) -> None:
    ax.bar([0, 1, 2], [3, 3, 3], color=style.BLUE, label="Bars")
    ax.legend(loc="lower left", fontsize=10)


def colour_of_another_palette(ax: Axes) -> None:
    good(ax)
    ax.lines[1].set_color("tab:blue")


def bars_of_another_palette(ax: Axes) -> None:
    ax.bar([0, 1], [1, 2], color="tab:purple")


def merging_curves(ax: Axes) -> None:
    good(ax)
    ax.lines[0].set_color("#888888")
    ax.lines[1].set_color(style.CYCLE[4])


@pytest.mark.parametrize(
    ("draw", "fault"),
    [
        (small_text, "'Too small' has 7.3 pt"),
        (small_text_where_it_is_shown, "'Small in a column' has 7.3 pt"),
        (legend_over_contours, "axes 0: the legend lies over"),
        (legend_over_a_curve, "axes 0: the legend lies over 'Measured'"),
        (legend_over_points, "axes 0: the legend lies over 'Points'"),
        (legend_over_markers, "axes 0: the legend lies over 'Points'"),
        (legend_over_bars, "axes 0: the legend lies over"),
        (colour_of_another_palette, "axes 0: 'Simulated' has a colour without a role, #1f77b4"),
        (bars_of_another_palette, "has a colour without a role, #9467bd"),
        (merging_curves, "axes 0: 'Measured' and 'Simulated' merge"),
    ],
)
def test_a_fault_is_found(draw: Callable[[Axes], None], fault: str) -> None:
    figure = Figure()
    draw(figure.subplots())
    assert any(fault in found for found in faults_of(figure))


def different_line_styles(ax: Axes) -> None:
    merging_curves(ax)
    ax.lines[1].set_linestyle("--")


def colour_mixed_with_white(ax: Axes) -> None:
    good(ax)
    ax.axvspan(0.2, 0.4, color=(style.BLUE, 0.2))
    ax.axvspan(0.4, 0.5, color="#BAD9EA")  # 27 % of the blue


def legend_beside_contours(ax: Axes) -> None:
    legend_over_contours(ax)
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1), fontsize=10)


def wide_diagram(ax: Axes) -> None:
    ax.figure.set_size_inches(12.0, 2.0)
    ax.set_axis_off()
    ax.text(0, 0, "Process", fontsize=14)


def colours_of_numbers(ax: Axes) -> None:
    ax.pcolormesh(np.arange(12.0).reshape(3, 4))


@pytest.mark.parametrize(
    "draw",
    [
        good,
        different_line_styles,
        colour_mixed_with_white,
        colours_of_numbers,
        legend_beside_contours,
        wide_diagram,
    ],
)
def test_a_right_figure_has_no_fault(draw: Callable[[Axes], None]) -> None:
    figure = Figure()
    draw(figure.subplots())
    assert faults_of(figure) == []


def test_the_colours_of_the_notebooks_are_those_of_the_pages() -> None:
    plt.style.use(style.NOTEBOOK_STYLE)
    cycle = [entry["color"] for entry in mpl.rcParams["axes.prop_cycle"]]
    assert [to_hex(one) for one in cycle] == [one.lower() for one in style.CYCLE]
    assert not mpl.rcParams["axes.grid"]  # which would answer a question in the place of the student


def test_the_first_colours_of_the_cycle_stay_apart_for_all_readers() -> None:
    first = style.CYCLE[:4]
    assert min(distance(one, other) for one in first for other in first if one != other) > 18


def test_the_figures_of_the_lab_have_no_fault(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    drawn: dict[str, Figure] = {}
    monkeypatch.setattr("labsid.plots.save_png", lambda figure, path: drawn.setdefault(path.stem, figure))
    list(draw_figures(Course(ROOT), tmp_path))
    assert len(drawn) == 11
    assert {name: found for name, figure in drawn.items() if (found := faults_of(figure))} == {}


@pytest.mark.parametrize("narrow", [False, True])
@pytest.mark.parametrize(
    "draw", [gap.figure_first, gap.figure_simulations, gap.figure_location, gap.figure_limits, gap.figure_experiment]
)
def test_the_figures_of_a_diagnosis_have_no_fault(draw: Callable[..., Figure], narrow: bool) -> None:
    base = with_limits(with_experiment(with_holdout(report("input-delay"))))
    assert faults_of(draw(base, narrow), PAGE) == []


def figures_of(name: str) -> Iterator[tuple[str, Figure]]:
    """Run a notebook with its solutions; yield each figure with the grade_id of its cell."""
    variables: dict[str, Any] = {}
    for cell in jupytext.read(NOTEBOOKS / name / f"{name}.md", fmt="md:myst").cells:
        if cell.cell_type != "code":
            continue
        grade_id = str(cell.metadata["nbgrader"]["grade_id"])
        body = ast.parse(cell.source).body
        last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), grade_id, "exec"), variables)
        shown = eval(compile(ast.Expression(last.value), grade_id, "eval"), variables) if last is not None else None
        figures = [plt.figure(number) for number in plt.get_fignums()]
        for figure in figures + ([shown] if isinstance(shown, Figure) and shown not in figures else []):
            yield grade_id, figure
        plt.close("all")


@pytest.mark.parametrize("name", mostly_exhaustive(assignment_names(), ["prelab-sinusoids"]))
def test_the_figures_of_a_notebook_have_no_fault(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with work_folder():
        for data in ("SysIdenData_StudentVersion.mat", "WithheldRig.csv"):
            Path(data).write_bytes((ROOT / "data" / data).read_bytes())
        found = [f"{grade_id}: {fault}" for grade_id, figure in figures_of(name) for fault in faults_of(figure)]
    assert found == []


@pytest.mark.parametrize("name", assignment_names())
def test_a_notebook_uses_the_style_and_no_other_colours(name: str) -> None:
    source = (NOTEBOOKS / name / f"{name}.md").read_text(encoding="utf-8")
    assert source.count(f'plt.style.use("{style.NOTEBOOK_STYLE}")') == 1
    assert not re.findall(r"tab:\w+|xkcd:\w+", source)


@pytest.mark.parametrize("name", assignment_names())
def test_every_figure_of_a_notebook_is_described_in_words(name: str) -> None:
    """Figures of `labsid.plots` in their alternative text, those that a cell draws in the text below it."""
    cells = jupytext.read(NOTEBOOKS / name / f"{name}.md", fmt="md:myst").cells
    missing = []
    for number, cell in enumerate(cells):
        if cell.cell_type != "code" or not DRAWS.search(cell.source) or "def enlarge" in cell.source:
            continue
        grade_id = str(cell.metadata["nbgrader"]["grade_id"])
        after = [one.source for one in cells[number + 1 : number + 4] if one.cell_type == "markdown"]
        if not any(DESCRIBED.search(text) for text in after) and not _has_alternative_text(cell.source):
            missing.append(grade_id)
    assert missing == []


def _has_alternative_text(source: str) -> bool:
    from labsid import plots
    from labsid.plots import lecture_diagrams

    called = re.fullmatch(r"(?:plots\.)?(figure_\w+)\(\)", source.strip())
    if called is None:
        return False
    draw = getattr(lecture_diagrams, called[1], None) or getattr(plots, called[1])
    return bool(draw().alt)
