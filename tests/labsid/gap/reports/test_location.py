"""Where the error lies: shares add up to one, segments cover, and the right one holds most."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsid.gap.reports.location import (
    most_uneven_signal,
    operating_map,
    share_by_frequency,
    share_by_record,
    share_by_time,
    share_by_value,
    unevenness,
)

errors = arrays(float, st.integers(30, 200), elements=st.floats(-1e3, 1e3, width=32)).filter(lambda e: bool(e.any()))


@given(errors, st.integers(0, 2**31 - 1), st.floats(0.01, 10.0))
def test_segments_cover_the_record_and_their_shares_add_up_to_one(e: np.ndarray, seed: int, Ts: float) -> None:
    marked = np.random.default_rng(seed).random(e.size) < 0.1
    t = 3.0 + Ts * np.arange(e.size)
    segments = share_by_time(t, e, Ts, marked)
    starts, stops, shares = np.array(segments).T
    assert starts[0] == t[0]
    assert stops[-1] == pytest.approx(t[-1] + Ts)
    np.testing.assert_allclose(starts[1:], stops[:-1])
    assert np.all(stops > starts)
    assert shares.sum() == pytest.approx(1.0)
    assert np.all(shares >= 0.0)


@given(errors, st.floats(0.01, 10.0))
def test_bands_reach_to_the_nyquist_frequency_and_their_shares_add_up_to_one(e: np.ndarray, Ts: float) -> None:
    low, high, share = np.array(share_by_frequency(e, Ts)).T
    assert low[0] == 0.0
    assert high[-1] == pytest.approx(0.5 / Ts)
    np.testing.assert_allclose(low[1:], high[:-1])
    assert share.sum() == pytest.approx(1.0)


@given(errors, st.integers(0, 2**31 - 1))
def test_cells_cover_the_range_and_their_shares_add_up_to_one(e: np.ndarray, seed: int) -> None:
    x = np.random.default_rng(seed).standard_normal(e.size)
    cells = share_by_value("y", x, e)
    assert [cell["signal"] for cell in cells] == ["y"] * 6
    assert cells[0]["low"] == x.min()
    assert cells[-1]["high"] == pytest.approx(x.max())
    assert all(a["high"] == b["low"] for a, b in pairwise(cells))
    assert sum(cell["share"] for cell in cells) == pytest.approx(1.0)
    assert sum(cell["time"] for cell in cells) == pytest.approx(1.0)
    assert 0.0 <= unevenness(cells) <= 1.0 + 1e-9


def test_marked_stretches_are_segments_of_their_own() -> None:
    e, marked = np.zeros(100), np.zeros(100, bool)
    marked[20:30] = marked[70:] = True
    e[20:30], e[70:] = 3.0, 1.0
    segments = share_by_time(np.arange(100.0), e, 1.0, marked)
    assert [segment[:2] for segment in segments] == [[0.0, 20.0], [20.0, 30.0], [30.0, 70.0], [70.0, 100.0]]
    np.testing.assert_allclose([segment[2] for segment in segments], [0.0, 0.75, 0.0, 0.25])


@pytest.mark.parametrize("marked", [np.zeros(240, bool), np.ones(240, bool), np.arange(240) % 2 == 0])
def test_segments_are_of_equal_length_without_distinct_stretches(marked: np.ndarray) -> None:
    assert np.count_nonzero(np.diff(marked.astype(int))) in (0, 239)
    segments = share_by_time(np.arange(240.0), np.ones(240), 1.0, marked)
    assert [stop - start for start, stop, _ in segments] == [20.0] * 12


def test_a_sinusoid_lies_in_its_band() -> None:
    e = np.sin(2.0 * np.pi * 0.3 * 0.5 * np.arange(400))
    bands = share_by_frequency(e, 0.5)
    low, high, share = max(bands, key=lambda band: band[2])
    assert low <= 0.3 < high
    assert share > 0.95


@pytest.mark.parametrize("samples", [400, 401])
def test_a_constant_and_a_sinusoid_of_its_power_share_equally(samples: int) -> None:
    e = 1.0 + np.sqrt(2.0) * np.sin(2.0 * np.pi * 0.3 * np.arange(samples))
    assert share_by_frequency(e, 1.0)[0][2] == pytest.approx(0.5, abs=0.01)


def test_a_constant_error_lies_in_the_lowest_band() -> None:
    assert share_by_frequency(np.ones(101), 1.0)[0][2] == pytest.approx(1.0)


def test_the_most_uneven_signal_is_the_one_at_which_the_error_concentrates() -> None:
    rng = np.random.default_rng(2)
    u = np.repeat(rng.uniform(-1.0, 1.0, 60), 10)
    y = np.cumsum(rng.standard_normal(600)) / 10.0
    noise = 0.01 * rng.standard_normal(600)
    assert most_uneven_signal(u, y, 0.1, noise + (u > 0.6))[0]["signal"] == "u"
    assert most_uneven_signal(u, y, 0.1, noise + (y > np.quantile(y, 0.9)))[0]["signal"] == "y"
    cells = most_uneven_signal(u, y, 0.1, noise + (u > 0.6))
    assert max(cells, key=lambda cell: float(cell["share"]))["high"] == pytest.approx(u.max())


def test_an_even_error_is_concentrated_nowhere() -> None:
    x = np.linspace(0.0, 1.0, 600)
    assert unevenness(share_by_value("u", x, np.ones(600))) < 0.01
    assert unevenness(share_by_value("u", x, (x > 5 / 6).astype(float))) == pytest.approx(5 / 6, abs=0.01)


def test_the_map_covers_the_whole_error_and_unvisited_cells_are_empty() -> None:
    rng = np.random.default_rng(0)
    u, e = np.repeat([0.0, 1.0, 2.0], 50), rng.standard_normal(150)
    y = u + 0.1 * rng.standard_normal(150)
    seen = operating_map(u, y, e)
    count = np.histogram2d(u, y, (seen["u"], seen["y"]))[0]
    rms = np.array(seen["rms"], float)
    assert rms.shape == (14, 14)
    np.testing.assert_array_equal(np.isnan(rms), count == 0)
    assert float(np.nansum(rms**2 * count)) == pytest.approx(float(e @ e))


def test_the_gap_is_shared_out_by_record() -> None:
    rows = [{"name": "a", "start": 0.0, "samples": 100}, {"name": "b", "start": 60.0, "samples": 80}]
    segments = [[0.0, 40.0, 0.3], [40.0, 60.0, 0.2], [60.0, 100.0, 0.5]]
    first, second = share_by_record(segments, rows, 0.5)
    assert (first["name"], second["name"]) == ("a", "b")
    assert (first["share"], second["share"]) == pytest.approx((0.4 / 0.9, 0.5 / 0.9))
    assert (first["time"], second["time"]) == pytest.approx((5 / 9, 4 / 9))
