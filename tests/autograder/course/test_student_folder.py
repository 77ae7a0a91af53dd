"""What a student does around the notebooks: get them without losing work, and hand them in."""

import json
import shutil
import zipfile
from pathlib import Path

import pytest

from autograder.course.layout import RECORD_FILE, Course, read_template
from autograder.course.student_folder import copy_release, pack_submission
from labsid.checks.notebook import load_assignment

PRELAB, LAB = "prelab-sinusoids", "lab-identification"


@pytest.fixture
def work(course: Course, tmp_path: Path) -> Path:
    """A work folder with two assignments as they are released."""
    for name in (PRELAB, LAB):
        shutil.copytree(course.release / name, tmp_path / "work" / name)
    return tmp_path / "work"


def answer(path: Path, **answers: str) -> None:
    """Write answers into a notebook, as Jupyter would."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        text = answers.get(cell["id"].replace("-", "_"))
        if text is not None:
            cell["source"] = text.splitlines(keepends=True)
    path.write_text(json.dumps(notebook), encoding="utf-8")


def test_the_release_is_copied_whole(course: Course, tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "work"
    lines = list(copy_release(course, folder))
    assert [line.split(":")[0] for line in lines] == course.assignments()
    for name in course.assignments():
        there = {path.name for path in (folder / name).iterdir()}
        assert there == {f"{name}.ipynb", load_assignment(name).record_file} - {None}
        for file in there:
            assert (folder / name / file).read_bytes() == (course.release / name / file).read_bytes()
    assert lines[:2] == [f"{PRELAB}: new: {PRELAB}.ipynb", f"{LAB}: new: {RECORD_FILE}, {LAB}.ipynb"]


def test_work_is_never_overwritten(course: Course, work: Path) -> None:
    mine = work / PRELAB / f"{PRELAB}.ipynb"
    mine.write_text("my work", encoding="utf-8")
    (work / LAB / f"{LAB}.ipynb").unlink()
    lines = {line.split(":")[0]: line for line in copy_release(course, work)}
    assert mine.read_text(encoding="utf-8") == "my work"
    assert lines[PRELAB] == f"{PRELAB}: kept: {PRELAB}.ipynb"
    assert lines[LAB] == f"{LAB}: new: {LAB}.ipynb; kept: {RECORD_FILE}"
    again = list(copy_release(course, work))
    assert not any("new" in line for line in again)


def test_what_jupyter_left_in_the_release_is_not_copied(course: Course, tmp_path: Path) -> None:
    shutil.copytree(course.root, tmp_path / "course")
    opened = Course(tmp_path / "course")
    (opened.release / PRELAB / ".ipynb_checkpoints").mkdir()
    list(copy_release(opened, tmp_path / "work"))
    assert not (tmp_path / "work" / PRELAB / ".ipynb_checkpoints").exists()


def test_a_course_that_is_not_built_is_built_first(course: Course, tmp_path: Path) -> None:
    fresh = Course(tmp_path / "course")
    shutil.copytree(course.notebooks / PRELAB, fresh.notebooks / PRELAB)
    (fresh.root / "autograder").mkdir()
    lines = list(copy_release(fresh, tmp_path / "work"))
    assert lines == ["Building the notebooks (once) ...", f"{PRELAB}: new: {PRELAB}.ipynb"]


def test_a_file_in_the_place_of_the_work_folder_is_said(course: Course, tmp_path: Path) -> None:
    (tmp_path / "work").touch()
    with pytest.raises(ValueError, match="is a file; give --folder another name"):
        list(copy_release(course, tmp_path / "work"))


def test_what_is_still_open_is_said(course: Course, work: Path, tmp_path: Path) -> None:
    cells = [cell for cell in read_template(course, PRELAB).cells if cell.kind in ("answer", "manual")]
    ids = [cell.id for cell in cells]
    answer(work / PRELAB / f"{PRELAB}.ipynb", prelab_1_time_answer="t = 1  # Your code here\nprint(...)")
    lines = list(pack_submission(work, tmp_path / "hand-in.zip"))
    assert [line.split(":")[0] for line in lines] == [LAB, PRELAB, "Hand in this file"]
    open_ones = ", ".join(one for one in ids if one != "prelab-1-time-answer")
    assert lines[1] == f"{PRELAB}: 1 of {len(ids)} questions answered; not answered: {open_ones}"

    answer(work / PRELAB / f"{PRELAB}.ipynb", **{one.replace("-", "_"): "done" for one in ids})
    assert list(pack_submission(work, tmp_path / "hand-in.zip"))[1] == f"{PRELAB}: all {len(ids)} questions answered"
    answer(work / PRELAB / f"{PRELAB}.ipynb", **{ids[0].replace("-", "_"): " \n"})
    assert list(pack_submission(work, tmp_path / "hand-in.zip"))[1].endswith(f"not answered: {ids[0]}")


def test_the_hand_in_holds_the_notebooks_their_record_and_nothing_else(work: Path, tmp_path: Path) -> None:
    (work / LAB / ".ipynb_checkpoints").mkdir()
    (work / LAB / ".ipynb_checkpoints" / f"{LAB}-checkpoint.ipynb").touch()
    (work / "notes.txt").touch()
    (work / "notes.ipynb").touch()
    out = tmp_path / "hand-in.zip"
    lines = list(pack_submission(work, out))
    assert len(lines) == 3
    with zipfile.ZipFile(out) as archive:
        assert archive.testzip() is None
        expected = [f"{LAB}/{LAB}.ipynb", f"{LAB}/{RECORD_FILE}", f"{PRELAB}/{PRELAB}.ipynb"]
        assert sorted(archive.namelist()) == sorted(expected)
        for inside in expected:
            assert archive.read(inside) == (work / inside).read_bytes()


def test_a_notebook_of_another_name_is_said_to_be_left_out(work: Path, tmp_path: Path) -> None:
    (work / LAB / f"{LAB}.ipynb").rename(work / LAB / "final version.ipynb")
    lines = list(pack_submission(work, tmp_path / "hand-in.zip"))
    left = f"{LAB}/final version.ipynb is not included: the notebook of this folder is {LAB}.ipynb"
    assert lines[1:] == [left, f"Hand in this file: {tmp_path / 'hand-in.zip'}"]


def test_the_same_work_makes_the_same_file(work: Path, tmp_path: Path) -> None:
    for name in ("one.zip", "two.zip"):
        list(pack_submission(work, tmp_path / name))
        for path in work.rglob("*.ipynb"):
            path.touch()
    assert (tmp_path / "one.zip").read_bytes() == (tmp_path / "two.zip").read_bytes()


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(b"", id="empty"),
        pytest.param(b'{"cells": [', id="cut off"),
        pytest.param(b"\x89PNG\xff", id="binary"),
        pytest.param(b"[]", id="a list"),
        pytest.param(b"{}", id="no cells"),
        pytest.param(b'{"cells": 3}', id="cells that are a number"),
        pytest.param(b'{"cells": [3]}', id="a cell that is a number"),
        pytest.param(b'{"cells": [{"cell_type": "code", "metadata": {}}]}', id="a cell without source"),
        pytest.param(
            b'{"cells": [{"cell_type": "code", "source": "", "metadata":'
            b'{"nbgrader": {"grade_id": "a", "grade": true, "points": "x"}}}]}',
            id="points of text",
        ),
        pytest.param(b"[" * 100_000, id="nesting without end"),
    ],
)
def test_a_notebook_that_cannot_be_read_is_not_handed_in(work: Path, tmp_path: Path, content: bytes) -> None:
    out = tmp_path / "hand-in.zip"
    out.write_bytes(b"the last hand-in")
    (work / PRELAB / f"{PRELAB}.ipynb").write_bytes(content)
    with pytest.raises(
        ValueError, match=r"prelab-sinusoids.ipynb is not a readable notebook \(\w+\)\. Open it"
    ) as said:
        list(pack_submission(work, out))
    assert "\n" not in str(said.value)
    assert out.read_bytes() == b"the last hand-in"


def test_a_notebook_of_somebody_else_is_not_handed_in(work: Path, tmp_path: Path) -> None:
    content = '{"cells": [{"cell_type": "code", "source": "a = 3", "metadata": {}}], "nbformat": 4}'
    (work / LAB / f"{LAB}.ipynb").write_text(content, encoding="utf-8")
    with pytest.raises(ValueError, match="contains no cell of the assignment"):
        list(pack_submission(work, tmp_path / "hand-in.zip"))
    assert not (tmp_path / "hand-in.zip").exists()


def test_an_empty_folder_is_said(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "nosuch"):
        with pytest.raises(ValueError, match="contains no notebooks"):
            list(pack_submission(folder, tmp_path / "hand-in.zip"))
    assert list(tmp_path.iterdir()) == []
