"""Hand-ins and machines that break the work on one submission: the others are graded, and a next run goes on."""

import csv
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import nbformat
import numpy as np
import pytest

from autograder.batch import judge_process
from autograder.batch.executors import LocalExecutor
from autograder.batch.fingerprint import submission_hash
from autograder.batch.grade import Graded, grade_batch
from autograder.batch.hand_ins import compare_with_others
from autograder.batch.selection import find_batch
from autograder.batch.wrong_record import _noisy_numbers
from autograder.course.layout import Course
from autograder.judge.redaction import REDACTED, redact
from autograder.results import result_files
from autograder.results.similar import MAX_PARSED_CHARACTERS, normal_form
from autograder.sandbox.isolation import Limits, MachineError, ProcessLauncher, StudentProcess

PRELAB, LAB = "prelab-sinusoids", "lab-identification"
SECRET = b"the secret of this course"
EMPTY_AND_HUGE = "np.zeros((0, 1 << 31, 1 << 31), np.int8)"


@pytest.fixture(scope="module", autouse=True)
def unchanged_code() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("autograder.batch.fingerprint.sources_hash", lambda *modules: "the same")
        yield


def hand_in(course: Course, folder: Path, student: str, name: str, replaced: Mapping[str, str]) -> None:
    notebook = nbformat.read(course.source / name / f"{name}.ipynb", as_version=4)
    for cell in notebook.cells:
        cell.source = replaced.get(cell.id, cell.source)
    path = folder / student / name / f"{name}.ipynb"
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps(notebook), encoding="utf-8")


