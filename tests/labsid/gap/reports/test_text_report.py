"""The text report, for every effect and verdict."""

import copy

import pytest
from gap_reports import (
    PARAMETERS,
    UNSIMULATED,
    effect,
    report,
    with_experiment,
    with_holdout,
    with_plateaus,
    with_rest,
)
from hypothesis import given
from hypothesis import strategies as st

from labsid.gap.reports import sentences
from labsid.gap.reports.effect_texts import REMAINING_ERRORS, clause, noun
from labsid.gap.reports.location_text import location_sentences
from labsid.gap.reports.text_report import format_report
from labsid.gap.verdict import baseline_choice
from labsid.gap.verdict.black_boxes import KINDS


def _one_line(text):
    return " ".join(text.split())


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
    base["gap"] |= {"before": 0.0102, "after": 0.0102, "closed": None, "ci95": None}
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
    assert "where A dead zone: between the command and the process. " in _one_line(format_report(base))


def test_two_effects_are_said_in_clauses_and_three_by_their_names():
    said = sentences.verdict_sentence(report("input-delay", "extra-lag"))
    assert "late (a transport delay), and there is an additional lag" in said
    said = sentences.verdict_sentence(report("input-delay", "extra-lag", "output-drift"))
    assert said.startswith("A transport delay, an extra lag and a drift of the sensor act: together they explain 97 %")


