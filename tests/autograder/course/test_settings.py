"""course.toml and the students file: what they mean, and that a mistake in them is one clear line."""

import re
from collections.abc import Callable
from datetime import UTC, datetime
from decimal import Decimal
from pathlib import Path

import pytest

from autograder.course.layout import Course
from autograder.course.own_rig import OwnRig, Quantity
from autograder.course.settings import AssignmentSettings, CourseSettings, read_settings
from autograder.course.students import Student, merge_students, read_students, write_students
from autograder.results.late import parse_rules
from labsid.records.reading import Reading

ROOT = Path(__file__).resolve().parents[3]
WHOLE = """
title = "Identification"
timezone = "Australia/Sydney"
secret = "../private/secret"
students = "class.csv"
extensions = "../own-dates.csv"
lms = "moodle"
[late]
grace = "2h"
per-day = "10%"
[assignments.two]
due = 2026-12-01T09:00:00+01:00
weight = 2.5
late = { per-day = "0.2", most = "50%" }
[assignments.one]
due = 2026-11-30T23:59:00
"""


@pytest.fixture
def settings(tmp_path: Path) -> Callable[[str], CourseSettings]:
    """Read a course.toml of a course with the assignments one, two and three."""
    for name in ("one", "two", "three"):
        (tmp_path / "notebooks" / name).mkdir(parents=True)
        (tmp_path / "notebooks" / name / f"{name}.md").touch()

    def read(text: str) -> CourseSettings:
        (tmp_path / "course.toml").write_text(text, encoding="utf-8")
        return read_settings(Course(tmp_path))

    return read


def test_every_key_is_read(settings: Callable[[str], CourseSettings], tmp_path: Path) -> None:
    one = AssignmentSettings(datetime(2026, 11, 30, 12, 59, tzinfo=UTC), None, {"grace": "2h", "per-day": "10%"})
    rule = {"grace": "2h", "per-day": "0.2", "most": "50%"}
    two = AssignmentSettings(datetime(2026, 12, 1, 8, 0, tzinfo=UTC), Decimal("2.5"), rule)
    found = settings(WHOLE)
    assert found == CourseSettings(
        "Identification", "Australia/Sydney", tmp_path / "../private/secret", tmp_path / "class.csv", "moodle",
        {"one": one, "two": two}, tmp_path / "../own-dates.csv",
    )  # fmt: skip
    assert found.weights == {"two": Decimal("2.5")}
    rules = parse_rules(found.late_rules)
    assert (rules["one"].due, str(rules["one"].per_day), str(rules["two"].per_day)) == (one.due, "10 %", "0.2")


def test_the_second_record_is_used_unless_it_is_switched_off(settings: Callable[[str], CourseSettings]) -> None:
    assert settings(WHOLE).without_second_record == frozenset()
    assert settings("[assignments.two]\nsecond-record = true").without_second_record == frozenset()
    assert settings("[assignments.two]\nsecond-record = false").without_second_record == {"two"}


def test_what_is_due_depends_on_the_time(settings: Callable[[str], CourseSettings]) -> None:
    found = settings(WHOLE)
    assert found.due_by(datetime(2026, 11, 30, 12, 58, tzinfo=UTC)) == []
    assert found.due_by(datetime(2026, 11, 30, 12, 59, tzinfo=UTC)) == ["one"]
    assert found.due_by(datetime(2027, 1, 1, tzinfo=UTC)) == ["one", "two"]
    assert settings("[assignments.one]\nweight = 1").due_by(datetime(2027, 1, 1, tzinfo=UTC)) is None


