"""What `labsid submit` calls right, grading calls right: honest hand-ins in odd styles, in both."""

import json
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from pathlib import Path

import pytest
from course_work import GradeCode, read_solved

from autograder.course.layout import Course
from autograder.judge.outcome import QuestionResult
from autograder.sandbox.isolation import open_launcher
from labsid.hand_in.clean_run import CleanRun
from labsid.hand_in.saved_work import read_saved
from labsid.hand_in.submission_file import run_notebook

PRELAB = "prelab-sinusoids"
ANSWER = "prelab-1-time-answer"
QUESTION = "prelab-1-time"
RIGHT = "t = np.linspace(0, 100, 1001).reshape(-1, 1)"

SAME = {
    "star of labsid": f"from labsid import *\n{RIGHT}",
    "star of labsid.plots": f"from labsid.plots import *\nfigure_2\n{RIGHT}",
    "a name of the star": f"from labsid import *\nload_record\n{RIGHT}",
    "!pip": f"!pip install numpy\n{RIGHT}",
    "%pip": f"%pip install numpy\n{RIGHT}",
    "output of a program": f"files = !ls\n{RIGHT}",
    "getuser": f"import getpass\nname = getpass.getuser()\n{RIGHT}",
    "%autosave": f"%autosave 30\n{RIGHT}",
    "practice": f"check.practice()\n{RIGHT}",
    "display": f"display(3)\n{RIGHT}",
    "a file of 60 MB": f"np.save('big.npy', np.zeros(7_500_000))\n{RIGHT}",
    "200 files": f"files = [open(f'{{k}}', 'w') for k in range(200)]\n{RIGHT}",
    "threads": f"from concurrent.futures import ThreadPoolExecutor\nlist(ThreadPoolExecutor(2).map(abs, [1]))\n{RIGHT}",
}
"""Answers that are right in both."""

SAID = {
    "a taught name of the star": f"from labsid import *\nfit_arx\n{RIGHT}",
    "a taught name": f"from labsid import fit_arx\n{RIGHT}",
    "a taught module": f"import labsid.lab.arx\n{RIGHT}",
    "subprocess": f"import subprocess\nsubprocess.run(['ls'], check=True)\n{RIGHT}",
    "multiprocessing": f"import multiprocessing\nmultiprocessing.Pool(2).map(abs, [1, 2])\n{RIGHT}",
    "a lock between processes": f"import multiprocessing\nmultiprocessing.Lock()\n{RIGHT}",
    "subprocess of a thread": "import subprocess\nfrom concurrent.futures import ThreadPoolExecutor\n"
    f"ThreadPoolExecutor().submit(subprocess.run, ['ls']).result()\n{RIGHT}",
    "socket": f"import socket\nsocket.create_connection(('127.0.0.1', 9), 1)\n{RIGHT}",
    "a file of 100 MB": f"np.save('big.npy', np.zeros(12_500_000))\n{RIGHT}",
    "400 files": f"files = [open(f'{{k}}', 'w') for k in range(400)]\n{RIGHT}",
    "90 threads": "import threading, time\nthreading.stack_size(65536)\n"
    f"for _ in range(90):\n    threading.Thread(target=time.sleep, args=(1,)).start()\n{RIGHT}",
    "3 GB": f"big = np.zeros(3 * 2**27)\n{RIGHT}",
}
"""Answers that are wrong in both, as the student reads before handing in."""


ANSWERED = (
    "prelab-1-time", "prelab-2-noise", "prelab-3-cut", "prelab-4-matrix", "prelab-4-function", "prelab-5-original",
    "prelab-6-cut-off",
)  # fmt: skip
"""Questions whose answers have styles side by side."""

Grade = Callable[[Mapping[str, str]], Mapping[str, QuestionResult]]