def rows_of(out: Path) -> dict[str, list[dict[str, str]]]:
    with (out / "grades.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {student: [row for row in rows if row["student"] == student] for student in {row["student"] for row in rows}}


@dataclass
class Failing:
    """A launcher on a machine that fails for the first `failures` processes."""

    launcher: ProcessLauncher
    failures: int

    @property
    def level(self) -> str:
        return self.launcher.level

    @property
    def limits(self) -> Limits:
        return self.launcher.limits

    def start(self, folder: Path) -> StudentProcess:
        self.failures -= 1
        if self.failures >= 0:
            raise MachineError("the process did not start: No space left on device")
        return self.launcher.start(folder)

    def close(self) -> None: ...


def test_values_that_cannot_be_converted_cost_their_own_question(
    course: Course, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    """With individual records, wrong values are compared with those of others."""
    hand_in(
        course,
        tmp_path / "in",
        "ann",
        LAB,
        {"lab-1c-offsets-answer": f"y_offset = u_offset = y = u = {EMPTY_AND_HUGE}"},
    )
    hand_in(course, tmp_path / "in", "bob", LAB, {})
    batch = find_batch(course, tmp_path / "in")
    list(grade_batch(course, batch, tmp_path / "out", LocalExecutor(launcher, 2), SECRET))
    rows = rows_of(tmp_path / "out")
    assert {row["status"] for row in rows["ann"]} == {"graded", "manual"}
    assert sum(row["score"] not in ("", "0") for row in rows["ann"]) > 5
    assert all(row["score"] == row["max_score"] for row in rows["bob"] if row["status"] != "manual")
    assert _noisy_numbers(np.zeros((0, 1 << 31, 1 << 31), np.int8)).size == 0


def test_deeply_nested_code_beside_right_answers_costs_nothing(
    course: Course, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    """The cells as collected, their lines put back, and the code compared with that of others."""
    solution = nbformat.read(course.source / PRELAB / f"{PRELAB}.ipynb", as_version=4)
    answers = {cell.id: cell.source for cell in solution.cells if cell.id.endswith("-answer")}
    deep = [
        "s = 'a'" + ".strip()" * 300,
        "s = " + " + ".join(f"'{k}'" for k in range(600)),
        "if 0: pass\n" + "".join(f"elif s == {k}: pass\n" for k in range(500)),
        "s = 0x" + "f" * 6000,
    ]
    replaced = {name: "\n".join([source, *deep]) for name, source in answers.items() if "def " not in source}
    assert len(replaced) > 2
    hand_in(course, tmp_path / "in", "ann", PRELAB, replaced)
    list(grade_batch(course, find_batch(course, tmp_path / "in"), tmp_path / "out", LocalExecutor(launcher)))
    rows = rows_of(tmp_path / "out")["ann"]
    assert {row["status"] for row in rows} == {"graded", "manual"}
    assert all(row["score"] == row["max_score"] for row in rows if row["status"] == "graded")


def test_a_hand_in_that_keeps_the_judge_busy_is_quarantined(
    course: Course, launcher: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hand_in(course, tmp_path / "in", "ann", PRELAB, {})
    hand_in(course, tmp_path / "in", "bob", PRELAB, {})
    batch = find_batch(course, tmp_path / "in")
    call = judge_process.JudgeProcess.call

    def busy_with_ann(self, function, *arguments, **settings):  # type: ignore[no-untyped-def]
        if "ann" in arguments:
            return call(self, eval, "sum(iter(int, 1))", cpu_seconds=1)
        return call(self, function, *arguments, **settings)

    with monkeypatch.context() as patch:
        patch.setattr(judge_process.JudgeProcess, "call", busy_with_ann)
        list(grade_batch(course, batch, tmp_path / "out", LocalExecutor(launcher)))
    rows = rows_of(tmp_path / "out")
    assert {row["reason"] for row in rows["ann"]} == {
        "it could not be judged: it takes more than 1 s of processor time"
    }
    assert {row["status"] for row in rows["ann"]} == {"quarantined"}
    assert {row["status"] for row in rows["bob"]} == {"graded", "manual"}
    again = list(grade_batch(course, batch, tmp_path / "out", LocalExecutor(launcher)))
    assert not any(one.fresh for one in again)


def test_a_failure_of_the_machine_is_no_grade(course: Course, launcher: ProcessLauncher, tmp_path: Path) -> None:
    """It is tried again at once, and if that fails in the next run."""
    hand_in(course, tmp_path / "in", "ann", PRELAB, {})
    batch = find_batch(course, tmp_path / "in")
    list(grade_batch(course, batch, tmp_path / "once", LocalExecutor(Failing(launcher, 1))))
    assert {row["status"] for row in rows_of(tmp_path / "once")["ann"]} == {"graded", "manual"}

    out = tmp_path / "out"
    list(grade_batch(course, batch, out, LocalExecutor(Failing(launcher, 99))))
    assert {row["reason"] for row in rows_of(out)["ann"]} == {
        "it could not be judged: the process did not start: No space left on device"
    }
    (stored,) = result_files.load_all(out)
    assert stored.flags == ("could not be judged: the process did not start: No space left on device",)
    assert list(grade_batch(course, batch, out, LocalExecutor(launcher))) == [
        Graded("ann", PRELAB, True, "environment")
    ]
    assert {row["status"] for row in rows_of(out)["ann"]} == {"graded", "manual"}


@pytest.mark.skipif(os.name != "posix", reason="file names are Unicode here")
def test_a_folder_whose_name_is_not_unicode_is_named_and_left_out(course: Course, tmp_path: Path) -> None:
    hand_in(course, tmp_path, "ann", PRELAB, {})
    shutil.copytree(tmp_path / "ann", os.fsdecode(os.fsencode(tmp_path) + b"/b\xf6b"))
    batch = find_batch(course, tmp_path)
    assert (batch.students, batch.ignored) == (("ann",), ("b\\udcf6b",))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no devices here")
def test_links_devices_and_huge_files_are_not_read_for_the_fingerprint(tmp_path: Path) -> None:
    before = submission_hash(tmp_path, ".mat")
    (tmp_path / "zero.ipynb").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe.ipynb")
    with (tmp_path / "sparse.mat").open("wb") as file:
        file.truncate(1 << 40)
    after = submission_hash(tmp_path, ".mat")
    assert after == submission_hash(tmp_path, ".mat") != before


def test_long_code_is_compared_as_text() -> None:
    source = "x;" * MAX_PARSED_CHARACTERS
    assert normal_form(source) == (source, 1)
    assert normal_form("x = 1")[0] == normal_form("y = 1")[0]


def test_texts_are_looked_for_within_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each search of a long notebook takes milliseconds, and a list holds millions of texts."""
    source = "kept" + "a" * 996
    monkeypatch.setattr("autograder.judge.redaction.MAX_SEARCHED_CHARACTERS", 3 * len(source))
    seen = redact(("a" * 201, "kept", "other", "kept", "kept"), source)
    assert isinstance(seen, tuple)
    assert [repr(text) for text in seen[1:]] == ["'kept'", f"'{REDACTED}'", "'kept'", f"'{REDACTED}'"]


def test_a_class_graded_with_a_secret_is_not_graded_again_without_it(
    course: Course, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    """Everybody would be graded on another record, without a word."""
    hand_in(course, tmp_path / "in", "ann", LAB, {})
    batch, out = find_batch(course, tmp_path / "in"), tmp_path / "out"
    list(grade_batch(course, batch, out, LocalExecutor(launcher), SECRET))
    before = (out / "grades.csv").read_bytes()
    for secret in (None, b"the secret of another course"):
        with pytest.raises(ValueError, match=r"was graded with --secret.* Run: labsid course grade .* --secret FILE"):
            list(grade_batch(course, batch, out, LocalExecutor(launcher), secret))
    assert (out / "grades.csv").read_bytes() == before
    assert not any(one.fresh for one in grade_batch(course, batch, out, LocalExecutor(launcher), SECRET))
    assert SECRET.decode() not in (out / ".secret").read_text(encoding="ascii")


def test_shapes_and_texts_tell_no_hidden_numbers(course: Course, launcher: ProcessLauncher, tmp_path: Path) -> None:
    """The function gets hidden inputs, and the feedback quotes the shape of what it returns."""
    code = "def cut_off(data, n):\n    return np.zeros((1_234_567 + int(1e5 * abs(data[1, 1])), 2), np.int8)"
    hand_in(course, tmp_path / "in", "ann", PRELAB, {"prelab-4-function-answer": code})
    batch = find_batch(course, tmp_path / "in")
    list(grade_batch(course, batch, tmp_path / "out", LocalExecutor(launcher)))
    (row,) = [row for row in rows_of(tmp_path / "out")["ann"] if row["question"] == "prelab-4-function"]
    assert row["score"] == "0"
    assert f"shape ({REDACTED}, 2)" in row["reason"]


def test_what_cannot_be_compared_with_others_keeps_its_marks(
    course: Course, launcher: ProcessLauncher, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hand_in(course, tmp_path / "in", "ann", PRELAB, {})
    call = judge_process.JudgeProcess.call

    def broken(self, function, *arguments, **settings):  # type: ignore[no-untyped-def]
        if function is compare_with_others:
            return call(self, eval, "1 / 0")
        return call(self, function, *arguments, **settings)

    monkeypatch.setattr(judge_process.JudgeProcess, "call", broken)
    list(grade_batch(course, find_batch(course, tmp_path / "in"), tmp_path / "out", LocalExecutor(launcher)))
    rows = rows_of(tmp_path / "out")["ann"]
    assert all(row["score"] == row["max_score"] for row in rows if row["status"] == "graded")
    kept = json.loads((tmp_path / "out" / "results" / "ann" / f"{PRELAB}.json").read_text(encoding="utf-8"))
    assert kept["flags"] == ["not compared with the others: it stops with ZeroDivisionError"]
