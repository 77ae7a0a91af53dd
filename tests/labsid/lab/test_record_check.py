"""`check_record`: what is said about a record is what was put into it."""

import json

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.lab.record_check import check_record, to_json_dict
from labsid.records.formats import RawRecord, read_raw
from labsid.records.reading import Reading


def texts(check, topic, level=None):
    found = [f for f in check.findings if f.topic == topic]
    if level is not None:
        assert [f.level for f in found] == [level] * len(found)
    assert found, f"nothing about {topic} in {[f.topic for f in check.findings]}"
    return " | ".join(f.text for f in found)


@pytest.fixture
def good(staircase):
    def make(**changes):
        s = staircase
        columns = {"t": s["t"], "u": s["u"], "y": s["y"], "y_measured": s["measured"], "y_noise_reduced": s["y"]}
        return RawRecord(**(columns | changes))

    return make


def changed(values, index, value):
    values = np.array(values)
    values[index] = value
    return values


def test_a_good_record(good):
    check = check_record(good())
    assert check.usable
    assert check.faults == ()
    assert (check.samples, check.Ts) == (600, 0.75)
    assert check.verdict.startswith("usable for the lab: yes, because it starts at rest")
    assert {f.level for f in check.findings} <= {"ok", "note"}
    assert texts(check, "sampling", "ok") == "600 samples, one every 0.75 s, 449.25 s in all; no gaps."
    assert "3 levels (1.6, 2, 2.2), 5 changes; held (samples): 2 for 100, 1.6 for 100" in texts(check, "input", "ok")
    assert texts(check, "rest", "ok").startswith("settled from the start: 100 samples (75 s) before the first change")
    assert "lattice of 0.0048828 (a converter of 10 bits over 5" in texts(check, "converter")
    assert "exactly the mean of the last 5 samples" in texts(check, "noise reduction", "note")
    assert "a delay of 2 samples (1.5 s)" in texts(check, "noise reduction")
    assert "none seen" in texts(check, "feedback", "ok")
    assert "order at least 10; cond(Phi) of the first half" in texts(check, "excitation", "ok")


def test_the_noise_is_that_of_the_measured_output(good):
    text = texts(check_record(good()), "noise", "ok")
    assert "measured output, settled" in text
    assert float(text.split()[1]) == pytest.approx(0.01, rel=0.25)


def test_missing_values_by_stretches(good, staircase):
    u = changed(staircase["u"], [17, 18, 19, 40], np.nan)
    check = check_record(good(u=u, t=changed(staircase["t"], 5, np.inf)))
    assert not check.usable
    told = texts(check, "values", "refused")
    assert "u is missing or not finite at samples 17 to 19, 40 (4 in all)." in told
    assert "t is missing or not finite at samples 5 (1 in all)." in told
    assert told.count("|") == 1
    assert [fault.topic for fault in check.faults] == ["values", "values"]


def test_missing_outputs_are_counted_and_nothing_is_refused(good, staircase):
    y = changed(staircase["y"], [17, 18, 19, 40], np.nan)
    check = check_record(good(y=y, y_noise_reduced=y))
    assert check.usable
    assert texts(check, "values", "note") == (
        "y is missing in 4 of 600 samples (17 to 19, 40); these are neither fitted nor scored."
    )
    assert "with gaps in y" in texts(check, "sampling", "ok")


def test_values_beyond_reason(good, staircase):
    huge = changed(staircase["y"], 3, 1e300)
    check = check_record(good(y=huge))
    assert "y must be below 1e+100 in size; got 1e+300 at sample 3" in texts(check, "values", "refused")
    assert "output" not in {f.topic for f in check.findings}
    check = check_record(good(y_measured=huge))
    assert "y_measured must be below" in texts(check, "values", "refused")
    assert "between" in texts(check, "output", "ok")


