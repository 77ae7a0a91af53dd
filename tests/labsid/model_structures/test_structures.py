"""One description of ARX, AR, ARMA, ARMAX and FIR."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from statsmodels.tsa.ar_model import AutoReg

from labsid.lab.arx import fit_arx
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import (
    PolynomialModel,
    Structure,
    arx_pq,
    build_equations,
    fit_structure,
    model_from_theta,
)


def record(seed=0, n=60):
    rng = np.random.default_rng(seed)
    return rng.standard_normal(n), rng.standard_normal(n)


@pytest.mark.parametrize(
    ("structure", "kind", "parameters", "longest_lag"),
    [
        (Structure(2, 3), "ARX", 5, 3),
        (Structure(2, 3, delay=2), "ARX", 5, 4),
        (arx_pq(2, 3), "ARX", 6, 3),
        (arx_pq(0, 0), "FIR", 1, 0),
        (Structure(3, 0), "AR", 3, 3),
        (Structure(1, 0, 2), "ARMA", 3, 2),
        (Structure(0, 0, 2), "MA", 2, 2),
        (Structure(1, 1, 1), "ARMAX", 3, 1),
        (Structure(0, 3, delay=0), "FIR", 3, 2),
    ],
)
def test_kinds_and_counts(structure, kind, parameters, longest_lag):
    assert (structure.kind, structure.parameters, structure.longest_lag) == (kind, parameters, longest_lag)


def test_example_2_3_rows_from_rest():
    equations = build_equations(Structure(0, 3, delay=0), [1, 2, 3, 4], [5, 6, 7, 8], start=0)
    np.testing.assert_array_equal(equations.Phi, [[1, 0, 0], [2, 1, 0], [3, 2, 1], [4, 3, 2]])


def test_example_3_1_rows():
    u, y = record()
    equations = build_equations(Structure(1, 1), u, y)
    np.testing.assert_array_equal(equations.Phi, np.column_stack([-y[:-1], u[:-1]]))
    np.testing.assert_array_equal(equations.Y, y[1:])


def test_armax_row_by_hand():
    u, y, e = np.arange(10.0), 10 + np.arange(10.0), 100 + np.arange(10.0)
    equations = build_equations(Structure(2, 2, 1, delay=3), u, y, e)
    assert (equations.start, equations.stop) == (4, 10)
    np.testing.assert_array_equal(equations.Phi[0], [-13, -12, 1, 0, 103])
    assert equations.Y[0] == 14


@given(st.integers(0, 3), st.integers(0, 3), st.integers(0, 2), st.integers(0, 4), st.integers(0, 6))
@settings(max_examples=100, deadline=None)
def test_rows_are_the_sums_of_the_definition(na, nb, nc, delay, start):
    if na + nb + nc == 0:
        return
    structure = Structure(na, nb, nc, delay)
    rng = np.random.default_rng(7)
    u, y, e = rng.standard_normal((3, 30))
    equations = build_equations(structure, u, y, e, start=start)

    def at(x, k):
        return x[k] if k >= 0 else 0.0

    for k in (start, 15, 29):
        row = [-at(y, k - i) for i in range(1, na + 1)]
        row += [at(u, k - delay - i) for i in range(nb)]
        row += [at(e, k - i) for i in range(1, nc + 1)]
        np.testing.assert_array_equal(equations.Phi[k - start], row)


@pytest.mark.parametrize("seed", range(5))
def test_the_labs_arx_is_the_same_model_with_the_sign_elsewhere(seed):
    u, y = record(seed)
    ours, labs = fit_structure(Structure(2, 2), u, y), fit_arx(u, y, 1.0)
    np.testing.assert_allclose(ours.model.a, labs.model.a, rtol=1e-10)
    np.testing.assert_allclose(ours.model.b, labs.model.b, rtol=1e-10)
    np.testing.assert_allclose(ours.model.theta * [-1, -1, 1, 1], labs.model.theta, rtol=1e-10)


def test_ar_is_that_of_statsmodels():
    _, y = record(3)
    oracle = AutoReg(y, lags=3, trend="n").fit()
    fit = fit_structure(Structure(3, 0), None, y)
    np.testing.assert_allclose(-fit.model.a[1:], oracle.params, rtol=1e-9)


@pytest.mark.parametrize(
    "truth",
    [
        PolynomialModel([1, -1.2, 0.5], [0.3, -0.4, 0.7], [1], delay=3),
        PolynomialModel([1, -0.6], [2.0, 1.0], [1], delay=0),
        PolynomialModel([1], [1.0, 0.5, 0.25], [1], delay=1),
    ],
)
def test_a_known_truth_is_recovered_whatever_its_delay_and_orders(truth):
    u, _ = record(4)
    fit = fit_structure(truth.structure, u, free_run(truth, u), Ts=0.5)
    np.testing.assert_allclose(fit.model.theta, truth.theta, atol=1e-12)
    assert (fit.fit.status, fit.model.Ts, fit.model.delay) == ("unique", 0.5, truth.delay)


def test_the_errata_on_armax_with_the_true_noise_it_is_linear():
    truth = PolynomialModel([1, -0.8], [1.0], [1, -0.8])
    u, e = record(5, 300)
    y = free_run(truth, u, e)
    equations = build_equations(truth.structure, u, y, e)
    # Y - Phi theta is exactly e(k), which a fit with the true noise in phi then finds.
    np.testing.assert_allclose(equations.Y - equations.Phi @ truth.theta, e[1:], atol=1e-12)


def test_theta_and_back():
    structure = Structure(2, 1, 1, delay=2)
    model = model_from_theta(structure, [0.1, 0.2, 3, 0.4], Ts=0.1)
    np.testing.assert_array_equal(model.a, [1, 0.1, 0.2])
    np.testing.assert_array_equal(model.delayed_b, [0, 0, 3])
    np.testing.assert_array_equal(model.theta, [0.1, 0.2, 3, 0.4])
    assert model.structure == structure
    with pytest.raises(ValueError, match="read-only"):
        model.a[0] = 2


U, Y = record()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Structure(0, 0), "must be zero or more and leave a parameter; got 0, 0, 0 and 1"),
        (lambda: Structure(-1, 2), "got -1, 2, 0 and 1"),
        (lambda: PolynomialModel([2, 1], [1], [1]), "a and c must start with 1; got 2 and 1"),
        (lambda: PolynomialModel([1], [1], [1], delay=-1), "delay must be zero or more; got -1"),
        (lambda: PolynomialModel([1], [1], [1], Ts=0), "Ts must be a positive number of seconds; got 0"),
        (lambda: model_from_theta(Structure(1, 1), [1]), r"one entry per coefficient of the ARX model \(2\); got 1"),
        (
            lambda: build_equations(Structure(1, 1), None, Y),
            "u must be given: the ARX structure has coefficients of it",
        ),
        (lambda: build_equations(Structure(1, 0, 1), None, Y), "e must be given: the ARMA structure"),
        (lambda: build_equations(Structure(1, 1), U[:-1], Y), "u and y must have equal length; got 59 and 60"),
        (
            lambda: build_equations(Structure(30, 30), U, Y),
            "the model has 60 unknowns and needs at least as many rows; got 30",
        ),
        (lambda: build_equations(Structure(1, 1), U, Y, start=5, stop=3), "got start 5 and stop 3"),
        (lambda: fit_structure(Structure(1, 1, 1), U, Y), "nc must be 0 for linear least squares; got 1"),
    ],
)
def test_what_does_not_fit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
