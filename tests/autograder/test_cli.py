"""The commands of the course, as an instructor and a student type them."""

import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable
from datetime import datetime, tzinfo
from html import unescape
from pathlib import Path

import pytest
from course_work import copy_course

from autograder.course.individual_data import individual_file
from autograder.course.layout import Course
from autograder.course.nbgrader_access import open_gradebook
from autograder.results.gradebook import database_url
from autograder.samples import write_samples
from autograder.sandbox.bubblewrap import SandboxError
from autograder.sandbox.doctor import LevelReport
from labsid.checks.notebook import load_assignment
from labsid.cli.commands import main

ROOT = Path(__file__).resolve().parents[2]
PRELAB, LAB = "prelab-sinusoids", "lab-identification"
SECRET = b"0123456789abcdef0123456789abcdef"


@pytest.fixture
def here(course: Course, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Course:
    """The commands work on the course that was built for the tests, from an empty folder."""
    import autograder.demonstration

    monkeypatch.setattr("autograder.course.layout.find_course", lambda: course)
    monkeypatch.setattr(autograder.demonstration, "find_course", lambda: course)
    (tmp_path / "cwd").mkdir()
    monkeypatch.chdir(tmp_path / "cwd")
    return course


@pytest.fixture
def submitted(course: Course, tmp_path: Path) -> Path:
    """Two hand-ins of the pre-lab: an untouched one, and one that was cut off."""
    folder = tmp_path / "submitted"
    shutil.copytree(course.release / PRELAB, folder / "gil" / PRELAB)
    shutil.copytree(course.release / PRELAB, folder / "ivy" / PRELAB)
    path = folder / "ivy" / PRELAB / f"{PRELAB}.ipynb"
    path.write_bytes(path.read_bytes()[:1000])
    return folder


def complaint(capsys: pytest.CaptureFixture[str], arguments: list[str]) -> str:
    """What the command says on stderr when it refuses; it must be one line, with exit status 2."""
    assert main(arguments) == 2
    captured = capsys.readouterr()
    (line,) = captured.err.splitlines()
    assert line.startswith("labsid: error: ")
    return line


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["course", "grade", "--submitted", "nosuch", "--out", "out"], "nosuch is not a folder"),
        (["course", "grade", "--submitted", ".", "--out", "out"], "holds no submission"),
        (["course", "grade", "--out", "out"], "'--submitted'"),
        (["course", "grade", "--submitted", ".", "--out", "out", "--jobs", "0"], "'--jobs'"),
        (
            ["course", "grade", "--submitted", ".", "--out", "out", "--isolation", "some"],
            "expected strict, best or none",
        ),
        (["course", "grade", "--submitted", ".", "--out", "out", "--assignment", "holiday"], "no assignment 'holiday'"),
        (["course", "feedback", "--out", "nosuch"], "nosuch holds no results"),
        (["course", "export", "--out", "nosuch"], "nosuch holds no results"),
        (["course", "export", "--out", "nosuch", "--format", "xml"], "expected csv, moodle, canvas,"),
        (["course", "export", "--out", "nosuch", "--format", "moodle"], "needs --worksheet"),
        (["course", "export", "--out", "nosuch", "--format", "moodle", "--worksheet", "x"], "x"),
        (["course", "export", "--out", "nosuch", "--worksheet", "x"], "are for --format moodle"),
        (["course", "export", "--out", "nosuch", "--format", "canvas"], "holds no results"),
        (["course", "export", "--out", "nosuch", "--format", "gradescope"], "holds no results"),
        (["course", "export", "--out", "nosuch", "--column", "x"], "--column is for --format canvas"),
        (["course", "package", "--for", "x", "--assignment", "y", "--out", "p.zip"], "expected gradescope or github"),
        (["course", "package", "--for", "github", "--assignment", "y", "--out", "p.zip"], "no assignment 'y'"),
        (["course", "collect", ".", "--out", "dir", "--from", "x"], "expected moodle, canvas, gradescope"),
        (["course", "report", "--out", "nosuch"], "nosuch holds no results"),
        (["course", "collect", "nosuch.zip", "--out", "dir"], "nosuch.zip"),
        (["course", "collect", ".", "--out", "dir", "--timezone", "Mars/Base"], "the time zone Mars/Base is not known"),
        (["course", "collect", ".", "--out", "dir", "--worksheet", "nosuch"], "nosuch"),
        (["course", "release", "--out", "r.zip", "--secret", "nosuch"], "--secret and --students go together"),
        (["course", "release", "--out", "r.zip", "--secret", "nosuch", "--students", "x"], "nosuch"),
        (["course", "grade", "--submitted", ".", "--out", "out", "--secret", "nosuch"], "nosuch"),
        (["course", "grade", "--submitted", ".", "--out", "out", "--late", "grace=2h"], "--late needs due"),
        (["course", "destroy"], "No such command 'destroy'"),
        (["submit", "--folder", "nosuch"], "nosuch contains no notebooks"),
    ],
)
def test_bad_input_is_one_line_and_status_2(
    here: Course, capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    assert said in complaint(capsys, arguments)
    assert list(Path.cwd().iterdir()) == []


def test_strict_isolation_is_refused_where_it_cannot_be_had(
    here: Course, submitted: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing() -> str:
        raise SandboxError("bubblewrap is not installed")

    monkeypatch.setattr("autograder.sandbox.process_launchers.find_bubblewrap", missing)
    line = complaint(
        capsys, ["course", "grade", "--submitted", str(submitted), "--out", "out", "--isolation", "strict"]
    )
    assert "isolation 'strict' is unavailable: namespaces: bubblewrap is not installed" in line
    assert not Path("out").exists()


def test_the_doctor_reports_what_is_blocked(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    found = [
        LevelReport("namespaces", "bubblewrap is not installed", {}),
        LevelReport("none", "", {"read the course": False, "allocate 2 GB": True}),
    ]
    monkeypatch.setattr("autograder.sandbox.doctor.attempt_escapes", lambda: iter(found))
    assert main(["course", "doctor", "--json", str(tmp_path / "found.json")]) == 0
    said = capsys.readouterr().out
    assert re.search(r"^read the course +- +OPEN$", said, re.MULTILINE)
    assert re.search(r"^allocate 2 GB +- +blocked$", said, re.MULTILINE)
    assert "namespaces is unavailable: bubblewrap is not installed" in said
    assert said.splitlines()[-1] == "Grading with --isolation best uses: none"
    written = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert written["schema"] == "labsid.doctor/1"
    assert written["rungs"]["none"]["holds"] == found[1].blocked


def test_from_hand_ins_to_feedback_and_export(
    here: Course, submitted: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    grade = ["course", "grade", "--submitted", str(submitted), "--out", "out", "--isolation", "none"]
    assert main(grade) == 0
    captured = capsys.readouterr()
    assert captured.err.startswith("NOT ISOLATED")
    assert len(captured.err.splitlines()) == 1
    (ivy,) = [line for line in captured.out.splitlines() if line.startswith("ivy")]
    assert re.search(r"quarantined \(.*cannot be read: .*broken JSON", ivy)
    assert captured.out.endswith("2 submissions graded, 0 unchanged since the last run. Grades: out/grades.csv\n")
    assert main([*grade, "--jobs", "1", "--assignment", PRELAB]) == 0
    assert "0 submissions graded, 2 unchanged" in capsys.readouterr().out
    assert main(["course", "feedback", "--out", "out"]) == 0
    assert capsys.readouterr().out == "Wrote 2 pages below out/feedback.\n"
    assert "broken JSON" in Path("out", "feedback", "ivy", f"{PRELAB}.html").read_text(encoding="utf-8")
    assert main(["course", "export", "--out", "out", "--format", "csv"]) == 0
    assert capsys.readouterr().out == "Wrote out/export.csv and out/grades.csv.\n"
    assert f"ivy,{PRELAB},0,1,0,quarantined" in Path("out", "export.csv").read_text(encoding="utf-8")


def test_from_moodle_and_back(here: Course, capsys: pytest.CaptureFixture[str]) -> None:
    mine = json.loads((here.release / PRELAB / f"{PRELAB}.ipynb").read_text(encoding="utf-8"))
    mine["cells"].append({"cell_type": "markdown", "metadata": {}, "source": "Done."})
    with zipfile.ZipFile("moodle.zip", "w") as packed:
        packed.writestr("Gil_7_assignsubmission_file_/my work.ipynb", json.dumps(mine))
        packed.write(here.release / LAB / f"{LAB}.ipynb", f"Gil_7_assignsubmission_file_/{LAB}.ipynb")
    columns = "Identifier,Full name,Email address,Last modified (submission),Grade,Maximum Grade,Feedback comments"
    row = 'Participant 7,Gil,gil@x.edu,"Friday, 20 November 2026, 4:05 PM",,1.00,'
    Path("sheet.csv").write_text(f"{columns}\n{row}\n", encoding="utf-8")
    assert (
        main(["course", "collect", "moodle.zip", "--out", "in", "--worksheet", "sheet.csv", "--timezone", "UTC"]) == 0
    )
    assert capsys.readouterr().out.splitlines() == [
        f"gil@x.edu (Gil): {PRELAB}; as released, not collected: {LAB}",
        f"Handed in, by number of students: {PRELAB} 1. A notebook as it was released is not counted.",
        "Next: labsid course grade --submitted in --out OUT",
    ]
    rules = "due=2026-11-20T16:00,per-day=10%"
    assert main(["course", "grade", "--submitted", "in", "--out", "out", "--late", rules]) == 0
    assert "0.1 late penalty" in capsys.readouterr().out
    assert main(["course", "report", "--out", "out"]) == 0
    assert capsys.readouterr().out == "Wrote out/report.html.\n"
    assert main(["course", "export", "--format", "moodle", "--worksheet", "sheet.csv", "--out", "out"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[-1] == "Filled in 1 rows. Upload out/moodle/worksheet.csv and out/moodle/feedback.zip."
    with zipfile.ZipFile("out/moodle/feedback.zip") as archive:
        assert archive.namelist() == ["Gil_7_assignsubmission_file_/feedback.html"]


def test_hand_ins_with_all_notebooks_are_graded_as_printed(
    here: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The blocker: `labsid submit` packs untouched notebooks, too, and every command is run as the last one says."""
    for name in here.assignments():
        built = here.source if name == PRELAB else here.release
        for file in (built / name).glob("*.ipynb"):
            (tmp_path / "work" / name).mkdir(parents=True, exist_ok=True)
            shutil.copy(file, tmp_path / "work" / name)
    with zipfile.ZipFile("hand-in.zip", "w") as packed:
        for file in sorted((tmp_path / "work").glob("*/*")):
            packed.write(file, file.relative_to(tmp_path / "work"))
    with zipfile.ZipFile("moodle.zip", "w") as packed:
        for who in ("Ada L_1", "Ben O_2"):
            packed.write("hand-in.zip", f"{who}_assignsubmission_file_/hand-in.zip")
    columns = "Identifier,Full name,ID number,Grade,Maximum Grade,Feedback comments"
    for name, most in (("sheet.csv", "1.00"), ("other.csv", "2.00")):
        rows = [f"Participant 1,Ada L,ada,,{most},", f"Participant 2,Ben O,ben,,{most},"]
        Path(name).write_text("\r\n".join([columns, *rows]) + "\r\n", encoding="utf-8")
    assert main(["course", "collect", "moodle.zip", "--out", "in", "--worksheet", "sheet.csv"]) == 0
    said = capsys.readouterr().out.splitlines()
    untouched = sorted(set(here.assignments()) - {PRELAB})
    assert said[0] == f"ada (Ada L): {PRELAB}; as released, not collected: {', '.join(untouched)}"
    assert said[2].startswith(f"Handed in, by number of students: {PRELAB} 2. ")
    assert main(said[-1].removeprefix("Next: labsid ").split()) == 0
    grades = Path("OUT", "grades.csv").read_text(encoding="utf-8")
    assert {line.split(",")[1] for line in grades.splitlines()[1:]} == {PRELAB}
    capsys.readouterr()
    export = ["course", "export", "--format", "moodle", "--out", "OUT", "--worksheet"]
    assert main([*export, "sheet.csv"]) == 0
    assert "Participant 1,Ada L,ada,0.95,1.00," in Path("OUT", "moodle", "worksheet.csv").read_text(encoding="utf-8")
    assert "ada: 0.05 marks not yet graded by hand" in capsys.readouterr().out
    line = complaint(capsys, [*export, "other.csv"])
    assert f"maximum is 2, but the marks are out of 1 ({PRELAB} 1); nothing was written." in line
    assert main(line.partition("to convert the marks to 2.00: labsid ")[2].split()) == 0
    assert "Participant 1,Ada L,ada,1.9,2.00," in Path("OUT", "moodle", "worksheet.csv").read_text(encoding="utf-8")


def test_course_toml_is_read_by_every_command(
    here: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    own = Course(tmp_path / "own")
    shutil.copytree(here.root, own.root)
    shutil.copyfile(ROOT / "pyproject.toml", own.root / "pyproject.toml")
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: own)
    (own.root / "secret").write_bytes(b"0123456789abcdef0123456789abcdef\n")
    (own.root / "class.csv").write_text(
        "id;name;e-mail\nz1;Jürgen Öz;j@x.edu\nz2;Li, Mei;m@x.edu\nz3;;\n", encoding="utf-8"
    )
    (own.root / "course.toml").write_text(
        f"""
title = "System identification"
timezone = "Australia/Sydney"
secret = "secret"
students = "class.csv"
late = {{ per-day = "10%" }}
[assignments.{PRELAB}]
due = 2026-03-01T23:59:00
weight = 5
[assignments.{LAB}]
due = 2999-01-01T00:00:00
""",
        encoding="utf-8",
    )
    columns = "Identifier,Full name,ID number,Last modified (submission),Grade,Maximum Grade,Feedback comments"
    rows = [
        'Participant 1,Jürgen Öz,z1,"Monday, 2 March 2026, 1:00 AM",,1.00,',
        'Participant 2,"Li, Mei",z2,"Sunday, 1 March 2026, 11:00 PM",,1.00,',
    ]
    Path("sheet.csv").write_text("\r\n".join([columns, *rows]) + "\r\n", encoding="utf-8")

    assert main(["course", "release", "--out", "r.zip", "--assignment", LAB]) == 0
    with zipfile.ZipFile("r.zip") as archive:
        names = archive.namelist()
    assert f"{LAB}/{LAB}.ipynb" in names
    assert f"{PRELAB}/{PRELAB}.ipynb" not in names
    assert not [name for name in names if name.endswith(".mat") or re.search(r"z\d", name)]
    for student in ("z1", "z2", "z3"):
        with zipfile.ZipFile(Path("r-packages", f"{student}.zip")) as archive:
            assert archive.namelist() == [f"{LAB}/SysIdenData_StudentVersion.mat"]

    with zipfile.ZipFile("moodle.zip", "w") as packed:
        for who in ("Jürgen Öz_1", "Li, Mei_2"):
            for name in (PRELAB, LAB):
                packed.write(own.source / name / f"{name}.ipynb", f"{who}_assignsubmission_file_/{name}.ipynb")
    assert main(["course", "collect", "moodle.zip", "--out", "in", "--worksheet", "sheet.csv"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "Next: labsid course grade --submitted in --out OUT"
    assert (Path("in", "z1", PRELAB) / "timestamp.txt").read_text(encoding="utf-8") == "2026-03-01 14:00:00 UTC\n"
    assert main(["course", "grade", "--submitted", "in", "--out", "OUT"]) == 0
    captured = capsys.readouterr()
    assert (
        f"{LAB}: not graded, because its due date in course.toml has not passed; 2 students handed it in."
        in captured.err
    )
    assert "nothing handed in by 1 of 3 students: z3" in captured.err
    assert "0.1 late penalty" in captured.out
    results = sorted(path.relative_to("OUT/results").as_posix() for path in Path("OUT", "results").glob("*/*.json"))
    assert results == [f"z1/{PRELAB}.json", f"z2/{PRELAB}.json"]
    with open_gradebook(database_url(Path("OUT"))) as book:
        student = book.find_student("z1")
        assert (student.first_name, student.last_name, student.email) == ("Jürgen", "Öz", "j@x.edu")
        assert (book.find_student("z2").first_name, book.find_student("z2").last_name) == ("Mei", "Li")
    assert main(["course", "report", "--out", "OUT"]) == 0
    report = Path("OUT", "report.html").read_text(encoding="utf-8")
    assert "<h1>System identification: class report</h1>" in report
    assert f'<a href="feedback/z1/{PRELAB}.html">Jürgen Öz</a>' in report
    page = Path("OUT", "feedback", "z1", f"{PRELAB}.html").read_text(encoding="utf-8")
    assert f'<p class="who">System identification · Jürgen Öz (z1) · {PRELAB}</p>' in page
    assert main(["course", "export", "--format", "moodle", "--worksheet", "sheet.csv", "--out", "OUT"]) == 0
    rules = "due=2026-02-01T00:00,per-day=10%,most=20%"
    assert main(["course", "grade", "--submitted", "in", "--out", "OUT", "--late", rules, "--assignment", PRELAB]) == 0
    assert "0.2 late penalty" in capsys.readouterr().out  # an option wins

    text = (own.root / "course.toml").read_text(encoding="utf-8")
    (own.root / "course.toml").write_text(text.replace("10%", "much"), encoding="utf-8")
    line = complaint(capsys, ["course", "grade", "--submitted", "in", "--out", "OUT"])
    assert "course.toml, late rules: per-day=much is not an amount" in line
    (own.root / "course.toml").write_text("tittle = 1\n", encoding="utf-8")
    for command in (
        ["report", "--out", "OUT"],
        ["grade", "--submitted", "in", "--out", "OUT"],
        ["release", "--out", "x"],
    ):
        line = complaint(capsys, ["course", *command])
        assert "course.toml: the file has the unknown key 'tittle'; expected one of title, timezone," in line


def test_a_term_is_as_the_readme_prints_it(
    here: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each command of the guide, exactly as printed and in its order, with the course.toml that it shows."""
    own = copy_course(tmp_path / "own", PRELAB, LAB)
    shutil.copyfile(ROOT / "pyproject.toml", own.root / "pyproject.toml")
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: own)
    guide = (ROOT / "autograder" / "README.md").read_text(encoding="utf-8")
    guide = guide.partition("## A term, step by step")[2].partition("## What happens to a submission")[0]
    (settings,) = re.findall(r"```toml\n(.*?)```", guide, re.DOTALL)
    (own.root / "course.toml").write_text(settings, encoding="utf-8")
    (tmp_path / "course-secret.txt").write_bytes(SECRET)
    (tmp_path / "students.csv").write_text("id,name,email\nz1,Ada Öz,a@x.edu\n", encoding="utf-8")
    columns = "Identifier,Full name,ID number,Last modified (submission),Grade,Maximum Grade,Feedback comments"
    row = 'Participant 1,Ada Öz,z1,"Tuesday, 17 November 2026, 1:00 AM",,1.00,'
    (extensions,) = re.findall(r"```csv\n(.*?)```", guide, re.DOTALL)
    (tmp_path / "extensions.csv").write_text(extensions.replace("z5123456", "z1"), encoding="utf-8")
    Path("worksheet.csv").write_text(f"{columns}\r\n{row}\r\n", encoding="utf-8")
    with zipfile.ZipFile("submissions.zip", "w") as packed:
        packed.write(here.source / PRELAB / f"{PRELAB}.ipynb", f"Ada Öz_1_assignsubmission_file_/{PRELAB}.ipynb")

    class Later(datetime):
        @classmethod
        def now(cls, tz: tzinfo | None = None) -> "Later":
            return cls(2026, 12, 24, tzinfo=tz)

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    opened: list[str] = []
    for module in ("cli", "feedback_texts", "solutions_command"):
        monkeypatch.setattr(f"autograder.{module}.datetime", Later)
    monkeypatch.setattr("socketserver.BaseServer.serve_forever", interrupted)
    monkeypatch.setattr("webbrowser.open", opened.append)
    printed = re.findall(r"^    labsid (.*)$", guide, re.MULTILINE)
    elsewhere = re.compile("gradebook.csv|export.zip|gradescope")  # Canvas and Gradescope: with the files of these
    commands = [command for command in printed if not elsewhere.search(command)]
    assert (len(commands), len(printed)) == (11, 16)
    for command in commands:
        assert main(command.split()) == 0, (command, capsys.readouterr().err)
    assert len(opened) == 1
    for name in ("release.zip", "release-packages.zip", "release-packages/z1.zip", "OUT/report.html", "OUT/export.csv"):
        assert Path(name).is_file()
    assert "Participant 1,Ada Öz,z1," in Path("OUT", "moodle", "worksheet.csv").read_text(encoding="utf-8")
    worksheet = Path("OUT", "moodle", "worksheet.csv").read_text(encoding="utf-8")
    assert f',0.95,1.00,"{PRELAB}: 0.95 of 1 marks.' in worksheet  # a day late, within the extension
    assert "Extension until 18 November 2026, 09:00 (Australia/Sydney)." in worksheet
    page = Path("OUT", "feedback", "z1", f"{PRELAB}.html").read_text(encoding="utf-8")
    assert "<summary>The question</summary>" in page
    assert "<summary>Model answer</summary>" in page
    with zipfile.ZipFile("solutions.zip") as archive:
        assert archive.namelist() == [f"{PRELAB}/{PRELAB}-solution.{kind}" for kind in ("html", "ipynb")]
    assert Path("OUT", "moodle", "feedback.zip").is_file()


def test_packages_come_in_the_layout_of_moodles_feedback_files(
    here: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    own = Course(tmp_path / "own")
    shutil.copytree(here.root, own.root)
    shutil.copyfile(ROOT / "pyproject.toml", own.root / "pyproject.toml")
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: own)
    Path("secret").write_bytes(SECRET)
    Path("class.csv").write_text("z1,Jürgen Öz\nz2,Li Mei\nz3,Nobody There\n", encoding="utf-8")
    rows = ("Participant 7,Jürgen_Öz,z1", "Participant 8,Li Mei,z2", "Participant 9,A Guest,z9")
    Path("sheet.csv").write_text("\n".join(["Identifier,Full name,ID number", *rows]), encoding="utf-8")
    release = [
        "course",
        "release",
        "--out",
        "r.zip",
        "--assignment",
        LAB,
        "--secret",
        "secret",
        "--worksheet",
        "sheet.csv",
    ]
    assert main([*release, "--students", "class.csv"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "z3: not in the worksheet"
    with zipfile.ZipFile("r-packages.zip") as archive:
        folders = ("Jürgen Öz_7_assignsubmission_file_", "Li Mei_8_assignsubmission_file_")
        assert archive.namelist() == [f"{folder}/my-data.zip" for folder in folders]
        with zipfile.ZipFile(io.BytesIO(archive.read(archive.namelist()[1]))) as package:
            record = f"{LAB}/SysIdenData_StudentVersion.mat"
            assert package.namelist() == [record]
            assert package.read(record) == individual_file("SysIdenData_StudentVersion.mat", "z2", SECRET)
    with zipfile.ZipFile("r.zip") as archive:
        assert "environment.yml" in archive.namelist()
        assert f"{LAB}/{LAB}.ipynb" in archive.namelist()
        assert not [name for name in archive.namelist() if name.endswith(".mat")]
    assert main(release) == 0
    with zipfile.ZipFile("r-packages.zip") as archive:
        assert len(archive.namelist()) == 3
    line = complaint(capsys, [PRELAB if word == LAB else word for word in release])
    assert "these assignments have no data files" in line
    assert "no assignment 'holiday'" in complaint(
        capsys, ["course", "release", "--out", "x.zip", "--assignment", "holiday"]
    )


def test_the_course_is_built(
    here: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    other = Course(tmp_path / "course")
    shutil.copytree(here.notebooks / PRELAB, other.notebooks / PRELAB)
    (other.root / "autograder").mkdir()
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: other)
    assert main(["course", "build"]) == 0
    made, *said = capsys.readouterr().out.splitlines()
    assert "course-secret" in made
    assert said == [f"Built 1 assignments: {PRELAB}.", f"Release: {other.release}"]
    text = other.notebooks / PRELAB / f"{PRELAB}.md"
    text.write_text(text.read_text(encoding="utf-8").replace("### END SOLUTION", "", 1), encoding="utf-8")
    assert "cannot be released: prelab-1-time-answer: 1 BEGIN" in complaint(capsys, ["course", "build"])
    text.write_text(text.read_text(encoding="utf-8").replace("{grade_id:", "{grade_id", 1), encoding="utf-8")
    assert "cannot be released" in complaint(capsys, ["course", "build"])


def test_a_student_gets_the_notebooks_and_hands_them_in(
    here: Course, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("labsid.checks.notebook_file.release_folder", lambda: here.release)
    assert main(["lab", "--no-open"]) == 0
    first = capsys.readouterr().out.splitlines()
    assert len(first) == len(here.assignments())
    assert all(": new: " in line for line in first)
    mine = Path("labsid-work", LAB, f"{LAB}.ipynb")
    mine.write_text(mine.read_text(encoding="utf-8").replace("*Your answer here*", "From rest."), encoding="utf-8")
    before = mine.read_bytes()
    assert main(["lab", "--no-open"]) == 0
    assert "kept: " in capsys.readouterr().out
    assert mine.read_bytes() == before
    assert main(["submit", "--yes"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"Hand in this file: hand-in.zip ({LAB})"
    with zipfile.ZipFile("hand-in.zip") as archive:
        assert set(archive.namelist()) == {f"{LAB}/{LAB}.ipynb", f"{LAB}/{load_assignment(LAB).record_file}"}


def test_a_broken_notebook_is_not_handed_in(here: Course, submitted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = complaint(capsys, ["submit", "--folder", str(submitted / "ivy")])
    assert "prelab-sinusoids.ipynb is not a readable notebook" in line
    assert list(Path.cwd().iterdir()) == []


def test_a_checkout_builds_its_notebooks_when_they_are_first_asked_for(
    here: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    found = iter([None, here.release])
    monkeypatch.setattr("labsid.checks.notebook_file.release_folder", lambda: next(found))
    monkeypatch.setattr("autograder.course.build.build_course", lambda course: iter(course.assignments()))
    monkeypatch.setattr("autograder.course.own_secret.make_own_secret", lambda course: False)
    assert main(["lab", "--no-open"]) == 0
    assert capsys.readouterr().out.startswith("Building the notebooks (once) ...\n")
    assert Path("labsid-work", "start.ipynb").is_file()


def test_what_is_in_the_way_is_said(
    here: Course, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("labsid.checks.notebook_file.release_folder", lambda: here.release)
    Path("labsid-work").touch()
    assert "labsid-work is a file" in complaint(capsys, ["lab", "--no-open"])
    assert "labsid-work exists and was not made by this command" in complaint(capsys, ["demo", "--out", "labsid-work"])
    Path("out").touch()
    assert "out" in complaint(capsys, ["course", "feedback", "--out", "out"])


# ---- stopping


ENDLESS = "import os\nwith open({path!r}, 'w') as file:\n    file.write(str(os.getpid()))\nwhile True:\n    pass"
PROGRAM = """
import sys
from pathlib import Path
import autograder.course.layout
here = autograder.course.layout.Course(Path(sys.argv.pop(1)))
autograder.course.layout.find_course = lambda: here
from labsid.cli.commands import main
sys.exit(main())
"""


def wait_for(condition: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + 120
    while not condition():
        assert time.monotonic() < deadline, f"{what}: waited in vain"
        time.sleep(0.05)


def is_running(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    status = Path(f"/proc/{pid}/stat")  # one that has ended but was not yet fetched is not running
    return not (status.is_file() and status.read_text().rpartition(")")[2].split()[0] == "Z")


@pytest.mark.skipif(os.name != "posix", reason="signals are sent")
@pytest.mark.parametrize(
    "how",
    # `test_grade.py` and `test_isolation.py` have runs that are killed
    [signal.SIGINT, pytest.param(signal.SIGKILL, marks=pytest.mark.exhaustive)],
)
def test_a_run_that_is_stopped_keeps_what_is_graded_and_goes_on(
    here: Course, submitted: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], how: signal.Signals
) -> None:
    endless = submitted / "zed" / PRELAB / f"{PRELAB}.ipynb"
    shutil.copytree(submitted / "gil" / PRELAB, endless.parent)
    notebook = json.loads(endless.read_text(encoding="utf-8"))
    (cell,) = (cell for cell in notebook["cells"] if cell["id"] == "prelab-1-time-answer")
    cell["source"] = ENDLESS.format(path=str(tmp_path / "pid"))
    endless.write_text(json.dumps(notebook), encoding="utf-8")

    def is_started() -> bool:
        begun = (tmp_path / "pid").is_file() and (tmp_path / "pid").read_text().isdigit()
        return begun and len(list(Path("out", "results").glob("*/*.json"))) == 2

    # without isolation: the endless student says outside of its folder that it runs
    grade = ["course", "grade", "--submitted", str(submitted), "--out", "out", "--jobs", "1", "--isolation", "none"]
    command = [sys.executable, "-c", PROGRAM, str(here.root), *grade]
    (tmp_path / "temporary").mkdir()
    environment = {**os.environ, "TMPDIR": str(tmp_path / "temporary")}
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=environment) as process:
        try:
            wait_for(lambda: process.poll() is not None or is_started(), "the endless student")
            process.send_signal(how)
            out, err = process.communicate(timeout=60)
        finally:
            process.kill()
    assert (tmp_path / "pid").is_file(), err
    student = int((tmp_path / "pid").read_text())
    wait_for(lambda: not is_running(student), "the end of the endless student")
    if how == signal.SIGINT:
        assert process.returncode == 2
        assert list((tmp_path / "temporary").glob("labsid-*")) == []
        assert err.splitlines()[1:] == [
            "labsid: error: interrupted. Finished results are kept; run the same command again to continue."
        ]
    assert out == ""
    kept = {path.parent.name: path.read_bytes() for path in Path("out", "results").glob("*/*.json")}
    assert set(kept) == {"gil", "ivy"}

    shutil.copy(submitted / "gil" / PRELAB / f"{PRELAB}.ipynb", endless)
    assert main(grade) == 0
    assert "1 submissions graded, 2 unchanged" in capsys.readouterr().out
    for student_name, result in kept.items():
        assert Path("out", "results", student_name, f"{PRELAB}.json").read_bytes() == result
    assert len(Path("out", "grades.csv").read_text(encoding="utf-8").splitlines()) == 1 + 3 * 8


# ---- everything


@pytest.mark.exhaustive  # CI runs the command itself
def test_the_demonstration(
    here: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On a course of the assignments that the samples answer."""
    small = copy_course(tmp_path / "course", PRELAB, LAB)
    monkeypatch.setattr("autograder.demonstration.find_course", lambda: small)
    assert main(["demo", "--out", "demo"]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    samples = write_samples(small, Path("samples"))
    for student in samples:
        assert f"   {student}: " in captured.out
        assert Path("demo", "graded", "feedback", student, f"{LAB}.html").is_file()
    feedback = unescape(Path("demo", "graded", "feedback", "ben", f"{LAB}.html").read_text(encoding="utf-8"))
    assert "The question" in feedback
    _, shown = (ROOT / "README.md").read_text(encoding="utf-8").split("## One graded notebook\n")
    rows = re.findall(r"^\| `(lab-\S+)` \| 0 / (\S+) \| (.*) \|$", shown.partition("\n## ")[0], re.M)
    assert len(rows) == 3
    words = re.sub(r"<[^>]+>", "", feedback)
    assert all(question in words and f"0 / {marks}" in words and said in words for question, marks, said in rows)
    assert re.search(r"1\.45\s*of 2 marks", words)
    grades = Path("demo", "graded", "grades.csv").read_text(encoding="utf-8")
    for status in ("graded", "manual", "crashed", "quarantined"):
        assert f",{status}," in grades
    lost = {line.split(",")[2]: line for line in grades.splitlines() if line.startswith("gina,") and ",0," in line}
    typed = ("lab-1c-offsets", "lab-2b-theta", "lab-2b-parameters", "lab-2c-transfer-function", "lab-3a-mse")
    assert tuple(lost) == typed
    assert all("This value fits your record only" in line for line in lost.values())
    report = Path("demo", "graded", "report.html").read_text(encoding="utf-8")
    assert f"right on the student&#39;s own record alone: {', '.join(typed)}" in report
    assert "also tried on records that nobody has seen" in report
    figures = list(Path("demo", "figures").glob("*.png"))
    assert len(figures) >= 8
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in figures)
    assert set(json.loads(Path("demo", "identification.json").read_text(encoding="utf-8"))) >= {"theta"}
    _, _, where = captured.out.partition("Output:\n")
    paths = [Path(line.split("  ")[1].strip()) for line in where.splitlines()]
    assert len(paths) >= 4
    assert [path for path in paths if not path.exists()] == []
    keep = Path("demo", "mine.txt")
    keep.touch()
    Path("demo", ".labsid-demo").unlink()
    assert "was not made by this command" in complaint(capsys, ["demo", "--out", "demo"])
    assert keep.exists()
