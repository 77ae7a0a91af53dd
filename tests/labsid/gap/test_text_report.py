"""The text report, for every effect and verdict."""

import copy

import pytest
from gap_reports import PARAMETERS, effect, report, with_experiment, with_holdout, with_plateaus

from labsid.gap import sentences
from labsid.gap.effect_texts import clause, noun
from labsid.gap.location_text import location_sentences
from labsid.gap.text_report import format_report


def _one_line(text):
    return " ".join(text.split())


UNSIMULATED = ("output-dropout", "output-outliers", "output-quantization", "coloured-noise")


@pytest.mark.parametrize("name", sorted(set(PARAMETERS) - set(UNSIMULATED)))
def test_every_effect_is_one_sentence_with_its_share_of_the_gap(name):
    said = sentences.verdict_sentence(report(name))
    assert said == f"{clause(effect(name))}: {noun(name)} explains 97 % [94, 100] of the gap."
    text = format_report(report(name))
    assert _one_line(text).startswith(said)
    assert f"{noun(name)} ({name}), probability over 99 %" in _one_line(text)


@pytest.mark.parametrize("name", UNSIMULATED)
def test_sample_faults_close_no_gap(name):
    base = report(name)
    base["gap"] |= {"before": 0.0102, "after": 0.0102, "closed": None, "ci95": None, "black_box": None}
    said = sentences.verdict_sentence(base)
    assert said == f"{clause(effect(name))}: {noun(name)}; apart from this, there is no gap beyond noise."
    base["gap"] |= {"before": 0.02, "after": 0.02}
    assert sentences.verdict_sentence(base).endswith(
        "the rms simulation error is 0.0200, and the noise alone is 0.0100."
    )


def test_the_dead_zone_as_the_contract_says_it():
    text = format_report(report("input-dead-zone"))
    assert text.splitlines()[0].startswith(
        "The actuator does not move between 0.458 and 0.875: a dead zone explains 97 %"
    )
    assert "lower edge of the band  0.4580 ± 0.0013  units of u" in text
    assert "is 0.0644 before and 0.0102 after adding the cause; the noise alone is 0.0100" in _one_line(text)
    assert "The cause is between the command and the process." in _one_line(text)
    assert "80 % of the gap lies between 30 and 45 s, 12 % of the record" in _one_line(text)
    assert "70 % of it lies between 0.250 and 0.500 Hz" in _one_line(text)
    assert "90 % of it lies where u is between 2 and 3, in which the record spends 50 % of its time" in _one_line(text)
    assert "Only white noise remains." in _one_line(text)


def test_a_pair_is_said_together_and_the_unsure_half_of_it_hedged():
    base = report("input-dead-zone", "load-step")
    said = sentences.verdict_sentence(base)
    assert said == (
        "The actuator does not move between 0.458 and 0.875 (a dead zone), and an unmeasured load starts at 374.2 s "
        "and changes the output by -0.210 (a load step): together they explain 97 % [94, 100] of the gap."
    )
    base["effects"][1]["probability"] = 0.43
    assert "(a dead zone), and possibly an unmeasured load starts" in sentences.verdict_sentence(base)
    base["effects"][0]["probability"] = 0.7
    assert sentences.verdict_sentence(base).startswith("Probably the actuator does not move")
    assert "A dead zone: between the command and the process;" in _one_line(format_report(base))


def test_three_effects_are_listed():
    said = sentences.verdict_sentence(report("input-delay", "extra-lag", "output-drift"))
    assert "late (a transport delay), there is an additional lag" in said
    assert "(an extra lag), and the zero of the sensor" in said


@pytest.mark.parametrize(
    ("closed", "ci95", "end"),
    [
        (0.3, [0.1, 0.5], "a transport delay explains only 30 % [10, 50] of the gap."),
        (0.3, [-0.2, 0.8], "a transport delay explains only 30 % [-20, 80] of the gap, possibly none of it."),
        (-0.2, [-1.3, 0.4], "but closes none of the gap on held-out samples (-20 % [-130, 40])."),
        (None, None, "but held-out samples show no gap."),
    ],
)
def test_an_effect_that_fails_on_held_out_samples_is_reported_so(closed, ci95, end):
    base = report("input-delay")
    base["gap"] |= {"closed": closed, "ci95": ci95}
    assert sentences.verdict_sentence(base).endswith(end)


