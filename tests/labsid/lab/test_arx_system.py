"""Difference equations of several signals: recovery, the lab's case, python-control as oracle, errors."""

import control
import numpy as np
import pytest
import statsmodels.api as sm
from hypothesis import given
from hypothesis import strategies as st

from labsid.lab.arx import fit_arx, to_ss, to_tf
from labsid.lab.arx_system import ArxSystem, fit_arx_system, simulate_system, system_from_thetas
from labsid.lab.simulation import simulate

Ts = 0.5


def make_system(rng, ny, nu, n, coupled=False):
    """A stable system: poles of each equation inside the circle of 0.9, and weak coupling."""
    a, b = np.zeros((ny, ny, n + 1)), rng.standard_normal((ny, nu, n))
    for i in range(ny):
        a[i, i] = np.poly(rng.uniform(-0.9, 0.9, n))
        for m in range(ny):
            if coupled and m != i:
                a[i, m, 1:] = 0.02 * rng.standard_normal(n)
    return ArxSystem(a, b, Ts)


def recursion(model, u):
    """The equations as the head of the module prints them."""
    y = np.zeros((len(u), len(model.outputs)))
    for k in range(len(u)):
        for lag in range(1, min(k, model.order) + 1):
            y[k] += model.b[:, :, lag - 1] @ u[k - lag] - model.a[:, :, lag] @ y[k - lag]
    return y


@given(st.integers(0, 10**6), st.integers(1, 3), st.integers(1, 3), st.integers(1, 3), st.booleans())
def test_free_run_and_fit_undo_each_other(seed, ny, nu, n, coupled):
    rng = np.random.default_rng(seed)
    model, u = make_system(rng, ny, nu, n, coupled), rng.standard_normal((200, nu))
    y = simulate_system(model, u)
    np.testing.assert_allclose(y, recursion(model, u), rtol=1e-9, atol=1e-9)
    found = fit_arx_system(u, y, Ts, n, coupled=coupled)
    assert all(equation.fit.status == "unique" for equation in found.equations)
    np.testing.assert_allclose(found.model.a, model.a, atol=1e-6)
    np.testing.assert_allclose(found.model.b, model.b, atol=1e-6)


@given(st.integers(0, 10**6), st.booleans())
def test_inputs_superpose(seed, coupled):
    rng = np.random.default_rng(seed)
    model, u = make_system(rng, 2, 3, 2, coupled), rng.standard_normal((50, 3))
    parts = sum(simulate_system(model, u * only) for only in np.eye(3))
    np.testing.assert_allclose(simulate_system(model, u), parts, atol=1e-9)


@pytest.mark.parametrize(("order", "start", "stop"), [(1, 1, None), (2, 2, 300), (3, 0, 400)])
def test_one_input_and_one_output_are_the_case_of_the_lab(staircase, order, start, stop):
    u, y = staircase["u"] - 2.0, staircase["y"] - 2.3
    lab = fit_arx(u, y, 0.75, order, start, stop)
    (equation,) = (found := fit_arx_system(u[:, None], y[:, None], 0.75, order, start, stop)).equations
    np.testing.assert_array_equal(equation.regression.Phi, lab.regression.Phi)
    np.testing.assert_array_equal(equation.fit.theta, lab.fit.theta)
    np.testing.assert_array_equal(equation.fit.stderr, lab.fit.stderr)
    np.testing.assert_array_equal(found.model.a[0, 0], lab.model.a)
    np.testing.assert_array_equal(found.model.b[0, 0], lab.model.b)
    np.testing.assert_allclose(simulate_system(found.model, u[:, None])[:, 0], simulate(lab.model, u), atol=1e-9)
    np.testing.assert_allclose(found.model.poles, lab.model.poles, atol=1e-9)
    assert found.model.static_gain[0, 0] == pytest.approx(lab.model.static_gain)


@pytest.mark.parametrize("coupled", [False, True])
def test_phi_has_a_block_for_each_signal_and_standard_errors_are_those_of_statsmodels(coupled):
    rng = np.random.default_rng(3)
    model, u = make_system(rng, 2, 2, 2, coupled), rng.standard_normal((300, 2))
    y = simulate_system(model, u) + 0.1 * rng.standard_normal((300, 2))
    first, second = fit_arx_system(u, y, Ts, 2, coupled=coupled).equations
    signals = [y[:, 1], *([y[:, 0]] if coupled else []), u[:, 0], u[:, 1]]
    expected = np.column_stack([x[2 - lag : 300 - lag] for x in signals for lag in (1, 2)])
    np.testing.assert_array_equal(second.regression.Phi, expected)
    for equation in (first, second):
        oracle = sm.OLS(equation.regression.Y, equation.regression.Phi).fit()
        np.testing.assert_allclose(equation.fit.theta, oracle.params, rtol=1e-8)
        np.testing.assert_allclose(equation.fit.stderr, oracle.bse, rtol=1e-8)