def test_nothing_is_needed(settings: Callable[[str], CourseSettings], tmp_path: Path) -> None:
    assert settings("") == CourseSettings()
    (tmp_path / "course.toml").unlink()
    assert read_settings(Course(tmp_path)) == CourseSettings()
    assert CourseSettings().late_rules == ""
    assert settings("[assignments.one]\ndue = 2026-11-30T23:59:00").late_rules == ""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("title = ", "is not valid TOML: Invalid value"),
        ("name = 'x'", "the file has the unknown key 'name'; expected one of title, timezone,"),
        ("title = 1", "title must be text in quotation marks, got 1."),
        ("title = ''", "title must be text in quotation marks, got ''."),
        ("lms = 'blackboard'", "lms must be moodle or canvas, got 'blackboard'."),
        ("timezone = 'Mars/Base'", "the time zone Mars/Base is not known"),
        ("assignments = 3", "assignments must be tables such as [assignments.NAME], got 3."),
        ("[assignments.four]", "[assignments] has the unknown key 'four'; expected one of one, three, two."),
        ("[assignments]\none = 3", "[assignments.one] must be a table with due, weight, late, second-record, got 3."),
        (
            "[assignments.one]\ndeu = 1",
            "[assignments.one] has the unknown key 'deu'; expected one of due, weight, late, second-record.",
        ),
        ("[assignments.one]\ndue = '2026-11-30'", "due in [assignments.one] must be a date and time such as"),
        ("[assignments.one]\ndue = 2026-11-30", "due in [assignments.one] must be a date and time such as"),
        ("[assignments.one]\nweight = 'ten'", "weight in [assignments.one] must be a positive number, got 'ten'."),
        ("[assignments.one]\nsecond-record = 0", "second-record in [assignments.one] must be true or false, got 0."),
        ("[assignments.one]\nweight = true", "must be a positive number, got True."),
        ("[assignments.one]\nweight = nan", "must be a positive number, got Decimal('NaN')."),
        ("late = 3", "[late] must be a table with grace, per-day, most, got 3."),
        ("hub = 3", "hub must be a table [hub] with hand-in, exchange, course, got 3."),
        ("[hub]\nfolder = '/srv'", "[hub] has the unknown key 'folder'; expected one of hand-in, exchange, course."),
        (
            "[hub]\nhand-in = 'there'",
            "hand-in in [hub] must be a path in quotation marks that begins with /, got 'there'.",
        ),
        ("[hub]", "[hub] must have one of hand-in, a shared folder, and exchange, that of nbgrader."),
        ("[hub]\nhand-in = '/srv'\nexchange = '/x'", "[hub] must have one of hand-in"),
        ("[hub]\nhand-in = '/srv'\ncourse = 'x'", "course in [hub] is the name of the course in nbgrader's exchange"),
        ("[hub]\nexchange = '/srv'", "course in [hub] is the name of the course in nbgrader's exchange"),
        (
            "[hub]\nexchange = '/srv'\ncourse = '../x'",
            "course in [hub] is the name of the course in nbgrader's exchange",
        ),
        ("[late]\nper_day = '1%'", "[late] has the unknown key 'per_day'; expected one of grace, per-day, most."),
        ("[late]\nper-day = 10", "per-day in [late] must be text in quotation marks, got 10."),
        (
            "[late]\ngrace = '1h'\n[assignments.one]\ndue = 2026-11-30T23:59:00",
            "the late rule of [assignments.one] needs per-day",
        ),
    ],
)
def test_a_mistake_is_one_clear_line(
    settings: Callable[[str], CourseSettings], tmp_path: Path, text: str, said: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(said)) as error:
        settings(text)
    assert len(str(error.value).splitlines()) == 1
    assert str(error.value).startswith(str(tmp_path / "course.toml"))


def test_the_readme_shows_a_course_toml_that_is_right(tmp_path: Path) -> None:
    (shown,) = re.findall(r"```toml\n(.*?)```", (ROOT / "autograder" / "README.md").read_text(encoding="utf-8"), re.S)
    course = Course(tmp_path)
    for name in Course(ROOT).assignments():
        (course.notebooks / name).mkdir(parents=True)
        (course.notebooks / name / f"{name}.md").touch()
    (tmp_path / "course.toml").write_text(shown, encoding="utf-8")
    found = read_settings(course)
    assert found.title
    assert found.secret
    assert found.students
    assert len(parse_rules(found.late_rules)) == len(found.assignments) > 1


# ---- students


@pytest.mark.parametrize(
    "text",
    [
        "id,name,email\nz1,Ada Lovelace,a@x.edu\nz2,,\n",
        "z1, Ada Lovelace, a@x.edu\n# gone: z3\n\nz2\n",
        "\ufeffE-mail;Group;Full name;ID number\na@x.edu;B;Ada Lovelace;z1\n;;;z2\n",
    ],
)
def test_students_are_read_in_every_layout(tmp_path: Path, text: str) -> None:
    (tmp_path / "s.csv").write_text(text, encoding="utf-8")
    students = [Student("z1", "Ada Lovelace", "a@x.edu"), Student("z2")]
    assert read_students(tmp_path / "s.csv") == students
    write_students(tmp_path / "t.csv", students)
    assert read_students(tmp_path / "t.csv") == students


def test_a_line_with_too_many_columns_is_said(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text("z1,Lovelace, Ada,a@x.edu\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"got 4 columns in 'z1,Lovelace,Ada,a@x\.edu', expected id, name and e-mail"):
        read_students(tmp_path / "s.csv")


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("Ada Lovelace", ("Ada", "Lovelace")),
        ("Lovelace, Ada King", ("Ada King", "Lovelace")),
        ("Jürgen von Öz", ("Jürgen von", "Öz")),
        ("Plato", ("", "Plato")),
        ("", ("", "")),
    ],
)
def test_names_have_two_parts(name: str, parts: tuple[str, str]) -> None:
    assert Student("z", name).first_and_last_name == parts


def test_the_last_list_with_a_name_counts() -> None:
    first, second = [Student("b", "B"), Student("a", "A")], [Student("b"), Student("a", "Ann", "a@x"), Student("c")]
    assert merge_students(first, second) == [Student("a", "Ann", "a@x"), Student("b", "B"), Student("c")]


