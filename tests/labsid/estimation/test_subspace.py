"""The subspace method: known systems, the realisation of python-control as oracle, noise, missing outputs."""

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsid.estimation.subspace import fit_subspace
from labsid.lab.arx_system import fit_arx_system
from labsid.model_structures.state_space import StateSpaceModel, simulate_states


def make_model(rng, n, nu, ny):
    blocks = rng.uniform(0.3, 0.9, n) * np.exp(1j * rng.uniform(0.2, 2.5, n))
    G = np.diag(blocks.real)
    for k in range(0, n - 1, 2):
        G[k : k + 2, k : k + 2] = [[blocks[k].real, blocks[k].imag], [-blocks[k].imag, blocks[k].real]]
    return StateSpaceModel(G, rng.standard_normal((n, nu)), rng.standard_normal((ny, n)), np.zeros((ny, nu)), 0.2)


def markov(model, count=8):
    """The pulse responses ``C G^k H``, free of the choice of states."""
    return np.array([model.C @ np.linalg.matrix_power(model.G, k) @ model.H for k in range(count)])


@given(st.integers(0, 10**6), st.integers(1, 5), st.integers(1, 3), st.integers(1, 3))
def test_a_known_system_is_found_without_noise(seed, n, nu, ny):
    rng = np.random.default_rng(seed)
    model, u, x0 = make_model(rng, n, nu, ny), rng.standard_normal((400, nu)), rng.standard_normal(n)
    y = simulate_states(model, u, x0)
    found = fit_subspace(u, y, 0.2, n)
    np.testing.assert_allclose(markov(found.model), markov(model), atol=1e-5 * np.abs(markov(model)).max())
    np.testing.assert_allclose(simulate_states(found.model, u, found.x0), y, atol=1e-5 * np.abs(y).max())
    assert found.reflected == 0


def test_the_realisation_of_python_control_from_pulse_responses_agrees():
    """ERA gets the pulse responses of the noisy data's long ARX; both must come as near to the truth."""
    rng = np.random.default_rng(2)
    model, u = make_model(rng, 4, 2, 2), rng.standard_normal((4000, 2))
    y = simulate_states(model, u)
    y += 0.05 * y.std(axis=0) * rng.standard_normal(y.shape)
    long = fit_arx_system(u, y, 0.2, 25).model.state_space
    pulses = np.moveaxis(np.concatenate([np.zeros((1, 2, 2)), markov(long, 40)]), 0, 2)
    oracle, _ = control.eigensys_realization(pulses, 4, dt=1.0)  # it counts pulses in units of dt
    era = StateSpaceModel(oracle.A, oracle.B, oracle.C, np.zeros((2, 2)), 0.2)
    found = fit_subspace(u, y, 0.2, 4).model
    size = np.abs(markov(model)).max()
    assert np.abs(markov(found) - markov(model)).max() < 0.01 * size
    assert np.abs(markov(found) - markov(era)).max() < 0.05 * size


def test_singular_values_drop_after_the_order():
    rng = np.random.default_rng(3)
    model, u = make_model(rng, 3, 2, 2), rng.standard_normal((2000, 2))
    y = simulate_states(model, u) + 0.01 * rng.standard_normal((2000, 2))
    s = fit_subspace(u, y, 0.2, 3).singular_values
    assert s[2] > 5 * s[3]


def test_missing_outputs_are_left_out():
    rng = np.random.default_rng(4)
    model, u = make_model(rng, 2, 1, 2), rng.standard_normal((600, 1))
    y, measured = simulate_states(model, u), np.ones((600, 2), bool)
    measured[[100, 300], 0] = measured[220:240, 1] = False
    found = fit_subspace(u, np.where(measured, y, 1e3), 0.2, 2, measured=measured)
    np.testing.assert_allclose(markov(found.model), markov(model), atol=1e-6)


def test_units_do_not_matter():
    rng = np.random.default_rng(5)
    model, u = make_model(rng, 3, 2, 2), rng.standard_normal((800, 2))
    y = simulate_states(model, u) + 0.1 * rng.standard_normal((800, 2))
    plain, scaled = fit_subspace(u, y, 0.2, 3).model, fit_subspace(u * [1e3, 1], y * [1, 1e-4], 0.2, 3).model
    expected = markov(plain) * np.array([[1.0], [1e-4]]) / np.array([1e3, 1.0])
    np.testing.assert_allclose(markov(scaled), expected, rtol=1e-5, atol=1e-12)


def test_the_model_is_stable_where_the_data_drift_away():
    rng = np.random.default_rng(6)
    u = rng.standard_normal((300, 1))
    y = np.column_stack([np.cumsum(np.cumsum(u)), 1.01 ** np.arange(300)])
    found = fit_subspace(u, y, 0.2, 3)
    assert found.reflected > 0
    assert np.abs(found.model.poles).max() <= 1.0


@pytest.mark.parametrize(
    ("samples", "order", "rows", "message"),
    [
        (300, 0, None, r"order must be at least 1 and below block_rows \* ny; got order 0"),
        (300, 4, 4, r"got order 4, 4 block rows and ny = 1"),
        (20, 3, None, r"20 samples allow 3 block rows\. Use a longer record or a lower order"),
    ],
)
def test_what_is_refused(samples, order, rows, message):
    rng = np.random.default_rng(1)
    with pytest.raises(ValueError, match=message):
        fit_subspace(rng.standard_normal((samples, 1)), rng.standard_normal((samples, 1)), 1.0, order, rows)
