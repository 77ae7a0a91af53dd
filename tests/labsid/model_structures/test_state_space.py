"""State-space models of several signals: simulation, initial state, and what is refused."""

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsid.model_structures.state_space import (
    StateSpaceModel,
    estimate_state,
    free_responses,
    simulate_states,
    state_space_system,
)

RNG = np.random.default_rng(1)
G = np.array([[0.8, 0.1, 0.0], [0.0, 0.5, 0.2], [0.1, 0.0, -0.3]])
MODEL = StateSpaceModel(G, RNG.standard_normal((3, 2)), RNG.standard_normal((2, 3)), RNG.standard_normal((2, 2)), 0.1)
U = RNG.standard_normal((80, 2))


def test_simulation_is_that_of_python_control():
    system = state_space_system(MODEL, ("a", "b"), ("c", "d"))
    x0 = [1.0, -2.0, 0.5]
    oracle = control.forced_response(system, 0.1 * np.arange(80), U.T, x0)
    np.testing.assert_allclose(simulate_states(MODEL, U, x0), oracle.outputs.T, atol=1e-10)
    np.testing.assert_allclose(MODEL.static_gain, control.dcgain(system), rtol=1e-9)
    np.testing.assert_allclose(np.sort_complex(MODEL.poles), np.sort_complex(control.poles(system)), atol=1e-9)
    assert (MODEL.order, MODEL.is_stable) == (3, True)


@given(st.lists(st.floats(-100, 100), min_size=3, max_size=3))
def test_the_initial_state_is_found_from_what_is_measured(x0):
    y = simulate_states(MODEL, U, x0)
    np.testing.assert_allclose(y - simulate_states(MODEL, U), free_responses(MODEL, 80) @ x0, atol=1e-9)
    measured = np.ones(y.shape, bool)
    measured[3:9, 0] = measured[5:40, 1] = False
    np.testing.assert_allclose(estimate_state(MODEL, U, np.where(measured, y, 1e6), measured), x0, atol=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: StateSpaceModel(G, np.ones((2, 1)), np.ones((1, 3)), [[0.0]], 1.0),
            r"must fit each other; got .*\(2, 1\)",
        ),
        (lambda: StateSpaceModel(G, np.ones((3, 1)), np.ones((1, 3)), [[0.0]], -1.0), r"Ts must be a positive number"),
        (lambda: simulate_states(MODEL, U[:, :1]), r"u must have a column for each of the 2 inputs; got 1"),
        (
            lambda: simulate_states(StateSpaceModel([[9.0]], [[1.0]], [[1.0]], [[0.0]], 1.0), np.ones((400, 1))),
            r"the model has a pole of magnitude 9, outside the unit circle: it is unstable",
        ),
    ],
)
def test_what_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
