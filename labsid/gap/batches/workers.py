"""Worker processes that import and compile once each; a killed process affects no task but its own.

When a process of a `concurrent.futures` pool is killed, the whole pool breaks and the task is unknown. Here a thread
for each process sends it one task at a time, as a line of JSON on its standard input.
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
POLL = 0.2  # s: delay until Ctrl-C is handled on Windows

# Workers get the import path of this process, without the current folder.
_PROGRAM = """
import sys
sys.path[:] = sys.argv[2:]
from importlib import import_module
import_module(sys.argv[1]).run_worker()
"""
_ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "BLIS", "NUMBA")}
_ONE_THREAD["VECLIB_MAXIMUM_THREADS"] = "1"

Task = dict[str, Any]


def run_tasks(module: str, tasks: Sequence[Task], jobs: int) -> Generator[tuple[int, Task | None], None, None]:
    """Run tasks in several processes.

    Parameters
    ----------
    module : str
        Module whose function `run_worker` calls `serve`.
    tasks : sequence of dict
        Serialisable as JSON.
    jobs : int
        Number of processes.

    Yields
    ------
    tuple of int and dict or None
        Number and result of a task, in the order of completion; None if the process died in every attempt. Closing
        the iterator ends all processes.
    """
    todo: SimpleQueue[int] = SimpleQueue()
    done: SimpleQueue[tuple[int, Task | None] | Exception] = SimpleQueue()
    for number in range(len(tasks)):
        todo.put(number)
    processes = _ProcessGroup(module)

    def feed() -> None:
        worker = None
        try:
            while True:
                number = todo.get_nowait()
                result = None
                for _ in range(ATTEMPTS):
                    worker = worker or processes.start()
                    result = _run(worker, tasks[number])
                    if result is not None or processes.stopped.is_set():
                        break
                    dead, worker = worker, None
                    processes.end(dead)
                done.put((number, result))
        except Empty:
            pass
        except Exception as error:  # no process can be started: reported to the main thread
            done.put(error)
        finally:
            if worker is not None:
                processes.end(worker)

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
        processes.stop()
        for thread in threads:
            if thread.ident is not None:
                thread.join()


def serve(run: Callable[[Task], Task]) -> None:
    """Run tasks from standard input until it is closed; called in the worker process of `run_tasks`.

    Parameters
    ----------
    run : callable
        ``run(task)`` returns a result that is serialisable as JSON.
    """
    tasks: SimpleQueue[Task] = SimpleQueue()

    def listen() -> None:
        for line in sys.stdin.buffer:
            tasks.put(json.loads(line))
        os._exit(0)  # the parent has ended, so nobody reads the current result

    # Output of libraries must not mix with the results or fill a pipe that is not read.
    with os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8") as results, open(os.devnull, "w") as nowhere:
        for stream in (sys.stdout, sys.stderr):
            os.dup2(nowhere.fileno(), stream.fileno())
        Thread(target=listen, daemon=True).start()
        while True:
            text = json.dumps(run(tasks.get()), allow_nan=False)
            results.write(text + "\n")
            results.flush()


class _Stopped(Exception):
    """No more processes may be started."""


class _ProcessGroup:
    """The running worker processes, each in its own session: Ctrl-C reaches only the parent."""

    def __init__(self, module: str) -> None:
        self.command = [sys.executable, "-P", "-c", _PROGRAM, module, *sys.path]
        self.stopped = Event()
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = Lock()

    def start(self) -> "subprocess.Popen[str]":
        """Start a process."""
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
        """End a process.

        Raises
        ------
        OSError
            If it could not start: it writes to standard error only in that case.
        """
        worker.kill()
        message = ""
        for pipe in (worker.stdin, worker.stdout, worker.stderr):
            assert pipe is not None
            with suppress(OSError), pipe:  # closing flushes a task that the process has not read
                message = pipe.read() if pipe is worker.stderr else message
        worker.wait()
        with self._lock:
            self._running.discard(worker)
        if message.strip() and not self.stopped.is_set():
            raise OSError(f"a worker process could not start: {message.strip().splitlines()[-1]}")

    def stop(self) -> None:
        """Kill all processes; the threads that wait for them then clean up."""
        with self._lock:
            self.stopped.set()
            for worker in self._running:
                worker.kill()


def _run(worker: "subprocess.Popen[str]", task: Task) -> Task | None:
    """Run a task in a worker; None if the worker died."""
    assert worker.stdin is not None
    assert worker.stdout is not None
    try:
        worker.stdin.write(json.dumps(task) + "\n")
        worker.stdin.flush()
        result: Task = json.loads(worker.stdout.readline())
    except (OSError, ValueError):  # it ended before the result was complete
        return None
    return result


def _next(done: "SimpleQueue[Any]") -> Any:
    """The next entry of a queue; Ctrl-C interrupts the wait on every system."""
    while True:
        with suppress(Empty):
            return done.get(timeout=POLL)
