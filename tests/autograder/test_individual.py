"""Individual data: every student graded on their own record, and work on somebody else's record found out."""

import csv
import json
import shutil
import zipfile
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path

import nbformat
import numpy as np
import pytest

from autograder.batch.executors import LocalExecutor
from autograder.batch.grade import grade_batch
from autograder.batch.grading_inputs import DataStore, inputs_for, record_path
from autograder.batch.selection import find_batch
from autograder.batch.wrong_record import STUDENT_MESSAGE, find_reference_values
from autograder.course.individual_data import individual_file
from autograder.course.layout import RECORD_FILE, Course, read_template
from autograder.course.own_secret import PUBLIC_SECRET
from autograder.course.release import labsid_wheel, write_individual_release, write_release
from autograder.course.students import Student, read_students
from autograder.results.result_files import load, result_path
from autograder.sandbox.isolation import ProcessLauncher
from labsid.checks.notebook import load_assignment
from labsid.records.record import load_record

LAB, STEP = "lab-identification", "step-response"
SECRET = b"the course's secret, of more than 16 bytes"
STUDENTS = ("ann", "bob", "cat", "dan", "eve", "fay")


@pytest.fixture(scope="module")
def data_store(course: Course, tmp_path_factory: pytest.TempPathFactory) -> DataStore:
    return DataStore(course, SECRET, tmp_path_factory.mktemp("records"))


def literal(values: Mapping[str, object]) -> str:
    return "\n".join(f"{name} = np.array({np.asarray(value).tolist()!r})" for name, value in values.items())


@pytest.fixture(scope="module")
def graded(
    course: Course, data_store: DataStore, launcher: ProcessLauncher, tmp_path_factory: pytest.TempPathFactory
) -> Mapping[str, Path]:
    """Honest ann and fay; bob with the numbers of ann, dan with the course's; cat with a file of ann; eve wrong."""
    folder = tmp_path_factory.mktemp("class")
    source = nbformat.read(course.source / LAB / f"{LAB}.ipynb", as_version=4)

    def hand_in(student: str, replaced: Mapping[str, str]) -> Path:
        notebook = json.loads(json.dumps(source))
        for cell in notebook["cells"]:
            cell["source"] = replaced.get(cell["id"], cell["source"])
        path = folder / "submitted" / student / LAB / f"{LAB}.ipynb"
        path.parent.mkdir(parents=True)
        path.write_text(json.dumps(notebook), encoding="utf-8")
        return path.parent

    def theta(path: Path) -> dict[str, object]:
        right = find_reference_values(load_assignment(LAB), load_record(path))
        return {"theta_hat": right["lab-2b-theta"]["theta_hat"]}

    anns = record_path(data_store, RECORD_FILE, "ann")
    hand_in("ann", {})
    hand_in("bob", {"lab-2b-theta-answer": literal(theta(anns))})
    shutil.copyfile(anns, hand_in("cat", {}) / RECORD_FILE)
    hand_in("dan", {"lab-2b-theta-answer": literal(theta(course.record))})
    hand_in("eve", {"lab-2b-theta-answer": "theta_hat = np.array([1.0, 2.0, 3.0, 4.123456])"})
    shutil.copyfile(record_path(data_store, RECORD_FILE, "fay"), hand_in("fay", {}) / RECORD_FILE)
    out = folder / "out"
    list(grade_batch(course, find_batch(course, folder / "submitted"), out, LocalExecutor(launcher, 2), SECRET))
    return {student: result_path(out, student, LAB) for student in STUDENTS}


def test_without_a_secret_everybody_has_the_courses_record(course: Course, tmp_path: Path) -> None:
    inputs = inputs_for(DataStore(course, None, tmp_path), read_template(course, LAB), "ann")
    assert inputs.files == {RECORD_FILE: course.record}
    assert inputs.assets.secret == PUBLIC_SECRET
    assert list(tmp_path.iterdir()) == []


