"""Free runs of a model of several signals: errors by output and by pair."""

import numpy as np
import pytest

from labsid.lab.system_verification import mse_by_output, verify_system
from labsid.model_structures.state_space import StateSpaceModel, simulate_states

RNG = np.random.default_rng(1)
G, H = [[0.9, 0.0], [0.1, 0.7]], [[1.0, 0.0], [0.0, 0.5]]
MODEL = StateSpaceModel(G, H, [[0.0, 1.0], [1.0, 0.0]], np.zeros((2, 2)), 1.0)
U = RNG.standard_normal((301, 2))


def test_a_true_model_has_the_errors_of_the_noise():
    y = simulate_states(MODEL, U)
    noise = np.array([0.1, 0.01]) * RNG.standard_normal(y.shape)
    runs = verify_system(MODEL, U, y + noise)
    assert runs.half == 150
    np.testing.assert_allclose(runs.mse_all, np.mean(noise**2, axis=0))
    np.testing.assert_allclose(runs.mse_second_half_carried, np.mean(noise[150:] ** 2, axis=0))
    np.testing.assert_array_equal(runs.y_second_half_carried, runs.y_all[150:])
    assert np.all(runs.mse_second_half > 2 * runs.mse_second_half_carried)
    scale = (y + noise)[150:].var(axis=0)  # the estimated state minimises the sum of errors over these
    assert np.sum(runs.mse_second_half_estimated / scale) <= np.sum(runs.mse_second_half_carried / scale)


def test_the_pair_without_effect_changes_no_error():
    y = simulate_states(MODEL, U)
    runs = verify_system(MODEL, U, y)
    assert runs.mse_without.shape == (2, 2)
    assert runs.mse_without[1, 1] < 1e-25  # the second input moves only the first output
    assert np.all(runs.mse_without[0] > 0.01)


def test_samples_that_are_missing_are_not_scored():
    y, measured = simulate_states(MODEL, U), np.ones((301, 2), bool)
    measured[200:220, 1] = False
    runs = verify_system(MODEL, U, np.where(measured, y, 1e3), measured)
    assert runs.mse_all.max() < 1e-20
    found = mse_by_output(np.ones((4, 2)), np.full((4, 2), 3.0), np.array([[True, False]] * 4))
    assert found[0] == 4.0
    assert np.isnan(found[1])


def test_lengths_must_agree():
    with pytest.raises(ValueError, match=r"u and y must have equal length; got 301 and 300\. Cut"):
        verify_system(MODEL, U, np.zeros((300, 2)))
