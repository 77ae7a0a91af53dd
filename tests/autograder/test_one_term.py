"""One assignment from build to export, as an instructor types it, with one hand-in of each kind.

Each kind must get its own marks and words, and must leave the others alone.
"""

import csv
import io
import json
import re
import shutil
import zipfile
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import nbformat
import pytest
from course_work import ROOT, copy_course, give_by_hand

from labsid.cli.commands import main

PRELAB = "prelab-sinusoids"
SETTINGS = f"""
title = "System identification"
timezone = "UTC"
lms = "moodle"
students = "class.csv"
extensions = "extensions.csv"
late = {{ per-day = "10%" }}
[assignments.{PRELAB}]
due = 2026-03-02T09:00:00
"""
CLASS = {
    "ada": ("Ada Perfect", "Monday, 2 March 2026, 8:00 AM"),
    "ben": ("Ben Mistaken", "Monday, 2 March 2026, 8:30 AM"),
    "cleo": ("Cleo Untouched", "Monday, 2 March 2026, 8:40 AM"),
    "dan": ("Dan Extended", "Thursday, 5 March 2026, 10:00 AM"),
    "eve": ("Eve Stopped", "Tuesday, 3 March 2026, 8:00 AM"),
    "finn": ("Finn Broken", "Monday, 2 March 2026, 8:50 AM"),
    "gil": ("Gil Absent", "-"),
}
CLOCK = "It starts at 0.95, because 20 s are cut off. With t_new the formula is sin(0.02 pi t_new + 0.4 pi)."
MISTAKES = {
    "prelab-1-time-answer": "t = np.linspace(0, 100, 1000).reshape(-1, 1)",
    "prelab-3-cut-answer": "t_new, y1_new, y2_new = t[200:], y1[200:], y2[200:]",
    "prelab-6-clock": "At zero.",
}
STOPS = {"prelab-2-noise-answer": "y1 = np.sin(0.02 * np.pi * t) + noise\ny2 = np.cos(0.02 * np.pi * t)"}


@dataclass(frozen=True)
class Term:
    """What the commands left and printed.

    Attributes
    ----------
    out : Path
        The results.
    said : dict
        What each command printed, by its name.
    """

    out: Path
    said: dict[str, str]

    @property
    def worksheet(self) -> list[dict[str, str]]:
        """The rows of Moodle's worksheet as filled in."""
        with open(self.out / "moodle" / "worksheet.csv", encoding="utf-8", newline="") as rows:
            return list(csv.DictReader(rows))

    def comment(self, student: str) -> str:
        """What Moodle shows to a student beside the grade."""
        return next(row["Feedback comments"] for row in self.worksheet if row["ID number"] == student)

    def page(self, student: str) -> str:
        """The feedback page of a student."""
        return (self.out / "feedback" / student / f"{PRELAB}.html").read_text(encoding="utf-8")


def answered(released: bytes, solved: Path, changes: dict[str, str]) -> str:
    """The released notebook with the model solution, or something else, in its answers."""
    notebook = nbformat.reads(released.decode(), as_version=4)
    solution = {cell.id: cell.source for cell in nbformat.read(solved, as_version=4).cells}
    for cell in notebook.cells:
        marks = cell.metadata.get("nbgrader", {})
        if marks.get("solution"):
            cell.source = changes.get(cell.id, CLOCK if cell.cell_type == "markdown" else solution[cell.id])
    return json.dumps(notebook)


