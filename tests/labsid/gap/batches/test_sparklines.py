"""The small drawings of the errors in the rows of a batch."""

import numpy as np
import pytest
from gap_reports import report
from signals_reports import signals_report

from labsid.gap.batches.sparklines import BELOW, HEIGHT, PARTS, WIDTH, error_lines


def points(line: str) -> np.ndarray:
    """Its points, shape (n, 2)."""
    return np.array([pair.split(",") for pair in line.split()], float)


def test_the_largest_error_is_at_the_top_and_the_lines_have_one_scale():
    found = report("input-delay")
    n = len(found["traces"]["t"])
    y = np.zeros(n)
    found["traces"] |= {"y": y.tolist(), "before": np.linspace(0.1, 4.0, n).tolist(), "after": (y + 1.0).tolist()}
    found["gap"]["noise_floor"] = 1.0
    lines = error_lines(found)
    before, after = points(lines["before"]), points(lines["after"])
    assert before.shape == (PARTS, 2)
    assert before[0, 0] == 0.0
    assert before[-1] == pytest.approx([WIDTH, BELOW])
    assert np.all(np.diff(before[:, 1]) <= 0.0)
    quarter = HEIGHT - BELOW - (HEIGHT - 2.0 * BELOW) / 4.0
    np.testing.assert_allclose(after[:, 1], quarter, atol=0.2)
    assert float(lines["noise"]) == pytest.approx(quarter, abs=0.2)


def test_parts_without_a_measured_output_are_left_out():
    found = report("input-delay")
    found["traces"]["y"] = [None] * 60 + found["traces"]["y"][60:]
    assert len(points(error_lines(found)["before"])) == 30


def test_without_an_error_there_is_no_line():
    found = report(verdict="none")
    found["traces"] |= dict.fromkeys(("before", "after"), found["traces"]["y"])
    assert error_lines(found) is None


def test_of_several_signals_the_output_with_the_largest_gap_is_drawn():
    found = signals_report(("input-dead-zone", "valve"))
    worst = found["outputs"][found["where"]["output"]]
    alone = error_lines({"traces": worst["traces"], "gap": worst["gap"]})
    assert error_lines(found) == alone
