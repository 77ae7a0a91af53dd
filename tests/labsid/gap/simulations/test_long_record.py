"""Very long records: which part is diagnosed, and that it is said."""

import numpy as np
import pytest
from gap_search import searched

from labsid.gap import prepared
from labsid.gap.diagnosis import diagnose
from labsid.gap.simulations.long_record import downsample, shorten_holdout, shorten_record
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.records.record import Record
from labsid.simulators.simulator import function_simulator

pytestmark = pytest.mark.usefixtures("without_limits")


def record_of(u, y=None, Ts=0.5):
    u = np.asarray(u, float)
    y = np.arange(u.size, dtype=float) if y is None else y
    return Record(Ts * np.arange(u.size), u, y, Ts, name="long")


def test_a_record_that_is_short_enough_stays_as_it_is():
    record = record_of(np.arange(100) % 7)
    part = shorten_record(record, None, longest=100)
    assert part.record is record
    assert (part.every, part.notes) == (1, ())
    assert shorten_holdout(record, 1, longest=100) == (record, ())


def test_thinned_out_where_the_input_rests():
    u = np.repeat([1.0, 2.0, 1.0, 3.0, 2.0], 200)
    part = shorten_record(record_of(u), None, longest=400)
    assert part.every == 3
    assert len(part.record) == 333
    assert part.record.Ts == 1.5
    np.testing.assert_array_equal(part.record.y, 3.0 * np.arange(333))
    assert part.record.u[66] == pytest.approx((1.0 + 1.0 + 2.0) / 3.0)  # the change lies within
    assert part.notes == (
        "The diagnosis uses 333 of the 1000 samples of the record, from t = 0 s to 498 s, one in 3 (the input averaged "
        "over each interval).",
    )


def test_cut_where_the_input_never_rests():
    u = np.concatenate([np.zeros(500), np.random.default_rng(1).uniform(-1, 1, 420), np.zeros(80)])
    part = shorten_record(record_of(u), None, longest=100)
    assert part.every == 1
    assert len(part.record) == 100
    k = round(part.record.t[0] / 0.5)
    assert 500 <= k <= 820
    np.testing.assert_array_equal(part.record.u, u[k : k + 100])
    assert "uses 100 of the 1000 samples" in part.notes[0]


def test_the_last_samples_are_not_forgotten():
    u = np.zeros(1030)
    u[-5:] = [1.0, 0.0, 1.0, 0.0, 1.0]
    u[:-5] += 1e-9 * np.arange(1025)
    part = shorten_record(record_of(u), None, longest=100)
    assert part.record.t[-1] == 0.5 * 1029


def test_a_given_simulation_keeps_its_sampling_time_and_its_beginning():
    u = np.repeat([1.0, 1.0, 1.0, 1.0, 3.0, 2.0], 200)
    record = record_of(u)
    part = shorten_record(record, {"num": [1.0]}, longest=300)
    assert (part.every, len(part.record)) == (1, 300)
    part = shorten_record(record, SimulatedOutput(2.0 * record.y), longest=300)
    np.testing.assert_array_equal(part.simulation.y, 2.0 * part.record.y)
    part = shorten_record(record, function_simulator(lambda t, u: u), longest=300)
    assert part.record.t[0] == 0.0


def test_the_holdout_goes_along():
    part, notes = shorten_holdout(record_of(np.arange(1000)), 3, longest=100)
    assert (len(part), part.Ts) == (100, 1.5)
    assert notes == ("The diagnosis uses 100 of the 1000 samples of the holdout, up to t = 148.5 s.",)


def test_thinned_by_one_is_the_same():
    record = record_of(np.arange(10))
    assert downsample(record, 1) is record


@searched("input-delay", "load-step")
def test_the_report_states_the_samples_left_out(rig_record, monkeypatch):
    record = rig_record("none", 900)
    monkeypatch.setattr(
        prepared, "shorten_record", lambda *given, is_slow: shorten_record(*given, longest=200, is_slow=is_slow)
    )
    monkeypatch.setattr(
        prepared, "shorten_holdout", lambda holdout, every: shorten_holdout(holdout, every, longest=200)
    )
    report = diagnose(record, holdout=rig_record("none", 700, seed=6)).report
    assert report["record"]["samples"] == 900
    assert report["screen"][0].startswith("The diagnosis uses 200 of the 900 samples of the record, from t = ")
    assert report["screen"][1] == "The diagnosis uses 200 of the 700 samples of the holdout, up to t = 99.5 s."
    assert report["verdict"] == "none"
