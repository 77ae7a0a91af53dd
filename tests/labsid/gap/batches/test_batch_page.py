"""The summary page of a batch, and the pages of its records."""

import base64
import hashlib
import html
import json
import os
import re

import pytest
from gap_reports import report, with_rest
from signals_reports import signals_report, with_planned_inputs

from labsid.gap.batches import batch_page
from labsid.gap.batches.batch_page import batch_page_content, render_batch_page, write_batch_page, write_record_pages
from labsid.gap.reports.html_report import render_html

HOSTILE = "<script>alert('&\"')</script>"


def with_errors(found, after, closed):
    """The report with an error after of so many times the noise, and another closed share."""
    gap = found["gap"]
    return found | {"gap": gap | {"after": after * gap["noise_floor"], "closed": closed}}


def error(message):
    return {"schema": "labsid.gap/4", "verdict": "error", "message": message}


REPORTS = {
    "a": with_errors(report("input-delay"), 2.0, 0.9),
    "b": with_rest(report(verdict="unknown"), "disturbance"),
    "c": with_errors(report("input-delay", "load-step"), 3.0, 0.4),
    "d": report(verdict="none"),
    "e": with_errors(with_rest(report("resonance", verdict="partial"), "input"), 3.0, 0.2),
    "f": error("f.csv is empty: a record needs at least two samples of u and y."),
}
LINKS = {stem: f"{stem}.json" for stem in REPORTS}


def content_of(reports):
    return batch_page_content("bench", reports, {stem: f"{stem}.json" for stem in reports})


def test_the_worst_record_is_first_and_errors_are_apart():
    page = content_of(REPORTS)
    assert [row["stem"] for row in page["rows"]] == ["b", "e", "c", "a", "d"]
    assert page["errors"] == [{"stem": "f", "href": "f.json", "message": REPORTS["f"]["message"]}]
    reordered = dict(reversed(REPORTS.items()))
    assert content_of(reordered)["rows"] == page["rows"]


def test_counts_by_verdict_and_by_effect():
    page = content_of(REPORTS)
    assert page["count"] == "6 records"
    assert page["headline"] == "1 not explained, 1 partly explained, 2 explained, 1 without a gap, 1 not diagnosed"
    assert [(bar["label"], bar["value"], bar["width"]) for bar in page["verdicts"]][1:3] == [
        ("◐ Partly explained", "1 of 6", "16.7"),
        ("✓ Explained", "2 of 6", "33.3"),
    ]
    assert {bar["label"]: bar["value"] for bar in page["effects"]} == {
        "Transport delay": "2 of 6",
        "Load step": "1 of 6",
        "Lightly damped mode": "1 of 6",
    }


def test_a_row_has_the_errors_relative_to_the_noise():
    row = next(row for row in content_of(REPORTS)["rows"] if row["stem"] == "c")
    assert (row["verdict"], row["effects"]) == ("Explained", ["Transport delay", "Load step"])
    assert row["before"] == (pytest.approx(6.44), "6.44")
    assert row["after"] == (pytest.approx(3.0), "3.00")
    assert row["closed"] == (0.4, "40 %")
    assert (row["interval"], row["width"]) == (" [94, 100]", "40")


def test_an_effect_of_several_signals_is_shown_with_its_signal():
    found = with_planned_inputs(signals_report(("input-dead-zone", "valve"), ("extra-lag", None)))
    (row,) = content_of({"a": found})["rows"]
    assert row["effects"] == ["Dead zone at valve", "Extra lag"]
    assert row["ambiguous"] == ["extra lag", "rate limit of the actuator at valve"]
    assert row["before"] == (6.4, "6.40")


def test_a_record_without_noise_or_gap_has_no_numbers():
    found = report(verdict="none")
    found["gap"] |= {"noise_floor": 0.0}
    (row,) = content_of({"a": found})["rows"]
    assert (row["before"], row["after"], row["closed"], row["width"]) == (*[(None, "–")] * 3, None)


def test_the_page_loads_nothing_and_runs_only_its_own_script():
    shown = render_batch_page("bench", REPORTS, LINKS)
    assert "http://" not in shown
    assert "https://" not in shown
    assert "url(" not in shown
    (script,) = re.findall(r"<script>(.*?)</script>", shown, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    (policy,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]*)"', shown)
    assert f"default-src 'none'; script-src 'sha256-{digest}';" in policy
    assert not re.search(r"<[^>]* on\w+=", shown)


def test_names_are_escaped():
    found = report("input-delay")
    found["effects"][0]["name"] = HOSTILE
    found["ambiguous"] = [HOSTILE]
    reports = {"javascript:x": found, HOSTILE: report(verdict="none"), f"e{HOSTILE}": error(HOSTILE)}
    shown = render_batch_page(HOSTILE, reports, {stem: f"{stem}.json" for stem in reports})
    assert shown.count("<script") == 1
    assert 'href="javascript%3Ax.json"' in shown
    assert html.unescape(shown).count(HOSTILE) > 6


def test_a_batch_of_errors_has_no_table_of_records():
    shown = render_batch_page("bench", {"f": REPORTS["f"]}, LINKS)
    assert "1 record: 1 not diagnosed" in shown
    assert "<script" not in shown
    assert 'id="records"' not in shown


# Pages of the records -------------------------------------------------------------------------------------


@pytest.fixture
def out(tmp_path):
    """A folder with the JSON reports of two records and an error."""
    for stem in ("a", "d", "f"):
        (tmp_path / f"{stem}.json").write_text(json.dumps(REPORTS[stem]), encoding="utf-8")
    return tmp_path


@pytest.fixture
def written_here(monkeypatch, undrawn):
    """Pages are written by this process, without figures; `test_batch.py` has them written by another."""

    def run_tasks(module, tasks, jobs):
        assert module == "labsid.gap.batches.batch_page"
        return ((number, batch_page._write_record_page(task)) for number, task in enumerate(tasks))

    monkeypatch.setattr(batch_page, "run_tasks", run_tasks)


@pytest.mark.usefixtures("written_here")
def test_pages_are_written_once_and_again_after_a_new_report(out):
    reports = {stem: REPORTS[stem] for stem in ("a", "d", "f")}
    write_batch_page(out / "summary.html", "bench", reports)
    assert 'href="a.json"' in (out / "summary.html").read_text(encoding="utf-8")
    told = []
    assert write_record_pages(out, reports, 1, lambda what, share: told.append(what)) == {}
    assert told == ["1 of 2 pages", "2 of 2 pages"]
    assert (out / "a.html").read_text(encoding="utf-8") == render_html(REPORTS["a"])
    assert not (out / "f.html").exists()
    write_batch_page(out / "summary.html", "bench", reports)
    shown = (out / "summary.html").read_text(encoding="utf-8")
    assert re.findall(r'href="([^"]*)"', shown) == ["a.html", "d.html", "f.json"]
    later = (out / "a.html").stat().st_mtime_ns + 10**9
    os.utime(out / "a.json", ns=(later, later))
    write_batch_page(out / "summary.html", "bench", reports)
    assert 'href="a.json"' in (out / "summary.html").read_text(encoding="utf-8")
    told.clear()
    write_record_pages(out, reports, 1, lambda what, share: told.append(what))
    assert told == ["2 of 2 pages"]


@pytest.mark.usefixtures("written_here")
def test_a_page_that_cannot_be_written_is_reported(out):
    (out / "a.json").write_text("{}", encoding="utf-8")
    assert write_record_pages(out, {"a": REPORTS["a"], "d": REPORTS["d"]}, 1) == {"a": "KeyError: 'verdict'"}
    assert (out / "d.html").exists()
