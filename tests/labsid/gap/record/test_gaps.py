"""Records with missing outputs: simulated through, neither fitted nor scored; their units in the report."""

from dataclasses import replace

import numpy as np
import pytest
from gap_search import searched

from labsid.cli.commands import main
from labsid.gap.diagnosis import diagnose
from labsid.records.record import Record

pytestmark = pytest.mark.usefixtures("without_limits")


@pytest.fixture(scope="module", autouse=True)
def few_effects():
    """The rivals of a limit are not what is tested here."""
    with searched("input-delay", "input-saturation", "extra-lag", "output-saturation", "load-step"):
        yield


def named(report):
    return [effect["name"] for effect in report["effects"]]


@pytest.fixture(scope="module")
def clipped(rig_record):
    return rig_record("input-saturation", 400)


@pytest.fixture
def holey(clipped):
    """The record with every 40th output missing, and a stretch of ten."""
    y = clipped.y.copy()
    y[7::40] = np.nan
    y[200:210] = np.nan
    return replace(clipped, y=y)


def test_missing_outputs_change_neither_effects_nor_parameters(clipped, holey):
    whole, report = diagnose(clipped).report, diagnose(holey).report
    (effect,), (expected,) = report["effects"], whole["effects"]
    assert effect["name"] == expected["name"] == "input-saturation"
    high, reference = effect["parameters"]["high"], expected["parameters"]["high"]
    assert high["value"] == pytest.approx(reference["value"], abs=3.0 * reference["stderr"])
    assert "y is missing in" in report["record_findings"][0]["text"]


def test_gaps_of_one_of_several_records_and_of_a_holdout_are_left_out(clipped, holey, rig_record):
    other = rig_record("input-saturation", 400)
    for report in (
        diagnose([replace(other, name="a"), replace(holey, name="b")]).report,
        diagnose(clipped, holdout=holey).report,
    ):
        assert named(report) == ["input-saturation"]
        assert report["gap"]["closed"] > 0.9
        assert any("y is missing in" in finding["text"] for finding in report["record_findings"])
    shown = report["holdout_traces"]["y"]
    assert [value is None for value in shown] == holey.missing.tolist()
    assert not any(start < holey.t[205] < stop for start, stop in report["gap"]["holdout"])


def test_a_holdout_without_outputs_where_it_is_scored_is_refused(clipped, holey):
    y = holey.y.copy()
    y[y.size // 4 + 5 : -1] = np.nan
    with pytest.raises(ValueError, match="the holdout has an output at 6 of its scored samples; at least 10 are"):
        diagnose(clipped, holdout=replace(holey, y=y))


def test_figures_show_no_output_where_there_is_none(holey):
    report = diagnose(holey).report
    assert [value is None for value in report["traces"]["y"]] == holey.missing.tolist()
    assert all(np.isfinite(report["traces"]["before"]))


def test_units_of_the_log_stand_in_the_report_and_a_replay_leaves_gaps_out(tmp_path, capsys, clipped, holey):
    rows = zip(holey.t.tolist(), holey.u.tolist(), holey.y.tolist(), strict=True)
    text = "t [s],u [V],y [rad]\n" + "".join(f"{t!r},{u!r},{'' if y != y else repr(y)}\n" for t, u, y in rows)
    (tmp_path / "log.csv").write_text(text)
    better = tmp_path / "better.json"
    assert main(["gap", "diagnose", str(tmp_path / "log.csv"), "--export", str(better)]) == 0
    said = capsys.readouterr().out
    assert "rad" in said
    assert "units of y" not in said
    assert main(["gap", "simulate", str(better), str(tmp_path / "log.csv")]) == 0
    error = float(capsys.readouterr().out.split("rmse ")[1].split()[0])
    assert 0.0 < error < 0.2 * float(np.std(clipped.y))


def test_a_record_with_gaps_can_be_used_like_any_other(holey):
    assert isinstance(holey, Record)
    assert holey.missing.sum() == np.isnan(holey.y).sum() > 10
    assert "without y" in repr(holey)
    with pytest.raises(ValueError, match="u must be finite"):
        replace(holey, u=np.where(holey.missing, np.nan, holey.u))


def test_a_record_begins_with_its_first_output(clipped):
    """Without it the samples before would be fitted to an invented state."""
    y = clipped.y.copy()
    y[:70] = y[-30:] = np.nan
    report = diagnose(replace(clipped, y=y)).report
    assert named(report) == ["input-saturation"]
    assert report["record"]["samples"] == 300
    assert report["traces"]["t"][0] == clipped.t[70]
    assert any("missing in the first 70 and the last 30 samples" in one["text"] for one in report["record_findings"])


def test_an_output_at_every_second_sample_is_diagnosed_at_its_readings(clipped):
    y = np.where(np.arange(len(clipped)) % 2, np.nan, clipped.y)
    report = diagnose(replace(clipped, y=y)).report
    assert named(report) == ["input-saturation"]
    assert "one sample in 2 only" in " ".join(report["screen"])


def test_an_output_at_uneven_distances_is_diagnosed_at_its_readings(clipped):
    there = np.cumsum(np.random.default_rng(1).integers(2, 4, len(clipped)))
    y = np.full(len(clipped), np.nan)
    y[there[there < y.size]] = clipped.y[there[there < y.size]]
    report = diagnose(replace(clipped, y=y)).report
    assert named(report) == ["input-saturation"]
    assert "one sample in 2.5" in " ".join(report["screen"])
