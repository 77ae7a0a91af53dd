"""Shift operators, their polynomials, and the z-transform."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import dimpulse, lfilter

from labsid.model_structures.polynomials import (
    add,
    apply,
    evaluate,
    multiply,
    series,
    shift_back,
    shift_error,
    shift_forward,
    superposition_error,
    z_pairs,
    z_transform,
)

coefficients = st.lists(st.integers(-5, 5).map(float), min_size=1, max_size=5)
signals = st.lists(st.integers(-9, 9).map(float), min_size=1, max_size=20)


def test_shifts_by_hand():
    np.testing.assert_array_equal(shift_back([1, 2, 3]), [0, 1, 2])
    np.testing.assert_array_equal(shift_forward([1, 2, 3]), [2, 3])
    np.testing.assert_array_equal(shift_back([1, 2, 3], 3), [0, 0, 0])
    np.testing.assert_array_equal(shift_forward(shift_back([1, 2, 3], 2), 2), [1])


def test_example_7_2_by_hand():
    # (1 + 2 q^-1)(1 + 3 q^-1) = 1 + 5 q^-1 + 6 q^-2.
    np.testing.assert_array_equal(multiply([1, 2], [1, 3]), [1, 5, 6])
    np.testing.assert_array_equal(add([1, 2], [0, 0, 4]), [1, 2, 4])


@given(coefficients, coefficients, signals)
@settings(max_examples=100, deadline=None)
def test_a_product_works_like_its_factors_one_after_the_other_and_a_sum_like_both(P, Q, x):
    np.testing.assert_allclose(apply(multiply(P, Q), x), apply(P, apply(Q, x)), atol=1e-9)
    np.testing.assert_allclose(apply(add(P, Q), x), apply(P, x) + apply(Q, x), atol=1e-9)
    z = 1.3 * np.exp(0.7j)
    assert evaluate(multiply(P, Q), z) == pytest.approx(evaluate(P, z) * evaluate(Q, z), abs=1e-9)
    assert evaluate(add(P, Q), z) == pytest.approx(evaluate(P, z) + evaluate(Q, z), abs=1e-9)


@given(signals, st.integers(0, 5))
@settings(max_examples=100, deadline=None)
def test_the_operator_is_the_polynomial_with_one_coefficient(x, n):
    n = min(n, len(x))
    np.testing.assert_array_equal(apply([0.0] * n + [1.0], x), shift_back(x, n))


def test_series_by_hand_and_as_the_inverse():
    np.testing.assert_allclose(series([1], [1, -0.5], 4), [1, 0.5, 0.25, 0.125])
    A = [2, -1, 0.4]
    np.testing.assert_allclose(multiply(A, series([1], A, 12))[:12], [1] + 11 * [0], atol=1e-15)


def test_series_is_the_impulse_response_of_scipy():
    b, a = [0, 1, 0.5], [1, -1.2, 0.5]
    impulse = np.eye(1, 25)[0]
    np.testing.assert_allclose(series(b, a, 25), lfilter(b, a, impulse), atol=1e-14)
    _, (response,) = dimpulse(([1, 0.5], [1, -1.2, 0.5], 1), n=25)
    np.testing.assert_allclose(series(b, a, 25), response.ravel(), atol=1e-14)


@pytest.mark.parametrize("name", ["impulse", "step", "ramp", "geometric", "sine"])
def test_the_sum_is_the_tabled_transform(name):
    pair = {pair.name: pair for pair in z_pairs(0.5, -0.8, 2.0)}[name]
    x = pair.sequence(np.arange(400.0))
    for z in (1.3, -1.2, 1.1 + 0.6j):
        assert abs(z) > pair.radius
        assert z_transform(x, z) == pytest.approx(pair.transform(z), rel=1e-9)


def test_a_delay_multiplies_the_transform_by_one_over_z():
    x = np.append(np.random.default_rng(0).standard_normal(30), 0)
    z = 0.9 + 0.8j
    assert z_transform(shift_back(x), z) == pytest.approx(z_transform(x, z) / z)


def test_linear_is_more_than_scaling():
    rng = np.random.default_rng(1)
    u1, u2 = rng.standard_normal((2, 50))

    def median(u):  # scales with its input, which is all that the notes ask, but does not add
        return np.array([np.median(u[max(k - 2, 0) : k + 1]) for k in range(u.size)])

    def difference_equation(u):
        return lfilter([0, 1], [1, -0.8], u)

    assert superposition_error(median, u1, u2, 3.0, 0.0) < 1e-12
    assert superposition_error(median, u1, u2, 3.0, -2.0) > 0.1
    assert superposition_error(difference_equation, u1, u2, 3.0, -2.0) < 1e-12


def test_time_invariant_is_commuting_with_shifts():
    u = np.random.default_rng(2).standard_normal(50)
    assert shift_error(lambda u: lfilter([0, 1], [1, -0.8], u), u, 7) < 1e-12
    assert shift_error(lambda u: np.arange(u.size) * u, u, 7) > 1
    assert shift_error(np.square, u, 7) == 0  # not linear, and yet the same on every day


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: shift_back([1, 2], 3), "n must be between 0 and the 2 samples of x; got 3"),
        (lambda: shift_forward([1, 2], -1), "n must be between 0 and the 2 samples of x; got -1"),
        (lambda: series([1], [0, 1], 3), r"A must have a nonzero A\[0\]"),
        (lambda: series([1], [1], 0), "terms must be at least 1; got 0"),
        (lambda: evaluate([1, 2], 0), "z must not be zero"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