def test_with_a_secret_everybody_has_an_own_record(data_store: DataStore, course: Course) -> None:
    template = read_template(course, LAB)
    ann, bob = (inputs_for(data_store, template, student) for student in ("ann", "bob"))
    assert ann.assets.record is not None
    assert bob.assets.record is not None
    assert not np.array_equal(ann.assets.record.y, bob.assets.record.y)
    assert ann.files[RECORD_FILE].read_bytes() == individual_file(RECORD_FILE, "ann", SECRET)
    assert ann.assets.secret == SECRET
    again = inputs_for(data_store, read_template(course, STEP), "ann")
    assert again.files == ann.files
    other = inputs_for(DataStore(course, SECRET + b"!", data_store.folder), template, "ann")
    assert other.files[RECORD_FILE] != ann.files[RECORD_FILE]
    for path in data_store.folder.iterdir():
        assert "ann" not in path.name


def test_an_id_that_can_have_no_record_is_said(data_store: DataStore, course: Course) -> None:
    with pytest.raises(ValueError, match="control characters"):
        inputs_for(data_store, read_template(course, LAB), "a\x07b")
    with pytest.raises(ValueError, match="is the same for everybody"):
        individual_file("other.mat", "ann", SECRET)


def test_honest_work_is_right_on_its_own_record_and_not_flagged(graded: Mapping[str, Path]) -> None:
    for student in ("ann", "fay"):
        result = load(graded[student])
        assert all(question.score in (None, question.max_score) for question in result.questions)
        assert result.flags == ()
        assert result.notes == ()


def test_a_wrong_answer_that_is_right_on_anothers_record_is_flagged(graded: Mapping[str, Path]) -> None:
    for student, owner in (("bob", "ann"), ("dan", "the course's own record")):
        result = load(graded[student])
        assert result.flags == (f"made on the record of {owner}: lab-2b-theta",)
        (wrong,) = (question for question in result.questions if question.question == "lab-2b-theta")
        assert wrong.score == Decimal(0)
        assert wrong.reason.endswith(STUDENT_MESSAGE)
        assert "ann" not in wrong.reason
        assert result.notes == (f"some answers are made on another record than yours ({RECORD_FILE})",)
        others = [q for q in result.questions if q.question != "lab-2b-theta" and q.status != "manual"]
        assert all(question.score == question.max_score for question in others)


def test_anothers_data_file_is_flagged(graded: Mapping[str, Path]) -> None:
    result = load(graded["cat"])
    assert result.flags == ("handed in with the data file of ann",)
    assert result.notes == (f"{RECORD_FILE} is not the one that you were given",)


def test_an_answer_that_is_only_wrong_is_not_flagged(graded: Mapping[str, Path]) -> None:
    result = load(graded["eve"])
    assert result.flags == ()
    assert any(question.score == 0 for question in result.questions)


