"""Pictures of figures, drawn from the plain data."""

import base64
import math
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from matplotlib.figure import Figure

from autograder.judge.picture import MAX_POINTS, figure_svg, words_of
from labsid.plots.describe import describe_figure
from labsid.plots.figure_values import AxesValue, CurveValue, FigureValue

SVG = "{http://www.w3.org/2000/svg}"


def drawn(figure: FigureValue) -> ElementTree.Element:
    return ElementTree.fromstring(base64.b64decode(figure_svg(figure)))


def texts(root: ElementTree.Element) -> list[str]:
    return [element.text or "" for element in root.iter(f"{SVG}text")]


def curves(root: ElementTree.Element) -> list[str]:
    groups = [group for group in root.iter(f"{SVG}g") if "clip-path" in group.attrib]
    return [path.attrib["d"] for group in groups for path in group.iter(f"{SVG}path")]


def test_a_figure_shows_its_curves_labels_and_legend() -> None:
    figure = Figure()
    upper, lower = figure.subplots(2, 1)
    upper.plot([0, 1, 2], [0, 1, 0], label="$y$")
    upper.legend()
    upper.set(title=r"Estimate $\hat{\theta}$", xlabel="Time (s)", ylabel="Level (V)", xlim=(0, 2), ylim=(0, 1))
    lower.step([0, 1, 2], [0, 1, 1])
    lower.set(xlim=(0, 2), ylim=(0, 1))
    root = drawn(describe_figure(figure))
    shown = texts(root)
    for text in ("Estimate θ", "Time (s)", "Level (V)", "y", "0.5", "1.5"):
        assert text in shown
    assert curves(root)[0] == "M84 220L256 30L428 220"  # from corner to the middle of the top to the other corner
    assert curves(root)[1].startswith("M84 220H")


def test_a_panel_without_curves_is_left_out() -> None:
    figure = Figure()
    upper, lower = figure.subplots(2, 1)
    lower.set(xlabel="Time (s)", ylabel="Level (V)")
    assert figure_svg(describe_figure(figure)) == ""
    upper.plot([0, 1, 2], [0, 1, 0])
    root = drawn(describe_figure(figure))
    assert root.attrib["height"] == "270"
    assert len(curves(root)) == 1
    assert "Level (V)" not in texts(root)
    upper.lines[0].remove()
    lower.text(0.5, 0.5, "no data")
    assert "no data" in texts(drawn(describe_figure(figure)))


@pytest.mark.parametrize(
    ("label", "shown"),
    [
        (r"$\sin(0.02\pi t)$", "sin(0.02π t)"),
        (r"$\cos(0.02 \pi t)$", "cos(0.02 π t)"),
        (r"$\hat{\theta}_{1}$, $\mathrm{rms}$", "θ_1, rms"),
        (r"$\lambda = 0.98 \pm 0.01\,\%$", "λ = 0.98 ± 0.01 %"),
        (r"$\Delta\omega \leq \epsilon$", "Δω ≤ ε"),
        (r"C:\data", r"C:\data"),
        (r"$<\script>$", "<script>"),
        ("$\\", "\\"),
    ],
)
def test_formulas_in_labels_are_written_in_plain_text(label: str, shown: str) -> None:
    curve = CurveValue(np.arange(2.0), np.arange(2.0), (0, 0, 0), steps=False, label=label)
    axes = AxesValue(label, label, "", (0, 1), (0, 1), True, (label,), (), (curve,))
    assert texts(drawn(FigureValue((axes,)))).count(shown) == 3


def test_a_curve_that_is_not_finite_is_drawn_where_it_is() -> None:
    y = np.array([0, 1, np.nan, 1, np.inf])
    curve = CurveValue(np.arange(5.0), y, (0.1, 0.2, 0.3), steps=False, label="", joined=True)
    axes = AxesValue("", "", "", (0, 4), (0, 1), True, (), (), (curve,))
    (path,) = curves(drawn(FigureValue((axes,))))
    assert path.count("M") == 2
    assert path.count("L") == 1


def test_a_long_curve_keeps_its_extremes_and_gets_no_larger() -> None:
    y = np.zeros(100_000)
    y[51_234] = 1
    curve = CurveValue(np.arange(y.size, dtype=float), y, (0, 0, 0), steps=False, label="", joined=True)
    axes = AxesValue("", "", "", (0, y.size), (0, 1), False, (), (), (curve,))
    (path,) = curves(drawn(FigureValue((axes,))))
    assert " 30L" in path  # the top
    assert path.count("L") <= MAX_POINTS


def output_panel(*curves: CurveValue, ylim: tuple[float, float] = (-1, 1)) -> AxesValue:
    names = tuple(curve.label for curve in curves)
    return AxesValue("", "Time (s)", "Output (V)", (0, 100), ylim, True, names, (), curves)


def signal(y: np.ndarray, label: str, style: str = "- None 1.5") -> CurveValue:
    return CurveValue(np.arange(y.size, dtype=float), y, (0, 0, 0), False, label, "", True, style)


MEASURED = signal(np.sin(np.arange(101) / 9), "Measured")
UNSTABLE = signal(0.1 * (-1.4) ** np.arange(101.0), "Simulated")


def test_an_unstable_simulation_leaves_the_panel_which_shows_the_measured_range() -> None:
    figure = FigureValue((output_panel(MEASURED, UNSTABLE, ylim=(-4e13, 4e13)),))
    root, said = drawn(figure), "Simulated is unstable: it leaves the panel at 9 s"
    assert said in " ".join(texts(root))
    assert {"-1", "0", "1"} <= set(texts(root))
    assert not [text for text in texts(root) if "e+" in text]
    assert words_of(figure_svg(figure)) == f"Output (V) over Time (s): Measured from -1 to 1. {said}."


