"""Known parameters, equations and bounds: the SUSTech examples, and other solvers."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import minimize, nnls

from labsid.least_squares.constrained import fit_with_known, least_squares_in_box, least_squares_with_equations
from labsid.least_squares.solve import loss, solve_least_squares
from labsid.model_structures.prediction import free_run
from labsid.model_structures.realisation import model_from_transfer_function
from labsid.model_structures.structures import arx_pq, build_equations


def case(seed, n=12, p=3):
    rng = np.random.default_rng(seed)
    return rng.standard_normal((n, p)), rng.standard_normal(n)


def test_sustech_example_1_rows_and_recovery():
    a, b = 0.5, -0.7
    rng = np.random.default_rng(0)
    u = rng.standard_normal(20)
    y = free_run(model_from_transfer_function([1, 0, b], [1, 0, a, 0]), u)
    equations = build_equations(arx_pq(2, 3), u, y)
    # theta = [alpha1, alpha2, beta0, beta1, beta2, beta3] = [0, a, 0, 1, 0, b].
    result = fit_with_known(equations.Phi, equations.Y, {0: 0.0, 2: 0.0, 3: 1.0, 4: 0.0})
    assert result.free == (1, 5)
    np.testing.assert_allclose(result.theta, [0, a, 0, 1, 0, b], atol=1e-12)
    # The same by the rows of the errata: [-y(k-2), u(k-3)], targets y(k) - u(k-1), k = 4 .. 20 counted from one.
    H = np.array([[-y[k - 3], u[k - 4]] for k in range(4, 21)])
    target = np.array([y[k - 1] - u[k - 2] for k in range(4, 21)])
    np.testing.assert_array_equal(equations.Phi[:, [1, 5]], H)
    np.testing.assert_allclose(solve_least_squares(H, target).theta, result.fit.theta, rtol=1e-12)


def test_sustech_example_2():
    # G = (z - 1)/(z - a): y(k) - a y(k-1) = u(k) - u(k-1).
    # Two rows and one unknown; the regression of all three would want three rows.
    Phi = np.array([[-2, 0.5, 1], [-1, 1, 0.5]])  # [-y(k-1), u(k), u(k-1)], k = 2, 3 counted from one
    result = fit_with_known(Phi, [1, 2], {1: 1.0, 2: -1.0})
    np.testing.assert_allclose(result.theta, [-0.9, 1, -1], rtol=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_nothing_known_is_least_squares_and_a_known_estimate_changes_nothing(seed):
    Phi, Y = case(seed)
    theta = solve_least_squares(Phi, Y).theta
    np.testing.assert_allclose(fit_with_known(Phi, Y, {}).theta, theta, rtol=1e-12)
    np.testing.assert_allclose(fit_with_known(Phi, Y, {1: theta[1]}).theta, theta, rtol=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_equations_hold_and_nothing_within_them_is_better(seed):
    Phi, Y = case(seed)
    rng = np.random.default_rng(100 + seed)
    A, b = rng.standard_normal((2, 3)), rng.standard_normal(2)
    fit = least_squares_with_equations(Phi, Y, A, b)
    np.testing.assert_allclose(A @ fit.theta, b, atol=1e-12)
    # Stationarity and the constraint in one system of equations (Karush, Kuhn, Tucker).
    kkt = np.block([[Phi.T @ Phi, -A.T], [A, np.zeros((2, 2))]])
    both = np.linalg.solve(kkt, np.concatenate([Phi.T @ Y, b]))
    np.testing.assert_allclose(fit.theta, both[:3], rtol=1e-8)
    np.testing.assert_allclose(fit.multipliers, both[3:], rtol=1e-7, atol=1e-10)
    assert fit.status == "unique"
    assert fit.loss >= solve_least_squares(Phi, Y).loss


def test_the_multiplier_is_the_price_of_the_constraint():
    Phi, Y = case(3)
    A = np.array([[1.0, 2, 0]])
    step = 1e-6
    low, middle, high = (least_squares_with_equations(Phi, Y, A, [0.7 + d]) for d in (-step, 0, step))
    assert middle.multipliers[0] == pytest.approx((high.loss - low.loss) / (2 * step), rel=1e-6)


def test_known_parameters_are_equations_too():
    Phi, Y = case(4)
    np.testing.assert_allclose(
        least_squares_with_equations(Phi, Y, [[0, 1, 0]], [0.3]).theta,
        fit_with_known(Phi, Y, {1: 0.3}).theta,
        rtol=1e-9,
    )


def test_constraints_can_determine_what_the_data_do_not_and_all_of_it():
    Phi, Y = np.array([[1.0, 1.0], [2.0, 2.0]]), np.array([2.0, 4.0])
    np.testing.assert_allclose(least_squares_with_equations(Phi, Y, [[1, -1]], [4]).theta, [3, -1], rtol=1e-12)
    whole = least_squares_with_equations(Phi, Y, np.eye(2), [5, 6])
    np.testing.assert_allclose(whole.theta, [5, 6])
    undetermined = least_squares_with_equations(np.zeros((3, 3)), [1, 2, 3], [[1, 0, 0]], [5])
    assert undetermined.status == "not unique"
    np.testing.assert_allclose(undetermined.theta, [5, 0, 0], atol=1e-14)
    # Fewer rows than unknowns will do where the constraints supply the rest.
    np.testing.assert_allclose(least_squares_with_equations([[1, 1]], [3], [[1, -1]], [1]).theta, [2, 1], rtol=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_box_is_the_best_of_all_ways_to_hold_parameters_at_bounds(seed):
    Phi, Y = case(seed)
    lower, upper = np.array([-0.05, 0.1, -np.inf]), np.array([0.05, np.inf, 0.0])
    fit = least_squares_in_box(Phi, Y, lower, upper)
    tried = []
    for choice in product((None, "lower", "upper"), repeat=3):
        known = {i: {"lower": lower, "upper": upper}[side][i] for i, side in enumerate(choice) if side}
        if not np.all(np.isfinite(list(known.values()))):
            continue
        theta = (
            np.array([known.get(i, 0.0) for i in range(3)]) if len(known) == 3 else fit_with_known(Phi, Y, known).theta
        )
        if np.all((lower <= theta) & (theta <= upper)):
            tried.append(loss(Phi, Y, theta))
    assert fit.loss == pytest.approx(min(tried), rel=1e-10)
    assert np.all((lower <= fit.theta) & (fit.theta <= upper))
    for i in range(3):
        if i not in fit.active:
            assert fit.multipliers[i] == 0
            assert Phi[:, i] @ fit.residual == pytest.approx(0, abs=1e-9)
        else:
            assert fit.multipliers[i] * (1 if fit.theta[i] == lower[i] else -1) >= 0


@pytest.mark.parametrize("seed", range(5))
def test_box_is_scipys_and_clipping_is_not_it(seed):
    rng = np.random.default_rng(seed)
    Phi = rng.standard_normal((15, 2)) @ [[1, 0.9], [0, 0.3]]
    Y = Phi @ [1.0, -1.0] + 0.1 * rng.standard_normal(15)
    fit = least_squares_in_box(Phi, Y, [0, 0], [np.inf, np.inf])
    np.testing.assert_allclose(fit.theta, nnls(Phi, Y)[0], atol=1e-10)
    clipped = np.maximum(solve_least_squares(Phi, Y).theta, 0)
    assert loss(Phi, Y, clipped) > 1.05 * fit.loss
    bounded = minimize(lambda th: loss(Phi, Y, th), [1, 1], bounds=[(0, None)] * 2, tol=1e-12)
    assert fit.loss == pytest.approx(bounded.fun, rel=1e-6)


def test_a_wide_box_does_not_matter_and_a_flat_loss_is_said():
    Phi, Y = case(6)
    fit = least_squares_in_box(Phi, Y, [-100] * 3, [100] * 3)
    np.testing.assert_allclose(fit.theta, solve_least_squares(Phi, Y).theta)
    assert (fit.active, fit.status) == ((), "unique")
    assert least_squares_in_box([[1, 1], [2, 2]], [1, 2], [-9, -9], [9, 9]).status == "not unique"


PHI, Y3 = np.eye(3)[:, :2], np.array([1.0, 2, 3])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fit_with_known(PHI, Y3, {2: 1.0}), "known must name places 0 to 1 of theta; got 2"),
        (lambda: fit_with_known(PHI, Y3, {0: 1.0, 1: 2.0}), "known must leave a parameter to estimate; got all 2"),
        (lambda: fit_with_known(PHI, Y3, {0: np.nan}), "known values must be finite; got nan for place 0"),
        (lambda: fit_with_known(PHI, [1, 2], {0: 1.0}), "Phi and Y must have equally many rows; got 3 and 2"),
        (lambda: least_squares_with_equations(PHI, Y3, [[1]], [1]), r"A must have 2 columns.*got \(1, 1\) and 1"),
        (
            lambda: least_squares_with_equations(PHI, Y3, [[1, 1]], [1, 2]),
            r"as many rows as b has entries; got \(1, 2\)",
        ),
        (
            lambda: least_squares_with_equations(PHI, Y3, [[1, 1], [2, 2]], [1, 3]),
            "rows of A must be independent; got rank 1",
        ),
        (
            lambda: least_squares_in_box(PHI, Y3, [0], [1]),
            r"one entry per parameter \(2\); got shapes \(1,\) and \(1,\)",
        ),
        (lambda: least_squares_in_box(PHI, Y3, [0, 1], [1, 1]), r"got 1\.0 and 1\.0 for parameter 1\. For a known"),
        (lambda: least_squares_in_box(PHI, Y3, [0, np.nan], [1, 1]), "lower must be below upper; got nan"),
    ],
)
def test_what_does_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
