"""Independent calls on the cores of this machine, in forked processes that share the memory of the caller."""

import os
import pickle
import signal
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from typing import Any, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

MOST_ITEMS = 10_000  # whose numbers fit into a pipe at once
_DIGITS = 4  # bytes of a number in the pipe

_jobs: ContextVar[int] = ContextVar("jobs", default=1)


def available_cores() -> int:
    """The number of cores that this process may use; 1 on systems where a process is not forked safely."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1


@contextmanager
def on_cores(jobs: int) -> Iterator[None]:
    """Let `mapped` use so many processes, at most one for each core."""
    token = _jobs.set(min(jobs, available_cores()))
    try:
        yield
    finally:
        _jobs.reset(token)


def mapped(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    kept: Sequence[object] = (),
    begun: Callable[[int, int], None] | None = None,
) -> list[Result]:
    """``[function(item) for item in items]``, of independent calls, on the cores that `on_cores` allows.

    The caller takes part. Each process takes the next item when it is done with one. The results are the same for any
    number of processes. What a process does not return, because it was ended, the caller computes.

    Parameters
    ----------
    function : callable
        Without effects other than its result: those of a forked process are lost.
    items : iterable
    kept : sequence of object
        Objects to which results refer, beside the items: they are not copied.
    begun : callable, optional
        Called by the caller with the number of an item that begins, from 0, and the number of all.

    Raises
    ------
    Exception
        What the first call that failed has raised.
    """
    items = list(items)

    def call(i: int) -> Result:
        if begun is not None:
            begun(i, len(items))
        return function(items[i])

    workers = min(_jobs.get(), len(items))
    if workers < 2 or len(items) > MOST_ITEMS:
        return [call(i) for i in range(len(items))]
    results = _on_processes(call, lambda i: function(items[i]), len(items), workers, (*kept, *items))
    for i in range(len(items)):
        if i not in results:
            results[i] = call(i)
        elif isinstance(results[i], _Failed):
            raise results[i].error
    return [results[i] for i in range(len(items))]


class _Failed:
    """A call that has raised an error."""

    def __init__(self, error: Exception) -> None:
        self.error = error


def _on_processes(
    own: Callable[[int], Any], forked: Callable[[int], Any], count: int, workers: int, kept: tuple[object, ...]
) -> dict[int, Any]:
    """Results by number: of `own` in this process, of `forked` in the others."""
    numbers, end = os.pipe()
    os.write(end, b"".join(i.to_bytes(_DIGITS, "big") for i in range(count)))
    os.close(end)
    children: list[tuple[int, int]] = []
    try:
        for _ in range(workers - 1):
            children.append(_fork(forked, numbers, kept))
        by_number = _results(own, numbers)
        for _, results in children:
            by_number |= _received(results, kept)
    finally:
        os.close(numbers)
        for process, results in children:
            os.close(results)
            os.kill(process, signal.SIGKILL)  # it has ended, or its results are not needed
            os.waitpid(process, 0)
    return by_number


def _results(call: Callable[[int], Any], numbers: int) -> dict[int, Any]:
    """Results of the calls whose numbers this process has taken from the pipe."""
    found: dict[int, Any] = {}
    while taken := os.read(numbers, _DIGITS):
        i = int.from_bytes(taken, "big")
        try:
            found[i] = call(i)
        except Exception as error:
            found[i] = _Failed(error)
    return found


def _fork(call: Callable[[int], Any], numbers: int, kept: tuple[object, ...]) -> tuple[int, int]:
    """The number of a new process, and the pipe from which its results are read."""
    results, end = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads: those of BLAS and of the progress rest
        process = os.fork()
    if process:
        os.close(end)
        return process, results
    try:
        _jobs.set(1)
        os.close(results)
        file = BytesIO()
        _Pickler(file, kept).dump(_results(call, numbers))
        with open(end, "wb") as pipe:
            pipe.write(file.getbuffer())
    finally:
        os._exit(0)  # neither buffers nor handlers of the caller are run a second time


def _received(results: int, kept: tuple[object, ...]) -> dict[int, Any]:
    """The results of a process; none if it has ended early."""
    with open(results, "rb", closefd=False) as pipe:
        content = pipe.read()
    try:
        return dict(_Unpickler(BytesIO(content), kept).load())
    except (EOFError, pickle.UnpicklingError):
        return {}


class _Pickler(pickle.Pickler):
    """Writes kept objects as their places."""

    def __init__(self, file: BytesIO, kept: tuple[object, ...]) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self._places = {id(one): place for place, one in enumerate(kept)}

    def persistent_id(self, one: object) -> int | None:
        return self._places.get(id(one))


class _Unpickler(pickle.Unpickler):
    def __init__(self, file: BytesIO, kept: tuple[object, ...]) -> None:
        super().__init__(file)
        self._kept = kept

    def persistent_load(self, place: int) -> object:
        return self._kept[place]
