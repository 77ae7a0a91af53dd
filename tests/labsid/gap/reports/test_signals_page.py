"""The page of several signals: complete in itself, escaped, and with the numbers of the report."""

import base64
import csv
import io
import json
import re
from itertools import pairwise

import pytest
from gap_reports import with_rest
from page_reader import Page
from signals_reports import signals_report, undrawn_in_both_widths, with_planned_inputs

from labsid.gap.reports.html_report import write_html_report
from labsid.gap.reports.page_parts import command
from labsid.gap.reports.quantities import number
from labsid.gap.reports.sentences import PRODUCTS
from labsid.gap.reports.signals_page import encoded_figures, page_content, render_signals
from labsid.gap.reports.signals_text import format_signals, verdict_sentence
from labsid.gap.signals.result import SignalsDiagnosis

HOSTILE = "<script>alert('&\"')</script>"
FOUND = (("input-dead-zone", "valve"), ("extra-lag", None))
KINDS = {
    "effect": signals_report(*FOUND),
    "ambiguous": with_planned_inputs(signals_report(("input-delay", "valve"), probability=0.58)),
    "none": signals_report(verdict="none"),
    "partial": with_rest(signals_report(*FOUND, verdict="partial", probability=0.7), "input"),
    "unknown": with_rest(signals_report(verdict="unknown"), "disturbance"),
    "holdout": signals_report(*FOUND, holdout=True),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_valid_and_loads_nothing(kind, undrawn_signals):
    text = render_signals(KINDS[kind])
    page = Page(text)
    assert (page.faults, page.open) == ([], [])
    assert text.startswith("<!doctype html>")
    assert not {"script", "link", "iframe", "object", "form"} & set(page.tags)
    assert "http:" not in text
    assert "https:" not in text
    assert "url(" not in text
    assert all(value.startswith("data:") for _, name, value in page.attributes if name in ("src", "href", "srcset"))
    (policy,) = [value for _, name, value in page.attributes if name == "content" and value.startswith("default-src")]
    assert policy == "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


@pytest.mark.parametrize("kind", KINDS)
def test_headings_do_not_skip_a_level_and_pictures_are_described(kind, undrawn_signals):
    page = Page(render_signals(KINDS[kind]))
    levels = [int(tag[1]) for tag in page.tags if re.fullmatch(r"h\d", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
    alts = [value for tag, name, value in page.attributes if (tag, name) == ("img", "alt")]
    assert len(alts) == page.tags.count("img")
    assert all(alts)


@pytest.mark.parametrize("kind", KINDS)
def test_the_verdict_is_first_and_the_sections_are_in_order(kind, undrawn_signals):
    words = Page(render_signals(KINDS[kind])).words
    titles = [
        verdict_sentence(KINDS[kind]),
        *(["Effects"] if KINDS[kind]["effects"] else []),
        "Measured and simulated outputs",
        "Gap by output",
        "Which input moves which output",
        *(["Location of the gap"] if kind != "none" else []),
        "Next step",
        "Reproduce this report",
    ]
    start = 0
    for title in titles:
        start = words.index(title, start) + len(title)
    assert ("Location of the gap" in words) == (kind != "none")


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_of_the_page_is_one_of_the_report(kind, undrawn_signals):
    """In per cent or not, to the digits shown."""
    report = KINDS[kind]
    words = Page(render_signals(report)).words
    shown = words[: words.index("Reproduce this report")]
    for said in ("rig-7", "95 % interval", "At 100 % only noise", "over 20 the", "under 6 no"):
        shown = shown.replace(said, "")
    known = {float(found) for found in re.findall(r"-?\d+\.?\d*(?:e[-+]?\d+)?", json.dumps(_numbers(report)))}
    known |= {len(report["signals"][side]) for side in ("inputs", "outputs")}
    known |= {report["record"]["samples"] * report["record"]["Ts"], *_location_sums(report)}
    for text in re.findall(r"(?<![\w.])-?\d+\.?\d*", shown):
        half = 0.51 * 10.0 ** -len(text.partition(".")[2])
        close = (abs(scale * value - float(text)) <= half for value in known for scale in (1.0, 100.0))
        assert any(close), text


def _numbers(report):
    """Without the traces, which hold nearly every number."""
    tests = [one["unexplained"] for one in report["outputs"].values()]
    return {key: value for key, value in report.items() if key not in ("outputs", "limits", "ranking")} | {"o": tests}


def _location_sums(report):
    """Shares of neighbouring cells are added up in sentences."""
    time = sum(cell["time"] for cell in report["where"]["operating"][-1:])
    return [time, *((stop - start) / 120.0 for start, stop, _ in report["where"]["time"])]


def test_names_from_a_file_are_escaped(undrawn_signals):
    base = with_planned_inputs(
        signals_report(
            ("input-delay", HOSTILE), inputs=[(HOSTILE, HOSTILE), ("b", "")], outputs=[(f"y{HOSTILE}", HOSTILE)]
        )
    )
    base["record"]["name"] = HOSTILE
    base["findings"] = [{"kind": "samples", "signal": "b", "text": HOSTILE}]
    base["command"] = f"labsid gap diagnose {HOSTILE}"
    text = render_signals(base)
    assert "<script" not in text
    page = Page(text)
    assert (page.faults, page.open) == ([], [])
    assert page.words.count(HOSTILE) > 8
    assert f"b: {HOSTILE}" in page.words


def test_the_first_screen_is_that_of_the_output_with_the_largest_gap():
    shown = KINDS["partial"] | {"where": KINDS["partial"]["where"] | {"output": "level"}}
    first, gap = page_content(shown)["first"], shown["outputs"]["level"]["gap"]
    assert first["unit"] == "cm"
    assert [bar["value"] for bar in first["bars"]][:2] == [number(gap[key]) for key in ("before", "after")]
    assert [bar["label"] for bar in first["bars"]][2:] == ["Noise and what no model predicts", "White noise"]
    assert [share["label"] for share in first["shares"]] == ["Gap closed in level", "In all outputs"]
    assert first["shares"][1]["closed"] in first["headline"]
    assert page_content(KINDS["unknown"])["first"]["shares"] == []


def test_one_output_has_one_closed_share():
    base = signals_report(FOUND[0], outputs=[("level", "cm")])
    assert [share["label"] for share in page_content(base)["first"]["shares"]] == ["Gap closed"]


def test_the_loop_names_each_effect_with_its_signal():
    loop = page_content(KINDS["partial"])["first"]["loop"]
    tags = {part["title"]: part["tags"] for part in loop["blocks"]}
    assert tags["Actuator"] == ["cause: dead zone at valve", "main part of the rest in temperature"]
    assert tags["Process"] == ["cause: extra lag in temperature"]
    assert loop["ends"] == ("valve, heater", "level, temperature")
    many = signals_report(verdict="unknown", inputs=[("torque_1", ""), ("torque_2", ""), ("torque_3", "")])
    assert page_content(many)["first"]["loop"]["ends"][0] == "3 inputs"
    assert not loop["closed"]
    assert page_content(KINDS["effect"])["next"] == "Check the rig for a dead zone at valve and an extra lag."


def test_a_signal_without_a_unit_shows_its_name_only():
    assert [row[0] for row in page_content(KINDS["effect"])["table"]] == ["Output", "level (cm)", "temperature"]


def test_without_a_correction_the_table_has_no_column_for_it():
    assert page_content(KINDS["none"])["table"][0] == ("Output", "Simulation", "Noise")
    assert page_content(KINDS["effect"])["table"][0] == ("Output", "Before", "After", "Noise", "Gap closed")


def test_every_effect_has_its_signal_and_the_outputs_in_which_it_is_seen():
    first, second = page_content(KINDS["effect"])["effects"]
    assert (first["title"], first["place"]) == ("Dead zone at valve", "seen in temperature")
    assert second["title"] == "Extra lag"
    assert [unit for _, _, unit in first["parameters"]] == ["V", "V"]
    assert page_content(KINDS["effect"])["places"] == "at valve and in the dynamics of temperature"


def test_the_proposed_inputs_can_be_saved(undrawn_signals):
    report = KINDS["ambiguous"]
    page = Page(render_signals(report))
    (link,) = [value for tag, name, value in page.attributes if (tag, name) == ("a", "href")]
    rows = list(csv.DictReader(io.StringIO(base64.b64decode(link.partition("base64,")[2]).decode())))
    planned = report["next_experiment"]
    for name, u in ({"t": planned["t"]} | planned["u"]).items():
        assert [float(row[name]) for row in rows] == u
    assert "(.csv with t,valve,heater)" in page.words
    assert "does not rule out an extra lag or a rate limit of the actuator at valve" in page.words


def test_inputs_without_a_panel_are_named(undrawn_signals):
    base = signals_report(verdict="unknown", inputs=[("a", ""), ("b", ""), ("c", "")], outputs=[("y", "")])
    assert "Inputs without a panel: b and c." in Page(render_signals(base)).words
    assert "without a panel" not in Page(render_signals(KINDS["effect"])).words


def test_the_command_names_the_signals():
    assert command(KINDS["holdout"]) == (
        "labsid gap diagnose rig-7 --inputs valve,heater --outputs level,temperature --holdout RECORD2 "
        "--json report.json --html report.html"
    )
    given = KINDS["effect"] | {"command": "labsid gap diagnose tanks.csv --inputs 1,2 --outputs 3,4"}
    assert page_content(given)["command"] == given["command"]


def test_the_figures_are_those_of_the_verdict(monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr("labsid.plots.page_figures.in_both_widths", undrawn_in_both_widths)
        assert set(encoded_figures(KINDS["none"])) == {"first", "signals", "couplings"}
    found = encoded_figures(KINDS["holdout"])
    assert set(found) == {"first", "signals", "couplings", "zoom", "where", "holdout", "effect 1", "effect 2"}
    assert all(base64.b64decode(png).startswith(b"\x89PNG") for one in found.values() for png in one.values())


def test_the_kind_of_report_chooses_the_page(tmp_path, undrawn_signals):
    write_html_report(tmp_path / "page.html", KINDS["effect"])
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == render_signals(KINDS["effect"])


def test_a_notebook_shows_the_page_and_the_figure(undrawn_signals):
    result = SignalsDiagnosis(KINDS["effect"], {})
    assert result._repr_html_().startswith('<iframe srcdoc="&lt;!doctype html&gt;')
    assert result.plot().axes[-2].get_title(loc="left") == "Cause: dead zone"


@pytest.mark.parametrize("product", ["output", "wave"])
def test_a_product_in_place_of_the_effects_is_said_with_its_output(product):
    found = signals_report(("cubic-stiffness", None), verdict="partial", probability=0.4)
    outputs = {name: one | {"product": product if name == "level" else ""} for name, one in found["outputs"].items()}
    found |= {"product": product, "outputs": outputs, "next_experiment": None}
    text = " ".join(format_signals(found).split())
    said, look = PRODUCTS[product]
    assert f"In level: a{said[1:]}" in text
    assert look in text
    assert said not in format_signals(found | {"product": ""})
