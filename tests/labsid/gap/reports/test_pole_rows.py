"""Poles and zeros of a report: those of the rig and of the given simulation, within their errors."""

import numpy as np
import pytest
from gap_reports import report
from gap_search import searched
from scipy.signal import lfilter

from labsid import diagnose
from labsid.gap.reports.pole_rows import drawn_dynamics, poles_sentence
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

POLES, TS = (0.93, 0.7), 0.5
A = np.poly(POLES)
MODEL = {"num": [0.0, 0.02, 0.03], "den": np.poly([0.96, 0.5]).tolist(), "dt": TS, "u0": 0.0, "y0": 0.0}


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(5)
    u = np.repeat(rng.uniform(-1.0, 1.0, 90), 8)
    return Record(TS * np.arange(u.size), u, lfilter([0.0, 0.05, 0.02], A, u) + 0.002 * rng.standard_normal(u.size), TS)


@searched("extra-lag")
def test_the_poles_of_the_rig_are_found_within_their_errors(record):
    found = diagnose(record).report
    poles = found["dynamics"]["after"]["poles"]
    assert not found["dynamics"]["after"]["linearised"]
    for row, true in zip(poles, POLES, strict=True):
        sd = float(np.sqrt(row["covariance"][0][0]))
        assert abs(row["value"][0] - true) < 4.0 * sd
        assert sd < 0.02
    zero = found["dynamics"]["after"]["zeros"][0]  # another one, near zero, is a part of a sample
    assert abs(zero["value"][0] + 0.4) < 4.0 * float(np.sqrt(zero["covariance"][0][0])) < 0.8
    assert "longest time constant of the linear dynamics is 6." in poles_sentence(found)


@searched("extra-lag", "parameter-mismatch")
def test_the_poles_before_are_those_of_the_given_simulation(record):
    found = diagnose(record, MODEL).report
    before, after = (found["dynamics"][name] for name in ("before", "after"))
    assert [row["value"][0] for row in before["poles"]] == pytest.approx([0.96, 0.5])
    assert [row["value"][0] for row in before["zeros"]] == pytest.approx([-1.5])
    assert all(row["covariance"] is None for row in before["poles"])
    assert after["poles"][0]["value"][0] == pytest.approx(0.93, abs=0.02)
    drawn = drawn_dynamics(found)
    assert {name: len(own[0]) for name, own in drawn.items()} == {"before": 2, "after": 2}


@searched("extra-lag")
def test_a_simulation_that_is_run_has_no_poles_before(record):
    def simulate(t, u):
        return lfilter([0.0, 0.05, 0.02], A, u)

    found = diagnose(record, simulate).report
    assert found["dynamics"] is None
    assert drawn_dynamics(found) is None
    assert poles_sentence(found) == ""


def test_a_report_of_an_earlier_version_has_no_poles():
    assert drawn_dynamics(report("input-delay")) is None


def test_what_is_linearised_is_said():
    own = {"poles": [{"value": [0.9, 0.0], "covariance": None}], "zeros": None, "linearised": True}
    text = poles_sentence(report("sqrt-outflow") | {"dynamics": {"before": own | {"linearised": False}, "after": own}})
    assert "about the mean level" in text
    assert text.count("before") == text.count("after") == 1
