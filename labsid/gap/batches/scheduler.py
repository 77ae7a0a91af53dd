"""Diagnose the records of a folder on the workers of a Dask scheduler."""

import tempfile
import time
import warnings
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from labsid._scheduler import check_address, connect, wait_for_worker
from labsid.gap.batches.version import sources_version

CONNECT_SECONDS = 10.0
NO_WORKER_SECONDS = 30.0  # without any worker, after which the run ends
_POLL_SECONDS = 2.0
_PENDING_PER_THREAD = 3  # tasks on the scheduler for each thread of its workers
_MIN_PENDING = 16
_RESUME = "Finished reports are kept; run the same command again for the rest."

Task = dict[str, Any]
Run = Callable[[Task], Task]


def run_on_scheduler(
    run: Run, version: str, tasks: Sequence[Task], address: str
) -> Generator[tuple[int, Task | None], None, None]:
    """Run tasks on the workers of a scheduler. The files travel as bytes; the workers need no shared folder.

    Parameters
    ----------
    run : callable
        At the top level of its module.
    version : str
        Of this machine's labsid, which every worker must have.
    tasks : sequence of dict
        The entry "files" holds lists of paths of this machine by kind.
    address : str
        Such as ``tcp://HOST:8786``.

    Yields
    ------
    tuple of int and dict or None
        Number and result of a task, in the order of completion; None if it killed its workers.

    Raises
    ------
    ValueError
        If the scheduler cannot be reached or is lost, it has no worker, or a worker has another labsid.
    """
    address = check_address(address)
    if not tasks:
        return
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="distributed")
        client = connect(address, CONNECT_SECONDS)
        try:
            yield from _run(client, address, run, version, tasks)
        finally:
            client.close()


def _run(
    client: Any, address: str, run: Run, version: str, tasks: Sequence[Task]
) -> Generator[tuple[int, Task | None], None, None]:
    wait_for_worker(client, address, CONNECT_SECONDS)
    pending: dict[Any, int] = {}
    done: SimpleQueue[Any] = SimpleQueue()
    todo = iter(range(len(tasks)))
    seen = time.monotonic()
    while True:
        threads = sum(_threads(client, address).values())
        seen = time.monotonic() if threads else seen
        if time.monotonic() - seen > NO_WORKER_SECONDS:
            raise ValueError(f"no worker is left at {address}. {_RESUME}")
        most = max(_PENDING_PER_THREAD * threads, _MIN_PENDING)
        for number in islice(todo, max(most - len(pending), 0)):
            call = client.submit(_on_worker, run, version, _packed(tasks[number]), pure=False)
            pending[call] = number
            call.add_done_callback(done.put)
        if not pending:
            return
        with suppress(Empty):
            call = done.get(timeout=_POLL_SECONDS)
            yield pending.pop(call), _result(call, address)


def _threads(client: Any, address: str) -> dict[str, int]:
    """Number of threads of each worker."""
    try:
        if client.status == "running":
            found: dict[str, int] = client.nthreads(callback_timeout=CONNECT_SECONDS)
            return found
    except (OSError, TimeoutError):
        pass
    raise ValueError(f"the scheduler at {address} is gone. {_RESUME}")


def _result(future: Any, address: str) -> Task | None:
    from distributed import KilledWorker

    if future.status == "cancelled":
        raise ValueError(f"the scheduler at {address} is gone. {_RESUME}")
    try:
        result: Task = future.result()
    except KilledWorker:
        return None
    except Exception as error:  # such as a worker without labsid
        raise ValueError(f"a worker of {address} cannot run labsid ({error}). Install this version there.") from None
    if "refused" in result:
        raise ValueError(f"a worker of {address} {result['refused']}. {_RESUME}")
    return result


def _packed(task: Task) -> Task:
    """The task with the names and contents of its files."""
    return task | {"files": {kind: [_content(Path(path)) for path in paths] for kind, paths in task["files"].items()}}


def _content(path: Path) -> tuple[str, bytes | None]:
    """Name and content of a file; None for one that cannot be read, so that it is missing on the worker, too."""
    try:
        return path.name, path.read_bytes()
    except OSError:
        return path.name, None


def _on_worker(run: Run, version: str, task: Task) -> Task:
    """Run a task with its files in a temporary folder."""
    if sources_version() != version:
        return {"refused": "has another labsid than this machine: install the same version there, and restart it"}
    with tempfile.TemporaryDirectory(prefix="labsid-") as folder:
        paths: dict[str, list[str]] = {}
        for kind, files in task["files"].items():
            Path(folder, kind).mkdir()
            paths[kind] = [str(Path(folder, kind, name)) for name, _ in files]
            for name, content in files:
                if content is not None:
                    Path(folder, kind, name).write_bytes(content)
        return run(task | {"files": paths})
