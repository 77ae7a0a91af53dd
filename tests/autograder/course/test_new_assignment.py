"""A new assignment: what the command writes can be built, released, solved and graded as it is."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import jupytext
import pytest

from autograder.course.layout import Course
from autograder.course.lint import lint_metadata
from autograder.course.new_assignment import MAX_NAME_CHARACTERS, write_new_assignment

ROOT = Path(__file__).resolve().parents[3]
NAME = "pid-control"
GAIN, RESPONSE = f"{NAME}-1-gain", f"{NAME}-2-response"
DECAY = "def step_response(t, K, tau):\n    return K * np.exp(-t / tau)"
GUIDE = (ROOT / "notebooks" / "README.md").read_text(encoding="utf-8").partition("## A new assignment")[2]
NEW, BUILD, PREVIEW, TRY, GRADE = (line.split() for line in re.findall(r"^    labsid (.+)$", GUIDE, re.MULTILINE))
Labsid = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def empty(tmp_path: Path) -> Course:
    """A checkout without assignments."""
    for folder in ("notebooks", "autograder", "labsid/checks/assignments"):
        (tmp_path / folder).mkdir(parents=True)
    return Course(tmp_path)


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of this checkout, with its code, compiled as it is here, and without its assignments."""
    root = tmp_path_factory.mktemp("checkout") / "course"
    for package in ("labsid", "autograder"):
        unwanted = shutil.ignore_patterns("*.pyc.*", "*.tmp.*", "source", "release", "course-secret", *(
            ["data"] if package == "autograder" else []
        ))  # fmt: skip
        shutil.copytree(ROOT / package, root / package, ignore=unwanted)
    shutil.copytree(ROOT / "data", root / "data")
    shutil.copyfile(ROOT / "pyproject.toml", root / "pyproject.toml")
    (root / "notebooks").mkdir()
    return root


@pytest.fixture(scope="module")
def labsid(checkout: Path) -> Labsid:
    """Run the command of that copy."""

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        program = "import sys; from labsid.cli.commands import main; sys.exit(main())"
        return subprocess.run(
            [sys.executable, "-P", "-c", program, *arguments],
            cwd=checkout.parent,
            env={**os.environ, "PYTHONPATH": str(checkout), "TMPDIR": str(checkout.parent)},
            capture_output=True,
            text=True,
            timeout=300,
        )

    return run


@pytest.fixture(scope="module")
def built(checkout: Path, labsid: Labsid) -> Path:
    """The copy with a new assignment, built."""
    done = labsid(*NEW)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == (
        f"Next: labsid course build, then labsid course preview --assignment {NAME}"
    )
    done = labsid(*BUILD)
    assert (done.returncode, done.stdout.splitlines()[1]) == (0, f"Built 1 assignments: {NAME}."), done.stderr
    return checkout


def write_hand_in(course: Path, folder: Path, answers: dict[str, str]) -> None:
    """The released notebook with these answers, by the id of their question."""
    notebook = json.loads((course / "autograder" / "release" / NAME / f"{NAME}.ipynb").read_text(encoding="utf-8"))
    for question, text in answers.items():
        (cell,) = (cell for cell in notebook["cells"] if cell["id"] == f"{question}-answer")
        cell["source"] = text
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{NAME}.ipynb").write_text(json.dumps(notebook), encoding="utf-8")


def solution(course: Path) -> dict[str, str]:
    """The model answers."""
    notebook = json.loads((course / "autograder" / "source" / NAME / f"{NAME}.ipynb").read_text(encoding="utf-8"))
    texts = {cell["id"]: "".join(cell["source"]) for cell in notebook["cells"]}
    return {question: texts[f"{question}-answer"] for question in (GAIN, RESPONSE)}


@pytest.mark.slow
def test_a_new_assignment_is_graded_as_it_is(built: Path, labsid: Labsid, tmp_path: Path) -> None:
    submitted, out = tmp_path / "submitted", tmp_path / "out"
    write_hand_in(built, submitted / "ada" / NAME, solution(built))
    write_hand_in(built, submitted / "ben" / NAME, {GAIN: "K = 2 / 1.2", RESPONSE: DECAY})
    write_hand_in(built, submitted / "cem" / NAME, {GAIN: "K = 5", RESPONSE: "def step_response(t, K, tau):\n    pass"})
    done = labsid("course", "grade", "--submitted", str(submitted), "--out", str(out))
    assert done.returncode == 0, done.stderr
    with (out / "grades.csv").open(encoding="utf-8", newline="") as file:
        rows = {(row["student"], row["question"]): row for row in csv.DictReader(file)}
    assert {key: row["score"] for key, row in rows.items()} == {
        ("ada", GAIN): "0.4", ("ada", RESPONSE): "0.6",
        ("ben", GAIN): "0", ("ben", RESPONSE): "0",
        ("cem", GAIN): "0", ("cem", RESPONSE): "0",
    }  # fmt: skip
    assert "turn the fraction upside down" in rows["ben", GAIN]["reason"]
    assert "it is 1 minus the exponential" in rows["ben", RESPONSE]["reason"]
    assert rows["cem", GAIN]["reason"] == "`K` is not the gain: see the equation of step 1."
    assert "`step_response` returns nothing" in rows["cem", RESPONSE]["reason"]


