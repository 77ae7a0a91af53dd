"""Roots and their errors: those of many draws of the coefficients, and unknown where nothing is known."""

import numpy as np
import pytest

from labsid.model_structures.roots import roots_with_errors


@pytest.mark.parametrize("poles", [(0.9, 0.5), (0.8 + 0.3j, 0.8 - 0.3j), (0.95, 0.6 + 0.2j, 0.6 - 0.2j)])
def test_the_covariance_is_that_of_the_roots_of_drawn_coefficients(poles):
    p = np.poly(poles).real
    half = np.random.default_rng(0).standard_normal((p.size, p.size)) * 1e-4
    spread = half @ half.T
    spread[0] = spread[:, 0] = 0.0
    found = roots_with_errors(p, spread)
    assert sorted((root.value.real, root.value.imag) for root in found) == pytest.approx(
        np.array(sorted((x.real, x.imag) for x in map(complex, poles))), abs=1e-9
    )
    draws = np.random.default_rng(1).multivariate_normal(p, spread, 4000)
    for root in found:
        near = [min(np.roots(one), key=lambda r: abs(r - root.value)) for one in draws]
        measured = np.cov(np.real(near), np.imag(near))
        np.testing.assert_allclose(measured, root.covariance, rtol=0.12, atol=2e-10)


def test_a_region_holds_95_percent_of_the_draws_and_an_unknown_one_is_none():
    (root, _) = roots_with_errors([1.0, -1.6, 0.73], np.diag([0.0, 4e-6, 4e-6]))
    ellipse = root.ellipse()
    reach = np.hypot(*(ellipse - [[root.value.real], [root.value.imag]]))
    assert reach.max() ** 2 == pytest.approx(5.991 * np.linalg.eigvalsh(root.covariance)[-1], rel=1e-3)
    real = roots_with_errors([1.0, -0.5], np.diag([0.0, 1e-4]))[0]
    assert np.ptp(real.ellipse()[0]) == pytest.approx(2 * 1.96 * 0.01, rel=1e-3)
    assert np.ptp(real.ellipse()[1]) == 0.0
    assert roots_with_errors([1.0, -0.5])[0].ellipse() is None
    assert all(one.ellipse() is None for one in roots_with_errors([1.0, -1.0, 0.25], np.eye(3)))  # a double root


def test_leading_zeros_are_a_delay_and_no_root_lies_at_infinity():
    assert [root.value for root in roots_with_errors([0.0, 2.0, -1.0], np.eye(3))] == [0.5]
    assert roots_with_errors([3.0]) == ()
    assert roots_with_errors([0.0, 0.0]) == ()
