import contextlib
import os
import socket
import threading
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import count
from operator import methodcaller
from pathlib import Path

import pytest

from autograder.batch import judge_process
from autograder.batch.judge_messages import receive_message
from autograder.batch.judge_process import JudgeError, JudgePool, JudgeProcess
from autograder.batch.judge_worker import RemoteLauncher
from autograder.sandbox.isolation import Limits, MachineError, ProcessLauncher, StudentProcess

pytestmark = pytest.mark.skipif(not hasattr(socket, "send_fds"), reason="this system judges in the grader's process")


@pytest.fixture(scope="module")
def judge() -> Iterator[JudgeProcess]:
    pool = JudgePool()
    with pool.borrow() as borrowed:
        yield borrowed
    pool.close()


def test_a_call_returns_what_the_function_returns(judge: JudgeProcess) -> None:
    assert judge.call(eval, "1 + 1") == 2
    assert judge.call(os.getpid) == judge.call(os.getpid) != os.getpid()


@pytest.mark.parametrize(
    ("code", "reason", "details"),
    [
        ("int('x')", "it stops with ValueError", "invalid literal"),
        ("bytearray(1 << 40)", "it takes more than 2 GB of memory", ""),
        ("sum(iter(int, 1))", "it takes more than 1 s of processor time", ""),
        ("__import__('os')._exit(3)", "it ends the judge's process", "exit status 3"),
        ("lambda: 0", "it stops with", "pickle"),
        ("'x' * (300 << 20)", "its result is larger than 256 MB", ""),
    ],
)
def test_a_call_that_exceeds_a_limit_costs_itself_alone(
    judge: JudgeProcess, code: str, reason: str, details: str
) -> None:
    with pytest.raises(JudgeError) as refused:
        judge.call(eval, code, cpu_seconds=1 if "processor time" in reason else 60)
    assert str(refused.value).startswith(reason)
    assert details in refused.value.details
    assert judge.call(eval, "1 + 1") == 2


def test_a_call_that_waits_is_ended(judge: JudgeProcess, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judge_process, "WALL_SECONDS", 0.5)
    with pytest.raises(JudgeError, match=r"it takes longer than 0\.5 s"):
        judge.call(time.sleep, 999)


def test_a_judge_that_the_system_kills_is_a_failure_of_the_machine(judge: JudgeProcess) -> None:
    with pytest.raises(MachineError, match="was killed"):
        judge.call(eval, "__import__('os').kill(__import__('os').getpid(), 9)")


@dataclass
class Recording:
    """A launcher that keeps what it has started."""

    launcher: ProcessLauncher
    started: list[StudentProcess] = field(default_factory=list)

    @property
    def level(self) -> str:
        return self.launcher.level

    @property
    def limits(self) -> Limits:
        return self.launcher.limits

    def start(self, folder: Path) -> StudentProcess:
        self.started.append(self.launcher.start(folder))
        return self.started[-1]

    def close(self) -> None: ...


def test_student_processes_end_with_the_call_that_started_them(
    judge: JudgeProcess, launcher: ProcessLauncher, tmp_path: Path
) -> None:
    """A batch judges like this; here the call leaves its process running, and returns what cannot be sent."""
    recording = Recording(launcher)
    with pytest.raises(JudgeError, match="it stops with TypeError"):
        judge.call(methodcaller("start", tmp_path), launcher=recording)
    assert len(recording.started) == 1
    assert recording.started[0]._ended is not None


class Silent:
    """A launcher of processes that do nothing; the exit status of each is its number."""

    level, limits = "none", Limits()

    def __init__(self) -> None:
        self.numbers = count()

    def start(self, folder: Path) -> StudentProcess:
        number = next(self.numbers)
        return StudentProcess(socket.socket(socket.AF_UNIX), self.limits, lambda: (number, ""))

    def close(self) -> None: ...


def test_threads_of_the_judge_start_and_end_processes_in_turn(tmp_path: Path) -> None:
    """The second record waits in a thread while the first run goes on: no reply may reach the other's request."""
    judge, silent, (ours, theirs) = JudgeProcess(), Silent(), socket.socketpair()

    def serve() -> None:
        with ours, contextlib.suppress(Exception):  # it ends with the connection, or with what is not a message
            while True:
                judge._serve(ours, receive_message(ours), silent)

    def start_and_end(_: int) -> int:
        return launcher.start(tmp_path).close()[0]

    grader = threading.Thread(target=serve)
    grader.start()
    launcher = RemoteLauncher(theirs, silent.level, silent.limits)
    with ThreadPoolExecutor(4) as threads:
        ended = list(threads.map(start_and_end, range(400)))
    theirs.close()
    grader.join()
    assert sorted(ended) == list(range(400))


def test_a_process_that_cannot_start_is_a_failure_of_the_machine(judge: JudgeProcess, tmp_path: Path) -> None:
    class Broken:
        level, limits = "none", Limits()

        def start(self, folder: Path) -> StudentProcess:
            raise MachineError("no space left")

        def close(self) -> None: ...

    with pytest.raises(MachineError, match="no space left"):
        judge.call(methodcaller("start", tmp_path), launcher=Broken())


def test_an_interrupted_run_waits_for_no_call() -> None:
    pool, raised = JudgePool(), []

    def work() -> None:
        try:
            with pool.borrow() as judge:
                judge.call(time.sleep, 999)
        except CancelledError as error:
            raised.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    while not pool._busy or pool._busy[0]._process is None:
        time.sleep(0.01)
    pool.close()
    thread.join(timeout=20)
    assert len(raised) == 1
    with pytest.raises(CancelledError), pool.borrow():
        pass
