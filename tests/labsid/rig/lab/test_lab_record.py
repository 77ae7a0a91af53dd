"""The stand-in beside the real record, and thirty students' records through the lab's procedure."""

import hashlib

import numpy as np
import pytest
import scipy.io
from scipy import signal

from labsid.lab.excitation import excitation_order
from labsid.lab.identification import identify
from labsid.rig import (
    log_to_record,
    make_empty_start_record,
    make_lab_record,
    make_verification_record,
    student_plan,
)
from labsid.rig.lab.tanks import steady_levels

SECRET = b"a secret for the tests alone"
IDS = [f"z{5000000 + i}" for i in range(30)]
STEP = 0.0048828125
MAKERS = [make_lab_record, make_verification_record, make_empty_start_record]


def changes(u):
    return np.flatnonzero(np.diff(u)) + 1


def steady_voltage(student):
    plan = student_plan(student, SECRET)
    p = plan.parameters
    return p.sensor_zero + p.sensor_gain * steady_levels(p, plan.levels[0])[1]


@pytest.fixture(scope="module")
def stand_in():
    return make_lab_record()


@pytest.fixture(scope="module")
def logs():
    return [make_lab_record(student, SECRET) for student in IDS]


@pytest.fixture(scope="module")
def identified(logs):
    return [identify(log_to_record(log)) for log in logs]


def test_the_stand_in_has_the_lab_s_samples_and_levels(stand_in):
    assert stand_in.t.size == 903
    np.testing.assert_array_equal(stand_in.t, 0.75 * np.arange(903))
    assert changes(stand_in.u).tolist() == [51, 251, 451, 651, 851]
    assert stand_in.u[[0, *changes(stand_in.u)]].tolist() == [2.0, 1.6, 2.2, 2.0, 1.6, 2.2]


def test_the_stand_in_starts_settled_and_reaches_the_lab_s_plateaus(stand_in):
    y = stand_in.y_measured
    assert y[:51].mean() == pytest.approx(2.33, abs=0.01)
    assert abs(y[:25].mean() - y[25:51].mean()) < 0.01
    assert [y[end - 20 : end].mean() for end in (251, 451, 651, 851)] == pytest.approx(
        [1.16, 2.95, 2.32, 1.16], abs=0.05
    )


def test_the_noise_of_the_stand_in_is_that_of_its_sensor(stand_in):
    plateau = stand_in.y_measured[:51]
    assert plateau.std() == pytest.approx(0.013, rel=0.25)


def test_the_stand_in_lies_beside_the_real_record(stand_in, shared_data):
    path = shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat"
    log = scipy.io.loadmat(path, simplify_cells=True)["LogData"]
    np.testing.assert_array_equal(stand_in.t, log["time"])
    np.testing.assert_array_equal(stand_in.u, log["signals"][1]["values"])
    real = log["signals"][0]["values"]
    # Alike, so that the figures look like the lab's (0.06 V of a range of 1.9 V), but not a copy.
    assert np.sqrt(np.mean((stand_in.y_noise_reduced - real[:, 1]) ** 2)) < 0.06
    assert np.mean(stand_in.y_measured == real[:, 0]) < 0.1


def test_the_stand_in_gives_a_model_like_the_lab_s(stand_in):
    record = log_to_record(stand_in)
    second, first = identify(record), identify(record, order=1, start=1)
    assert second.fit.theta == pytest.approx([1.377, -0.392, -0.007, 0.051], abs=0.05)
    assert first.fit.theta == pytest.approx([0.978, 0.068], abs=0.01)
    assert 100 < second.fit.condition_number < 1000
    assert np.abs(second.model.poles).max() < 1
    assert second.verification.mse_all < 1.5e-3
    assert second.verification.mse_all < first.verification.mse_all
    # 3b: from rest the second half starts elsewhere, and carrying the state takes that away.
    assert second.verification.mse_second_half > 10 * second.verification.mse_second_half_carried


@pytest.mark.parametrize("make", MAKERS)
@pytest.mark.parametrize("student", [None, "z5000001"])
def test_column_one_is_quantized_and_column_two_is_its_moving_mean(make, student):
    log = make(student, SECRET if student else None)
    codes = log.y_measured / STEP
    assert (codes == np.round(codes)).all()
    mean = signal.lfilter(np.ones(5) / 5, 1, log.y_measured)
    np.testing.assert_allclose(log.y_noise_reduced[4:], mean[4:], atol=1e-14)


@pytest.mark.parametrize("make", [make_lab_record, make_verification_record])
def test_the_moving_mean_of_a_settled_rig_includes_samples_before_the_log(make):
    log = make()
    assert log.y_noise_reduced[:4] == pytest.approx(log.y_measured[:4], abs=0.04)
    inside = np.cumsum(log.y_measured[:4]) / np.arange(1, 5)
    assert not np.allclose(log.y_noise_reduced[:4], inside)  # samples from before the log are in it


