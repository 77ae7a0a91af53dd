"""What a late hand-in costs: a small language of rules, and exact decimals.

::

    RULES   = RULE [";" RULE ...]
    RULE    = [ASSIGNMENT ":"] KEY "=" VALUE ["," KEY "=" VALUE ...]

    due=2026-11-30T23:59     when it is due (needed); with an offset (2026-11-30T23:59+11:00), in `tz`, or in UTC
    tz=Australia/Sydney      the time zone of `due`
    grace=2h                 nothing is taken off until then; after it, lateness still counts from `due`
    per-day=10%              what every started day of 24 hours costs: a share of the marks there are, or marks (0.2)
    most=50%                 the most that is taken off; unless given, all

Durations are a number and one of m, h, d. A rule with the name of an assignment is for that one; the one without, for
all that have no rule of their own. A hand-in without a known time is not late.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, tzinfo
from decimal import Decimal, InvalidOperation
from zoneinfo import ZoneInfo

from autograder.course.plain_text import plain_decimal

_KEYS = ("due", "tz", "grace", "per-day", "most")
_DAY = timedelta(days=1)
_DURATION = re.compile(r"(\d{1,5})([mhd])", re.ASCII)
_UNITS = {"m": "minutes", "h": "hours", "d": "days"}


@dataclass(frozen=True, slots=True)
class Deduction:
    """Marks, or a share of the marks there are.

    Attributes
    ----------
    amount : Decimal
        Not negative; of a share, 1 is all.
    of_all : bool
        Whether it is a share.
    """

    amount: Decimal
    of_all: bool

    def __str__(self) -> str:
        return f"{plain_decimal(self.amount * 100)} %" if self.of_all else plain_decimal(self.amount)

    def of(self, marks: Decimal) -> Decimal:
        """In marks, where there are that many."""
        return self.amount * marks if self.of_all else self.amount


@dataclass(frozen=True, slots=True)
class LateRule:
    """The rule of one assignment.

    Attributes
    ----------
    due : datetime
        In UTC.
    grace : timedelta
    per_day : Share
    most : Share
    """

    due: datetime
    grace: timedelta
    per_day: Deduction
    most: Deduction


LateRules = Mapping[str, LateRule]
"""By assignment; the rule of all others has the empty name."""


@dataclass(frozen=True, slots=True)
class LatePenalty:
    """What lateness cost one submission.

    Attributes
    ----------
    penalty : Decimal
        Marks taken off, at most all there are.
    reason : str
        In words, for the student; empty where it was not late.
    """

    penalty: Decimal
    reason: str


ON_TIME = LatePenalty(Decimal(0), "")


def parse_rules(text: str) -> LateRules:
    """Read the rules of ``--late``.

    Raises
    ------
    ValueError
        Names what is wrong, and what was expected.
    """
    rules: dict[str, LateRule] = {}
    for part in filter(None, (part.strip() for part in text.split(";"))):
        named = re.match(r"([\w-]+)\s*:\s*(?=[a-z-]+\s*=)", part)
        name = named[1] if named else ""
        if name in rules:
            raise ValueError(f"--late has two rules for {name or 'all assignments'}; give one.")
        rules[name] = _parse_rule(part[named.end() :] if named else part)
    if not rules:
        raise ValueError("--late is empty; expected such as due=2026-11-30T23:59,per-day=10%.")
    return rules


def late_penalty(rules: LateRules, assignment: str, submitted: datetime | None, marks: Decimal) -> LatePenalty:
    """What lateness costs a submission.

    Parameters
    ----------
    rules : mapping
        As `parse_rules` gives them.
    assignment : str
    submitted : datetime or None
        When it was handed in, in UTC; None where that is not known.
    marks : Decimal
        The marks that the assignment has.
    """
    rule = rules.get(assignment, rules.get(""))
    if rule is None or submitted is None or submitted <= rule.due + rule.grace:
        return ON_TIME
    over = submitted - rule.due
    days = -(-over // _DAY)
    penalty = min(days * rule.per_day.of(marks), rule.most.of(marks), marks)
    return LatePenalty(
        penalty,
        f"Handed in {_duration_text(over)} late: {plain_decimal(penalty)} of {plain_decimal(marks)} marks taken off "
        f"({rule.per_day} a started day).",
    )


def read_timestamp(text: str) -> datetime | None:
    """Read nbgrader's ``timestamp.txt``, such as ``2026-11-30 15:58:23.948203 UTC``, in UTC; None where it is none.

    Without a zone it is UTC, as for nbgrader.
    """
    found = re.match(r"\s*(\d{4}-\d{2}-\d{2}[T ]\d{2}:\d{2}(?::\d{2}(?:\.\d{1,6})?)?)\s*(\S*)\s*$", text[:200])
    if found is None:
        return None
    try:
        when = datetime.fromisoformat(found[1])
        zone = found[2]
        if re.fullmatch(r"[+-]\d{2}:?\d{2}", zone):
            return datetime.fromisoformat(f"{when.isoformat()}{zone}").astimezone(UTC)
        return when.replace(tzinfo=time_zone(zone) if zone not in ("", "Z") else UTC).astimezone(UTC)
    except (ValueError, OverflowError):
        return None


def _parse_rule(text: str) -> LateRule:
    given: dict[str, str] = {}
    for item in text.split(","):
        key, equals, value = (word.strip() for word in item.partition("="))
        if key not in _KEYS or not equals or not value:
            raise ValueError(f"--late: got {item.strip()!r}, expected one of {', '.join(_KEYS)} with = and a value.")
        if key in given:
            raise ValueError(f"--late has {key} twice; give it once.")
        given[key] = value
    if "due" not in given:
        raise ValueError("--late needs due, such as due=2026-11-30T23:59.")
    if "per-day" not in given:
        raise ValueError("--late needs per-day, such as per-day=10%.")
    due, grace = _parse_due(given["due"], given.get("tz")), _parse_duration(given.get("grace", "0m"))
    if datetime.max.replace(tzinfo=UTC) - due < grace:
        raise ValueError(f"--late: due={given['due']} with grace={given['grace']} is beyond the end of time.")
    return LateRule(
        due,
        grace,
        _parse_deduction("per-day", given["per-day"]),
        _parse_deduction("most", given.get("most", "100%")),
    )


def _parse_due(text: str, zone: str | None) -> datetime:
    try:
        due = datetime.fromisoformat(text)
    except ValueError:
        raise ValueError(f"--late: due={text} is no time; expected such as 2026-11-30T23:59.") from None
    if due.tzinfo is not None and zone is not None:
        raise ValueError(f"--late: due={text} has an offset and there is tz={zone}, too; give one of them.")
    try:
        return (due if due.tzinfo is not None else due.replace(tzinfo=time_zone(zone or "UTC"))).astimezone(UTC)
    except OverflowError:
        raise ValueError(f"--late: due={text} is no time; expected such as 2026-11-30T23:59.") from None


def time_zone(name: str) -> tzinfo:
    """The time zone of that name; `ValueError` where there is none."""
    if name == "UTC":
        return UTC  # not every system has the table of zones
    try:
        return ZoneInfo(name)
    except (KeyError, ValueError, OSError):  # not there, or no name of a zone at all
        raise ValueError(f"the time zone {name} is not known here; expected such as Australia/Sydney.") from None


def _parse_duration(text: str) -> timedelta:
    found = _DURATION.fullmatch(text)
    if found is None:
        raise ValueError(f"--late: grace={text} is no duration; expected such as 30m, 2h or 1d.")
    return timedelta(**{_UNITS[found[2]]: int(found[1])})


def _parse_deduction(key: str, text: str) -> Deduction:
    try:
        amount = Decimal(text.removesuffix("%").strip())
    except InvalidOperation:
        amount = Decimal(-1)
    if not amount.is_finite() or amount < 0 or amount.adjusted() > 6 or len(amount.as_tuple().digits) > 12:
        raise ValueError(f"--late: {key}={text} is no amount; expected such as 10% or 0.2.")
    if text.endswith("%"):
        return Deduction(amount / 100, of_all=True)
    return Deduction(amount, of_all=False)


def _duration_text(over: timedelta) -> str:
    minutes = max(over // timedelta(minutes=1), 1)
    parts = ((minutes // 1440, "d"), (minutes // 60 % 24, "h"), (minutes % 60, "min"))
    return " ".join(f"{number} {unit}" for number, unit in parts if number)