@pytest.fixture(scope="module")
def term(tmp_path_factory: pytest.TempPathFactory) -> Term:
    root = tmp_path_factory.mktemp("term")
    own = copy_course(root, PRELAB)
    shutil.copyfile(ROOT / "pyproject.toml", root / "pyproject.toml")
    (root / "course.toml").write_text(SETTINGS, encoding="utf-8")
    (root / "class.csv").write_text("id,name\n" + "".join(f"{who},{name}\n" for who, (name, _) in CLASS.items()))
    (root / "extensions.csv").write_text(f"student,assignment,due\ndan,{PRELAB},2026-03-05T09:00\n")
    columns = "Identifier,Full name,ID number,Last modified (submission),Grade,Maximum Grade,Feedback comments"
    rows = [f'Participant {n},{name},{who},"{at}",,1.00,' for n, (who, (name, at)) in enumerate(CLASS.items(), 1)]
    (root / "worksheet.csv").write_text("\r\n".join([columns, *rows]) + "\r\n", encoding="utf-8")
    said: dict[str, str] = {}

    def labsid(*arguments: str) -> None:
        printed = io.StringIO()
        with chdir(root), redirect_stdout(printed), redirect_stderr(printed):
            assert main(["course", *arguments]) == 0, printed.getvalue()
        said[arguments[0]] = printed.getvalue()

    labsid("build")
    labsid("release", "--out", "release.zip")
    with zipfile.ZipFile(root / "release.zip") as archive:
        released = archive.read(f"{PRELAB}/{PRELAB}.ipynb")
    solved = own.source / PRELAB / f"{PRELAB}.ipynb"
    perfect = answered(released, solved, {})
    notebooks: dict[str, str | bytes] = {
        "ada": perfect,
        "ben": answered(released, solved, MISTAKES),
        "cleo": released,
        "dan": perfect.replace("It starts at 0.95", "The sine starts at about 0.95"),
        "eve": answered(released, solved, STOPS),
        "finn": perfect[: len(perfect) // 2],
    }
    with zipfile.ZipFile(root / "submissions.zip", "w") as packed:
        for n, (who, (name, _)) in enumerate(CLASS.items(), 1):
            if who in notebooks:
                packed.writestr(f"{name}_{n}_assignsubmission_file_/{PRELAB}.ipynb", notebooks[who])
    labsid("collect", "submissions.zip", "--out", "submitted", "--worksheet", "worksheet.csv")
    labsid("grade", "--submitted", "submitted", "--out", "OUT")
    give_by_hand(root / "OUT", PRELAB, "ada", "prelab-6-clock", manual_score=0.05)
    labsid("report", "--out", "OUT")
    labsid("feedback", "--out", "OUT")
    labsid("export", "--out", "OUT", "--worksheet", "worksheet.csv", "--assignment", PRELAB)
    return Term(root / "OUT", said)


def test_each_hand_in_has_its_own_marks(term: Term) -> None:
    marks = {row["ID number"]: row["Grade"] for row in term.worksheet}
    assert marks == {"ada": "1", "ben": "0.7", "cleo": "0", "dan": "0.85", "eve": "0.6", "finn": "0", "gil": ""}
    with open(term.out / "grades.csv", encoding="utf-8", newline="") as grades:
        lost = [(row["student"], row["question"]) for row in csv.DictReader(grades) if row["score"] == "0"]
    assert [question for student, question in lost if student == "ben"] == ["prelab-1-time", "prelab-3-cut"]
    assert [question for student, question in lost if student == "eve"] == ["prelab-2-noise"]
    assert {student for student, _ in lost} == {"ben", "cleo", "eve", "finn"}


def test_a_late_hand_in_loses_its_part_and_an_extension_counts_from_its_own_date(term: Term) -> None:
    deducted = "0.1 of 1 marks deducted (10 % per started day)."
    own = "Handed in 1 h after the extension"
    assert f"Extension until 5 March 2026, 09:00 (UTC). {own}: {deducted}" in term.comment("dan")
    assert f"{own}: {deducted}" in term.page("dan")
    assert "Extension: due for you on 5 March 2026, 09:00 (UTC)." in term.page("dan")
    assert f"Handed in 23 h late: {deducted}" in term.comment("eve")
    assert [who for who in CLASS if "deducted" in term.comment(who)] == ["dan", "eve"]


def test_untouched_unreadable_and_nothing_are_told_apart(term: Term) -> None:
    assert f"cleo (Cleo Untouched): as released, not collected: {PRELAB}\n" in term.said["collect"]
    assert f"finn (Finn Broken): {PRELAB} (cannot be read as a notebook)\n" in term.said["collect"]
    assert "nothing handed in by 1 of 7 students: gil" in term.said["grade"]
    assert "nothing handed in (the grade is left empty; --zero gives 0 marks): gil" in term.said["export"]
    assert "Handed in as it was released, without an answer." in term.comment("cleo")
    assert "Handed in as it was released, without an answer." in term.page("cleo")
    broken = f"{PRELAB}.ipynb cannot be read: it is not a notebook (broken JSON at line 1)"
    assert f"Handed in, but could not be graded: {broken}." in term.comment("finn")
    assert broken in term.page("finn")
    assert term.comment("gil") == ""
    report = (term.out / "report.html").read_text(encoding="utf-8")
    assert f"{PRELAB}, handed in as it was released, without an answer (1): Cleo Untouched." in report
    assert "Handed in nothing at all (1): Gil Absent." in report
    assert "4 graded; 1 handed in as it was released, without an answer; 1 handed in, but could not be graded" in report


def test_mistakes_are_named_and_a_cell_that_stops_is_explained(term: Term) -> None:
    assert "Common mistakes: 1000 points; time not set back to zero." in term.comment("ben")
    assert "<code>t_new</code> starts at 20 s: subtract its first time from it" in term.page("ben")
    assert "Three columns of 801 rows.</p>" in term.page("ben")
    assert re.search('Judged on the right values of <a [^\n]*href="#prelab-3-cut"', term.page("ben"))
    assert "Your cell stopped in line 1 with NameError: name &#39;noise&#39; is not defined." in term.page("eve")
    assert "7 of 7 automatically graded questions are right." in term.page("ada")
    assert term.comment("ada") == f"{PRELAB}: 1 of 1 marks. See the feedback file for details."
