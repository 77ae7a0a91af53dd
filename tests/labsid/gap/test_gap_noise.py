"""Autoregressions of a residual, against statsmodels."""

import numpy as np
import pytest
from scipy.signal import lfilter
from statsmodels.tsa.ar_model import AutoReg

from labsid.gap.noise import LONGEST, ORDERS, fit_noise, whole_rows


def coloured(*ar: float, samples: int = 2000, seed: int = 1) -> np.ndarray:
    """e(k) = ar[0] e(k-1) + ... + white noise of standard deviation 0.3."""
    return lfilter([1.0], [1.0, *-np.array(ar)], 0.3 * np.random.default_rng(seed).standard_normal(samples))


@pytest.mark.parametrize("order", [1, 2, 4, 8])
def test_the_autoregression_is_that_of_statsmodels(order: int) -> None:
    e = coloured(1.2, -0.5)
    found = fit_noise(e, whole_rows(np.ones(e.size, bool)), (order,))
    # The first LONGEST samples are only looked back to, whatever the order: so that orders can be compared.
    expected = AutoReg(e, order, trend="n", hold_back=LONGEST).fit()
    np.testing.assert_allclose(found.ar, expected.params, rtol=1e-5, atol=1e-6)
    assert found.sigma2 == pytest.approx(expected.sigma2, rel=1e-6)
    assert found.rows == e.size - LONGEST
    assert found.score == pytest.approx(found.rows * np.log(found.sigma2) + order * np.log(found.rows))


@pytest.mark.parametrize(("ar", "order"), [((), 0), ((0.8,), 1), ((1.2, -0.5), 2)])
def test_the_order_is_that_of_the_noise(ar: tuple[float, ...], order: int) -> None:
    e = coloured(*ar)
    found = fit_noise(e, whole_rows(np.ones(e.size, bool)))
    assert found.ar.size == order
    np.testing.assert_allclose(found.ar, ar, atol=0.06)
    assert found.sigma2 == pytest.approx(0.09, rel=0.1)


def test_the_best_order_has_the_best_score() -> None:
    e, sound = coloured(1.5, -0.9, 0.3), whole_rows(np.ones(2000, bool))
    least = min(fit_noise(e, sound, (order,)).score for order in ORDERS)
    assert fit_noise(e, sound).score == pytest.approx(least, rel=1e-9)


def test_rows_that_do_not_count_do_not_pull() -> None:
    e, rows = coloured(0.8), np.ones(2000, bool)
    rows[500:700] = False
    spoilt = np.where(rows, e, 50.0)
    assert fit_noise(spoilt, whole_rows(rows)).sigma2 == pytest.approx(0.09, rel=0.1)
    assert fit_noise(spoilt, whole_rows(np.ones(2000, bool))).sigma2 > 1.0


def test_whole_rows_by_hand() -> None:
    rows = np.ones(12, bool)
    rows[5] = False
    expected = np.array([0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1, 1], bool)
    np.testing.assert_array_equal(whole_rows(rows, 2), expected)
    assert rows[6]  # what was given stays as it was
