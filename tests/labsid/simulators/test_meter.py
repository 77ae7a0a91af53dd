"""The runs of a simulation are counted and timed, and a search ends at its budget."""

from itertools import count

import numpy as np
import pytest

from labsid.simulators.meter import BudgetSpentError, RunMeter
from labsid.simulators.simulator import SimulatorError, function_simulator

T = 0.1 * np.arange(50)
U = np.ones(50)


def test_runs_and_their_time_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that goes on by a second whenever it is read."""
    clock = count()
    monkeypatch.setattr("labsid.simulators.meter.perf_counter", lambda: float(next(clock)))
    meter = RunMeter()
    meter.begin(None)
    for _ in range(3):
        meter.measured(int)
    assert meter.runs == 3
    assert meter.seconds == 3.0
    assert str(meter) == "3 simulations, 43 % of the time"  # of seven seconds: three runs, between and after them one


def test_only_a_search_is_held_to_the_budget() -> None:
    meter = RunMeter()
    meter.begin(8)
    with meter.searching(0.75):
        for made in range(6):
            assert meter.left == 6 - made
            meter.measured(int)
        assert meter.exhausted
        assert not meter.spent  # nothing more has been asked for
        with pytest.raises(BudgetSpentError, match=r"8 evaluations are too few"):
            meter.measured(int)
        assert meter.spent
    assert not meter.exhausted
    for _ in range(10):
        meter.measured(int)
    assert meter.runs == 16
    meter.begin(None)
    assert (meter.runs, meter.spent) == (0, False)
    with meter.searching():
        assert meter.left == np.inf
        assert not meter.exhausted


def test_a_simulation_counts_its_runs_those_that_fail_too() -> None:
    def simulate(t: object, u: object, k: float = 1.0) -> object:
        if k < 0.0:
            raise RuntimeError("negative")
        return k * np.asarray(u)

    simulator = function_simulator(simulate).with_free(["k"])
    simulator(T, U)
    with pytest.raises(SimulatorError, match="negative"):
        simulator(T, U, {"k": -1.0})
    assert simulator.meter.runs == 2
    assert function_simulator(simulate).meter.runs == 0
