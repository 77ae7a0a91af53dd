"""What lateness costs: the language of rules, and exact decimals."""

import contextlib
import re
from datetime import UTC, datetime, timedelta
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from autograder.results.late import LATE_WITHOUT_TIME, LatePenalty, late_penalty, parse_rules, read_timestamp

RULE = "due=2026-11-30T23:59,grace=2h,per-day=10%,most=50%"
DUE = datetime(2026, 11, 30, 23, 59, tzinfo=UTC)
MINUTE, HOUR, DAY = timedelta(minutes=1), timedelta(hours=1), timedelta(days=1)


def penalty(rule: str, submitted: datetime | None, marks: str = "2", assignment: str = "lab") -> Decimal:
    return late_penalty(parse_rules(rule), assignment, submitted, Decimal(marks)).penalty


@pytest.mark.parametrize(
    ("after", "taken_off"),
    [
        (-DAY, "0"),
        (timedelta(0), "0"),
        (2 * HOUR, "0"),  # the grace is included
        (2 * HOUR + timedelta(microseconds=1), "0.2"),  # and lateness counts from when it was due
        (DAY, "0.2"),
        (DAY + MINUTE, "0.4"),
        (4 * DAY + MINUTE, "1"),
        (400 * DAY, "1"),
    ],
)
def test_every_started_day_costs(after: timedelta, taken_off: str) -> None:
    assert penalty(RULE, DUE + after) == Decimal(taken_off)


def test_decimals_are_exact() -> None:
    assert penalty("due=2026-11-30T23:59,per-day=10%", DUE + 2 * DAY + MINUTE, "0.3") == Decimal("0.09")
    assert penalty("due=2026-11-30T23:59,per-day=0.1", DUE + 2 * DAY + MINUTE) == Decimal("0.3")
    assert penalty("due=2026-11-30T23:59,per-day=0.1,most=0.25", DUE + 9 * DAY) == Decimal("0.25")
    assert penalty("due=2026-11-30T23:59,per-day=5", DUE + 9 * DAY) == Decimal("2")


def test_the_student_is_told_how_late_and_what_it_costs() -> None:
    late = late_penalty(parse_rules(RULE), "lab", DUE + DAY + 3 * HOUR + MINUTE, Decimal("2"))
    assert late == LatePenalty(
        Decimal("0.4"), "Handed in 1 d 3 h 1 min late: 0.4 of 2 marks deducted (10 % per started day)."
    )
    assert late_penalty(parse_rules(RULE), "lab", DUE, Decimal("2")).reason == ""


def test_an_extension_takes_the_place_of_the_due_date() -> None:
    rules, own = parse_rules(RULE), DUE + 5 * DAY
    assert late_penalty(rules, "lab", own + 2 * HOUR, Decimal(2), own) == LatePenalty(Decimal(0), "")
    late = late_penalty(rules, "lab", own + 3 * HOUR, Decimal(2), own)
    assert late.penalty == Decimal("0.2")
    assert late.reason == "Handed in 3 h after the extension: 0.2 of 2 marks deducted (10 % per started day)."
    assert late_penalty({}, "lab", own + DAY, Decimal(2), own).penalty == 0


def test_the_example_of_the_guide_is_right() -> None:
    guide = (Path(__file__).parents[3] / "autograder" / "README.md").read_text(encoding="utf-8")
    taken_off = re.findall(r"^\| (Monday|Tuesday|a week).*\| ([\d.]+|nothing) \|$", guide, re.MULTILINE)
    rule = "due=2026-11-16T09:00,grace=2h,per-day=10%,most=50%"
    after = (HOUR + 59 * MINUTE, 2 * HOUR + MINUTE, DAY + MINUTE, 7 * DAY)
    due = datetime(2026, 11, 16, 9, tzinfo=UTC)
    found = [penalty(rule, due + one, "1") for one in after]
    assert [(Decimal(0) if said == "nothing" else Decimal(said)) for _, said in taken_off] == found


def test_a_hand_in_without_a_time_is_not_late() -> None:
    assert penalty(RULE, None) == 0
    found = late_penalty(parse_rules(RULE), "lab", None, Decimal(2))
    assert found.reason == "The time of the hand-in is not known; nothing was deducted."
    assert late_penalty({}, "lab", None, Decimal(2)).reason == ""


def test_a_hand_in_that_the_platform_calls_late_without_a_time_is_said_and_costs_nothing() -> None:
    found = late_penalty(parse_rules(RULE), "lab", None, Decimal(2), told_late=True)
    assert found == LatePenalty(Decimal(0), LATE_WITHOUT_TIME)
    assert late_penalty({}, "lab", None, Decimal(2), told_late=True).reason == ""
    timed = late_penalty(parse_rules(RULE), "lab", DUE, Decimal(2), told_late=True)  # the time decides
    assert timed.reason == ""


