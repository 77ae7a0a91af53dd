"""Grading on a cluster: the workers of a Dask scheduler.

The scheduler passes pickled calls on as opaque bytes: it does not need labsid, and no log holds the course's secret.
Client, scheduler and workers trust each other. Student processes cannot reach any of them: their values cross the
typed channel into the worker, as on a single machine.
"""

import contextlib
import pickle
import time
import uuid
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, ProcessPoolExecutor
from multiprocessing import get_context
from threading import Event, Lock
from typing import Any

from autograder.batch.cluster_worker import (
    Failure,
    WorkerRequirements,
    check_worker,
    run_on_worker,
    worker_requirements,
)
from autograder.batch.judge_process import JudgeProcess
from autograder.batch.tasks import Task
from autograder.course.plain_text import one_line
from autograder.intake.submission import quarantined_submission
from autograder.judge.outcome import SubmissionResult, ungraded_result
from autograder.sandbox.isolation import LEVELS, Limits, is_weaker
from labsid._scheduler import check_address, connect, wait_for_worker

CONNECT_SECONDS = 10.0
"""Time-out of the scheduler's answer."""

CHECK_SECONDS = 60.0
"""Time-out of the workers' check, in which they open their process launchers."""

NO_WORKER_SECONDS = 30.0
"""Time without any worker after which grading stops; workers that ended may be restarting."""

_POLL_SECONDS = 2.0
_REPLY_SECONDS = 60.0
_MIN_PENDING, _MAX_PENDING = 16, 256  # the minimum leaves tasks for workers that join later
_RESUME = "Finished results are kept; run the same command again for the rest."


@contextlib.contextmanager
def open_cluster(
    address: str, isolation: str, notify: Callable[[str], None], limits: Limits | None = None
) -> Iterator["ClusterExecutor"]:
    """Connect to a scheduler and check its workers.

    Parameters
    ----------
    address : str
        ``tcp://HOST:PORT``, ``tls://HOST:PORT`` or ``HOST:PORT``.
    isolation : str
        The isolation required of every worker, as `open_launcher` takes it.
    notify : callable
        Takes a line for the instructor: a rejected worker, or a submission that killed its workers.
    limits : Limits, optional
        Limits of one submission.

    Raises
    ------
    ValueError
        If the address is invalid, nothing answers there in time, or no worker is usable.
    """
    address = check_address(address)
    requirements = worker_requirements(isolation, limits or Limits())
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="distributed")
        cluster = ClusterExecutor(connect(address, CONNECT_SECONDS), address, requirements, notify)
        try:
            cluster.start()
            yield cluster
        finally:
            cluster.close()


