"""Points of a figure of a long record: limited in number, ordered, with every spike."""

from typing import Any

import numpy as np
import pytest

from labsid.gap.reports.traces import (
    extreme_samples,
    figure_traces,
    packed,
    record_traces,
    worst_of_records,
    worst_stretch,
)


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


def _replayed(before: np.ndarray) -> dict[str, Any]:
    """A report that replays a record whose output is zero."""
    u = np.arange(float(before.size))
    part = {"start": 10.0, "Ts": 0.5, "u": packed(u, "<f8"), "y": packed(np.zeros(u.size))}
    part |= {"before": packed(before), "after": packed(before), "fitted": [[0, before.size]], "scored": []}
    replay = {"record": part, "y_scale": {"centre": 2.0, "unit": 3.0}}
    return {"replay": replay}


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


def _of_two_records() -> dict[str, Any]:
    """A report of two records, of 100 and 80 samples at 0.5 s, with 20 samples between them."""
    t = 0.5 * np.concatenate([np.arange(100), np.arange(120, 200)])
    y, after = np.zeros(t.size), np.full(t.size, 0.1)
    before = np.where(t < 5.0, 9.0, np.where(t >= 90.0, 2.0, 0.5))
    rows = [{"name": "first", "start": 0.0, "samples": 100, "unscored": 10}]
    rows += [{"name": "second", "start": 60.0, "samples": 80, "unscored": 10}]
    return {"traces": figure_traces(t, t, y, before, after), "records": rows, "record": {"Ts": 0.5}}


def test_each_record_has_its_own_time_and_its_first_samples_are_not_scored() -> None:
    first, second = record_traces(_of_two_records())
    np.testing.assert_allclose(first["t"], 0.5 * np.arange(100))
    np.testing.assert_allclose(second["t"], 0.5 * np.arange(80))
    np.testing.assert_array_equal(second["u"], second["t"] + 60.0)
    for own in (first, second):
        np.testing.assert_array_equal(own["counts"], np.arange(own["t"].size) >= 10)


def test_the_worst_stretch_of_several_records_is_that_of_one_of_them() -> None:
    name, start, stretch = worst_of_records(_of_two_records())  # 9 before 5 s is in samples that are not scored
    assert (name, start, stretch["t"].size) == ("second", 60.0, 40)
    assert stretch["t"][-1] == pytest.approx(39.5)
    assert stretch["before"][-1] == 2.0