def test_due_dates_are_said_in_the_time_of_the_course(settings: Callable[[str], CourseSettings]) -> None:
    assert settings(WHOLE).due_texts() == {
        "two": "1 December 2026, 19:00 (Australia/Sydney)",
        "one": "30 November 2026, 23:59 (Australia/Sydney)",
    }


def test_ids_that_differ_only_in_case_are_refused(tmp_path: Path) -> None:
    (tmp_path / "s.csv").write_text("z1,Ada\nZ1,Ben\n", encoding="utf-8")
    with pytest.raises(
        ValueError, match=r"names Ada \(z1\) and Ben \(Z1\), whose IDs differ only in upper and lower case"
    ):
        read_students(tmp_path / "s.csv")


def test_a_name_that_a_spreadsheet_would_evaluate_is_kept_apart(tmp_path: Path) -> None:
    students = [Student("@z1", "=cmd|' /C calc'!A0", "+a@x", "-ada", "7"), Student("z2", "'O")]
    write_students(tmp_path / "s.csv", students)
    text = (tmp_path / "s.csv").read_text(encoding="utf-8")
    assert text.splitlines()[1] == "'@z1,'=cmd|' /C calc'!A0,'+a@x,'-ada,7"
    assert read_students(tmp_path / "s.csv") == students


RIG = """
[rig]
record = "motor.csv"
name = "the motor"
sentence = "A bridge drives it."
input = { name = "voltage", unit = "V", symbol = "v" }
output = { name = "speed", unit = "rpm" }
"""


def test_a_rig_is_read(settings: Callable[[str], CourseSettings], tmp_path: Path) -> None:
    (tmp_path / "motor.png").write_bytes(b"a picture")
    more = (
        'picture = "motor.png"\nsimulated = true\nreading = { from = 7.25, to = 9, inputs = "Q1", time-unit = "ms" }\n'
    )
    rig = settings(RIG + more).rig
    assert rig == OwnRig(
        tmp_path / "motor.csv",
        "the motor",
        "A bridge drives it.",
        Quantity("voltage", "V", "v"),
        Quantity("speed", "rpm"),
        tmp_path / "motor.png",
        Reading(since=7.25, until=9, inputs="Q1", time_unit="ms"),
        simulated=True,
    )
    assert (rig.input.called, rig.output.called, rig.units) == ("voltage $v$", "speed", ("V", "rpm"))
    assert settings("").rig is None
    in_dollars = settings(RIG.replace('symbol = "v"', 'symbol = "$v$"')).rig
    assert in_dollars is not None
    assert in_dollars.input.called == "voltage $v$"


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        (("[rig]", "[rig]\nmotor = 1"), "[rig] has the unknown key 'motor'; expected one of record, name, sentence"),
        (('record = "motor.csv"', ""), "[rig] needs record."),
        (("record =", "record = 3 #"), "record in [rig] must be text in quotation marks, got 3."),
        (('{ name = "speed", unit = "rpm" }', '"speed"'), "output of [rig] must be a table such as { name ="),
        ((', unit = "rpm"', ""), "output of [rig] needs unit."),
        (('"rpm"', '"rounds per minute"'), "the unit of output of [rig] must be as on an axis, such as m/s or °C"),
        (('"rpm"', '"$x$"'), "the unit of output of [rig] must be as on an axis"),
        (("[rig]", '[rig]\npicture = "rig.gif"'), "picture of [rig] must be .png, .jpg, .jpeg, .svg, got 'rig.gif'."),
        (("[rig]", '[rig]\npicture = "no.png"'), "picture of [rig]: there is no "),
        (("[rig]", "[rig]\nreading = { begin = 3 }"), "reading of [rig] has the unknown key 'begin'; expected one of"),
        (("[rig]", '[rig]\nreading = { from = "3 s" }'), "from in reading of [rig] must be a number without"),
        (("[rig]", "[rig]\nreading = { columns = 3 }"), "columns in reading of [rig] must be text in quotation marks"),
        (("[rig]", "[rig]\nreading = { from = 5, to = 3 }"), "since (--from) must be before until (--to)"),
        (("[rig]", '[rig]\nsimulated = "yes"'), "simulated in [rig] must be true or false, got 'yes'."),
    ],
)
def test_a_mistake_in_a_rig_is_one_clear_line(
    changed: tuple[str, str], told: str, settings: Callable[[str], CourseSettings]
) -> None:
    with pytest.raises(ValueError, match=re.escape(told)) as refused:
        settings(RIG.replace(*changed))
    assert "course.toml: " in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_picture_of_many_megabytes_is_refused(settings: Callable[[str], CourseSettings], tmp_path: Path) -> None:
    (tmp_path / "big.png").write_bytes(bytes(1_000_001))
    with pytest.raises(ValueError, match=r"big\.png has more than 1 MB"):
        settings(RIG + 'picture = "big.png"\n')
