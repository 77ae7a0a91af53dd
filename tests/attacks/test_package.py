"""The package that leaves the house: run in a bare place without the course, on honest and on hostile hand-ins."""

import io
import json
import re
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from course_work import ROOT, copy_course, read_solved
from own_rigs import OF_THE_MOTOR, motor_log, rig_course, write_csv

import autograder
from autograder.course.build import build_course
from autograder.course.layout import RECORD_FILE, Course
from autograder.course.own_secret import make_own_secret, shared_file
from autograder.export.autograder_package import write_package
from autograder.sandbox.bubblewrap import find_bubblewrap
from autograder.sandbox.isolation import probe_levels
from labsid.lab.identification import identify
from labsid.records.reading import Reading
from labsid.records.record import read_record

NAME = "prelab-sinusoids"

pytestmark = pytest.mark.skipif(
    all(level.problem for level in probe_levels() if level.name == "namespaces"), reason="no container can be made"
)


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    built = copy_course(tmp_path_factory.mktemp("course"), NAME, "lab-identification")
    shutil.copyfile(ROOT / "pyproject.toml", built.root / "pyproject.toml")
    make_own_secret(built)
    list(build_course(built))
    return built


@pytest.fixture(scope="module")
def package(course: Course, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package for Gradescope, unpacked, with the wheel unpacked in ``site``."""
    return unpacked(course, NAME, tmp_path_factory.mktemp("package"))


def unpacked(course: Course, name: str, folder: Path) -> Path:
    """The package of an assignment in a folder, with its wheel unpacked."""
    write_package(course, folder / "p.zip", "gradescope", name)
    with zipfile.ZipFile(folder / "p.zip") as archive:
        archive.extractall(folder / "source")
        modes = {info.filename: info.external_attr >> 16 for info in archive.infolist()}
    assert [name for name, mode in modes.items() if mode & 0o100] == ["run_autograder", "setup.sh"]
    (wheel,) = (folder / "source").glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder


def solved(course: Course, replaced: Mapping[str, str] = {}, added: Mapping[str, str] = {}, name: str = NAME) -> bytes:
    """The model solution with some cells replaced, and others added after cells."""
    _, texts = read_solved(course, name)
    notebook = json.loads((course.release / name / f"{name}.ipynb").read_bytes())
    cells = []
    for cell in notebook["cells"]:
        cell["source"] = replaced.get(cell["id"], texts.get(cell["id"], "".join(cell["source"])))
        cells.append(cell)
        if (source := added.get(cell["id"])) is not None:
            cells.append({"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None, "source": source,
                          "id": f"after-{cell['id']}"})  # fmt: skip
    return json.dumps({**notebook, "cells": cells}).encode()


def run(package: Path, folder: Path, hand_in: Mapping[str, bytes]) -> dict[str, Any]:
    """Run the package in a place that has neither the checkout nor the course, as a user who is not root."""
    submission, results = folder / "submission", folder / "results"
    results.mkdir()
    for name, content in hand_in.items():
        (submission / name).parent.mkdir(parents=True, exist_ok=True)
        (submission / name).write_bytes(content)
    packages = sysconfig.get_paths()["purelib"]
    home = Path(autograder.__file__).parents[1]
    hidden = {one for base in {ROOT, home, *_roots_of_labsid()} for one in base.iterdir() if one.name != ".venv"}
    inside = {package / "source": "/autograder/source", package / "site": "/autograder/site",
              submission: "/autograder/submission"}  # fmt: skip
    line = [find_bubblewrap(), "--unshare-all", "--die-with-parent", "--uid", "1000", "--gid", "1000"]
    line += [word for one in ("/usr", "/etc", "/lib", "/lib64", "/bin", "/opt") for word in _bound(Path(one))]
    line += ["--proc", "/proc", "--dev", "/dev", "--tmpfs", "/tmp", "--dir", "/autograder"]
    for base in {Path(sys.prefix), Path(sys.base_prefix), Path(sys.executable).resolve().parents[1]}:
        line += _bound(base)
    for one in hidden:
        line += ["--tmpfs", str(one)] if one.is_dir() and _is_bound(one) else []
    for source, target in inside.items():
        line += ["--ro-bind", str(source), target]
    line += ["--bind", str(results), "/autograder/results", "--clearenv", "--setenv", "PATH", "/usr/bin:/bin"]
    line += ["--setenv", "PYTHONPATH", f"/autograder/site:{packages}", "--chdir", "/autograder"]
    script = ["/autograder/source/grade.py", "--submission", "/autograder/submission"]
    done = subprocess.run(
        [*line, sys.executable, "-B", *script, "--results", "/autograder/results/results.json"],
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    found: dict[str, Any] = json.loads((results / "results.json").read_text(encoding="utf-8"))
    return found


def _bound(path: Path) -> list[str]:
    return ["--ro-bind", str(path), str(path)] if path.exists() else []


def _is_bound(path: Path) -> bool:
    return any(base in path.parents for base in (Path(sys.prefix), Path("/usr"), Path("/opt")))


def _roots_of_labsid() -> set[Path]:
    """Where the labsid of this environment is, which the package must not need."""
    import labsid

    return {Path(labsid.__file__).parents[1]}


def scores(result: Mapping[str, Any]) -> dict[str, float | None]:
    return {test["name"].partition(":")[0]: test.get("score") for test in result["tests"]}


def wanted(course: Course) -> dict[str, float]:
    template, _ = read_solved(course, NAME)
    return {cell.id: float(cell.points or 0) for cell in template.questions if cell.kind == "question"}


def test_the_model_solution_has_all_marks_that_checks_can_give(course: Course, package: Path, tmp_path: Path) -> None:
    result = run(package, tmp_path, {f"{NAME}/{NAME}.ipynb": solved(course)})
    found = scores(result)
    assert {name: score for name, score in found.items() if score is not None} == wanted(course)
    assert {test["name"].partition(":")[0] for test in result["tests"] if "max_score" not in test} == {
        name for name, score in found.items() if score is None
    }
    assert "no proof of who wrote the answer" in result["output"]
    assert {test["visibility"] for test in result["tests"]} == {"visible"}


def test_a_wrong_answer_costs_its_own_marks_and_no_answer_is_told(
    course: Course, package: Path, tmp_path: Path
) -> None:
    """After the wrong step the notebook goes on from the reference's values, which a cell tries to tell."""
    telling = "raise ValueError('sT' + 'olen', repr(list(t_new[:3])), float(t_new[7]))"
    notebook = solved(
        course,
        {"prelab-3-cut-answer": "t_new, y_1_new = t, y_1", "prelab-4-function-answer": telling},
        {"prelab-3-cut": telling},
    )
    result = run(package, tmp_path, {"work.ipynb": notebook})
    found = scores(result)
    assert found["prelab-3-cut"] == 0
    assert found["prelab-4-function"] == 0
    text = json.dumps(result)
    assert "sTolen" not in text
    kept = {name: score for name, score in found.items() if name in ("prelab-1-time", "prelab-2-noise")}
    assert kept == {name: wanted(course)[name] for name in kept}


HOSTILE = {
    "outcome displayed": "from IPython.display import publish_display_data\n"
    "publish_display_data({'text/plain': 'x'}, metadata={'labsid': {'question': 'prelab-3-cut', 'state': 'right'}})",
    "check replaced": "check = lambda *_: None",
    "results written": "open('/autograder/results/results.json', 'w').write('{\"score\": 99}')",
    "process ended": "import os\nos._exit(0)",
    "package read": "import glob, os\n"
    "raise ValueError([p for p in glob.glob('/autograder/**', recursive=True) if 'secret' in p or 'solution' in p])",
}


@pytest.mark.parametrize("attack", HOSTILE)
def test_a_hostile_hand_in_gets_nothing_for_a_wrong_answer(
    attack: str, course: Course, package: Path, tmp_path: Path
) -> None:
    wrong = {"prelab-3-cut-answer": f"t_new, y_1_new = t, y_1\n{HOSTILE[attack]}"}
    result = run(package, tmp_path, {f"{NAME}.ipynb": solved(course, wrong)})
    assert scores(result)["prelab-3-cut"] == 0
    assert result.get("score") is None


@pytest.mark.parametrize(
    ("hand_in", "said"),
    [
        ({"essay.pdf": b"%PDF"}, f"{NAME}.ipynb was not handed in."),
        ({f"{NAME}.ipynb": b"{"}, "is not a readable notebook (JSONDecodeError)"),
        ({f"{NAME}.ipynb": b'{"nbformat": 4, "cells": []}'}, "contains no cell of the assignment"),
    ],
)
def test_what_cannot_be_run_is_one_line(hand_in: dict[str, bytes], said: str, package: Path, tmp_path: Path) -> None:
    result = run(package, tmp_path, hand_in)
    assert result["score"] == 0
    assert said in result["output"]
    assert "\n" not in result["output"]


def everything_in(content: bytes) -> dict[str, bytes]:
    """The files of a zip file, and of zip files and wheels in it."""
    found: dict[str, bytes] = {}
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        for name in archive.namelist():
            data = archive.read(name)
            found[name] = data
            if name.endswith((".whl", ".zip")):
                found |= {f"{name}/{inner}": inside for inner, inside in everything_in(data).items()}
    return found


def test_a_package_about_your_own_rig_has_its_record_and_knows_typed_values(
    tmp_path_factory: pytest.TempPathFactory, tmp_path: Path
) -> None:
    """The second record of the package is one of that rig, so that a value of the first is wrong on it."""
    lab, folder = "lab-identification", tmp_path_factory.mktemp("motor")
    shutil.copyfile(ROOT / "pyproject.toml", folder / "pyproject.toml")
    own = rig_course(folder, write_csv(folder / "motor.csv", motor_log()), OF_THE_MOTOR, lab)
    package = unpacked(own, lab, tmp_path_factory.mktemp("package"))
    data = package / "source" / "data" / RECORD_FILE
    assert data.read_bytes() == shared_file(own, RECORD_FILE).read_bytes() != (own.data / RECORD_FILE).read_bytes()
    theta = identify(read_record(data, Reading())).fit.theta.tolist()
    typed = {"lab-2b-theta-answer": f"theta_hat = np.array({theta})"}
    results = {}
    for case, replaced in {"solved": {}, "typed": typed}.items():
        (tmp_path / case).mkdir()
        found = scores(run(package, tmp_path / case, {f"{lab}.ipynb": solved(own, replaced, name=lab)}))
        results[case] = {name for name, score in found.items() if score == 0}
    assert results == {"solved": set(), "typed": {"lab-2b-theta"}}


@pytest.mark.parametrize("system", ["gradescope", "github"])
@pytest.mark.parametrize("name", [NAME, "lab-identification"])
def test_a_package_has_no_answer_and_no_secret(system: str, name: str, course: Course, tmp_path: Path) -> None:
    write_package(course, tmp_path / "p.zip", system, name)
    files = everything_in((tmp_path / "p.zip").read_bytes())
    template, texts = read_solved(course, name)
    own = {cell.id for cell in template.cells if cell.kind in ("answer", "manual")}
    released = {cell.id: cell.source for cell in template.cells}
    answers = {text.strip().encode() for key, text in texts.items() if key in own and text != released[key]}
    telling = [answer for answer in answers if len(answer) > 40]
    assert len(telling) > 3
    secret = course.secret_file.read_bytes().strip()
    for path, content in files.items():
        assert secret not in content, path
        assert [answer for answer in telling if answer in content] == [], path
        assert b"BEGIN SOLUTION" not in content, path
        assert not re.search(r"(^|/)(autograder|source)/|students|secret|gradebook", path), path
    write_package(course, tmp_path / "again.zip", system, name)
    assert (tmp_path / "again.zip").read_bytes() == (tmp_path / "p.zip").read_bytes()


def test_individual_data_stay_outside(course: Course, tmp_path: Path) -> None:
    write_package(course, tmp_path / "p.zip", "gradescope", "lab-identification", is_individual=True)
    assert not any(path.startswith("data/") for path in everything_in((tmp_path / "p.zip").read_bytes()))


def test_what_cannot_be_packed_is_refused(course: Course, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="expected gradescope or github"):
        write_package(course, tmp_path / "p.zip", "canvas", NAME)
    with pytest.raises(ValueError, match="there is no assignment 'x'"):
        write_package(course, tmp_path / "p.zip", "github", "x")
    assert not (tmp_path / "p.zip").exists()