def test_an_assignment_may_have_its_own_rule() -> None:
    rules = f"{RULE}; lab-identification: due=2026-12-24T12:00,per-day=100%"
    assert penalty(rules, DUE + DAY, assignment="prelab-sinusoids") == Decimal("0.2")
    assert penalty(rules, DUE + DAY, assignment="lab-identification") == 0
    assert penalty("other: due=2026-01-01,per-day=1", DUE, assignment="lab") == 0


@pytest.mark.parametrize(
    "due", ["2026-12-01T10:59+11:00", "2026-12-01T10:59,tz=Australia/Sydney", "2026-11-30T23:59", "2026-11-30T23:59Z"]
)
def test_due_has_a_zone(due: str) -> None:
    assert parse_rules(f"due={due},per-day=1")[""].due == DUE


@pytest.mark.parametrize(
    ("rules", "said"),
    [
        ("", "--late is empty"),
        (" ; ", "--late is empty"),
        ("per-day=10%", "--late needs due"),
        ("due=2026-11-30", "--late needs per-day"),
        ("due=soon,per-day=10%", "due=soon is not a time"),
        ("due=2026-11-30,per-day=much", "per-day=much is not an amount"),
        ("due=2026-11-30,per-day=-1%", "per-day=-1% is not an amount"),
        ("due=2026-11-30,per-day=nan", "per-day=nan is not an amount"),
        ("due=2026-11-30,per-day=1e99", "per-day=1e99 is not an amount"),
        ("due=2026-11-30,per-day=1,per-day=2", "per-day twice"),
        ("due=2026-11-30,per-day=1,grace=2", "grace=2 is not a duration"),
        ("due=2026-11-30,per-day=1,bonus=2", "got 'bonus=2', expected one of due, tz, grace, per-day, most"),
        ("due=2026-11-30,per-day", "got 'per-day', expected one of"),
        ("due=2026-11-30,per-day=1,tz=Mars/Base", "the time zone Mars/Base is not known"),
        ("due=2026-11-30,per-day=1,tz=../x", "the time zone ../x is not known"),
        ("due=2026-11-30T10:00+01:00,per-day=1,tz=UTC", "has an offset, and there is also tz"),
        ("due=9999-12-31T23:59,per-day=1,grace=9d", "beyond the year 9999"),
        ("due=2026-11-30,per-day=1;due=2026-11-30,per-day=1", "two rules for all assignments"),
    ],
)
def test_a_rule_that_is_none_is_said(rules: str, said: str) -> None:
    with pytest.raises(ValueError, match=re.escape(said)):
        parse_rules(rules)


@given(st.text(max_size=80) | st.from_regex(r"(due|tz|grace|per-day|most|x)=[\w:%+.-]*(,|;|$)", fullmatch=False))
def test_any_text_is_read_or_refused(text: str) -> None:
    with contextlib.suppress(ValueError):
        assert late_penalty(parse_rules(text), "lab", DUE, Decimal(2)).penalty >= 0


amounts = st.decimals(0, 100, allow_nan=False, places=2)


@given(
    days=st.integers(0, 40), minutes=st.integers(0, 1439), grace=st.integers(0, 99), per_day=amounts, most=amounts,
    share=st.booleans(), marks=st.decimals(0, 20, places=2),
)  # fmt: skip
def test_a_penalty_never_grows_beyond_the_marks_nor_shrinks_with_time(
    days: int, minutes: int, grace: int, per_day: Decimal, most: Decimal, share: bool, marks: Decimal
) -> None:
    unit = "%" if share else ""
    rules = parse_rules(f"due=2026-11-30T23:59,grace={grace}h,per-day={per_day}{unit},most={most}{unit}")
    submitted = DUE + days * DAY + minutes * MINUTE
    earlier = late_penalty(rules, "lab", submitted, marks).penalty
    later = late_penalty(rules, "lab", submitted + DAY, marks).penalty
    assert 0 <= earlier <= later <= marks
    assert later <= (most / 100 * marks if share else most)
    if submitted <= DUE + grace * HOUR:
        assert earlier == 0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2026-11-30 23:59:00.000000 UTC", DUE),
        ("2026-11-30 23:59:00", DUE),
        ("2026-11-30T23:59Z\n", DUE),
        ("2026-12-01 10:59 Australia/Sydney", DUE),
        ("2026-12-01 10:59:00 +1100", DUE),
        ("yesterday", None),
        ("", None),
        ("2026-11-30 23:59 Mars/Base", None),
        ("2026-13-30 23:59 UTC", None),
        ("0001-01-01 00:00 +11:00", None),
    ],
)
def test_a_timestamp_is_read_as_nbgrader_writes_it(text: str, expected: datetime | None) -> None:
    assert read_timestamp(text) == expected


@given(st.text(max_size=60))
def test_any_timestamp_is_read_or_none(text: str) -> None:
    found = read_timestamp(text)
    assert found is None or found.tzinfo is UTC
