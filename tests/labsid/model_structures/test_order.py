"""Loss against order, its price, and Example 7-2."""

import numpy as np
import pytest
import statsmodels.api as sm

from labsid.lab.excitation import persistent_excitation
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.order import compare_models, loss_against_order, pair_roots
from labsid.model_structures.polynomials import multiply
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import PolynomialModel, Structure, build_equations, fit_structure

TRUTH = PolynomialModel([1, -1.3, 0.5], [1.0, 0.4], [1])
ORDERS = [Structure(n, n) for n in range(1, 7)]


def record(seed, n=1000, truth=TRUTH):
    rng = np.random.default_rng(seed)
    u, e = rng.uniform(-2, 2, n), rng.standard_normal(n)
    return u, free_run(truth, u, e), e


def test_the_loss_falls_to_the_noise_at_the_true_order_and_hardly_further():
    u, y, _ = record(0)
    scan = loss_against_order(ORDERS, u, y)
    assert scan.rows == 994
    assert np.all(np.diff(scan.loss) <= 0)
    assert scan.loss[0] > 1.3
    assert scan.loss[1] == pytest.approx(1, abs=0.1)
    assert scan.loss[1] - scan.loss[5] < 0.02
    assert np.argmin(scan.bic) == 1


def test_criteria_are_those_of_statsmodels_but_for_their_constants():
    u, y, _ = record(1, 300)
    scan = loss_against_order(ORDERS, u, y)
    oracles = [
        sm.OLS(equations.Y, equations.Phi).fit() for equations in (build_equations(s, u, y, start=6) for s in ORDERS)
    ]
    np.testing.assert_allclose(np.diff(scan.aic), np.diff([oracle.aic for oracle in oracles]), rtol=1e-6)
    np.testing.assert_allclose(np.diff(scan.bic), np.diff([oracle.bic for oracle in oracles]), rtol=1e-6)
    np.testing.assert_allclose(scan.loss, [oracle.ssr / 294 for oracle in oracles], rtol=1e-9)
    p = scan.parameters
    np.testing.assert_allclose(scan.fpe, scan.loss * (294 + p) / (294 - p))


def test_bic_finds_the_order_and_aic_overshoots_now_and_then():
    bic, aic = [], []
    for seed in range(60):
        scan = loss_against_order(ORDERS, *record(seed, 500)[:2])
        bic.append(int(np.argmin(scan.bic)) + 1)
        aic.append(int(np.argmin(scan.aic)) + 1)
    assert np.mean(np.array(bic) == 2) > 0.9
    assert min(aic) == 2
    assert np.mean(np.array(aic) == 2) < np.mean(np.array(bic) == 2)


def test_fpe_is_the_loss_on_new_data():
    # Few samples and many parameters, so that the correction counts.
    fresh, foretold, shown = [], [], []
    for seed in range(300):
        u, y, _ = record(seed, 50)
        scan = loss_against_order([Structure(5, 5)], u, y)
        model = fit_structure(Structure(5, 5), u, y).fit.theta
        new = build_equations(Structure(5, 5), *record(1000 + seed, 400)[:2])
        fresh.append(np.mean((new.Y - new.Phi @ model) ** 2))
        foretold.append(scan.fpe[0])
        shown.append(scan.loss[0])
    assert np.mean(foretold) == pytest.approx(np.mean(fresh), rel=0.1)
    assert np.mean(shown) < 0.85 * np.mean(fresh)


def test_without_noise_the_true_order_fits_exactly_and_a_larger_one_is_singular():
    u = np.random.default_rng(3).standard_normal(200)
    scan = loss_against_order(ORDERS[:3], u, free_run(TRUTH, u))
    assert scan.loss[0] > 1e-2
    assert np.all(scan.loss[1:] < 1e-25)
    assert scan.condition_number[1] < 100 < 1e12 < scan.condition_number[2]
    silent = loss_against_order(ORDERS[:1], u, np.zeros(200))
    assert (silent.loss[0], silent.aic[0], silent.fpe[0]) == (0, -np.inf, 0)


