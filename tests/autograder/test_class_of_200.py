"""A class, also of 200: from Moodle's zip and worksheet to the filled-in worksheet, in one run as one types it.

The hand-ins are renamed copies of ten varied notebooks, with all that a real class hands in: names with umlauts and
twice the same name, PDFs, broken files, second versions, zips of `labsid submit`, late ones, and nothing at all.
"""

import csv
import io
import json
import unicodedata
import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from course_work import copy_course

from autograder.course.build import build_course
from autograder.course.layout import Course
from autograder.marking.answers import open_questions
from autograder.marking.server import MarkingApp
from labsid.cli.commands import main

PRELAB, LAB, OPEN = "prelab-sinusoids", "lab-identification", "prelab-6-clock"
DUE = datetime(2026, 11, 20, 16, 0, tzinfo=UTC)
FIRST = ("Jürgen", "Zoë", "Łukasz", "Søren", "Ana María", "D'Arcy", "Wei", "Ayşe", "Noël", "Ada_B")
LAST = ("Müller", "Öztürk", "O'Neil", "Nguyễn", "García-López", "Ångström", "Li", "Groß", "Smith", "Wójcik")
STUB = "# Your code here\n..."


@dataclass(frozen=True)
class Variant:
    """A notebook: the cells that are replaced in the model solution, and its automatic marks out of 0.95."""

    cells: Mapping[str, str]
    marks: str


def answer(name: str, source: str) -> dict[str, str]:
    return {f"prelab-{name}-answer": source}


NOTHING = {f"prelab-{name}-answer": STUB for name in ("2-noise", "3-cut", "4-matrix", "5-original", "6-cut-off")}
NOTHING["prelab-4-function-answer"] = "def cut_off(data, n):\n    ..."
VARIANTS = (
    Variant({}, "0.95"),
    Variant(answer("1-time", "t = np.arange(0, 1001)[:, None] / 10"), "0.95"),
    Variant(answer("1-time", "t = np.arange(0, 100, 0.1)[:, None]"), "0.85"),
    Variant(answer("2-noise", "y1 = np.sin(0.02 * np.pi * t)\ny2 = np.cos(0.02 * np.pi * t)"), "0.7"),
    Variant(answer("3-cut", STUB), "0.8"),
    Variant(answer("4-matrix", "import os\nos._exit(1)"), "0.85"),
    Variant(answer("4-function", "def cut_off(data, n):\n    return data[n:]"), "0.8"),
    Variant(NOTHING, "0.1"),
    Variant({**NOTHING, **answer("1-time", STUB)}, "0"),  # only the open question
    Variant({OPEN: "*Your answer here*"}, "0.95"),
)
UNANSWERED = 9
"""The variant without an answer to the open question, which has 0 of its 0.05 marks at once."""


@dataclass(frozen=True)
class Participant:
    """A student with what is handed in, when, and the mark that is right before marking by hand."""

    number: int
    name: str
    files: Mapping[str, bytes]
    submitted: datetime | None
    mark: Decimal | None
    waits: bool

    @property
    def id(self) -> str:
        return f"z{5000000 + self.number}"


@pytest.fixture
def small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Course:
    """A course of two assignments with a due date."""
    course = copy_course(tmp_path / "course", PRELAB, LAB)
    list(build_course(course))
    (course.root / "course.toml").write_text(
        f'title = "Class of 200"\ntimezone = "UTC"\n[late]\nper-day = "10%"\nmost = "50%"\n'
        f"[assignments.{PRELAB}]\ndue = {DUE:%Y-%m-%dT%H:%M:%S}\n",
        encoding="utf-8",
    )
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: course)
    (tmp_path / "cwd").mkdir()
    monkeypatch.chdir(tmp_path / "cwd")
    return course


def notebook_of(model: Mapping[str, Any], variant: Variant, name: str) -> bytes:
    """The model solution with replaced cells and a remark that no other student has."""
    cells = [{**cell, "source": variant.cells.get(cell["id"], cell["source"])} for cell in model["cells"]]
    remark = {"cell_type": "markdown", "id": "name", "metadata": {}, "source": f"Handed in by {name}."}
    return json.dumps({**model, "cells": [*cells, remark]}, ensure_ascii=False).encode()


