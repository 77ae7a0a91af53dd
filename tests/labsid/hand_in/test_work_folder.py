"""The release copied into a work folder, without losing work."""

import shutil
from pathlib import Path

import pytest

from autograder.course.layout import RECORD_FILE, Course
from labsid.checks.notebook import load_assignment
from labsid.checks.notebook_file import START_PAGE
from labsid.hand_in.work_folder import copy_release, default_folder

PRELAB, LAB = "prelab-sinusoids", "lab-identification"


@pytest.fixture
def work(released: Course, tmp_path: Path) -> Path:
    """A work folder with two assignments as they are released."""
    for name in (PRELAB, LAB):
        shutil.copytree(released.release / name, tmp_path / "work" / name)
    return tmp_path / "work"


def test_the_release_is_copied_whole(released: Course, tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "work"
    lines = list(copy_release(released.release, folder))
    assert [line.split(":")[0] for line in lines] == released.assignments()
    for name in released.assignments():
        there = {path.name for path in (folder / name).iterdir()}
        assert there == {f"{name}.ipynb", load_assignment(name).record_file} - {None}
        for file in there:
            assert (folder / name / file).read_bytes() == (released.release / name / file).read_bytes()
    assert lines[:2] == [f"{PRELAB}: new: {PRELAB}.ipynb", f"{LAB}: new: {RECORD_FILE}, {LAB}.ipynb"]
    assert (folder / START_PAGE).read_bytes() == (released.release / START_PAGE).read_bytes()


def test_work_is_never_overwritten(released: Course, work: Path) -> None:
    mine = work / PRELAB / f"{PRELAB}.ipynb"
    mine.write_text("my work", encoding="utf-8")
    (work / START_PAGE).write_text("my page", encoding="utf-8")
    (work / LAB / f"{LAB}.ipynb").unlink()
    lines = {line.split(":")[0]: line for line in copy_release(released.release, work)}
    assert mine.read_text(encoding="utf-8") == "my work"
    assert (work / START_PAGE).read_text(encoding="utf-8") == "my page"
    assert lines[PRELAB] == f"{PRELAB}: kept: {PRELAB}.ipynb"
    assert lines[LAB] == f"{LAB}: new: {LAB}.ipynb; kept: {RECORD_FILE}"
    again = list(copy_release(released.release, work))
    assert not any("new" in line for line in again)


def test_what_jupyter_left_in_the_release_is_not_copied(released: Course, tmp_path: Path) -> None:
    shutil.copytree(released.release, tmp_path / "release")
    (tmp_path / "release" / PRELAB / ".ipynb_checkpoints").mkdir()
    (tmp_path / "release" / ".ipynb_checkpoints").mkdir()
    list(copy_release(tmp_path / "release", tmp_path / "work"))
    assert not (tmp_path / "work" / PRELAB / ".ipynb_checkpoints").exists()
    assert not (tmp_path / "work" / ".ipynb_checkpoints").exists()


def test_a_file_in_the_place_of_the_work_folder_is_said(released: Course, tmp_path: Path) -> None:
    (tmp_path / "work").touch()
    with pytest.raises(ValueError, match="is a file; give --folder another name"):
        list(copy_release(released.release, tmp_path / "work"))


def test_a_folder_with_a_start_page_is_the_work_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert default_folder() == Path("labsid-work")
    Path(START_PAGE).touch()
    assert default_folder() == Path()
