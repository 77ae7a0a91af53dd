"""Bowl, hill, saddle and trough."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsid.least_squares.quadratic_form import (
    BOWL,
    SADDLE,
    definiteness,
    evaluate_quadratic_form,
    random_positive_definite,
    surface,
)


@pytest.mark.parametrize(
    ("M", "kind"),
    [
        (BOWL, "positive definite"),
        (-BOWL, "negative definite"),
        (SADDLE, "indefinite"),
        (np.eye(2), "positive definite"),
        ([[1, 1], [1, 1]], "positive semidefinite"),
        ([[-1, 1], [1, -1]], "negative semidefinite"),
        ([[0, 1], [-1, 0]], "zero"),
        ([[1, 3], [0, 1]], "indefinite"),  # both its eigenvalues are 1, but x'Mx at (1, -1) is -1
    ],
)
def test_kinds(M, kind):
    assert definiteness(M).kind == kind


@given(arrays(np.float64, (4, 3), elements=st.integers(-5, 5).map(float)))
@settings(max_examples=100, deadline=None)
def test_phi_phi_is_definite_exactly_with_full_column_rank(phi):
    kind = definiteness(phi.T @ phi).kind
    rank = np.linalg.matrix_rank(phi)
    assert kind == ("positive definite" if rank == 3 else "positive semidefinite" if rank else "zero")


def test_form_by_hand_at_one_point_and_at_many():
    M = [[1, 2], [0, 3]]  # x1^2 + 2 x1 x2 + 3 x2^2
    assert evaluate_quadratic_form(M, [1, -1]) == 2
    np.testing.assert_allclose(evaluate_quadratic_form(M, [[[1, 0], [0, 1]], [[1, 1], [2, 1]]]), [[1, 3], [6, 11]])


@pytest.mark.parametrize("M", [BOWL, SADDLE, -BOWL])
def test_surface_spans_the_eigenvalues_and_is_zero_in_the_middle(M):
    result = surface(M, radius=2.0, rings=60)
    assert result.f.shape == (61, 121)
    np.testing.assert_array_equal(result.f[0], 0)
    np.testing.assert_allclose(np.hypot(result.x1[-1], result.x2[-1]), 2)
    rim = result.f[-1] / 4
    low, high = result.definiteness.eigenvalues
    assert low - 1e-12 <= rim.min() <= low + 3e-3 * (high - low)
    assert high - 3e-3 * (high - low) <= rim.max() <= high + 1e-12
    assert result.f[7, 11] == pytest.approx(
        np.array([result.x1[7, 11], result.x2[7, 11]]) @ M @ [result.x1[7, 11], result.x2[7, 11]]
    )


@pytest.mark.parametrize("seed", range(20))
def test_random_positive_definite_is(seed):
    M = random_positive_definite(np.random.default_rng(seed), 3)
    np.linalg.cholesky(M)
    assert definiteness(M).kind == "positive definite"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: definiteness([[1, 2]]), r"M must be square; got shape \(1, 2\)"),
        (
            lambda: evaluate_quadratic_form(np.eye(2), [1, 2, 3]),
            r"x must have 2 entries per point, as M has rows; got shape \(3,\)",
        ),
        (lambda: surface(np.eye(3)), r"M must have shape \(2, 2\) for a surface over the plane; got \(3, 3\)"),
        (lambda: surface(BOWL, radius=0), "radius must be positive and rings at least 1; got 0 and 20"),
        (lambda: random_positive_definite(np.random.default_rng(0), 0), "n must be at least 1; got 0"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
