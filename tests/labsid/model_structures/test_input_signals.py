"""The five inputs, and the order to which each excites."""

import numpy as np
import pytest
from statsmodels.tsa.arima_process import ArmaProcess

from labsid.lab.excitation import excitation_order, persistent_excitation
from labsid.model_structures.input_signals import arma_process, feedback, sinusoids, step, uniform_noise
from labsid.model_structures.residuals import autocorrelation
from labsid.model_structures.structures import PolynomialModel, Structure, build_equations, fit_structure

PLANT = PolynomialModel([1, -0.8], [1.0], [1])


def test_step_by_hand():
    np.testing.assert_array_equal(step(5, 2.0, at=3), [0, 0, 0, 2, 2])
    assert excitation_order(step(60, 1.7)) == 1


@pytest.mark.parametrize(("samples", "at"), [(200, 0), (200, 5), (200, 100), (200, 150), (61, 30), (9, 8)])
def test_a_step_inside_the_record_has_a_large_order_about_its_edge(samples, at):
    assert excitation_order(step(samples, at=at), largest=samples) == min(at + 1, samples - at)
    assert excitation_order(step(samples, at=at)[at:]) == 1


def test_uniform_noise_has_its_moments_and_excites_any_order():
    u = uniform_noise(np.random.default_rng(0), 100_000)
    assert -2 <= u.min() < -1.999 < 1.999 < u.max() <= 2
    assert u.mean() == pytest.approx(0, abs=0.015)
    assert u.var() == pytest.approx(16 / 12, rel=0.01)
    assert excitation_order(u[:200], largest=50) == 50


def test_arma_process_has_the_autocorrelation_of_theory():
    c, d = [1, -0.7], [1, 0.5]
    u = arma_process(np.random.default_rng(1), 100_000, c, d, sigma=2.0)
    theory = ArmaProcess(c, d)
    np.testing.assert_allclose(autocorrelation(u, 5).values, theory.acf(6), atol=0.03)
    assert u.var() == pytest.approx(4 * theory.acovf(1)[0], rel=0.05)
    assert excitation_order(u[:200], largest=40) == 40


def test_sinusoids_are_those_of_example_7_1():
    t = np.arange(1000)
    printed = 2 * np.sin(np.pi * t / 50 + np.pi / 3) + np.sin(np.pi * t / 30)
    np.testing.assert_allclose(sinusoids(1000, [2, 1], [np.pi / 50, np.pi / 30], [np.pi / 3, 0]), printed, atol=1e-12)
    assert excitation_order(printed) == 4


@pytest.mark.parametrize(("omegas", "order"), [([1.0], 2), ([0.0], 1), ([np.pi], 1), ([0.0, 0.5, 2.0, np.pi], 6)])
def test_order_of_excitation_of_sinusoids(omegas, order):
    m = len(omegas)
    assert excitation_order(sinusoids(400, np.ones(m), omegas, np.full(m, 0.5))) == order


@pytest.mark.parametrize("omega", [0.0, np.pi])
def test_a_frequency_of_0_or_pi_adds_nothing_where_its_samples_are_zero(omega):
    np.testing.assert_allclose(sinusoids(400, [1.0], [omega], [0.0]), 0, atol=1e-12)
    other = [omega, 0.5] if omega == 0 else [0.5, omega]
    assert excitation_order(sinusoids(400, [1, 1], other, [0.0, 0.0])) == 2
    assert excitation_order(sinusoids(400, [1, 1], other, [0.5, 0.5])) == 3


def test_feedback_by_hand():
    # u = r - 0.5 y, y(k) = 0.8 y(k-1) + u(k-1) + e(k)
    loop = feedback(PLANT, [1, 0, 0], [0.5], [0, 0, 1])
    np.testing.assert_allclose(loop.u, [1, -0.5, -0.65])
    np.testing.assert_allclose(loop.y, [0, 1, 0.8 - 0.5 + 1])


@pytest.mark.parametrize("f", [[0.3], [0.2, 0.1], [0.1, -0.2, 0.05, 0.02]])
def test_the_loop_is_closed(f):
    rng = np.random.default_rng(2)
    r, e = rng.standard_normal((2, 50))
    plant = PolynomialModel([1, -1.1, 0.3], [0.5, 0.2], [1, 0.4], delay=2)
    loop = feedback(plant, r, f, e)
    y, u = np.zeros(60), np.zeros(60)  # ten samples of rest before the first
    for k in range(10, 60):
        noise = e[k - 10] + 0.4 * (e[k - 11] if k > 10 else 0)
        y[k] = 1.1 * y[k - 1] - 0.3 * y[k - 2] + 0.5 * u[k - 2] + 0.2 * u[k - 3] + noise
        u[k] = r[k - 10] - sum(f[i] * y[k - i] for i in range(len(f)))
    np.testing.assert_allclose(loop.y, y[10:], atol=1e-10)
    np.testing.assert_allclose(loop.u, u[10:], atol=1e-10)


def test_a_gain_without_a_set_point_hides_the_plant_and_two_remedies():
    rng = np.random.default_rng(3)
    e, r = rng.standard_normal((2, 2000))
    bare = feedback(PLANT, np.zeros(2000), [0.5], e)
    assert not persistent_excitation(build_equations(Structure(1, 1), bare.u, bare.y).Phi).positive_definite
    assert fit_structure(Structure(1, 1), bare.u, bare.y).fit.status == "rank-deficient"
    for loop in (feedback(PLANT, r, [0.5], e), feedback(PLANT, np.zeros(2000), [0.3, 0.3], e)):
        fit = fit_structure(Structure(1, 1), loop.u, loop.y)
        assert fit.fit.status == "unique"
        np.testing.assert_array_less(np.abs(fit.model.theta - [-0.8, 1]), 4 * fit.fit.stderr)


RNG = np.random.default_rng(0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: step(0), "samples must be at least 1; got 0"),
        (lambda: step(3, at=3), "at must lie within the 3 samples; got 3"),
        (lambda: uniform_noise(RNG, 3, (2, 2)), "levels must be in order; got 2 and 2"),
        (lambda: arma_process(RNG, 3, [2], [1]), "c and d must start with 1; got 2 and 1"),
        (lambda: arma_process(RNG, 3, [1, -1.0], [1]), "c must have its roots within .* magnitude 1"),
        (lambda: arma_process(RNG, 3, [1], [1], 0), "sigma must be positive; got 0"),
        (lambda: sinusoids(3, [1, 1], [1, 1], [0, 0]), r"omegas must increase, .* got \[1\.0, 1\.0\]"),
        (lambda: sinusoids(3, [1], [4], [0]), "omegas must increase, from 0 to pi"),
        (lambda: sinusoids(3, [1], [1, 2], [0]), "amplitudes and omegas and phases must have equal length"),
        (lambda: feedback(PolynomialModel([1], [1.0], [1], delay=0), [1], [1]), "with a delay of at least 1"),
        (lambda: feedback(PolynomialModel([1, 0.5], [], [1]), [1], [1]), "model must have an input"),
        (lambda: feedback(PLANT, np.ones(2000), [3.0]), "root of magnitude 2.2, outside the unit circle"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
