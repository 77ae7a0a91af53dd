"""The fast path must find what the sound one finds, and give way where it cannot."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from labsid.lab.arx import fit_arx
from labsid.lab.long_arx import fit_long_arx
from labsid.lab.offset import find_offsets, remove_offsets
from labsid.records.record import load_record


def driven(samples, seed=0, noise=0.3):
    rng = np.random.default_rng(seed)
    u, e = rng.standard_normal((2, samples))
    return u, lfilter([0, 1, 0.5], [1, -1.5, 0.7], u) + noise * lfilter([1], [1, -1.5, 0.7], e)


def agrees(u, y, order, rtol=1e-9):
    fast, slow = fit_long_arx(u, y, 0.5, order), fit_arx(u, y, 0.5, order)
    np.testing.assert_allclose(fast.model.theta, slow.model.theta, rtol=rtol, atol=rtol)
    np.testing.assert_allclose(fast.covariance, slow.fit.covariance, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(fast.stderr, slow.fit.stderr, rtol=1e-6)
    np.testing.assert_allclose(
        [fast.loss, fast.sigma2, fast.condition_number],
        [slow.fit.loss, slow.fit.sigma2, slow.fit.condition_number],
        rtol=1e-7,
    )
    assert (fast.rows, fast.status, fast.model.Ts) == (slow.regression.Y.size, slow.fit.status, 0.5)
    return fast


def test_phi_prime_phi_by_hand():
    """u = 1, 0, 2, 1; y = 0, 1, 3, 3: order 1 has the rows [0, 1], [1, 0], [3, 2] and Y = 1, 3, 3.

    Phi'Phi = [[10, 6], [6, 5]], Phi'Y = [12, 7], so theta = [[5, -6], [-6, 10]] [12, 7] / 14 = [9, -1] / 7.
    """
    fit = fit_long_arx([1, 0, 2, 1], [0, 1, 3, 3], Ts=1.0, order=1)
    assert fit.solved_by == "gram"
    np.testing.assert_allclose(fit.model.theta, [9 / 7, -1 / 7], rtol=1e-13)
    assert fit.rows == 3
    assert 2 * fit.loss == pytest.approx(19 - (9 * 12 - 7) / 7)


@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("samples", [20, 1023, 1024, 1025, 5000])
def test_it_finds_what_the_sound_path_finds(samples, order):
    u, y = driven(samples)
    assert agrees(u, y, order).solved_by == "gram"


def test_a_million_samples():
    u, y = driven(10**6)
    fast = agrees(u, y, 2, rtol=1e-11)
    assert fast.solved_by == "gram"
    np.testing.assert_allclose(fast.model.theta, [1.5, -0.7, 1, 0.5], atol=5 * fast.stderr.max())


@given(st.integers(1, 4), st.integers(30, 200), st.integers(0, 10**6), st.floats(1e-3, 1e3))
@settings(max_examples=60, deadline=None)
def test_any_record_and_the_units_of_u(order, samples, seed, factor):
    u, y = driven(samples, seed)
    plain, scaled = agrees(u, y, order, 1e-8), fit_long_arx(factor * u, y, 0.5, order)
    np.testing.assert_allclose(scaled.model.b * factor, plain.model.b, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(scaled.model.a, plain.model.a, rtol=1e-6, atol=1e-8)


def test_the_lab_record(shared_data):
    record = load_record(shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat")
    u, y = remove_offsets(record.u, record.y, find_offsets(record.u, record.y))
    fit = fit_long_arx(u[:451], y[:451], record.Ts)
    np.testing.assert_array_equal(np.round(fit.model.theta, 8), [1.37746171, -0.39246554, -0.00666983, 0.05140205])
    assert fit.condition_number == pytest.approx(269.75, abs=0.005)


@pytest.mark.parametrize(
    ("u", "y", "status"),
    [
        (np.zeros(100), np.ones(100), "rank-deficient"),  # nothing to learn b from
        (*driven(1000, noise=0.0), "unique"),  # without noise E'E drowns in the rounding of Y'Y
        (driven(1000)[0], 1e7 + driven(1000)[1], "unique"),  # an offset left in: condition number above 1e5
    ],
)
def test_where_the_sums_are_not_good_enough_phi_is_built(u, y, status):
    fast, slow = fit_long_arx(u, y, 1.0), fit_arx(u, y, 1.0)
    assert fast.solved_by == "svd"
    assert fast.status == slow.fit.status == status
    np.testing.assert_array_equal(fast.model.theta, slow.model.theta)


def test_the_inputs_may_be_read_only_and_are_left_alone():
    u, y = driven(100)
    before = u.copy()
    u.setflags(write=False)
    fit_long_arx(u, y, 1.0)
    np.testing.assert_array_equal(u, before)
    assert y.flags.writeable


@pytest.mark.parametrize(
    ("u", "y", "order", "message"),
    [
        (np.ones(10), np.ones(9), 2, "equal length; got 10 and 9"),
        (np.ones(5), np.ones(5), 2, "the model has 4 unknowns"),
        (np.ones(10), np.ones(10), 0, "order must be at least 1"),
        (np.append(np.ones(99), np.nan), np.ones(100), 2, "u must be finite; got nan at sample 99"),
        (np.ones(100), np.where(np.arange(100) == 50, np.inf, 1), 2, "y must be finite; got inf at sample 50"),
        (np.ones((10, 2)), np.ones(10), 2, "one signal"),
    ],
)
def test_bad_input_is_refused_as_by_fit_arx(u, y, order, message):
    with pytest.raises(ValueError, match=message):
        fit_long_arx(u, y, 1.0, order)
