"""The check's own linear fit against known models and against a brute search."""

import control
import numpy as np
import pytest

from labsid.blind.closure import simulate_linear_fit
from labsid.blind.output_error import discrete_poles, fit_linear
from labsid.records.record import Record


def second_order(samples: int = 800, seed: int = 0, x0: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    u = 3.0 + np.repeat(rng.uniform(-1, 1, samples // 20), 20)
    G = control.ss(control.tf([0.05, 0.03], [1, -1.5, 0.58], 1.0))
    return u, 2.0 + control.forced_response(G, np.arange(samples), u - 3.0, X0=x0).outputs


@pytest.mark.parametrize("x0", [0.0, 4.0])
def test_a_noiseless_model_is_recovered_from_any_initial_state(x0: float) -> None:
    u, y = second_order(x0=x0)
    fit = fit_linear(u, y, [0.95, 0.3])
    np.testing.assert_allclose(fit.a, [1, -1.5, 0.58], atol=1e-6)
    np.testing.assert_allclose(fit.b, [0.05, 0.03], atol=1e-6)
    assert fit.rmse < 1e-8


def test_complex_poles_are_found_from_real_ones() -> None:
    rng = np.random.default_rng(2)
    u = np.repeat(rng.uniform(-1, 1, 40), 20)
    poles = discrete_poles(np.array([-0.03 + 0.2j, -0.03 - 0.2j]))
    G = control.tf([0.1, 0.1], np.real(np.poly(poles)), 1.0)
    y = control.forced_response(G, np.arange(u.size), u).outputs
    assert fit_linear(u, y, [0.9, 0.8]).rmse < 1e-7


def test_with_noise_only_the_noise_is_left() -> None:
    u, y = second_order()
    noise = 0.1 * np.random.default_rng(1).standard_normal(y.size)
    fit = fit_linear(u, y + noise, [0.9, 0.6])
    assert fit.rmse == pytest.approx(np.std(noise), rel=0.02)
    assert np.sqrt(np.mean((fit.y - y) ** 2)) < 0.02


def test_samples_that_do_not_count_do_not_matter() -> None:
    u, y = second_order()
    counts = np.ones(y.size, dtype=bool)
    counts[200:300] = False
    spoilt = y.copy()
    spoilt[200:300] += 50.0
    fit = fit_linear(u, spoilt, [0.9, 0.6], counts=counts)
    assert fit.rmse < 1e-7
    np.testing.assert_allclose(fit.y, y, atol=1e-6)


def test_a_third_tap_forgives_part_of_a_sample() -> None:
    rng = np.random.default_rng(4)
    u = np.repeat(rng.uniform(-1, 1, 100), 8)
    u[:8] = 0.0
    G = control.sample_system(control.tf([1], [12, 1]) * control.tf([1], [4, 1]), 0.25)
    y = control.forced_response(G, np.arange(4 * u.size) / 4, np.repeat(u, 4)).outputs
    late = np.concatenate([[0.0], y[3::4][: u.size - 1]])  # a quarter of a sample late
    two, three = (fit_linear(u, late, [0.9, 0.8], taps=taps).rmse for taps in (2, 3))
    assert three < 1e-9 < 1e-5 < two


def test_a_fit_simulates_another_record_from_the_initial_state_of_that_record() -> None:
    u, y = second_order()
    fit = fit_linear(u, y, [0.9, 0.6])
    other_u, other_y = second_order(seed=5, x0=-3.0)
    other = Record(t=np.arange(800.0), u=other_u, y=other_y, Ts=1.0)
    np.testing.assert_allclose(simulate_linear_fit(fit, float(u.mean()), other), other_y, atol=1e-5)
