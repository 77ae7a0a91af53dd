"""The page: well-formed, complete in itself, escaped, and saying what the terminal says."""

import base64
import copy
import csv
import gzip
import hashlib
import io
import json
import re

import pytest
from gap_reports import PARAMETERS, report, undrawn_figures, with_experiment, with_holdout, with_plateaus, with_rest
from page_reader import Page

from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.record.record_findings import BY_LAW, BY_RELAY
from labsid.gap.reports import sentences
from labsid.gap.reports.html_report import page_content, render_html, write_html_report
from labsid.gap.reports.location_text import location_sentences
from labsid.gap.reports.page_parts import command
from labsid.gap.reports.quantities import with_names
from labsid.plots.gap_curves import noise_band

HOSTILE = "<script>alert('&\"')</script>"


def _read(path, content):
    """Write the page of a report and read it back as a browser would."""
    write_html_report(path, content)
    html = path.read_text(encoding="utf-8")
    parsed = Page(html)
    assert parsed.faults == []
    assert parsed.open == []
    return html, parsed


KINDS = {
    "effect": report("input-dead-zone"),
    "pair": report("load-step", "output-outliers"),
    "ambiguous": with_experiment(report("input-delay", probability=0.58)),
    "none": report(verdict="none"),
    "partial": with_rest(report("coulomb-friction", "resonance", verdict="partial", probability=0.7), "input"),
    "unknown": with_rest(report("input-delay", verdict="unknown"), "disturbance"),
    "mismatch": report("parameter-mismatch"),
}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The page of every kind of answer: its HTML, and what a browser finds in it. One has its figures."""
    folder = tmp_path_factory.mktemp("pages")
    with pytest.MonkeyPatch.context() as patched:
        made = {"ambiguous": _read(folder / "ambiguous.html", KINDS["ambiguous"])}
        patched.setattr("labsid.gap.reports.html_report.encoded_figures", undrawn_figures)
        return made | {kind: _read(folder / f"{kind}.html", KINDS[kind]) for kind in KINDS if kind not in made}


@pytest.mark.parametrize("kind", KINDS)
def test_every_page_is_self_contained(kind, pages):
    html, parsed = pages[kind]
    assert html.lstrip().startswith("<!doctype html>")
    assert not {"link", "iframe", "object", "form"} & set(parsed.tags)
    plain = html[: html.index("<script")]
    assert "http:" not in re.sub(r"base64,[A-Za-z0-9+/=]*", "", plain)  # where any letters stand by chance
    assert "https:" not in plain
    for tag, name, value in parsed.attributes:
        assert not name.startswith("on"), "no script in an attribute"
        if name in ("src", "href", "srcset"):
            assert value.startswith("data:"), (tag, name)
    assert "url(" not in plain
    assert parsed.tags.count("h1") == 1


@pytest.mark.parametrize("kind", KINDS)
def test_the_security_policy_allows_the_scripts_of_the_page_and_nothing_else(kind, pages):
    _, parsed = pages[kind]
    (policy,) = [value for tag, name, value in parsed.attributes if (tag, name) == ("meta", "content") and ";" in value]
    *packed, own = parsed.scripts
    data, library = (gzip.decompress(base64.b64decode(text)).decode() for text in packed)
    scripts = library, own
    assert scripts[0].startswith("/* BEGIN bokeh")
    assert len(packed[1]) < 0.4 * len(library)
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in scripts]
    assert policy.startswith("default-src 'none'; img-src data:; script-src ")
    assert re.findall(r"'sha256-(.*?)'", policy) == digests
    assert len(digests) == 2
    assert "unsafe-eval" not in policy
    assert set(json.loads(data)["parts"]) == {"record"}


def test_the_same_report_gives_the_same_page(undrawn):
    """Although bokeh counts what a process has made."""
    shown = with_holdout(report("input-delay"))
    assert render_html(shown) == render_html(shown)


@pytest.mark.parametrize("kind", KINDS)
def test_the_verdict_is_first_and_the_sections_are_in_order(kind, pages):
    _, parsed = pages[kind]
    words = parsed.words
    titles = (
        sentences.verdict_sentence(KINDS[kind]),
        "Measured and simulated output",
        *([] if kind == "none" else ["Location of the gap"]),
        "Effects tried",
        "Residual",
        "Next step",
        "Reproduce this report",
    )
    places = [words.index(title) for title in titles]
    assert places == sorted(places)
    where = [] if kind == "none" else location_sentences(KINDS[kind])
    for said in (*where, *sentences.residual_sentences(KINDS[kind])):
        assert said in words


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_effect_is_explained_with_its_parameters(name):
    (shown,) = page_content(report(name))["effects"]
    assert shown["meaning"] == DESCRIPTIONS[name].meaning
    assert len(shown["parameters"]) == len(PARAMETERS[name])
    assert all(label and value for label, value, _ in shown["parameters"])


def test_figures_are_png_for_both_widths_with_alternative_text(pages):
    html, parsed = pages["ambiguous"]
    pictures = [value for _, name, value in parsed.attributes if name in ("src", "srcset")]
    assert len(pictures) == 9  # those of two widths but for the simulations
    for picture in pictures:
        kind, _, data = picture.partition("base64,")
        assert kind == "data:image/png;"
        assert base64.b64decode(data, validate=True).startswith(b"\x89PNG\r\n\x1a\n")
    alts = [value for tag, name, value in parsed.attributes if (tag, name) == ("img", "alt")]
    assert len(alts) == html.count("<img") == 5
    assert all(alts)


def test_names_from_a_file_are_escaped(tmp_path, undrawn):
    base = with_experiment(report("input-delay"))
    base["record"]["name"] = HOSTILE
    base["effects"][0]["name"] = HOSTILE
    base["effects"][0]["parameters"] = {HOSTILE: {"value": 1.0, "stderr": 0.1, "unit": HOSTILE}}
    base |= {"ambiguous": [HOSTILE], "screen": [HOSTILE]}
    base["ranking"][0]["name"] = HOSTILE
    base["next_experiment"]["why"] = HOSTILE
    html, parsed = _read(tmp_path / "page.html", base)
    assert HOSTILE not in html
    assert parsed.tags.count("script") == 3
    assert parsed.words.count(HOSTILE) >= 6


def test_the_command_is_safe_to_paste():
    base = report("parameter-mismatch")
    base["record"]["name"] = "my rig; rm -rf $HOME"
    assert command(base) == (
        "labsid gap diagnose 'my rig; rm -rf $HOME' --sim MODEL --json report.json --html report.html"
    )
    assert "--holdout RECORD2" in command(with_holdout(base))
    base["records"] = [{"name": "run 1"}, {"name": "run-2"}]
    assert command(base).startswith("labsid gap diagnose 'run 1' run-2 --sim MODEL")
    base["command"] = "labsid gap diagnose dryer.dat --columns 1,2 --Ts 0.08"
    assert command(base) == base["command"]


def test_the_accepted_row_has_its_interval_and_further_rows_are_collapsed(tmp_path, undrawn):
    base = report("input-delay", "output-outliers")
    base["ranking"] += [{"name": f"extra-lag+{k}", "probability": 0.0, "rmse": 1.0, "closed": 0.1} for k in range(7)]
    shown = page_content(base)
    assert [row["accepted"] for row in shown["ranking"]] == [True, *[False] * 10]
    held_out = shown["ranking"][0]["held_out"]
    assert held_out == {"closed": "97 % [94, 100]", "at": "96.9", "low": "93.9", "span": "5.9"}
    _, parsed = _read(tmp_path / "page.html", base)
    assert "3 more" in parsed.words
    assert parsed.words.count(" accepted ") == 1


def test_a_candidate_is_drawn_where_its_numbers_say(tmp_path, undrawn):
    base = report("input-delay")
    base["ranking"][0] |= {"closed": 0.61, "ci95": [-0.2, 0.74]}
    base["ranking"][1] |= {"closed": -0.4, "probability": 0.25}
    first, second, *_ = page_content(base)["ranking"]
    assert {key: first[key] for key in ("closed", "at", "low", "span")} == {
        "closed": "61 % [0, 74]",
        "at": "61.0",
        "low": "0.0",
        "span": "74.0",
    }
    assert (second["at"], second["span"], second["chance"]) == ("0.0", "", "25.0")
    html, _ = _read(tmp_path / "page.html", base)
    assert html.count('<i style="left: 0.0%; width: 74.0%">') == 1
    assert '<b style="left: 61.0%">' in html


def with_records(base):
    """The report as one of two records of 100 and 120 samples, with 20 samples between them."""
    rows = [("run-1", 0.0, 100), ("<b>$2$</b>", 60.0, 120)]
    numbers = {"before": 0.2, "after": 0.1, "noise_floor": 0.05, "closed": 0.5, "unscored": 50}
    base["records"] = [{"name": name, "start": t, "samples": n} | numbers for name, t, n in rows]
    base["record"]["Ts"] = 0.5
    inside = [k for k in range(240) if not 100 <= k < 120]
    base["traces"] = {name: [x[k] for k in inside] for name, x in base["traces"].items()}
    return base


def test_several_records_are_drawn_one_by_one_and_located_by_their_names(tmp_path):
    html, parsed = _read(tmp_path / "page.html", with_records(report("input-delay")))
    assert "Outputs and errors of each record." in html
    assert "Times run on" not in html
    assert "92 % of the gap lies in run-1, 45 % of the samples." in parsed.words
    assert parsed.tags.count("select") == 1
    assert "<b>$2$" not in html


def test_no_row_is_accepted_if_the_verdict_is_unknown(pages):
    _, parsed = pages["unknown"]
    assert not any(row["accepted"] for row in page_content(KINDS["unknown"])["ranking"])
    assert "None reduces this error by more than chance." in parsed.words


def test_the_ranking_of_a_part_compares_errors_and_gives_no_probabilities(pages):
    """The probability of an effect is not that of a combination, so the two are not shown one above the other."""
    _, parsed = pages["partial"]
    table = parsed.words[parsed.words.index("Effects tried") : parsed.words.index("Residual")]
    assert "Probability" not in table
    assert "under 1" not in table
    assert table.count("lightly damped mode accepted") == 1
    assert [row["accepted"] for row in page_content(KINDS["partial"])["ranking"]] == [True, False, False, False]
    _, parsed = pages["effect"]
    assert "Probability" in parsed.words[parsed.words.index("Effects tried") :]


@pytest.mark.parametrize("kind", ["partial", "unknown"])
def test_the_rest_is_shown_as_bars_and_on_the_loop(kind, pages):
    content = page_content(KINDS[kind])
    assert [bar["label"] for bar in content["kinds"]] == [
        "Linear dynamics",
        "A curve or hysteresis at the input",
        "A curve at the output",
        "Nonlinear dynamics",
        "A change with time",
        "Not predicted by the models tried",
    ]
    assert sum(float(bar["width"] or 0.0) for bar in content["kinds"]) == pytest.approx(100.0, abs=0.2)
    what = "main part of the rest" if kind == "partial" else "main part of the error"
    block = "Actuator" if kind == "partial" else "Environment"
    assert [part["title"] for part in content["first"]["loop"]["blocks"] if what in part["tags"]] == [block]
    _, parsed = pages[kind]
    assert f"{block} {what}" in parsed.words
    assert content["look"] in parsed.words
    assert parsed.words.index(content["first"]["headline"]) < parsed.words.index(content["first"]["remaining"])


def test_the_noise_includes_disturbances_where_something_else_remains(pages):
    assert "indistinguishable from noise" in pages["effect"][1].words
    for kind in ("partial", "unknown"):
        assert "indistinguishable from noise" not in pages[kind][1].words
        rest, white = page_content(KINDS[kind])["first"]["bars"][-2:]
        assert (rest["label"], white["label"]) == ("Noise and what no model predicts", "White noise")
        assert float(white["value"]) == pytest.approx(0.5 * noise_band(KINDS[kind])[0], rel=0.01)


def test_an_effect_that_is_less_probable_than_not_is_no_cause_on_the_loop():
    base = report("coulomb-friction", "output-drift", verdict="partial")
    base["effects"][1]["probability"] = 0.2
    tags = {part["title"]: part["tags"] for part in page_content(base)["first"]["loop"]["blocks"]}
    assert (tags["Process"], tags["Sensor"], tags["Actuator"]) == (
        ["cause: dry friction"],
        ["possible cause: drift of the sensor"],
        [],
    )


def test_the_proposed_input_can_be_saved(pages):
    _, parsed = pages["ambiguous"]
    (link,) = [value for tag, name, value in parsed.attributes if (tag, name) == ("a", "href")]
    rows = list(csv.DictReader(io.StringIO(base64.b64decode(link.partition("base64,")[2]).decode())))
    planned = KINDS["ambiguous"]["next_experiment"]
    assert [float(row["t"]) for row in rows] == planned["t"]
    assert [float(row["u"]) for row in rows] == planned["u"]


def test_the_loop_marks_the_blocks_of_the_causes():
    stations = page_content(KINDS["pair"])["first"]["loop"]["blocks"]
    assert [part["title"] for part in stations if part["share"] != "0"] == ["Sensor", "Environment"]
    assert "Simulation" not in [part["title"] for part in stations]
    assert [
        part["title"] for part in page_content(KINDS["mismatch"])["first"]["loop"]["blocks"] if part["share"] != "0"
    ] == ["Simulation"]


@pytest.mark.parametrize(
    ("text", "closed"),
    [
        (f"{BY_RELAY}, as from a relay controller. Whether it responds cannot be judged.", True),
        (f"{BY_LAW}, as from a controller with a gain of 3. Whether it responds cannot be judged.", True),
        (
            "the error of the best simulation helps to predict the input (F = 30). Either the input depends on it.",
            False,
        ),
        ("input and output follow from each other without delay, by one straight line.", False),
    ],
)
def test_the_way_of_the_signal_is_a_loop_where_the_record_has_a_controller(text, closed):
    finding = {"level": "note", "topic": "feedback", "text": text}
    assert page_content(report("input-delay") | {"record_findings": [finding]})["first"]["loop"]["closed"] is closed
    assert (
        page_content(report("input-delay") | {"record_findings": [finding | {"topic": "input"}]})["first"]["loop"][
            "closed"
        ]
        is False
    )


def test_an_unstable_rig_has_a_loop():
    shown = report("input-delay")
    assert page_content(shown | {"gap": shown["gap"] | {"mode": "stabilised"}})["first"]["loop"]["closed"] is True


def test_no_line_ends_between_a_number_and_its_per_cent(pages):
    _, parsed = pages["pair"]
    assert " %" not in "".join(parsed.text)
    assert "97\u00a0%\u00a0[94,\u00a0100]" in "".join(parsed.text)


def test_no_line_ends_inside_an_interval_or_between_a_number_and_its_unit(tmp_path, undrawn):
    said = "5 % [1, 12] after 1138 s at 0.2 Hz (p = 0.5, p > 0.99), in units of y"
    _, parsed = _read(tmp_path / "page.html", report("input-delay") | {"screen": [said]})
    (shown,) = (text for text in parsed.text if "1138" in text)
    assert shown.strip().split(" ") == [
        "5\u00a0%\u00a0[1,\u00a012]",
        "after",
        "1138\u00a0s",
        "at",
        "0.2\u00a0Hz",
        "(p\u00a0=\u00a00.5,",
        "p\u00a0>\u00a00.99),",
        *["in", "units", "of", "y"],
    ]


def test_record_findings_are_listed_under_the_verdict(tmp_path, undrawn):
    _, parsed = _read(tmp_path / "page.html", with_plateaus(report("output-drift", verdict="unknown"), left=0.6))
    places = [
        parsed.words.index(text)
        for text in ("the output settles at different levels", "Findings from the record:", "Measured and simulated")
        if text in parsed.words
    ]
    assert places == sorted(places)
    assert "Apply the same input again" in parsed.words


def test_the_page_explains_that_the_baseline_is_fitted_to_both_sides_of_a_load_step():
    assert "on both sides" in page_content(report("load-step"))["fitted_baseline"]
    assert page_content(report("input-delay"))["fitted_baseline"] == ""
    given = report("load-step") | {"simulation": {"given": True, "output_only": False}}
    assert page_content(given)["fitted_baseline"] == ""


def test_bars_compare_errors_before_and_after_with_the_noise():
    assert [bar["width"] for bar in page_content(KINDS["effect"])["first"]["bars"]] == ["100.0", "15.8", "15.5"]
    assert [bar["label"] for bar in page_content(KINDS["none"])["first"]["bars"]] == ["Simulation", "Noise alone"]
    assert [bar["label"] for bar in page_content(KINDS["unknown"])["first"]["bars"]] == [
        "Simulation",
        "Noise and what no model predicts",
        "White noise",
    ]
    noise = {"partial": 2}
    after = {
        kind: page_content(KINDS[kind])["first"]["bars"][-1 - noise.get(kind, 1)]["label"]
        for kind in ("effect", "partial", "mismatch")
    }
    assert after == {
        "effect": "After adding the cause",
        "partial": "After adding the effects",
        "mismatch": "After refitting the parameters",
    }


def test_a_bar_for_each_effect_has_the_error_that_its_share_leaves():
    shown = report("coulomb-friction", "resonance", verdict="partial")
    shown["effects"][0]["closed"] = 0.5
    (_, step, after, floor, _) = page_content(shown)["first"]["bars"]
    gap = shown["gap"]
    left = (float(step["value"]) ** 2 - gap["noise_floor"] ** 2) / (gap["before"] ** 2 - gap["noise_floor"] ** 2)
    assert 1.0 - left**0.5 == pytest.approx(0.5, abs=0.01)
    assert (step["label"], after["value"], floor["value"]) == ("With dry friction", "0.0102", "0.0100")


def test_effects_that_were_added_in_one_step_have_one_bar_and_one_share():
    shown = report("coulomb-friction", "resonance", "output-drift", verdict="partial")
    for effect, closed in zip(shown["effects"], (0.5, 0.5, 0.969), strict=True):
        effect["closed"] = closed
    content = page_content(shown)
    assert [bar["label"] for bar in content["first"]["bars"]][:3] == [
        "Before",
        "With dry friction and lightly damped mode",
        "After adding the effects",
    ]
    assert [effect["closed"] for effect in content["effects"]] == [None, "50 %", "97 %"]
    for effect in shown["effects"]:
        effect["closed"] = 0.969
    assert [bar["label"] for bar in page_content(shown)["first"]["bars"]][:2] == ["Before", "After adding the effects"]


def test_without_a_gap_no_place_of_it_is_named(pages):
    html, parsed = pages["none"]
    assert "Location" not in parsed.words
    assert 'class="loop"' not in html
    assert "no gap beyond noise" in parsed.words


def test_a_simulated_output_is_described_once():
    shown = report("input-saturation")
    model = {"order": 2, "dead_time": 0, "error": 5e-9}
    shown["simulation"] |= {"given": True, "output": {"resampled": "", "model": model}}
    content = page_content(shown)
    assert f"{content['simulation']} {content['baseline']}".count("reproduces your simulated output") == 1


def test_the_page_states_that_only_the_output_was_given():
    base = report("output-drift")
    base["simulation"] = {"given": True, "output_only": True}
    assert "Only the output" in page_content(base)["simulation"]
    base["simulation"]["output_only"] = False
    assert "unchanged" in page_content(base)["simulation"]


def test_the_page_is_a_pure_function_of_the_report(tmp_path, pages):
    base = copy.deepcopy(KINDS["ambiguous"])
    write_html_report(tmp_path / "again.html", base)
    assert (tmp_path / "again.html").read_text(encoding="utf-8") == pages["ambiguous"][0]
    assert base == KINDS["ambiguous"]


def test_a_folder_that_is_not_there_is_an_error(tmp_path, undrawn):
    with pytest.raises(FileNotFoundError, match="no such folder"):
        write_html_report(tmp_path / "nowhere" / "page.html", KINDS["none"])


def test_names_of_the_columns_are_on_the_loop_and_in_the_texts(monkeypatch):
    monkeypatch.setattr("labsid.gap.reports.html_report.encoded_figures", undrawn_figures)
    shown = with_names(KINDS["effect"], "goal", "position")
    content = page_content(shown)
    assert content["first"]["loop"]["ends"] == ("goal", "position")
    assert content["first"]["unit"] == "units of position"
    assert "(units of position, " in content["gap"]
    words = Page(render_html(shown)).words
    assert "units of goal" in words
    assert "units of u" not in words
    assert "u is the input and y the output" not in words
    assert "u is the input and y the output, in the units of the record." in Page(render_html(KINDS["effect"])).words
    assert page_content(KINDS["effect"])["first"]["loop"]["ends"] == ("u", "y")
    assert with_names(KINDS["effect"], "u", "y") == KINDS["effect"]
