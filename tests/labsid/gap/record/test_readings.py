"""Records of a slow sensor: simulated at all samples, compared at the readings that it has."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid.gap.diagnosis import diagnose
from labsid.gap.record.readings import at_readings
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

FEW = (
    "input-delay",
    "input-dead-zone",
    "input-backlash",
    "input-nonlinearity",
    "extra-lag",
    "output-drift",
    "periodic-disturbance",
)
"""What readings that come late, or that are held, may be taken for; `test_nothing_is_invented...` tries all."""


@searched(*FEW)
def test_a_slow_sensor_is_diagnosed_at_its_readings():
    rng = np.random.default_rng(2)
    u = np.repeat(rng.uniform(0, 10, 30), 40)
    readings = lfilter([0, 0.03], [1, -0.97], u) + 0.02 * rng.standard_normal(u.size)
    y = readings[np.arange(u.size) // 5 * 5]
    run = Record(0.1 * np.arange(u.size), u, y, 0.1)
    found = at_readings([run])
    (slow,), stride, (note,) = found.records, found.stride, found.notes
    assert (stride, slow.Ts) == (1, pytest.approx(0.5))
    np.testing.assert_array_equal(slow.y, readings[::5][: len(slow)])
    np.testing.assert_array_equal(slow.u, u[::5][: len(slow)])
    report = diagnose(run).report
    assert report["verdict"] == "none"
    assert note in report["screen"]


@searched(*FEW)
def test_a_slow_sensor_with_a_clock_of_its_own_shows_no_gap():
    rng = np.random.default_rng(6)
    u = np.repeat(rng.uniform(-1, 1, 40), 40)
    readings = lfilter([0, 1.0, -0.5], np.poly([0.96, 0.92]), u)
    readings = readings / np.std(readings) + 0.02 * rng.standard_normal(u.size)
    y = readings[np.ceil(np.floor(np.arange(u.size) / 3.3) * 3.3).astype(int)]
    report = diagnose(Record(0.1 * np.arange(u.size), u, y, 0.1)).report
    assert report["verdict"] == "none"
    assert "one sample in 3.3 only" in " ".join(report["screen"])


@searched(*FEW)
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
    found = at_readings([run])
    (slow,), stride = found.records, found.stride
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
@searched(*FEW)
def test_the_input_may_move_between_two_readings(held):
    found = at_readings([run := read_slowly(dead, 1, held=held)])
    (slow,), stride, (note,) = found.records, found.stride, found.notes
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


@pytest.mark.parametrize("seed", [2, pytest.param(3, marks=pytest.mark.exhaustive)])
def test_nothing_is_invented_between_the_readings(seed):
    report = diagnose(read_slowly(np.array, seed, every=4)).report
    assert (report["verdict"], report["effects"]) == ("none", [])
    assert report["unexplained"]["whiteness_p"] > 1e-3


@searched(*FEW)
def test_a_delay_of_a_slow_sensor_is_found_between_its_readings():
    late = read_slowly(lambda u: np.concatenate([np.full(7, u[0]), u[:-7]]), 4, every=3)
    report = diagnose(late).report
    (cause,) = report["effects"]
    assert cause["name"] == "input-delay"
    assert cause["parameters"]["delay"]["value"] == pytest.approx(0.14, abs=0.02)


@searched(*FEW)
def test_a_slow_sensor_beside_a_simulation_and_another_run():
    found = diagnose(read_slowly(dead, 5), holdout=read_slowly(dead, 6))
    assert [cause["name"] for cause in found.report["effects"]] == ["input-dead-zone"]
    assert found.report["gap"]["closed"] > 0.9
    again = diagnose(read_slowly(dead, 7), found.model.to_json_dict()).report
    assert again["verdict"] == "none"


@searched(*FEW)
def test_missing_readings_of_a_slow_sensor_are_left_out():
    run = read_slowly(np.array, 8, held=False)
    y = run.y.copy()
    y[[100, 105, 500]] = np.nan
    holes = Record(run.t, run.u, y, run.Ts)
    found = at_readings([holes])
    (slow,), stride = found.records, found.stride
    assert (stride, int((~slow.missing).sum())) == (5, 197)
    assert diagnose(holes).report["verdict"] == "none"


def test_too_few_readings_are_refused():
    run = read_slowly(np.array, 9, every=12)
    with pytest.raises(ValueError, match="has 84 readings; a diagnosis needs at least 100"):
        diagnose(run)


def test_more_samples_than_a_search_can_take_are_fewer_between_the_readings():
    run = read_slowly(dead, 1)
    found = at_readings([run], longest=500)
    (slow,), stride = found.records, found.stride
    assert (stride, slow.Ts) == (2, pytest.approx(0.05))
    np.testing.assert_array_equal(slow.y[::2], run.y[::5][: slow.y[::2].size])
    assert at_readings([run], longest=0).stride == 1


def at_full_rate(w, seed):
    return read_slowly(w, seed, every=1)


@searched(*FEW)
def test_a_simulated_output_is_cut_like_its_record():
    run = read_slowly(dead, 12, held=False)
    simulated = lfilter([0, 0.05, 0.04], np.poly([0.9, 0.8]), run.u)
    report = diagnose(run, simulated).report
    assert [cause["name"] for cause in report["effects"]] == ["input-dead-zone"]


@pytest.mark.parametrize(("first", "second"), [(read_slowly, at_full_rate), (at_full_rate, read_slowly)])
@searched(*FEW)
def test_one_of_two_records_may_have_a_slow_sensor(first, second):
    report = diagnose(first(dead, 13), holdout=second(dead, 14)).report
    assert [cause["name"] for cause in report["effects"]] == ["input-dead-zone"]
    assert report["gap"]["after"] < 1.5 * report["gap"]["noise_floor"]


@searched(*FEW)
def test_several_slow_records_begin_where_their_readings_say():
    report = diagnose([read_slowly(dead, seed) for seed in (15, 16)]).report
    assert [cause["name"] for cause in report["effects"]] == ["input-dead-zone"]
    assert all(one["after"] < 1.4 * one["noise_floor"] for one in report["records"])


@searched(*FEW)
def test_a_sinusoid_is_looked_for_up_to_half_the_rate_of_the_readings():
    run = read_slowly(np.array, 18)
    wave = 0.3 * np.std(run.y) * np.sin(2.0 * np.pi * 9.2 * run.t)
    report = diagnose(Record(run.t, run.u, run.y + wave[np.arange(run.t.size) // 5 * 5], run.Ts)).report
    (cause,) = report["effects"]
    assert cause["name"] == "periodic-disturbance"
    assert cause["parameters"]["frequency"]["value"] == pytest.approx(0.8, abs=0.01)


@searched(*FEW)
def test_between_readings_the_error_is_drawn_and_not_the_output():
    report = diagnose(read_slowly(dead, 19)).report
    traces = {name: np.array(values, float) for name, values in report["traces"].items()}
    assert np.abs(traces["y"] - traces["after"]).max() < 6.0 * report["gap"]["noise_floor"]


POLES = (0.95, 0.85)


def simulate(t, u):
    return lfilter([0, 0.005, 0.0045], np.poly(POLES), u)


def read_between_samples(w, every, jitter=0.0, lost=0.0):
    """A logger that holds the readings of a sensor with a clock of its own, between the samples of the input."""
    rng, fine, N = np.random.default_rng(13), 20, 2400
    u = np.repeat(rng.uniform(-1, 1, N // 20), 20)
    exact = np.interp(np.arange(N * fine) / fine, np.arange(N), simulate(None, w(u)))
    ticks = 0.3 + every * np.arange(int(N / every))
    ticks = np.sort(ticks + jitter * every * rng.uniform(-1, 1, ticks.size))
    ticks = ticks[(ticks > 0.0) & (rng.random(ticks.size) >= lost)]
    readings = exact[(ticks * fine).astype(int)] + 0.002 * rng.standard_normal(ticks.size)
    seen = np.searchsorted(ticks, np.arange(N), side="right") - 1
    return Record(0.1 * np.arange(N), u, readings[np.maximum(seen, 0)], 0.1)


@pytest.mark.parametrize(
    ("every", "jitter", "lost"),
    [
        pytest.param(4.6, 0.0, 0.0, marks=pytest.mark.exhaustive),
        (4.6, 0.0, 0.2),
        pytest.param(6.0, 0.4, 0.0, marks=pytest.mark.exhaustive),
    ],
)
@searched("input-saturation", *FEW)
def test_a_given_simulation_is_compared_at_the_times_of_the_readings(every, jitter, lost):
    run = read_between_samples(np.array, every, jitter, lost)
    report = diagnose(run, simulate, exclude=[(50.0, 60.0)]).report
    assert (report["verdict"], report["effects"]) == ("none", [])
    assert report["gap"]["before"] < (0.008 if jitter else 0.003)  # the noise is .002, a sample up to .02
    limited = read_between_samples(lambda u: np.clip(u, -0.5, 0.6), every, jitter, lost)
    found = diagnose(limited, simulate).report["effects"]
    (cause,) = [one for one in found if one["probability"] > 0.5]
    assert cause["name"] == "input-saturation"
    assert cause["parameters"]["high"]["value"] == pytest.approx(0.6, abs=0.03)
