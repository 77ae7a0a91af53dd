"""Whiteness and input-residual tests, compared with statsmodels, and their rate of false alarms."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import chi2
from statsmodels.stats.diagnostic import acorr_ljungbox
from statsmodels.tsa.stattools import acf, ccf

from labsid.model_structures.prediction import free_run
from labsid.model_structures.residuals import autocorrelation, cross_correlation, input_residual_test, whiteness_test
from labsid.model_structures.structures import PolynomialModel, Structure, fit_structure


def white(seed, n=400):
    return np.random.default_rng(seed).standard_normal((2, n))


def test_autocorrelation_by_hand():
    # Deviations from the mean: -1, 1, -1, 1; sum of squares 4; lag 1: -3, lag 2: 2.
    result = autocorrelation([0, 2, 0, 2], lags=2, confidence=0.95)
    np.testing.assert_allclose(result.values, [1, -0.75, 0.5])
    np.testing.assert_array_equal(result.lags, [0, 1, 2])
    assert result.band == pytest.approx(1.959964 / 2)


@pytest.mark.parametrize("seed", range(3))
def test_statsmodels_agrees_on_every_lag(seed):
    u, e = white(seed)
    e = lfilter([1, 0.5], [1], e)
    np.testing.assert_allclose(autocorrelation(e, 15).values, acf(e, nlags=15, fft=False), rtol=1e-9)
    crossed = cross_correlation(u, e, 15)
    np.testing.assert_array_equal(crossed.lags, np.arange(-15, 16))
    np.testing.assert_allclose(crossed.values[15:], ccf(e, u, adjusted=False, nlags=16), atol=1e-12)
    np.testing.assert_allclose(crossed.values[15::-1], ccf(u, e, adjusted=False, nlags=16), atol=1e-12)


@pytest.mark.parametrize("parameters", [0, 2])
def test_ljung_box_is_that_of_statsmodels(parameters):
    _, e = white(1)
    oracle = acorr_ljungbox(e, lags=[12], model_df=parameters)
    result = whiteness_test(e, 12, parameters)
    assert result.statistic == pytest.approx(oracle["lb_stat"].iloc[0], rel=1e-9)
    assert result.p_value == pytest.approx(oracle["lb_pvalue"].iloc[0], rel=1e-9)
    assert result.degrees_of_freedom == 12 - parameters


def test_a_delayed_input_shows_at_its_lag_and_feedback_at_the_other_side():
    u, e = white(2)
    missed = e + np.concatenate([np.zeros(3), u[:-3]])
    assert 3 in cross_correlation(u, missed, 10).outside
    fed_back = u + np.concatenate([np.zeros(2), e[:-2]])
    assert -2 in cross_correlation(fed_back, e, 10).outside


def test_bands_hold_what_they_promise_where_the_plain_one_would_not():
    inside_white, inside_cross, inside_plain = [], [], []
    for seed in range(300):
        u, e = white(seed)
        inside_white.append(autocorrelation(e, 20).outside.size / 20)
        # Both coloured, and independent of each other.
        result = cross_correlation(lfilter([1], [1, -0.8], u), lfilter([1], [1, -0.8], e), 20)
        inside_cross.append(result.outside.size / 41)
        inside_plain.append(np.mean(np.abs(result.values) > 1.96 / 20))
    assert np.mean(inside_white) == pytest.approx(0.05, abs=0.015)
    assert np.mean(inside_cross) < 0.1
    assert np.mean(inside_plain) > 0.25


def test_p_values_are_uniform_for_a_true_model_and_small_for_a_poor_one():
    truth = PolynomialModel([1, -1.3, 0.5], [1.0, 0.4], [1])
    rejected = {"white": [], "input": [], "poor white": [], "poor input": []}
    for seed in range(300):
        u, e = white(seed)
        y = free_run(truth, u, e)
        good = fit_structure(Structure(2, 2), u, y).fit.residual
        poor = fit_structure(Structure(1, 1), u, y).fit.residual
        rejected["white"].append(whiteness_test(good, 20, 2).p_value < 0.05)
        rejected["input"].append(input_residual_test(u[2:], good, 3, 10).p_value < 0.05)
        rejected["poor white"].append(whiteness_test(poor, 20, 1).p_value < 0.05)
        rejected["poor input"].append(input_residual_test(u[1:], poor, 2, 10).p_value < 0.05)
    shares = {name: np.mean(found) for name, found in rejected.items()}
    assert 0.02 < shares["white"] < 0.1
    assert 0 < shares["input"] < 0.07
    assert shares["poor white"] > 0.9
    assert shares["poor input"] > 0.9


def test_input_residual_statistic_is_chi_square_for_a_coloured_input():
    statistics = []
    for seed in range(500):
        u, e = white(seed)
        statistics.append(input_residual_test(lfilter([1], [1, -0.9], u), e, 0, 8).statistic)
    assert np.mean(statistics) == pytest.approx(8, abs=4 * np.sqrt(16 / 500))
    assert np.mean(np.array(statistics) > chi2.ppf(0.95, 8)) == pytest.approx(0.05, abs=0.03)


def test_a_sinusoid_has_two_degrees_of_freedom_however_many_lags():
    statistics = []
    for seed in range(300):
        result = input_residual_test(np.sin(0.3 * np.arange(400)), white(seed)[1], 0, 12)
        assert result.degrees_of_freedom == 2
        statistics.append(result.statistic)
    assert np.mean(statistics) == pytest.approx(2, abs=4 * np.sqrt(4 / 300))


def test_least_squares_makes_the_lags_in_phi_vanish():
    u, e = white(5)
    y = free_run(PolynomialModel([1], [1.0, 0.5], [1, 0.9]), u, e)
    residual = fit_structure(Structure(0, 2), u, y).fit.residual
    # Sums over the rows themselves, without removing means.
    assert abs(residual @ u[1:-1]) < 1e-10
    assert abs(residual @ u[:-2]) < 1e-10
    assert whiteness_test(residual).p_value < 1e-6


def test_the_coefficients_at_the_lags_in_phi_are_small_and_not_zero():
    found = []
    for seed in range(200):
        u, e = white(seed, 200)
        y = free_run(PolynomialModel([1, -0.8], [1.0], [1]), u, e)
        residual = fit_structure(Structure(1, 1), u, y).fit.residual
        correlation = cross_correlation(u[1:], residual, 1)
        found.append(correlation.values[correlation.lags == 1][0])
    assert 0.004 < np.sqrt(np.mean(np.square(found))) < 0.012
    assert correlation.band > 0.13


U, E = white(0, 50)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: autocorrelation(E, 50), "lags must be at least 1 and less than the 50 samples; got 50"),
        (lambda: autocorrelation(E, 0), "lags must be at least 1 .* got 0"),
        (lambda: autocorrelation(np.ones(50)), "e must vary to have a correlation; got 1 throughout"),
        (lambda: autocorrelation(E, 5, 1.0), r"confidence must lie between 0 and 1; got 1\.0"),
        (lambda: cross_correlation(U[1:], E), "u and e must have equal length; got 49 and 50"),
        (lambda: whiteness_test(E, 5, 5), "parameters must lie between 0 and lags - 1 = 4; got 5"),
        (lambda: input_residual_test(U, E, -1), "first must be at least 0 and lags at least 1; got -1 and 20"),
        (lambda: input_residual_test(U, E, 2, 24), "lags must be .* less than the 50 samples; got 50"),
    ],
)
def test_arguments_out_of_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
