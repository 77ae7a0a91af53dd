"""Moodle's worksheet filled in and its feedback zip; the report; equal code; lateness from hand-in to export."""

import csv
import io
import json
import re
import shutil
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from urllib.parse import unquote

import pytest

from autograder.batch.executors import LocalExecutor
from autograder.batch.grade import Graded, grade_batch
from autograder.batch.selection import find_batch
from autograder.course.layout import Course
from autograder.course.students import Student, write_students
from autograder.export.grades_csv import export_csv
from autograder.export.moodle import export_moodle
from autograder.intake.submission import UNTOUCHED, NotebookCell
from autograder.intake.worksheet import Worksheet, read_worksheet
from autograder.judge.outcome import QuestionResult
from autograder.results import gradebook, grades, result_files
from autograder.results.copied import Copied
from autograder.results.feedback import FeedbackTexts, write_feedback
from autograder.results.gradebook import ManualGrades
from autograder.results.late import parse_rules
from autograder.results.report import report_page, write_report
from autograder.results.result_files import StoredResult
from autograder.results.similar import (
    MIN_NODES,
    EqualWork,
    code_fingerprints,
    find_equal,
    find_similar,
    normal_form,
)
from autograder.results.summary import class_table
from autograder.sandbox.isolation import ProcessLauncher

PRELAB = "prelab-sinusoids"
NOTHING = ManualGrades({}, {}, frozenset())


def question(name: str, score: str | None, most: str, status: str = "graded", **rest: object) -> QuestionResult:
    return QuestionResult(
        name,
        None if score is None else Decimal(score),
        Decimal(most),
        status,
        "Because.",
        **rest,  # type: ignore[arg-type]
    )


def stored(student: str, name: str = "tiny", *questions: QuestionResult, **rest: object) -> StoredResult:
    return StoredResult(student, name, name.title(), questions, {}, (), "none", {}, **rest)  # type: ignore[arg-type]


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Ada has 2 of 2 as 0.6 + 0.6 + 0.8, ben is late, cat's file was broken, dan waits."""
    folder = tmp_path / "out"
    thirds = [question("a", "0.6", "0.6"), question("b", "0.6", "0.6"), question("c", "0.8", "0.8")]
    wrong = question("b", "0", "0.6", slip="sign of a")
    broken = [question(name, "0", most, "quarantined") for name, most in (("a", "0.6"), ("b", "0.6"), ("c", "0.8"))]
    for one in (
        stored("ada", "tiny", *thirds),
        stored("ben@x.edu", "tiny", thirds[0], wrong, thirds[2], penalty=Decimal("0.2"), late="Handed in 1 d late."),
        stored("cat", "tiny", *broken),
        stored("1004", "tiny", thirds[0], question("b", None, "0.6", "manual"), thirds[2]),
        stored("eve", "tiny", *thirds),
    ):
        result_files.store(folder, one)
    return folder


HEADER = (
    "Identifier,Full name,Email address,ID number,Group,Status,Grade,Maximum Grade,Grade can be changed,"
    "Last modified (submission),Last modified (grade),Feedback comments"
)
ROWS = (
    'Participant 1001,"Lovelace, Ada",a@x.edu,ada,"A ""1""",Submitted,,2.00,Yes,-,"Monday, 1 June 2026, 9:00 AM",',
    "Participant 1002,Ben O'Neil,ben@x.edu,,B,Submitted,,2.00,Yes,-,-,",
    "Participant 1003,Cat,c@x.edu,cat,B,Submitted,,2.00,Yes,-,-,",
    "Participant 1004,Dan/../x,,,B,Submitted,,2.00,Yes,-,-,",
    "Participant 1005,Eve,eve@x.edu,eve,B,Submitted,1.00,2.00,No,-,-,mine",
    "Participant 1006,Fay,f@x.edu,fay,B,No submission,,2.00,Yes,-,-,",
)


@pytest.fixture
def sheet(tmp_path: Path) -> Worksheet:
    (tmp_path / "w.csv").write_text("\ufeff" + "\r\n".join([HEADER, *ROWS]) + "\r\n", encoding="utf-8", newline="")
    return read_worksheet(tmp_path / "w.csv")


