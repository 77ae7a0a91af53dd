"""The log and its file: the lab's four lines, the layout of the real file, equal bytes."""

import os

import numpy as np
import pytest
import scipy.io

from labsid.records.record import load_record
from labsid.rig.lab.log import LabLog, lab_record_bytes, log_to_record, write_lab_record


@pytest.fixture
def log():
    rng = np.random.default_rng(5)
    return LabLog(
        t=0.75 * np.arange(60),
        u=np.repeat([2.0, 1.6], 30),
        y_measured=rng.normal(2.3, 0.1, 60),
        y_noise_reduced=rng.normal(2.3, 0.1, 60),
        Ts=0.75,
        name="a_run",
    )


@pytest.fixture
def path(log, tmp_path):
    path = tmp_path / "a_run.mat"
    write_lab_record(path, log)
    return path


def test_the_four_lines_of_the_lab(log, path):
    # t = LogData.time; y_act = LogData.signals(1).values(:,2); y_actm = LogData.signals(1).values(:,1);
    # u_act = LogData.signals(2).values;
    LogData = scipy.io.loadmat(path)["LogData"][0, 0]
    signals = LogData["signals"]
    assert signals.shape == (1, 2)
    np.testing.assert_array_equal(LogData["time"], log.t[:, None])
    np.testing.assert_array_equal(signals[0, 0]["values"][:, 1], log.y_noise_reduced)
    np.testing.assert_array_equal(signals[0, 0]["values"][:, 0], log.y_measured)
    np.testing.assert_array_equal(signals[0, 1]["values"], log.u[:, None])


def layout(value):
    """Fields, shapes and kinds of a MATLAB value, without its numbers and lengths of text."""
    if value.dtype.names:
        inner = [{name: layout(element[name]) for name in value.dtype.names} for element in value.ravel()]
        return value.shape, inner
    if value.dtype.kind == "U":
        return "text", value.size
    return "numbers", len(value.shape), value.shape[1:], value.size == 0


def test_the_layout_is_that_of_the_real_file(path, shared_data):
    real = shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat"
    ours, theirs = (scipy.io.loadmat(file, mat_dtype=True)["LogData"] for file in (path, real))
    assert layout(ours) == layout(theirs)
    for field in ("dimensions", "label", "plotStyle"):
        for i in range(2):
            np.testing.assert_array_equal(ours[0, 0]["signals"][0, i][field], theirs[0, 0]["signals"][0, i][field])


def test_the_file_says_that_it_is_simulated(path):
    assert path.read_bytes().startswith(b"MATLAB 5.0 MAT-file, written by labsid.rig: a simulated record")
    assert "simulated" in scipy.io.loadmat(path)["LogData"][0, 0]["blockName"].item()


def test_it_is_a_version_5_file_in_the_byte_order_it_states(path):
    head = path.read_bytes()[:128]
    assert head[124:128] == b"\x00\x01IM"
    assert scipy.io.matlab.matfile_version(str(path)) == (1, 0)


def test_equal_logs_give_equal_bytes(log, path):
    assert path.read_bytes() == lab_record_bytes(log) == lab_record_bytes(log)


def test_the_record_of_a_log_is_the_record_of_its_file(log, path):
    direct, read = log_to_record(log), load_record(path)
    assert direct.Ts == read.Ts == 0.75
    for name in ("t", "u", "y", "y_measured", "y_noise_reduced"):
        np.testing.assert_array_equal(getattr(direct, name), getattr(read, name))
    np.testing.assert_array_equal(direct.y, log.y_noise_reduced)
    assert direct.name == "a_run"


def test_a_log_cannot_be_changed(log):
    with pytest.raises(ValueError, match="read-only"):
        log.u[0] = 0.0


def test_a_log_needs_equal_lengths():
    with pytest.raises(ValueError, match="must have equal length; got 3 and 2 and 3 and 3"):
        LabLog(np.arange(3), [1, 2], [1, 2, 3], [1, 2, 3], 1.0, "x")


def test_another_ending_is_refused(log, tmp_path):
    with pytest.raises(ValueError, match=r"path must end in \.mat; got 'run\.csv'\. Call it run\.mat\."):
        write_lab_record(tmp_path / "run.csv", log)
    assert not os.listdir(tmp_path)


def test_a_folder_that_is_not_there_is_an_os_error(log, tmp_path):
    with pytest.raises(FileNotFoundError):
        write_lab_record(tmp_path / "nowhere" / "run.mat", log)
