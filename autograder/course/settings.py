"""The settings of a course: the file ``course.toml`` in its root. Every command works without it.

::

    title = "System identification"
    timezone = "Australia/Sydney"        # of due dates without an offset (default UTC) and of Moodle's worksheet
    secret = "../private/course-secret"  # for individual data; a path from the folder of course.toml
    students = "students.csv"            # columns id, name, e-mail
    extensions = "extensions.csv"        # columns student, assignment, due: own due dates of single students
    lms = "moodle"

    [late]                               # as in --late; no penalty without it
    grace = "2h"
    per-day = "10%"
    most = "50%"

    [assignments.lab-identification]
    due = 2026-11-30T23:59:00
    weight = 20                          # marks in the total of the course; default those of the notebook
    late = { per-day = "5%" }            # takes the place of single values of [late]
    second-record = false                # grade on the student's own record alone; default true

    [rig]                                # in the place of the tanks; try the log with: labsid course rig motor.csv
    record = "motor.csv"                 # any log that labsid reads
    name = "the DC motor"                # as in a sentence
    sentence = "A bridge drives the motor, and an encoder measures its speed."
    input = { name = "voltage", unit = "V", symbol = "v" }
    output = { name = "speed", unit = "rpm", symbol = "n" }
    picture = "motor.png"                # PNG, JPEG or SVG; may be left out
    reading = { from = 7.2 }             # options of labsid check, where the log needs them
    simulated = true                     # a record made with a model of the log; default false

    [hub]                                # students work on a JupyterHub, and hand in there: hand-in or exchange
    hand-in = "/srv/labsid/hand-in"      # a shared folder, of mode 3773
    exchange = "/srv/nbgrader/exchange"  # the root of nbgrader's exchange, with the name of the course in it
    course = "sysid"
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime, tzinfo
from decimal import Decimal
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from autograder.course.layout import SETTINGS_FILE, Course
from autograder.course.own_rig import OwnRig
from autograder.course.rig_settings import to_own_rig
from autograder.course.toml_values import absolute_path, moment, refuse_unknown, switch, text, value_of
from labsid.hand_in.hub import Hub

LATE_KEYS = ("grace", "per-day", "most")
LEARNING_PLATFORMS = ("moodle", "canvas")
_KEYS = ("title", "timezone", "secret", "students", "extensions", "lms", "late", "assignments", "rig", "hub")
_HUB_KEYS = ("hand-in", "exchange", "course")
_ASSIGNMENT_KEYS = ("due", "weight", "late", "second-record")


@dataclass(frozen=True, slots=True)
class AssignmentSettings:
    """Settings of one assignment.

    Attributes
    ----------
    due : datetime or None
        In UTC; None without a date.
    weight : Decimal or None
        Marks in the total of the course; None for those of the notebook.
    late : mapping
        Values of the late rule, by key of ``--late``.
    second_record : bool
        Whether hand-ins are run on other records, too, on which typed-in values are wrong.
    """

    due: datetime | None = None
    weight: Decimal | None = None
    late: Mapping[str, str] = field(default_factory=dict)
    second_record: bool = True


@dataclass(frozen=True, slots=True)
class CourseSettings:
    """Settings of a course; the defaults are those without a file.

    Attributes
    ----------
    title : str
    timezone : str or None
        Name of the time zone; None if the file has none.
    secret, students : Path or None
        Files.
    lms : str or None
        The learning platform.
    assignments : mapping
        AssignmentSettings by name.
    extensions : Path or None
        File with own due dates of single students.
    rig : OwnRig or None
        The rig of the lab, if it is not the tanks.
    hub : Hub or None
        Where students hand in on a JupyterHub.
    """

    title: str = ""
    timezone: str | None = None
    secret: Path | None = None
    students: Path | None = None
    lms: str | None = None
    assignments: Mapping[str, AssignmentSettings] = field(default_factory=dict)
    extensions: Path | None = None
    rig: OwnRig | None = None
    hub: Hub | None = None

    @property
    def weights(self) -> dict[str, Decimal]:
        """The weights that are set, by assignment."""
        return {name: one.weight for name, one in self.assignments.items() if one.weight is not None}

    @property
    def without_second_record(self) -> frozenset[str]:
        """The assignments that are graded on the student's own record alone."""
        return frozenset(name for name, one in self.assignments.items() if not one.second_record)

    def due_texts(self) -> dict[str, str]:
        """Due dates for students, in the time zone of the course, by assignment."""
        return {name: local_time(due, self.timezone) for name, due in self.due_dates.items()}

    @property
    def due_dates(self) -> dict[str, datetime]:
        """Due dates in UTC, by assignment."""
        return {name: one.due for name, one in self.assignments.items() if one.due is not None}

    def due_by(self, now: datetime) -> list[str] | None:
        """The assignments whose due dates have passed; None if there are no due dates."""
        dates = self.due_dates
        return [name for name, due in dates.items() if due <= now] if dates else None

    @property
    def late_rules(self) -> str:
        """The late rules as text for ``--late``; empty without any."""
        rules = []
        for name, one in self.assignments.items():
            if one.due is not None and one.late:
                values = {"due": one.due.isoformat(), **one.late}
                rules.append(f"{name}: " + ",".join(f"{key}={value}" for key, value in values.items()))
        return ";".join(rules)