def test_time_that_jumps_is_described_place_by_place(good, staircase):
    t = staircase["t"].copy()
    t[50:] -= 10.0
    t[200:] += 7.5
    check = check_record(good(t=t))
    told = texts(check, "sampling", "refused")
    assert "time goes backwards or stands still once: from 36.75 to 27.5 s at sample 50." in told
    assert "irregular once: 0.75 s as a rule, but from 139.25 to 147.5 s at sample 200." in told
    assert "The longest gap is 8.25 s, about 10 samples." in told
    assert check.verdict.startswith("usable for the lab: no, because time goes backwards")
    assert texts(check, "rest", "ok")  # the signals are described all the same


def test_many_places_are_not_all_named(good, staircase):
    y = changed(staircase["y"], slice(0, 100, 10), np.nan)
    told = texts(check_record(good(u=y)), "values")
    assert "at samples 0, 10, 20, 30, and so on (10 in all)" in told


def test_lengths_that_differ(good, staircase):
    check = check_record(good(u=staircase["u"][:-1]))
    assert "t has 600, u has 599, y has 600" in texts(check, "lengths", "refused")
    assert check.samples == 599


def test_missing_values_do_not_hide_lengths_that_differ(good, staircase):
    check = check_record(good(u=changed(staircase["u"][:-1], 3, np.nan)))
    assert "u is missing" in texts(check, "values", "refused")
    assert "u has 599" in texts(check, "lengths", "refused")


def test_one_sample():
    check = check_record(RawRecord(np.zeros(1), np.ones(1), np.ones(1)))
    assert "t must have at least 2 samples; got 1" in texts(check, "values", "refused")


def test_given_sampling_time(good):
    told = texts(check_record(good(t=None, Ts=0.75)), "sampling", "note")
    assert "one every 0.75 s as given; there are no times to verify this" in told
    assert "disagrees" in texts(check_record(good(Ts=0.5)), "sampling")
    assert "there is no time column" in texts(check_record(good(t=None)), "sampling", "refused")


def test_an_empty_start_is_seen_and_the_settled_part_found(staircase):
    s = staircase
    filling = 2.3 * (1 - np.exp(-np.arange(300) / 40)) + 0.003 * np.random.default_rng(0).standard_normal(300)
    u, y = np.r_[np.full(300, 2.0), s["u"]], np.r_[filling, s["y"]]
    check = check_record(RawRecord(None, u, y, Ts=0.75))
    told = texts(check, "rest", "warning")
    k0 = int(told.split("in samples ")[1].split()[0])
    assert 100 < k0 < 300
    assert "of the 400 samples (300 s) before the input first changes" in told
    assert float(told.split("y offset ")[1].split(",")[0]) == pytest.approx(2.3, abs=0.02)
    assert check.usable
    assert check.verdict.startswith("usable for the lab: yes, with 1 warning: not settled at the start")


def test_a_period_too_short_and_one_that_never_settles(staircase):
    s = staircase
    assert "only 4 samples" in texts(check_record(RawRecord(None, s["u"][96:], s["y"][96:], Ts=1)), "rest", "warning")
    u = np.repeat([2.0, 1.6, 2.2], 100)
    drifting = np.arange(300) / 50
    assert "before the input first changes" in texts(
        check_record(RawRecord(None, u, drifting, Ts=1)), "rest", "warning"
    )


def test_an_input_that_moves_at_once(staircase):
    rng = np.random.default_rng(2)
    check = check_record(RawRecord(None, rng.standard_normal(300), rng.standard_normal(300), Ts=1))
    assert "the input changes at sample 1" in texts(check, "rest", "refused")
    assert "between" in texts(check, "input", "ok")
    assert not check.usable


def test_constant_signals(good, staircase):
    constant = np.full(600, 2.0)
    check = check_record(good(u=constant))
    assert "the input is constant (2). It excites nothing" in texts(check, "input", "refused")
    assert check.faults == ()
    check = check_record(good(y=constant, y_noise_reduced=constant, y_measured=constant))
    assert "the output is constant (2)" in texts(check, "output", "refused")


