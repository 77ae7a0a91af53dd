"""The matrix appendix against numpy, and against its own rules."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsid.least_squares.linear_algebra import (
    eigenvalues_2x2,
    is_orthogonal,
    is_skew_symmetric,
    is_symmetric,
    partitioned_product,
    pseudo_inverse,
    singular_values,
    singular_values_by_eigenvalues,
    symmetric_and_skew,
)

whole = st.integers(-9, 9).map(float)
matrices = st.tuples(st.integers(1, 5), st.integers(1, 5)).flatmap(
    lambda shape: arrays(np.float64, shape, elements=whole)
)


def test_singular_values_by_hand():
    # A'A = diag(9, 16).
    parts = singular_values([[3, 0], [0, -4], [0, 0]])
    np.testing.assert_allclose(parts.s, [4, 3])
    assert (parts.rank, parts.condition_number) == (2, pytest.approx(4 / 3))


@given(matrices)
@settings(max_examples=100, deadline=None)
def test_decomposition_puts_the_matrix_together_again(A):
    parts = singular_values(A)
    np.testing.assert_allclose(parts.U * parts.s @ parts.V.T, A, atol=1e-12)
    np.testing.assert_allclose(parts.U.T @ parts.U, np.eye(parts.s.size), atol=1e-12)
    np.testing.assert_allclose(parts.V.T @ parts.V, np.eye(parts.s.size), atol=1e-12)
    assert parts.rank == np.linalg.matrix_rank(A)
    if parts.rank == min(A.shape):
        assert parts.condition_number == pytest.approx(np.linalg.cond(A), rel=1e-9)
    np.testing.assert_allclose(singular_values_by_eigenvalues(A)[: parts.s.size], parts.s, atol=2e-6)


def test_the_definition_by_eigenvalues_loses_small_singular_values():
    A = np.array([[1, 1], [1e-10, 0], [0, 1e-10]])
    assert singular_values(A).s[1] == pytest.approx(1e-10, rel=1e-5)
    assert singular_values_by_eigenvalues(A)[1] != pytest.approx(1e-10, rel=0.5)


def test_a_matrix_without_rank_has_no_finite_condition():
    parts = singular_values(np.zeros((2, 2)))
    assert (parts.rank, parts.condition_number) == (0, np.inf)


@given(matrices)
@settings(max_examples=100, deadline=None)
def test_pseudo_inverse_obeys_the_four_conditions_of_penrose(A):
    P = pseudo_inverse(A)
    np.testing.assert_allclose(A @ P @ A, A, atol=1e-10)
    np.testing.assert_allclose(P @ A @ P, P, atol=1e-10)
    np.testing.assert_allclose(A @ P, (A @ P).T, atol=1e-10)
    np.testing.assert_allclose(P @ A, (P @ A).T, atol=1e-10)


def test_pseudo_inverse_formula_as_it_is_right_and_not_as_it_is_printed():
    A = np.random.default_rng(0).standard_normal((6, 3))
    np.testing.assert_allclose(pseudo_inverse(A), np.linalg.inv(A.T @ A) @ A.T, rtol=1e-10)
    np.testing.assert_allclose(pseudo_inverse(A.T), A @ np.linalg.inv(A.T @ A), rtol=1e-10)
    assert np.linalg.matrix_rank(A @ A.T) == 3  # of 6: the printed (A A')^-1 does not exist


@given(arrays(np.float64, (2, 2), elements=whole))
@settings(max_examples=100, deadline=None)
def test_eigenvalues_2x2_have_the_trace_and_determinant(A):
    plus, minus = eigenvalues_2x2(A)
    assert plus + minus == pytest.approx(np.trace(A), abs=1e-12)
    assert plus * minus == pytest.approx(A[0, 0] * A[1, 1] - A[0, 1] * A[1, 0], abs=1e-10)
    for value in (plus, minus):
        assert abs(np.linalg.det(value * np.eye(2) - A)) < 1e-9


def test_eigenvalues_2x2_by_hand_real_and_in_conjugate_pairs():
    np.testing.assert_allclose(eigenvalues_2x2([[2, 1], [1, 2]]), [3, 1])
    np.testing.assert_allclose(eigenvalues_2x2([[0, -1], [1, 0]]), [1j, -1j])
    # The root as printed, ending after 2ad, would be imaginary here: a^2 - 2ad = -7 for eigenvalues 1 and 4.
    np.testing.assert_allclose(eigenvalues_2x2([[1, 0], [0, 4]]), [4, 1])


def test_partitioned_product_is_a_sum_and_not_a_stack():
    rng = np.random.default_rng(1)
    A, B = rng.standard_normal((4, 3)), rng.standard_normal((3, 5))
    np.testing.assert_allclose(partitioned_product(A[:, :-1], A[:, -1], B[:-1], B[-1]), A @ B, rtol=1e-12)


def test_one_more_sample_adds_an_outer_product_to_the_normal_matrix():
    Phi = np.random.default_rng(2).standard_normal((9, 2))
    updated = partitioned_product(Phi[:-1].T, Phi[-1], Phi[:-1], Phi[-1])
    np.testing.assert_allclose(updated, Phi.T @ Phi, rtol=1e-13)


@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0])
def test_rotations_are_orthogonal_and_keep_lengths(angle):
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    assert is_orthogonal(R)
    assert is_orthogonal(R @ [[0, 1], [1, 0]])
    assert np.linalg.norm(R @ [3, 4]) == pytest.approx(5)
    assert not is_orthogonal(2 * R)


@given(arrays(np.float64, (3, 3), elements=whole), arrays(np.float64, (3,), elements=whole))
@settings(max_examples=100, deadline=None)
def test_every_matrix_is_symmetric_plus_skew_and_the_form_sees_the_first(A, x):
    symmetric, skew = symmetric_and_skew(A)
    assert is_symmetric(symmetric)
    assert is_skew_symmetric(skew)
    np.testing.assert_array_equal(symmetric + skew, A)
    assert x @ skew @ x == 0
    assert x @ A @ x == pytest.approx(x @ symmetric @ x)


def test_kinds_are_told_apart():
    assert not is_symmetric([[1, 2], [2.1, 1]])
    assert not is_skew_symmetric([[1, 2], [-2, 0]])


def amplification(A, b, error):
    """Relative error of the least-squares solution, over that of b."""
    x, changed = np.linalg.pinv(A) @ b, np.linalg.pinv(A) @ (b + error)
    return np.linalg.norm(changed - x) / np.linalg.norm(x) / (np.linalg.norm(error) / np.linalg.norm(b))


def test_the_amplification_of_least_squares_may_exceed_the_condition_number():
    A, b = np.array([[1.0], [0.0]]), np.array([0.001, 1.0])
    assert singular_values(A).condition_number == 1
    assert amplification(A, b, np.array([1e-6, 0.0])) == pytest.approx(1000, rel=1e-3)


@pytest.mark.parametrize("seed", range(10))
def test_the_amplification_is_bounded_by_the_condition_number_over_the_cosine(seed):
    rng = np.random.default_rng(seed)
    A, b = rng.standard_normal((6, 3)) * [1, 10, 0.1], rng.standard_normal(6)
    parts = singular_values(A)
    cosine = np.linalg.norm(A @ np.linalg.pinv(A) @ b) / np.linalg.norm(b)
    for error in rng.standard_normal((50, 6)):
        assert amplification(A, b, 1e-3 * error) <= parts.condition_number / cosine
    # Reached where x lies along the largest singular value and the error along the smallest.
    worst = parts.U[:, 0] + 0.5 * np.linalg.svd(A)[0][:, -1]
    reached = amplification(A, worst, 1e-3 * parts.U[:, -1])
    assert reached == pytest.approx(parts.condition_number * np.hypot(1, 0.5), rel=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: singular_values([1, 2]), r"A must be a matrix, written as a list of rows; got shape \(2,\)"),
        (lambda: singular_values([[1], [2, 3]]), "A must be a matrix of real numbers with rows of equal length"),
        (lambda: singular_values([[np.nan]]), "A must be finite; got NaN or infinity in it"),
        (lambda: is_orthogonal([[1, 2]]), r"A must be square; got shape \(1, 2\)"),
        (lambda: eigenvalues_2x2(np.eye(3)), r"A must have shape \(2, 2\); got \(3, 3\)\. For larger matrices"),
        (
            lambda: partitioned_product([[1]], [1, 2], [[1]], [1]),
            r"D \(m, k\), f \(m,\), G \(k, n\), h \(n,\); got \(1, 1\), \(2,\), \(1, 1\), \(1,\)",
        ),
    ],
)
def test_what_does_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