def zipped(files: Mapping[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return packed.getvalue()


def make_class(course: Course, size: int) -> Iterator[Participant]:
    """Participants; the kind of hand-in follows from the number."""
    model = json.loads((course.source / PRELAB / f"{PRELAB}.ipynb").read_text(encoding="utf-8"))
    untouched = (course.release / LAB / f"{LAB}.ipynb").read_bytes()
    for number in range(size):
        name = f"{FIRST[number % 10]} {LAST[number // 10 % (size // 20)]}"  # each name twice
        variant = VARIANTS[number * 7 % 10]
        mine = notebook_of(model, variant, name)
        mark: Decimal | None = Decimal(variant.marks)
        waits = number * 7 % 10 != UNANSWERED
        days = 3 if number % 13 == 0 else 0
        kind = number % 20
        if kind == 3:
            files, mark, waits = {"Prelab Übung.pdf": b"%PDF-1.7"}, Decimal(0), False
        elif kind == 5 and number > size // 2:
            files, mark, waits = {f"{PRELAB}.ipynb": mine[: len(mine) // 2]}, Decimal(0), False
        elif kind == 7:
            old = notebook_of(model, Variant(NOTHING, "0.1"), name)
            files = {f"{PRELAB}.ipynb": old, f"{PRELAB} (1).ipynb": mine}
        elif kind == 11:
            packed = zipped({f"{PRELAB}/{PRELAB}.ipynb": mine, f"{LAB}/{LAB}.ipynb": untouched})
            files = {"hand-in.zip": packed}
        elif kind == 15:
            files = {unicodedata.normalize("NFD", f"Lösung {name}.ipynb"): mine, "notes.txt": b"Hello"}
        elif kind == 19:
            files, mark, waits = {}, None, False
        else:
            files = {f"{PRELAB}.ipynb": mine}
        is_refused = mark is not None and kind in (3, 5) and not waits
        if mark is not None and not is_refused:
            mark = max(mark - days * Decimal("0.1"), Decimal(0))
        when = None if not files else DUE - timedelta(hours=1) + timedelta(days=days)
        yield Participant(number, name, files, when, mark, waits)


def write_moodle(people: list[Participant]) -> None:
    """Moodle's zip and worksheet."""
    columns = [
        "Identifier",
        "Full name",
        "Email address",
        "ID number",
        "Status",
        "Grade",
        "Maximum Grade",
        "Grade can be changed",
        "Last modified (submission)",
        "Last modified (grade)",
        "Feedback comments",
    ]
    with zipfile.ZipFile("moodle.zip", "w") as archive:
        for one in people:
            folder = f"{one.name.replace('_', ' ')}_{90000 + one.number}_assignsubmission_file_"
            for index, (name, content) in enumerate(one.files.items()):
                archive.writestr(zipfile.ZipInfo(f"{folder}/{name}", (2026, 11, 20, 10, index, 0)), content)
    with Path("worksheet.csv").open("w", encoding="utf-8-sig", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for one in people:
            when = "-" if one.submitted is None else f"{one.submitted:%A, %d %B %Y, %I:%M %p}"
            address = f"{one.id}@x.edu"
            status = "Submitted for grading" if one.files else "No submission"
            identifier = f"Participant {90000 + one.number}"
            writer.writerow([identifier, one.name, address, one.id, status, "", "1.00", "Yes", when, "-", ""])


@pytest.mark.slow
@pytest.mark.parametrize("size", [40, pytest.param(200, marks=pytest.mark.exhaustive)])
def test_a_class_comes_back_with_the_right_marks(size: int, small: Course, capsys: pytest.CaptureFixture[str]) -> None:
    people = list(make_class(small, size))
    share = size // 20  # of each kind
    write_moodle(people)
    by_id = {one.id: one for one in people}
    handed_in = [one for one in people if one.files]

    assert main(["course", "collect", "moodle.zip", "--out", "in", "--worksheet", "worksheet.csv"]) == 0
    *lines, counted, following = capsys.readouterr().out.splitlines()
    assert len(lines) == len(handed_in) == 19 * share
    assert sum("no notebook of this course; skipped: Prelab Übung.pdf" in line for line in lines) == share
    assert sum(f"(the latest of 2 versions: {PRELAB} (1).ipynb)" in line for line in lines) == share
    assert sum(f"as released, not collected: {LAB}" in line for line in lines) == share
    assert counted.startswith(f"Handed in, by number of students: {PRELAB} {18 * share}. ")
    assert main(following.removeprefix("Next: labsid ").split()) == 0
    assert f"{19 * share} submissions graded, 0 unchanged" in capsys.readouterr().out

    # marked by hand, as the page does it
    (question,) = open_questions(Path("OUT"), small)
    waiting = [one for one in people if one.waits]
    assert [one.student for one in question.answers] == sorted(one.id for one in waiting)
    assert {by_id[one.student].name for one in question.answers} == {one.name for one in waiting}
    app = MarkingApp(Path("OUT"), [question], "Dr Öz", lambda: datetime(2026, 11, 24, tzinfo=UTC))
    points = {one.id: ("0.05", "0.02")[one.number % 2] for one in waiting[:20]}
    for student, score in points.items():
        body = json.dumps({"student": student, "score": score, "comment": ""}).encode()
        assert app.respond("POST", f"/{app.token}/{PRELAB}/{OPEN}", body).status == 200

    assert main(["course", "report", "--out", "OUT"]) == 0
    assert main(["course", "export", "--format", "moodle", "--worksheet", "worksheet.csv", "--out", "OUT"]) == 0
    with Path("OUT", "moodle", "worksheet.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = {row["ID number"]: row for row in csv.DictReader(file)}
    assert list(rows) == [one.id for one in people]
    wrong = {}
    for one in people:
        expected = "" if one.mark is None else one.mark
        if one.id in points:
            late = Decimal("0.3") if one.number % 13 == 0 else Decimal(0)
            automatic = Decimal(VARIANTS[one.number * 7 % 10].marks)
            expected = max(automatic + Decimal(points[one.id]) - late, Decimal(0))
        found = rows[one.id]["Grade"]
        if (found and Decimal(found)) != expected:
            wrong[one.id] = (one.name, list(one.files), found, expected)
    assert wrong == {}
    marks = Counter(row["Grade"] for row in rows.values())
    assert marks[""] == share
    assert len(marks) > 9

    with zipfile.ZipFile("OUT/moodle/feedback.zip") as archive:
        names = archive.namelist()
        assert len(names) == 19 * share
        for one in handed_in:
            folder = f"{one.name.replace('_', ' ')}_{90000 + one.number}_assignsubmission_file_"
            page = archive.read(f"{folder}/feedback.html").decode()
            assert f"({one.id})" in page
    with Path("OUT", "grades.csv").open(encoding="utf-8", newline="") as file:
        by_hand = [row for row in csv.DictReader(file) if row["reason"] == "marked by Dr Öz on 2026-11-24"]
    assert {row["student"]: row["score"] for row in by_hand} == points
    report = Path("OUT", "report.html").read_text(encoding="utf-8")
    assert "whole notebook" in report  # the copies
    assert "Jürgen Müller" in report
