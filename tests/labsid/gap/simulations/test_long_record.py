"""Very long records: which part is diagnosed, and that it is said."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.gap import diagnosis
from labsid.gap.diagnosis import diagnose
from labsid.gap.simulations.long_record import at_readings, downsample, shorten_holdout, shorten_record
from labsid.gap.simulations.simulated_output import SimulatedOutput
from labsid.records.record import Record
from labsid.simulators.simulator import function_simulator


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


def test_the_report_states_the_samples_left_out(rig_record, monkeypatch):
    record = rig_record("none", 900)
    monkeypatch.setattr(
        diagnosis, "shorten_record", lambda record, sim, stride: shorten_record(record, sim, longest=200, stride=stride)
    )
    monkeypatch.setattr(
        diagnosis, "shorten_holdout", lambda holdout, every: shorten_holdout(holdout, every, longest=200)
    )
    report = diagnose(record, holdout=rig_record("none", 700, seed=6)).report
    assert report["record"]["samples"] == 900
    assert report["screen"][0].startswith("The diagnosis uses 200 of the 900 samples of the record, from t = ")
    assert report["screen"][1] == "The diagnosis uses 200 of the 700 samples of the holdout, up to t = 99.5 s."
    assert report["verdict"] == "none"


def test_a_slow_sensor_is_diagnosed_at_its_readings():
    rng = np.random.default_rng(2)
    u = np.repeat(rng.uniform(0, 10, 30), 40)
    readings = lfilter([0, 0.03], [1, -0.97], u) + 0.02 * rng.standard_normal(u.size)
    y = readings[np.arange(u.size) // 5 * 5]
    run = Record(0.1 * np.arange(u.size), u, y, 0.1)
    (slow,), stride, (note,) = at_readings([run])
    assert (stride, slow.Ts) == (1, pytest.approx(0.5))
    np.testing.assert_array_equal(slow.y, readings[::5][: len(slow)])
    np.testing.assert_array_equal(slow.u, u[::5][: len(slow)])
    report = diagnose(run).report
    assert report["verdict"] == "none"
    assert note in report["screen"]


def test_a_slow_sensor_with_a_clock_of_its_own_shows_no_gap():
    rng = np.random.default_rng(6)
    u = np.repeat(rng.uniform(-1, 1, 40), 40)
    readings = lfilter([0, 1.0, -0.5], np.poly([0.96, 0.92]), u)
    readings = readings / np.std(readings) + 0.02 * rng.standard_normal(u.size)
    y = readings[np.ceil(np.floor(np.arange(u.size) / 3.3) * 3.3).astype(int)]
    report = diagnose(Record(0.1 * np.arange(u.size), u, y, 0.1)).report
    assert report["verdict"] == "none"
    assert "one sample in 3.3 only" in " ".join(report["screen"])


def test_readings_at_the_ticks_of_a_clock_are_at_even_distances():
    """Of a fast rig, where a reading that is taken for one of the next sample is far off."""
    rng, every, pole = np.random.default_rng(7), 4.32, np.exp(-1 / 6)
    u = rng.uniform(-1, 1, 1500)
    exact = lfilter([0, 1 - pole], [1, -pole], u)
    ticks = 0.4 + every * np.arange(int(u.size / every))
    whole = ticks.astype(int)  # y decays towards u within a sample
    true = u[whole] + (exact[whole] - u[whole]) * np.exp(-(ticks - whole) / 6)
    readings = true + 0.01 * rng.standard_normal(ticks.size)
    seen = np.searchsorted(ticks, np.arange(u.size), side="right") - 1
    run = Record(0.1 * np.arange(u.size), u, readings[np.maximum(seen, 0)], 0.1)
    (slow,), stride, _ = at_readings([run])
    assert (stride, slow.Ts) == (5, pytest.approx(0.1 * every / 5, rel=1e-4))
    t, y = slow.t[::5], slow.y[::5]
    first = int(np.argmin(np.abs(ticks * 0.1 - t[0])))
    np.testing.assert_array_equal(y, readings[first : first + y.size])
    assert np.isnan(np.delete(slow.y, np.arange(0, slow.y.size, 5))).all()
    np.testing.assert_allclose(t, 0.1 * ticks[first : first + t.size], atol=0.05)
    assert diagnose(run).report["verdict"] == "none"


def read_slowly(w, seed, every=5, held=True):
    """A command that moves at each sample, and a rig behind `w` of it that is read at every so many samples."""
    rng = np.random.default_rng(seed)
    u = lfilter([0.5], [1, -0.5], rng.uniform(-1, 1, 1000))
    y = lfilter([0, 0.05, 0.04], np.poly([0.9, 0.8]), w(u))
    y = y + 0.01 * np.std(y) * rng.standard_normal(u.size)
    seen = y[np.arange(u.size) // every * every] if held else np.where(np.arange(u.size) % every, np.nan, y)
    return Record(0.02 * np.arange(u.size), u, seen, 0.02)


def dead(u):
    return np.sign(u) * np.maximum(np.abs(u) - 0.2, 0.0)


@pytest.mark.parametrize("held", [True, False])
def test_the_input_may_move_between_two_readings(held):
    (slow,), stride, (note,) = at_readings([run := read_slowly(dead, 1, held=held)])
    assert (stride, len(slow)) == (5, 996)
    np.testing.assert_array_equal(slow.u, run.u[:996])
    np.testing.assert_array_equal(slow.y[::5], run.y[:996:5])
    assert slow.missing.sum() == 996 - 200
    report = diagnose(run).report
    assert note in report["screen"]
    (cause,) = report["effects"]
    assert cause["name"] == "input-dead-zone"
    assert cause["parameters"]["high"]["value"] == pytest.approx(0.2, abs=0.02)
    assert not any("feedback" in finding["text"] for finding in report["record_findings"])


def test_nothing_is_invented_between_the_readings():
    for seed in (2, 3):
        report = diagnose(read_slowly(np.array, seed, every=4)).report
        assert (report["verdict"], report["effects"]) == ("none", [])
        assert report["unexplained"]["whiteness_p"] > 1e-3


def test_a_delay_of_a_slow_sensor_is_found_between_its_readings():
    late = read_slowly(lambda u: np.concatenate([np.full(7, u[0]), u[:-7]]), 4, every=3)
    report = diagnose(late).report
    (cause,) = report["effects"]
    assert cause["name"] == "input-delay"
    assert cause["parameters"]["delay"]["value"] == pytest.approx(0.14, abs=0.02)


def test_a_slow_sensor_beside_a_simulation_and_another_run():
    found = diagnose(read_slowly(dead, 5), holdout=read_slowly(dead, 6))
    assert [cause["name"] for cause in found.report["effects"]] == ["input-dead-zone"]
    assert found.report["gap"]["closed"] > 0.9
    again = diagnose(read_slowly(dead, 7), found.model.to_json_dict()).report
    assert again["verdict"] == "none"


def test_missing_readings_of_a_slow_sensor_are_left_out():
    run = read_slowly(np.array, 8, held=False)
    y = run.y.copy()
    y[[100, 105, 500]] = np.nan
    holes = Record(run.t, run.u, y, run.Ts)
    (slow,), stride, _ = at_readings([holes])
    assert (stride, int((~slow.missing).sum())) == (5, 197)
    assert diagnose(holes).report["verdict"] == "none"


def test_too_few_readings_are_refused():
    run = read_slowly(np.array, 9, every=12)
    with pytest.raises(ValueError, match="has 84 readings; a diagnosis needs at least 100"):
        diagnose(run)


def test_more_samples_than_a_search_can_take_are_fewer_between_the_readings():
    run = read_slowly(dead, 1)
    (slow,), stride, _ = at_readings([run], longest=500)
    assert (stride, slow.Ts) == (2, pytest.approx(0.05))
    np.testing.assert_array_equal(slow.y[::2], run.y[::5][: slow.y[::2].size])
    assert at_readings([run], longest=0)[1] == 1
