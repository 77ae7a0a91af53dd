"""The model of a measured rig: found again from its own run, and records made with it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from own_rigs import MOTOR, motor_log
from scipy.signal import lsim

from labsid.checks.other_records import LAB_FILE, another_record
from labsid.checks.other_records.rig_model import identify_rig, lab_input, make_rig_log, make_student_log, rests_alike
from labsid.lab.offset import find_offsets
from labsid.records.record import Record, load_record
from labsid.rig.lab.log import lab_record_bytes, log_to_record

SECRET = b"the course's secret, of more than 16 bytes"


@pytest.mark.parametrize("damping", [0.3, 1.0, 2.0])
def test_the_model_is_found_again(damping: float) -> None:
    true = replace(MOTOR, damping=damping, delay=2)
    found = identify_rig(log_to_record(motor_log(model=true)))
    assert found.gain == pytest.approx(true.gain, rel=0.01)
    assert found.period == pytest.approx(true.period, rel=0.1)
    assert found.damping == pytest.approx(damping, rel=0.1)
    assert found.delay == 2
    assert found.lattice == true.lattice
    assert found.noise == pytest.approx(true.noise, rel=0.35)
    assert 0.1 < found.correlation < 0.8


@pytest.mark.parametrize("damping", [0.4, 1.0, 2.5])
def test_the_response_is_that_of_the_transfer_function(damping: float) -> None:
    model = replace(MOTOR, damping=damping, delay=0, y_rest=0.0, u_rest=0.0)
    u = np.repeat((0.0, 1.0, -0.5), 60)
    fine = 200
    t = model.Ts / fine * np.arange(u.size * fine)
    system = ([model.gain], [model.period**2, 2 * damping * model.period, 1.0])
    held = lsim(system, np.repeat(u, fine), t, interp=False)[1][::fine]
    assert np.allclose(model.respond(u), held, atol=2e-3 * model.gain)


def test_a_record_that_no_model_follows_is_refused() -> None:
    record = log_to_record(motor_log())
    noise = np.random.default_rng(0).standard_normal(len(record))
    other = Record(t=record.t, u=record.u, y=noise, Ts=record.Ts, name="noise")
    with pytest.raises(ValueError, match="no model of second order follows noise"):
        identify_rig(other)


def test_a_log_begins_with_a_start_up_or_at_rest() -> None:
    u = np.repeat((4.0, 6.0), 100)
    quiet = replace(MOTOR, noise=0.0, lattice=0.0)
    starting = make_rig_log(replace(quiet, y_start=40.0), u, np.random.SeedSequence(0), "x", ("V", "rpm"))
    settled = make_rig_log(quiet, u, np.random.SeedSequence(0), "x", ("V", "rpm"))
    assert starting.y_measured[0] == pytest.approx(40.0, abs=1e-9)
    assert starting.y_measured[99] == pytest.approx(75.0, rel=0.01)
    assert np.allclose(settled.y_noise_reduced[:100], 75.0)
    assert not rests_alike(starting, settled)


def test_the_input_of_the_lab_is_held_until_the_output_settles() -> None:
    record = log_to_record(motor_log())
    u = lab_input(replace(MOTOR, period=1.0), record)
    changes = np.flatnonzero(np.diff(u)) + 1
    assert changes.size == 5
    assert np.diff(changes).min() * MOTOR.Ts >= 5 * replace(MOTOR, period=1.0).time_constant
    assert (u.min(), u.max()) == (record.u.min(), record.u.max())


def test_a_students_log_is_another_for_each_and_the_same_for_one() -> None:
    log = motor_log()
    model = identify_rig(log_to_record(log))
    ann, again, bob = (make_student_log(model, log, student, SECRET) for student in ("ann", "ann", "bob"))
    assert lab_record_bytes(ann) == lab_record_bytes(again)
    assert not np.array_equal(ann.y_measured, bob.y_measured)
    assert np.all(np.rint(ann.y_measured / 0.5) * 0.5 == ann.y_measured)
    with pytest.raises(ValueError, match="at least 16 bytes"):
        make_student_log(model, log, "ann", b"short")


def test_the_units_are_read_back(tmp_path: Path) -> None:
    path = tmp_path / LAB_FILE
    path.write_bytes(lab_record_bytes(replace(motor_log(), units=("%", "°C"))))
    assert load_record(path).units == ("%", "°C")


def test_hidden_records_of_a_rig_are_apart_from_it_and_no_harder(tmp_path: Path) -> None:
    own = log_to_record(motor_log())
    rest = find_offsets(own.u, own.y)
    for seed in range(8):
        path = tmp_path / LAB_FILE
        path.write_bytes(another_record(LAB_FILE, own, seed))
        other = load_record(path)
        begun = find_offsets(other.u, other.y)
        assert (len(other), other.Ts, other.units) == (len(own), own.Ts, own.units)
        assert abs(begun.y_offset - rest.y_offset) > 0.03 * max(np.ptp(own.y), np.ptp(other.y))
        assert np.count_nonzero(np.diff(other.u)) == np.count_nonzero(np.diff(own.u))
        assert (begun.settled[0] == 0) == (rest.settled[0] == 0)
        gain = identify_rig(other).gain
        assert abs(gain / MOTOR.gain - 1) > 0.12
