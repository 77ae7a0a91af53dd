"""Hand-ins out of the zip files of Canvas and Gradescope: whose they are, when they came, hostile names and tables."""

import json
import zipfile
from pathlib import Path

import pytest

from autograder.course.layout import Course
from autograder.course.students import Student, read_students
from autograder.intake.canvas_gradebook import CanvasGradebook, read_gradebook
from autograder.intake.collect import collect_submissions
from autograder.intake.other_downloads import METADATA, list_gradescope, which_system
from autograder.intake.submission import LATE_FILE, NOT_READ_FILE
from autograder.intake.worksheet import read_worksheet

PRELAB, LAB = "prelab-sinusoids", "lab-identification"
TOP = "assignment_77_export"


@pytest.fixture
def notebook(course: Course) -> str:
    return with_mark(course, "Done.")


def with_mark(course: Course, mark: str, name: str = LAB) -> str:
    changed = json.loads((course.release / name / f"{name}.ipynb").read_bytes())
    changed["cells"].append({"cell_type": "markdown", "metadata": {}, "source": mark, "id": "mark"})
    return json.dumps(changed)


def packed(path: Path, files: dict[str, str | bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, (2026, 11, 20, 12, 0, 0)), content)
    return path


def collected(out: Path) -> dict[str, str]:
    """The text of the last cell of each notebook, by its path."""
    return {
        path.relative_to(out).as_posix(): json.loads(path.read_bytes())["cells"][-1]["source"]
        for path in sorted(out.rglob("*.ipynb"))
    }


@pytest.fixture
def gradebook(tmp_path: Path) -> CanvasGradebook:
    rows = (
        "Student,ID,SIS User ID,SIS Login ID,Section,Lab (1)",
        "    Points Possible,,,,,2",
        '"Lovelace, Ada",501,s1,ada,A,',
        '"Five, Bo_502",777,s2,bo,A,',
        '"Victim, Vic",502,s3,vic,A,',
        '"Nobody, Nell",503,s4,nell,A,',
        '"Student, Test",599,,0a1b2c,A,',
    )
    (tmp_path / "gradebook.csv").write_text("\n".join(rows), encoding="utf-8")
    return read_gradebook(tmp_path / "gradebook.csv")


def test_a_download_of_canvas_late_and_with_several_attempts(
    course: Course, gradebook: CanvasGradebook, tmp_path: Path
) -> None:
    lab = {mark: with_mark(course, mark) for mark in ("first", "second", "third")}
    files: dict[str, str | bytes] = {
        f"lovelaceada_LATE_501_9001_{LAB}.ipynb": lab["first"],
        f"lovelaceada_LATE_501_9002_{LAB}-1.ipynb": lab["second"],
        f"lovelaceada_LATE_501_9003_{LAB}-2.ipynb": lab["third"],
        "nobodynell_503_9004_essay.pdf": b"%PDF",
        f"strangerzoe_888_9005_{LAB}.ipynb": lab["first"],
        "grades.txt": b"",
    }
    path = packed(tmp_path / "submissions.zip", files)
    assert list(collect_submissions(course, path, tmp_path / "out", gradebook)) == [
        f"ada (lovelaceada): {LAB} (the latest of 3 versions: attempt 3/{LAB}.ipynb); late in Canvas, whose download "
        "has no times: no penalty is taken off",
        "nell (nobodynell): no notebook of this course; skipped: essay.pdf",
        f"888 (strangerzoe): {LAB}; not in the gradebook: the participant number is the ID",
        "files of no participant: grades.txt",
    ]
    assert collected(tmp_path / "out") == {f"888/{LAB}/{LAB}.ipynb": "first", f"ada/{LAB}/{LAB}.ipynb": "third"}
    students = {one.id: one for one in read_students(tmp_path / "out" / "students.csv")}
    assert students["ada"] == Student("ada", "Ada Lovelace", "", "ada", "501")
    assert "bo" in students
    assert "0a1b2c" not in students  # the test student of Canvas
    assert (tmp_path / "out" / "ada" / LAB / LATE_FILE).is_file()
    assert not (tmp_path / "out" / "888" / LAB / LATE_FILE).exists()
    again = list(collect_submissions(course, path, tmp_path / "out"))  # who is who was decided before
    assert again[0].startswith("ada (lovelaceada)")
    in_time = packed(tmp_path / "in-time.zip", {f"lovelaceada_501_9001_{LAB}.ipynb": lab["first"]})
    list(collect_submissions(course, in_time, tmp_path / "out"))
    assert not (tmp_path / "out" / "ada" / LAB / LATE_FILE).exists()


