"""A figure is judged by what a reader sees in it, however it was drawn."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from labsid.checks.figures import (
    find_curve,
    legend_text,
    one_figure,
    plain_text,
    require_curve,
    require_here,
    require_label,
    require_labels,
    require_legend,
    require_limits,
)
from labsid.checks.verdict import NoAnswer
from labsid.plots.describe import describe_figure
from labsid.plots.figure_values import AxesValue, CurveValue

T = np.arange(0, 10, 0.5)
Y = np.sin(T)
U = np.repeat([1.6, 2.0, 2.2, 1.6], 5)


def seen(draw: Callable[[Axes], object]) -> AxesValue:
    """What is seen in axes on which `draw` drew."""
    figure = Figure()
    draw(figure.subplots())
    (axes,) = describe_figure(figure).axes
    return axes


def refusal(check: Callable[..., object], *arguments: Any) -> NoAnswer:
    with pytest.raises(NoAnswer) as refused:
        check(*arguments)
    return refused.value


# ---- what is seen


@pytest.mark.parametrize(
    ("draw", "steps", "samples"),
    [
        pytest.param(lambda ax: ax.plot(T, U), False, 20, id="plot"),
        pytest.param(lambda ax: ax.plot(T.reshape(-1, 1), U.reshape(-1, 1)), False, 20, id="plot of columns"),
        pytest.param(lambda ax: ax.plot(list(T), tuple(U), "r--"), False, 20, id="plot of lists"),
        pytest.param(lambda ax: ax.plot(T, U, "o"), False, 20, id="plot of points"),
        pytest.param(lambda ax: ax.plot(T, U, drawstyle="steps-post"), True, 20, id="plot with steps"),
        pytest.param(lambda ax: ax.step(T, U, where="post"), True, 20, id="step"),
        pytest.param(lambda ax: ax.step(T, U), True, 20, id="step before"),
        pytest.param(lambda ax: ax.stairs(U[:-1], T), True, 19, id="stairs"),
        pytest.param(lambda ax: ax.stairs(U, np.append(T, 10)), True, 20, id="stairs with an edge more"),
    ],
)
def test_a_curve_is_seen_however_it_is_drawn(draw: Callable, steps: bool, samples: int) -> None:
    axes = seen(draw)
    (curve,) = axes.curves
    assert (curve.steps, curve.y.size) == (steps, samples)
    assert (curve.where != "") == steps
    assert find_curve(axes, U, T) is curve
    assert find_curve(axes, U.reshape(-1, 1), T.reshape(-1, 1)) is curve
    assert find_curve(axes, U + 0.01, T) is None
    assert find_curve(axes, U, T + 0.01) is None


@pytest.mark.parametrize(
    "draw",
    [
        pytest.param(lambda ax: ax.scatter(T, Y, label="y"), id="scatter"),
        pytest.param(lambda ax: ax.stem(T, Y, label="y"), id="stem"),
        pytest.param(lambda ax: ax.bar(T, Y, label="y"), id="bar"),
        pytest.param(lambda ax: ax.errorbar(T, Y, yerr=0.1, label="y"), id="errorbar"),
    ],
)
@pytest.mark.parametrize("legend", [lambda ax: ax.legend(), lambda ax: ax.figure.legend()], ids=["axes", "figure"])
def test_points_and_bars_are_read_with_their_label(draw: Callable, legend: Callable) -> None:
    axes = seen(lambda ax: (draw(ax), legend(ax)))
    curve = find_curve(axes, Y, T)
    assert curve is not None
    assert (legend_text(axes, curve), axes.legend) == ("y", ("y",))
    seen_by_position = seen(lambda ax: (ax.axhline(0), draw(ax), ax.legend(["zero", "signal"])))
    curve = find_curve(seen_by_position, Y, T)
    assert curve is not None
    assert legend_text(seen_by_position, curve) == "signal"


@pytest.mark.parametrize(
    "draw",
    [
        pytest.param(lambda ax: ax.plot(T, Y, alpha=0, lw=0), id="transparent and without width"),
        pytest.param(lambda ax: ax.plot(T, Y, alpha=0.01), id="transparent"),
        pytest.param(lambda ax: ax.plot(T, Y, lw=0), id="without width"),
        pytest.param(lambda ax: ax.plot(T, Y, visible=False), id="not shown"),
        pytest.param(lambda ax: ax.plot(T, Y, "w"), id="white on white"),
        pytest.param(lambda ax: ax.plot(T, Y, color=(0, 0, 1, 0)), id="a transparent colour"),
        pytest.param(lambda ax: ax.plot(T, Y, linestyle=""), id="no line and no marker"),
        pytest.param(lambda ax: ax.plot(T, Y, "o", ms=0), id="markers without size"),
        pytest.param(lambda ax: ax.plot(T, Y, "o", mfc="none", mec="none"), id="markers without colour"),
        pytest.param(lambda ax: (ax.set_facecolor("k"), ax.plot(T, Y, "k")), id="black on black"),
        pytest.param(lambda ax: ax.stairs(U[:-1], T, alpha=0), id="stairs"),
        pytest.param(lambda ax: ax.scatter(T, Y, s=0), id="points without size"),
        pytest.param(lambda ax: ax.scatter(T, Y, c="w"), id="white points"),
        pytest.param(lambda ax: ax.bar(T, Y, alpha=0), id="bars"),
        pytest.param(lambda ax: ax.hlines([1, 2], 0, 5, lw=0), id="lines without width"),
        pytest.param(lambda ax: (ax.plot(T, Y), ax.set_visible(False)), id="axes that are not shown"),
    ],
)
def test_a_curve_that_cannot_be_seen_is_none(draw: Callable) -> None:
    assert seen(draw).curves == ()


@pytest.mark.parametrize(
    "draw",
    [
        pytest.param(lambda ax: ax.plot(T, Y, alpha=0.2), id="pale"),
        pytest.param(lambda ax: ax.plot(T, Y, lw=0.3), id="thin"),
        pytest.param(lambda ax: ax.plot(T, Y, "lightyellow"), id="light"),
        pytest.param(lambda ax: (ax.set_facecolor("k"), ax.plot(T, Y, "w")), id="white on black"),
        pytest.param(lambda ax: ax.plot(T, Y, "o", mfc="none"), id="circles"),
        pytest.param(lambda ax: ax.plot(T, Y, "ow", mec="k"), id="white with an edge"),
        pytest.param(lambda ax: ax.plot(T, Y, "w.-", mfc="r"), id="red points on a white line"),
        pytest.param(lambda ax: (ax.set_facecolor("none"), ax.plot(T, Y)), id="no background"),
        pytest.param(lambda ax: ax.scatter(T, Y, c=Y, cmap="gray"), id="coloured by value"),
        pytest.param(lambda ax: ax.scatter(T, Y, marker="x"), id="crosses"),
        pytest.param(lambda ax: ax.scatter(T, Y, facecolors="none", edgecolors="k"), id="rings"),
        pytest.param(lambda ax: ax.bar(T, Y, fill=False, edgecolor="b"), id="bars without area"),
    ],
)
def test_a_curve_that_can_be_seen_is_one(draw: Callable) -> None:
    assert find_curve(seen(draw), Y, T) is not None


def test_horizontal_lines_are_read_at_their_level() -> None:
    def draw(ax: Axes) -> None:
        ax.set_xlim(0, 10)
        ax.axhline(0.5)
        ax.axvline(3)
        ax.hlines([1, 2], [0, 5], [5, 10])
        ax.fill_between(T, Y, 0)

    read = [(list(curve.x), list(curve.y)) for curve in seen(draw).curves]
    assert read == [([0, 10], [0.5, 0.5]), ([0, 5], [1, 1]), ([5, 10], [2, 2])]


def test_several_panels_are_read_as_one_figure() -> None:
    figure = Figure()
    upper, lower = figure.subplots(2)
    upper.plot(T, Y, label="y")
    upper.set_ylabel("y (V)")
    lower.plot(T, U, label="u")
    lower.set_xlabel("t (s)")
    axes = one_figure("fig", describe_figure(figure))
    assert find_curve(axes, Y, T) is not None
    assert find_curve(axes, U, T) is not None
    assert (axes.xlabel, axes.ylabel) == ("t (s)", "")
    lower.set_ylabel("u (V)")
    assert one_figure("fig", describe_figure(figure)).ylabel == "y (V) u (V)"
    assert "is empty" in str(refusal(one_figure, "fig", describe_figure(Figure())))
    assert "should be the figure itself" in str(refusal(one_figure, "fig", "text"))


def test_texts_of_figure_and_legend_are_read() -> None:
    figure = Figure()
    ax = figure.subplots()
    ax.plot(T, Y, label="y")
    ax.legend(title="MSE: 3")
    figure.text(0.1, 0.9, "MSE: 4")
    assert describe_figure(figure).axes[0].texts == ("MSE: 3", "MSE: 4")


def test_strange_data_is_seen_too() -> None:
    """One line that is none must not make the whole figure unreadable."""

    def draw(ax: Axes) -> None:
        ax.plot(["a", "b", "c"], [1, 2, 3])
        ax.plot([0, 1, 2], [None, 2, 3])
        ax.plot(np.ma.masked_array([0.0, 1.0, 2.0], [0, 0, 1]), [1, 2, 3])

    axes = seen(draw)
    assert [curve.y.size for curve in axes.curves] == [3, 3, 3]
    dates = seen(lambda ax: ax.plot(np.array(["2024-01-01", "2024-01-02", "2024-01-03"], "M8[D]"), [1, 2, 3]))
    assert np.diff(dates.curves[0].x).tolist() == [1, 1]


def test_the_words_of_a_figure_are_seen() -> None:
    def draw(ax: Axes) -> None:
        ax.plot(T, Y, color="#ff0000", label="output")
        ax.step(T, U, color="blue", label="input")
        ax.set_title("middle")
        ax.set_title("left", loc="left")
        ax.set_xlabel("Time (s)")
        ax.set_ylabel("Voltage (V)")
        ax.set_xlim(0, 10)
        ax.set_ylim(3, -3)
        ax.grid(True)
        ax.legend()
        ax.text(1, 1, "MSE = 3")

    axes = seen(draw)
    assert (axes.title, axes.xlabel, axes.ylabel) == ("middle left", "Time (s)", "Voltage (V)")
    assert (axes.xlim, axes.ylim, axes.grid) == ((0, 10), (3, -3), True)
    assert axes.legend == ("output", "input")
    assert axes.texts == ("MSE = 3",)
    assert [curve.color for curve in axes.curves] == [(1, 0, 0), (0, 0, 1)]
    assert [curve.label for curve in axes.curves] == ["output", "input"]
    bare = seen(lambda ax: ax.plot(T, Y))
    assert (bare.title, bare.xlabel, bare.legend, bare.texts, bare.grid) == ("", "", (), (), False)


def test_text_in_a_box_is_seen() -> None:
    from matplotlib.offsetbox import AnchoredText

    assert seen(lambda ax: ax.add_artist(AnchoredText("MSE 1: 3", loc="upper left"))).texts == ("MSE 1: 3",)


@pytest.mark.parametrize(
    "build",
    [
        pytest.param(lambda figure: [figure.add_subplot(2, 2, i) for i in (4, 1, 3, 2)], id="made out of order"),
        pytest.param(lambda figure: list(np.ravel(figure.subplots(2, 2)))[::-1], id="a table, filled backwards"),
    ],
)
def test_subplots_are_seen_as_they_are_read(build: Callable) -> None:
    figure = Figure()
    for ax in build(figure):
        position = ax.get_position()
        ax.set_title(f"{'top' if position.y0 > 0.5 else 'bottom'} {'left' if position.x0 < 0.4 else 'right'}")
    titles = [axes.title for axes in describe_figure(figure).axes]
    assert titles == ["top left", "top right", "bottom left", "bottom right"]


# ---- what must be in it


def test_a_curve_that_is_there_is_found_among_others() -> None:
    def draw(ax: Axes) -> None:
        ax.plot(T, Y)
        ax.plot(T, U)
        ax.plot(T[:5], U[:5])

    axes = seen(draw)
    assert require_curve(axes, "(a)", "the input", U, T) is axes.curves[1]
    assert require_curve(axes, "(a)", "the input", U) is axes.curves[1]


def test_a_curve_that_is_not_there_is_said() -> None:
    axes = seen(lambda ax: ax.plot(Y))
    error = refusal(require_curve, axes, "(a)", "the output", Y, T)
    assert str(error).startswith("In (a), the output is drawn against the sample number, and not against time")
    assert error.slip == "drawn against the sample number"
    error = refusal(require_curve, seen(lambda ax: ax.plot(3 * T, Y)), "(a)", "the output", Y, T)
    assert error.slip == "drawn against another vector"
    error = refusal(require_curve, axes, "(b)", "the input", U, T)
    assert (str(error), error.slip) == ("In (b) no curve shows the input. Plot it against time.", "no curve")
    assert refusal(require_curve, seen(lambda ax: None), "(b)", "the input", U).slip == "no curve"


@pytest.mark.parametrize(
    "short",
    [Y[:-2], Y[:1], np.append(Y, 0), Y[1:], Y[::-1], np.where(T == 3, 9, Y)],
    ids=["two samples short", "one sample", "one sample too many", "shifted", "backwards", "one sample wrong"],
)
def test_a_curve_that_is_not_quite_it_is_none(short: np.ndarray) -> None:
    assert find_curve(seen(lambda ax: ax.plot(short)), Y) is None


def test_a_curve_with_a_gap_is_none() -> None:
    assert find_curve(seen(lambda ax: ax.plot(T, np.where(T == 3, np.nan, Y))), Y) is None


def test_a_curve_that_lies_flat_is_found() -> None:
    zero = np.zeros(20)
    assert find_curve(seen(lambda ax: ax.plot(T, zero)), zero, T) is not None
    assert find_curve(seen(lambda ax: ax.plot(T, zero + 1e-3)), zero, T) is None


@pytest.mark.parametrize(
    "label",
    ["Time (s)", "Time [s]", "t / s", "time, s", "Time (sec)", r"$t$ ($\mathrm{s}$)", r"$t\,(\mathrm{s})$", "T (S)"],
)
def test_a_label_with_its_unit_is_taken(label: str) -> None:
    require_label(seen(lambda ax: ax.set_xlabel(label)), "(a)", "x", "s")


@pytest.mark.parametrize(
    ("label", "unit", "is_taken"),
    [
        ("Position (m)", "m", True),
        ("Position (mm)", "m", False),
        ("Position in $(\\mathrm{m})$", "m", True),
        ("Speed (1/min)", "1/min", True),
        ("Speed (1/minute)", "1/min", False),
        ("Power (%)", "%", True),
        ("Speed (m/s)", "m/s", True),
        ("Acceleration (m/s^2)", "m/s^2", True),
        ("Voltage (Volts)", "V", True),
        ("Voltage (mV)", "V", False),
    ],
)
def test_a_longer_unit_is_another_one(label: str, unit: str, is_taken: bool) -> None:
    axes = seen(lambda ax: ax.set_ylabel(label))
    if is_taken:
        require_label(axes, "(a)", "y", unit)
    else:
        error = refusal(require_label, axes, "(a)", "y", unit)
        assert (error.slip, f"write it as ({unit})" in str(error)) == ("another unit", True)


def test_labels_that_lack_something_are_said() -> None:
    axes = seen(lambda ax: (ax.set_xlabel("Time (s)"), ax.set_ylabel("Voltage")))
    error = refusal(require_labels, axes, "(a)", ("s", "V"))
    assert str(error) == "In (a) the y-label 'Voltage' has no unit: write it as (V)."
    assert error.slip == "no unit"
    swapped = seen(lambda ax: (ax.set_xlabel("Voltage (V)"), ax.set_ylabel("Time (s)")))
    assert refusal(require_labels, swapped, "(a)", ("s", "V")).slip == "axis labels swapped"
    require_label(axes, "(a)", "y", "")
    error = refusal(require_labels, seen(lambda ax: ax.set_ylabel("y (V)")), "(a)", ("s", "V"))
    assert str(error) == "In (a) the x-axis has no label: use `set_xlabel`."
    assert error.slip == "axis without a label"
    assert refusal(require_label, seen(lambda ax: ax.set_xlabel("  ")), "(a)", "x", "").slip == "axis without a label"
    require_labels(seen(lambda ax: (ax.set_xlabel("t (s)"), ax.set_ylabel("u (V)"))), "(a)", ("s", "V"))


def test_limits_are_those_of_the_figure() -> None:
    axes = seen(lambda ax: (ax.set_xlim(0, 100), ax.set_ylim(-1.5, 1.5)))
    require_limits(axes, "(a)", (0, 100), (-1.5, 1.5))
    error = refusal(require_limits, axes, "(a)", (0, 80), (-1.5, 1.5))
    assert str(error) == "In (a) the x-axis runs from 0 to 100; it should run from 0 to 80: use `set_xlim`."
    assert error.slip == "axis limits"
    assert "y-axis runs from -1.5 to 1.5" in str(refusal(require_limits, axes, "(a)", (0, 100), (-1.5, 1)))


def test_what_the_other_panel_has_is_said() -> None:
    limited, free = seen(lambda ax: (ax.set_xlim(0, 9), ax.set_ylim(0, 1))), seen(lambda ax: ax.set_xlim(0, 3))

    def check(axes: AxesValue) -> None:
        require_limits(axes, "(a)", (0, 9), (0, 1))

    require_here(check, limited, free, "ax_a")
    error = refusal(require_here, check, free, limited, "ax_a")
    assert "The other panel has that. Each panel is set through its own axes, this one through `ax_a`." in str(error)
    assert error.slip == "axis limits"
    for beside in (free, None):
        assert "other panel" not in str(refusal(require_here, check, free, beside, "ax_a"))


def test_a_legend_names_its_curves() -> None:
    def draw(ax: Axes) -> None:
        ax.plot(T, Y, label="output")
        ax.plot(T, U, label="input")
        ax.legend()

    axes = seen(draw)
    require_legend(axes, "(a)", 2)
    error = refusal(require_legend, axes, "(a)", 3)
    assert str(error).startswith("In (a) the legend should name 3 curves")
    assert error.slip == "no legend"
    assert refusal(require_legend, seen(lambda ax: ax.plot(T, Y, label="y")), "(a)", 1).slip == "no legend"
    blank = seen(lambda ax: (ax.plot(T, Y, label=" "), ax.legend()))
    assert refusal(require_legend, blank, "(a)", 1).slip == "no legend"


def test_the_legend_text_of_a_curve_is_found() -> None:
    def by_label(ax: Axes) -> None:
        ax.plot(T, Y, label="output")
        ax.plot(T, U, label="input")
        ax.legend(handles=ax.lines[::-1])

    def by_position(ax: Axes) -> None:
        ax.plot(T, Y)
        ax.plot(T, U)
        ax.legend(["output", "input"])

    for draw in (by_label, by_position):
        axes = seen(draw)
        assert legend_text(axes, require_curve(axes, "(a)", "y", Y)) == "output"
        assert legend_text(axes, require_curve(axes, "(a)", "u", U)) == "input"
    one = seen(lambda ax: (ax.plot(T, Y), ax.plot(T, U), ax.legend(["output"])))
    assert legend_text(one, one.curves[1]) == ""
    none = seen(lambda ax: ax.plot(T, Y))
    assert legend_text(none, none.curves[0]) == ""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (r"$\sin(0.02\pi t)$", "sin(0.02πt)"),
        (r"$\sin\left(0.02 \pi \, t\right)$", "sin(0.02πt)"),
        ("sin(0.02*π*t)", "sin(0.02πt)"),
        (r"$\mathrm{cos}(0.02 \cdot \pi t)$", "cos(0.02πt)"),
        ("  plain text ", "plaintext"),
        (r"$\theta_1 = \tau\phi$", "θ_1=τφ"),
        ("", ""),
    ],
)
def test_labels_without_their_marks(text: str, expected: str) -> None:
    assert plain_text(text) == expected


def test_a_curve_of_unequal_length_is_not_found() -> None:
    """A hostile answer could hold one; it must not break the search."""
    curve = CurveValue(np.zeros(3), np.zeros(20), (0, 0, 0), False, "")
    axes = AxesValue("", "", "", (0, 1), (0, 1), False, (), (), (curve,))
    assert find_curve(axes, np.zeros(20), T) is None


@pytest.mark.parametrize(
    ("draw", "said", "slip"),
    [
        (lambda ax: ax.plot(Y, T), "`y` is on the horizontal axis", "x and y swapped"),
        (lambda ax: ax.plot(np.column_stack([Y, U]).T), "a curve for each *row*", "rows drawn"),
        (lambda ax: ax.plot(T, Y + 2), "Such a constant is an offset.", "no curve"),
        (lambda ax: ax.plot(T, 2 * Y), "twice the right value.", "no curve"),
        (lambda ax: ax.plot(T, U), "Plot it against time.", "no curve"),
        (lambda ax: (ax.plot(T, U), ax.step(T, U)), "and two show `u`.", "one signal drawn twice"),
    ],
)
def test_what_is_drawn_in_place_of_a_signal_is_said(draw: Callable[[Axes], object], said: str, slip: str) -> None:
    refused = refusal(require_curve, seen(draw), "the panel", "`y`", Y, T, {"y": Y, "u": U})
    assert said in str(refused)
    assert refused.slip == slip