@pytest.fixture(scope="module")
def at_grading(released: Course) -> Iterator[Grade]:
    """The questions, graded in the sandbox."""
    with open_launcher("best") as launcher:
        grade = GradeCode(released, launcher)
        yield lambda answers: grade(PRELAB, answers)


def at_submit(course: Course, folder: Path, answers: Mapping[str, str]) -> CleanRun:
    path = folder / PRELAB / f"{PRELAB}.ipynb"
    path.parent.mkdir()
    notebook = json.loads((course.release / PRELAB / f"{PRELAB}.ipynb").read_bytes())
    for cell in notebook["cells"]:
        cell["source"] = answers.get(cell["id"], cell["source"])
    path.write_text(json.dumps(notebook), encoding="utf-8")
    run = run_notebook(read_saved(path))
    assert run is not None
    return run


def state(run: CleanRun, question: str = QUESTION) -> str:
    return next(one.state for one in run.states if one.question.id == question)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("styles", "right"),
    [
        pytest.param(list(kinds)[start : start + len(ANSWERED)], kinds is SAME, id=f"{name} {start}")
        for name, kinds in {"same": SAME, "said": SAID}.items()
        for start in range(0, len(kinds), len(ANSWERED))
    ],
)
def test_submit_and_grading_agree(
    released: Course, at_grading: Grade, tmp_path: Path, styles: list[str], right: bool
) -> None:
    """Styles side by side, each ahead of the right answer to another question."""
    solution = read_solved(released, PRELAB)[1]
    texts = [{**SAME, **SAID}[style].removesuffix(RIGHT) for style in styles]
    before = dict(zip(ANSWERED, texts, strict=False))
    answers = {f"{question}-answer": text + solution[f"{question}-answer"] for question, text in before.items()}
    run = at_submit(released, tmp_path, answers)
    graded = at_grading(answers)
    for question, text in before.items():
        one = graded[question]
        assert (state(run, question) == "right") is right, (text, run.reasons.get(question))
        assert (one.score == one.max_score != Decimal(0)) is right, (text, one.reason)
    skipped = sum("was skipped, as it is when the notebook is graded" in remark for remark in run.remarks)
    assert skipped == sum(any(sign in text for sign in "!%") for text in texts)


@pytest.mark.slow
def test_what_lies_elsewhere_on_the_students_machine_is_said(
    released: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A module, and a file, that grading does not have; what a library or the notebook itself writes is not named."""
    own, scratch = tmp_path / "own", tmp_path / "scratch"
    own.mkdir()
    scratch.mkdir()
    (own / "mylib.py").write_text("def points():\n    return 1001\n", encoding="utf-8")
    (own / "stop.txt").write_text("100", encoding="utf-8")
    monkeypatch.setattr("tempfile.tempdir", str(scratch))  # tests have their folders where programs have theirs
    monkeypatch.setenv("TMPDIR", str(scratch))
    source = (
        f"import sys, tempfile, matplotlib.pyplot as plt\nsys.path.append({str(own)!r})\nimport mylib\n"
        f"stop = float(open({str(own / 'stop.txt')!r}).read())\nopen('own.txt', 'w').close()\n"
        "tempfile.TemporaryFile().close()\nplt.plot([1, 2])\nplt.savefig('a.png')\n"
        "t = np.linspace(0, stop, mylib.points()).reshape(-1, 1)"
    )
    run = at_submit(released, tmp_path, {ANSWER: source})
    said = [remark for remark in run.remarks if "is not there when the notebook is graded" in remark]
    assert [remark.partition(" ")[0] for remark in said] == [f"`{own / 'mylib.py'}`", f"`{own / 'stop.txt'}`"]


@pytest.mark.slow
def test_more_cells_than_grading_runs_are_said(
    released: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("labsid.hand_in.clean_run.MOST_OWN_CELLS", 0)
    run = at_submit(released, tmp_path, {ANSWER: RIGHT})
    assert state(run) == "not right"
    assert "more than 0 cells of your own code" in run.reasons[QUESTION]