def test_too_few_samples_for_the_unknowns():
    u, y = np.array([0.0, 0.0, 1.0, 1.0, 0.0]), np.array([0.0, 0.0, 0.0, 0.5, 0.75])
    told = texts(check_record(RawRecord(None, u, y, Ts=1)), "excitation", "refused")
    assert told == "the first half has 2 samples, too few rows for the 2 unknowns of order 1."


def test_a_first_half_without_a_change(staircase):
    s = staircase
    u, y = np.r_[np.full(700, 2.0), s["u"]], np.r_[np.full(700, 2.3), s["y"]]
    told = texts(check_record(RawRecord(None, u, y, Ts=1)), "excitation", "refused")
    assert told.startswith("the first half does not excite order 1. Phi has rank ")


def test_signals_of_very_different_sizes_are_told_from_an_input_that_does_not_excite(staircase):
    s = staircase
    told = texts(check_record(RawRecord(None, 1e12 * s["u"], 1e-12 * s["y"], Ts=1)), "excitation", "refused")
    assert told.startswith("y is at most ")
    assert told.endswith("Convert one of them to other units.")
    assert "rank" not in told


def test_plateaus_that_do_not_repeat(good, staircase):
    assert "comes back to the same levels" in texts(check_record(good()), "plateaus", "ok")
    drift = np.linspace(0, 0.2, 600)
    s = staircase
    check = check_record(RawRecord(s["t"], s["u"], s["y"] + drift))
    assert "does not come back to the same level" in texts(check, "plateaus", "note")


def test_clipping_and_held_values(good, staircase):
    rng = np.random.default_rng(3)
    k = np.arange(900)
    u = np.repeat([0.0, 1.0, -1.0, 0.5, 1.0, -0.5], 150)
    y = np.sin(k / 20) * (k > 150) + 0.01 * rng.standard_normal(k.size)
    clipped = np.minimum(y, 0.7)
    told = texts(check_record(RawRecord(None, u, clipped, Ts=1)), "clipping", "warning")
    assert f"stuck at its highest value 0.7 for {np.sum(clipped == 0.7)} samples" in told
    y[300:320] = y[299]
    check = check_record(RawRecord(None, u, y, Ts=1))
    assert "at samples 299 to 319 (21 in all)" in texts(check, "held values", "warning")
    assert "clipping" not in {f.topic for f in check.findings}


def test_a_coarse_converter_is_worth_a_note(staircase):
    s = staircase
    y = np.round(s["y"] / 0.1) * 0.1
    told = texts(check_record(RawRecord(s["t"], s["u"], y)), "converter", "note")
    assert told.startswith("values lie on a lattice of 0.1, ")


def test_feedback(good, staircase):
    told = texts(check_record(good(reference=np.ones(600))), "feedback", "refused")
    assert told.startswith("it is a closed-loop record (it has a reference).")
    rng = np.random.default_rng(6)
    u, y = np.zeros(800), np.zeros(800)
    for k in range(1, 800):
        y[k] = 0.9 * y[k - 1] + 0.1 * u[k - 1] + 0.02 * rng.standard_normal()
        u[k] = -2 * y[k] + 0.02 * rng.standard_normal()
    assert "taken in closed loop" in texts(check_record(RawRecord(None, u, y, Ts=1)), "feedback", "warning")
    u = rng.standard_normal(800)
    y = lfilter([0, 0.1], [1, -0.9], u)
    assert "does not help" in texts(check_record(RawRecord(None, u, y, Ts=1)), "feedback", "ok")


def test_a_relay_and_a_periodic_input_are_told_apart_from_neither():
    u, y = np.zeros(800), np.zeros(800)
    for k in range(1, 800):
        y[k] = 0.9 * y[k - 1] + 0.1 * u[k - 1]
        u[k] = 1.0 if y[k] < 0.2 or (u[k - 1] == 1.0 and y[k] < 0.6) else 0.0
    assert "a relay in closed loop" in texts(check_record(RawRecord(None, u, y, Ts=1)), "feedback", "note")


