"""The gradebook of Canvas filled in, and files in the columns of Canvas and Gradescope."""

import csv
import io
from decimal import Decimal
from pathlib import Path

import pytest

from autograder.course.students import Student, write_students
from autograder.export.canvas import CanvasExport, export_canvas
from autograder.export.gradescope import export_gradescope
from autograder.intake.canvas_gradebook import CanvasGradebook, as_worksheet, read_gradebook
from autograder.judge.outcome import QuestionResult
from autograder.results import result_files
from autograder.results.result_files import StoredResult
from labsid.cli.commands import main

HEADER = (
    "Student,ID,SIS User ID,SIS Login ID,Section,Notes,Pre-lab: Sinusoids (9001),Lab 1 (9002),Essay (9003),"
    "Assignments Current Points,Final Score"
)
ABOVE = (
    ",,,,,,,,,Manual Posting,",
    "    Points Possible,,,,,,2.00,10,5,(read only),(read only)",
)
ROWS = (
    '"Lovelace, Ada",501,s-ada,ada,Mon,"late, ""ill""",,7,4.5,1,9',
    '"O\'Neil, Ben",502,,BEN@x.edu,Mon,,1.5,,,,',
    "\"=cmd|' /C calc'!A0, Cat\",503,cat,cat9,Tue,,,,EX,,",
    '"Dan",504,dan,dan,Tue,,EX,,,,',
    '"Noether, Emmy",505,emmy,emmy,Tue,,,,,,',
    '"Student, Test",599,,5f3a,Mon,,,,,,',
)


def question(name: str, score: str | None, most: str, status: str = "graded") -> QuestionResult:
    return QuestionResult(name, None if score is None else Decimal(score), Decimal(most), status, "Because.")


def stored(student: str, name: str, title: str, *questions: QuestionResult) -> StoredResult:
    return StoredResult(student, name, title, questions, {}, (), "none", {}, submitted="2026-06-01T09:00:00+00:00")


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Two assignments: marks of 2 and of 8; Ben's second waits, Zoe is not in the gradebook."""
    folder = tmp_path / "out"
    for student, first in (("ada", "1.75"), ("ben", "0.5"), ("cat", "2"), ("dan", "1"), ("zoe", "2")):
        result_files.store(folder, stored(student, "prelab-sinusoids", "Pre-lab: sinusoids", question("a", first, "2")))
    for student, second in (("ada", "8"), ("ben", None)):
        status = "manual" if second is None else "graded"
        result_files.store(folder, stored(student, "lab-x", "Lab X", question("b", second, "8", status)))
    students = [Student("ada", "Ada Lovelace"), Student("ben", "Ben O'Neil", "ben@x.edu"), Student("fay", "=Fay Lo")]
    write_students(folder / "students.csv", students)
    return folder


def book_of(path: Path, *rows: str, header: str = HEADER, above: tuple[str, ...] = ABOVE, end: str = "\n") -> Path:
    path.write_text("\ufeff" + end.join([header, *above, *(rows or ROWS)]) + end, encoding="utf-8", newline="")
    return path


@pytest.fixture
def book(tmp_path: Path) -> CanvasGradebook:
    return read_gradebook(book_of(tmp_path / "g.csv"))


def rows_of(done: CanvasExport) -> list[dict[str, str]]:
    text = done.path.read_bytes().decode("utf-8-sig")
    return list(csv.DictReader(io.StringIO(text, newline="")))


