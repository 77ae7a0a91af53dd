"""Pseudo-linear regression for ARMAX models."""

import numpy as np
import pytest

from labsid.estimation.armax import fit_armax
from labsid.estimation.monte_carlo import run_monte_carlo
from labsid.estimation.recursive import recursive_armax
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.lecture_systems import example_7_1, example_7_2, system_2
from labsid.model_structures.prediction import prediction_errors
from labsid.model_structures.structures import Structure, build_equations, fit_structure

ARMAX = Structure(1, 1, 1)


def test_the_solution_regresses_on_its_own_prediction_errors():
    """What defines the fixed point: e comes from theta, and theta from the regression on e."""
    r = example_7_1(np.random.default_rng(0))
    found = fit_armax(ARMAX, r.u, r.y, Ts=0.5)
    assert (found.status, found.model.Ts) == ("converged", 0.5)
    np.testing.assert_array_equal(found.e, prediction_errors(found.model, r.u, r.y))
    again = build_equations(ARMAX, r.u, r.y, found.e)
    np.testing.assert_allclose(solve_least_squares(again.Phi, again.Y).theta, found.model.theta, atol=1e-8)


@pytest.mark.parametrize(
    ("system", "truth"), [(example_7_1, [-0.9, 1.0, 0.3]), (system_2, [-0.8, 1.0, -0.8])], ids=["7-1", "system 2"]
)
def test_it_finds_the_noise_model_over_many_records(system, truth):
    def estimate(rng):
        r = system(rng, 2000)
        found = fit_armax(ARMAX, r.u, r.y)
        assert found.status == "converged"
        return found.model.theta

    result = run_monte_carlo(estimate, truth, 25, seed=3)
    assert np.all(np.abs(result.bias) < 4 * result.bias_stderr + 0.003)
    assert np.all(result.spread < 0.05)


def test_it_agrees_with_the_end_of_the_recursion():
    r = example_7_1(np.random.default_rng(1), 20_000)
    np.testing.assert_allclose(
        recursive_armax(ARMAX, r.u, r.y).theta[-1], fit_armax(ARMAX, r.u, r.y).model.theta, atol=0.03
    )


def test_example_7_2_with_the_true_noise_the_columns_are_exactly_dependent():
    r = example_7_2(np.random.default_rng(2))
    too_large = build_equations(Structure(2, 0, 2), None, r.y, r.e)
    s = np.linalg.svd(too_large.Phi, compute_uv=False)
    assert s[-1] < 1e-12 * s[0]
    assert solve_least_squares(too_large.Phi, too_large.Y).status == "rank-deficient"
    right = build_equations(Structure(1, 0, 1), None, r.y, r.e)
    assert solve_least_squares(right.Phi, right.Y).status == "unique"


def test_example_7_2_with_the_estimated_noise_they_are_only_nearly_so():
    """Errata: the print calls Phi'Phi / N singular. Any d gives the same system; the noise estimate hides it."""
    r = example_7_2(np.random.default_rng(2))
    right = fit_armax(Structure(1, 0, 1), None, r.y)
    assert right.status == "converged"
    np.testing.assert_allclose(right.model.theta, [-0.9, 0.3], atol=0.1)

    def condition(e):
        larger = build_equations(Structure(2, 0, 2), None, r.y, e)
        return solve_least_squares(larger.Phi, larger.Y).condition_number

    long_ar = fit_structure(Structure(10, 0), None, r.y)
    estimated = condition(np.concatenate([np.zeros(10), long_ar.fit.residual]))
    assert 5 * right.fit.condition_number < estimated < 1000
    # Errors that a model one order lower made itself obey its equation, and with it the columns.
    assert condition(right.e) > 1e12


def test_a_delay_is_taken_into_account():
    r = example_7_1(np.random.default_rng(4), 3000)
    later = np.roll(r.u, -2)  # y(k) depends on later(k - 3); the two wrapped samples hardly matter
    found = fit_armax(Structure(1, 1, 1, delay=3), later, r.y)
    np.testing.assert_allclose(found.model.theta, [-0.9, 1.0, 0.3], atol=0.08)


def test_scaling_the_output_and_input():
    r = example_7_1(np.random.default_rng(5))
    plain, scaled = fit_armax(ARMAX, r.u, r.y), fit_armax(ARMAX, 10 * r.u, 3 * r.y)
    np.testing.assert_allclose(scaled.model.theta, plain.model.theta * [1, 0.3, 1], atol=1e-6)


def test_what_does_not_work_out_is_a_status():
    r = example_7_2(np.random.default_rng(0))
    assert fit_armax(Structure(2, 0, 2), None, r.y).status in {"not invertible", "not converged", "rank-deficient"}
    assert fit_armax(ARMAX, *(getattr(system_2(np.random.default_rng(0)), s) for s in "uy"), iterations=2).status == (
        "not converged"
    )
    silent = example_7_1(np.random.default_rng(0))
    assert fit_armax(Structure(1, 2, 1), np.zeros(1000), silent.y).status == "rank-deficient"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fit_armax(Structure(1, 1), np.ones(50), np.ones(50)), "nc and iterations must be at least 1; got 0"),
        (lambda: fit_armax(ARMAX, np.ones(50), np.ones(50), iterations=0), "got 1 and 0"),
        (lambda: fit_armax(ARMAX, np.ones(50), np.ones(49)), "equal length"),
        (lambda: fit_armax(ARMAX, np.ones(50), np.full(50, np.nan)), "y must be finite"),
        (lambda: fit_armax(ARMAX, None, np.ones(50)), "u must be given"),
        (lambda: fit_armax(Structure(4, 4, 4), np.ones(9), np.ones(9)), "needs at least as many rows"),
    ],
)
def test_bad_input_says_what_is_wrong(call, message):
    with pytest.raises(ValueError, match=message):
        call()
