"""The release as a student lives with it: one wheel with every command, a start page, and texts that are true."""

import io
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from autograder.course.layout import RECORD_FILE, Course
from autograder.course.release import release_files, write_individual_release, write_release
from labsid.checks.permitted import RULE
from labsid.checks.time_limit import CELL_SECONDS
from labsid.checks.timetable import HOURS

ROOT = Path(__file__).resolve().parents[3]
PRELAB, LAB = "prelab-sinusoids", "lab-identification"
SECRET = b"a secret of the tests"


@pytest.fixture(scope="module")
def complete(course: Course, tmp_path_factory: pytest.TempPathFactory) -> Course:
    """The course with the project's own description beside it, as a checkout has."""
    root = tmp_path_factory.mktemp("checkout") / "course"
    shutil.copytree(course.root, root)
    shutil.copyfile(ROOT / "pyproject.toml", root / "pyproject.toml")
    return Course(root)


@pytest.fixture(scope="module")
def shared(complete: Course, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The files of the release with shared data and one due date."""
    path = tmp_path_factory.mktemp("release") / "release.zip"
    write_release(complete, path, due={LAB: "Monday, 30 November, 23:59"})
    return contents(path.read_bytes())


@pytest.fixture(scope="module")
def individual(complete: Course, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The files for everybody of the release with individual data."""
    path = tmp_path_factory.mktemp("release") / "release.zip"
    write_individual_release(complete, path, SECRET, ["ann"])
    return contents(path.read_bytes())


def contents(archive: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(archive)) as opened:
        return {name: opened.read(name) for name in opened.namelist()}


def wheel_of(release: dict[str, bytes]) -> dict[str, bytes]:
    (name,) = (name for name in release if name.endswith(".whl"))
    return contents(release[name])


def pages(release: dict[str, bytes]) -> list[str]:
    """The texts of the start page and of README.md."""
    cells = json.loads(release["start.ipynb"])["cells"]
    start = "\n\n".join("".join(cell["source"]) for cell in cells)
    return [start, release["README.md"].decode()]


def test_the_start_page_lists_the_assignments_in_order(course: Course, shared: dict[str, bytes]) -> None:
    for page in pages(shared):
        rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| ") and "ipynb" in line]
        assert [row[1].split("](")[1] for row in rows] == [f"{name}/{name}.ipynb)" for name in course.assignments()]
        assert [row[2] for row in rows] == [f"{HOURS[name]:g}" for name in course.assignments()]
        assert [row[3] for row in rows] == ["1", "2", "1", "1", "1", "1", "1", "1", "1", "2", "1"]
        assert rows[1][4] == "Monday, 30 November, 23:59 |"
        assert "labsid submit" in page
        assert RULE.format(seconds=CELL_SECONDS) in page
        assert "check.skip(" in page
        assert "It is off until you turn it on, and nothing depends on it" in " ".join(page.split())


def test_every_assignment_has_its_hours_and_the_guide_says_the_same(course: Course) -> None:
    assert list(HOURS) == course.assignments()
    guide = (ROOT / "notebooks" / "README.md").read_text(encoding="utf-8")
    for name, hours in HOURS.items():
        (row,) = (line for line in guide.splitlines() if line.startswith("|") and f"`{name}`" in line)
        assert row.split("|")[4].split(",")[0].strip() == f"{hours:g}"


def test_no_text_speaks_of_data_that_are_not_there(shared: dict[str, bytes], individual: dict[str, bytes]) -> None:
    assert f"{LAB}/{RECORD_FILE}" in shared
    assert f"labsid/release/{LAB}/{RECORD_FILE}" in wheel_of(shared)
    assert all("are beside the notebooks" in page for page in pages(shared))
    assert not any(name.endswith((".mat", ".csv")) for name in (*individual, *wheel_of(individual)))
    for page in pages(individual):
        assert "are beside the notebooks" not in page
        assert "Your own data come separately" in page
        assert f"`{LAB}/{RECORD_FILE}`" in page
        assert "due" not in next(line for line in page.splitlines() if line.startswith("|  | assignment"))


def test_the_wheel_has_the_release_and_no_solution(course: Course, shared: dict[str, bytes]) -> None:
    wheel = wheel_of(shared)
    for name in course.assignments():
        assert wheel[f"labsid/release/{name}/{name}.ipynb"] == shared[f"{name}/{name}.ipynb"]
    assert wheel["labsid/release/start.ipynb"] == shared["start.ipynb"]
    assert not any(b"BEGIN SOLUTION" in content for name, content in wheel.items() if name.endswith(".ipynb"))


@pytest.mark.slow
def test_a_student_works_with_the_wheel_alone(shared: dict[str, bytes], tmp_path: Path) -> None:
    """Every command of a student, from the wheel, in a folder of its own and without the autograder."""
    for name, content in wheel_of(shared).items():
        (tmp_path / "site" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "site" / name).write_bytes(content)
    here = tmp_path / "here"
    here.mkdir()
    program = (
        "import sys\n"
        "sys.modules['autograder'] = sys.modules['nbgrader'] = None\n"
        "import labsid\n"
        "from labsid.cli.commands import main\n"
        "sys.exit(main())\n"
    )

    def labsid(*arguments: str) -> str:
        environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
        done = subprocess.run(
            [sys.executable, "-c", program, *arguments], cwd=here, env=environment, capture_output=True, text=True
        )
        return done.stdout + done.stderr

    assert f"{LAB}: new: {RECORD_FILE}, {LAB}.ipynb" in labsid("lab", "--no-open")
    work = here / "labsid-work"
    assert (work / "start.ipynb").read_bytes() == shared["start.ipynb"]
    assert "there is nothing to hand in" in labsid("submit")
    path = work / PRELAB / f"{PRELAB}.ipynb"
    notebook = json.loads(path.read_text(encoding="utf-8"))
    answer = next(cell for cell in notebook["cells"] if cell["id"] == "prelab-1-time-answer")
    answer["source"] = ["t = np.linspace(0, 100, 1001).reshape(-1, 1)"]
    path.write_text(json.dumps(notebook), encoding="utf-8")
    shown = labsid("submit", "--yes")
    assert "Total: 0.1 of 1 marks; 0.05 of them are given by hand" in shown
    assert "Left out, because they are as they were released: lab-identification, postlab-model-order" in shown
    assert shown.splitlines()[-1] == "Hand in this file: hand-in.zip (prelab-sinusoids)"
    assert contents((here / "hand-in.zip").read_bytes()).keys() == {f"{PRELAB}/{PRELAB}.ipynb"}
    record = str(work / LAB / RECORD_FILE)
    assert "903 samples" in labsid("check", record)
    assert "theta" in labsid("identify", record).lower() or "a1" in labsid("identify", record)
    assert "diagnose" in labsid("gap", "--help")


def test_the_start_page_has_the_title_of_the_course(complete: Course) -> None:
    for title, heading in (("Identification II", "Identification II"), ("", "System identification")):
        (complete.root / "course.toml").write_text(f'title = "{title}"\n' if title else "", encoding="utf-8")
        files = release_files(complete, [LAB])
        for page in ("README.md", "start.ipynb"):
            assert f"# {heading}: start here" in files[page].decode()
    (complete.root / "course.toml").unlink()
