"""The free runs of exercise 3 and their mean squared errors."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.lab.arx import ArxModel
from labsid.lab.excitation import prbs
from labsid.lab.simulation import simulate
from labsid.lab.verification import mse, verify

MODEL = ArxModel([1, -1.2, 0.3], [0.1, 0.05], 0.75)


def test_mse_by_hand():
    assert mse([1, 2, 3], [1, 4, 0]) == pytest.approx(13 / 3)


def test_the_second_half_starts_at_half_of_n_rounded_down():
    u = prbs(21, register=5)
    v = verify(MODEL, u, simulate(MODEL, u))
    assert v.half == 10
    assert v.y_all.size == 21
    assert v.y_second_half.size == v.y_second_half_carried.size == v.y_second_half_estimated.size == 11


def test_a_true_model_explains_all_but_the_second_half_from_rest():
    u = prbs(200, register=7)
    y = simulate(MODEL, u)
    v = verify(MODEL, u, y)
    assert v.mse_all < 1e-28
    assert v.mse_second_half_carried < 1e-28
    assert v.mse_second_half_estimated < 1e-20
    # From rest, the run starts at zero, where the process was not: the question of exercise 3b.
    assert v.y_second_half[0] == 0
    assert abs(y[v.half]) > 0.1
    assert v.mse_second_half > 1e-3
    np.testing.assert_allclose(v.y_second_half_estimated[0], y[v.half], atol=1e-9)
    # The difference is the free response: it dies away with the poles.
    np.testing.assert_allclose(v.y_second_half[-20:], y[-20:], atol=1e-4)


@given(st.integers(0, 1000), st.integers(8, 60))
@settings(max_examples=60, deadline=None)
def test_each_run_is_what_its_name_says(seed, N):
    u, y = np.random.default_rng(seed).standard_normal((2, N))
    v = verify(MODEL, u, y)
    half = N // 2
    np.testing.assert_array_equal(v.y_all, simulate(MODEL, u))
    np.testing.assert_array_equal(v.y_second_half, simulate(MODEL, u[half:]))
    np.testing.assert_array_equal(v.y_second_half_carried, v.y_all[half:])
    np.testing.assert_array_equal(v.y_second_half_estimated, simulate(MODEL, u[half:], v.x0))
    assert v.mse_all == mse(y, v.y_all)
    assert v.mse_second_half == mse(y[half:], v.y_second_half)
    assert v.mse_second_half_carried == mse(y[half:], v.y_second_half_carried)
    assert v.mse_second_half_estimated == mse(y[half:], v.y_second_half_estimated)
    # The estimated state is the best of all, rest and the carried one included.
    assert v.mse_second_half_estimated <= min(v.mse_second_half, v.mse_second_half_carried) + 1e-12


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mse([1, 2], [1]), "y and y_sim must have equal length; got 2 and 1"),
        (lambda: mse([1, np.nan], [1, 2]), "y must be finite; got nan at sample 1"),
        (lambda: verify(MODEL, [1] * 5, [1] * 4), "u and y must have equal length; got 5 and 4"),
        (lambda: verify(MODEL, [1] * 3, [1] * 3), "u must have at least 4 samples; got 3"),
    ],
)
def test_arguments_that_do_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
