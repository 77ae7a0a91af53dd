"""Faults of the command that a record shows without a model."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.lab.command_faults import log_step, unanswered_command
from labsid.lab.record_check import check_record
from labsid.records.formats import read_raw

LEVELS = np.repeat(np.random.default_rng(2).uniform(-1.0, 1.0, 60), 20)


def output(acting):
    return lfilter([0.0, 0.3], [1.0, -0.7], acting) + 0.005 * np.random.default_rng(4).standard_normal(acting.size)


def test_the_step_of_a_coarse_log():
    assert log_step(np.round(LEVELS, 2)) == pytest.approx(0.01)
    assert log_step(np.round(LEVELS, 5)) is None
    assert log_step(LEVELS) is None


@pytest.mark.parametrize("ends", [(800, 1200), (400, 600)])
def test_a_command_without_an_answer(ends):
    off = np.zeros(LEVELS.size, bool)
    off[slice(*ends)] = True
    start, stop = unanswered_command(LEVELS, output(np.where(off, 0.0, LEVELS)))
    assert ends[0] <= start < ends[0] + 50
    assert ends[1] - 30 < stop <= ends[1]


@pytest.mark.parametrize(
    "acting",
    [
        pytest.param(LEVELS, id="all is well"),
        pytest.param(np.where(np.abs(LEVELS) > 0.3, LEVELS, 0.0), id="a dead zone"),
        pytest.param(np.minimum(LEVELS, -0.3), id="a limit"),
    ],
)
def test_an_answer_or_a_limit_is_none(acting):
    assert unanswered_command(LEVELS, output(acting)) is None


def test_an_input_that_rests_needs_no_answer():
    u = np.where(np.arange(LEVELS.size) > 700, 0.1, LEVELS)
    assert unanswered_command(u, output(u)) is None


def test_the_check_says_so(shared_data):
    texts = {}
    for name in ("coarse-command", "command-off", "command-off-for-a-while"):
        check = check_record(read_raw(shared_data / "found" / f"{name}.csv"))
        texts[name] = " ".join(finding.text for finding in check.findings)
    assert "logged in steps of 0.02" in texts["coarse-command"]
    assert "stands still" not in texts["coarse-command"]
    for name in ("command-off", "command-off-for-a-while"):
        assert "The command may not have reached the rig" in texts[name]
        assert "logged in steps" not in texts[name]