@pytest.mark.exhaustive
def test_the_guide_can_be_followed_as_printed(built: Path, labsid: Labsid) -> None:
    """But for JupyterLab, which is not opened. The other tests run most of these commands."""
    for preview in (PREVIEW, TRY):
        done = labsid(*preview, "--no-open")
        assert done.returncode == 0, done.stderr
    assert (NEW[-1], PREVIEW[-1]) == (NAME, NAME)
    write_hand_in(built, built.parent / "hand-ins" / "try-1" / NAME, solution(built))
    done = labsid(*GRADE)
    assert done.returncode == 0, done.stderr
    assert f"try-1,{NAME},{GAIN},0.4,0.4,graded" in (built.parent / "OUT" / "grades.csv").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_student_sees_the_new_assignment_in_the_preview(built: Path, labsid: Labsid, tmp_path: Path) -> None:
    """And its checks say in the notebook what grading says."""
    work = tmp_path / "work"
    done = labsid("course", "preview", "--assignment", NAME, "--no-open", "--folder", str(work))
    assert done.returncode == 0, done.stderr
    assert f"| 1 | [Pid control]({NAME}/{NAME}.ipynb) |  | 1 |" in (work / "README.md").read_text(encoding="utf-8")
    assert "BEGIN SOLUTION" not in (work / NAME / f"{NAME}.ipynb").read_text(encoding="utf-8")
    for answers, said in (
        (solution(built), "Total: 1 of 1 marks"),
        ({GAIN: "K = 1.6 / 3", RESPONSE: DECAY}, "`K` is a level divided by a level"),
    ):
        write_hand_in(built, work / NAME, answers)
        shown = labsid("submit", "--folder", str(work), "--yes", "--out", str(tmp_path / "hand-in.zip")).stdout
        assert said in " ".join(shown.split()), shown


@pytest.mark.slow
def test_a_second_one_of_the_same_name_is_refused(built: Path, labsid: Labsid) -> None:
    done = labsid("course", "new", NAME)
    assert done.returncode == 2
    *_, line = done.stderr.splitlines()
    assert line.startswith(f"labsid: error: there is an assignment '{NAME}' already (")


@pytest.mark.slow
def test_the_build_says_what_to_write_for_a_question_and_a_check(built: Path, labsid: Labsid, tmp_path: Path) -> None:
    notebook = built / "notebooks" / NAME / f"{NAME}.md"
    checks = built / "labsid" / "checks" / "assignments" / "pid_control" / "__init__.py"
    kept = {path: path.read_text(encoding="utf-8") for path in (notebook, checks)}
    file = "labsid/checks/assignments/pid_control/__init__.py"
    try:
        notebook.write_text(kept[notebook].replace(RESPONSE, f"{NAME}-2-step"), encoding="utf-8")
        *_, line = labsid("course", "build").stderr.splitlines()
        assert f'Write Question("{NAME}-2-step", judge), with a function judge(ask) that returns a Verdict: ' in line
        assert f"add it to the questions of ASSIGNMENT in {file};" in line
        assert f'{{grade_id: {RESPONSE}, points: 1}} with check("{RESPONSE}") in notebooks/{NAME}/{NAME}.md' in line
        checks.write_text(kept[checks] + "\n)", encoding="utf-8")
        *_, line = labsid("course", "build").stderr.splitlines()
        assert f"{file} cannot be imported: SyntaxError: unmatched ')'" in line
    finally:
        for path, text in kept.items():
            path.write_text(text, encoding="utf-8")


def test_what_is_written_has_the_style_of_the_project(empty: Course) -> None:
    shutil.copyfile(ROOT / "pyproject.toml", empty.root / "pyproject.toml")
    for package in ("labsid", "labsid/checks", "labsid/checks/assignments"):
        (empty.root / package / "__init__.py").touch()
    written = write_new_assignment(empty, "a" * MAX_NAME_CHARACTERS)
    assert all(path.is_file() for path in written)
    for command in (["check"], ["format", "--check", "--diff"]):
        ran = [sys.executable, "-m", "ruff", *command, "--no-cache", str(empty.root)]
        done = subprocess.run(ran, cwd=empty.root, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


def test_a_new_assignment_comes_last(empty: Course) -> None:
    for name in ("lab-identification", "prelab-sinusoids"):
        (empty.notebooks / name).mkdir()
        (empty.notebooks / name / f"{name}.md").touch()
    write_new_assignment(empty, "basics")
    assert empty.assignments() == ["prelab-sinusoids", "lab-identification", "basics"]


@pytest.mark.parametrize(
    "name",
    [
        "",
        "Lab",
        "my_lab",
        "my lab",
        "-lab",
        "lab-",
        "a--b",
        "2nd-lab",
        "läb",
        "../lab",
        "a/b",
        "class",
        "a" * 41,
        "a\n",
    ],
)
def test_a_name_that_is_none_is_refused(empty: Course, name: str) -> None:
    with pytest.raises(ValueError, match="cannot be the name of an assignment"):
        write_new_assignment(empty, name)
    assert list(empty.notebooks.iterdir()) == []


@pytest.mark.parametrize("taken", ["notebooks/pid-control", "labsid/checks/assignments/pid_control"])
def test_a_name_that_is_taken_is_refused(empty: Course, taken: str) -> None:
    (empty.root / taken).mkdir()
    with pytest.raises(ValueError, match=rf"already \({empty.root / taken} exists\)\. Choose another name"):
        write_new_assignment(empty, NAME)
    assert len(list((empty.root / taken).parent.iterdir())) == 1


def test_a_course_without_labsid_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="Run this command in a checkout"):
        write_new_assignment(Course(tmp_path), NAME)


def test_ids_of_the_longest_name_can_be_grade_ids(empty: Course) -> None:
    notebook, *_ = write_new_assignment(empty, "a" * MAX_NAME_CHARACTERS)
    cells = jupytext.read(notebook, fmt="md:myst").cells
    assert len([cell for cell in cells if "nbgrader" in cell.metadata]) == 7
    assert [problem for cell in cells for problem in lint_metadata(cell)] == []
