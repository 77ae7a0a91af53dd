"""The records that ship are what their commands make, and the README tells the truth about them."""

import re

import numpy as np
import pytest
import scipy.io

from autograder.course.own_secret import PUBLIC_SECRET
from labsid.lab.identification import identify
from labsid.records.record import load_record
from labsid.rig import (
    lab_record_bytes,
    make_empty_start_record,
    make_lab_record,
    make_verification_record,
    read_secret,
    student_plan,
)
from labsid.rig.lab.plan import STAND_IN
from labsid.rig.switchable.withheld import withheld_record_bytes
from labsid.rig.switchable.withheld_effects import RECORD_FILE, STAND_IN_STUDENT

MADE_BY = {
    "SysIdenData_StudentVersion.mat": make_lab_record,
    "SysIdenData_Verification.mat": make_verification_record,
    "SysIdenData_EmptyStart.mat": make_empty_start_record,
}


@pytest.fixture(scope="module")
def data(shipped_record_path):
    return shipped_record_path.parent


@pytest.fixture(scope="module")
def readme(data):
    return (data / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", MADE_BY)
def test_a_shipped_record_is_made_again_byte_for_byte(data, name):
    assert (data / name).read_bytes() == lab_record_bytes(MADE_BY[name]())


def test_the_stand_in_of_the_withheld_rigs_is_made_again_byte_for_byte(data):
    assert (data / RECORD_FILE).read_bytes() == withheld_record_bytes(STAND_IN_STUDENT, PUBLIC_SECRET)


@pytest.mark.parametrize("name", MADE_BY)
def test_the_door_takes_a_shipped_record(data, name):
    log = MADE_BY[name]()
    record = load_record(data / name)
    assert record.Ts == 0.75
    np.testing.assert_array_equal(record.y, log.y_noise_reduced)
    np.testing.assert_array_equal(record.u, log.u)


def test_the_lab_s_four_lines_read_the_stand_in(data):
    LogData = scipy.io.loadmat(data / "SysIdenData_StudentVersion.mat", struct_as_record=False)["LogData"][0, 0]
    t = LogData.time
    y_act = LogData.signals[0, 0].values[:, 1]
    y_actm = LogData.signals[0, 0].values[:, 0]
    u_act = LogData.signals[0, 1].values
    assert t.shape == u_act.shape == (903, 1)
    assert y_act.shape == y_actm.shape == (903,)


def test_the_readme_names_every_file_with_its_length(data, readme):
    shipped = {path.name for path in data.iterdir()} - {"README.md"}
    rows = dict(re.findall(r"^\| `([^`]+)` \|.*\| (\d*) ?\|[^|]+\|$", readme, re.MULTILINE))
    assert set(rows) == shipped
    for name in MADE_BY:
        assert int(rows[name]) == len(load_record(data / name))


def test_the_readme_states_the_rig_that_was_used(readme):
    p = STAND_IN.parameters
    for stated in (
        f"{p.upper_area:g} and {p.lower_area:g} cm^2",
        f"{p.upper_orifice:g} and {p.lower_orifice:g} cm^2",
        f"{p.upper_height:g} and {p.lower_height:g} cm",
        f"{p.pump_gain:g} cm^3/s/V",
        f"{p.sensor_gain:g} V/cm; {p.sensor_zero:g} V",
        "samples 51, 251, 451, 651 and 851",
    ):
        assert stated in readme


def test_the_readme_states_the_levels_of_the_stand_in(data, readme):
    y = load_record(data / "SysIdenData_StudentVersion.mat").y
    stated = re.search(r"about ([\d.]+), ([\d.]+) and ([\d.]+) V for 2\.0, 1\.6\s+and 2\.2 V", readme)
    assert stated is not None
    measured = [y[end - 20 : end].mean() for end in (51, 251, 451)]
    assert [float(level) for level in stated.groups()] == pytest.approx(measured, abs=0.02)


def test_the_demo_secret_says_that_it_is_public_and_works(data):
    secret = read_secret(data / "demo-secret.txt")
    assert b"public" in secret
    assert student_plan("z5000001", secret) != student_plan("z5000002", secret)


def test_the_records_tell_the_lab_s_story(data):
    lab = identify(load_record(data / "SysIdenData_StudentVersion.mat"))
    assert lab.warnings == ()
    assert lab.offsets.settled == (0, 51)
    empty = identify(load_record(data / "SysIdenData_EmptyStart.mat"))
    assert 0 < empty.offsets.settled[0] < empty.offsets.settled[1] == 351
    assert empty.offsets.y_offset == pytest.approx(lab.offsets.y_offset, abs=0.02)
