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

from autograder.judge.picture import MAX_POINTS, figure_svg
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
    assert curves(root)[0] == "M62 208L345 26L628 208"  # from corner to the middle of the top to the other corner
    assert curves(root)[1].startswith("M62 208H")


def test_a_panel_without_curves_is_left_out() -> None:
    figure = Figure()
    upper, lower = figure.subplots(2, 1)
    lower.set(xlabel="Time (s)", ylabel="Level (V)")
    assert figure_svg(describe_figure(figure)) == ""
    upper.plot([0, 1, 2], [0, 1, 0])
    root = drawn(describe_figure(figure))
    assert root.attrib["height"] == "250"
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
    curve = CurveValue(np.arange(5.0), y, (0.1, 0.2, 0.3), steps=False, label="")
    axes = AxesValue("", "", "", (0, 4), (0, 1), True, (), (), (curve,))
    (path,) = curves(drawn(FigureValue((axes,))))
    assert path.count("M") == 2
    assert path.count("L") == 1


def test_a_long_curve_keeps_its_extremes_and_gets_no_larger() -> None:
    y = np.zeros(100_000)
    y[51_234] = 1
    curve = CurveValue(np.arange(y.size, dtype=float), y, (0, 0, 0), steps=False, label="")
    axes = AxesValue("", "", "", (0, y.size), (0, 1), False, (), (), (curve,))
    (path,) = curves(drawn(FigureValue((axes,))))
    assert " 26L" in path  # the top
    assert path.count("L") <= MAX_POINTS


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
        "g",
        "rect",
        "path",
        "text",
        "clipPath",
    }
    assert not any(name.startswith("on") for element in root.iter() for name in element.attrib)
    for path in curves(root):
        places = [float(place) for place in re.sub("[MLHV]", " ", path).split()]
        assert all(math.isfinite(place) and abs(place) <= 2000 for place in places)
