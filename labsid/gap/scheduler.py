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
from labsid.gap.version import sources_version

CONNECT_SECONDS = 10.0
NO_WORKER_SECONDS = 30.0  # without any worker, after which the run ends
_POLL_SECONDS = 2.0
_PENDING_PER_THREAD = 3  # tasks on the scheduler for each thread of its workers
_MIN_PENDING = 16
_RESUME = "Finished reports are kept; run the same command again for the rest."
_FILES = ("record", "sim", "holdout")

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
        Their files are paths of this machine.
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
    """The task with the contents of its files; None for one that cannot be read, so that it is missing there, too."""
    files: dict[str, tuple[str, bytes | None]] = {}
    for path, kind in ((Path(task[kind]), kind) for kind in _FILES if task[kind] is not None):
        files[kind] = path.name, None
        with suppress(OSError):
            files[kind] = path.name, path.read_bytes()
    return task | {"files": files}


def _on_worker(run: Run, version: str, task: Task) -> Task:
    """Run a task with its files in a temporary folder."""
    if sources_version() != version:
        return {"refused": "has another labsid than this machine: install the same version there, and restart it"}
    with tempfile.TemporaryDirectory(prefix="labsid-") as folder:
        paths: dict[str, str | None] = dict.fromkeys(_FILES)
        for kind, (name, content) in task["files"].items():
            path = Path(folder) / kind / name
            path.parent.mkdir()
            if content is not None:
                path.write_bytes(content)
            paths[kind] = str(path)
        return run(task | paths)
