"""Late penalties: the rules of ``--late``, and exact decimal arithmetic.

::

    RULES   = RULE [";" RULE ...]
    RULE    = [ASSIGNMENT ":"] KEY "=" VALUE ["," KEY "=" VALUE ...]

    due=2026-11-30T23:59     due date (required), with an offset (2026-11-30T23:59+11:00), in `tz`, or in UTC
    tz=Australia/Sydney      time zone of `due`
    grace=2h                 no penalty until then; after it, lateness counts from `due`
    per-day=10%              penalty for each started day of 24 hours (required): a share of all marks, or marks (0.2)
    most=50%                 largest penalty; default 100%

Durations are a number and one of m, h, d. A rule without the name of an assignment applies to all assignments without a
rule of their own. A submission whose time is unknown is not late, and the report says that it is unknown.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from decimal import Decimal, InvalidOperation

from autograder.course.plain_text import plain_decimal
from autograder.course.settings import time_zone

_KEYS = ("due", "tz", "grace", "per-day", "most")
_DAY = timedelta(days=1)
_DURATION = re.compile(r"(\d{1,5})([mhd])", re.ASCII)
_UNITS = {"m": "minutes", "h": "hours", "d": "days"}


@dataclass(frozen=True, slots=True)
class Deduction:
    """A deduction in marks, or as a share of all marks.

    Attributes
    ----------
    amount : Decimal
        Not negative; a share of 1 is all marks.
    is_share : bool
    """

    amount: Decimal
    is_share: bool

    def __str__(self) -> str:
        return f"{plain_decimal(self.amount * 100)} %" if self.is_share else plain_decimal(self.amount)

    def in_marks(self, marks: Decimal) -> Decimal:
        """The deduction from an assignment with that many marks."""
        return self.amount * marks if self.is_share else self.amount


@dataclass(frozen=True, slots=True)
class LateRule:
    """The late rule of one assignment.

    Attributes
    ----------
    due : datetime
        In UTC.
    grace : timedelta
    per_day : Deduction
    most : Deduction
    """

    due: datetime
    grace: timedelta
    per_day: Deduction
    most: Deduction


LateRules = Mapping[str, LateRule]
"""By assignment; the rule for all other assignments has an empty name."""


@dataclass(frozen=True, slots=True)
class LatePenalty:
    """The late penalty of one submission.

    Attributes
    ----------
    penalty : Decimal
        In marks, at most all marks of the assignment.
    reason : str
        Explanation for the student; empty if the submission was on time.
    """

    penalty: Decimal
    reason: str


ON_TIME = LatePenalty(Decimal(0), "")
TIME_UNKNOWN = "The time of the hand-in is not known; nothing was deducted."
LATE_WITHOUT_TIME = "Late by the learning platform, which gives no time; nothing was deducted here."


def parse_rules(text: str) -> LateRules:
    """Parse the rules of ``--late``.

    Raises
    ------
    ValueError
        If a rule is invalid.
    """
    rules: dict[str, LateRule] = {}
    for part in filter(None, (part.strip() for part in text.split(";"))):
        named = re.match(r"([\w-]+)\s*:\s*(?=[a-z-]+\s*=)", part)
        name = named[1] if named else ""
        if name in rules:
            raise ValueError(f"--late has two rules for {name or 'all assignments'}; give one.")
        rules[name] = _parse_rule(part[named.end() :] if named else part)
    if not rules:
        raise ValueError("--late is empty; expected a rule such as due=2026-11-30T23:59,per-day=10%.")
    return rules


def late_penalty(
    rules: LateRules,
    assignment: str,
    submitted: datetime | None,
    marks: Decimal,
    own_due: datetime | None = None,
    told_late: bool = False,
) -> LatePenalty:
    """Compute the late penalty of a submission.

    Parameters
    ----------
    rules : mapping
        As returned by `parse_rules`.
    assignment : str
    submitted : datetime or None
        Submission time in UTC; None if unknown.
    marks : Decimal
        All marks of the assignment.
    own_due : datetime, optional
        The student's own due date, which takes the place of the rule's.
    told_late : bool
        Whether the learning platform calls a submission late of which no time is known.
    """
    rule = rules.get(assignment, rules.get(""))
    if rule is not None and own_due is not None:
        rule = replace(rule, due=own_due)
    if rule is not None and submitted is None:
        return LatePenalty(Decimal(0), LATE_WITHOUT_TIME if told_late else TIME_UNKNOWN)
    if rule is None or submitted is None or submitted <= rule.due + rule.grace:
        return ON_TIME
    lateness = submitted - rule.due
    days = -(-lateness // _DAY)
    penalty = min(days * rule.per_day.in_marks(marks), rule.most.in_marks(marks), marks)
    after = "late" if own_due is None else "after the extension"
    return LatePenalty(
        penalty,
        f"Handed in {_duration_text(lateness)} {after}: {plain_decimal(penalty)} of {plain_decimal(marks)} marks "
        f"deducted ({rule.per_day} per started day).",
    )


def read_timestamp(text: str) -> datetime | None:
    """Parse nbgrader's ``timestamp.txt``, such as ``2026-11-30 15:58:23.948203 UTC``; None if it is invalid.

    Without a time zone it is in UTC, as in nbgrader.
    """
    matched = re.match(r"\s*(\d{4}-\d{2}-\d{2}[T ]\d{2}:\d{2}(?::\d{2}(?:\.\d{1,6})?)?)\s*(\S*)\s*$", text[:200])
    if matched is None:
        return None
    try:
        when = datetime.fromisoformat(matched[1])
        zone = matched[2]
        if re.fullmatch(r"[+-]\d{2}:?\d{2}", zone):
            return datetime.fromisoformat(f"{when.isoformat()}{zone}").astimezone(UTC)
        return when.replace(tzinfo=time_zone(zone) if zone not in ("", "Z") else UTC).astimezone(UTC)
    except (ValueError, OverflowError):
        return None


def _parse_rule(text: str) -> LateRule:
    values: dict[str, str] = {}
    for item in text.split(","):
        key, equals, value = (word.strip() for word in item.partition("="))
        if key not in _KEYS or not equals or not value:
            raise ValueError(f"--late: got {item.strip()!r}, expected one of {', '.join(_KEYS)} with = and a value.")
        if key in values:
            raise ValueError(f"--late has {key} twice; give it once.")
        values[key] = value
    if "due" not in values:
        raise ValueError("--late needs due, such as due=2026-11-30T23:59.")
    if "per-day" not in values:
        raise ValueError("--late needs per-day, such as per-day=10%.")
    due, grace = _parse_due(values["due"], values.get("tz")), _parse_duration(values.get("grace", "0m"))
    if datetime.max.replace(tzinfo=UTC) - due < grace:
        raise ValueError(f"--late: due={values['due']} with grace={values['grace']} is beyond the year 9999.")
    return LateRule(
        due,
        grace,
        _parse_deduction("per-day", values["per-day"]),
        _parse_deduction("most", values.get("most", "100%")),
    )


def _parse_due(text: str, zone: str | None) -> datetime:
    try:
        due = datetime.fromisoformat(text)
    except ValueError:
        raise ValueError(f"--late: due={text} is not a time; expected a value such as 2026-11-30T23:59.") from None
    if due.tzinfo is not None and zone is not None:
        raise ValueError(f"--late: due={text} has an offset, and there is also tz={zone}; give one of them.")
    try:
        return (due if due.tzinfo is not None else due.replace(tzinfo=time_zone(zone or "UTC"))).astimezone(UTC)
    except OverflowError:
        raise ValueError(f"--late: due={text} is not a time; expected a value such as 2026-11-30T23:59.") from None


def _parse_duration(text: str) -> timedelta:
    found = _DURATION.fullmatch(text)
    if found is None:
        raise ValueError(f"--late: grace={text} is not a duration; expected a value such as 30m, 2h or 1d.")
    return timedelta(**{_UNITS[found[2]]: int(found[1])})


def _parse_deduction(key: str, text: str) -> Deduction:
    try:
        amount = Decimal(text.removesuffix("%").strip())
    except InvalidOperation:
        amount = Decimal(-1)
    if not amount.is_finite() or amount < 0 or amount.adjusted() > 6 or len(amount.as_tuple().digits) > 12:
        raise ValueError(f"--late: {key}={text} is not an amount; expected a value such as 10% or 0.2.")
    if text.endswith("%"):
        return Deduction(amount / 100, is_share=True)
    return Deduction(amount, is_share=False)


def _duration_text(lateness: timedelta) -> str:
    minutes = max(lateness // timedelta(minutes=1), 1)
    parts = ((minutes // 1440, "d"), (minutes // 60 % 24, "h"), (minutes % 60, "min"))
    return " ".join(f"{number} {unit}" for number, unit in parts if number)
