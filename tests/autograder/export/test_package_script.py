"""The script of the packages: which notebook it takes, and what Gradescope and GitHub Classroom get to read."""

import base64
import json
from pathlib import Path
from typing import Any

import pytest

from autograder.export import package_script as script

QUESTIONS = [
    {"id": "a", "heading": "One", "marks": "0.6", "earned": "0.6", "state": "right", "said": ""},
    {"id": "b", "heading": "Two", "marks": "0.4", "earned": "0", "state": "not right", "said": "It is a row."},
    {"id": "c", "heading": "Three", "marks": "1", "earned": "0", "state": "not done", "said": ""},
    {"id": "d", "heading": "Four", "marks": "1", "earned": "0", "state": "noted", "said": ""},
    {"id": "e", "heading": "Five", "marks": "1", "earned": "0", "state": "marked by hand", "said": ""},
]
FOUND = {"title": "T", "questions": QUESTIONS, "remarks": ["A remark."]}


def test_gradescope_gets_a_test_for_each_question_and_no_marks_for_what_is_noted() -> None:
    result = script.for_gradescope(FOUND)
    tests = result["tests"]
    assert [(test["name"], test.get("score"), test.get("max_score"), test["output"]) for test in tests] == [
        ("a: One", 0.6, 0.6, "Right."),
        ("b: Two", 0.0, 0.4, "It is a row."),
        ("c: Three", 0.0, 1.0, "Not done."),
        ("d: Four", None, None, script._UNJUDGED["noted"]),
        ("e: Five", None, None, "Marked by hand. No marks here."),
    ]  # fmt: skip
    assert result["output"] == f"{script.HONESTY}\n\nA remark."
    assert "score" not in result  # Gradescope adds up the tests


def test_github_gets_those_that_checks_can_judge() -> None:
    result = script.for_github(FOUND)
    assert (result["version"], result["status"], result["max_score"]) == (1, "fail", 2.0)
    assert [(test["name"], test["status"], test["score"], test["message"]) for test in result["tests"]] == [
        ("a: One", "pass", 0.6, None), ("b: Two", "fail", 0.0, "It is a row."), ("c: Three", "fail", 0.0, "Not done."),
    ]  # fmt: skip


def test_the_notebook_with_the_name_counts_and_no_link_is_followed(tmp_path: Path) -> None:
    for name in ("old/deep/lab.ipynb", "lab/lab.ipynb", "other.ipynb", ".ipynb_checkpoints/lab.ipynb"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("{}", encoding="utf-8")
    assert script.find_notebook(tmp_path, "lab") == tmp_path / "lab" / "lab.ipynb"
    with pytest.raises(script.ProblemError, match=r"pre.ipynb was not handed in\."):
        script.find_notebook(tmp_path, "pre")
    alone = tmp_path / "alone"
    alone.mkdir()
    (alone / "link.ipynb").symlink_to(tmp_path / "other.ipynb")
    with pytest.raises(script.ProblemError):
        script.find_notebook(alone, "lab")
    (alone / "Untitled.ipynb").write_text("{}", encoding="utf-8")
    assert script.find_notebook(alone, "lab") == alone / "Untitled.ipynb"


def packed(folder: Path, system: str) -> Path:
    (folder / "settings.json").write_text(
        json.dumps({"assignment": "lab", "record": None, "system": system}), encoding="utf-8"
    )
    return folder


def test_the_reporter_of_github_gets_its_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(script, "HERE", packed(tmp_path, "github"))
    monkeypatch.setattr(script, "run_checks", lambda *_: FOUND)
    monkeypatch.setenv("GITHUB_OUTPUT", str(tmp_path / "output"))
    monkeypatch.setattr("sys.argv", ["grade.py", "--submission", ".", "--results", str(tmp_path / "r" / "r.json")])
    assert script.main() == 0
    line = (tmp_path / "output").read_text(encoding="utf-8").removeprefix("result=")
    assert json.loads(base64.b64decode(line)) == json.loads((tmp_path / "r" / "r.json").read_text(encoding="utf-8"))
    assert "fail: b: Two: It is a row." in capsys.readouterr().out


def test_a_python_that_nobody_may_run_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "lab.ipynb").write_text("{}", encoding="utf-8")
    monkeypatch.setattr("sys.executable", str(tmp_path / "lab.ipynb"))
    with pytest.raises(script.ProblemError, match=r"could not be started as the user nobody: .*Permission denied"):
        script.run_checks(tmp_path, {"assignment": "lab", "record": None})


def test_checks_that_cannot_be_run_are_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Ended:
        stdout, stderr = b"", b"Traceback ...\nModuleNotFoundError: No module named 'labsid'\n"

    def ended(*_: Any, **__: Any) -> Ended:
        return Ended()

    (tmp_path / "lab.ipynb").write_text("{}", encoding="utf-8")
    monkeypatch.setattr(script, "HERE", packed(tmp_path, "gradescope"))
    monkeypatch.setattr(script.subprocess, "run", ended)
    monkeypatch.setattr(script.os, "geteuid", lambda: 1000)
    monkeypatch.setattr("sys.argv", ["grade.py", "--submission", str(tmp_path), "--results", str(tmp_path / "r.json")])
    assert script.main() == 0
    result = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    assert result["output"] == "the checks could not be run: ModuleNotFoundError: No module named 'labsid'"