def test_the_report_and_the_table_name_them(graded: Mapping[str, Path]) -> None:
    from autograder.results.report import write_report
    from autograder.results.summary import class_table

    out = graded["ann"].parent.parent.parent
    page = write_report(out).read_text(encoding="utf-8")
    assert "made on the record of ann: lab-2b-theta" in page
    assert "handed in with the data file of ann" in page
    lines = {line.split()[0]: line for line in class_table(out).splitlines()}
    assert "made on the record of ann" in lines["bob"]
    assert "record of" not in lines["ann"]
    with (out / "grades.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["student"] == "bob" and row["question"] == "lab-2b-theta"]
    assert rows[0]["reason"].endswith(STUDENT_MESSAGE)


def test_a_student_of_an_impossible_id_is_quarantined_alone(
    course: Course, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    for student in ("ann", " bob"):
        shutil.copytree(course.source / LAB, tmp_path / "submitted" / student / LAB)
    batch = find_batch(course, tmp_path / "submitted")
    list(grade_batch(course, batch, tmp_path / "out", LocalExecutor(launcher, 2), SECRET))
    assert load(result_path(tmp_path / "out", "ann", LAB)).questions[0].status == "graded"
    refused = load(result_path(tmp_path / "out", " bob", LAB)).questions[0]
    assert refused.status == "quarantined"
    assert "no record can be generated for this student" in refused.reason


# ---- the release


@pytest.fixture
def complete(course: Course, tmp_path: Path) -> Course:
    """The course with the project's own description beside it, as a checkout has."""
    root = tmp_path / "checkout"
    shutil.copytree(course.root, root)
    shutil.copyfile(Path(__file__).resolve().parent.parent.parent / "pyproject.toml", root / "pyproject.toml")
    return Course(root)


def test_the_release_is_what_students_need_and_the_same_bytes(complete: Course, tmp_path: Path) -> None:
    files = write_release(complete, tmp_path / "a.zip")
    write_release(complete, tmp_path / "b.zip")
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        assert sorted(archive.namelist()) == files
        assert archive.read(f"{LAB}/{RECORD_FILE}") == complete.record.read_bytes()
        environment = archive.read("environment.yml").decode()
        for name in files:
            assert b"BEGIN SOLUTION" not in archive.read(name)
    for name in complete.assignments():
        assert f"{name}/{name}.ipynb" in files
    assert f"prelab-sinusoids/{RECORD_FILE}" not in files
    (wheel,) = (name for name in files if name.endswith(".whl"))
    assert f"- ./{wheel}" in environment
    assert "jupyterlab" in environment
    assert "nbgrader" not in environment


def test_the_wheel_is_whole(tmp_path: Path) -> None:
    import base64
    import hashlib

    name, content = labsid_wheel()
    (tmp_path / name).write_bytes(content)
    with zipfile.ZipFile(tmp_path / name) as archive:
        listed = archive.read(next(one for one in archive.namelist() if one.endswith("/RECORD"))).decode().split()
        assert {line.split(",")[0] for line in listed} == set(archive.namelist())
        assert not any(one.startswith("autograder") for one in archive.namelist())
        for line in listed:
            file, digest, _ = line.rsplit(",", 2)
            if digest:
                found = base64.urlsafe_b64encode(hashlib.sha256(archive.read(file)).digest()).decode().rstrip("=")
                assert digest == f"sha256={found}"


def test_an_individual_release_has_nothing_of_anybody_for_everybody(complete: Course, tmp_path: Path) -> None:
    done = write_individual_release(complete, tmp_path / "a.zip", SECRET, ["ann", "bob"])
    assert (done.shared, done.packages, done.students) == (tmp_path / "a.zip", tmp_path / "a-packages", 2)
    assert sorted(path.name for path in tmp_path.glob("a*/*")) == ["ann.zip", "bob.zip"]
    own = {name: individual_file(RECORD_FILE, name, SECRET) for name in ("ann", "bob")}
    for student, record in own.items():
        with zipfile.ZipFile(tmp_path / "a-packages" / f"{student}.zip") as archive:
            assert archive.read(f"{LAB}/{RECORD_FILE}") == archive.read(f"{STEP}/{RECORD_FILE}") == record
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        assert f"{LAB}/{LAB}.ipynb" in archive.namelist()
        for name in archive.namelist():
            assert not name.endswith((".mat", ".csv"))
            assert not {"ann", "bob"} & set(name.split("/"))
            assert archive.read(name) not in own.values()
    none = write_individual_release(complete, tmp_path / "n.zip", SECRET, ["ann"], ["prelab-sinusoids"])
    assert none.packages is None
    assert not (tmp_path / "n-packages").exists()
    for student in ("../x", "a/b", " ann", ""):
        with pytest.raises(ValueError, match="student"):
            write_individual_release(complete, tmp_path / "b.zip", SECRET, [student])
    assert not (tmp_path / "b.zip").exists()


def test_a_list_of_students_is_read(tmp_path: Path) -> None:
    path = tmp_path / "students"
    path.write_text("\ufeff# the class\nann\n\n bob \n", encoding="utf-8")
    assert read_students(path) == [Student("ann"), Student("bob")]
    path.write_text("ann\nann\n", encoding="utf-8")
    with pytest.raises(ValueError, match="names ann twice"):
        read_students(path)
    path.write_text("# nobody\n", encoding="utf-8")
    with pytest.raises(ValueError, match="names no students"):
        read_students(path)
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match="not text in UTF-8"):
        read_students(path)


def test_a_course_that_is_not_built_is_not_released(complete: Course, tmp_path: Path) -> None:
    shutil.rmtree(complete.release)
    with pytest.raises(ValueError, match="has not been built"):
        write_release(complete, tmp_path / "a.zip")
    assert not (tmp_path / "a.zip").exists()
