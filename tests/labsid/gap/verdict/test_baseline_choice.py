"""The linear model of a record: output error unless another model is clearly better, or its pole cannot be seen."""

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid._arrays import FloatArray
from labsid.gap.diagnosis import diagnose
from labsid.gap.dynamics.responses import real_rates
from labsid.gap.fits.fitting import Fit, Problem, finish
from labsid.gap.fits.linear_fits import LINEAR, fit_baseline
from labsid.gap.record.data import Data, scaled
from labsid.gap.verdict.baseline_choice import (
    FASTEST_RATE,
    FIRST_ORDER,
    LEAST_SQUARES,
    OBSERVED_TIME_CONSTANTS,
    OUTPUT_ERROR,
    LinearModel,
    choose_linear_model,
    fit_arx_poles,
    fit_first_order,
    without_unseen_pole,
)
from labsid.gap.verdict.held_out_errors import hold_out
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")

TWO_POLES = np.poly([0.9, 0.7])


def levels(samples: int, hold: int, seed: int) -> FloatArray:
    """An input of random levels."""
    return np.repeat(np.random.default_rng(seed).uniform(-1.0, 1.0, samples // hold + 1), hold)[:samples]


def noise(samples: int, seed: int) -> FloatArray:
    return np.random.default_rng(seed).standard_normal(samples)


def data_of(u: FloatArray, y: FloatArray) -> Data:
    return scaled(u, y, np.ones(u.size, bool), 1.0)


def chosen(u: FloatArray, y: FloatArray) -> tuple[LinearModel, dict[str, float]]:
    """The choice, and the rms error of each method on the held-out samples."""
    data = data_of(u, y)
    held_out = hold_out(data, None)
    start = held_out.refit(fit_baseline(data))
    fits = {
        OUTPUT_ERROR: start,
        FIRST_ORDER: fit_first_order(held_out.data),
        LEAST_SQUARES: fit_arx_poles(held_out.data),
    }
    errors = {name: float(np.sqrt(np.mean(held_out.errors(fit)))) for name, fit in fits.items()}
    return choose_linear_model(held_out, start), errors


def time_constants(fit: Fit, samples: int) -> float:
    """Length of the record in time constants of the slowest pole."""
    return float(np.min(real_rates(*fit.rates)) * samples)


@pytest.mark.parametrize("seed", range(3))
def test_output_error_is_kept_where_it_is_right(seed: int) -> None:
    u = levels(400, 8, seed)
    y = lfilter([0.0, 0.03, 0.02], TWO_POLES, u)
    model, errors = chosen(u, y + 0.05 * y.std() * noise(400, seed))
    assert (model.method, model.observed) == (OUTPUT_ERROR, True)
    assert errors[OUTPUT_ERROR] == min(errors.values())


@pytest.mark.parametrize("seed", range(3))
def test_a_rig_of_first_order_keeps_the_order_asked_for_without_loss(seed: int) -> None:
    """Output error of second order has the first-order rig as a special case; it is not worse, so it stays."""
    u = levels(400, 20, seed)
    y = lfilter([0.0, 0.1], [1.0, -0.9], u)
    model, errors = chosen(u, y + 0.05 * y.std() * noise(400, 9 + seed))
    assert model.method == OUTPUT_ERROR
    assert errors[OUTPUT_ERROR] < 1.05 * errors[FIRST_ORDER]


@pytest.mark.parametrize("seed", [0, 1, 3, 4, 6, 8])
def test_a_pole_that_the_record_is_too_short_to_see_is_not_chosen(seed: int) -> None:
    """Output error imitates a slow disturbance by a slow pole."""
    u = levels(200, 25, seed)
    x = lfilter([0.0, 0.1], [1.0, -0.9], u)
    disturbance = lfilter([1.0], [1.0, -0.99], noise(200, 100 + seed))
    y = x + 0.4 * x.std() / disturbance.std() * disturbance
    data = data_of(u, y)
    assert time_constants(hold_out(data, None).refit(fit_baseline(data)), 200) < OBSERVED_TIME_CONSTANTS
    model, _ = chosen(u, y)
    assert model.method != OUTPUT_ERROR
    assert not model.observed
    assert time_constants(model.fit, 200) >= OBSERVED_TIME_CONSTANTS


@pytest.mark.parametrize("seed", [0, 2, 3, 5])
def test_a_pole_of_half_the_record_is_not_chosen_even_if_it_halves_the_error(seed: int) -> None:
    u, pole = levels(300, 20, seed), np.exp(-1.0 / 600)
    y = lfilter([0.0, 0.2], [1.0, -0.8], u) + 3.0 * lfilter([0.0, 1.0 - pole], [1.0, -pole], u)
    model, errors = chosen(u, y + 0.05 * y.std() * noise(300, seed))
    assert 0.25 < errors[OUTPUT_ERROR] / min(errors[FIRST_ORDER], errors[LEAST_SQUARES]) < 0.5
    assert model.method != OUTPUT_ERROR
    assert not model.observed
    assert model.errors == pytest.approx(errors)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("poles", [[1.0, -1.0], [1.0, -1.8, 0.8], [1.0, -2.0, 1.0]])
def test_a_rig_that_integrates_its_input_keeps_its_model(poles: list[float], seed: int) -> None:
    """A position driven by a speed, by a motor with a time constant, and by a force."""
    u = levels(1200, 15, seed)
    y = lfilter([0.0, 0.1], poles, u - u.mean())
    model, errors = chosen(u, y + 0.02 * y.std() * noise(1200, seed))
    assert (model.method, model.observed) == (OUTPUT_ERROR, False)
    assert errors[OUTPUT_ERROR] == pytest.approx(0.02, rel=0.3)


def test_a_slowly_decaying_oscillation_is_observed() -> None:
    """Half a time constant of its decay is in the record, and many periods."""
    u = levels(1200, 15, 1)
    pole = np.exp(-0.0005 + 0.3j)
    y = lfilter([0.0, 0.05], np.real(np.poly([pole, np.conj(pole)])), u)
    model, errors = chosen(u, y + 0.02 * y.std() * noise(1200, 1))
    assert (model.method, model.observed) == (OUTPUT_ERROR, True)
    assert errors[OUTPUT_ERROR] == pytest.approx(0.02, rel=0.3)


@pytest.mark.parametrize("seed", [0, 1, 3, 7])
def test_least_squares_is_chosen_where_the_noise_is_that_of_its_equation(seed: int) -> None:
    """Noise that passes through the poles of the rig is white in ``y(k) = phi(k)' theta + e(k)``."""
    u = levels(300, 5, seed)
    y = lfilter([0.0, 0.03, 0.02], TWO_POLES, u) + lfilter([0.02], TWO_POLES, noise(300, seed))
    model, errors = chosen(u, y)
    assert model.method == LEAST_SQUARES
    assert errors[LEAST_SQUARES] < 0.97 * errors[OUTPUT_ERROR]


def test_first_order_recovers_its_pole() -> None:
    u = levels(300, 5, 1)
    data = data_of(u, lfilter([0.0, 0.1], [1.0, -0.9], u))
    fit = fit_first_order(data)
    assert real_rates(*fit.rates)[0] == pytest.approx(-np.log(0.9), rel=1e-3)
    np.testing.assert_allclose(fit.output, data.y, atol=1e-4)


def test_first_order_has_no_pole_slower_than_the_record_shows() -> None:
    u = levels(300, 20, 1)
    y = np.cumsum(u)
    assert time_constants(fit_first_order(data_of(u, y)), 300) >= 0.999 * OBSERVED_TIME_CONSTANTS


def test_the_simulation_of_least_squares_is_that_of_its_parameters() -> None:
    """Without noise it reproduces the record; with noise its poles are those of numpy's least squares."""
    u = levels(300, 5, 1)
    y = lfilter([0.0, 0.03, 0.02], TWO_POLES, u)
    data = data_of(u, y)
    fit = fit_arx_poles(data)
    np.testing.assert_allclose(fit.output, data.y, atol=1e-8)
    np.testing.assert_allclose(np.exp(-np.array(real_rates(*fit.rates))), [0.9, 0.7], rtol=1e-8)
    noisy = data_of(u, y + lfilter([0.02], TWO_POLES, noise(300, 1)))
    x, w = noisy.y, noisy.u
    Phi = np.column_stack([x[1:-1], x[:-2], w[1:-1], w[:-2], np.ones(298)])
    a = np.linalg.lstsq(Phi, x[2:], rcond=None)[0][:2]
    c, k = fit_arx_poles(noisy).rates
    np.testing.assert_allclose(np.sort(np.exp(-np.roots([1.0, -c, k]))), np.sort(np.roots([1.0, *-a])), rtol=1e-6)


def test_least_squares_leaves_out_the_rows_that_are_held_out() -> None:
    u = levels(300, 5, 1)
    y = lfilter([0.0, 0.03, 0.02], TWO_POLES, u)
    y[100:130] += 3.0
    rows = (np.arange(300) < 100) | (np.arange(300) >= 130)
    data = scaled(u, y, rows, 1.0)
    np.testing.assert_allclose((fit_arx_poles(data).output - data.y)[rows], 0.0, atol=1e-6)


def test_a_negative_pole_is_replaced_by_a_fast_one() -> None:
    u = levels(300, 5, 1)
    data = data_of(u, lfilter([0.0, 0.03, 0.02], np.poly([0.9, -0.4]), u))
    fit = fit_arx_poles(data)
    assert max(real_rates(*fit.rates)) == pytest.approx(FASTEST_RATE)
    assert np.sqrt(np.mean((fit.output - data.y) ** 2)) < 0.05


def test_beside_another_record_the_model_that_predicts_it_best_is_chosen() -> None:
    """A rig that integrates through a lag: its slow pole is not a drift, because it predicts the other record."""
    u, v = levels(900, 15, 1), levels(900, 15, 2)
    y, z = (lfilter([0.0, 0.1], np.poly([0.9995, 0.6]), one - 0.3) for one in (u, v))
    data = data_of(u, y + 0.1 * y.std() * noise(900, 1))
    held_out = hold_out(data, (v, z + 0.1 * y.std() * noise(900, 2)))
    model = choose_linear_model(held_out, fit_baseline(data))
    assert not model.observed
    assert model.errors[model.method] == min(model.errors.values())
    assert model.method == OUTPUT_ERROR


@searched("output-drift", "load-step", "extra-lag", "slow-mode")
def test_a_rig_with_an_integrator_and_a_pole_is_reported_with_its_own_noise() -> None:
    """As of a battery: a model of first order leaves several times the noise, though its pole shows."""
    u = levels(1200, 25, 7)
    y = np.cumsum(u) / 3000.0 + lfilter([0.0, 0.008], [1.0, -0.96], u) + 0.05 * u
    y = y + 0.002 * noise(1200, 8)
    report = diagnose(Record(np.arange(1200.0), u, y, 1.0)).report
    assert report["verdict"] == "none"
    assert report["gap"]["before"] == pytest.approx(0.002, rel=0.1)
    assert report["gap"]["noise_floor"] == pytest.approx(0.002, rel=0.1)


@pytest.mark.parametrize("integrates", [False, True])
def test_a_pole_that_a_zero_cancels_is_not_taken_for_an_integrator(integrates: bool) -> None:
    """The fit of second order to a rig of first order may have one: a load would seem to be integrated."""
    u = levels(1200, 25, 3)
    y = np.cumsum(u) / 30.0 if integrates else lfilter([0.0, 0.03], [1.0, -0.97], u)
    data = data_of(u, y + 0.02 * y.std() * noise(1200, 4))
    theta = np.array([0.0, np.log(0.0306), np.log(3e-6)])
    point = Problem(data, LINEAR).point(theta)
    assert point is not None
    fit = finish(data, LINEAR, point)
    assert time_constants(fit, 1200) < OBSERVED_TIME_CONSTANTS
    found = without_unseen_pole(data, fit)
    assert (found is fit) == integrates
    assert integrates or time_constants(found, 1200) == pytest.approx(36.5, rel=0.1)
