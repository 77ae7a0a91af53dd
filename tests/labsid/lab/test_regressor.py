"""Phi as eq. (6) prints it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.lab.regressor import build_phi

U = np.array([10.0, 11, 12, 13, 14, 15, 16])
Y = np.array([20.0, 21, 22, 23, 24, 25, 26])


def test_rows_by_hand():
    r = build_phi(U, Y, order=2, start=2, stop=6)
    np.testing.assert_array_equal(r.Phi, [[21, 20, 11, 10], [22, 21, 12, 11], [23, 22, 13, 12], [24, 23, 14, 13]])
    np.testing.assert_array_equal(r.Y, [22, 23, 24, 25])
    assert (r.order, r.start, r.stop) == (2, 2, 6)


def test_start_is_the_first_sample_with_every_lag_and_stop_the_end():
    r = build_phi(U, Y, order=2)
    assert (r.start, r.stop) == (2, 7)
    assert r.Phi.shape == (5, 4)


def test_start_1_is_the_printed_first_row_with_rest_before_the_record():
    r = build_phi(U, Y, order=2, start=1)
    np.testing.assert_array_equal(r.Phi[0], [20, 0, 10, 0])
    assert r.Y[0] == 21


def test_start_0_is_at_rest_altogether():
    r = build_phi(U, Y, order=2, start=0)
    np.testing.assert_array_equal(r.Phi[:2], [[0, 0, 0, 0], [20, 0, 10, 0]])
    assert r.Y[0] == 20


def test_first_order_is_eq_9():
    r = build_phi(U, Y, order=1, start=1, stop=4)
    np.testing.assert_array_equal(r.Phi, [[20, 10], [21, 11], [22, 12]])


def test_the_result_is_read_only_and_apart_from_the_arguments():
    y = Y.copy()
    r = build_phi(U, y, order=1)
    y[:] = 0
    assert r.Y[0] == 21
    with pytest.raises(ValueError, match="read-only"):
        r.Phi[0, 0] = 1


@given(
    st.integers(1, 4),
    st.integers(0, 6),
    st.integers(0, 5),
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=25, max_size=40),
)
@settings(max_examples=100, deadline=None)
def test_rows_equal_the_definition_written_out_as_a_loop(order, start, short, pairs):
    u, y = np.array(pairs).T
    stop = u.size - short
    r = build_phi(u, y, order, start, stop)
    for row, k in zip(r.Phi, range(start, stop), strict=True):
        lags = [y[k - i] if k >= i else 0.0 for i in range(1, order + 1)]
        lags += [u[k - i] if k >= i else 0.0 for i in range(1, order + 1)]
        assert row.tolist() == lags
    np.testing.assert_array_equal(r.Y, y[start:stop])


@given(st.integers(1, 3), st.integers(1, 8))
@settings(max_examples=30, deadline=None)
def test_a_shift_in_time_changes_nothing(order, shift):
    rng = np.random.default_rng(shift)
    u, y = rng.standard_normal((2, 40))
    here = build_phi(u, y, order, order, 30)
    pad = np.full(shift, 7.0)
    later = build_phi(np.append(pad, u), np.append(pad, y), order, order + shift, 30 + shift)
    np.testing.assert_array_equal(here.Phi, later.Phi)
    np.testing.assert_array_equal(here.Y, later.Y)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"order": 0}, r"order must be at least 1; got 0\."),
        ({"order": 4}, r"the model has 8 unknowns and needs at least as many rows; got 3 \(samples 4 to 6\)"),
        ({"order": 9}, r"0 <= start < stop <= 7 .*; got start 9 and stop 7\. Give a longer record"),
        ({"start": -1}, r"got start -1 and stop 7"),
        ({"stop": 8}, r"got start 2 and stop 8"),
        ({"start": 5, "stop": 5}, r"got start 5 and stop 5"),
        ({"stop": 5}, r"needs at least as many rows; got 3 \(samples 2 to 4\)"),
    ],
)
def test_settings_that_do_not_fit(settings, message):
    with pytest.raises(ValueError, match=message):
        build_phi(U, Y, **settings)


def test_lengths_must_agree():
    with pytest.raises(ValueError, match="u and y must have equal length; got 6 and 7"):
        build_phi(U[1:], Y)


def test_nan_is_named_with_its_place():
    y = Y.copy()
    y[3] = np.nan
    with pytest.raises(ValueError, match="y must be finite; got nan at sample 3"):
        build_phi(U, y)


def test_each_input_has_a_block_of_lags():
    u, y = np.arange(20.0).reshape(10, 2), np.arange(10.0) ** 2
    Phi = build_phi(u, y, 2).Phi
    first, second = build_phi(u[:, 0], y, 2).Phi, build_phi(u[:, 1], y, 2).Phi
    np.testing.assert_array_equal(Phi, np.column_stack([first, second[:, 2:]]))
    with pytest.raises(ValueError, match=r"u2 must be finite; got nan at sample 3"):
        build_phi(np.where(u == 7, np.nan, u), y, 2)
    with pytest.raises(ValueError, match=r"the model has 6 unknowns and needs at least as many rows; got 5"):
        build_phi(u, y, 2, stop=7)
