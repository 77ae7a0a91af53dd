"""Poles and zeros as figures: in a diagnosis, and of an identified model."""

import numpy as np
import pytest
from gap_reports import report
from matplotlib.colors import to_hex

from labsid.lab.identification import identify
from labsid.model_structures.roots import Root
from labsid.plots.gap_details import figure_poles
from labsid.plots.identification import figure_identification
from labsid.plots.style import BLUE, VERMILION
from labsid.records.record import Record


def roots(*values: complex, sd: float = np.nan) -> tuple[Root, ...]:
    return tuple(Root(complex(x), np.diag([sd**2, 0.0 if np.isreal(x) else sd**2])) for x in values)


def drawn(ax, marker):
    return [
        (line.get_label(), to_hex(line.get_color()).upper(), list(line.get_xdata()))
        for line in ax.lines
        if line.get_marker() == marker
    ]


@pytest.mark.parametrize("narrow", [False, True])
def test_both_simulations_are_drawn_with_their_regions(narrow, covered):
    poles = {"before": (roots(0.9, 0.8), ()), "after": (roots(0.92, 0.7, sd=0.01), roots(-3.0, 0.5))}
    figure = figure_poles(report("input-delay") | {"poles": poles}, narrow)
    plane, zoom = figure.axes
    assert drawn(plane, "x") == [("Before", VERMILION, [0.9, 0.8]), ("After", BLUE, [0.92, 0.7])]
    assert [x for *_, x in drawn(plane, "o")] == [[], [0.5]]
    assert "zero -3" in plane.get_xlabel()
    widths = sorted(np.ptp(patch.get_path().vertices[:, 0]) for patch in plane.patches)
    assert widths == pytest.approx([2 * 1.96 * 0.01] * 2, rel=1e-3)
    assert zoom.get_xlim()[0] < 0.7 < 0.92 < zoom.get_xlim()[1]
    assert covered(figure) == []


def test_poles_far_apart_have_no_zoom_and_an_unchanged_simulation_is_drawn_once():
    shown = report(verdict="unknown") | {"poles": {name: (roots(0.9, -0.7), ()) for name in ("before", "after")}}
    (plane,) = figure_poles(shown).axes
    assert [label for label, *_ in drawn(plane, "x")] == ["Simulated"]


def test_an_identification_is_drawn_with_its_errors(covered):
    rng = np.random.default_rng(0)
    u = np.repeat(rng.choice([0.0, 1.0, 2.0], 40), 15)
    u[:30] = 0.0
    y = np.zeros(u.size)
    for k in range(1, u.size):
        y[k] = 0.9 * y[k - 1] + 0.2 * u[k - 1] + 0.01 * rng.standard_normal()
    found = identify(Record(0.5 * np.arange(u.size), u, y, 0.5, name="tank", units=("V", "mm")), order=1)
    figure = figure_identification(found)
    titles = {ax.get_title(): ax for ax in figure.axes}
    assert {"Gain", "Phase", "Response to a unit step", "Poles × and zeros ○", "The poles, closer"} < set(titles)
    assert titles["Gain"].get_ylabel() == "Gain (mm/V)"
    ax = titles["Response to a unit step"]
    band, step = ax.collections[0].get_paths()[0].vertices[:, 1], ax.lines[0].get_ydata()
    assert band.min() < 0.02  # at the step
    assert 0.001 < band.max() - step.max() < 0.1
    measured = next(line for line in figure.axes[0].lines if line.get_label() == "Actual output")
    np.testing.assert_array_equal(measured.get_ydata(), found.y)
    assert figure.alt.startswith("Measured output and free run")
    assert covered(figure) == []
