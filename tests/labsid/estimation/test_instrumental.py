"""Instrumental variables: consistent where least squares is not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.estimation.instrumental import fit_instrumental, instrumental_variables
from labsid.estimation.monte_carlo import run_monte_carlo
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.lecture_systems import example_7_1, example_8_1, system_2
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import Structure, build_equations, fit_structure

ARX = Structure(1, 1)


def test_two_unknowns_by_hand():
    """Z'Phi = [[1, 2], [2, 1]], Z'Y = [8, 7], so theta = [2, 3]."""
    found = instrumental_variables([[1, 0], [0, 1], [0, 0]], [[1, 2], [2, 1], [5, 5]], [8, 7, 99])
    np.testing.assert_allclose(found.theta, [2, 3], rtol=1e-13)
    np.testing.assert_allclose(found.residual, [0, 0, 74], atol=1e-12)
    assert found.status == "unique"


@given(st.integers(1, 4), st.integers(0, 10**6))
@settings(max_examples=50, deadline=None)
def test_the_residual_is_orthogonal_to_the_instruments(p, seed):
    rng = np.random.default_rng(seed)
    Phi = rng.standard_normal((40, p))
    Z, Y = Phi + rng.standard_normal((40, p)), rng.standard_normal(40)
    found = instrumental_variables(Z, Phi, Y)
    if found.condition_number < 1e4:
        assert np.max(np.abs(Z.T @ found.residual)) < 1e-8
    np.testing.assert_allclose(instrumental_variables(Phi, Phi, Y).theta, solve_least_squares(Phi, Y).theta, atol=1e-9)
    scaled = instrumental_variables(Z * np.arange(1.0, p + 1), Phi, Y)
    np.testing.assert_allclose(scaled.theta, found.theta, rtol=1e-6, atol=1e-8)


def test_it_agrees_with_statsmodels():
    gmm = pytest.importorskip("statsmodels.sandbox.regression.gmm", reason="statsmodels is not installed")
    r = system_2(np.random.default_rng(0))
    equations = build_equations(ARX, r.u, r.y)
    Z = build_equations(ARX, r.u, r.noise_free).Phi
    oracle = gmm.IV2SLS(equations.Y, equations.Phi, Z).fit()
    found = instrumental_variables(Z, equations.Phi, equations.Y)
    np.testing.assert_allclose(found.theta, oracle.params, rtol=1e-10)


def test_iv_is_consistent_on_system_2_where_least_squares_is_not():
    """Twice the record, 1 / sqrt(2) of the spread and no bias; the bias of least squares stays at 0.17."""

    def iv(samples):
        def estimate(rng):
            r = system_2(rng, samples)
            return fit_instrumental(ARX, r.u, r.y).model.theta

        return estimate

    def ls(rng):
        r = system_2(rng, 2000)
        return fit_structure(ARX, r.u, r.y).model.theta

    short, long = (run_monte_carlo(iv(samples), [-0.8, 1.0], 100, seed=5) for samples in (500, 2000))
    assert np.all(np.abs(long.bias) < 4 * long.bias_stderr)
    assert np.all(long.spread < 0.65 * short.spread)
    biased = run_monte_carlo(ls, [-0.8, 1.0], 100, seed=5)
    assert biased.bias[0] == pytest.approx(0.17, abs=0.01)  # -0.63 = -0.8 * 3.704 / 4.704, with var(x) = 4/3 / 0.36


def test_example_7_1_bias_of_least_squares_and_iv():
    def estimate(rng):
        r = example_7_1(rng, 4000)
        return np.concatenate([fit_structure(ARX, r.u, r.y).model.theta, fit_instrumental(ARX, r.u, r.y).model.theta])

    result = run_monte_carlo(estimate, [-0.9, 1.0, -0.9, 1.0], 60, seed=6)
    t = np.abs(result.bias) / result.bias_stderr
    assert np.all(t[:2] > 5)
    assert np.all(t[2:] < 4)


def test_example_8_1_the_median_is_right_and_a_single_record_is_not():
    ends = []
    for seed in range(60):
        r = example_8_1(np.random.default_rng(seed))
        found = fit_instrumental(ARX, r.u, r.y)
        if found.status == "converged":
            ends.append(found.model.theta)
    assert len(ends) > 50
    assert np.median(ends, axis=0) == pytest.approx([-0.9, 1.0], abs=0.1)
    assert np.std(ends, axis=0)[1] > 0.2


def test_the_fixed_point_is_its_own_instrument():
    r = system_2(np.random.default_rng(1))
    found = fit_instrumental(ARX, r.u, r.y, Ts=0.1)
    assert (found.status, found.model.Ts) == ("converged", 0.1)
    equations = build_equations(ARX, r.u, r.y)
    Z = build_equations(ARX, r.u, free_run(found.model, r.u)).Phi
    np.testing.assert_allclose(
        instrumental_variables(Z, equations.Phi, equations.Y).theta, found.model.theta, atol=1e-7
    )
    np.testing.assert_array_equal(found.path[-1], found.model.theta)
    np.testing.assert_array_equal(found.path[0], fit_structure(ARX, r.u, r.y).model.theta)


def test_what_does_not_work_out_is_a_status():
    r = system_2(np.random.default_rng(1))
    assert fit_instrumental(ARX, r.u, r.y, iterations=1).status == "not converged"
    singular = instrumental_variables([[1, 0], [0, 0], [0, 0]], np.ones((3, 2)), [1, 2, 3])
    assert singular.status == "singular"
    assert singular.condition_number == np.inf
    assert np.all(np.isnan(singular.theta))
    # Without input the model's output is silent: no instrument.
    quiet = fit_instrumental(ARX, np.zeros(200), r.y[:200])
    assert quiet.status == "singular"
    assert np.all(np.isfinite(quiet.model.theta))
    growing = fit_instrumental(ARX, r.u[:200], 1.01 ** np.arange(200))
    assert growing.status == "unstable"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: instrumental_variables(np.ones((3, 2)), np.ones((3, 1)), np.ones(3)), "equal shapes"),
        (lambda: instrumental_variables(np.ones((3, 1)), np.ones((3, 1)), np.ones(4)), "one row an entry of Y"),
        (lambda: instrumental_variables([[np.nan]], [[1.0]], [1.0]), "must be finite"),
        (lambda: fit_instrumental(Structure(1, 1, 1), np.ones(9), np.ones(9)), "structure must be ARX"),
        (lambda: fit_instrumental(Structure(0, 2), np.ones(9), np.ones(9)), "structure must be ARX"),
        (lambda: fit_instrumental(ARX, np.ones(9), np.ones(9), iterations=0), "iterations at least 1"),
        (lambda: fit_instrumental(ARX, np.ones(9), np.ones(8)), "equal length"),
        (lambda: fit_instrumental(ARX, np.ones(2), np.ones(2)), "the model has 2 unknowns"),
    ],
)
def test_bad_input_says_what_is_wrong(call, message):
    with pytest.raises(ValueError, match=message):
        call()
