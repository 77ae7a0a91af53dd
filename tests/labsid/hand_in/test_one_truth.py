"""What `labsid submit` calls right, grading calls right: honest hand-ins in odd styles, in both."""

import json
from collections.abc import Callable, Iterator
from decimal import Decimal
from pathlib import Path

import pytest
from course_work import GradeCode
from representatives import mostly_exhaustive

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


ONE_OF_EACH_KIND = (
    "star of labsid", "!pip", "output of a program", "a file of 60 MB", "threads",
    "a taught name", "subprocess", "a lock between processes", "socket", "a file of 100 MB", "3 GB",
)  # fmt: skip
"""Tried everywhere."""

Grade = Callable[[str], QuestionResult]


@pytest.fixture(scope="module")
def at_grading(released: Course) -> Iterator[Grade]:
    """The first question, graded in the sandbox."""
    with open_launcher("best") as launcher:
        grade = GradeCode(released, launcher)
        yield lambda source: grade(PRELAB, {ANSWER: source})[QUESTION]


def at_submit(course: Course, folder: Path, source: str) -> CleanRun:
    path = folder / PRELAB / f"{PRELAB}.ipynb"
    path.parent.mkdir()
    notebook = json.loads((course.release / PRELAB / f"{PRELAB}.ipynb").read_bytes())
    for cell in notebook["cells"]:
        if cell["id"] == ANSWER:
            cell["source"] = source
    path.write_text(json.dumps(notebook), encoding="utf-8")
    run = run_notebook(read_saved(path))
    assert run is not None
    return run


def state(run: CleanRun) -> str:
    return next(one.state for one in run.states if one.question.id == QUESTION)


@pytest.mark.slow
@pytest.mark.parametrize("style", mostly_exhaustive([*SAME, *SAID], ONE_OF_EACH_KIND))
def test_submit_and_grading_agree(released: Course, at_grading: Grade, tmp_path: Path, style: str) -> None:
    source = {**SAME, **SAID}[style]
    run = at_submit(released, tmp_path, source)
    graded = at_grading(source)
    assert (state(run) == "right") is (style in SAME), run.reasons.get(QUESTION)
    assert (graded.score == graded.max_score != Decimal(0)) is (style in SAME), graded.reason
    if source.startswith(("!", "%")):
        assert any("was skipped, as it is when the notebook is graded" in remark for remark in run.remarks)


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
    run = at_submit(released, tmp_path, source)
    said = [remark for remark in run.remarks if "is not there when the notebook is graded" in remark]
    assert [remark.partition(" ")[0] for remark in said] == [f"`{own / 'mylib.py'}`", f"`{own / 'stop.txt'}`"]


@pytest.mark.slow
def test_more_cells_than_grading_runs_are_said(
    released: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("labsid.hand_in.clean_run.MOST_OWN_CELLS", 0)
    run = at_submit(released, tmp_path, RIGHT)
    assert state(run) == "not right"
    assert "more than 0 cells of your own code" in run.reasons[QUESTION]
