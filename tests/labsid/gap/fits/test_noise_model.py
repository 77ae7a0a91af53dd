"""Autoregressions of a residual, against statsmodels."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from statsmodels.tsa.ar_model import AutoReg

from labsid.gap.fits.linear_fits import fit_baseline
from labsid.gap.fits.noise_model import fit_noise
from labsid.gap.record.data import complete_rows, scaled, usable_lags


def coloured(*ar: float, samples: int = 2000, seed: int = 1) -> np.ndarray:
    """e(k) = ar[0] e(k-1) + ... + white noise of standard deviation 0.3."""
    return lfilter([1.0], [1.0, *-np.array(ar)], 0.3 * np.random.default_rng(seed).standard_normal(samples))


@pytest.mark.parametrize("ar", [(0.8,), (1.2, -0.5), (1.5, -0.9, 0.3)])
@pytest.mark.parametrize("lags", [1, 2, 4, 8])
def test_the_autoregression_is_the_best_of_statsmodels_up_to_so_many_lags(lags: int, ar: tuple[float, ...]) -> None:
    e = coloured(*ar)
    found = fit_noise(e, complete_rows(np.ones(e.size, bool)), lags)
    scores = {}
    for order in (order for order in (0, 1, 2, 3, 4, 6, 8) if order <= lags):
        # The first 8 samples are only looked back to, whatever the order: so that orders can be compared.
        fit = AutoReg(e, order, trend="n", hold_back=8).fit()
        sigma2 = float(np.mean(fit.resid**2)) if order else float(np.mean(e[8:] ** 2))
        scores[order] = (found.rows * np.log(sigma2) + order * np.log(found.rows), fit.params, sigma2)
    score, params, sigma2 = min(scores.values(), key=lambda item: item[0])
    np.testing.assert_allclose(found.ar, params, rtol=1e-5, atol=1e-6)
    assert found.sigma2 == pytest.approx(sigma2, rel=1e-6)
    assert found.rows == e.size - 8
    assert found.score == pytest.approx(score)


@pytest.mark.parametrize(("ar", "order"), [((), 0), ((0.8,), 1), ((1.2, -0.5), 2)])
def test_the_order_is_that_of_the_noise(ar: tuple[float, ...], order: int) -> None:
    e = coloured(*ar)
    found = fit_noise(e, complete_rows(np.ones(e.size, bool)))
    assert found.ar.size == order
    np.testing.assert_allclose(found.ar, ar, atol=0.06)
    assert found.sigma2 == pytest.approx(0.09, rel=0.1)


def test_rows_that_do_not_count_do_not_pull() -> None:
    e, rows = coloured(0.8), np.ones(2000, bool)
    rows[500:700] = False
    spoilt = np.where(rows, e, 50.0)
    assert fit_noise(spoilt, complete_rows(rows)).sigma2 == pytest.approx(0.09, rel=0.1)
    assert fit_noise(spoilt, complete_rows(np.ones(2000, bool))).sigma2 > 1.0


def test_whole_rows_by_hand() -> None:
    rows = np.ones(12, bool)
    rows[5] = False
    expected = np.array([0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1, 1], bool)
    np.testing.assert_array_equal(complete_rows(rows, 2), expected)
    assert rows[6]  # what was given stays as it was


def gapped(period: int) -> np.ndarray:
    """2000 rows; every `period`-th is excluded."""
    rows = np.ones(2000, bool)
    rows[::period] = False
    return rows


@pytest.mark.parametrize(("period", "lags"), [(3000, 8), (40, 8), (9, 4), (6, 4), (5, 2), (4, 2), (3, 1), (2, 0)])
def test_lags_are_as_many_as_there_are_good_samples_in_a_row(period: int, lags: int) -> None:
    assert usable_lags(gapped(period)) == lags


def test_a_few_good_samples_in_a_row_are_enough_if_they_are_a_tenth() -> None:
    """Of 300 consecutive rows, 292 have eight predecessors; of the alternating rest, none has one."""
    rows = gapped(2)
    rows[:300] = True
    assert complete_rows(rows).sum() > 0.1 * rows.sum()
    assert usable_lags(rows) == 8
    rows = gapped(2)
    rows[:80] = True
    assert usable_lags(rows) == 0  # most rows count, as white noise


def test_rows_of_which_none_follows_another_have_white_noise() -> None:
    rows = gapped(2)
    e = np.where(rows, np.random.default_rng(2).normal(0.0, 0.3, rows.size), 50.0)
    found = fit_noise(e, complete_rows(rows, 0), 0)
    assert found.sigma2 == pytest.approx(0.09, rel=0.15)
    assert (found.ar.size, found.rows) == (0, 1000)


@pytest.mark.parametrize("period", [6, 4])
def test_noise_between_many_gaps_is_fitted_with_fewer_lags(period: int) -> None:
    rows = gapped(period)
    e, lags = np.where(rows, coloured(0.8), 50.0), usable_lags(rows)
    with pytest.raises(ValueError, match="only 0 samples follow 8 used samples"):
        fit_noise(e, complete_rows(rows))
    found = fit_noise(e, complete_rows(rows, lags), lags)
    assert found.sigma2 == pytest.approx(0.09, rel=0.2)
    assert found.ar[0] == pytest.approx(0.8, abs=0.15)


def test_a_record_knows_its_lags(levels: np.ndarray) -> None:
    rows = gapped(4)[: levels.size]
    data = scaled(levels, np.cumsum(levels), rows, 1.0)
    assert data.lags == 2
    np.testing.assert_array_equal(data.complete, complete_rows(rows, 2))
    whole = replace(data, rows=np.ones(levels.size, bool))
    assert whole.lags == 8
    np.testing.assert_array_equal(whole.complete, np.arange(levels.size) >= 8)


def test_a_record_with_many_gaps_is_fitted(levels: np.ndarray, two_poles: Callable[..., np.ndarray]) -> None:
    rows = gapped(4)[: levels.size]
    y = two_poles(levels) + 0.02 * np.random.default_rng(1).standard_normal(levels.size)
    fit = fit_baseline(scaled(levels, np.where(rows, y, 9.0), rows, 1.0))
    np.testing.assert_allclose(fit.rates, [0.5, 0.05], rtol=0.3)
    assert np.sqrt(fit.noise.sigma2) * np.std(np.where(rows, y, 9.0)) == pytest.approx(0.02, rel=0.15)


def test_a_fit_looks_no_further_back_than_its_record_allows(
    levels: np.ndarray, two_poles: Callable[..., np.ndarray]
) -> None:
    """Excluded rows must not be read."""
    noise = 0.1 * coloured(1.5, -0.9, 0.3, samples=levels.size)
    orders = []
    for rows in (np.ones(levels.size, bool), gapped(4)[: levels.size]):
        data = scaled(levels, two_poles(levels) + noise, rows, 1.0)
        orders.append(fit_baseline(data).noise.ar.size)
    assert orders[0] > 2
    assert orders[1] <= 2


def test_the_noise_between_the_readings_of_a_slow_sensor_is_not_looked_at():
    e = coloured(0.8)
    slow = np.full(5 * e.size, 50.0)
    slow[::5] = e
    rows = np.arange(slow.size) % 5 == 0
    one, other = fit_noise(e, complete_rows(rows[::5])), fit_noise(slow, complete_rows(rows, 8, 5), 8, 5)
    assert (one.score, one.sigma2, one.rows) == (other.score, other.sigma2, other.rows)
    np.testing.assert_array_equal(other.ar[4::5], one.ar)
    assert np.count_nonzero(other.ar) == one.ar.size
    assert other.correlation_time == pytest.approx(5 * one.correlation_time)


def test_fewer_lags_leave_enough_rows():
    rows = np.zeros(400, bool)
    rows[:28] = rows[50:230:4] = True
    assert complete_rows(rows, 8).sum() == 20
    rows[27] = False
    assert usable_lags(rows) == 4
