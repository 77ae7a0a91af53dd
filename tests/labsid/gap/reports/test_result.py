"""The result of a diagnosis in a script and in a notebook."""

import html
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from gap_search import searched
from scipy.signal import lfilter

from labsid import diagnose
from labsid._arrays import FloatArray
from labsid.gap.reports.html_report import render_html
from labsid.gap.reports.replay_data import ReplayData
from labsid.gap.reports.result import Diagnosis
from labsid.gap.reports.text_report import format_report
from labsid.records.record import Record


@pytest.fixture(scope="module")
def record(levels: FloatArray) -> Record:
    u = np.asarray(levels)
    clipped = np.clip(u, np.quantile(u, 0.2), np.quantile(u, 0.8))
    y = np.zeros(u.size)
    for k in range(1, u.size):
        y[k] = 0.9 * y[k - 1] + 0.1 * clipped[k - 1]
    noise = 0.01 * np.std(y) * np.random.default_rng(4).standard_normal(u.size)
    return Record(0.5 * np.arange(u.size), u, y + noise, 0.5, name="clipped")


@pytest.fixture(scope="module")
def result(record: Record) -> Diagnosis:
    """By a search for few effects."""
    with searched("input-saturation", "input-nonlinearity", "output-saturation", "load-step"):
        return diagnose(record)


def test_it_says_what_was_found(result: Diagnosis) -> None:
    assert result.verdict == "effect"
    assert list(result.effects) == ["input-saturation"]
    assert set(result.effects["input-saturation"]) == {"low", "high"}
    assert re.fullmatch(
        r"<Diagnosis: effect: input-saturation \(p = [01].\d\d\); rms error \S+ before, \S+ after, \d+% of the gap "
        r"closed>",
        repr(result),
    )
    assert str(result) == format_report(result.report)
    assert result.ranking[0]["name"] == "input-saturation"


def test_the_ranking_is_a_table_in_pandas(result: Diagnosis) -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(result.ranking)
    assert {"name", "probability", "rmse", "closed"} <= set(table.columns)
    assert list(table["probability"]) == [one["probability"] for one in result.report["ranking"]]


@pytest.mark.usefixtures("undrawn")
def test_a_notebook_shows_the_page(result: Diagnosis) -> None:
    shown = result._repr_html_()
    (page,) = re.findall(r'srcdoc="([^"]*)"', shown)
    assert html.unescape(page) == render_html(result.report)


def test_what_a_page_replays_is_made_for_a_page_only(result: Diagnosis) -> None:
    """Once, whoever asks for it; the text and the fields of the result do not."""
    made: list[dict[str, Any]] = []

    def make() -> dict[str, Any]:
        made.append({"record": len(made)})
        return made[-1]

    fresh = replace(result, replay=ReplayData(make)).with_summary(result.summary | {"command": "labsid"})
    assert (str(fresh), repr(fresh), fresh.verdict) == (str(result), repr(result), "effect")
    assert fresh.effects == result.effects
    assert fresh.ranking == result.ranking
    assert made == []
    assert fresh.report["replay"] == fresh.report["replay"] == {"record": 0}
    assert len(made) == 1
    assert list(fresh.report) == [*result.report, "command"]
    assert fresh.report["command"] == "labsid"
    assert result.report["replay"]["accepted"] == ["input-saturation"]


@searched("input-saturation")
@pytest.mark.parametrize("given", [True, False])
def test_only_a_simulation_that_is_run_is_replayed_at_once(
    record: Record, given: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its runs belong to those that the report counts, and no later look at the result runs it again."""
    made: list[dict[str, Any]] = []

    def replay_content(*_: object) -> dict[str, Any]:
        made.append({"record": {}})
        return made[-1]

    def simulate(t: FloatArray, u: FloatArray) -> FloatArray:
        return np.asarray(lfilter([0.0, 0.1], [1.0, -0.9], u))

    monkeypatch.setattr("labsid.gap.diagnosis.replay_content", replay_content)
    found = diagnose(record, simulate if given else None, evaluations=100 if given else None)
    assert len(made) == given
    assert found.report["replay"] == {"record": {}}
    assert len(made) == 1


def test_the_better_simulation_can_be_run(result: Diagnosis, record: Record) -> None:
    y = result.better(record.t, record.u, record.y)
    assert np.sqrt(np.mean((y - record.y)[50:] ** 2)) == pytest.approx(result.report["gap"]["after"], rel=0.2)
    np.testing.assert_array_equal(result.better(list(record.t), list(record.u), list(record.y)), y)
    with pytest.raises(ValueError, match=r"vectors of one length, .* got shapes \[\(\d+,\), \(3,\)\]"):
        result.better(record.t, record.u[:3])
    with pytest.raises(ValueError, match=r"runs at 0.5 s, the times at 1 s"):
        result.better(2.0 * record.t, record.u)


def test_the_figure_is_that_of_the_page(result: Diagnosis) -> None:
    figure = result.plot()
    assert figure.axes[0].get_ylabel().startswith("Output")