def test_f_test_is_that_of_statsmodels():
    u, y, _ = record(4, 100)
    small, large = (build_equations(s, u, y, start=3) for s in (Structure(1, 1), Structure(3, 3)))
    result = compare_models(solve_least_squares(small.Phi, small.Y), solve_least_squares(large.Phi, large.Y))
    statistic, p_value, added = sm.OLS(large.Y, large.Phi).fit().compare_f_test(sm.OLS(small.Y, small.Phi).fit())
    assert result.statistic == pytest.approx(statistic, rel=1e-9)
    assert result.p_value == pytest.approx(p_value, rel=1e-6)
    assert (result.added, result.degrees_of_freedom) == (added, 97 - 6)
    assert result.p_value < 1e-6


def test_f_test_rejects_one_true_model_in_twenty():
    p_values = []
    for seed in range(400):
        u, y, _ = record(seed, 200)
        fits = [fit_structure(s, u, y, start=3).fit for s in (Structure(2, 2), Structure(3, 3))]
        p_values.append(compare_models(*fits).p_value)
    assert np.mean(np.array(p_values) < 0.05) == pytest.approx(0.05, abs=0.033)  # three standard errors


def test_example_7_2_is_singular_with_the_true_noise_and_only_nearly_with_its_estimate():
    truth = PolynomialModel([1, -0.8], [], [1, 0.5])
    e = np.random.default_rng(5).standard_normal(1000)
    y = free_run(truth, None, e)
    equations = build_equations(Structure(2, 0, 2), None, y, e)
    exact = persistent_excitation(equations.Phi)
    assert not exact.positive_definite
    assert exact.eigenvalues[-1] < 1e-28 * 1e4 * exact.eigenvalues[0]
    # The direction that nothing determines is that of d: theta = [a + d, a d, c + d, c d].
    direction = np.linalg.svd(equations.Phi)[2][-1]
    np.testing.assert_allclose(direction / direction[0], [1, -0.8, 1, 0.5], atol=1e-9)
    long_ar = fit_structure(Structure(20, 0), None, y, start=0)
    estimated = persistent_excitation(build_equations(Structure(2, 0, 2), None, y, long_ar.fit.residual, start=20).Phi)
    assert estimated.positive_definite
    assert 1e-4 < estimated.eigenvalues[-1] < 0.1


def test_an_overfitted_noisy_arx_is_not_singular_however_long_the_record():
    smallest = []
    for n in (1000, 100_000):
        u, y, _ = record(6, n)
        smallest.append(persistent_excitation(build_equations(Structure(3, 3), u, y).Phi).eigenvalues[-1])
    assert min(smallest) > 0.05
    assert smallest[1] == pytest.approx(smallest[0], rel=0.3)


@pytest.mark.parametrize("d", [-0.9, 0.0, 0.3, 2.0])
def test_the_common_factor_cancels_whatever_d_is(d):
    c, a = 0.5, -0.8  # Example 7-2: C over A
    pairs = pair_roots(multiply([1, c], [1, d]), multiply([1, a], [1, d]))
    assert pairs.distance[0] == pytest.approx(0, abs=1e-12)
    assert pairs.poles[0] == pytest.approx(-d, abs=1e-12)
    assert pairs.distance[1] == pytest.approx(1.3)


def test_pairs_of_an_overfitted_model_nearly_cancel_and_those_of_the_truth_do_not():
    u, y, _ = record(7, 5000)
    distances = {}
    for n in (2, 3):
        model = fit_structure(Structure(n, n), u, y).model
        distances[n] = pair_roots(model.b, model.a).distance
    assert distances[2][0] > 0.5
    assert distances[3][0] < 0.35
    # A delay is not a root, and the lower degree decides how many pairs there are.
    assert pair_roots([0, 0, 1, 0.5], [1, -1, 0.3, 0.1]).distance.size == 1
    assert pair_roots([1], [1, 0.5]).distance.size == 0


FIT = solve_least_squares(np.eye(4)[:, :2], [1, 2, 3, 4])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: loss_against_order([], [1, 2], [1, 2]), "structures must hold at least one structure"),
        (lambda: loss_against_order([Structure(1, 0, 1)], None, [1, 2, 3]), "nc must be 0 for linear least squares"),
        (lambda: compare_models(FIT, FIT), r"more parameters than smaller and fewer than equations \(4\); got 2 and 2"),
        (
            lambda: compare_models(solve_least_squares([[1], [2]], [1, 2]), FIT),
            "must solve the same equations; got 2 and 4 of them",
        ),
        (lambda: pair_roots([0, 0], [1, 2]), "numerator must not be zero everywhere"),
    ],
)
def test_what_cannot_be_compared(call, message):
    with pytest.raises(ValueError, match=message):
        call()
