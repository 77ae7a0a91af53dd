"""What a record could have shown, in the report: rows, table and sentences."""

import json
from dataclasses import replace

import pytest
from gap_reports import limits_row, report, with_limits

from labsid.gap.limits.smallest_sizes import Limits
from labsid.gap.reports.html_report import page_content
from labsid.gap.reports.limit_rows import (
    NOT_SHOWN,
    as_rows,
    hidden_sentences,
    limit_cells,
    limits_sentence,
    short_noun,
)
from labsid.gap.reports.quantities import with_units
from labsid.gap.reports.text_report import format_limits, format_report

BACKLASH = Limits(
    name="input-backlash",
    parameter="width",
    unit="u",
    whole="u",
    detect=0.02,
    named=0.05,
    excluded=0.01,
    shares={"detect": 0.004, "named": 0.01, "excluded_above": 0.002},
    rival="coulomb-friction",
    at={},
)


def test_a_row_has_the_keys_of_the_contract():
    (row,) = as_rows([BACKLASH])
    assert row == limits_row("input-backlash")
    assert list(row)[:10] == [
        *("name", "signal", "parameter", "unit", "detect", "named", "rival", "excluded_above", "why", "tested"),
    ]
    json.dumps(row)


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        (
            {"reason": "levels", "named": None},
            "The input has too few levels. Needed: Changes of direction",
        ),
        ({"reason": "closed", "named": None}, "The simulation can only be run as a whole"),
        ({"reason": "beside", "named": None}, "It cannot be combined with the dynamics of what was found."),
        ({"reason": "hidden", "named": None}, "A refit of the simulation hides it here, at every size that was tried."),
        ({"named": None}, "It looks like dry friction here, at every size that was tried. Needed: Changes of"),
        ({"named": None, "rival": None}, "It is not told from others here"),
    ],
)
def test_why_an_effect_is_not_shown(changes, why):
    (row,) = as_rows([replace(BACKLASH, **changes)])
    assert row["why"].startswith(why)


def test_the_signal_is_the_one_that_an_effect_acts_on():
    names = ("input-backlash", "output-backlash", "extra-lag", "load-step")
    rows = as_rows([replace(BACKLASH, name=name) for name in names])
    assert [row["signal"] for row in rows] == ["u", "y", None, None]


def test_the_table_has_a_row_for_each_visible_effect_with_its_unit():
    base = with_limits(report(verdict="none"))
    assert limit_cells(base, str) == [
        ("input-backlash", "0.0200 u (0.40 %)", "1.0 %", "0.20 %", "coulomb-friction"),
        ("input-saturation, high", "0.0200 u (0.40 %)", "1.0 %", "0.20 %", NOT_SHOWN),
        ("input-saturation, low", "1.50 u (30 %)", NOT_SHOWN, NOT_SHOWN, "coulomb-friction"),
        ("input-delay", "0.0200 s (30 %)", NOT_SHOWN, "20 %", "coulomb-friction"),
        ("slow-mode", "0.40 %", "1.0 %", "0.20 %", "coulomb-friction"),
    ]
    stated = limit_cells(with_units(base, "V", "mm"), short_noun)
    assert stated[0] == ("Backlash", "0.0200 V (0.40 %)", "1.0 %", "0.20 %", "Dry friction")


def test_the_sentence_says_what_is_excluded():
    base = with_limits(report(verdict="none"))
    assert "A larger size than the last one is excluded at 95 %." in limits_sentence(base)
    nothing = base | {"limits": [row | {"excluded_above": None} for row in base["limits"]]}
    assert "Nothing is excluded, because more than noise is left" in limits_sentence(nothing)
    assert "The input is not applied yet" in limits_sentence(nothing | {"planned": True})
    assert limits_sentence(report(verdict="none")) is None


def test_what_is_hidden_is_listed_by_reason():
    base = with_limits(report(verdict="none"))
    assert hidden_sentences(base) == [
        "Transport delay: it looks like dry friction here, at every size that was tried. Needed: Other inputs.",
        "Extra lag: the input has two levels only.",
    ]


@pytest.mark.parametrize("verdict", ["none", "unknown", "effect", "partial"])
def test_the_text_has_the_table_where_nothing_is_named_and_the_page_always(verdict):
    shown = verdict in ("none", "unknown")
    base = with_limits(report(*(() if shown else ("load-step",)), verdict=verdict))
    text = format_report(base)
    assert ("visible from" in text) == shown
    assert max(map(len, text.splitlines())) <= 96
    assert page_content(base)["limits"]["open"] == shown
    assert len(page_content(base)["limits"]["rows"]) == 5
    assert page_content(report("load-step"))["limits"] is None


def test_the_table_of_the_command_names_the_record_and_the_plan():
    base = with_limits(report(verdict="none"))
    content = {"record": base["record"], "verdict": "none", "planned": False, "limits": base["limits"]}
    assert format_limits(content).startswith("rig-7: 240 samples, verdict none. What the record can show:\n")
    assert "a record with the planned input" in format_limits(content | {"planned": True})


def test_the_sides_of_an_effect_are_told_apart_where_they_do_not_show():
    rows = [
        limits_row("end-stop") | {"parameter": side, "detect": None, "why": why}
        for side, why in (("low", "It looks like an overflow here."), ("high", "A refit hides it here."))
    ]
    shown = report(verdict="none") | {"limits": rows}
    assert hidden_sentences(shown) == [
        "End stop (low): it looks like an overflow here.",
        "End stop (high): a refit hides it here.",
    ]
