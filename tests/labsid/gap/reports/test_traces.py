"""Points of a figure of a long record: limited in number, ordered, with every spike."""

import numpy as np
import pytest

from labsid.gap.reports.traces import extreme_samples, figure_traces


def test_a_short_record_is_shown_completely() -> None:
    x = np.random.default_rng(0).standard_normal(2400)
    np.testing.assert_array_equal(extreme_samples([x]), np.arange(2400))


@pytest.mark.parametrize("samples", [2401, 20_000, 54_321])
def test_spikes_of_long_records_are_shown(samples: int) -> None:
    rng = np.random.default_rng(samples)
    y, after = rng.standard_normal(samples), 0.1 * rng.standard_normal(samples)
    before = np.zeros(samples)
    spikes = np.arange(1, 20) * samples // 20
    y[spikes] += 100.0
    before[1234] = -70.0  # an error of +70, far from any spike
    shown = figure_traces(0.5 * np.arange(samples), np.ones(samples), y, before, after)
    assert len({len(x) for x in shown.values()}) == 1
    assert len(shown["t"]) <= 2400
    assert np.all(np.diff(shown["t"]) > 0.0)
    kept = np.round(np.array(shown["t"]) / 0.5).astype(int)
    assert {1234, *spikes.tolist()} <= set(kept.tolist())
    np.testing.assert_array_equal(shown["y"], y[kept])
    np.testing.assert_array_equal(shown["before"], before[kept])


def test_every_stretch_shows_its_minimum_and_maximum() -> None:
    x = np.sin(np.arange(10_000) / 3.0)
    pick = extreme_samples([x], 400)
    assert pick.size <= 400
    for own in np.array_split(np.arange(x.size), 200):
        shown = np.intersect1d(pick, own)
        assert x[shown].max() == x[own].max()
        assert x[shown].min() == x[own].min()