class ClusterExecutor:
    """Executes and judges on the workers of a scheduler."""

    def __init__(
        self, client: Any, address: str, requirements: WorkerRequirements, notify: Callable[[str], None]
    ) -> None:
        self._client = client
        self._address = address
        self._requirements = requirements
        self._notify = notify
        self._levels: dict[str, str] = {}  # isolation level of each accepted worker
        self._rejected: dict[str, str] = {}  # reason for each rejected worker
        self._check_lock, self._poll_lock, self._local_lock = Lock(), Lock(), Lock()
        self._known_workers: frozenset[str] = frozenset()
        self._polled_at = self._empty_since = 0.0
        self.level = LEVELS[-1]
        self.max_pending = _MIN_PENDING

    def start(self) -> None:
        """Check the workers that are connected; raise `ValueError` if none is usable."""
        with self._scheduler_errors():
            wait_for_worker(self._client, self._address, NO_WORKER_SECONDS)
            self._check_new_workers()
            threads = sum(self._threads().values())
        if not self._levels:
            reasons = [f"{worker} is rejected: {reason}" for worker, reason in self._rejected.items()]
            timed_out = f"none answered within {CHECK_SECONDS:g} s"
            raise ValueError(f"no worker of {self._address} is usable; {reasons[0] if reasons else timed_out}")
        self.level = max(self._levels.values(), key=LEVELS.index)
        self.max_pending = min(max(2 * threads, _MIN_PENDING), _MAX_PENDING)

    def run(self, task: Task, judge: JudgeProcess) -> SubmissionResult:
        """Execute and judge on a worker, or on this machine if the workers fail; `judge` is not used."""
        with self._scheduler_errors():
            while True:
                rejected = len(self._rejected)
                answer = self._run_on_cluster(task)
                if isinstance(answer, SubmissionResult):
                    return answer
                if answer is not None:
                    self._check_new_workers()  # the task may have gone to a worker that joined since the last check
                    if len(self._rejected) == rejected:
                        return self._run_locally(task, answer.reason)

    def close(self) -> None:
        """Disconnect; running tasks continue on the workers, and their results are discarded."""
        self._client.close()

    def _run_on_cluster(self, task: Task) -> SubmissionResult | Failure | None:
        """Run a task on a worker; None if the chosen workers left and others have joined."""
        from distributed import KilledWorker

        chosen = self._choose_workers()
        call, done = self._call(run_on_worker, task, workers=chosen), Event()
        call.add_done_callback(lambda _: done.set())
        while not done.wait(_POLL_SECONDS):
            usable = self._usable_workers()
            if chosen is not None and usable and usable.isdisjoint(chosen):
                call.cancel()
                return None
        if call.status == "cancelled":  # the client is closing; its event loop may stop before it fetches a result
            raise CancelledError
        try:
            answer: SubmissionResult | Failure = call.result(timeout=_REPLY_SECONDS)
            return answer
        except KilledWorker as killed:
            return Failure(f"it killed {killed.allowed_failures + 1} workers")
        except Exception as error:
            if call.status == "error":
                return Failure(str(error))
            raise

    def _run_locally(self, task: Task, cluster_reason: str) -> SubmissionResult:
        """Run a task that failed on the cluster in a process of its own: other tasks may have caused the failure."""
        name = f"{task.submission.assignment} of {task.submission.student}"
        answer: SubmissionResult | Failure
        try:
            with self._local_lock, ProcessPoolExecutor(1, get_context("spawn")) as pool:
                self._require_connection()
                level = pool.submit(check_worker, self._requirements).result()
                if isinstance(level, str) and is_weaker(level, self.level):
                    level = Failure(f"it isolates less than the workers ({level})")
                if isinstance(level, Failure):
                    answer = level
                else:
                    answer = pool.submit(run_on_worker, self._requirements, task).result()
        except CancelledError:
            raise
        except Exception as error:
            answer = Failure(str(error))
        if isinstance(answer, SubmissionResult):
            self._notify(f"{name}: graded on this machine; on the cluster, {one_line(cluster_reason)}")
            return answer
        self._notify(
            f"{name}: quarantined; on the cluster, {one_line(cluster_reason)}; "
            f"on this machine, {one_line(answer.reason)}"
        )
        refused = quarantined_submission(task.submission.student, task.submission.assignment, "it could not be graded")
        return ungraded_result(refused, task.assets.template, self.level)

    def _check_new_workers(self) -> None:
        """Accept or reject the workers that joined since the last check."""
        with self._check_lock:
            new = self._threads().keys() - self._levels.keys() - self._rejected.keys()
            calls = {worker: self._call(check_worker, workers=[worker], priority=1) for worker in sorted(new)}
            deadline = time.monotonic() + CHECK_SECONDS
            rejected = {}
            for worker, call in calls.items():
                try:
                    answer = call.result(timeout=max(deadline - time.monotonic(), 0.1))
                except Exception as error:
                    if call.status != "error":
                        if isinstance(error, TimeoutError):  # busy, or gone: neither accepted nor rejected
                            continue
                        raise
                    answer = Failure(f"its labsid differs from this machine's ({error})")
                if isinstance(answer, Failure):
                    rejected[worker] = one_line(answer.reason)
                else:
                    self._levels[worker] = answer
            self._rejected |= rejected
            for worker, reason in rejected.items() if self._levels else ():
                self._notify(f"worker {worker} is rejected: {reason}")

    def _choose_workers(self) -> list[str] | None:
        """The workers a task may run on; None for any, as long as none was rejected."""
        while self._rejected:
            if usable := self._usable_workers():
                return sorted(usable)
            time.sleep(_POLL_SECONDS)
        return None

    def _usable_workers(self) -> frozenset[str]:
        """The workers that were not rejected; `ValueError` if there has been none for `NO_WORKER_SECONDS`."""
        with self._poll_lock:
            now = time.monotonic()
            if now - self._polled_at >= _POLL_SECONDS:
                self._known_workers, self._polled_at = frozenset(self._threads()), now
            usable = self._known_workers - self._rejected.keys()
            self._empty_since = 0.0 if usable else self._empty_since or now
            if not usable and now - self._empty_since > NO_WORKER_SECONDS:
                raise ValueError(f"no usable worker is left at {self._address}. {_RESUME}")
            return usable

    def _call(self, function: Callable[..., Any], *arguments: Any, **settings: Any) -> Any:
        """Submit a call to the workers; returns its future."""
        self._require_connection()  # without one, the future would never complete
        call = pickle.dumps(_Call(function, self._requirements, *arguments))
        return self._client.submit(pickle.loads, call, key=f"labsid-{uuid.uuid4().hex}", pure=False, **settings)

    def _threads(self) -> dict[str, int]:
        """The number of threads of each connected worker."""
        self._require_connection()
        found: dict[str, int] = self._client.nthreads(callback_timeout=_REPLY_SECONDS)
        return found

    def _require_connection(self) -> None:
        if self._client.status != "running":
            raise CancelledError

    @contextlib.contextmanager
    def _scheduler_errors(self) -> Iterator[None]:
        """Turn any error of a lost scheduler into a one-line `ValueError`."""
        try:
            yield
        except Exception as error:
            if isinstance(error, CancelledError | TimeoutError) or self._client.status != "running":
                raise ValueError(f"the scheduler at {self._address} is gone. {_RESUME}") from None
            raise


class _Call:
    """A call that runs when it is unpickled, so that the scheduler needs only `pickle.loads`."""

    def __init__(self, function: Callable[..., Any], *arguments: Any) -> None:
        self._call = function, arguments

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return self._call
