"""A small class from hand-in to feedback: the files, the gradebook, being stopped, and running again."""

import csv
import json
import re
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Any

import nbformat
import numpy as np
import pytest
from course_work import give_by_hand, scores_in_gradebook

from autograder.batch.executors import LocalExecutor
from autograder.batch.fingerprint import result_fingerprint
from autograder.batch.grade import Graded, grade_batch
from autograder.batch.grading_inputs import DataStore, inputs_for
from autograder.batch.selection import Batch, find_batch, handed_in_by
from autograder.course.layout import Course, read_template
from autograder.course.plain_text import plain_decimal
from autograder.export.grades_csv import export_csv
from autograder.intake.submission import NotebookCell
from autograder.judge.ask import ProcessAsk
from autograder.judge.execution import ExecutedCell
from autograder.judge.outcome import QuestionResult, SubmissionResult
from autograder.results import gradebook, grades, result_files
from autograder.results.autograded import write_autograded
from autograder.results.feedback import printable, write_feedback
from autograder.results.grades import write_csv, write_grades
from autograder.results.report import write_report
from autograder.results.result_files import StoredResult
from autograder.results.sent_tries import load_sent
from autograder.results.summary import class_table
from autograder.samples import write_samples
from autograder.sandbox.isolation import LEVELS, ProcessLauncher, Reply, StudentProcessError, open_launcher
from labsid.checks.kept_tries import KeptTry, tries_bytes, tries_file_name

PRELAB, LAB = "prelab-sinusoids", "lab-identification"
OPEN = "prelab-6-clock"


@dataclass(frozen=True)
class Class:
    """A graded class: ada is right, ben half right, finn's file is cut off, gil answers one open question."""

    course: Course
    batch: Batch
    out: Path

    def grades(self) -> dict[tuple[str, str, str], dict[str, str]]:
        return {(row["student"], row["assignment"], row["question"]): row for row in read_csv(self.out / "grades.csv")}