def test_the_worksheet_comes_back_with_grades_and_nothing_else_changed(out: Path, sheet: Worksheet) -> None:
    done = export_moodle(out, sheet)
    text = done.worksheet.read_bytes().decode()
    assert text.startswith("\ufeff" + HEADER + "\r\n")
    rows = list(csv.DictReader(io.StringIO(text.removeprefix("\ufeff"), newline="")))
    assert [row["Grade"] for row in rows] == ["2", "1.2", "0", "1.4", "1.00", ""]
    for row, before in zip(rows, sheet.rows, strict=True):
        kept = [column for column in sheet.columns if column not in ("Grade", "Feedback comments")]
        assert [row[column] for column in kept] == [before[column] for column in kept]
    assert rows[1]["Feedback comments"].startswith(
        "tiny: 1.2 of 2 marks. Handed in 1 d late. Common mistakes: sign of a."
    )
    assert "Handed in, but could not be graded." in rows[2]["Feedback comments"]
    assert rows[4]["Feedback comments"] == "mine"
    assert rows[5]["Feedback comments"] == ""
    assert done.filled == 5
    assert done.remarks == (
        "1004: 0.6 marks not yet graded by hand",
        "eve: the grade is locked in Moodle and was not changed",
        "nothing handed in (the grade is left empty; --zero gives 0 marks): fay",
    )
    assert read_worksheet(done.worksheet).columns == sheet.columns  # and it can be read again


@pytest.mark.parametrize("username", ["ada", "ADA", "eve"])
def test_a_username_that_is_anothers_id_gets_nothing_of_the_other(out: Path, sheet: Worksheet, username: str) -> None:
    """Fay, who handed in nothing, and whose username is the ID of another student."""
    rows = [{**row, "Username": username if row["Full name"] == "Fay" else ""} for row in sheet.rows]
    with_names = Worksheet((*sheet.columns, "Username"), tuple(rows), "", sheet.path)
    with pytest.raises(ValueError, match=rf"(?i){username} is the ID of .* and the username of Fay \(fay\)"):
        export_moodle(out, with_names)
    assert not (out / "moodle").exists()
    # a worksheet of Fay alone, after the other has left: the stored table knows whose the ID is
    stored = [Student("ada", "Lovelace, Ada", participant="1001"), Student("eve", "", "eve@x.edu", participant="1005")]
    write_students(out / "students.csv", stored)
    alone = Worksheet((*sheet.columns, "Username"), (rows[-1] | {"ID number": ""},), "", sheet.path)
    with pytest.raises(ValueError, match=r"participant 100\d and Fay .* have the same ID"):
        export_moodle(out, alone)


def test_the_stored_table_says_who_is_who(out: Path, sheet: Worksheet) -> None:
    """Whatever stands in the columns of the worksheet that is filled in."""
    write_students(out / "students.csv", [Student("eve", participant="1001"), Student("ada", participant="1005")])
    rows = tuple({**row, "ID number": "", "Email address": ""} for row in sheet.rows if row["Full name"] != "Eve")
    done = export_moodle(out, Worksheet(sheet.columns, rows, "", sheet.path))
    with zipfile.ZipFile(done.feedback) as archive:
        page = archive.read("Lovelace, Ada_1001_assignsubmission_file_/feedback.html").decode()
    assert "eve" in page
    assert "ada" not in page


def test_the_feedback_zip_has_moodles_layout_and_the_same_bytes(out: Path, sheet: Worksheet) -> None:
    done = export_moodle(out, sheet)
    first = done.feedback.read_bytes()
    assert export_moodle(out, sheet).feedback.read_bytes() == first
    with zipfile.ZipFile(done.feedback) as archive:
        assert archive.namelist() == sorted(
            f"{who}_assignsubmission_file_/feedback.html"
            for who in ("Lovelace, Ada_1001", "Ben O'Neil_1002", "Cat_1003", "Dan..x_1004", "Eve_1005")
        )
        assert b"Handed in 1 d late." in archive.read("Ben O'Neil_1002_assignsubmission_file_/feedback.html")


