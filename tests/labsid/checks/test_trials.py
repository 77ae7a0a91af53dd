"""Trial data are fit to be tried on, whatever is drawn."""

import numpy as np

from labsid.checks.trials import ARX, first_order, trial_definite, trial_equations, trial_record
from labsid.model_structures.prediction import free_run
from labsid.model_structures.structures import fit_structure


def test_trial_equations_are_well_conditioned_and_contradict_each_other() -> None:
    for seed in range(200):
        Phi, Y = trial_equations(np.random.default_rng(seed), 9, 3)
        assert np.linalg.cond(Phi) < 50
        theta = np.linalg.lstsq(Phi, Y, rcond=None)[0]
        assert np.linalg.norm(Y - Phi @ theta) > 0.1 * np.linalg.norm(Y)


def test_trial_definite_is_symmetric_and_positive_definite() -> None:
    for seed in range(200):
        M = trial_definite(np.random.default_rng(seed), 3)
        assert np.array_equal(M, M.T)
        assert np.linalg.eigvalsh(M)[0] >= 1 - 1e-12


def test_first_order_by_hand() -> None:
    y = free_run(first_order(-0.5, 2.0, 0.5), np.array([1.0, 0, 0]), np.array([0.0, 1, 0]))
    np.testing.assert_allclose(y, [0, 3, 2])  # y(1) = 2 u(0) + e(1), y(2) = 0.5 y(1) + 0.5 e(1)


def test_a_trial_record_starts_at_rest_and_follows_its_system() -> None:
    for seed in range(20):
        u, y = trial_record(np.random.default_rng(seed), 80, 0.0, noise=0.0)
        assert y[0] == 0
        a, b = fit_structure(ARX, u, y).fit.theta
        assert -0.8 <= a <= -0.4
        assert 0.7 <= b <= 2.0
