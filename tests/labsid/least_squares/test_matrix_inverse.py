"""Inverses by hand against numpy's; the inversion lemma under its right conditions."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsid.least_squares.matrix_inverse import (
    adjoint,
    characteristic_polynomial,
    closed_loop_gain,
    cofactors,
    inverse_by_adjoint,
    inverse_by_cayley_hamilton,
    inverse_by_eigenvectors,
    inversion_lemma,
)

square = st.integers(1, 5).flatmap(lambda n: arrays(np.float64, (n, n), elements=st.integers(-9, 9).map(float)))


def test_2x2_by_hand():
    A = [[1, 2], [3, 5]]  # determinant -1
    np.testing.assert_allclose(adjoint(A), [[5, -2], [-3, 1]])
    np.testing.assert_allclose(inverse_by_adjoint(A), [[-5, 2], [3, -1]])
    np.testing.assert_allclose(characteristic_polynomial(A), [1, -6, -1])
    np.testing.assert_allclose(inverse_by_cayley_hamilton(A), [[-5, 2], [3, -1]])


def test_cofactors_of_3x3_by_hand_and_of_a_number():
    np.testing.assert_allclose(cofactors([[1, 2, 3], [0, 4, 5], [1, 0, 6]]), [[24, 5, -4], [-12, 3, 2], [-2, -5, 4]])
    np.testing.assert_allclose(cofactors([[7]]), [[1]])
    np.testing.assert_allclose(inverse_by_adjoint([[4]]), [[0.25]])


@given(square)
@settings(max_examples=100, deadline=None)
def test_inverses_are_numpys_and_the_adjoint_gives_the_determinant(A):
    n = A.shape[0]
    determinant = np.linalg.det(A)
    scale = 1 + np.max(np.abs(A)) ** n
    np.testing.assert_allclose(adjoint(A) @ A, determinant * np.eye(n), atol=1e-10 * scale)
    np.testing.assert_allclose(A @ adjoint(A), determinant * np.eye(n), atol=1e-10 * scale)
    assume(np.linalg.cond(A) < 1e4)
    for inverse in (inverse_by_adjoint, inverse_by_cayley_hamilton):
        np.testing.assert_allclose(inverse(A), np.linalg.inv(A), rtol=1e-6, atol=1e-8)


@given(square)
@settings(max_examples=100, deadline=None)
def test_every_matrix_satisfies_its_characteristic_equation(A):
    coefficients = characteristic_polynomial(A)
    np.testing.assert_allclose(coefficients, np.poly(A), atol=1e-6 * (1 + np.max(np.abs(coefficients))))
    value = np.zeros_like(A)
    for c in coefficients:
        value = value @ A + c * np.eye(A.shape[0])
    np.testing.assert_allclose(value, 0, atol=1e-9 * (1 + np.max(np.abs(A)) * A.shape[0]) ** A.shape[0])


def test_symmetric_inverse_as_it_is_right_and_not_as_it_is_printed():
    A = np.array([[4.0, 1, 0], [1, 3, 1], [0, 1, 2]])
    np.testing.assert_allclose(inverse_by_eigenvectors(A), np.linalg.inv(A), rtol=1e-12, atol=1e-14)
    d, V = np.linalg.eigh(A)
    assert np.max(np.abs(V.T / d @ V - np.linalg.inv(A))) > 0.1


@pytest.mark.parametrize("seed", range(20))
def test_inversion_lemma_is_the_inverse_of_the_sum(seed):
    rng = np.random.default_rng(seed)
    n, k = rng.integers(1, 6, 2)
    A, C = rng.standard_normal((n, n)) + 3 * np.eye(n), rng.standard_normal((k, k)) + 3 * np.eye(k)
    B, D = rng.standard_normal((n, k)), rng.standard_normal((k, n))
    np.testing.assert_allclose(inversion_lemma(A, B, C, D) @ (A + B @ C @ D), np.eye(n), atol=1e-8)


def test_inversion_lemma_gives_the_p_of_example_5_2_though_bcd_is_singular():
    phi = np.array([[0.6], [0.4]])
    P = inversion_lemma(np.eye(2) / 1000, phi, [[1]], phi.T)
    assert np.linalg.matrix_rank(phi @ phi.T) == 1
    np.testing.assert_allclose(P, [[309.0211, -460.6526], [-460.6526, 692.8983]], atol=5e-5)


@given(square)
@settings(max_examples=100, deadline=None)
def test_interesting_identity(A):
    n = A.shape[0]
    assume(np.linalg.cond(np.eye(n) + A) < 1e4)
    np.testing.assert_allclose(closed_loop_gain(A), A @ np.linalg.inv(np.eye(n) + A), rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: inverse_by_adjoint([[1, 2], [2, 4]]), r"A must be nonsingular; got rank 1 of 2\. A singular matrix"),
        (lambda: inverse_by_cayley_hamilton(np.zeros((3, 3))), "A must be nonsingular; got rank 0 of 3"),
        (lambda: inverse_by_eigenvectors([[1, 2], [3, 4]]), "A must be symmetric; got entries of A - A. up to 1"),
        (lambda: closed_loop_gain([[-1.0]]), r"I \+ A must be nonsingular; got rank 0 of 1"),
        (lambda: inversion_lemma([[0.0]], [[1]], [[1]], [[1]]), "A must be nonsingular"),
        (lambda: inversion_lemma([[1.0]], [[1]], [[0]], [[1]]), "C must be nonsingular"),
        (lambda: inversion_lemma([[1.0]], [[1]], [[-1]], [[1]]), r"A \+ B C D must be nonsingular"),
        (
            lambda: inversion_lemma(np.eye(2), [[1]], [[1]], [[1]]),
            r"B and D must have shapes \(2, 1\) and \(1, 2\) to go with A and C; got \(1, 1\) and \(1, 1\)",
        ),
        (lambda: adjoint([[1, 2]]), r"A must be square; got shape \(1, 2\)"),
    ],
)
def test_what_has_no_inverse(call, message):
    with pytest.raises(ValueError, match=message):
        call()
