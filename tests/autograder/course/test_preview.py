"""The preview: the files that students get, in a folder, with JupyterLab on their start page."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from autograder.course.layout import Course
from autograder.course.preview import changed_since_build
from autograder.course.release import write_release
from labsid.cli.commands import main

ROOT = Path(__file__).resolve().parents[3]
PRELAB, LAB = "prelab-sinusoids", "lab-identification"


@pytest.fixture
def here(course: Course, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Course:
    """A built course of two assignments as the commands find it, with a due date."""
    own = Course(tmp_path / "own")
    for name in (PRELAB, LAB):
        for folder in ("notebooks", "autograder/source", "autograder/release"):
            shutil.copytree(course.root / folder / name, own.root / folder / name)
    shutil.copytree(course.data, own.data)
    shutil.copyfile(ROOT / "pyproject.toml", own.root / "pyproject.toml")
    (own.root / "course.toml").write_text(f"[assignments.{LAB}]\ndue = 2026-11-30T23:59:00\n", encoding="utf-8")
    monkeypatch.setattr("autograder.course.layout.find_course", lambda: own)
    monkeypatch.chdir(tmp_path)
    return own


def files_below(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_preview_is_the_release_unpacked(here: Course, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["course", "preview", "--no-open", "--folder", "seen"]) == 0
    assert capsys.readouterr().err == ""
    write_release(here, Path("release.zip"), due={LAB: "30 November 2026, 23:59 (UTC)"})
    with zipfile.ZipFile("release.zip") as archive:
        assert files_below(Path("seen")) == {name: archive.read(name) for name in archive.namelist()}
    assert main(["course", "preview", "--no-open", "--folder", "one", "--assignment", PRELAB]) == 0
    assert {path.name for path in Path("one").iterdir() if path.is_dir()} == {PRELAB}
    assert LAB not in Path("one", "start.ipynb").read_text(encoding="utf-8")


def test_the_preview_opens_jupyterlab_on_the_start_page_of_a_temporary_folder(
    here: Course, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    started: list[tuple[list[str], Path]] = []
    monkeypatch.setattr(subprocess, "run", lambda command, cwd, check: started.append((command, cwd)))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert main(["course", "preview", "--assignment", PRELAB]) == 0
    ((command, folder),) = started
    assert command == [sys.executable, "-m", "jupyterlab", "start.ipynb"]
    assert folder.parent == tmp_path
    assert (folder / PRELAB / f"{PRELAB}.ipynb").is_file()
    assert f"files to {folder}, as a student gets them." in capsys.readouterr().out


def test_what_is_in_the_way_of_a_preview_is_said(here: Course, capsys: pytest.CaptureFixture[str]) -> None:
    Path("full").mkdir()
    Path("full", "mine.txt").touch()
    for arguments, said in (
        (["--folder", "full"], "full is not an empty folder. Give --folder another name"),
        (["--folder", "full/mine.txt"], "full/mine.txt is not an empty folder"),
        (["--folder", "new", "--assignment", "holiday"], "there is no assignment 'holiday'"),
    ):
        assert main(["course", "preview", "--no-open", *arguments]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith(f"labsid: error: {said}")
    assert list(files_below(Path("full"))) == ["mine.txt"]
    assert not Path("new").exists()
    shutil.rmtree(here.release / PRELAB)
    assert main(["course", "preview", "--no-open", "--folder", "new"]) == 2
    assert "Run: labsid course build" in capsys.readouterr().err


def test_a_text_that_is_newer_than_its_release_is_said(here: Course, capsys: pytest.CaptureFixture[str]) -> None:
    assert changed_since_build(here) == []
    text, built = here.notebooks / PRELAB / f"{PRELAB}.md", here.release / PRELAB / f"{PRELAB}.ipynb"
    os.utime(text, ns=(0, built.stat().st_mtime_ns + 1))
    assert main(["course", "preview", "--no-open", "--folder", "seen"]) == 0
    assert capsys.readouterr().err == (
        f"{PRELAB}: its text was changed after the last build. Run: labsid course build\n"
    )
    assert changed_since_build(here, [LAB]) == []
