"""Which course the commands work on: that of the working folder, otherwise the checkout, which is said."""

from pathlib import Path

import pytest

from autograder.course.layout import find_course
from labsid.cli.commands import main

ROOT = Path(__file__).resolve().parents[3]


def make_course(root: Path) -> Path:
    for name in ("notebooks", "autograder"):
        (root / name).mkdir(parents=True)
    return root


def test_the_course_of_the_working_folder_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = make_course(tmp_path / "copy")
    monkeypatch.chdir(own)
    assert (find_course().root, find_course().remark) == (own, "")
    inner = make_course(own / "attempt")
    monkeypatch.chdir(inner)
    assert find_course().root == inner


def test_a_course_above_the_working_folder_is_used_and_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = make_course(tmp_path / "copy")
    monkeypatch.chdir(own / "notebooks")
    found = find_course()
    assert found.root == own
    assert found.remark == f"Using the course in {own}: this folder has no folders 'notebooks' and 'autograder'."


def test_the_checkout_is_used_and_said_where_there_is_no_course(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    found = find_course()
    assert (found.notebooks / "lab-identification" / "lab-identification.md").is_file()
    assert found.remark.startswith(f"Using the course in {ROOT}: ")
    assert "course.toml" not in found.remark
    (tmp_path / "course.toml").write_text('title = "Mine"\n', encoding="utf-8")
    assert find_course().remark.endswith("course.toml of this folder is not read.")


def test_checks_that_do_not_run_are_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = make_course(tmp_path / "copy")
    (own / "labsid" / "checks").mkdir(parents=True)
    monkeypatch.chdir(own)
    assert find_course().remark == (
        f"The checks are those of the labsid in {ROOT}, which runs this command, not those of {own / 'labsid'}. "
        f"To use these, run: pip install --editable {own}"
    )
    monkeypatch.chdir(ROOT)
    assert find_course().remark == ""


def test_a_command_reads_the_settings_of_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A `course build` in a copy of the course wrote into the checkout, and no command read the copy's course.toml."""
    own = make_course(tmp_path / "copy")
    (own / "course.toml").write_text("tittle = 1\n", encoding="utf-8")
    monkeypatch.chdir(own)
    assert main(["course", "report", "--out", "OUT"]) == 2
    assert f"{own / 'course.toml'}: the file has the unknown key 'tittle'" in capsys.readouterr().err
    assert main(["course", "build"]) == 2
    assert f"no assignments in {own / 'notebooks'}" in capsys.readouterr().err
    monkeypatch.chdir(own / "notebooks")
    assert main(["course", "build"]) == 2
    assert capsys.readouterr().err.startswith(f"Using the course in {own}: ")