def test_standard_errors_cover_the_truth():
    rng = np.random.default_rng(4)
    model, inside = make_system(rng, 2, 2, 1), []
    truth = np.array([np.concatenate([-model.a[i, i, 1:], model.b[i].ravel()]) for i in range(2)])
    for _ in range(200):
        u, e = rng.standard_normal((300, 2)), 0.3 * rng.standard_normal((300, 2))
        y = np.zeros((300, 2))
        for k in range(1, 300):
            y[k] = model.b[:, :, 0] @ u[k - 1] - model.a[:, :, 1] @ y[k - 1] + e[k]
        fits = [equation.fit for equation in fit_arx_system(u, y, Ts, 1).equations]
        inside.append([np.abs(fit.theta - true) < 1.96 * fit.stderr for fit, true in zip(fits, truth, strict=True)])
    assert np.mean(inside) == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize(
    ("ny", "nu", "n", "coupled"), [(2, 2, 2, False), (1, 3, 1, False), (3, 1, 2, True), (2, 2, 3, True)]
)
def test_systems_of_python_control_respond_alike(ny, nu, n, coupled):
    rng = np.random.default_rng(5)
    model, u = make_system(rng, ny, nu, n, coupled), rng.standard_normal((60, nu))
    assert model.coupled == coupled
    y, t = simulate_system(model, u), Ts * np.arange(60)
    states, matrix = to_ss(model), to_tf(model)
    assert (states.input_labels, states.output_labels) == (list(model.inputs), list(model.outputs))
    assert (matrix.ninputs, matrix.noutputs, matrix.dt, states.dt) == (nu, ny, Ts, Ts)
    found = control.forced_response(states, t, u.T if nu > 1 else u[:, 0]).outputs
    np.testing.assert_allclose(np.reshape(found, (ny, 60)), y.T, atol=1e-9)
    pairs = [[control.forced_response(matrix[i, j], t, u[:, j]).outputs for j in range(nu)] for i in range(ny)]
    np.testing.assert_allclose(np.sum(pairs, axis=1), y.T, atol=1e-6)
    np.testing.assert_allclose(np.reshape(control.dcgain(states), (ny, nu)), model.static_gain, rtol=1e-8)


def test_rows_without_an_output_are_left_out_of_its_equation_alone():
    rng = np.random.default_rng(6)
    model, u = make_system(rng, 2, 2, 2), rng.standard_normal((100, 2))
    y = simulate_system(model, u)
    measured = np.ones(y.shape, bool)
    measured[50, 1] = False
    y[50, 1] = 1e3
    first, second = fit_arx_system(u, y, Ts, 2, measured=measured).equations
    assert (first.regression.Y.size, second.regression.Y.size) == (98, 95)
    np.testing.assert_allclose(second.fit.theta, np.concatenate([-model.a[1, 1, 1:], model.b[1].ravel()]), atol=1e-9)
    both = fit_arx_system(u, y, Ts, 2, measured=measured, coupled=True).equations
    assert [equation.regression.Y.size for equation in both] == [95, 95]


def test_an_integrator_has_no_static_gain():
    model = system_from_thetas([[1.0, 0.5]], 1, Ts, ("u",), ("y",))
    assert not np.isfinite(model.static_gain).any()
    assert not model.is_stable


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ArxSystem(np.ones((1, 1, 2)), np.ones((1, 1, 2)), Ts), r"shapes \(ny, ny, n \+ 1\) and \(ny, nu, n\)"),
        (lambda: ArxSystem(np.ones((2, 2, 2)), np.ones((2, 1, 1)), Ts), r"a\[i, i\] must begin with 1"),
        (lambda: ArxSystem([[[1, np.nan]]], [[[1.0]]], Ts), r"a and b must be finite"),
        (lambda: ArxSystem([[[1, 0.5]]], [[[1.0]]], 0.0), r"Ts must be a positive number of seconds; got 0"),
        (
            lambda: ArxSystem([[[1, 0.5]]], [[[1.0]]], Ts, u_offset=[1, 2]),
            r"u_offset must have 1 entries; got shape \(2,\)",
        ),
        (
            lambda: system_from_thetas([[1.0]], 1, Ts, ("u",), ("T",)),
            r"theta of T must have 2 entries, 1 for each of 2",
        ),
        (lambda: fit_arx_system(np.ones((5, 3)), np.ones((5, 1)), Ts), r"y: the model has 8 unknowns .* got 3"),
    ],
)
def test_what_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