def test_several_assignments_add_up_exactly_or_one_is_chosen(out: Path, sheet: Worksheet) -> None:
    for student in ("ada", "cat"):
        result_files.store(out, stored(student, "other", question("x", "0.1", "0.3")))
    with pytest.raises(ValueError, match=r"the worksheet's maximum is 2, but the marks are out of 2.3 ") as refused:
        export_moodle(out, sheet)
    line = f"labsid course export --format moodle --worksheet {sheet.path} --out {out}"
    assert str(refused.value).endswith(
        f"(tiny 2, other 0.3); nothing was written. Type, for tiny alone: {line} --assignment tiny; "
        f"to convert the marks to 2.00: {line} --scale"
    )
    assert not (out / "moodle").exists()
    done = export_moodle(out, sheet, scale=True)
    rows = [list(row.values()) for row in read_worksheet(done.worksheet).rows]
    assert rows[0][6] == "1.83"  # 2.1 of 2.3, in Moodle's 2
    assert rows[1][6] == "1.04"  # 1.2 of 2.3, too: nothing was handed in for the other
    assert "ada: 2.1 of 2.3 is 1.83 of 2.00" in done.remarks
    with zipfile.ZipFile(done.feedback) as archive:
        assert "Lovelace, Ada_1001_assignsubmission_file_/feedback-other.html" in archive.namelist()
    only = export_moodle(out, sheet, "tiny")
    assert read_worksheet(only.worksheet).rows[0]["Grade"] == "2"
    weighted = export_moodle(out, sheet, weights={"tiny": Decimal("1.5"), "other": Decimal("0.5")})
    assert read_worksheet(weighted.worksheet).rows[0]["Grade"] == "1.67"  # 1.5 + 0.5 / 3
    assert read_worksheet(weighted.worksheet).rows[1]["Grade"] == "0.9"  # 1.2 of 2 counts 1.5
    with pytest.raises(ValueError, match="holds no results of 'holiday'"):
        export_moodle(out, sheet, "holiday")


def test_a_student_who_is_not_in_the_worksheet_is_named(out: Path, sheet: Worksheet) -> None:
    result_files.store(out, stored("zoe", "tiny", question("a", "0.6", "0.6")))
    assert "zoe: not in the worksheet" in export_moodle(out, sheet).remarks


def test_who_handed_in_nothing_is_named_and_gets_0_only_if_asked(out: Path, sheet: Worksheet) -> None:
    done = export_moodle(out, sheet)
    assert "nothing handed in (the grade is left empty; --zero gives 0 marks): fay" in done.remarks
    done = export_moodle(out, sheet, zero=True)
    assert "nothing handed in (0 marks were given): fay" in done.remarks
    *others, fay = csv.DictReader(io.StringIO(done.worksheet.read_text(encoding="utf-8-sig"), newline=""))
    assert (fay["Grade"], fay["Feedback comments"]) == ("0", "Nothing was handed in.")
    assert [row["Grade"] for row in others] == ["2", "1.2", "0", "1.4", "1.00"]


def test_the_csv_has_a_row_of_0_for_who_of_the_class_handed_in_nothing(out: Path) -> None:
    def rows(*students: str) -> list[dict[str, str]]:
        write_students(out / "students.csv", [Student(one) for one in students])
        return list(csv.DictReader(io.StringIO(export_csv(out).read_text(encoding="utf-8"))))

    *others, fay = rows("ada", "fay")
    assert others == rows("ada")
    expected = {"student": "fay", "assignment": "tiny", "score": "0", "max_score": "2", "status": "missing"}
    assert fay == {**expected, "waiting": "0", "late_penalty": "0"}


def test_a_worksheet_without_the_columns_is_said(out: Path) -> None:
    with pytest.raises(ValueError, match="no column Grade and no column Feedback comments"):
        export_moodle(out, Worksheet(("Identifier",), (), ""))


# ---- lateness, from the hand-in to the exports