def read_csv(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module", autouse=True)
def unchanged_code() -> Iterator[None]:
    """Somebody may be editing the code while these tests run; a change would have everything graded anew."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("autograder.batch.fingerprint.sources_hash", lambda *modules: "the same")
        yield


@pytest.fixture(scope="module")
def graded(course: Course, launcher: ProcessLauncher, tmp_path_factory: pytest.TempPathFactory) -> Class:
    folder = tmp_path_factory.mktemp("class")
    write_samples(course, folder / "samples")
    for student, name in (("ada", PRELAB), ("ben", LAB), ("finn", LAB)):
        shutil.copytree(folder / "samples" / student / name, folder / "submitted" / student / name)
    shutil.copytree(course.release / PRELAB, folder / "submitted" / "gil" / PRELAB)
    path = folder / "submitted" / "gil" / PRELAB / f"{PRELAB}.ipynb"
    notebook = json.loads(path.read_text(encoding="utf-8"))
    (cell,) = (cell for cell in notebook["cells"] if cell["id"] == OPEN)
    cell["source"] = ["Because of the clock."]
    path.write_text(json.dumps(notebook), encoding="utf-8")
    (folder / "submitted" / ".DS_Store").touch()
    (folder / "submitted" / ".cache").mkdir()
    batch = find_batch(course, folder / "submitted")
    done = list(grade_batch(course, batch, folder / "out", LocalExecutor(launcher, 2)))
    assert sorted((one.student, one.assignment) for one in done) == sorted(
        (student, name) for student in ("ada", "ben", "finn", "gil") for name in (PRELAB, LAB)
    )
    assert all(one.fresh for one in done)
    return Class(course, batch, folder / "out")


@pytest.fixture
def again(graded: Class, tmp_path: Path) -> Class:
    """A copy of the graded class, to change."""
    shutil.copytree(graded.batch.submitted, tmp_path / "submitted")
    shutil.copytree(graded.out, tmp_path / "out")
    return Class(graded.course, find_batch(graded.course, tmp_path / "submitted"), tmp_path / "out")


def regrade(klass: Class, launcher: ProcessLauncher) -> set[Graded]:
    return {one for one in grade_batch(klass.course, klass.batch, klass.out, LocalExecutor(launcher, 2)) if one.fresh}


def same_but_seconds(one: Path, other: Path, assignment: str = "") -> bool:
    rows = [
        [{**row, "seconds": ""} for row in read_csv(path / "grades.csv") if assignment in row["assignment"]]
        for path in (one, other)
    ]
    return len(rows[0]) > 10 and rows[0] == rows[1]


def add_a_cell(submitted: Path, student: str, name: str) -> None:
    path = submitted / student / name / f"{name}.ipynb"
    notebook = json.loads(path.read_text(encoding="utf-8"))
    notebook["cells"].append({"cell_type": "markdown", "metadata": {}, "source": "Done."})
    path.write_text(json.dumps(notebook), encoding="utf-8")


# ---- grades.csv


def test_grades_have_a_line_for_every_question_in_order(graded: Class) -> None:
    lines = (graded.out / "grades.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "student,assignment,question,score,max_score,status,reason,isolation,seconds"
    expected = [
        (student, name, question.id)
        for student in ("ada", "ben", "finn", "gil")
        for name in sorted((PRELAB, LAB))
        for question in read_template(graded.course, name).questions
    ]
    rows = read_csv(graded.out / "grades.csv")
    assert sorted((row["student"], row["assignment"], row["question"]) for row in rows) == sorted(expected)
    for student in ("ada", "ben", "finn", "gil"):
        for name in (PRELAB, LAB):
            asked = [row["question"] for row in rows if (row["student"], row["assignment"]) == (student, name)]
            assert asked == [question.id for question in read_template(graded.course, name).questions]


def test_scores_are_exact_decimals(graded: Class) -> None:
    for row in graded.grades().values():
        points = {
            question.id: question.points for question in read_template(graded.course, row["assignment"]).questions
        }
        assert Decimal(row["max_score"]) == points[row["question"]]
        assert row["max_score"] == plain_decimal(points[row["question"]])
        assert row["score"] in ("", "0", row["max_score"])
        assert row["isolation"] in LEVELS
        assert re.fullmatch(r"\d+\.\d{3}", row["seconds"])
    lab = [row for row in graded.grades().values() if (row["student"], row["assignment"]) == ("ben", LAB)]
    assert sum(Decimal(row["max_score"]) for row in lab) == Decimal("2")


def test_each_student_gets_what_is_due(graded: Class) -> None:
    by_student: dict[tuple[str, str], list[dict[str, str]]] = {}
    for (student, name, _), row in graded.grades().items():
        by_student.setdefault((student, name), []).append(row)
    for row in by_student["ada", PRELAB]:
        manual = row["status"] == "manual"
        assert (row["score"], row["status"]) == (("", "manual") if manual else (row["max_score"], "graded"))
    slips = {row["question"] for row in by_student["ben", LAB] if row["score"] == "0"}
    assert slips == {"lab-1c-offsets", "lab-2b-parameters", "lab-3a-second-half"}
    for row in by_student["finn", LAB]:
        assert (row["score"], row["status"], row["seconds"]) == ("0", "quarantined", "0.000")
        assert "lab-identification.ipynb cannot be read" in row["reason"]
    for row in by_student["finn", PRELAB] + by_student["ada", LAB]:
        assert (row["score"], row["status"], row["reason"]) == ("0", "missing", "no notebook was submitted")
    for row in by_student["gil", PRELAB]:
        assert (row["score"], row["status"]) in (("0", "graded"), ("", "manual"))


def test_two_runs_are_equal_in_all_but_seconds(graded: Class, launcher: ProcessLauncher, tmp_path: Path) -> None:
    batch = find_batch(graded.course, graded.batch.submitted, LAB)
    list(grade_batch(graded.course, batch, tmp_path, LocalExecutor(launcher)))
    assert same_but_seconds(graded.out, tmp_path, LAB)


# ---- running again


def test_a_second_run_grades_nothing_anew(again: Class, graded: Class, launcher: ProcessLauncher) -> None:
    (again.out / "grades.csv").unlink()
    assert regrade(again, launcher) == set()
    assert (again.out / "grades.csv").read_bytes() == (graded.out / "grades.csv").read_bytes()


def test_only_what_changed_is_graded_anew(again: Class, graded: Class, launcher: ProcessLauncher) -> None:
    add_a_cell(again.batch.submitted, "gil", PRELAB)
    assert regrade(again, launcher) == {Graded("gil", PRELAB, True, "submission")}
    assert same_but_seconds(graded.out, again.out)


def test_tries_that_were_sent_are_stored_without_names_and_no_mark_depends_on_them(
    again: Class, graded: Class, launcher: ProcessLauncher
) -> None:
    sent = (KeptTry("prelab-1-time", 3, False, "row"), KeptTry("prelab-1-time", 5, True))
    path = again.batch.submitted / "ada" / PRELAB / tries_file_name(PRELAB)
    path.write_bytes(tries_bytes(sent))
    assert regrade(again, launcher) == set()
    assert load_sent(again.out, PRELAB) == (sent,)
    assert "ada" not in (again.out / "tries" / f"{PRELAB}.json").read_text(encoding="utf-8")
    assert same_but_seconds(again.out, graded.out)
    write_report(again.out)
    assert "What was hard" not in (again.out / "report.html").read_text(encoding="utf-8")  # one student
    path.unlink()
    regrade(again, launcher)
    assert load_sent(again.out, PRELAB) == ()


def test_the_report_has_what_five_students_sent(again: Class) -> None:
    sent = [[["prelab-1-time", 3, False, "row"], ["prelab-1-time", 5, True, ""]]] * 5
    path = again.out / "tries" / f"{PRELAB}.json"
    path.parent.mkdir()
    path.write_text(json.dumps({"schema": "labsid.sent-tries/1", "sent": sent}), encoding="utf-8")
    write_report(again.out)
    assert "What was hard" in (again.out / "report.html").read_text(encoding="utf-8")
    (row,) = read_csv(again.out / "what-was-hard.csv")
    assert (row["question"], row["tries_until_right"], row["first_mistakes"]) == ("prelab-1-time", "2", "row (5)")
    path.unlink()
    write_report(again.out)
    assert not (again.out / "what-was-hard.csv").exists()


def test_a_broken_result_is_graded_anew(again: Class, graded: Class, launcher: ProcessLauncher) -> None:
    for student, content in (("finn", "{"), ("gil", '{"schema": "labsid.result/0"}'), ("ada", "[]")):
        (again.out / "results" / student / f"{PRELAB}.json").write_text(content, encoding="utf-8")
    assert regrade(again, launcher) == {Graded(student, PRELAB, True, "new") for student in ("ada", "finn", "gil")}
    assert same_but_seconds(graded.out, again.out)


def test_a_gradebook_that_is_gone_is_filled_again_without_grading(
    again: Class, graded: Class, launcher: ProcessLauncher
) -> None:
    (again.out / "gradebook.db").unlink()
    assert regrade(again, launcher) == set()
    assert scores_in_gradebook(again.out) == scores_in_gradebook(graded.out)


def test_what_a_killed_run_had_not_entered_is_entered_by_the_next(
    again: Class, graded: Class, launcher: ProcessLauncher, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Killed after the results and before the gradebook: nothing is graded again, nothing is missing or twice."""
    (again.out / "gradebook.db").unlink()
    shutil.rmtree(again.out / "results")
    monkeypatch.setattr(gradebook, "enter", lambda out, stored: 0)
    assert len(regrade(again, launcher)) == 8
    monkeypatch.undo()
    monkeypatch.setattr("autograder.batch.fingerprint.sources_hash", lambda *modules: "the same")
    assert regrade(again, launcher) == set()
    assert scores_in_gradebook(again.out) == scores_in_gradebook(graded.out)
    assert gradebook.enter(again.out, result_files.load_all(again.out)) == 0


def test_every_part_of_a_fingerprint_counts(course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    template = read_template(course, LAB)
    shutil.copytree(course.data, tmp_path / "data")
    solution = shutil.copytree(course.source / LAB, Course(tmp_path).source / LAB) / f"{LAB}.ipynb"
    folder = tmp_path / "ann" / LAB
    folder.mkdir(parents=True)

    def parts(root: Path = course.root, secret: bytes | None = None) -> dict[str, str]:
        data_store = DataStore(Course(root), secret, tmp_path / "records")
        return result_fingerprint(data_store, inputs_for(data_store, template, "ann"), folder)

    def differing(other: dict[str, str]) -> set[str]:
        return {part for part, found in other.items() if found != first[part]}

    first = parts()
    assert set(first) == {"submission", "release", "solution", "check", "data", "environment"}
    assert parts(tmp_path) == first
    written = solution.read_text(encoding="utf-8")
    solution.write_text(written.replace("while u[n] == u[0]", "while u[n] == u[1]"), encoding="utf-8")
    assert differing(parts(tmp_path)) == {"solution"}
    solution.write_text(written, encoding="utf-8")
    assert differing(parts(secret=b"a secret of the course")) == {"data"}
    switched_off = DataStore(course, None, tmp_path / "records", frozenset({LAB}))
    inputs = inputs_for(switched_off, template, "ann")
    assert not inputs.assets.second_record
    assert differing(result_fingerprint(switched_off, inputs, folder)) == {"data"}
    with monkeypatch.context() as patch:
        patch.setattr("autograder.batch.fingerprint.sources_hash", lambda *modules: "other")
        assert differing(parts()) == {"check"}
        patch.setattr("autograder.batch.fingerprint.environment_hash", lambda: "other")
        patch.setattr("autograder.batch.fingerprint.template_hash", lambda template: "other")
        assert differing(parts()) == {"check", "environment", "release"}
    shutil.copyfile(course.data / "SysIdenData_Verification.mat", tmp_path / "data" / course.record.name)
    assert differing(parts(tmp_path)) == {"data"}
    (folder / "timestamp.txt").write_text("2026-11-30 12:00:00 UTC", encoding="utf-8")
    assert parts() == first
    for name in ("other.ipynb", "mine.mat"):
        (folder / name).write_text("{}", encoding="utf-8")
        assert differing(parts()) == {"submission"}
        (folder / name).unlink()


class Killed(BaseException):
    """What a kill looks like from inside: nothing after it is written."""


def test_killed_at_any_write_nothing_is_lost_or_doubled(
    graded: Class, launcher: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At a file that is written or a change of the gradebook that is committed: the last ones, and some before."""
    from sqlalchemy import event
    from sqlalchemy.engine import Engine

    batch = Batch(graded.batch.submitted, ("finn", "gil"), (PRELAB,))
    writes = [0, 0]  # so many there were; the one at which the run is killed

    def step(*_: object) -> None:
        writes[0] += 1
        if writes[0] == writes[1]:
            raise Killed

    def write(path: Path, content: bytes) -> None:
        step()
        path.write_bytes(content)

    def grade(out: Path, killed_at: int) -> None:
        writes[:] = 0, killed_at
        list(grade_batch(graded.course, batch, out, LocalExecutor(launcher)))

    monkeypatch.setattr("labsid._files.write_file", write)
    event.listen(Engine, "commit", step)
    try:
        grade(tmp_path / "whole", killed_at=0)
        count = writes[0]
        moments = sorted({*range(2, count, max(count // 3, 1)), *range(count - 3, count + 1)})
        for moment in moments:
            with pytest.raises(Killed):
                grade(tmp_path / str(moment), moment)
            grade(tmp_path / str(moment), killed_at=0)
            assert same_but_seconds(tmp_path / "whole", tmp_path / str(moment))
            assert scores_in_gradebook(tmp_path / str(moment)) == scores_in_gradebook(tmp_path / "whole")
    finally:
        event.remove(Engine, "commit", step)
    assert len(moments) > 5


def test_only_one_run_writes(again: Class, launcher: ProcessLauncher) -> None:
    first = grade_batch(again.course, again.batch, again.out, LocalExecutor(launcher))
    next(first)
    with pytest.raises(ValueError, match="another 'labsid course grade' is writing to"):
        next(grade_batch(again.course, again.batch, again.out, LocalExecutor(launcher)))
    first.close()
    assert regrade(again, launcher) == set()


@pytest.mark.parametrize("stop", [RuntimeError, KeyboardInterrupt])
def test_a_run_that_is_stopped_goes_on_where_it_was(
    graded: Class, launcher: ProcessLauncher, tmp_path: Path, stop: type[BaseException]
) -> None:
    batch = find_batch(graded.course, graded.batch.submitted, PRELAB)
    with open_launcher() as doomed:
        run = grade_batch(graded.course, batch, tmp_path, LocalExecutor(doomed, 2))
        first = {next(run), next(run)}
        with pytest.raises(stop):
            run.throw(stop)
    assert not (tmp_path / "grades.csv").exists()
    kept = {(path.parent.name, path.stem) for path in (tmp_path / "results").glob("*/*.json")}
    assert {(one.student, one.assignment) for one in first} == kept
    assert not list(tmp_path.rglob("*.partial"))

    assert len(regrade(Class(graded.course, batch, tmp_path), launcher)) == 2
    assert same_but_seconds(graded.out, tmp_path, PRELAB)
    entered = {key: score for key, score in scores_in_gradebook(graded.out).items() if key[1] == PRELAB}
    assert scores_in_gradebook(tmp_path) == entered


def test_a_caller_may_stop_asking(graded: Class, launcher: ProcessLauncher, tmp_path: Path) -> None:
    batch = find_batch(graded.course, graded.batch.submitted, PRELAB)
    run = grade_batch(graded.course, batch, tmp_path, LocalExecutor(launcher))
    first = next(run)
    run.close()
    kept = [(path.parent.name, path.stem) for path in (tmp_path / "results").glob("*/*.json")]
    assert kept == [(first.student, first.assignment)]


def test_the_gradebook_is_not_entered_twice_when_stopped_before_the_result(
    again: Class, graded: Class, launcher: ProcessLauncher
) -> None:
    """Killed between the two writes: the gradebook has the score, the result is not there yet."""
    (again.out / "results" / "gil" / f"{PRELAB}.json").unlink()
    assert regrade(again, launcher) == {Graded("gil", PRELAB, True, "new")}
    assert scores_in_gradebook(again.out) == scores_in_gradebook(graded.out)


# ---- the gradebook


def test_nbgraders_gradebook_has_the_scores(graded: Class) -> None:
    scores = scores_in_gradebook(graded.out)
    assert {(student, name) for student, name, _ in scores} == {("ada", PRELAB), ("ben", LAB), ("gil", PRELAB)}
    rows = graded.grades()
    for key, (score, most, waits) in scores.items():
        row = rows[key]
        assert most == float(row["max_score"])
        assert score == (None if row["score"] == "" else float(row["score"]))
        assert waits == (row["score"] == "")
    with gradebook.open_gradebook(gradebook.database_url(graded.out)) as book:
        assert book.find_submission(PRELAB, "ada").score == pytest.approx(0.95)
        assert book.find_assignment(LAB).max_score == pytest.approx(2)


@pytest.fixture
def by_hand(again: Class) -> Callable[..., None]:
    """Grade the pre-lab by hand."""
    return partial(give_by_hand, again.out, PRELAB)


def test_what_was_given_by_hand_outlives_a_new_grading(
    again: Class, by_hand: Callable, launcher: ProcessLauncher
) -> None:
    by_hand("ada", OPEN, "Nearly: see <the> hint & 3a.", manual_score=0.04)
    add_a_cell(again.batch.submitted, "ada", PRELAB)
    assert regrade(again, launcher) == {Graded("ada", PRELAB, True, "submission")}
    row = again.grades()["ada", PRELAB, OPEN]
    assert (row["score"], row["max_score"], row["status"]) == ("0.04", "0.05", "manual")
    with gradebook.open_gradebook(gradebook.database_url(again.out)) as book:
        assert book.find_grade(OPEN, PRELAB, PRELAB, "ada").manual_score == 0.04
    export_csv(again.out)
    exported = {(row["student"], row["assignment"]): row for row in read_csv(again.out / "export.csv")}
    assert exported["ada", PRELAB]["score"] == "0.99"
    assert (exported["ada", PRELAB]["waiting"], exported["ada", PRELAB]["status"]) == ("0", "complete")
    list(write_feedback(again.out))
    page = (again.out / "feedback" / "ada" / f"{PRELAB}.html").read_text(encoding="utf-8")
    assert "Nearly: see &lt;the&gt; hint &amp; 3a." in page
    assert "Graded by hand" in page
    assert "<strong>0.99</strong> of 1" in page
    assert "more wait" not in page


def test_export_brings_the_grades_up_to_date(again: Class, by_hand: Callable) -> None:
    by_hand("ada", OPEN, manual_score=0.05)
    by_hand("ada", "prelab-1-time", manual_score=0.05)  # manual scores take precedence
    export_csv(again.out)
    rows = again.grades()
    assert rows["ada", PRELAB, OPEN]["score"] == "0.05"
    assert rows["ada", PRELAB, "prelab-1-time"]["score"] == "0.05"


def test_extra_credit_is_added_exactly(again: Class, by_hand: Callable) -> None:
    by_hand("ada", "prelab-1-time", extra_credit=0.2)  # 0.1 + 0.2
    by_hand("ada", OPEN, manual_score=0.01, extra_credit=0.05)
    by_hand("gil", OPEN, extra_credit=0.05)
    given = gradebook.read_manual_grades(again.out).scores
    assert given == {("ada", PRELAB, "prelab-1-time"): Decimal("0.3"), ("ada", PRELAB, OPEN): Decimal("0.06")}
    write_grades(again.out)
    assert again.grades()["ada", PRELAB, "prelab-1-time"]["score"] == "0.3"
    assert again.grades()["gil", PRELAB, OPEN]["score"] == ""


def test_a_broken_second_hand_in_takes_the_automatic_scores_with_it(again: Class, launcher: ProcessLauncher) -> None:
    (again.batch.submitted / "ada" / PRELAB / f"{PRELAB}.ipynb").write_text("{", encoding="utf-8")
    assert regrade(again, launcher) == {Graded("ada", PRELAB, True, "submission")}
    assert {row["score"] for (student, _, _), row in again.grades().items() if student == "ada"} == {"0"}
    assert {score for (student, _, _), (score, _, _) in scores_in_gradebook(again.out).items() if student == "ada"} == {
        0
    }


def test_an_assignment_that_changed_under_its_grades_is_said(tmp_path: Path) -> None:
    folder = tmp_path / "autograder" / "release" / "tiny"
    folder.mkdir(parents=True)

    def release(*questions: str) -> Course:
        notebook = nbformat.v4.new_notebook()
        for question in questions:
            cell = nbformat.v4.new_markdown_cell("*Your answer here*", id=question)
            cell.metadata["nbgrader"] = {
                "grade": True, "grade_id": question, "locked": False, "schema_version": 3, "solution": True,
                "task": False, "cell_type": "markdown", "points": 0.1,
            }  # fmt: skip
            notebook.cells.append(cell)
        nbformat.write(notebook, folder / "tiny.ipynb")
        return Course(tmp_path)

    out = tmp_path / "out"
    gradebook.prepare(release("a", "b"), out, ["tiny"])
    gradebook.prepare(release("a"), out, ["tiny"])  # nobody was graded yet
    question = QuestionResult("a", None, Decimal("0.1"), "manual", "")
    assert gradebook.enter(out, [StoredResult("ann", "tiny", "", (question,), {}, (), "none", {})]) == 1
    for questions in (("a", "b"), ("b",), ()):
        with pytest.raises(ValueError, match=r"tiny has changed since .*Grade into a new folder"):
            gradebook.prepare(release(*questions), out, ["tiny"])


def test_nbgraders_own_commands_find_their_way_in_the_folder(graded: Class, monkeypatch: pytest.MonkeyPatch) -> None:
    from traitlets.config.loader import PyFileConfigLoader

    config = PyFileConfigLoader("nbgrader_config.py", str(graded.out)).load_config().CourseDirectory
    assert Path(config.root) == graded.out
    assert Path(config.source_directory) == graded.course.source
    assert config.db_url == gradebook.database_url(graded.out)


def test_folders_whose_names_differ_only_in_case_are_refused(course: Course, tmp_path: Path) -> None:
    for student in ("ada", "Ada", "ben"):
        (tmp_path / "submitted" / student).mkdir(parents=True)
    with pytest.raises(ValueError, match=r"the folders Ada and ada of .* differ only in upper and lower case"):
        find_batch(course, tmp_path / "submitted", PRELAB)


# ---- autograded notebooks


def test_autograded_notebooks_show_what_was_handed_in_and_what_came_of_it(graded: Class) -> None:
    made = {(path.parent.parent.name, path.stem) for path in (graded.out / "autograded").glob("*/*/*.ipynb")}
    assert made == {("ada", PRELAB), ("ben", LAB), ("gil", PRELAB)}
    for student, name in made:
        notebook = nbformat.read(graded.out / "autograded" / student / name / f"{name}.ipynb", as_version=4)
        nbformat.validate(notebook)
        released = nbformat.read(graded.course.release / name / f"{name}.ipynb", as_version=4)
        assert len(notebook.cells) == len(released.cells)
        for cell, given in zip(notebook.cells, released.cells, strict=True):
            assert cell.cell_type == given.cell_type
            assert cell.metadata.get("nbgrader") == given.metadata.get("nbgrader")
            if "nbgrader" in given.metadata:
                assert cell.id == given.id
            else:
                assert cell.source == given.source
    ben = nbformat.read(graded.out / "autograded" / "ben" / LAB / f"{LAB}.ipynb", as_version=4)
    cells = {cell.id: cell for cell in ben.cells}
    assert "y_offset = np.mean(y_act)" in cells["lab-1c-offsets-answer"].source
    (picture,) = cells["lab-1b-figure-5"].outputs
    assert picture.output_type == "display_data"
    assert picture.data["image/svg+xml"].startswith("<svg ")


def test_added_cells_errors_and_deaths_are_in_the_autograded_notebook(graded: Class, tmp_path: Path) -> None:
    def ran(step: NotebookCell, **reply: Any) -> ExecutedCell:
        return ExecutedCell(step, Reply(ok=True, **reply))

    course = graded.course
    first = read_template(course, PRELAB).cells[0]
    result = SubmissionResult(
        "ann", PRELAB, (), (
            ran(NotebookCell(None, "extra", "before", True), stdout="said \ud800"),
            ran(NotebookCell(first.id, "given", first.source, True), error={"kind": "NameError", "text": "no x"}),
            ran(NotebookCell(None, "extra", "a *note*", False)),
            ExecutedCell(
                NotebookCell(None, "extra", "end()", True), Reply(False), StudentProcessError("crashed", "it ended")
            ),
        ), (), "none",
    )  # fmt: skip
    write_autograded(course, tmp_path, result)
    notebook = nbformat.read(tmp_path / "autograded" / "ann" / PRELAB / f"{PRELAB}.ipynb", as_version=4)
    nbformat.validate(notebook)
    assert [cell.source for cell in notebook.cells] == [
        "before",
        first.source,
        '<div class="labsid-answer"><p>a <em>note</em></p>&#10;</div>',
        "end()",
    ]
    assert [cell.id for cell in notebook.cells] == ["extra-0", first.id, "extra-2", "extra-3"]
    assert notebook.cells[0].outputs[0].text == "said \ud800"
    assert notebook.cells[1].outputs[0].ename == "NameError"
    assert notebook.cells[3].outputs[0].text == "it ended\n"


def test_formgrader_runs_nothing_that_a_student_wrote(graded: Class) -> None:
    """Shown by nbgrader's exporter with the settings of the folder, as formgrader does it."""
    from nbgrader.server_extensions.formgrader.formgrader import HTMLExporter
    from traitlets.config.loader import PyFileConfigLoader

    path = graded.out / "autograded" / "ben" / LAB / f"{LAB}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    hostile = '<img src=x onerror="alert(1)"><script>alert("planted")</script>'
    notebook.cells.append(nbformat.v4.new_markdown_cell(hostile))
    notebook.cells.append(nbformat.v4.new_code_cell("", outputs=[nbformat.v4.new_output("stream", text=hostile)]))
    config = PyFileConfigLoader("nbgrader_config.py", str(graded.out)).load_config()
    page, _ = HTMLExporter(config=config).from_notebook_node(notebook)
    assert '<script>alert("planted")' not in page
    assert not re.search(r"<img[^>]*onerror", page)
    assert re.search(r'<img[^>]*src="data:image/svg\+xml;base64,', page)


# ---- feedback


@pytest.fixture(scope="module")
def pages(graded: Class) -> Mapping[tuple[str, str], str]:
    paths = list(write_feedback(graded.out))
    return {(path.parent.name, path.stem): path.read_text(encoding="utf-8") for path in paths}


def test_every_submission_gets_a_page_that_stands_alone(pages: Mapping, graded: Class) -> None:
    assert set(pages) == {(student, name) for student in graded.batch.students for name in (PRELAB, LAB)}
    for page in pages.values():
        assert page.startswith("<!doctype html>")
        assert not re.search(r"https?:|<script|<link|@import|src=\"(?!data:image/svg)", page)


def test_a_page_says_reason_slip_and_points(pages: Mapping, graded: Class) -> None:
    page = pages["ben", LAB]
    row = graded.grades()["ben", LAB, "lab-1c-offsets"]
    assert row["reason"].startswith("`y_offset` is the mean")
    assert "<code>y_offset</code>" + row["reason"].removeprefix("`y_offset`") in page
    assert "Common mistake: mean over the whole record" in page
    assert "0 / 0.15" in page
    assert page.count("Judged on the right values of") == 1  # once, at the top
    assert 'Judged on the right values of <a href="#lab-1c-offsets">' in page
    assert "Output y (V) over Time (s): " in page  # what a figure shows, in words
    assert "y_offset = np.mean(y_act)" in page
    assert 'src="data:image/svg+xml;base64,' in page
    assert "not yet graded by hand" in page
    assert "broken JSON" in pages["finn", LAB]
    assert "<div>Not handed in.</div>" in pages["finn", PRELAB]


def test_pages_are_the_same_when_written_again(graded: Class, pages: Mapping) -> None:
    for path in write_feedback(graded.out):
        assert path.read_text(encoding="utf-8") == pages[path.parent.name, path.stem]


def test_a_page_holds_no_input_that_the_judge_tried(
    course: Course, grade_code: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[np.ndarray] = []
    call = ProcessAsk.call

    def spy(self: ProcessAsk, name: str, *arguments: Any) -> Any:
        tried.extend(argument for argument in arguments if isinstance(argument, np.ndarray))
        return call(self, name, *arguments)

    monkeypatch.setattr(ProcessAsk, "call", spy)
    cell = (
        "import matplotlib.pyplot as plt\ndef cut_off(data, n):\n    print(data)\n    plt.plot(data)\n    return data"
    )
    found = grade_code(PRELAB, {"prelab-4-function-answer": cell})["prelab-4-function"]
    assert found.score == 0
    assert tried
    result_files.store(tmp_path, StoredResult("ann", PRELAB, "Pre-lab", (found,), {}, (), "none", {}))
    (page,) = (path.read_text(encoding="utf-8") for path in write_feedback(tmp_path))
    assert "def cut_off(data, n):" in page
    assert "<img" not in page
    numbers = {f"{abs(value):.5f}" for array in tried for value in array.reshape(-1)}
    shown = [number for number in numbers if number in page and not number.endswith("000")]
    assert shown == []


HOSTILE = '<script>alert("x")</script>'


@pytest.fixture
def hostile_page(tmp_path: Path) -> str:
    question = QuestionResult(
        "q-1", Decimal("0.0"), Decimal("0.10"), "graded",
        reason=f"reason `{HOSTILE}` {HOSTILE} `", slip=f"slip {HOSTILE}", answer=f"answer {HOSTILE}</pre>",
        output=f"\x1b[31mred\x1b[0m \x1b]8;;file://x\x07\b\0 {HOSTILE} \ud800 é",
        figures=("iVBORw0KGgoAAAA=", '" onerror="alert(1)'),
    )  # fmt: skip
    heading, notes = {"q-1": f"Heading {HOSTILE}"}, (f"note {HOSTILE}",)
    result = StoredResult(
        "<b>eve", "tiny", f"Title {HOSTILE}", (question,), heading, notes, f"none {HOSTILE}", {}, late=f"late {HOSTILE}"
    )
    result_files.store(tmp_path, result)
    (path,) = write_feedback(tmp_path)
    return path.read_text(encoding="utf-8")


def test_nothing_that_a_student_wrote_is_run_by_a_browser(hostile_page: str) -> None:
    assert "<script" not in hostile_page
    assert "&lt;script&gt;" in hostile_page
    assert "<b>eve" not in hostile_page
    assert "&lt;b&gt;eve" in hostile_page
    assert '" onerror' not in hostile_page
    assert hostile_page.count("<img") == 2
    assert hostile_page.count("</pre>") == 2


def test_terminal_colours_and_control_characters_are_taken_out(hostile_page: str) -> None:
    assert "\x1b" not in hostile_page
    assert "[31m" not in hostile_page
    assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f]", hostile_page)
    assert "red" in hostile_page
    assert "é" in hostile_page
    assert printable("\x1b[1;31mHot\x1b[0m\ttea\r\n\x07") == "Hot\ttea\n"


def test_feedback_on_nothing_is_said(tmp_path: Path) -> None:
    for command in (
        lambda: list(write_feedback(tmp_path)),
        lambda: export_csv(tmp_path),
        lambda: class_table(tmp_path),
    ):
        with pytest.raises(ValueError, match=r"holds no results\. Run: labsid course grade"):
            command()


# ---- exports and tables


def test_the_export_has_a_line_for_every_submission(graded: Class) -> None:
    path = export_csv(graded.out)
    assert path.read_text(encoding="utf-8").splitlines()[0] == (
        "student,assignment,score,max_score,waiting,status,late_penalty"
    )
    rows = {(row["student"], row["assignment"]): list(row.values())[2:] for row in read_csv(path)}
    assert len(rows) == 8
    assert rows["ada", PRELAB] == ["0.95", "1", "0.05", "waiting", "0"]
    assert rows["ben", LAB] == ["1.45", "2", "0.1", "waiting", "0"]
    assert rows["finn", LAB] == ["0", "2", "0", "quarantined", "0"]
    assert rows["finn", PRELAB] == ["0", "1", "0", "missing", "0"]


def test_the_table_of_the_class(graded: Class) -> None:
    lines = class_table(graded.out).splitlines()
    assert len(lines) == 5
    assert re.fullmatch(r"ben\s+0 of 1\s+1.45 of 2\s+missing, 0.1 to grade by hand", lines[2])
    assert "quarantined" in lines[3]


def test_the_table_takes_any_name(tmp_path: Path) -> None:
    """Names come from folders; rich would read some of them as its own mark-up."""
    question = QuestionResult("q", None, Decimal("0.5"), "manual", "")
    for name in ("[/red]", "[bold]x"):
        path = tmp_path / "results" / name.replace("/", "") / "tiny.json"
        result_files.store(tmp_path, StoredResult(path.parent.name, "tiny", "", (question,), {}, (), "none", {}))
        path.write_text(path.read_text().replace(f'"{path.parent.name}"', json.dumps(name)), encoding="utf-8")
    table = class_table(tmp_path)
    assert "[/red]" in table
    assert "[bold]x" in table


def test_a_spreadsheet_gets_no_formula(tmp_path: Path) -> None:
    nasty = ["=1+1", "@SUM(A1)", "+1+1", "-2+3+cmd|' /C calc'!A0", " =1", "\t=1", "-x"]
    harmless = ["-1", "-0.5", "0.3", "2", "", "a=b", "Right."]
    write_csv(tmp_path / "a.csv", ["x"], [{"x": text} for text in nasty + harmless])
    assert [row["x"] for row in read_csv(tmp_path / "a.csv")] == [f"'{text}" for text in nasty] + harmless


def test_reasons_stand_on_one_line(tmp_path: Path) -> None:
    reason = 'first\nsecond\r\n\x07"third", \x1b[31mred'
    question = QuestionResult("q", Decimal("0.1"), Decimal("0.10"), "graded", reason, seconds=1.23456)
    stored = StoredResult("=ann", "tiny", "Tiny", (question,), {}, (), "none", {})
    write_csv(
        tmp_path / "grades.csv",
        grades.GRADE_COLUMNS,
        grades.grade_rows([stored], gradebook.ManualGrades({}, {}, frozenset())),
    )
    (row,) = read_csv(tmp_path / "grades.csv")
    assert row["reason"] == 'first second "third", [31mred'
    assert (row["student"], row["max_score"], row["seconds"]) == ("'=ann", "0.1", "1.235")


def test_results_come_back_as_they_were_stored(tmp_path: Path) -> None:
    question = QuestionResult(
        "q",
        Decimal("0.30"),
        Decimal("0.6"),
        "graded",
        "Because \ud800.",
        "slip",
        "a = 1",
        "out",
        ("cGljdHVyZQ==",),
        0.25,
    )
    by_hand = QuestionResult("open", None, Decimal("0.1"), "manual", "")
    result = StoredResult(
        "ann", "tiny", "Tiny", (question, by_hand), {"q": "1. Heading"}, ("a note",), "none", {"check": "abc"},
        ("a flag",), ("open",), "2026-12-01T00:00:00+00:00", Decimal("0.1"), "Handed in late.", {"q": ("12", 30)},
    )  # fmt: skip
    result_files.store(tmp_path, result)
    (stored,) = result_files.load_all(tmp_path)
    assert stored == result
    assert grades.totals(stored, {}) == grades.Totals(Decimal("0.2"), Decimal("0.7"), Decimal("0.1"), Decimal("0.1"))
    given = {("ann", "tiny", "open"): Decimal("0.1")}
    assert grades.totals(stored, given) == grades.Totals(Decimal("0.3"), Decimal("0.7"), Decimal("0"), Decimal("0.1"))


@pytest.mark.parametrize(
    "content",
    ["", "{", "[]", "{}", '{"schema": "labsid.result/2"}', "\xff", "SCORE"],
)
def test_a_result_that_is_none_is_said(tmp_path: Path, content: str) -> None:
    question = QuestionResult("q", Decimal("0.30"), Decimal("0.6"), "graded", "")
    result_files.store(tmp_path, StoredResult("ann", "tiny", "", (question,), {}, (), "none", {}))
    path = result_files.result_path(tmp_path, "ann", "tiny")
    whole = path.read_text(encoding="utf-8")
    path.write_text(whole.replace("0.30", "lots") if content == "SCORE" else content, encoding="latin-1")
    with pytest.raises(ValueError, match=r"tiny.json is not a result .*Delete it and grade again"):
        result_files.load_all(tmp_path)


@pytest.mark.parametrize(("value", "text"), [("0.60", "0.6"), ("2.0", "2"), ("100", "100"), ("0", "0"), ("-0.0", "0")])
def test_decimals_are_plain(value: str, text: str) -> None:
    assert plain_decimal(Decimal(value)) == text


# ---- what is handed to the grader


def test_hand_ins_that_are_none_are_said(course: Course, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="is not a folder"):
        find_batch(course, tmp_path / "nosuch")
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match="is not a folder"):
        find_batch(course, tmp_path / "file")
    with pytest.raises(ValueError, match="holds no submission: expected"):
        find_batch(course, tmp_path)
    (tmp_path / "ann" / "holiday").mkdir(parents=True)
    with pytest.raises(ValueError, match="holds no submission: expected"):
        find_batch(course, tmp_path)
    with pytest.raises(ValueError, match=r"no assignment 'holiday'; there are prelab-sinusoids, lab-identification"):
        find_batch(course, tmp_path, "holiday")


def test_what_nobody_answered_is_not_graded_and_it_is_said(course: Course, tmp_path: Path) -> None:
    """The zip of `labsid submit` can hold every notebook: untouched ones must not mark the class down."""
    for student in ("ann", "bob", "cat"):
        for name in (PRELAB, LAB, "step-response"):
            shutil.copytree(course.release / name, tmp_path / student / name)
        add_a_cell(tmp_path, student, LAB)
    assert handed_in_by(course, tmp_path) == {PRELAB: [], LAB: ["ann", "bob", "cat"], "step-response": []}
    batch = find_batch(course, tmp_path)
    assert batch.assignments == (LAB,)
    assert batch.remarks == tuple(
        f"{name}: not graded, because every notebook is as released." for name in (PRELAB, "step-response")
    )
    add_a_cell(tmp_path, "bob", PRELAB)
    batch = find_batch(course, tmp_path)
    assert batch.assignments == (PRELAB, LAB)
    assert batch.remarks[0] == (
        f"{PRELAB}: handed in by 1 of 3 students; the others get 0 marks. If it is not due, grade only what is: "
        f"--assignment {LAB}"
    )
    batch = find_batch(course, tmp_path, due=[LAB, "step-response", "least-squares"])
    assert batch.assignments == (LAB,)
    assert batch.remarks == (
        f"{PRELAB}: not graded, because its due date in course.toml has not passed; 1 student handed it in.",
        "step-response: not graded, because every notebook is as released.",
        "least-squares: not graded, because nobody handed it in.",
    )
    with pytest.raises(ValueError, match=f"nothing that is due was handed in; .* holds {PRELAB}, {LAB}"):
        find_batch(course, tmp_path, due=[])
    assert find_batch(course, tmp_path, "step-response", PRELAB).assignments == (PRELAB, "step-response")


def test_a_folder_of_untouched_notebooks_holds_no_submission(course: Course, tmp_path: Path) -> None:
    shutil.copytree(course.release / LAB, tmp_path / "ann" / LAB)
    with pytest.raises(ValueError, match=r"holds no submission: .*; every notebook in it is as released\."):
        find_batch(course, tmp_path)


def test_an_assignment_can_be_graded_though_nobody_handed_it_in(course: Course, tmp_path: Path) -> None:
    (tmp_path / "ann").mkdir()
    assert find_batch(course, tmp_path, LAB) == Batch(tmp_path, ("ann",), (LAB,))


def test_only_what_was_asked_for_is_graded(graded: Class, launcher: ProcessLauncher, tmp_path: Path) -> None:
    batch = find_batch(graded.course, graded.batch.submitted, PRELAB)
    list(grade_batch(graded.course, batch, tmp_path, LocalExecutor(launcher)))
    assert {row["assignment"] for row in read_csv(tmp_path / "grades.csv")} == {PRELAB}


def test_a_course_that_is_not_built_is_said(graded: Class, launcher: ProcessLauncher, tmp_path: Path) -> None:
    shutil.copytree(graded.course.notebooks, tmp_path / "notebooks")
    with pytest.raises(ValueError, match=r"has not been built .*labsid course build"):
        list(grade_batch(Course(tmp_path), graded.batch, tmp_path / "out", LocalExecutor(launcher)))


def test_strange_things_in_a_hand_in_do_not_stop_the_class(
    graded: Class, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    """A folder, a dangling link and a half character where a notebook should be."""
    submitted = tmp_path / "submitted"
    (submitted / "ann" / PRELAB / f"{PRELAB}.ipynb").mkdir(parents=True)
    (submitted / "bob" / PRELAB).mkdir(parents=True)
    (submitted / "bob" / PRELAB / f"{PRELAB}.ipynb").symlink_to(tmp_path / "nosuch")
    shutil.copytree(graded.course.release / PRELAB, submitted / "cat" / PRELAB)
    path = submitted / "cat" / PRELAB / f"{PRELAB}.ipynb"
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        if cell["id"] == "prelab-1-time-answer":
            cell["source"] = "print(chr(0xD800))\n# \ud800"
        if cell["id"] == OPEN:
            cell["source"] = "half \ud800"
    path.write_text(json.dumps(notebook), encoding="utf-8")
    batch = find_batch(graded.course, submitted)
    out = tmp_path / "out"
    assert len(list(grade_batch(graded.course, batch, out, LocalExecutor(launcher)))) == 3
    rows = read_csv(out / "grades.csv")
    assert {row["status"] for row in rows if row["student"] != "cat"} == {"missing"}
    assert {row["status"] for row in rows if row["student"] == "cat"} == {"graded", "manual"}
    assert len(list(write_feedback(out))) == 3
    assert list(grade_batch(graded.course, batch, out, LocalExecutor(launcher))) == [
        Graded(student, PRELAB, fresh=False) for student in ("ann", "bob", "cat")
    ]


# ---- the samples


def test_the_samples_are_answers_of_the_notebooks(course: Course) -> None:
    from autograder import samples

    ids = {cell.id for cell in read_template(course, LAB).cells if cell.kind in ("answer", "manual")}
    for replaced in (samples._MISTAKES, samples._OTHER_METHODS, samples._CRASHING):
        assert set(replaced) <= ids