def test_none_says_which_simulation_was_good_enough():
    base = report(verdict="none")
    text = format_report(base)
    assert _one_line(text).startswith(
        "There is no gap beyond noise: the rms error of a linear model fitted to the record is 0.0102, and the "
        "noise alone is 0.0100."
    )
    assert "where " not in text
    base["simulation"]["given"] = True
    base["gap"]["after"] = 0.0099  # refitted, which changes nothing that counts
    assert "the rms error of your simulation is 0.0102" in _one_line(format_report(base))
    assert "0.0099" not in format_report(base)


def test_unknown_lists_the_effects_tried_and_the_residual():
    base = report("input-delay", verdict="unknown")
    base["gap"] |= {"closed": 0.43, "ci95": [0.08, 0.58], "after": 0.04}
    base["unexplained"] |= {"share": 0.24, "whiteness_p": 0.0, "input_correlation_p": 1e-9, "repeats": 0.3}
    text = _one_line(format_report(base))
    assert text.startswith(
        "None of the 9 effects tried explains the gap: the best candidate, a transport delay, closes only "
        "43 % [8, 58] of it, and the remaining error exceeds the noise."
    )
    assert "tried Extra lag, backlash, transport delay, drift of the sensor, lightly damped mode, logger" in text
    assert "24 % of the gap remains; with the noise, 0.0101 rms" in text
    assert "It depends on past inputs (p < 0.001)" in text
    assert "repeats when the input repeats (correlation 0.30)" in text
    assert "Only white noise" not in text


def test_unknown_without_improvement_names_no_nearest_effect():
    base = report("input-delay", verdict="unknown")
    base["gap"] |= {"closed": 0.0, "ci95": [0.0, 0.0], "after": base["gap"]["before"]}
    assert sentences.verdict_sentence(base).endswith("none reduces it by more than chance.")
    base["gap"] |= {"closed": -0.1, "ci95": [-0.9, 0.2], "after": 0.08}
    assert sentences.verdict_sentence(base).endswith("a transport delay, does not reduce it on held-out samples.")


def test_a_set_is_named_as_one_and_not_twice():
    base = report("input-delay", probability=0.58) | {"ambiguous": ["input-rate-limit", "extra-lag"]}
    assert sentences.ambiguity_sentence(base) == (
        "The record does not rule out a rate limit of the actuator or an extra lag instead. Probability: "
        "a transport delay 58 %."
    )
    unknown = report("input-delay", verdict="unknown") | {"ambiguous": ["input-delay"]}
    assert sentences.ambiguity_sentence(unknown) is None  # the verdict has named it
    unknown["ambiguous"] = ["resonance"]
    assert sentences.ambiguity_sentence(unknown).startswith(
        "The best fits include a lightly damped mode, but none is accepted"
    )
    none = report(verdict="none") | {"ambiguous": ["extra-lag"]}
    assert sentences.ambiguity_sentence(none) == "The record does not rule out an extra lag."


def test_a_visible_limit_is_reported_apart_from_the_nearest_effect():
    base = report("overflow", probability=0.8) | {
        "beside": ["output-nonlinearity"],
        "ambiguous": ["output-nonlinearity"],
    }
    said = sentences.verdict_sentence(base)
    assert said.startswith(f"Probably {sentences.uncapitalised(clause(effect('overflow')))}: an overflow; the output")
    assert said.endswith(
        "It is not the only cause: the best candidate, which adds a curved characteristic of the sensor, "
        "closes 97 % [94, 100] of the gap."
    )
    assert sentences.ambiguity_sentence(base).startswith("The additional cause is uncertain: a curved characteristic")
    assert sentences.other_causes_sentence(base).startswith("Of the first row, only the effect named above")
    assert sentences.is_incomplete(base)
    assert not sentences.is_incomplete(report("overflow"))
    base["gap"] |= {"closed": -0.1, "ci95": [-0.4, 0.2]}
    assert "closes none of the gap on held-out samples." in sentences.verdict_sentence(base)


