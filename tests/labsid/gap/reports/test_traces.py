"""Points of a figure of a long record: limited in number, ordered, with every spike."""

from typing import Any

import numpy as np
import pytest

from labsid.gap.reports.traces import extreme_samples, figure_traces, packed, record_at, worst_stretch


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


def _replayed(before: np.ndarray, names: tuple[str, ...] = ()) -> dict[str, Any]:
    """A report that replays a record whose output is zero; the simulation before is NaN between several records."""
    u = np.arange(float(before.size))
    part = {"start": 10.0, "Ts": 0.5, "u": packed(u, "<f8"), "y": packed(np.zeros(u.size))}
    part |= {"before": packed(before), "after": packed(before), "fitted": [[0, before.size]], "scored": []}
    replay = {"record": part, "y_scale": {"centre": 2.0, "unit": 3.0}}
    return {"replay": replay, "records": [{"name": name} for name in names]}


def test_the_worst_stretch_has_all_samples_of_it_in_the_units_of_the_record() -> None:
    before = np.zeros(20_000)
    before[15_000:15_100] = 0.5
    found = worst_stretch(_replayed(before), "record")
    assert found is not None
    assert found["t"].size == 400
    assert found["t"][0] <= 10.0 + 0.5 * 15_000
    assert found["t"][-1] >= 10.0 + 0.5 * 15_099
    np.testing.assert_array_equal(np.unique(found["before"]), [2.0, 3.5])
    assert worst_stretch({"replay": None}, "record") is None


def test_the_worst_stretch_lies_within_one_of_several_records_and_has_its_time() -> None:
    before = np.zeros(1000)
    before[480:500], before[520:540] = 1.0, 1.0
    before[500:520] = np.nan
    shown = _replayed(before, ("first", "second"))
    found = worst_stretch(shown, "record")
    assert found is not None
    assert np.isfinite(found["before"]).all()
    assert record_at(shown, 10.0 + 0.5 * 499) == ("first", 10.0)
    assert record_at(shown, 10.0 + 0.5 * 530) == ("second", 10.0 + 0.5 * 520)
    assert record_at(_replayed(before), 12.0) == ("", 0.0)