@pytest.mark.parametrize("y", [np.linspace(0, 3, 101), 100 * MEASURED.y, np.where(np.arange(101) == 60, 1e9, 0.0)])
def test_a_curve_that_does_not_grow_without_bound_stays_in_the_panel(y: np.ndarray) -> None:
    limits = (float(y.min()), float(y.max()))
    root = drawn(FigureValue((output_panel(MEASURED, signal(y, "Simulated"), ylim=limits),)))
    assert not [text for text in texts(root) if "leaves" in text]


def test_limits_of_the_students_own_are_kept_beside_an_unstable_simulation() -> None:
    root = drawn(FigureValue((output_panel(MEASURED, UNSTABLE, ylim=(0.0, 0.5)),)))
    assert "0.5" in texts(root)
    assert "1" not in texts(root)


def test_a_simulation_that_ends_in_no_number_leaves_the_panel() -> None:
    with np.errstate(over="ignore"):
        y = np.array([3.0**k if k < 80 else np.nan for k in range(101)])
    root = drawn(FigureValue((output_panel(MEASURED, signal(y, "Simulated")),)))
    assert "Simulated is unstable: it leaves the panel at 1 s" in " ".join(texts(root))


def test_line_styles_and_points_are_those_of_the_figure() -> None:
    figure = Figure()
    ax = figure.subplots()
    ax.plot([0, 1, 2], [0, 1, 0], "--")
    ax.plot([0, 1, 2], [0, 1, 0], "o")
    ax.plot([0, 1, 2], [0, 1, 0])
    root = drawn(describe_figure(figure))
    (group,) = (group for group in root.iter(f"{SVG}g") if "clip-path" in group.attrib)
    dashed, points, solid = group.iter(f"{SVG}path")
    assert "stroke-dasharray" in dashed.attrib
    assert points.attrib["d"].count("h0") == 3
    assert "stroke-dasharray" not in solid.attrib
    assert solid.attrib["d"].count("L") == 2


def test_the_legend_stands_below_the_panel_and_takes_further_lines() -> None:
    many = [signal(MEASURED.y, f"a long name of curve {k}") for k in range(8)]
    root = drawn(FigureValue((output_panel(*many),)))
    names = [text for text in root.iter(f"{SVG}text") if (text.text or "").startswith("a long name")]
    assert len(names) == 8
    assert min(float(text.attrib["y"]) for text in names) > 270
    assert max(float(text.attrib["y"]) for text in names) < float(root.attrib["height"])
    assert max(float(text.attrib["x"]) for text in names) < 640


def test_words_say_how_far_curves_are_apart() -> None:
    other = signal(MEASURED.y + 0.25, "Simulated")
    words = words_of(figure_svg(FigureValue((output_panel(MEASURED, other),) * 2)))
    assert words.startswith(
        "(a) Output (V) over Time (s): Measured from -1 to 1; Simulated from -0.75 to 1.25, 0.25 rms "
    )
    assert "(b) Output" in words


hostile = st.text(max_size=30) | st.sampled_from(["<script>alert(1)</script>", '" onload="x', "]]>", "\x1b[31m\0"])
numbers = st.floats(allow_nan=True, allow_infinity=True)
signals = arrays(np.float64, st.integers(0, 20), elements=numbers)


@given(
    x=signals, y=signals, text=hostile, limits=st.tuples(numbers, numbers), color=st.tuples(numbers, numbers, numbers),
    steps=st.booleans(),
)  # fmt: skip
def test_any_figure_is_a_picture_in_which_nothing_runs(
    x: np.ndarray, y: np.ndarray, text: str, limits: tuple[float, float], color: tuple, steps: bool
) -> None:
    curve = CurveValue(x, y, color, steps, text)
    axes = AxesValue(text, text, text, limits, (limits[1], limits[0]), True, (text,), (text,), (curve,))
    root = drawn(FigureValue((axes,) * 2))
    assert {element.tag.removeprefix(SVG) for element in root.iter()} <= {
        "svg",
        "desc",
        "g",
        "rect",
        "path",
        "text",
        "clipPath",
    }
    assert not any(name.startswith("on") for element in root.iter() for name in element.attrib)
    for path in curves(root):
        places = [float(place) for place in re.sub("[MLHVh]", " ", path).split()]
        assert all(math.isfinite(place) and abs(place) <= 2000 for place in places)


def test_on_a_telephone_the_text_has_eight_points() -> None:
    """The page gives the figure about 330 pixels there; a point is 4/3 pixels."""
    root = drawn(FigureValue((output_panel(MEASURED),)))
    size, width = float(root.attrib["font-size"]), float(root.attrib["width"])
    assert size * min(330.0 / width, 1.0) * 0.75 >= 7.8


def test_a_long_text_in_a_panel_stays_within_it() -> None:
    figure = FigureValue((output_panel(MEASURED, UNSTABLE, ylim=(-4e13, 4e13)),))
    root = drawn(figure)
    width, size = float(root.attrib["width"]), float(root.attrib["font-size"])
    inside = [
        element for element in root.iter() if element.tag.endswith("text") and element.get("text-anchor") == "start"
    ]
    assert any("unstable" in "".join(element.itertext()) for element in inside)
    for element in inside:
        assert float(element.attrib["x"]) + 0.55 * size * len("".join(element.itertext())) <= width