@pytest.mark.parametrize(
    ("closed", "ci95", "end"),
    [
        (0.3, [0.1, 0.5], "a transport delay explains only 30 % [10, 50] of the gap."),
        (0.3, [-0.2, 0.8], "a transport delay explains only 30 % [0, 80] of the gap, possibly none."),
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
    base["unexplained"] |= {"whiteness_p": 0.0, "input_correlation_p": 1e-9, "repeats": 0.3}
    text = _one_line(format_report(base))
    assert text.startswith(
        "None of the 9 effects tried explains the gap: none reduces it on held-out samples by more than chance."
    )
    assert "tried Extra lag, backlash, transport delay, drift of the sensor, lightly damped mode, logger" in text
    assert "The rms simulation error is 0.0644; the noise, with what no model predicts, is 0.0100" in text
    assert "100 % of the gap remains; with the noise, 0.0101 rms" in text
    assert "It depends on past inputs (p < 0.001)" in text
    assert "After like inputs it is alike (correlation 0.30), unlike noise" in text
    assert "Only white noise" not in text


def test_unknown_says_which_kind_of_model_predicts_the_error():
    text = _one_line(format_report(with_rest(report("input-delay", verdict="unknown"), "nonlinear")))
    assert "Of the error beyond white noise, 67 % follows the input through nonlinear dynamics." in text
    assert text.endswith(f"next {REMAINING_ERRORS['nonlinear'].look}")


@pytest.mark.parametrize("verdict", ["effect", "none"])
def test_a_complete_explanation_leaves_nothing_to_look_for(verdict):
    base = with_rest(report(*["input-delay"] * (verdict == "effect"), verdict=verdict), "linear")
    assert "remains" not in sentences.verdict_sentence(base)
    assert sentences.look_sentence(base) is None
    base["unexplained"] |= {"whiteness_p": 0.5, "input_correlation_p": 0.5}
    assert sentences.kinds_sentence(base) is None
    assert "Only white noise remains." in sentences.residual_sentences(base)


PART = "explains 97 % [94, 100] of the gap."


def test_a_single_effect_explains_a_part():
    said = sentences.verdict_sentence(with_rest(report("coulomb-friction", verdict="partial"), "linear"))
    assert said == (
        f"{clause(effect('coulomb-friction'))}: dry friction {PART} Of the error beyond white noise that "
        "remains, 70 % follows the input through further linear dynamics."
    )


def test_several_effects_explain_a_part_together():
    base = report("input-dead-zone", "load-step", "resonance", verdict="partial")
    said = sentences.headline(base)
    assert said == (
        "A dead zone, a load step and a lightly damped mode act. Together they explain 97 % [94, 100] of the gap."
    )
    base["effects"][1]["probability"] = 0.7
    assert "A dead zone, a load step (70 %) and a lightly damped mode act." in sentences.headline(base)
    base["effects"][1]["probability"], base["effects"][2]["probability"] = 0.7, 0.2
    said = sentences.headline(base)
    assert (
        ", and probably an unmeasured load starts at 374.2 s and changes the output by -0.210 (a load step, 70 %)"
        in said
    )
    assert said.endswith(
        "Together with a lightly damped mode (20 %), less certain, they explain 97 % [94, 100] of the gap."
    )
    base["effects"][1]["probability"] = 0.4
    assert sentences.headline(base) == (
        "The actuator does not move between 0.458 and 0.875 (a dead zone). Together with a load step (40 %) and a "
        f"lightly damped mode (20 %), less certain, this {PART}"
    )


def test_effects_that_are_less_probable_than_not_are_not_said_to_act():
    base = report("input-delay", verdict="partial", probability=0.3)
    assert sentences.headline(base) == (
        "The cause is not known: a transport delay (30 %) explains 97 % [94, 100] of the gap, but may only imitate it."
    )
    assert sentences.place_sentence(base) is None
    assert "possible   a transport delay (input-delay), probability 30 %" in format_report(base)
    base = report("input-delay", "resonance", verdict="partial", probability=0.3)
    assert sentences.headline(base) == (
        "The cause is not known: a transport delay (30 %) and a lightly damped mode (30 %) explain 97 % [94, 100] of "
        "the gap, but may only imitate it."
    )


def test_a_part_without_a_closed_share_is_given_in_errors():
    base = report("input-delay", verdict="partial")
    base["gap"] |= {"closed": None, "ci95": None}
    assert sentences.headline(base).endswith(
        "a transport delay reduces the rms simulation error from 0.0644 to 0.0102."
    )


def test_the_texts_on_the_rest_are_those_of_the_black_boxes():
    assert tuple(REMAINING_ERRORS) == KINDS


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_rest_is_said_with_its_share_and_what_to_look_at(kind):
    base = with_rest(report("input-delay", verdict="partial"), kind)
    texts, share = REMAINING_ERRORS[kind], f"{100 * base['unexplained']['kinds'][kind]:.0f} %"
    said = sentences.remaining_sentence(base)
    assert said == f"Of the error beyond white noise that remains, {share} {texts.what}."
    text = _one_line(format_report(base))
    assert said in text
    assert f"The error beyond white noise by kind: {texts.label} {share}" in text
    assert text.endswith(f"next {texts.look}")
    assert "Only white noise remains" not in text


@pytest.mark.parametrize("verdict", ["partial", "unknown"])
@given(shares=st.lists(st.floats(0.0, 1.0), min_size=len(KINDS), max_size=len(KINDS)).filter(lambda x: sum(x) > 0.1))
def test_the_sentence_on_the_rest_and_the_shares_by_kind_agree(verdict, shares):
    base = with_rest(report("input-delay", verdict=verdict), "time")
    kinds = {kind: share / sum(shares) for kind, share in zip(KINDS, shares, strict=True)}
    base["unexplained"]["kinds"] = kinds
    largest = max(kinds, key=kinds.__getitem__)
    said = sentences.remaining_sentence(base)
    assert f"{100 * kinds[largest]:.0f} %" in said
    assert REMAINING_ERRORS[largest].what in said
    assert REMAINING_ERRORS[largest].label in sentences.kinds_sentence(base)
    assert sentences.look_sentence(base) == REMAINING_ERRORS[largest].look


def test_a_residual_that_nothing_foretells_is_not_said_to_repeat():
    base = with_rest(report("input-delay", verdict="partial"), "disturbance")
    base["unexplained"]["repeats"] = 0.3
    assert "After like inputs" not in format_report(base)


def test_a_rest_of_no_kind_is_still_said():
    base = report("input-delay", verdict="partial")
    assert sentences.remaining_sentence(base) == "Something else remains."
    assert sentences.kinds_sentence(base) is None
    assert "Only white noise remains" not in format_report(base)


@pytest.mark.parametrize(
    ("kind", "end"), [("disturbance", "but they predict only a part of it."), ("linear", "is missing.")]
)
def test_the_test_on_past_inputs_does_not_contradict_the_kind_of_the_rest(kind, end):
    base = with_rest(report("input-delay", verdict="partial"), kind)
    (said,) = (text for text in sentences.residual_sentences(base) if "past inputs" in text)
    assert said.endswith(end)
    base["unexplained"]["kinds"][kind] = 0.9
    (said,) = (text for text in sentences.residual_sentences(base) if "past inputs" in text)
    assert said.endswith(end.replace("a part", "a small part"))


def test_the_methods_of_the_linear_model_are_those_of_its_choice():
    assert sentences.OUTPUT_ERROR == baseline_choice.OUTPUT_ERROR
    assert sentences.FIRST_ORDER == baseline_choice.FIRST_ORDER


@pytest.mark.parametrize(
    ("method", "observed", "words"),
    [
        ("output error of first order", True, "The record does not support a linear model of the order asked for"),
        ("least squares", True, "The linear model was fitted by least squares, one step ahead"),
        ("output error", False, "the rig may be of lower order, or may integrate its input."),
        ("output error of first order", False, "model of the order asked for. The model used is of first order."),
        ("least squares", False, "asked for. The model used is fitted by least squares, one step ahead."),
    ],
)
def test_a_linear_model_other_than_asked_for_is_said(method, observed, words):
    base = report("input-delay", verdict="partial")
    assert sentences.baseline_sentence(base) is None
    base["simulation"]["model"] = {"method": method, "observed": observed}
    assert words in sentences.baseline_sentence(base)
    assert words in _one_line(format_report(base))
    assert sentences.baseline_sentence(report("parameter-mismatch")) is None


def test_a_set_is_named_as_one_and_not_twice():
    base = report("input-delay", probability=0.58) | {"ambiguous": ["input-rate-limit", "extra-lag"]}
    assert sentences.ambiguity_sentence(base) == (
        "The record does not rule out a rate limit of the actuator or an extra lag instead. Probability: "
        "a transport delay 58 %."
    )
    base["ranking"] = [{"name": "extra-lag", "probability": 0.31}, {"name": "input-rate-limit", "probability": 0.02}]
    assert sentences.ambiguity_sentence(base).endswith("Probability: a transport delay 58 % and an extra lag 31 %.")
    base["effects"][0]["chance"] = "possible"
    assert sentences.ambiguity_sentence(base).endswith("instead. A transport delay is possible.")
    part = report("input-delay", "load-step", verdict="partial") | {"ambiguous": ["extra-lag"]}
    assert sentences.ambiguity_sentence(part).startswith(
        "The record does not rule out an extra lag in the place of one of the effects. Probability: a transport delay"
    )
    none = report(verdict="none") | {"ambiguous": ["extra-lag"]}
    assert sentences.ambiguity_sentence(none) == "The record does not rule out an extra lag."


@pytest.mark.parametrize(("sides", "expected"), [(("high",), True), (("low", "high"), False)])
def test_a_dead_zone_with_one_edge_and_a_limit_are_told_apart_beyond_zero(sides, expected):
    base = report("input-dead-zone") | {"ambiguous": ["input-saturation"]}
    (found,) = base["effects"]
    found["parameters"] = {side: found["parameters"][side] for side in sides}
    assert ("other side of zero tell them apart" in sentences.ambiguity_sentence(base)) is expected
    assert "other side" not in sentences.ambiguity_sentence(base | {"ambiguous": ["input-backlash"]})


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
    for cell, share in zip(base["where"]["operating"], (0.2, 0.28, 0.52), strict=True):
        cell["share"] = share
    assert (
        location_sentences(base)[2] == "Over the range of u, the gap is in proportion to the time spent at each value."
    )


def test_a_gap_at_both_ends_of_a_range_is_said_to_be_there():
    base = report("input-saturation")
    shares, times = (0.47, 0.02, 0.05, 0.1, 0.36), (0.27, 0.15, 0.2, 0.23, 0.15)
    base["where"]["operating"] = [
        {"signal": "u", "low": float(i), "high": i + 1.0, "share": share, "time": time}
        for i, (share, time) in enumerate(zip(shares, times, strict=True))
    ]
    assert location_sentences(base)[2] == (
        "83 % of it lies where u is between 0 and 1 or between 4 and 5, in which the record spends 42 % of its time."
    )


def test_a_given_holdout_is_named_as_the_basis_of_the_score():
    base = report("input-delay")
    assert "held-out samples" in sentences.gap_sentence(base)
    assert "holdout record" in sentences.gap_sentence(with_holdout(base))


def test_a_headline_names_no_effect_under_ten_per_cent():
    base = report("input-dead-zone", "resonance", "output-drift", verdict="partial")
    for one, probability in zip(base["effects"], (0.95, 0.2, 0.01), strict=True):
        one["probability"] = probability
    said = sentences.headline(base)
    assert "Together with a lightly damped mode (20 %) and one further effect, less certain, this explains" in said
    base["effects"][1]["probability"] = 0.05
    assert "Together with 2 further effects, less certain, this explains" in sentences.headline(base)


def test_improbable_effects_that_imitate_a_gap_are_counted():
    base = with_rest(report("resonance", "output-drift", verdict="partial", probability=0.03), "time")
    assert "not known: 2 improbable effects explain 97 %" in sentences.headline(base)
    base["effects"][0]["probability"] = 0.3
    assert "not known: a lightly damped mode (30 %) and one further effect explain 97 %" in sentences.headline(base)


def test_improbable_effects_that_may_close_nothing_have_no_share():
    """The share of an error beyond noise, of which an unknown part is no noise."""
    base = with_rest(report("resonance", verdict="partial", probability=0.03), "time")
    base["gap"]["ci95"] = [-0.2, 1.0]
    assert "one improbable effect reduces the rms simulation error from 0.0644 to 0.0102" in sentences.headline(base)
    base["effects"][0]["probability"] = 0.7
    assert "possibly none" in sentences.headline(base)


def test_noise_that_no_model_predicts_is_not_called_the_noise():
    base = with_rest(report("load-step", verdict="partial"), "disturbance")
    base["unexplained"] |= {"share": 0.0, "rms": 0.0102, "colour": 4.0}
    assert sentences.remaining_sentence(base).startswith("Of the error beyond white noise that remains, ")


def test_white_noise_on_the_fitted_samples_alone_is_said_so():
    base = report("input-off")
    assert "Only white noise remains." in sentences.residual_sentences(base)
    base["gap"]["after"] = 3.0 * base["gap"]["noise_floor"]
    assert "Only white noise remains on the samples that were fitted." in sentences.residual_sentences(base)


def test_the_slowest_pole_is_not_determined_without_the_cause():
    base = report("input-dead-zone")
    base["simulation"] = base["simulation"] | {"model": {"method": "output error of first order", "observed": False}}
    said = sentences.baseline_sentence(base)
    assert said.startswith("Without the cause, the record does not determine the slowest pole")
    assert sentences.baseline_sentence(base | {"verdict": "unknown"}).startswith("The record does not determine")


def test_coefficients_that_are_known_together_are_not_each_told_from_zero():
    base = report("input-nonlinearity")
    rows = base["effects"][0]["parameters"]
    for name in ("c2", "c3"):
        rows[name] |= {"value": 0.1, "stderr": 0.3}
    text = " ".join(format_report(base).split())
    assert text.count("determined together only") == 2
    rows["c2"] |= {"value": 0.9}
    text = " ".join(format_report(base).split())
    assert "together only" not in text
    assert text.count("not told from zero") == 1


def test_what_remains_of_a_closed_gap_is_no_part_of_it():
    base = with_rest(report("load-step", verdict="partial"), "disturbance")
    assert sentences.remaining_sentence(base).startswith("Of the error beyond white noise that remains, ")
    base["unexplained"]["share"] = 0.004  # printed as "100 % of the gap" beside it
    assert sentences.remaining_sentence(base).startswith("What remains is as small as the noise, but not white: ")


def test_a_parameter_that_may_be_zero_is_marked():
    base = report("load-step")
    base["effects"][0]["parameters"]["size"] |= {"value": -0.0004, "stderr": 0.3}
    text = " ".join(format_report(base).split())
    assert "settled change of the output 0.00 ± 0.30 units of y, not told from zero" in text
    assert "-0.0" not in text


def test_lines_are_as_wide_as_the_terminal_with_bars_of_the_errors(monkeypatch):
    shown = report("output-nonlinearity", "resonance", verdict="partial")
    for columns, widest in ((80, 80), (200, 96)):
        monkeypatch.setenv("COLUMNS", str(columns))
        lines = format_report(shown).splitlines()
        assert widest - 15 < max(map(len, lines)) <= widest
        before, after = (
            next(line for line in lines if line.strip().startswith(f"{word} ")) for word in ("Before", "After")
        )
        assert before.count("#") > 5.0 * after.count("#") > 0
        assert before.endswith("  0.0644")
        assert after.endswith("  0.0102")


def test_the_name_of_a_record_keeps_its_letters_in_a_finding():
    base = report("output-saturation")
    base["records"] = [{"name": "run-1"}]
    base["record_findings"] = [{"topic": "clip", "level": "warning", "text": "run-1: y is stuck at 5%"}]
    assert sentences.record_sentences(base) == ["run-1: y is stuck at 5 %"]


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
        "varies by 0.0400 rms; over the whole record it is 0.0500 rms. After adding the cause, this variation is "
        "0.00400 rms."
    )
    assert said in _one_line(format_report(base))
    base = with_plateaus(report("output-drift"), left=0.0)
    assert sentences.record_sentences(base)[0].endswith(
        "After adding the cause, this variation is no larger than noise."
    )
    base = with_plateaus(report("output-drift", verdict="unknown"), left=0.6)
    assert sentences.record_sentences(base)[0].endswith("No effect tried explains this.")
    assert sentences.verdict_sentence(base).endswith("the output settles at different levels.")


def test_without_record_findings_the_row_is_absent():
    assert sentences.record_sentences(report("output-drift")) == []
    assert "\nrecord" not in format_report(report("output-drift"))


def test_the_ranking_is_introduced_by_what_it_compares():
    assert "probabilities compare the candidates" in sentences.ranking_sentence(report("input-delay"))
    assert sentences.ranking_sentence(report(verdict="none")).endswith("On this record none is needed.")
    unknown = report("input-delay", verdict="unknown")
    assert sentences.ranking_sentence(unknown).endswith("None reduces this error by more than chance.")
    part = report("input-delay", verdict="partial")
    said = sentences.ranking_sentence(part)
    assert said.endswith("The accepted effect reduces this error by more than chance.")
    assert "its error is that on held-out samples" in said
    part["ranking"][1]["rmse"] = 0.001
    assert sentences.ranking_sentence(part).endswith("Candidates with a smaller error contain an effect that does not.")
    assert "on the holdout record" in sentences.ranking_sentence(with_holdout(part))
