"""The pre-lab refresher, step by step."""

import numpy as np
import pytest

from labsid.lab.sinusoid import NOISE_BOUND, cut_off, make_sinusoids


@pytest.fixture
def sinusoids():
    return make_sinusoids(np.random.default_rng(5))


def test_time_is_a_column_from_0_to_100_s_in_steps_of_a_tenth(sinusoids):
    assert sinusoids.t.shape == (1001, 1)
    assert sinusoids.t[0, 0] == 0
    assert sinusoids.t[-1, 0] == 100
    np.testing.assert_allclose(np.diff(sinusoids.t[:, 0]), 0.1, rtol=1e-10)


def test_the_sinusoids_have_a_period_of_100_s_and_uniform_noise_within_the_bound(sinusoids):
    for y, clean in (
        (sinusoids.y1, np.sin(0.02 * np.pi * sinusoids.t)),
        (sinusoids.y2, np.cos(0.02 * np.pi * sinusoids.t)),
    ):
        noise = y - clean
        assert y.shape == (1001, 1)
        assert np.max(np.abs(noise)) <= NOISE_BOUND == 0.2
        # Uniform over the whole of +-0.2, not 0..0.2 and not +-0.1: its standard deviation is 0.4 / sqrt(12).
        assert np.std(noise) == pytest.approx(0.4 / np.sqrt(12), rel=0.06)
        assert abs(np.mean(noise)) < 0.015
    assert np.std(sinusoids.y1**2 + sinusoids.y2**2) > 0.1  # the two noises are not one and the same


def test_the_same_seed_makes_the_same_data_and_another_does_not(sinusoids):
    again = make_sinusoids(np.random.default_rng(5))
    np.testing.assert_array_equal(again.y1, sinusoids.y1)
    assert not np.array_equal(make_sinusoids(np.random.default_rng(6)).y1, sinusoids.y1)


def test_cut_off_drops_200_samples_and_time_starts_from_zero(sinusoids):
    new = cut_off(sinusoids)
    assert new.t_new.shape == new.y1_new.shape == new.y2_new.shape == (801, 1)
    assert new.t_new[0, 0] == 0
    assert new.t_new[-1, 0] == pytest.approx(80)
    np.testing.assert_array_equal(new.y1_new, sinusoids.y1[200:])
    np.testing.assert_array_equal(new.y2_new, sinusoids.y2[200:])


def test_data_new_holds_the_three_columns_side_by_side(sinusoids):
    new = cut_off(sinusoids)
    assert new.data_new.shape == (801, 3)
    np.testing.assert_array_equal(new.data_new, np.column_stack([new.t_new, new.y1_new, new.y2_new]))


def test_the_results_cannot_be_written_to(sinusoids):
    with pytest.raises(ValueError, match="read-only"):
        sinusoids.y1[0] = 0
    with pytest.raises(ValueError, match="read-only"):
        cut_off(sinusoids).data_new[0] = 0


@pytest.mark.parametrize("n", [-1, 1001])
def test_cut_off_must_leave_something(sinusoids, n):
    with pytest.raises(ValueError, match=rf"n must lie between 0 and 1000, to leave a sample; got {n}\."):
        cut_off(sinusoids, n)
