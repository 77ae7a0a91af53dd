"""Sampled poles, slow courses and steps, by hand and against scipy."""

import numpy as np
import pytest
from scipy.signal import cont2discrete

from labsid.gap.dynamics.responses import (
    chebyshev_course,
    denominator,
    normalized_time,
    real_rates,
    section,
    step_signal,
)


@pytest.mark.parametrize(("c", "k"), [(0.5, 0.05), (0.2, 0.3), (0.4, 0.04), (3.0, 1.0)])
def test_denominator_is_that_of_the_sampled_plant(c: float, k: float) -> None:
    _, den, _ = cont2discrete(([k], [1.0, c, k]), 1.0)
    np.testing.assert_allclose([1.0, *denominator(c, k)], den, rtol=1e-7)


def test_real_rates_are_the_roots_slow_one_first() -> None:
    np.testing.assert_allclose(real_rates(0.5, 0.06), [0.2, 0.3])
    np.testing.assert_allclose(real_rates(100.0, 1.0), [1.0 / (50.0 + np.sqrt(2499.0)), 8.0])


def test_a_complex_pair_counts_as_a_nearly_double_pole() -> None:
    slow, fast = real_rates(0.1, 0.25)
    assert slow < 0.5 < fast
    assert slow * fast == pytest.approx(0.25)


def test_along_goes_from_minus_one_to_one_and_stays() -> None:
    np.testing.assert_allclose(normalized_time(7, 5), [-1.0, -0.5, 0.0, 0.5, 1.0, 1.0, 1.0])


def test_begun_counts_the_sample_of_the_onset_in_part() -> None:
    np.testing.assert_allclose(step_signal(0.225, 5, 10), [0.0, 0.0, 0.75, 1.0, 1.0])
    np.testing.assert_allclose(step_signal(0.0, 3, 10), 1.0)
    np.testing.assert_allclose(step_signal(1.0, 10, 10), 0.0)


def test_slow_course_is_a_chebyshev_series_without_its_constant() -> None:
    x = np.linspace(-1.0, 1.0, 11)
    np.testing.assert_allclose(chebyshev_course(np.array([0.3, -0.2]), 11, 11), 0.3 * x - 0.2 * (2.0 * x**2 - 1.0))


def test_section_spans_every_response_of_its_poles(levels: np.ndarray) -> None:
    """Two poles, any zero, any initial state: simulated by its difference equation."""
    a1, a2 = denominator(0.5, 0.05)
    y = np.zeros(levels.size)
    y[0], y[1] = 0.7, 0.4
    for k in range(2, y.size):
        y[k] = -a1 * y[k - 1] - a2 * y[k - 2] + 0.3 * levels[k - 1] - 0.2 * levels[k - 2]
    columns = section(0.5, 0.05, levels)
    left = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
    assert np.abs(left).max() < 1e-10
