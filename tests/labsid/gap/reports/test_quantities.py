"""Formatting of numbers in the report."""

import pytest

from labsid.gap.reports.quantities import (
    Quantity,
    between,
    closed_percent,
    number,
    p_value,
    percent,
    probability,
    unit_in_words,
    with_error,
)


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (0.0, "0"),
        (0.0644, "0.0644"),
        (12.3129, "12.3"),
        (3743.25, "3743"),
        (0.09996, "0.100"),
        (-0.5117, "-0.512"),
        (2.5e-7, "2.50e-07"),
        (4.2e7, "4.20e+07"),
    ],
)
def test_three_digits_and_whole_numbers_in_full(value, written):
    assert number(value) == written


@pytest.mark.parametrize(
    ("value", "stderr", "written"),
    [
        (0.45802, 0.00125, "0.4580 ± 0.0013"),
        (3743.84, 1.96, "3743.8 ± 2.0"),
        (262.0, 848.0, "262 ± 848"),
        (6.018e-5, 3.77e-6, "(6.02 ± 0.38)e-05"),
        (5.2e7, 3.0e5, "(5.200 ± 0.030)e+07"),
        (0.01295, 0.0, "0.01295"),
        (6.400273312, 4e-11, "6.4003"),
        (1.0, 1e-12, "1.0000"),
    ],
)
def test_the_error_sets_the_digits(value, stderr, written):
    assert with_error(value, stderr) == written


def test_shares_and_probabilities_are_never_more_certain_than_they_are():
    assert [percent(x) for x in (0.0061, 0.19, 1.0, -0.596, 0.0)] == ["0.61 %", "19 %", "100 %", "-60 %", "0 %"]
    assert [probability(p) for p in (1.0, 0.994, 0.43, 0.001)] == ["over 99 %", "99 %", "43 %", "under 1 %"]
    assert [p_value(p) for p in (1e-27, 0.42, 1.0)] == ["p < 0.001", "p = 0.42", "p > 0.99"]


def test_the_closed_share_with_its_interval():
    assert closed_percent(0.969, [0.939, 1.0]) == "97 % [94, 100]"
    assert closed_percent(-0.165, [-1.31, 0.406]) == "-16 % [-131, 41]"
    assert closed_percent(-0.001) == "0 %"


def test_a_range_is_no_finer_than_a_hundredth_of_its_width():
    assert between(21.199999, 42.5) == ("21", "42")
    assert between(0.0312499, 0.0625) == ("0.031", "0.062")
    assert between(-0.00001, 2.0) == ("0", "2")
    assert between(5.0, 5.0) == ("5", "5")


def test_a_sentence_keeps_seconds_and_hertz_and_leaves_out_the_record_s_own_units():
    assert f"{Quantity(0.43394, 0.00035, 's')}" == "0.4339 s"
    assert f"{Quantity(0.45802, 0.00125, 'u')}" == "0.458"
    assert f"{Quantity(-0.597, 0.001, '1'):%}" == "-60 %"


@pytest.mark.parametrize(
    ("unit", "pair", "words"),
    [
        ("y/u", {}, "units of y for a unit of u"),
        ("y/u", {"names": {"u": "valve", "y": "level"}}, "units of level for a unit of valve"),
        ("y/u", {"names": {"u": "valve", "y": "level"}, "units": {"y": "cm"}}, "cm for a unit of valve"),
        ("1/u^2", {"names": {"u": "valve", "y": "level"}, "units": {"u": "V"}}, "per V²"),
        ("y/u", {"names": {"u": "valve", "y": "level"}, "units": {"u": "V", "y": "cm"}}, "cm/V"),
        ("s", {"names": {"u": "valve", "y": "level"}}, "s"),
        ("units of force", {"names": {"u": "units of u", "y": "y"}}, "units of force"),
        ("1", {"units": {"u": "V", "y": "cm"}}, ""),
    ],
)
def test_a_unit_has_the_names_and_the_units_of_the_columns(unit, pair, words):
    assert unit_in_words(unit, pair) == words
