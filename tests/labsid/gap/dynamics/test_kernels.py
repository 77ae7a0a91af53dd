"""The compiled loops over signals, against scipy's filters, and by hand."""

import numpy as np
import pytest
from scipy.signal import lfilter, lsim

from labsid._arrays import FloatArray
from labsid.gap.dynamics import _kernels
from labsid.gap.effects.input import RateLimit


@pytest.fixture(scope="module")
def w() -> FloatArray:
    """Levels, each held for a few samples."""
    return np.repeat(np.random.default_rng(3).uniform(-1.0, 1.0, 20), 6)


def test_section_columns_are_two_numerator_terms_and_two_initial_states(w: FloatArray) -> None:
    columns = _kernels.section(w, -1.5, 0.6)
    once = lfilter([0.0, 1.0], [1.0, -1.5, 0.6], w)
    free = lfilter([1.0], [1.0, -1.5, 0.6], np.eye(1, w.size)[0])
    later = np.concatenate([[0.0], once[:-1]]), np.concatenate([[0.0], free[:-1]])
    np.testing.assert_allclose(columns, np.column_stack([once, later[0], free, later[1]]), atol=1e-12)


def test_first_order_has_gain_one(w: FloatArray) -> None:
    np.testing.assert_allclose(_kernels.first_order(w, 0.8), lfilter([0.0, 0.2], [1.0, -0.8], w), atol=1e-12)


def test_whiten_is_the_moving_average_filter_of_every_column(w: FloatArray) -> None:
    X = np.column_stack([w, w[::-1]])
    expected = lfilter([1.0, -0.7, 0.2], [1.0], X, axis=0)
    np.testing.assert_allclose(_kernels.whiten(X, np.array([0.7, -0.2])), expected, atol=1e-12)
    np.testing.assert_array_equal(_kernels.whiten(X, np.zeros(0)), X)


def test_backlash_by_hand() -> None:
    w = np.array([0.0, 1.0, 2.0, 1.5, 0.0, -1.0])
    np.testing.assert_allclose(_kernels.backlash(w, 1.0, 0.5), [0.0, 0.5, 1.5, 1.5, 0.5, -0.5])


def test_where_in_the_play_a_record_begins() -> None:
    still = np.zeros(3)
    np.testing.assert_allclose(_kernels.backlash(still, 1.0, 0.0), -0.5)
    np.testing.assert_allclose(_kernels.backlash(still, 1.0, 1.0), 0.5)


def test_backlash_never_leaves_the_play_and_moves_only_when_it_is_taken_up(w: FloatArray) -> None:
    out = _kernels.backlash(w, 0.6, 0.5)
    assert np.abs(w - out).max() <= 0.3 + 1e-12
    moved = np.flatnonzero(np.diff(out) != 0.0) + 1
    assert 0 < moved.size < w.size
    np.testing.assert_allclose(np.abs(w - out)[moved], 0.3)


def test_rate_limit_by_hand() -> None:
    w = np.array([0.0, 1.0, 1.0, 1.0, 1.0, -1.0])
    # 0.8 to 1 within the first half of sample 3, then at rest: its mean is 0.95, its first moment 1/60.
    means, late = np.array([0.0, 0.2, 0.6, 0.95, 1.0, 0.8]), np.array([0.0, 1 / 30, 1 / 30, 1 / 60, 0.0, -1 / 30])
    np.testing.assert_allclose(_kernels.rate_limit(w, 0.4, 0.4, 0.0), (means, late), atol=1e-15)
    uneven = _kernels.rate_limit(w, 0.4, 1.0, 0.0)
    np.testing.assert_allclose(uneven, ([*means[:5], 0.5], [*late[:5], -1 / 12]), atol=1e-15)


@pytest.mark.parametrize("rate", [0.05, 0.13, 0.6])
def test_timed_values_act_on_dynamics_as_the_slewing_actuator_does(w: FloatArray, rate: float) -> None:
    """On a highpass mass, sampled: far nearer than the means over each sample alone."""
    fine, now, path = 400, w[0], []
    for value in w:
        for _ in range(fine):
            path.append(now)
            now += float(np.clip(value - now, -rate / fine, rate / fine))
    samples = np.reshape(path, (-1, fine))
    means, moments = samples.mean(axis=1), samples @ (np.arange(0.5, fine) / fine - 0.5) / fine
    found = _kernels.rate_limit(w, rate, rate, float(w[0]))
    np.testing.assert_allclose(found, (means, moments), atol=2e-3 * rate)
    A, B = np.array([[0.0, 1.0], [-0.3, -0.25]]), np.array([[0.0], [0.3]])
    _, exact, _ = lsim((A, B, np.eye(2)[:1], [[0.0]]), path, np.arange(len(path)) / fine, X0=[w[0], 0.0], interp=False)

    def error(held: FloatArray) -> float:
        _, found, _ = lsim((A, B, np.eye(2)[:1], [[0.0]]), held, np.arange(w.size), X0=[w[0], 0.0], interp=False)
        return float(np.sqrt(np.mean((found - exact[::fine]) ** 2)))

    timed = RateLimit("timed").apply(w, np.array([np.log(rate)]), w.size)
    assert error(timed) < 0.35 * error(means)


def test_delayed_by_hand() -> None:
    """Before the record the input stood where it begins; a part of a sample is interpolated."""
    w = np.array([1.0, 2.0, 4.0, 8.0])
    np.testing.assert_allclose(_kernels.delayed(w, 0, 0.0), w)
    np.testing.assert_allclose(_kernels.delayed(w, 1, 0.0), [1.0, 1.0, 2.0, 4.0])
    np.testing.assert_allclose(_kernels.delayed(w, 1, 0.25), [1.0, 1.0, 1.75, 3.5])
    np.testing.assert_allclose(_kernels.delayed(w, 9, 0.5), 1.0)


def test_a_negative_delay_holds_the_last_sample() -> None:
    w = np.array([1.0, 2.0, 4.0, 8.0])
    np.testing.assert_allclose(_kernels.delayed(w, -1, 0.0), [2.0, 4.0, 8.0, 8.0])
    np.testing.assert_allclose(_kernels.delayed(w, -1, 0.75), [1.25, 2.5, 5.0, 8.0])


def test_delayed_from_another_level_before_the_record() -> None:
    w = np.array([1.0, 2.0, 4.0, 8.0])
    np.testing.assert_allclose(_kernels.delayed(w, 2, 0.0, -3.0), [-2.0, -2.0, 1.0, 2.0])
    np.testing.assert_allclose(_kernels.delayed(w, 1, 0.25, -3.0), [-2.0, 0.25, 1.75, 3.5])
    np.testing.assert_allclose(_kernels.delayed(w, 0, 0.25, -3.0), [0.25, 1.75, 3.5, 7.0])