def converted(notebook: str, share: float = 1.0) -> str:
    """A notebook as Colab saves it: without the metadata of the course, with ids of its own; only its first cells."""
    changed = json.loads(notebook)
    changed["metadata"] = {"colab": {"provenance": []}, "kernelspec": {"name": "python3", "display_name": "Python 3"}}
    changed["nbformat_minor"] = 0
    changed["cells"] = changed["cells"][: round(share * len(changed["cells"]))]
    for number, cell in enumerate(changed["cells"]):
        cell.pop("id", None)
        cell["metadata"] = {"id": f"x{number}"}
    return json.dumps(changed)


def test_a_notebook_without_metadata_is_known_by_its_text_whatever_its_name(
    course: Course, gradebook: CanvasGradebook, tmp_path: Path
) -> None:
    lab, prelab = (converted(with_mark(course, "Done.", name)) for name in (LAB, PRELAB))
    files: dict[str, str | bytes] = {
        "fivebo_777_1_Untitled3.ipynb": prelab,
        f"lovelaceada_501_2_{PRELAB}.ipynb": lab,  # its name is that of another assignment
        "victimvic_502_3_my work.ipynb": converted(lab, 0.3),
        "nobodynell_503_4_poem.ipynb": json.dumps({"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}),
    }
    lines = list(
        collect_submissions(course, packed(tmp_path / "s.zip", files), tmp_path / "out", gradebook, system="canvas")
    )
    assert lines == [
        f"bo (fivebo): {PRELAB}",
        f"ada (lovelaceada): {LAB}",
        "nell (nobodynell): no notebook of this course; skipped: poem.ipynb: not a notebook of this course",
        "vic (victimvic): no notebook of this course; skipped: my work.ipynb: not a notebook of this course",
    ]
    for student, said in (("nell", "poem.ipynb"), ("vic", "my work.ipynb")):
        note = (tmp_path / "out" / student / NOT_READ_FILE).read_text(encoding="utf-8")
        assert note == f"{said}: not a notebook of this course\n"
    assert not (tmp_path / "out" / "bo" / NOT_READ_FILE).exists()


def test_a_notebook_of_another_course_beside_one_of_this_is_no_fault(course: Course, tmp_path: Path) -> None:
    foreign = json.dumps({"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5})
    files: dict[str, str | bytes] = {"a_501_1_poem.ipynb": foreign, f"a_501_2_{LAB}.ipynb": with_mark(course, "Done.")}
    list(collect_submissions(course, packed(tmp_path / "s.zip", files), tmp_path / "out", system="canvas"))
    assert not (tmp_path / "out" / "501" / NOT_READ_FILE).exists()


def test_a_name_or_a_file_with_numbers_gives_nothing_to_another_student(
    course: Course, notebook: str, gradebook: CanvasGradebook, tmp_path: Path
) -> None:
    ours = {
        f"fivebo_502_777_9001_{LAB}.ipynb": notebook,  # the student's name ends with the number of another
        f"lovelaceada_501_9002_502_9_{LAB}.ipynb": notebook,  # the file's name begins with it
        f"nobodynell_503_9003_4_{LAB}.ipynb": notebook,
    }
    path = packed(tmp_path / "s.zip", dict(ours))
    lines = list(collect_submissions(course, path, tmp_path / "out", gradebook))
    assert lines == [
        f"nell (nobodynell): {LAB}",
        f"files of no participant: fivebo_502_777_9001_{LAB}.ipynb, lovelaceada_501_9002_502_9_{LAB}.ipynb",
    ]
    assert not (tmp_path / "out" / "vic").exists()
    with pytest.raises(ValueError, match=r"contains no submission: expected files such as 'lovelaceada_12345"):
        list(collect_submissions(course, path, tmp_path / "without", system="canvas"))


def test_one_file_does_not_make_a_download_that_of_another_system(notebook: str, tmp_path: Path) -> None:
    canvas: dict[str, str | bytes] = {f"s{number}_{number}_9{number}_{LAB}.ipynb": notebook for number in (1, 2, 3)}
    canvas["mallory_66_967_x_1_assignsubmission_file_y.ipynb"] = notebook
    with zipfile.ZipFile(packed(tmp_path / "c.zip", canvas)) as archive:
        assert which_system(archive) == "canvas"
    moodle: dict[str, str | bytes] = {
        f"Ada Lovelace_1001_assignsubmission_file_/{METADATA}": b"x",
        "Ada Lovelace_1001_assignsubmission_file_/a_1_2_b.ipynb": notebook,
    }
    with zipfile.ZipFile(packed(tmp_path / "m.zip", moodle)) as archive:
        assert which_system(archive) == "moodle"
    gradescope: dict[str, str | bytes] = {
        f"{TOP}/{METADATA}": b"x",
        f"{TOP}/submission_1/X_99_assignsubmission_file_/a.ipynb": notebook,
        f"{TOP}/submission_2/{METADATA}": b"x",
    }
    with zipfile.ZipFile(packed(tmp_path / "g.zip", gradescope)) as archive:
        assert which_system(archive) == "gradescope"


TABLE = """---
submission_100:
  :submitters:
  - :name: Ada Lovelace
    :sid: '1815'
    :email: ada@x.edu
  :created_at: 2026-11-20 09:30:15.000000000 +11:00
  :score: 10.0
  :results:
    output: |-
      submission_200:
        :submitters:
        - :name: Not this one
          :sid: '1815'
submission_200:
  :submitters:
  - :name: Ben O'Neil
    :sid: ''
    :email: ben@x.edu
  - :name: Cat
    :sid: 'cat'
    :email: cat@x.edu
  :created_at: !ruby/object:ActiveSupport::TimeWithZone
    utc: &1 2026-11-19 23:00:00.000000000 Z
    zone: !ruby/object:ActiveSupport::TimeZone
      name: Etc/UTC
    time: *1
submission_300:
  :submitters: []
"""


def gradescope(path: Path, table: str | bytes, *submissions: tuple[int, str, str | bytes]) -> Path:
    files = {f"{TOP}/submission_{number}/{name}": content for number, name, content in submissions}
    return packed(path, {f"{TOP}/{METADATA}": table, **files})


def test_an_export_of_gradescope(course: Course, notebook: str, tmp_path: Path) -> None:
    path = gradescope(
        tmp_path / "g.zip",
        TABLE,
        (100, f"{LAB}.ipynb", notebook),
        (200, f"work/{LAB}.ipynb", notebook),
        (300, f"{LAB}.ipynb", notebook),
        (400, "../../../x.ipynb", notebook),
    )
    out = tmp_path / "out"
    assert list(collect_submissions(course, path, out)) == [
        f"1815 (Ada Lovelace): {LAB}",
        f"ben@x.edu (Ben O'Neil): {LAB}; handed in by 2 together (submission_200)",
        f"cat (Cat): {LAB}; handed in by 2 together (submission_200)",
        f"files of no participant: {TOP}/submission_300/{LAB}.ipynb, {TOP}/submission_400/../../../x.ipynb",
    ]
    assert set(collected(out)) == {f"{one}/{LAB}/{LAB}.ipynb" for one in ("1815", "ben@x.edu", "cat")}
    times = {one: (out / one / LAB / "timestamp.txt").read_text() for one in ("1815", "cat")}
    assert times == {"1815": "2026-11-19 22:30:15 UTC\n", "cat": "2026-11-19 23:00:00 UTC\n"}
    assert {one.participant for one in read_students(out / "students.csv")} == {""}
    later = gradescope(tmp_path / "h.zip", TABLE, (200, f"{LAB}.ipynb", notebook))
    assert [line.split()[0] for line in collect_submissions(course, later, out)] == ["ben@x.edu", "cat"]


def test_who_is_known_by_the_e_mail_address_keeps_the_id_of_the_course(
    course: Course, notebook: str, tmp_path: Path
) -> None:
    path = gradescope(tmp_path / "g.zip", TABLE, (200, f"{LAB}.ipynb", notebook))
    known = [Student("z1", "Ben O'Neil", "BEN@x.edu", "", "1000")]
    assert next(collect_submissions(course, path, tmp_path / "out", known=known)).startswith("z1 (Ben O'Neil)")


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (b"a: [", "submission_metadata.yml cannot be read"),
        (b"\xff\xfe\x00", "submission_metadata.yml cannot be read"),
        (b"[" * 200_000, "submission_metadata.yml cannot be read"),
        (b"", "contains no submission"),
        (b"a: &a [*a]\n*a : {b: c}\n? [x]\n: y\n", "contains no submission"),
        (TABLE.replace("cat@x.edu", "ben@x.edu").encode(), "ben@x.edu is the"),
        (TABLE.replace("'cat'", "'1815'").encode(), "have the same ID"),
    ],
)
def test_a_table_that_is_broken_or_hostile_is_one_line(
    course: Course, notebook: str, tmp_path: Path, table: bytes, said: str
) -> None:
    path = gradescope(tmp_path / "g.zip", table, (100, f"{LAB}.ipynb", notebook), (200, f"{LAB}.ipynb", notebook))
    with pytest.raises(ValueError, match=said) as refused:
        list(collect_submissions(course, path, tmp_path / "out"))
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "out").exists()


def test_aliases_are_not_expanded(tmp_path: Path) -> None:
    """Nine lists of nine would be a billion names."""
    bomb = "a0: &a0 [lol]\n" + "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 12))
    path = gradescope(tmp_path / "g.zip", bomb + TABLE.removeprefix("---\n"), (100, "x.txt", b""))
    with zipfile.ZipFile(path) as archive:
        assert [one.name for one in list_gradescope(archive).participants.values()] == ["Ada Lovelace"]


def test_a_student_whose_zip_is_hostile_costs_nobody_else(course: Course, notebook: str, tmp_path: Path) -> None:
    files: dict[str, str | bytes] = {
        "mallory_66_1_work.zip": b"PK\x03\x04broken",
        f"lovelaceada_501_2_{LAB}.ipynb": notebook,
        f"evil_67_3_{LAB}.ipynb": b"[" * 100_000,
    }
    lines = list(collect_submissions(course, packed(tmp_path / "s.zip", files), tmp_path / "out"))
    assert [line.split(":")[0] for line in lines] == ["67 (evil)", "501 (lovelaceada)", "66 (mallory)"]
    assert f"501 (lovelaceada): {LAB}" in lines


def test_a_table_of_another_system_is_refused(
    course: Course, gradebook: CanvasGradebook, notebook: str, tmp_path: Path
) -> None:
    (tmp_path / "w.csv").write_text("Identifier,Full name\nParticipant 1,Ada\n", encoding="utf-8")
    sheet = read_worksheet(tmp_path / "w.csv")
    canvas = packed(tmp_path / "c.zip", {f"lovelaceada_501_2_{LAB}.ipynb": notebook})
    with pytest.raises(ValueError, match=r"is a worksheet of Moodle, but .* is a download of Canvas"):
        list(collect_submissions(course, canvas, tmp_path / "out", sheet))
    export = gradescope(tmp_path / "g.zip", TABLE, (100, "x", b""))
    with pytest.raises(ValueError, match=r"is a gradebook of Canvas, but .* is a download of Gradescope"):
        list(collect_submissions(course, export, tmp_path / "out", gradebook))
    with pytest.raises(ValueError, match=f"there is no {METADATA} in it"):
        list(collect_submissions(course, canvas, tmp_path / "out", system="gradescope"))