def test_swapped_signals(staircase):
    s = staircase
    check = check_record(RawRecord(s["t"], s["y"], s["u"]))
    assert "u and y look swapped" in texts(check, "signals", "refused")
    assert len(check.faults) == 1


def test_how_the_file_was_understood_is_told(write_text):
    raw = read_raw(write_text("0,1,2\n1,1,2\n2,1,3\n"))
    assert texts(check_record(raw), "file", "note") == "no header: columns taken as t,u,y."


def test_json(good, staircase):
    check = check_record(good(u=changed(staircase["u"], 3, np.nan)))
    found = json.loads(json.dumps(to_json_dict(check), allow_nan=False))
    assert (found["usable"], found["refused"], found["samples"], found["Ts"]) == (False, True, 600, 0.75)
    assert found["verdict"] == check.verdict
    assert {"level": "refused", "topic": "values", "text": check.findings[1].text} in found["findings"]


# Real records ---------------------------------------------------------------------------------------------


def test_the_labs_own_file(shared_data):
    check = check_record(read_raw(shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat"))
    assert check.verdict.startswith("usable for the lab: yes, because it starts at rest")
    assert "settled from the start: 51 samples" in texts(check, "rest", "ok")
    assert "lattice of 0.0048828" in texts(check, "converter")
    assert "mean of the last 5 samples" in texts(check, "noise reduction")
    assert "269.8 for order 2" in texts(check, "excitation", "ok")
    assert "does not come back to the same level" in texts(check, "plateaus", "note")


@pytest.mark.parametrize(("number", "settled", "first"), [(4, 2.423, 308), (8, 2.806, 240)])
def test_empty_tank_starts(shared_data, number, settled, first):
    check = check_record(read_raw(shared_data / "unsw-water-tank" / f"SysIdenData_{number}.mat"))
    told = texts(check, "rest", "warning")
    assert f"of the {first} samples" in told
    assert float(told.split("y offset ")[1].split(",")[0]) == pytest.approx(settled, abs=0.012)
    assert check.usable
    assert [f.topic for f in check.findings if f.level == "warning"] == ["rest"]


def test_the_closed_loop_log(shared_data):
    check = check_record(read_raw(shared_data / "unsw-water-tank" / "SFControlData_0.mat"))
    assert check.verdict == "usable for the lab: no, because it is a closed-loop record (it has a reference)"
    assert "It rests on a limit: 2.5" in texts(check, "input", "note")
    assert check.faults == ()


def test_the_sensor_that_stops_at_ten_volts(shared_data):
    path = shared_data / "cascaded-tanks" / "dataBenchmark.csv"
    for columns in ("uEst,yEst", "uVal,yVal"):
        check = check_record(read_raw(path, Reading(columns=columns, Ts=4)))
        assert "stuck at its highest value 10 for" in texts(check, "clipping", "warning")
        assert "held values" not in {f.topic for f in check.findings}


def test_a_sensor_that_reads_seldom_is_judged_by_its_readings() -> None:
    """Straight lines between readings know the later one: they look like feedback, and have no noise."""
    rng = np.random.default_rng(5)
    u = np.repeat(rng.integers(0, 3, 40), 25).astype(float)
    y = lfilter([0, 0.1], [1, -0.9], u) + 0.05 * rng.standard_normal(u.size)
    y[np.arange(u.size) % 6 != 0] = np.nan
    found = {f.topic: f for f in check_record(RawRecord(0.1 * np.arange(u.size), u, y)).findings}
    assert found["feedback"].level == "note"
    assert "not judged" in found["feedback"].text
    said = float(found["noise"].text.split()[1])
    assert 0.03 < said < 0.3
