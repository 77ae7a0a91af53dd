"""Records with clock jitter: reading, reporting, and matching the sampling time of a simulation or holdout."""

import json
import re

import numpy as np
import pytest
from gap_search import run_here, searched

from labsid.cli.commands import main
from labsid.gap.batches import batch
from labsid.gap.batches.batch import diagnose_folder
from labsid.gap.diagnosis import diagnose
from labsid.gap.record.clock import at_sampling_time, clock_findings
from labsid.gap.reports.html_report import page_content
from labsid.gap.reports.text_report import format_report
from labsid.gap.simulations.simulation_files import load_simulation, replay
from labsid.records.reading import Reading
from labsid.records.record import Record, load_record

pytestmark = pytest.mark.usefixtures("without_limits")

DEN = np.poly([0.95, 0.8]).tolist()


@pytest.fixture(scope="module", autouse=True)
def few_effects():
    """What the clock changes does not depend on the others."""
    with searched("input-delay", "input-saturation", "extra-lag", "output-saturation", "load-step"):
        yield


@pytest.fixture(scope="module")
def clipped(rig_record):
    return rig_record("input-saturation", 400)


@pytest.fixture(scope="module")
def plain(rig_record):
    return rig_record("none", 200)


def write(path, record, stamps):
    rows = zip(stamps.tolist(), record.u.tolist(), record.y.tolist(), strict=True)
    path.write_text("t,u,y\n" + "".join(f"{t!r},{u!r},{y!r}\n" for t, u, y in rows))
    return path


def shaken(record, share=0.03, seconds=1.0):
    """Sampling instants with jitter, in units of `seconds`: clipped, because one far off would not be even."""
    off = share * record.Ts * np.random.default_rng(0).standard_normal(len(record)).clip(-1.55, 1.55)
    return (record.t + off) / seconds


def jittering(record, Ts=None, jitter=0.03):
    Ts = record.Ts if Ts is None else Ts
    return Record(Ts * np.arange(len(record)), record.u, record.y, Ts, jitter=jitter)


@pytest.fixture(scope="module")
def even_report(clipped):
    return diagnose(clipped).report


def test_clock_jitter_changes_neither_effects_nor_parameters(tmp_path, clipped, even_report):
    seconds = 60.0
    path = write(tmp_path / "record.csv", clipped, shaken(clipped, seconds=seconds))
    report = diagnose(load_record(path)).report
    assert report["record"]["Ts"] == pytest.approx(0.5 / seconds, rel=1e-9)
    (effect,) = report["effects"]
    (expected,) = even_report["effects"]
    assert effect["name"] == expected["name"] == "input-saturation"
    assert effect["parameters"]["high"]["value"] == pytest.approx(expected["parameters"]["high"]["value"], rel=1e-6)
    assert report["record_findings"][0]["topic"] == "sampling"


def test_text_and_page_report_clock_jitter(even_report, clipped):
    (finding,) = clock_findings(jittering(clipped, 1 / 30))
    assert "sampling" not in [one["topic"] for one in even_report["record_findings"]]
    report = even_report | {"record_findings": [{"topic": finding.topic, "text": finding.text}]}
    said = (
        "The clock jitters by 3 % of the sampling time (root mean square); the record is read as if it were sampled "
        "every 0.03333 s."
    )
    assert said in " ".join(format_report(report).split())
    assert page_content(report)["record"] == [said]


def test_small_jitter_is_not_reported_and_the_holdout_is_checked_separately(plain):
    assert clock_findings(jittering(plain, jitter=0.009), plain) == []
    (finding,) = clock_findings(plain, jittering(plain, jitter=0.052))
    assert finding.text.startswith("the clock of the holdout jitters by 5.2% of the sampling time")
    assert "the holdout is read as if it were sampled every 0.5 s" in finding.text


def test_a_jittering_clock_takes_a_sampling_time_within_one_sample_over_the_record(plain):
    record = jittering(plain, 0.501)
    near = at_sampling_time(record, 0.5)
    assert (near.Ts, near.jitter) == (0.5, 0.03)
    np.testing.assert_allclose(near.t, 0.5 * np.arange(200), rtol=1e-12)
    for other in (0.495, 0.51, float("nan"), "0.5", None, [0.5]):
        assert at_sampling_time(record, other) is record
    regular = Record(record.t, record.u, record.y, 0.501)
    assert at_sampling_time(regular, 0.5) is regular