@pytest.mark.parametrize(("margin", "how"), [(41.0, "reliable"), (9.0, "probably correct")])
def test_the_experiment_names_the_effects_it_separates_and_its_margin(margin, how):
    base = with_experiment(report("input-delay"))
    base["next_experiment"]["margin"] = margin
    said = sentences.experiment_sentence(base)
    assert said.startswith(
        "It distinguishes a transport delay from a drift of the sensor. On ramps, a drift of the sensor "
    )
    assert said.endswith(f"the decision would be {how}.")
    assert "input-delay" not in said
    assert "next_experiment" in format_report(base)


def test_the_gap_in_time_is_spread_or_in_stretches():
    base = report("output-dropout")
    base["where"]["time"] = [[0.0, 60.0, 0.55], [60.0, 120.0, 0.45]]
    assert "The gap is spread over the whole record." in location_sentences(base)
    base["where"]["time"] = [[0, 50, 0.1], [50, 52, 0.3], [52, 54, 0.2], [54, 90, 0.1], [90, 92, 0.3], [92, 120, 0.0]]
    assert location_sentences(base)[0] == (
        "80 % of the gap lies in 2 stretches that make up 5 % of the record; the largest is 50 to 54 s."
    )


def test_an_operating_range_that_only_follows_the_time_is_said_so():
    base = report("input-delay")
    base["where"]["operating"][2]["share"], base["where"]["operating"][1]["share"] = 0.55, 0.4
    assert (
        location_sentences(base)[2] == "Over the range of u, the gap is in proportion to the time spent at each value."
    )


def test_a_given_holdout_is_named_as_the_basis_of_the_score():
    base = report("input-delay")
    assert "held-out samples" in sentences.gap_sentence(base)
    assert "holdout record" in sentences.gap_sentence(with_holdout(base))


def test_lines_are_short_and_keep_numbers_with_their_percent_sign():
    for base in (report("input-dead-zone", "load-step"), report("input-delay", verdict="unknown")):
        for line in format_report(with_experiment(base)).splitlines():
            assert len(line) <= 96
            assert not line.strip().startswith(("%", "±"))


def test_control_characters_of_a_file_do_not_reach_the_terminal():
    base = report("input-delay") | {"screen": ["odd\x1b[2Jname\x07"]}
    text = format_report(base)
    assert "\x1b" not in text
    assert "\x07" not in text
    assert "odd [2Jname" in text


def test_formatting_does_not_change_the_report():
    base = with_experiment(report("input-delay", "load-step"))
    before = copy.deepcopy(base)
    assert format_report(base) == format_report(base)
    assert base == before


def test_unrepeated_levels_are_reported_with_the_simulation_error():
    base = with_plateaus(report("output-drift"), left=0.1)
    (said,) = sentences.record_sentences(base)
    assert said == (
        "The output does not come back to the same level. It should. Between these levels the simulation error "
        "varies by 0.0400 rms; over the whole record it is 0.0500 rms. With the cause added, this variation is "
        "0.00400 rms."
    )
    assert said in _one_line(format_report(base))
    base = with_plateaus(report("output-drift"), left=0.0)
    assert sentences.record_sentences(base)[0].endswith("With the cause added, this variation is no larger than noise.")
    base = with_plateaus(report("output-drift", verdict="unknown"), left=0.6)
    assert "No effect tried explains this." in sentences.record_sentences(base)[0]
    assert sentences.verdict_sentence(base).endswith("the output settles at different levels.")


def test_without_record_findings_the_row_is_absent():
    assert sentences.record_sentences(report("output-drift")) == []
    assert "\nrecord" not in format_report(report("output-drift"))


def test_the_remaining_probability_of_other_causes_is_reported():
    base = report("input-delay", verdict="unknown")
    assert sentences.other_causes_sentence(base).endswith("the first row is only the best candidate.")
    for row in base["ranking"]:
        row["probability"] *= 0.3
    assert sentences.other_causes_sentence(base).endswith("The remaining 70 % is for causes that are not in the table.")
    assert sentences.other_causes_sentence(report("input-delay")) == ""
