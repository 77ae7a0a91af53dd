"""Feedback on a hub: into the folder of its student alone, through no link; `tests/hub` has users of their own."""

import hashlib
import stat
import sys
from pathlib import Path

import pytest

from autograder.course.students import Student, write_students
from autograder.export.hub_feedback import return_feedback
from labsid.hand_in.hub import Hub

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="hubs run on Linux")


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """A graded class of two students, of whom one has another name on the hub."""
    for student in ("z1", "ben"):
        page = tmp_path / "out" / "feedback" / student / "lab.html"
        page.parent.mkdir(parents=True)
        page.write_text(f"page of {student}", encoding="utf-8")
    write_students(tmp_path / "out" / "students.csv", [Student("z1", username="ada"), Student("ben")])
    return tmp_path / "out"


def folder(path: Path, mode: int = 0o770) -> Path:
    path.mkdir(parents=True)
    path.chmod(mode)
    return path


def test_each_page_goes_into_the_folder_of_its_student(out: Path, tmp_path: Path) -> None:
    shared = folder(tmp_path / "shared")
    ada, ben = folder(shared / "ada"), folder(shared / "ben")
    assert list(return_feedback(out, Hub(hand_in=shared))) == [("", 1), ("", 1)]
    assert (ada / "feedback-lab.html").read_text(encoding="utf-8") == "page of z1"
    assert (ben / "feedback-lab.html").read_text(encoding="utf-8") == "page of ben"
    assert stat.S_IMODE((ben / "feedback-lab.html").stat().st_mode) == 0o644
    assert [path.name for path in ada.iterdir()] == ["feedback-lab.html"]


def test_a_link_is_replaced_and_a_folder_in_its_place_is_said(out: Path, tmp_path: Path) -> None:
    shared, precious = folder(tmp_path / "shared"), tmp_path / "precious"
    precious.write_text("marks", encoding="utf-8")
    (folder(shared / "ada") / "feedback-lab.html").symlink_to(precious)
    folder(folder(shared / "ben") / "feedback-lab.html")
    said = list(return_feedback(out, Hub(hand_in=shared)))
    assert said == [("ben: nothing returned: Is a directory", 0), ("", 1)]
    assert precious.read_text(encoding="utf-8") == "marks"
    assert not (shared / "ada" / "feedback-lab.html").is_symlink()
    assert [path.name for path in (shared / "ben").iterdir()] == ["feedback-lab.html"]


def test_a_folder_that_others_can_enter_or_a_link_to_one_gets_nothing(out: Path, tmp_path: Path) -> None:
    shared = folder(tmp_path / "shared")
    folder(shared / "ada", 0o775)
    (shared / "ben").symlink_to(folder(tmp_path / "elsewhere"))
    (first, _), (second, _) = return_feedback(out, Hub(hand_in=shared))
    assert first.startswith("ben: nothing returned: Not a directory")
    assert second == f"z1: nothing returned: others can enter {shared / 'ada'}; the next hand-in makes another folder"
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_in_the_exchange_a_page_has_the_name_that_nbgrader_computes(out: Path, tmp_path: Path) -> None:
    course = tmp_path / "exchange" / "sysid"
    hand_in = folder(course / "inbound" / "ada+lab+2026-01-01 00:00:00 UTC+x")
    (hand_in / "submission_secret.txt").write_text("secret", encoding="utf-8")
    said = list(return_feedback(out, Hub(exchange=tmp_path / "exchange", course="sysid")))
    assert said == [(f"ben: nothing returned: no hand-in in {course / 'inbound'}", 0), ("", 1)]
    (page,) = (course / "feedback").iterdir()
    assert page.stem == hashlib.md5(b"secretlab", usedforsecurity=False).hexdigest()
    assert stat.S_IMODE((course / "feedback").stat().st_mode) == 0o711


def test_what_is_missing_is_said(out: Path, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"as in \[hub\] of course\.toml, is not on this machine"):
        list(return_feedback(out, Hub(hand_in=tmp_path / "nowhere")))
    with pytest.raises(ValueError, match=r"has no pages\. Run: labsid course feedback --out"):
        list(return_feedback(tmp_path, Hub(hand_in=tmp_path)))