def test_a_holdout_model_and_series_of_nearly_the_same_sampling_time_are_accepted(tmp_path, plain):
    start = float(plain.u[0])
    model = {"num": [0.01, 0.0], "den": DEN, "dt": 0.5, "u0": start, "y0": start}
    other = jittering(plain, 0.4995)
    report = diagnose(jittering(plain, 0.501), model, holdout=other).report
    assert report["record"]["Ts"] == 0.5
    assert report["holdout_traces"] is not None
    found = diagnose(jittering(plain, 0.501), holdout=plain)
    assert found.report["record"]["Ts"] == 0.5
    assert diagnose(jittering(plain, 0.501), found.model).report["record"]["Ts"] == 0.5
    path = tmp_path / "model.json"
    path.write_text(json.dumps(model))
    np.testing.assert_array_equal(replay(path, other).y, replay(path, plain).y)
    with pytest.raises(ValueError, match="dt must be the record's sampling time"):
        replay(path, jittering(plain, 0.51))
    series = tmp_path / "sim.csv"
    rows = zip((plain.t + 0.14).tolist(), plain.y.tolist(), strict=True)
    series.write_text("t,y\n" + "".join(f"{t!r},{y!r}\n" for t, y in rows))
    np.testing.assert_array_equal(load_simulation(series, jittering(plain)).y, plain.y)
    assert load_simulation(series, plain).resampled


def test_the_command_line_accepts_a_jittering_holdout(tmp_path, capsys, plain, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write(tmp_path / "record.csv", plain, shaken(plain))
    write(tmp_path / "other.csv", plain, shaken(plain, 0.06))
    assert main(["gap", "diagnose", "record.csv", "--holdout", "other.csv", "--export", "better.json"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert re.search(r"The clock jitters by (3|2\.\d) % of the sampling time", said)
    assert re.search(r"The clock of the holdout jitters by (6|5\.\d) % of the sampling time", said)
    assert main(["gap", "simulate", "better.json", "other.csv"]) == 0
    assert "note: the clock jitters by " in capsys.readouterr().out
    write(tmp_path / "gap.csv", plain, plain.t + np.where(np.arange(200) < 100, 0.0, 50.0))
    for arguments in (["diagnose", "gap.csv"], ["simulate", "better.json", "gap.csv"]):
        assert main(["gap", *arguments]) == 2
        assert "sampling is irregular: 0.5 s as a rule, but 50.5 s from sample 99" in capsys.readouterr().err


def test_a_batch_accepts_jittering_records(tmp_path, plain, monkeypatch):
    monkeypatch.setattr(batch, "run_tasks", run_here)
    write(tmp_path / "a.csv", plain, shaken(plain))
    write(tmp_path / "a.holdout.csv", plain, shaken(plain, 0.06))
    write(tmp_path / "b.csv", plain, shaken(plain, 0.5))
    diagnose_folder(tmp_path, tmp_path / "out", jobs=1)
    answers = {name: json.loads((tmp_path / "out" / f"{name}.json").read_text()) for name in "ab"}
    assert answers["a"]["verdict"] == "none"
    topics = [finding["topic"] for finding in answers["a"]["record_findings"]]
    assert topics.count("sampling") == 2
    assert answers["b"]["verdict"] == "error"


def test_a_batch_reads_logs_with_the_options_of_a_record(tmp_path, plain, monkeypatch):
    monkeypatch.setattr(batch, "run_tasks", run_here)
    path = write(tmp_path / "a.csv", plain, shaken(plain, 0.15))
    path.write_text(path.read_text().replace("t,u,y", "clock,pump,level"))
    diagnose_folder(tmp_path, tmp_path / "out", jobs=1, how=Reading(columns="clock,pump,level", Ts=plain.Ts))
    answer = json.loads((tmp_path / "out" / "a.json").read_text())
    assert answer["verdict"] == "none"
    assert "jitters by 1" in answer["record_findings"][0]["text"]
