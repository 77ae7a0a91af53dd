"""Persistent excitation, and the recommended inputs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsid.lab.arx import ArxModel
from labsid.lab.excitation import (
    excitation_order,
    excited_in_other_units,
    persistent_excitation,
    prbs,
    square_wave,
    sum_of_sinusoids,
)
from labsid.lab.regressor import build_phi
from labsid.lab.simulation import simulate
from labsid.least_squares.solve import solve_least_squares


def test_eigenvalues_by_hand():
    # Phi'Phi = [[2, 1], [1, 2]] has the eigenvalues 3 and 1; there are three rows.
    result = persistent_excitation([[1, 0], [0, 1], [1, 1]])
    np.testing.assert_allclose(result.eigenvalues, [1, 1 / 3], rtol=1e-14)
    assert (result.rank, result.positive_definite) == (2, True)
    assert result.condition_number == pytest.approx(np.sqrt(3))


@pytest.mark.parametrize("seed", range(10))
def test_eigenvalues_are_those_of_the_normal_matrix_and_the_rank_that_of_least_squares(seed):
    rng = np.random.default_rng(seed)
    Phi = rng.standard_normal((40, 3)) * [1, 10, 0.1]
    result = persistent_excitation(Phi)
    np.testing.assert_allclose(result.eigenvalues, np.linalg.eigvalsh(Phi.T @ Phi / 40)[::-1], rtol=1e-9)
    fit = solve_least_squares(Phi, Phi[:, 0])
    assert result.rank == fit.rank
    assert result.condition_number == pytest.approx(fit.condition_number, rel=1e-12)


def test_columns_of_very_different_units_are_told_from_dependent_ones():
    columns = np.random.default_rng(1).standard_normal((40, 3)) * [1e-12, 1e-12, 1e12]
    assert not persistent_excitation(columns).positive_definite
    assert excited_in_other_units(columns)
    assert not excited_in_other_units(columns[:, [0, 0, 2]])
    assert not excited_in_other_units(columns * [1, 0, 1])


def test_dependent_columns_and_too_few_rows_are_not_positive_definite():
    assert not persistent_excitation([[1, 2], [2, 4], [3, 6]]).positive_definite
    few = persistent_excitation([[1.0, 2, 3]])
    assert (few.rank, few.positive_definite, few.condition_number) == (1, False, np.inf)
    np.testing.assert_allclose(few.eigenvalues, [14, 0, 0], atol=1e-14)


def test_a_single_sinusoid_cannot_identify_third_order_but_a_sum_can():
    model = ArxModel([1, -1.5, 0.74, -0.12], [0.3, 0.2, 0.1], 1.0)
    for periods, definite in (([9.0], False), ([9.0, 23.0, 47.0], True)):
        u = sum_of_sinusoids(3000, periods)
        y = simulate(model, u)
        # Far from the start-up transient, which would excite by itself.
        regression = build_phi(u, y, order=3, start=2000)
        assert persistent_excitation(regression.Phi).positive_definite is definite


def test_from_rest_a_single_sinusoid_identifies_second_order_and_in_steady_state_it_does_not():
    model = ArxModel([1, -1.5, 0.7], [1.0, 0.5], 1.0)
    u = sum_of_sinusoids(800, [60.0])
    y = simulate(model, u)
    from_rest, steady = (build_phi(u, y, order=2, start=start) for start in (2, 400))
    assert excitation_order(u) == 2
    assert persistent_excitation(from_rest.Phi).rank == 4
    error = solve_least_squares(from_rest.Phi, from_rest.Y).theta - [1.5, -0.7, 1.0, 0.5]
    assert np.max(np.abs(error)) < 1e-11
    assert np.linalg.matrix_rank(steady.Phi, tol=1e-9 * np.linalg.norm(steady.Phi)) == 2


@pytest.mark.parametrize(
    ("u", "order"),
    [
        (np.zeros(60), 0),
        (np.full(60, 1.7), 1),
        (sum_of_sinusoids(400, [17.3]), 2),
        (sum_of_sinusoids(400, [17.3, 31.7]), 4),
        (sum_of_sinusoids(400, [5.1, 9.7, 17.3, 31.7]), 8),
        (3 + sum_of_sinusoids(400, [17.3]), 3),
        (sum_of_sinusoids(2000, [1000.0]), 2),
        (prbs(400, register=5), 31),
        (prbs(100, register=3), 7),
        (np.where(np.arange(400) % 2 == 0, 1.0, -1.0), 1),
    ],
)
def test_order_of_known_signals(u, order):
    assert excitation_order(u) == order


def test_order_is_bounded_by_the_length_and_by_where_one_stops_looking():
    noise = np.random.default_rng(0).standard_normal(41)
    assert excitation_order(noise) == 21
    assert excitation_order(noise, largest=6) == 6


@given(st.integers(0, 10**6), st.floats(0.01, 100))
@settings(max_examples=40, deadline=None)
def test_order_does_not_depend_on_size_or_start(seed, scale):
    periods = np.random.default_rng(seed).uniform(4, 40, 2)
    periods[1] += 45
    u = sum_of_sinusoids(300, periods)
    assert excitation_order(u) == excitation_order(scale * u) == excitation_order(u[37:]) == 4


def test_prbs_has_two_levels_its_period_and_the_correlation_of_white_noise():
    u = prbs(2 * 127, levels=(1.6, 2.2), register=7)
    assert set(u) == {1.6, 2.2}
    np.testing.assert_array_equal(u[:127], u[127:])
    s = np.where(u[:127] > 1.9, 1.0, -1.0)
    correlation = np.array([s @ np.roll(s, lag) for lag in range(127)])
    np.testing.assert_array_equal(correlation, [127] + [-1] * 126)


def test_prbs_is_held_and_its_seed_shifts_it():
    u = prbs(100, register=6, hold=5)
    assert u.size == 100
    np.testing.assert_array_equal(u.reshape(-1, 5), np.repeat(u[::5], 5).reshape(-1, 5))
    shifted = prbs(63, register=6, rng=np.random.default_rng(1))
    plain = prbs(63, register=6)
    assert not np.array_equal(shifted, plain)
    assert any(np.array_equal(np.roll(plain, lag), shifted) for lag in range(63))


def test_square_wave_by_hand():
    np.testing.assert_array_equal(square_wave(7, 4, levels=(0, 2)), [2, 2, 0, 0, 2, 2, 0])
    np.testing.assert_array_equal(square_wave(6, 3), [1, 1, -1, 1, 1, -1])


def test_sum_of_sinusoids_has_the_asked_for_lines_and_moderate_peaks():
    u = sum_of_sinusoids(600, [600 / n for n in range(1, 21)], amplitude=0.5)
    lines = np.abs(np.fft.rfft(u)) / 300
    np.testing.assert_allclose(lines[1:21], 0.5, rtol=1e-9)
    assert np.max(lines[21:]) < 1e-9
    assert np.max(np.abs(u)) < 0.5 * 20 * 0.45  # twenty peaks that coincided would reach 10


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: excitation_order([1, 2], largest=0), r"largest must be at least 1; got 0\."),
        (lambda: prbs(0), r"samples must be at least 1; got 0\."),
        (lambda: prbs(10, hold=0), r"hold must be at least 1; got 0\."),
        (lambda: prbs(10, register=1), r"register must have 2 to 32 bits; got 1\."),
        (lambda: square_wave(10, 1), r"period must be at least 2; got 1\."),
        (lambda: square_wave(0, 4), r"samples must be at least 1; got 0\."),
        (lambda: sum_of_sinusoids(10, [5, 2]), r"periods must be above 2 samples; got 2\. Faster ones alias"),
        (lambda: persistent_excitation([1, 2]), r"Phi must be a finite matrix .*; got shape \(2,\)"),
        (lambda: persistent_excitation([[np.nan]]), "Phi must be a finite matrix"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
