"""What was hard: medians of those who sent their tries, nothing of fewer than five, and nothing by forged files."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path

import pytest

from autograder.results.feedback import load_template
from autograder.results.gradebook import ManualGrades
from autograder.results.hard_questions import HardAssignment, hard_csv, what_was_hard
from autograder.results.report import report_page
from autograder.results.sent_tries import StudentTries, gather_tries, load_sent
from labsid.checks.kept_tries import KeptTry, tries_bytes, tries_file_name

HEADINGS = {"q-1": "1. Phi", "q-2": "2. Theta"}


def tries(*slips: str, question: str = "q-1", minutes: int = 2) -> StudentTries:
    """Tries of one student, each two minutes after the last; an empty slip is a right answer."""
    return tuple(KeptTry(question, 10 + minutes * i, not slip, slip) for i, slip in enumerate(slips))


def test_medians_of_five() -> None:
    sent = [tries(""), tries("sign", ""), tries("sign", "other", ""), tries("sign", "sign", "sign", ""), tries("")]
    found = what_was_hard("tiny", sent, 8, HEADINGS)
    assert found is not None
    assert (found.sent, found.handed_in) == (5, 8)
    (row,) = found.questions
    assert (row.tried, row.tries_until_right, row.minutes_until_right) == (5, 2, 2)
    assert (row.gave_up, row.without_a_name, row.first_mistakes) == (None, None, ())


def test_a_group_of_four_is_not_shown_and_one_of_five_is() -> None:
    four = [tries("sign", "other")] * 4
    assert what_was_hard("tiny", four, 9, HEADINGS) is None
    found = what_was_hard("tiny", [*four, tries("sign", "other")], 9, HEADINGS)
    assert found is not None
    (row,) = found.questions
    assert (row.gave_up, row.without_a_name, row.first_mistakes) == (5, 5, (("sign", 5),))
    assert row.tries_until_right is None
    # a question that four of five tried has no row
    sent = [*four, tries("sign", question="q-2")]
    assert what_was_hard("tiny", sent, 9, HEADINGS).questions == ()  # type: ignore[union-attr]


def test_a_right_answer_ends_the_count_and_a_minute_that_goes_back_is_none() -> None:
    back = (KeptTry("q-1", 90, False, "sign"), KeptTry("q-1", 3, True), KeptTry("q-1", 99, False, "sign"))
    found = what_was_hard("tiny", [back] * 5, 5, HEADINGS)
    assert found is not None
    assert (found.questions[0].tries_until_right, found.questions[0].minutes_until_right) == (2, 0)
    assert found.questions[0].gave_up is None


def test_tries_at_unknown_questions_count_nobody() -> None:
    assert what_was_hard("tiny", [tries("", question="q-9")] * 6, 6, HEADINGS) is None


def test_the_hardest_question_comes_first() -> None:
    sent = [tries("") + tries("sign", "", question="q-2")] * 5
    found = what_was_hard("tiny", sent, 5, HEADINGS)
    assert found is not None
    assert [row.question for row in found.questions] == ["q-2", "q-1"]


def test_the_table_has_no_names_and_no_formula() -> None:
    sent = [tries("=cmd()", "")] * 5
    found = what_was_hard("tiny", sent, 7, HEADINGS)
    assert found is not None
    (row,) = csv.DictReader(io.StringIO(hard_csv([found])))
    assert (row["sent"], row["handed_in"], row["tried"], row["tries_until_right"]) == ("5", "7", "5", "2")
    assert row["first_mistakes"] == "'=cmd() (5)"
    assert row["gave_up"] == ""


# ---- from the hand-ins


def hand_in(submitted: Path, student: str, content: bytes) -> Path:
    path = submitted / student / "tiny" / tries_file_name("tiny")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    return path


def gathered(submitted: Path, out: Path) -> tuple[StudentTries, ...]:
    students = sorted(path.name for path in submitted.iterdir())
    gather_tries(submitted, students, "tiny", HEADINGS, out)
    return load_sent(out, "tiny")


def test_tries_are_gathered_without_names(tmp_path: Path) -> None:
    one, other = tries("sign", ""), tries("")
    hand_in(tmp_path / "in", "zoe", tries_bytes(one))
    hand_in(tmp_path / "in", "adam", tries_bytes((*other, KeptTry("q-9", 1, True))))
    assert gathered(tmp_path / "in", tmp_path / "out") == tuple(sorted((one, other)))
    text = (tmp_path / "out" / "tries" / "tiny.json").read_text(encoding="utf-8")
    assert "zoe" not in text
    assert "q-9" not in text


def test_what_is_not_sent_any_more_is_gone(tmp_path: Path) -> None:
    path = hand_in(tmp_path / "in", "zoe", tries_bytes(tries("")))
    assert len(gathered(tmp_path / "in", tmp_path / "out")) == 1
    path.unlink()
    assert gathered(tmp_path / "in", tmp_path / "out") == ()
    assert list((tmp_path / "out" / "tries").iterdir()) == []


def hostile() -> Iterator[bytes]:
    yield b""
    yield b"[" * 300_000
    yield b"\x00" * 500_000
    yield b'{"format": "labsid.tries/1", "tries": [' + b"[]," * 100_000 + b"[]]}"
    yield tries_bytes(tries("x" * 5000))
    yield tries_bytes((KeptTry("q-1", 10**12, True),))


def test_forged_files_leave_the_others(tmp_path: Path) -> None:
    for number, content in enumerate(hostile()):
        hand_in(tmp_path / "in", f"h{number}", content)
    target = hand_in(tmp_path / "in", "zoe", tries_bytes(tries("")))
    link = tmp_path / "in" / "link" / "tiny" / target.name
    link.parent.mkdir(parents=True)
    link.symlink_to(target)
    assert gathered(tmp_path / "in", tmp_path / "out") == (tries(""),)


@pytest.mark.parametrize(
    "content", ["", "[]", '{"schema": "other"}', '{"schema": "labsid.sent-tries/1", "sent": [[3]]}']
)
def test_a_damaged_store_is_none(content: str, tmp_path: Path) -> None:
    path = tmp_path / "tries" / "tiny.json"
    path.parent.mkdir()
    path.write_text(content, encoding="utf-8")
    assert load_sent(tmp_path, "tiny") == ()


# ---- in the report


def page_with(hard: HardAssignment | None) -> str:
    page = report_page([], ManualGrades({}, {}, frozenset()))
    page["hard"] = [] if hard is None else [hard]
    return load_template("report.html.j2").render(page=page)


def test_the_report_says_of_whom_and_escapes_names() -> None:
    html = page_with(what_was_hard("tiny", [tries("<script>alert(1)</script>", "")] * 5, 8, HEADINGS))
    assert "of those who sent them (5 of 8)" in html
    assert "&lt;script&gt;alert(1)&lt;/script&gt; (5)" in html
    assert "<script>" not in html
    assert "no suspicion" in html
    assert html.count('<span class="soft">&lt; 5</span>') == 2  # never right, and mistakes without a name


def test_without_tries_the_report_says_nothing_of_them() -> None:
    assert "What was hard" not in page_with(None)