def test_the_gradebook_comes_back_with_one_column_filled_in_and_nothing_else_changed(
    out: Path, book: CanvasGradebook
) -> None:
    done = export_canvas(out, book)
    lines = done.path.read_bytes().decode().split("\n")
    assert lines[:3] == ["\ufeff" + HEADER, *ABOVE]
    rows = rows_of(done)[2:]
    assert [row["Pre-lab: Sinusoids (9001)"] for row in rows] == ["1.75", "0.5", "2", "EX", "", ""]
    before = list(csv.DictReader(io.StringIO("\n".join([HEADER, *ROWS]))))
    kept = [name for name in book.columns if name not in ("Student", "Pre-lab: Sinusoids (9001)")]
    assert [[row[name] for name in kept] for row in rows] == [[row[name] for name in kept] for row in before]
    assert [row["Student"][:1] for row in rows] == ["L", "O", "'", "D", "N", "S"]  # no formula
    assert done.columns == ("Pre-lab: Sinusoids (9001)",)
    assert done.filled == 4
    assert done.remarks == (
        "lab-x: no column of this gradebook, not written",
        "ben: Pre-lab: Sinusoids (9001) was 1.5 in the gradebook and is 0.5",
        "dan: excused in Canvas, and not changed (Pre-lab: Sinusoids (9001): 1)",
        "zoe: not in the gradebook",
        "not known in this class: Noether, Emmy",
        "nothing handed in (the mark is left empty; --zero gives 0 marks): Noether, Emmy",
    )


def test_zero_gives_no_marks_to_the_test_student(out: Path, book: CanvasGradebook) -> None:
    rows = rows_of(export_canvas(out, book, "prelab-sinusoids", zero=True))[2:]
    assert [row["Pre-lab: Sinusoids (9001)"] for row in rows] == ["1.75", "0.5", "2", "EX", "0", ""]


def test_a_sum_goes_into_the_column_that_is_named_and_is_converted_on_demand(out: Path, book: CanvasGradebook) -> None:
    done = export_canvas(out, book, column="Lab 1")
    assert [row["Lab 1 (9002)"] for row in rows_of(done)[2:5]] == ["9.75", "0.5", "2"]
    assert "ben: 8 marks not yet graded by hand" in done.remarks
    assert "ada: Lab 1 (9002) was 7 in the gradebook and is 9.75" in done.remarks
    with pytest.raises(ValueError, match=r"^Essay \(9003\) is out of 5 points in Canvas, but .* out of 8; .*--scale$"):
        export_canvas(out, book, "lab-x", column="Essay (9003)")
    scaled = export_canvas(out, book, "lab-x", column="Essay (9003)", scale=True)
    assert [row["Essay (9003)"] for row in rows_of(scaled)[2:5]] == ["5", "0", "EX"]


def test_a_file_with_semicolons_and_windows_lines_comes_back_in_its_own_format(out: Path, tmp_path: Path) -> None:
    header = "Student;ID;SIS Login ID;Section;lab x (7)"
    path = book_of(
        tmp_path / "s.csv", "Ada;501;ada;A;3,5", header=header, above=(" Points Possible;;;;8,0",), end="\r\n"
    )
    text = export_canvas(out, read_gradebook(path)).path.read_bytes().decode()
    assert text == "\ufeff" + header + "\r\n Points Possible;;;;8,0\r\nAda;501;ada;A;8\r\n"