def read_settings(course: Course) -> CourseSettings:
    """Read ``course.toml`` in the root of the course; the defaults if there is none.

    Raises
    ------
    ValueError
        If the file is not TOML, or has an unknown key or a value of the wrong type.
    """
    path = course.root / SETTINGS_FILE
    if not path.is_file():
        return CourseSettings()
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"), parse_float=Decimal)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is not valid TOML: {error}.") from None
    try:
        return _to_settings(found, course)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _to_settings(found: dict[str, Any], course: Course) -> CourseSettings:
    refuse_unknown(found, _KEYS, "the file")
    zone_name = value_of(found, "timezone", text)
    zone = UTC if zone_name is None else time_zone(zone_name)
    late = _late(found.get("late", {}), "[late]")
    tables = found.get("assignments", {})
    if not isinstance(tables, dict):
        raise ValueError(f"assignments must be tables such as [assignments.NAME], got {tables!r}.")
    known = course.assignments()
    refuse_unknown(tables, known, "[assignments]")
    lms = value_of(found, "lms", text)
    if lms not in (None, *LEARNING_PLATFORMS):
        raise ValueError(f"lms must be {' or '.join(LEARNING_PLATFORMS)}, got {lms!r}.")
    secret, students, extensions = (value_of(found, key, text) for key in ("secret", "students", "extensions"))
    return CourseSettings(
        value_of(found, "title", text) or "",
        zone_name,
        None if secret is None else course.root / secret,
        None if students is None else course.root / students,
        lms,
        {name: _assignment(tables[name], name, zone, late) for name in known if name in tables},
        None if extensions is None else course.root / extensions,
        to_own_rig(found["rig"], course.root) if "rig" in found else None,
        _hub(found["hub"]) if "hub" in found else None,
    )


def _hub(table: Any) -> Hub:
    if not isinstance(table, dict):
        raise ValueError(f"hub must be a table [hub] with {', '.join(_HUB_KEYS)}, got {table!r}.")
    refuse_unknown(table, _HUB_KEYS, "[hub]")
    paths = {key: value_of(table, key, absolute_path, "[hub]") for key in ("hand-in", "exchange")}
    name = value_of(table, "course", text, "[hub]") or ""
    if sum(path is not None for path in paths.values()) != 1:
        raise ValueError("[hub] must have one of hand-in, a shared folder, and exchange, that of nbgrader.")
    if bool(name) != (paths["exchange"] is not None) or "/" in name or name.startswith("."):
        raise ValueError('course in [hub] is the name of the course in nbgrader\'s exchange, such as course = "sysid".')
    return Hub(paths["hand-in"], paths["exchange"], name)


def _assignment(table: Any, name: str, zone: tzinfo, late: Mapping[str, str]) -> AssignmentSettings:
    where = f"[assignments.{name}]"
    if not isinstance(table, dict):
        raise ValueError(f"{where} must be a table with {', '.join(_ASSIGNMENT_KEYS)}, got {table!r}.")
    refuse_unknown(table, _ASSIGNMENT_KEYS, where)
    due = value_of(table, "due", moment, where)
    if due is not None:
        due = (due if due.tzinfo is not None else due.replace(tzinfo=zone)).astimezone(UTC)
    rule = {**late, **_late(table.get("late", {}), f"late of {where}")}
    if rule and due is not None and "per-day" not in rule:
        raise ValueError(f'the late rule of {where} needs per-day, such as per-day = "10%".')
    second = value_of(table, "second-record", switch, where)
    return AssignmentSettings(due, value_of(table, "weight", _weight, where), rule, second is not False)


def _late(table: Any, where: str) -> dict[str, str]:
    if not isinstance(table, dict):
        raise ValueError(f"{where} must be a table with {', '.join(LATE_KEYS)}, got {table!r}.")
    refuse_unknown(table, LATE_KEYS, where)
    return {key: value_of(table, key, text, where) for key in table}


def _weight(value: Any) -> Decimal:
    if isinstance(value, bool) or not isinstance(value, int | Decimal) or not Decimal(value).is_finite() or value <= 0:
        raise TypeError("a positive number")
    return Decimal(value)


def time_zone(name: str) -> tzinfo:
    """The time zone of that name; `ValueError` if it is unknown."""
    if name == "UTC":
        return UTC  # available without a time zone database
    try:
        return ZoneInfo(name)
    except (KeyError, ValueError, OSError):  # not in the database, or not a valid name
        raise ValueError(f"the time zone {name} is not known; expected a name such as Australia/Sydney.") from None


def local_time(when: datetime, zone_name: str | None) -> str:
    """A time for students, in a time zone, which is UTC if it is None."""
    zone = UTC if zone_name is None else time_zone(zone_name)
    there = when.astimezone(zone)
    return f"{there.day} {there:%B %Y, %H:%M} ({zone_name or 'UTC'})"