def test_lateness_is_taken_off_everywhere_and_can_be_changed_without_grading(
    course: Course, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    for student in ("ann", "bob"):
        shutil.copytree(course.source / PRELAB, tmp_path / "submitted" / student / PRELAB)
    stamp = tmp_path / "submitted" / "bob" / PRELAB / "timestamp.txt"
    stamp.write_text("2026-12-02 12:00:00.000000 UTC\n", encoding="utf-8")
    out = tmp_path / "out"

    def grade(rules: str | None) -> list[Graded]:
        late = None if rules is None else parse_rules(rules)
        batch = find_batch(course, tmp_path / "submitted")
        return list(grade_batch(course, batch, out, LocalExecutor(launcher, 2), late=late))

    def exported() -> Mapping[str, tuple[str, str]]:
        with export_csv(out).open(encoding="utf-8", newline="") as file:
            return {row["student"]: (row["score"], row["late_penalty"]) for row in csv.DictReader(file)}

    assert all(one.fresh for one in grade("due=2026-12-01T00:00,per-day=10%"))
    assert exported() == {"ann": ("0.95", "0"), "bob": ("0.75", "0.2")}
    with gradebook.open_gradebook(gradebook.database_url(out)) as book:
        late = book.find_submission(PRELAB, "bob")
        assert late.late_submission_penalty == pytest.approx(0.2)
        assert str(late.timestamp) == "2026-12-02 12:00:00"
        assert book.find_submission(PRELAB, "ann").late_submission_penalty == 0
    list(write_feedback(out))
    page = (out / "feedback" / "bob" / f"{PRELAB}.html").read_text(encoding="utf-8")
    assert "Handed in 1 d 12 h late: 0.2 of 1 marks deducted (10 % per started day)." in page
    assert "<strong>0.75</strong>" in page
    assert "Handed in 1 d 12 h late" in write_report(out).read_text(encoding="utf-8")
    assert "0.2 late penalty" in class_table(out)
    questions = (out / "grades.csv").read_bytes()

    assert not any(one.fresh for one in grade("due=2026-12-01T00:00,per-day=5%"))
    assert exported()["bob"] == ("0.85", "0.1")
    assert (out / "grades.csv").read_bytes() == questions
    stamp.write_text("2026-11-02 12:00:00 UTC", encoding="utf-8")
    assert not any(one.fresh for one in grade("due=2026-12-01T00:00,per-day=5%"))
    assert exported()["bob"] == ("0.95", "0")
    with gradebook.open_gradebook(gradebook.database_url(out)) as book:
        assert book.find_submission(PRELAB, "bob").late_submission_penalty == 0


def test_a_penalty_takes_no_more_than_there_is() -> None:
    one = stored("ann", "tiny", question("a", "0.1", "0.6"), penalty=Decimal("0.3"))
    assert grades.totals(one, {}).score == 0


# ---- hand grading that an automatic change overtook


def test_hand_grading_survives_and_is_flagged_when_the_automatic_part_changes(
    course: Course, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    open_question = "prelab-6-clock"
    path = tmp_path / "submitted" / "ann" / PRELAB / f"{PRELAB}.ipynb"
    shutil.copytree(course.source / PRELAB, path.parent)
    batch, out = find_batch(course, tmp_path / "submitted"), tmp_path / "out"
    list(grade_batch(course, batch, out, LocalExecutor(launcher)))
    with gradebook.open_gradebook(gradebook.database_url(out)) as book:
        grade = book.find_grade(open_question, PRELAB, PRELAB, "ann")
        grade.manual_score, grade.needs_manual_grade = 0.03, False
        book.db.commit()
    notebook = json.loads(path.read_text(encoding="utf-8"))
    notebook["cells"].append({"cell_type": "markdown", "metadata": {}, "source": "Done."})
    path.write_text(json.dumps(notebook), encoding="utf-8")
    list(grade_batch(course, batch, out, LocalExecutor(launcher)))
    assert gradebook.read_manual_grades(out).needs_review == frozenset()  # graded again, and nothing came out otherwise

    (cell,) = (cell for cell in notebook["cells"] if cell.get("id") == "prelab-1-time-answer")
    cell["source"] = "t = 0"
    path.write_text(json.dumps(notebook), encoding="utf-8")
    list(grade_batch(course, batch, out, LocalExecutor(launcher)))
    given = gradebook.read_manual_grades(out)
    assert given.scores["ann", PRELAB, open_question] == Decimal("0.03")
    assert given.needs_review == {("ann", PRELAB, open_question)}
    assert "review manual grades" in class_table(out)
    assert "changed after it was graded by hand" in write_report(out).read_text(encoding="utf-8")
    with gradebook.open_gradebook(gradebook.database_url(out)) as book:
        book.find_grade(open_question, PRELAB, PRELAB, "ann").needs_manual_grade = False  # reviewed
        book.db.commit()
    assert not any(one.fresh for one in grade_batch(course, batch, out, LocalExecutor(launcher)))
    assert gradebook.read_manual_grades(out).needs_review == frozenset()


# ---- the report


def test_the_report_adds_up_exactly(out: Path) -> None:
    page = report_page(result_files.load_all(out), NOTHING)
    (tiny,) = page["assignments"]
    assert (tiny["handed_in"], tiny["late"]) == (4, 1)
    assert tiny["refused"] == ["1 handed in, but could not be graded"]
    assert (tiny["median"], tiny["mean"], tiny["max_score"], tiny["waiting"]) == ("1.7", "1.65", "2", "0.6")
    assert [bar["count"] for bar in tiny["bars"]] == [0, 0, 0, 0, 0, 0, 1, 1, 0, 2]
    costliest = tiny["questions"][0]
    assert (costliest["id"], costliest["lost"], costliest["full"], costliest["graded"]) == ("b", "0.6", 2, 3)
    assert costliest["slip"] == "sign of a (1)"
    assert tiny["slips"] == [{"slip": "sign of a", "count": 1, "lost": "0.6"}]
    assert [(review["student"], review["reasons"]) for review in page["reviews"]] == [
        ("cat", ["handed in, but could not be graded (quarantined)"]),
        ("ben@x.edu", ["Handed in 1 d late."]),
    ]
    assert page["unisolated"] == 5


def test_a_comment_on_several_assignments_names_each_one(out: Path, sheet: Worksheet) -> None:
    own = stored("ada", "other", question("a", "1", "1"), extension="4 December", late="Handed in 1 h late.")
    result_files.store(out, own)
    result_files.store(out, replace(stored("cat", "other", question("a", "0", "1", "missing")), notes=(UNTOUCHED,)))
    done = export_moodle(out, sheet, scale=True)
    text = done.worksheet.read_bytes().decode().removeprefix("\ufeff")
    comments = [row["Feedback comments"] for row in csv.DictReader(io.StringIO(text, newline=""))]
    assert comments[0] == (
        "other, tiny: 3 of 3 marks. other: Extension until 4 December. other: Handed in 1 h late. "
        "See the feedback file for details."
    )
    assert "other: Handed in as it was released, without an answer." in comments[2]
    assert "tiny: Handed in, but could not be graded." in comments[2]


def test_the_table_says_why_a_hand_in_could_not_be_graded(out: Path) -> None:
    long = "x.ipynb cannot be read: [/red] " + 200 * "a"
    cat = stored("cat", "tiny", question("a", "0", "0.6", "quarantined"))
    result_files.store(out, replace(cat, notes=(long,)))
    (line,) = [line for line in class_table(out).splitlines() if line.startswith("cat")]
    assert line.endswith(f"quarantined ({long[:100]} ...)")


def test_missing_untouched_and_unreadable_hand_ins_have_words_of_their_own(out: Path) -> None:
    missing = [question("a", "0", "0.6", "missing")]
    class_ = [
        stored("ann", "tiny", *missing),
        replace(stored("bob", "tiny", *missing), notes=(UNTOUCHED,)),
        replace(stored("cat", "tiny", question("a", "0", "0.6", "quarantined")), notes=("x.ipynb cannot be read",)),
        stored("dan", "tiny", question("a", "0", "0.6"), extension="4 December 2026, 23:59 (UTC)"),
    ]
    page = report_page(class_, NOTHING)
    assert page["missing"] == [
        {"assignment": "tiny", "words": "not handed in", "students": ["ann"]},
        {"assignment": "tiny", "words": "handed in as it was released, without an answer", "students": ["bob"]},
    ]
    assert [row["cells"][0]["status"] for row in page["class"]] == [
        "not handed in",
        "handed in as it was released, without an answer",
        "handed in, but could not be graded",
        "",
    ]
    said = {}
    for one in class_:
        result_files.store(out, one)
    for path in write_feedback(out):
        said[path.parent.name] = path.read_text(encoding="utf-8")
    assert "<div>Not handed in.</div>" in said["ann"]
    assert "<div>Handed in as it was released, without an answer.</div>" in said["bob"]
    assert "<div>Handed in, but could not be graded.</div>" in said["cat"]
    for refused in ("ann", "bob", "cat"):
        assert "automatically graded questions are right" not in said[refused]
    assert "0 of 1 automatically graded questions are right." in said["dan"]
    assert "Extension: due for you on 4 December 2026, 23:59 (UTC)." in said["dan"]
    written = write_report(out).read_text(encoding="utf-8")
    assert re.search(r"Extensions: <a [^>]*>dan</a> until 4 December 2026, 23:59 \(UTC\)\.", written)


def test_no_heading_of_a_page_is_twice_there(out: Path) -> None:
    twice = [question(name, "0", "0.5", slip="sign of a") for name in ("q-1", "q-2", "q-3")]
    headings = {"q-1": "1. Read", "q-2": "2. Offsets", "q-3": "2. Offsets"}
    for name in ("tiny", "other"):
        result_files.store(out, replace(stored("fay", name, *twice), headings=headings))
    written = [*write_feedback(out), write_report(out)]
    for path in written:
        found = re.findall(r"<h[1-6][^>]*>(.*?)</h[1-6]>", path.read_text(encoding="utf-8"), re.DOTALL)
        assert len(found) == len(set(found)), path
    page = (out / "feedback" / "fay" / "tiny.html").read_text(encoding="utf-8")
    assert "2. Offsets (1 of 2)</h2>" in page
    assert "1. Read</h2>" in page


def test_each_reason_to_look_is_given() -> None:
    crashed = question("a", "0", "0.6", "crashed")
    many = [
        stored("ann", "tiny", crashed, flags=("made on the record of bob: a",)),
        StoredResult(
            "bob", "tiny", "Tiny", (question("a", "0.6", "0.6"),), {}, ("the cell x was put back",), "none", {}
        ),
    ]
    reviews = {review["student"]: review["reasons"] for review in report_page(many, NOTHING)["reviews"]}
    assert reviews["ann"] == ["made on the record of bob: a", "crashed: a", "no automatic question is right"]
    assert reviews["bob"] == ["repaired: the cell x was put back"]


def test_the_report_stands_alone_and_runs_nothing(tmp_path: Path) -> None:
    evil = "<script>alert(1)</script>\x1b[31m"
    one = StoredResult(
        evil.replace("/", ""), "tiny", evil, (question("q", "0", "0.6", slip=evil),), {"q": evil}, (evil,), evil, {},
        flags=(evil,), late=evil,
    )  # fmt: skip
    result_files.store(tmp_path, one)
    page = write_report(tmp_path).read_text(encoding="utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;" in page
    assert "\x1b" not in page
    assert not re.search(r"https?:|<link|@import|src=", page)


# ---- equal code


FIRST = '''
def first_period(u):
    """Count them."""
    n = 0  # from the start
    while n < len(u) and u[n] == u[0]:
        n += 1
    return n
'''
COPY = """
def first_period( signal ):
    counter=0
    while counter < len(signal) and signal[counter] == signal[0]:
        # one more
        counter += 1
    return counter
"""
OTHER = "def first_period(u):\n    return int(np.flatnonzero(np.diff(u))[0]) + 1 if np.any(np.diff(u)) else len(u)"


def test_names_comments_and_spaces_do_not_hide_a_copy() -> None:
    assert normal_form(FIRST) == normal_form(COPY)
    assert normal_form(FIRST) != normal_form(OTHER)
    assert normal_form("x = np.sin(y)") != normal_form("x = np.cos(y)")
    assert normal_form("a = u; b = v") == normal_form("c = u\nd = v")
    assert normal_form("no python (") == ("no python (", 3)


def test_released_code_and_short_cells_tell_nothing() -> None:
    steps = [
        NotebookCell("a", "answer", FIRST, True), NotebookCell("q1", "question", "check()", True),
        NotebookCell("b", "answer", "x = 1", True), NotebookCell("q2", "question", "check()", True),
        NotebookCell("c", "answer", OTHER, True), NotebookCell("q3", "question", "check()", True),
    ]  # fmt: skip
    found = code_fingerprints(steps, {"c": OTHER})
    assert {question: size >= MIN_NODES for question, (_, size) in found.items()} == {"q1": True, "q2": False}
    pair = [stored(student, "tiny", work={"q2": ("a", 3), "q4": ("b", 4)}) for student in ("ann", "bob")]
    assert find_similar(pair) == []


def test_equal_notebooks_and_texts_are_found_however_many_have_them() -> None:
    text = "The second half does not start from rest, so that the error is larger."
    same = {"q1": ("a", 100), "q2": ("b", 3), "q3": ("c", 60)}
    class_ = [
        stored(f"s{n:02}", "tiny", question("open", None, "0.1", "manual", answer=text), work=same) for n in range(9)
    ]
    class_ += [
        stored("ann", "tiny", question("open", None, "0.1", "manual", answer=text.upper().replace(",", " --\n"))),
        stored(
            "bob", "tiny", question("open", None, "0.1", "manual", answer="It is wrong."), work={**same, "q2": ("d", 3)}
        ),
        stored("cat", "tiny", question("open", None, "0.1", "manual", answer="It is wrong."), work={"q2": ("b", 3)}),
        stored("dan", "tiny", question("a", "0.1", "0.1", answer=text), work={"q2": ("b", 3)}),
        stored("eve", "other", question("open", None, "0.1", "manual", answer=text), work=same),
    ]
    nine = tuple(f"s{n:02}" for n in range(9))
    assert find_equal(class_) == [EqualWork("tiny", None, nine), EqualWork("tiny", "open", (*nine, "ann"))]
    page = report_page(class_, NOTHING, {"s00": "Öz, <b>"})
    assert page["similar"] == []
    assert [len(one["students"]) for one in page["equal"]] == [9, 10]


def test_the_report_shows_copied_code_and_the_second_record(out: Path) -> None:
    copied = Copied({"q1": "labsid.lab.arx.fit_arx"}, ("q<2>",))
    off = stored("zoe", "other", question("a", "0.6", "0.6"), copied=copied, second_record="off")
    ran = stored("zoe", "tiny", question("a", "0.6", "0.6"), second_record="run")
    for one in (off, ran):
        result_files.store(out, one)
        assert result_files.load(result_files.result_path(out, "zoe", one.assignment)) == one
    gradebook.prepare(Course(out), out, ())
    page = write_report(out).read_text(encoding="utf-8")
    assert "the same as labsid.lab.arx.fit_arx; it may have been derived" in page
    assert "q&lt;2&gt;</td><td>code as text: a long literal is decoded" in page
    assert "switched off in course.toml" in page
    assert "also tried on records that nobody has seen" in page


def test_the_report_names_students_and_links_to_their_pages(out: Path) -> None:
    result_files.store(out, stored("a/b".replace("/", " #?"), "tiny", question("a", "0", "0.6")))
    gradebook.prepare(Course(out), out, ())
    gradebook.enter_students(out, [Student("ada", "Lovelace, Ada"), Student("cat", "<i>Cat")])
    page = write_report(out, FeedbackTexts("Identification")).read_text(encoding="utf-8")
    assert "<h1>Identification: class report</h1>" in page
    assert "Ada Lovelace" in page
    assert "&lt;i&gt;Cat" in page
    links = re.findall(r'href="(feedback/[^"]*)"', page)
    assert "feedback/ben%40x.edu/tiny.html" in links
    assert "feedback/a%20%23%3Fb/tiny.html" in links
    assert len(set(links)) == 6
    assert all((out / unquote(link)).is_file() for link in links)
    assert "Ada Lovelace</td>" not in page  # the ID stands beside the name
    assert "Ada Lovelace (ada)" in (out / "feedback" / "ada" / "tiny.html").read_text(encoding="utf-8")


def test_copies_are_found_and_what_many_wrote_is_not() -> None:
    mine = {"q1": ("a", 40), "q2": ("b", 60), "q3": ("common", 100)}
    work = {
        "ann": mine, "bob": {**mine, "q4": ("e", 30)}, "cat": {"q1": ("c", 40), "q3": ("common", 100)},
        "dan": {"q2": ("d", 60), "q3": ("common", 100)}, "eve": {"q1": ("a", 40), "q2": ("f", 90)},
    }  # fmt: skip
    pairs = find_similar([stored(student, "tiny", work=cells) for student, cells in work.items()])
    assert [(pair.first, pair.second, pair.questions) for pair in pairs] == [("ann", "bob", ("q1", "q2"))]
    assert pairs[0].share == 1
