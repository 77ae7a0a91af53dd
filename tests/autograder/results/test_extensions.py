"""Extensions: the table of own due dates, and what is said about it."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from autograder.results.extensions import Extension, extension_remarks, read_extensions

NAMES = ("prelab", "lab")
DUE = datetime(2026, 12, 4, 12, 59, tzinfo=UTC)


def read(folder: Path, text: str, zone: str | None = None) -> dict[tuple[str, str], Extension]:
    path = folder / "extensions.csv"
    path.write_text(text, encoding="utf-8")
    return read_extensions(path, NAMES, zone)


@pytest.mark.parametrize(
    "text",
    [
        "student,assignment,due\nz1,lab,2026-12-04T23:59\n",
        "\ufeffStudent; assignment; due\r\nz1; lab; 2026-12-04 23:59\r\n\r\n# z2;lab;x\r\n",
        "student,assignment,due\nz1,lab,2026-12-04T12:59Z\n",
    ],
)
def test_a_table_is_read_in_the_zone_of_the_course(tmp_path: Path, text: str) -> None:
    found = read(tmp_path, text, "Australia/Sydney")
    assert found == {("z1", "lab"): Extension(DUE, "4 December 2026, 23:59 (Australia/Sydney)")}


def test_without_a_zone_dates_are_in_utc(tmp_path: Path) -> None:
    (one,) = read(tmp_path, "student,assignment,due\nz1,lab,2026-12-04T12:59\n").values()
    assert one == Extension(DUE, "4 December 2026, 12:59 (UTC)")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "got the columns '', expected student,assignment,due in the first line"),
        ("z1,lab,2026-12-04\n", "got the columns 'z1,lab,2026-12-04', expected"),
        ("student,assignment,due\nz1,lab\n", "line 2: got 'z1,lab', expected student,assignment,due"),
        (
            "student,assignment,due\nz1,holiday,2026-12-04\n",
            "line 2: there is no assignment 'holiday'; there are prelab",
        ),
        ("student,assignment,due\nz1,lab,Friday\n", "line 2: due 'Friday' is not a time; expected a value such as"),
        (
            "student,assignment,due\nz1,lab,2026-12-04\nz1,lab,2026-12-05\n",
            "line 3: a second extension of z1 for lab; keep one",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(ValueError, match=r"extensions\.csv") as error:
        read(tmp_path, text)
    assert said in str(error.value)


def test_a_file_that_is_not_text_is_refused(tmp_path: Path) -> None:
    (tmp_path / "extensions.xlsx").write_bytes(b"PK\x03\x04\xff")
    with pytest.raises(ValueError, match="is not text in UTF-8"):
        read_extensions(tmp_path / "extensions.xlsx", NAMES)


def test_surprises_are_said() -> None:
    own = Extension(DUE, "4 December")
    after, before = DUE + timedelta(days=1), DUE - timedelta(days=1)
    found = {("z1", "lab"): own}
    assert extension_remarks(found, ["z1"], ["lab"], {"lab": before}, after) == []
    assert extension_remarks(found, ["z2"], ["lab"], {}, after) == [
        "extension of z1 for lab: there is no folder of this student; check the ID."
    ]
    assert extension_remarks(found, ["z1"], ["lab"], {"": after}, after) == [
        "extension of z1 for lab: 4 December is before the due date of everybody; check it."
    ]
    assert extension_remarks(found, ["z1"], ["lab"], {"lab": before}, before) == [
        "extension of z1 for lab: runs until 4 December; grade again after that."
    ]
    assert extension_remarks(found, ["z1"], ["prelab"], {"lab": before}, before) == []
