"""Noise, converter and moving average: hand-worked, statistical, and the rig's own logs."""

import numpy as np
import pytest
import scipy.io
from scipy import stats

from labsid.rig.lab.instruments import converter, noise_reduced, sensor_noise


def seed(number=1):
    return np.random.SeedSequence(number)


def test_noise_is_white_gaussian_with_the_deviation_asked_for():
    noise = sensor_noise(0.013, seed())(np.zeros(20000), np.zeros(20000))
    assert noise.std() == pytest.approx(0.013, rel=0.02)
    assert abs(noise.mean()) < 4 * 0.013 / np.sqrt(20000)
    assert stats.kstest(noise / 0.013, "norm").pvalue > 0.01
    assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 0.03


def test_noise_is_the_same_at_every_run_and_another_with_another_seed():
    block = sensor_noise(0.1, seed(1))
    volts = np.ones(5)
    np.testing.assert_array_equal(block(volts, volts), block(volts, volts))
    assert (block(volts, volts) != sensor_noise(0.1, seed(2))(volts, volts)).all()


def test_the_converter_rounds_to_the_nearest_code():
    # Two bits over -1..1 V: codes at -1, -0.5, 0 and 0.5 V.
    volts = np.array([-0.8, -0.7, -0.2, 0.2, 0.3])
    assert converter(2, -1.0, 1.0)(volts, volts).tolist() == [-1.0, -0.5, 0.0, 0.0, 0.5]


def test_the_converter_stops_at_its_range():
    volts = np.array([-5.0, 0.74, 0.9, 5.0])
    assert converter(2, -1.0, 1.0)(volts, volts).tolist() == [-1.0, 0.5, 0.5, 0.5]


def test_the_converter_of_the_lab_has_the_step_of_its_logs():
    volts = np.linspace(-0.2, 3.5, 5000)
    codes = converter(12, -10.0, 10.0)(volts, volts) / 0.0048828125
    assert (codes == np.round(codes)).all()
    assert np.abs(codes * 0.0048828125 - volts).max() <= 0.0048828125 / 2


def test_a_converter_needs_a_range():
    with pytest.raises(ValueError, match="high must be above low; got low = 1 and high = 1"):
        converter(12, 1.0, 1.0)


def test_the_mean_is_of_this_sample_and_the_four_before_it():
    reduced = noise_reduced([5.0, 10.0, 0.0], before=[1.0, 2.0, 3.0, 4.0])
    assert reduced.tolist() == [15 / 5, 24 / 5, 22 / 5]


def test_the_mean_needs_four_samples_before():
    with pytest.raises(ValueError, match="before must hold 4 samples; got 3"):
        noise_reduced([1.0, 2.0], before=[0.0, 0.0, 0.0])


@pytest.mark.parametrize("name", ["SysIdenData_StudentVersion", "SysIdenData_4", "SysIdenData_8"])
def test_the_logs_of_the_real_rig_hold_exactly_this_mean(shared_data, name):
    log = scipy.io.loadmat(shared_data / "unsw-water-tank" / f"{name}.mat", simplify_cells=True)["LogData"]
    measured, reduced = log["signals"][0]["values"].T
    np.testing.assert_array_equal(noise_reduced(measured[4:], measured[:4]), reduced[4:])


@pytest.mark.parametrize("name", ["SysIdenData_4", "SysIdenData_8"])
def test_a_real_rig_switched_on_with_the_log_begins_its_mean_with_zeros(shared_data, name):
    log = scipy.io.loadmat(shared_data / "unsw-water-tank" / f"{name}.mat", simplify_cells=True)["LogData"]
    measured, reduced = log["signals"][0]["values"].T
    np.testing.assert_allclose(noise_reduced(measured, np.zeros(4)), reduced, rtol=0, atol=1e-15)