def test_without_a_gradebook_a_new_one_has_all_students(out: Path) -> None:
    done = export_canvas(out, None, zero=True)
    assert done.path.read_text(encoding="utf-8").splitlines() == [
        "Student,ID,SIS User ID,SIS Login ID,Section,Pre-lab: sinusoids,Lab X",
        "    Points Possible,,,,,2,8",
        '"Lovelace, Ada",,,ada,,1.75,8',
        '"O\'Neil, Ben",,,ben,,0.5,0',
        "cat,,,cat,,2,0",
        "dan,,,dan,,1,0",
        '"Lo, =Fay",,,fay,,0,0',
        "zoe,,,zoe,,2,0",
    ]


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (("Ada,501,ben,ada,M,,,,,,",), "the row of Ada belongs to two students by its IDs, .*ada.* and .*ben"),
        (("A,501,,ada,M,,,,,,", "B,502,ada,,M,,,,,,"), "the rows of A and B both belong to ada"),
        (("A,501,,ada,M,",), r"has 6 fields in row 4, but 11 columns"),
    ],
)
def test_who_is_not_clear_or_a_broken_file_is_refused(
    rows: tuple[str, ...], said: str, out: Path, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=said):
        export_canvas(out, read_gradebook(book_of(tmp_path / "g.csv", *rows)))
    assert not (out / "canvas").exists()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"\xff\xfe", "is not text in UTF-8"),
        (b"Identifier,Full name\n", "is not a gradebook of Canvas: it has no column 'Student'"),
        (b"Student,SIS Login ID,A,A\n", "has the column 'A' twice"),
        (b'Student,SIS Login ID\n"a', "is not CSV"),
        (b"", "is not a gradebook of Canvas"),
    ],
)
def test_what_is_no_gradebook_is_refused(content: bytes, said: str, tmp_path: Path) -> None:
    (tmp_path / "g.csv").write_bytes(content)
    with pytest.raises(ValueError, match=said):
        read_gradebook(tmp_path / "g.csv")


def test_a_column_that_is_not_there_or_cannot_be_filled_in_is_refused(out: Path, book: CanvasGradebook) -> None:
    with pytest.raises(ValueError, match=r"no column with the name or title of lab-x\. Its columns are 'Pre-lab"):
        export_canvas(out, book, "lab-x")
    with pytest.raises(ValueError, match="has no column that can be filled in of the name 'Final Score'"):
        export_canvas(out, book, column="Final Score")
    with pytest.raises(ValueError, match="holds no results of 'lab-y'"):
        export_canvas(out, book, "lab-y")


def test_the_ids_of_canvas_are_those_of_the_course(book: CanvasGradebook) -> None:
    found = as_worksheet(book).rows
    assert tuple(found[0].values()) == ("Participant 501", "Ada Lovelace", "", "ada", "ada")
    assert tuple(found[1].values()) == ("Participant 502", "Ben O'Neil", "BEN@x.edu", "BEN@x.edu", "BEN@x.edu")
    assert as_worksheet(book, [Student("s-ada")]).rows[0]["ID number"] == "s-ada"


def test_marks_in_the_columns_of_gradescope(out: Path) -> None:
    path, remarks = export_gradescope(out, "lab-x")
    assert path.read_text(encoding="utf-8").splitlines() == [
        "First Name,Last Name,SID,Email,Sections,Lab X,Lab X - Max Points,Lab X - Submission Time,"
        "Lab X - Lateness (H:M:S)",
        "Ada,Lovelace,ada,,,8,8,2026-06-01T09:00:00+00:00,",
        "Ben,O'Neil,ben,ben@x.edu,,0,8,2026-06-01T09:00:00+00:00,",
        ",,cat,,,,8,,",
        ",,dan,,,,8,,",
        "'=Fay,Lo,fay,,,,8,,",
        ",,zoe,,,,8,,",
    ]
    assert remarks == ("ben: 8 marks of lab-x not yet graded by hand",)
    with pytest.raises(ValueError, match="holds no results of 'x'"):
        export_gradescope(out, "x")


def test_the_command_fills_in_and_says_what_to_import(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    book = str(book_of(tmp_path / "g.csv"))
    assert main(["course", "export", "--out", str(out), "--format", "canvas", "--worksheet", book]) == 0
    said = capsys.readouterr().out
    assert f"Marks of 4 students in 'Pre-lab: Sinusoids (9001)'. Import {out / 'canvas' / 'gradebook.csv'}." in said
    assert main(["course", "export", "--out", str(out), "--format", "gradescope"]) == 0
    assert f"Wrote {out / 'gradescope' / 'grades.csv'}" in capsys.readouterr().out
    assert main(["course", "export", "--out", str(out), "--format", "canvas", "--scale"]) == 2
    assert capsys.readouterr().err.splitlines()[-1].startswith("labsid: error: --scale needs --worksheet")
