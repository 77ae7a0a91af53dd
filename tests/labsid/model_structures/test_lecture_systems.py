"""The simulated examples: the printed difference equations, sample by sample, and their statistics."""

import numpy as np
import pytest

from labsid.model_structures import lecture_systems
from labsid.model_structures.prediction import prediction_errors

EVERY = [
    lecture_systems.system_1,
    lecture_systems.system_2,
    lecture_systems.example_3_2,
    lecture_systems.example_6_1,
    lecture_systems.example_7_1,
    lecture_systems.example_7_2,
    lecture_systems.example_8_1,
]


def rng(seed=0):
    return np.random.default_rng(seed)


@pytest.mark.parametrize("system", EVERY)
def test_seeded_frozen_and_as_long_as_asked(system):
    one, two, other = system(rng(1), 200), system(rng(1), 200), system(rng(2), 200)
    np.testing.assert_array_equal(one.y, two.y)
    assert not np.array_equal(one.y, other.y)
    assert one.u.size == one.y.size == one.e.size == 200
    with pytest.raises(ValueError, match="read-only"):
        one.y[0] = 1.0
    with pytest.raises(AttributeError):
        one.y = one.u


def test_system_1_is_the_printed_program():
    r = lecture_systems.system_1(rng())
    y = np.zeros(1000)
    for i in range(1, 1000):
        y[i] = 0.8 * y[i - 1] + r.u[i - 1] + r.e[i]
    np.testing.assert_allclose(r.y, y, atol=1e-12)
    np.testing.assert_array_equal(r.model.theta, [-0.8, 1.0])


def test_system_2_is_the_printed_program_and_white_noise_on_the_output():
    r = lecture_systems.system_2(rng())
    y = np.zeros(1000)
    for i in range(1, 1000):
        y[i] = 0.8 * y[i - 1] + r.u[i - 1] - 0.8 * r.e[i - 1] + r.e[i]
    np.testing.assert_allclose(r.y, y, atol=1e-12)
    np.testing.assert_allclose(r.y, r.noise_free + r.e, atol=1e-12)


def test_example_6_1_is_the_printed_equation():
    r = lecture_systems.example_6_1(rng())
    assert r.change == 500
    np.testing.assert_array_equal(r.theta[[0, 499, 500, 999]], [[-0.8, 0, 1]] * 2 + [[-1.1, 0.3, 2]] * 2)
    k = np.arange(2, 1000)
    v = r.y[k] + r.theta[k, 0] * r.y[k - 1] + r.theta[k, 1] * r.y[k - 2] - r.theta[k, 2] * r.u[k - 1]
    np.testing.assert_allclose(v, r.e[k], atol=1e-12)


@pytest.mark.parametrize(
    ("system", "amplitudes"), [(lecture_systems.example_7_1, (2, 1)), (lecture_systems.example_8_1, (0.1, 0.2))]
)
def test_examples_7_1_and_8_1_have_the_printed_inputs(system, amplitudes):
    r = system(rng())
    t = np.arange(1000)
    u = amplitudes[0] * np.sin(np.pi * t / 50 + np.pi / 3) + amplitudes[1] * np.sin(np.pi * t / 30)
    np.testing.assert_allclose(r.u, u, atol=1e-12)
    np.testing.assert_array_equal(r.model.theta, [-0.9, 1.0, 0.3])
    k = np.arange(1, 1000)
    v = r.y[k] - 0.9 * r.y[k - 1] - r.u[k - 1] - 0.3 * r.e[k - 1]
    np.testing.assert_allclose(v, r.e[k], atol=1e-12)


def test_example_7_2_has_no_input_and_the_numbers_asked_for():
    r = lecture_systems.example_7_2(rng(), 500, a=-0.5, c=0.2)
    np.testing.assert_array_equal(r.u, np.zeros(500))
    np.testing.assert_array_equal(r.noise_free, np.zeros(500))
    k = np.arange(1, 500)
    np.testing.assert_allclose(r.y[k] - 0.5 * r.y[k - 1], r.e[k] + 0.2 * r.e[k - 1], atol=1e-12)


def test_example_3_2_is_a_constant_in_unit_noise():
    r = lecture_systems.example_3_2(rng(), 10_000, level=5.0)
    assert r.y.mean() == pytest.approx(5.0, abs=4 / 100)
    np.testing.assert_array_equal(r.y, 5.0 + r.e)


@pytest.mark.parametrize("system", [s for s in EVERY if s is not lecture_systems.example_6_1])
def test_the_prediction_errors_of_the_true_model_are_the_noise(system):
    r = system(rng(3), 300)
    np.testing.assert_allclose(prediction_errors(r.model, r.u, r.y), r.e, atol=1e-9)


def test_the_noise_is_white_and_of_the_stated_size_and_the_input_uniform():
    r = lecture_systems.system_1(rng(4), 20_000)
    assert r.sigma == 1.0
    assert np.std(r.e) == pytest.approx(1.0, abs=4 / np.sqrt(2 * 20_000))
    assert abs(np.mean(r.e[1:] * r.e[:-1])) < 4 / np.sqrt(20_000)
    assert np.abs(r.u).max() <= 2
    assert np.var(r.u) == pytest.approx(4 / 3, rel=0.03)
    assert (r.y[0], r.e[0]) == (0.0, 0.0)


def test_too_few_samples():
    with pytest.raises(ValueError, match="samples must be"):
        lecture_systems.system_1(rng(), 0)
