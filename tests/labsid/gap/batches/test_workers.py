"""Worker processes: a killed one does not affect the others, and none outlives the parent."""

import os
import subprocess
import sys
import time
from contextlib import closing

import pytest

from labsid.gap.batches.workers import run_tasks

WORK = """
import os, pathlib, signal, time
from labsid.gap.batches.workers import serve

def answer(task):
    print("what a library prints")
    if "log" in task:
        with open(task["log"], "a") as file:
            file.write(f"{os.getpid()}\\n")
    if task.get("dies") == "always" or task.get("dies") == "once" and not os.path.exists(task["mark"]):
        pathlib.Path(task["mark"]).touch()
        os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(task.get("seconds", 0))
    return {"twice": 2 * task.get("number", 0), "pid": os.getpid(), "threads": os.environ["OMP_NUM_THREADS"]}

def run_worker():
    serve(answer)
"""


@pytest.fixture
def work(tmp_path, monkeypatch):
    """Name of a module with `run_worker`, on the path that the worker processes inherit."""
    (tmp_path / "work_of_the_tests.py").write_text(WORK)
    monkeypatch.syspath_prepend(tmp_path)
    return "work_of_the_tests"


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def pids_in(log, count):
    """The process ids in a file, once it has `count` of them."""
    for _ in range(600):
        if log.exists() and len(pids := log.read_text().split()) >= count:
            return [int(pid) for pid in pids]
        time.sleep(0.05)
    raise AssertionError(f"{log} never held {count} lines")


def test_every_task_gets_its_own_result(work):
    answers = dict(run_tasks(work, [{"number": n} for n in range(12)], jobs=2))
    assert {number: answer["twice"] for number, answer in answers.items()} == {n: 2 * n for n in range(12)}
    assert len({answer["pid"] for answer in answers.values()}) <= 2
    assert {answer["threads"] for answer in answers.values()} == {"1"}
    assert not any(alive(answer["pid"]) for answer in answers.values())


def test_no_tasks(work):
    assert list(run_tasks(work, [], jobs=2)) == []


def test_a_killed_process_is_replaced_and_its_task_repeated(work, tmp_path):
    log = tmp_path / "tries"
    deadly = {"dies": "always", "mark": str(tmp_path / "mark"), "log": str(log)}
    unlucky = {"dies": "once", "mark": str(tmp_path / "once"), "number": 5}
    tasks = [{"number": 1}, deadly, unlucky, *({"number": n} for n in range(8))]
    answers = dict(run_tasks(work, tasks, jobs=2))
    assert answers.pop(1) is None
    assert len(log.read_text().split()) == 2
    assert answers[2]["twice"] == 10
    assert sorted(answers) == [0, *range(2, len(tasks))]
    assert all(answers.values())


def test_processes_that_cannot_start_end_the_run():
    with pytest.raises(OSError, match=r"could not start: ModuleNotFoundError: No module named 'labsid\.nowhere'"):
        list(run_tasks("labsid.nowhere", [{}] * 3, jobs=2))


def test_closing_ends_the_processes_in_the_middle_of_a_task(work, tmp_path):
    log = tmp_path / "pids"
    tasks = [{"number": 1}, *({"seconds": 600, "log": str(log)} for _ in range(5))]
    with closing(run_tasks(work, tasks, jobs=2)) as results:
        assert next(results)[0] == 0
        pids = pids_in(log, 2)
        assert all(map(alive, pids))
    assert not any(map(alive, pids))


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="Windows ends processes in its own way")
def test_worker_processes_end_when_the_parent_is_killed(work, tmp_path):
    log = tmp_path / "pids"
    program = (
        f"import sys; sys.path[:] = {sys.path!r}\n"
        "from labsid.gap.batches.workers import run_tasks\n"
        f"list(run_tasks({work!r}, [{{'seconds': 600, 'log': {str(log)!r}}}] * 4, jobs=2))"
    )
    with subprocess.Popen([sys.executable, "-c", program]) as asking:
        pids = pids_in(log, 2)
        asking.kill()
    for _ in range(200):
        if not any(map(alive, pids)):
            return
        time.sleep(0.05)
    raise AssertionError(f"{pids} live on")
