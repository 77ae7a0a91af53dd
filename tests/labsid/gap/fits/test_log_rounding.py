"""What the coarse log of an input leaves: drawn at random, it is about what a rig leaves that acted on finer values."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.fits.log_rounding import log_rounding_error
from labsid.gap.record.data import scaled
from labsid.records.record import Record

LEVELS = np.repeat(np.random.default_rng(8).uniform(-1.0, 1.0, 100), 20)
FEW = ("input-delay", "input-nonlinearity", "input-quantization", "load-step", "output-drift", "parameter-drift")


def recorded(step, seed=3):
    y = lfilter([0.0, 0.05, 0.04], [1.0, -1.5, 0.56], LEVELS)
    y = y + 0.001 * np.std(y) * np.random.default_rng(seed).standard_normal(y.size)
    return Record(0.1 * np.arange(y.size), step * np.round(LEVELS / step), y, 0.1)


@pytest.mark.parametrize("step", [0.01, 0.04])
def test_it_is_the_error_of_the_rig(step):
    record = recorded(step)
    data = scaled(record.u, record.y, np.ones(len(record), bool), record.Ts)
    fit = fit_baseline(data)
    assert log_rounding_error(data, fit) == pytest.approx(fit.cost, rel=0.5)


def test_a_fine_log_and_a_staircase_leave_nothing():
    for step in (1e-6, 0.25):
        record = recorded(step)
        data = scaled(record.u, record.y, np.ones(len(record), bool), record.Ts)
        assert log_rounding_error(data, fit_baseline(data)) == 0.0


@searched(*FEW)
def test_it_is_no_gap_and_is_said():
    report = diagnose(recorded(0.02)).report
    assert (report["verdict"], report["effects"]) == ("none", [])
    assert any("logged in steps of 0.02" in text for text in report["screen"])


@searched("load-step", "output-drift", "parameter-drift")
def test_what_it_leaves_under_a_chirp_is_no_change_of_the_rig():
    """The slow part of a chirp is rounded to few values, so that the error changes along the record."""
    t = 0.04 * np.arange(1500)
    u = 2.5 * np.sin(0.15 * t + 0.02 * t**2)
    y = lfilter([0.0, 0.02, 0.019], [1.0, -1.84, 0.879], u)
    y = y + 0.001 * np.std(y) * np.random.default_rng(2).standard_normal(y.size)
    assert diagnose(Record(t, 0.2 * np.round(u / 0.2), y, 0.04)).report["verdict"] == "none"


def test_an_error_much_smaller_than_that_of_rounding_shows_set_points_in_whole_numbers():
    record = recorded(0.04)
    y = lfilter([0.0, 0.05, 0.04], [1.0, -1.5, 0.56], record.u)
    y = y + 0.001 * np.std(y) * np.random.default_rng(3).standard_normal(y.size)
    for output, acted in ((record.y, False), (y, True)):
        data = scaled(record.u, output, np.ones(y.size, bool), record.Ts)
        assert (log_rounding_error(data, fit_baseline(data)) == 0.0) == acted


@pytest.mark.parametrize(
    ("values", "is_coarse"), [(range(12), False), ([0, 1, 9, 17, 30, 38, 46, 55, 63, 72, 80, 89], True)]
)
def test_a_log_of_few_levels_is_coarse_only_if_they_are_far_apart(values, is_coarse):
    """Twelve levels in steps of one, as of a staircase, tell nothing of the steps of the log."""
    rng = np.random.default_rng(5)
    levels = np.repeat(rng.permutation(values), 60)
    acted = levels + np.repeat(rng.uniform(-0.5, 0.5, 12), 60)
    y = lfilter([0.0, 0.05, 0.04], [1.0, -1.5, 0.56], acted) + 0.01 * rng.standard_normal(levels.size)
    data = scaled(levels.astype(float), y, np.ones(y.size, bool), 0.1)
    assert (log_rounding_error(data, fit_baseline(data)) > 0.0) == is_coarse