def test_records_are_the_same_again_and_their_noises_differ():
    for make in MAKERS:
        np.testing.assert_array_equal(make().y_measured, make().y_measured)
    lab, verification = make_lab_record().y_measured[:51], make_verification_record().y_measured[:51]
    assert abs(np.corrcoef(lab, verification)[0, 1]) < 0.5


def test_a_student_s_record_never_changes():
    # Recorded once, in codes of the converter, which no rounding of the platform can move.
    codes = np.round(make_lab_record("z5000001", SECRET).y_measured / STEP).astype("<i2")
    assert codes[:6].tolist() == [522, 516, 518, 521, 517, 519]
    assert (
        hashlib.sha256(codes.tobytes()).hexdigest()
        == "43c430f6ef6b1f4e66594e6c7d95c73111c967de916025cceb725d995a25d457"
    )


def test_every_student_s_record_is_settled_and_in_range(logs):
    for student, log in zip(IDS, logs, strict=True):
        first = int(changes(log.u)[0])
        rest = log.y_measured[:first]
        assert log.t.size == 903
        assert changes(log.u).size == 5
        assert rest.mean() == pytest.approx(steady_voltage(student), abs=0.013 * 4 / np.sqrt(first))
        assert log.y_measured.min() > 0.2
        assert log.y_measured.max() < 4.8
        assert np.ptp(log.y_noise_reduced) > 1.0  # a hundred times the noise


def test_every_student_s_record_goes_through_the_lab_s_procedure(identified):
    for result in identified:
        assert result.warnings == ()
        assert result.offsets.status == "settled"
        assert result.fit.status == "unique"
        assert result.fit.condition_number < 1000
        assert np.abs(result.model.poles).max() < 0.99
        assert result.verification.mse_all < 0.01 * np.var(result.y)


def test_every_student_s_input_is_persistently_exciting(logs, identified):
    for log, result in zip(logs, identified, strict=True):
        assert result.excitation.positive_definite
        assert excitation_order(log.u[:451] - log.u[0]) >= 4


def test_no_student_can_hand_in_another_s_theta(identified):
    theta = np.array([result.fit.theta for result in identified])
    apart = np.abs(theta[:, None] - theta[None]).max(axis=2)
    np.fill_diagonal(apart, np.inf)
    assert apart.min() > 1e-4  # the nearest two of 435 pairs, in their most different coefficient
    assert np.median(apart.min(axis=1)) > 3e-3


def test_students_rigs_behave_differently(identified):
    gain = [result.model.b.sum() / result.model.a.sum() for result in identified]
    tau = [-0.75 / np.log(np.abs(result.model.poles).max()) for result in identified]
    assert np.std(gain) / np.mean(gain) > 0.08
    assert np.std(tau) / np.mean(tau) > 0.08
    assert 15 < min(tau) < 25 < 35 < max(tau) < 50


@pytest.mark.parametrize("student", [None, *IDS[:3]])
def test_a_model_of_the_lab_record_is_valid_on_the_verification_record(student):
    secret = SECRET if student else None
    lab, other = make_lab_record(student, secret), make_verification_record(student, secret)
    assert other.u[0] == lab.u[0]
    assert lab.u.min() < other.u.min() < other.u.max() <= lab.u.max()
    assert np.isin(np.unique(other.u), np.unique(lab.u)).sum() <= 2  # the rest, and at most one more
    model = identify(log_to_record(lab)).model
    y_sim = signal.lfilter(np.append(0, model.b), model.a, other.u - model.u_offset)
    error = other.y_noise_reduced - model.y_offset - y_sim
    assert np.mean(error**2) < 0.02 * np.var(other.y_noise_reduced)


@pytest.mark.parametrize("student", [None, *IDS[:3]])
def test_an_empty_start_settles(student):
    log = make_empty_start_record(student, SECRET if student else None)
    lab = make_lab_record(student, SECRET if student else None)
    np.testing.assert_array_equal(log.u[300:], lab.u)
    assert abs(log.y_measured[0]) < 0.1  # the sensor shows an empty tank ...
    assert np.diff(log.y_noise_reduced[:40]).min() > -0.05  # ... that fills from then on
    assert log.y_noise_reduced[0] == pytest.approx(log.y_measured[0] / 5)  # zeros before it
    offsets = identify(log_to_record(log)).offsets
    assert offsets.status == "settled"
    assert offsets.settled[0] > 50
    assert offsets.settled[1] == offsets.first_period == changes(log.u)[0]
    assert offsets.y_offset == pytest.approx(lab.y_noise_reduced[: changes(lab.u)[0]].mean(), abs=0.03)


@pytest.mark.parametrize("make", MAKERS)
def test_student_and_secret_go_together(make):
    with pytest.raises(ValueError, match="student and secret go together; got no secret"):
        make(student="z5000001")
    with pytest.raises(ValueError, match="student and secret go together; got no student"):
        make(secret=SECRET)


def test_an_unusable_id_or_secret_is_refused():
    with pytest.raises(ValueError, match="student must be an ID"):
        make_lab_record("", SECRET)
    with pytest.raises(ValueError, match="secret must have at least 16 bytes"):
        make_lab_record("z5000001", b"")
