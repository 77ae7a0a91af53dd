"""Tries that a student keeps: off until they choose, no code, values or times of day, and never in a check's way."""

import json
from pathlib import Path
from typing import Any

import pytest

from labsid.checks import CheckFailed, notebook_checks
from labsid.checks.kept_tries import (
    MAX_BYTES,
    MAX_TRIES,
    KeptTry,
    read_tries,
    tries_bytes,
    tries_file_name,
    tries_html,
    tries_text,
)
from labsid.checks.notebook import assignment_names, load_assignment
from labsid.checks.notebook_tries import NotebookTries
from labsid.checks.question import Assignment, Question
from labsid.checks.verdict import Slip, judge

FILE = "tiny-tries.json"
WRONG = KeptTry("q-gain", 0, False, "sign")


class Clock:
    """A monotonic clock that a test moves."""

    def __init__(self) -> None:
        self.seconds = 1000.0

    def __call__(self) -> float:
        return self.seconds


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The variables of a notebook of one question, in a folder of its own."""

    def gain(ask: Any) -> Any:
        slips = [Slip("sign", "look at the sign.", lambda: -3)]
        return judge(ask.value("a"), 3, lambda x, y: x == y, "right.", "not the gain.", slips)

    def function(ask: Any) -> Any:
        return judge(ask.call("f", 1), 3, lambda x, y: x == y, "right.", "not it.")

    assignment = Assignment("tiny", (Question("q-gain", gain), Question("q-call", function)))
    monkeypatch.setattr("labsid.checks.notebook.load_assignment", lambda name: assignment)
    monkeypatch.chdir(tmp_path)
    return {}


def tried(check: notebook_checks, variables: dict[str, Any], question: str = "q-gain", **values: Any) -> None:
    variables.update(values)
    try:
        check(question)
    except CheckFailed:
        return


def kept() -> list[KeptTry]:
    return list(read_tries(Path(FILE).read_bytes()))


# ---- in the notebook


def test_nothing_is_kept_until_the_student_chooses(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    check = notebook_checks("tiny", tiny)
    tried(check, tiny, a=-3)
    check.tries()
    assert "Your tries are not kept. check.tries.keep() begins" in capsys.readouterr().out
    assert list(Path().iterdir()) == []


def test_a_try_is_the_question_the_minute_and_the_name_of_the_mistake(tiny: dict, capsys) -> None:
    check = notebook_checks("tiny", tiny)
    check.tries.keep()
    notice = capsys.readouterr().out
    for said in (FILE, "No code, no values and no times of day", "No mark", "check.tries.delete()"):
        assert said in notice
    for value in (-3, 4, 3):
        tried(check, tiny, a=value)
    assert kept() == [WRONG, KeptTry("q-gain", 0, False, "other"), KeptTry("q-gain", 0, True)]
    document = json.loads(Path(FILE).read_text(encoding="utf-8"))
    assert set(document) == {"format", "tries"}
    assert all(set(one) == {"question", "minute", "right", "slip"} for one in document["tries"])
    capsys.readouterr()
    check.tries()
    assert capsys.readouterr().out.splitlines()[:2] == [
        "minute  question  result",
        "     0  q-gain    not right: sign",
    ]


def test_an_answer_that_python_stops_is_a_try_with_that_name(tiny: dict) -> None:
    check = notebook_checks("tiny", tiny)
    check.tries.keep()
    tried(check, tiny, "q-call", f=lambda x: x + "a")
    assert kept() == [KeptTry("q-call", 0, False, "Python error")]


def test_a_right_answer_is_kept_once_and_a_later_mistake_again(tiny: dict) -> None:
    check = notebook_checks("tiny", tiny)
    check.tries.keep()
    for value in (3, 3, -3, 3):
        tried(check, tiny, a=value)
    assert [one.right for one in kept()] == [True, False, True]


def test_the_same_code_again_is_no_new_try(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    tries = NotebookTries("tiny", lambda text, html: None, Clock())
    tries.keep()
    for code in ("a = 1", "a = 1", "a = 2", "a = 1"):
        tries.note("q-gain", False, None, (code,))
    assert len(kept()) == 3


def test_a_notebook_that_is_run_again_after_a_restart_has_no_new_tries(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    for opened in range(3):
        tries = NotebookTries("tiny", lambda text, html: None, Clock())
        if not opened:
            tries.keep()
        tries.note("q-gain", False, "sign", ("a = 1",))
        tries.note("q-line", True, None, ("b = 1",))
    assert len(kept()) == 2
    tries.note("q-gain", False, "sign", ("a = 2",))
    assert len(kept()) == 3


def test_minutes_go_on_after_a_restart_and_a_pause_counts_half_an_hour(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    shown: list[str] = []
    clock = Clock()

    def opened() -> NotebookTries:
        return NotebookTries("tiny", lambda text, html: shown.append(text), clock)

    tries = opened()
    tries.keep()
    clock.seconds += 5 * 60 + 59
    tries.note("q-gain", False)
    clock.seconds += 24 * 3600
    tries.note("q-gain", False)
    assert [one.minute for one in kept()] == [5, 35]
    tries = opened()
    assert shown[-1].startswith("Your tries are kept, as you chose")
    clock.seconds += 120
    tries.note("q-gain", True)
    assert [one.minute for one in kept()] == [5, 35, 37]


def test_delete_deletes_and_ends_the_keeping(tiny: dict, capsys: pytest.CaptureFixture[str]) -> None:
    check = notebook_checks("tiny", tiny)
    check.tries.keep()
    tried(check, tiny, a=-3)
    check.tries.delete()
    tried(check, tiny, a=4)
    assert not Path(FILE).exists()
    assert "are deleted, and no more are kept" in capsys.readouterr().out
    assert not notebook_checks("tiny", tiny).tries._tries


def test_a_file_that_cannot_be_read_or_written_never_stops_a_check(tiny: dict, monkeypatch, capsys) -> None:
    Path(FILE).write_bytes(b"[" * 10_000)
    check = notebook_checks("tiny", tiny)
    tried(check, tiny, a=-3)
    check.tries.keep()
    assert f"{FILE} cannot be read (it is not JSON), and no tries are kept" in capsys.readouterr().out
    assert Path(FILE).read_bytes() == b"[" * 10_000
    check.tries.delete()
    check.tries.keep()
    capsys.readouterr()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("labsid.checks.notebook_tries.write_file", full)
    tiny["a"] = 3
    check("q-gain")
    assert capsys.readouterr().out == "Your tries cannot be kept (No space left on device).\n✓ q-gain: right.\n"


def test_a_file_has_an_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path(FILE).write_bytes(tries_bytes([WRONG] * (MAX_TRIES - 1)))
    tries = NotebookTries("tiny", lambda text, html: None)
    for slip in ("one", "two"):
        tries.note("q-gain", False, slip, (slip,))
    assert [one.slip for one in kept()[-2:]] == ["sign", "one"]


# ---- the file


def test_the_file_comes_back_as_it_was_written() -> None:
    tries = (WRONG, KeptTry("q-line", 7, True), KeptTry("q-line", 9, False, "Φ' <b>"))
    assert read_tries(tries_bytes(tries)) == tries
    assert read_tries(tries_bytes(())) == ()
    assert read_tries(tries_bytes(tries), {"q-line"}) == tries[1:]
    assert "&lt;b&gt;" in tries_html(tries)
    assert tries_text(tries).splitlines()[-1] == "     9  q-line    not right: Φ' <b>"


def changed(**fields: object) -> bytes:
    one = {"question": "q", "minute": 1, "right": False, "slip": "sign", **fields}
    return json.dumps({"format": "labsid.tries/1", "tries": [one]}).encode()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "not JSON"),
        (b"\xff\xfe", "not JSON"),
        (b"[" * 100_000, "not JSON"),
        (b'{"format": "labsid.tries/1", "tries": ' + b"9" * 5000 + b"}", "not JSON"),
        (b"[]", "not of the format"),
        (b'{"format": "labsid.tries/2", "tries": []}', "not of the format"),
        (b'{"format": "labsid.tries/1", "tries": {}}', "not of the format"),
        (b" " * (MAX_BYTES + 1), "more than 400000 bytes"),
        (b'{"format": "labsid.tries/1", "tries": [' + b"0," * MAX_TRIES + b"0]}", "more than 2000 tries"),
        (b'{"format": "labsid.tries/1", "tries": [3]}', "other fields"),
        (changed(code="a = 3"), "other fields"),
        (changed(minute=-1), "not a whole number"),
        (changed(minute=1.5), "not a whole number"),
        (changed(minute=True), "not a whole number"),
        (changed(minute=10**9), "not a whole number"),
        (changed(slip="x" * 81), "printable text"),
        (changed(slip="a\nb"), "printable text"),
        (changed(question=["q"]), "printable text"),
        (changed(right=1), "right without a mistake"),
        (changed(right=True), "right without a mistake"),
        (changed(slip=""), "right without a mistake"),
    ],
)
def test_a_forged_file_is_refused(content: bytes, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        read_tries(content)


def test_the_longest_file_of_the_course_can_be_read() -> None:
    longest = max((q.id for name in assignment_names() for q in load_assignment(name).questions), key=len)
    content = tries_bytes([KeptTry(longest, 99_999, False, "a mistake with a name of forty letters ..")] * MAX_TRIES)
    assert len(read_tries(content)) == MAX_TRIES


def test_the_name_of_the_file_is_that_of_the_assignment() -> None:
    assert tries_file_name("tiny") == FILE
