"""What the first screen says: the closed share as a bar, the probability of the causes, and the next step."""

import pytest
from gap_reports import limits_row, report, with_limits, with_plateaus, with_rest

from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import REMAINING_ERRORS
from labsid.gap.reports.glance import chances_sentence, next_step, on_track, shown_sentence
from labsid.gap.reports.html_report import page_content, render_html
from labsid.gap.verdict.scores import closed_share


def test_the_bar_of_the_share_is_the_number_beside_it_and_not_the_difference_of_the_errors(undrawn):
    """0.0670 to 0.0452 above a noise of 0.0373 is three quarters of the way, and 54 % of the gap."""
    shown = report("periodic-disturbance", verdict="partial")
    before, after, floor = 0.0670, 0.0452, 0.0373
    closed = closed_share(before**2, after**2, floor**2)
    shown["gap"] |= {"before": before, "after": after, "noise_floor": floor, "closed": closed, "ci95": [-7.7, 1.0]}
    (share,) = page_content(shown)["first"]["shares"]
    assert share == {"label": "Gap closed", "closed": "54 % [0, 100]", "at": "54.1", "low": "0.0", "span": "100.0"}
    assert (before - after) / (before - floor) == pytest.approx(0.73, abs=0.01)
    assert 'class="fill after" style="width: 54.1%"' in render_html(shown)


def test_a_share_without_an_interval_has_no_line_and_none_without_a_gap():
    assert on_track(0.4, None) == {"closed": "40 %", "at": "40.0", "low": "", "span": ""}
    assert page_content(report(verdict="none"))["first"]["shares"] == []
    assert page_content(report(verdict="unknown"))["first"]["shares"] == []


def test_a_probability_is_given_once_if_it_is_that_of_all_causes():
    assert chances_sentence(report("input-delay", probability=0.95)) == "Probability of the cause: 95 %."
    pair = report("input-delay", "resonance", probability=0.95)
    assert chances_sentence(pair) == "Probability of the causes: 95 %."
    pair["effects"][1]["probability"] = 0.2
    assert chances_sentence(pair) == "Probability: transport delay 95 %, lightly damped mode 20 %."
    assert chances_sentence(report("input-delay", probability=0.3, verdict="partial")) is None
    assert chances_sentence(report(verdict="none")) is None


def test_what_a_record_without_a_gap_would_have_shown_is_counted():
    shown = shown_sentence(with_limits(report(verdict="none")))
    assert shown == (
        "The record would have shown 4 of 5 effects, from the sizes below on. It could not have shown extra lag."
    )
    every = report(verdict="none") | {"limits": [limits_row("input-backlash"), limits_row("input-delay")]}
    assert shown_sentence(every) == "The record would have shown each of 2 effects, from the sizes below on."
    assert shown_sentence(report(verdict="none")) is None
    assert shown_sentence(with_limits(report("input-delay"))) is None


def test_many_effects_that_could_not_be_shown_are_counted():
    hidden = [limits_row(name, detect=None) for name in ("resonance", "overflow", "gravity", "end-stop", "extra-lag")]
    shown = report(verdict="none") | {"limits": [limits_row("input-backlash"), *hidden]}
    assert str(shown_sentence(shown)).endswith("It could not have shown the 5 others.")


def test_the_next_step_follows_from_the_answer():
    assert next_step(report(verdict="none")) == "No further experiment is needed for this record."
    found = "Check the rig for a transport delay, or use the corrected simulation, which --export FILE writes."
    assert next_step(report("input-delay")) == found
    assert next_step(report("coloured-noise")) == "Check the rig for coloured noise."
    assert next_step(report("parameter-mismatch")).startswith("Give your simulation the fitted values")
    assert next_step(report("input-delay") | {"ambiguous": ["extra-lag"]}).startswith("Take a longer record")
    assert next_step(with_rest(report(verdict="unknown"), "input")) == REMAINING_ERRORS["input"].look
    assert next_step(report(verdict="unknown")).startswith("Inspect the rig")
    assert next_step(with_plateaus(report(verdict="unknown"), left=0.6)).startswith("Apply the same input again, and")
    planned = {"separates": ["input-delay", "extra-lag"], "why": "", "t": [0.0], "u": [0.0], "margin": 30.0}
    assert next_step(report("input-delay") | {"next_experiment": planned}) == (
        "Apply the proposed input. It distinguishes a transport delay from an extra lag."
    )


def test_wrong_numbers_of_a_simulation_are_in_the_headline():
    shown = report("parameter-mismatch")
    shown["gap"] |= {"closed": None, "ci95": None, "before": 0.5126, "after": 0.0101}
    number = {"determined": True, "at_limit": False, "limit": None, "combination": None, "group": []}
    rows = [("ka", 1.916, 0.001, 1.0), ("tau", 0.736, 0.001, 0.589), ("kb", 1.0005, 0.001, 1.0), ("kc", 2.0, 0.4, 1.0)]
    shown["numbers"] = [number | dict(zip(("name", "value", "stderr", "nominal"), row, strict=True)) for row in rows]
    said = (
        "umbers of your simulation are wrong: ka is 1.9160 (nominally 1.00) and tau is 0.7360 (nominally 0.589), and "
        "1 further differs. Refitting reduces the rms simulation error from 0.513 to 0.0101."
    )
    assert sentences.headline(shown) == f"N{said}"
    shown["effects"][0]["probability"] = 0.7
    assert sentences.headline(shown) == f"Probably n{said}"
    shown["numbers"] = shown["numbers"][2:3]
    assert "are wrong: ka" not in sentences.headline(shown)
    assert sentences.headline(shown).endswith("Refitting reduces the rms simulation error from 0.513 to 0.0101.")
