"""Tasks for several processes: each imports and compiles once, and one that dies takes no other with it.

A pool of `concurrent.futures` breaks as a whole when one of its processes is killed, without saying on which task.
Here each process has a thread that hands it one task at a time over its standard input, as a line of JSON.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Event, Lock, Thread
from typing import Any

ATTEMPTS = 2
POLL = 0.2  # s, after which Ctrl-C is seen on Windows

# The path by which this process found everything goes along; the current folder does not.
_PROGRAM = """
import sys
sys.path[:] = sys.argv[2:]
from importlib import import_module
import_module(sys.argv[1]).work()
"""
_ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "BLIS", "NUMBA")}
_ONE_THREAD["VECLIB_MAXIMUM_THREADS"] = "1"

Task = dict[str, Any]


def run_tasks(module: str, tasks: Sequence[Task], jobs: int) -> Generator[tuple[int, Task | None], None, None]:
    """Have tasks done by several processes.

    Parameters
    ----------
    module : str
        Module whose `work` calls `serve`.
    tasks : sequence of dict
        JSON-ready.
    jobs : int
        Processes at a time.

    Yields
    ------
    tuple of int and dict or None
        Number of a task and its answer, in the order in which they come; None where the process died over the task
        in every attempt. Closing the iterator ends all processes.
    """
    todo: SimpleQueue[int] = SimpleQueue()
    done: SimpleQueue[tuple[int, Task | None] | Exception] = SimpleQueue()
    for number in range(len(tasks)):
        todo.put(number)
    crew = _ProcessGroup(module)

    def feed() -> None:
        worker = None
        try:
            while True:
                number = todo.get_nowait()
                answer = None
                for _ in range(ATTEMPTS):
                    worker = worker or crew.start()
                    answer = _ask(worker, tasks[number])
                    if answer is not None or crew.stopped.is_set():
                        break
                    dead, worker = worker, None
                    crew.end(dead)
                done.put((number, answer))
        except Empty:
            pass
        except Exception as error:  # no process can be started any more: whoever waits must hear of it
            done.put(error)
        finally:
            if worker is not None:
                crew.end(worker)

    threads = [Thread(target=feed, daemon=True) for _ in range(min(jobs, len(tasks)))]
    try:
        for thread in threads:
            thread.start()
        for _ in tasks:
            result = _next(done)
            if isinstance(result, Exception):
                raise result
            yield result
    finally:
        crew.stop()
        for thread in threads:
            if thread.ident is not None:
                thread.join()


def serve(answer: Callable[[Task], Task]) -> None:
    """Answer tasks from standard input until it ends; the other side of `run_tasks`.

    Parameters
    ----------
    answer : callable
        From a task to a JSON-ready answer.
    """
    tasks: SimpleQueue[Task] = SimpleQueue()

    def listen() -> None:
        for line in sys.stdin.buffer:
            tasks.put(json.loads(line))
        os._exit(0)  # whoever asked is gone, perhaps killed: what is under way is of no use to anyone

    # What libraries print must neither come between the answers nor fill a pipe that nobody reads.
    with os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8") as answers, open(os.devnull, "w") as nowhere:
        for stream in (sys.stdout, sys.stderr):
            os.dup2(nowhere.fileno(), stream.fileno())
        Thread(target=listen, daemon=True).start()
        while True:
            text = json.dumps(answer(tasks.get()), allow_nan=False)
            answers.write(text + "\n")
            answers.flush()


class _Stopped(Exception):
    """No further process is wanted."""


class _ProcessGroup:
    """The processes that run now. They are in sessions of their own: Ctrl-C reaches only the process that asks."""

    def __init__(self, module: str) -> None:
        self.command = [sys.executable, "-P", "-c", _PROGRAM, module, *sys.path]
        self.stopped = Event()
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = Lock()

    def start(self) -> "subprocess.Popen[str]":
        """A new process."""
        with self._lock:
            if self.stopped.is_set():
                raise _Stopped
            worker = subprocess.Popen(
                self.command,
                env=os.environ | _ONE_THREAD,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                encoding="utf-8",
                start_new_session=True,
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
            )
            self._running.add(worker)
            return worker

    def end(self, worker: "subprocess.Popen[str]") -> None:
        """End one process and forget it.

        Raises
        ------
        OSError
            If it could not even start to serve: only then does it say anything on standard error.
        """
        worker.kill()
        said = ""
        for pipe in (worker.stdin, worker.stdout, worker.stderr):
            assert pipe is not None
            with suppress(OSError), pipe:  # of the task that it did not read any more
                said = pipe.read() if pipe is worker.stderr else said
        worker.wait()
        with self._lock:
            self._running.discard(worker)
        if said.strip() and not self.stopped.is_set():
            raise OSError(f"a process for the records could not start: {said.strip().splitlines()[-1]}")

    def stop(self) -> None:
        """Kill all processes: the threads that wait for them see their end, and clear them away."""
        with self._lock:
            self.stopped.set()
            for worker in self._running:
                worker.kill()


def _ask(worker: "subprocess.Popen[str]", task: Task) -> Task | None:
    """The worker's answer; None where it died."""
    assert worker.stdin is not None
    assert worker.stdout is not None
    try:
        worker.stdin.write(json.dumps(task) + "\n")
        worker.stdin.flush()
        answer: Task = json.loads(worker.stdout.readline())
    except (OSError, ValueError):  # it ended before or within its answer
        return None
    return answer


def _next(done: "SimpleQueue[Any]") -> Any:
    """The next entry of a queue, Ctrl-C being seen on every system."""
    while True:
        with suppress(Empty):
            return done.get(timeout=POLL)
